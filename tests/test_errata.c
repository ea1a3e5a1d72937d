/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_errata.c - the arguments of docs/errata.md, in numbers. */
#include "learn/energy.h"
#include "parse/earley.h"
#include "tests/support.h"

#include <gsl/gsl_integration.h>
#include <gsl/gsl_sf_gamma.h>
#include <math.h>

enum { MAX_RULES = 8 };

/* S with n lexical rules over n terminals: only its parameters count. */
typedef struct {
    uint32_t rhs[MAX_RULES];
    sg_split_rule rules[MAX_RULES];
    const char *names[MAX_RULES];
    uint32_t colors[MAX_RULES];
    sg_split_form form;
} coin;

static void make_coin(coin *c, size_t n)
{
    static const char *const symbols[] = {"S"};
    for (size_t i = 0; i < n; i++) {
        c->rhs[i] = (uint32_t)i;
        c->names[i] = "t";
        c->colors[i] = 0;
        c->rules[i] = (sg_split_rule){.lhs = 0, .op = SG_SPLIT_LEXICAL, .n = 1, .rhs = &c->rhs[i],
                                      .probability = 1 / (double)n, .source = SG_NONE};
    }
    c->form = (sg_split_form){.name = "coin", .nsymbols = 1, .symbol_names = symbols, .nterminals = n,
                              .terminal_names = c->names, .terminal_colors = c->colors, .axiom = 0, .nrules = n,
                              .rules = c->rules};
}

static double log_parameter_prior(size_t n, double alpha, const double *counts)
{
    coin c;
    sg_error err = SG_ERROR_INIT;
    sg_energy_opts opts = SG_ENERGY_OPTS_INIT;
    sg_energy_parts parts;
    make_coin(&c, n);
    opts.data_term = SG_DATA_VITERBI;
    opts.alpha = alpha;
    ck_ok(sg_energy_of_form(&opts, &c.form, counts, &parts, &err));
    return parts.log_parameter_prior;
}

/* Density of theta_1 = t for two rules: counts that make t the maximising parameter. */
static double density_of_two(double t, void *alpha)
{
    const double many = 1e9, a = *(double *)alpha - 1;
    const double counts[2] = {t * (many + 2 * a) - a, (1 - t) * (many + 2 * a) - a};
    return exp(log_parameter_prior(2, *(double *)alpha, counts));
}

START_TEST(the_parameter_prior_is_a_density)
{
    /* alpha = 1: constant on a simplex of volume 1 / (k-1)!. With the inverted normaliser this is 1 for k <= 2 only. */
    for (size_t k = 1; k <= MAX_RULES; k++) {
        const double counts[MAX_RULES] = {3, 1, 4, 1, 5, 9, 2, 6};
        ck_assert_double_eq_tol(exp(log_parameter_prior(k, 1, counts)) / gsl_sf_fact((unsigned)k - 1), 1, 1e-12);
    }
    for (double alpha = 1.5; alpha < 4; alpha += 0.5) {
        gsl_function f = {density_of_two, &alpha};
        gsl_integration_workspace *w = gsl_integration_workspace_alloc(200);
        double integral, error;
        ck_assert_int_eq(gsl_integration_qags(&f, 1e-6, 1 - 1e-6, 0, 1e-7, 200, w, &integral, &error), 0);
        gsl_integration_workspace_free(w);
        ck_assert_double_eq_tol(integral, 1, 1e-5);
    }
}
END_TEST

typedef struct {
    double alpha, heads, tails;
} tosses;

static double likelihood_times_prior(double t, void *user)
{
    const tosses *s = user;
    return pow(t, s->heads + s->alpha - 1) * pow(1 - t, s->tails + s->alpha - 1) / gsl_sf_beta(s->alpha, s->alpha);
}

START_TEST(the_marginal_term_is_the_integral)
{
    for (int heads = 0; heads < 6; heads++) {
        for (int tails = 0; tails < 6; tails++) {
            const double counts[2] = {heads, tails};
            tosses s = {1 + 0.5 * (heads % 3), heads, tails};
            coin c;
            sg_error err = SG_ERROR_INIT;
            sg_energy_opts opts = SG_ENERGY_OPTS_INIT;
            sg_energy_parts parts;
            make_coin(&c, 2);
            opts.alpha = s.alpha;
            ck_ok(sg_energy_of_form(&opts, &c.form, counts, &parts, &err));
            gsl_function f = {likelihood_times_prior, &s};
            gsl_integration_workspace *w = gsl_integration_workspace_alloc(200);
            double integral, error;
            ck_assert_int_eq(gsl_integration_qags(&f, 0, 1, 0, 1e-10, 200, w, &integral, &error), 0);
            gsl_integration_workspace_free(w);
            ck_assert_double_eq_tol(parts.log_likelihood, log(integral), 1e-8);
            ck_assert_double_eq(parts.log_parameter_prior, 0);
        }
    }
}
END_TEST

/* S -> X X side by side; X -> T over T (0.5) | T (0.5); T -> t. */
static double inside_of_mismatch(size_t width, size_t height)
{
    static const char *const symbols[] = {"S", "X", "T"}, *const terminals[] = {"t"};
    static const uint32_t colors[] = {0}, pair_of_x[] = {1, 1}, pair_of_t[] = {2, 2}, t[] = {0}, one_t[] = {2};
    const sg_split_rule rules[] = {
        {.lhs = 0, .op = SG_SPLIT_X, .n = 2, .rhs = pair_of_x, .probability = 1, .source = SG_NONE},
        {.lhs = 1, .op = SG_SPLIT_Y, .n = 2, .rhs = pair_of_t, .probability = 0.5, .source = SG_NONE},
        {.lhs = 1, .op = SG_SPLIT_Y, .n = 1, .rhs = one_t, .probability = 0.5, .source = SG_NONE},
        {.lhs = 2, .op = SG_SPLIT_LEXICAL, .n = 1, .rhs = t, .probability = 1, .source = SG_NONE},
    };
    const sg_split_form form = {.name = "mismatch", .nsymbols = 3, .symbol_names = symbols, .nterminals = 1,
                                .terminal_names = terminals, .terminal_colors = colors, .axiom = 0, .nrules = 4,
                                .rules = rules};
    const uint16_t labels[16] = {0};
    const sg_cells cells = {width, height, labels, NULL};
    sg_error err = SG_ERROR_INIT;
    sg_parse_table *table = NULL;
    sg_chart *chart = NULL;
    double log_inside = NAN;
    ck_ok(sg_parse_table_create(&form, SG_CELL_MODE, &table, &err));
    ck_ok(sg_chart_create(&chart, &err));
    ck_ok(sg_earley_inside(table, &cells, chart, &log_inside, &err));
    sg_chart_free(chart);
    sg_parse_table_free(table);
    return exp(log_inside);
}

START_TEST(mass_is_lost_where_rows_do_not_fit)
{
    double mass = 0;
    for (size_t width = 1; width <= 4; width++)
        for (size_t height = 1; height <= 4; height++)
            mass += inside_of_mismatch(width, height);
    ck_assert_double_eq_tol(inside_of_mismatch(2, 1), 0.25, 1e-14);
    ck_assert_double_eq_tol(inside_of_mismatch(2, 2), 0.25, 1e-14);
    ck_assert_double_eq_tol(mass, 0.5, 1e-14);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("errata");
    TCase *tc = tcase_create("errata");
    tcase_add_test(tc, the_parameter_prior_is_a_density);
    tcase_add_test(tc, the_marginal_term_is_the_integral);
    tcase_add_test(tc, mass_is_lost_where_rows_do_not_fit);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
