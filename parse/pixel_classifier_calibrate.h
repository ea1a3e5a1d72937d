/* SPDX-License-Identifier: GPL-3.0-or-later */
/* pixel_classifier_calibrate.h - fitting the calibration of a forest on pixels that it was not grown on, and scoring.
 * Source: Guo, Pleiss, Sun and Weinberger, "On calibration of modern neural networks" (2017), for the temperature. */
#ifndef SG_PARSE_PIXEL_CLASSIFIER_CALIBRATE_H
#define SG_PARSE_PIXEL_CLASSIFIER_CALIBRATE_H

#include "image/classes.h"
#include "parse/pixel_classifier.h"

/** What a forest says of pixels of known classes. */
typedef struct {
    size_t n, nclasses;
    float *p;         /* [n][nclasses], > 0, rows sum to 1 */
    uint8_t *classes; /* [n] */
} sg_pixel_judgements;

void sg_pixel_judgements_clear(sg_pixel_judgements *j);

/** How often a pixel of a class counts: in accuracy, as classes occur in photographs; in log loss, as they occur in what the
 *  forest is to judge, which differs when that is balanced. */
typedef struct {
    double accuracy[SG_MAX_CLASSES], loss[SG_MAX_CLASSES];
} sg_pixel_weights;

/** How good probabilities are. */
typedef struct {
    double overall;                /* share of the pixels whose most probable class is the true one */
    double class_average;          /* mean recall of the classes that occur */
    double log_loss;               /* mean of -log of the true class's probability, nats */
    double recall[SG_MAX_CLASSES]; /* NaN for a class that does not occur */
} sg_pixel_score;

/** Of calibrated probabilities.
 *  @param frequency  [nclasses] of the classes in the forest's leaves
 *  j->n may be 0: then all is NaN */
sg_pixel_score sg_pixel_score_of(const sg_pixel_judgements *j, const sg_calibration *c, const double *frequency,
                                 const sg_pixel_weights *weights);

#define SG_PIXEL_EXPONENTS 41

/** Accuracy of the most probable classes for each exponent that is tried: 0, 0.025, ..., 1. */
typedef struct {
    double exponent, overall, class_average;
} sg_pixel_tradeoff;

/** Fit. The exponent is that whose most probable classes have the best mean of overall accuracy and class average, the smallest
 *  of equals; the temperature then has the least log loss (Brent's method, in log temperature).
 *  @param fit_exponent  false: it is 0
 *  @param curve  out [SG_PIXEL_EXPONENTS], whether it is fitted or not; or NULL
 *  @param progress  asked whether to stop; or NULL
 *  @return SG_OK, SG_EINVAL (no pixels), SG_ENUMERIC, SG_ENOMEM, SG_STOPPED */
sg_status sg_pixel_calibration_fit(const sg_pixel_judgements *j, const double *frequency,
                                   const sg_pixel_weights *weights, bool fit_exponent, int threads, sg_progress *progress,
                                   sg_pixel_tradeoff *curve, sg_calibration *out, sg_error *err);

#endif
