/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sampler_support.h - is a sampler's mean the right one? Means with standard errors that know of autocorrelation. */
#ifndef SG_TESTS_SAMPLER_SUPPORT_H
#define SG_TESTS_SAMPLER_SUPPORT_H

#include "tests/support.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stddef.h>

enum { BATCHES = 50, MAX_FEATURES = 10 };

/** Means over a chain, by batches that are much longer than its memory: their scatter tells the error. */
typedef struct {
    size_t n, nfeatures, batch_length;
    double batch[BATCHES][MAX_FEATURES];
} batch_means;

static inline void batch_means_init(batch_means *b, size_t nfeatures, size_t total)
{
    *b = (batch_means){.nfeatures = nfeatures, .batch_length = total / BATCHES};
}

static inline void batch_means_add(batch_means *b, const double *feature)
{
    const size_t i = b->n++ / b->batch_length;
    for (size_t k = 0; i < BATCHES && k < b->nfeatures; k++)
        b->batch[i][k] += feature[k] / (double)b->batch_length;
}

static inline double batch_means_mean(const batch_means *b, size_t k)
{
    double sum = 0;
    for (size_t i = 0; i < BATCHES; i++)
        sum += b->batch[i][k];
    return sum / BATCHES;
}

static inline double batch_means_error(const batch_means *b, size_t k)
{
    const double mean = batch_means_mean(b, k);
    double sum = 0;
    for (size_t i = 0; i < BATCHES; i++)
        sum += (b->batch[i][k] - mean) * (b->batch[i][k] - mean);
    return sqrt(sum / (BATCHES - 1.0) / BATCHES);
}

/** Standard errors between the mean and what it should be; an exact hit of a constant is 0. */
static inline double batch_means_z(const batch_means *b, size_t k, double right)
{
    const double off = fabs(batch_means_mean(b, k) - right), error = batch_means_error(b, k);
    return off <= 1e-9 * fmax(1, fabs(right)) ? 0 : off / error;
}

/** p of the Kolmogorov-Smirnov test that n sorted values are uniform on (0,1): asymptotic, with Stephens' correction.
 */
static inline double test_ks_p(const double *sorted, size_t n)
{
    double d = 0, p = 0;
    for (size_t i = 0; i < n; i++)
        d = fmax(d, fmax(sorted[i] - (double)i / (double)n, (double)(i + 1) / (double)n - sorted[i]));
    const double root = sqrt((double)n), t = (root + 0.12 + 0.11 / root) * d;
    for (int k = 1; k <= 100; k++)
        p += (k % 2 == 1 ? 2 : -2) * exp(-2.0 * k * k * t * t);
    return t < 0.2 ? 1 : p;
}

#endif
