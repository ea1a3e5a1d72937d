/* SPDX-License-Identifier: GPL-3.0-or-later */
/* pixel_classifier_learn.h - from annotated photographs to a pixel classifier.
 *
 * A sample of pixels grows the trees; then all pixels of the training photographs go down them and fill the leaves; then the
 * probabilities are calibrated on the validation photographs. */
#ifndef SG_PARSE_PIXEL_CLASSIFIER_LEARN_H
#define SG_PARSE_PIXEL_CLASSIFIER_LEARN_H

#include "parse/forest_grow.h"
#include "parse/pixel_classifier_calibrate.h"

typedef struct {
    sg_feature_set features;
    sg_forest_grow_opts grow; /* its seed, threads and progress are those of everything */
    size_t pixels;            /* of the sample */
    bool balanced;            /* as many of each class in the sample, and each class with equal weight in the leaves */
    double smoothing;         /* pixels of each class that every leaf has besides; > 0 */
} sg_pixel_learn_opts;

#define SG_PIXEL_LEARN_OPTS_INIT                                                                                       \
    {{SG_FEATURES_RICH, 0, 0}, SG_FOREST_GROW_OPTS_INIT, 200000, false, 1}

/** What came of it. */
typedef struct {
    size_t train_images, valid_images;
    uint64_t train_pixels[SG_MAX_CLASSES];  /* of each class in the training photographs */
    uint64_t sample_pixels[SG_MAX_CLASSES]; /* and in the sample */
    size_t valid_pixels;                    /* that the calibration saw */
    sg_pixel_score valid_before, valid;     /* on these pixels, before and after calibration */
    sg_pixel_tradeoff curve[SG_PIXEL_EXPONENTS];
    uint64_t *uses;                         /* [features] nodes that ask for each feature; malloc'd */
    double sample_s, grow_s, fill_s, valid_s; /* wall-clock time of the steps, seconds */
} sg_pixel_learn_report;

void sg_pixel_learn_report_clear(sg_pixel_learn_report *r);

/** Learn. Classes that occur in no training photograph keep what smoothing gives them.
 *  @param valid  NULL or empty: the calibration is SG_CALIBRATION_NONE
 *  @return SG_OK; SG_STOPPED: a classifier of the trees grown so far, filled and calibrated as far as it got; *out is NULL when
 *          no tree was grown; SG_EINVAL (options out of range), SG_EINPUT (a photograph changed since it was opened, or is too
 *          large), SG_ENUMERIC, SG_ENOMEM */
sg_status sg_pixel_classifier_learn(const sg_dataset *train, const sg_dataset *valid, const sg_pixel_learn_opts *opts,
                                    sg_pixel_classifier **out, sg_pixel_learn_report *report, sg_error *err);

#endif
