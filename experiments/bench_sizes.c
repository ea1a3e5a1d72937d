/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench_sizes.c - draws of sizes, their densities and shifts of one boundary, against the definition by GSL's functions.
 * The reference knows the conditional moments beforehand too; it finds each size by gsl_cdf_ugaussian_P and _Pinv, and the
 * effect of a shift as the difference of two densities. */
#include "bench_sizes.h"

#include "core/random.h"
#include "grammar/grammar.h"
#include "grammar/simplex.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_randist.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { MOST = 20, NDRAWS = 256 };

typedef struct {
    sg_grammar *g;
    const sg_simplex *s;
    size_t k;
    gsl_matrix *weight;
    double mean[MOST], sd[MOST];
    double u[NDRAWS][MOST], value[NDRAWS][MOST];
    sg_simplex_term terms[NDRAWS][MOST], shifted[MOST];
    size_t at[NDRAWS]; /* boundary that is shifted */
    double e[NDRAWS], sum;
} setting;

static double now_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* INDEPENDENT: a diagonal covariance; GIVEN_SUM: what is left of that when the last size has a spread of its own; DENSE. */
typedef enum { INDEPENDENT, GIVEN_SUM, DENSE, NKINDS } covariance_kind;
static const char *const kind_names[NKINDS] = {"independent", "given their sum", "dependent"};

static double covariance_of(size_t k, size_t i, size_t j, covariance_kind kind)
{
    const double other = kind == DENSE ? cos((double)(i + j)) / (double)k : 0;
    return pow(0.2 / (double)k, 2) * (i == j ? 1 : other);
}

/* Mean sizes between 1/2k and 3/2k, standard deviations of a fifth of 1/k. */
static sg_grammar *make_grammar(size_t k, covariance_kind kind)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (out == NULL)
        return NULL;
    fprintf(out, "label t\nstart S\nrule S -> split x { ");
    for (size_t i = 0; i < k; i++)
        fprintf(out, "t%s", i + 1 < k ? " | " : " } sizes mean (");
    double left = 1;
    for (size_t i = 0; i + 1 < k; i++) {
        const double m = (0.5 + (double)(i * 7 % k) / (double)k) / (double)k;
        fprintf(out, "%.17g, ", m);
        left -= m;
    }
    fprintf(out, "%.17g) %s (", left, kind == GIVEN_SUM ? "sd" : "covariance");
    for (size_t i = 0; kind == GIVEN_SUM && i < k; i++)
        fprintf(out, "%.17g%s", sqrt(covariance_of(k, i, i, kind)), i + 1 < k ? ", " : ")");
    for (size_t i = 0; kind != GIVEN_SUM && i + 1 < k; i++)
        for (size_t j = 0; j + 1 < k; j++)
            fprintf(out, "%s%.17g%s", j == 0 ? "(" : "", covariance_of(k, i, j, kind),
                    j + 2 < k ? ", " : i + 2 < k ? "), " : "))");
    sg_grammar *g = NULL;
    sg_error err = SG_ERROR_INIT;
    if (fclose(out) == 0 && sg_grammar_parse(text, size, "bench", &g, &err) != SG_OK)
        fprintf(stderr, "bench_derivation: %s\n", err.msg);
    free(text);
    return g;
}

/* Conditional moments from the Cholesky factor. */
static void condition(setting *b)
{
    const size_t n = b->k - 1;
    gsl_matrix_const_view c = gsl_matrix_const_view_array(sg_simplex_covariance(b->s), n, n);
    gsl_matrix *l = gsl_matrix_alloc(n, n);
    gsl_matrix_memcpy(l, &c.matrix);
    gsl_linalg_cholesky_decomp1(l);
    for (size_t j = 0; j < n; j++) {
        b->sd[j] = gsl_matrix_get(l, j, j);
        for (size_t i = j; i-- > 0;) {
            double w = gsl_matrix_get(l, j, i);
            for (size_t m = i + 1; m < j; m++)
                w -= gsl_matrix_get(b->weight, j, m) * gsl_matrix_get(l, m, i);
            gsl_matrix_set(b->weight, j, i, w / gsl_matrix_get(l, i, i));
        }
    }
    gsl_matrix_free(l);
}

static double mean_of(const setting *b, size_t j, const double *value)
{
    double m = b->mean[j];
    for (size_t i = 0; i < j; i++)
        m += b->weight->data[j * b->weight->tda + i] * (value[i] - b->mean[i]);
    return m;
}

static void gsl_sample(setting *b, size_t i)
{
    double *value = b->value[i], rest = 1;
    for (size_t j = 0; j + 1 < b->k; j++) {
        const double mean = mean_of(b, j, value), sd = b->sd[j];
        const double below = gsl_cdf_ugaussian_P(-mean / sd), upto = gsl_cdf_ugaussian_P((rest - mean) / sd);
        value[j] = mean + sd * gsl_cdf_ugaussian_Pinv(below + b->u[i][j] * (upto - below));
        rest -= value[j];
    }
    value[b->k - 1] = rest;
}

static double gsl_density_of(const setting *b, const double *value)
{
    double rest = 1, sum = 0;
    for (size_t j = 0; j + 1 < b->k; j++) {
        const double mean = mean_of(b, j, value), sd = b->sd[j];
        const double mass = gsl_cdf_ugaussian_P((rest - mean) / sd) - gsl_cdf_ugaussian_P(-mean / sd);
        sum += log(gsl_ran_gaussian_pdf(value[j] - mean, sd) / mass);
        rest -= value[j];
    }
    return sum;
}

static void gsl_density(setting *b, size_t i)
{
    b->sum += gsl_density_of(b, b->value[i]);
}

static void gsl_shift(setting *b, size_t i)
{
    double after[MOST];
    memcpy(after, b->value[i], b->k * sizeof *after);
    after[b->at[i]] += b->e[i];
    after[b->at[i] + 1] -= b->e[i];
    b->sum += gsl_density_of(b, after) - gsl_density_of(b, b->value[i]);
}

static void our_sample(setting *b, size_t i)
{
    sg_simplex_transform(b->s, b->u[i], b->value[i]);
}

static void our_sample_with_density(setting *b, size_t i)
{
    b->sum += sg_simplex_draw(b->s, b->u[i], b->value[i]);
}

static void gsl_sample_with_density(setting *b, size_t i)
{
    gsl_sample(b, i);
    gsl_density(b, i);
}

static void our_density(setting *b, size_t i)
{
    b->sum += sg_simplex_log_density(b->s, b->value[i]);
}

static void our_invert(setting *b, size_t i)
{
    double u[MOST];
    sg_simplex_invert_from(b->s, b->at[i], b->value[i], NULL, u);
    b->sum += u[b->at[i]];
}

static void our_shift(setting *b, size_t i)
{
    b->sum += sg_simplex_shift(b->s, b->value[i], NULL, b->at[i], b->e[i], NULL);
}

static void our_shift_of_terms(setting *b, size_t i)
{
    b->sum += sg_simplex_shift(b->s, b->value[i], b->terms[i], b->at[i], b->e[i], b->shifted);
}

static double time_one(setting *b, double seconds, void (*work)(setting *b, size_t i))
{
    size_t n = 0;
    const double start = now_s();
    double elapsed;
    do {
        for (size_t r = 0; r < 20; r++)
            for (size_t i = 0; i < NDRAWS; i++)
                work(b, i);
        n += 20 * NDRAWS;
        elapsed = now_s() - start;
    } while (elapsed < seconds);
    return 1e9 * elapsed / (double)n;
}

static void fill(setting *b, gsl_rng *rng)
{
    for (size_t i = 0; i < NDRAWS; i++) {
        for (size_t j = 0; j < b->k; j++)
            b->u[i][j] = sg_random_uniform(rng);
        sg_simplex_transform_from(b->s, 0, b->u[i], b->value[i], b->terms[i]);
        b->at[i] = gsl_rng_uniform_int(rng, b->k - 1);
        const double *v = b->value[i] + b->at[i];
        b->e[i] = -v[0] + sg_random_uniform(rng) * (v[0] + v[1]);
    }
}

static void time_setting(setting *b, covariance_kind kind, double seconds)
{
    const struct {
        const char *name;
        void (*work)(setting *b, size_t i), (*reference)(setting *b, size_t i);
    } lines[] = {{"sample", our_sample, gsl_sample},         {"sample with density", our_sample_with_density, gsl_sample_with_density},
                 {"density", our_density, gsl_density},      {"shift", our_shift, gsl_shift},
                 {"shift of kept terms", our_shift_of_terms, NULL}, {"uniforms behind a shift", our_invert, NULL}};
    for (size_t l = 0; l < sizeof lines / sizeof *lines; l++) {
        printf("  %2zu sizes, %-16s %-24s %7.0f ns", b->k, kind_names[kind], lines[l].name,
               time_one(b, seconds, lines[l].work));
        if (lines[l].reference != NULL)
            printf("   GSL %7.0f ns", time_one(b, seconds, lines[l].reference));
        printf("\n");
    }
}

static void bench_setting(setting *b, size_t k, covariance_kind kind, double seconds)
{
    gsl_rng *rng = sg_random_create(k);
    b->k = k;
    b->g = make_grammar(k, kind);
    b->weight = gsl_matrix_calloc(k - 1, k - 1);
    if (b->g != NULL && b->weight != NULL && rng != NULL) {
        b->s = sg_grammar_rule(b->g, 0)->draws[0].simplex;
        memcpy(b->mean, sg_simplex_mean(b->s), k * sizeof *b->mean);
        condition(b);
        fill(b, rng);
        time_setting(b, kind, seconds);
    }
    gsl_matrix_free(b->weight);
    sg_grammar_free(b->g);
    gsl_rng_free(rng);
}

void bench_sizes(double seconds)
{
    setting *b = calloc(1, sizeof *b);
    if (b == NULL)
        return;
    for (size_t k = 5; k <= MOST; k *= 2)
        for (int kind = 0; kind < NKINDS; kind++)
            bench_setting(b, k, (covariance_kind)kind, seconds);
    free(b);
}
