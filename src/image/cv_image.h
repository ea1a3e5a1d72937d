/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cv_image.h - photographs; coding and resizing through OpenCV. No OpenCV type and no C++ exception passes; what is decoded
 * is found whole and of a bearable size first (photo.c). */
#ifndef SG_IMAGE_CV_IMAGE_H
#define SG_IMAGE_CV_IMAGE_H

#include "image/image.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Decode a photograph, JPEG or PNG, to 8-bit RGB (grey is spread, CMYK converted, transparent parts laid over white,
 *  EXIF rotation ignored: label maps do not have it).
 *  @return SG_OK, SG_EINPUT (missing, truncated, damaged, oversized, no such picture), SG_ENOMEM; on failure out is untouched */
sg_status sg_photo_read(const char *path, sg_image *out, sg_error *err);
/** Size of a photograph without decoding it, but a JPEG's segments are walked to its end. @return as sg_photo_read */
sg_status sg_photo_read_size(const char *path, size_t *width, size_t *height, sg_error *err);
/** JPEG, quality 0-100; written beside its place and renamed. @return SG_OK, SG_EINVAL, SG_EIO, SG_ENOMEM */
sg_status sg_photo_write_jpeg(const char *path, const sg_image *im, int quality, sg_error *err);
/** Resize with area averaging (down) or bilinear interpolation (up), each side as it needs. out is made here.
 *  @return SG_OK, SG_EINVAL, SG_ENOMEM */
sg_status sg_photo_resize(const sg_image *im, size_t width, size_t height, sg_image *out, sg_error *err);

/** The shim's own: code as JPEG; *bytes is malloc'd, the caller frees it. */
sg_status sg_cv_encode_jpeg(const sg_image *im, int quality, uint8_t **bytes, size_t *n, sg_error *err);

#ifdef __cplusplus
}
#endif

#endif
