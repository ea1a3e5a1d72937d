/* SPDX-License-Identifier: GPL-3.0-or-later */
/* tree_picture.h - a derivation drawn as a tree, as in figure 2 of Talton et al., "Metropolis procedural modeling", ACM
 * Transactions on Graphics 30(2) (2011): non-terminals round, terminals in boxes with their parameters, and beside each
 * expanded node the probability of its rule and what it drew. Of a large derivation the upper part. */
#ifndef SG_SCENE_TREE_PICTURE_H
#define SG_SCENE_TREE_PICTURE_H

#include "core/arena.h"
#include "derivation/derivation.h"
#include "image/image.h"

#include <stdio.h>

typedef enum {
    SG_TREE_NONTERMINAL,
    SG_TREE_TERMINAL, /* a label or a shape operation */
    SG_TREE_ELIDED,   /* stands for all that is below its parent */
} sg_tree_shape;

/** Something drawn. Lengths in px at scale 1, x to the right and y down. Operations that follow each other in a body are one
 *  mark, a stack of boxes. */
typedef struct {
    sg_tree_shape shape;
    size_t node;   /* of the derivation; of a terminal the one whose body it stands in */
    size_t parent; /* among the marks; SIZE_MAX for the root */
    size_t level;
    const char *text;    /* inside, UTF-8: one line a box */
    const char *beside;  /* lines to the right of it; "" when there are none */
    size_t columns, lines, beside_columns, beside_lines; /* characters */
    uint32_t fill;       /* 0xRRGGBB */
    double x, y, width, height; /* centre and extent, of the whole stack */
} sg_tree_mark;

typedef struct {
    sg_tree_mark *marks; /* [n] in pre-order */
    size_t n, capacity;
    double *level_top, *level_bottom; /* [nlevels] of the rows, texts beside nodes included */
    size_t nlevels;
    double width, height;
    sg_arena *arena; /* of the texts */
} sg_tree_picture;

typedef struct {
    size_t max_marks; /* about so many are drawn: nodes are expanded level by level as long as there is room. What stands below
                         the others is told by number */
    size_t max_depth; /* nodes of this depth are not expanded */
} sg_tree_picture_opts;

#define SG_TREE_PICTURE_OPTS_INIT {150, SIZE_MAX}

/* Sizes of letters, px at scale 1; all are equally wide. */
#define SG_TREE_LETTER_PX 12.0
#define SG_TREE_SMALL_PX 10.0
#define SG_TREE_ADVANCE 0.6 /* of the size */
#define SG_TREE_LINE 1.2    /* from line to line, of the size */
#define SG_TREE_BESIDE_PX 4.0 /* between a mark and the text beside it */
#define SG_TREE_BOX_PX 22.0   /* height of a box */

/** Draw the tree of a derivation. Tied siblings are drawn where they stand first. Free with sg_tree_picture_clear().
 *  @return SG_OK, SG_EINVAL (no node), SG_ENUMERIC (a weight or a repeat count is impossible), SG_ENOMEM; out only on success */
sg_status sg_tree_picture_make(const sg_derivation *d, const sg_tree_picture_opts *opts, sg_tree_picture *out,
                               sg_error *err);
void sg_tree_picture_clear(sg_tree_picture *p);

/** The middle of a line of the text beside a mark, and where the last one ends, from the top of the mark: the first line is level
 *  with the first box. */
static inline double sg_tree_beside_line(size_t line)
{
    return SG_TREE_BOX_PX / 2 + (double)line * SG_TREE_LINE * SG_TREE_SMALL_PX;
}
static inline double sg_tree_beside_end(const sg_tree_mark *m)
{
    return m->beside_lines > 0 ? sg_tree_beside_line(m->beside_lines - 1) + SG_TREE_LINE * SG_TREE_SMALL_PX / 2 : 0;
}

/** @return SG_OK, SG_EIO (also found later, when the file is flushed) */
sg_status sg_tree_picture_svg(const sg_tree_picture *p, FILE *out, sg_error *err);
/** The same in pixels, at `scale` px a unit or as much less as makes it at most 16384 px a side and 64 million in all. Letters
 *  that are not ASCII become '?'. out is made here. @return SG_OK, SG_ENOMEM */
sg_status sg_tree_picture_paint(const sg_tree_picture *p, double scale, sg_image *out, sg_error *err);

#endif
