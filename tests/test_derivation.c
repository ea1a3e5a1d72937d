/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_derivation.c - sampling, splicing, expanding, priors, on grammars that use every kind of body. */
#include "core/random.h"
#include "derivation/derivation.h"
#include "tests/failing_malloc.h"
#include "tests/support.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_integration.h>
#include <gsl/gsl_randist.h>
#include <math.h>
#include <string.h>

/* Three rules: branches end soon enough for trees to be finite. */
static const char branching[] = "grammar branching\n"
                                "label t\n"
                                "start S\n"
                                "rule S\n"
                                "  -> 0.2 : split x { S | S }\n"
                                "  -> 0.15 : split y { S | S | S }\n"
                                "  -> 0.65 : t\n";

/* Parameters, guards, weights that depend on parameters, draws that are passed on, repeats, a depth limit. */
static const char general[] = "grammar general\n"
                              "weights\n"
                              "limit depth 7\n"
                              "label t\n"
                              "label w\n"
                              "start S(2)\n"
                              "rule S(a) if a > 0.3\n"
                              "  -> 1 + a : u ~ uniform(0.1, a) split x { T(u) | S(a / 2) | T(a + u) }\n"
                              "  -> 1 : split y { S(a * 0.7) | T(1) | t }\n"
                              "  -> 1 : repeat x 1 + floor(a + 0.5) { split y { S(a / 3) | T(a) } }\n"
                              "rule S(a) if a <= 0.3\n"
                              "  -> 1 : w\n"
                              "rule S(a) at limit -> w\n"
                              "rule T(b)\n"
                              "  -> 2 : t\n"
                              "  -> 1 : v ~ normal(b, 1) split x { '0.5 : U(v, b) | '0.5 : t }\n"
                              "rule U(v, b)\n"
                              "  -> 1 : t\n"
                              "  -> 1 : split y { t | w | w } sizes mean (0.2, 0.3, 0.5) covariance ((0.01, 0), (0, 0.0025))\n";

static sg_grammar *load(const char *text)
{
    sg_error err = SG_ERROR_INIT;
    sg_grammar *g = NULL;
    ck_ok(sg_grammar_parse(text, strlen(text), "test", &g, &err));
    return g;
}

static bool same(const sg_derivation *a, const sg_derivation *b)
{
    return a->nnodes == b->nnodes && a->nvalues == b->nvalues && a->nuniforms == b->nuniforms &&
           (a->nnodes == 0 || memcmp(a->nodes, b->nodes, a->nnodes * sizeof *a->nodes) == 0) &&
           (a->nvalues == 0 || memcmp(a->values, b->values, a->nvalues * sizeof *a->values) == 0) &&
           (a->nuniforms == 0 || memcmp(a->uniforms, b->uniforms, a->nuniforms * sizeof *a->uniforms) == 0);
}

/* A grammar with one derivation of it and a generator. */
typedef struct {
    sg_grammar *g;
    sg_derivation d;
    gsl_rng *rng;
} fixture;

static fixture open_fixture(const char *text, uint64_t seed)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = {.g = load(text), .rng = sg_random_create(seed)};
    ck_assert_ptr_nonnull(f.rng);
    sg_derivation_init(&f.d, f.g);
    ck_ok(sg_derivation_sample(&f.d, f.rng, 100000, &err));
    return f;
}

static void close_fixture(fixture *f)
{
    sg_derivation_clear(&f->d);
    gsl_rng_free(f->rng);
    sg_grammar_free(f->g);
}

START_TEST(samples_keep_every_invariant)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(_i % 2 == 0 ? branching : general, (uint64_t)_i + 1);
    for (int round = 0; round < 20; round++) {
        ck_ok(sg_derivation_check(&f.d, &err));
        ck_assert(sg_derivation_complete(&f.d));
        double log_prior = NAN, log_density = NAN;
        ck_ok(sg_derivation_log_prior(&f.d, &log_prior, &err));
        ck_ok(sg_derivation_log_density(&f.d, &log_density, &err));
        ck_assert(isfinite(log_prior) && log_prior <= 0 && isfinite(log_density));
        ck_ok(sg_derivation_sample(&f.d, f.rng, 100000, &err));
    }
    close_fixture(&f);
}
END_TEST

START_TEST(same_stream_gives_the_same_derivation)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(general, 7);
    sg_derivation again;
    sg_derivation_init(&again, f.g);
    sg_random_stream(f.rng, 7, 3, 0);
    ck_ok(sg_derivation_sample(&f.d, f.rng, 100000, &err));
    sg_random_stream(f.rng, 7, 3, 0);
    ck_ok(sg_derivation_sample(&again, f.rng, 100000, &err));
    ck_assert(same(&f.d, &again));
    sg_derivation_clear(&again);
    close_fixture(&f);
}
END_TEST

/* The subtree at a random node goes out, another one comes in, the old one comes back: nothing has changed. */
START_TEST(splice_and_extract_are_inverse)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(_i % 2 == 0 ? general : branching, (uint64_t)_i + 100);
    sg_derivation old, fresh, before, out;
    sg_derivation_init(&old, f.g);
    sg_derivation_init(&fresh, f.g);
    sg_derivation_init(&before, f.g);
    sg_derivation_init(&out, f.g);
    for (int round = 0; round < 60; round++) {
        const size_t node = gsl_rng_uniform_int(f.rng, f.d.nnodes);
        const sg_node n = f.d.nodes[node];
        ck_ok(sg_derivation_copy(&before, &f.d, &err));
        ck_ok(sg_derivation_extract(&f.d, node, &old, &err));
        ck_ok(sg_derivation_check(&old, &err));
        ck_assert_uint_eq(old.nodes[0].depth, n.depth);
        ck_ok(sg_derivation_sample_subtree(&fresh, n.symbol, f.d.values + n.values, n.depth, f.rng, 100000, &err));
        ck_ok(sg_derivation_check(&fresh, &err));
        ck_ok(sg_derivation_splice(&f.d, node, &fresh, &err));
        ck_ok(sg_derivation_check(&f.d, &err));
        ck_assert_uint_eq(f.d.nnodes, before.nnodes - old.nnodes + fresh.nnodes);
        ck_ok(sg_derivation_extract(&f.d, node, &out, &err));
        ck_assert(same(&out, &fresh));
        ck_ok(sg_derivation_splice(&f.d, node, &old, &err));
        ck_assert(same(&f.d, &before));
        ck_ok(sg_derivation_splice(&f.d, node, &fresh, &err)); /* the next round begins elsewhere */
        if (f.d.nnodes > 3000)
            ck_ok(sg_derivation_sample(&f.d, f.rng, 100000, &err));
    }
    sg_derivation_clear(&old);
    sg_derivation_clear(&fresh);
    sg_derivation_clear(&before);
    sg_derivation_clear(&out);
    close_fixture(&f);
}
END_TEST

START_TEST(splice_shifts_depths_and_refuses_other_symbols)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture("label t\nstart S\nrule S -> split x { A | B }\nrule A -> split y { B | B }\nrule B -> t\n", 1);
    sg_derivation slice;
    sg_derivation_init(&slice, f.g);
    const sg_sym a = sg_grammar_find(f.g, "A"), b = sg_grammar_find(f.g, "B");
    ck_ok(sg_derivation_sample_subtree(&slice, a, NULL, 5, f.rng, 100, &err));
    ck_assert_uint_eq(slice.nodes[1].depth, 6);
    ck_ok(sg_derivation_splice(&f.d, 1, &slice, &err));
    ck_ok(sg_derivation_check(&f.d, &err));
    ck_assert_uint_eq(f.d.nodes[2].depth, 2);
    ck_ok(sg_derivation_sample_subtree(&slice, b, NULL, 1, f.rng, 100, &err));
    ck_assert_int_eq(sg_derivation_splice(&f.d, 1, &slice, &err), SG_EINVAL);
    ck_ok(sg_derivation_check(&f.d, &err));
    sg_derivation_clear(&slice);
    close_fixture(&f);
}
END_TEST

/* Rules of the root over many samples are independent draws. */
START_TEST(rule_frequencies_are_the_probabilities)
{
    sg_error err = SG_ERROR_INIT;
    enum { N = 6000 };
    fixture f = open_fixture(branching, (uint64_t)_i + 500);
    const sg_symbol *s = sg_grammar_symbol(f.g, sg_grammar_start(f.g));
    size_t count[3] = {0};
    for (int i = 0; i < N; i++) {
        ck_ok(sg_derivation_sample(&f.d, f.rng, 1000000, &err));
        count[f.d.nodes[0].rule - s->first_rule]++;
    }
    const double p[3] = {0.2, 0.15, 0.65};
    double chisq = 0;
    for (int k = 0; k < 3; k++)
        chisq += pow((double)count[k] - N * p[k], 2) / (N * p[k]);
    ck_assert_msg(gsl_cdf_chisq_Q(chisq, 2) > 1e-6, "seed %d: chi-square %g", _i + 500, chisq);
    close_fixture(&f);
}
END_TEST

/* Few rules and many, impossible ones first, last and between: each is drawn as often as it should be. */
START_TEST(many_rules_are_drawn_by_their_probabilities)
{
    enum { N = 100000 };
    const uint32_t nrules = (uint32_t)_i;
    sg_error err = SG_ERROR_INIT;
    gsl_rng *rng = sg_random_create((uint64_t)_i);
    char text[4000] = "weights label t label s start S rule S", *end = text + strlen(text);
    for (uint32_t i = 0; i < nrules; i++)
        end += sprintf(end, " -> %u : %s", nrules > 2 && i % 3 != 1 ? 0 : i + 1, i % 2 == 0 ? "s" : "t");
    sg_grammar *g = load(text);
    sg_derivation d;
    sg_derivation_init(&d, g);
    double count[64] = {0}, chisq = 0;
    size_t possible = 0;
    for (int i = 0; i < N; i++) {
        ck_ok(sg_derivation_sample(&d, rng, 10, &err));
        count[d.nodes[0].rule]++;
    }
    for (uint32_t i = 0; i < nrules; i++) {
        const double want = N * sg_grammar_rule(g, i)->probability;
        ck_assert(want > 0 || count[i] == 0);
        chisq += want > 0 ? pow(count[i] - want, 2) / want : 0;
        possible += want > 0;
    }
    ck_assert_msg(possible == 1 || gsl_cdf_chisq_Q(chisq, (double)possible - 1) > 1e-6, "%u rules: chi-square %g", nrules, chisq);
    sg_derivation_clear(&d);
    gsl_rng_free(rng);
    sg_grammar_free(g);
}
END_TEST

/* Weights that depend on the parameter: S(2) uses its first rule with probability 3/5, and U one in two. */
START_TEST(conditional_rule_frequencies_are_the_probabilities)
{
    sg_error err = SG_ERROR_INIT;
    enum { N = 4000 };
    fixture f = open_fixture(general, (uint64_t)_i + 900);
    const sg_rule_id first = sg_grammar_symbol(f.g, sg_grammar_start(f.g))->first_rule;
    size_t count[3] = {0};
    for (int i = 0; i < N; i++) {
        ck_ok(sg_derivation_sample(&f.d, f.rng, 1000000, &err));
        ck_assert_uint_lt(f.d.nodes[0].rule - first, 3);
        count[f.d.nodes[0].rule - first]++;
    }
    const double p[3] = {0.6, 0.2, 0.2};
    double chisq = 0;
    for (int k = 0; k < 3; k++)
        chisq += pow((double)count[k] - N * p[k], 2) / (N * p[k]);
    ck_assert_msg(gsl_cdf_chisq_Q(chisq, 2) > 1e-6, "seed %d: chi-square %g", _i + 900, chisq);
    close_fixture(&f);
}
END_TEST

/* Moments of the sequential truncated normal by quadrature, independent of the library's inverse cdf. */
typedef struct {
    double mean1, sd1, mean2, slope, sd2; /* of s1, and of s2 given s1 */
    int power1, power2;
} sequential;

static double truncated_mass(double mean, double sd, double high)
{
    return gsl_cdf_gaussian_P(high - mean, sd) - gsl_cdf_gaussian_P(-mean, sd);
}

/* E[s2^power] for s2 ~ TN(mean, sd) on (0, high) */
static double truncated_moment(double mean, double sd, double high, int power)
{
    if (power == 0)
        return 1;
    const double z = truncated_mass(mean, sd, high);
    const double a = gsl_ran_gaussian_pdf(-mean, sd), b = gsl_ran_gaussian_pdf(high - mean, sd);
    const double first = mean + sd * sd * (a - b) / z;
    /* E[(x-m)^2] = sd^2 (1 + (alpha phi(alpha) - beta phi(beta)) / Z) in x */
    return power == 1 ? first : sd * sd * (1 + (-mean * a - (high - mean) * b) / z) + 2 * mean * first - mean * mean;
}

static double integrand(double s1, void *params)
{
    const sequential *q = params;
    const double density = gsl_ran_gaussian_pdf(s1 - q->mean1, q->sd1) / truncated_mass(q->mean1, q->sd1, 1);
    return density * pow(s1, q->power1) *
           truncated_moment(q->mean2 + q->slope * (s1 - q->mean1), q->sd2, 1 - s1, q->power2);
}

static double sequential_moment(sequential q, int power1, int power2)
{
    double result = NAN, error;
    size_t evaluations;
    q.power1 = power1;
    q.power2 = power2;
    gsl_function f = {integrand, &q};
    gsl_integration_cquad_workspace *w = gsl_integration_cquad_workspace_alloc(200);
    ck_assert_int_eq(gsl_integration_cquad(&f, 0, 1, 1e-12, 1e-10, w, &result, &error, &evaluations), 0);
    gsl_integration_cquad_workspace_free(w);
    return result;
}

START_TEST(sizes_have_the_moments_of_the_sequential_truncated_normal)
{
    sg_error err = SG_ERROR_INIT;
    enum { N = 20000 };
    /* wide enough for both ends to cut */
    fixture f = open_fixture("label t\nstart S\nrule S -> split x { t | t | t } sizes mean (0.3, 0.4, 0.3)\n"
                             "  covariance ((0.09, -0.03), (-0.03, 0.0625))\n",
                             (uint64_t)_i + 40);
    const sequential q = {0.3, 0.3, 0.4, -0.03 / 0.09, sqrt(0.0625 - 0.03 * 0.03 / 0.09), 0, 0};
    double sum[2] = {0}, square[2] = {0}, product = 0;
    for (int i = 0; i < N; i++) {
        ck_ok(sg_derivation_sample(&f.d, f.rng, 100, &err));
        const double *s = f.d.values + f.d.nodes[0].values;
        ck_assert(s[0] > 0 && s[1] > 0 && s[2] >= 0);
        ck_assert_double_eq_tol(s[0] + s[1] + s[2], 1, 1e-12);
        product += s[0] * s[1] / N;
        for (int k = 0; k < 2; k++) {
            sum[k] += s[k] / N;
            square[k] += s[k] * s[k] / N;
        }
    }
    /* five standard deviations of a mean of N numbers in (0,1): at most 5 * 0.5 / sqrt(N) */
    const double tolerance = 5 * 0.3 / sqrt(N);
    ck_assert_double_eq_tol(sequential_moment(q, 0, 0), 1, 1e-9);
    ck_assert_double_eq_tol(sum[0], sequential_moment(q, 1, 0), tolerance);
    ck_assert_double_eq_tol(sum[1], sequential_moment(q, 0, 1), tolerance);
    ck_assert_double_eq_tol(square[0], sequential_moment(q, 2, 0), tolerance);
    ck_assert_double_eq_tol(square[1], sequential_moment(q, 0, 2), tolerance);
    ck_assert_double_eq_tol(product, sequential_moment(q, 1, 1), tolerance / 2);
    close_fixture(&f);
}
END_TEST

/* Expand the first open node by its k-th rule. */
static void expand(fixture *f, uint32_t k)
{
    sg_error err = SG_ERROR_INIT;
    size_t node = 0;
    while (f->d.nodes[node].rule != SG_NONE)
        node++;
    const sg_rule_id rule = sg_grammar_symbol(f->g, f->d.nodes[node].symbol)->first_rule + k;
    ck_ok(sg_derivation_expand(&f->d, node, rule, f->rng, &err));
    ck_ok(sg_derivation_check(&f->d, &err));
}

START_TEST(log_prior_and_density_by_hand)
{
    sg_error err = SG_ERROR_INIT;
    double got = NAN;
    fixture f = open_fixture(branching, 1);
    ck_ok(sg_derivation_open(&f.d, sg_grammar_start(f.g), NULL, 0, &err));
    ck_ok(sg_derivation_log_prior(&f.d, &got, &err));
    ck_assert_double_eq(got, 0);
    expand(&f, 0); /* S S */
    expand(&f, 2); /* the first: t */
    ck_assert(!sg_derivation_complete(&f.d));
    expand(&f, 1); /* the second: S S S */
    for (int i = 0; i < 3; i++)
        expand(&f, 2);
    ck_assert(sg_derivation_complete(&f.d));
    ck_assert_uint_eq(f.d.nnodes, 6);
    ck_ok(sg_derivation_log_prior(&f.d, &got, &err));
    ck_assert_double_eq_tol(got, log(0.2) + log(0.15) + 4 * log(0.65), 1e-12);
    ck_ok(sg_derivation_log_density(&f.d, &got, &err));
    ck_assert_double_eq(got, 0);
    close_fixture(&f);

    f = open_fixture(general, 1);
    ck_ok(sg_derivation_open(&f.d, sg_grammar_start(f.g), sg_grammar_start_args(f.g), 0, &err));
    expand(&f, 1);                              /* S(2): 1/5; children S(1.4) T(1) t */
    expand(&f, 0);                              /* S(1.4): 2.4/4.4, u in (0.1, 1.4); children T(u) S(0.7) T(1.4+u) */
    expand(&f, 1);                              /* T(u): 1/3, v ~ N(u,1); children U(v,u) t */
    expand(&f, 1);                              /* U: 1/2, sizes */
    const double *u = f.d.values + f.d.nodes[1].values, *v = f.d.values + f.d.nodes[2].values,
                 *sizes = f.d.values + f.d.nodes[3].values + 2;
    ck_assert_double_eq(u[0], 1.4);
    ck_assert_double_eq(v[0], u[1]);
    ck_ok(sg_derivation_log_prior(&f.d, &got, &err));
    ck_assert_double_eq_tol(got, log(0.2) + log(2.4 / 4.4) + log(1.0 / 3) + log(0.5), 1e-12);
    double want = -log(1.3) + log(gsl_ran_gaussian_pdf(v[1] - v[0], 1));
    want += log(gsl_ran_gaussian_pdf(sizes[0] - 0.2, 0.1) / truncated_mass(0.2, 0.1, 1));
    want += log(gsl_ran_gaussian_pdf(sizes[1] - 0.3, 0.05) / truncated_mass(0.3, 0.05, 1 - sizes[0]));
    ck_ok(sg_derivation_log_density(&f.d, &got, &err));
    ck_assert_double_eq_tol(got, want, 1e-9);
    close_fixture(&f);
}
END_TEST

START_TEST(a_rule_that_cannot_stand_there_has_log_prior_minus_infinity)
{
    sg_error err = SG_ERROR_INIT;
    double got = NAN;
    fixture f = open_fixture(general, 1);
    const sg_rule_id first = sg_grammar_symbol(f.g, sg_grammar_start(f.g))->first_rule;
    ck_ok(sg_derivation_open(&f.d, sg_grammar_start(f.g), sg_grammar_start_args(f.g), 0, &err));
    ck_ok(sg_derivation_expand(&f.d, 0, first + 3, f.rng, &err)); /* its guard asks for a <= 0.3 */
    ck_ok(sg_derivation_log_prior(&f.d, &got, &err));
    ck_assert(isinf(got) && got < 0);
    ck_ok(sg_derivation_open(&f.d, sg_grammar_start(f.g), sg_grammar_start_args(f.g), 0, &err));
    const sg_rule_id completion = sg_grammar_symbol(f.g, sg_grammar_start(f.g))->completion;
    ck_ok(sg_derivation_expand(&f.d, 0, completion, f.rng, &err)); /* only beyond the limit */
    ck_ok(sg_derivation_log_prior(&f.d, &got, &err));
    ck_assert(isinf(got) && got < 0);
    ck_assert_int_eq(sg_derivation_expand(&f.d, 0, first, f.rng, &err), SG_EINVAL);
    close_fixture(&f);
}
END_TEST

/* Node by node, in any order, comes what sampling gives: the count of nodes has the same mean. */
START_TEST(stepwise_expansion_samples_the_prior)
{
    sg_error err = SG_ERROR_INIT;
    enum { N = 1500 };
    fixture f = open_fixture(general, (uint64_t)_i + 60);
    double sum[2] = {0}, square[2] = {0};
    for (int i = 0; i < N; i++) {
        ck_ok(sg_derivation_sample(&f.d, f.rng, 100000, &err));
        sum[0] += (double)f.d.nnodes;
        square[0] += pow((double)f.d.nnodes, 2);
        ck_ok(sg_derivation_open(&f.d, sg_grammar_start(f.g), sg_grammar_start_args(f.g), 0, &err));
        for (size_t open = 0; open < f.d.nnodes;) {
            open = gsl_rng_uniform_int(f.rng, f.d.nnodes);
            for (size_t k = 0; k < f.d.nnodes && f.d.nodes[open].rule != SG_NONE; k++)
                open = (open + 1) % f.d.nnodes;
            if (f.d.nodes[open].rule != SG_NONE)
                break;
            sg_rule_id rule;
            ck_ok(sg_derivation_choose(&f.d, open, f.rng, &rule, &err));
            ck_ok(sg_derivation_expand(&f.d, open, rule, f.rng, &err));
        }
        if (i < 50)
            ck_ok(sg_derivation_check(&f.d, &err));
        ck_assert(sg_derivation_complete(&f.d));
        sum[1] += (double)f.d.nnodes;
        square[1] += pow((double)f.d.nnodes, 2);
    }
    double mean[2], variance[2];
    for (int k = 0; k < 2; k++) {
        mean[k] = sum[k] / N;
        variance[k] = square[k] / N - mean[k] * mean[k];
    }
    const double z = (mean[0] - mean[1]) / sqrt((variance[0] + variance[1]) / N);
    ck_assert_msg(fabs(z) < 5, "seed %d: means %g and %g, z = %g", _i + 60, mean[0], mean[1], z);
    close_fixture(&f);
}
END_TEST

/* Six successors, of which three are A and two B(1): tied, A is stored once and its probability counts once. */
START_TEST(tied_siblings_are_stored_and_counted_once)
{
    sg_error err = SG_ERROR_INIT;
    double tied_prior = NAN, free_prior = NAN;
    const char rules[] = "label t\nlabel w\nstart S\n"
                         "rule S -> split x { A | B(1) | A | B(2) | A | B(1) }\n"
                         "rule A -> 0.3 : t -> 0.7 : w\n"
                         "rule B(x) -> 0.5 : t -> 0.5 : split y { A | A }\n";
    char text[512];
    snprintf(text, sizeof text, "tied\n%s", rules);
    fixture tied = open_fixture(text, 3), untied = open_fixture(rules, 3);
    ck_assert(sg_grammar_tied(tied.g) && !sg_grammar_tied(untied.g));
    ck_ok(sg_derivation_open(&tied.d, sg_grammar_start(tied.g), NULL, 0, &err));
    ck_ok(sg_derivation_open(&untied.d, sg_grammar_start(untied.g), NULL, 0, &err));
    expand(&tied, 0);
    expand(&untied, 0);
    ck_assert_uint_eq(tied.d.nnodes, 4);   /* S, A, B(1), B(2): arguments tell siblings apart */
    ck_assert_uint_eq(untied.d.nnodes, 7);
    ck_assert_double_eq(tied.d.values[tied.d.nodes[2].values], 1);
    ck_assert_double_eq(tied.d.values[tied.d.nodes[3].values], 2);
    while (!sg_derivation_complete(&tied.d))
        expand(&tied, 0);
    while (!sg_derivation_complete(&untied.d))
        expand(&untied, 0);
    ck_ok(sg_derivation_log_prior(&tied.d, &tied_prior, &err));
    ck_ok(sg_derivation_log_prior(&untied.d, &free_prior, &err));
    ck_assert_double_eq_tol(tied_prior, log(0.3) + 2 * log(0.5), 1e-12);
    ck_assert_double_eq_tol(free_prior, 3 * log(0.3) + 3 * log(0.5), 1e-12);
    close_fixture(&tied);
    close_fixture(&untied);
}
END_TEST

START_TEST(a_tied_grammar_keeps_the_invariants)
{
    sg_error err = SG_ERROR_INIT;
    char text[sizeof general + 8];
    snprintf(text, sizeof text, "tied\n%s", general);
    fixture f = open_fixture(text, (uint64_t)_i + 1);
    for (int round = 0; round < 20; round++) {
        ck_ok(sg_derivation_check(&f.d, &err));
        ck_ok(sg_derivation_sample(&f.d, f.rng, 100000, &err));
    }
    close_fixture(&f);
}
END_TEST

START_TEST(repeats_derive_their_block_once_for_each_time)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture("tied\nlabel t\nstart S(3)\n"
                             "rule S(n) -> split y { A | repeat x n { split y { A | repeat y 2 { B } } } | A }\n"
                             "rule A -> t\nrule B -> t\n",
                             1);
    ck_ok(sg_derivation_check(&f.d, &err));
    /* S, one A for both ends, and in each of three times A, B, B */
    ck_assert_uint_eq(f.d.nnodes, 1 + 1 + 3 * 3);
    const char *want[] = {"S", "A", "A", "B", "B", "A", "B", "B", "A", "B", "B"};
    for (size_t i = 0; i < f.d.nnodes; i++)
        ck_assert_str_eq(sg_grammar_symbol(f.g, f.d.nodes[i].symbol)->name, want[i]);
    const sg_rule *r = sg_grammar_rule(f.g, f.d.nodes[0].rule);
    size_t n = 0;
    ck_ok(sg_rule_child_count(f.g, r, f.d.values, 0, &n, &err));
    ck_assert_uint_eq(n, 10);
    close_fixture(&f);
}
END_TEST

START_TEST(the_depth_limit_completes)
{
    sg_error err = SG_ERROR_INIT;
    double log_prior = NAN;
    fixture f = open_fixture("limit depth 3\nlabel t\nlabel w\nstart S\n"
                             "rule S -> 0.9 : split x { S | R } -> 0.1 : t\nrule S at limit -> split y { R | R }\n"
                             "rule R -> 0.5 : t -> 0.5 : split x { R | R }\n",
                             1);
    bool cut = false;
    for (int round = 0; round < 200; round++) {
        ck_ok(sg_derivation_check(&f.d, &err));
        ck_ok(sg_derivation_log_prior(&f.d, &log_prior, &err));
        double want = 0;
        for (size_t i = 0; i < f.d.nnodes; i++) {
            const sg_node *n = f.d.nodes + i;
            const sg_symbol *s = sg_grammar_symbol(f.g, n->symbol);
            ck_assert_uint_le(n->depth, 5);
            if (n->depth <= 3)
                want += log(sg_grammar_rule(f.g, n->rule)->probability);
            else if (strcmp(s->name, "S") == 0)
                ck_assert_uint_eq(n->rule, s->completion);
            else if (strcmp(s->name, "R") == 0)
                ck_assert_uint_eq(n->rule, SG_RULE_EMPTY);
            cut = cut || n->rule == SG_RULE_EMPTY;
        }
        ck_assert_double_eq_tol(log_prior, want, 1e-9);
        ck_ok(sg_derivation_sample(&f.d, f.rng, 1000, &err));
    }
    ck_assert(cut);
    close_fixture(&f);
}
END_TEST

START_TEST(too_many_nodes_are_refused)
{
    sg_error err = SG_ERROR_INIT;
    sg_grammar *g = load("label t\nstart S\nrule S -> 0.9999999 : split x { Tree | S } -> 0.0000001 : t\nrule Tree -> t\n");
    gsl_rng *rng = sg_random_create(1);
    sg_derivation d;
    sg_derivation_init(&d, g);
    ck_assert_int_eq(sg_derivation_sample(&d, rng, 20, &err), SG_ENUMERIC);
    ck_assert_ptr_nonnull(strstr(err.msg, "more than 20 nodes"));
    ck_assert_ptr_nonnull(strstr(err.msg, "S > S > S"));
    ck_assert_uint_eq(d.nnodes, 0);
    ck_assert_int_eq(sg_derivation_sample(&d, rng, 20, NULL), SG_ENUMERIC);
    sg_derivation_clear(&d);
    gsl_rng_free(rng);
    sg_grammar_free(g);
}
END_TEST

START_TEST(impossible_draws_and_guards_tell_the_path)
{
    sg_error err = SG_ERROR_INIT;
    sg_grammar *g = load("label t\nstart S\nrule S -> split x { t | Mid(1) }\nrule Mid(a) -> w ~ normal(-9, a) split y { Bad(w) }\n"
                         "rule Bad(b) -> v ~ normal(0, b) split x { '1 : Leaf(v) }\nrule Leaf(v) if v > 1 -> t\n");
    gsl_rng *rng = sg_random_create(1);
    sg_derivation d, before;
    sg_derivation_init(&d, g);
    sg_derivation_init(&before, g);
    ck_assert_int_eq(sg_derivation_sample(&d, rng, 20, &err), SG_ENUMERIC);
    ck_assert_ptr_eq(strstr(err.msg, "test:5: error: deriving S > Mid(1) > Bad(-"), err.msg);
    ck_assert_ptr_nonnull(strstr(err.msg, "): draw v: the standard deviation must be greater than 0"));
    ck_assert_uint_eq(d.nnodes, 0);
    /* a failed expansion changes nothing */
    const sg_sym bad = sg_grammar_find(g, "Bad"), leaf = sg_grammar_find(g, "Leaf");
    ck_ok(sg_derivation_open(&d, bad, (const double[]){-1}, 0, &err));
    ck_ok(sg_derivation_copy(&before, &d, &err));
    ck_assert_int_eq(sg_derivation_expand(&d, 0, sg_grammar_symbol(g, bad)->first_rule, rng, &err), SG_ENUMERIC);
    ck_assert(same(&d, &before));
    sg_rule_id rule;
    ck_ok(sg_derivation_open(&d, leaf, (const double[]){0}, 0, &err));
    ck_assert_int_eq(sg_derivation_choose(&d, 0, rng, &rule, &err), SG_ENUMERIC);
    sg_derivation_clear(&d);
    sg_derivation_clear(&before);
    gsl_rng_free(rng);
    sg_grammar_free(g);
}
END_TEST

START_TEST(depth_costs_no_stack)
{
    sg_error err = SG_ERROR_INIT;
    enum { DEPTH = 200000 };
    fixture f = open_fixture("label t\nstart S(5)\nrule S(n) if n > 0 -> split x { S(n - 1) | t }\nrule S(n) if n <= 0 -> t\n", 1);
    sg_derivation copy;
    sg_derivation_init(&copy, f.g);
    ck_ok(sg_derivation_sample_subtree(&f.d, sg_grammar_start(f.g), (const double[]){DEPTH}, 0, f.rng, 3 * DEPTH, &err));
    ck_assert_uint_eq(f.d.nnodes, 2 * DEPTH + 1);
    ck_assert_uint_eq(f.d.nodes[DEPTH].depth, DEPTH);
    ck_ok(sg_derivation_check(&f.d, &err));
    ck_ok(sg_derivation_extract(&f.d, DEPTH / 2, &copy, &err));
    ck_ok(sg_derivation_splice(&f.d, DEPTH / 4, &copy, &err));
    ck_ok(sg_derivation_refresh(&f.d, 0, &err));
    ck_assert_int_eq(sg_derivation_sample_subtree(&f.d, sg_grammar_start(f.g), (const double[]){1e9}, 0, f.rng, DEPTH, &err),
                     SG_ENUMERIC);
    sg_derivation_clear(&copy);
    close_fixture(&f);
}
END_TEST

START_TEST(refresh_carries_changed_uniforms_down)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(general, (uint64_t)_i + 20);
    sg_derivation before;
    sg_derivation_init(&before, f.g);
    int changed = 0;
    for (int round = 0; round < 40; round++) {
        ck_ok(sg_derivation_sample(&f.d, f.rng, 100000, &err));
        ck_ok(sg_derivation_copy(&before, &f.d, &err));
        for (size_t i = 0; i < f.d.nuniforms; i++)
            f.d.uniforms[i] = sg_random_uniform(f.rng);
        if (f.d.nuniforms > 0) {
            ck_assert_int_eq(sg_derivation_check(&f.d, &err), SG_EINVAL);
            changed++;
        }
        ck_ok(sg_derivation_refresh(&f.d, 0, &err));
        ck_ok(sg_derivation_check(&f.d, &err));
        for (size_t i = 0; i < f.d.nuniforms; i++)
            f.d.uniforms[i] = before.uniforms[i];
        ck_ok(sg_derivation_refresh(&f.d, 0, &err));
        ck_assert(same(&f.d, &before));
    }
    ck_assert_int_gt(changed, 10);
    sg_derivation_clear(&before);
    close_fixture(&f);
}
END_TEST

START_TEST(refresh_refuses_a_repeat_that_changed)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture("label t\nstart S\nrule S -> n ~ uniform(1, 9) repeat x floor(n) { A }\nrule A -> t\n", 1);
    f.d.uniforms[0] = 0.01;
    ck_assert_int_eq(sg_derivation_check(&f.d, &err), SG_EINVAL);
    ck_assert_int_eq(sg_derivation_refresh(&f.d, 0, &err), SG_ENUMERIC);
    close_fixture(&f);
}
END_TEST

/* Every field that check() watches, damaged once. */
START_TEST(check_sees_damage)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(general, 11);
    while (f.d.nnodes < 20 || f.d.nuniforms < 3)
        ck_ok(sg_derivation_sample(&f.d, f.rng, 100000, &err));
    sg_derivation good;
    sg_derivation_init(&good, f.g);
    ck_ok(sg_derivation_copy(&good, &f.d, &err));
    for (size_t i = 0; i < good.nnodes; i++) {
        for (int field = 0; field < 7; field++) {
            ck_ok(sg_derivation_copy(&f.d, &good, &err));
            sg_node *n = f.d.nodes + i;
            uint32_t *const fields[] = {&n->symbol, &n->rule, &n->parent, &n->length, &n->depth, &n->values, &n->uniforms};
            *fields[field] += 1;
            if (field != 1) /* the next rule of the symbol may be as good */
                ck_assert_msg(sg_derivation_check(&f.d, &err) == SG_EINVAL, "node %zu, field %d", i, field);
            *fields[field] = UINT32_MAX - 5;
            ck_assert_msg(sg_derivation_check(&f.d, &err) == SG_EINVAL, "node %zu, field %d", i, field);
        }
    }
    for (size_t i = 0; i < good.nvalues; i++) {
        ck_ok(sg_derivation_copy(&f.d, &good, &err));
        f.d.values[i] += 0.001;
        ck_assert_int_eq(sg_derivation_check(&f.d, &err), SG_EINVAL);
    }
    sg_derivation_clear(&good);
    close_fixture(&f);
}
END_TEST

START_TEST(warm_buffers_allocate_nothing)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(general, 5);
    sg_derivation slice, keep;
    sg_derivation_init(&slice, f.g);
    sg_derivation_init(&keep, f.g);
    double log_prior = NAN;
    for (int pass = 0; pass < 2; pass++) {
        gsl_rng_set(f.rng, 5);
        test_allocations = 0;
        int st = 0; /* Check's own macros allocate: one assertion at the end */
        for (int i = 0; i < 300; i++) {
            st |= (int)sg_derivation_sample(&f.d, f.rng, 100000, &err);
            const sg_node n = f.d.nodes[f.d.nnodes / 2];
            st |= (int)sg_derivation_copy(&keep, &f.d, &err);
            st |= (int)sg_derivation_extract(&f.d, f.d.nnodes / 2, &slice, &err);
            st |= (int)sg_derivation_sample_subtree(&slice, n.symbol, f.d.values + n.values, n.depth, f.rng, 100000, &err);
            st |= (int)sg_derivation_splice(&f.d, f.d.nnodes / 2, &slice, &err);
            st |= (int)sg_derivation_refresh(&f.d, 0, &err);
            st |= (int)sg_derivation_log_prior(&f.d, &log_prior, &err);
            st |= (int)sg_derivation_open(&f.d, sg_grammar_start(f.g), sg_grammar_start_args(f.g), 0, &err);
            sg_rule_id rule = SG_NONE;
            st |= (int)sg_derivation_choose(&f.d, 0, f.rng, &rule, &err);
            st |= (int)sg_derivation_expand(&f.d, 0, rule, f.rng, &err);
        }
        const size_t allocations = test_allocations;
        ck_assert_int_eq(st, SG_OK);
        ck_assert_msg(pass == 0 || allocations == 0, "%zu allocations", allocations);
    }
    sg_derivation_clear(&slice);
    sg_derivation_clear(&keep);
    close_fixture(&f);
}
END_TEST

/* Each allocation of each call fails once: the call says so, and its object is what its comment promises. */
START_TEST(failed_allocations_are_reported)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(general, 8);
    while (f.d.nnodes < 60)
        ck_ok(sg_derivation_sample(&f.d, f.rng, 100000, &err));
    size_t failures[5] = {0};
    for (size_t k = 0; k < 40; k++) {
        for (int call = 0; call < 5; call++) {
            sg_derivation d, slice, before;
            sg_derivation_init(&d, f.g);
            sg_derivation_init(&slice, f.g);
            sg_derivation_init(&before, f.g);
            if (call == 2)
                ck_ok(sg_derivation_extract(&f.d, 1, &d, &err));
            if (call == 2)
                ck_ok(sg_derivation_sample_subtree(&slice, d.nodes[0].symbol, (const double[]){9, 2}, 0, f.rng, 100000, &err));
            if (call == 3)
                ck_ok(sg_derivation_open(&d, sg_grammar_start(f.g), (const double[]){40}, 0, &err));
            ck_ok(sg_derivation_copy(&before, &d, &err));
            sg_random_stream(f.rng, 8, 1, 0);
            const sg_rule_id repeat = sg_grammar_symbol(f.g, sg_grammar_start(f.g))->first_rule + 2;
            test_fail_allocation(k);
            const sg_status st = call == 0   ? sg_derivation_sample(&d, f.rng, 100000, &err)
                                 : call == 1 ? sg_derivation_copy(&d, &f.d, &err)
                                 : call == 2 ? sg_derivation_splice(&d, 0, &slice, &err)
                                 : call == 3 ? sg_derivation_expand(&d, 0, repeat, f.rng, &err)
                                             : sg_derivation_check(&f.d, &err);
            const int failed = test_allocation_failed();
            ck_assert_msg(st == (failed ? SG_ENOMEM : SG_OK), "call %d, allocation %zu: status %d", call, k, (int)st);
            failures[call] += failed != 0;
            ck_assert(!failed || same(&d, &before));
            sg_derivation_clear(&d);
            sg_derivation_clear(&slice);
            sg_derivation_clear(&before);
        }
    }
    for (int call = 0; call < 5; call++)
        ck_assert_msg(failures[call] > 0, "call %d allocates nothing", call);
    close_fixture(&f);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("derivation");
    TCase *tc = tcase_create("derivation");
    tcase_set_timeout(tc, 120);
    tcase_add_loop_test(tc, samples_keep_every_invariant, 0, 20);
    tcase_add_test(tc, same_stream_gives_the_same_derivation);
    tcase_add_loop_test(tc, splice_and_extract_are_inverse, 0, 10);
    tcase_add_test(tc, splice_shifts_depths_and_refuses_other_symbols);
    tcase_add_loop_test(tc, rule_frequencies_are_the_probabilities, 0, 4);
    tcase_add_loop_test(tc, many_rules_are_drawn_by_their_probabilities, 1, 50);
    tcase_add_loop_test(tc, conditional_rule_frequencies_are_the_probabilities, 0, 4);
    tcase_add_loop_test(tc, sizes_have_the_moments_of_the_sequential_truncated_normal, 0, 4);
    tcase_add_test(tc, log_prior_and_density_by_hand);
    tcase_add_test(tc, a_rule_that_cannot_stand_there_has_log_prior_minus_infinity);
    tcase_add_loop_test(tc, stepwise_expansion_samples_the_prior, 0, 2);
    tcase_add_test(tc, tied_siblings_are_stored_and_counted_once);
    tcase_add_loop_test(tc, a_tied_grammar_keeps_the_invariants, 0, 8);
    tcase_add_test(tc, repeats_derive_their_block_once_for_each_time);
    tcase_add_test(tc, the_depth_limit_completes);
    tcase_add_test(tc, too_many_nodes_are_refused);
    tcase_add_test(tc, impossible_draws_and_guards_tell_the_path);
    tcase_add_test(tc, depth_costs_no_stack);
    tcase_add_loop_test(tc, refresh_carries_changed_uniforms_down, 0, 4);
    tcase_add_test(tc, refresh_refuses_a_repeat_that_changed);
    tcase_add_test(tc, check_sees_damage);
    tcase_add_test(tc, warm_buffers_allocate_nothing);
    tcase_add_test(tc, failed_allocations_are_reported);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
