/* SPDX-License-Identifier: GPL-3.0-or-later */
/* search_lookahead.c - greedy merging that looks behind the next hills. */
#include "config.h"

#include "learn/search_priv.h"

#include <string.h>

/* `saved` holds the best grammar while the line is above it. */
typedef struct {
    sg_line saved;
    bool active;
    double energy;
    size_t ahead;
} lookout;

/* Before a step that does not lower the energy: keep the grammar, once. */
static sg_status keep(lookout *k, const sg_line *l, sg_error *err)
{
    if (k->active)
        return SG_OK;
    SG_TRY(sg_line_copy(&k->saved, l, err));
    k->active = true;
    k->energy = sg_line_energy(l);
    k->ahead = 0;
    return SG_OK;
}

static sg_status walk(sg_line *l, const sg_search_opts *o, lookout *k, sg_error *err)
{
    sg_candidate best;
    double delta;
    while (sg_line_best(l, &best, &delta)) {
        if (!sg_search_goes_on(o, l))
            return SG_STOPPED;
        if (delta >= -SG_LEAST_GAIN)
            SG_TRY(keep(k, l, err));
        if (k->active && k->ahead++ >= o->patience)
            break;
        SG_TRY(sg_line_merge(l, best.a, best.b, err));
        SG_TRY(sg_line_reestimate(l, o, false, err));
        if (k->active && sg_line_energy(l) < k->energy - SG_LEAST_GAIN)
            k->active = false;
    }
    return SG_OK;
}

sg_status sg_search_lookahead(sg_line *l, const sg_search_opts *o, sg_error *err)
{
    lookout k;
    memset(&k, 0, sizeof k);
    const sg_status st = walk(l, o, &k, err);
    if (k.active)
        sg_line_swap(l, &k.saved);
    sg_line_clear(&k.saved);
    return st;
}
