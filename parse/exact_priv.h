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

/* px, not always whole */
typedef struct {
    double x0, y0, x1, y1;
} sg_exact_place;

/* What all steps of one parse share. */
typedef struct {
    const sg_grammar *g;
    sg_split_form form;
    sg_exact_costs costs;
    size_t longest; /* right-hand side */
} sg_exact_problem;

/** Lines of the lattice, px. */
typedef struct {
    size_t width, height; /* cells */
    uint32_t *x, *y;
} sg_exact_lines;

static inline sg_exact_place sg_exact_whole(const sg_exact_problem *p)
{
    return (sg_exact_place){0, 0, (double)p->costs.width, (double)p->costs.height};
}

static inline double sg_exact_length(const sg_split_rule *r, sg_exact_place at)
{
    return r->op == SG_SPLIT_X ? at.x1 - at.x0 : at.y1 - at.y0;
}

/** What is `from` to `to`, as shares of its length, of a place that the rule cuts. */
static inline sg_exact_place sg_exact_part(const sg_split_rule *r, sg_exact_place at, double from, double to)
{
    const double start = r->op == SG_SPLIT_X ? at.x0 : at.y0, length = sg_exact_length(r, at);
    return r->op == SG_SPLIT_X ? (sg_exact_place){start + from * length, at.y0, start + to * length, at.y1}
                               : (sg_exact_place){at.x0, start + from * length, at.x1, start + to * length};
}

/** The first part with which part i of a rule is derived: another one for equal siblings of tied grammars only. */
uint32_t sg_exact_first(const sg_exact_problem *p, const sg_split_rule *r, uint32_t i);
/** Cost of a terminal over the pixels of a place. */
double sg_exact_leaf_energy(const sg_exact_problem *p, uint32_t terminal, sg_exact_place at);
/** E_img of a derivation in a place. */
double sg_exact_image_energy(const sg_exact_problem *p, const sg_exact_node *e, sg_exact_place at);
/** E_attr of sizes of a rule, by the grammar's own density. @param work [n] */
double sg_exact_size_energy(const sg_exact_problem *p, const sg_split_rule *r, const double *sizes, double *work);
/** E_img + E_rule + E_attr. @param work [longest right-hand side] */
double sg_exact_energy(const sg_exact_problem *p, const sg_exact_node *root, double *work);

/** The tree of a parse, sizes from the lines. @return SG_OK, SG_ENOMEM */
sg_status sg_exact_tree_create(const sg_exact_problem *p, const sg_parse_node *nodes, const sg_exact_lines *lines,
                               sg_arena *arena, sg_exact_node **out, sg_error *err);
/** A node with room for sizes and children; NULL when memory is out. */
sg_exact_node *sg_exact_node_create(const sg_split_rule *rule, sg_arena *arena);
/** Deep copy; siblings that are one stay one. @return NULL when memory is out */
sg_exact_node *sg_exact_tree_copy(const sg_exact_node *e, sg_arena *arena);
/** Give equal siblings one derivation: of theirs the one with the least energy in all their places. */
void sg_exact_tree_tie(const sg_exact_problem *p, sg_exact_node *root);
/** As a derivation of the grammar. Sizes whose density is too small for a uniform to tell come out as near as it can.
 *  @return SG_OK, SG_ENUMERIC, SG_ENOMEM */
sg_status sg_exact_tree_derivation(const sg_exact_problem *p, const sg_exact_node *root, sg_derivation *out,
                                   sg_error *err);

/** Move the cuts of all splits, one by one, as long as E_img + E_attr falls. @return SG_OK, SG_ENOMEM */
sg_status sg_exact_move_cuts(const sg_exact_problem *p, sg_exact_node *root, sg_arena *arena, sg_error *err);

/** The best derivation that descent finds from the rules of the axiom (exact_descend.c).
 *  @param step  px between the places where cuts are tried
 *  @return SG_OK; SG_ENOPARSE (none fits); SG_ENOMEM */
sg_status sg_exact_descend(const sg_exact_problem *p, double step, sg_arena *arena, sg_exact_node **out, sg_error *err);

#endif
