/* SPDX-License-Identifier: GPL-3.0-or-later */
/* derivation.h - the one derivation type: a flat tree, pre-order, with its random values beside it.
 *
 * Nodes are one array, uniforms and values another two, so that a subtree is a slice of each: copying is memcpy and
 * replacing a subtree is a splice. A node may be open (symbol known, no rule chosen yet). With tied siblings a symbol
 * is stored once, at its first occurrence; interpretation places it at every occurrence (sg_op.child) and the prior
 * counts it once. */
#ifndef SG_DERIVATION_DERIVATION_H
#define SG_DERIVATION_DERIVATION_H

#include "core/arena.h"
#include "core/status.h"
#include "grammar/grammar.h"

#include <gsl/gsl_rng.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** Rule of a node deeper than the depth limit whose symbol has no completion: the empty body, with probability 1. */
#define SG_RULE_EMPTY (UINT32_MAX - 1)

typedef struct {
    sg_sym symbol;
    sg_rule_id rule;   /* SG_NONE: open; SG_RULE_EMPTY: cut at the depth limit */
    uint32_t parent;   /* distance back to the parent; 0 for the root */
    uint32_t length;   /* nodes in the subtree, itself included; first child: node + 1, next sibling: node + length */
    uint32_t depth;    /* of the root: 0 */
    uint32_t values;   /* first of its values: arguments, then draw values; nparams + nvalues of the rule */
    uint32_t uniforms; /* first of its uniforms: nuniforms of the rule */
} sg_node;

/** A stored child that a rule asks for: operation `op` of the body of node `parent`. */
typedef struct {
    uint32_t parent, op;
} sg_child_op;

typedef struct {
    sg_child_op *items;
    size_t n, capacity;
} sg_child_list;

typedef struct sg_derivation {
    const sg_grammar *grammar; /* borrowed */
    sg_node *nodes;
    size_t nnodes, nodes_capacity;
    double *uniforms;
    size_t nuniforms, uniforms_capacity;
    double *values;
    size_t nvalues, values_capacity;
    sg_child_list pending; /* work space of sampling and refreshing; empty between calls */
} sg_derivation;

/** An empty derivation: no node. Free with sg_derivation_clear(). */
void sg_derivation_init(sg_derivation *d, const sg_grammar *g);
void sg_derivation_clear(sg_derivation *d);
/** Make dst equal to src; dst keeps its memory. @return SG_OK, SG_ENOMEM */
sg_status sg_derivation_copy(sg_derivation *dst, const sg_derivation *src, sg_error *err);

/** Sample from the grammar's prior, replacing what d holds.
 *  @param max_nodes  a derivation that would be larger is an error
 *  @return SG_OK, SG_ENUMERIC (no guard holds, a weight, a distribution or a repeat count is impossible, an argument is NaN,
 *          max_nodes is passed; the sentence tells file, line and derivation path), SG_ENOMEM; on failure d is empty */
sg_status sg_derivation_sample(sg_derivation *d, gsl_rng *rng, size_t max_nodes, sg_error *err);

/** Sample a subtree for symbol with these arguments at this depth into `slice` (a derivation of its own whose root has
 *  that depth). */
sg_status sg_derivation_sample_subtree(sg_derivation *slice, sg_sym symbol, const double *args, uint32_t depth,
                                       gsl_rng *rng, size_t max_nodes, sg_error *err);

/** Make d one open node: where step-wise expansion begins. args: [nparams of symbol]. @return SG_OK, SG_ENOMEM */
sg_status sg_derivation_open(sg_derivation *d, sg_sym symbol, const double *args, uint32_t depth, sg_error *err);

/** Replace the subtree at `node` by the slice (another derivation than d), whose root must have the same symbol; its depths
 *  are shifted to that of the node. Lengths of ancestors and offsets behind it are mended. O(nodes behind + depth).
 *  @return SG_OK, SG_EINVAL (another symbol), SG_ENOMEM; on failure d is as it was */
sg_status sg_derivation_splice(sg_derivation *d, size_t node, const sg_derivation *slice, sg_error *err);
/** Copy the subtree at `node` into slice. @return SG_OK, SG_ENOMEM */
sg_status sg_derivation_extract(const sg_derivation *d, size_t node, sg_derivation *slice, sg_error *err);

/** Draw a rule for an open node from the prior: its completion, or SG_RULE_EMPTY, beyond the depth limit.
 *  @return SG_OK, SG_EINVAL (not open), SG_ENUMERIC */
sg_status sg_derivation_choose(const sg_derivation *d, size_t node, gsl_rng *rng, sg_rule_id *rule, sg_error *err);
/** Expand an open node by rule (SG_RULE_EMPTY included), with fresh uniforms from rng; its children are open.
 *  @return SG_OK, SG_EINVAL (not open, or no rule of its symbol), SG_ENUMERIC, SG_ENOMEM; on failure d is as it was */
sg_status sg_derivation_expand(sg_derivation *d, size_t node, sg_rule_id rule, gsl_rng *rng, sg_error *err);
bool sg_derivation_complete(const sg_derivation *d);

/** Put where it happened in front of the sentence in err: the grammar's file and the line of the node's rule (of its symbol
 *  while it is open), and the path of symbols with their arguments from the root to the node. For whatever fails on a
 *  node of a derivation. @return code */
sg_status sg_derivation_fail_at(const sg_derivation *d, size_t node, sg_status code, sg_error *err);

/** Log prior in the space of uniforms: the sum of log rule probabilities. Open nodes count nothing; tied siblings stand
 *  once in the tree and count once. -INFINITY when a rule has probability 0 where it stands (its guard fails, or it is not
 *  what the depth limit asks for). @return SG_OK, SG_ENUMERIC, SG_ENOMEM */
sg_status sg_derivation_log_prior(const sg_derivation *d, double *log_prior, sg_error *err);
/** Probability of the rule of a node that is not open, 0 when it cannot stand there. @return SG_OK, SG_ENUMERIC, SG_ENOMEM */
sg_status sg_derivation_rule_probability(const sg_derivation *d, size_t node, double *p, sg_error *err);
/** Sum of log densities of all draws in value space (the E_attr of DESIGN 5.4 is its negative). @return SG_OK, SG_ENUMERIC */
sg_status sg_derivation_log_density(const sg_derivation *d, double *log_density, sg_error *err);

/** Recompute draw values from uniforms, and arguments from values, down the subtree of `node`, after uniforms were changed.
 *  @return SG_OK, SG_ENUMERIC (also when a repeat now asks for other children: then the subtree must be
 *          derived anew), SG_ENOMEM; on failure the values below the node are worth nothing until a refresh succeeds */
sg_status sg_derivation_refresh(sg_derivation *d, size_t node, sg_error *err);

/** Check every invariant above (for tests and readers): lengths, parents and depths agree, rules belong to their symbols,
 *  each node has the children that its rule asks for, values are what uniforms and arguments make them (to 1e-9).
 *  @return SG_OK, SG_EINVAL (the sentence names the node), SG_ENOMEM */
sg_status sg_derivation_check(const sg_derivation *d, sg_error *err);

/** The symbols from the root down to a node, as "S > A > B"; of a long path the first and the last few. */
void sg_derivation_path(const sg_derivation *d, size_t node, char *text, size_t size);

/** The stored children that rule r of node `parent` asks for, appended to the list: one item a child, in order. Successors
 *  outside repeats with one sg_op.child are one child; those in a repeat are children anew each time.
 *  @param frame  arguments and draw values of the node
 *  @return SG_OK, SG_EINVAL (more than `limit` items in the list), SG_ENUMERIC (a repeat count, or repeats that place more than
 *          2^24 blocks), SG_ENOMEM */
sg_status sg_derivation_list_children(const sg_grammar *g, const sg_rule *r, const double *frame, double depth,
                                      uint32_t parent, size_t limit, sg_child_list *list, sg_error *err);

#endif
