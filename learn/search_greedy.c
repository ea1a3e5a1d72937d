/* SPDX-License-Identifier: GPL-3.0-or-later */
/* search_greedy.c - the best merge, as long as it lowers the energy. */
#include "config.h"

#include "learn/search_priv.h"

sg_status sg_search_greedy(sg_line *l, const sg_search_opts *o, sg_error *err)
{
    sg_candidate best;
    double delta;
    while (sg_line_best(l, &best, &delta) && delta < -SG_LEAST_GAIN) {
        if (!sg_search_goes_on(o, l))
            return SG_STOPPED;
        SG_TRY(sg_line_merge(l, best.a, best.b, err));
        SG_TRY(sg_line_reestimate(l, o, false, err));
    }
    return SG_OK;
}
