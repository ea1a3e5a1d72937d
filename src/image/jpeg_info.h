/* SPDX-License-Identifier: GPL-3.0-or-later */
/* jpeg_info.h - JPEG files: what one says of itself, without decoding a pixel, and then its pixels. Decoders fill what is
 * missing with grey and call it good, and allocate whatever the header asks for: both is found out here. No libjpeg type
 * passes. */
#ifndef SG_IMAGE_JPEG_INFO_H
#define SG_IMAGE_JPEG_INFO_H

#include "core/status.h"
#include "image/image.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** True when the bytes begin as a JPEG file does. */
bool sg_jpeg_is(const uint8_t *bytes, size_t n);

/** Walk the segments up to the end-of-image marker (ITU T.81, annex B).
 *  @param bytes   [n] the whole file; what follows the end marker is passed over
 *  @param width   out, px; height likewise
 *  @return SG_OK, SG_EINPUT (truncated, damaged, an empty or oversized picture, or more of one than the bytes can hold; the
 *          sentence names no file) */
sg_status sg_jpeg_check(const uint8_t *bytes, size_t n, size_t *width, size_t *height, sg_error *err);

/** Decode what sg_jpeg_check() has passed: grey is spread, CMYK converted, EXIF rotation ignored.
 *  @param out  made for the size that sg_jpeg_check() gave
 *  @return SG_OK, SG_EINPUT (damaged coded data; the sentence names no file), SG_ENOMEM; on failure out holds anything */
sg_status sg_jpeg_decode(const uint8_t *bytes, size_t n, sg_image *out, sg_error *err);

#endif
