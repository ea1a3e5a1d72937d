/* SPDX-License-Identifier: GPL-3.0-or-later */
/* jpeg_read.c - JPEG pixels through libjpeg. It mends damaged data with a remark and calls the picture good; here such a
 * remark is a fault. libjpeg leaves by longjmp(), which does not leave this file. */
#include "config.h"

#include "image/jpeg_info.h"

#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <stdnoreturn.h>

#include <jpeglib.h>

#include <jerror.h>

typedef struct {
    struct jpeg_error_mgr base; /* first: libjpeg hands this out */
    jmp_buf leave;
    bool no_memory;
    char why[JMSG_LENGTH_MAX];
} complaint;

typedef struct {
    struct jpeg_decompress_struct libjpeg;
    complaint complaint;
    JSAMPROW row; /* of CMYK; malloc'd */
} reader;

static noreturn void leave(j_common_ptr libjpeg)
{
    complaint *c = (complaint *)libjpeg->err;
    c->no_memory = c->base.msg_code == JERR_OUT_OF_MEMORY;
    c->base.format_message(libjpeg, c->why);
    longjmp(c->leave, 1);
}

/* Level -1 is damage; but these two are about headers whose pixels are sound. */
static void remark(j_common_ptr libjpeg, int level)
{
    const int code = libjpeg->err->msg_code;
    if (level < 0 && code != JWRN_JFIF_MAJOR && code != JWRN_ADOBE_XFORM)
        leave(libjpeg);
}

static void say_nothing(j_common_ptr libjpeg)
{
    (void)libjpeg;
}

/* Adobe's CMYK, which is the one there is, holds the light that is left. */
static void rgb_of_cmyk(const uint8_t *cmyk, size_t width, uint8_t *rgb)
{
    for (size_t x = 0; x < width; x++, cmyk += 4, rgb += 3)
        for (int k = 0; k < 3; k++)
            rgb[k] = (uint8_t)(cmyk[3] - ((255 - cmyk[k]) * cmyk[3] >> 8));
}

static void begin(reader *r, const uint8_t *bytes, size_t n)
{
    struct jpeg_decompress_struct *d = &r->libjpeg;
    jpeg_create_decompress(d);
    jpeg_mem_src(d, bytes, n);
    jpeg_read_header(d, TRUE);
    d->out_color_space = d->num_components == 4 ? JCS_CMYK : JCS_RGB;
    jpeg_start_decompress(d);
}

static void read_rows(reader *r, sg_image *out)
{
    struct jpeg_decompress_struct *d = &r->libjpeg;
    while (d->output_scanline < d->output_height) {
        uint8_t *rgb = out->rgb + 3 * out->width * d->output_scanline;
        JSAMPROW row = r->row != NULL ? r->row : rgb;
        jpeg_read_scanlines(d, &row, 1);
        if (r->row != NULL)
            rgb_of_cmyk(row, out->width, rgb);
    }
    jpeg_finish_decompress(d);
}

/* Between setjmp() and longjmp() no local variable changes. */
static sg_status decode(reader *r, const uint8_t *bytes, size_t n, sg_image *out, sg_error *err)
{
    complaint *c = &r->complaint;
    r->libjpeg.err = jpeg_std_error(&c->base);
    c->base.error_exit = leave;
    c->base.emit_message = remark;
    c->base.output_message = say_nothing;
    if (setjmp(c->leave) != 0)
        return c->no_memory ? SG_FAIL_NOMEM(err) : SG_FAIL(err, SG_EINPUT, "a damaged JPEG file: %s", c->why);
    begin(r, bytes, n);
    if (r->libjpeg.output_width != out->width || r->libjpeg.output_height != out->height)
        return SG_FAIL(err, SG_EINPUT, "a damaged JPEG file: it has two sizes");
    if (r->libjpeg.num_components == 4 && (r->row = malloc(4 * out->width)) == NULL)
        return SG_FAIL_NOMEM(err);
    read_rows(r, out);
    return SG_OK;
}

sg_status sg_jpeg_decode(const uint8_t *bytes, size_t n, sg_image *out, sg_error *err)
{
    reader r = {.row = NULL};
    const sg_status st = decode(&r, bytes, n, out, err);
    jpeg_destroy_decompress(&r.libjpeg);
    free(r.row);
    return st;
}
