/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench_derivation.c - how fast derivations are sampled, against a plain sampler, and interpreted, and what a splice saves
 * against a copy of the whole. One thread, figures per second of processor time; it judges nothing.
 * Usage: bench_derivation [SECONDS-A-LINE [models]], with `models` only models in space. */
#include "bench_plain.h"
#include "bench_sizes.h"
#include "core/random.h"
#include "derivation/derivation.h"
#include "scene/label_scene.h"
#include "scene/mesh.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static const char plain[] = "label t\nstart S\nrule S -> 0.2 : split x { S | S } -> 0.19 : split y { S | S | S } -> 0.61 : t\n";
static const char normal[] = "label t\nstart S\n"
                             "rule S -> 0.2 : z ~ normal(0, 1) split x { S | S }\n"
                             "       -> 0.19 : z ~ normal(0, 1) split y { S | S | S }\n"
                             "       -> 0.61 : z ~ normal(0, 1) t\n";
static const char sized[] = "label t\nstart S\n"
                            "rule S -> 0.2 : split x { S | S } sizes mean (0.5, 0.5) sd (0.1, 0.1)\n"
                            "       -> 0.19 : split y { S | S | S } sizes mean (0.3, 0.4, 0.3) sd (0.1, 0.1, 0.1)\n"
                            "       -> 0.61 : t\n";

/* Processor time: other work on the machine does not count. */
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
    fprintf(stderr, "bench_derivation: %s\n", err->msg);
    exit(1);
}

/* Millions of nodes a second. */
static double time_plain(const sg_grammar *g, gsl_rng *rng, double seconds)
{
    size_t nodes = 0;
    const double start = now_s();
    double elapsed;
    do {
        for (int i = 0; i < 200; i++)
            nodes += bench_plain_sample(g, rng);
        elapsed = now_s() - start;
    } while (elapsed < seconds);
    return 1e-6 * (double)nodes / elapsed;
}

static void time_sampling(const char *what, sg_derivation *d, gsl_rng *rng, bool plainly, double seconds)
{
    sg_error err = SG_ERROR_INIT;
    size_t nodes = 0, samples = 0;
    const double start = now_s();
    double elapsed;
    do {
        for (int i = 0; i < 1000; i++) {
            stop(sg_derivation_sample(d, rng, 1u << 24, &err), &err);
            nodes += d->nnodes;
        }
        samples += 1000;
        elapsed = now_s() - start;
    } while (elapsed < seconds);
    const double rate = 1e-6 * (double)nodes / elapsed;
    printf("%-28s %8.2f M nodes/s   (%.1f nodes a sample)", what, rate, (double)nodes / (double)samples);
    if (plainly) {
        const double plain_rate = time_plain(d->grammar, rng, seconds);
        printf("   plain: %.2f, ratio %.1f", plain_rate, rate / plain_rate);
    }
    putchar('\n');
}

/* A tree of about n nodes: samples of this size are rare, so it is grown by splicing larger subtrees in for leaves. */
static void grow(sg_derivation *d, sg_derivation *slice, gsl_rng *rng, size_t n)
{
    sg_error err = SG_ERROR_INIT;
    stop(sg_derivation_sample(d, rng, 1u << 24, &err), &err);
    while (d->nnodes < n) {
        const size_t node = gsl_rng_uniform_int(rng, d->nnodes);
        stop(sg_derivation_sample_subtree(slice, d->nodes[node].symbol, NULL, 0, rng, 1u << 24, &err), &err);
        if (slice->nnodes > d->nodes[node].length)
            stop(sg_derivation_splice(d, node, slice, &err), &err);
    }
}

/* One step of a chain: a proposal of a new subtree at a random node, as a splice, and as a copy of the whole tree. */
static void time_splices(sg_derivation *d, sg_derivation *slice, gsl_rng *rng, double seconds, bool in_place)
{
    sg_error err = SG_ERROR_INIT;
    sg_derivation copy, old;
    sg_derivation_init(&copy, d->grammar);
    sg_derivation_init(&old, d->grammar);
    size_t steps = 0;
    const double start = now_s();
    double elapsed;
    do {
        for (int i = 0; i < 200; i++) {
            const size_t node = gsl_rng_uniform_int(rng, d->nnodes);
            const sg_node n = d->nodes[node];
            stop(sg_derivation_sample_subtree(slice, n.symbol, d->values + n.values, n.depth, rng, 1u << 24, &err), &err);
            if (in_place) {
                stop(sg_derivation_extract(d, node, &old, &err), &err);
                stop(sg_derivation_splice(d, node, slice, &err), &err);
                stop(sg_derivation_splice(d, node, &old, &err), &err); /* rejected */
            } else {
                stop(sg_derivation_copy(&copy, d, &err), &err);
                stop(sg_derivation_splice(&copy, node, slice, &err), &err);
            }
        }
        steps += 200;
        elapsed = now_s() - start;
    } while (elapsed < seconds);
    printf("  %-26s %8.0f k proposals/s, tree of %zu nodes\n", in_place ? "splice and undo" : "copy the whole, splice",
           1e-3 * (double)steps / elapsed, d->nnodes);
    sg_derivation_clear(&copy);
    sg_derivation_clear(&old);
}

static void time_scenes(sg_derivation *d, gsl_rng *rng, double seconds)
{
    sg_error err = SG_ERROR_INIT;
    sg_label_scene scene = {0};
    size_t rects = 0;
    const double start = now_s();
    double elapsed;
    grow(d, &(sg_derivation){.grammar = d->grammar}, rng, 1000);
    do {
        for (int i = 0; i < 100; i++) {
            stop(sg_label_scene_interpret(&scene, d, 300, 400, &err), &err);
            rects += scene.nrects;
        }
        elapsed = now_s() - start;
    } while (elapsed < seconds);
    printf("%-28s %8.2f M rectangles/s\n", "interpretation", 1e-6 * (double)rects / elapsed);
    sg_label_scene_clear(&scene);
}

/* Models in space: derivations, their primitives, and their meshes. */
static const char tree[] = "limit depth 9\nstart T(1)\n"
                           "rule T(w)\n"
                           "  -> width(w / 10) draw(normal(1, 0.1)) [ roll(uniform(0, 360)) pitch(normal(40, 5)) T(w * 0.7) ]\n"
                           "     [ roll(120) pitch(30) T(w * 0.6) ] roll(90) T(w * 0.8)\n"
                           "rule T(w) at limit -> scale(w, w, w) insert(sphere)\n";
static const char city[] = "start City\n"
                           "rule City -> size(200, 30, 200) repeat x 10 { repeat z 10 { Lot } }\n"
                           "rule Lot -> h ~ uniform(6, 30) scale(0.8, 1, 0.8) size(16, h, 16)\n"
                           "  components { side : Front(h) | top : Roof }\n"
                           "rule Front(h) -> repeat y h / 3 { repeat x 5 { split x { Wall | ~2 : Window | Wall } } }\n"
                           "rule Window -> 0.8 : set_material(#3050a0) extrude(-0.1) -> 0.2 : Wall\n"
                           "rule Wall -> extrude(0.2)\n"
                           "rule Roof -> hip_roof(30, 0.5)\n";

typedef struct {
    double nodes, primitives, derive_s, interpret_s, mesh_s, vertices, plain_s;
} model_times;

static model_times time_model(const sg_grammar *g, gsl_rng *rng, bool plainly, double seconds)
{
    sg_error err = SG_ERROR_INIT;
    const sg_scene_opts scene_opts = SG_SCENE_OPTS_INIT;
    const sg_mesh_opts mesh_opts = SG_MESH_OPTS_INIT;
    sg_derivation d;
    sg_scene scene = {0};
    sg_mesh mesh = {0};
    model_times t = {0};
    sg_derivation_init(&d, g);
    while (t.derive_s + t.interpret_s + t.mesh_s < 3 * seconds) {
        const double start = now_s();
        stop(sg_derivation_sample(&d, rng, 1u << 24, &err), &err);
        const double derived = now_s();
        stop(sg_scene_interpret(&d, &scene_opts, &scene, &err), &err);
        const double interpreted = now_s();
        stop(sg_mesh_from_scene(&scene, &mesh_opts, &mesh, &err), &err);
        const double meshed = now_s();
        if (plainly && bench_plain_interpret(&d) != scene.n)
            abort();
        t.plain_s += now_s() - meshed;
        t.mesh_s += meshed - interpreted;
        t.derive_s += derived - start;
        t.interpret_s += interpreted - derived;
        t.nodes += (double)d.nnodes;
        t.primitives += (double)scene.n;
        t.vertices += (double)mesh.nvertices;
    }
    sg_derivation_clear(&d);
    sg_scene_clear(&scene);
    sg_mesh_clear(&mesh);
    return t;
}

static void time_models(const char *name, const char *text, gsl_rng *rng, bool plainly, double seconds)
{
    sg_error err = SG_ERROR_INIT;
    sg_grammar *g = NULL;
    stop(sg_grammar_parse(text, strlen(text), "bench", &g, &err), &err);
    const model_times t = time_model(g, rng, plainly, seconds);
    printf("%-28s %8.2f M nodes/s derived, %.2f M primitives/s interpreted, %.2f M with the derivation, %.2f M vertices/s of "
           "meshes\n", name, 1e-6 * t.nodes / t.derive_s, 1e-6 * t.primitives / t.interpret_s,
           1e-6 * t.primitives / (t.derive_s + t.interpret_s), 1e-6 * t.vertices / t.mesh_s);
    if (plainly)
        printf("  %-26s %8.2f M primitives/s interpreted, ratio %.1f\n", "plain", 1e-6 * t.primitives / t.plain_s,
               t.plain_s / t.interpret_s);
    sg_grammar_free(g);
}

int main(int argc, char **argv)
{
    const double seconds = argc > 1 ? atof(argv[1]) : 1;
    const struct {
        const char *name, *text;
    } cases[] = {{"three rules", plain}, {"three rules, a normal each", normal}, {"three rules, drawn sizes", sized}};
    sg_error err = SG_ERROR_INIT;
    gsl_rng *rng = sg_random_create(1);
    const bool all = argc < 3;
    for (size_t k = 0; all && k < 3 && rng != NULL; k++) {
        sg_grammar *g = NULL;
        sg_derivation d, slice;
        stop(sg_grammar_parse(cases[k].text, strlen(cases[k].text), "bench", &g, &err), &err);
        sg_derivation_init(&d, g);
        sg_derivation_init(&slice, g);
        time_sampling(cases[k].name, &d, rng, k < 2, seconds);
        for (size_t n = 100; k != 1 && n <= 10000; n *= 10) {
            grow(&d, &slice, rng, n);
            time_splices(&d, &slice, rng, seconds, true);
            time_splices(&d, &slice, rng, seconds, false);
        }
        if (k != 1)
            time_scenes(&d, rng, seconds);
        sg_derivation_clear(&d);
        sg_derivation_clear(&slice);
        sg_grammar_free(g);
    }
    if (rng != NULL) {
        time_models("a tree in space", tree, rng, true, seconds);
        time_models("a city", city, rng, false, seconds);
        gsl_rng_free(rng);
    }
    if (all)
        bench_sizes(seconds / 4);
    return rng != NULL ? 0 : 4;
}
