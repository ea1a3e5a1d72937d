/* SPDX-License-Identifier: GPL-3.0-or-later */
/* distribution.h - the random draws of rules, each a map from uniforms in (0,1) to values.
 * In the space of uniforms every draw has density 1 (DESIGN 5.3), so samplers move uniforms and the map does the rest.
 * A uniform near 1 may be written as its distance from 1 with a minus sign: -1e-40 is what 1 - 1e-40 cannot be. Sizes far up
 * in a tail are told from each other that way; no draw is made of more than 1 - 2^-53 otherwise.
 *
 * The simplex draw is the sequential truncated normal of DESIGN 5.3: s_1 ~ TN on (0,1), s_j given s_1..s_{j-1} ~ TN on
 * (0, 1 - sum), with the conditional moments of N(mean, covariance); the last size is the remainder. k sizes take k-1
 * uniforms and make k values that sum to 1. */
#ifndef SG_GRAMMAR_DISTRIBUTION_H
#define SG_GRAMMAR_DISTRIBUTION_H

#include "core/status.h"
#include "grammar/expr.h"

#include <stdbool.h>
#include <stdint.h>

typedef enum {
    SG_DRAW_UNIFORM,          /* low, high */
    SG_DRAW_NORMAL,           /* mean, sd */
    SG_DRAW_TRUNCATED_NORMAL, /* mean, sd, low, high */
    SG_DRAW_MIXTURE,          /* (weight, mean, sd) ...: two uniforms, which normal and where in it */
    SG_DRAW_DISCRETE,         /* (weight, value) ... */
    SG_DRAW_SIMPLEX,          /* means and covariance of relative sizes */
} sg_draw_kind;

typedef struct sg_simplex sg_simplex; /* conditional moments, made once */

typedef struct {
    sg_draw_kind kind;
    const char *name; /* NULL when anonymous */
    uint32_t nargs;
    const sg_expr *args;   /* over the parameters and the draws before this one */
    const double *constants; /* [nargs] their values when they depend on neither, else NULL */
    uint32_t nuniforms;
    uint32_t nvalues;
    uint32_t first_uniform; /* among the uniforms of the node */
    uint32_t first_value;   /* among the draw values of the node: frame slot nparams + first_value */
    const sg_simplex *simplex; /* SIMPLEX only */
} sg_draw;

struct sg_grammar;

/** A uniform as a number in (0,1), whichever way it is written. */
static inline double sg_uniform_plain(double u)
{
    return u >= 0 ? u : 1 + u < 1 ? 1 + u : 1 - 0x1p-53;
}

/** Values of a draw from its uniforms, by inverse cumulative distribution functions.
 *  @param frame  parameters and earlier draw values
 *  @param u      [nuniforms] in (0,1), or (-1,0) as above
 *  @param value  out [nvalues]
 *  @return SG_OK, SG_ENUMERIC (impossible parameters: sd <= 0, low >= high, weights negative or all zero, NaN) */
sg_status sg_draw_transform(const struct sg_grammar *g, const sg_draw *d, const double *frame, double depth,
                            const double *u, double *value, sg_error *err);

/** Values and their log density, for less than the two one by one. log_density: out, as below */
sg_status sg_draw_transform_density(const struct sg_grammar *g, const sg_draw *d, const double *frame, double depth,
                                    const double *u, double *value, double *log_density, sg_error *err);

/** The uniforms that give these values: the inverse of the above (for mixtures one of them).
 *  @return SG_OK, SG_ENUMERIC (a value has density 0) */
sg_status sg_draw_invert(const struct sg_grammar *g, const sg_draw *d, const double *frame, double depth,
                         const double *value, double *u, sg_error *err);

/** Uniforms given the values, drawn from what is left to chance: with the fresh ones that stand in u the result is distributed
 *  as those of the prior are, given these values. So a mixture's component is drawn from its posterior, and a discrete draw's
 *  uniform within the share of the value; elsewhere the uniform follows from the value. The values that sg_draw_transform()
 *  makes of them are these up to 1e-9 (relative above 1), and the very same where a double allows it.
 *  @param value  [nvalues]; of sizes the last one is the remainder, and may differ from that by 1e-6
 *  @param u      in and out [nuniforms]
 *  @return SG_OK, SG_ENUMERIC (a value outside of the support, which the sentence names, or too far in a tail; impossible
 *          parameters), SG_ENOMEM */
sg_status sg_draw_condition(const struct sg_grammar *g, const sg_draw *d, const double *frame, double depth,
                            const double *value, double *u, sg_error *err);

/** Log density of the values in value space: for sizes over the first k-1 of them; for discrete draws log probability.
 *  -INFINITY outside the support. */
sg_status sg_draw_log_density(const struct sg_grammar *g, const sg_draw *d, const double *frame, double depth,
                              const double *value, double *log_density, sg_error *err);

/** Untruncated mean [k] and covariance [k-1][k-1] that a simplex draw was made from; k = nvalues. Borrowed. */
const double *sg_simplex_mean(const sg_simplex *s);
const double *sg_simplex_covariance(const sg_simplex *s);

#endif
