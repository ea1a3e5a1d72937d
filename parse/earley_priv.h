/* SPDX-License-Identifier: GPL-3.0-or-later */
/* earley_priv.h - what the files of the Earley parser share: the compiled grammar and the chart.
 *
 * The set of rectangles that a symbol derives from a corner, with their values, depends on grammar and cells alone and
 * not on who asks. So the parser is a memoised recursion over corners: predict() takes the symbols asked for at a
 * corner with their left-corner closure, computes all their rectangles in one sweep by increasing size, and is done
 * with them. Behind its first child an item asks at a corner that lies strictly to the right or below, so the recursion
 * is at most width + height deep, and what it returns is final. No edge is stored: outside values and the best
 * derivation enumerate them again. Right-hand sides with a common beginning share it (a trie over all rules of one
 * direction), and with it their items; an item with one child has that child's value and is not stored either. */
#ifndef SG_PARSE_EARLEY_PRIV_H
#define SG_PARSE_EARLEY_PRIV_H

#include "core/arena.h"
#include "parse/earley.h"
#include "parse/extended.h"

#include <stdbool.h>

#define SG_EARLEY_MAX_SIDE 4096             /* cells; ends are kept in 16 bits, and the recursion is that deep */
#define SG_EARLEY_NEVER    (UINT32_MAX / 4) /* least size of a symbol that derives nothing */

/* A node of the two tries of right-hand sides (split-x, split-y): a beginning of at least one rule. Node 0 is none. */
typedef struct {
    uint32_t symbol;         /* the last one of the beginning */
    uint32_t child, sibling; /* longer beginnings; 0: none */
    uint32_t end, nends;     /* the rules that are complete here: sg_prefix_end */
    uint32_t rest;           /* cells along the split that the rest takes at least; 0 when a rule ends here */
    uint32_t lhs;            /* the one left-hand side of the rules below, or SG_NONE: several, see lhs_mask */
    uint64_t lhs_mask;       /* bit lhs % 64 of each */
    uint32_t axis;           /* SG_SPLIT_X or SG_SPLIT_Y */
} sg_prefix;

typedef struct {
    uint32_t lhs, rule;
    sg_ext p;
    double log_p;
} sg_prefix_end;

/* Lexical rules of one symbol with one terminal. */
typedef struct {
    uint32_t symbol, terminal;
    uint32_t best_rule; /* the most probable one, the first of equals */
    sg_ext p;           /* sum over the rules */
    double log_p;       /* of best_rule */
} sg_leaf;

/* Unit rules between two symbols. */
typedef struct {
    uint32_t lhs, rhs;
    uint32_t best_rule;
    double sum;   /* of the probabilities */
    sg_ext p;     /* the same */
    double log_p; /* of best_rule */
} sg_unit;

/* Symbols that unit rules join in a cycle, or one symbol without a cycle. */
typedef struct {
    uint32_t first, n; /* sg_unit_graph.order[first .. first + n) */
    sg_ext *sum;       /* [n][n] (1 - U)^-1, NULL for one symbol without a loop */
    double *best;      /* [n][n] logs of the best chains, 0 on the diagonal */
    uint32_t *next;    /* [n][n] best chain: the sg_unit of its first link */
} sg_unit_component;

typedef struct {
    size_t nunits;
    sg_unit *units;      /* by left-hand symbol, then right-hand symbol */
    uint32_t *start;     /* [nsymbols + 1] into units */
    uint32_t *order;     /* [nsymbols] what unit rules lead to stands before what they lead from */
    uint32_t *rank;      /* [nsymbols] place in order */
    uint32_t *component; /* [nsymbols] */
    sg_unit_component *components;
    size_t ncomponents, largest;
} sg_unit_graph;

typedef struct {
    uint32_t lhs, n, leaf; /* leaf, or unit: index into the table's leaves or units */
    sg_split_op op;
    const uint32_t *rhs;
    double p, log_p;
    bool used;                /* productive and reachable */
    uint32_t nchildren;       /* stored in a derivation: n, but distinct symbols only where siblings are tied */
    uint32_t tied_node;       /* tied siblings: the node at which the whole right-hand side ends, else 0 */
    const uint32_t *first_of; /* [n] tied siblings: place of the first symbol that is equal */
} sg_table_rule;

struct sg_parse_table {
    sg_arena *arena;
    sg_leaf_mode mode;
    uint32_t nsymbols, nterminals, nrules, axiom;
    sg_table_rule *rules;
    uint32_t *rule_start, *rule_order; /* rules of symbol s: rule_order[rule_start[s] ..], by increasing index */
    uint32_t *min_size[2];             /* [axis][nsymbols] cells at least; SG_EARLEY_NEVER: no part in any derivation */
    size_t words;                      /* 64-bit words of a set of terminals, with room for one that no rule makes */
    uint64_t *first;                   /* [nsymbols][words] labels that the top left cell can have */
    uint32_t *corner_start, *corners;  /* left corners of symbol s that are symbols */
    bool *only_leaves;                 /* [nsymbols] only lexical rules */
    uint32_t *root[2];                 /* [axis][nsymbols] the node of the beginning that is this symbol, or 0 */
    sg_prefix *nodes;
    size_t nnodes;
    sg_prefix_end *ends;
    size_t nends;
    sg_leaf *leaves; /* by symbol, then terminal */
    size_t nleaves;
    uint32_t *leaf_start; /* [nsymbols + 1] */
    sg_unit_graph units;
    uint32_t *tied_start, *tied_rules; /* [nsymbols + 1]: rules with tied siblings by their first symbol; NULL: none */
    uint32_t longest_tied;
};

/** Find the rules with tied siblings, before the tries are built. */
sg_status sg_tied_find(sg_parse_table *t, const sg_split_form *form, sg_error *err);
sg_status sg_prefix_build(sg_parse_table *t, sg_error *err);
/** Structure (components, order) from t->units.units; then the closures, for the probabilities in t->rules. */
sg_status sg_unit_graph_build(sg_parse_table *t, sg_error *err);
sg_status sg_unit_graph_close(sg_parse_table *t, sg_error *err);

/* Rectangles of one symbol from one corner, twice: by rows (y1, then x1) for those who go on to the right, by columns
 * for those who go on downwards, which is made when it is first asked for. */
typedef struct {
    uint32_t base, span;   /* slice k holds the rectangles whose other end is base + k */
    const uint32_t *start; /* [span + 1]; NULL: not made yet */
    const uint16_t *along; /* [n] ends along the axis */
    void *value;           /* [n] sg_ext or double */
    uint32_t *index;       /* [n] place by rows; NULL: the same place */
} sg_comps_form;

typedef struct {
    uint32_t n;
    sg_comps_form form[2];
    sg_ext *outside; /* [n] by rows, or NULL */
    uint32_t cursor; /* of the backward sweep */
    uint32_t leaf;   /* + 1; index of the sg_leaf that stands for all, or 0 */
} sg_comps;

/* Symbols that were predicted together. */
typedef struct sg_group {
    struct sg_group *next; /* the group before it at this corner */
    uint32_t n;
    uint32_t symbols[];
} sg_group;

/* Ends in one row of the chart of a corner: a set, and for each the items that end there. */
typedef struct sg_row {
    struct sg_row *next_free;
    uint32_t *head; /* [width + 1] into sg_level.links */
    uint64_t bits[];
} sg_row;

/* The items of one node whose rectangles share the end across the split. */
typedef struct {
    uint32_t node, across, slot;
} sg_line;

typedef struct {
    uint32_t line, next;
} sg_link;

typedef struct {
    uint32_t symbol;
    const sg_comps *comps; /* NULL: own */
    sg_comps own;
    uint32_t cursor;
    bool here; /* it has the rectangle that is being visited */
} sg_old;

/* Work space of one corner in progress; all of it is clean again when the corner is done. */
typedef struct {
    uint32_t x, y, stride;
    uint8_t *in;       /* [nsymbols] 1: in the group, 2: among the old ones */
    uint64_t mask;     /* bit symbol % 64 of the group's */
    uint32_t *symbols; /* [nsymbols] the group */
    uint32_t nsymbols;
    uint32_t *unit_symbols; /* [nsymbols] those with unit rules, in the order of the closure */
    uint32_t nunit_symbols;
    uint32_t *leaves; /* [nleaves] lexical rules of the group that can apply */
    uint32_t nleaves;
    uint32_t *touched; /* [nsymbols] with a value at this rectangle */
    uint32_t ntouched;
    void *b;         /* [nsymbols] values at this rectangle */
    void *b2;        /* [nsymbols] outside values at this rectangle */
    uint32_t *count; /* [nsymbols] */
    sg_old *olds;
    size_t nolds, olds_capacity;
    sg_row **rows;   /* [height + 1] by end; NULL: nothing ends there */
    uint16_t *limit; /* [height + 1] leaves end at most here */
    sg_line *lines;
    size_t nlines, lines_capacity;
    void *values, *outside; /* [nlines][stride] */
    size_t values_capacity, outside_capacity;
    uint32_t *slots;
    size_t nslots;
    sg_link *links; /* links[0] is none */
    size_t nlinks, links_capacity;
    uint32_t *done_symbol; /* finished rectangles, in the order of the sweep */
    uint32_t *done_end;
    void *done_value;
    size_t ndone, done_symbol_capacity, done_end_capacity, done_value_capacity;
    uint32_t *bounds; /* of the children of a rule with tied siblings */
    size_t bounds_capacity;
} sg_level;

typedef enum { SG_CHART_EMPTY, SG_CHART_INSIDE, SG_CHART_VITERBI } sg_chart_kind;

struct sg_chart {
    sg_chart_kind kind;
    const sg_parse_table *table; /* of the last parse */
    uint32_t width, height;
    sg_arena *arena;        /* lives until the next parse */
    uint16_t *labels;       /* [height][width], or NULL: costs; labels that no rule makes are nterminals */
    uint16_t *runs;         /* [height][width] region mode: cells of this label from here to the right */
    double *costs;          /* [nterminals][height][width] above the least of the cell */
    long double *cost_sums; /* region mode: [nterminals][height + 1][width + 1] over the finite ones */
    uint32_t *cost_holes;   /* region mode: the number of infinite ones, the same shape */
    sg_comps ***index;      /* [height][width] -> [nsymbols]; NULL: not predicted */
    sg_group **groups;      /* [height][width] */
    uint16_t *iota;         /* [max side + 1] 0, 1, 2, ... */
    size_t states;
    double least_cost; /* sum over the cells of their cheapest terminal: costs are kept above it */
    double floor;      /* Viterbi: lower values are not worth keeping */
    double log_value;  /* of the axiom over all cells */
    sg_level **levels;
    size_t nlevels, levels_capacity;
    size_t level_symbols, level_leaves, level_width, level_height; /* what the levels are made for */
    size_t row_width;
    sg_row *free_rows;
    size_t bytes; /* of levels and rows */
};

extern const sg_comps sg_no_comps;

/** Check the cells, take what the parse needs of them, and empty the chart. */
sg_status sg_chart_begin(sg_chart *c, const sg_parse_table *t, const sg_cells *cells, sg_chart_kind kind,
                         sg_error *err);
/** The work space of this depth, made when it is first needed; NULL when memory is out. */
sg_level *sg_chart_level(sg_chart *c, size_t depth);
/** A clean row, or NULL. */
sg_row *sg_chart_row(sg_chart *c);
/** After a failure in the middle: drops the work spaces, which are not clean. */
void sg_chart_drop_levels(sg_chart *c);
/** Cost of a terminal over a rectangle: 0 for its label, +INFINITY where it cannot stand. */
double sg_chart_leaf_cost(const sg_chart *c, uint32_t terminal, uint32_t x, uint32_t y, uint32_t x1, uint32_t y1);
/** Whether a lexical rule may cover it. */
bool sg_chart_leaf_fits(const sg_chart *c, uint32_t x, uint32_t y, uint32_t x1, uint32_t y1);

/** Whether child i of a rule with tied siblings, that begins at bounds[i], repeats its first occurrence cell by cell;
 * then bounds[i + 1] is set. The strip begins at (x, y) and has this end across. */
bool sg_tied_repeats(const sg_chart *c, const sg_table_rule *r, uint32_t i, uint32_t *bounds, uint32_t x, uint32_t y,
                     uint32_t across);

/** False when the symbol can certainly derive no rectangle from this corner. */
static inline bool sg_chart_may_start(const sg_chart *c, const sg_parse_table *t, uint32_t s, uint32_t x, uint32_t y)
{
    if (x + t->min_size[SG_SPLIT_X][s] > c->width || y + t->min_size[SG_SPLIT_Y][s] > c->height)
        return false;
    if (c->labels == NULL)
        return true;
    const uint32_t label = c->labels[(size_t)y * c->width + x];
    return (t->first[s * t->words + label / 64] >> (label % 64) & 1) != 0;
}

/** In cell mode over labels the one rectangle of a symbol with lexical rules only is not worth storing. */
static inline bool sg_chart_leaf_inline(const sg_chart *c, const sg_parse_table *t, uint32_t s)
{
    return t->only_leaves[s] && t->mode == SG_CELL_MODE && c->labels != NULL;
}

static inline const sg_leaf *sg_table_leaf(const sg_parse_table *t, uint32_t symbol, uint32_t terminal)
{
    for (uint32_t i = t->leaf_start[symbol]; i < t->leaf_start[symbol + 1]; i++)
        if (t->leaves[i].terminal == terminal)
            return &t->leaves[i];
    return NULL;
}

/* After a Viterbi pass: the rectangles of a symbol from a corner with this end across the axis, by their ends along it.
 */
typedef struct {
    const uint16_t *along;
    const double *log_value;
    uint32_t n;
} sg_viterbi_slice;

/** @return false when memory is out */
bool sg_viterbi_slice_of(sg_chart *c, uint32_t symbol, uint32_t x, uint32_t y, uint32_t axis, uint32_t across,
                         sg_viterbi_slice *out);

#endif
