/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_move.c - proposals, against derivations that are changed by hand and made anew from scratch. */
#include "core/random.h"
#include "derivation/change.h"
#include "derivation/derivation_switch.h"
#include "tests/failing_malloc.h"
#include "tests/grammar_support.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <string.h>

/* Draws that are passed on to weights, guards, repeat counts and other draws, and draws that are geometry. */
static const char passing[] = "grammar passing\n"
                              "weights\n"
                              "limit depth 6\n"
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
                            "rule S -> 0.2 : split x { S | t | S } sizes mean (0.4, 0.2, 0.4) sd (0.1, 0.1, 0.1)\n"
                            "       -> 0.19 : split y { S | R } sizes mean (0.5, 0.5) sd (0.1, 0.1)\n"
                            "       -> 0.61 : t\n"
                            "rule R -> split x { t | w | t | w } sizes mean (0.3, 0.2, 0.3, 0.2)\n"
                            "   covariance ((0.01, -0.004, 0), (-0.004, 0.01, 0), (0, 0, 0.02))\n";

enum { MOST = 100000 };

typedef struct {
    sg_grammar *g;
    sg_derivation d, slice, other;
    gsl_rng *rng;
    double *uniforms;
    sg_node_draws draws;
} fixture;

static fixture open_fixture(const char *text, uint64_t seed, size_t least)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = {.g = test_grammar(text), .rng = sg_random_create(seed)};
    ck_assert_ptr_nonnull(f.rng);
    sg_derivation_init(&f.d, f.g);
    sg_derivation_init(&f.slice, f.g);
    sg_derivation_init(&f.other, f.g);
    f.draws.uniforms = malloc(64 * sizeof(double));
    f.draws.frame = malloc(sg_grammar_frame_size(f.g) * sizeof(double));
    ck_assert(f.draws.uniforms != NULL && f.draws.frame != NULL);
    do
        ck_ok(sg_derivation_sample(&f.d, f.rng, MOST, &err));
    while (f.d.nnodes < least || f.d.nuniforms < 2);
    return f;
}

static void close_fixture(fixture *f)
{
    sg_derivation_clear(&f->d);
    sg_derivation_clear(&f->slice);
    sg_derivation_clear(&f->other);
    free(f->draws.uniforms);
    free(f->draws.frame);
    gsl_rng_free(f->rng);
    sg_grammar_free(f->g);
}

static bool same(const sg_derivation *a, const sg_derivation *b)
{
    return a->nnodes == b->nnodes && a->nvalues == b->nvalues && a->nuniforms == b->nuniforms &&
           (a->nnodes == 0 || memcmp(a->nodes, b->nodes, a->nnodes * sizeof *a->nodes) == 0) &&
           (a->nvalues == 0 || memcmp(a->values, b->values, a->nvalues * sizeof *a->values) == 0) &&
           (a->nuniforms == 0 || memcmp(a->uniforms, b->uniforms, a->nuniforms * sizeof *a->uniforms) == 0);
}

static bool same_rules(const sg_derivation *a, const sg_derivation *b)
{
    bool same = a->nnodes == b->nnodes;
    for (size_t i = 0; same && i < a->nnodes; i++)
        same = a->nodes[i].rule == b->nodes[i].rule;
    return same;
}

static size_t any_node(const fixture *f)
{
    return gsl_rng_uniform_int(f->rng, f->d.nnodes);
}

/* Any node whose rule has draws (sizes, when asked for). */
static size_t node_with_draws(const fixture *f, bool sizes)
{
    for (size_t tries = 0; tries < 10000; tries++) {
        const size_t i = any_node(f);
        if (f->d.nodes[i].rule == SG_RULE_EMPTY)
            continue;
        const sg_rule *r = sg_grammar_rule(f->g, f->d.nodes[i].rule);
        if (sizes ? sg_rule_has_sizes(r) : r->ndraws > 0)
            return i;
    }
    return SIZE_MAX;
}

static double log_prior(const sg_derivation *d)
{
    sg_error err = SG_ERROR_INIT;
    double log_p = NAN;
    ck_ok(sg_derivation_log_prior(d, &log_p, &err));
    return log_p;
}

static void resample(fixture *f)
{
    sg_error err = SG_ERROR_INIT;
    do
        ck_ok(sg_derivation_sample(&f->d, f->rng, MOST, &err));
    while (f->d.nnodes < 3);
}

START_TEST(rules_know_whether_their_draws_are_passed_on)
{
    const struct {
        const char *body;
        bool passed;
    } cases[] = {
        {"t", false},
        {"u ~ uniform(0, 1) split x { 'u : t | ~1 : A(0) }", false},
        {"u ~ uniform(0, 1) split x { A(u) | t }", true},
        {"u ~ uniform(0, 1) split x { A(1 + f(2, u)) | t }", true},
        {"u ~ uniform(0, 1) v ~ uniform(u, 2) split x { 'v : t | ~1 : A(p) }", false},
        {"split x { A(uniform(0, 1)) | t }", true},
        {"split x { t | t } sizes mean (0.5, 0.5) sd (0.1, 0.1)", false},
        {"u ~ uniform(1, 3) repeat x u { t }", true},
        {"u ~ uniform(1, 3) repeat x p { split y { 'u / 4 : t | ~1 : t } }", false},
        {"u ~ uniform(0, 1) split x { maybe(u) t | t }", true},
        {"u ~ uniform(0, 1) split x { maybe(0.5) A(p) | 'u : t }", false},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[512];
        snprintf(text, sizeof text, "label t\nfunction f(x, y) = x * y\nstart S(2)\nrule S(p) -> 0.5 : %s -> 0.5 : A(p)\nrule A(q) -> t\n",
                 cases[i].body);
        sg_grammar *g = test_grammar(text);
        const sg_rule *r = sg_grammar_rule(g, sg_grammar_symbol(g, sg_grammar_start(g))->first_rule);
        ck_assert_msg(r->draws_passed == cases[i].passed, "%s", cases[i].body);
        sg_grammar_free(g);
    }
}
END_TEST

/* child_ops is what sg_derivation_list_children() lists. */
START_TEST(rules_list_their_children)
{
    sg_error err = SG_ERROR_INIT;
    char text[sizeof passing + 8];
    snprintf(text, sizeof text, "%s%s", _i == 0 ? "" : "tied\n", passing);
    sg_grammar *g = test_grammar(text);
    sg_child_list list = {0};
    for (size_t i = 0; i < sg_grammar_rule_count(g); i++) {
        const sg_rule *r = sg_grammar_rule(g, (sg_rule_id)i);
        ck_assert((r->child_ops == NULL) == r->has_repeat);
        if (r->has_repeat)
            continue;
        list.n = 0;
        ck_ok(sg_derivation_list_children(g, r, NULL, 0, 0, 100, &list, &err));
        ck_assert_uint_eq(list.n, r->nchildren);
        for (size_t k = 0; k < list.n; k++)
            ck_assert_uint_eq(list.items[k].op, r->child_ops[k]);
    }
    free(list.items);
    sg_grammar_free(g);
}
END_TEST

START_TEST(a_change_is_made_in_either_form)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(sized, (uint64_t)_i + 1, 10);
    for (int round = 0; round < 100; round++) {
        size_t node = node_with_draws(&f, false);
        ck_ok(sg_derivation_copy(&f.other, &f.d, &err));
        if (node != SIZE_MAX) {
            ck_ok(sg_node_resample(&f.d, node, f.rng, &f.draws, &err));
            const sg_change draws = {&f.d, node, NULL, f.draws.uniforms, f.draws.values};
            ck_ok(sg_derivation_make_room(&f.d, &draws, &err));
            ck_ok(sg_derivation_apply(&f.d, &draws, &err));
            ck_ok(sg_derivation_check(&f.d, &err));
            ck_assert(same_rules(&f.d, &f.other) && !same(&f.d, &f.other));
        }
        node = any_node(&f);
        bool inside;
        ck_ok(sg_derivation_regenerate(&f.d, node, &(sg_uniforms){.rng = f.rng}, MOST, &f.slice, &inside, &err));
        ck_assert(inside);
        const sg_change slice = {&f.d, node, &f.slice, NULL, NULL};
        ck_ok(sg_derivation_copy(&f.other, &f.d, &err));
        ck_ok(sg_derivation_splice(&f.other, node, &f.slice, &err));
        ck_ok(sg_derivation_make_room(&f.d, &slice, &err));
        ck_ok(sg_derivation_apply(&f.d, &slice, &err));
        ck_assert(same(&f.d, &f.other));
        if (f.d.nnodes > 3000 || f.d.nnodes < 2)
            resample(&f);
    }
    close_fixture(&f);
}
END_TEST

/* The first uniforms of the new subtree are those of the old one, in pre-order, and what is lacking is fresh. */
START_TEST(a_copy_keeps_uniforms_in_pre_order)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(_i % 2 == 0 ? sized : passing, (uint64_t)_i + 1, 10);
    int longer = 0, shorter = 0;
    for (int round = 0; round < 300; round++) {
        const size_t node = any_node(&f);
        size_t nold = 0;
        const double *old = sg_derivation_uniforms(&f.d, node, &nold);
        sg_uniforms from = {old, nold, 0, f.rng};
        bool inside;
        ck_ok(sg_derivation_regenerate(&f.d, node, &from, MOST, &f.slice, &inside, &err));
        ck_assert(inside);
        ck_ok(sg_derivation_check(&f.slice, &err));
        ck_assert_uint_eq(f.slice.nodes[0].depth, f.d.nodes[node].depth);
        for (size_t i = 0; i < f.slice.nuniforms && i < nold; i++)
            ck_assert_double_eq(f.slice.uniforms[i], old[i]);
        longer += f.slice.nuniforms > nold;
        shorter += f.slice.nuniforms < nold;
        ck_ok(sg_derivation_extract(&f.d, node, &f.other, &err));
        if (same_rules(&f.slice, &f.other))
            ck_assert(same(&f.slice, &f.other));
        ck_ok(sg_derivation_splice(&f.d, node, &f.slice, &err));
        if (f.d.nnodes > 1000 || f.d.nnodes < 3)
            resample(&f);
    }
    ck_assert(longer > 3 && shorter > 3);
    close_fixture(&f);
}
END_TEST

START_TEST(fresh_regeneration_samples_the_subtree)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(passing, (uint64_t)_i + 1, 10);
    for (int round = 0; round < 50; round++) {
        const size_t node = any_node(&f);
        const sg_node n = f.d.nodes[node];
        bool inside;
        sg_random_stream(f.rng, 5, 0, (uint64_t)round);
        ck_ok(sg_derivation_regenerate(&f.d, node, &(sg_uniforms){.rng = f.rng}, MOST, &f.slice, &inside, &err));
        sg_random_stream(f.rng, 5, 0, (uint64_t)round);
        ck_ok(sg_derivation_sample_subtree(&f.other, n.symbol, f.d.values + n.values, n.depth, f.rng, MOST, &err));
        ck_assert(inside && same(&f.slice, &f.other));
    }
    close_fixture(&f);
}
END_TEST

/* Too many nodes are told from a grammar that fails, and counted with the rest of the tree. */
START_TEST(too_many_nodes_are_outside)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(sized, 3, 20);
    size_t out = 0, in = 0;
    for (int round = 0; round < 400; round++) {
        const size_t node = any_node(&f), most = f.d.nnodes + 2;
        bool inside;
        sg_random_stream(f.rng, 6, 0, (uint64_t)round);
        ck_ok(sg_derivation_regenerate(&f.d, node, &(sg_uniforms){.rng = f.rng}, most, &f.slice, &inside, &err));
        sg_random_stream(f.rng, 6, 0, (uint64_t)round);
        bool fits;
        ck_ok(sg_derivation_regenerate(&f.d, node, &(sg_uniforms){.rng = f.rng}, MOST, &f.other, &fits, &err));
        ck_assert(fits);
        const bool want = f.d.nnodes - f.d.nodes[node].length + f.other.nnodes <= most;
        ck_assert(inside == want);
        ck_assert(!inside || same(&f.slice, &f.other));
        in += inside;
        out += !inside;
    }
    ck_assert(in > 10 && out > 10);
    close_fixture(&f);
}
END_TEST

START_TEST(a_grammar_that_fails_is_an_error)
{
    sg_error err = SG_ERROR_INIT;
    sg_grammar *g = test_grammar("label t\nstart S\nrule S -> u ~ uniform(0, 1) split x { A(u) | t }\nrule A(u) if u < 0.5 -> t\n");
    gsl_rng *rng = sg_random_create(1);
    sg_derivation d, slice;
    sg_derivation_init(&d, g);
    sg_derivation_init(&slice, g);
    while (sg_derivation_sample(&d, rng, MOST, &err) != SG_OK)
        ;
    size_t failed = 0, revalued = 0;
    bool inside;
    double d_log_rules;
    for (int i = 0; i < 100; i++) {
        const sg_status st =
            sg_derivation_regenerate(&d, 0, &(sg_uniforms){.rng = rng}, MOST, &slice, &inside, &err);
        ck_assert(st == SG_OK || st == SG_ENUMERIC);
        ck_assert(inside);
        failed += st != SG_OK;
        /* the guard of A fails, and nothing else holds: the prior would fail there too */
        revalued += sg_derivation_revalue(&d, &(sg_uniforms){.rng = rng}, &slice, &d_log_rules, &inside, &err) != SG_OK;
    }
    ck_assert(failed > 20 && revalued > 20);
    ck_assert_ptr_nonnull(strstr(err.msg, "S > A"));
    sg_derivation_clear(&d);
    sg_derivation_clear(&slice);
    gsl_rng_free(rng);
    sg_grammar_free(g);
}
END_TEST

/* New values by the obvious way: uniforms set in a copy, all of it refreshed. false: the tree cannot be. */
static bool obvious_values(const sg_derivation *like, const double *uniforms, sg_derivation *out)
{
    sg_error err = SG_ERROR_INIT;
    ck_ok(sg_derivation_copy(out, like, &err));
    if (like->nuniforms > 0)
        memcpy(out->uniforms, uniforms, like->nuniforms * sizeof *uniforms);
    if (sg_derivation_refresh(out, 0, &err) != SG_OK)
        return false;
    double log_p;
    return sg_derivation_log_prior(out, &log_p, &err) == SG_OK && isfinite(log_p);
}

START_TEST(other_values_for_the_same_rules)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(_i % 2 == 0 ? passing : sized, (uint64_t)_i + 1, 5);
    int inside_count = 0, outside_count = 0, moved = 0;
    for (int round = 0; round < 600; round++) {
        resample(&f);
        const size_t node = round % 4 == 0 ? any_node(&f) : 0;
        ck_ok(sg_derivation_extract(&f.d, node, &f.other, &err));
        sg_derivation want;
        sg_derivation_init(&want, f.g);
        double *u = malloc((f.other.nuniforms + 1) * sizeof *u), d_log_rules = NAN;
        ck_assert_ptr_nonnull(u);
        const size_t nkept = round % 3 == 0 ? 0 : f.other.nuniforms / 2;
        for (size_t i = 0; i < f.other.nuniforms; i++)
            u[i] = i < nkept ? f.other.uniforms[i] : sg_random_uniform(f.rng);
        bool inside;
        sg_uniforms from = {u, f.other.nuniforms, 0, f.rng};
        const sg_status st = sg_derivation_revalue(&f.other, &from, &f.slice, &d_log_rules, &inside, &err);
        const bool possible = obvious_values(&f.other, u, &want);
        ck_assert_msg(st == SG_OK, "%s", err.msg);
        ck_assert(inside == possible);
        if (inside) {
            ck_assert(same(&f.slice, &want));
            ck_assert_double_eq_tol(d_log_rules, log_prior(&want) - log_prior(&f.other), 1e-9);
            moved += fabs(d_log_rules) > 1e-6;
        }
        inside_count += inside;
        outside_count += !inside;
        sg_derivation_clear(&want);
        free(u);
    }
    ck_assert_int_gt(inside_count, 100);
    ck_assert(_i % 2 == 1 || (outside_count > 30 && moved > 10));
    ck_assert(_i % 2 == 0 || (outside_count == 0 && moved == 0));
    close_fixture(&f);
}
END_TEST

/* The draws of one node, and what depends on them, are what changes: against all of it made anew. */
START_TEST(other_draws_at_the_root_are_carried_down)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(passing, (uint64_t)_i + 1, 5);
    int inside_count = 0, outside_count = 0;
    for (int round = 0; round < 600; round++) {
        resample(&f);
        const size_t node = node_with_draws(&f, false);
        if (node == SIZE_MAX)
            continue;
        ck_ok(sg_derivation_extract(&f.d, node, &f.other, &err));
        ck_ok(sg_node_reflect(&f.d, node, 0.2, f.rng, &f.draws, &err));
        const size_t n = sg_grammar_rule(f.g, f.other.nodes[0].rule)->nuniforms;
        double *u = malloc((f.other.nuniforms + 1) * sizeof *u), d_log_rules = NAN, want_log = NAN;
        ck_assert_ptr_nonnull(u);
        memcpy(u, f.other.uniforms, f.other.nuniforms * sizeof *u);
        memcpy(u, f.draws.uniforms, n * sizeof *u);
        sg_derivation want;
        sg_derivation_init(&want, f.g);
        bool inside, want_inside;
        sg_uniforms from = {u, f.other.nuniforms, 0, f.rng};
        ck_ok(sg_derivation_revalue(&f.other, &from, &want, &want_log, &want_inside, &err));
        ck_ok(sg_derivation_revalue_root(&f.other, f.draws.uniforms, &f.slice, &d_log_rules, &inside, &err));
        ck_assert(inside == want_inside);
        ck_assert(!inside || (same(&f.slice, &want) && d_log_rules == want_log));
        inside_count += inside;
        outside_count += !inside;
        free(u);
        sg_derivation_clear(&want);
    }
    ck_assert(inside_count > 100 && outside_count > 20);
    close_fixture(&f);
}
END_TEST

/* Two repeats whose counts change places ask for as many children as before, but for others. */
START_TEST(repeats_that_trade_children_are_noticed)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture("label t\nstart S\nrule S -> n ~ uniform(0.5, 4.5) split y { repeat x n { A } | repeat x 5 - n { B } }\n"
                             "rule A -> t\nrule B -> v ~ uniform(0, 1) t\n",
                             1, 2);
    const double now = f.d.values[0], other = round(now) <= 2 ? 0.9 : 0.1;
    double u[8] = {other}, d_log_rules;
    bool inside;
    ck_assert_uint_eq(f.d.nnodes, 6);
    ck_ok(sg_derivation_revalue_root(&f.d, u, &f.slice, &d_log_rules, &inside, &err));
    ck_assert(!inside);
    u[0] = f.d.uniforms[0] + (now - round(now) > 0 ? -0.001 : 0.001); /* the same counts */
    ck_ok(sg_derivation_revalue_root(&f.d, u, &f.slice, &d_log_rules, &inside, &err));
    ck_assert(inside);
    f.d.uniforms[0] = other;
    ck_assert_int_eq(sg_derivation_refresh(&f.d, 0, &err), SG_ENUMERIC);
    close_fixture(&f);
}
END_TEST

START_TEST(a_reflected_step_moves_one_uniform_and_keeps_them_uniform)
{
    sg_error err = SG_ERROR_INIT;
    enum { N = 20000, BINS = 10 };
    fixture f = open_fixture("label t\nstart S\nrule S -> split x { t | t | t } sizes mean (0.3, 0.3, 0.4) sd (0.2, 0.2, 0.2)\n",
                             (uint64_t)_i + 1, 1);
    size_t count[BINS] = {0}, flow[BINS][BINS] = {{0}};
    for (int i = 0; i < N; i++) {
        ck_ok(sg_derivation_sample(&f.d, f.rng, MOST, &err));
        ck_ok(sg_node_reflect(&f.d, 0, 0.3, f.rng, &f.draws, &err));
        const size_t moved = f.draws.uniforms[0] != f.d.uniforms[0] ? 0 : 1;
        ck_assert_double_eq(f.draws.uniforms[1 - moved], f.d.uniforms[1 - moved]);
        const size_t from = (size_t)(f.d.uniforms[moved] * BINS), to = (size_t)(f.draws.uniforms[moved] * BINS);
        ck_assert(f.draws.uniforms[moved] > 0 && f.draws.uniforms[moved] < 1);
        count[to]++;
        flow[from][to]++;
        ck_ok(sg_derivation_apply(&f.d, &(sg_change){&f.d, 0, NULL, f.draws.uniforms, f.draws.values}, &err));
        ck_ok(sg_derivation_check(&f.d, &err));
    }
    double chisq = 0, asymmetry = 0;
    for (int b = 0; b < BINS; b++) {
        chisq += pow((double)count[b] - (double)N / BINS, 2) / ((double)N / BINS);
        for (int c = 0; c < b; c++)
            if (flow[b][c] + flow[c][b] > 0)
                asymmetry += pow((double)flow[b][c] - (double)flow[c][b], 2) / (double)(flow[b][c] + flow[c][b]);
    }
    ck_assert_msg(gsl_cdf_chisq_Q(chisq, BINS - 1) > 1e-6, "seed %d: chi-square %g", _i + 1, chisq);
    ck_assert_msg(gsl_cdf_chisq_Q(asymmetry, BINS * (BINS - 1) / 2) > 1e-6, "seed %d: asymmetry %g", _i + 1, asymmetry);
    close_fixture(&f);
}
END_TEST

static double log_density(const sg_derivation *d)
{
    sg_error err = SG_ERROR_INIT;
    double log_phi = NAN;
    ck_ok(sg_derivation_log_density(d, &log_phi, &err));
    return log_phi;
}

START_TEST(a_shift_trades_between_two_sizes)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(_i % 2 == 0 ? sized : passing, (uint64_t)_i + 1, 10);
    int in = 0, out = 0, neighbours = 0, slides = 0;
    for (int round = 0; round < 2000; round++) {
        const size_t node = node_with_draws(&f, true);
        if (node == SIZE_MAX || round % 10 == 0) {
            resample(&f);
            continue;
        }
        const sg_rule *r = sg_grammar_rule(f.g, f.d.nodes[node].rule);
        const double *old = f.d.values + f.d.nodes[node].values + sg_grammar_symbol(f.g, r->lhs)->nparams;
        double change = NAN;
        bool inside;
        sg_node_shift(&f.d, node, 0.5, f.rng, &f.draws, &change, &inside);
        (inside ? &in : &out)[0]++;
        if (!inside)
            continue;
        uint32_t at = 0, other;
        while (f.draws.values[at] == old[at])
            at++;
        for (other = at + 1; f.draws.values[other] == old[other];)
            other++;
        (other == at + 1 ? &neighbours : &slides)[0]++;
        ck_assert_double_eq_tol(f.draws.values[at] + f.draws.values[other], old[at] + old[other], 1e-14);
        for (uint32_t i = other + 1; i < r->nvalues; i++)
            ck_assert_double_eq(f.draws.values[i], old[i]);
        const double before = log_density(&f.d);
        ck_ok(sg_derivation_apply(&f.d, &(sg_change){&f.d, node, NULL, f.draws.uniforms, f.draws.values}, &err));
        ck_ok(sg_derivation_check(&f.d, &err));
        ck_assert_double_eq_tol(change, log_density(&f.d) - before, 1e-9);
    }
    ck_assert(in > 500 && out > 20 && neighbours > 100 && slides > 50);
    close_fixture(&f);
}
END_TEST

/* Shifts that are accepted by the ratio of densities alone keep the prior: moments against those of direct samples. */
START_TEST(shifts_keep_the_prior)
{
    sg_error err = SG_ERROR_INIT;
    enum { N = 3000, STEPS = 40 };
    fixture f = open_fixture("label t\nstart S\nrule S -> split x { t | t | t } sizes mean (0.3, 0.4, 0.3)\n"
                             "  covariance ((0.09, -0.03), (-0.03, 0.0625))\n",
                             (uint64_t)_i + 1, 1);
    double sum[2][5] = {{0}}, square[2][5] = {{0}};
    for (int i = 0; i < 2 * N; i++) {
        ck_ok(sg_derivation_sample(&f.d, f.rng, MOST, &err));
        for (int s = 0; i < N && s < STEPS; s++) {
            double change = 0;
            bool inside;
            sg_node_shift(&f.d, 0, 0.5, f.rng, &f.draws, &change, &inside);
            if (inside && log(sg_random_uniform(f.rng)) < change)
                ck_ok(sg_derivation_apply(&f.d, &(sg_change){&f.d, 0, NULL, f.draws.uniforms, f.draws.values}, &err));
        }
        const double *s = f.d.values, m[5] = {s[0], s[1], s[0] * s[0], s[1] * s[1], s[0] * s[1]};
        for (int k = 0; k < 5; k++) {
            sum[i < N][k] += m[k] / N;
            square[i < N][k] += m[k] * m[k] / N;
        }
    }
    for (int k = 0; k < 5; k++) {
        const double variance = (square[0][k] - sum[0][k] * sum[0][k] + square[1][k] - sum[1][k] * sum[1][k]) / N;
        const double z = (sum[0][k] - sum[1][k]) / sqrt(variance);
        ck_assert_msg(fabs(z) < 5, "seed %d, moment %d: %g and %g, z = %g", _i + 1, k, sum[0][k], sum[1][k], z);
    }
    close_fixture(&f);
}
END_TEST

START_TEST(warm_proposals_allocate_nothing)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(passing, 5, 30);
    const size_t node = node_with_draws(&f, true);
    for (int pass = 0; pass < 2; pass++) {
        sg_random_stream(f.rng, 5, 0, 0);
        test_allocations = 0;
        int st = 0;
        double change;
        bool inside;
        for (int i = 0; i < 300; i++) {
            size_t n = 0;
            const double *old = sg_derivation_uniforms(&f.d, 0, &n);
            st |= (int)sg_derivation_regenerate(&f.d, 0, &(sg_uniforms){old, n, 0, f.rng}, MOST, &f.slice, &inside, &err);
            st |= (int)sg_derivation_revalue(&f.slice, &(sg_uniforms){.rng = f.rng}, &f.other, &change, &inside, &err);
            st |= (int)sg_node_resample(&f.d, node, f.rng, &f.draws, &err);
            st |= (int)sg_node_reflect(&f.d, node, 0.1, f.rng, &f.draws, &err);
            sg_node_shift(&f.d, node, 0.1, f.rng, &f.draws, &change, &inside);
        }
        const size_t allocations = test_allocations;
        ck_assert_int_eq(st, SG_OK);
        ck_assert_msg(pass == 0 || allocations == 0, "%zu allocations", allocations);
    }
    close_fixture(&f);
}
END_TEST

START_TEST(failed_allocations_are_reported)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(passing, 8, 60);
    sg_derivation before;
    sg_derivation_init(&before, f.g);
    ck_ok(sg_derivation_copy(&before, &f.d, &err));
    size_t failures[4] = {0};
    for (size_t k = 0; k < 30; k++) {
        for (int call = 0; call < 4; call++) {
            sg_derivation slice, d;
            sg_derivation_init(&slice, f.g);
            sg_derivation_init(&d, f.g);
            if (call == 3)
                ck_ok(sg_derivation_extract(&f.d, 0, &slice, &err));
            bool inside;
            double change;
            sg_random_stream(f.rng, 8, 1, 0);
            const sg_change whole = {&d, 0, &slice, NULL, NULL};
            test_fail_allocation(k);
            const sg_status st =
                call == 0   ? sg_derivation_regenerate(&f.d, 0, &(sg_uniforms){.rng = f.rng}, MOST, &slice, &inside, &err)
                : call == 1 ? sg_derivation_revalue(&f.d, &(sg_uniforms){.rng = f.rng}, &slice, &change, &inside, &err)
                : call == 2 ? sg_derivation_revalue_root(&f.d, f.d.uniforms, &slice, &change, &inside, &err)
                            : sg_derivation_make_room(&d, &whole, &err);
            const int failed = test_allocation_failed();
            ck_assert_msg(st == (failed ? SG_ENOMEM : SG_OK), "call %d, allocation %zu: status %d", call, k, (int)st);
            failures[call] += failed != 0;
            ck_assert(same(&f.d, &before));
            sg_derivation_clear(&slice);
            sg_derivation_clear(&d);
        }
    }
    for (int call = 0; call < 4; call++)
        ck_assert_msg(failures[call] > 0, "call %d allocates nothing", call);
    sg_derivation_clear(&before);
    close_fixture(&f);
}
END_TEST

static const char alternatives[] = "%slabel t\nlabel w\nstart S\n"
                                   "rule S -> 0.3 : split y { R | Q | R } sizes mean (0.4, 0.2, 0.4) sd (0.1, 0.1, 0.1)\n"
                                   "       -> 0.3 : split y { R | Q | Q | w | R } sizes mean (0.2, 0.2, 0.2, 0.2, 0.2)\n"
                                   "                  sd (0.1, 0.1, 0.1, 0.1, 0.1)\n"
                                   "       -> 0.3 : split x { Q | R } sizes mean (0.5, 0.5) sd (0.1, 0.1) -> 0.1 : R\n"
                                   "rule R -> 0.5 : split x { t | w | t } sizes mean (0.3, 0.2, 0.5) sd (0.1, 0.1, 0.1)\n"
                                   "       -> 0.5 : split x { t | w | t | w | t } sizes mean (0.2, 0.2, 0.2, 0.2, 0.2)\n"
                                   "                  sd (0.1, 0.1, 0.1, 0.1, 0.1)\n"
                                   "rule Q -> 0.5 : w -> 0.5 : t\n";

static size_t child_with(const sg_derivation *d, sg_sym symbol, bool last)
{
    size_t found = SIZE_MAX;
    for (size_t c = 1; c < d->nnodes; c += d->nodes[c].length)
        if (d->nodes[c].symbol == symbol && (last || found == SIZE_MAX))
            found = c;
    return found;
}

static void check_same_subtree(const sg_derivation *a, size_t i, const sg_derivation *b, size_t j)
{
    ck_assert_uint_eq(a->nodes[i].length, b->nodes[j].length);
    for (uint32_t k = 0; k < a->nodes[i].length; k++)
        ck_assert(a->nodes[i + k].rule == b->nodes[j + k].rule);
    size_t n, m;
    const double *u = sg_derivation_uniforms(a, i, &n), *v = sg_derivation_uniforms(b, j, &m);
    ck_assert_uint_eq(n, m);
    for (size_t k = 0; k < n; k++)
        ck_assert_double_eq(u[k], v[k]);
}

/* At the root: the first R of both rules is kept where one is in front or tied, and each switch makes a whole derivation. */
START_TEST(a_switch_keeps_what_two_rules_share)
{
    sg_error err = SG_ERROR_INIT;
    char text[2000];
    const bool tied = _i % 2 == 1;
    snprintf(text, sizeof text, alternatives, tied ? "tied\n" : "");
    fixture f = open_fixture(text, (uint64_t)_i + 1, 1);
    const sg_sym r = sg_grammar_find(f.g, "R");
    sg_switcher *w = NULL;
    ck_ok(sg_switcher_create(f.g, &w, &err));
    ck_assert(sg_switcher_useful(w));
    int switched = 0;
    for (int round = 0; round < 500; round++) {
        double log_propose;
        bool inside;
        ck_ok(sg_derivation_sample(&f.d, f.rng, MOST, &err));
        ck_ok(sg_switcher_propose(w, &f.d, 0, f.rng, MOST, &f.slice, &log_propose, &inside, &err));
        if (!inside)
            continue;
        switched++;
        ck_ok(sg_derivation_check(&f.slice, &err));
        ck_assert(isfinite(log_propose) && f.slice.nodes[0].rule != f.d.nodes[0].rule);
        check_same_subtree(&f.d, child_with(&f.d, r, false), &f.slice, child_with(&f.slice, r, false));
        ck_ok(sg_switcher_propose(w, &f.d, 0, f.rng, f.d.nnodes / 2, &f.slice, &log_propose, &inside, &err));
        ck_assert(!inside || f.slice.nnodes <= f.d.nnodes / 2);
    }
    ck_assert(switched > 100);
    sg_switcher_free(w);
    close_fixture(&f);
}
END_TEST

START_TEST(rules_that_depend_on_arguments_are_not_switched)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(passing, 3, 1);
    sg_switcher *w = NULL;
    double log_propose;
    bool inside;
    ck_ok(sg_switcher_create(f.g, &w, &err));
    ck_assert(!sg_switcher_useful(w));
    ck_ok(sg_switcher_propose(w, &f.d, 0, f.rng, MOST, &f.slice, &log_propose, &inside, &err));
    ck_assert(!inside);
    sg_switcher_free(w);
    close_fixture(&f);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("move");
    TCase *tc = tcase_create("move");
    tcase_set_timeout(tc, 120);
    tcase_add_test(tc, rules_know_whether_their_draws_are_passed_on);
    tcase_add_loop_test(tc, rules_list_their_children, 0, 2);
    tcase_add_loop_test(tc, a_change_is_made_in_either_form, 0, 4);
    tcase_add_loop_test(tc, a_copy_keeps_uniforms_in_pre_order, 0, 6);
    tcase_add_loop_test(tc, fresh_regeneration_samples_the_subtree, 0, 3);
    tcase_add_test(tc, too_many_nodes_are_outside);
    tcase_add_test(tc, a_grammar_that_fails_is_an_error);
    tcase_add_loop_test(tc, other_values_for_the_same_rules, 0, 6);
    tcase_add_loop_test(tc, other_draws_at_the_root_are_carried_down, 0, 4);
    tcase_add_test(tc, repeats_that_trade_children_are_noticed);
    tcase_add_loop_test(tc, a_reflected_step_moves_one_uniform_and_keeps_them_uniform, 0, 3);
    tcase_add_loop_test(tc, a_shift_trades_between_two_sizes, 0, 4);
    tcase_add_loop_test(tc, a_switch_keeps_what_two_rules_share, 0, 4);
    tcase_add_test(tc, rules_that_depend_on_arguments_are_not_switched);
    tcase_add_loop_test(tc, shifts_keep_the_prior, 0, 3);
    tcase_add_test(tc, warm_proposals_allocate_nothing);
    tcase_add_test(tc, failed_allocations_are_reported);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
