/* SPDX-License-Identifier: GPL-3.0-or-later */
/* jpeg_info.h - what a JPEG file says of itself, without decoding a pixel: its size, and whether it is whole. Decoders
 * fill what is missing with grey and call it good, and allocate whatever the header asks for. */
#ifndef SG_IMAGE_JPEG_INFO_H
#define SG_IMAGE_JPEG_INFO_H

#include "core/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** True when the bytes begin as a JPEG file does. */
bool sg_jpeg_is(const uint8_t *bytes, size_t n);

/** Walk the segments up to the end-of-image marker (ITU T.81, annex B).
 *  @param bytes   [n] the whole file; what follows the end marker is passed over
 *  @param width   out, px; height likewise
 *  @return SG_OK, SG_EINPUT (truncated, damaged, an empty or oversized picture; the sentence names no file) */
sg_status sg_jpeg_check(const uint8_t *bytes, size_t n, size_t *width, size_t *height, sg_error *err);

#endif
