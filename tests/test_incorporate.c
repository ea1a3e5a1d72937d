/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_incorporate.c - lattices to the initial grammar, and the merged grammar to the finished one. */
#include "core/file.h"
#include "core/random.h"
#include "learn/compatible.h"
#include "learn/finish.h"
#include "learn/incorporate.h"
#include "learn/report.h"
#include "tests/support.h"

#include <gsl/gsl_linalg.h>
#include <gsl/gsl_randist.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

/* Floor of windows over a floor of balconies, sky above: rows 1 and 2 correspond one to one. */
static const char small[] = "lattice 5 4\n"
                            "x 0 10 30 40 60 100\n"
                            "y 0 20 50 60 100\n"
                            "sky sky sky sky sky\n"
                            "wall window wall window wall\n"
                            "wall balcony wall balcony wall\n"
                            "shop shop shop shop shop\n";

static sg_error err = SG_ERROR_INIT;
static sg_arena *arena;
static const sg_density_opts own = SG_DENSITY_OPTS_INIT;
static const sg_incorporate_opts pairs = {SG_SHARE_EQUAL, SG_REGROUP_PAIRS, 0, NULL, NULL};

static void setup(void)
{
    arena = sg_arena_create();
}

static void teardown(void)
{
    sg_arena_free(arena);
}

static sg_split_form incorporate(const char *const *text, size_t n, sg_incorporate_opts opts, double **counts)
{
    sg_lattice lattices[8];
    for (size_t i = 0; i < n; i++)
        ck_ok(sg_lattice_parse("text", text[i], strlen(text[i]), arena, &lattices[i], &err));
    sg_split_form f;
    ck_ok(sg_incorporate(lattices, n, &opts, arena, &f, counts, &err));
    return f;
}

/* "lhs op rhs..." of a rule. */
static const char *rule_text(const sg_split_form *f, size_t i)
{
    static char text[512];
    static const char *const op[] = {"x", "y", "="};
    const sg_split_rule *r = &f->rules[i];
    int n = snprintf(text, sizeof text, "%s %s", f->symbol_names[r->lhs], op[r->op]);
    for (uint32_t k = 0; k < r->n; k++)
        n += snprintf(text + n, sizeof text - (size_t)n, " %s",
                      r->op == SG_SPLIT_LEXICAL ? f->terminal_names[r->rhs[k]] : f->symbol_names[r->rhs[k]]);
    return text;
}

static size_t find_rule(const sg_split_form *f, const char *text)
{
    for (size_t i = 0; i < f->nrules; i++)
        if (strcmp(rule_text(f, i), text) == 0)
            return i;
    ck_abort_msg("no rule '%s'", text);
}

static size_t count_rules(const sg_split_form *f, sg_split_op op)
{
    size_t n = 0;
    for (size_t i = 0; i < f->nrules; i++)
        n += f->rules[i].op == op;
    return n;
}

START_TEST(rows_that_correspond_become_columns)
{
    double *counts;
    const sg_split_form f = incorporate((const char *[]){small}, 1, pairs, &counts);
    ck_assert_uint_eq(f.nterminals, 5);
    const size_t s = find_rule(&f, "S y R1 R2 R3");
    const double heights[] = {0.2, 0.4, 0.4};
    for (int i = 0; i < 3; i++)
        ck_assert_double_eq_tol(f.rules[s].attributes[i], heights[i], 1e-15);
    const size_t floor = find_rule(&f, "R2 x C1 C2 C1 C2 C1");
    ck_assert_double_eq_tol(f.rules[floor].attributes[4], 0.4, 1e-15);
    const size_t column = find_rule(&f, "C2 y window balcony");
    ck_assert_double_eq(counts[column], 2);
    ck_assert_uint_eq(f.rules[column].nattributes, 2);
    ck_assert_double_eq_tol(f.rules[column].attributes[2], 0.75, 1e-15);
    ck_assert_double_eq(counts[find_rule(&f, "C1 y wall wall")], 3);
    ck_assert_double_eq(counts[find_rule(&f, "wall = wall")], 6);
    ck_assert_uint_eq(f.nsymbols, 1 + 5 + 3 + 2);
}
END_TEST

START_TEST(without_regrouping_each_row_is_a_rule)
{
    double *counts;
    const sg_split_form f =
        incorporate((const char *[]){small, small}, 2, (sg_incorporate_opts){.share = SG_SHARE_EQUAL}, &counts);
    ck_assert_uint_eq(count_rules(&f, SG_SPLIT_X), 4);
    ck_assert_uint_eq(count_rules(&f, SG_SPLIT_Y), 1); /* the two lattices are equal */
    ck_assert_double_eq(counts[find_rule(&f, "S y R1 R2 R3 R4")], 2);
    ck_assert_double_eq(counts[find_rule(&f, "R1 x sky sky sky sky sky")], 2);
}
END_TEST

START_TEST(without_sharing_each_row_has_its_symbol)
{
    double *counts;
    const sg_split_form f =
        incorporate((const char *[]){small, small}, 2, (sg_incorporate_opts){.share = SG_SHARE_NONE}, &counts);
    ck_assert_uint_eq(count_rules(&f, SG_SPLIT_X), 8);
    ck_assert_uint_eq(count_rules(&f, SG_SPLIT_Y), 2);
    ck_assert_uint_eq(f.nsymbols, 1 + 5 + 8);
    ck_assert_double_eq(f.rules[find_rule(&f, "S y R1 R2 R3 R4")].probability, 0.5);
}
END_TEST

START_TEST(collapsed_sharing_keeps_the_rules_apart)
{
    double *counts;
    const char *const text[] = {"lattice 3 1\nsky sky wall\n", "lattice 4 1\nsky sky sky wall\n"};
    const sg_split_form f = incorporate(text, 2, (sg_incorporate_opts){.share = SG_SHARE_COLLAPSED}, &counts);
    ck_assert_uint_eq(f.nsymbols, 1 + 2 + 1);
    ck_assert_double_eq(f.rules[find_rule(&f, "R1 x sky sky wall")].probability, 0.5);
    ck_assert_double_eq(f.rules[find_rule(&f, "R1 x sky sky sky wall")].probability, 0.5);
    ck_assert_double_eq(counts[find_rule(&f, "S y R1")], 2);
}
END_TEST

START_TEST(frequent_pairs_are_formed_first)
{
    /* balcony over window alone comes once, window over balcony twice: the middle rows go with their own balconies. */
    const char *const text[] = {"lattice 2 4\nwall window\nwall balcony\nwall window\nwall balcony\n"};
    double *counts;
    const sg_split_form f = incorporate(text, 1, pairs, &counts);
    ck_assert_double_eq(counts[find_rule(&f, "C2 y window balcony")], 2);
    find_rule(&f, "S y R1 R1");
}
END_TEST

/* Three storeys with courses of wall between them are one band of two kinds of columns; the shop's columns are others. */
START_TEST(storeys_become_one_band)
{
    const char *const text[] = {"lattice 7 8\n"
                                "sky sky sky sky sky sky sky\n"
                                "wall window wall window wall window wall\n"
                                "wall balcony wall balcony wall balcony wall\n"
                                "wall wall wall wall wall wall wall\n"
                                "wall window wall window wall window wall\n"
                                "wall balcony wall balcony wall balcony wall\n"
                                "wall wall wall wall wall wall wall\n"
                                "shop shop shop shop door shop shop\n"};
    double *counts;
    const sg_split_form f =
        incorporate(text, 1, (sg_incorporate_opts){SG_SHARE_EQUAL, SG_REGROUP_FLOORS, 0, NULL, NULL}, &counts);
    sg_split_form g;
    ck_ok(sg_finish(&f, &own, arena, &g, &err));
    find_rule(&g, "S y R1 R2 R3");
    find_rule(&g, "R2 x C1 C2 C1 C2 C1 C2 C1");
    find_rule(&g, "C2 y window balcony wall window balcony wall");
}
END_TEST

START_TEST(labels_follow_the_given_table)
{
    const char *const names[] = {"shop", "unused", "sky", "window", "wall", "balcony"};
    const uint32_t colors[] = {1, 2, 3, 4, 5, 6};
    double *counts;
    const sg_incorporate_opts opts = {SG_SHARE_EQUAL, SG_REGROUP_PAIRS, 6, names, colors};
    const sg_split_form f = incorporate((const char *[]){small}, 1, opts, &counts);
    ck_assert_uint_eq(f.nterminals, 5);
    ck_assert_str_eq(f.terminal_names[1], "sky");
    ck_assert_uint_eq(f.terminal_colors[1], 3);
    sg_lattice l;
    const char other[] = "lattice 1 1\ntree\n";
    ck_ok(sg_lattice_parse("text", other, strlen(other), arena, &l, &err));
    sg_split_form g;
    ck_assert_int_eq(sg_incorporate(&l, 1, &opts, arena, &g, &counts, &err), SG_EINPUT);
    ck_assert_ptr_nonnull(strstr(err.msg, "tree"));
    ck_assert_int_eq(sg_incorporate(&l, 0, &opts, arena, &g, &counts, &err), SG_EINVAL);
}
END_TEST

START_TEST(finishing_collapses_what_one_region_can_stand_for)
{
    double *counts;
    const char *const text[] = {"lattice 6 3\nx 0 10 20 40 60 70 100\ny 0 10 20 40\n"
                                "sky sky sky sky sky sky\n"
                                "wall wall window window wall window\n"
                                "wall wall balcony balcony wall balcony\n"};
    const sg_split_form f = incorporate(text, 1, pairs, &counts);
    sg_split_form g;
    ck_ok(sg_finish(&f, &own, arena, &g, &err));
    find_rule(&g, "R1 x sky");
    const size_t floor = find_rule(&g, "R2 x C1 C2 C1 C2");
    const double widths[] = {0.2, 0.4, 0.1, 0.3};
    for (int i = 0; i < 4; i++) {
        ck_assert_double_eq_tol(g.rules[floor].attributes[i], widths[i], 1e-15);
        ck_assert_double_eq_tol(g.rules[floor].mean[i], widths[i], 1e-15);
    }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            ck_assert_double_eq_tol(g.rules[floor].covariance[i * 3 + j], i == j ? 1e-4 : 0, 1e-15);
}
END_TEST

/* Two storeys of one symbol stay two storeys; X -> X X over one label goes, and what is left is normalised. */
START_TEST(finishing_keeps_storeys_and_drops_self_rules)
{
    const char *const names[] = {"S", "F", "wall", "window", "C"};
    const char *const labels[] = {"wall", "window"};
    const uint32_t colors[] = {0, 0};
    const uint32_t ff[] = {1, 1}, ww[] = {2, 2}, wc[] = {2, 4}, nw[] = {3, 2}, t0[] = {0}, t1[] = {1};
    const double halves[] = {0.5, 0.5};
    const sg_split_rule rules[] = {
        {0, SG_SPLIT_Y, 2, ff, 1.0, 1, halves, NULL, NULL, SG_NONE},
        {1, SG_SPLIT_X, 2, wc, 1.0, 1, halves, NULL, NULL, SG_NONE},
        {2, SG_SPLIT_X, 2, ww, 0.25, 1, halves, NULL, NULL, SG_NONE},
        {2, SG_SPLIT_LEXICAL, 1, t0, 0.75, 0, NULL, NULL, NULL, SG_NONE},
        {3, SG_SPLIT_LEXICAL, 1, t1, 1.0, 0, NULL, NULL, NULL, SG_NONE},
        {4, SG_SPLIT_Y, 2, nw, 1.0, 1, halves, NULL, NULL, SG_NONE},
    };
    const sg_split_form f = {.name = "m", .nsymbols = 5, .symbol_names = names, .nterminals = 2,
                             .terminal_names = labels, .terminal_colors = colors, .nrules = 6, .rules = rules};
    sg_split_form g;
    ck_ok(sg_finish(&f, &own, arena, &g, &err));
    find_rule(&g, "S y F F");
    ck_assert_uint_eq(g.nrules, 5);
    ck_assert_double_eq(g.rules[find_rule(&g, "wall = wall")].probability, 1.0);
}
END_TEST

/* DESIGN 5.2 written out again with m = 2, and positive definite for any number of uses. */
START_TEST(fitted_sizes_are_shrunk_and_proper)
{
    const double two[] = {0.2, 0.3, 0.5, 0.4, 0.3, 0.3};
    double mean[3], c[4];
    sg_fit_sizes(two, 2, 3, 0, mean, c);
    ck_assert_double_eq_tol(mean[0], 0.3, 1e-15);
    ck_assert_double_eq_tol(c[0], 0.01, 1e-15); /* (2 * 0.01 + 4 * 0.01) / 6 */
    ck_assert_double_eq_tol(c[3], 1e-4, 1e-15); /* never varied: the floor */
    ck_assert_double_eq_tol(c[1], 0, 1e-15);
    const double four[] = {0.1, 0.1, 0.8, 0.3, 0.3, 0.4, 0.1, 0.1, 0.8, 0.3, 0.3, 0.4};
    for (size_t m = 1; m <= 4; m++) {
        sg_fit_sizes(four, m, 3, 0, mean, c);
        const double s = m == 1 ? 0 : m == 3 ? 0.02 * 4 / 9 : 0.01;
        ck_assert_double_eq_tol(c[0], fmax(s, 1e-4), 1e-12);
        ck_assert_double_eq_tol(c[1], (double)m * s / ((double)m + 4), 1e-12);
        gsl_matrix_view v = gsl_matrix_view_array(c, 2, 2);
        ck_assert_int_eq(gsl_linalg_cholesky_decomp1(&v.matrix), 0);
    }
}
END_TEST

/* One example varies as the Dirichlet does; with many, their own covariance wins. */
START_TEST(sizes_shrink_towards_a_dirichlet)
{
    const double one[] = {0.2, 0.3, 0.5}, concentration = 24;
    double mean[3], c[4], many[3 * 4000];
    sg_fit_sizes(one, 1, 3, concentration, mean, c);
    const double by = 4 / 5.0 / 25; /* nu0 / (m + nu0) / (c + 1) */
    ck_assert_double_eq_tol(c[0], by * 0.2 * 0.8, 1e-15);
    ck_assert_double_eq_tol(c[3], by * 0.3 * 0.7, 1e-15);
    ck_assert_double_eq_tol(c[1], -by * 0.2 * 0.3, 1e-15);
    ck_assert_double_eq(c[1], c[2]);
    for (size_t i = 0; i < 4000; i++)
        for (size_t j = 0; j < 3; j++)
            many[3 * i + j] = one[j] + (i % 2 == 0 ? 0.01 : -0.01) * ((double)j - 1);
    sg_fit_sizes(many, 4000, 3, concentration, mean, c);
    ck_assert_double_eq_tol(c[0], 1e-4, 1e-5);
    gsl_matrix_view v = gsl_matrix_view_array(c, 2, 2);
    ck_assert_int_eq(gsl_linalg_cholesky_decomp1(&v.matrix), 0);
}
END_TEST

/* Rules of other means and lengths share the concentration that their sizes were drawn with. */
START_TEST(the_pooled_concentration_is_that_of_the_draws)
{
    enum { RULES = 200, USES = 5 };
    const double concentration = 30;
    static double sizes[RULES][USES * 4];
    static sg_split_rule rules[RULES];
    gsl_rng *rng = sg_random_create(1);
    ck_assert_ptr_nonnull(rng);
    for (size_t r = 0; r < RULES; r++) {
        const uint32_t n = 2 + (uint32_t)(r % 3);
        double alpha[4], total = 0;
        for (uint32_t i = 0; i < n; i++)
            total += alpha[i] = 0.2 + gsl_rng_uniform(rng);
        for (uint32_t i = 0; i < n; i++)
            alpha[i] *= concentration / total;
        const size_t uses = 1 + r % USES;
        for (size_t k = 0; k < uses; k++)
            gsl_ran_dirichlet(rng, n, alpha, sizes[r] + k * n);
        rules[r] = (sg_split_rule){.op = SG_SPLIT_X, .n = n, .nattributes = uses, .attributes = sizes[r]};
    }
    gsl_rng_free(rng);
    const sg_split_form f = {.nrules = RULES, .rules = rules};
    ck_assert_double_eq_tol(sg_pooled_concentration(&f, SG_SPLIT_X), concentration, 0.15 * concentration);
    ck_assert_double_eq(sg_pooled_concentration(&f, SG_SPLIT_Y), 0);
}
END_TEST

/* The page and the picture are there, hold each symbol, and escape what could break them. */
START_TEST(a_report_shows_the_grammar)
{
    double *counts;
    const sg_split_form f = incorporate((const char *[]){small}, 1, pairs, &counts);
    sg_split_form g;
    ck_ok(sg_finish(&f, &own, arena, &g, &err));
    char folder[] = "/tmp/sg_test_report_XXXXXX", path[256];
    ck_assert_ptr_nonnull(mkdtemp(folder));
    const sg_report_step steps[] = {{"initial <grammar>", 10, 11, 3, 1, 5}, {"merge a b", 8.5, 10, 3, 1, 5}};
    const sg_report_line lines[] = {{"weight", "0.3"}};
    const sg_report_picture picture = {"a.png", "A & B"};
    const sg_report r = {"Test", lines, 1, lines, 1, steps, 2, &f, &f, &g, &picture, 1, &picture, 1};
    ck_ok(sg_report_write(folder, &r, &err));
    char *page, *svg;
    size_t length;
    snprintf(path, sizeof path, "%s/index.html", folder);
    ck_ok(sg_file_read(path, 1 << 24, arena, &page, &length, &err));
    ck_assert_ptr_nonnull(strstr(page, "initial &lt;grammar&gt;"));
    ck_assert_ptr_nonnull(strstr(page, "A &amp; B"));
    ck_assert_ptr_nonnull(strstr(page, "-1.50"));
    unlink(path);
    snprintf(path, sizeof path, "%s/grammar.svg", folder);
    ck_ok(sg_file_read(path, 1 << 24, arena, &svg, &length, &err));
    for (size_t x = 0; x < g.nsymbols; x++)
        ck_assert_ptr_nonnull(strstr(svg, g.symbol_names[x]));
    ck_assert_ptr_null(strstr(svg, "nan"));
    unlink(path);
    ck_assert_int_eq(rmdir(folder), 0);
    ck_assert_int_eq(sg_report_write("/no/such/folder", &r, &err), SG_EIO);
}
END_TEST

/* R -> split-x wall window over the whole width; C -> split-y, D -> split-y of the same labels, D a tenth as high. */
START_TEST(compatible_means_labels_then_kinds_then_sizes)
{
    const char *const names[] = {"S", "R", "C", "D", "wall", "window"};
    const char *const labels[] = {"wall", "window"};
    const uint32_t colors[] = {0, 0};
    const uint32_t s1[] = {1, 2, 3}, pair[] = {4, 5}, t0[] = {0}, t1[] = {1};
    const double heights[] = {0.5, 0.45, 0.05}, halves[] = {0.5, 0.5}, counts[] = {1, 1, 1, 1, 3, 3};
    const sg_split_rule rules[] = {
        {0, SG_SPLIT_Y, 3, s1, 1.0, 1, heights, NULL, NULL, SG_NONE},
        {1, SG_SPLIT_X, 2, pair, 1.0, 1, halves, NULL, NULL, SG_NONE},
        {2, SG_SPLIT_Y, 2, pair, 1.0, 1, halves, NULL, NULL, SG_NONE},
        {3, SG_SPLIT_Y, 2, pair, 1.0, 1, halves, NULL, NULL, SG_NONE},
        {4, SG_SPLIT_LEXICAL, 1, t0, 1.0, 0, NULL, NULL, NULL, SG_NONE},
        {5, SG_SPLIT_LEXICAL, 1, t1, 1.0, 0, NULL, NULL, NULL, SG_NONE},
    };
    const sg_split_form f = {.name = "m", .nsymbols = 6, .symbol_names = names, .nterminals = 2,
                             .terminal_names = labels, .terminal_colors = colors, .nrules = 6, .rules = rules};
    const sg_energy_opts energy = SG_ENERGY_OPTS_INIT;
    const bool want[3][2] = {{true, true}, {false, true}, {false, false}}; /* R with C, C with D */
    for (int what = SG_COMPATIBLE_LABELS; what <= SG_COMPATIBLE_SIZES; what++) {
        sg_rules r = {0};
        ck_ok(sg_rules_create(&r, &f, counts, &energy, arena, &err));
        ck_ok(sg_rules_restrict(&r, (sg_compatible)what, &f, counts, &err));
        ck_assert_int_eq(sg_rules_compatible(&r, 1, 2), want[what][0]);
        ck_assert_int_eq(sg_rules_compatible(&r, 2, 3), want[what][1]);
        ck_assert(!sg_rules_compatible(&r, 0, 1));
        ck_assert(!sg_rules_compatible(&r, 4, 5));
        sg_rules_clear(&r);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("incorporate");
    TCase *tc = tcase_create("incorporate");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_test(tc, rows_that_correspond_become_columns);
    tcase_add_test(tc, without_regrouping_each_row_is_a_rule);
    tcase_add_test(tc, without_sharing_each_row_has_its_symbol);
    tcase_add_test(tc, collapsed_sharing_keeps_the_rules_apart);
    tcase_add_test(tc, frequent_pairs_are_formed_first);
    tcase_add_test(tc, storeys_become_one_band);
    tcase_add_test(tc, labels_follow_the_given_table);
    tcase_add_test(tc, finishing_collapses_what_one_region_can_stand_for);
    tcase_add_test(tc, finishing_keeps_storeys_and_drops_self_rules);
    tcase_add_test(tc, fitted_sizes_are_shrunk_and_proper);
    tcase_add_test(tc, sizes_shrink_towards_a_dirichlet);
    tcase_add_test(tc, the_pooled_concentration_is_that_of_the_draws);
    tcase_add_test(tc, a_report_shows_the_grammar);
    tcase_add_test(tc, compatible_means_labels_then_kinds_then_sizes);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
