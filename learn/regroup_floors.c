/* SPDX-License-Identifier: GPL-3.0-or-later */
/* regroup_floors.c - the partition of a lattice's rows into bands that is shortest to describe.
 * A band of rows is one split-x of columns, and each distinct column that has more than one label is one split-y. Its cost
 * is the description length of these rules once runs are collapsed (DESIGN 5.2), plus its place in the axiom's rule. So
 * the storeys of a facade, whose windows and balconies stand in the same columns, become one band, while the ground floor
 * with columns of its own stays apart. Exact, by dynamic programming over the rows. */
#include "learn/regroup_priv.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

/* Non-terminals of a typical grammar, for the price of a symbol; a factor of two in it moves no band on real facades. */
static const double TYPICAL_LOG_SYMBOLS = 5.3;
static const double MEAN_LENGTH = 2; /* of the Poisson prior over lengths */

/* Description length of a rule of n symbols, nats. */
static double rule_length(size_t n)
{
    const double k = (double)n - 1;
    return (double)n * TYPICAL_LOG_SYMBOLS + MEAN_LENGTH - k * log(MEAN_LENGTH) + lgamma(k + 1);
}

typedef struct {
    const uint32_t *t;
    size_t width, height;
    uint32_t *distinct; /* [width] one column of each kind met */
} band;

static bool equal_columns(const band *b, size_t x, size_t other, size_t y0, size_t y1)
{
    for (size_t y = y0; y < y1; y++)
        if (b->t[y * b->width + x] != b->t[y * b->width + other])
            return false;
    return true;
}

static size_t runs_in_column(const band *b, size_t x, size_t y0, size_t y1)
{
    size_t runs = 1;
    for (size_t y = y0 + 1; y < y1; y++)
        runs += b->t[y * b->width + x] != b->t[(y - 1) * b->width + x];
    return runs;
}

static double band_cost(const band *b, size_t y0, size_t y1)
{
    size_t runs = 0, ndistinct = 0;
    double columns = 0;
    for (size_t x = 0; x < b->width; x++) {
        if (x > 0 && equal_columns(b, x, x - 1, y0, y1))
            continue;
        runs++;
        bool known = false;
        for (size_t k = 0; k < ndistinct && !known; k++)
            known = equal_columns(b, x, b->distinct[k], y0, y1);
        if (known)
            continue;
        b->distinct[ndistinct++] = (uint32_t)x;
        const size_t n = runs_in_column(b, x, y0, y1);
        columns += n > 1 ? rule_length(n) : 0;
    }
    return TYPICAL_LOG_SYMBOLS + rule_length(runs) + columns;
}

sg_status sg_regroup_floors(const uint32_t *t, size_t width, size_t height, sg_arena *arena, size_t *first,
                            size_t *ngroups)
{
    band b = {t, width, height, SG_NEW_ARRAY(arena, uint32_t, width)};
    double *best = SG_NEW_ARRAY(arena, double, height + 1);
    size_t *from = SG_NEW_ARRAY(arena, size_t, height + 1);
    if (b.distinct == NULL || best == NULL || from == NULL)
        return SG_ENOMEM;
    for (size_t end = 1; end <= height; end++) {
        best[end] = INFINITY;
        for (size_t start = end; start-- > 0;) { /* ties: the smaller band */
            const double cost = best[start] + band_cost(&b, start, end);
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
