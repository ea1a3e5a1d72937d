/* SPDX-License-Identifier: GPL-3.0-or-later */
/* label_target.c - targets: integral images of label costs. */
#include "score/label_score_priv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

/* Nats over all pixels: 2^62 units. */
#define MAX_NATS 17179869184.0

enum { LINE = 8 }; /* sums of a cache line */

/* The channels of the costs that the labels of g use: their planes, each once, and label -> plane. */
typedef struct {
    const float *planes[SG_NPY_MAX_CHANNELS];
    size_t n;
} plane_list;

static sg_status find_planes(const sg_grammar *g, const sg_float_map *costs, const uint32_t *channel,
                             uint32_t *plane_of, plane_list *planes, sg_error *err)
{
    uint32_t known[SG_NPY_MAX_CHANNELS];
    memset(known, 0xff, sizeof known);
    planes->n = 0;
    for (sg_sym s = 0; s < sg_grammar_symbol_count(g); s++) {
        const sg_symbol *symbol = sg_grammar_symbol(g, s);
        plane_of[s] = SG_NONE;
        if (symbol->kind != SG_SYMBOL_LABEL)
            continue;
        const uint32_t c = channel[s];
        if (c >= costs->channels || c >= SG_NPY_MAX_CHANNELS)
            return SG_FAIL(err, SG_EINVAL, "the label %s has channel %u of %zu", symbol->name, (unsigned)c,
                           costs->channels);
        if (known[c] == SG_NONE) {
            known[c] = (uint32_t)planes->n;
            planes->planes[planes->n++] = costs->values + c * costs->width * costs->height;
        }
        plane_of[s] = known[c];
    }
    return SG_OK;
}

static sg_status check_costs(const plane_list *planes, size_t width, size_t height, sg_error *err)
{
    double sum = 0;
    for (size_t i = 0; i < width * height; i++) {
        double most = 0;
        for (size_t c = 0; c < planes->n; c++) {
            const double cost = planes->planes[c][i];
            if (!(cost >= 0) || !isfinite(cost))
                return SG_FAIL(err, SG_EINVAL, "the cost of pixel (%zu, %zu) is %g", i % width, i / width, cost);
            most = fmax(most, cost);
        }
        sum += most;
    }
    if (sum > MAX_NATS)
        return SG_FAIL(err, SG_EINVAL, "the costs of all pixels sum up to %g nats: %g are too many", sum, MAX_NATS);
    return SG_OK;
}

static int64_t units(float cost)
{
    return (int64_t)(cost * SG_LABEL_UNITS_PER_NAT + 0.5);
}

static void sum_row(const plane_list *planes, size_t y, sg_label_sums *s)
{
    int64_t left[SG_NPY_MAX_CHANNELS] = {0}, cost[SG_NPY_MAX_CHANNELS];
    for (size_t x = 0; x < s->width; x++) {
        int64_t least = INT64_MAX;
        for (size_t c = 0; c < planes->n; c++) {
            cost[c] = units(planes->planes[c][y * s->width + x]);
            least = cost[c] < least ? cost[c] : least;
        }
        int64_t *at = s->sums + (y + 1) * s->row + (x + 1) * s->channels;
        for (size_t c = 0; c < planes->n; c++) {
            left[c] += cost[c] - least;
            at[c] = at[c - s->row] + left[c];
        }
        s->base += planes->n > 0 ? least : 0;
    }
}

/* Reads are scattered over many megabytes: large pages spare most of the address translation. n is a multiple of LINE. */
static int64_t *zeroed_sums(size_t n)
{
    const size_t line = LINE * sizeof(int64_t), large = (size_t)2 << 20, size = n * sizeof(int64_t);
    const size_t alignment = size < large ? line : large;
    int64_t *sums = aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
    if (sums == NULL)
        return NULL;
#ifdef MADV_HUGEPAGE
    if (size >= large)
        madvise(sums, size, MADV_HUGEPAGE); /* a wish: nothing depends on it */
#endif
    return memset(sums, 0, size);
}

static sg_status sum_costs(const plane_list *planes, size_t width, size_t height, sg_label_sums *s, sg_error *err)
{
    SG_TRY(check_costs(planes, width, height, err));
    s->width = width;
    s->height = height;
    s->channels = planes->n > 0 ? (planes->n + LINE - 1) / LINE * LINE : LINE;
    s->row = (width + 1) * s->channels;
    s->sums = zeroed_sums((height + 1) * s->row);
    if (s->sums == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t y = 0; y < height; y++)
        sum_row(planes, y, s);
    return SG_OK;
}

static sg_status fill_target(const sg_float_map *costs, const uint32_t *channel, sg_label_target *t, sg_error *err)
{
    plane_list planes;
    t->channel = malloc((sg_grammar_symbol_count(t->g) + 1) * sizeof *t->channel);
    if (t->channel == NULL)
        return SG_FAIL_NOMEM(err);
    SG_TRY(find_planes(t->g, costs, channel, t->channel, &planes, err));
    SG_TRY(sg_label_plans_create(t, err));
    return sum_costs(&planes, costs->width, costs->height, &t->image, err);
}

sg_status sg_label_score_create(const sg_grammar *g, const sg_float_map *costs, const uint32_t *channel, double weight,
                                sg_score **out, sg_error *err)
{
    if (!(weight > 0) || !isfinite(weight))
        return SG_FAIL(err, SG_EINVAL, "the weight of a score is %g, and must be positive", weight);
    if (costs->width == 0 || costs->height == 0)
        return SG_FAIL(err, SG_EINVAL, "costs of no pixels");
    sg_label_target *t = calloc(1, sizeof *t);
    if (t == NULL)
        return SG_FAIL_NOMEM(err);
    t->score.ops = &sg_label_score_ops;
    t->g = g;
    t->tied = sg_grammar_tied(g);
    t->nats = weight / SG_LABEL_UNITS_PER_NAT;
    const sg_status st = fill_target(costs, channel, t, err);
    if (st != SG_OK)
        sg_label_target_free(&t->score);
    else
        *out = &t->score;
    return st;
}

void sg_label_target_free(sg_score *target)
{
    sg_label_target *t = (sg_label_target *)target;
    sg_label_plans_clear(&t->plans);
    free(t->channel);
    free(t->image.sums);
    free(t);
}
