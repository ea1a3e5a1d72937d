/* SPDX-License-Identifier: GPL-3.0-or-later */
/* exact_costs.c - costs of labels per pixel as those of terminals, and their sums over rectangles. */
#include "parse/exact_priv.h"

#include <math.h>

/* The channel of a terminal: the label of its name. */
static sg_status channel_of(const sg_grammar *g, const char *name, const uint32_t *channel, size_t nchannels,
                            uint32_t *out, sg_error *err)
{
    const sg_sym s = sg_grammar_find(g, name);
    *out = channel[s];
    if (*out >= nchannels)
        return SG_FAIL(err, SG_EINVAL, "label %s has channel %u of %zu", name, (unsigned)*out, nchannels);
    return SG_OK;
}

static sg_status weigh(const float *from, size_t n, double weight, float *to, sg_error *err)
{
    for (size_t i = 0; i < n; i++) {
        if (!(from[i] >= 0 && isfinite(from[i])))
            return SG_FAIL(err, SG_EINVAL, "a cost must be finite and not negative");
        to[i] = (float)(weight * from[i]);
    }
    return SG_OK;
}

static void add_up(const float *costs, size_t width, size_t height, double *sums)
{
    for (size_t y = 0; y < height; y++) {
        const double *above = sums + y * (width + 1);
        double *here = sums + (y + 1) * (width + 1), row = 0;
        for (size_t x = 0; x < width; x++) {
            row += costs[y * width + x];
            here[x + 1] = above[x + 1] + row;
        }
    }
}

sg_status sg_exact_costs_create(const sg_grammar *g, const sg_split_form *form, const sg_float_map *costs,
                                const uint32_t *channel, double weight, sg_arena *arena, sg_exact_costs *out,
                                sg_error *err)
{
    const size_t n = costs->width * costs->height, nsums = (costs->width + 1) * (costs->height + 1);
    sg_exact_costs c = {costs->width, costs->height, form->nterminals,
                        SG_NEW_ARRAY(arena, float, form->nterminals * n),
                        SG_NEW_ARRAY(arena, double, form->nterminals * nsums)};
    if (c.costs == NULL || c.sums == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t t = 0; t < c.nterminals; t++) {
        uint32_t from;
        SG_TRY(channel_of(g, form->terminal_names[t], channel, costs->channels, &from, err));
        SG_TRY(weigh(costs->values + from * n, n, weight, c.costs + t * n, err));
        add_up(c.costs + t * n, c.width, c.height, c.sums + t * nsums);
    }
    *out = c;
    return SG_OK;
}
