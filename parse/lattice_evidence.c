/* SPDX-License-Identifier: GPL-3.0-or-later */
/* lattice_evidence.c - where lines may stand: indicator evidence, topological persistence, straight runs (MATHEMATICS B2,
 * step 1). Labels are compared for equality only, so their numbering has no influence. */
#include "parse/lattice_priv.h"

#include "image/classes.h"

#include <stdlib.h>
#include <string.h>

/* Changes of label along one pixel row; `open` are the runs that reach this row. */
static void add_row_evidence(const uint8_t *label, size_t length, uint32_t *open, uint32_t *profile, uint32_t *run)
{
    uint8_t last = SG_CLASS_IGNORE;
    for (size_t p = 0; p < length; p++) {
        const bool change = label[p] != SG_CLASS_IGNORE && last != SG_CLASS_IGNORE && label[p] != last;
        if (label[p] != SG_CLASS_IGNORE)
            last = label[p];
        open[p] = change ? open[p] + 1 : 0;
        profile[p] += change;
        if (open[p] > run[p])
            run[p] = open[p];
    }
}

sg_status sg_axis_evidence(const sg_axis *a, sg_arena *scratch, uint32_t *profile, uint32_t *run, sg_error *err)
{
    uint32_t *open = SG_NEW_ARRAY(scratch, uint32_t, a->length);
    if (open == NULL)
        return SG_FAIL_NOMEM(err);
    memset(profile, 0, (a->length + 1) * sizeof *profile);
    memset(run, 0, (a->length + 1) * sizeof *run);
    for (size_t row = 0; row < a->breadth; row++)
        add_row_evidence(a->labels + row * a->length, a->length, open, profile, run);
    return SG_OK;
}

typedef struct {
    uint32_t value;
    uint32_t place;
} ranked;

static int higher_first(const void *a, const void *b)
{
    const ranked *p = a, *q = b;
    if (p->value != q->value)
        return p->value < q->value ? 1 : -1;
    return p->place < q->place ? -1 : p->place > q->place;
}

static ranked *rank_places(const uint32_t *value, size_t n, sg_arena *scratch)
{
    ranked *order = SG_NEW_ARRAY(scratch, ranked, n);
    if (order == NULL)
        return NULL;
    for (size_t i = 0; i < n; i++)
        order[i] = (ranked){value[i], (uint32_t)i};
    qsort(order, n, sizeof *order, higher_first);
    return order;
}

static uint32_t find_root(uint32_t *parent, uint32_t i)
{
    while (parent[i] != i)
        i = parent[i] = parent[parent[i]];
    return i;
}

/* Joins the hills left and right of p; the lower one ends here. A hill's root is its summit. */
static void join_hills(const uint32_t *value, uint32_t *parent, uint32_t p, uint32_t q, uint32_t *persistence)
{
    const uint32_t a = find_root(parent, p), b = find_root(parent, q);
    if (a == b)
        return;
    const bool keep_a = value[a] > value[b] || (value[a] == value[b] && a < b);
    const uint32_t summit = keep_a ? a : b, lower = keep_a ? b : a;
    persistence[lower] = value[lower] - value[p];
    parent[lower] = summit;
}

sg_status sg_persistence(const uint32_t *value, size_t n, sg_arena *scratch, uint32_t *persistence, sg_error *err)
{
    const ranked *order = rank_places(value, n, scratch);
    uint32_t *parent = SG_NEW_ARRAY(scratch, uint32_t, n);
    bool *risen = SG_NEW_ARRAY(scratch, bool, n);
    if (order == NULL || parent == NULL || risen == NULL)
        return SG_FAIL_NOMEM(err);
    memset(persistence, 0, n * sizeof *persistence);
    for (size_t k = 0; k < n; k++) { /* the water falls; places rise from it, the highest first */
        const uint32_t p = order[k].place;
        parent[p] = p;
        risen[p] = true;
        if (p > 0 && risen[p - 1])
            join_hills(value, parent, p, p - 1, persistence);
        if (p + 1 < n && risen[p + 1])
            join_hills(value, parent, p, p + 1, persistence);
    }
    if (n > 0)
        persistence[order[0].place] = value[order[0].place] - value[order[n - 1].place];
    return SG_OK;
}

/* Places with a strength above 0, the strongest ones if there are more than max_places, and both ends. */
static sg_status collect_places(const uint32_t *strength, size_t length, size_t max_places, sg_arena *arena,
                                sg_places *out, sg_error *err)
{
    sg_mark mark = sg_arena_mark(arena);
    bool *chosen = malloc((length + 1) * sizeof *chosen);
    const ranked *order = rank_places(strength, length + 1, arena);
    if (chosen == NULL || order == NULL) {
        free(chosen);
        return SG_FAIL_NOMEM(err);
    }
    memset(chosen, 0, (length + 1) * sizeof *chosen);
    chosen[0] = chosen[length] = true;
    size_t n = 2;
    for (size_t k = 0; k <= length && n < max_places && order[k].value > 0; k++)
        if (!chosen[order[k].place]) {
            chosen[order[k].place] = true;
            n++;
        }
    sg_arena_rewind(arena, mark);
    *out = (sg_places){0, SG_NEW_ARRAY(arena, uint32_t, n)};
    for (size_t p = 0; p <= length && out->at != NULL; p++)
        if (chosen[p])
            out->at[out->n++] = (uint32_t)p;
    free(chosen);
    return out->at != NULL ? SG_OK : SG_FAIL_NOMEM(err);
}

/* The sharpest place within one pixel of a maximum of the smoothed profile. */
static size_t sharpest(const uint32_t *profile, size_t length, size_t p)
{
    size_t best = p;
    for (size_t q = p > 1 ? p - 1 : 1; q <= p + 1 && q < length; q++)
        if (profile[q] > profile[best])
            best = q;
    return best;
}

/* Strength of each place as a candidate; 0: none. */
static sg_status rate_candidates(const sg_axis *a, const sg_candidate_opts *opts, sg_arena *scratch,
                                 uint32_t *strength, sg_error *err)
{
    const size_t n = a->length + 1;
    uint32_t *profile = SG_NEW_ARRAY(scratch, uint32_t, n), *run = SG_NEW_ARRAY(scratch, uint32_t, n);
    uint32_t *box = SG_NEW_ARRAY(scratch, uint32_t, n), *persistence = SG_NEW_ARRAY(scratch, uint32_t, n);
    if (profile == NULL || run == NULL || box == NULL || persistence == NULL)
        return SG_FAIL_NOMEM(err);
    SG_TRY(sg_axis_evidence(a, scratch, profile, run, err));
    for (size_t p = 1; p + 1 < n; p++)
        box[p] = profile[p - 1] + profile[p] + profile[p + 1];
    SG_TRY(sg_persistence(box, n, scratch, persistence, err));
    for (size_t p = 1; p + 1 < n; p++) {
        if (run[p] >= opts->min_run && run[p] > strength[p])
            strength[p] = run[p];
        const size_t q = sharpest(profile, a->length, p);
        if (persistence[p] > 0 && persistence[p] >= opts->persistence * (double)a->breadth &&
            persistence[p] > strength[q])
            strength[q] = persistence[p];
    }
    return SG_OK;
}

/* Strength 0 for all places but those. */
static void keep_only(const sg_places *among, size_t length, uint32_t *strength)
{
    size_t k = 0;
    for (size_t p = 0; p <= length; p++) {
        if (k < among->n && among->at[k] == p)
            k++;
        else
            strength[p] = 0;
    }
}

sg_status sg_axis_candidates(const sg_axis *a, const sg_candidate_opts *opts, const sg_places *among, sg_arena *arena,
                             sg_places *out, sg_error *err)
{
    sg_arena *scratch = sg_arena_create();
    if (scratch == NULL)
        return SG_FAIL_NOMEM(err);
    uint32_t *strength = SG_NEW_ARRAY(scratch, uint32_t, a->length + 1);
    sg_status st = strength != NULL ? SG_OK : SG_FAIL_NOMEM(err);
    if (st == SG_OK)
        st = rate_candidates(a, opts, scratch, strength, err);
    if (st == SG_OK && among != NULL)
        keep_only(among, a->length, strength);
    if (st == SG_OK)
        st = collect_places(strength, a->length, opts->max_places, arena, out, err);
    sg_arena_free(scratch);
    return st;
}

/* Number of rows in which the pixels on both sides differ, ignored ones too. */
static void count_differences(const sg_axis *a, uint32_t *count)
{
    for (size_t row = 0; row < a->breadth; row++) {
        const uint8_t *label = a->labels + row * a->length;
        for (size_t p = 1; p < a->length; p++)
            count[p] += label[p] != label[p - 1];
    }
}

sg_status sg_axis_knots(const sg_axis *a, size_t max_places, sg_arena *arena, sg_places *out, sg_error *err)
{
    uint32_t *count = calloc(a->length + 1, sizeof *count);
    if (count == NULL)
        return SG_FAIL_NOMEM(err);
    count_differences(a, count);
    for (size_t p = 1; p < a->length && a->costs != NULL; p++)
        count[p]++;
    const sg_status st = collect_places(count, a->length, max_places, arena, out, err);
    free(count);
    return st;
}
