/* SPDX-License-Identifier: GPL-3.0-or-later */
/* exact_priv.h - what the files of exact parsing share. */
#ifndef SG_PARSE_EXACT_PRIV_H
#define SG_PARSE_EXACT_PRIV_H

#include "core/arena.h"
#include "grammar/split.h"
#include "parse/earley.h"
#include "parse/exact_parse.h"
#include "parse/lattice_fit.h"

/* Weighted costs of the terminals of a split form, and their sums over all rectangles from the upper left corner. */
typedef struct {
    size_t width, height, nterminals;
    float *costs; /* [nterminals][height][width] */
    double *sums; /* [nterminals][height + 1][width + 1] */
} sg_exact_costs;

/** @return SG_OK, SG_EINVAL (as sg_exact_parse()), SG_ENOMEM */
sg_status sg_exact_costs_create(const sg_grammar *g, const sg_split_form *form, const sg_float_map *costs,
                                const uint32_t *channel, double weight, sg_arena *arena, sg_exact_costs *out,
                                sg_error *err);

/** Cost of a terminal over half-open pixels. */
static inline double sg_exact_cost(const sg_exact_costs *c, uint32_t terminal, size_t x0, size_t y0, size_t x1,
                                   size_t y1)
{
    const size_t row = c->width + 1;
    const double *s = c->sums + terminal * row * (c->height + 1);
    return s[y1 * row + x1] - s[y0 * row + x1] - s[y1 * row + x0] + s[y0 * row + x0];
}

/* A derivation with the relative sizes of its splits. Tied siblings are one node. */
typedef struct sg_exact_node {
    const sg_split_rule *rule;
    double *sizes;                   /* [n] left to right or top to bottom; NULL: lexical */
    struct sg_exact_node **children; /* [n] */
} sg_exact_node;

/** Lines of the lattice, px. */
typedef struct {
    size_t width, height; /* cells */
    uint32_t *x, *y;
} sg_exact_lines;

/** The tree of a parse, sizes from the lines. @return SG_OK, SG_ENOMEM */
sg_status sg_exact_tree_create(const sg_split_form *form, const sg_parse_node *nodes, const sg_exact_lines *lines,
                               sg_arena *arena, sg_exact_node **out, sg_error *err);
/** Give equal siblings one derivation: of theirs the one with the least energy in all their places. */
void sg_exact_tree_tie(sg_exact_node *root, const sg_exact_costs *costs);
/** As a derivation of the grammar that the form was made from. Sizes whose density is too small for a uniform to tell
 *  come out as near as it can. @return SG_OK, SG_ENUMERIC, SG_ENOMEM */
sg_status sg_exact_tree_derivation(const sg_exact_node *root, const sg_grammar *g, sg_derivation *out, sg_error *err);

#endif
