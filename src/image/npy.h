/* SPDX-License-Identifier: GPL-3.0-or-later */
/* npy.h - per-pixel values as NumPy array files (INTERFACES 4): 32-bit floats, shape (channels, height, width) in C
 * order. */
#ifndef SG_IMAGE_NPY_H
#define SG_IMAGE_NPY_H

#include "core/status.h"

#include <stddef.h>

typedef struct {
    size_t channels, height, width;
    float *values; /* [channels][height][width] */
} sg_float_map;

#define SG_NPY_MAX_CHANNELS 256
#define SG_NPY_MAX_VALUES ((size_t)1 << 30)

/** Zeroed values. @return SG_OK, SG_EINVAL (a side is 0 or too large), SG_ENOMEM */
sg_status sg_float_map_create(size_t channels, size_t height, size_t width, sg_float_map *out, sg_error *err);
/** Free and zero; a zeroed one is fine. */
void sg_float_map_clear(sg_float_map *m);

/** Read format versions 1 to 3. The values are taken as they are: NaN and infinities are the caller's to judge.
 *  @return SG_OK, SG_EINPUT (missing, truncated, too long, other type, order or shape: said by name), SG_ENOMEM */
sg_status sg_npy_read(const char *path, sg_float_map *out, sg_error *err);
/** Write format version 1; beside its place and renamed. @return SG_OK, SG_EINVAL, SG_EIO */
sg_status sg_npy_write(const char *path, const sg_float_map *m, sg_error *err);

#endif
