/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_merge.c - energies, changes of energy, and candidate lists of model merging, against definitions and brute
 * force. */
#include "learn/candidates.h"
#include "learn/energy.h"
#include "learn/merge.h"
#include "tests/learn_support.h"
#include "tests/support.h"

#include <math.h>
#include <string.h>

static sg_energy_opts random_opts(gsl_rng *rng)
{
    const double alphas[] = {1, 0.3, 2.5, 1}, weights[] = {0.3, 1, 0.05, 2};
    sg_energy_opts o = SG_ENERGY_OPTS_INIT;
    o.weight = weights[gsl_rng_uniform_int(rng, 4)];
    o.alpha = alphas[gsl_rng_uniform_int(rng, 4)];
    o.data_term = gsl_rng_uniform_int(rng, 2) == 0 ? SG_DATA_MARGINAL : SG_DATA_VITERBI;
    if (o.data_term == SG_DATA_VITERBI && o.alpha < 1)
        o.alpha = 1.7; /* counts of 0 stand in these grammars */
    o.poisson = gsl_rng_uniform_int(rng, 2) == 0;
    return o;
}

static double energy_from_scratch(const sg_rules *r)
{
    sg_error err = SG_ERROR_INIT;
    sg_energy_parts parts;
    ck_ok(sg_rules_energy_parts(r, &parts, &err));
    return parts.energy;
}

#define ck_close(got, want, scale)                                                                                     \
    ck_assert_msg(fabs((got) - (want)) <= 1e-9 * (fabs(scale) + 1), "%.17g is not %.17g", (double)(got), (double)(want))

START_TEST(each_change_is_the_difference_of_energies)
{
    sg_error err = SG_ERROR_INIT;
    sg_arena *a = sg_arena_create();
    gsl_rng *rng = sg_random_create((uint64_t)_i + 1);
    size_t pairs = 0;
    for (int round = 0; round < 60; round++) {
        sg_arena_reset(a);
        test_grammar g = test_random_grammar(rng, a, 3 + (uint32_t)gsl_rng_uniform_int(rng, 5), 2, 4, 3);
        const sg_energy_opts o = random_opts(rng);
        sg_rules r = {0}, merged = {0};
        ck_ok(sg_rules_create(&r, &g.form, g.counts, &o, a, &err));
        const double before = energy_from_scratch(&r);
        ck_close(sg_rules_energy(&r), before, before);
        for (uint32_t x = 0; x < r.nsymbols; x++)
            for (uint32_t y = 0; y < r.nsymbols; y++) {
                double delta;
                if (!sg_rules_compatible(&r, x, y)) {
                    ck_assert_int_eq(sg_merge_delta(&r, x, y, &delta, NULL), SG_EINVAL);
                    continue;
                }
                ck_ok(sg_merge_delta(&r, x, y, &delta, &err));
                ck_ok(sg_rules_copy(&merged, &r, &err));
                ck_ok(sg_merge_apply(&merged, x, y, &err));
                const double after = energy_from_scratch(&merged);
                ck_close(sg_rules_energy(&merged), after, after);
                ck_close(before + delta, after, after);
                pairs++;
            }
        sg_rules_clear(&merged);
        sg_rules_clear(&r);
    }
    ck_assert_uint_gt(pairs, 100);
    gsl_rng_free(rng);
    sg_arena_free(a);
}
END_TEST

/* A hundred symbols merged until no pair is left: carried sums must not drift. */
START_TEST(carried_energy_stays_exact_over_long_runs)
{
    sg_error err = SG_ERROR_INIT;
    sg_arena *a = sg_arena_create();
    gsl_rng *rng = sg_random_create(77 + (uint64_t)_i);
    test_grammar g = test_random_grammar(rng, a, 400, 4, 6, 5);
    const sg_energy_opts o = random_opts(rng);
    sg_rules r = {0};
    ck_ok(sg_rules_create(&r, &g.form, g.counts, &o, a, &err));
    size_t merges = 0;
    for (int miss = 0; miss < 2000; miss++) {
        const uint32_t x = (uint32_t)gsl_rng_uniform_int(rng, r.nsymbols),
                       y = (uint32_t)gsl_rng_uniform_int(rng, r.nsymbols);
        if (!sg_rules_compatible(&r, x, y))
            continue;
        double delta;
        const double before = sg_rules_energy(&r);
        ck_ok(sg_merge_delta(&r, x, y, &delta, &err));
        ck_ok(sg_merge_apply(&r, x, y, &err));
        ck_close(sg_rules_energy(&r), before + delta, before);
        merges++;
        miss = 0;
    }
    ck_assert_uint_gt(merges, 300);
    const double scratch = energy_from_scratch(&r);
    ck_close(sg_rules_energy(&r), scratch, scratch);
    sg_rules_clear(&r);
    gsl_rng_free(rng);
    sg_arena_free(a);
}
END_TEST

/* The plain way: every pair scored anew at every step. Ties go to the lower indices, as in the candidate list. */
static bool exhaustive_best(sg_rules *r, uint32_t *a, uint32_t *b, double *best)
{
    bool found = false;
    for (uint32_t x = 0; x < r->nsymbols; x++)
        for (uint32_t y = x + 1; y < r->nsymbols; y++) {
            double delta;
            if (!sg_rules_compatible(r, x, y))
                continue;
            ck_assert_int_eq(sg_merge_delta(r, x, y, &delta, NULL), SG_OK);
            if (found && delta >= *best)
                continue;
            found = true;
            *best = delta;
            *a = x;
            *b = y;
        }
    return found;
}

START_TEST(candidate_list_gives_what_scoring_all_pairs_gives)
{
    sg_error err = SG_ERROR_INIT;
    sg_arena *a = sg_arena_create();
    gsl_rng *rng = sg_random_create(1000 + (uint64_t)_i);
    for (int round = 0; round < 4; round++) {
        sg_arena_reset(a);
        const uint32_t sizes[] = {8, 20, 45, 45}, lengths[] = {2, 3, 2, 7};
        test_grammar g =
            test_random_grammar(rng, a, sizes[round], 2 + (uint32_t)gsl_rng_uniform_int(rng, 2), 3, lengths[round]);
        const sg_energy_opts o = random_opts(rng);
        sg_rules r = {0};
        sg_candidates c = {0}, copy = {0};
        ck_ok(sg_rules_create(&r, &g.form, g.counts, &o, a, &err));
        ck_ok(sg_candidates_fill(&c, &r, &err));
        for (;;) {
            uint32_t x = 0, y = 0;
            double delta = 0;
            sg_candidate best, top[3];
            size_t ntop;
            const bool found = exhaustive_best(&r, &x, &y, &delta);
            ck_assert_int_eq(sg_candidates_best(&c, &r, &best), found);
            ck_ok(sg_candidates_copy(&copy, &c, &err));
            ck_ok(sg_candidates_top(&copy, &r, 3, top, &ntop, &err));
            if (!found)
                break;
            ck_close(best.key + sg_merge_common(&r), delta, sg_rules_energy(&r));
            ck_assert_double_eq(top[0].key, best.key);
            ck_assert(top[0].a == best.a && top[0].b == best.b);
            for (size_t i = 1; i < ntop; i++) {
                ck_assert(top[i].key >= top[i - 1].key);
                ck_assert(top[i].a != top[i - 1].a || top[i].b != top[i - 1].b);
                double other;
                ck_ok(sg_merge_delta(&r, top[i].a, top[i].b, &other, &err));
                ck_close(top[i].key + sg_merge_common(&r), other, sg_rules_energy(&r));
            }
            /* now and then a merge that is not the best, so that unusual states come up too */
            const bool stray = gsl_rng_uniform_int(rng, 3) == 0 && ntop > 1;
            ck_ok(sg_merge_apply(&r, stray ? top[ntop - 1].a : best.a, stray ? top[ntop - 1].b : best.b, &err));
            ck_ok(sg_candidates_update(&c, &r, &err));
        }
        sg_candidates_clear(&copy);
        sg_candidates_clear(&c);
        sg_rules_clear(&r);
    }
    gsl_rng_free(rng);
    sg_arena_free(a);
}
END_TEST

/* S -> A B | A A, A -> t, B -> t: merging A and B leaves S -> A A and A -> t. By hand, w = 1, marginal, alpha = 1:
 * DL before: 2 (2 log 3 - log Pois(1;2)) + 2 log 1, after: 2 log 2 - log Pois(1;2) + log 1; data before:
 * S (2,1): log[1! 2!1!/4!] = log(1/12), A (5) and B (2) one rule each: 0; after: 0. */
START_TEST(a_merge_by_hand)
{
    sg_error err = SG_ERROR_INIT;
    sg_arena *arena = sg_arena_create();
    const uint32_t ab[] = {1, 2}, aa[] = {1, 1}, t[] = {0};
    const double two[] = {0.25, 0.75, 0.5, 0.5}, one[] = {0.1, 0.9};
    const sg_split_rule rules[] = {{.lhs = 0, .op = SG_SPLIT_X, .n = 2, .rhs = ab, .nattributes = 2, .attributes = two},
                                   {.lhs = 0, .op = SG_SPLIT_X, .n = 2, .rhs = aa, .nattributes = 1, .attributes = one},
                                   {.lhs = 1, .op = SG_SPLIT_LEXICAL, .n = 1, .rhs = t},
                                   {.lhs = 2, .op = SG_SPLIT_LEXICAL, .n = 1, .rhs = t}};
    const double counts[] = {2, 1, 4, 2};
    const char *names[] = {"S", "A", "B"}, *terminals[] = {"t"};
    const uint32_t colors[] = {0};
    const sg_split_form form = {.name = "hand",
                                .nsymbols = 3,
                                .symbol_names = names,
                                .nterminals = 1,
                                .terminal_names = terminals,
                                .terminal_colors = colors,
                                .nrules = 4,
                                .rules = rules};
    sg_energy_opts o = SG_ENERGY_OPTS_INIT;
    o.weight = 1;
    sg_rules r = {0};
    ck_ok(sg_rules_create(&r, &form, counts, &o, arena, &err));
    const double pois = log(2) - 2;
    const double before = 2 * (2 * log(3) - pois) + log(12), after = 2 * log(2) - pois;
    ck_assert_double_eq_tol(sg_rules_energy(&r), before, 1e-12);
    double delta;
    ck_ok(sg_merge_delta(&r, 2, 1, &delta, &err));
    ck_assert_double_eq_tol(delta, after - before, 1e-12);
    ck_ok(sg_merge_apply(&r, 1, 2, &err));
    ck_assert_double_eq_tol(sg_rules_energy(&r), after, 1e-12);
    ck_assert_uint_eq(r.live_symbols, 2);
    sg_split_form out;
    double *c;
    ck_ok(sg_rules_form(&r, true, arena, &out, NULL, &c, &err));
    ck_assert_uint_eq(out.nrules, 2);
    ck_assert_double_eq(c[0], 3);
    ck_assert_double_eq(c[1], 6);
    ck_assert_uint_eq(out.rules[0].nattributes, 3);
    const double want[] = {0.25, 0.75, 0.5, 0.5, 0.1, 0.9};
    ck_assert_mem_eq(out.rules[0].attributes, want, sizeof want);
    ck_assert_double_eq(out.rules[0].probability, 1);
    ck_assert_int_eq(sg_merge_delta(&r, 0, 1, &delta, &err), SG_EINVAL); /* the axiom stays */
    sg_rules_clear(&r);
    sg_arena_free(arena);
}
END_TEST

START_TEST(the_viterbi_parameters_maximise_what_they_should)
{
    /* numerically: for a = alpha - 1 the M-step theta ~ c + a maximises sum (c + a) log theta */
    sg_energy_opts o = SG_ENERGY_OPTS_INIT;
    o.data_term = SG_DATA_VITERBI;
    o.alpha = 1.5;
    const double c[] = {3, 1, 6};
    double best = 0;
    for (int i = 0; i < 3; i++)
        best += (c[i] + 0.5) * log(sg_energy_probability(&o, c[i], 3, 10));
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            double moved = 0;
            for (int k = 0; k < 3; k++)
                moved += (c[k] + 0.5) * log(sg_energy_probability(&o, c[k], 3, 10) + (k == i) * 1e-3 - (k == j) * 1e-3);
            ck_assert(moved <= best + 1e-12);
        }
    o.data_term = SG_DATA_MARGINAL;
    ck_assert_double_eq_tol(sg_energy_probability(&o, 3, 3, 10), 4.5 / 14.5, 1e-15);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("merge");
    TCase *tc = tcase_create("merge");
    tcase_set_timeout(tc, 120);
    tcase_add_loop_test(tc, each_change_is_the_difference_of_energies, 0, 10);
    tcase_add_loop_test(tc, carried_energy_stays_exact_over_long_runs, 0, 8);
    tcase_add_loop_test(tc, candidate_list_gives_what_scoring_all_pairs_gives, 0, 10);
    tcase_add_test(tc, a_merge_by_hand);
    tcase_add_test(tc, the_viterbi_parameters_maximise_what_they_should);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
