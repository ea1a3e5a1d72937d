/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_exact_parse.c - exact parsing of costs per pixel: planted derivations, brute force on tiny images, bad input. */
#include "parse/exact_parse.h"
#include "scene/label_scene.h"
#include "tests/earley_oracle.h"
#include "tests/support.h"

#include <math.h>
#include <string.h>

enum { WIDTH = 80, HEIGHT = 60, CLASSES = 4 };

static const char house[] = "label wall\nlabel window\nlabel sky\nlabel door\n"
                            "start House\n"
                            "rule House\n"
                            "  -> 0.4 : split y { Ground | Floor | sky }\n"
                            "             sizes mean (0.4, 0.4, 0.2) sd (0.1, 0.1, 0.1)\n"
                            "  -> 0.6 : split y { Ground | Floor | Floor | sky }\n"
                            "             sizes mean (0.3, 0.3, 0.2, 0.2) sd (0.1, 0.1, 0.1, 0.1)\n"
                            "rule Ground\n"
                            "  -> split x { wall | door | wall } sizes mean (0.4, 0.2, 0.4) sd (0.2, 0.1, 0.2)\n"
                            "rule Floor\n"
                            "  -> 0.5 : split x { wall | Bay | wall } sizes mean (0.3, 0.4, 0.3) sd (0.1, 0.1, 0.1)\n"
                            "  -> 0.5 : split x { wall | Bay | wall | Bay | wall }\n"
                            "             sizes mean (0.2, 0.2, 0.2, 0.2, 0.2) sd (0.05, 0.05, 0.05, 0.05, 0.05)\n"
                            "rule Bay\n"
                            "  -> split y { wall | window | wall } sizes mean (0.2, 0.6, 0.2) sd (0.1, 0.1, 0.1)\n";

typedef struct {
    sg_grammar *g;
    gsl_rng *rng;
    sg_derivation planted;
    sg_label_map map;
    sg_float_map costs;
    uint32_t channel[64];
    uint8_t value_of[64];
    sg_exact_result result;
} fixture;

static fixture f;
static sg_error err;

/* Labels have their channels in the reverse order, so that nothing is right by chance. */
static void open_grammar(const char *text)
{
    ck_ok(sg_grammar_parse(text, strlen(text), "test", &f.g, &err));
    uint32_t next = CLASSES;
    for (sg_sym s = 0; s < sg_grammar_symbol_count(f.g); s++) {
        const bool label = sg_grammar_symbol(f.g, s)->kind == SG_SYMBOL_LABEL;
        f.channel[s] = label ? --next : UINT32_MAX;
        f.value_of[s] = label ? (uint8_t)next : 0;
    }
}

static void set_up(void)
{
    f = (fixture){.rng = sg_random_create(1)};
    ck_ok(sg_label_map_create(WIDTH, HEIGHT, &f.map, &err));
    ck_ok(sg_float_map_create(CLASSES, HEIGHT, WIDTH, &f.costs, &err));
}

static void tear_down(void)
{
    sg_exact_result_clear(&f.result);
    sg_derivation_clear(&f.planted);
    sg_label_map_clear(&f.map);
    sg_float_map_clear(&f.costs);
    sg_grammar_free(f.g);
    gsl_rng_free(f.rng);
}

static void raster(const sg_derivation *d, sg_label_map *map)
{
    sg_label_scene scene = {0};
    ck_ok(sg_label_scene_interpret(&scene, d, WIDTH, HEIGHT, &err));
    sg_label_scene_raster(&scene, f.value_of, map);
    sg_label_scene_clear(&scene);
}

/* On a lattice every part has a pixel at least. */
static bool every_part_shows(void)
{
    sg_label_scene scene = {0};
    bool good = true;
    ck_ok(sg_label_scene_interpret(&scene, &f.planted, WIDTH, HEIGHT, &err));
    for (size_t i = 0; i < scene.nrects; i++)
        good = good && scene.rects[i].x1 - scene.rects[i].x0 > 2 && scene.rects[i].y1 - scene.rects[i].y0 > 2;
    sg_label_scene_clear(&scene);
    return good;
}

/* A derivation of the prior as costs: its labels cheap, others dear; a share of the pixels is mistaken. */
static void plant(uint64_t seed, double mistakes)
{
    sg_random_stream(f.rng, seed, 0, 0);
    sg_derivation_init(&f.planted, f.g);
    do
        ck_ok(sg_derivation_sample(&f.planted, f.rng, 1000, &err));
    while (!every_part_shows());
    raster(&f.planted, &f.map);
    for (size_t i = 0; i < WIDTH * HEIGHT; i++) {
        const bool mistaken = sg_random_uniform(f.rng) < mistakes;
        const uint32_t label = mistaken ? oracle_below(f.rng, CLASSES) : f.map.labels[i];
        for (uint32_t c = 0; c < CLASSES; c++)
            f.costs.values[c * WIDTH * HEIGHT + i] = c == label ? 0.006F : 6.2F;
    }
}

static double cost_of(const sg_derivation *d, double weight)
{
    sg_label_map map;
    ck_ok(sg_label_map_create(WIDTH, HEIGHT, &map, &err));
    raster(d, &map);
    double sum = 0;
    for (size_t i = 0; i < WIDTH * HEIGHT; i++)
        sum += weight * f.costs.values[map.labels[i] * WIDTH * HEIGHT + i];
    sg_label_map_clear(&map);
    return sum;
}

static double rules_of(const sg_derivation *d)
{
    double log_prior;
    ck_ok(sg_derivation_log_prior(d, &log_prior, &err));
    return -log_prior;
}

static size_t different_pixels(const sg_derivation *d)
{
    sg_label_map map;
    ck_ok(sg_label_map_create(WIDTH, HEIGHT, &map, &err));
    raster(d, &map);
    size_t n = 0;
    for (size_t i = 0; i < WIDTH * HEIGHT; i++)
        n += map.labels[i] != f.map.labels[i];
    sg_label_map_clear(&map);
    return n;
}

/* Its parts agree with what derivation, raster and grammar say. */
static void check_result(double weight)
{
    double log_density;
    ck_ok(sg_derivation_check(&f.result.derivation, &err));
    ck_ok(sg_derivation_log_density(&f.result.derivation, &log_density, &err));
    ck_assert_double_eq_tol(f.result.energy_attribute, -log_density, 1e-9);
    ck_assert_double_eq_tol(f.result.energy_rule, rules_of(&f.result.derivation), 1e-9);
    const double image = cost_of(&f.result.derivation, weight);
    ck_assert_double_eq_tol(f.result.energy_image, image, 1e-6 * (1 + image));
}

START_TEST(planted_derivations_are_found)
{
    open_grammar(house);
    plant((uint64_t)_i, 0);
    sg_exact_opts opts = SG_EXACT_OPTS_INIT;
    opts.refine = false;
    ck_ok(sg_exact_parse(f.g, &f.costs, f.channel, &opts, &f.result, &err));
    check_result(1);
    const double planted = cost_of(&f.planted, 1) + rules_of(&f.planted);
    ck_assert_msg(f.result.energy_lattice <= planted + 1e-3, "%g, planted %g", f.result.energy_lattice, planted);
    ck_assert_uint_eq(different_pixels(&f.result.derivation), 0);
    ck_assert_double_eq_tol(f.result.energy_image + f.result.energy_rule, f.result.energy_lattice, 1e-3);
}
END_TEST

/* With noise the lattice is no longer known, and weak costs leave rules and sizes a say. */
START_TEST(parts_of_the_energy_agree_with_the_raster)
{
    open_grammar(house);
    plant((uint64_t)_i, 0.3);
    sg_exact_opts opts = SG_EXACT_OPTS_INIT;
    opts.weight = 0.02 * (_i + 1);
    opts.max_cells = 60;
    ck_ok(sg_exact_parse(f.g, &f.costs, f.channel, &opts, &f.result, &err));
    check_result(opts.weight);
    ck_assert_uint_le(f.result.columns * f.result.rows, 60);
}
END_TEST

/* Wide size models for all splits, so that no size is out of reach. */
static void give_sizes(oracle_grammar *g, double *mean, double (*covariance)[ORACLE_RHS * ORACLE_RHS])
{
    for (size_t r = 0; r < g->form.nrules; r++) {
        const uint32_t n = g->rules[r].n;
        if (g->rules[r].op == SG_SPLIT_LEXICAL || n < 2)
            continue;
        for (uint32_t i = 0; i < n; i++)
            mean[r * ORACLE_RHS + i] = 1.0 / n;
        for (uint32_t i = 0; i < n - 1; i++)
            for (uint32_t j = 0; j < n - 1; j++)
                covariance[r][i * (n - 1) + j] = i == j;
        g->rules[r].mean = mean + r * ORACLE_RHS;
        g->rules[r].covariance = covariance[r];
    }
}

static sg_status tiny_case(uint64_t seed, oracle_grammar *g, oracle_cells *c)
{
    static double mean[ORACLE_RULES * ORACLE_RHS], covariance[ORACLE_RULES][ORACLE_RHS * ORACLE_RHS];
    static const uint32_t colors[ORACLE_TERMINALS];
    sg_random_stream(f.rng, seed, 1, 0);
    oracle_random_grammar(g, f.rng);
    give_sizes(g, mean, covariance);
    g->form.terminal_colors = colors;
    SG_TRY(sg_grammar_from_split(&g->form, &f.g, &err)); /* fails where a symbol derives nothing */
    const size_t width = 2 + oracle_below(f.rng, 4), height = 2 + oracle_below(f.rng, 4), n = width * height;
    ck_ok(sg_float_map_create(g->form.nterminals, height, width, &f.costs, &err));
    for (size_t i = 0; i < g->form.nterminals * n; i++)
        c->costs[i] = f.costs.values[i] = (float)(5 * sg_random_uniform(f.rng));
    c->cells = (sg_cells){width, height, NULL, c->costs};
    for (uint32_t t = 0; t < g->form.nterminals; t++)
        f.channel[sg_grammar_find(f.g, g->form.terminal_names[t])] = t;
    return SG_OK;
}

/* @return true when every pixel line was a line of the lattice, so that the best of all derivations is known */
static bool compare_with_oracle(const oracle_grammar *g, const oracle_cells *c)
{
    const sg_exact_opts opts = {1, c->cells.width * c->cells.height, false, 1};
    double p[ORACLE_RULES];
    oracle_probabilities(g, p);
    const double best = oracle_parse(g, &c->cells, SG_REGION_MODE, true, p);
    const sg_status st = sg_exact_parse(f.g, &f.costs, f.channel, &opts, &f.result, &err);
    if (best == -INFINITY) {
        ck_assert_int_eq(st, SG_ENOPARSE);
        ck_assert_uint_eq(f.result.derivation.nnodes, 0);
        return false;
    }
    ck_assert_msg(st == SG_OK, "%s", err.msg);
    ck_ok(sg_derivation_check(&f.result.derivation, &err));
    ck_assert_double_ge(f.result.energy_lattice, -best - 1e-4);
    ck_assert_double_eq_tol(f.result.energy_image + f.result.energy_rule, f.result.energy_lattice, 1e-4);
    if (f.result.columns != c->cells.width || f.result.rows != c->cells.height)
        return false;
    ck_assert_double_eq_tol(f.result.energy_lattice, -best, 1e-4);
    return true;
}

START_TEST(tiny_images_agree_with_brute_force)
{
    size_t compared = 0;
    for (uint64_t seed = 0; seed < 300; seed++) {
        oracle_grammar g;
        oracle_cells c;
        sg_float_map_clear(&f.costs);
        if (tiny_case(seed, &g, &c) == SG_OK)
            compared += compare_with_oracle(&g, &c);
        sg_exact_result_clear(&f.result);
        sg_grammar_free(f.g);
        f.g = NULL;
    }
    ck_assert_uint_ge(compared, 50);
}
END_TEST

START_TEST(tied_siblings_share_one_derivation)
{
    char tied[sizeof house + 8];
    snprintf(tied, sizeof tied, "tied\n%s", house);
    open_grammar(tied);
    plant((uint64_t)_i, 0);
    sg_exact_opts opts = SG_EXACT_OPTS_INIT;
    opts.refine = false;
    ck_ok(sg_exact_parse(f.g, &f.costs, f.channel, &opts, &f.result, &err));
    check_result(1);
    ck_assert_double_le(f.result.energy_lattice, cost_of(&f.planted, 1) + rules_of(&f.planted) + 30);
}
END_TEST

START_TEST(costs_that_say_nothing_still_have_a_parse)
{
    open_grammar(house);
    for (size_t i = 0; i < CLASSES * WIDTH * HEIGHT; i++)
        f.costs.values[i] = 1;
    const sg_exact_opts opts = SG_EXACT_OPTS_INIT;
    ck_ok(sg_exact_parse(f.g, &f.costs, f.channel, &opts, &f.result, &err));
    check_result(1);
    ck_assert_double_eq_tol(f.result.energy_image, WIDTH * HEIGHT, 1e-3);
}
END_TEST

static double energy_of(const sg_derivation *d, double weight)
{
    double log_density;
    ck_ok(sg_derivation_log_density(d, &log_density, &err));
    return cost_of(d, weight) + rules_of(d) - log_density;
}

/* Sizes count, and ties: what comes out is about as good as what the costs were made from, or better. */
START_TEST(refining_lowers_the_energy)
{
    char text[sizeof house + 8];
    snprintf(text, sizeof text, "%s%s", _i % 2 == 0 ? "tied\n" : "", house);
    open_grammar(text);
    plant((uint64_t)_i, 0.4);
    sg_exact_opts opts = SG_EXACT_OPTS_INIT;
    opts.weight = 0.03;
    opts.max_cells = 300;
    opts.refine = false;
    ck_ok(sg_exact_parse(f.g, &f.costs, f.channel, &opts, &f.result, &err));
    const double rough = energy_of(&f.result.derivation, opts.weight);
    sg_exact_result_clear(&f.result);
    opts.refine = true;
    opts.step_px = 2;
    ck_ok(sg_exact_parse(f.g, &f.costs, f.channel, &opts, &f.result, &err));
    check_result(opts.weight);
    const double fine = energy_of(&f.result.derivation, opts.weight);
    ck_assert_msg(fine <= rough + 1e-6, "%g before, %g after", rough, fine);
    ck_assert_double_le(fine, 1.1 * energy_of(&f.planted, opts.weight));
}
END_TEST

static const char strips[] = "label wall\nlabel window\nlabel sky\n"
                             "tied\n"
                             "start House\n"
                             "rule House -> split y { Floor | sky | Floor }\n"
                             "  sizes mean (0.4, 0.2, 0.4) sd (0.08, 0.05, 0.08)\n"
                             "rule Floor -> split x { wall | window | wall }\n"
                             "  sizes mean (0.3, 0.3, 0.4) sd (0.07, 0.05, 0.08)\n";

/* -log density of the sizes that cuts at whole pixels a < b of n make; the first rule of the symbol has one draw. */
static double size_cost(const char *symbol, size_t a, size_t b, size_t n)
{
    const sg_rule *r = sg_grammar_rule(f.g, sg_grammar_symbol(f.g, sg_grammar_find(f.g, symbol))->first_rule);
    const double size[] = {(double)a / (double)n, (double)(b - a) / (double)n, (double)(n - b) / (double)n};
    double log_density = 0;
    ck_ok(sg_draw_log_density(f.g, &r->draws[0], NULL, 0, size, &log_density, &err));
    return -log_density;
}

/* Column x of a strip between two rows, as one label. */
static void add_strip(double weight, const char *label, size_t y0, size_t y1, double *column)
{
    const float *costs = f.costs.values + f.channel[sg_grammar_find(f.g, label)] * WIDTH * HEIGHT;
    for (size_t y = y0; y < y1; y++)
        for (size_t x = 0; x < WIDTH; x++)
            column[x] += weight * costs[y * WIDTH + x];
}

/* The best cuts of the floors, given what each column costs as wall and as window. */
static double best_floor(const double *wall, const double *window, double (*sizes)[WIDTH + 1])
{
    double least = INFINITY, wall_to[WIDTH + 1] = {0}, window_to[WIDTH + 1] = {0};
    for (size_t x = 0; x < WIDTH; x++) {
        wall_to[x + 1] = wall_to[x] + wall[x];
        window_to[x + 1] = window_to[x] + window[x];
    }
    for (size_t a = 1; a < WIDTH; a++)
        for (size_t b = a + 1; b < WIDTH; b++)
            least = fmin(least, sizes[a][b] + wall_to[a] + window_to[b] - window_to[a] + wall_to[WIDTH] - wall_to[b]);
    return least;
}

/* All derivations of the strips that cut at whole pixels. The picture's y runs down, the first size is the lowest. */
static double best_of_strips(double weight)
{
    static double sizes[WIDTH + 1][WIDTH + 1];
    double least = INFINITY;
    for (size_t a = 1; a < WIDTH; a++)
        for (size_t b = a + 1; b < WIDTH; b++)
            sizes[a][b] = size_cost("Floor", a, b, WIDTH);
    for (size_t top = 1; top < HEIGHT; top++)
        for (size_t bottom = top + 1; bottom < HEIGHT; bottom++) {
            double wall[WIDTH] = {0}, window[WIDTH] = {0}, sky[WIDTH] = {0}, sum = 0;
            add_strip(weight, "wall", 0, top, wall);
            add_strip(weight, "wall", bottom, HEIGHT, wall);
            add_strip(weight, "window", 0, top, window);
            add_strip(weight, "window", bottom, HEIGHT, window);
            add_strip(weight, "sky", top, bottom, sky);
            for (size_t x = 0; x < WIDTH; x++)
                sum += sky[x];
            sum += size_cost("House", HEIGHT - bottom, HEIGHT - top, HEIGHT);
            least = fmin(least, sum + best_floor(wall, window, sizes));
        }
    return least;
}

/* Children and cuts in turn need not end at the best there is; here, with one hump in each direction, they do. */
START_TEST(descent_finds_the_best_tied_derivation)
{
    open_grammar(strips);
    plant((uint64_t)_i, 0.5);
    sg_exact_opts opts = SG_EXACT_OPTS_INIT;
    opts.weight = 0.02;
    opts.step_px = 1;
    ck_ok(sg_exact_parse(f.g, &f.costs, f.channel, &opts, &f.result, &err));
    check_result(opts.weight);
    const double best = best_of_strips(opts.weight), got = energy_of(&f.result.derivation, opts.weight);
    ck_assert_msg(got <= best + 1e-6, "%.9g, best %.9g", got, best);
}
END_TEST

static void check_fails(sg_status status, const sg_exact_opts *opts)
{
    ck_assert_int_eq(sg_exact_parse(f.g, &f.costs, f.channel, opts, &f.result, &err), status);
    ck_assert_uint_eq(f.result.derivation.nnodes, 0);
    ck_assert(err.msg[0] != '\0');
    err.msg[0] = '\0';
}

START_TEST(bad_input_is_refused)
{
    open_grammar(house);
    plant(1, 0);
    const sg_exact_opts opts = SG_EXACT_OPTS_INIT;
    const double bad_weights[] = {0, -1, NAN, INFINITY};
    for (size_t i = 0; i < 4; i++) {
        sg_exact_opts bad = opts;
        bad.weight = bad_weights[i];
        check_fails(SG_EINVAL, &bad);
        bad = opts;
        bad.step_px = i == 3 ? 0.5 : bad_weights[i];
        check_fails(SG_EINVAL, &bad);
    }
    const float bad_costs[] = {-1, NAN, INFINITY};
    for (size_t i = 0; i < 3; i++) {
        f.costs.values[77] = bad_costs[i];
        check_fails(SG_EINVAL, &opts);
    }
    f.costs.values[77] = 1;
    f.channel[sg_grammar_find(f.g, "sky")] = CLASSES;
    check_fails(SG_EINVAL, &opts);
}
END_TEST

START_TEST(what_no_grammar_can_fill_has_no_parse)
{
    const sg_exact_opts opts = SG_EXACT_OPTS_INIT;
    open_grammar(house);
    sg_float_map_clear(&f.costs);
    ck_ok(sg_float_map_create(CLASSES, 2, 2, &f.costs, &err));
    check_fails(SG_ENOPARSE, &opts);
    sg_grammar_free(f.g);
    open_grammar("label a\nlabel b\nstart S\nrule S -> split x { 2 : a | ~1 : b }\n");
    check_fails(SG_EINPUT, &opts);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("exact_parse");
    TCase *tc = tcase_create("exact_parse");
    tcase_add_checked_fixture(tc, set_up, tear_down);
    tcase_add_loop_test(tc, planted_derivations_are_found, 0, 20);
    tcase_add_loop_test(tc, parts_of_the_energy_agree_with_the_raster, 0, 8);
    tcase_add_test(tc, tiny_images_agree_with_brute_force);
    tcase_add_loop_test(tc, tied_siblings_share_one_derivation, 0, 8);
    tcase_add_loop_test(tc, refining_lowers_the_energy, 0, 8);
    tcase_add_loop_test(tc, descent_finds_the_best_tied_derivation, 0, 4);
    tcase_add_test(tc, costs_that_say_nothing_still_have_a_parse);
    tcase_add_test(tc, bad_input_is_refused);
    tcase_add_test(tc, what_no_grammar_can_fill_has_no_parse);
    tcase_set_timeout(tc, 60);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
