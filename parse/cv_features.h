/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cv_features.h - filters of planes through OpenCV. Borders are repeated. No OpenCV type and no C++ exception passes.
 */
#ifndef SG_PARSE_CV_FEATURES_H
#define SG_PARSE_CV_FEATURES_H

#include "image/image.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A view of floats. The two planes of a call have one size and do not overlap. */
typedef struct {
    float *at;
    size_t width, height;
    size_t stride; /* floats from one row to the next */
} sg_plane;

/** CIE L (0 to 100), a and b of a photograph. @return SG_OK, SG_ENOMEM, as all below; SG_ENUMERIC when OpenCV fails */
sg_status sg_cv_lab(const sg_image *photo, sg_plane lightness, sg_plane a, sg_plane b, sg_error *err);
/** Hue (0 to 360 degrees, 0 for grey), saturation and value (0 to 1). */
sg_status sg_cv_hsv(const sg_image *photo, sg_plane hue, sg_plane saturation, sg_plane value, sg_error *err);
/** Gaussian of this standard deviation, px. */
sg_status sg_cv_gaussian(sg_plane from, sg_plane to, double sigma, sg_error *err);
/** Derivatives by 3 x 3 Scharr kernels, per px: dx times to the right, dy times down; one of them is 1, the other 0. */
sg_status sg_cv_derivative(sg_plane from, sg_plane to, int dx, int dy, sg_error *err);
/** Laplacian, 3 x 3. */
sg_status sg_cv_laplacian(sg_plane from, sg_plane to, sg_error *err);
/** Means of boxes with odd sides. */
sg_status sg_cv_box_mean(sg_plane from, sg_plane to, size_t width, size_t height, sg_error *err);

#ifdef __cplusplus
}
#endif

#endif
