/* SPDX-License-Identifier: GPL-3.0-or-later */
/* png_io.h - PNG files through libpng. No libpng type stands in a header of ours. */
#ifndef SG_IMAGE_PNG_IO_H
#define SG_IMAGE_PNG_IO_H

#include "image/image.h"

#include <stdbool.h>

/** Read a label map: 8-bit (or less) grey or palette PNG, the pixel value (palette index) is kept as it is.
 *  @return SG_OK, SG_EINPUT (missing, truncated, oversized, 16-bit, RGB or alpha: said by name), SG_ENOMEM */
sg_status sg_png_read_labels(const char *path, sg_label_map *out, sg_error *err);
/** Read any PNG as 8-bit RGB: palettes are expanded, 16 bits cut to 8, alpha laid over white; colour
 *  profiles and gamma are ignored, so colours that stand for labels are not changed. @return as above */
sg_status sg_png_read_rgb(const char *path, sg_image *out, sg_error *err);
/** The same of a file in memory: n > 0 bytes, which stay as they are. @param name  for messages @return as above */
sg_status sg_png_decode_rgb(uint8_t *bytes, size_t n, const char *name, sg_image *out, sg_error *err);
/** Do the bytes begin as those of a PNG file? */
bool sg_png_is(const uint8_t *bytes, size_t n);
/** Size of a PNG from its header only. @return SG_OK, SG_EINPUT */
sg_status sg_png_read_size(const char *path, size_t *width, size_t *height, sg_error *err);

/** Write RGB; written beside its place and renamed. @return SG_OK, SG_EIO, SG_ENOMEM */
sg_status sg_png_write_rgb(const char *path, const sg_image *im, sg_error *err);
/** Write a palette PNG: pixel values are the labels; colors 0xRRGGBB for values 0..ncolors-1 (at most 256).
 *  @return SG_OK, SG_EINVAL (a label without a colour, no or too many colours), SG_EIO, SG_ENOMEM */
sg_status sg_png_write_labels(const char *path, const sg_label_map *m, const uint32_t *colors, size_t ncolors,
                              sg_error *err);

#endif
