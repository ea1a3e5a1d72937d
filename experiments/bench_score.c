/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench_score.c - how many changes of a derivation are scored in a second, by kind, against scoring from scratch.
 * The target is made up: the costs of a sampled scene seen through noise. Changes come in batches that are made beforehand,
 * each is scored once; each batch has another derivation, a sample of the prior. One thread, processor time, medians over
 * batches; prints figures, judges nothing. Usage: bench_score GRAMMAR.sg [BATCHES-A-LINE [WIDTH HEIGHT]] */
#include "core/random.h"
#include "scene/label_scene.h"
#include "score/label_score.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { BATCH = 256, MAX_NODES = 5000 };

typedef enum { SLICE, RESAMPLE, ONE, SHIFT, KINDS } kind;
static const char *const names[KINDS] = {"subtree of a node anew", "all values of a node", "one uniform of a node",
                                         "a boundary between two sizes"};

typedef struct {
    sg_grammar *g;
    gsl_rng *rng;
    sg_derivation d;
    sg_float_map costs;
    uint32_t *channel;
    sg_score *target;
    sg_score_state *state, *states[BATCH];
    sg_change changes[BATCH];
    sg_derivation slices[BATCH];
    double *values; /* [BATCH][frame size] */
    double *uniforms;
    size_t frame;
} bench;

static double now_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void stop(sg_status st, const sg_error *err)
{
    if (st == SG_OK)
        return;
    fprintf(stderr, "bench_score: %s\n", err->msg);
    exit(1);
}

/* -log of a softmax of noise in which the scene's own label stands out. */
static void make_costs(bench *b, size_t width, size_t height)
{
    sg_error err = SG_ERROR_INIT;
    sg_label_scene scene = {0};
    sg_classes classes;
    sg_label_map map;
    uint8_t *value_of = calloc(sg_grammar_symbol_count(b->g), 1);
    stop(sg_label_classes(b->g, &classes, value_of, &err), &err);
    stop(sg_label_map_create(width, height, &map, &err), &err);
    do
        stop(sg_derivation_sample(&b->d, b->rng, MAX_NODES, &err), &err);
    while (sg_label_scene_interpret(&scene, &b->d, (double)width, (double)height, &err) != SG_OK);
    sg_label_scene_raster(&scene, value_of, &map);
    const size_t n = width * height, channels = classes.nclasses;
    stop(sg_float_map_create(channels, height, width, &b->costs, &err), &err);
    for (size_t i = 0; i < n; i++) {
        double weight[SG_MAX_CLASSES], sum = 0;
        for (size_t c = 0; c < channels; c++)
            sum += weight[c] = exp(3 * gsl_rng_uniform(b->rng) + (map.labels[i] == c ? 2 : 0));
        for (size_t c = 0; c < channels; c++)
            b->costs.values[c * n + i] = (float)-log(weight[c] / sum);
    }
    for (size_t s = 0; s < sg_grammar_symbol_count(b->g); s++)
        b->channel[s] = value_of[s];
    sg_classes_clear(&classes);
    sg_label_map_clear(&map);
    sg_label_scene_clear(&scene);
    free(value_of);
}

static void open_bench(bench *b, const char *path, size_t width, size_t height)
{
    sg_error err = SG_ERROR_INIT;
    stop(sg_grammar_load(path, &b->g, &err), &err);
    b->frame = sg_grammar_frame_size(b->g) + 1;
    b->rng = sg_random_create(1);
    b->channel = calloc(sg_grammar_symbol_count(b->g), sizeof *b->channel);
    b->values = calloc(BATCH * b->frame, sizeof *b->values);
    b->uniforms = calloc(BATCH * b->frame, sizeof *b->uniforms);
    sg_derivation_init(&b->d, b->g);
    make_costs(b, width, height);
    stop(sg_label_score_create(b->g, &b->costs, b->channel, 1, &b->target, &err), &err);
    stop(sg_score_state_create(b->target, &b->state, &err), &err);
    for (size_t i = 0; i < BATCH; i++) {
        stop(sg_score_state_create(b->target, b->states + i, &err), &err);
        sg_derivation_init(b->slices + i, b->g);
    }
}

static void close_bench(bench *b)
{
    for (size_t i = 0; i < BATCH; i++) {
        sg_score_state_free(b->states[i]);
        sg_derivation_clear(b->slices + i);
    }
    sg_score_state_free(b->state);
    sg_score_free(b->target);
    sg_derivation_clear(&b->d);
    sg_float_map_clear(&b->costs);
    gsl_rng_free(b->rng);
    sg_grammar_free(b->g);
    free(b->channel);
    free(b->values);
    free(b->uniforms);
}

/* The first draw of a node with at least two sizes, where it has one. */
static const sg_draw *sizes_of(const bench *b, size_t node)
{
    const sg_node *n = b->d.nodes + node;
    const sg_rule *r = n->rule < SG_RULE_EMPTY ? sg_grammar_rule(b->g, n->rule) : NULL;
    return r != NULL && r->ndraws > 0 && r->draws[0].kind == SG_DRAW_SIMPLEX && r->draws[0].nvalues > 1 ? r->draws : NULL;
}

static void shift(bench *b, const sg_draw *draw, double *size)
{
    const size_t k = gsl_rng_uniform_int(b->rng, draw->nvalues - 1);
    const double both = size[k] + size[k + 1];
    const double step = both * (gsl_rng_uniform(b->rng) - 0.5) * exp(-3 * gsl_rng_uniform(b->rng));
    const double first = fmin(fmax(size[k] + step, 1e-3 * both), 0.999 * both);
    size[k + 1] -= first - size[k];
    size[k] = first;
}

static void make_values(bench *b, kind what, const sg_draw *draw, sg_change *c, double *u, double *v)
{
    sg_error err = SG_ERROR_INIT;
    const sg_node n = b->d.nodes[c->node];
    const uint32_t nparams = sg_grammar_symbol(b->g, n.symbol)->nparams;
    const sg_rule *r = sg_grammar_rule(b->g, n.rule);
    memcpy(u, b->d.uniforms + n.uniforms, r->nuniforms * sizeof *u);
    memcpy(v, b->d.values + n.values + nparams, r->nvalues * sizeof *v);
    if (what == SHIFT) {
        shift(b, draw, v);
    } else {
        if (what == ONE)
            u[gsl_rng_uniform_int(b->rng, draw->nuniforms)] = sg_random_uniform(b->rng);
        for (uint32_t i = 0; what == RESAMPLE && i < draw->nuniforms; i++)
            u[i] = sg_random_uniform(b->rng);
        stop(sg_draw_transform(b->g, draw, b->d.values + n.values, n.depth, u, v, &err), &err);
    }
    c->uniforms = u;
    c->values = v;
}

static bool make_change(bench *b, kind what, size_t i)
{
    sg_error err = SG_ERROR_INIT;
    const size_t node = gsl_rng_uniform_int(b->rng, b->d.nnodes);
    const sg_node n = b->d.nodes[node];
    b->changes[i] = (sg_change){.current = &b->d, .node = node};
    if (what == SLICE) {
        b->changes[i].slice = b->slices + i;
        return sg_derivation_sample_subtree(b->slices + i, n.symbol, b->d.values + n.values, n.depth, b->rng, MAX_NODES,
                                            &err) == SG_OK;
    }
    const sg_draw *draw = sizes_of(b, node);
    if (draw == NULL)
        return false;
    make_values(b, what, draw, b->changes + i, b->uniforms + i * b->frame, b->values + i * b->frame);
    return true;
}

static void apply(bench *b, const sg_change *c)
{
    sg_error err = SG_ERROR_INIT;
    const sg_node n = b->d.nodes[c->node];
    if (c->slice != NULL)
        stop(sg_derivation_splice(&b->d, c->node, c->slice, &err), &err);
    else
        memcpy(b->d.values + n.values + sg_grammar_symbol(b->g, n.symbol)->nparams, c->values,
               sg_grammar_rule(b->g, n.rule)->nvalues * sizeof *c->values);
}

/* Seconds that the batch takes: each change scored and rolled back, or scored and committed in a state of its own. */
static double time_batch(bench *b, bool commit, double *nodes)
{
    sg_error err = SG_ERROR_INIT;
    sg_score_value v;
    for (size_t i = 0; commit && i < BATCH; i++)
        stop(sg_score_state_copy(b->states[i], b->state, &err), &err);
    const double start = now_s();
    for (size_t i = 0; i < BATCH; i++) {
        sg_score_state *s = commit ? b->states[i] : b->state;
        stop(sg_score_propose(s, b->changes + i, -INFINITY, &v, &err), &err);
        if (commit && isfinite(v.log))
            sg_score_commit(s);
        else
            sg_score_rollback(s);
    }
    const double seconds = now_s() - start;
    for (size_t i = 0; i < BATCH; i++) {
        const sg_change *c = b->changes + i;
        *nodes += (double)(c->slice != NULL ? c->slice->nnodes : b->d.nodes[c->node].length) / BATCH;
    }
    return seconds;
}

/* Another derivation, the same ones for each kind. */
static void begin_batch(bench *b, unsigned long number, double *nodes)
{
    sg_error err = SG_ERROR_INIT;
    sg_score_value v;
    gsl_rng_set(b->rng, number);
    do {
        stop(sg_derivation_sample(&b->d, b->rng, MAX_NODES, &err), &err);
        stop(sg_score_evaluate(b->state, &b->d, &v, &err), &err);
    } while (!isfinite(v.log));
    *nodes += (double)b->d.nnodes;
}

/* Make one change after the other; what is carried must be what comes from scratch. */
static double drift(bench *b, kind what)
{
    sg_error err = SG_ERROR_INIT;
    sg_score_value v, carried = {NAN, NAN};
    for (int k = 0; k < 1000; k++) {
        while (!make_change(b, what, 0))
            ;
        stop(sg_score_propose(b->state, b->changes, -INFINITY, &v, &err), &err);
        if (!isfinite(v.log)) {
            sg_score_rollback(b->state);
            continue;
        }
        sg_score_commit(b->state);
        apply(b, b->changes);
        carried = v;
    }
    stop(sg_score_evaluate(b->state, &b->d, &v, &err), &err);
    return isnan(carried.log) ? 0 : fabs(v.log - carried.log);
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *x, size_t n)
{
    qsort(x, n, sizeof *x, by_size);
    return x[n / 2];
}

static void time_kind(bench *b, kind what, size_t batches)
{
    double tree = 0, nodes = 0, *propose = malloc(2 * batches * sizeof *propose), *commit = propose + batches;
    for (size_t k = 0; propose != NULL && k < batches; k++) {
        begin_batch(b, k + 1, &tree);
        for (size_t i = 0; i < BATCH; i++)
            while (!make_change(b, what, i))
                ;
        propose[k] = time_batch(b, false, &nodes) / BATCH;
        commit[k] = time_batch(b, true, &nodes) / BATCH;
    }
    if (propose == NULL)
        return;
    const double seconds = median(propose, batches);
    printf("%-30s %8.2f M/s %7.0f ns, with commit %6.0f ns; %.1f nodes of %.0f; off by %g\n", names[what], 1e-6 / seconds,
           1e9 * seconds, 1e9 * median(commit, batches), nodes / 2 / (double)batches, tree / (double)batches,
           drift(b, what));
    free(propose);
}

static void time_scratch(bench *b, size_t batches)
{
    enum { TIMES = 20 };
    sg_error err = SG_ERROR_INIT;
    sg_score_value v;
    double tree = 0, *seconds = malloc(batches * sizeof *seconds);
    for (size_t k = 0; seconds != NULL && k < batches; k++) {
        begin_batch(b, k + 1, &tree);
        const double start = now_s();
        for (int i = 0; i < TIMES; i++)
            stop(sg_score_evaluate(b->state, &b->d, &v, &err), &err);
        seconds[k] = (now_s() - start) / TIMES;
    }
    if (seconds == NULL)
        return;
    const double middle = median(seconds, batches);
    printf("%-30s %8.2f M/s %7.0f ns; %.0f nodes\n", "from scratch", 1e-6 / middle, 1e9 * middle, tree / (double)batches);
    free(seconds);
}

int main(int argc, char **argv)
{
    static bench b;
    if (argc < 2) {
        fputs("Usage: bench_score GRAMMAR.sg [BATCHES-A-LINE [WIDTH HEIGHT]]\n", stderr);
        return 2;
    }
    const size_t batches = argc > 2 && atoi(argv[2]) > 0 ? (size_t)atoi(argv[2]) : 500;
    open_bench(&b, argv[1], argc > 4 ? strtoul(argv[3], NULL, 10) : 400, argc > 4 ? strtoul(argv[4], NULL, 10) : 500);
    time_scratch(&b, batches);
    for (kind k = 0; k < KINDS; k++)
        time_kind(&b, k, batches);
    close_bench(&b);
    return 0;
}
