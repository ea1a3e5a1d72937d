/* SPDX-License-Identifier: GPL-3.0-or-later */
/* forest_grow.c - trees grown side by side, and what the leaves hold. */
#include "config.h"

#include "parse/forest_grow.h"

#include "core/random.h"
#include "parse/cv_forest.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    sg_cv_node *nodes; /* NULL: not grown */
    size_t nnodes;
} grown_tree;

typedef struct {
    const sg_cv_samples *samples;
    const sg_forest_grow_opts *opts;
    grown_tree *trees; /* [opts->trees] */
    size_t ndone;
    bool stopped;
    sg_status status;  /* of the first tree, in order, that failed */
    size_t failed_tree;
    sg_error error;
} growth;

/* The seed of OpenCV's generator: neighbouring seeds of its own kind begin alike. */
static sg_status tree_seed(uint64_t seed, size_t tree, uint64_t *out, sg_error *err)
{
    gsl_rng *rng = sg_random_create(seed);
    if (rng == NULL)
        return SG_FAIL_NOMEM(err);
    sg_random_stream(rng, seed, 1, tree);
    const uint64_t high = gsl_rng_get(rng);
    *out = high << 32 | gsl_rng_get(rng);
    gsl_rng_free(rng);
    return SG_OK;
}

static sg_status grow_tree(const growth *g, size_t tree, sg_error *err)
{
    const sg_forest_grow_opts *o = g->opts;
    const sg_cv_forest_opts one = {1, o->depth, o->min_leaf, o->active};
    sg_cv_forest *f;
    uint64_t seed = 0;
    SG_TRY(tree_seed(o->seed, tree, &seed, err));
    SG_TRY(sg_cv_forest_grow(g->samples, &one, seed, &f, err));
    const sg_status st = sg_cv_forest_tree(f, 0, &g->trees[tree].nodes, &g->trees[tree].nnodes, err);
    sg_cv_forest_free(f);
    return st;
}

/* The failure that is told is that of the first tree in order, whichever thread met one first. */
static void note_outcome(growth *g, size_t tree, sg_status st, const sg_error *err)
{
    g->ndone++;
    sg_progress_report(g->opts->progress, "trees", g->ndone, g->opts->trees);
    if (st != SG_OK && (g->status == SG_OK || tree < g->failed_tree)) {
        g->status = st;
        g->failed_tree = tree;
        g->error = *err;
    }
}

static void grow_trees(growth *g)
{
#pragma omp parallel for schedule(dynamic) num_threads(g->opts->threads)
    for (size_t t = 0; t < g->opts->trees; t++) {
        bool skip;
#pragma omp critical(sg_forest_grow)
        {
            g->stopped = g->stopped || sg_progress_stopped(g->opts->progress);
            skip = g->stopped || g->status != SG_OK;
        }
        if (skip)
            continue;
        sg_error e = SG_ERROR_INIT;
        const sg_status st = grow_tree(g, t, &e);
#pragma omp critical(sg_forest_grow)
        note_outcome(g, t, st, &e);
    }
}

/* The shim hands out nodes level by level and children in pairs, as our tables want them. */
static void copy_tree(const grown_tree *from, sg_forest *f, uint32_t first, uint32_t *leaf)
{
    for (size_t i = 0; i < from->nnodes; i++) {
        const sg_cv_node *n = &from->nodes[i];
        f->nodes[first + i] = n->feature < 0
                                  ? (sg_forest_node){0, SG_FOREST_LEAF, (*leaf)++}
                                  : (sg_forest_node){n->threshold, (uint32_t)n->feature, first + (uint32_t)n->left};
    }
}

static sg_status collect(const growth *g, const sg_sample_matrix *s, sg_forest *out, sg_error *err)
{
    size_t ntrees = 0, nnodes = 0;
    for (size_t t = 0; t < g->opts->trees; t++) {
        ntrees += g->trees[t].nodes != NULL;
        nnodes += g->trees[t].nnodes;
    }
    memset(out, 0, sizeof *out);
    if (ntrees == 0)
        return SG_OK;
    /* every inner node has two children: nnodes = 2 leaves - 1 in each tree */
    SG_TRY(sg_forest_create(s->nfeatures, s->nclasses, ntrees, nnodes, (nnodes + ntrees) / 2, out, err));
    uint32_t leaf = 0, first = 0;
    size_t k = 0;
    for (size_t t = 0; t < g->opts->trees; t++) {
        if (g->trees[t].nodes == NULL)
            continue;
        copy_tree(&g->trees[t], out, first, &leaf);
        first += (uint32_t)g->trees[t].nnodes;
        out->roots[++k] = first;
    }
    for (size_t i = 0; i < out->nleaves * out->nclasses; i++)
        out->leaves[i] = 1 / (float)out->nclasses;
    return SG_OK;
}

static sg_status grow_and_collect(const sg_sample_matrix *s, growth *g, sg_forest *out, sg_error *err)
{
    grow_trees(g);
    if (g->status != SG_OK) {
        if (err != NULL)
            *err = g->error;
        return g->status;
    }
    SG_TRY(collect(g, s, out, err));
    return g->stopped ? SG_FAIL(err, SG_STOPPED, "stopped") : SG_OK;
}

sg_status sg_forest_grow(const sg_sample_matrix *s, const sg_forest_grow_opts *opts, sg_forest *out, sg_error *err)
{
    sg_cv_samples *samples;
    if (opts->trees == 0 || opts->trees > 1u << 20)
        return SG_FAIL(err, SG_EINVAL, "a forest of %zu trees", opts->trees);
    SG_TRY(sg_cv_samples_create(s->x, s->n, s->nfeatures, s->classes, &samples, err));
    growth g = {.samples = samples, .opts = opts, .trees = calloc(opts->trees, sizeof *g.trees), .status = SG_OK};
    const sg_status st = g.trees != NULL ? grow_and_collect(s, &g, out, err) : SG_FAIL_NOMEM(err);
    for (size_t t = 0; g.trees != NULL && t < opts->trees; t++)
        free(g.trees[t].nodes);
    free(g.trees);
    sg_cv_samples_free(samples);
    return st;
}

void sg_forest_count(const sg_forest_view *v, const ptrdiff_t *pixels, const uint8_t *classes, size_t n,
                     uint32_t *leaves, uint64_t *counts)
{
    const sg_forest *f = sg_forest_view_forest(v);
    for (size_t t = 0; t < f->ntrees; t++) {
        sg_forest_find(v, t, pixels, n, leaves);
        for (size_t i = 0; i < n; i++) {
            uint64_t *at = &counts[leaves[i] * f->nclasses + classes[i]];
#pragma omp atomic
            (*at)++;
        }
    }
}

void sg_forest_fill(sg_forest *f, const uint64_t *counts, const double *weights, double smoothing)
{
    for (size_t i = 0; i < f->nleaves; i++) {
        const uint64_t *from = counts + i * f->nclasses;
        double sum = 0;
        for (size_t c = 0; c < f->nclasses; c++)
            sum += weights[c] * (double)from[c] + smoothing;
        for (size_t c = 0; c < f->nclasses; c++)
            f->leaves[i * f->nclasses + c] = (float)((weights[c] * (double)from[c] + smoothing) / sum);
    }
}
