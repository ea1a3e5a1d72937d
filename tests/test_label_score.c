/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_label_score.c - the score of label costs against the raster, from scratch and over many changes. */
#include "core/random.h"
#include "scene/label_scene.h"
#include "score/label_score.h"
#include "tests/failing_malloc.h"
#include "tests/random_grammar.h"
#include "tests/support.h"

#include <math.h>
#include <string.h>

#define UNITS_PER_NAT 268435456.0 /* as label_score_priv.h: the oracle rounds each pixel's cost by itself */

enum { MAX_NODES = 2000 };

/* Nested splits, repeats, all kinds of sizes, symbols several times in one body: what has no flat plan. */
static const char mixed[] =
    "label t\nlabel u\nlabel v\nstart S(3)\n"
    "rule S(n)\n"
    "  -> 0.3 : split y { '0.25 : A | ~2 : S(n) | ~1 : A }\n"
    "  -> 0.2 : repeat x n { split y { 2 : t | ~1 : A } }\n"
    "  -> 0.2 : split x { u | split y { v | A | v } | A } sizes mean (0.3, 0.4, 0.3) sd (0.2, 0.2, 0.2)\n"
    "  -> 0.1 : split x { uniform(3, 20) : A | ~1 : split y { uniform(0.2, 0.7) : A | ~1 : B | ~0.5 : A } }\n"
    "  -> 0.2 : split y { B | S(n) | B | A } sizes mean (0.2, 0.4, 0.2, 0.2) sd (0.2, 0.2, 0.2, 0.2)\n"
    "rule A\n"
    "  -> 0.3 : t\n"
    "  -> 0.2 : u\n"
    "  -> 0.1 : B\n"
    "  -> 0.2 : split x { u | t | t | v } sizes mean (0.2, 0.4, 0.3, 0.1) sd (0.2, 0.2, 0.1, 0.1)\n"
    "  -> 0.2 : repeat y 3 { v }\n"
    "rule B\n"
    "  -> 0.5 : split y { t | A | u | A } sizes mean (0.2, 0.4, 0.3, 0.1) sd (0.2, 0.2, 0.1, 0.1)\n"
    "  -> 0.3 : split x { ~1 : v | '0.3 : B | ~1 : v }\n"
    "  -> 0.2 : [ u ]\n";

typedef struct {
    sg_grammar *g;
    sg_derivation d, slice;
    gsl_rng *rng;
    sg_float_map costs;
    uint32_t *channel;
    uint8_t *value_of;
    sg_label_scene scene;
    sg_label_map map;
    double weight;
    sg_score *target;
    sg_score_state *state;
} fixture;

static void random_costs(fixture *f, size_t channels, size_t height, size_t width)
{
    sg_error err = SG_ERROR_INIT;
    ck_ok(sg_float_map_create(channels, height, width, &f->costs, &err));
    const double scale = exp(6 * gsl_rng_uniform(f->rng) - 3);
    for (size_t i = 0; i < channels * height * width; i++)
        f->costs.values[i] = (float)(-log(gsl_rng_uniform_pos(f->rng)) * scale);
}

/* A fixture over costs of random size; takes g over. */
static fixture open_fixture(sg_grammar *g, uint64_t seed)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = {.g = g, .rng = sg_random_create(seed), .weight = 0.7};
    const size_t n = sg_grammar_symbol_count(g), channels = 1 + gsl_rng_uniform_int(f.rng, 11);
    random_costs(&f, channels, 1 + gsl_rng_uniform_int(f.rng, 90), 1 + gsl_rng_uniform_int(f.rng, 90));
    f.channel = malloc(n * sizeof *f.channel);
    f.value_of = calloc(n, 1);
    for (size_t s = 0; s < n; s++) {
        f.channel[s] = UINT32_MAX;
        if (sg_grammar_symbol(g, (sg_sym)s)->kind == SG_SYMBOL_LABEL)
            f.value_of[s] = (uint8_t)(f.channel[s] = (uint32_t)gsl_rng_uniform_int(f.rng, channels));
    }
    sg_derivation_init(&f.d, g);
    sg_derivation_init(&f.slice, g);
    ck_ok(sg_label_map_create(f.costs.width, f.costs.height, &f.map, &err));
    ck_ok(sg_label_score_create(g, &f.costs, f.channel, f.weight, &f.target, &err));
    ck_ok(sg_score_state_create(f.target, &f.state, &err));
    return f;
}

static void close_fixture(fixture *f)
{
    sg_score_state_free(f->state);
    sg_score_free(f->target);
    sg_label_scene_clear(&f->scene);
    sg_label_map_clear(&f->map);
    sg_float_map_clear(&f->costs);
    sg_derivation_clear(&f->d);
    sg_derivation_clear(&f->slice);
    free(f->channel);
    free(f->value_of);
    gsl_rng_free(f->rng);
    sg_grammar_free(f->g);
}

static sg_grammar *grammar_of(const char *text)
{
    sg_error err = SG_ERROR_INIT;
    sg_grammar *g = NULL;
    ck_ok(sg_grammar_parse(text, strlen(text), "test", &g, &err));
    return g;
}

static bool sample(fixture *f)
{
    sg_error err = SG_ERROR_INIT;
    return sg_derivation_sample(&f->d, f->rng, MAX_NODES, &err) == SG_OK;
}

/* The oracle: the costs of the raster's pixels. */
static double log_of_raster(fixture *f, const sg_derivation *d)
{
    sg_error err = SG_ERROR_INIT;
    const size_t n = f->costs.width * f->costs.height;
    if (sg_label_scene_interpret(&f->scene, d, (double)f->costs.width, (double)f->costs.height, &err) != SG_OK)
        return -INFINITY;
    memset(f->map.labels, 255, n);
    sg_label_scene_raster(&f->scene, f->value_of, &f->map);
    int64_t sum = 0;
    for (size_t i = 0; i < n; i++) {
        ck_assert_uint_lt(f->map.labels[i], f->costs.channels);
        sum += llround(f->costs.values[f->map.labels[i] * n + i] * UNITS_PER_NAT);
    }
    return -f->weight / UNITS_PER_NAT * (double)sum;
}

static double evaluated(fixture *f, const sg_derivation *d)
{
    sg_error err = SG_ERROR_INIT;
    sg_score_value v;
    ck_ok(sg_score_evaluate(f->state, d, &v, &err));
    ck_assert(v.value == v.log / ((double)f->costs.width * (double)f->costs.height));
    return v.log;
}

static void check_from_scratch(fixture *f, int samples)
{
    for (int k = 0; k < samples; k++)
        if (sample(f))
            ck_assert_double_eq(evaluated(f, &f->d), log_of_raster(f, &f->d));
}

/* ---- grammars ---- */

static sg_grammar *load(const char *name)
{
    sg_error err = SG_ERROR_INIT;
    char path[4096];
    sg_grammar *g = NULL;
    snprintf(path, sizeof path, "%s/data/grammars/%s.sg", test_folder("SG_SOURCE_DIR"), name);
    ck_ok(sg_grammar_load(path, &g, &err));
    return g;
}

static sg_grammar *split_grammar(int seed)
{
    sg_error err = SG_ERROR_INIT;
    sg_arena *arena = sg_arena_create();
    gsl_rng *rng = sg_random_create((uint64_t)seed);
    const random_split_opts opts = RANDOM_SPLIT_OPTS_INIT;
    sg_split_form form;
    sg_grammar *g = NULL;
    random_split_form(rng, &opts, arena, &form);
    ck_ok(sg_grammar_from_split(&form, &g, &err));
    gsl_rng_free(rng);
    sg_arena_free(arena);
    return g;
}

static sg_grammar *language_grammar(int seed)
{
    gsl_rng *rng = sg_random_create((uint64_t)seed);
    random_grammar_opts opts = RANDOM_GRAMMAR_OPTS_INIT;
    opts.derivable = true;
    char *text = random_grammar_text(rng, &opts);
    sg_grammar *g = grammar_of(text);
    free(text);
    gsl_rng_free(rng);
    return g;
}

static sg_grammar *mixed_grammar(bool tied)
{
    char text[sizeof mixed + 8];
    snprintf(text, sizeof text, "%s%s", tied ? "tied\n" : "", mixed);
    return grammar_of(text);
}

/* Grammars of all kinds by number. */
static sg_grammar *any_grammar(int k)
{
    static const char *const facades[] = {"arcade", "haussmann", "office", "terrace"};
    return k < 4 ? load(facades[k]) : k < 8 ? mixed_grammar(k % 2 == 0) : split_grammar(k);
}

enum { GRAMMARS = 40 };

START_TEST(from_scratch_it_is_the_raster)
{
    fixture f = open_fixture(any_grammar(_i), (uint64_t)_i + 1);
    check_from_scratch(&f, 40);
    close_fixture(&f);
}
END_TEST

/* Most of these are no label scenes. */
START_TEST(what_is_no_label_scene_is_minus_infinity)
{
    fixture f = open_fixture(language_grammar(_i), (uint64_t)_i + 1);
    check_from_scratch(&f, 20);
    close_fixture(&f);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("label score");
    TCase *tc = tcase_create("label score");
    tcase_set_timeout(tc, 120);
    tcase_add_loop_test(tc, from_scratch_it_is_the_raster, 0, GRAMMARS);
    tcase_add_loop_test(tc, what_is_no_label_scene_is_minus_infinity, 0, 40);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
