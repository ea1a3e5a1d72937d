/* SPDX-License-Identifier: GPL-3.0-or-later */
/* derivation_move.h - the proposals of searches: a subtree anew, the same tree with other values, other draws of one node.
 *
 * Nothing here changes a derivation: what is made is a slice, or the draws of one node, for an sg_change. What a proposal
 * does to the prior is told in the space of uniforms, where every draw has density 1 (DESIGN 5.3). A proposal that
 * is outside of the target (a rule that has probability 0 where it stands, too many nodes, sizes outside of the simplex)
 * is no error: then `inside` is false, and what was made is worth nothing. */
#ifndef SG_DERIVATION_DERIVATION_MOVE_H
#define SG_DERIVATION_DERIVATION_MOVE_H

#include "derivation/derivation.h"

/** Uniforms in the order in which nodes take them, pre-order: the kept ones first, surplus dropped, lack filled with fresh
 *  ones. {NULL, 0, 0, rng}: all fresh. */
typedef struct {
    const double *kept; /* [nkept] */
    size_t nkept, next;
    gsl_rng *rng;
} sg_uniforms;

/** The next n of them. */
void sg_uniforms_take(sg_uniforms *from, double *u, size_t n);

/** Uniforms of the subtree of `node`: where they begin, and how many. */
const double *sg_derivation_uniforms(const sg_derivation *d, size_t node, size_t *n);

/** Derive the subtree at `node` anew from the rules into `slice`, its uniforms from `from`, whose generator also draws the
 *  rules.
 *  @param max_nodes  of d with the slice in it
 *  @param inside     out: false when there would be more
 *  @return SG_OK, SG_ENUMERIC (the grammar fails as in sg_derivation_sample()), SG_ENOMEM */
sg_status sg_derivation_regenerate(const sg_derivation *d, size_t node, sg_uniforms *from, size_t max_nodes,
                                   sg_derivation *slice, bool *inside, sg_error *err);

/** The rules of `like` with the uniforms of `from`, into `slice`; arguments of the root stay.
 *  @param d_log_rules  out: sum of log rule probabilities of slice, less that of like
 *  @param inside       out: false when a rule of like has probability 0 with these values, or a repeat would ask for other
 *                      children
 *  @return SG_OK, SG_ENUMERIC (the grammar fails at values that the prior can have), SG_ENOMEM */
sg_status sg_derivation_revalue(const sg_derivation *like, sg_uniforms *from, sg_derivation *slice, double *d_log_rules,
                                bool *inside, sg_error *err);

/** The same with the uniforms of the root of `like` alone changed: what does not depend on them is only copied.
 *  @param uniforms  [nuniforms of the root's rule] */
sg_status sg_derivation_revalue_root(const sg_derivation *like, const double *uniforms, sg_derivation *slice,
                                     double *d_log_rules, bool *inside, sg_error *err);

/* The rest is about nodes whose rule has draws. */

/** Draws of one node: uniforms, and the frame that they make. */
typedef struct {
    double *uniforms; /* [nuniforms of the rule] */
    double *frame;    /* arguments, then [nvalues of the rule]; room for sg_grammar_frame_size() */
    const double *values; /* in the frame */
} sg_node_draws;

/** Fresh uniforms for all draws of the node. @return SG_OK, SG_ENUMERIC */
sg_status sg_node_resample(const sg_derivation *d, size_t node, gsl_rng *rng, sg_node_draws *out, sg_error *err);

/** One of its uniforms, any, by a Gaussian step that is reflected at 0 and 1: symmetric. @return SG_OK, SG_ENUMERIC */
sg_status sg_node_reflect(const sg_derivation *d, size_t node, double sd, gsl_rng *rng, sg_node_draws *out, sg_error *err);

/** Whether the rule has a draw whose neighbouring sizes can be shifted. */
bool sg_rule_has_sizes(const sg_rule *r);

/** Two sizes of one of its simplex draws, by a Gaussian step: the first grows by what the second loses. Half of the time, and
 *  where there are only two, they are neighbours, so that the boundary between them moves; else what stands between them slides.
 *  Symmetric in the space of sizes, since the sum of the two stays and the step depends on nothing else.
 *  @param sd               of the step as a share of the two sizes' sum; each step draws its own scale, log-uniform down to
 *                          sd/64, so that small and large ones both happen
 *  @param d_log_density    out: log density of the draws after less before; it is also the log of the ratio of reverse over
 *                          forward proposal density in the space of uniforms
 *  @param inside           out: false when a size would not be positive */
void sg_node_shift(const sg_derivation *d, size_t node, double sd, gsl_rng *rng, sg_node_draws *out, double *d_log_density,
                   bool *inside);

/** Log density of draws that were made for this node. @return SG_OK, SG_ENUMERIC, SG_ENOMEM */
sg_status sg_node_draws_log_density(const sg_derivation *d, size_t node, const sg_node_draws *draws, double *log_density,
                                    sg_error *err);

#endif
