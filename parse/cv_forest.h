/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cv_forest.h - OpenCV's random trees: growing, and its own prediction to compare ours with. No OpenCV type and no C++
 * exception passes. Its trees keep one class a leaf; forest.h makes more of them. */
#ifndef SG_PARSE_CV_FOREST_H
#define SG_PARSE_CV_FOREST_H

#include "core/status.h"

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Samples to grow trees on. Threads may share them. */
typedef struct sg_cv_samples sg_cv_samples;
/** A forest as OpenCV holds it. */
typedef struct sg_cv_forest sg_cv_forest;

#define SG_CV_MAX_DEPTH 25 /* OpenCV grows no deeper */

typedef struct {
    size_t trees;
    size_t depth;    /* of the deepest leaf: 1..SG_CV_MAX_DEPTH; the root alone has depth 0 */
    size_t min_leaf; /* a node of so many samples or fewer is not split */
    size_t active;   /* features that are tried at a node, drawn anew for each; 0: the square root of their number */
} sg_cv_forest_opts;

/** A node of a flattened tree. */
typedef struct {
    int32_t feature;     /* -1: a leaf */
    float threshold;     /* a value <= threshold goes left */
    int32_t left, right; /* -1 in a leaf */
    int32_t label;       /* the class that OpenCV gives what ends here */
} sg_cv_node;

/** Take samples. They are not copied: both arrays must outlive the result.
 *  @param x  [nfeatures][n]
 *  @param classes  [n]
 *  @return SG_OK, SG_EINVAL (nothing, or more than OpenCV's 32-bit sizes hold), SG_ENOMEM */
sg_status sg_cv_samples_create(const float *x, size_t n, size_t nfeatures, const uint8_t *classes, sg_cv_samples **out,
                               sg_error *err);
void sg_cv_samples_free(sg_cv_samples *s);

/** Grow a forest; each tree on n samples drawn from the n with replacement. OpenCV draws from one generator a thread: it is
 *  set to the seed here, so that the forest is a function of samples, options and seed.
 *  @return SG_OK, SG_EINVAL (options out of range), SG_ENUMERIC (OpenCV fails), SG_ENOMEM */
sg_status sg_cv_forest_grow(const sg_cv_samples *s, const sg_cv_forest_opts *opts, uint64_t seed, sg_cv_forest **out,
                            sg_error *err);
void sg_cv_forest_free(sg_cv_forest *f);
size_t sg_cv_forest_trees(const sg_cv_forest *f);
size_t sg_cv_forest_features(const sg_cv_forest *f);

/** One tree: its nodes level by level from the root on, the right child next to the left one. nodes is malloc'd here.
 *  @return SG_OK, SG_EINVAL (no such tree), SG_ENUMERIC (a node of a kind that is not known), SG_ENOMEM */
sg_status sg_cv_forest_tree(const sg_cv_forest *f, size_t tree, sg_cv_node **nodes, size_t *nnodes, sg_error *err);

/** OpenCV's own prediction: the class with most votes, for each of n samples.
 *  @param x  [n][nfeatures]
 *  @param classes  out [n]
 *  @return SG_OK, SG_EINVAL, SG_ENUMERIC, SG_ENOMEM */
sg_status sg_cv_forest_predict(const sg_cv_forest *f, const float *x, size_t n, uint8_t *classes, sg_error *err);
/** OpenCV's own votes. @param votes  out [n][nclasses], by class number */
sg_status sg_cv_forest_votes(const sg_cv_forest *f, const float *x, size_t n, size_t nclasses, int32_t *votes,
                             sg_error *err);

#ifdef __cplusplus
}
#endif

#endif
