/* SPDX-License-Identifier: GPL-3.0-or-later */
/* split_walk.c - sizes as in CGA shape (Mueller, Wonka, Haegler, Ulmer and Van Gool, "Procedural modeling of
 * buildings", 2006): absolute, relative to the scope, and floating shares of what these leave; drawn sizes are shares
 * of the same remainder, which is all of the scope when every part is drawn. */
#include "scene/split_walk.h"

#include <math.h>

static double size_of(const sg_split_walk *w, const sg_op *part)
{
    return sg_grammar_eval(w->g, part->args[0], w->frame, w->depth);
}

static const char *sum_parts(sg_split_walk *w)
{
    size_t nfloating = 0, ndrawn = 0;
    const sg_op *part = w->split + 1;
    for (uint32_t k = 0; k < w->split->nparts; k++, part += part->length) {
        if (part->size == SG_SIZE_DRAWN) {
            ndrawn++;
            continue;
        }
        const double s = size_of(w, part);
        if (!(s >= 0) || !isfinite(s))
            return "the size of a part is negative or no number";
        if (part->size == SG_SIZE_FLOATING) {
            w->floating += s;
            nfloating++;
        } else {
            w->fixed += part->size == SG_SIZE_RELATIVE ? s : w->length > 0 ? s / w->length : s > 0 ? INFINITY : 0;
        }
    }
    if (nfloating > 0 && ndrawn > 0)
        return "a split with both floating and drawn sizes";
    w->rest = w->fixed < 1 ? 1 - w->fixed : 0;
    w->filled = ndrawn > 0 || w->floating > 0 || w->rest <= SG_SPLIT_TOLERANCE || w->length <= 0;
    return NULL;
}

const char *sg_split_walk_begin(sg_split_walk *w, const sg_grammar *g, const sg_rule *r, const sg_op *split,
                                const double *frame, double depth, double length)
{
    *w = (sg_split_walk){
        .g = g, .r = r, .split = split, .part = split + 1, .frame = frame, .depth = depth, .length = length};
    return sum_parts(w);
}

static double share_of(sg_split_walk *w, const sg_op *part)
{
    if (part->size == SG_SIZE_DRAWN) {
        const sg_draw *draw = w->r->draws + w->split->draw;
        const uint32_t nparams = sg_grammar_symbol(w->g, w->r->lhs)->nparams;
        return w->rest * w->frame[nparams + draw->first_value + w->ndrawn++];
    }
    const double s = size_of(w, part);
    if (part->size == SG_SIZE_FLOATING)
        return w->floating > 0 ? w->rest * s / w->floating : 0;
    return part->size == SG_SIZE_RELATIVE ? s : w->length > 0 ? s / w->length : 0;
}

double sg_split_walk_next(sg_split_walk *w)
{
    w->share = share_of(w, w->part);
    w->sum += w->share;
    w->part += w->part->length;
    return ++w->k == w->split->nparts && w->filled ? 1 : sg_placer_share(w->sum);
}
