/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_earley_em.c - re-estimation never lowers its objective, ends where expectation and maximisation agree, and finds
 * the probabilities that lattices were made with. */
#include "parse/earley_em.h"
#include "tests/earley_oracle.h"
#include "tests/support.h"

#include <math.h>
#include <string.h>

enum { LATTICES = 6, ROUNDS = 30 };

typedef struct {
    gsl_rng *rng;
    oracle_grammar g;
    oracle_cells cells[LATTICES];
    sg_cells views[LATTICES];
    sg_em_opts opts;
} fixture;

/* A grammar and lattices of its language. */
static void draw(fixture *f)
{
    size_t n = 0;
    for (int tries = 0; n < LATTICES; tries++) {
        if (tries % 200 == 0) {
            oracle_random_grammar(&f->g, f->rng);
            n = 0;
        }
        oracle_cells *c = &f->cells[n];
        oracle_random_labels(&f->g, c, 1 + oracle_below(f->rng, 4), 1 + oracle_below(f->rng, 4), f->rng);
        if (c->cells.width * c->cells.height > 2 &&
            oracle_paint(&f->g, f->opts.mode, c, f->g.form.axiom, 0, 0, (uint32_t)c->cells.width,
                         (uint32_t)c->cells.height, 12, f->rng))
            f->views[n++] = c->cells;
    }
}

/* The definition: logs of all lattices by the tabular algorithm, and the prior. */
static double objective_of(const fixture *f, const double *p)
{
    double sum = 0;
    for (size_t i = 0; i < LATTICES; i++)
        sum += oracle_parse(&f->g, &f->views[i], f->opts.mode, f->opts.kind == SG_EM_VITERBI, p);
    for (size_t r = 0; r < f->g.form.nrules && f->opts.alpha != 1; r++)
        sum += (f->opts.alpha - 1) * log(p[r]);
    return sum;
}

START_TEST(the_objective_never_falls)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = {.rng = sg_random_create((uint64_t)_i), .opts = SG_EM_OPTS_INIT};
    for (int k = 0; k < 6; k++) {
        f.opts.kind = k % 2 == 0 ? SG_EM_TRUE : SG_EM_VITERBI;
        f.opts.mode = _i % 2 == 0 ? SG_CELL_MODE : SG_REGION_MODE;
        f.opts.alpha = k % 3 == 2 ? 1.5 : 1;
        f.opts.iterations = ROUNDS;
        f.opts.tolerance = 0;
        draw(&f);
        double p[ORACLE_RULES], start[ORACLE_RULES], trace[ROUNDS + 1], sums[ORACLE_SYMBOLS] = {0};
        size_t n;
        ck_ok(sg_em_reestimate(&f.g.form, f.views, LATTICES, &f.opts, NULL, p, trace, &n, &err));
        ck_assert_uint_gt(n, 0);
        oracle_probabilities(&f.g, start);
        ck_assert_double_eq_tol(trace[0], objective_of(&f, start), 1e-8);
        ck_assert_double_eq_tol(trace[n], objective_of(&f, p), 1e-8);
        for (size_t i = 0; i < n; i++)
            ck_assert_msg(trace[i + 1] >= trace[i] - 1e-9 * fabs(trace[i]), "iteration %zu: %.15g after %.15g (_i %d)",
                          i + 1, trace[i + 1], trace[i], _i);
        for (size_t r = 0; r < f.g.form.nrules; r++)
            sums[f.g.rules[r].lhs] += p[r];
        for (size_t s = 0; s < f.g.form.nsymbols; s++)
            ck_assert_double_eq_tol(sums[s], 1, 1e-9);
    }
    gsl_rng_free(f.rng);
}
END_TEST

/* Rows of a and b of length 1 and 2 in known shares: nothing is hidden, so one iteration gives the relative counts. */
START_TEST(without_ambiguity_one_iteration_counts)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = {.opts = SG_EM_OPTS_INIT};
    oracle_begin(&f.g, 2, 2);
    oracle_rule(&f.g, 0, SG_SPLIT_X, 2, (uint32_t[]){1, 1}, 0.5);
    oracle_rule(&f.g, 0, SG_SPLIT_LEXICAL, 1, (uint32_t[]){0}, 0.5);
    oracle_rule(&f.g, 1, SG_SPLIT_LEXICAL, 1, (uint32_t[]){0}, 0.5);
    oracle_rule(&f.g, 1, SG_SPLIT_LEXICAL, 1, (uint32_t[]){1}, 0.5);
    uint16_t aa[2] = {0, 0}, ab[2] = {0, 1}, a[1] = {0};
    const sg_cells cells[4] = {{2, 1, aa, NULL}, {2, 1, ab, NULL}, {2, 1, ab, NULL}, {1, 1, a, NULL}};
    double p[4], trace[101];
    size_t n;
    for (int kind = 0; kind < 2; kind++) {
        f.opts.kind = kind == 0 ? SG_EM_TRUE : SG_EM_VITERBI;
        ck_ok(sg_em_reestimate(&f.g.form, cells, 4, &f.opts, NULL, p, trace, &n, &err));
        ck_assert_uint_le(n, 2);
        const double want[4] = {3. / 4, 1. / 4, 4. / 6, 2. / 6};
        for (int r = 0; r < 4; r++)
            ck_assert_double_eq_tol(p[r], want[r], 1e-12);
    }
    f.opts.alpha = 2;
    ck_ok(sg_em_reestimate(&f.g.form, cells, 4, &f.opts, NULL, p, trace, &n, &err));
    ck_assert_double_eq_tol(p[0], 4. / 6, 1e-12);
    ck_assert_double_eq_tol(p[2], 5. / 8, 1e-12);
}
END_TEST

static bool stop_now(sg_progress *self)
{
    (void)self;
    return true;
}

START_TEST(bad_arguments_and_lattices_outside_have_their_status)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = {.opts = SG_EM_OPTS_INIT};
    oracle_begin(&f.g, 1, 2);
    oracle_rule(&f.g, 0, SG_SPLIT_LEXICAL, 1, (uint32_t[]){0}, 1);
    oracle_rule(&f.g, 0, SG_SPLIT_LEXICAL, 1, (uint32_t[]){1}, 0);
    uint16_t labels[2] = {0, 0};
    sg_cells cells[2] = {{1, 1, labels, NULL}, {2, 1, labels, NULL}};
    double p[2];
    ck_assert_int_eq(sg_em_reestimate(&f.g.form, cells, 2, &f.opts, NULL, p, NULL, NULL, &err), SG_ENOPARSE);
    ck_assert_ptr_nonnull(strstr(err.msg, "lattice 2"));
    ck_assert_int_eq(sg_em_reestimate(&f.g.form, cells, 0, &f.opts, NULL, p, NULL, NULL, &err), SG_EINVAL);
    f.opts.alpha = 0.5;
    ck_assert_int_eq(sg_em_reestimate(&f.g.form, cells, 1, &f.opts, NULL, p, NULL, NULL, &err), SG_EINVAL);
    f.opts.alpha = 2; /* a rule of probability 0 has no place in such a prior */
    ck_assert_int_eq(sg_em_reestimate(&f.g.form, cells, 1, &f.opts, NULL, p, NULL, NULL, &err), SG_EINVAL);
    f.opts.alpha = 1;
    sg_progress stopper = {.stop = stop_now};
    ck_assert_int_eq(sg_em_reestimate(&f.g.form, cells, 1, &f.opts, &stopper, p, NULL, NULL, &err), SG_STOPPED);
    ck_ok(sg_em_reestimate(&f.g.form, cells, 1, &f.opts, NULL, p, NULL, NULL, &err));
    ck_assert_double_eq(p[0], 1);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("earley_em");
    TCase *tc = tcase_create("earley_em");
    tcase_set_timeout(tc, 60);
    tcase_add_loop_test(tc, the_objective_never_falls, 0, 12);
    tcase_add_test(tc, without_ambiguity_one_iteration_counts);
    tcase_add_test(tc, bad_arguments_and_lattices_outside_have_their_status);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
