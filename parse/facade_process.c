/* SPDX-License-Identifier: GPL-3.0-or-later */
/* facade_process.c - a photograph is read, parsed and written, and all of its memory let go, before the next one's turn. */
#include "config.h"

#include "parse/facade_process.h"

#include "core/file.h"
#include "image/cv_image.h"
#include "image/png_io.h"
#include "parse/unaries.h"

#include <math.h>
#include <string.h>
#include <time.h>

/* The pieces of one photograph, freed together. */
typedef struct {
    const sg_facade_setup *setup;
    const sg_facade_photo *photo;
    sg_image image;
    sg_float_map unaries; /* probabilities, then costs */
    sg_label_map map;     /* most probable class of each pixel, as values of the class table */
    sg_label_map truth;   /* classes of the truth */
    sg_facade_parse parse;
} work;

static double now_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* The path that a sentence is about comes first in it. */
static sg_status about(const char *path, sg_status st, sg_error *err)
{
    if (st == SG_OK || err == NULL)
        return st;
    const sg_error inner = *err;
    return SG_FAIL(err, st, "%s: %.900s", path, inner.msg);
}

/* ---- unaries ---- */

static sg_status read_probabilities(work *w, sg_error *err)
{
    const char *path = w->photo->probabilities, *slash = strrchr(path, '/');
    char folder[4096];
    const int n = snprintf(folder, sizeof folder, "%.*s", slash != NULL ? (int)(slash - path) : 1, slash != NULL ? path : ".");
    if (n < 0 || (size_t)n >= sizeof folder)
        return SG_FAIL(err, SG_EINPUT, "%.200s...: the path is too long", path);
    SG_TRY(sg_unaries_read(folder, w->photo->name, w->setup->classes->nclasses, w->setup->floor, &w->unaries, err));
    if (w->image.rgb != NULL && (w->image.width != w->unaries.width || w->image.height != w->unaries.height))
        return SG_FAIL(err, SG_EINPUT, "%s: %zu x %zu pixels, but %s has %zu x %zu", path, w->unaries.width,
                       w->unaries.height, w->photo->image, w->image.width, w->image.height);
    return SG_OK;
}

static sg_status classify(work *w, sg_error *err)
{
    const sg_facade_setup *s = w->setup;
    SG_TRY(about(w->photo->image, sg_pixel_classifier_apply(s->classifier, &w->image, s->threads, &w->unaries, err), err));
    return sg_unaries_lift(&w->unaries, s->floor, err);
}

static sg_status find_map(work *w, sg_error *err)
{
    SG_TRY(sg_unaries_map(&w->unaries, &w->map, err));
    for (size_t i = 0; i < w->map.width * w->map.height; i++)
        w->map.labels[i] = w->setup->classes->first_index[w->map.labels[i]];
    return SG_OK;
}

static sg_status make_costs(work *w, sg_facade_outcome *out, sg_error *err)
{
    const double begin = now_s();
    if (w->photo->image != NULL)
        SG_TRY(sg_photo_read(w->photo->image, &w->image, err));
    SG_TRY(w->setup->classifier != NULL ? classify(w, err) : read_probabilities(w, err));
    if (w->photo->truth != NULL)
        SG_TRY(find_map(w, err));
    if (w->setup->hard > 0)
        SG_TRY(sg_unaries_harden(&w->unaries, w->setup->hard, err));
    sg_unaries_to_costs(&w->unaries);
    out->width = w->unaries.width;
    out->height = w->unaries.height;
    out->unary_seconds = now_s() - begin;
    return SG_OK;
}

/* ---- truth ---- */

static sg_status read_truth(work *w, sg_error *err)
{
    const char *path = w->photo->truth;
    const sg_classes *classes = w->setup->truth_classes;
    SG_TRY(sg_png_read_labels(path, &w->truth, err));
    sg_label_map *m = &w->truth;
    if (m->width != w->unaries.width || m->height != w->unaries.height)
        return SG_FAIL(err, SG_EINPUT, "%s: %zu x %zu pixels, but the photograph has %zu x %zu", path, m->width, m->height,
                       w->unaries.width, w->unaries.height);
    for (size_t i = 0; i < m->width * m->height; i++) {
        const uint8_t class = classes->class_of[m->labels[i]];
        if (class == SG_CLASS_UNKNOWN)
            return SG_FAIL(err, SG_EINPUT, "%s: label %u is not in the class table (the first at column %zu, row %zu)", path,
                           (unsigned)m->labels[i], i % m->width, i / m->width);
        m->labels[i] = class;
    }
    return SG_OK;
}

double sg_confusion_accuracy(const sg_confusion *c)
{
    uint64_t right = 0, all = 0;
    for (size_t k = 0; k < c->nclasses; k++) {
        right += c->counts[k * (c->nclasses + 1) + k];
        all += sg_confusion_pixels(c, k);
    }
    return all > 0 ? (double)right / (double)all : NAN;
}

static sg_facade_report report_of(const work *w, sg_facade_stage stage)
{
    const sg_facade_setup *s = w->setup;
    return (sg_facade_report){s->folder,  w->photo->name,   w->image.rgb != NULL ? &w->image : NULL, s->g, s->classes,
                              s->channel, w->unaries.width, w->unaries.height, &w->parse, stage};
}

static sg_status score_stage(const work *w, sg_facade_stage stage, sg_confusion *c, sg_error *err)
{
    sg_label_map map;
    const sg_facade_report report = report_of(w, stage);
    SG_TRY(sg_facade_label_map(&report, &map, err));
    const sg_status st = sg_confusion_add(c, &w->truth, &map, w->setup->truth_of, err);
    sg_label_map_clear(&map);
    return st;
}

static sg_status score_all(work *w, sg_arena *arena, sg_facade_outcome *out, sg_error *err)
{
    const size_t n = w->setup->truth_classes->nclasses;
    SG_TRY(sg_confusion_create(n, arena, &out->map, err));
    SG_TRY(sg_confusion_add(&out->map, &w->truth, &w->map, w->setup->truth_of, err));
    for (int s = 0; s < SG_FACADE_STAGES; s++) {
        sg_confusion c;
        if (!w->parse.results[s].done)
            continue;
        SG_TRY(sg_confusion_create(n, arena, &c, err));
        SG_TRY(score_stage(w, (sg_facade_stage)s, &c, err));
        out->stages[s].accuracy = sg_confusion_accuracy(&c);
        if (s == (int)w->parse.best)
            out->found = c;
    }
    out->scored = true;
    return SG_OK;
}

/* ---- outcome ---- */

static sg_status note_search(const sg_metropolis_result *r, sg_arena *arena, sg_facade_outcome *out, sg_error *err)
{
    out->searched = true;
    out->moves = r->moves;
    out->search_seconds = r->seconds;
    out->swaps_proposed = r->swaps_proposed;
    out->swaps_accepted = r->swaps_accepted;
    out->stats = r->stats;
    out->nruns = r->nruns;
    out->best_run = r->best_run;
    out->run_energies = SG_NEW_ARRAY(arena, double, r->nruns + 1);
    if (out->run_energies == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t i = 0; i < r->nruns; i++)
        out->run_energies[i] = 0 - sg_posterior_log(&r->run_best[i]);
    return SG_OK;
}

static sg_status note_parse(const sg_facade_parse *p, sg_arena *arena, sg_facade_outcome *out, sg_error *err)
{
    out->best = p->best;
    out->nsamples = p->samples.nsamples;
    out->columns = p->columns;
    out->rows = p->rows;
    out->states = p->states;
    out->energy_lattice = p->energy_lattice;
    for (int s = 0; s < SG_FACADE_STAGES; s++) {
        const sg_facade_result *r = &p->results[s];
        out->stages[s] = (sg_facade_stage_outcome){r->done, r->energy, r->seconds, NAN};
        out->seconds += r->seconds;
    }
    return p->searched ? note_search(&p->search, arena, out, err) : SG_OK;
}

/* ---- all ---- */

/* SG_STOPPED goes on: what was found is scored and written. */
static sg_status parse(work *w, sg_progress *progress, sg_facade_outcome *out, sg_arena *arena, sg_error *err)
{
    sg_facade_opts opts = w->setup->opts;
    opts.search.seed = sg_facade_seed(opts.search.seed, w->photo->name);
    const sg_status st = sg_facade_run(w->setup->g, &w->unaries, w->setup->channel, &opts, progress, &w->parse, err);
    if (st != SG_OK && st != SG_STOPPED)
        return about(w->photo->name, st, err);
    if (!w->parse.results[w->parse.best].done) /* stopped before there was anything */
        return st;
    SG_TRY(note_parse(&w->parse, arena, out, err));
    if (w->photo->truth != NULL)
        SG_TRY(score_all(w, arena, out, err));
    const sg_facade_report report = report_of(w, w->parse.best);
    SG_TRY(sg_facade_write(&report, w->setup->formats, err));
    return st;
}

/* Each of its results can have its name. */
static sg_status check_name(const work *w, sg_error *err)
{
    for (int k = 0; k < SG_FACADE_FORMATS; k++)
        if ((w->setup->formats >> k & 1) && !sg_file_name_fits(w->setup->folder, w->photo->name, sg_facade_format_ending(k)))
            return SG_FAIL(err, SG_EINPUT, "%.700s: the name is too long for its results", w->photo->name);
    return SG_OK;
}

static sg_status process(work *w, sg_progress *progress, sg_facade_outcome *out, sg_arena *arena, sg_error *err)
{
    SG_TRY(check_name(w, err));
    SG_TRY(make_costs(w, out, err));
    if (w->photo->truth != NULL)
        SG_TRY(read_truth(w, err));
    return parse(w, progress, out, arena, err);
}

sg_status sg_facade_process(const sg_facade_setup *setup, const sg_facade_photo *photo, sg_progress *progress,
                            sg_arena *arena, sg_facade_outcome *out)
{
    work w = {.setup = setup, .photo = photo};
    memset(out, 0, sizeof *out);
    out->status = process(&w, progress, out, arena, &out->error);
    if (out->status == SG_ENOMEM)
        SG_FAIL(&out->error, SG_ENOMEM, "%.900s: there is not enough memory for it",
                photo->image != NULL ? photo->image : photo->probabilities);
    sg_facade_parse_clear(&w.parse);
    sg_label_map_clear(&w.truth);
    sg_label_map_clear(&w.map);
    sg_float_map_clear(&w.unaries);
    sg_image_clear(&w.image);
    return out->status;
}
