/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_earley.c - the 2D Earley parser against a tabular algorithm and brute force, on random grammars with unit
 * cycles, left recursion, ambiguity and symbols that derive nothing; its derivations, counts, and its range of values.
 */
#include "parse/earley.h"
#include "tests/earley_oracle.h"
#include "tests/support.h"

#include <math.h>
#include <string.h>

enum { CASES = 60 }; /* a test; tests are looped, and _i seeds them */

typedef struct {
    gsl_rng *rng;
    sg_chart *chart;
    sg_error err;
    oracle_grammar g;
    oracle_cells c;
    double p[ORACLE_RULES];
    sg_parse_table *t;
    sg_leaf_mode mode;
} fixture;

static void begin(fixture *f, int seed, uint64_t stream)
{
    sg_error err = SG_ERROR_INIT;
    memset(f, 0, sizeof *f);
    f->rng = sg_random_create((uint64_t)seed + 1000 * stream);
    ck_ok(sg_chart_create(&f->chart, &err));
}

static void end(fixture *f)
{
    gsl_rng_free(f->rng);
    sg_chart_free(f->chart);
    sg_parse_table_free(f->t);
}

static void compile(fixture *f)
{
    sg_error err = SG_ERROR_INIT;
    sg_parse_table_free(f->t);
    f->t = NULL;
    ck_ok(sg_parse_table_create(&f->g.form, f->mode, &f->t, &err));
    oracle_probabilities(&f->g, f->p);
}

/* A grammar and a lattice of its language. */
static void draw_positive(fixture *f, uint32_t side)
{
    f->mode = oracle_below(f->rng, 2) == 0 ? SG_CELL_MODE : SG_REGION_MODE;
    for (int tries = 0;; tries++) {
        if (tries % 20 == 0)
            oracle_random_grammar(&f->g, f->rng);
        oracle_random_labels(&f->g, &f->c, 1 + oracle_below(f->rng, side), 1 + oracle_below(f->rng, side), f->rng);
        if (f->c.cells.width * f->c.cells.height < 3 && tries % 4 != 0)
            continue;
        if (oracle_paint(&f->g, f->mode, &f->c, f->g.form.axiom, 0, 0, (uint32_t)f->c.cells.width,
                         (uint32_t)f->c.cells.height, 12, f->rng))
            break;
    }
    compile(f);
}

static void draw_costs(fixture *f, uint32_t side)
{
    f->mode = oracle_below(f->rng, 2) == 0 ? SG_CELL_MODE : SG_REGION_MODE;
    oracle_random_grammar(&f->g, f->rng);
    oracle_random_costs(&f->g, &f->c, 1 + oracle_below(f->rng, side), 1 + oracle_below(f->rng, side), f->rng);
    compile(f);
}

static double inside(fixture *f)
{
    sg_error err = SG_ERROR_INIT;
    double v = NAN;
    ck_ok(sg_earley_inside(f->t, &f->c.cells, f->chart, &v, &err));
    return v;
}

static double viterbi(fixture *f)
{
    sg_error err = SG_ERROR_INIT;
    double v = NAN;
    ck_ok(sg_earley_viterbi(f->t, &f->c.cells, f->chart, &v, &err));
    return v;
}

/* Logs whose numbers agree to 1e-10 relative, or which are both minus infinity. */
#define ck_log_eq(got, want)                                                                                           \
    do {                                                                                                               \
        const double got_ = (got), want_ = (want);                                                                     \
        ck_assert_msg(got_ == want_ || fabs(got_ - want_) <= 1e-10, "%s = %.17g, %s = %.17g (_i %d)", #got, got_,      \
                      #want, want_, _i);                                                                               \
    } while (0)

static double tabular(const fixture *f, bool maximum)
{
    return oracle_parse(&f->g, &f->c.cells, f->mode, maximum, f->p);
}

START_TEST(inside_equals_tabular_and_enumeration_on_lattices_of_the_language)
{
    fixture f;
    begin(&f, _i, 1);
    for (int k = 0; k < CASES; k++) {
        draw_positive(&f, 3);
        const double got = inside(&f);
        ck_assert(isfinite(got));
        ck_log_eq(got, tabular(&f, false));
        ck_log_eq(got, oracle_enumerate(&f.g, &f.c.cells, f.mode, f.p));
    }
    end(&f);
}
END_TEST

START_TEST(inside_is_zero_outside_the_language)
{
    fixture f;
    begin(&f, _i, 2);
    for (int k = 0; k < CASES;) {
        f.mode = oracle_below(f.rng, 2) == 0 ? SG_CELL_MODE : SG_REGION_MODE;
        oracle_random_grammar(&f.g, f.rng);
        oracle_random_labels(&f.g, &f.c, 1 + oracle_below(f.rng, 3), 1 + oracle_below(f.rng, 3), f.rng);
        compile(&f);
        const double want = tabular(&f, false);
        ck_log_eq(inside(&f), want);
        ck_log_eq(viterbi(&f), tabular(&f, true));
        if (want != -INFINITY)
            continue;
        ck_assert(oracle_enumerate(&f.g, &f.c.cells, f.mode, f.p) == -INFINITY);
        k++;
    }
    end(&f);
}
END_TEST

START_TEST(larger_lattices_equal_the_tabular_algorithm)
{
    fixture f;
    begin(&f, _i, 3);
    for (int k = 0; k < CASES / 6; k++) {
        draw_positive(&f, ORACLE_SIDE);
        ck_log_eq(inside(&f), tabular(&f, false));
        ck_log_eq(viterbi(&f), tabular(&f, true));
    }
    end(&f);
}
END_TEST

START_TEST(costs_take_the_place_of_labels)
{
    fixture f;
    begin(&f, _i, 4);
    for (int k = 0; k < CASES / 2; k++) {
        draw_costs(&f, 4);
        ck_log_eq(inside(&f), tabular(&f, false));
        ck_log_eq(viterbi(&f), tabular(&f, true));
    }
    end(&f);
}
END_TEST

/* Dear cells: the best derivation is found by several passes with lower and lower floors, or by none. */
START_TEST(large_costs_change_nothing)
{
    fixture f;
    begin(&f, _i, 17);
    size_t outside = 0;
    for (int k = 0; k < CASES / 2; k++) {
        draw_costs(&f, 4);
        for (size_t i = 0; i < f.g.form.nterminals * f.c.cells.width * f.c.cells.height; i++)
            f.c.costs[i] *= 200; /* a long double holds exp(-11000) */
        const double got = viterbi(&f), want = tabular(&f, true);
        ck_assert_msg(got == want || fabs(got - want) <= 1e-13 * fabs(want) + 1e-10, "%.17g, not %.17g", got, want);
        outside += got == -INFINITY;
    }
    ck_assert_uint_gt(outside, 0);
    ck_assert_uint_lt(outside, CASES / 2);
    end(&f);
}
END_TEST

/* Score a tree by its rules and leaves, and check that it is one: symbols, extents, order, counts. */
static size_t check_tree(const fixture *f, const sg_parse_node *nodes, size_t at, uint32_t symbol, double *score,
                         double *counts)
{
    const sg_parse_node *node = &nodes[at];
    const sg_split_rule *r = &f->g.rules[node->rule];
    ck_assert_uint_eq(r->lhs, symbol);
    *score += log(r->probability);
    counts[node->rule]++;
    size_t next = at + 1;
    if (r->op == SG_SPLIT_LEXICAL) {
        const long double leaf = oracle_leaf(&f->c.cells, f->mode, r->rhs[0], node->x0, node->y0, node->x1, node->y1);
        ck_assert(leaf > 0);
        *score += (double)logl(leaf);
    } else {
        uint32_t x = node->x0, y = node->y0;
        for (uint32_t i = 0; i < r->n; i++) {
            const sg_parse_node *child = &nodes[next];
            ck_assert_uint_eq(child->x0, x);
            ck_assert_uint_eq(child->y0, y);
            ck_assert_uint_gt(child->x1, child->x0);
            ck_assert_uint_gt(child->y1, child->y0);
            if (r->op == SG_SPLIT_X) {
                ck_assert_uint_eq(child->y1, node->y1);
                x = child->x1;
            } else {
                ck_assert_uint_eq(child->x1, node->x1);
                y = child->y1;
            }
            next = check_tree(f, nodes, next, r->rhs[i], score, counts);
        }
        ck_assert_uint_eq(r->op == SG_SPLIT_X ? x : y, r->op == SG_SPLIT_X ? node->x1 : node->y1);
    }
    ck_assert_uint_eq(node->length, next - at);
    return next;
}

static void check_derivation(fixture *f, int _i)
{
    sg_error err = SG_ERROR_INIT;
    const double best = viterbi(f);
    ck_log_eq(best, tabular(f, true));
    if (best == -INFINITY) {
        sg_parse_node *none;
        size_t nnone;
        ck_assert_int_eq(sg_earley_viterbi_tree(f->t, f->chart, &none, &nnone, &err), SG_ENOPARSE);
        return;
    }
    sg_parse_node *nodes = NULL, *again = NULL;
    size_t n = 0, nagain = 0;
    ck_ok(sg_earley_viterbi_tree(f->t, f->chart, &nodes, &n, &err));
    double score = 0, counts[ORACLE_RULES] = {0}, got[ORACLE_RULES] = {0};
    ck_assert_uint_eq(check_tree(f, nodes, 0, f->g.form.axiom, &score, counts), n);
    ck_assert_uint_eq(nodes[0].x1, f->c.cells.width);
    ck_assert_uint_eq(nodes[0].y1, f->c.cells.height);
    ck_log_eq(score, best);
    ck_ok(sg_earley_viterbi_counts(f->t, f->chart, got, &err));
    for (size_t r = 0; r < f->g.form.nrules; r++)
        ck_assert_double_eq(got[r], counts[r]);
    viterbi(f); /* the same again */
    ck_ok(sg_earley_viterbi_tree(f->t, f->chart, &again, &nagain, &err));
    ck_assert_uint_eq(n, nagain);
    ck_assert_mem_eq(nodes, again, n * sizeof *nodes);
    free(nodes);
    free(again);
}

START_TEST(the_best_derivation_has_the_best_score)
{
    fixture f;
    begin(&f, _i, 5);
    for (int k = 0; k < CASES; k++) {
        if (k % 4 == 3)
            draw_costs(&f, 4);
        else
            draw_positive(&f, 4);
        check_derivation(&f, _i);
    }
    end(&f);
}
END_TEST

/* Rules that begin with the first child's start, equals in value: the order of the rules decides, then the cuts. */
START_TEST(ties_break_by_rule_then_by_cut)
{
    sg_error err = SG_ERROR_INIT;
    fixture f;
    begin(&f, 0, 6);
    oracle_begin(&f.g, 1, 1);
    oracle_rule(&f.g, 0, SG_SPLIT_Y, 2, (uint32_t[]){0, 0}, 0.25);
    oracle_rule(&f.g, 0, SG_SPLIT_X, 2, (uint32_t[]){0, 0}, 0.25);
    oracle_rule(&f.g, 0, SG_SPLIT_LEXICAL, 1, (uint32_t[]){0}, 0.25);
    oracle_rule(&f.g, 0, SG_SPLIT_LEXICAL, 1, (uint32_t[]){0}, 0.25);
    oracle_random_labels(&f.g, &f.c, 3, 3, f.rng);
    compile(&f);
    viterbi(&f);
    sg_parse_node *nodes;
    size_t n;
    ck_ok(sg_earley_viterbi_tree(f.t, f.chart, &nodes, &n, &err));
    ck_assert_uint_eq(n, 17);
    ck_assert_uint_eq(nodes[0].rule, 0);
    ck_assert_uint_eq(nodes[1].rule, 1);
    ck_assert_uint_eq(nodes[1].y1, 1);
    ck_assert_uint_eq(nodes[2].x1, 1);
    for (size_t i = 0; i < n; i++)
        ck_assert_uint_ne(nodes[i].rule, 3);
    free(nodes);
    end(&f);
}
END_TEST

/* d log Z / d log p of each rule, from the tabular algorithm in extended precision. */
static void check_counts(fixture *f, int _i)
{
    sg_error err = SG_ERROR_INIT;
    double counts[ORACLE_RULES] = {0}, probe[ORACLE_RULES];
    if (inside(f) == -INFINITY)
        return;
    ck_ok(sg_earley_expected_counts(f->t, f->chart, counts, &err));
    for (size_t r = 0; r < f->g.form.nrules; r++) {
        const double h = 1e-4;
        memcpy(probe, f->p, sizeof probe);
        probe[r] = f->p[r] * exp(h);
        const double up = oracle_parse(&f->g, &f->c.cells, f->mode, false, probe);
        probe[r] = f->p[r] * exp(-h);
        const double down = oracle_parse(&f->g, &f->c.cells, f->mode, false, probe);
        probe[r] = f->p[r] * exp(2 * h);
        const double up2 = oracle_parse(&f->g, &f->c.cells, f->mode, false, probe);
        probe[r] = f->p[r] * exp(-2 * h);
        const double down2 = oracle_parse(&f->g, &f->c.cells, f->mode, false, probe);
        const double want = (8 * (up - down) - (up2 - down2)) / (12 * h);
        ck_assert_msg(fabs(counts[r] - want) <= 1e-7 * (1 + fabs(want)),
                      "rule %zu: %.12g, finite difference %.12g (_i %d)", r, counts[r], want, _i);
    }
}

/* Each use of a symbol on a right-hand side is a use of one of its rules, and the axiom is used once more; in cell mode
 * each cell is a use of a lexical rule. */
static void check_balance(fixture *f)
{
    sg_error err = SG_ERROR_INIT;
    double counts[ORACLE_RULES] = {0}, balance[ORACLE_SYMBOLS] = {0}, lexical = 0;
    if (inside(f) == -INFINITY)
        return;
    ck_ok(sg_earley_expected_counts(f->t, f->chart, counts, &err));
    ck_assert_int_eq(sg_earley_expected_counts(f->t, f->chart, counts, &err), SG_EINVAL);
    balance[f->g.form.axiom] = 1;
    for (size_t r = 0; r < f->g.form.nrules; r++) {
        const sg_split_rule *rule = &f->g.rules[r];
        ck_assert(counts[r] >= 0);
        balance[rule->lhs] -= counts[r];
        lexical += rule->op == SG_SPLIT_LEXICAL ? counts[r] : 0;
        for (uint32_t i = 0; rule->op != SG_SPLIT_LEXICAL && i < rule->n; i++)
            balance[rule->rhs[i]] += counts[r];
    }
    for (size_t s = 0; s < f->g.form.nsymbols; s++)
        ck_assert_double_eq_tol(balance[s], 0, 1e-9);
    if (f->mode == SG_CELL_MODE)
        ck_assert_double_eq_tol(lexical, (double)(f->c.cells.width * f->c.cells.height), 1e-9);
}

START_TEST(expected_counts_are_finite_differences)
{
    fixture f;
    begin(&f, _i, 7);
    for (int k = 0; k < CASES / 4; k++) {
        if (k % 4 == 3)
            draw_costs(&f, 3);
        else
            draw_positive(&f, 3);
        check_counts(&f, _i);
    }
    end(&f);
}
END_TEST

START_TEST(expected_counts_balance)
{
    fixture f;
    begin(&f, _i, 8);
    for (int k = 0; k < CASES; k++) {
        if (k % 4 == 3)
            draw_costs(&f, ORACLE_SIDE);
        else
            draw_positive(&f, ORACLE_SIDE);
        check_balance(&f);
    }
    end(&f);
}
END_TEST

START_TEST(replaced_probabilities_are_those_of_a_new_table)
{
    sg_error err = SG_ERROR_INIT;
    fixture f;
    begin(&f, _i, 9);
    for (int k = 0; k < CASES / 2; k++) {
        draw_positive(&f, 3);
        for (size_t r = 0; r < f.g.form.nrules; r++)
            f.p[r] *= oracle_below(f.rng, 6) == 0 ? 0 : sg_random_uniform(f.rng);
        ck_ok(sg_parse_table_set_probabilities(f.t, f.p, &err));
        const double got = inside(&f), best = viterbi(&f);
        ck_log_eq(got, tabular(&f, false));
        ck_log_eq(best, tabular(&f, true));
        for (size_t r = 0; r < f.g.form.nrules; r++)
            f.g.rules[r].probability = f.p[r];
        compile(&f);
        ck_assert(inside(&f) == got);
        ck_assert(viterbi(&f) == best);
    }
    end(&f);
}
END_TEST

/* A tied grammar and a lattice of its language, by rejection. */
static double draw_tied(fixture *f, bool units)
{
    f->mode = SG_CELL_MODE;
    for (int tries = 0;; tries++) {
        if (tries % 50 == 0) {
            oracle_random_grammar(&f->g, f->rng);
            f->g.form.tied = true;
            for (size_t r = 0; r < f->g.form.nrules && !units; r++)
                if (f->g.rules[r].op != SG_SPLIT_LEXICAL && f->g.rules[r].n == 1)
                    tries = -1;
            if (tries < 0)
                continue;
            compile(f);
        }
        oracle_random_labels(&f->g, &f->c, 1 + oracle_below(f->rng, 4), 1 + oracle_below(f->rng, 3), f->rng);
        const double v = oracle_tied(&f->g, &f->c.cells, false, f->p);
        if (f->c.cells.width * f->c.cells.height >= 3 && v != -INFINITY)
            return v;
    }
}

START_TEST(tied_siblings_have_equal_cells_and_count_once)
{
    sg_error err = SG_ERROR_INIT;
    fixture f;
    begin(&f, _i, 14);
    for (int k = 0; k < CASES / 4; k++) {
        const double want = draw_tied(&f, true);
        ck_log_eq(inside(&f), want);
        double counts[ORACLE_RULES] = {0};
        ck_ok(sg_earley_expected_counts(f.t, f.chart, counts, &err));
        for (size_t r = 0; r < f.g.form.nrules; r++) {
            const double h = 1e-4, p = f.p[r];
            f.p[r] = p * exp(h);
            const double up = oracle_tied(&f.g, &f.c.cells, false, f.p);
            f.p[r] = p * exp(-h);
            const double down = oracle_tied(&f.g, &f.c.cells, false, f.p);
            f.p[r] = p;
            ck_assert_double_eq_tol(counts[r], (up - down) / (2 * h), 1e-6 * (1 + counts[r]));
        }
        for (int other = 0; other < 4; other++) { /* lattices of any kind */
            oracle_random_labels(&f.g, &f.c, 1 + oracle_below(f.rng, 4), 1 + oracle_below(f.rng, 3), f.rng);
            ck_log_eq(inside(&f), oracle_tied(&f.g, &f.c.cells, false, f.p));
        }
    }
    end(&f);
}
END_TEST

START_TEST(the_best_tied_derivation_stores_each_symbol_once)
{
    sg_error err = SG_ERROR_INIT;
    fixture f;
    begin(&f, _i, 15);
    for (int k = 0; k < CASES / 4; k++) {
        draw_tied(&f, false);
        const double best = viterbi(&f);
        ck_log_eq(best, oracle_tied(&f.g, &f.c.cells, true, f.p));
        sg_parse_node *nodes;
        size_t n;
        double score = 0, counts[ORACLE_RULES] = {0};
        ck_ok(sg_earley_viterbi_tree(f.t, f.chart, &nodes, &n, &err));
        for (size_t i = 0; i < n; i++) {
            score += log(f.p[nodes[i].rule]);
            ck_assert_uint_le(i + nodes[i].length, n);
        }
        ck_log_eq(score, best);
        ck_assert_uint_eq(nodes[0].length, n);
        ck_ok(sg_earley_viterbi_counts(f.t, f.chart, counts, &err));
        for (size_t i = 0; i < n; i++)
            counts[nodes[i].rule]--;
        for (size_t r = 0; r < f.g.form.nrules; r++)
            ck_assert_double_eq(counts[r], 0);
        free(nodes);
    }
    end(&f);
}
END_TEST

/* S -> A B A with one derivation of A: tied or not, in either mode. With two, only cell mode over labels is exact. */
START_TEST(what_tied_siblings_cannot_have_is_refused)
{
    sg_error err = SG_ERROR_INIT;
    fixture f;
    double v;
    begin(&f, 0, 16);
    oracle_begin(&f.g, 3, 3);
    oracle_rule(&f.g, 0, SG_SPLIT_X, 3, (uint32_t[]){1, 2, 1}, 1);
    oracle_rule(&f.g, 1, SG_SPLIT_LEXICAL, 1, (uint32_t[]){0}, 1);
    oracle_rule(&f.g, 2, SG_SPLIT_LEXICAL, 1, (uint32_t[]){1}, 0.5);
    oracle_rule(&f.g, 2, SG_SPLIT_LEXICAL, 1, (uint32_t[]){2}, 0.5);
    f.g.form.tied = true;
    f.mode = SG_REGION_MODE;
    compile(&f);
    f.c.cells = (sg_cells){4, 1, f.c.labels, NULL};
    memcpy(f.c.labels, (uint16_t[]){0, 0, 2, 0}, 4 * sizeof(uint16_t));
    ck_log_eq(inside(&f), log(0.5));
    f.g.rhs[0][0] = f.g.rhs[0][1] = f.g.rhs[0][2] = 2; /* the symbol with two derivations, three times */
    sg_parse_table *t;
    ck_assert_int_eq(sg_parse_table_create(&f.g.form, SG_REGION_MODE, &t, &err), SG_EINVAL);
    f.mode = SG_CELL_MODE;
    compile(&f);
    f.c.cells.width = 3;
    memcpy(f.c.labels, (uint16_t[]){2, 2, 2}, 3 * sizeof(uint16_t));
    ck_log_eq(inside(&f), log(0.5));
    f.c.labels[1] = 1;
    ck_assert(inside(&f) == -INFINITY);
    oracle_random_costs(&f.g, &f.c, 3, 1, f.rng);
    ck_assert_int_eq(sg_earley_inside(f.t, &f.c.cells, f.chart, &v, &err), SG_EINVAL);
    end(&f);
}
END_TEST

/* Costs that grow by a constant take it from the log of every derivation, cell by cell: no value is too small. */
START_TEST(values_far_below_the_least_double_keep_their_precision)
{
    sg_error err = SG_ERROR_INIT;
    enum { SIDE = 14 };
    fixture f;
    begin(&f, _i, 10);
    oracle_begin(&f.g, 1, 2);
    oracle_rule(&f.g, 0, SG_SPLIT_Y, 2, (uint32_t[]){0, 0}, 0.25);
    oracle_rule(&f.g, 0, SG_SPLIT_X, 3, (uint32_t[]){0, 0, 0}, 0.25);
    oracle_rule(&f.g, 0, SG_SPLIT_LEXICAL, 1, (uint32_t[]){0}, 0.25);
    oracle_rule(&f.g, 0, SG_SPLIT_LEXICAL, 1, (uint32_t[]){1}, 0.25);
    f.mode = _i % 2 == 0 ? SG_CELL_MODE : SG_REGION_MODE;
    compile(&f);
    double costs[2 * SIDE * SIDE], counts[2][ORACLE_RULES] = {{0}}, v[2][2];
    for (int pass = 0; pass < 2; pass++) {
        sg_random_stream(f.rng, 5, (uint32_t)_i, 0);
        for (size_t k = 0; k < 2 * SIDE * SIDE; k++)
            costs[k] = sg_random_uniform(f.rng) + 1500 * pass;
        const sg_cells cells = {SIDE - 1, SIDE, NULL, costs};
        ck_ok(sg_earley_viterbi(f.t, &cells, f.chart, &v[pass][0], &err));
        ck_ok(sg_earley_inside(f.t, &cells, f.chart, &v[pass][1], &err));
        ck_ok(sg_earley_expected_counts(f.t, f.chart, counts[pass], &err));
    }
    const double shift = 1500.0 * (SIDE - 1) * SIDE;
    ck_assert(isfinite(v[0][0]) && v[0][1] > v[0][0]);
    ck_assert_double_eq_tol(v[1][0] + shift, v[0][0], 1e-8); /* a log of 3e5 has no more digits */
    ck_assert_double_eq_tol(v[1][1] + shift, v[0][1], 1e-8);
    for (size_t r = 0; r < f.g.form.nrules; r++)
        ck_assert_double_eq_tol(counts[0][r], counts[1][r], 1e-7 * (1 + counts[0][r]));
    end(&f);
}
END_TEST

/* A row of a symbol each: the recursion is as deep as the lattice is long. */
START_TEST(long_lattices_do_not_exhaust_the_stack)
{
    sg_error err = SG_ERROR_INIT;
    enum { LONG = 3000 };
    static uint16_t labels[LONG];
    fixture f;
    begin(&f, 0, 11);
    oracle_begin(&f.g, 2, 1);
    oracle_rule(&f.g, 0, SG_SPLIT_Y, 2, (uint32_t[]){1, 0}, 0.5);
    oracle_rule(&f.g, 0, SG_SPLIT_LEXICAL, 1, (uint32_t[]){0}, 0.5);
    oracle_rule(&f.g, 1, SG_SPLIT_LEXICAL, 1, (uint32_t[]){0}, 1);
    compile(&f);
    const sg_cells cells = {1, LONG, labels, NULL};
    double v, counts[ORACLE_RULES] = {0};
    ck_ok(sg_earley_inside(f.t, &cells, f.chart, &v, &err));
    ck_assert_double_eq_tol(v, LONG * log(0.5), 1e-8);
    ck_ok(sg_earley_expected_counts(f.t, f.chart, counts, &err));
    ck_assert_double_eq_tol(counts[0], LONG - 1, 1e-8);
    end(&f);
}
END_TEST

START_TEST(bad_arguments_have_their_status)
{
    sg_error err = SG_ERROR_INIT;
    fixture f;
    double v, counts[ORACLE_RULES] = {0};
    begin(&f, 0, 12);
    draw_positive(&f, 3);
    sg_cells cells = f.c.cells;
    cells.width = 0;
    ck_assert_int_eq(sg_earley_inside(f.t, &cells, f.chart, &v, &err), SG_EINVAL);
    ck_assert_int_eq(sg_earley_expected_counts(f.t, f.chart, counts, &err), SG_EINVAL);
    cells = f.c.cells;
    cells.labels = NULL;
    ck_assert_int_eq(sg_earley_viterbi(f.t, &cells, f.chart, &v, &err), SG_EINVAL);
    ck_assert_int_eq(sg_earley_viterbi_counts(f.t, f.chart, counts, &err), SG_EINVAL);
    f.c.costs[0] = NAN;
    cells.costs = f.c.costs;
    ck_assert_int_eq(sg_earley_viterbi(f.t, &cells, f.chart, &v, &err), SG_EINVAL);
    f.p[0] = NAN;
    ck_assert_int_eq(sg_parse_table_set_probabilities(f.t, f.p, &err), SG_EINVAL);
    sg_parse_table *t = NULL;
    oracle_begin(&f.g, 1, 1);
    ck_assert_int_eq(sg_parse_table_create(&f.g.form, SG_CELL_MODE, &t, &err), SG_OK); /* no rule: the empty language */
    cells = (sg_cells){1, 1, &(uint16_t){0}, NULL};
    ck_ok(sg_earley_inside(t, &cells, f.chart, &v, &err));
    ck_assert(v == -INFINITY);
    sg_parse_table_free(t);
    oracle_rule(&f.g, 0, SG_SPLIT_X, 1, (uint32_t[]){0}, 1);
    oracle_rule(&f.g, 0, SG_SPLIT_LEXICAL, 1, (uint32_t[]){0}, 1);
    ck_assert_int_eq(sg_parse_table_create(&f.g.form, SG_CELL_MODE, &t, &err), SG_ENUMERIC);
    f.g.rhs[0][0] = 1;
    ck_assert_int_eq(sg_parse_table_create(&f.g.form, SG_CELL_MODE, &t, &err), SG_EINVAL);
    end(&f);
}
END_TEST

START_TEST(labels_that_no_rule_makes_are_outside_the_language)
{
    sg_error err = SG_ERROR_INIT;
    fixture f;
    begin(&f, 0, 13);
    oracle_begin(&f.g, 1, 1);
    oracle_rule(&f.g, 0, SG_SPLIT_X, 2, (uint32_t[]){0, 0}, 0.5);
    oracle_rule(&f.g, 0, SG_SPLIT_LEXICAL, 1, (uint32_t[]){0}, 0.5);
    for (int mode = 0; mode < 2; mode++) {
        f.mode = mode == 0 ? SG_CELL_MODE : SG_REGION_MODE;
        compile(&f);
        uint16_t labels[3] = {0, 0, 0};
        const sg_cells cells = {3, 1, labels, NULL};
        double v;
        ck_ok(sg_earley_inside(f.t, &cells, f.chart, &v, &err));
        ck_assert(isfinite(v));
        labels[1] = UINT16_MAX;
        ck_ok(sg_earley_inside(f.t, &cells, f.chart, &v, &err));
        ck_assert(v == -INFINITY);
        labels[1] = 1;
        ck_ok(sg_earley_viterbi(f.t, &cells, f.chart, &v, &err));
        ck_assert(v == -INFINITY);
    }
    end(&f);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("earley");
    TCase *tc = tcase_create("earley");
    tcase_set_timeout(tc, 120);
    tcase_add_loop_test(tc, inside_equals_tabular_and_enumeration_on_lattices_of_the_language, 0, 20);
    tcase_add_loop_test(tc, inside_is_zero_outside_the_language, 0, 20);
    tcase_add_loop_test(tc, larger_lattices_equal_the_tabular_algorithm, 0, 8);
    tcase_add_loop_test(tc, costs_take_the_place_of_labels, 0, 8);
    tcase_add_loop_test(tc, large_costs_change_nothing, 0, 8);
    tcase_add_loop_test(tc, the_best_derivation_has_the_best_score, 0, 12);
    tcase_add_test(tc, ties_break_by_rule_then_by_cut);
    tcase_add_loop_test(tc, expected_counts_are_finite_differences, 0, 8);
    tcase_add_loop_test(tc, expected_counts_balance, 0, 8);
    tcase_add_loop_test(tc, replaced_probabilities_are_those_of_a_new_table, 0, 4);
    tcase_add_loop_test(tc, tied_siblings_have_equal_cells_and_count_once, 0, 8);
    tcase_add_loop_test(tc, the_best_tied_derivation_stores_each_symbol_once, 0, 4);
    tcase_add_test(tc, what_tied_siblings_cannot_have_is_refused);
    tcase_add_loop_test(tc, values_far_below_the_least_double_keep_their_precision, 0, 2);
    tcase_add_test(tc, long_lattices_do_not_exhaust_the_stack);
    tcase_add_test(tc, bad_arguments_have_their_status);
    tcase_add_test(tc, labels_that_no_rule_makes_are_outside_the_language);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
