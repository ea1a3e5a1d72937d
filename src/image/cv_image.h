/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cv_image.h - photographs through OpenCV: any format that it decodes. No OpenCV type and no C++ exception passes. */
#ifndef SG_IMAGE_CV_IMAGE_H
#define SG_IMAGE_CV_IMAGE_H

#include "image/image.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Decode a photograph to 8-bit RGB (grey is spread, alpha dropped, EXIF rotation ignored: label maps do not have it).
 *  @return SG_OK, SG_EINPUT (missing, truncated, oversized, no picture), SG_ENOMEM */
sg_status sg_photo_read(const char *path, sg_image *out, sg_error *err);
/** JPEG, quality 0-100; written beside its place and renamed. @return SG_OK, SG_EIO */
sg_status sg_photo_write_jpeg(const char *path, const sg_image *im, int quality, sg_error *err);
/** Resize with area averaging (down) or bilinear interpolation (up). out is made here. @return SG_OK, SG_EINVAL, SG_ENOMEM */
sg_status sg_photo_resize(const sg_image *im, size_t width, size_t height, sg_image *out, sg_error *err);

#ifdef __cplusplus
}
#endif

#endif
