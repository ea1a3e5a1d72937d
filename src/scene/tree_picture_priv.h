/* SPDX-License-Identifier: GPL-3.0-or-later */
/* tree_picture_priv.h - the words of tree pictures. */
#ifndef SG_SCENE_TREE_PICTURE_PRIV_H
#define SG_SCENE_TREE_PICTURE_PRIV_H

#include "scene/tree_picture.h"

#include <stdbool.h>

/** A hidden symbol that stands for a label in a split: drawn as the label. @return SG_NONE for others */
sg_sym sg_tree_label_of(const sg_grammar *g, sg_sym symbol);

/* Texts live in the arena; NULL when memory is out. */
const char *sg_tree_node_text(sg_arena *arena, const sg_derivation *d, size_t node);
const char *sg_tree_label_text(sg_arena *arena, const sg_grammar *g, sg_sym label);
/** An operation of the body of node. */
const char *sg_tree_operation_text(sg_arena *arena, const sg_derivation *d, size_t node, const sg_op *op);
/** Probability of its rule and what it draws. @return SG_OK, SG_ENUMERIC, SG_ENOMEM */
sg_status sg_tree_beside_text(sg_arena *arena, const sg_derivation *d, size_t node, const char **text, sg_error *err);

/** Is text on this colour 0xRRGGBB to be white? By the luma of ITU-R BT.601. */
static inline bool sg_tree_is_dark(uint32_t color)
{
    return 299 * (color >> 16 & 255) + 587 * (color >> 8 & 255) + 114 * (color & 255) < 128000;
}

/** Characters of the longest line, and how many lines; a text of nothing has none. */
size_t sg_tree_columns(const char *text, size_t *lines);

#endif
