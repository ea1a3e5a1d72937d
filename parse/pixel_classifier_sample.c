/* SPDX-License-Identifier: GPL-3.0-or-later */
/* pixel_classifier_sample.c - counting and drawing pixels of a data set. */
#include "config.h"

#include "parse/pixel_classifier_sample.h"

#include "core/random.h"
#include "image/cv_image.h"

#include <stdlib.h>
#include <string.h>

enum { FLOOR_SHARE = 20 }; /* a rare class has at least 1 / 20 of what it had if all were as frequent */

/* ---- counting ---- */

static sg_status count_item(const sg_dataset *d, size_t item, uint64_t *counts, sg_error *err)
{
    sg_label_map map;
    SG_TRY(sg_dataset_read_labels(d, item, &map, err));
    for (size_t i = 0; i < map.width * map.height; i++)
        if (map.labels[i] != SG_CLASS_IGNORE)
            counts[map.labels[i]]++;
    sg_label_map_clear(&map);
    return SG_OK;
}

sg_status sg_pixel_census_take(const sg_dataset *d, sg_arena *arena, sg_pixel_census *out, sg_error *err)
{
    sg_pixel_census c = {.nitems = d->nitems, .nclasses = d->classes.nclasses};
    c.of_item = SG_NEW_ARRAY(arena, uint64_t, c.nitems * c.nclasses + 1);
    c.of_class = SG_NEW_ARRAY(arena, uint64_t, c.nclasses);
    if (c.of_item == NULL || c.of_class == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t i = 0; i < c.nitems; i++)
        SG_TRY(count_item(d, i, c.of_item + i * c.nclasses, err));
    for (size_t i = 0; i < c.nitems * c.nclasses; i++) {
        c.of_class[i % c.nclasses] += c.of_item[i];
        c.npixels += c.of_item[i];
    }
    *out = c;
    return SG_OK;
}

static uint64_t at_most(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

void sg_pixel_quotas(const sg_pixel_census *c, size_t n, bool balanced, uint64_t *quotas)
{
    const uint64_t least = balanced ? n / c->nclasses : n / (FLOOR_SHARE * c->nclasses);
    uint64_t given = 0;
    for (size_t k = 0; k < c->nclasses; k++) {
        quotas[k] = at_most(c->of_class[k], least > 0 ? least : 1);
        given += quotas[k];
    }
    if (balanced || n <= given || c->npixels <= given)
        return;
    /* what is over goes by what each class has over */
    const double share = (double)(at_most(n, c->npixels) - given) / (double)(c->npixels - given);
    for (size_t k = 0; k < c->nclasses; k++)
        quotas[k] += (uint64_t)(share * (double)(c->of_class[k] - quotas[k]));
}

/* ---- photographs ---- */

sg_status sg_pixel_photo_open(const sg_dataset *d, size_t item, const sg_feature_set *set, sg_pixel_photo *out,
                              sg_error *err)
{
    sg_image im = {0};
    sg_pixel_photo p = {{0}, {0}};
    sg_error inner = SG_ERROR_INIT;
    sg_status st = sg_photo_read(d->items[item].image, &im, err);
    if (st == SG_OK)
        st = sg_dataset_read_labels(d, item, &p.labels, err);
    if (st == SG_OK && (p.labels.width != im.width || p.labels.height != im.height)) /* changed since it was checked */
        st = SG_FAIL(err, SG_EINPUT, "%s: not of the size of its label map", d->items[item].image);
    if (st == SG_OK) {
        st = sg_features_create(set, &im, &p.features, &inner);
        if (st != SG_OK)
            SG_FAIL(err, st, "%s: %.900s", d->items[item].image, inner.msg);
    }
    sg_image_clear(&im);
    if (st == SG_OK)
        *out = p;
    else
        sg_pixel_photo_clear(&p);
    return st;
}

void sg_pixel_photo_clear(sg_pixel_photo *p)
{
    sg_features_clear(&p->features);
    sg_label_map_clear(&p->labels);
}

size_t sg_pixel_photo_list(const sg_pixel_photo *p, size_t step, ptrdiff_t *pixels, uint8_t *classes)
{
    size_t n = 0;
    for (size_t y = 0; y < p->labels.height; y += step)
        for (size_t x = 0; x < p->labels.width; x += step) {
            const uint8_t class = p->labels.labels[y * p->labels.width + x];
            if (class == SG_CLASS_IGNORE)
                continue;
            pixels[n] = (ptrdiff_t)(y * p->features.stride + x);
            classes[n++] = class;
        }
    return n;
}

typedef struct {
    sg_status status; /* of the first photograph, in order, that failed */
    size_t failed_item, ndone;
    bool stopped;
    sg_error error;
} progress_state;

static void note_outcome(progress_state *s, size_t item, sg_status st, const sg_error *err)
{
    s->ndone++;
    if (st != SG_OK && (s->status == SG_OK || item < s->failed_item)) {
        s->status = st;
        s->failed_item = item;
        s->error = *err;
    }
}

sg_status sg_pixel_photos_each(const sg_dataset *d, const sg_pixel_sample_opts *opts, const char *step,
                               sg_status (*work)(void *user, size_t item, const sg_pixel_photo *p, sg_error *err),
                               void *user, sg_error *err)
{
    progress_state s = {.status = SG_OK};
#pragma omp parallel for schedule(dynamic) num_threads(opts->threads)
    for (size_t i = 0; i < d->nitems; i++) {
        bool skip;
#pragma omp critical(sg_pixel_photos)
        {
            s.stopped = s.stopped || sg_progress_stopped(opts->progress);
            skip = s.stopped || s.status != SG_OK;
        }
        if (skip)
            continue;
        sg_error e = SG_ERROR_INIT;
        sg_pixel_photo photo = {{0}, {0}};
        sg_status st = sg_pixel_photo_open(d, i, &opts->features, &photo, &e);
        if (st == SG_OK)
            st = work(user, i, &photo, &e);
        sg_pixel_photo_clear(&photo);
#pragma omp critical(sg_pixel_photos)
        {
            note_outcome(&s, i, st, &e);
            sg_progress_report(opts->progress, step, s.ndone, d->nitems);
        }
    }
    if (s.status != SG_OK && err != NULL)
        *err = s.error;
    if (s.status != SG_OK)
        return s.status;
    return s.stopped ? SG_FAIL(err, SG_STOPPED, "stopped") : SG_OK;
}

/* ---- drawing ---- */

typedef struct {
    const sg_pixel_census *census;
    const uint64_t *quotas;
    uint64_t seed;
    size_t *first;     /* [nitems + 1] of a photograph's samples */
    uint64_t *of_item; /* [nitems][nclasses] samples to draw */
    sg_sample_matrix *out;
} drawing;

/* Shares of the quotas, rounded so that they add up: to the left of each photograph lies its share of the whole. */
static void share_quotas(drawing *d)
{
    const sg_pixel_census *c = d->census;
    for (size_t k = 0; k < c->nclasses; k++) {
        uint64_t seen = 0, given = 0;
        for (size_t i = 0; i < c->nitems; i++) {
            seen += c->of_item[i * c->nclasses + k];
            const double left = (double)d->quotas[k] * (double)seen / (double)(c->of_class[k] > 0 ? c->of_class[k] : 1);
            uint64_t part = (uint64_t)(left + 0.5) - given;
            part = at_most(part, c->of_item[i * c->nclasses + k]);
            d->of_item[i * c->nclasses + k] = part;
            given += part;
        }
    }
    d->first[0] = 0;
    for (size_t i = 0; i < c->nitems; i++) {
        d->first[i + 1] = d->first[i];
        for (size_t k = 0; k < c->nclasses; k++)
            d->first[i + 1] += (size_t)d->of_item[i * c->nclasses + k];
    }
}

/* Selection sampling (Knuth, volume 2, algorithm 3.4.2S) in each class: exactly so many, every subset as likely. */
static size_t select_pixels(const drawing *d, size_t item, const sg_pixel_photo *p, gsl_rng *rng, ptrdiff_t *pixels,
                            uint8_t *classes)
{
    const size_t nclasses = d->census->nclasses;
    uint64_t left[SG_MAX_CLASSES], wanted[SG_MAX_CLASSES];
    size_t n = 0;
    memcpy(left, d->census->of_item + item * nclasses, nclasses * sizeof *left);
    memcpy(wanted, d->of_item + item * nclasses, nclasses * sizeof *wanted);
    sg_random_stream(rng, d->seed, 0, item);
    for (size_t i = 0; i < p->labels.width * p->labels.height; i++) {
        const uint8_t class = p->labels.labels[i];
        if (class == SG_CLASS_IGNORE || wanted[class] == 0 || n == d->first[item + 1] - d->first[item])
            continue;
        if (sg_random_uniform(rng) * (double)left[class]-- >= (double)wanted[class])
            continue;
        wanted[class]--;
        pixels[n] = (ptrdiff_t)(i / p->labels.width * p->features.stride + i % p->labels.width);
        classes[n++] = class;
    }
    return n;
}

static sg_status draw_item(void *user, size_t item, const sg_pixel_photo *p, sg_error *err)
{
    drawing *d = user;
    const size_t first = d->first[item], n = d->first[item + 1] - first;
    gsl_rng *rng = sg_random_create(d->seed);
    ptrdiff_t *pixels = malloc((n + 1) * sizeof *pixels);
    sg_status st = rng != NULL && pixels != NULL ? SG_OK : SG_FAIL_NOMEM(err);
    if (st == SG_OK && select_pixels(d, item, p, rng, pixels, d->out->classes + first) != n)
        st = SG_FAIL(err, SG_EINPUT, "a label map has changed while it was read");
    for (size_t f = 0; st == SG_OK && f < d->out->nfeatures; f++) {
        float *to = d->out->x + f * d->out->n + first;
        const float *from = p->features.data + p->features.offsets[f];
        for (size_t i = 0; i < n; i++)
            to[i] = from[pixels[i]];
    }
    free(pixels);
    gsl_rng_free(rng);
    return st;
}

static sg_status make_matrix(const drawing *d, size_t nfeatures, sg_error *err)
{
    sg_sample_matrix *m = d->out;
    m->n = d->first[d->census->nitems];
    m->nfeatures = nfeatures;
    m->nclasses = d->census->nclasses;
    m->x = m->n < SIZE_MAX / sizeof *m->x / nfeatures ? malloc(m->n * nfeatures * sizeof *m->x + 1) : NULL;
    m->classes = malloc(m->n + 1);
    return m->x != NULL && m->classes != NULL ? SG_OK : SG_FAIL_NOMEM(err);
}

sg_status sg_pixel_sample_draw(const sg_dataset *d, const sg_pixel_census *c, const uint64_t *quotas,
                               const sg_pixel_sample_opts *opts, sg_sample_matrix *out, sg_error *err)
{
    sg_sample_matrix m = {0};
    drawing w = {c, quotas, opts->seed, calloc(c->nitems + 1, sizeof *w.first),
                 calloc(c->nitems * c->nclasses + 1, sizeof *w.of_item), &m};
    sg_status st = w.first != NULL && w.of_item != NULL ? SG_OK : SG_FAIL_NOMEM(err);
    if (st == SG_OK) {
        share_quotas(&w);
        st = make_matrix(&w, sg_feature_set_count(&opts->features), err);
    }
    if (st == SG_OK)
        st = sg_pixel_photos_each(d, opts, "features", draw_item, &w, err);
    free(w.first);
    free(w.of_item);
    if (st == SG_OK) {
        *out = m;
        return st;
    }
    free(m.x);
    free(m.classes);
    return st;
}
