/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_chain.c - chains: what is carried against what is computed anew, the best against all that was visited, memory. That
 * their kernels keep the target is proven elsewhere. */
#include "search/chain.h"

#include "core/random.h"
#include "derivation/derivation_move.h"
#include "tests/failing_malloc.h"
#include "tests/function_score.h"
#include "tests/grammar_support.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_integration.h>
#include <gsl/gsl_randist.h>
#include <string.h>

/* Everything that a grammar can pass on, as in test_move.c. */
static const char passing[] = "grammar passing\n"
                              "weights\n"
                              "limit depth 5\n"
                              "label t\nlabel w\n"
                              "start S(2)\n"
                              "rule S(a) if a > 0.3\n"
                              "  -> 1 + a : u ~ uniform(0.1, a) split x { T(u) | S(a / 2) | T(a + u) }\n"
                              "  -> 1 : split y { S(a * 0.7) | T(1) | t } sizes mean (0.3, 0.3, 0.4) sd (0.1, 0.1, 0.1)\n"
                              "  -> 1 : n ~ uniform(0.5, a + 1) repeat x n { split y { S(a / 3) | T(a) } }\n"
                              "rule S(a) if a <= 0.3\n"
                              "  -> 1 : w\n"
                              "rule S(a) at limit -> w\n"
                              "rule T(b) if b > 0.5\n"
                              "  -> 2 : t\n"
                              "  -> b : v ~ normal(b, 1) split x { '0.5 : U(v) | '0.5 : t }\n"
                              "rule T(b) if b <= 0.5\n"
                              "  -> 1 : s ~ uniform(0.1, 0.9) split x { 's : U(b) | ~1 : t }\n"
                              "rule U(v)\n"
                              "  -> 1 : t\n"
                              "  -> v * v : split y { t | w | w } sizes mean (0.2, 0.3, 0.5) sd (0.1, 0.05, 0.2)\n";

/* Sizes only: what facades are made of. */
static const char sized[] = "label t\nlabel w\nstart S\n"
                            "rule S -> 0.2 : split x { S | R | S } sizes mean (0.4, 0.2, 0.4) sd (0.1, 0.1, 0.1)\n"
                            "       -> 0.25 : split y { S | R } sizes mean (0.5, 0.5) sd (0.02, 0.02)\n"
                            "       -> 0.55 : t\n"
                            "rule R -> 0.7 : split x { t | w | t | w } sizes mean (0.3, 0.2, 0.3, 0.2)\n"
                            "   covariance ((0.01, -0.004, 0), (-0.004, 0.01, 0), (0, 0, 0.02))\n"
                            "       -> 0.3 : w\n";

/* Wants about 14 nodes, values near 0.35; smooth enough for each move to be accepted sometimes. */
static double wants(const sg_derivation *d)
{
    double sum = 0;
    for (size_t i = 0; i < d->nvalues; i++)
        sum -= fabs(d->values[i] - 0.35);
    return 4 * sum - 0.3 * fabs((double)d->nnodes - 14);
}

/* The same, and cannot interpret trees with a certain rule at a certain place. */
static double refuses_some(const sg_derivation *d)
{
    return d->nnodes % 5 == 3 ? -INFINITY : wants(d);
}

static double indifferent(const sg_derivation *d)
{
    (void)d;
    return 0;
}

typedef struct {
    sg_grammar *g;
    function_score *score;
    sg_chain *c;
} fixture;

static const sg_kernel_opts all_moves = {{0.2, 0.2, 0.2, 0.2, 0.2, 0.2}, true, 8, 1, 0.1, 0.5, 400};

static fixture open_fixture(const char *text, double (*log_of)(const sg_derivation *), const sg_kernel_opts *opts,
                            uint64_t seed, double beta)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = {.g = test_grammar(text), .score = malloc(sizeof *f.score)};
    ck_assert_ptr_nonnull(f.score);
    *f.score = (function_score){{&function_ops}, log_of, false};
    ck_ok(sg_chain_create(f.g, &f.score->base, opts, seed, 0, beta, &f.c, &err));
    ck_ok(sg_chain_start(f.c, NULL, 10, NULL, &err));
    return f;
}

static void close_fixture(fixture *f)
{
    sg_chain_free(f->c);
    sg_grammar_free(f->g);
    free(f->score);
}

static void step_many(sg_chain *c, uint64_t first, uint64_t n)
{
    sg_error err = SG_ERROR_INIT;
    sg_status st = SG_OK;
    for (uint64_t i = first; st == SG_OK && i < first + n; i++)
        st = sg_chain_step(c, i, NULL, &err);
    ck_ok(st);
}

static bool same(const sg_derivation *a, const sg_derivation *b)
{
    return a->nnodes == b->nnodes && a->nvalues == b->nvalues && a->nuniforms == b->nuniforms &&
           (a->nnodes == 0 || memcmp(a->nodes, b->nodes, a->nnodes * sizeof *a->nodes) == 0) &&
           (a->nvalues == 0 || memcmp(a->values, b->values, a->nvalues * sizeof *a->values) == 0) &&
           (a->nuniforms == 0 || memcmp(a->uniforms, b->uniforms, a->nuniforms * sizeof *a->uniforms) == 0);
}

static sg_posterior from_scratch(const fixture *f, const sg_derivation *d)
{
    sg_error err = SG_ERROR_INIT;
    sg_posterior p = {{f->score->log_of(d), f->score->log_of(d)}, NAN, NAN};
    ck_ok(sg_derivation_log_prior(d, &p.log_rules, &err));
    ck_ok(sg_derivation_log_density(d, &p.log_density, &err));
    return p;
}

static void check_carried(const fixture *f)
{
    sg_error err = SG_ERROR_INIT;
    const sg_posterior want = from_scratch(f, sg_chain_derivation(f->c)), *got = sg_chain_posterior(f->c);
    ck_ok(sg_derivation_check(sg_chain_derivation(f->c), &err));
    ck_assert_double_eq_tol(got->score.log, want.score.log, 1e-12);
    ck_assert_double_eq_tol(got->log_rules, want.log_rules, 1e-9);
    ck_assert_double_eq_tol(got->log_density, want.log_density, 1e-9);
}

START_TEST(what_is_carried_is_what_is_computed_anew)
{
    sg_kernel_opts opts = all_moves;
    opts.depth_base = _i < 4 ? 1 : 1.7;
    fixture f = open_fixture(_i % 2 == 0 ? sized : passing, _i % 3 == 0 ? refuses_some : wants, &opts, (uint64_t)_i + 1, 0.7);
    for (uint64_t i = 0; i < 20; i++) {
        step_many(f.c, 1 + i * 1000, 1000);
        check_carried(&f);
    }
    step_many(f.c, 20001, 80000);
    check_carried(&f);
    const sg_chain_stats *s = sg_chain_statistics(f.c);
    for (int k = 0; k < SG_MOVE_KINDS; k++)
        ck_assert_msg(s->proposed[k] == 0 ? k == SG_MOVE_SWITCH && _i % 2 == 1 : s->accepted[k] > 100 && s->accepted[k] < s->proposed[k], "move %d: %lu of %lu", k,
                      (unsigned long)s->accepted[k], (unsigned long)s->proposed[k]);
    ck_assert_msg(s->second_accepted > 10 && s->second_accepted < s->second_proposed, "%lu of %lu second tries",
                  (unsigned long)s->second_accepted, (unsigned long)s->second_proposed);
    close_fixture(&f);
}
END_TEST

START_TEST(the_best_is_the_best_of_all_that_was_visited)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(_i % 2 == 0 ? sized : passing, wants, &all_moves, (uint64_t)_i + 10, 0.5);
    sg_derivation best;
    sg_derivation_init(&best, f.g);
    double highest = -INFINITY;
    for (uint64_t i = 0; i < 3000; i++) {
        if (i > 0)
            ck_ok(sg_chain_step(f.c, i, NULL, &err));
        const double now = sg_posterior_log(sg_chain_posterior(f.c));
        if (now > highest) {
            ck_ok(sg_derivation_copy(&best, sg_chain_derivation(f.c), &err));
            highest = now;
        }
        sg_posterior p;
        const sg_derivation *got = sg_chain_best(f.c, &p);
        if (i % 10 != 0 && i > 100)
            continue;
        ck_assert(same(got, &best));
        ck_assert_double_eq(sg_posterior_log(&p), highest);
    }
    sg_derivation_clear(&best);
    close_fixture(&f);
}
END_TEST

static int kinds_seen(const sg_chain_stats *s)
{
    int n = 0;
    for (int k = 0; k < SG_MOVE_KINDS; k++)
        n += s->proposed[k] > 0;
    return n;
}

static bool is_jump(sg_move_kind kind)
{
    return kind <= SG_MOVE_JUMP_COPY || kind == SG_MOVE_SWITCH;
}

START_TEST(a_step_is_what_its_terms_say)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(_i % 2 == 0 ? passing : sized, wants, &all_moves, (uint64_t)_i + 20, 0.8);
    sg_derivation before;
    sg_derivation_init(&before, f.g);
    for (uint64_t i = 1; i < 4000; i++) {
        sg_move m;
        ck_ok(sg_derivation_copy(&before, sg_chain_derivation(f.c), &err));
        const sg_posterior p = *sg_chain_posterior(f.c);
        ck_ok(sg_chain_step(f.c, i, &m, &err));
        const sg_posterior *q = sg_chain_posterior(f.c);
        ck_assert(m.node == SIZE_MAX || m.node < before.nnodes);
        ck_assert(m.accepted || same(&before, sg_chain_derivation(f.c)));
        ck_assert(m.log_accept <= 0 && m.log_accept2 <= 0 && (!m.second_stage || m.log_accept < 0));
        ck_assert(!m.second_stage || m.kind <= SG_MOVE_JUMP_COPY);
        const double sum = 0.8 * m.d_log_score + m.d_log_rules + m.d_log_select + m.d_log_propose;
        ck_assert(m.d_log_score == -INFINITY ? m.log_accept == -INFINITY : fabs(fmin(0, sum) - m.log_accept) < 1e-12);
        ck_assert_double_eq(m.d_log_anneal, 0);
        ck_assert(is_jump(m.kind) ? m.d_log_rules == 0 : m.d_log_select == 0);
        ck_assert(m.kind == SG_MOVE_SHIFT || m.kind == SG_MOVE_SWITCH || m.d_log_propose == 0);
        if (m.accepted && !m.second_stage)
            ck_assert_double_eq_tol(q->score.log - p.score.log, m.d_log_score, 1e-12);
        if (m.accepted && !is_jump(m.kind))
            ck_assert_double_eq_tol(q->log_rules - p.log_rules, m.d_log_rules, 1e-9);
    }
    /* rules that depend on arguments are not switched */
    ck_assert_int_eq(kinds_seen(sg_chain_statistics(f.c)), _i % 2 == 0 ? SG_MOVE_KINDS - 1 : SG_MOVE_KINDS);
    sg_derivation_clear(&before);
    close_fixture(&f);
}
END_TEST

/* A score that stops below the floor takes the chain to the same places. */
START_TEST(early_ends_of_scores_change_nothing)
{
    sg_error err = SG_ERROR_INIT;
    for (int k = 0; k < 2; k++) {
        fixture f[2];
        size_t cut = 0;
        for (int e = 0; e < 2; e++) {
            f[e] = open_fixture(k == 0 ? sized : passing, refuses_some, &all_moves, 5, 30);
            f[e].score->stops_early = e == 1;
        }
        for (uint64_t i = 1; i < 3000; i++) {
            sg_move m[2];
            for (int e = 0; e < 2; e++)
                ck_ok(sg_chain_step(f[e].c, i, &m[e], &err));
            cut += m[1].d_log_score == -INFINITY && m[0].d_log_score > -INFINITY;
            ck_assert(m[0].accepted == m[1].accepted);
            ck_assert_msg(fabs(exp(m[0].log_accept) - exp(m[1].log_accept)) < 1e-19, "%g %g", m[0].log_accept, m[1].log_accept);
        }
        const sg_derivation *a = sg_chain_derivation(f[0].c), *b = sg_chain_derivation(f[1].c);
        ck_assert_uint_eq(a->nnodes, b->nnodes);
        ck_assert(a->nvalues == b->nvalues && memcmp(a->values, b->values, a->nvalues * sizeof *a->values) == 0);
        ck_assert_uint_gt(cut, 100);
        for (int e = 0; e < 2; e++)
            close_fixture(&f[e]);
    }
}
END_TEST

START_TEST(a_chain_is_a_function_of_seed_and_number)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(passing, wants, &all_moves, 3, 1);
    sg_chain *c[4];
    const uint64_t seeds[4] = {3, 3, 4, 3};
    const uint32_t ids[4] = {0, 0, 0, 1};
    for (int i = 0; i < 4; i++) {
        ck_ok(sg_chain_create(f.g, &f.score->base, &all_moves, seeds[i], ids[i], 1, &c[i], &err));
        ck_ok(sg_chain_start(c[i], NULL, 10, NULL, &err));
        step_many(c[i], 1, 500);
    }
    ck_assert(same(sg_chain_derivation(c[0]), sg_chain_derivation(c[1])));
    ck_assert(!same(sg_chain_derivation(c[0]), sg_chain_derivation(c[2])));
    ck_assert(!same(sg_chain_derivation(c[0]), sg_chain_derivation(c[3])));
    for (int i = 0; i < 4; i++)
        sg_chain_free(c[i]);
    close_fixture(&f);
}
END_TEST

START_TEST(a_chain_begins_at_the_best_sample_or_at_what_is_given)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(sized, wants, &all_moves, 3, 1);
    double last = -INFINITY;
    for (size_t tries = 1; tries <= 64; tries *= 8) {
        ck_ok(sg_chain_start(f.c, NULL, tries, NULL, &err));
        check_carried(&f);
        ck_assert_double_ge(sg_chain_posterior(f.c)->score.log, last);
        last = sg_chain_posterior(f.c)->score.log;
    }
    sg_derivation d;
    sg_derivation_init(&d, f.g);
    gsl_rng *rng = sg_random_create(5);
    ck_ok(sg_derivation_sample(&d, rng, 1000, &err));
    ck_ok(sg_chain_start(f.c, &d, 0, NULL, &err));
    ck_assert(same(&d, sg_chain_derivation(f.c)) && same(&d, sg_chain_best(f.c, NULL)));
    check_carried(&f);
    while (d.nnodes % 5 != 3)
        ck_ok(sg_derivation_sample(&d, rng, 1000, &err));
    f.score->log_of = refuses_some;
    sg_chain *c = NULL;
    ck_ok(sg_chain_create(f.g, &f.score->base, &all_moves, 1, 0, 1, &c, &err));
    ck_assert_int_eq(sg_chain_start(c, &d, 0, NULL, &err), SG_ENOPARSE);
    sg_chain_free(c);
    gsl_rng_free(rng);
    sg_derivation_clear(&d);
    close_fixture(&f);
}
END_TEST

static double impossible(const sg_derivation *d)
{
    (void)d;
    return -INFINITY;
}

START_TEST(bad_options_and_hopeless_scores_are_refused)
{
    sg_error err = SG_ERROR_INIT;
    sg_grammar *g = test_grammar(sized);
    function_score score = {{&function_ops}, impossible, false};
    sg_chain *c = NULL;
    for (int i = 0; i < 9; i++) {
        sg_kernel_opts o = all_moves;
        double beta = 1;
        switch (i) {
        case 0: o.share[3] = -0.1; break;
        case 1: memset(o.share, 0, sizeof o.share); break;
        case 2: o.share[0] = NAN; break;
        case 3: o.reflect_step = 0; break;
        case 4: o.shift_step = -1; break;
        case 5: o.depth_base = 0; break;
        case 6: o.depth_base = INFINITY; break;
        case 7: beta = -0.5; break;
        default: beta = NAN; break;
        }
        ck_assert_int_eq(sg_chain_create(g, &score.base, &o, 1, 0, beta, &c, &err), SG_EINVAL);
        ck_assert_ptr_null(c);
    }
    ck_ok(sg_chain_create(g, &score.base, &all_moves, 1, 0, 1, &c, &err));
    ck_assert_int_eq(sg_chain_start(c, NULL, 5, NULL, &err), SG_ENOPARSE);
    ck_assert_ptr_nonnull(strstr(err.msg, "5 samples"));
    sg_chain_free(c);
    sg_grammar_free(g);
}
END_TEST

START_TEST(moves_without_use_take_no_share)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture("label t\nlabel w\nstart S\nrule S -> 0.5 : t -> 0.5 : w\n", indifferent, &all_moves, 1, 1);
    step_many(f.c, 1, 200);
    const sg_chain_stats *s = sg_chain_statistics(f.c);
    ck_assert_uint_eq(s->proposed[SG_MOVE_JUMP_FRESH] + s->proposed[SG_MOVE_JUMP_COPY] + s->proposed[SG_MOVE_SWITCH], 200);
    close_fixture(&f);
    f = open_fixture("label t\nstart S\nrule S -> split x { t | t }\n", indifferent, &all_moves, 1, 1);
    sg_move m;
    ck_ok(sg_chain_step(f.c, 1, &m, &err));
    ck_assert(m.node == SIZE_MAX && !m.accepted);
    close_fixture(&f);
    /* here half of the trees have nothing to shift */
    f = open_fixture("label t\nstart S\nrule S -> 0.5 : split x { t | t } sizes mean (0.5, 0.5) sd (0.1, 0.1) -> 0.5 : t\n",
                     indifferent, &all_moves, 1, 1);
    size_t idle = 0;
    for (uint64_t i = 1; i <= 500; i++) {
        ck_ok(sg_chain_step(f.c, i, &m, &err));
        idle += m.node == SIZE_MAX;
        ck_assert(m.node != SIZE_MAX || m.kind > SG_MOVE_JUMP_COPY);
    }
    ck_assert(idle > 100 && idle < 250);
    close_fixture(&f);
}
END_TEST

START_TEST(trees_stay_below_the_limit)
{
    sg_kernel_opts opts = all_moves;
    opts.max_nodes = 12;
    fixture f = open_fixture(sized, wants, &opts, 2, 0.2);
    size_t most = 0;
    for (uint64_t i = 0; i < 5000; i++) {
        step_many(f.c, i + 1, 1);
        const size_t n = sg_chain_derivation(f.c)->nnodes;
        most = n > most ? n : most;
    }
    ck_assert_uint_le(most, 12);
    ck_assert_uint_ge(most, 10);
    close_fixture(&f);
}
END_TEST

START_TEST(a_swap_exchanges_where_chains_stand)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(_i == 0 ? sized : passing, wants, &all_moves, 2, 1);
    sg_chain *b = NULL;
    ck_ok(sg_chain_create(f.g, &f.score->base, &all_moves, 2, 1, 0.4, &b, &err));
    ck_ok(sg_chain_start(b, NULL, 1, NULL, &err));
    gsl_rng *rng = sg_random_create(9);
    sg_derivation x, y, best[2];
    sg_derivation *const all[] = {&x, &y, &best[0], &best[1]};
    for (int i = 0; i < 4; i++)
        sg_derivation_init(all[i], f.g);
    double highest[2] = {-INFINITY, -INFINITY};
    size_t swapped = 0;
    for (uint64_t i = 1; i < 2000; i++) {
        ck_ok(sg_derivation_copy(&x, sg_chain_derivation(f.c), &err));
        ck_ok(sg_derivation_copy(&y, sg_chain_derivation(b), &err));
        const double p = sg_chain_posterior(f.c)->score.log, q = sg_chain_posterior(b)->score.log;
        const double u = sg_random_uniform(rng);
        const bool want = u < exp(0.6 * (q - p));
        ck_assert(sg_chain_swap(f.c, b, u) == want);
        swapped += want;
        ck_assert(same(sg_chain_derivation(f.c), want ? &y : &x) && same(sg_chain_derivation(b), want ? &x : &y));
        ck_assert_double_eq(sg_chain_posterior(f.c)->score.log, want ? q : p);
        ck_assert(sg_chain_beta(f.c) == 1 && sg_chain_beta(b) == 0.4);
        for (int k = 0; k < 2; k++) {
            sg_chain *c = k == 0 ? f.c : b;
            for (int half = 0; half < 2; half++) { /* after the swap, and after a step */
                if (sg_posterior_log(sg_chain_posterior(c)) > highest[k] || i == 1) {
                    sg_posterior record;
                    sg_chain_best(c, &record);
                    if (i == 1 && half == 0 && sg_posterior_log(&record) > sg_posterior_log(sg_chain_posterior(c))) {
                        ck_ok(sg_derivation_copy(&best[k], k == 0 ? &x : &y, &err));
                        highest[k] = sg_posterior_log(&record);
                    } else if (sg_posterior_log(sg_chain_posterior(c)) > highest[k]) {
                        ck_ok(sg_derivation_copy(&best[k], sg_chain_derivation(c), &err));
                        highest[k] = sg_posterior_log(sg_chain_posterior(c));
                    }
                }
                ck_assert(same(sg_chain_best(c, NULL), &best[k]));
                if (half == 0)
                    ck_ok(sg_chain_step(c, i, NULL, &err));
            }
        }
    }
    ck_assert(swapped > 200 && swapped < 1900);
    check_carried(&f);
    for (int i = 0; i < 4; i++)
        sg_derivation_clear(all[i]);
    gsl_rng_free(rng);
    sg_chain_free(b);
    close_fixture(&f);
}
END_TEST

/* ---- annealing: the sharpened target by quadrature ---- */

static const char two_rules[] = "label t\nlabel w\nstart S\n"
                                "rule S -> 0.3 : split x { t | w } sizes mean (0.4, 0.6) sd (0.2, 0.2)\n"
                                "       -> 0.7 : split y { t | w } sizes mean (0.5, 0.5) sd (0.3, 0.1)\n";

static double prefers(const sg_derivation *d)
{
    const double s = d->values[d->nodes[0].values];
    return d->nodes[0].rule == 0 ? -3 * fabs(s - 0.7) : -2 * s;
}

typedef struct {
    int rule;
    double power, beta;
    int moment;
} sharpened;

static double sharp_density(double s, void *user)
{
    const sharpened *q = user;
    const double mean = q->rule == 0 ? 0.4 : 0.5, sd = q->rule == 0 ? 0.2 * M_SQRT1_2 : sqrt(0.09 - 0.09 * 0.09 / 0.1);
    const double mass = gsl_cdf_gaussian_P(1 - mean, sd) - gsl_cdf_gaussian_P(-mean, sd);
    const double log_score = q->rule == 0 ? -3 * fabs(s - 0.7) : -2 * s;
    const double log_p = log(q->rule == 0 ? 0.3 : 0.7) + log(gsl_ran_gaussian_pdf(s - mean, sd) / mass);
    return pow(s, q->moment) * exp(q->power * (q->beta * log_score + log_p));
}

static double integral(sharpened q)
{
    double result, error;
    gsl_integration_workspace *w = gsl_integration_workspace_alloc(200);
    gsl_function f = {sharp_density, &q};
    gsl_integration_qags(&f, 0, 1, 1e-12, 1e-9, 200, w, &result, &error);
    gsl_integration_workspace_free(w);
    return result;
}

START_TEST(annealing_sharpens_the_posterior_of_values)
{
    enum { N = 120000, BATCHES = 60 };
    sg_kernel_opts opts = all_moves;
    memset(opts.share, 0, sizeof opts.share);
    opts.share[_i % SG_MOVE_KINDS] = 1; /* each move by itself, with jumps for the rule */
    if (_i % SG_MOVE_KINDS > SG_MOVE_JUMP_COPY)
        opts.share[SG_MOVE_JUMP_FRESH] = 0.3;
    opts.delayed_rejection = _i >= SG_MOVE_KINDS;
    const double power = 3, beta = 0.8;
    fixture f = open_fixture(two_rules, prefers, &opts, (uint64_t)_i + 1, beta);
    sg_chain_set_sharpness(f.c, power);
    double sum[2][BATCHES] = {{0}};
    for (uint64_t i = 0; i < N; i++) {
        step_many(f.c, i + 1, 1);
        const sg_derivation *d = sg_chain_derivation(f.c);
        sum[0][i / (N / BATCHES)] += (double)BATCHES / N * (d->nodes[0].rule == 0);
        sum[1][i / (N / BATCHES)] += (double)BATCHES / N * d->values[0];
    }
    const double mass[2] = {integral((sharpened){0, power, beta, 0}), integral((sharpened){1, power, beta, 0})};
    const double first = integral((sharpened){0, power, beta, 1}) + integral((sharpened){1, power, beta, 1});
    const double want[2] = {mass[0] / (mass[0] + mass[1]), first / (mass[0] + mass[1])};
    for (int k = 0; k < 2 && _i != SG_MOVE_JUMP_COPY; k++) { /* copies alone never draw a value */
        double mean = 0, square = 0;
        for (int b = 0; b < BATCHES; b++) {
            mean += sum[k][b] / BATCHES;
            square += sum[k][b] * sum[k][b] / BATCHES;
        }
        const double z = (mean - want[k]) / sqrt((square - mean * mean) / (BATCHES - 1));
        ck_assert_msg(fabs(z) < 5, "moves %d, moment %d: %g for %g, z = %g", _i, k, mean, want[k], z);
    }
    close_fixture(&f);
}
END_TEST

START_TEST(annealing_keeps_what_is_carried)
{
    fixture f = open_fixture(_i == 0 ? sized : passing, wants, &all_moves, 4, 1);
    for (uint64_t i = 0; i < 20; i++) {
        sg_chain_set_sharpness(f.c, 1 + 0.2 * (double)i);
        sg_chain_set_beta(f.c, 1 + 0.01 * (double)i);
        step_many(f.c, 1 + 500 * i, 500);
        check_carried(&f);
    }
    close_fixture(&f);
}
END_TEST

/* ---- memory ---- */

START_TEST(warm_steps_allocate_nothing)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(passing, wants, &all_moves, 5, 1);
    step_many(f.c, 1, 20000);
    sg_derivation d;
    sg_derivation_init(&d, f.g);
    ck_ok(sg_derivation_copy(&d, sg_chain_derivation(f.c), &err));
    sg_status st = SG_OK;
    for (int pass = 0; pass < 2; pass++) {
        ck_ok(sg_chain_start(f.c, &d, 0, NULL, &err));
        test_allocations = 0;
        for (uint64_t i = 1; i < 3000; i++)
            st = st == SG_OK ? sg_chain_step(f.c, i, NULL, &err) : st;
        const size_t allocations = test_allocations;
        ck_ok(st);
        ck_assert_msg(pass == 0 || allocations == 0, "%zu allocations", allocations);
    }
    sg_derivation_clear(&d);
    close_fixture(&f);
}
END_TEST

/* Each allocation fails once: the step says so, and the chain stands where it stood, with all that it carries. */
START_TEST(failed_allocations_leave_the_chain_as_it_was)
{
    sg_error err = SG_ERROR_INIT;
    sg_grammar *g = test_grammar(_i == 0 ? passing : sized);
    function_score score = {{&function_ops}, wants, false};
    fixture f = {.g = g, .score = &score};
    size_t failures[3] = {0}, first = 0; /* that creating gets by without */
    sg_derivation before;
    sg_derivation_init(&before, g);
    for (size_t at = 0; at < 200; at++) {
        sg_chain *c = NULL;
        test_fail_allocation(at);
        sg_status st = sg_chain_create(g, &f.score->base, &all_moves, 7, 0, 1, &c, &err);
        int failed = test_allocation_failed();
        ck_assert(st == (failed ? SG_ENOMEM : SG_OK) && (c == NULL) == (failed != 0));
        failures[0] += failed != 0;
        first += failed != 0;
        if (failed)
            continue;
        const size_t k = at - first;
        test_fail_allocation(k);
        st = sg_chain_start(c, NULL, 3, NULL, &err);
        failed = test_allocation_failed();
        ck_assert(st == (failed ? SG_ENOMEM : SG_OK));
        failures[1] += failed != 0;
        if (failed)
            ck_ok(sg_chain_start(c, NULL, 3, NULL, &err));
        f.c = c;
        test_fail_allocation(k);
        int any = 0;
        for (uint64_t i = 1; i < 300; i++) {
            const size_t so_far = test_allocations, fail_at = test_fail_at;
            test_fail_at = (size_t)-1;
            ck_ok(sg_derivation_copy(&before, sg_chain_derivation(c), &err));
            test_allocations = so_far;
            test_fail_at = fail_at;
            st = sg_chain_step(c, i, NULL, &err);
            if (st == SG_OK)
                continue;
            any++;
            test_allocation_failed();
            ck_assert_int_eq(st, SG_ENOMEM);
            ck_assert(same(&before, sg_chain_derivation(c)));
            check_carried(&f);
        }
        const int left = test_allocation_failed();
        ck_assert(any <= 1 && !left);
        failures[2] += any != 0;
        check_carried(&f);
        sg_chain_free(c);
    }
    for (int i = 0; i < 3; i++)
        ck_assert_msg(failures[i] > 3, "call %d: %zu failures", i, failures[i]);
    sg_derivation_clear(&before);
    sg_grammar_free(g);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("chain");
    TCase *tc = tcase_create("chain");
    tcase_set_timeout(tc, 120);
    tcase_add_loop_test(tc, what_is_carried_is_what_is_computed_anew, 0, 6);
    tcase_add_loop_test(tc, the_best_is_the_best_of_all_that_was_visited, 0, 4);
    tcase_add_loop_test(tc, a_step_is_what_its_terms_say, 0, 2);
    tcase_add_test(tc, early_ends_of_scores_change_nothing);
    tcase_add_test(tc, a_chain_is_a_function_of_seed_and_number);
    tcase_add_test(tc, a_chain_begins_at_the_best_sample_or_at_what_is_given);
    tcase_add_test(tc, bad_options_and_hopeless_scores_are_refused);
    tcase_add_test(tc, moves_without_use_take_no_share);
    tcase_add_test(tc, trees_stay_below_the_limit);
    tcase_add_loop_test(tc, a_swap_exchanges_where_chains_stand, 0, 2);
    tcase_add_loop_test(tc, annealing_sharpens_the_posterior_of_values, 0, 2 * SG_MOVE_KINDS);
    tcase_add_loop_test(tc, annealing_keeps_what_is_carried, 0, 2);
    tcase_add_test(tc, warm_steps_allocate_nothing);
    tcase_add_loop_test(tc, failed_allocations_leave_the_chain_as_it_was, 0, 2);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
