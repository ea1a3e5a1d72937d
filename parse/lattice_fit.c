/* SPDX-License-Identifier: GPL-3.0-or-later */
/* lattice_fit.c - alternating exact choice of columns and rows (MATHEMATICS B2, step 2). */
#include "parse/lattice_fit.h"

#include "image/classes.h"
#include "parse/lattice_fit_priv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_TABLE_FLOATS = 1 << 26, MAX_STEPS = 100 };

static sg_status check_source(const sg_lattice_source *s, sg_error *err)
{
    if (s->width == 0 || s->height == 0 || s->width > SG_IMAGE_MAX_SIDE || s->height > SG_IMAGE_MAX_SIDE ||
        s->width * s->height > SG_IMAGE_MAX_PIXELS)
        return SG_FAIL(err, SG_EINVAL, "a map of %zu x %zu pixels cannot be made a lattice", s->width, s->height);
    if (s->nclasses == 0 || s->nclasses > SG_MAX_CLASSES)
        return SG_FAIL(err, SG_EINVAL, "%zu classes: expected 1 to %d", s->nclasses, SG_MAX_CLASSES);
    size_t counted = 0;
    for (size_t i = 0; i < s->width * s->height; i++) {
        if (s->labels[i] >= s->nclasses && s->labels[i] != SG_CLASS_IGNORE)
            return SG_FAIL(err, SG_EINVAL, "label %d at pixel %zu, %zu is not among the %zu classes", s->labels[i],
                           i % s->width, i / s->width, s->nclasses);
        counted += s->labels[i] != SG_CLASS_IGNORE;
    }
    if (counted == 0)
        return SG_FAIL(err, SG_EINPUT, "every pixel is ignored: there is nothing to make a lattice of");
    for (size_t i = 0; s->costs != NULL && i < s->nclasses * s->width * s->height; i++)
        if (!(s->costs[i] >= 0 && isfinite(s->costs[i])))
            return SG_FAIL(err, SG_EINVAL, "a cost is negative or not finite");
    return SG_OK;
}

/* Labels renumbered so that the classes that occur come first and no table has room for the others. Costs keep all. */
static void renumber(sg_lattice_problem *p, uint8_t *labels)
{
    const sg_lattice_source *s = &p->source;
    const size_t n = s->width * s->height;
    bool occurs[256] = {false};
    uint8_t number[256] = {0};
    for (size_t i = 0; i < n; i++)
        occurs[s->labels[i]] = true;
    for (size_t c = 0; c < s->nclasses; c++)
        if (occurs[c])
            number[c] = (uint8_t)p->noccurring++;
    number[SG_CLASS_IGNORE] = SG_CLASS_IGNORE;
    for (size_t i = 0; i < n; i++) {
        labels[i] = s->costs != NULL ? s->labels[i] : number[s->labels[i]];
        p->counted_px += labels[i] != SG_CLASS_IGNORE;
    }
}

static void transpose_labels(const uint8_t *in, size_t width, size_t height, uint8_t *out)
{
    for (size_t y = 0; y < height; y++)
        for (size_t x = 0; x < width; x++)
            out[x * height + y] = in[y * width + x];
}

static void transpose_costs(const float *in, size_t width, size_t height, float *out)
{
    for (size_t y = 0; y < height; y++)
        for (size_t x = 0; x < width; x++)
            out[x * height + y] = in[y * width + x];
}

static sg_status make_axes(sg_lattice_problem *p, sg_error *err)
{
    const sg_lattice_source *s = &p->source;
    const size_t n = s->width * s->height;
    uint8_t *labels = sg_arena_alloc(p->arena, n), *turned = sg_arena_alloc(p->arena, n);
    float *costs = s->costs != NULL ? SG_NEW_ARRAY(p->arena, float, n * s->nclasses) : NULL;
    if (labels == NULL || turned == NULL || (s->costs != NULL && costs == NULL))
        return SG_FAIL_NOMEM(err);
    renumber(p, labels);
    transpose_labels(labels, s->width, s->height, turned);
    for (size_t c = 0; costs != NULL && c < s->nclasses; c++)
        transpose_costs(s->costs + c * n, s->width, s->height, costs + c * n);
    const size_t nclasses = s->costs != NULL ? s->nclasses : p->noccurring;
    p->axis[0] = (sg_axis){s->width, s->height, nclasses, labels, s->costs};
    p->axis[1] = (sg_axis){s->height, s->width, nclasses, turned, costs};
    return SG_OK;
}

/* No table of sums grows beyond MAX_TABLE_FLOATS: the longer axis gives way first. */
static void limit_places(const sg_lattice_problem *p, size_t limit[2])
{
    const size_t room = MAX_TABLE_FLOATS / p->axis[0].nclasses;
    for (int d = 0; d < 2; d++)
        limit[d] = p->opts.max_places < p->axis[d].length + 1 ? p->opts.max_places : p->axis[d].length + 1;
    while (limit[0] * (limit[1] + 8) > room || limit[1] * (limit[0] + 8) > room)
        limit[limit[1] > limit[0]]--;
}

static sg_status make_places(sg_lattice_problem *p, sg_error *err)
{
    size_t limit[2];
    limit_places(p, limit);
    for (int d = 0; d < 2; d++) {
        sg_candidate_opts o = {p->opts.persistence, p->opts.min_run, p->opts.max_candidates};
        o.max_places = o.max_places < limit[d] ? o.max_places : limit[d];
        SG_TRY(sg_axis_knots(&p->axis[d], limit[d], p->arena, &p->knots[d], err));
        if (p->knots[d].n <= o.max_places)
            p->candidates[d] = p->knots[d]; /* few enough to leave none out */
        else
            SG_TRY(sg_axis_candidates(&p->axis[d], &o, &p->knots[d], p->arena, &p->candidates[d], err));
    }
    for (int d = 0; d < 2; d++) {
        p->cuts[d].at = SG_NEW_ARRAY(p->arena, uint32_t, p->axis[d].length + 1);
        p->best[d].at = SG_NEW_ARRAY(p->arena, uint32_t, p->axis[d].length + 1);
        if (p->cuts[d].at == NULL || p->best[d].at == NULL)
            return SG_FAIL_NOMEM(err);
        const sg_places *strips = &p->knots[1 - d];
        SG_TRY(sg_strip_table_create(&p->axis[d], &p->knots[d], strips, p->arena, &p->base[d], err));
        if (p->candidates[d].at == p->knots[d].at)
            p->first[d] = p->base[d];
        else
            SG_TRY(sg_strip_table_coarsen(&p->base[d], strips, &p->candidates[d], strips, p->arena, &p->first[d], err));
    }
    return SG_OK;
}

sg_status sg_lattice_problem_create(const sg_lattice_source *source, const sg_lattice_fit_opts *opts,
                                    sg_lattice_problem **out, sg_error *err)
{
    if (opts->max_places < 2 || opts->max_candidates < 2 || opts->max_places > SG_LATTICE_MAX_SIDE ||
        opts->max_candidates > SG_LATTICE_MAX_SIDE || opts->starts < 1 || opts->starts > 4)
        return SG_FAIL(err, SG_EINVAL, "fitting takes 2 to %d places and 1 to 4 starts", SG_LATTICE_MAX_SIDE);
    SG_TRY(check_source(source, err));
    sg_lattice_problem *p = calloc(1, sizeof *p);
    if (p == NULL)
        return SG_FAIL_NOMEM(err);
    p->source = *source;
    p->opts = *opts;
    p->arena = sg_arena_create();
    p->scratch = sg_arena_create();
    sg_status st = p->arena != NULL && p->scratch != NULL ? make_axes(p, err) : SG_FAIL_NOMEM(err);
    if (st == SG_OK)
        st = make_places(p, err);
    if (st != SG_OK) {
        sg_lattice_problem_free(p);
        return st;
    }
    *out = p;
    return SG_OK;
}

void sg_lattice_problem_free(sg_lattice_problem *p)
{
    if (p == NULL)
        return;
    sg_arena_free(p->arena);
    sg_arena_free(p->scratch);
    free(p);
}

static void copy_places(const sg_places *from, sg_places *to)
{
    memcpy(to->at, from->at, from->n * sizeof *from->at);
    to->n = from->n;
}

static double line_price(const sg_lattice_weights *w, int d)
{
    return d == 0 ? w->per_column : w->per_row;
}

/* The first lines of axis d: every different pixel row across is a strip; how many lines the other axis will have is a guess. */
static sg_status cut_first(sg_lattice_problem *p, const sg_lattice_weights *w, int d, double scale, sg_error *err)
{
    const double others = 0.5 * (double)(p->candidates[1 - d].n - 1);
    sg_places places;
    double value;
    SG_TRY(sg_cuts_solve(&p->first[d], scale * (line_price(w, d) + w->per_cell * others), p->scratch, &places, &value,
                         err));
    copy_places(&places, &p->cuts[d]);
    return SG_OK;
}

/* Exact lines of axis d given those of the other: replaced if the energy falls below `energy`. */
static sg_status cut_again(sg_lattice_problem *p, const sg_lattice_weights *w, int d, double *energy, sg_error *err)
{
    const double others = (double)(p->cuts[1 - d].n - 1);
    sg_strip_table table;
    sg_places places;
    double value;
    SG_TRY(sg_strip_table_coarsen(&p->base[d], &p->knots[1 - d], &p->knots[d], &p->cuts[1 - d], p->scratch, &table, err));
    SG_TRY(sg_cuts_solve(&table, line_price(w, d) + w->per_cell * others, p->scratch, &places, &value, err));
    const double base = p->source.costs != NULL ? 0 : (double)p->counted_px;
    const double found = base - value + line_price(w, 1 - d) * others;
    if (found < *energy - 1e-9 * fabs(*energy) || *energy == INFINITY) {
        copy_places(&places, &p->cuts[d]);
        *energy = found;
    }
    return SG_OK;
}

/* From one start to a fixed point. */
static sg_status descend(sg_lattice_problem *p, const sg_lattice_weights *w, int d, double scale, double *trace,
                         size_t *nsteps, sg_error *err)
{
    double energy = INFINITY;
    *nsteps = 0;
    sg_status st = cut_first(p, w, d, scale, err);
    for (bool fell = true; st == SG_OK && fell && *nsteps < MAX_STEPS; d = 1 - d) {
        const sg_mark mark = sg_arena_mark(p->scratch);
        const double before = energy;
        st = cut_again(p, w, 1 - d, &energy, err);
        fell = energy < before;
        if (fell)
            trace[(*nsteps)++] = energy;
        sg_arena_rewind(p->scratch, mark);
    }
    return st;
}

/* The best of all starts is left in p->best. */
static sg_status descend_all(sg_lattice_problem *p, const sg_lattice_weights *w, size_t nstarts, double *trace,
                             size_t *nsteps, sg_error *err)
{
    static const double scales[] = {1, 1, 0.4, 0.4};
    double lowest = INFINITY, steps[MAX_STEPS];
    for (size_t start = 0; start < nstarts; start++) {
        size_t n;
        const sg_mark mark = sg_arena_mark(p->scratch);
        const sg_status st = descend(p, w, start % 2, scales[start], steps, &n, err);
        sg_arena_rewind(p->scratch, mark);
        SG_TRY(st);
        if (steps[n - 1] < lowest) {
            lowest = steps[n - 1];
            memcpy(trace, steps, n * sizeof *trace);
            *nsteps = n;
            for (int d = 0; d < 2; d++)
                copy_places(&p->cuts[d], &p->best[d]);
        }
    }
    return SG_OK;
}

sg_status sg_lattice_fit_starts(sg_lattice_problem *p, const sg_lattice_weights *w, size_t nstarts, sg_arena *arena,
                                sg_lattice_fit *out, sg_error *err)
{
    double trace[MAX_STEPS];
    sg_lattice_fit f = {.weights = *w};
    SG_TRY(descend_all(p, w, nstarts, trace, &f.nsteps, err));
    f.width = p->best[0].n - 1;
    f.height = p->best[1].n - 1;
    f.x = sg_arena_copy(arena, p->best[0].at, (f.width + 1) * sizeof *f.x);
    f.y = sg_arena_copy(arena, p->best[1].at, (f.height + 1) * sizeof *f.y);
    f.trace = sg_arena_copy(arena, trace, f.nsteps * sizeof *trace);
    f.classes = sg_arena_alloc(arena, f.width * f.height);
    if (f.x == NULL || f.y == NULL || f.trace == NULL || f.classes == NULL)
        return SG_FAIL_NOMEM(err);
    const sg_mark mark = sg_arena_mark(p->scratch);
    const sg_status st = sg_lattice_vote(&p->source, p->scratch, &f, err);
    sg_arena_rewind(p->scratch, mark);
    SG_TRY(st);
    f.energy = f.loss + w->per_column * (double)f.width + w->per_row * (double)f.height +
               w->per_cell * (double)(f.width * f.height);
    *out = f;
    return SG_OK;
}

static bool is_price(double v)
{
    return v >= 0 && isfinite(v);
}

sg_status sg_lattice_fit_weights(sg_lattice_problem *p, const sg_lattice_weights *weights, sg_arena *arena,
                                 sg_lattice_fit *out, sg_error *err)
{
    if (!is_price(weights->per_column) || !is_price(weights->per_row) || !is_price(weights->per_cell))
        return SG_FAIL(err, SG_EINVAL, "the prices of lines and cells must be finite and not negative");
    return sg_lattice_fit_starts(p, weights, p->opts.starts, arena, out, err);
}
