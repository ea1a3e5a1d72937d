/* SPDX-License-Identifier: GPL-3.0-or-later */
/* photo.c - photographs as files: what is checked before a decoder sees them. */
#include "config.h"

#include "core/file.h"
#include "image/cv_image.h"
#include "image/jpeg_info.h"
#include "image/png_io.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { PHOTO_LIMIT = 1 << 28 }; /* bytes of a file */

typedef struct {
    uint8_t *bytes;
    size_t n, width, height;
} jpeg_file;

static sg_status check_jpeg(const char *path, jpeg_file *f, sg_error *err)
{
    sg_error inner = SG_ERROR_INIT;
    if (!sg_jpeg_is(f->bytes, f->n))
        return SG_FAIL(err, SG_EINPUT, "%s: neither a JPEG nor a PNG file", path);
    const sg_status st = sg_jpeg_check(f->bytes, f->n, &f->width, &f->height, &inner);
    return st == SG_OK ? st : SG_FAIL(err, st, "%s: %s", path, inner.msg);
}

static sg_status decode_jpeg(const char *path, const jpeg_file *f, sg_image *out, sg_error *err)
{
    sg_image im;
    sg_error inner = SG_ERROR_INIT;
    SG_TRY(sg_image_create(f->width, f->height, &im, err));
    const sg_status st = sg_jpeg_decode(f->bytes, f->n, &im, &inner);
    if (st != SG_OK) {
        sg_image_clear(&im);
        return st == SG_ENOMEM ? SG_FAIL_NOMEM(err) : SG_FAIL(err, st, "%s: %s", path, inner.msg);
    }
    *out = im;
    return SG_OK;
}

/* Read once from begin to end: a pipe will do. */
static sg_status read_bytes(const char *path, sg_arena *arena, jpeg_file *f, sg_error *err)
{
    char *text;
    SG_TRY(sg_file_read(path, PHOTO_LIMIT, arena, &text, &f->n, err));
    f->bytes = (uint8_t *)text;
    return f->n > 0 ? SG_OK : SG_FAIL(err, SG_EINPUT, "%s: the file is empty", path);
}

static sg_status read_photo(const char *path, sg_arena *arena, sg_image *out, sg_error *err)
{
    jpeg_file f = {NULL, 0, 0, 0};
    SG_TRY(read_bytes(path, arena, &f, err));
    if (sg_png_is(f.bytes, f.n))
        return sg_png_decode_rgb(f.bytes, f.n, path, out, err);
    SG_TRY(check_jpeg(path, &f, err));
    return decode_jpeg(path, &f, out, err);
}

sg_status sg_photo_read(const char *path, sg_image *out, sg_error *err)
{
    sg_arena *arena = sg_arena_create();
    if (arena == NULL)
        return SG_FAIL_NOMEM(err);
    const sg_status st = read_photo(path, arena, out, err);
    sg_arena_free(arena);
    return st;
}

static bool looks_like_png(const char *path)
{
    uint8_t head[8];
    FILE *fp = fopen(path, "rb");
    if (fp == NULL)
        return false;
    const size_t n = fread(head, 1, sizeof head, fp);
    fclose(fp);
    return sg_png_is(head, n);
}

static sg_status read_jpeg_size(const char *path, sg_arena *arena, size_t *width, size_t *height, sg_error *err)
{
    jpeg_file f = {NULL, 0, 0, 0};
    SG_TRY(read_bytes(path, arena, &f, err));
    SG_TRY(check_jpeg(path, &f, err));
    *width = f.width;
    *height = f.height;
    return SG_OK;
}

sg_status sg_photo_read_size(const char *path, size_t *width, size_t *height, sg_error *err)
{
    if (looks_like_png(path))
        return sg_png_read_size(path, width, height, err);
    sg_arena *arena = sg_arena_create();
    if (arena == NULL)
        return SG_FAIL_NOMEM(err);
    const sg_status st = read_jpeg_size(path, arena, width, height, err);
    sg_arena_free(arena);
    return st;
}

sg_status sg_photo_write_jpeg(const char *path, const sg_image *im, int quality, sg_error *err)
{
    uint8_t *bytes = NULL;
    size_t n = 0;
    sg_output out;
    if (quality < 0 || quality > 100)
        return SG_FAIL(err, SG_EINVAL, "a JPEG quality of %d is not between 0 and 100", quality);
    SG_TRY(sg_image_check_size(im->width, im->height, err));
    SG_TRY(sg_cv_encode_jpeg(im, quality, &bytes, &n, err));
    sg_status st = sg_output_open(&out, path, err);
    if (st == SG_OK) {
        fwrite(bytes, 1, n, out.fp);
        st = sg_output_commit(&out, err); /* a failed write shows up here */
    }
    free(bytes);
    return st;
}
