/* SPDX-License-Identifier: GPL-3.0-or-later */
/* earley.h - 2D Earley-Stolcke parsing of label lattices and of cell costs (DESIGN 5.1, MATHEMATICS B1.2).
 *
 * A parse table is compiled from a split form once; probabilities can be replaced without compiling again. A chart is
 * the work space of one parse, made once and reused: it keeps its memory. One chart a thread; a table is shared. */
#ifndef SG_PARSE_EARLEY_H
#define SG_PARSE_EARLEY_H

#include "core/status.h"
#include "derivation/derivation.h"
#include "grammar/split.h"

#include <stddef.h>
#include <stdint.h>

typedef enum {
    SG_CELL_MODE,   /* a lexical rule covers exactly one cell */
    SG_REGION_MODE, /* it covers any rectangle of one label (with costs: any rectangle, its cells' costs added) */
} sg_leaf_mode;

typedef struct sg_parse_table sg_parse_table;
typedef struct sg_chart sg_chart;

/** What is parsed: labels or costs over W x H cells, top row first. Exactly one of labels and costs is set. */
typedef struct {
    size_t width, height;
    const uint16_t *labels; /* [height][width] terminals of the split form; UINT16_MAX: a label that no rule makes */
    const double *costs;    /* [nterminals][height][width] -log p of the terminal in the cell, nats; +INFINITY is fine */
} sg_cells;

/** Compile. Unproductive and unreachable symbols take no part. Where siblings are tied (form->tied) and a rule repeats
 *  a symbol, that symbol must have a single derivation, or the mode be SG_CELL_MODE: then the parse is exact over
 *  labels, and refused over costs (earley_tied.c). Clear form->tied to parse as if every child were derived by itself.
 *  @return SG_OK, SG_ENUMERIC (the unit rules have spectral radius >= 1: no inside probability), SG_EINVAL (a malformed
 *          form, a probability outside [0,1], tied siblings in region mode), SG_ENOMEM */
sg_status sg_parse_table_create(const sg_split_form *form, sg_leaf_mode mode, sg_parse_table **out, sg_error *err);
void sg_parse_table_free(sg_parse_table *t);
/** Replace the rule probabilities: p is [nrules of the form]. */
sg_status sg_parse_table_set_probabilities(sg_parse_table *t, const double *p, sg_error *err);

sg_status sg_chart_create(sg_chart **out, sg_error *err);
void sg_chart_free(sg_chart *c);
/** Items in the chart of the last parse, and bytes that the chart holds. */
size_t sg_chart_states(const sg_chart *c);
size_t sg_chart_bytes(const sg_chart *c);

/** Inside: log of the sum over derivations. -INFINITY when the lattice is outside the language.
 *  @return SG_OK, SG_EINVAL (a side is 0 or over 4096, a cost is NaN or -INFINITY, neither or both of labels and costs,
 *          costs where tied siblings forbid them), SG_ENOMEM */
sg_status sg_earley_inside(const sg_parse_table *t, const sg_cells *cells, sg_chart *c, double *log_inside,
                           sg_error *err);
/** Viterbi: log of the largest derivation. Ties break by rule index, then by split position. Over costs it is found in
 *  passes that keep no part below a floor (earley_viterbi.c); the chart is that of the last one. @return as above */
sg_status sg_earley_viterbi(const sg_parse_table *t, const sg_cells *cells, sg_chart *c, double *log_viterbi,
                            sg_error *err);

/** After sg_earley_inside() on this chart, once: the expected uses of each rule given the cells, by outside values.
 *  Nothing is added when the cells are outside the language. What tied siblings share counts once.
 *  @param counts  in/out [nrules of the form], added to
 *  @return SG_OK, SG_EINVAL (no inside pass came before), SG_ENOMEM */
sg_status sg_earley_expected_counts(const sg_parse_table *t, sg_chart *c, double *counts, sg_error *err);
/** After sg_earley_viterbi() on this chart: the uses of each rule in the best derivation, added to counts.
 *  @return SG_OK, SG_ENOPARSE (outside the language), SG_EINVAL (no Viterbi pass came before), SG_ENOMEM */
sg_status sg_earley_viterbi_counts(const sg_parse_table *t, sg_chart *c, double *counts, sg_error *err);

/** A parse as derivation nodes in pre-order, with the cells that each covers. The children of a node are those of its
 *  right-hand side, in order; where siblings are tied and share a derivation, only the first of equal ones. */
typedef struct {
    uint32_t rule;           /* of the split form */
    uint32_t length;         /* nodes of the subtree, itself included */
    uint32_t x0, y0, x1, y1; /* cells, half open */
} sg_parse_node;

/** After sg_earley_viterbi(): the best derivation. @param nodes out, malloc'd by the call, free() it
 *  @return as sg_earley_viterbi_counts() */
sg_status sg_earley_viterbi_tree(const sg_parse_table *t, sg_chart *c, sg_parse_node **nodes, size_t *nnodes,
                                 sg_error *err);

#endif
