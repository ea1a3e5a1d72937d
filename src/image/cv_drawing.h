/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cv_drawing.h - smooth lines, areas and letters on a picture, through OpenCV. No OpenCV type and no C++ exception passes.
 * Coordinates are px, x to the right and y down, (0,0) the upper left corner of the upper left pixel; what is outside is cut. */
#ifndef SG_IMAGE_CV_DRAWING_H
#define SG_IMAGE_CV_DRAWING_H

#include "image/image.h"

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Fill a convex polygon. @param xy  [n][2] corners. @return SG_OK, SG_EINVAL, SG_ENOMEM */
sg_status sg_cv_fill(sg_image *im, const double *xy, size_t n, uint32_t color, sg_error *err);
/** Draw a line through points, back to the first one when closed. @param width_px  rounded, at least 1. @return as above */
sg_status sg_cv_stroke(sg_image *im, const double *xy, size_t n, bool closed, double width_px, uint32_t color, sg_error *err);
/** Write a line of text so that it is centred in a box, as large as fits; what is not ASCII becomes '?', the letter of three
 *  dots "...".
 *  @param letter_px  size of the letters, from which a capital takes 0.7
 *  @param width_px   of the box
 *  @param from_left  begin at its left side instead
 *  @return as above */
sg_status sg_cv_text(sg_image *im, const char *text, double x, double y, double letter_px, double width_px, bool from_left,
                     uint32_t color, sg_error *err);

#ifdef __cplusplus
}
#endif

#endif
