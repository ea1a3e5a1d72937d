/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_simplex.c - sizes of learned splits: moments, Jacobians, an oracle by the definition, terms and shifts against it. */
#include "grammar/simplex_priv.h"
#include "grammar/truncated.h"
#include "tests/grammar_support.h"

#include <gsl/gsl_integration.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_randist.h>

/* A random positive definite covariance of k-1 sizes with standard deviations about `scale`. */
static const sg_simplex *random_simplex(gsl_rng *rng, sg_arena *arena, size_t k, double scale)
{
    sg_error err = SG_ERROR_INIT;
    const size_t n = k - 1;
    double *mean = SG_NEW_ARRAY(arena, double, k), *covariance = SG_NEW_ARRAY(arena, double, n * n);
    double *factor = SG_NEW_ARRAY(arena, double, n * n), sum = 0;
    for (size_t i = 0; i < k; i++)
        sum += mean[i] = 0.1 + gsl_rng_uniform(rng);
    for (size_t i = 0; i < k; i++)
        mean[i] /= sum;
    for (size_t i = 0; i < n * n; i++)
        factor[i] = scale * gsl_ran_gaussian(rng, 1) / sqrt((double)k);
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
            covariance[i * n + j] = i == j ? scale * scale * 0.01 : 0;
            for (size_t c = 0; c < n; c++)
                covariance[i * n + j] += factor[i * n + c] * factor[j * n + c];
        }
    const sg_simplex *s = NULL;
    ck_ok(sg_simplex_create(arena, k, mean, covariance, &s, &err));
    return s;
}

START_TEST(sizes_are_positive_and_sum_to_one)
{
    gsl_rng *rng = sg_random_create((uint64_t)_i);
    sg_arena *arena = sg_arena_create();
    for (int i = 0; i < 200; i++) {
        const size_t k = 1 + gsl_rng_uniform_int(rng, 12);
        const bool extreme = i % 3 == 0; /* uniforms that no rounding can bring back, but sizes all the same */
        const sg_simplex *s = random_simplex(rng, arena, k, pow(10, 4 * gsl_rng_uniform(rng) - 3));
        double u[12], value[12], back[12], again[12], sum = 0;
        for (size_t j = 0; j + 1 < k; j++)
            u[j] = extreme ? (gsl_rng_uniform(rng) < 0.5 ? 0x1p-53 : 1 - 0x1p-53) : sg_random_uniform(rng);
        sg_simplex_transform(s, u, value);
        for (size_t j = 0; j < k; j++) {
            ck_assert_msg(value[j] > 0 && value[j] <= 1, "size %zu of %zu is %g", j, k, value[j]);
            sum += value[j];
        }
        ck_assert_double_eq_tol(sum, 1, 1e-14);
        ck_assert(sg_simplex_invert(s, value, back));
        ck_assert(isfinite(sg_simplex_log_density(s, value)));
        sg_simplex_transform(s, back, again);
        for (size_t j = 0; j < k && !extreme; j++)
            ck_assert_double_eq_tol(value[j], again[j], 1e-9);
    }
    gsl_rng_free(rng);
    sg_arena_free(arena);
}
END_TEST

/* The density in value space is one over the Jacobian determinant of the map from uniforms: by central differences. */
START_TEST(density_of_sizes_is_the_jacobian)
{
    gsl_rng *rng = sg_random_create(100 + (uint64_t)_i);
    sg_arena *arena = sg_arena_create();
    enum { MAX = 5 };
    const double h = 1e-6;
    for (int i = 0; i < 50; i++) {
        const size_t k = 2 + gsl_rng_uniform_int(rng, MAX - 1), n = k - 1;
        const sg_simplex *s = random_simplex(rng, arena, k, pow(10, 2 * gsl_rng_uniform(rng) - 2));
        double u[MAX], value[MAX], up[MAX], down[MAX];
        gsl_matrix *jacobian = gsl_matrix_alloc(n, n);
        for (size_t j = 0; j < n; j++)
            u[j] = 0.05 + 0.9 * gsl_rng_uniform(rng);
        sg_simplex_transform(s, u, value);
        for (size_t j = 0; j < n; j++) {
            const double at = u[j];
            u[j] = at + h;
            sg_simplex_transform(s, u, up);
            u[j] = at - h;
            sg_simplex_transform(s, u, down);
            u[j] = at;
            for (size_t r = 0; r < n; r++)
                gsl_matrix_set(jacobian, r, j, (up[r] - down[r]) / (2 * h));
        }
        gsl_permutation *p = gsl_permutation_alloc(n);
        int sign;
        gsl_linalg_LU_decomp(jacobian, p, &sign);
        const double log_jacobian = gsl_linalg_LU_lndet(jacobian);
        ck_assert_double_eq_tol(sg_simplex_log_density(s, value), -log_jacobian, 1e-4);
        gsl_permutation_free(p);
        gsl_matrix_free(jacobian);
    }
    gsl_rng_free(rng);
    sg_arena_free(arena);
}
END_TEST

/* Where no border is near, the draws have the mean and the covariance that they were made from. */
START_TEST(sizes_have_the_moments_of_the_model)
{
    enum { K = 4, N = 40000 };
    static const double mean[K] = {0.2, 0.3, 0.3, 0.2};
    static const double covariance[9] = {4e-4, -1e-4, 1e-4, -1e-4, 9e-4, -3e-4, 1e-4, -3e-4, 4e-4};
    sg_error err = SG_ERROR_INIT;
    sg_arena *arena = sg_arena_create();
    gsl_rng *rng = sg_random_create(5);
    const sg_simplex *s = NULL;
    ck_ok(sg_simplex_create(arena, K, mean, covariance, &s, &err));
    double sum[K] = {0}, products[9] = {0};
    for (int i = 0; i < N; i++) {
        double u[K - 1], v[K];
        for (int j = 0; j + 1 < K; j++)
            u[j] = sg_random_uniform(rng);
        sg_simplex_transform(s, u, v);
        for (int j = 0; j < K; j++)
            sum[j] += v[j];
        for (int j = 0; j < 9; j++)
            products[j] += (v[j / 3] - mean[j / 3]) * (v[j % 3] - mean[j % 3]);
    }
    for (int j = 0; j < K; j++)
        ck_assert_double_eq_tol(sum[j] / N, mean[j], 5 * 0.03 / sqrt(N));
    for (int j = 0; j < 9; j++)
        ck_assert_double_eq_tol(products[j] / N, covariance[j], 5 * 1.5 * 9e-4 / sqrt(N));
    gsl_rng_free(rng);
    sg_arena_free(arena);
}
END_TEST

static double two_size_density(double x, void *user)
{
    const double value[2] = {x, 1 - x};
    return exp(sg_simplex_log_density(user, value));
}

/* With two sizes: the normal, cut to (0, 1) and normalised; also where the mean is far outside. */
START_TEST(two_sizes_are_a_truncated_normal)
{
    static const double means[] = {0.5, 0.02, 0.98, -3, 5}, sds[] = {0.1, 0.01, 0.3};
    sg_error err = SG_ERROR_INIT;
    sg_arena *arena = sg_arena_create();
    gsl_integration_workspace *w = gsl_integration_workspace_alloc(1000);
    for (int i = 0; i < 15; i++) {
        const double mean[2] = {means[i % 5], 1 - means[i % 5]}, sd = sds[i / 5], variance = sd * sd;
        const sg_simplex *s = NULL;
        ck_ok(sg_simplex_create(arena, 2, mean, &variance, &s, &err));
        gsl_function f = {two_size_density, (void *)(uintptr_t)s};
        double mass, error;
        const double mode = fmin(fmax(mean[0], 0), 1);
        double points[] = {0, fmax(mode - 8 * sd, 1e-4), fmax(fmin(mode, 0.9995), 5e-4), fmin(mode + 8 * sd, 1 - 1e-4), 1};
        gsl_integration_qagp(&f, points, 5, 1e-10, 1e-8, 1000, w, &mass, &error);
        ck_assert_double_eq_tol(mass, 1, 1e-7);
        const double a[2] = {0.3, 0.7}, b[2] = {0.6, 0.4}; /* ratio of densities is that of the normal */
        const double ratio = sg_simplex_log_density(s, a) - sg_simplex_log_density(s, b);
        const double wanted = (pow(0.6 - mean[0], 2) - pow(0.3 - mean[0], 2)) / (2 * variance);
        ck_assert_double_eq_tol(ratio, wanted, 1e-9 * (1 + fabs(wanted)));
    }
    gsl_integration_workspace_free(w);
    sg_arena_free(arena);
}
END_TEST

START_TEST(sizes_outside_the_simplex_are_refused)
{
    sg_error err = SG_ERROR_INIT;
    sg_grammar *g = test_grammar("label a start A rule A -> split x { a | a | a } sizes mean (0.3, 0.3, 0.4) sd (0.1, 0.1, 0.1)");
    const sg_draw *d = &sg_grammar_rule(g, 0)->draws[0];
    static const double bad[][3] = {{0, 0.5, 0.5}, {-0.1, 0.5, 0.6}, {0.5, 0.5, 0}, {0.5, 0.6, -0.1}, {NAN, 0.5, 0.5}};
    for (int i = 0; i < 5; i++) {
        double u[2], density;
        ck_assert_int_eq(sg_draw_invert(g, d, NULL, 0, bad[i], u, &err), SG_ENUMERIC);
        ck_ok(sg_draw_log_density(g, d, NULL, 0, bad[i], &density, &err));
        ck_assert(isinf(density) && density < 0);
    }
    sg_grammar_free(g);
}
END_TEST

/* ---- against the definition ---- */

enum { MOST = 26 };
typedef enum { DENSE, DIAGONAL, GIVEN_SUM, NKINDS } covariance_kind;

/* Independent sizes, or what is left of their independence when they sum to 1. */
static const sg_simplex *independent_simplex(gsl_rng *rng, sg_arena *arena, size_t k, double scale, covariance_kind kind)
{
    sg_error err = SG_ERROR_INIT;
    const size_t n = k - 1;
    double mean[MOST], variance[MOST], *covariance = SG_NEW_ARRAY(arena, double, n * n), sum = 0, all = 0;
    for (size_t i = 0; i < k; i++) {
        sum += mean[i] = 0.1 + gsl_rng_uniform(rng);
        all += variance[i] = pow(scale * (0.5 + gsl_rng_uniform(rng)), 2);
    }
    for (size_t i = 0; i < k; i++)
        mean[i] /= sum;
    for (size_t i = 0; i < n * n; i++) {
        const size_t r = i / n, c = i % n;
        covariance[i] = (r == c ? variance[r] : 0) - (kind == GIVEN_SUM ? variance[r] * variance[c] / all : 0);
    }
    const sg_simplex *s = NULL;
    ck_ok(sg_simplex_create(arena, k, mean, covariance, &s, &err));
    return s;
}

static const sg_simplex *any_simplex(gsl_rng *rng, sg_arena *arena, size_t k, double scale, covariance_kind kind)
{
    return kind == DENSE ? random_simplex(rng, arena, k, scale) : independent_simplex(rng, arena, k, scale, kind);
}

/* Mean and sd of size j given those before it, by the definition: C_jb C_bb^-1 through an LU decomposition. */
static void condition(const sg_simplex *s, size_t k, size_t j, const double *value, double *mean, double *sd)
{
    const size_t n = k - 1;
    gsl_matrix_const_view c = gsl_matrix_const_view_array(sg_simplex_covariance(s), n, n);
    double variance = gsl_matrix_get(&c.matrix, j, j);
    *mean = sg_simplex_mean(s)[j];
    if (j > 0) {
        gsl_matrix *before = gsl_matrix_alloc(j, j);
        gsl_permutation *p = gsl_permutation_alloc(j);
        gsl_vector *w = gsl_vector_alloc(j);
        gsl_vector_const_view row = gsl_matrix_const_subrow(&c.matrix, j, 0, j);
        gsl_matrix_const_view corner = gsl_matrix_const_submatrix(&c.matrix, 0, 0, j, j);
        int sign;
        gsl_matrix_memcpy(before, &corner.matrix);
        gsl_linalg_LU_decomp(before, p, &sign);
        gsl_linalg_LU_solve(before, p, &row.vector, w);
        for (size_t i = 0; i < j; i++) {
            *mean += gsl_vector_get(w, i) * (value[i] - sg_simplex_mean(s)[i]);
            variance -= gsl_vector_get(w, i) * gsl_matrix_get(&c.matrix, j, i);
        }
        gsl_vector_free(w);
        gsl_permutation_free(p);
        gsl_matrix_free(before);
    }
    *sd = sqrt(variance);
}

static void random_uniforms(gsl_rng *rng, size_t n, double *u)
{
    for (size_t j = 0; j < n; j++)
        u[j] = sg_random_uniform(rng);
}

START_TEST(sizes_and_densities_are_those_of_the_definition)
{
    gsl_rng *rng = sg_random_create(200 + (uint64_t)_i);
    sg_arena *arena = sg_arena_create();
    for (int i = 0; i < 120; i++) {
        const size_t k = 2 + gsl_rng_uniform_int(rng, i % 10 == 0 ? MOST - 1 : 8);
        const sg_simplex *s = any_simplex(rng, arena, k, pow(10, 3 * gsl_rng_uniform(rng) - 2.5), (covariance_kind)(i % NKINDS));
        double u[MOST], value[MOST], back[MOST], rest = 1, log_density = 0;
        sg_simplex_term terms[MOST], again[MOST];
        random_uniforms(rng, k - 1, u);
        sg_simplex_transform_from(s, 0, u, value, terms);
        ck_assert(sg_simplex_invert(s, value, back));
        for (size_t j = 0; j + 1 < k; j++) {
            double mean, sd;
            condition(s, k, j, value, &mean, &sd);
            const double density = sg_truncated_log_density(mean, sd, 0, rest, value[j]);
            ck_assert_double_eq_tol(value[j], sg_truncated_quantile(mean, sd, 0, rest, u[j]), 1e-11 * sd + 1e-13 * rest);
            ck_assert_double_eq_tol(sg_uniform_plain(back[j]), sg_truncated_cdf(mean, sd, 0, rest, value[j]), 1e-11);
            ck_assert_double_eq_tol(terms[j].exponent - log(terms[j].mass) - log(sd), density, 1e-10 * (1 + fabs(density)));
            rest -= value[j];
            log_density += density;
        }
        const double tolerance = 1e-10 * (double)k * (1 + fabs(log_density));
        ck_assert_double_eq_tol(sg_simplex_log_density(s, value), log_density, tolerance);
        ck_assert_double_eq_tol(sg_simplex_log_density_of_terms(s, terms), log_density, tolerance);
        ck_assert_double_eq_tol(sg_simplex_draw(s, u, back), log_density, tolerance);
        ck_assert_mem_eq(back, value, k * sizeof *value);
        ck_assert(sg_simplex_terms(s, value, again));
        ck_assert_double_eq_tol(sg_simplex_log_density_of_terms(s, again), log_density, tolerance);
    }
    gsl_rng_free(rng);
    sg_arena_free(arena);
}
END_TEST

START_TEST(sizes_go_back_to_their_uniforms)
{
    gsl_rng *rng = sg_random_create(300 + (uint64_t)_i);
    sg_arena *arena = sg_arena_create();
    for (int i = 0; i < 300; i++) {
        const size_t k = 2 + gsl_rng_uniform_int(rng, MOST - 1), first = gsl_rng_uniform_int(rng, k - 1);
        const sg_simplex *s = any_simplex(rng, arena, k, pow(10, -2 * gsl_rng_uniform(rng)), (covariance_kind)(i % NKINDS));
        double u[MOST], value[MOST], back[MOST], rest = 1;
        sg_simplex_term terms[MOST];
        random_uniforms(rng, k - 1, u);
        sg_simplex_transform_from(s, 0, u, value, terms);
        for (size_t j = 0; j + 1 < k; j++)
            back[j] = j < first ? -1 : NAN;
        sg_simplex_invert_from(s, first, value, i % 2 == 0 ? terms : NULL, back);
        for (size_t j = 0; j + 1 < k; j++) {
            /* A size is known to an ulp of what is left, and the uniform by the density there. */
            const double density = exp(terms[j].exponent) / terms[j].mass / rest;
            ck_assert_double_eq_tol(j < first ? back[j] : sg_uniform_plain(back[j]), j < first ? -1 : u[j], 1e-12 + (j < first ? 0 : 1e-15 * density));
            rest -= value[j];
        }
    }
    gsl_rng_free(rng);
    sg_arena_free(arena);
}
END_TEST

/* Some uniforms change: only what comes behind the first of them does. */
START_TEST(a_draw_goes_on_from_any_size)
{
    gsl_rng *rng = sg_random_create(400 + (uint64_t)_i);
    sg_arena *arena = sg_arena_create();
    for (int i = 0; i < 200; i++) {
        const size_t k = 2 + gsl_rng_uniform_int(rng, 10), first = gsl_rng_uniform_int(rng, k);
        const sg_simplex *s = any_simplex(rng, arena, k, pow(10, 2 * gsl_rng_uniform(rng) - 2), (covariance_kind)(i % NKINDS));
        double u[MOST], value[MOST], want[MOST];
        sg_simplex_term terms[MOST], wanted[MOST];
        random_uniforms(rng, k - 1, u);
        sg_simplex_transform_from(s, 0, u, value, terms);
        for (size_t j = first; j + 1 < k; j++)
            u[j] = sg_random_uniform(rng);
        sg_simplex_transform_from(s, first, u, value, terms);
        sg_simplex_transform_from(s, 0, u, want, wanted);
        ck_assert_mem_eq(value, want, k * sizeof *value);
        ck_assert_mem_eq(terms, wanted, (k - 1) * sizeof *terms);
    }
    gsl_rng_free(rng);
    sg_arena_free(arena);
}
END_TEST

/* ---- shifts ---- */

static void shift_values(double *value, size_t j, double e)
{
    value[j] += e;
    value[j + 1] -= e;
}

/* Of a log density: what is left before the last sizes is a difference, and densities are relative to it. */
static double rounding(size_t k, const double *value)
{
    return 4e-16 * (double)k / (value[k - 2] + value[k - 1]);
}

static void ck_same_terms(const sg_simplex *s, size_t k, const double *value, const sg_simplex_term *terms, double tolerance)
{
    sg_simplex_term want[MOST];
    ck_assert(sg_simplex_terms(s, value, want));
    for (size_t j = 0; j + 1 < k; j++) {
        const double scale = tolerance * (1 + fabs(want[j].centre)) + rounding(k, value);
        ck_assert_double_eq_tol(terms[j].centre, want[j].centre, scale);
        ck_assert_double_eq_tol(terms[j].exponent - log(terms[j].mass), want[j].exponent - log(want[j].mass),
                                scale * (1 + fabs(want[j].exponent)));
    }
}

START_TEST(shifts_change_the_density_as_from_scratch)
{
    gsl_rng *rng = sg_random_create(500 + (uint64_t)_i);
    sg_arena *arena = sg_arena_create();
    int refused = 0;
    for (int i = 0; i < 600; i++) {
        const size_t k = 2 + gsl_rng_uniform_int(rng, i % 10 == 0 ? MOST - 1 : 6), j = gsl_rng_uniform_int(rng, k - 1);
        const sg_simplex *s = any_simplex(rng, arena, k, pow(10, 3 * gsl_rng_uniform(rng) - 2.5), (covariance_kind)(i % NKINDS));
        double u[MOST], value[MOST], after[MOST];
        sg_simplex_term terms[MOST], shifted[MOST], made[MOST];
        random_uniforms(rng, k - 1, u);
        sg_simplex_transform_from(s, 0, u, value, terms);
        const double e = -value[j] + 1.1 * gsl_rng_uniform(rng) * (value[j] + value[j + 1]);
        memcpy(after, value, sizeof after);
        shift_values(after, j, e);
        const double before = sg_simplex_log_density(s, value), want = sg_simplex_log_density(s, after) - before;
        const double got = sg_simplex_shift(s, value, terms, j, e, shifted);
        if (isinf(want)) {
            ck_assert(isinf(got) && got < 0);
            ck_assert(isinf(sg_simplex_shift(s, value, NULL, j, e, NULL)));
            refused++;
            continue;
        }
        const double tolerance = 1e-10 * (1 + fabs(before) + fabs(want)) + rounding(k, after) + rounding(k, value);
        ck_assert_double_eq_tol(got, want, tolerance);
        ck_assert_double_eq_tol(sg_simplex_shift(s, value, NULL, j, e, NULL), want, tolerance);
        ck_assert_double_eq_tol(sg_simplex_shift(s, value, terms, j, e, NULL), want, tolerance);
        ck_assert_double_eq_tol(sg_simplex_shift(s, value, NULL, j, e, made), want, tolerance);
        ck_same_terms(s, k, after, shifted, 1e-10);
        ck_same_terms(s, k, after, made, 1e-10);
    }
    ck_assert_int_gt(refused, 0);
    ck_assert_int_lt(refused, 200);
    gsl_rng_free(rng);
    sg_arena_free(arena);
}
END_TEST

/* As a chain does it: terms are kept in place over many shifts, and the uniforms are made at the end. */
START_TEST(terms_stay_true_over_many_shifts)
{
    gsl_rng *rng = sg_random_create(600 + (uint64_t)_i);
    sg_arena *arena = sg_arena_create();
    enum { K = 20 };
    const sg_simplex *s = any_simplex(rng, arena, K, 0.01, (covariance_kind)_i);
    double u[K], value[K], again[K];
    sg_simplex_term terms[K], proposed[K];
    random_uniforms(rng, K - 1, u);
    sg_simplex_transform_from(s, 0, u, value, terms);
    double log_density = sg_simplex_log_density_of_terms(s, terms);
    int accepted = 0;
    for (int i = 0; i < 100000; i++) {
        const size_t j = gsl_rng_uniform_int(rng, K - 1);
        const double e = gsl_ran_gaussian(rng, 0.01), change = sg_simplex_shift(s, value, terms, j, e, proposed);
        if (!(log(sg_random_uniform(rng)) < change))
            continue;
        shift_values(value, j, e);
        memcpy(terms, proposed, sizeof terms);
        log_density += change;
        accepted++;
    }
    ck_assert_int_gt(accepted, 1000);
    ck_assert_double_eq_tol(sg_simplex_log_density(s, value), log_density, 1e-9 * (1 + fabs(log_density)));
    ck_same_terms(s, K, value, terms, 1e-9);
    sg_simplex_invert_from(s, 0, value, terms, u);
    sg_simplex_transform(s, u, again);
    for (size_t j = 0; j < K; j++)
        ck_assert_double_eq_tol(value[j], again[j], 1e-12);
    gsl_rng_free(rng);
    sg_arena_free(arena);
}
END_TEST

/* Sizes that the prior never makes, but data may ask for: uniforms tell them apart in both tails. */
START_TEST(sizes_far_in_a_tail_come_back_from_their_uniforms)
{
    gsl_rng *rng = sg_random_create((uint64_t)_i + 70);
    sg_arena *arena = sg_arena_create();
    size_t far = 0, upper = 0, lost = 0;
    for (int i = 0; i < 2000; i++) {
        const size_t k = 2 + gsl_rng_uniform_int(rng, 8);
        const sg_simplex *s = random_simplex(rng, arena, k, pow(10, -1 - 1.5 * gsl_rng_uniform(rng)));
        double u[10], value[10], again[10], rest = 1;
        for (size_t j = 0; j + 1 < k; j++) {
            value[j] = rest * (0.01 + 0.98 * gsl_rng_uniform(rng)) / (double)(k - j) * 1.5;
            rest -= value[j];
        }
        value[k - 1] = rest;
        ck_assert(sg_simplex_invert(s, value, u));
        bool representable = true;
        for (size_t j = 0; j + 1 < k; j++) {
            ck_assert(u[j] > -1 && u[j] < 1 && u[j] != 0);
            representable &= fabs(u[j]) > 0x1p-1022;
            far += fabs(u[j]) < 1e-30;
            upper += u[j] < 0;
        }
        lost += !representable;
        sg_simplex_transform(s, u, again);
        for (size_t j = 0; j < k && representable; j++)
            ck_assert_double_eq_tol(value[j], again[j], 1e-10);
    }
    ck_assert(far > 500 && upper > 500 && lost < 1800);
    gsl_rng_free(rng);
    sg_arena_free(arena);
}
END_TEST

/* Each tail's share grows by the density: relatively, however little it is. */
START_TEST(shares_are_relatively_exact_in_both_tails)
{
    gsl_rng *rng = sg_random_create((uint64_t)_i + 90);
    for (int i = 0; i < 5000; i++) {
        const double a = 60 * (gsl_rng_uniform(rng) - 0.6), width = 40 * gsl_rng_uniform_pos(rng);
        const double t = width * (0.01 + 0.98 * gsl_rng_uniform(rng)), h = 1e-5 * fmin(t, width - t);
        const double mass = sg_truncated_mass(a, width, sg_truncated_below(a));
        const double density = exp(sg_truncated_exponent(a, width, t)) / mass;
        const double below = sg_truncated_share(a, width, mass, t), above = sg_truncated_share_above(a, width, mass, t);
        ck_assert_double_eq_tol(below + above, 1, 1e-13);
        const bool low = below < above;
        const double least = low ? below : above;
        if (least < 1e-290)
            continue;
        if (a > 0 || a + width < 0 || least > 1e-12) /* around 0 what is beyond 8.3 is left out on purpose */
            continue;
        double (*share)(double, double, double, double) = low ? sg_truncated_share : sg_truncated_share_above;
        const double slope = (share(a, width, mass, t + h) - share(a, width, mass, t - h)) / (2 * h);
        const double z = a + t, truth = (low ? 1 : -1) * density;
        ck_assert_msg(fabs(slope / truth - 1) < 1e-4 + 1e-9 * z * z + 1e-15 / h, "a %g width %g t %g: %g and %g", a, width, t,
                      slope, truth);
    }
    for (int i = 0; i < 5000; i++) {
        const double a = 60 * (gsl_rng_uniform(rng) - 0.6), width = 20 * gsl_rng_uniform_pos(rng);
        const double outside = sg_truncated_below(a), t = width * gsl_rng_uniform_pos(rng);
        double mass = sg_truncated_mass(a, width, outside);
        const double below = sg_truncated_share(a, width, mass, t), above = sg_truncated_share_above(a, width, mass, t);
        if (fmin(below, above) < 1e-290)
            continue;
        const double back = sg_truncated_distance(a, width, outside, below < 0.5 ? below : -above, &mass);
        ck_assert_msg(fabs(back - t) < 1e-9 * (1 + t), "a %g width %g t %.17g back %.17g", a, width, t, back);
    }
    gsl_rng_free(rng);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("simplex");
    TCase *tc = tcase_create("simplex");
    tcase_set_timeout(tc, 120);
    tcase_add_loop_test(tc, sizes_are_positive_and_sum_to_one, 0, 10);
    tcase_add_loop_test(tc, density_of_sizes_is_the_jacobian, 0, 10);
    tcase_add_test(tc, sizes_have_the_moments_of_the_model);
    tcase_add_test(tc, two_sizes_are_a_truncated_normal);
    tcase_add_test(tc, sizes_outside_the_simplex_are_refused);
    tcase_add_loop_test(tc, sizes_and_densities_are_those_of_the_definition, 0, 10);
    tcase_add_loop_test(tc, sizes_go_back_to_their_uniforms, 0, 10);
    tcase_add_loop_test(tc, a_draw_goes_on_from_any_size, 0, 4);
    tcase_add_loop_test(tc, shifts_change_the_density_as_from_scratch, 0, 10);
    tcase_add_loop_test(tc, terms_stay_true_over_many_shifts, 0, NKINDS);
    tcase_add_loop_test(tc, sizes_far_in_a_tail_come_back_from_their_uniforms, 0, 3);
    tcase_add_loop_test(tc, shares_are_relatively_exact_in_both_tails, 0, 3);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
