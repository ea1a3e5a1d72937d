/* SPDX-License-Identifier: GPL-3.0-or-later */
/* image.h - pictures and label maps in memory, row-major, top row first. */
#ifndef SG_IMAGE_IMAGE_H
#define SG_IMAGE_IMAGE_H

#include "core/status.h"

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** 8-bit interleaved RGB. */
typedef struct {
    size_t width, height;
    uint8_t *rgb; /* [height][width][3] */
} sg_image;

/** One class index per pixel. */
typedef struct {
    size_t width, height;
    uint8_t *labels; /* [height][width] */
} sg_label_map;

/** @return SG_OK, SG_EINVAL (a side is 0 or over SG_IMAGE_MAX_SIDE, or over SG_IMAGE_MAX_PIXELS in all) */
sg_status sg_image_check_size(size_t width, size_t height, sg_error *err);

/** Zeroed pictures. @return SG_OK, SG_EINVAL (as sg_image_check_size), SG_ENOMEM; on failure out is untouched */
sg_status sg_image_create(size_t width, size_t height, sg_image *out, sg_error *err);
sg_status sg_label_map_create(size_t width, size_t height, sg_label_map *out, sg_error *err);
/** Free the pixels and zero the struct; a zeroed one is fine. */
void sg_image_clear(sg_image *im);
void sg_label_map_clear(sg_label_map *m);

/** Give a label to the pixels whose centres lie in a polygon, by the even-odd rule; parts outside are cut off. A
 *  centre on the outline belongs to the polygon at its left and top sides only, so neighbours tile without overlap.
 *  @param xy  [n][2] corners in px, x to the right and y down, (0,0) the upper left corner of the upper left pixel
 *  @return SG_OK, SG_EINVAL (fewer than 3 corners, a coordinate that is no number or over 1e6), SG_ENOMEM
 *  O(rows of the polygon * n) */
sg_status sg_label_map_fill_polygon(sg_label_map *m, const double *xy, size_t n, uint8_t label, sg_error *err);

#define SG_IMAGE_MAX_SIDE 32768   /* px */
#define SG_IMAGE_MAX_PIXELS (1u << 28)

static inline void sg_image_set(sg_image *im, size_t x, size_t y, uint32_t color)
{
    uint8_t *p = im->rgb + 3 * (y * im->width + x);
    p[0] = (uint8_t)(color >> 16);
    p[1] = (uint8_t)(color >> 8);
    p[2] = (uint8_t)color;
}

#ifdef __cplusplus
}
#endif

#endif
