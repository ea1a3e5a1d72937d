/* SPDX-License-Identifier: GPL-3.0-or-later */
/* split_walk.h - the parts of one split as shares of its scope: the one arithmetic of splits, for label scenes and
 * scenes. */
#ifndef SG_SCENE_SPLIT_WALK_H
#define SG_SCENE_SPLIT_WALK_H

#include "grammar/grammar.h"

/** Rounding of sums of sizes that is forgiven, relative to the scope. */
#define SG_SPLIT_TOLERANCE 1e-9

/** A split that is walked along, part by part, in the order of the body. */
typedef struct {
    double fixed; /* sum of absolute and relative sizes, as shares of the scope; over 1: they are larger than it */
    bool filled;  /* the parts leave nothing of the scope (to SG_SPLIT_TOLERANCE of it) */
    double share; /* size of the part walked last */
    /* how far the walk is */
    const sg_grammar *g;
    const sg_rule *r;
    const sg_op *split, *part;
    const double *frame;
    double depth, length, floating, rest, sum;
    uint32_t k;
    size_t ndrawn;
} sg_split_walk;

/** Where a part of a split ends, as a share of the scope: the sum of the shares up to it, rounded to 2^-40. So a cut
 *  that moves between two parts leaves those behind it where they were, to the last bit, however the sum is rounded. */
static inline double sg_placer_share(double sum)
{
    const double grid = 6144; /* doubles near it are 2^-40 apart */
    return sum + grid - grid;
}

/** Begin at the first part of a split of rule r.
 *  @param frame   arguments and draw values of the node
 *  @param length  of the scope along the axis of the split
 *  @return NULL, or what is wrong: a size is negative or no number, or floating and drawn sizes are mixed */
const char *sg_split_walk_begin(sg_split_walk *w, const sg_grammar *g, const sg_rule *r, const sg_op *split,
                                const double *frame, double depth, double length);
/** Where the next part ends, as a share of the scope: more than 1 behind its end, exactly 1 for the last part of a
 *  split that is filled. */
double sg_split_walk_next(sg_split_walk *w);

#endif
