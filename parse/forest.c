/* SPDX-License-Identifier: GPL-3.0-or-later */
/* forest.c - the tables of a forest: making, checking, looking up. */
#include "config.h"

#include "parse/forest.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { LANES = 8, TILE = 64 }; /* pixels that go down together; side of the squares that threads take, px */

sg_status sg_forest_create(size_t nfeatures, size_t nclasses, size_t ntrees, size_t nnodes, size_t nleaves,
                           sg_forest *out, sg_error *err)
{
    if (nfeatures == 0 || nclasses == 0 || ntrees == 0 || nnodes < ntrees || nleaves < ntrees ||
        nfeatures >= SG_FOREST_LEAF || nnodes >= UINT32_MAX || nleaves > nnodes || ntrees >= UINT32_MAX)
        return SG_FAIL(err, SG_EINVAL, "a forest of %zu trees, %zu nodes and %zu leaves", ntrees, nnodes, nleaves);
    sg_forest f = {nfeatures, nclasses, ntrees, nnodes, nleaves, NULL, NULL, NULL};
    f.roots = calloc(ntrees + 1, sizeof *f.roots);
    f.nodes = calloc(nnodes, sizeof *f.nodes);
    f.leaves = calloc(nleaves * nclasses, sizeof *f.leaves);
    if (f.roots == NULL || f.nodes == NULL || f.leaves == NULL) {
        sg_forest_clear(&f);
        return SG_FAIL_NOMEM(err);
    }
    *out = f;
    return SG_OK;
}

void sg_forest_clear(sg_forest *f)
{
    free(f->roots);
    free(f->nodes);
    free(f->leaves);
    memset(f, 0, sizeof *f);
}

/* ---- checks ---- */

/* Level by level: the children of the k-th inner node must be the next pair that nobody has had, so that there are neither
 * cycles nor orphans. */
static sg_status check_tree(const sg_forest *f, size_t tree, uint32_t *next_leaf, sg_error *err)
{
    const size_t begin = f->roots[tree], end = f->roots[tree + 1];
    size_t next = begin + 1;
    for (size_t i = begin; i < end; i++) {
        const sg_forest_node *n = &f->nodes[i];
        if (n->feature == SG_FOREST_LEAF) {
            if (n->child != (*next_leaf)++)
                return SG_FAIL(err, SG_EINPUT, "tree %zu: node %zu is no leaf in its order", tree, i - begin);
            continue;
        }
        if (n->feature >= f->nfeatures || !isfinite(n->threshold))
            return SG_FAIL(err, SG_EINPUT, "tree %zu: node %zu asks for no feature", tree, i - begin);
        if (n->child != next || next + 2 > end)
            return SG_FAIL(err, SG_EINPUT, "tree %zu: the children of node %zu are not where they belong", tree, i - begin);
        next += 2;
    }
    return next == end ? SG_OK : SG_FAIL(err, SG_EINPUT, "tree %zu: a node is nobody's child", tree);
}

static sg_status check_leaves(const sg_forest *f, sg_error *err)
{
    for (size_t i = 0; i < f->nleaves; i++) {
        double sum = 0;
        for (size_t c = 0; c < f->nclasses; c++) {
            const float p = f->leaves[i * f->nclasses + c];
            if (!(p > 0 && p <= 1))
                return SG_FAIL(err, SG_EINPUT, "leaf %zu: a probability of %g", i, (double)p);
            sum += (double)p;
        }
        if (fabs(sum - 1) > 1e-4)
            return SG_FAIL(err, SG_EINPUT, "leaf %zu: probabilities sum to %g", i, sum);
    }
    return SG_OK;
}

sg_status sg_forest_check(const sg_forest *f, sg_error *err)
{
    uint32_t next_leaf = 0;
    if (f->roots[0] != 0 || f->roots[f->ntrees] != f->nnodes)
        return SG_FAIL(err, SG_EINPUT, "the trees are not all of the nodes");
    for (size_t t = 0; t < f->ntrees; t++)
        if (f->roots[t] >= f->roots[t + 1] || f->roots[t + 1] > f->nnodes)
            return SG_FAIL(err, SG_EINPUT, "tree %zu has no nodes", t);
    for (size_t t = 0; t < f->ntrees; t++)
        SG_TRY(check_tree(f, t, &next_leaf, err));
    if (next_leaf != f->nleaves)
        return SG_FAIL(err, SG_EINPUT, "%u leaves, but distributions for %zu", (unsigned)next_leaf, f->nleaves);
    return check_leaves(f, err);
}

/* Nodes stand level by level: a level ends where the children of its last inner node do. */
size_t sg_forest_depth(const sg_forest *f, size_t tree)
{
    size_t depth = 0, level_end = f->roots[tree] + 1, next_end = level_end;
    for (size_t i = f->roots[tree]; i < f->roots[tree + 1]; i++) {
        if (i == level_end) {
            depth++;
            level_end = next_end;
        }
        if (f->nodes[i].feature != SG_FOREST_LEAF)
            next_end = f->nodes[i].child + 2;
    }
    return depth;
}

/* ---- looking up ---- */

/* A leaf is its own child whatever is compared, so that lanes that have come to one wait there for the others. */
typedef struct {
    ptrdiff_t offset;
    float threshold;
    uint32_t child;
} bound_node;

struct sg_forest_view {
    const sg_forest *forest;
    const float *data;
    bound_node *nodes; /* [forest->nnodes] */
};

sg_status sg_forest_bind(const sg_forest *f, const float *data, const ptrdiff_t *offsets, sg_forest_view **out,
                         sg_error *err)
{
    sg_forest_view *v = malloc(sizeof *v);
    bound_node *nodes = malloc(f->nnodes * sizeof *nodes);
    if (v == NULL || nodes == NULL) {
        free(v);
        free(nodes);
        return SG_FAIL_NOMEM(err);
    }
    for (size_t i = 0; i < f->nnodes; i++) {
        const sg_forest_node *n = &f->nodes[i];
        nodes[i] = n->feature == SG_FOREST_LEAF ? (bound_node){offsets[0], INFINITY, (uint32_t)i}
                                                : (bound_node){offsets[n->feature], n->threshold, n->child};
    }
    *v = (sg_forest_view){f, data, nodes};
    *out = v;
    return SG_OK;
}

void sg_forest_view_free(sg_forest_view *v)
{
    if (v != NULL)
        free(v->nodes);
    free(v);
}

const sg_forest *sg_forest_view_forest(const sg_forest_view *v)
{
    return v->forest;
}

/* All lanes a step down; true when one of them has moved. */
static inline bool step_lanes(const bound_node *nodes, const float *data, const ptrdiff_t *pixels, uint32_t *at)
{
    uint32_t moved = 0;
    for (int k = 0; k < LANES; k++) {
        const bound_node *n = &nodes[at[k]];
        const uint32_t to = n->child + (data[n->offset + pixels[k]] > n->threshold);
        moved |= to ^ at[k];
        at[k] = to;
    }
    return moved != 0;
}

static inline uint32_t find_one(const bound_node *nodes, const float *data, ptrdiff_t pixel, uint32_t at)
{
    for (;;) {
        const bound_node *n = &nodes[at];
        const uint32_t to = n->child + (data[n->offset + pixel] > n->threshold);
        if (to == at)
            return at;
        at = to;
    }
}

void sg_forest_find(const sg_forest_view *v, size_t tree, const ptrdiff_t *pixels, size_t n, uint32_t *leaves)
{
    const uint32_t root = v->forest->roots[tree];
    const sg_forest_node *nodes = v->forest->nodes;
    size_t i = 0;
    for (; i + LANES <= n; i += LANES) {
        uint32_t at[LANES];
        for (int k = 0; k < LANES; k++)
            at[k] = root;
        while (step_lanes(v->nodes, v->data, pixels + i, at))
            ;
        for (int k = 0; k < LANES; k++)
            leaves[i + (size_t)k] = nodes[at[k]].child;
    }
    for (; i < n; i++)
        leaves[i] = nodes[find_one(v->nodes, v->data, pixels[i], root)].child;
}

void sg_forest_mean(const sg_forest_view *v, const ptrdiff_t *pixels, size_t n, uint32_t *leaves, float *p)
{
    const sg_forest *f = v->forest;
    const size_t nclasses = f->nclasses;
    const float share = 1 / (float)f->ntrees;
    memset(p, 0, n * nclasses * sizeof *p);
    for (size_t t = 0; t < f->ntrees; t++) {
        sg_forest_find(v, t, pixels, n, leaves);
        for (size_t i = 0; i < n; i++) {
            const float *leaf = f->leaves + leaves[i] * nclasses;
            for (size_t c = 0; c < nclasses; c++)
                p[i * nclasses + c] += leaf[c];
        }
    }
    for (size_t i = 0; i < n * nclasses; i++)
        p[i] *= share;
}

/* ---- photographs, in squares: a square's sums and a tree's nodes fit into the cache together ---- */

typedef struct {
    ptrdiff_t pixels[TILE * TILE];
    uint32_t leaves[TILE * TILE];
    float p[]; /* [TILE * TILE][nclasses] */
} tile_scratch;

static void apply_tile(const sg_forest_view *v, const sg_features *features, size_t x0, size_t y0, tile_scratch *s,
                       sg_float_map *out)
{
    const size_t x1 = x0 + TILE < out->width ? x0 + TILE : out->width;
    const size_t y1 = y0 + TILE < out->height ? y0 + TILE : out->height;
    const size_t nclasses = out->channels, plane = out->width * out->height;
    size_t n = 0;
    for (size_t y = y0; y < y1; y++)
        for (size_t x = x0; x < x1; x++)
            s->pixels[n++] = (ptrdiff_t)(y * features->stride + x);
    sg_forest_mean(v, s->pixels, n, s->leaves, s->p);
    for (size_t c = 0; c < nclasses; c++) {
        size_t i = 0;
        for (size_t y = y0; y < y1; y++)
            for (size_t x = x0; x < x1; x++)
                out->values[c * plane + y * out->width + x] = s->p[nclasses * i++ + c];
    }
}

static sg_status apply_tiles(const sg_forest_view *v, const sg_features *features, int threads, sg_float_map *out,
                             sg_error *err)
{
    const size_t across = (out->width + TILE - 1) / TILE, down = (out->height + TILE - 1) / TILE;
    bool failed = false;
#pragma omp parallel num_threads(threads)
    {
        tile_scratch *s = malloc(sizeof *s + TILE * TILE * out->channels * sizeof(float));
        if (s == NULL) {
#pragma omp atomic write
            failed = true;
        }
#pragma omp for schedule(dynamic)
        for (size_t i = 0; i < across * down; i++)
            if (s != NULL)
                apply_tile(v, features, i % across * TILE, i / across * TILE, s, out);
        free(s);
    }
    return failed ? SG_FAIL_NOMEM(err) : SG_OK;
}

sg_status sg_forest_apply(const sg_forest *f, const sg_features *features, int threads, sg_float_map *out,
                          sg_error *err)
{
    sg_float_map map = {0};
    sg_forest_view *v = NULL;
    if (features->nfeatures != f->nfeatures)
        return SG_FAIL(err, SG_EINVAL, "%zu features for a forest over %zu", features->nfeatures, f->nfeatures);
    sg_status st = sg_float_map_create(f->nclasses, features->height, features->width, &map, err);
    if (st == SG_OK)
        st = sg_forest_bind(f, features->data, features->offsets, &v, err);
    if (st == SG_OK)
        st = apply_tiles(v, features, threads, &map, err);
    sg_forest_view_free(v);
    if (st == SG_OK)
        *out = map;
    else
        sg_float_map_clear(&map);
    return st;
}
