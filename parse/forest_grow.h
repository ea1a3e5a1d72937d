/* SPDX-License-Identifier: GPL-3.0-or-later */
/* forest_grow.h - growing the trees of a forest on samples, and filling its leaves with more than it was grown on. */
#ifndef SG_PARSE_FOREST_GROW_H
#define SG_PARSE_FOREST_GROW_H

#include "core/progress.h"
#include "parse/cv_forest.h"
#include "parse/forest.h"

/** Samples with their classes. Free both arrays. */
typedef struct {
    size_t n, nfeatures, nclasses;
    float *x;         /* [nfeatures][n] */
    uint8_t *classes; /* [n] */
} sg_sample_matrix;

typedef struct {
    size_t trees;
    size_t depth;    /* 1..SG_CV_MAX_DEPTH */
    size_t min_leaf; /* a node of so many samples or fewer is not split */
    size_t active;   /* features that are tried at a node; 0: the square root of their number */
    uint64_t seed;
    int threads;
    sg_progress *progress; /* or NULL; it may be called from any thread, one at a time */
} sg_forest_grow_opts;

#define SG_FOREST_GROW_OPTS_INIT {20, 20, 5, 0, 1, 1, NULL}

/** Grow the trees (OpenCV's: parse/cv_forest.h), one after the other in each thread. Tree t is a function of samples,
 *  options and (seed, t). Each leaf gives its class the probability 1 at first, as OpenCV has it: sg_forest_fill().
 *  @param out  made here, also on SG_STOPPED, then with the trees that are done; zeroed when there is none
 *  @return SG_OK, SG_EINVAL (options out of range), SG_ENUMERIC, SG_ENOMEM, SG_STOPPED */
sg_status sg_forest_grow(const sg_sample_matrix *s, const sg_forest_grow_opts *opts, sg_forest *out, sg_error *err);

/** The table of a whole forest of OpenCV's: the mean of its leaves is the share of votes.
 *  @return SG_OK, SG_EINVAL (a label is no class), SG_ENUMERIC, SG_ENOMEM */
sg_status sg_forest_from_cv(const sg_cv_forest *from, size_t nclasses, sg_forest *out, sg_error *err);

/** Send n pixels of known classes down all trees and count where they end. Threads may count into one table.
 *  @param leaves  scratch [n]
 *  @param counts  in and out [nleaves][nclasses] */
void sg_forest_count(const sg_forest_view *v, const ptrdiff_t *pixels, const uint8_t *classes, size_t n,
                     uint32_t *leaves, uint64_t *counts);

/** Set the leaves to the counted classes, each class with its weight, and `smoothing` of each class more (Laplace: 1).
 *  @param weights  [nclasses], > 0
 *  @param smoothing  > 0 */
void sg_forest_fill(sg_forest *f, const uint64_t *counts, const double *weights, double smoothing);

#endif
