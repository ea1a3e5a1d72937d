/* SPDX-License-Identifier: GPL-3.0-or-later */
/* simplex_priv.h - the sequential truncated normal on the simplex of relative sizes (DESIGN 5.3). */
#ifndef SG_GRAMMAR_SIMPLEX_PRIV_H
#define SG_GRAMMAR_SIMPLEX_PRIV_H

#include "core/arena.h"
#include "grammar/distribution.h"

/** Make the conditional moments of k sizes.
 *  @param covariance  [k-1][k-1], symmetric
 *  @return SG_OK, SG_ENUMERIC (the covariance is not positive definite), SG_ENOMEM */
sg_status sg_simplex_create(sg_arena *arena, size_t k, const double *mean, const double *covariance,
                            const sg_simplex **out, sg_error *err);

/** [k-1] uniforms to [k] sizes, all of them > 0, that sum to 1. */
void sg_simplex_transform(const sg_simplex *s, const double *u, double *value);
/** @return false when the sizes are not inside the simplex */
bool sg_simplex_invert(const sg_simplex *s, const double *value, double *u);
double sg_simplex_log_density(const sg_simplex *s, const double *value);

#endif
