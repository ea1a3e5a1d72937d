/* SPDX-License-Identifier: GPL-3.0-or-later */
/* simplex.h - sizes of learned splits for those who change them often: terms that are kept, and updated where they change.
 *
 * The log density of k sizes is a sum over the k-1 that are drawn. A term holds what one of them adds; who keeps the terms
 * of a draw gets the effect of moving one boundary for the price of what it changes. Terms are made together with the
 * sizes, or from them. Everything here is in the units of the sizes, shares of 1. */
#ifndef SG_GRAMMAR_SIMPLEX_H
#define SG_GRAMMAR_SIMPLEX_H

#include "grammar/distribution.h"

#include <stdbool.h>
#include <stddef.h>

/** One size, a truncated normal given those before it. Its log density is exponent - log mass - log sd. */
typedef struct {
    double centre;   /* conditional mean / sd */
    double exponent; /* log of the normal density; where the mean is not between the bounds, over that at the nearer one */
    double mass;     /* between the bounds, in the same scale */
} sg_simplex_term;

/** Uniforms to sizes, all of them > 0, that sum to 1.
 *  @param u      [k-1] in (0,1), or (-1,0) for what is near 1 (distribution.h)
 *  @param value  out [k] */
void sg_simplex_transform(const sg_simplex *s, const double *u, double *value);
/** The same, and their log density over the first k-1 sizes. */
double sg_simplex_draw(const sg_simplex *s, const double *u, double *value);
/** The same from size `first` on: the ones before it stand in value already, with their terms.
 *  @param terms  in and out [k-1], or NULL */
void sg_simplex_transform_from(const sg_simplex *s, size_t first, const double *u, double *value,
                               sg_simplex_term *terms);

/** Sizes to uniforms. @return false when the sizes are not inside the simplex */
bool sg_simplex_invert(const sg_simplex *s, const double *value, double *u);
/** The same from uniform `first` on, of sizes that are inside the simplex: those before it are not touched.
 *  @param terms  [k-1] of these sizes, or NULL */
void sg_simplex_invert_from(const sg_simplex *s, size_t first, const double *value, const sg_simplex_term *terms,
                            double *u);

/** The same of sizes that were shifted at j (sg_simplex_shift()): the uniforms that this changes. */
void sg_simplex_invert_shifted(const sg_simplex *s, size_t j, const double *value, const sg_simplex_term *terms, double *u);

/** Terms of sizes: out [k-1]. @return false when the sizes are not inside the simplex */
bool sg_simplex_terms(const sg_simplex *s, const double *value, sg_simplex_term *terms);
/** Log density over the first k-1 sizes; -INFINITY outside of the simplex. */
double sg_simplex_log_density(const sg_simplex *s, const double *value);
/** The same from terms: O(k), one logarithm. */
double sg_simplex_log_density_of_terms(const sg_simplex *s, const sg_simplex_term *terms);

/** What it does to the log density when size j grows by e and size j+1, which may be the last, shrinks by it. No terms before
 *  j change, and none behind j+1 where the covariance is that of independent sizes, given their sum or not.
 *  @param value    [k] the sizes as they are; j < k-1
 *  @param terms    [k-1] of them, or NULL: then those that count are made anew
 *  @param shifted  out [k-1], the terms after the change, or NULL; may be `terms`. Worth nothing when -INFINITY is returned
 *  @return log density after less before; -INFINITY when one of the two sizes would not be > 0 */
double sg_simplex_shift(const sg_simplex *s, const double *value, const sg_simplex_term *terms, size_t j, double e,
                        sg_simplex_term *shifted);

#endif
