/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_kernels_values.c - chains on small grammars with continuous draws against quadrature, within 5 standard errors.
 *
 * The means of some features under prior * exp(beta * log score) come from the midpoint rule in the space of uniforms
 * over all derivations (derivation_oracle.h), and for two grammars from closed forms. Each kernel is tried with no more
 * company than it needs to reach everything. */
#include "search/chain.h"
#include "tests/derivation_oracle.h"
#include "tests/grammar_support.h"
#include "tests/sampler_support.h"
#include "tests/toy_score.h"

#include <gsl/gsl_integration.h>
#include <gsl/gsl_randist.h>
#include <math.h>
#include <string.h>

typedef struct {
    const char *name, *text;
    unsigned cells; /* of the midpoint rule, for each uniform */
    toy_function *log_of;
    bool sizes; /* has sizes to shift */
} toy;

/* Draw values of a node: what stands behind its arguments. */
static const double *drawn(const sg_derivation *d, size_t node)
{
    const sg_node *n = d->nodes + node;
    return d->values + n->values + sg_grammar_symbol(d->grammar, n->symbol)->nparams;
}

static uint32_t ndrawn(const sg_derivation *d, size_t node)
{
    const sg_node *n = d->nodes + node;
    return n->rule >= SG_RULE_EMPTY ? 0 : sg_grammar_rule(d->grammar, n->rule)->nvalues;
}

static double sum_drawn(const sg_derivation *d)
{
    double sum = 0;
    for (size_t i = 0; i < d->nnodes; i++)
        for (uint32_t k = 0; k < ndrawn(d, i); k++)
            sum += drawn(d, i)[k];
    return sum;
}

/* All that is drawn adds up to 3: the score of MATHEMATICS B5.2. */
static double sum_is_three(const sg_derivation *d, void *user)
{
    (void)user;
    return -0.5 * pow(sum_drawn(d) - 3, 2);
}

/* The first value is 0.37 within 0.15. */
static double first_size(const sg_derivation *d, void *user)
{
    (void)user;
    return -0.5 * pow((drawn(d, 0)[0] - 0.37) / 0.15, 2);
}

/* A bit of everything: number of nodes, each rule, each value in a way of its own. */
static double mixed(const sg_derivation *d, void *user)
{
    (void)user;
    double log = 0.4 * (double)d->nnodes;
    for (size_t i = 0; i < d->nnodes; i++) {
        log += 0.3 * sin(3.0 * d->nodes[i].rule);
        for (uint32_t k = 0; k < ndrawn(d, i); k++)
            log -= 2 * pow(drawn(d, i)[k] - 0.2 * (double)(i + k + 1), 2);
    }
    return log;
}

static const toy toys[] = {
    {"one or two values",
     "label a start S\n"
     "rule S -> 0.4 : A -> 0.6 : split x { B | B }\n"
     "rule A -> draw(normal(1, 0.5)) a\n"
     "rule B -> draw(uniform(0, 10)) a\n",
     400, sum_is_three, false},
    {"two or three sizes",
     "label a label b start S\n"
     "rule S -> 0.3 : split x { a | b } sizes mean (0.45, 0.55) covariance ((0.0064))\n"
     "  -> 0.7 : split x { a | b | a } sizes mean (0.3, 0.35, 0.35) covariance ((0.0144, 0), (0, 0.0144))\n",
     400, first_size, true},
    {"sizes in sizes",
     "label a label b start S\n"
     "rule S -> 0.5 : split y { R | a } sizes mean (0.5, 0.5) covariance ((0.04))\n"
     "  -> 0.5 : split y { Q | Q } sizes mean (0.3, 0.7) covariance ((0.02))\n"
     "rule R -> 0.5 : split x { a | b | a } sizes mean (0.3, 0.4, 0.3) covariance ((0.02, -0.01), (-0.01, 0.03))\n"
     "  -> 0.3 : split x { a | b } sizes mean (0.7, 0.3) covariance ((0.01)) -> 0.2 : a\n"
     "rule Q -> 0.6 : split x { a | b } sizes mean (0.4, 0.6) covariance ((0.05)) -> 0.4 : a\n",
     48, mixed, true},
    {"switched blocks",
     "label a label b start S\n"
     "rule S -> 0.4 : split x { a | Q | b } sizes mean (0.3, 0.3, 0.4) covariance ((0.02, -0.01), (-0.01, 0.03))\n"
     "  -> 0.3 : split x { a | b } sizes mean (0.6, 0.4) covariance ((0.03)) -> 0.1 : Q\n"
     "  -> 0.2 : split x { a | Q } sizes mean (0.4, 0.6) covariance ((0.04))\n"
     "rule Q -> 0.5 : split y { a | b } sizes mean (0.4, 0.6) covariance ((0.05)) -> 0.5 : b\n",
     60, mixed, true},
    {"switched and tied",
     "tied label a label b start S\n"
     "rule S -> 0.4 : split x { Q | a | Q } sizes mean (0.3, 0.3, 0.4) covariance ((0.02, -0.01), (-0.01, 0.03))\n"
     "  -> 0.3 : split x { Q | b } sizes mean (0.6, 0.4) covariance ((0.03)) -> 0.1 : Q\n"
     "  -> 0.2 : split y { a | Q } sizes mean (0.4, 0.6) covariance ((0.04))\n"
     "rule Q -> 0.5 : split y { a | b } sizes mean (0.4, 0.6) covariance ((0.05)) -> 0.5 : b\n",
     60, mixed, true},
    {"values decide what follows",
     "weights label a label b start S\n"
     "rule S -> x ~ uniform(0, 1) split x { T(x) | a } -> 2 : x ~ normal(0.5, 1) T(x)\n"
     "rule T(x) if x < 0.5 -> 1 : a -> 2 * x * x : y ~ normal(x, 0.3) U(y)\n"
     "rule T(x) if x >= 0.5 -> x : b -> 1 : y ~ uniform(0, 1 + x) split x { U(y) | U(1 - y) }\n"
     "rule U(y) -> 1 : a -> exp(y) : b\n",
     400, mixed, false},
    {"mixtures and discrete draws",
     "weights label a label b start S\n"
     "rule S -> 1 : m ~ mixture((1, 0, 0.3), (2, 1, 0.2)) a\n"
     "  -> 2 : n ~ discrete((1, 1), (2, 2), (1, 3)) t ~ truncated_normal(n / 3, 0.4, 0, 1) A(t)\n"
     "rule A(t) -> 1 : a -> 1 : u ~ uniform(0, 0.1 + t) b\n",
     60, mixed, false},
    {"a value decides how many",
     "weights label a start S\n"
     "rule S -> n ~ uniform(0.5, 2.5) repeat x n { A(n) } -> 1 : A(1)\n"
     "rule A(n) -> n : y ~ normal(0.5, 0.5) scale(y, 1, 1) a -> a\n",
     48, mixed, false},
};

enum { NTOYS = sizeof toys / sizeof *toys, NFEATURES = 7 };

static void features_of(const sg_derivation *d, double *f)
{
    const double sum = sum_drawn(d);
    f[0] = d->nodes[0].rule == 0;
    f[1] = (double)d->nnodes;
    f[2] = sum;
    f[3] = fmin(sum * sum, 100);
    f[4] = ndrawn(d, 0) > 0 ? drawn(d, 0)[0] : -1;
    f[5] = d->nodes[d->nnodes - 1].rule;
    f[6] = ndrawn(d, d->nnodes - 1) > 0 ? drawn(d, d->nnodes - 1)[0] : 0;
}

typedef struct {
    const toy *t;
    double beta, weight, sum[NFEATURES];
} quadrature;

static void add_point(void *user, const sg_derivation *d, double prior)
{
    quadrature *q = user;
    double f[NFEATURES];
    const double w = prior * exp(q->beta * q->t->log_of(d, NULL));
    features_of(d, f);
    q->weight += w;
    for (int k = 0; k < NFEATURES; k++)
        q->sum[k] += w * f[k];
}

static quadrature integrate(const toy *t, const sg_grammar *g, unsigned cells, double beta)
{
    quadrature q = {.t = t, .beta = beta};
    oracle_each_start(g, cells, 100, add_point, &q);
    for (int k = 0; k < NFEATURES; k++)
        q.sum[k] /= q.weight;
    return q;
}

/* Kernels that together reach everything. */
typedef struct {
    const char *name;
    double share[SG_MOVE_KINDS];
    bool delayed, sizes_only;
} recipe;

static const recipe recipes[] = {
    {"fresh jumps", {1, 0, 0, 0, 0}, false, false},
    {"fresh jumps, delayed", {1, 0, 0, 0, 0}, true, false},
    {"copying jumps, resampling", {1, 1, 1, 0, 0}, false, false},
    {"jumps, delayed, reflecting", {1, 3, 0, 3, 0}, true, false}, /* copies alone never pass some guards */
    {"copying jumps, shifts", {0, 1, 0, 0, 2}, false, true},
    {"switches, shifts", {0.3, 0, 0, 0, 1, 3}, false, true},
    {"switches alone for the rules", {0, 0, 1, 0, 1, 4}, false, true},
    {"everything", {1, 1, 1, 1, 1, 1}, true, false},
};

enum { NRECIPES = sizeof recipes / sizeof *recipes };

static void run_chain(const toy *t, const sg_grammar *g, const recipe *r, double beta, uint64_t seed, size_t steps,
                      batch_means *means)
{
    sg_error err = SG_ERROR_INIT;
    sg_kernel_opts opts = SG_KERNEL_OPTS_INIT;
    memcpy(opts.share, r->share, sizeof opts.share);
    opts.delayed_rejection = r->delayed;
    opts.depth_base = 1 + (double)(seed % 3) / 2;
    opts.reflect_step = 0.3;
    toy_score score;
    toy_score_init(&score, t->log_of, NULL);
    sg_chain *c = NULL;
    ck_ok(sg_chain_create(g, &score.base, &opts, seed, 0, beta, &c, &err));
    ck_ok(sg_chain_start(c, NULL, 5, NULL, &err));
    batch_means_init(means, NFEATURES, steps);
    for (size_t i = 1; i <= steps + steps / 20; i++) {
        double f[NFEATURES];
        test_must_ok(sg_chain_step(c, i, NULL, &err));
        if (i <= steps / 20) /* it begins elsewhere */
            continue;
        features_of(sg_chain_derivation(c), f);
        batch_means_add(means, f);
    }
    sg_chain_free(c);
}

static void compare(const toy *t, const recipe *r, double beta, uint64_t seed, const batch_means *means,
                    const double *right)
{
    for (size_t k = 0; k < NFEATURES; k++) {
        const double z = batch_means_z(means, k, right[k]);
        ck_assert_msg(z < 5, "%s, %s, beta %g, seed %d: feature %zu is %g +- %g, should be %g", t->name, r->name, beta,
                      (int)seed, k, batch_means_mean(means, k), batch_means_error(means, k), right[k]);
    }
}

START_TEST(means_are_those_of_quadrature)
{
    enum { STEPS = 120000 };
    const toy *t = toys + _i;
    sg_grammar *g = test_grammar(t->text);
    const double betas[] = {1, 0.5};
    quadrature right[2];
    for (int b = 0; b < 2; b++)
        right[b] = integrate(t, g, t->cells, betas[b]);
    for (int i = 0; i < NRECIPES; i++) {
        if (recipes[i].sizes_only && !t->sizes)
            continue;
        const int b = i % 2;
        const uint64_t seed = (uint64_t)(100 * _i + i);
        batch_means means;
        run_chain(t, g, recipes + i, betas[b], seed, STEPS, &means);
        compare(t, recipes + i, betas[b], seed, &means, right[b].sum);
    }
    sg_grammar_free(g);
}
END_TEST

/* The integrals of the two examples of MATHEMATICS B5.2 and B5.5, without this project's draws or trees. */
static double two_uniforms(double sum, void *user)
{
    (void)user; /* density of the sum of two uniforms on (0,10), times the score */
    return (sum < 10 ? sum : 20 - sum) / 100 * exp(-0.5 * (sum - 3) * (sum - 3));
}

static double one_size(double s, void *user)
{
    const double *p = user, mean = p[0], sd = p[1];
    const double mass = gsl_cdf_gaussian_P(1 - mean, sd) - gsl_cdf_gaussian_P(-mean, sd);
    return gsl_ran_gaussian_pdf(s - mean, sd) / mass * exp(-0.5 * pow((s - 0.37) / 0.15, 2));
}

static double integral(double (*f)(double, void *), void *user, double a, double b)
{
    gsl_function function = {f, user};
    gsl_integration_workspace *w = gsl_integration_workspace_alloc(500);
    double sum = NAN, error;
    ck_assert_int_eq(gsl_integration_qags(&function, a, b, 0, 1e-9, 500, w, &sum, &error), 0);
    gsl_integration_workspace_free(w);
    return sum;
}

/* Probability of the first rule. */
static double closed_form(int which)
{
    if (which == 0) {
        const double one = 0.4 * sqrt(2 * M_PI) * gsl_ran_gaussian_pdf(3 - 1, sqrt(1 + 0.25));
        const double two = 0.6 * (integral(two_uniforms, NULL, 0, 10) + integral(two_uniforms, NULL, 10, 20));
        return one / (one + two);
    }
    double two_parts[] = {0.45, 0.08}, three_parts[] = {0.3, 0.12};
    const double two = 0.3 * integral(one_size, two_parts, 0, 1), three = 0.7 * integral(one_size, three_parts, 0, 1);
    return two / (two + three);
}

START_TEST(probabilities_are_those_of_closed_forms)
{
    enum { STEPS = 400000 };
    const toy *t = toys + _i;
    const recipe *everything = recipes + NRECIPES - 1;
    const double right = closed_form(_i);
    sg_grammar *g = test_grammar(t->text);
    ck_assert_double_eq_tol(integrate(t, g, t->cells, 1).sum[0], right, 1e-4);
    if (_i == 0)
        ck_assert_double_eq_tol(right, 0.6155, 5e-5); /* as in MATHEMATICS B5.2 */
    batch_means means;
    run_chain(t, g, everything, 1, (uint64_t)_i + 1000, STEPS, &means);
    ck_assert_msg(batch_means_z(&means, 0, right) < 5, "%s, seed %d: %g +- %g, should be %g", t->name, _i + 1000,
                  batch_means_mean(&means, 0), batch_means_error(&means, 0), right);
    ck_assert(batch_means_error(&means, 0) < 0.004); /* the printed ratios are off by more than a tenth */
    sg_grammar_free(g);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("kernels_values");
    TCase *tc = tcase_create("values");
    tcase_set_timeout(tc, 60);
    tcase_add_loop_test(tc, means_are_those_of_quadrature, 0, NTOYS);
    tcase_add_loop_test(tc, probabilities_are_those_of_closed_forms, 0, 2);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
