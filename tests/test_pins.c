/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_pins.c - draws and choices that are given: which ones a pin means, what it leaves to chance, and that the derivation is
 * a proper one. */
#include "core/random.h"
#include "derivation/derivation_io.h"
#include "derivation/pins.h"
#include "tests/failing_malloc.h"
#include "tests/grammar_support.h"

#include <gsl/gsl_cdf.h>

/* Every kind of draw, on a tree that is the same whatever they are. */
static const char fixed[] = "start S\n"
                            "rule S -> u ~ uniform(2, 5) A(u) B A(1) [ B A(2) ]\n"
                            "rule A(a) -> n ~ normal(a, 2) t ~ truncated_normal(0, 1, -1, 3) draw(normal(n, 1)) B\n"
                            "rule B -> m ~ mixture((1, 0, 1), (3, 2, 0.5)) k ~ discrete((1, 1), (2, 2), (1, 1), (4, 7))\n"
                            "   split x { C | C | C } sizes mean (0.2, 0.3, 0.5) sd (0.1, 0.1, 0.2)\n"
                            "rule C -> draw(1)\n";
static const char branching[] = "weights\nlimit depth 5\nstart S(1)\n"
                                "rule S(a) if a < 3 -> 2 : h ~ uniform(0, 1) A(h) S(a + h) S(1) -> 1 : A(2)\n"
                                "rule S(a) if a >= 3 -> A(a)\n"
                                "rule A(x) -> 1 : w ~ normal(x, 1) draw(w) -> x + 1 : maybe(0.5) B\n"
                                "rule B -> h ~ uniform(0, 4) draw(h)\n"
                                "rule S(a) at limit -> draw(a)\n";

typedef struct {
    sg_grammar *g;
    sg_pins *pins;
    sg_pin_run *run;
    sg_derivation d;
    gsl_rng *rng;
} fixture;

/* texts: a NULL-terminated list */
static fixture open_fixture(const char *grammar, const char *const *texts, uint64_t seed)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = {.g = test_grammar(grammar), .rng = sg_random_create(seed)};
    ck_ok(sg_pins_create(f.g, &f.pins, &err));
    for (; *texts != NULL; texts++)
        ck_ok(sg_pins_add(f.pins, *texts, &err));
    ck_ok(sg_pin_run_create(f.pins, &f.run, &err));
    sg_derivation_init(&f.d, f.g);
    return f;
}

static void close_fixture(fixture *f)
{
    sg_derivation_clear(&f->d);
    sg_pin_run_free(f->run);
    sg_pins_free(f->pins);
    gsl_rng_free(f->rng);
    sg_grammar_free(f->g);
}

#define PINS(...) ((const char *const[]){__VA_ARGS__, NULL})

static void sample(fixture *f)
{
    sg_error err = SG_ERROR_INIT;
    test_must_ok(sg_derivation_sample_given(&f->d, f->run, f->rng, 100000, &err));
}

/* Value v (arguments first) of the k-th node of a symbol, from 0. */
static double value_of(const fixture *f, const char *symbol, size_t k, size_t v)
{
    const sg_sym s = sg_grammar_find(f->g, symbol);
    for (size_t i = 0; i < f->d.nnodes; i++)
        if (f->d.nodes[i].symbol == s && k-- == 0)
            return f->d.values[f->d.nodes[i].values + v];
    ck_abort_msg("no such node of %s", symbol);
}


/* A's values: a, n, t, and the draw without a name. B's: m, k, three sizes. */
START_TEST(pinned_values_stand_where_they_should)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(fixed, PINS("S.u=3", "A#2.n = -1.5", "A.t=2.25", "A.t=0.5", "S > B.k=7", "B#1.m=1.1",
                                         "A > B.3=(0.1, 0.7,0.2)", "S > (1 more) > B#2.m=-4", "A:1.3=2"),
                             (uint64_t)_i + 1);
    sample(&f);
    ck_ok(sg_derivation_check(&f.d, &err));
    ck_assert(value_of(&f, "S", 0, 0) == 3 && value_of(&f, "A", 0, 0) == 3 && value_of(&f, "A", 1, 1) == -1.5);
    for (size_t k = 0; k < 3; k++)
        ck_assert(value_of(&f, "A", k, 2) == 0.5 && value_of(&f, "A", k, 3) == 2 &&
                  (k == 1 || value_of(&f, "A", k, 1) != -1.5));
    ck_assert(value_of(&f, "B", 1, 1) == 7 && value_of(&f, "B", 3, 1) == 7);
    ck_assert(value_of(&f, "B", 0, 0) == 1.1 && value_of(&f, "B", 1, 0) != 1.1);
    ck_assert(value_of(&f, "B", 2, 0) == -4); /* the second B that has one symbol between S and itself */
    for (size_t k = 0; k < 5; k += 2)
        ck_assert(fabs(value_of(&f, "B", k, 3) - 0.7) < 1e-12 && fabs(value_of(&f, "B", k, 4) - 0.2) < 1e-12);
    ck_assert(fabs(value_of(&f, "B", 1, 3) - 0.7) > 1e-6);
    const size_t uses[] = {1, 1, 0, 3, 2, 1, 3, 1, 3};
    for (size_t i = 0; i < sg_pins_count(f.pins); i++)
        ck_assert_msg(sg_pin_run_uses(f.run, i) == uses[i], "%s: %zu", sg_pins_text(f.pins, i), sg_pin_run_uses(f.run, i));
    close_fixture(&f);
}
END_TEST

/* Draws that are not pinned, and depend on no pinned one, are those of the same seed. */
START_TEST(other_draws_stay)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(fixed, PINS("B.k=2", "A#1.t=0"), 9);
    sg_derivation free_one;
    sg_derivation_init(&free_one, f.g);
    sg_random_stream(f.rng, 9, (uint32_t)_i, 0);
    sample(&f);
    sg_random_stream(f.rng, 9, (uint32_t)_i, 0);
    ck_ok(sg_derivation_sample(&free_one, f.rng, 1000, &err));
    ck_assert_uint_eq(free_one.nuniforms, f.d.nuniforms);
    size_t changed = 0;
    for (size_t i = 0; i < f.d.nuniforms; i++)
        changed += free_one.uniforms[i] != f.d.uniforms[i];
    ck_assert(changed >= 5 && changed <= 6);
    sg_derivation_clear(&free_one);
    close_fixture(&f);
}
END_TEST

/* chi-square of counts against probabilities */
static void check_counts(const size_t *count, const double *p, size_t n, size_t total, const char *what)
{
    double chisq = 0;
    for (size_t i = 0; i < n; i++) {
        const double expected = p[i] * (double)total;
        chisq += ((double)count[i] - expected) * ((double)count[i] - expected) / expected;
    }
    ck_assert_msg(gsl_cdf_chisq_Q(chisq, (double)n - 1) > 1e-6, "%s: chi-square %g", what, chisq);
}

/* What is left to chance in a mixture and a discrete draw of a given value: the component by its posterior, the uniform
 * evenly in the component's share. */
START_TEST(what_is_left_to_chance_has_its_distribution)
{
    enum { N = 20000, BINS = 8 };
    const double x = 1.2, weight[2] = {1 * exp(-x * x / 2), 3 / 0.5 * exp(-(x - 2) * (x - 2) / 0.5)};
    const double p[2] = {weight[0] / (weight[0] + weight[1]), weight[1] / (weight[0] + weight[1])};
    fixture f = open_fixture(fixed, PINS("B.m=1.2", "B.k=1"), (uint64_t)_i + 50);
    const sg_sym b = sg_grammar_find(f.g, "B");
    size_t component[2] = {0}, place[2][BINS] = {{0}}, value[2] = {0};
    for (int i = 0; i < N; i++) {
        sample(&f);
        size_t node = 0;
        while (f.d.nodes[node].symbol != b)
            node++;
        const double *u = f.d.uniforms + f.d.nodes[node].uniforms;
        const int second = u[0] >= 0.25;
        component[second]++;
        place[second][(size_t)(BINS * (second ? (u[0] - 0.25) / 0.75 : u[0] / 0.25))]++;
        ck_assert((u[2] > 0 && u[2] < 0.125) || (u[2] > 0.375 && u[2] < 0.5)); /* the two 1s of 8 */
        value[u[2] > 0.3]++;
    }
    double even[BINS];
    for (size_t i = 0; i < BINS; i++)
        even[i] = 1.0 / BINS;
    check_counts(component, p, 2, N, "components");
    check_counts(place[0], even, BINS, component[0], "first share");
    check_counts(place[1], even, BINS, component[1], "second share");
    check_counts(value, (const double[]){0.5, 0.5}, 2, N, "equal values");
    close_fixture(&f);
}
END_TEST

/* Rules, with guards and a depth limit, are pinned where they may stand. */
START_TEST(rules_are_chosen)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(branching, PINS("S#1=1", "S > S=2", "A=2", "maybe(0.5) B=1", "B.h=4"), (uint64_t)_i + 7);
    sample(&f);
    ck_ok(sg_derivation_check(&f.d, &err));
    ck_assert_uint_eq(f.d.nnodes, 12); /* S A ~ B, S A ~ B, S A ~ B */
    double log_prior = NAN, expected = log(2.0 / 3);
    ck_ok(sg_derivation_log_prior(&f.d, &log_prior, &err));
    ck_assert(isfinite(log_prior));
    const double h = value_of(&f, "S", 0, 1);
    const double x[3] = {h, 2, 2};
    for (int i = 0; i < 3; i++)
        expected += log((x[i] + 1) / (x[i] + 2)) + log(0.5) + (i > 0 ? log(1.0 / 3) : 0);
    ck_assert_double_eq_tol(log_prior, expected, 1e-12);
    /* All choices are pinned, and the draws of B. */
    ck_assert_double_eq_tol(sg_pin_run_log_weight(f.run), log_prior + 3 * log(0.25), 1e-12);
    close_fixture(&f);
    f = open_fixture(branching, PINS("S=3"), 1);
    ck_assert_int_eq(sg_derivation_sample_given(&f.d, f.run, f.rng, 1000, &err), SG_ENUMERIC);
    ck_assert_ptr_nonnull(strstr(err.msg, "): given S=3: this rule has probability 0 here"));
    ck_assert_uint_eq(f.d.nnodes, 0);
    close_fixture(&f);
    f = open_fixture(branching, PINS("S=1"), 2); /* down to the limit, where nothing is chosen; where a < 3 no more it fails */
    (void)sg_derivation_sample_given(&f.d, f.run, f.rng, 1000, &err);
    close_fixture(&f);
}
END_TEST

/* Weighted by the pins' density, samples of S = (x, y), x ~ N(0,1), y ~ N(x,1), y pinned, are those of the posterior of x. */
START_TEST(weights_make_the_posterior)
{
    enum { N = 40000 };
    fixture f = open_fixture("start S\nrule S -> x ~ normal(0, 1) y ~ normal(x, 1) draw(y)\n", PINS("S.y=1.5"), (uint64_t)_i + 3);
    double sum = 0, first = 0, second = 0;
    for (int i = 0; i < N; i++) {
        sample(&f);
        const double w = exp(sg_pin_run_log_weight(f.run)), x = f.d.values[0];
        sum += w;
        first += w * x;
        second += w * x * x;
    }
    const double mean = first / sum, variance = second / sum - mean * mean;
    ck_assert_double_eq_tol(mean, 0.75, 0.03);
    ck_assert_double_eq_tol(variance, 0.5, 0.03);
    ck_assert_double_eq_tol(sum / N, exp(-1.5 * 1.5 / 4) / sqrt(4 * M_PI), 0.004); /* the evidence */
    close_fixture(&f);
}
END_TEST

START_TEST(derivations_are_stored_and_read_again)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(fixed, PINS("A.n=40", "A#1.t=2.9999999999", "B.m=1", "B#2.3=0.9,0.05,0.05", "S.u=5", "S.u=2", "A#3.3=10"),
                             (uint64_t)_i + 1);
    sample(&f);
    sg_bytes bytes = {0};
    ck_ok(sg_derivation_file_encode(f.g, &f.d, 1, &bytes, &err));
    sg_derivation_file file;
    ck_ok(sg_derivation_file_decode(bytes.bytes, bytes.n, "memory", f.g, &file, &err));
    ck_assert_uint_eq(file.items[0].nvalues, f.d.nvalues);
    ck_assert_mem_eq(file.items[0].values, f.d.values, f.d.nvalues * sizeof *f.d.values);
    double log_prior = NAN;
    ck_ok(sg_derivation_log_prior(&f.d, &log_prior, &err));
    ck_assert(file.log_priors[0] == log_prior);
    ck_ok(sg_derivation_refresh(&file.items[0], 0, &err)); /* values anew from uniforms */
    for (size_t i = 0; i < f.d.nvalues; i++)
        ck_assert_double_eq_tol(file.items[0].values[i], f.d.values[i], 1e-9 * (1 + fabs(f.d.values[i])));
    sg_bytes_clear(&bytes);
    sg_derivation_file_clear(&file);
    close_fixture(&f);
}
END_TEST

/* A pin that cannot be: when it is read, or when it comes to it. */
static void check_refused(const char *grammar, const char *text, const char *sentence)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(grammar, (const char *const[]){NULL}, 1);
    sg_status st = sg_pins_add(f.pins, text, &err);
    if (st == SG_OK) {
        sg_pin_run_free(f.run);
        ck_ok(sg_pin_run_create(f.pins, &f.run, &err));
        st = sg_derivation_sample_given(&f.d, f.run, f.rng, 1000, &err);
        ck_assert_int_eq(st, SG_ENUMERIC);
    } else
        ck_assert_int_eq(st, SG_EINVAL);
    ck_assert_msg(strstr(err.msg, sentence) != NULL, "%s\nsays: %s\nwants: %s", text, err.msg, sentence);
    close_fixture(&f);
}

START_TEST(bad_pins_are_refused)
{
    static const struct {
        const char *text, *sentence;
    } cases[] = {
        {"X.a=1", "no symbol at 'X.a=1'; the symbols are: S, A, B, C"},
        {"S > Q.a=1", "no symbol at 'Q.a=1'"},
        {"", "no symbol"},
        {"A.q=1", "A has no draw 'q' of 1 value; its draws are: n in rule 1, t in rule 1, 3 in rule 1"},
        {"A.a=1", "A has no draw 'a'"},
        {"A.4=1", "A has no draw '4'"},
        {"A.n=1,2", "of 2 values"},
        {"B.3=0.5", "its draws are: m in rule 1, k in rule 1, 3 (3 sizes) in rule 1"},
        {"C.1=1", "its draws are: none"},
        {"A:2.n=1", "A has 1 rule, not 2"},
        {"A=2", "A has 1 rule, not 2"},
        {"A=0", "the number of a rule"},
        {"A=x", "the number of a rule"},
        {"A#0.n=1", "follows #"},
        {"A.n", "= is missing"},
        {"A n=1", "no symbol at 'A n=1'"},
        {"A#1 n=1", "neither . nor = follows"},
        {"A.=1", "the name of a draw follows"},
        {"A.n=", "is no number"},
        {"A.n=inf", "is no number"},
        {"A.n=1x", "something follows"},
        {"S > (1 more).n=1", "ends with no symbol"},
        {"S.u=5.5", "deriving S: given S.u=5.5: 5.5 is outside of the support of this uniform: from 2 to 5"},
        {"A.t=-1.01", "): given A.t=-1.01: -1.01 is outside of the support of this truncated_normal: from -1 to 3"},
        {"B.k=3", "3 is outside of the support of this discrete: 1, 2, 1, 7"},
        {"B.3=0.5,0.5,0.5", "no 3 sizes greater than 0 that sum to 1"},
        {"B.3=1,0,0", "no 3 sizes greater than 0 that sum to 1"},
        {"A.n=1000", "1000 is too far in a tail of this normal"},
        {"B.m=-1000", "-1000 is too far in a tail of this mixture"},
    };
    check_refused(fixed, cases[_i].text, cases[_i].sentence);
}
END_TEST

START_TEST(memory_that_is_out_is_told)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(fixed, (const char *const[]){NULL}, 1);
    size_t failures = 0;
    for (size_t k = 0;; k++, failures++) {
        sg_pins *pins = NULL;
        sg_pin_run *run = NULL;
        test_fail_allocation(k);
        sg_status st = sg_pins_create(f.g, &pins, &err);
        if (st == SG_OK)
            st = sg_pins_add(pins, "S > A#2.n=3", &err);
        if (st == SG_OK)
            st = sg_pins_add(pins, "B.3=0.2,0.3,0.5", &err);
        if (st == SG_OK)
            st = sg_pin_run_create(pins, &run, &err);
        if (st == SG_OK)
            st = sg_derivation_sample_given(&f.d, run, f.rng, 1000, &err);
        const bool failed = test_allocation_failed();
        ck_assert_int_eq(st, failed ? SG_ENOMEM : SG_OK);
        sg_pin_run_free(run);
        sg_pins_free(pins);
        if (!failed)
            break;
    }
    ck_assert_uint_ge(failures, 10);
    close_fixture(&f);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("pins");
    TCase *tc = tcase_create("pins");
    tcase_add_loop_test(tc, pinned_values_stand_where_they_should, 0, 5);
    tcase_add_loop_test(tc, other_draws_stay, 0, 5);
    tcase_add_loop_test(tc, what_is_left_to_chance_has_its_distribution, 0, 2);
    tcase_add_loop_test(tc, rules_are_chosen, 0, 5);
    tcase_add_loop_test(tc, weights_make_the_posterior, 0, 2);
    tcase_add_loop_test(tc, derivations_are_stored_and_read_again, 0, 5);
    tcase_add_loop_test(tc, bad_pins_are_refused, 0, 29);
    tcase_add_test(tc, memory_that_is_out_is_told);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
