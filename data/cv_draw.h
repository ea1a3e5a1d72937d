/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cv_draw.h - shapes with soft edges, blur, resizing and perspective, through OpenCV. No OpenCV type and no C++ exception
 * passes. Every call returns false when memory is out, and true otherwise. */
#ifndef SG_DATA_CV_DRAW_H
#define SG_DATA_CV_DRAW_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** A mask: 0 outside the shape, 255 inside, between them along its edge. */
typedef struct {
    size_t width, height;
    uint8_t *cover; /* [height][width] */
} sg_mask;

/** Filled polygon. @param xy [n][2] pixel coordinates */
bool sg_cvdraw_polygon(sg_mask *m, const double *xy, size_t n);
/** Line of a thickness of at least 1 px. */
bool sg_cvdraw_line(sg_mask *m, double x0, double y0, double x1, double y1, double thickness);
/** Arc of an ellipse, degrees clockwise from the right; filled when thickness is 0. */
bool sg_cvdraw_arc(sg_mask *m, double x, double y, double rx, double ry, double from, double to, double thickness);
/** Text whose capitals are `height` px high, beginning at (x, y) on the base line. */
bool sg_cvdraw_text(sg_mask *m, const char *text, double x, double y, double height, double thickness);

/** Gaussian blur in place. @param plane [height][width][channels], at most 4 channels */
bool sg_cvdraw_blur(float *plane, size_t width, size_t height, int channels, double sigma_px);
/** Bicubic enlargement of one plane. */
bool sg_cvdraw_enlarge(const float *from, size_t from_width, size_t from_height, float *to, size_t width, size_t height);
/** RGB seen through a perspective (row-major 3x3, from canvas to canvas), then reduced by area averaging. */
bool sg_cvdraw_photograph(const float *from, size_t from_width, size_t from_height, const double perspective[9],
                          float *to, size_t width, size_t height);

#ifdef __cplusplus
}
#endif

#endif
