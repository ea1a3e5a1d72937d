/* SPDX-License-Identifier: GPL-3.0-or-later */
/* evaluation.h - label maps against the truth: confusion matrices, the scores they give, and means over folds.
 *
 * Classes are those of the truth. Pixels whose truth is ignored count nowhere. A pixel that was found to be no class of the
 * truth's, an ignored one among them, is an error: it counts in a column of its own. */
#ifndef SG_PARSE_EVALUATION_H
#define SG_PARSE_EVALUATION_H

#include "core/arena.h"
#include "core/status.h"
#include "image/classes.h"
#include "image/image.h"

#include <stddef.h>
#include <stdint.h>

/** Counts over any number of label maps, px. */
typedef struct {
    size_t nclasses, nmaps;
    uint64_t *counts; /* [nclasses][nclasses + 1]: truth, then found; the last column: no class of the truth's */
    uint64_t ignored; /* pixels whose truth is ignored */
} sg_confusion;

/** All zero, in the arena. @return SG_OK, SG_ENOMEM */
sg_status sg_confusion_create(size_t nclasses, sg_arena *arena, sg_confusion *out, sg_error *err);
/** Count one map.
 *  @param truth     classes below nclasses; anything else is ignored
 *  @param found     pixel values
 *  @param class_of  [256] class of the truth of a pixel value of `found`; nclasses and above: none
 *  @return SG_OK, SG_EINVAL (the sizes differ) */
sg_status sg_confusion_add(sg_confusion *c, const sg_label_map *truth, const sg_label_map *found,
                           const uint8_t class_of[256], sg_error *err);
/** Add the counts of another of as many classes. */
void sg_confusion_merge(const sg_confusion *from, sg_confusion *to);
/** Pixels of a true class. */
uint64_t sg_confusion_pixels(const sg_confusion *c, size_t class);
/** Pixels that were found to be no class of the truth's. */
uint64_t sg_confusion_unclassed(const sg_confusion *c);

/** Which class of the truth a pixel value of a found map is, by name.
 *  @param found     class table of the found map
 *  @param aliases   [naliases] "NAME=OTHER": what was found to be NAME counts as OTHER
 *  @param class_of  out [256]: class of the truth, or SG_CLASS_UNKNOWN
 *  @return SG_OK, SG_EINVAL (an alias without =, of a NAME that the found table has not, or an OTHER that the truth's has not) */
sg_status sg_evaluation_classes(const sg_classes *found, const sg_classes *truth, const char *const *aliases,
                                size_t naliases, uint8_t class_of[256], sg_error *err);

/** Fractions of 1; NAN where there is nothing to divide by. The three arrays lie in one block, in this order. */
typedef struct {
    size_t nclasses;
    double overall;       /* right pixels of all that count */
    double class_average; /* mean recall of the classes that the truth has */
    double mean_iou;      /* mean intersection over union of the classes that the truth has or that were found */
    double *recall;       /* [nclasses] right pixels of the class's; NAN: the truth has none */
    double *iou;          /* [nclasses]; NAN: neither has any */
    double *entries;      /* [nclasses][nclasses + 1] the confusion as shares of the truth; NAN in rows without pixels */
} sg_scores;

/** Scores of one confusion matrix: all its pixels pooled. @return SG_OK, SG_ENOMEM */
sg_status sg_scores_of(const sg_confusion *c, sg_arena *arena, sg_scores *out, sg_error *err);
/** Unweighted means over n > 0 folds, each number over the folds where it is one. @return SG_OK, SG_EINVAL, SG_ENOMEM */
sg_status sg_scores_mean(const sg_scores *folds, size_t n, sg_arena *arena, sg_scores *out, sg_error *err);
/** The convention of the published tables on ECP (the program of Martinovic and Van Gool, "Bayesian Grammar Learning for
 *  Inverse Procedural Modeling", CVPR 2013): each entry of a fold's row-normalised confusion is cut to whole per cent, and
 *  these are averaged over the folds; overall is the mean of the folds' pixel accuracies, which are not cut. Intersections
 *  over unions were not published: NAN. @return SG_OK, SG_EINVAL, SG_ENOMEM */
sg_status sg_scores_published(const sg_confusion *folds, size_t n, sg_arena *arena, sg_scores *out, sg_error *err);

#endif
