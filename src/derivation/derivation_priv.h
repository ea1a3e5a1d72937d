/* SPDX-License-Identifier: GPL-3.0-or-later */
/* derivation_priv.h - what the files of this folder share. */
#ifndef SG_DERIVATION_DERIVATION_PRIV_H
#define SG_DERIVATION_DERIVATION_PRIV_H

#include "derivation/derivation.h"

/* Offsets are 32 bits: no array of a derivation holds more items than this. */
#define SG_DERIVATION_MAX_ITEMS ((size_t)UINT32_MAX - 2)

/** The rule of a node, or NULL when it has none (open, or empty at the depth limit). */
static inline const sg_rule *sg_node_rule(const sg_derivation *d, const sg_node *node)
{
    return node->rule >= SG_RULE_EMPTY ? NULL : sg_grammar_rule(d->grammar, node->rule);
}

/** Room for that many more nodes, uniforms and values. @return SG_OK, SG_ENOMEM */
sg_status sg_derivation_reserve(sg_derivation *d, size_t nodes, size_t uniforms, size_t values, sg_error *err);

/** The same without a call where there is room already: once a node in every hot loop. */
static inline sg_status sg_derivation_room(sg_derivation *d, size_t nodes, size_t uniforms, size_t values, sg_error *err)
{
    if (d->nnodes + nodes <= d->nodes_capacity && d->nuniforms + uniforms <= d->uniforms_capacity &&
        d->nvalues + values <= d->values_capacity && d->nodes_capacity < SG_DERIVATION_MAX_ITEMS &&
        d->values_capacity < SG_DERIVATION_MAX_ITEMS && d->uniforms_capacity < SG_DERIVATION_MAX_ITEMS)
        return SG_OK;
    return sg_derivation_reserve(d, nodes, uniforms, values, err);
}

/** Append an open node; its arguments are undefined. The caller has checked room with sg_derivation_reserve(). */
size_t sg_derivation_append(sg_derivation *d, sg_sym symbol, uint32_t parent, uint32_t depth, uint32_t nparams);

/** Move everything behind the subtree of `node` (and values, uniforms from these offsets on) by so many places, and mend
 *  offsets and parents. Room has been reserved. Lengths are the caller's, and still the old ones. */
void sg_derivation_shift(sg_derivation *d, size_t node, ptrdiff_t nodes, size_t first_value, ptrdiff_t values,
                         size_t first_uniform, ptrdiff_t uniforms);

/** Add to the lengths of all ancestors of node. */
void sg_derivation_stretch(sg_derivation *d, size_t node, ptrdiff_t nodes);

/** Evaluate the arguments of a successor over its parent's frame into args. @return SG_OK, SG_ENUMERIC (one is NaN) */
sg_status sg_derivation_eval_args(const sg_grammar *g, const sg_op *op, const double *frame, double depth, double *args,
                                  sg_error *err);

/** Values of all draws of a rule from its uniforms; frame holds the arguments and receives the values. */
sg_status sg_derivation_transform(const sg_grammar *g, const sg_rule *r, uint32_t nparams, double depth,
                                  const double *uniforms, double *frame, sg_error *err);

/** Evaluate the arguments of the children of `node`, which uses r, over its frame.
 *  @param fits  out: false when a repeat now asks for other children than there are; then some arguments are the new ones
 *  @return SG_OK, SG_ENUMERIC (a repeat count, an argument that is NaN), SG_ENOMEM */
sg_status sg_derivation_hand_down(sg_derivation *d, size_t node, const sg_rule *r, bool *fits, sg_error *err);

/** Probability of the rule of a node that is not open, 0 when it cannot stand there. @return SG_OK, SG_ENUMERIC, SG_ENOMEM */
sg_status sg_node_probability(const sg_derivation *d, const sg_node *n, double *p, sg_error *err);
/** Log density of the draws in a frame of rule r. @return SG_OK, SG_ENUMERIC, SG_ENOMEM */
sg_status sg_frame_log_density(const sg_grammar *g, const sg_rule *r, uint32_t nparams, double depth, const double *frame,
                               double *log_density, sg_error *err);
/** Log density of the draws of a node. @return SG_OK, SG_ENUMERIC, SG_ENOMEM */
sg_status sg_node_log_density(const sg_derivation *d, const sg_node *n, double *log_density, sg_error *err);

/** Draw a rule for the symbol of a node, whatever its rule is now, from the prior: as sg_derivation_choose(). */
sg_status sg_derivation_draw_rule(const sg_derivation *d, size_t node, gsl_rng *rng, sg_rule_id *rule, sg_error *err);

#endif
