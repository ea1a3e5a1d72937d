/* SPDX-License-Identifier: GPL-3.0-or-later */
/* placer.h - one body of a split grammar, placed in a rectangle. The scene, the JSON form of derivations and scores of label
 * scenes use it; scores place simple splits by themselves, through the same sg_placer_share() and sg_placer_cut(). */
#ifndef SG_SCENE_PLACER_H
#define SG_SCENE_PLACER_H

#include "scene/split_walk.h"
#include "scene/stored_children.h"

typedef struct {
    double x0, y0, x1, y1; /* picture coordinates */
} sg_rect;

/** A child or a label in its place. */
typedef struct {
    sg_rect rect;
    size_t node;  /* the child; for a label the node whose body it stands in */
    sg_sym label; /* SG_NONE: a child */
} sg_place;

/** Work space: a zeroed one is empty. The owner may use items as its stack: placing only appends. */
typedef struct sg_placer {
    sg_place *items;
    size_t n, items_capacity;
    size_t nplaced;   /* since the last sg_placer_reset() */
    sg_stored_children children;
    size_t *starts;   /* of the parts of the splits being placed */
    size_t nstarts, starts_capacity;
    double *sizes;    /* relative sizes of the body's outermost split or repeat, in picture order; none: no split */
    size_t nsizes, sizes_capacity;
} sg_placer;

/** The coordinate of a share along a scope that runs from `from` (share 0) to `to`, in either direction: never outside, exact
 *  at both ends, and equal shares give equal coordinates. */
static inline double sg_placer_cut(double from, double to, double share)
{
    const double low = from < to ? from : to, high = from < to ? to : from;
    const double at = share >= 1 ? to : from + share * (to - from);
    return at < low ? low : at > high ? high : at;
}

void sg_placer_clear(sg_placer *p);
void sg_placer_reset(sg_placer *p);

/** Append what the body of `node` places in rect, in picture order: left to right, top to bottom.
 *  @return SG_OK, SG_ENUMERIC (as sg_label_scene_interpret()), SG_ENOMEM */
sg_status sg_placer_place(sg_placer *p, const sg_derivation *d, size_t node, sg_rect rect, sg_error *err);
/** The same with another frame (arguments and draw values) than the node's own. */
sg_status sg_placer_place_frame(sg_placer *p, const sg_derivation *d, size_t node, const double *frame, sg_rect rect,
                                sg_error *err);
/** Where the parts of a split with constant sizes, none of them absolute, end, as shares of any scope.
 *  @param ends  out [parts], in the order of the body
 *  @return SG_OK, SG_ENUMERIC */
sg_status sg_placer_constant_ends(const sg_grammar *g, const sg_rule *r, const sg_op *split, double *ends);
/** Turn items from `first` to the end around, so that the first one is on top of the stack. */
void sg_placer_reverse(sg_placer *p, size_t first);
/** Put a place of the owner's own in at `at`. @return SG_OK, SG_ENOMEM */
sg_status sg_placer_insert(sg_placer *p, size_t at, sg_place place, sg_error *err);

#endif
