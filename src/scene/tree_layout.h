/* SPDX-License-Identifier: GPL-3.0-or-later */
/* tree_layout.h - where the nodes of a drawn tree stand: a tidy drawing, level below level.
 *
 * Source: E. M. Reingold and J. S. Tilford, "Tidier drawings of trees", IEEE Transactions on Software Engineering 7(2) (1981),
 * with J. Q. Walker's extension to any number of children in the linear time of C. Buchheim, M. Juenger and S. Leipert,
 * "Improving Walker's algorithm to run in linear time", Graph Drawing 2002. Departs from the paper: nodes have widths of
 * their own to either side, and walks use the tree's order in memory, not recursion, so depth costs no stack. */
#ifndef SG_SCENE_TREE_LAYOUT_H
#define SG_SCENE_TREE_LAYOUT_H

#include "core/status.h"

#include <stddef.h>

/** A node of a tree that stands in pre-order in an array. */
typedef struct {
    size_t parent;      /* its place in the array; SIZE_MAX for the root, which is the first */
    double left, right; /* extent to either side of where it stands, >= 0 */
    double x;           /* out: where it stands; the leftmost extent of the tree is at 0 */
} sg_tree_item;

/** Lay out a tree: parents stand above the middle between their first and last child, children in order, and on each level
 *  there is at least `gap` between the extents of neighbours.
 *  @param items  [n] in pre-order
 *  @param width  out: from the leftmost to the rightmost extent
 *  @return SG_OK, SG_EINVAL (no node; a parent that does not fit pre-order), SG_ENOMEM. O(n) */
sg_status sg_tree_layout(sg_tree_item *items, size_t n, double gap, double *width, sg_error *err);

#endif
