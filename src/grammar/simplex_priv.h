/* SPDX-License-Identifier: GPL-3.0-or-later */
/* simplex_priv.h - the sequential truncated normal on the simplex of relative sizes (DESIGN 5.3). */
#ifndef SG_GRAMMAR_SIMPLEX_PRIV_H
#define SG_GRAMMAR_SIMPLEX_PRIV_H

#include "core/arena.h"
#include "grammar/simplex.h"

/** Make the conditional moments of k sizes.
 *  @param covariance  [k-1][k-1], symmetric
 *  @return SG_OK, SG_ENUMERIC (the covariance is not positive definite), SG_ENOMEM */
sg_status sg_simplex_create(sg_arena *arena, size_t k, const double *mean, const double *covariance,
                            const sg_simplex **out, sg_error *err);

#endif
