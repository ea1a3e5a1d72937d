/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench_derivation.c - how fast derivations are sampled, and what a splice saves against a copy of the whole.
 * One thread, processor time; prints figures, judges nothing. Usage: bench_derivation [SECONDS-A-LINE] */
#include "bench_sizes.h"
#include "core/random.h"
#include "derivation/derivation.h"
#include "scene/label_scene.h"

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

static void time_sampling(const char *what, sg_derivation *d, gsl_rng *rng, double seconds)
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
    printf("%-28s %8.2f M nodes/s   (%.1f nodes a sample)\n", what, 1e-6 * (double)nodes / elapsed,
           (double)nodes / (double)samples);
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

int main(int argc, char **argv)
{
    const double seconds = argc > 1 ? atof(argv[1]) : 1;
    const struct {
        const char *name, *text;
    } cases[] = {{"three rules", plain}, {"three rules, a normal each", normal}, {"three rules, drawn sizes", sized}};
    sg_error err = SG_ERROR_INIT;
    gsl_rng *rng = sg_random_create(1);
    for (size_t k = 0; k < 3 && rng != NULL; k++) {
        sg_grammar *g = NULL;
        sg_derivation d, slice;
        stop(sg_grammar_parse(cases[k].text, strlen(cases[k].text), "bench", &g, &err), &err);
        sg_derivation_init(&d, g);
        sg_derivation_init(&slice, g);
        time_sampling(cases[k].name, &d, rng, seconds);
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
    gsl_rng_free(rng);
    bench_sizes(seconds / 4);
    return rng != NULL ? 0 : 4;
}
