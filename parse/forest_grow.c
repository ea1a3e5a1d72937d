/* SPDX-License-Identifier: GPL-3.0-or-later */
/* forest_grow.c - trees grown side by side, and what the leaves hold. */
#include "config.h"

#include "parse/forest_grow.h"

#include "core/random.h"

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
static sg_status copy_tree(const grown_tree *from, sg_forest *f, uint32_t first, uint32_t *leaf, sg_error *err)
{
    for (size_t i = 0; i < from->nnodes; i++) {
        const sg_cv_node *n = &from->nodes[i];
        if (n->feature >= 0) {
            f->nodes[first + i] = (sg_forest_node){n->threshold, (uint32_t)n->feature, first + (uint32_t)n->left};
            continue;
        }
        if (n->label < 0 || (size_t)n->label >= f->nclasses)
            return SG_FAIL(err, SG_EINVAL, "a leaf of class %d of %zu", (int)n->label, f->nclasses);
        f->leaves[*leaf * f->nclasses + (size_t)n->label] = 1;
        f->nodes[first + i] = (sg_forest_node){0, SG_FOREST_LEAF, (*leaf)++};
    }
    return SG_OK;
}

static sg_status copy_trees(const grown_tree *trees, size_t n, sg_forest *f, sg_error *err)
{
    uint32_t leaf = 0, first = 0;
    for (size_t t = 0, k = 0; t < n; t++) {
        if (trees[t].nodes == NULL)
            continue;
        SG_TRY(copy_tree(&trees[t], f, first, &leaf, err));
        first += (uint32_t)trees[t].nnodes;
        f->roots[++k] = first;
    }
    return SG_OK;
}

/* The trees that are there; a zeroed forest when none is. */
static sg_status collect(const grown_tree *trees, size_t n, size_t nfeatures, size_t nclasses, sg_forest *out,
                         sg_error *err)
{
    sg_forest f = {0};
    size_t ntrees = 0, nnodes = 0;
    for (size_t t = 0; t < n; t++) {
        ntrees += trees[t].nodes != NULL;
        nnodes += trees[t].nnodes;
    }
    if (ntrees > 0) {
        /* every inner node has two children: nnodes = 2 leaves - 1 in each tree */
        SG_TRY(sg_forest_create(nfeatures, nclasses, ntrees, nnodes, (nnodes + ntrees) / 2, &f, err));
        const sg_status st = copy_trees(trees, n, &f, err);
        if (st != SG_OK) {
            sg_forest_clear(&f);
            return st;
        }
    }
    *out = f;
    return SG_OK;
}

static void free_trees(grown_tree *trees, size_t n)
{
    for (size_t t = 0; trees != NULL && t < n; t++)
        free(trees[t].nodes);
    free(trees);
}

sg_status sg_forest_from_cv(const sg_cv_forest *from, size_t nclasses, sg_forest *out, sg_error *err)
{
    const size_t n = sg_cv_forest_trees(from);
    grown_tree *trees = calloc(n, sizeof *trees);
    sg_status st = trees != NULL ? SG_OK : SG_FAIL_NOMEM(err);
    for (size_t t = 0; st == SG_OK && t < n; t++)
        st = sg_cv_forest_tree(from, t, &trees[t].nodes, &trees[t].nnodes, err);
    if (st == SG_OK)
        st = collect(trees, n, sg_cv_forest_features(from), nclasses, out, err);
    free_trees(trees, n);
    return st;
}

static sg_status grow_and_collect(const sg_sample_matrix *s, growth *g, sg_forest *out, sg_error *err)
{
    grow_trees(g);
    if (g->status != SG_OK) {
        if (err != NULL)
            *err = g->error;
        return g->status;
    }
    SG_TRY(collect(g->trees, g->opts->trees, s->nfeatures, s->nclasses, out, err));
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
    free_trees(g.trees, opts->trees);
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
