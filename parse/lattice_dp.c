/* SPDX-License-Identifier: GPL-3.0-or-later */
/* lattice_dp.c - strip sums of one axis and the exact choice of its lines (MATHEMATICS B2, step 2). */
#include "parse/lattice_priv.h"

#include "image/classes.h"

#include <math.h>
#include <string.h>

enum { LANES = 8 };

/* Interval k's own gains go to place k + 1; the prefix sums follow. */
static void count_labels(const sg_axis *a, const sg_places *strips, sg_strip_table *t)
{
    const size_t block = t->nclasses * t->stride;
    for (size_t j = 0; j < t->nstrips; j++)
        for (uint32_t row = strips->at[j]; row < strips->at[j + 1]; row++) {
            const uint8_t *label = a->labels + row * a->length;
            for (size_t k = 0; k + 1 < t->places.n; k++) {
                float *sum = t->sum + (k + 1) * block + j;
                for (uint32_t p = t->places.at[k]; p < t->places.at[k + 1]; p++)
                    if (label[p] != SG_CLASS_IGNORE)
                        sum[label[p] * t->stride] += 1;
            }
        }
}

static void add_costs(const sg_axis *a, const sg_places *strips, sg_strip_table *t)
{
    const size_t block = t->nclasses * t->stride;
    for (size_t c = 0; c < t->nclasses; c++)
        for (size_t j = 0; j < t->nstrips; j++)
            for (uint32_t row = strips->at[j]; row < strips->at[j + 1]; row++) {
                const float *cost = a->costs + (c * a->breadth + row) * a->length;
                for (size_t k = 0; k + 1 < t->places.n; k++) {
                    double gain = 0;
                    for (uint32_t p = t->places.at[k]; p < t->places.at[k + 1]; p++)
                        gain -= (double)cost[p];
                    t->sum[(k + 1) * block + c * t->stride + j] += (float)gain;
                }
            }
}

static sg_status make_table(size_t nclasses, const sg_places *places, const sg_places *strips, sg_arena *arena,
                            sg_strip_table *t, sg_error *err)
{
    *t = (sg_strip_table){.places = *places, .nclasses = nclasses, .nstrips = strips->n - 1};
    t->stride = (t->nstrips + LANES - 1) / LANES * LANES;
    t->sum = SG_NEW_ARRAY(arena, float, places->n * nclasses * t->stride);
    return t->sum != NULL ? SG_OK : SG_FAIL_NOMEM(err);
}

sg_status sg_strip_table_create(const sg_axis *a, const sg_places *places, const sg_places *strips, sg_arena *arena,
                                sg_strip_table *out, sg_error *err)
{
    sg_strip_table t;
    SG_TRY(make_table(a->nclasses, places, strips, arena, &t, err));
    const size_t block = t.nclasses * t.stride;
    if (a->costs != NULL)
        add_costs(a, strips, &t);
    else
        count_labels(a, strips, &t);
    for (size_t i = block; i < places->n * block; i++)
        t.sum[i] += t.sum[i - block];
    *out = t;
    return SG_OK;
}

static void add_groups(const float *fine, const sg_places *fine_strips, const sg_places *strips, float *coarse)
{
    size_t j = 0;
    for (size_t k = 0; k + 1 < strips->n; k++)
        for (; fine_strips->at[j] < strips->at[k + 1]; j++)
            coarse[k] += fine[j];
}

sg_status sg_strip_table_coarsen(const sg_strip_table *base, const sg_places *base_strips, const sg_places *places,
                                 const sg_places *strips, sg_arena *arena, sg_strip_table *out, sg_error *err)
{
    sg_strip_table t;
    SG_TRY(make_table(base->nclasses, places, strips, arena, &t, err));
    size_t i = 0;
    for (size_t k = 0; k < places->n; k++) {
        while (base->places.at[i] < places->at[k])
            i++;
        for (size_t c = 0; c < base->nclasses; c++)
            add_groups(base->sum + (i * base->nclasses + c) * base->stride, base_strips, strips,
                       t.sum + (k * t.nclasses + c) * t.stride);
    }
    *out = t;
    return SG_OK;
}

/* The hot loop. Lanes are strips: the compiler turns the inner loops into packed maxima. */
double sg_strip_table_gain(const sg_strip_table *t, size_t i, size_t j)
{
    const size_t stride = t->stride, block = t->nclasses * stride;
    const float *first = t->sum + i * block, *last = t->sum + j * block;
    float total[LANES] = {0};
    for (size_t s = 0; s < stride; s += LANES) {
        float best[LANES];
        for (size_t v = 0; v < LANES; v++)
            best[v] = last[s + v] - first[s + v];
        for (size_t c = stride + s; c < block; c += stride)
            for (size_t v = 0; v < LANES; v++) {
                const float gain = last[c + v] - first[c + v];
                best[v] = gain > best[v] ? gain : best[v];
            }
        for (size_t v = 0; v < LANES; v++)
            total[v] += best[v];
    }
    double sum = 0;
    for (size_t v = 0; v < LANES; v++)
        sum += (double)total[v];
    return sum;
}

typedef struct {
    double value;  /* of the best way to cut from the first place to this one */
    size_t length; /* its intervals */
    size_t from;   /* its last interval's start */
} best_way;

/* Best way to place j over the starts that are alive; those that cannot win any more are dropped. */
static size_t reach(const sg_strip_table *t, double penalty, size_t j, size_t *alive, size_t nalive, double *gains,
                    best_way *best)
{
    best[j] = (best_way){-INFINITY, 0, 0};
    for (size_t k = 0; k < nalive; k++) {
        const size_t i = alive[k];
        gains[k] = best[i].value + sg_strip_table_gain(t, i, j);
        const double value = gains[k] - penalty;
        if (value > best[j].value || (value == best[j].value && best[i].length + 1 < best[j].length))
            best[j] = (best_way){value, best[i].length + 1, i};
    }
    size_t kept = 0;
    for (size_t k = 0; k < nalive; k++)
        if (gains[k] >= best[j].value)
            alive[kept++] = alive[k];
    alive[kept++] = j;
    return kept;
}

sg_status sg_cuts_solve(const sg_strip_table *t, double penalty, sg_arena *arena, sg_places *out, double *value,
                        sg_error *err)
{
    const size_t n = t->places.n;
    best_way *best = SG_NEW_ARRAY(arena, best_way, n);
    size_t *alive = SG_NEW_ARRAY(arena, size_t, n);
    double *gains = SG_NEW_ARRAY(arena, double, n);
    if (best == NULL || alive == NULL || gains == NULL)
        return SG_FAIL_NOMEM(err);
    size_t nalive = 1; /* place 0 */
    for (size_t j = 1; j < n; j++)
        nalive = reach(t, penalty, j, alive, nalive, gains, best);
    const size_t length = best[n - 1].length;
    *out = (sg_places){length + 1, SG_NEW_ARRAY(arena, uint32_t, length + 1)};
    if (out->at == NULL)
        return SG_FAIL_NOMEM(err);
    size_t i = n - 1;
    for (size_t k = length + 1; k-- > 0; i = best[i].from)
        out->at[k] = t->places.at[i];
    *value = best[n - 1].value;
    return SG_OK;
}
