/* SPDX-License-Identifier: GPL-3.0-or-later */
/* simplex.c - sizes of learned splits. Size j given those before it is a normal with mean
 *   mean_j + sum_{i<j} weight_ji (s_i - mean_i)   and standard deviation sd_j,
 * from the Cholesky factor of the covariance, truncated to (0, what is left). The last size is what is left. */
#include "config.h"

#include "grammar/simplex_priv.h"
#include "grammar/truncated.h"

#include <lapacke.h>
#include <math.h>

struct sg_simplex {
    size_t k;
    const double *mean;       /* [k] */
    const double *covariance; /* [k-1][k-1] */
    const double *weight;     /* [k-1][k-1], strictly lower triangle */
    const double *sd;         /* [k-1] */
};

/* From the lower factor L: sd_j = L_jj, and row j of the weights solves w L' = L_j over the first j columns. */
static void condition(const double *factor, size_t n, double *weight, double *sd)
{
    for (size_t j = 0; j < n; j++) {
        sd[j] = factor[j * n + j];
        for (size_t c = j; c-- > 0;) {
            double w = factor[j * n + c];
            for (size_t i = c + 1; i < j; i++)
                w -= weight[j * n + i] * factor[i * n + c];
            weight[j * n + c] = w / factor[c * n + c];
        }
    }
}

sg_status sg_simplex_create(sg_arena *arena, size_t k, const double *mean, const double *covariance,
                            const sg_simplex **out, sg_error *err)
{
    const size_t n = k - 1;
    sg_simplex *s = SG_NEW(arena, sg_simplex);
    double *factor = sg_arena_copy(arena, covariance, n * n * sizeof *factor);
    double *weight = SG_NEW_ARRAY(arena, double, n * n);
    double *sd = SG_NEW_ARRAY(arena, double, n);
    double *mean_copy = sg_arena_copy(arena, mean, k * sizeof *mean);
    double *covariance_copy = sg_arena_copy(arena, covariance, n * n * sizeof *covariance);
    if (s == NULL || factor == NULL || weight == NULL || sd == NULL || mean_copy == NULL || covariance_copy == NULL)
        return SG_FAIL_NOMEM(err);
    /* The upper triangle by columns is the lower one by rows; so said, LAPACKE needs no transposed copy. */
    if (n > 0 && LAPACKE_dpotrf(LAPACK_COL_MAJOR, 'U', (lapack_int)n, factor, (lapack_int)n) != 0)
        return SG_FAIL(err, SG_ENUMERIC, "the covariance of the sizes is not positive definite");
    condition(factor, n, weight, sd);
    *s = (sg_simplex){k, mean_copy, covariance_copy, weight, sd};
    *out = s;
    return SG_OK;
}

const double *sg_simplex_mean(const sg_simplex *s)
{
    return s->mean;
}

const double *sg_simplex_covariance(const sg_simplex *s)
{
    return s->covariance;
}

static double conditional_mean(const sg_simplex *s, size_t j, const double *value)
{
    double m = s->mean[j];
    for (size_t i = 0; i < j; i++)
        m += s->weight[j * (s->k - 1) + i] * (value[i] - s->mean[i]);
    return m;
}

void sg_simplex_transform(const sg_simplex *s, const double *u, double *value)
{
    double rest = 1;
    for (size_t j = 0; j + 1 < s->k; j++) {
        double v = sg_truncated_quantile(conditional_mean(s, j, value), s->sd[j], 0, rest, u[j]);
        /* A size of nothing, or nothing left, would end the chain of conditionals: keep an ulp. */
        v = fmin(fmax(v, 0x1p-60 * rest), rest * (1 - 0x1p-50));
        value[j] = v;
        rest -= v;
    }
    value[s->k - 1] = rest;
}

bool sg_simplex_invert(const sg_simplex *s, const double *value, double *u)
{
    double rest = 1;
    for (size_t j = 0; j + 1 < s->k; j++) {
        if (!(value[j] > 0 && value[j] < rest))
            return false;
        u[j] = sg_truncated_cdf(conditional_mean(s, j, value), s->sd[j], 0, rest, value[j]);
        u[j] = fmin(fmax(u[j], 0x1p-60), 1 - 0x1p-53);
        rest -= value[j];
    }
    return true;
}

double sg_simplex_log_density(const sg_simplex *s, const double *value)
{
    double rest = 1, sum = 0;
    for (size_t j = 0; j + 1 < s->k; j++) {
        if (!(value[j] > 0 && value[j] < rest))
            return -INFINITY;
        sum += sg_truncated_log_density(conditional_mean(s, j, value), s->sd[j], 0, rest, value[j]);
        rest -= value[j];
    }
    return sum;
}
