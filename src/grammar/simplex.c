/* SPDX-License-Identifier: GPL-3.0-or-later */
/* simplex.c - sizes of learned splits: conditional moments, uniforms to sizes and back, densities. */
#include "config.h"

#include "grammar/simplex_priv.h"

#include <lapacke.h>

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

/* True when row j is one number, up to rounding. */
static bool even_row(const double *row, size_t j)
{
    for (size_t i = 1; i < j; i++)
        if (!(fabs(row[i] - row[0]) <= 1e-13 * (1 + fabs(row[0]))))
            return false;
    return true;
}

static bool even_rows(const double *weight, size_t n)
{
    for (size_t j = 0; j < n; j++)
        if (!even_row(weight + j * n, j))
            return false;
    return true;
}

/* Weights become pulls, in units of sd. */
static void scale_row(const double *mean, size_t j, double *row, sg_size_model *m)
{
    for (size_t i = 0; i < j; i++) {
        m->centre -= row[i] * mean[i] / m->sd;
        row[i] /= m->sd;
    }
    m->pull = j > 0 ? row[0] : 0;
    if (even_row(row, j) && m->pull == 0)
        m->below = sg_truncated_below(-m->centre);
}

static void make_sizes(const double *mean, const double *sd, size_t n, double *weight, sg_size_model *sizes)
{
    for (size_t j = 0; j < n; j++) {
        sizes[j] = (sg_size_model){.sd = sd[j], .rate = 1 / sd[j], .centre = mean[j] / sd[j], .below = -1};
        scale_row(mean, j, weight + j * n, sizes + j);
    }
}

static double sum_of_logs(const double *x, size_t n)
{
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += log(x[i]);
    return sum;
}

sg_status sg_simplex_create(sg_arena *arena, size_t k, const double *mean, const double *covariance,
                            const sg_simplex **out, sg_error *err)
{
    const size_t n = k - 1;
    sg_simplex *s = SG_NEW(arena, sg_simplex);
    double *factor = sg_arena_copy(arena, covariance, n * n * sizeof *factor);
    double *weight = SG_NEW_ARRAY(arena, double, n * n);
    double *sd = SG_NEW_ARRAY(arena, double, n);
    sg_size_model *sizes = SG_NEW_ARRAY(arena, sg_size_model, n);
    double *mean_copy = sg_arena_copy(arena, mean, k * sizeof *mean);
    double *covariance_copy = sg_arena_copy(arena, covariance, n * n * sizeof *covariance);
    if (s == NULL || factor == NULL || weight == NULL || sd == NULL || sizes == NULL || mean_copy == NULL ||
        covariance_copy == NULL)
        return SG_FAIL_NOMEM(err);
    /* The upper triangle by columns is the lower one by rows; so said, LAPACKE needs no transposed copy. */
    if (n > 0 && LAPACKE_dpotrf(LAPACK_COL_MAJOR, 'U', (lapack_int)n, factor, (lapack_int)n) != 0)
        return SG_FAIL(err, SG_ENUMERIC, "the covariance of the sizes is not positive definite");
    condition(factor, n, weight, sd);
    const bool even = even_rows(weight, n);
    make_sizes(mean, sd, n, weight, sizes);
    *s = (sg_simplex){k, mean_copy, covariance_copy, sizes, even ? NULL : weight, sum_of_logs(sd, n)};
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

/* Draw a size: its term, and the size itself. */
static inline sg_simplex_term draw_size(const sg_size_model *m, double centre, double rest, double u, double *value)
{
    const double width = rest * m->rate;
    double mass;
    const double v = m->sd * sg_truncated_distance(-centre, width, sg_size_below(m, centre), u, &mass);
    /* A size of nothing, or nothing left, would end the chain of conditionals: keep an ulp. */
    const double least = 0x1p-60 * rest, most = rest * (1 - 0x1p-50);
    *value = v > least && v < most ? v : v > least ? most : least;
    return (sg_simplex_term){centre, sg_truncated_exponent(-centre, width, *value * m->rate), mass};
}

void sg_simplex_transform_from(const sg_simplex *s, size_t first, const double *u, double *value,
                               sg_simplex_term *terms)
{
    double rest = sg_simplex_rest(first, value);
    for (size_t j = first; j + 1 < s->k; j++) {
        const sg_simplex_term t = draw_size(s->sizes + j, sg_size_centre(s, j, value, rest), rest, u[j], value + j);
        if (terms != NULL)
            terms[j] = t;
        rest -= value[j];
    }
    value[s->k - 1] = rest;
}

double sg_simplex_draw(const sg_simplex *s, const double *u, double *value)
{
    double rest = 1, sum = -s->log_sds;
    sg_log_sum masses = {1, 0};
    for (size_t j = 0; j + 1 < s->k; j++) {
        const sg_simplex_term t = draw_size(s->sizes + j, sg_size_centre(s, j, value, rest), rest, u[j], value + j);
        sum += t.exponent;
        sg_log_multiply(&masses, t.mass);
        rest -= value[j];
    }
    value[s->k - 1] = rest;
    return sum - sg_log_total(&masses);
}

void sg_simplex_transform(const sg_simplex *s, const double *u, double *value)
{
    sg_simplex_transform_from(s, 0, u, value, NULL);
}

static bool inside(const sg_simplex *s, const double *value)
{
    double rest = 1;
    for (size_t j = 0; j + 1 < s->k; j++) {
        if (!(value[j] > 0 && value[j] < rest))
            return false;
        rest -= value[j];
    }
    return true;
}

bool sg_simplex_terms(const sg_simplex *s, const double *value, sg_simplex_term *terms)
{
    double rest = 1;
    for (size_t j = 0; j + 1 < s->k; j++) {
        if (!(value[j] > 0 && value[j] < rest))
            return false;
        terms[j] = sg_size_term(s->sizes + j, sg_size_centre(s, j, value, rest), value[j], rest);
        rest -= value[j];
    }
    return true;
}

/* The mass below t, or with a minus sign what is above it where that is little. */
static double uniform_of(double a, double width, double mass, double t)
{
    const double u = sg_truncated_share(a, width, mass, t);
    if (u <= 1 - 1e-6)
        return fmax(u, 0x1p-1022);
    return -fmax(sg_truncated_share_above(a, width, mass, t), 0x1p-1022);
}

/* Uniforms first ... end-1. */
static void invert_range(const sg_simplex *s, size_t first, size_t end, const double *value, const sg_simplex_term *terms,
                         double *u)
{
    double rest = sg_simplex_rest(first, value);
    for (size_t j = first; j < end; j++) {
        const sg_size_model *m = s->sizes + j;
        const double centre = terms != NULL ? terms[j].centre : sg_size_centre(s, j, value, rest);
        const double width = rest * m->rate;
        const double mass = terms != NULL ? terms[j].mass : sg_truncated_mass(-centre, width, sg_size_below(m, centre));
        u[j] = uniform_of(-centre, width, mass, value[j] * m->rate);
        rest -= value[j];
    }
}

void sg_simplex_invert_from(const sg_simplex *s, size_t first, const double *value, const sg_simplex_term *terms,
                            double *u)
{
    invert_range(s, first, s->k - 1, value, terms, u);
}

void sg_simplex_invert_shifted(const sg_simplex *s, size_t j, const double *value, const sg_simplex_term *terms, double *u)
{
    const size_t n = s->k - 1;
    invert_range(s, j, s->pull == NULL && j + 2 < n ? j + 2 : n, value, terms, u);
}

bool sg_simplex_invert(const sg_simplex *s, const double *value, double *u)
{
    if (!inside(s, value))
        return false;
    sg_simplex_invert_from(s, 0, value, NULL, u);
    return true;
}

double sg_simplex_log_density(const sg_simplex *s, const double *value)
{
    double rest = 1, sum = -s->log_sds;
    sg_log_sum masses = {1, 0};
    for (size_t j = 0; j + 1 < s->k; j++) {
        if (!(value[j] > 0 && value[j] < rest))
            return -INFINITY;
        const sg_simplex_term t = sg_size_term(s->sizes + j, sg_size_centre(s, j, value, rest), value[j], rest);
        sum += t.exponent;
        sg_log_multiply(&masses, t.mass);
        rest -= value[j];
    }
    return sum - sg_log_total(&masses);
}

double sg_simplex_log_density_of_terms(const sg_simplex *s, const sg_simplex_term *terms)
{
    double sum = -s->log_sds;
    sg_log_sum masses = {1, 0};
    for (size_t j = 0; j + 1 < s->k; j++) {
        sum += terms[j].exponent;
        sg_log_multiply(&masses, terms[j].mass);
    }
    return sum - sg_log_total(&masses);
}
