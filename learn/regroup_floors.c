/* SPDX-License-Identifier: GPL-3.0-or-later */
/* regroup_floors.c - the partition of a lattice's rows into bands that is shortest to describe.
 * A band of rows is one split-x of columns, and each distinct column that has more than one label is one split-y. Its cost
 * is the description length of these rules once runs are collapsed (DESIGN 5.2), plus its place in the axiom's rule. So
 * the storeys of a facade, whose windows and balconies stand in the same columns, become one band, while the ground floor
 * with columns of its own stays apart. Exact, by dynamic programming over the rows. */
#include "learn/regroup_priv.h"

#include "grammar/grammar.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

/* For the price of a symbol: log of the non-terminals of a typical initial grammar (about 200). Half or twice as many
 * change the 1469 rules of the initial grammar of all 104 ECP facades to 1477 or 1463. */
static const double TYPICAL_LOG_SYMBOLS = 5.3;
static const double MEAN_LENGTH = 2; /* of the Poisson prior over lengths */

/* Description length of a rule of n symbols, nats. */
static double rule_length(size_t n)
{
    const double k = (double)n - 1;
    return (double)n * TYPICAL_LOG_SYMBOLS + MEAN_LENGTH - k * log(MEAN_LENGTH) + lgamma(k + 1);
}

/* The columns of the band of rows y..end-1, by kind: two columns of one kind are equal. Kinds are numbered by their first
 * column. One more row on top splits kinds: that is all the work, so that noise of any size is grouped in a moment. */
typedef struct {
    const uint32_t *t;
    size_t width;
    uint32_t *kind;             /* [width] of a column */
    uint32_t *label, *next;     /* [width] of a kind: its top label, another kind split from the same one */
    uint32_t *runs, *old_runs;  /* [width] of a kind: runs of equal labels in a column; before the last row came */
    uint32_t *first_part;       /* [width] of an old kind: a kind split from it, SG_NONE: none yet */
} band;

static bool band_create(band *b, sg_arena *arena)
{
    uint32_t **const arrays[] = {&b->kind, &b->label, &b->next, &b->runs, &b->old_runs, &b->first_part};
    for (size_t i = 0; i < sizeof arrays / sizeof arrays[0]; i++)
        if ((*arrays[i] = SG_NEW_ARRAY(arena, uint32_t, b->width)) == NULL)
            return false;
    return true;
}

/* The part of an old kind that has this label on top; n is its number when it is new. */
static uint32_t find_part(const band *b, uint32_t old, uint32_t label, uint32_t n)
{
    for (uint32_t k = b->first_part[old]; k != SG_NONE; k = b->next[k])
        if (b->label[k] == label)
            return k;
    return n;
}

/* Description length of rows y..end-1 as a band, from what is known of rows y+1..end-1. */
static double add_row(band *b, size_t y, size_t end)
{
    const uint32_t *top = b->t + y * b->width;
    size_t runs = 0;
    uint32_t n = 0, left = SG_NONE;
    double columns = 0;
    uint32_t *swap = b->runs;
    b->runs = b->old_runs;
    b->old_runs = swap;
    for (size_t x = 0; x < b->width; x++)
        b->first_part[x] = SG_NONE;
    for (size_t x = 0; x < b->width; x++) {
        const uint32_t old = y + 1 < end ? b->kind[x] : 0, kind = find_part(b, old, top[x], n);
        if (kind == n) {
            b->label[n] = top[x];
            b->next[n] = b->first_part[old];
            b->first_part[old] = n;
            b->runs[n] = y + 1 < end ? b->old_runs[old] + (top[x] != top[x + b->width]) : 1;
            columns += b->runs[n] > 1 ? rule_length(b->runs[n]) : 0;
            n++;
        }
        b->kind[x] = kind;
        runs += kind != left;
        left = kind;
    }
    return TYPICAL_LOG_SYMBOLS + rule_length(runs) + columns;
}

sg_status sg_regroup_floors(const uint32_t *t, size_t width, size_t height, sg_arena *arena, size_t *first,
                            size_t *ngroups)
{
    band b = {.t = t, .width = width};
    double *best = SG_NEW_ARRAY(arena, double, height + 1);
    size_t *from = SG_NEW_ARRAY(arena, size_t, height + 1);
    if (!band_create(&b, arena) || best == NULL || from == NULL)
        return SG_ENOMEM;
    for (size_t end = 1; end <= height; end++) {
        best[end] = INFINITY;
        for (size_t start = end; start-- > 0;) { /* ties: the smaller band */
            const double cost = best[start] + add_row(&b, start, end);
            if (cost < best[end]) {
                best[end] = cost;
                from[end] = start;
            }
        }
    }
    size_t n = 0;
    for (size_t end = height; end > 0; end = from[end])
        n++;
    *ngroups = n;
    first[n] = height;
    for (size_t end = height; end > 0; end = from[end])
        first[--n] = from[end];
    return SG_OK;
}
