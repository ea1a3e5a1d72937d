/* SPDX-License-Identifier: GPL-3.0-or-later */
/* pixel_classifier_learn.c - sample, grow, fill, calibrate. */
#include "config.h"

#include "parse/pixel_classifier_learn.h"

#include "parse/pixel_classifier_priv.h"
#include "parse/pixel_classifier_sample.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { CHUNK = 4096, MAX_VALID = 1000000 }; /* pixels judged at a time; of the validation part that are looked at */

typedef struct {
    const sg_dataset *train, *valid;
    const sg_pixel_learn_opts *opts;
    sg_pixel_sample_opts photos;
    sg_pixel_census census;
    sg_pixel_classifier *classifier;
    sg_pixel_learn_report *report;
    sg_arena *arena;
    uint64_t *counts; /* [leaves][classes] */
} job;

static double now_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* What a pixel of each class must count so that classes have the frequencies that the leaves speak for. */
static void weigh(const double *frequency, const uint64_t *counts, size_t nclasses, double *weights)
{
    double total = 0;
    for (size_t k = 0; k < nclasses; k++)
        total += (double)counts[k];
    for (size_t k = 0; k < nclasses; k++)
        weights[k] = counts[k] > 0 ? frequency[k] * total / (double)counts[k] : 0;
}

static void set_frequencies(const job *j)
{
    const sg_pixel_census *c = &j->census;
    size_t present = 0;
    for (size_t k = 0; k < c->nclasses; k++)
        present += c->of_class[k] > 0;
    for (size_t k = 0; k < c->nclasses; k++)
        j->classifier->frequency[k] = !j->opts->balanced      ? (double)c->of_class[k] / (double)c->npixels
                                      : c->of_class[k] > 0 ? 1 / (double)present
                                                           : 0;
}

/* ---- judging many pixels ---- */

static sg_status judge(const sg_forest_view *v, const ptrdiff_t *pixels, size_t n, float *p, sg_error *err)
{
    const size_t nclasses = sg_forest_view_forest(v)->nclasses;
    uint32_t *leaves = malloc(CHUNK * sizeof *leaves);
    if (leaves == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t i = 0; i < n; i += CHUNK)
        sg_forest_mean(v, pixels + i, n - i < CHUNK ? n - i : CHUNK, leaves, p + i * nclasses);
    free(leaves);
    return SG_OK;
}

static sg_status count(const sg_forest_view *v, const ptrdiff_t *pixels, const uint8_t *classes, size_t n,
                       uint64_t *counts, sg_error *err)
{
    uint32_t *leaves = malloc(CHUNK * sizeof *leaves);
    if (leaves == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t i = 0; i < n; i += CHUNK)
        sg_forest_count(v, pixels + i, classes + i, n - i < CHUNK ? n - i : CHUNK, leaves, counts);
    free(leaves);
    return SG_OK;
}

/* ---- the sample ---- */

static sg_status fill_from_sample(const job *j, const sg_sample_matrix *m, const sg_forest_view *v,
                                  const ptrdiff_t *pixels, sg_error *err)
{
    double weights[SG_MAX_CLASSES];
    SG_TRY(count(v, pixels, m->classes, m->n, j->counts, err));
    weigh(j->classifier->frequency, j->report->sample_pixels, m->nclasses, weights);
    sg_forest_fill(&j->classifier->forest, j->counts, weights, j->opts->smoothing);
    memset(j->counts, 0, j->classifier->forest.nleaves * m->nclasses * sizeof *j->counts);
    return SG_OK;
}

static sg_status with_sample(const job *j, const sg_sample_matrix *m, sg_error *err)
{
    ptrdiff_t *offsets = malloc(m->nfeatures * sizeof *offsets), *pixels = malloc(m->n * sizeof *pixels);
    sg_forest_view *v = NULL;
    sg_status st = offsets != NULL && pixels != NULL ? SG_OK : SG_FAIL_NOMEM(err);
    for (size_t f = 0; st == SG_OK && f < m->nfeatures; f++)
        offsets[f] = (ptrdiff_t)(f * m->n);
    for (size_t i = 0; st == SG_OK && i < m->n; i++)
        pixels[i] = (ptrdiff_t)i;
    if (st == SG_OK)
        st = sg_forest_bind(&j->classifier->forest, m->x, offsets, &v, err);
    if (st == SG_OK)
        st = fill_from_sample(j, m, v, pixels, err);
    sg_forest_view_free(v);
    free(offsets);
    free(pixels);
    return st;
}

static sg_status count_uses(const sg_forest *f, uint64_t **uses, sg_error *err)
{
    *uses = calloc(f->nfeatures, sizeof **uses);
    if (*uses == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t i = 0; i < f->nnodes; i++)
        if (f->nodes[i].feature != SG_FOREST_LEAF)
            (*uses)[f->nodes[i].feature]++;
    return SG_OK;
}

static sg_status grow_on(job *j, const sg_sample_matrix *m, sg_error *err)
{
    sg_forest *f = &j->classifier->forest;
    const double begin = now_s();
    const sg_status grown = sg_forest_grow(m, &j->opts->grow, f, err);
    j->report->grow_s = now_s() - begin;
    if ((grown != SG_OK && grown != SG_STOPPED) || f->ntrees == 0)
        return grown;
    sg_error inner = SG_ERROR_INIT;
    j->counts = SG_NEW_ARRAY(j->arena, uint64_t, f->nleaves * f->nclasses);
    sg_status st = j->counts != NULL ? with_sample(j, m, &inner) : SG_FAIL_NOMEM(&inner);
    if (st == SG_OK)
        st = count_uses(f, &j->report->uses, &inner);
    if (st != SG_OK && err != NULL)
        *err = inner;
    return st != SG_OK ? st : grown;
}

static sg_status sample_and_grow(job *j, sg_error *err)
{
    sg_sample_matrix m = {0};
    const double begin = now_s();
    sg_pixel_quotas(&j->census, j->opts->pixels, j->opts->balanced, j->report->sample_pixels);
    SG_TRY(sg_pixel_sample_draw(j->train, &j->census, j->report->sample_pixels, &j->photos, &m, err));
    j->report->sample_s = now_s() - begin;
    const sg_status st = grow_on(j, &m, err);
    free(m.x);
    free(m.classes);
    return st;
}

/* ---- all pixels of the training photographs ---- */

typedef struct {
    ptrdiff_t *pixels;
    uint8_t *classes;
    size_t n;
    sg_forest_view *view;
} listing;

static void clear_listing(listing *l)
{
    free(l->pixels);
    free(l->classes);
    sg_forest_view_free(l->view);
}

static sg_status list_photo(const job *j, const sg_pixel_photo *p, size_t step, listing *l, sg_error *err)
{
    const size_t room = p->labels.width * p->labels.height;
    *l = (listing){malloc(room * sizeof *l->pixels), malloc(room), 0, NULL};
    if (l->pixels == NULL || l->classes == NULL)
        return SG_FAIL_NOMEM(err);
    l->n = sg_pixel_photo_list(p, step, l->pixels, l->classes);
    return sg_forest_bind(&j->classifier->forest, p->features.data, p->features.offsets, &l->view, err);
}

static sg_status fill_item(void *user, size_t item, const sg_pixel_photo *p, sg_error *err)
{
    const job *j = user;
    listing l;
    (void)item;
    sg_status st = list_photo(j, p, 1, &l, err);
    if (st == SG_OK)
        st = count(l.view, l.pixels, l.classes, l.n, j->counts, err);
    clear_listing(&l);
    return st;
}

static sg_status fill_from_all(job *j, sg_error *err)
{
    double weights[SG_MAX_CLASSES];
    const double begin = now_s();
    SG_TRY(sg_pixel_photos_each(j->train, &j->photos, "leaves", fill_item, j, err));
    weigh(j->classifier->frequency, j->census.of_class, j->census.nclasses, weights);
    sg_forest_fill(&j->classifier->forest, j->counts, weights, j->opts->smoothing);
    j->report->fill_s = now_s() - begin;
    return SG_OK;
}

/* ---- calibration ---- */

typedef struct {
    const job *job;
    size_t step;             /* of the grid of pixels that are judged */
    sg_pixel_judgements *of; /* [valid->nitems] */
} judging;

static sg_status judge_item(void *user, size_t item, const sg_pixel_photo *p, sg_error *err)
{
    const judging *g = user;
    const job *j = g->job;
    sg_pixel_judgements *to = &g->of[item];
    listing l;
    sg_status st = list_photo(j, p, g->step, &l, err);
    if (st == SG_OK) {
        to->n = l.n;
        to->nclasses = j->census.nclasses;
        to->p = malloc((l.n * to->nclasses + 1) * sizeof *to->p);
        st = to->p != NULL ? judge(l.view, l.pixels, l.n, to->p, err) : SG_FAIL_NOMEM(err);
    }
    to->classes = l.classes;
    l.classes = NULL;
    clear_listing(&l);
    return st;
}

static sg_status join(const judging *g, size_t nitems, sg_pixel_judgements *all, sg_error *err)
{
    const size_t nclasses = g->job->census.nclasses;
    for (size_t i = 0; i < nitems; i++)
        all->n += g->of[i].n;
    all->nclasses = nclasses;
    all->p = malloc((all->n * nclasses + 1) * sizeof *all->p);
    all->classes = malloc(all->n + 1);
    if (all->p == NULL || all->classes == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t i = 0, at = 0; i < nitems; at += g->of[i++].n) {
        memcpy(all->p + at * nclasses, g->of[i].p, g->of[i].n * nclasses * sizeof *all->p);
        memcpy(all->classes + at, g->of[i].classes, g->of[i].n);
    }
    return SG_OK;
}

static sg_status calibrate_on(job *j, const sg_pixel_judgements *all, sg_error *err)
{
    const sg_calibration none = SG_CALIBRATION_NONE;
    sg_pixel_classifier *c = j->classifier;
    sg_pixel_weights w;
    uint64_t counts[SG_MAX_CLASSES] = {0};
    for (size_t i = 0; i < all->n; i++)
        counts[all->classes[i]]++;
    for (size_t k = 0; k < all->nclasses; k++)
        w.accuracy[k] = w.loss[k] = 1;
    if (j->opts->balanced)
        weigh(c->frequency, counts, all->nclasses, w.loss);
    SG_TRY(sg_pixel_calibration_fit(all, c->frequency, &w, !j->opts->balanced, j->opts->grow.threads,
                                    j->opts->grow.progress, j->report->curve, &c->calibration, err));
    j->report->valid_pixels = all->n;
    j->report->valid_before = sg_pixel_score_of(all, &none, c->frequency, &w);
    j->report->valid = sg_pixel_score_of(all, &c->calibration, c->frequency, &w);
    return SG_OK;
}

/* Of large validation parts a grid of pixels is enough. */
static size_t grid_step(const sg_pixel_census *c)
{
    size_t step = 1;
    while (c->npixels / (step * step) > MAX_VALID)
        step++;
    return step;
}

static sg_status calibrate(job *j, sg_error *err)
{
    sg_pixel_census census;
    sg_pixel_judgements all = {0};
    const double begin = now_s();
    const size_t n = j->valid->nitems;
    SG_TRY(sg_pixel_census_take(j->valid, j->arena, &census, err));
    judging g = {j, grid_step(&census), calloc(n, sizeof *g.of)};
    sg_status st = g.of != NULL ? SG_OK : SG_FAIL_NOMEM(err);
    if (st == SG_OK)
        st = sg_pixel_photos_each(j->valid, &j->photos, "validation", judge_item, &g, err);
    if (st == SG_OK)
        st = join(&g, n, &all, err);
    if (st == SG_OK && all.n > 0)
        st = calibrate_on(j, &all, err);
    for (size_t i = 0; g.of != NULL && i < n; i++)
        sg_pixel_judgements_clear(&g.of[i]);
    free(g.of);
    sg_pixel_judgements_clear(&all);
    j->report->valid_s = now_s() - begin;
    return st;
}

/* ---- all of it ---- */

static sg_status copy_classes(const sg_classes *from, sg_classes *to, sg_error *err)
{
    sg_classes c = *from;
    memset(c.names, 0, sizeof c.names);
    for (size_t k = 0; k < c.nclasses; k++) {
        c.names[k] = strdup(from->names[k]);
        if (c.names[k] == NULL) {
            sg_classes_clear(&c);
            return SG_FAIL_NOMEM(err);
        }
    }
    *to = c;
    return SG_OK;
}

static sg_status learn(job *j, sg_error *err)
{
    const sg_calibration none = SG_CALIBRATION_NONE;
    sg_pixel_classifier *c = j->classifier;
    c->features = j->opts->features;
    c->balanced = j->opts->balanced;
    c->calibration = none;
    SG_TRY(copy_classes(&j->train->classes, &c->classes, err));
    SG_TRY(sg_pixel_census_take(j->train, j->arena, &j->census, err));
    memcpy(j->report->train_pixels, j->census.of_class, j->census.nclasses * sizeof *j->census.of_class);
    set_frequencies(j);
    SG_TRY(sample_and_grow(j, err));
    SG_TRY(fill_from_all(j, err));
    return j->valid != NULL && j->valid->nitems > 0 ? calibrate(j, err) : SG_OK;
}

static sg_status check_opts(const sg_dataset *train, const sg_pixel_learn_opts *o, sg_error *err)
{
    if (train->nitems == 0)
        return SG_FAIL(err, SG_EINVAL, "no photographs to learn from");
    if (sg_feature_set_count(&o->features) == 0)
        return SG_FAIL(err, SG_EINVAL, "unknown features");
    if (o->pixels == 0 || !(o->smoothing > 0) || o->grow.threads < 1)
        return SG_FAIL(err, SG_EINVAL, "a sample of %zu pixels, smoothing %g, %d threads", o->pixels, o->smoothing,
                       o->grow.threads);
    return SG_OK;
}

void sg_pixel_learn_report_clear(sg_pixel_learn_report *r)
{
    free(r->uses);
    memset(r, 0, sizeof *r);
}

sg_status sg_pixel_classifier_learn(const sg_dataset *train, const sg_dataset *valid, const sg_pixel_learn_opts *opts,
                                    sg_pixel_classifier **out, sg_pixel_learn_report *report, sg_error *err)
{
    *out = NULL;
    memset(report, 0, sizeof *report);
    SG_TRY(check_opts(train, opts, err));
    job j = {.train = train, .valid = valid, .opts = opts, .report = report,
             .photos = {opts->features, opts->grow.seed, opts->grow.threads, opts->grow.progress}};
    report->train_images = train->nitems;
    report->valid_images = valid != NULL ? valid->nitems : 0;
    j.classifier = calloc(1, sizeof *j.classifier);
    j.arena = sg_arena_create();
    const sg_status st = j.classifier != NULL && j.arena != NULL ? learn(&j, err) : SG_FAIL_NOMEM(err);
    sg_arena_free(j.arena);
    if ((st == SG_OK || st == SG_STOPPED) && j.classifier->forest.ntrees > 0) {
        *out = j.classifier;
        return st;
    }
    sg_pixel_classifier_free(j.classifier);
    if (st != SG_STOPPED)
        sg_pixel_learn_report_clear(report);
    return st;
}
