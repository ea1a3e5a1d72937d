/* SPDX-License-Identifier: GPL-3.0-or-later */
/* simplex.c - sizes of learned splits. Size j given those before it is a normal with mean
 *   mean_j + sum_{i<j} weight_ji (s_i - mean_i)   and standard deviation sd_j,
 * from the Cholesky factor of the covariance, truncated to (0, what is left). The last size is what is left.
 *
 * Everything is done in units of sd_j, so that the mean is centre_j + sum_{i<j} pull_ji s_i. Where the sizes are independent,
 * or independent given their sum (learned splits with one example, and all that are written with "sd"), row j of the pulls
 * is one number, and the sum is what is no longer left: no loop. */
#include "config.h"

#include "grammar/simplex_priv.h"
#include "grammar/truncated.h"

#include <lapacke.h>
#include <math.h>
#include <string.h>

typedef struct {
    double sd, rate; /* rate: 1 / sd */
    double centre;   /* of the conditional mean when all sizes before are 0 */
    double pull;     /* of each size before it, when they are all the same */
} size_model;

struct sg_simplex {
    size_t k;
    const double *mean;       /* [k] */
    const double *covariance; /* [k-1][k-1] */
    const size_model *sizes;  /* [k-1] */
    const double *pull;       /* [k-1][k-1], strictly lower triangle; NULL: see size_model */
    double log_sds;           /* sum */
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
static void scale(const double *mean, size_t n, const double *sd, double *weight, size_model *sizes)
{
    for (size_t j = 0; j < n; j++) {
        size_model *m = sizes + j;
        *m = (size_model){.sd = sd[j], .rate = 1 / sd[j], .centre = mean[j], .pull = j > 0 ? weight[j * n] / sd[j] : 0};
        for (size_t i = 0; i < j; i++) {
            m->centre -= weight[j * n + i] * mean[i];
            weight[j * n + i] /= sd[j];
        }
        m->centre /= sd[j];
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
    size_model *sizes = SG_NEW_ARRAY(arena, size_model, n);
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
    scale(mean, n, sd, weight, sizes);
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

/* Conditional mean of size j in units of its sd; rest: 1 less the sizes before it. */
static double centre_of(const sg_simplex *s, size_t j, const double *value, double rest)
{
    const size_model *m = s->sizes + j;
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

/* Draw size j; only the centre and the mass of the term are made. */
static double draw_size(const size_model *m, double rest, double u, sg_simplex_term *t)
{
    const double a = -t->centre, width = rest * m->rate;
    t->mass = sg_truncated_mass(a, width);
    const double v = m->sd * (u >= 0 ? sg_truncated_distance(a, width, t->mass, u)
                                     : sg_truncated_distance_above(a, width, t->mass, -u));
    /* A size of nothing, or nothing left, would end the chain of conditionals: keep an ulp. */
    return fmin(fmax(v, 0x1p-60 * rest), rest * (1 - 0x1p-50));
}

static double rest_before(size_t first, const double *value)
{
    double rest = 1;
    for (size_t j = 0; j < first; j++)
        rest -= value[j];
    return rest;
}

void sg_simplex_transform_from(const sg_simplex *s, size_t first, const double *u, double *value,
                               sg_simplex_term *terms)
{
    double rest = rest_before(first, value);
    for (size_t j = first; j + 1 < s->k; j++) {
        const size_model *m = s->sizes + j;
        sg_simplex_term t = {.centre = centre_of(s, j, value, rest)};
        value[j] = draw_size(m, rest, u[j], &t);
        if (terms != NULL) {
            t.exponent = sg_truncated_exponent(-t.centre, rest * m->rate, value[j] * m->rate);
            terms[j] = t;
        }
        rest -= value[j];
    }
    value[s->k - 1] = rest;
}

void sg_simplex_transform(const sg_simplex *s, const double *u, double *value)
{
    sg_simplex_transform_from(s, 0, u, value, NULL);
}

static sg_simplex_term term_of(const size_model *m, double centre, double value, double rest)
{
    const double width = rest * m->rate;
    return (sg_simplex_term){centre, sg_truncated_exponent(-centre, width, value * m->rate),
                             sg_truncated_mass(-centre, width)};
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
        terms[j] = term_of(s->sizes + j, centre_of(s, j, value, rest), value[j], rest);
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
    double rest = rest_before(first, value);
    for (size_t j = first; j < end; j++) {
        const size_model *m = s->sizes + j;
        const double centre = terms != NULL ? terms[j].centre : centre_of(s, j, value, rest);
        const double width = rest * m->rate, mass = terms != NULL ? terms[j].mass : sg_truncated_mass(-centre, width);
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

/* A sum of logarithms as the logarithm of a product, as long as that is a number. */
typedef struct {
    double product, sum;
} log_sum;

static void multiply(log_sum *l, double x)
{
    l->product *= x;
    if (l->product > 1e-100 && l->product < 1e100)
        return;
    l->sum += log(l->product);
    l->product = 1;
}

static double total(const log_sum *l)
{
    return l->sum + log(l->product);
}

double sg_simplex_log_density(const sg_simplex *s, const double *value)
{
    double rest = 1, sum = -s->log_sds;
    log_sum masses = {1, 0};
    for (size_t j = 0; j + 1 < s->k; j++) {
        if (!(value[j] > 0 && value[j] < rest))
            return -INFINITY;
        const sg_simplex_term t = term_of(s->sizes + j, centre_of(s, j, value, rest), value[j], rest);
        sum += t.exponent;
        multiply(&masses, t.mass);
        rest -= value[j];
    }
    return sum - total(&masses);
}

double sg_simplex_log_density_of_terms(const sg_simplex *s, const sg_simplex_term *terms)
{
    double sum = -s->log_sds;
    log_sum masses = {1, 0};
    for (size_t j = 0; j + 1 < s->k; j++) {
        sum += terms[j].exponent;
        multiply(&masses, terms[j].mass);
    }
    return sum - total(&masses);
}

/* What size i has to do with size j growing by e and size j+1 shrinking by it. */
static double drift(const sg_simplex *s, size_t i, size_t j, double e)
{
    if (s->pull == NULL)
        return i == j + 1 ? s->sizes[i].pull * e : 0;
    const double *pull = s->pull + i * (s->k - 1) + j;
    return i == j ? 0 : i == j + 1 ? pull[0] * e : (pull[0] - pull[1]) * e;
}

/* One shift, term by term. */
typedef struct {
    const sg_simplex *s;
    const double *value;
    const sg_simplex_term *terms;
    size_t j;
    double e;
    sg_simplex_term *shifted;
    double exponents; /* after less before */
    log_sum masses;   /* before over after */
} shift;

/* rest: before size i, as it was. */
static void shift_term(shift *f, size_t i, double rest)
{
    const size_model *m = f->s->sizes + i;
    const double by = drift(f->s, i, f->j, f->e);
    if (f->terms == NULL && i > f->j + 1 && by == 0)
        return;
    const sg_simplex_term before =
        f->terms != NULL ? f->terms[i] : term_of(m, centre_of(f->s, i, f->value, rest), f->value[i], rest);
    sg_simplex_term after = before;
    const double centre = before.centre + by;
    if (i == f->j)
        after.exponent = sg_truncated_exponent(-centre, rest * m->rate, (f->value[i] + f->e) * m->rate);
    else if (i == f->j + 1)
        after = term_of(m, centre, f->value[i] - f->e, rest - f->e);
    else if (by != 0)
        after = term_of(m, centre, f->value[i], rest);
    f->exponents += after.exponent - before.exponent;
    if (after.mass != before.mass)
        multiply(&f->masses, before.mass / after.mass);
    if (f->shifted != NULL)
        f->shifted[i] = after;
}

double sg_simplex_shift(const sg_simplex *s, const double *value, const sg_simplex_term *terms, size_t j, double e,
                        sg_simplex_term *shifted)
{
    const size_t n = s->k - 1, end = s->pull == NULL && shifted == NULL && j + 2 < n ? j + 2 : n;
    double rest = rest_before(j, value);
    const double grown = value[j] + e;
    if (!(grown > 0 && value[j + 1] - e > 0 && grown < rest && (j + 1 == n || value[j + 1] - e < rest - grown)))
        return -INFINITY;
    if (shifted != NULL && terms == NULL) {
        if (!sg_simplex_terms(s, value, shifted))
            return -INFINITY;
        terms = shifted;
    }
    if (shifted != terms && shifted != NULL && j > 0)
        memcpy(shifted, terms, j * sizeof *terms);
    shift f = {s, value, terms, j, e, shifted, 0, {1, 0}};
    for (size_t i = j; i < end; rest -= value[i++])
        shift_term(&f, i, rest);
    return f.exponents + total(&f.masses);
}
