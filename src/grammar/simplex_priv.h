/* SPDX-License-Identifier: GPL-3.0-or-later */
/* simplex_priv.h - the sequential truncated normal on the simplex of relative sizes (DESIGN 5.3): what its files share.
 *
 * Size j given those before it is a normal with mean
 *   mean_j + sum_{i<j} weight_ji (s_i - mean_i)   and standard deviation sd_j,
 * from the Cholesky factor of the covariance, truncated to (0, what is left). The last size is what is left. Everything is
 * done in units of sd_j, so that the mean is centre_j + sum_{i<j} pull_ji s_i. Where the sizes are independent, or
 * independent given their sum (learned splits with one example, and all that are written with "sd"), row j of the pulls is
 * one number, and the sum is what is no longer left: no loop. */
#ifndef SG_GRAMMAR_SIMPLEX_PRIV_H
#define SG_GRAMMAR_SIMPLEX_PRIV_H

#include "core/arena.h"
#include "grammar/simplex.h"
#include "grammar/truncated.h"

#include <math.h>

typedef struct {
    double sd, rate; /* rate: 1 / sd */
    double centre;   /* when all sizes before are 0 */
    double pull;     /* of each size before it, when they are all the same */
    double below;    /* sg_truncated_below(-centre) where the centre is constant, else -1 */
} sg_size_model;

struct sg_simplex {
    size_t k;
    const double *mean;         /* [k] */
    const double *covariance;   /* [k-1][k-1] */
    const sg_size_model *sizes; /* [k-1] */
    const double *pull;         /* [k-1][k-1], strictly lower triangle; NULL: that of the size_model */
    double log_sds;             /* sum */
};

/** Make the conditional moments of k sizes.
 *  @param covariance  [k-1][k-1], symmetric
 *  @return SG_OK, SG_ENUMERIC (the covariance is not positive definite), SG_ENOMEM */
sg_status sg_simplex_create(sg_arena *arena, size_t k, const double *mean, const double *covariance,
                            const sg_simplex **out, sg_error *err);

/** What the sizes before `first` leave. */
static inline double sg_simplex_rest(size_t first, const double *value)
{
    double rest = 1;
    for (size_t j = 0; j < first; j++)
        rest -= value[j];
    return rest;
}

/** Conditional mean of size j in units of its sd; rest: sg_simplex_rest(j). Every second product is summed apart, so that
 *  one sum need not wait for the other. */
static inline double sg_size_centre(const sg_simplex *s, size_t j, const double *value, double rest)
{
    const sg_size_model *m = s->sizes + j;
    if (s->pull == NULL)
        return m->centre + m->pull * (1 - rest);
    const double *pull = s->pull + j * (s->k - 1);
    double even = m->centre, odd = 0;
    size_t i = 0;
    for (; i + 1 < j; i += 2) {
        even += pull[i] * value[i];
        odd += pull[i + 1] * value[i + 1];
    }
    return even + odd + (i < j ? pull[i] * value[i] : 0);
}

static inline double sg_size_below(const sg_size_model *m, double centre)
{
    return m->below >= 0 ? m->below : sg_truncated_below(-centre);
}

static inline sg_simplex_term sg_size_term(const sg_size_model *m, double centre, double value, double rest)
{
    const double width = rest * m->rate;
    return (sg_simplex_term){centre, sg_truncated_exponent(-centre, width, value * m->rate),
                             sg_truncated_mass(-centre, width, sg_size_below(m, centre))};
}

/** A sum of logarithms as the logarithm of a product, as long as that is a number. */
typedef struct {
    double product, sum;
} sg_log_sum;

static inline void sg_log_multiply(sg_log_sum *l, double x)
{
    l->product *= x;
    if (l->product > 1e-100 && l->product < 1e100)
        return;
    l->sum += log(l->product);
    l->product = 1;
}

static inline double sg_log_total(const sg_log_sum *l)
{
    return l->sum + log(l->product);
}

#endif
