/* SPDX-License-Identifier: GPL-3.0-or-later */
/* forest.h - random forests as flat tables: trees that ask one feature a node, and class probabilities in the leaves.
 *
 * The nodes of a tree stand level by level, the two children of a node side by side, so that a step down is one look-up,
 * one comparison and one addition. A table is bound to the place where features lie (a photograph's planes, a sample
 * matrix); several pixels then go down together, since one alone would only wait for memory.
 * Source: Breiman, "Random forests", Machine Learning 45 (2001). Departs from it: leaves hold smoothed histograms and the
 * trees' probabilities are averaged, since votes of a few trees are too coarse for costs. */
#ifndef SG_PARSE_FOREST_H
#define SG_PARSE_FOREST_H

#include "core/status.h"
#include "image/npy.h"
#include "parse/features.h"

#include <stddef.h>
#include <stdint.h>

#define SG_FOREST_LEAF UINT32_MAX

typedef struct {
    float threshold;  /* a value <= threshold goes to the child, else to the node after it */
    uint32_t feature; /* SG_FOREST_LEAF in a leaf */
    uint32_t child;   /* node number; in a leaf the number of the leaf */
} sg_forest_node;

typedef struct {
    size_t nfeatures, nclasses, ntrees, nnodes, nleaves;
    uint32_t *roots;       /* [ntrees + 1]: tree t has the nodes roots[t] .. roots[t + 1] - 1 */
    sg_forest_node *nodes; /* [nnodes] */
    float *leaves;         /* [nleaves][nclasses], > 0, rows sum to 1 */
} sg_forest;

/** Zeroed tables of these sizes. @return SG_OK, SG_EINVAL (a size is 0 or past 32 bits), SG_ENOMEM */
sg_status sg_forest_create(size_t nfeatures, size_t nclasses, size_t ntrees, size_t nnodes, size_t nleaves,
                           sg_forest *out, sg_error *err);
/** Free and zero; a zeroed one is fine. */
void sg_forest_clear(sg_forest *f);
/** Do the tables hold what is said above: trees without cycles, every node reached once, numbers in range, finite
 *  thresholds, distributions? @return SG_OK, SG_EINPUT (the sentence says where not) */
sg_status sg_forest_check(const sg_forest *f, sg_error *err);
/** Edges from the root of a tree to its deepest leaf. */
size_t sg_forest_depth(const sg_forest *f, size_t tree);

/** A forest and where the features of pixel p lie: feature k at data[offsets[k] + p]. */
typedef struct sg_forest_view sg_forest_view;

/** @param offsets  [f->nfeatures]; copied. @return SG_OK, SG_ENOMEM; f and data must outlive the view */
sg_status sg_forest_bind(const sg_forest *f, const float *data, const ptrdiff_t *offsets, sg_forest_view **out,
                         sg_error *err);
void sg_forest_view_free(sg_forest_view *v);
const sg_forest *sg_forest_view_forest(const sg_forest_view *v);

/** The leaves that n pixels come to in a tree.
 *  @param pixels  [n] each p as above: y * stride + x in a photograph
 *  @param leaves  out [n] numbers of leaves in the forest */
void sg_forest_find(const sg_forest_view *v, size_t tree, const ptrdiff_t *pixels, size_t n, uint32_t *leaves);

/** Mean of the trees' class probabilities, of n pixels. Summed in the order of the trees.
 *  @param p  out [n][nclasses]
 *  @param leaves  scratch [n] */
void sg_forest_mean(const sg_forest_view *v, const ptrdiff_t *pixels, size_t n, uint32_t *leaves, float *p);

/** Mean of the trees' class probabilities, of every pixel of a photograph.
 *  @param threads  1 or more; the result does not depend on it
 *  @param out  made here: [nclasses][height][width]
 *  @return SG_OK, SG_EINVAL (features of another number), SG_ENOMEM */
sg_status sg_forest_apply(const sg_forest *f, const sg_features *features, int threads, sg_float_map *out,
                          sg_error *err);

#endif
