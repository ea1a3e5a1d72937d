/* SPDX-License-Identifier: GPL-3.0-or-later */
/* pixel_classifier.h - a random forest over features of photographs, with its classes and its calibration: what
 * learn-unaries writes and apply-unaries and parse-facade read (*.rf). */
#ifndef SG_PARSE_PIXEL_CLASSIFIER_H
#define SG_PARSE_PIXEL_CLASSIFIER_H

#include "core/progress.h"
#include "image/classes.h"
#include "image/npy.h"
#include "parse/dataset.h"
#include "parse/features.h"

#include <stdbool.h>

typedef struct sg_pixel_classifier sg_pixel_classifier; /* immutable; threads share it */

/** What is done to the forest's probabilities p: (p / frequency^exponent)^(1 / temperature), normalised. Frequencies are those
 *  of the classes in the leaves: the exponent moves from classes as they occur (0) to classes on an equal footing (1). */
typedef struct {
    double temperature, exponent;
    bool fitted; /* to photographs that were not trained on; else 1 and 0 */
} sg_calibration;

#define SG_CALIBRATION_NONE {1, 0, false}

/** The classifier of a file: binary, versioned, with a checksum.
 *  @return SG_OK, SG_EINPUT (missing, cut short, too long, no such file, another version, another definition of its features, a
 *          checksum or a table that does not hold: the sentence says which), SG_ENOMEM; *out only on success */
sg_status sg_pixel_classifier_read(const char *path, sg_pixel_classifier **out, sg_error *err);
/** Written beside its place and renamed. @return SG_OK, SG_EIO */
sg_status sg_pixel_classifier_write(const char *path, const sg_pixel_classifier *c, sg_error *err);
void sg_pixel_classifier_free(sg_pixel_classifier *c);

/** Its classes in the order of the channels; borrowed. */
const sg_classes *sg_pixel_classifier_classes(const sg_pixel_classifier *c);
sg_feature_set sg_pixel_classifier_features(const sg_pixel_classifier *c);
sg_calibration sg_pixel_classifier_calibration(const sg_pixel_classifier *c);

typedef struct {
    size_t nfeatures, ntrees, nnodes, nleaves;
} sg_pixel_classifier_sizes;

sg_pixel_classifier_sizes sg_pixel_classifier_sizes_of(const sg_pixel_classifier *c);

/** Class probabilities of every pixel: [classes][height][width], each > 0, sums to 1 over the classes.
 *  @param threads  1 or more; the result does not depend on it
 *  @return SG_OK, SG_EINPUT (a photograph too large: sg_features_create()), SG_ENOMEM; out is made here, sg_float_map_clear() */
sg_status sg_pixel_classifier_apply(const sg_pixel_classifier *c, const sg_image *photo, int threads, sg_float_map *out,
                                    sg_error *err);

#endif
