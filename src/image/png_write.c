/* SPDX-License-Identifier: GPL-3.0-or-later */
/* png_write.c - PNG files from label maps and pictures; see png_read.c about libpng's jumps. */
#include "config.h"

#include "core/file.h"
#include "image/png_io.h"

#include <errno.h>
#include <png.h>
#include <setjmp.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    sg_output out;
    png_structp png;
    png_infop info;
    size_t width, height, stride;
    const uint8_t *pixels;
    int color_type;
    png_color palette[256];
    size_t ncolors; /* 0: no palette */
    bool out_of_memory;
    sg_status status;
    sg_error *err;
} writer;

static void on_error(png_structp png, png_const_charp message)
{
    writer *w = png_get_error_ptr(png);
    if (w->out_of_memory)
        w->status = SG_FAIL_NOMEM(w->err);
    else
        w->status = SG_FAIL(w->err, SG_EIO, "%s: %s", w->out.path, ferror(w->out.fp) ? strerror(errno) : message);
    png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp message)
{
    (void)png;
    (void)message;
}

static png_voidp allocate(png_structp png, png_alloc_size_t size)
{
    writer *w = png_get_mem_ptr(png);
    void *p = malloc(size);
    if (p == NULL)
        w->out_of_memory = true;
    return p;
}

static void deallocate(png_structp png, png_voidp p)
{
    (void)png;
    free(p);
}

static void encode(writer *w)
{
    png_init_io(w->png, w->out.fp);
    png_set_IHDR(w->png, w->info, (png_uint_32)w->width, (png_uint_32)w->height, 8, w->color_type, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (w->ncolors > 0)
        png_set_PLTE(w->png, w->info, w->palette, (int)w->ncolors);
    png_write_info(w->png, w->info);
    for (size_t y = 0; y < w->height; y++)
        png_write_row(w->png, w->pixels + y * w->stride);
    png_write_end(w->png, NULL);
}

static sg_status guard(writer *w)
{
    if (setjmp(png_jmpbuf(w->png)) == 0)
        encode(w);
    return w->status;
}

static sg_status write_open_file(writer *w)
{
    w->png = png_create_write_struct_2(PNG_LIBPNG_VER_STRING, w, on_error, on_warning, w, allocate, deallocate);
    if (w->png == NULL)
        return SG_FAIL_NOMEM(w->err);
    w->info = png_create_info_struct(w->png);
    const sg_status st = w->info != NULL ? guard(w) : SG_FAIL_NOMEM(w->err);
    png_destroy_write_struct(&w->png, &w->info);
    return st;
}

static sg_status write_file(const char *path, writer *w)
{
    SG_TRY(sg_image_check_size(w->width, w->height, w->err));
    SG_TRY(sg_output_open(&w->out, path, w->err));
    const sg_status st = write_open_file(w);
    if (st == SG_OK)
        return sg_output_commit(&w->out, w->err);
    sg_output_discard(&w->out);
    return st;
}

sg_status sg_png_write_rgb(const char *path, const sg_image *im, sg_error *err)
{
    writer w;
    memset(&w, 0, sizeof w);
    w.width = im->width;
    w.height = im->height;
    w.stride = 3 * im->width;
    w.pixels = im->rgb;
    w.color_type = PNG_COLOR_TYPE_RGB;
    w.err = err;
    return write_file(path, &w);
}

sg_status sg_png_write_labels(const char *path, const sg_label_map *m, const uint32_t *colors, size_t ncolors,
                              sg_error *err)
{
    if (ncolors == 0 || ncolors > 256)
        return SG_FAIL(err, SG_EINVAL, "%s: a palette of %zu colours: it must have 1 to 256", path, ncolors);
    for (size_t i = 0; i < m->width * m->height; i++)
        if (m->labels[i] >= ncolors)
            return SG_FAIL(err, SG_EINVAL, "%s: label %u has no colour in a palette of %zu", path,
                           (unsigned)m->labels[i], ncolors);
    writer w;
    memset(&w, 0, sizeof w);
    w.width = m->width;
    w.height = m->height;
    w.stride = m->width;
    w.pixels = m->labels;
    w.color_type = PNG_COLOR_TYPE_PALETTE;
    w.ncolors = ncolors;
    for (size_t i = 0; i < ncolors; i++)
        w.palette[i] = (png_color){(png_byte)(colors[i] >> 16), (png_byte)(colors[i] >> 8), (png_byte)colors[i]};
    w.err = err;
    return write_file(path, &w);
}
