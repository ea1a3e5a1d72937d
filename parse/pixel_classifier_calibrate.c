/* SPDX-License-Identifier: GPL-3.0-or-later */
/* pixel_classifier_calibrate.c - exponent by accuracy, temperature by log loss. */
#include "config.h"

#include "parse/pixel_classifier_calibrate.h"

#include "parse/pixel_classifier_priv.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_min.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { TEMPERATURES = 25, BLOCK = 4096, MAX_STEPS = 100 };
#define LEAST_LOG_TEMPERATURE (-3.0)
#define MOST_LOG_TEMPERATURE 3.0

void sg_pixel_judgements_clear(sg_pixel_judgements *j)
{
    free(j->p);
    free(j->classes);
    memset(j, 0, sizeof *j);
}

/* ---- score ---- */

static size_t most_probable(const float *p, size_t n)
{
    size_t best = 0;
    for (size_t k = 1; k < n; k++)
        if (p[k] > p[best])
            best = k;
    return best;
}

static void average_accuracy(const double *right, const double *all, size_t nclasses, const sg_pixel_weights *weights,
                             sg_pixel_score *s)
{
    double weight_right = 0, weight = 0, sum = 0, present = 0;
    for (size_t k = 0; k < nclasses; k++) {
        weight_right += weights->accuracy[k] * right[k];
        weight += weights->accuracy[k] * all[k];
        present += all[k] > 0;
        sum += all[k] > 0 ? right[k] / all[k] : 0;
    }
    s->overall = weight_right / weight;
    s->class_average = sum / present;
}

sg_pixel_score sg_pixel_score_of(const sg_pixel_judgements *j, const sg_calibration *c, const double *frequency,
                                 const sg_pixel_weights *weights)
{
    sg_pixel_score s = {0};
    double right[SG_MAX_CLASSES] = {0}, all[SG_MAX_CLASSES] = {0}, loss[SG_MAX_CLASSES] = {0};
    float shift[SG_MAX_CLASSES];
    sg_pixel_calibration_shift(c, frequency, j->nclasses, shift);
    for (size_t i = 0; i < j->n; i++) {
        float p[SG_MAX_CLASSES];
        const size_t truth = j->classes[i];
        memcpy(p, j->p + i * j->nclasses, j->nclasses * sizeof *p);
        sg_pixel_calibrate(c, shift, j->nclasses, p);
        all[truth]++;
        right[truth] += most_probable(p, j->nclasses) == truth;
        loss[truth] -= log((double)p[truth]);
    }
    average_accuracy(right, all, j->nclasses, weights, &s);
    double sum = 0, weight = 0;
    for (size_t k = 0; k < j->nclasses; k++) {
        s.recall[k] = right[k] / all[k];
        sum += weights->loss[k] * loss[k];
        weight += weights->loss[k] * all[k];
    }
    s.log_loss = sum / weight;
    return s;
}

/* ---- exponent ---- */

/* Logs of p are given. */
static sg_pixel_tradeoff accuracy_at(const sg_pixel_judgements *j, const float *logs, const double *frequency,
                                     double exponent, const sg_pixel_weights *weights)
{
    const sg_calibration c = {1, exponent, false};
    double right[SG_MAX_CLASSES] = {0}, all[SG_MAX_CLASSES] = {0};
    float shift[SG_MAX_CLASSES];
    sg_pixel_calibration_shift(&c, frequency, j->nclasses, shift);
    for (size_t i = 0; i < j->n; i++) {
        const float *p = logs + i * j->nclasses;
        size_t best = 0;
        for (size_t k = 1; k < j->nclasses; k++)
            if (p[k] - shift[k] > p[best] - shift[best])
                best = k;
        all[j->classes[i]]++;
        right[j->classes[i]] += best == j->classes[i];
    }
    sg_pixel_score s;
    average_accuracy(right, all, j->nclasses, weights, &s);
    return (sg_pixel_tradeoff){exponent, s.overall, s.class_average};
}

static double best_exponent(const sg_pixel_tradeoff *curve)
{
    size_t best = 0;
    for (size_t i = 1; i < SG_PIXEL_EXPONENTS; i++)
        if (curve[i].overall + curve[i].class_average > curve[best].overall + curve[best].class_average)
            best = i;
    return curve[best].exponent;
}

static void draw_curve(const sg_pixel_judgements *j, const float *logs, const double *frequency,
                       const sg_pixel_weights *weights, int threads, sg_progress *progress, sg_pixel_tradeoff *curve)
{
    bool stopped = false;
#pragma omp parallel for schedule(dynamic) num_threads(threads)
    for (size_t i = 0; i < SG_PIXEL_EXPONENTS; i++) {
        bool skip;
#pragma omp critical(sg_calibration)
        skip = stopped = stopped || sg_progress_stopped(progress);
        if (!skip)
            curve[i] = accuracy_at(j, logs, frequency, (double)i / (SG_PIXEL_EXPONENTS - 1), weights);
    }
}

/* ---- temperature ---- */

typedef struct {
    const sg_pixel_judgements *judgements;
    const float *logs; /* [n][nclasses] of p, less the shift of the exponent */
    const double *weights; /* [nclasses] */
    double *parts; /* [blocks] sums of losses: added in their order whoever makes them */
    int threads;
    sg_progress *progress;
} loss_problem;

static double block_loss(const loss_problem *l, size_t block, double scale)
{
    const sg_pixel_judgements *j = l->judgements;
    const size_t end = (block + 1) * BLOCK < j->n ? (block + 1) * BLOCK : j->n;
    double sum = 0;
    for (size_t i = block * BLOCK; i < end; i++) {
        const float *p = l->logs + i * j->nclasses;
        const float most = p[most_probable(p, j->nclasses)];
        float total = 0;
        for (size_t k = 0; k < j->nclasses; k++)
            total += expf((p[k] - most) * (float)scale);
        const double truth = (double)(p[j->classes[i]] - most) * scale;
        sum += l->weights[j->classes[i]] * (log((double)total) - truth);
    }
    return sum;
}

/* Sum of the losses at a temperature, less a constant factor. */
static double loss_at(double log_temperature, void *params)
{
    const loss_problem *l = params;
    const size_t nblocks = (l->judgements->n + BLOCK - 1) / BLOCK;
    const double scale = exp(-log_temperature);
    double sum = 0;
#pragma omp parallel for schedule(static) num_threads(l->threads)
    for (size_t b = 0; b < nblocks; b++)
        l->parts[b] = block_loss(l, b, scale);
    for (size_t b = 0; b < nblocks; b++)
        sum += l->parts[b];
    return sum;
}

static sg_status refine(gsl_min_fminimizer *m, sg_progress *progress, double *at, sg_error *err)
{
    for (int i = 0; i < MAX_STEPS; i++) {
        if (sg_progress_stopped(progress))
            return SG_FAIL(err, SG_STOPPED, "stopped");
        if (gsl_min_fminimizer_iterate(m) != GSL_SUCCESS)
            return SG_FAIL(err, SG_ENUMERIC, "the temperature cannot be fitted");
        const double low = gsl_min_fminimizer_x_lower(m), high = gsl_min_fminimizer_x_upper(m);
        if (gsl_min_test_interval(low, high, 1e-5, 0) == GSL_SUCCESS)
            break;
    }
    *at = gsl_min_fminimizer_x_minimum(m);
    return SG_OK;
}

/* The least of a grid lies between two higher neighbours, unless it is at an end: then that end it is. */
static sg_status fit_temperature(loss_problem *l, double *temperature, sg_error *err)
{
    const double step = (MOST_LOG_TEMPERATURE - LEAST_LOG_TEMPERATURE) / (TEMPERATURES - 1);
    double loss[TEMPERATURES];
    size_t best = 0;
    for (size_t i = 0; i < TEMPERATURES; i++) {
        if (sg_progress_stopped(l->progress))
            return SG_FAIL(err, SG_STOPPED, "stopped");
        loss[i] = loss_at(LEAST_LOG_TEMPERATURE + step * (double)i, l);
        best = loss[i] < loss[best] ? i : best;
    }
    double at = LEAST_LOG_TEMPERATURE + step * (double)best;
    *temperature = exp(at);
    if (best == 0 || best == TEMPERATURES - 1 || loss[best] >= loss[best - 1] || loss[best] >= loss[best + 1])
        return SG_OK;
    gsl_function f = {loss_at, l};
    gsl_min_fminimizer *m = gsl_min_fminimizer_alloc(gsl_min_fminimizer_brent);
    if (m == NULL)
        return SG_FAIL_NOMEM(err);
    sg_status st = SG_OK;
    if (gsl_min_fminimizer_set_with_values(m, &f, at, loss[best], at - step, loss[best - 1], at + step,
                                           loss[best + 1]) != GSL_SUCCESS)
        st = SG_FAIL(err, SG_ENUMERIC, "the temperature cannot be fitted");
    if (st == SG_OK)
        st = refine(m, l->progress, &at, err);
    gsl_min_fminimizer_free(m);
    *temperature = exp(at);
    return st;
}

static sg_status fit(const sg_pixel_judgements *j, const double *frequency, const sg_pixel_weights *weights,
                     bool fit_exponent, int threads, sg_progress *progress, float *logs, double *parts,
                     sg_pixel_tradeoff *curve, sg_calibration *out, sg_error *err)
{
    sg_calibration c = {1, 0, true};
    sg_pixel_tradeoff mine[SG_PIXEL_EXPONENTS];
    float shift[SG_MAX_CLASSES];
    for (size_t i = 0; i < j->n * j->nclasses; i++)
        logs[i] = logf(j->p[i]);
    if (fit_exponent || curve != NULL)
        draw_curve(j, logs, frequency, weights, threads, progress, mine);
    if (sg_progress_stopped(progress))
        return SG_FAIL(err, SG_STOPPED, "stopped");
    if (fit_exponent)
        c.exponent = best_exponent(mine);
    if (curve != NULL)
        memcpy(curve, mine, sizeof mine);
    sg_pixel_calibration_shift(&c, frequency, j->nclasses, shift);
    for (size_t i = 0; i < j->n * j->nclasses; i++)
        logs[i] -= shift[i % j->nclasses];
    loss_problem l = {j, logs, weights->loss, parts, threads, progress};
    SG_TRY(fit_temperature(&l, &c.temperature, err));
    *out = c;
    return SG_OK;
}

sg_status sg_pixel_calibration_fit(const sg_pixel_judgements *j, const double *frequency,
                                   const sg_pixel_weights *weights, bool fit_exponent, int threads, sg_progress *progress,
                                   sg_pixel_tradeoff *curve, sg_calibration *out, sg_error *err)
{
    if (j->n == 0)
        return SG_FAIL(err, SG_EINVAL, "no pixels to calibrate with");
    float *logs = malloc(j->n * j->nclasses * sizeof *logs);
    double *parts = malloc((j->n / BLOCK + 1) * sizeof *parts);
    const sg_status st = logs != NULL && parts != NULL
                             ? fit(j, frequency, weights, fit_exponent, threads, progress, logs, parts, curve, out,
                                   err)
                             : SG_FAIL_NOMEM(err);
    free(logs);
    free(parts);
    return st;
}
