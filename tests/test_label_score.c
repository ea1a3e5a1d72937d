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

void *__real_aligned_alloc(size_t alignment, size_t n);
void *__wrap_aligned_alloc(size_t alignment, size_t n);

void *__wrap_aligned_alloc(size_t alignment, size_t n)
{
    return test_allocations++ == test_fail_at ? NULL : __real_aligned_alloc(alignment, n);
}

#define UNITS_PER_NAT 268435456.0 /* as label_score_priv.h: the oracle rounds each pixel's cost by itself */


/* As ck_assert and ck_ok, without telling Check about each success: for what runs very often. */
#define quick_assert(expr)                                                                                             \
    do {                                                                                                               \
        if (!(expr))                                                                                                   \
            ck_abort_msg("%s", #expr);                                                                                 \
    } while (0)
#define quick_ok(expr) quick_assert((expr) == SG_OK)

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
    size_t max_nodes; /* few where siblings are tied: the scene grows by powers */
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
    fixture f = {.g = g, .rng = sg_random_create(seed), .weight = 0.7, .max_nodes = sg_grammar_tied(g) ? 50 : 400};
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
    return sg_derivation_sample(&f->d, f->rng, f->max_nodes, &err) == SG_OK;
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
        quick_assert(f->map.labels[i] < f->costs.channels);
        sum += llround(f->costs.values[f->map.labels[i] * n + i] * UNITS_PER_NAT);
    }
    return -f->weight / UNITS_PER_NAT * (double)sum;
}

static double evaluated(fixture *f, const sg_derivation *d)
{
    sg_error err = SG_ERROR_INIT;
    sg_score_value v;
    quick_ok(sg_score_evaluate(f->state, d, &v, &err));
    quick_assert(v.value == v.log / ((double)f->costs.width * (double)f->costs.height));
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

/* ---- changes ---- */

/* A change of f->d, and what it is made of. */
typedef struct {
    sg_change change;
    double uniforms[64], values[64];
} proposal;

static void init_proposal(fixture *f, proposal *p)
{
    memset(p, 0, sizeof *p);
    p->change.current = &f->d;
    p->change.uniforms = p->uniforms;
    p->change.values = p->values;
}

static bool propose_slice(fixture *f, size_t node, proposal *p)
{
    sg_error err = SG_ERROR_INIT;
    const sg_node n = f->d.nodes[node];
    init_proposal(f, p);
    p->change.node = node;
    p->change.slice = &f->slice;
    const size_t most = f->max_nodes + n.length > f->d.nnodes ? f->max_nodes + n.length - f->d.nnodes : 1;
    return sg_derivation_sample_subtree(&f->slice, n.symbol, f->d.values + n.values, n.depth, f->rng, most, &err) == SG_OK;
}

/* Sizes that trade, as a search shifts a boundary: all other sizes stay. */
static void trade(fixture *f, const sg_draw *draw, double *size)
{
    const size_t k = gsl_rng_uniform_int(f->rng, draw->nvalues - 1);
    const double step = (gsl_rng_uniform(f->rng) - 0.5) * pow(10, -8 * gsl_rng_uniform(f->rng)) *
                        fmin(size[k], size[k + 1]);
    size[k] += step;
    size[k + 1] -= step;
}

/* Whether arguments and repeat counts come out the same. */
static bool same_children(const fixture *f, const sg_rule *r, const double *frame, const double *other, double depth)
{
    for (const sg_op *op = r->ops; op < r->ops + r->nops; op++)
        for (uint32_t i = 0; i < op->nargs && (op->kind == SG_OP_SUCCESSOR || op->kind == SG_OP_REPEAT); i++)
            if (sg_grammar_eval(f->g, op->args[i], frame, depth) != sg_grammar_eval(f->g, op->args[i], other, depth))
                return false;
    return true;
}

/* Other values of one draw, or of all. False: the node has none, or children depend on them. */
static bool propose_values(fixture *f, size_t node, proposal *p)
{
    sg_error err = SG_ERROR_INIT;
    const sg_node n = f->d.nodes[node];
    const sg_rule *r = n.rule < SG_RULE_EMPTY ? sg_grammar_rule(f->g, n.rule) : NULL;
    init_proposal(f, p);
    p->change.node = node;
    if (r == NULL || r->ndraws == 0)
        return false;
    const uint32_t nparams = sg_grammar_symbol(f->g, n.symbol)->nparams;
    double frame[64];
    quick_assert(nparams + r->nvalues <= 64);
    if (r->nuniforms > 0) /* a simplex of one part has a draw and none */
        memcpy(p->uniforms, f->d.uniforms + n.uniforms, r->nuniforms * sizeof(double));
    memcpy(frame, f->d.values + n.values, (nparams + r->nvalues) * sizeof(double));
    const sg_draw *draw = r->draws + gsl_rng_uniform_int(f->rng, r->ndraws);
    const bool trades = draw->kind == SG_DRAW_SIMPLEX && draw->nvalues > 1 && gsl_rng_uniform(f->rng) < 0.5;
    for (const sg_draw *q = r->draws; q < r->draws + r->ndraws; q++) {
        double *u = p->uniforms + q->first_uniform, *v = frame + nparams + q->first_value;
        if (q == draw && trades) {
            trade(f, q, v);
            quick_ok(sg_draw_invert(f->g, q, frame, n.depth, v, u, &err));
            continue;
        }
        for (uint32_t i = 0; q == draw && i < q->nuniforms; i++)
            u[i] = sg_random_uniform(f->rng);
        if (q >= draw && sg_draw_transform(f->g, q, frame, n.depth, u, v, &err) != SG_OK)
            return false;
    }
    memcpy(p->values, frame + nparams, r->nvalues * sizeof(double));
    return same_children(f, r, frame, f->d.values + n.values, n.depth);
}

static bool propose_any(fixture *f, proposal *p)
{
    const size_t node = gsl_rng_uniform_int(f->rng, f->d.nnodes);
    return gsl_rng_uniform(f->rng) < 0.6 ? propose_values(f, node, p) : propose_slice(f, node, p);
}

/* The changed derivation, made by hand. */
static void changed(const sg_change *c, sg_derivation *out)
{
    sg_error err = SG_ERROR_INIT;
    quick_ok(sg_derivation_copy(out, c->current, &err));
    if (c->slice != NULL) {
        quick_ok(sg_derivation_splice(out, c->node, c->slice, &err));
        return;
    }
    const sg_node n = out->nodes[c->node];
    const sg_rule *r = sg_grammar_rule(out->grammar, n.rule);
    if (r->nuniforms > 0)
        memcpy(out->uniforms + n.uniforms, c->uniforms, r->nuniforms * sizeof(double));
    memcpy(out->values + n.values + sg_grammar_symbol(out->grammar, n.symbol)->nparams, c->values,
           r->nvalues * sizeof(double));
}

static double proposed(fixture *f, const proposal *p, double floor)
{
    sg_error err = SG_ERROR_INIT;
    sg_score_value v;
    quick_ok(sg_score_propose(f->state, &p->change, floor, &v, &err));
    quick_assert(v.value == v.log / ((double)f->costs.width * (double)f->costs.height));
    return v.log;
}

/* Begin at a scene; false when there is none. */
static bool begin(fixture *f)
{
    for (int tries = 0; tries < 200; tries++)
        if (sample(f) && isfinite(evaluated(f, &f->d)))
            return true;
    return false;
}

/* Propose, check, commit or roll back; with sharp floors now and then. Returns the number of commits. */
static int walk(fixture *f, int steps, int check_every)
{
    sg_error err = SG_ERROR_INIT;
    sg_derivation next;
    sg_derivation_init(&next, f->g);
    double log = evaluated(f, &f->d);
    int commits = 0;
    for (int k = 0; k < steps; k++) {
        proposal p;
        if (!propose_any(f, &p))
            continue;
        const double floor = k % 3 == 0 ? log + 20 * (gsl_rng_uniform(f->rng) - 0.5) : -INFINITY;
        const double got = proposed(f, &p, floor);
        if (k % check_every == 0) {
            changed(&p.change, &next);
            const double want = log_of_raster(f, &next);
            if (got != want && !(got == -INFINITY && want < floor))
                ck_abort_msg("step %d, %s at node %zu of %zu: %.17g, not %.17g", k,
                             p.change.slice != NULL ? "slice" : "values", p.change.node, f->d.nnodes, got, want);
        }
        if (isfinite(got) && gsl_rng_uniform(f->rng) < 0.5) {
            sg_score_commit(f->state);
            changed(&p.change, &next);
            quick_ok(sg_derivation_copy(&f->d, &next, &err));
            log = got;
            commits++;
        } else {
            sg_score_rollback(f->state);
        }
    }
    sg_derivation_clear(&next);
    return commits;
}

START_TEST(changes_are_scored_as_from_scratch)
{
    fixture f = open_fixture(any_grammar(_i), (uint64_t)_i + 1);
    for (int k = 0; k < 2 && begin(&f); k++) /* the second time with what is left from the first */
        walk(&f, 400, 1);
    close_fixture(&f);
}
END_TEST

/* What is carried over many changes is what comes from scratch, to the last bit. */
START_TEST(nothing_is_lost_over_many_changes)
{
    fixture f = open_fixture(any_grammar(_i), (uint64_t)_i + 1);
    ck_assert(begin(&f));
    ck_assert_int_gt(walk(&f, 100000, 499), 10000);
    close_fixture(&f);
}
END_TEST

/* ---- where a state stands ---- */

static void apply(fixture *f, const sg_change *c)
{
    sg_error err = SG_ERROR_INIT;
    sg_derivation next;
    sg_derivation_init(&next, f->g);
    changed(c, &next);
    quick_ok(sg_derivation_copy(&f->d, &next, &err));
    sg_derivation_clear(&next);
}

/* Half of one column, half of two, or parts that do not fit. */
static const char brittle[] = "label a\nlabel b\nstart S\n"
                              "rule S -> split y { T | T | U } sizes mean (0.4, 0.3, 0.3) sd (0.2, 0.2, 0.2)\n"
                              "rule T -> 0.5 : split x { a | b } sizes mean (0.5, 0.5) sd (0.3, 0.3)\n"
                              "       -> 0.5 : split x { 60 : a | uniform(1, 60) : b | ~1 : a }\n"
                              "rule U -> 0.5 : split x { a | b } -> 0.2 : a -> 0.2 : split x { 500 : a | ~1 : b } -> 0.1 : nothing\n";

/* A state that stands at no scene scores changes, too, and comes back to one. */
START_TEST(a_state_comes_back_from_no_scene)
{
    sg_error err = SG_ERROR_INIT;
    sg_derivation next;
    fixture f = open_fixture(grammar_of(brittle), (uint64_t)_i + 1);
    sg_derivation_init(&next, f.g);
    size_t none = 0, back = 0;
    for (int k = 0; k < 300; k++) {
        ck_ok(sg_derivation_sample(&f.d, f.rng, f.max_nodes, &err));
        bool stands = isfinite(evaluated(&f, &f.d));
        for (int j = 0; j < 4; j++) {
            proposal p;
            if (!propose_any(&f, &p))
                continue;
            changed(&p.change, &next);
            const double got = proposed(&f, &p, -INFINITY), want = log_of_raster(&f, &next);
            ck_assert_double_eq(got, want);
            none += !stands;
            if (isfinite(got)) {
                back += !stands;
                sg_score_commit(f.state);
                apply(&f, &p.change);
                stands = true;
            } else {
                sg_score_rollback(f.state);
            }
        }
    }
    ck_assert_msg(none > back && back > 10, "%zu, %zu", none, back);
    sg_derivation_clear(&next);
    close_fixture(&f);
}
END_TEST

/* A copy goes its own way: both score the same proposals the same, and one's commits do not touch the other. */
START_TEST(copies_stand_alone)
{
    sg_error err = SG_ERROR_INIT;
    sg_score_value v;
    fixture f = open_fixture(any_grammar(_i), (uint64_t)_i + 1);
    sg_score_state *first = f.state, *copy = NULL;
    ck_ok(sg_score_state_create(f.target, &copy, &err));
    ck_ok(sg_score_state_copy(copy, f.state, &err)); /* of one that stands nowhere */
    for (int k = 0; k < 20 && begin(&f); k++) {
        walk(&f, 20, 5);
        ck_ok(sg_score_state_copy(copy, f.state, &err));
        ck_ok(sg_score_state_copy(copy, copy, &err));
        for (int j = 0; j < 50; j++) {
            proposal p;
            if (!propose_any(&f, &p))
                continue;
            const double log = proposed(&f, &p, -INFINITY);
            quick_ok(sg_score_propose(copy, &p.change, -INFINITY, &v, &err));
            quick_assert(v.log == log);
            if (isfinite(log) && j % 2 == 0)
                sg_score_commit(copy); /* and once more below: then f's walk sees its own state as it was */
            else
                sg_score_rollback(copy);
            sg_score_rollback(f.state);
            ck_ok(sg_score_state_copy(copy, f.state, &err));
        }
        f.state = copy;
        walk(&f, 20, 1);
        f.state = first;
    }
    sg_score_state_free(copy);
    close_fixture(&f);
}
END_TEST

/* Open nodes cost what the cheapest labels do: what can still come of a derivation is not better. */
START_TEST(open_nodes_bound_their_completions)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(any_grammar(_i), (uint64_t)_i + 1);
    for (int k = 0; k < 50; k++) {
        ck_assert(begin(&f));
        const double complete = evaluated(&f, &f.d);
        const size_t node = gsl_rng_uniform_int(f.rng, f.d.nnodes);
        const sg_node n = f.d.nodes[node];
        ck_ok(sg_derivation_open(&f.slice, n.symbol, f.d.values + n.values, n.depth, &err));
        const sg_change open = {.current = &f.d, .node = node, .slice = &f.slice};
        sg_score_value v;
        ck_ok(sg_score_propose(f.state, &open, -INFINITY, &v, &err));
        ck_assert(v.log >= complete && v.log <= 0);
        sg_score_commit(f.state);
        apply(&f, &open);
        ck_assert_double_eq(evaluated(&f, &f.d), v.log);
        proposal p;
        if (propose_slice(&f, node, &p))
            ck_assert_double_le(proposed(&f, &p, -INFINITY), v.log);
        sg_score_rollback(f.state);
    }
    close_fixture(&f);
}
END_TEST

/* A tied grammar that asks for 2^n places. Changes of nodes with very many places are scored, or refused as the scene is. */
START_TEST(too_many_places_are_no_scene)
{
    sg_error err = SG_ERROR_INIT;
    sg_grammar *g = grammar_of("tied\nlabel a\nlabel b\nstart S(29)\n"
                              "rule S(n) if n > 0 -> split x { S(n - 1) | S(n - 1) }\n"
                              "rule S(n) if n <= 0 -> a -> b\n");
    fixture f = open_fixture(g, 1);
    ck_assert(sample(&f) && f.d.nnodes == 30);
    ck_assert_double_eq(evaluated(&f, &f.d), -INFINITY);
    const double small = 12;
    ck_ok(sg_derivation_sample_subtree(&f.d, sg_grammar_start(g), &small, 0, f.rng, 100, &err));
    ck_assert_double_eq(evaluated(&f, &f.d), log_of_raster(&f, &f.d));
    for (int k = 0; k < 3000; k++) { /* what is placed again is not counted again and again */
        proposal p;
        quick_assert(propose_slice(&f, k % 13, &p));
        const double log = proposed(&f, &p, -INFINITY);
        quick_assert(isfinite(log));
        sg_score_commit(f.state);
        apply(&f, &p.change);
        if (k % 500 == 0)
            ck_assert_double_eq(log, log_of_raster(&f, &f.d));
    }
    close_fixture(&f);
}
END_TEST

/* ---- faults ---- */

START_TEST(bad_targets_are_refused)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(mixed_grammar(false), 1);
    sg_score *t = NULL;
    static const double weights[] = {0, -1, NAN, INFINITY};
    for (size_t k = 0; k < 4; k++)
        ck_assert_int_eq(sg_label_score_create(f.g, &f.costs, f.channel, weights[k], &t, &err), SG_EINVAL);
    static const float costs[] = {-1e-6F, NAN, INFINITY, 3e10F};
    for (size_t k = 0; k < 4; k++) {
        float *cost = f.costs.values + f.channel[sg_grammar_find(f.g, "u")] * f.costs.width * f.costs.height;
        const float before = cost[0];
        cost[0] = costs[k];
        ck_assert_int_eq(sg_label_score_create(f.g, &f.costs, f.channel, 1, &t, &err), SG_EINVAL);
        ck_assert_ptr_nonnull(strstr(err.msg, "cost"));
        cost[0] = before;
    }
    f.channel[sg_grammar_find(f.g, "v")] = (uint32_t)f.costs.channels;
    ck_assert_int_eq(sg_label_score_create(f.g, &f.costs, f.channel, 1, &t, &err), SG_EINVAL);
    ck_assert_ptr_nonnull(strstr(err.msg, "label v"));
    ck_assert_ptr_null(t);
    sg_grammar *other = mixed_grammar(false);
    sg_derivation d;
    sg_score_value v;
    sg_derivation_init(&d, other);
    ck_assert_int_eq(sg_score_evaluate(f.state, &d, &v, &err), SG_EINVAL);
    sg_grammar_free(other);
    close_fixture(&f);
}
END_TEST

/* Costs of labels that the grammar does not have are not looked at. */
START_TEST(other_channels_do_not_count)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(grammar_of("label a\nstart S\nrule S -> a\n"), 3);
    const size_t n = f.costs.width * f.costs.height, used = f.channel[sg_grammar_find(f.g, "a")];
    for (size_t i = 0; i < n * f.costs.channels; i++)
        if (i / n != used)
            f.costs.values[i] = NAN;
    sg_score_state_free(f.state);
    sg_score_free(f.target);
    ck_ok(sg_label_score_create(f.g, &f.costs, f.channel, f.weight, &f.target, &err));
    ck_ok(sg_score_state_create(f.target, &f.state, &err));
    check_from_scratch(&f, 1);
    close_fixture(&f);
}
END_TEST

/* Each allocation of each call fails once; what stood still stands. */
START_TEST(failed_allocations_are_reported)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(any_grammar(_i), (uint64_t)_i + 1);
    ck_assert(begin(&f));
    size_t failures[5] = {0};
    for (size_t k = 0; k < 40; k++) {
        sg_score *target = NULL;
        sg_score_state *fresh = NULL, *copy = NULL;
        sg_score_value v;
        proposal p;
        evaluated(&f, &f.d);
        while (!propose_any(&f, &p))
            ;
        ck_ok(sg_score_state_create(f.target, &copy, &err));
        ck_ok(sg_score_state_create(f.target, &fresh, &err));
        for (int call = 0; call < 5; call++) {
            if (call == 4)
                ck_ok(sg_score_state_copy(fresh, f.state, &err)); /* a state that has no room yet for a proposal */
            sg_score_state *made = NULL;
            test_fail_allocation(k);
            const sg_status st = call == 0   ? sg_label_score_create(f.g, &f.costs, f.channel, 1, &target, &err)
                                 : call == 1 ? sg_score_state_create(f.target, &made, &err)
                                 : call == 2 ? sg_score_state_copy(copy, f.state, &err)
                                 : call == 3 ? sg_score_evaluate(fresh, &f.d, &v, &err)
                                             : sg_score_propose(fresh, &p.change, -INFINITY, &v, &err);
            const int failed = test_allocation_failed();
            ck_assert_msg(st == (failed ? SG_ENOMEM : SG_OK), "call %d, allocation %zu: status %d", call, k, (int)st);
            failures[call] += failed != 0;
            sg_score_free(target);
            sg_score_state_free(made);
            target = NULL;
        }
        ck_ok(sg_score_propose(fresh, &p.change, -INFINITY, &v, &err));
        ck_assert_double_eq(v.log, proposed(&f, &p, -INFINITY));
        sg_score_rollback(f.state);
        sg_score_state_free(fresh);
        sg_score_state_free(copy);
    }
    for (int call = 0; call < 5; call++)
        ck_assert_msg(failures[call] > 0, "call %d failed %zu times", call, failures[call]);
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
    tcase_add_loop_test(tc, changes_are_scored_as_from_scratch, 0, GRAMMARS);
    tcase_add_loop_test(tc, nothing_is_lost_over_many_changes, 0, 8);
    tcase_add_loop_test(tc, a_state_comes_back_from_no_scene, 0, 3);
    tcase_add_loop_test(tc, copies_stand_alone, 0, 12);
    tcase_add_loop_test(tc, open_nodes_bound_their_completions, 0, 8);
    tcase_add_test(tc, too_many_places_are_no_scene);
    tcase_add_test(tc, bad_targets_are_refused);
    tcase_add_test(tc, other_channels_do_not_count);
    tcase_add_loop_test(tc, failed_allocations_are_reported, 0, 8);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
