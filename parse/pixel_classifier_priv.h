/* SPDX-License-Identifier: GPL-3.0-or-later */
/* pixel_classifier_priv.h - what a pixel classifier is made of. */
#ifndef SG_PARSE_PIXEL_CLASSIFIER_PRIV_H
#define SG_PARSE_PIXEL_CLASSIFIER_PRIV_H

#include "parse/forest.h"
#include "parse/pixel_classifier.h"

#include <stdbool.h>

struct sg_pixel_classifier {
    sg_feature_set features;
    sg_classes classes;
    bool balanced; /* the leaves speak for equally frequent classes */
    sg_calibration calibration;
    double frequency[SG_MAX_CLASSES]; /* of the classes that the leaves speak for; sums to 1 */
    sg_forest forest;
};

/** Do its parts fit together? @return SG_OK, SG_EINPUT */
sg_status sg_pixel_classifier_check(const sg_pixel_classifier *c, sg_error *err);

/** Calibrate one pixel: p in and out [nclasses], > 0, sums to 1.
 *  @param shift  [nclasses] exponent * log(frequency), 0 for classes of frequency 0 */
void sg_pixel_calibrate(const sg_calibration *c, const float *shift, size_t nclasses, float *p);
/** @param shift  out [nclasses] */
void sg_pixel_calibration_shift(const sg_calibration *c, const double *frequency, size_t nclasses, float *shift);

#endif
