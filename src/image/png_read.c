/* SPDX-License-Identifier: GPL-3.0-or-later */
/* png_read.c - label maps and pictures from PNG files.
 * libpng leaves on an error by longjmp(). All that its jump could clobber lives in a struct behind a pointer, and the
 * function that calls setjmp() changes no variable of its own, so no value is lost. */
#include "config.h"

#include "image/png_io.h"

#include <errno.h>
#include <png.h>
#include <setjmp.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    const char *path;
    FILE *fp;
    size_t width, height;
    int bit_depth, color_type;
    png_structp png;
    png_infop info;
    uint8_t *pixels; /* where rows go */
    size_t stride;   /* bytes a row */
    bool out_of_memory;
    sg_status status;
    sg_error *err;
} reader;

/* ---- the header, by hand: it costs no decoder and says what is wrong by name ---- */

static size_t get_u32(const unsigned char *p)
{
    return (size_t)p[0] << 24 | (size_t)p[1] << 16 | (size_t)p[2] << 8 | (size_t)p[3];
}

static sg_status read_header(reader *r)
{
    enum { SIZE = 26 }; /* signature 8, chunk length 4, "IHDR" 4, width 4, height 4, depth 1, colour type 1 */
    unsigned char h[SIZE];
    errno = 0;
    const size_t n = fread(h, 1, SIZE, r->fp);
    if (ferror(r->fp))
        return SG_FAIL(r->err, SG_EINPUT, "%s: %s", r->path, strerror(errno));
    if (n == 0)
        return SG_FAIL(r->err, SG_EINPUT, "%s: the file is empty", r->path);
    if (memcmp(h, "\x89PNG\r\n\x1a\n", n < 8 ? n : 8) != 0)
        return SG_FAIL(r->err, SG_EINPUT, "%s: no PNG file", r->path);
    if (n < SIZE)
        return SG_FAIL(r->err, SG_EINPUT, "%s: the file is truncated", r->path);
    if (memcmp(h + 8, "\0\0\0\rIHDR", 8) != 0)
        return SG_FAIL(r->err, SG_EINPUT, "%s: a damaged PNG file: it does not begin with its header", r->path);
    r->width = get_u32(h + 16);
    r->height = get_u32(h + 20);
    r->bit_depth = h[24];
    r->color_type = h[25];
    sg_error inner = SG_ERROR_INIT;
    if (sg_image_check_size(r->width, r->height, &inner) != SG_OK)
        return SG_FAIL(r->err, SG_EINPUT, "%s: %s", r->path, inner.msg);
    rewind(r->fp);
    return SG_OK;
}

static sg_status open_stream(FILE *fp, const char *path, reader *r, sg_error *err)
{
    memset(r, 0, sizeof *r);
    r->path = path;
    r->err = err;
    r->fp = fp;
    const sg_status st = read_header(r);
    if (st != SG_OK)
        fclose(r->fp);
    return st;
}

static sg_status open_file(const char *path, reader *r, sg_error *err)
{
    FILE *fp = fopen(path, "rb");
    return fp != NULL ? open_stream(fp, path, r, err) : SG_FAIL(err, SG_EINPUT, "%s: %s", path, strerror(errno));
}

/* ---- libpng's callbacks ---- */

static void on_error(png_structp png, png_const_charp message)
{
    reader *r = png_get_error_ptr(png);
    if (r->out_of_memory)
        r->status = SG_FAIL_NOMEM(r->err);
    else
        r->status = SG_FAIL(r->err, SG_EINPUT, "%s: %s", r->path, message);
    png_longjmp(png, 1);
}

/* Warnings are about what does not change a pixel. */
static void on_warning(png_structp png, png_const_charp message)
{
    (void)png;
    (void)message;
}

static png_voidp allocate(png_structp png, png_alloc_size_t size)
{
    reader *r = png_get_mem_ptr(png);
    void *p = malloc(size);
    if (p == NULL)
        r->out_of_memory = true;
    return p;
}

static void deallocate(png_structp png, png_voidp p)
{
    (void)png;
    free(p);
}

static void read_bytes(png_structp png, png_bytep to, size_t n)
{
    reader *r = png_get_io_ptr(png);
    errno = 0;
    if (fread(to, 1, n, r->fp) == n)
        return;
    png_error(png, ferror(r->fp) ? strerror(errno) : "the file is truncated");
}

/* ---- decoding ---- */

static bool create_decoder(reader *r)
{
    r->png = png_create_read_struct_2(PNG_LIBPNG_VER_STRING, r, on_error, on_warning, r, allocate, deallocate);
    if (r->png == NULL)
        return false;
    r->info = png_create_info_struct(r->png);
    if (r->info == NULL)
        png_destroy_read_struct(&r->png, NULL, NULL);
    return r->info != NULL;
}

static void decode_header(reader *r)
{
    png_set_read_fn(r->png, r, read_bytes);
    png_set_user_limits(r->png, SG_IMAGE_MAX_SIDE, SG_IMAGE_MAX_SIDE);
    png_set_chunk_cache_max(r->png, 64);
    png_set_chunk_malloc_max(r->png, 1 << 23); /* bytes: text and profiles cannot be bombs */
    /* A damaged file is refused, also where the damage is beside the pixels. */
    png_set_crc_action(r->png, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
    png_read_info(r->png, r->info);
}

/* png_read_row() merges the passes of an interlaced picture into the row, so no second buffer is needed. */
static void decode_rows(reader *r)
{
    const int passes = png_set_interlace_handling(r->png);
    png_read_update_info(r->png, r->info);
    if (png_get_rowbytes(r->png, r->info) != r->stride)
        png_error(r->png, "a pixel format that is not known");
    for (int pass = 0; pass < passes; pass++)
        for (size_t y = 0; y < r->height; y++)
            png_read_row(r->png, r->pixels + y * r->stride, NULL);
    png_read_end(r->png, NULL); /* a file that lacks its end is truncated */
}

static void decode_labels(reader *r)
{
    decode_header(r);
    png_set_packing(r->png); /* 1, 2 and 4 bits become a byte each; values stay */
    decode_rows(r);
}

static void decode_rgba(reader *r)
{
    decode_header(r);
    png_set_expand(r->png);
    png_set_scale_16(r->png);
    png_set_gray_to_rgb(r->png);
    png_set_add_alpha(r->png, 0xff, PNG_FILLER_AFTER);
    decode_rows(r);
}

/* Run a part of the decoding; libpng's jump ends here. */
static sg_status guard(reader *r, void (*decode)(reader *))
{
    if (setjmp(png_jmpbuf(r->png)) == 0)
        decode(r);
    return r->status;
}

/* Decode into pixels of `channels` bytes; pixels is freed on failure. The file is closed. */
static sg_status decode_file(reader *r, size_t channels, void (*decode)(reader *))
{
    r->stride = channels * r->width;
    r->pixels = calloc(r->height, r->stride);
    sg_status st = SG_ENOMEM;
    if (r->pixels != NULL && create_decoder(r)) {
        st = guard(r, decode);
        png_destroy_read_struct(&r->png, &r->info, NULL);
    } else {
        st = SG_FAIL_NOMEM(r->err);
    }
    fclose(r->fp);
    if (st != SG_OK)
        free(r->pixels);
    return st;
}

/* ---- public ---- */

sg_status sg_png_read_size(const char *path, size_t *width, size_t *height, sg_error *err)
{
    reader r;
    SG_TRY(open_file(path, &r, err));
    fclose(r.fp);
    *width = r.width;
    *height = r.height;
    return SG_OK;
}

static sg_status check_label_format(const reader *r)
{
    const char *what = NULL;
    if (r->bit_depth == 16)
        what = "16 bits a channel";
    else if (r->color_type & PNG_COLOR_MASK_ALPHA)
        what = "an alpha channel";
    else if (r->color_type == PNG_COLOR_TYPE_RGB)
        what = "RGB colours";
    if (what == NULL)
        return SG_OK;
    return SG_FAIL(r->err, SG_EINPUT, "%s: a label map must be a grey or palette PNG of at most 8 bits; this has %s",
                   r->path, what);
}

sg_status sg_png_read_labels(const char *path, sg_label_map *out, sg_error *err)
{
    reader r;
    SG_TRY(open_file(path, &r, err));
    const sg_status st = check_label_format(&r);
    if (st != SG_OK) {
        fclose(r.fp);
        return st;
    }
    SG_TRY(decode_file(&r, 1, decode_labels));
    *out = (sg_label_map){r.width, r.height, r.pixels};
    return SG_OK;
}

/* RGBA to RGB over white, in place: the writer never overtakes the reader. */
static void flatten(uint8_t *pixels, size_t npixels)
{
    for (size_t i = 0; i < npixels; i++) {
        const unsigned alpha = pixels[4 * i + 3];
        for (size_t c = 0; c < 3; c++)
            pixels[3 * i + c] = (uint8_t)((pixels[4 * i + c] * alpha + 255u * (255u - alpha) + 127u) / 255u);
    }
}

/* The stream is closed. */
static sg_status read_rgb(reader *r, sg_image *out)
{
    SG_TRY(decode_file(r, 4, decode_rgba));
    flatten(r->pixels, r->width * r->height);
    uint8_t *smaller = realloc(r->pixels, 3 * r->width * r->height);
    *out = (sg_image){r->width, r->height, smaller != NULL ? smaller : r->pixels};
    return SG_OK;
}

sg_status sg_png_read_rgb(const char *path, sg_image *out, sg_error *err)
{
    reader r;
    SG_TRY(open_file(path, &r, err));
    return read_rgb(&r, out);
}

bool sg_png_is(const uint8_t *bytes, size_t n)
{
    return n >= 8 && memcmp(bytes, "\x89PNG\r\n\x1a\n", 8) == 0;
}

sg_status sg_png_decode_rgb(uint8_t *bytes, size_t n, const char *name, sg_image *out, sg_error *err)
{
    reader r;
    FILE *fp = fmemopen(bytes, n, "rb");
    if (fp == NULL)
        return SG_FAIL_NOMEM(err);
    SG_TRY(open_stream(fp, name, &r, err));
    return read_rgb(&r, out);
}
