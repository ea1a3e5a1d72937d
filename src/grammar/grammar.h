/* SPDX-License-Identifier: GPL-3.0-or-later */
/* grammar.h - the one grammar type: parametric, stochastic, conditional shape grammars.
 *
 * A grammar is immutable once made. It holds symbols and rules. A rule rewrites its left-hand symbol when its guard
 * holds, with probability weight / (sum of the weights of the rules of that symbol whose guards hold). It owns random
 * draws, and a body: a sequence of shape operations and successors, nested in blocks (splits, repeats, push/pop).
 * Guards, weights, arguments and the parameters of distributions are expressions, compiled once to register code
 * (expr.h) and evaluated over a frame: the formal parameters, then the values of the rule's draws.
 *
 * Conventions: y is up, "split y" runs bottom to top, units are metres where there are any.
 *
 * Labels (terminals) are symbols too. A label that stands in a split stands for an implicit lexical symbol: a hidden
 * non-terminal with the one rule "-> label", made when the grammar is made and printed as the label's name. */
#ifndef SG_GRAMMAR_GRAMMAR_H
#define SG_GRAMMAR_GRAMMAR_H

#include "core/status.h"
#include "grammar/distribution.h"
#include "grammar/expr.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

typedef uint32_t sg_sym;     /* index of a symbol */
typedef uint32_t sg_rule_id; /* index of a rule */

#define SG_NONE UINT32_MAX /* no symbol, no rule, no expression */

typedef enum { SG_SYMBOL_NONTERMINAL, SG_SYMBOL_LABEL } sg_symbol_kind;

typedef struct {
    const char *name;
    sg_symbol_kind kind;
    bool hidden; /* made by the reader: an implicit lexical symbol, or an optional successor */
    uint32_t nparams;
    const char *const *params;   /* [nparams] names */
    sg_rule_id first_rule;       /* rules of one symbol stand together, in the order of the file */
    uint32_t nrules;             /* completion rule not counted */
    sg_rule_id completion;       /* rule used at the depth limit, or SG_NONE (then the empty body) */
    bool constant_weights;       /* no guard, and no weight depends on a parameter: sg_rule.probability holds */
    const double *cumulative;    /* [nrules] with constant_weights: the first that is greater than a uniform is the rule */
    bool leaf;                   /* its one rule has neither guard, draws, children nor parameters: nothing to choose or draw */
    uint32_t color;              /* 0xRRGGBB, labels only */
    uint32_t line;               /* of the definition, 0 when there was no file */
    const char *file;            /* that it was imported from, else NULL */
} sg_symbol;

typedef enum { SG_AXIS_X, SG_AXIS_Y, SG_AXIS_Z } sg_axis;

typedef enum {
    SG_OP_SUCCESSOR, /* symbol(args): derive it; a label when symbol is a label */
    SG_OP_SPLIT,     /* a block of SG_OP_PART; cuts the scope along axis */
    SG_OP_PART,      /* one part of a split: size, then a block */
    SG_OP_REPEAT,    /* a block placed args[0] times along axis; its successors are derived once for each time */
    SG_OP_PUSH,      /* a block after which the state before it is restored */
    SG_OP_SHAPE,     /* any other shape operation: `shape` says which (shape_ops.h), args are its arguments; components have
                        a block of SG_OP_PART whose `shape` is the face */
} sg_op_kind;

/** How the size of a part is meant (CGA shape): 2.5 absolute, '0.3 relative to the scope, ~1 a share of what is left.
 *  DRAWN: the part's share of the rule's simplex draw (learned splits). */
typedef enum { SG_SIZE_ABSOLUTE, SG_SIZE_RELATIVE, SG_SIZE_FLOATING, SG_SIZE_DRAWN } sg_size_kind;

/** One operation of a body. Bodies are flat and in pre-order: a block follows its operation directly. */
typedef struct {
    sg_op_kind kind;
    uint32_t length;     /* operations in its block, itself included; the next sibling is op + length */
    uint32_t nargs;
    const sg_expr *args; /* [nargs] */
    sg_sym symbol;       /* SUCCESSOR */
    uint32_t child;      /* SUCCESSOR: which stored child it places, by first occurrence. Tied siblings share one (outside
                            repeats). SG_NONE for a label. In a rule with a repeat: see sg_rule_child_count(). */
    sg_axis axis;        /* SPLIT, REPEAT */
    uint32_t nparts;     /* SPLIT */
    uint32_t draw;       /* SPLIT with drawn sizes: index of the simplex draw in the rule, else SG_NONE */
    sg_size_kind size;   /* PART; args[0] is the size unless DRAWN */
    uint32_t shape;      /* SHAPE */
} sg_op;

typedef struct {
    sg_sym lhs;
    sg_expr guard;       /* SG_NONE: always */
    sg_expr weight;      /* SG_NONE: 1 */
    double probability;  /* normalised, when the symbol has constant_weights */
    uint32_t ndraws;
    const sg_draw *draws;    /* [ndraws]; a draw may use the values of those before it */
    uint32_t nuniforms;      /* over all draws */
    uint32_t nvalues;        /* over all draws: they fill the frame from slot nparams on */
    uint32_t nops;
    const sg_op *ops;        /* [nops] */
    uint32_t nchildren;      /* stored children when no repeat is in the body, see sg_rule_child_count() */
    bool has_repeat;
    const uint32_t *child_ops; /* [nchildren] the operation that places each stored child first; NULL with a repeat */
    bool draws_passed;   /* an argument of a successor or a repeat count uses a draw: what stands below depends on it.
                            Else draws are geometry only, and can be changed by themselves */
    size_t nattributes;      /* training attributes kept with a learned split */
    const double *attributes; /* [nattributes][nparts], relative sizes in body order */
    uint32_t line;
    const char *file;        /* that was imported and holds it; NULL: the grammar's own */
} sg_rule;

typedef struct sg_grammar sg_grammar;

/** Read a grammar file: the language (*.sg) or the exchange form (JSON), told apart by the first byte.
 *  Errors begin with FILE:LINE:COL, and the line with a caret under it follows in the same message.
 *  @return SG_OK, SG_EINPUT, SG_ENOMEM; *out only on success, free it with sg_grammar_free() */
sg_status sg_grammar_load(const char *path, sg_grammar **out, sg_error *err);
/** The same from memory; name stands for the file in messages. */
sg_status sg_grammar_parse(const char *text, size_t length, const char *name, sg_grammar **out, sg_error *err);
void sg_grammar_free(sg_grammar *g);

/** What reading found that is no error, but hardly meant: guards that never hold, symbols that nothing leads to, and
 *  weights and parameters that can become impossible, with a derivation that leads there. Each is one message
 *  "FILE:LINE:COL: warning: ...", with the line and a caret under it; at most 20, in the order they were found. */
size_t sg_grammar_warning_count(const sg_grammar *g);
const char *sg_grammar_warning(const sg_grammar *g, size_t i);

/** Canonical text: print(parse(text)) is a fixed point; numbers are the shortest that read back the same.
 *  @return SG_OK, SG_EIO */
sg_status sg_grammar_print(const sg_grammar *g, FILE *out, sg_error *err);
/** The generator graph for Graphviz: symbols, what each may produce and how probably, terminals apart.
 *  @return SG_OK, SG_EIO, SG_ENOMEM */
sg_status sg_grammar_print_dot(const sg_grammar *g, FILE *out, sg_error *err);

const char *sg_grammar_name(const sg_grammar *g);
/** The file that it was read from, or what stands for one in messages. */
const char *sg_grammar_source(const sg_grammar *g);
/** Paths of the files that it imports, and that these import; one that is imported twice stands there twice. */
size_t sg_grammar_import_count(const sg_grammar *g);
const char *sg_grammar_import(const sg_grammar *g, size_t i);
size_t sg_grammar_symbol_count(const sg_grammar *g);
size_t sg_grammar_rule_count(const sg_grammar *g); /* completion rules included */
const sg_symbol *sg_grammar_symbol(const sg_grammar *g, sg_sym s);
const sg_rule *sg_grammar_rule(const sg_grammar *g, sg_rule_id r);
/** The symbol of this name, SG_NONE when there is none. The name of a label is the label's, not the hidden symbol's. */
sg_sym sg_grammar_find(const sg_grammar *g, const char *name);
sg_sym sg_grammar_start(const sg_grammar *g);
/** Arguments of the start symbol, [nparams of it]. */
const double *sg_grammar_start_args(const sg_grammar *g);
/** Nodes deeper than this use the completion of their symbol; the start has depth 0. SIZE_MAX: no limit. */
size_t sg_grammar_depth_limit(const sg_grammar *g);
/** True when the grammar declares tied siblings: within one node each distinct right-hand symbol (with the same
 *  arguments) is derived once and reused (MATHEMATICS B5.6). */
bool sg_grammar_tied(const sg_grammar *g);
/** Most values a frame can need: parameters and draws of any rule. */
size_t sg_grammar_frame_size(const sg_grammar *g);

/** A string argument of a shape operation (shape_ops.h). */
const char *sg_grammar_string(const sg_grammar *g, uint32_t index);
/** Colour 0xRRGGBB of the material of that name, SG_NONE when the grammar declares none. */
uint32_t sg_grammar_material_color(const sg_grammar *g, uint32_t index);

/** True when the expression does not depend on its frame; then *value is its value. */
bool sg_grammar_constant(const sg_grammar *g, sg_expr e, double *value);

/** Evaluate an expression of this grammar; depth is the depth of the node. */
double sg_grammar_eval(const sg_grammar *g, sg_expr e, const double *frame, double depth);

/** Probabilities of the rules of s, given its arguments and depth (at most the depth limit).
 *  @param p  out [nrules of s]; sums to 1
 *  @return SG_OK, SG_ENUMERIC (no guard holds; a weight is negative or NaN; all are zero) */
sg_status sg_grammar_rule_probabilities(const sg_grammar *g, sg_sym s, const double *args, double depth, double *p,
                                        sg_error *err);

/** How often the block of a SG_OP_REPEAT is placed: its argument, rounded.
 *  @return SG_OK, SG_ENUMERIC (negative, not finite or over 1e6) */
sg_status sg_op_repeat_count(const sg_grammar *g, const sg_op *op, const double *frame, double depth, size_t *n,
                             sg_error *err);

/** Stored children of a node that uses rule r: the symbol of each, in order. A successor whose `child` is the number
 *  of distinct children before it is a new one, stored once for each time its block is placed; any other `child` points
 *  back to an earlier one. Labels that are placed directly are no children.
 *  @param frame  arguments and draw values of the node (repeat counts may depend on them)
 *  @param n      out: how many
 *  @return SG_OK, SG_ENUMERIC (a repeat count is negative, not finite or over 1e6) */
sg_status sg_rule_child_count(const sg_grammar *g, const sg_rule *r, const double *frame, double depth, size_t *n,
                              sg_error *err);

/** Is the body one split across the picture plane (x or y), each of whose parts holds one successor and nothing else? */
bool sg_rule_is_flat_split(const sg_rule *r);

#endif
