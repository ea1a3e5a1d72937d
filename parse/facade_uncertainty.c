/* SPDX-License-Identifier: GPL-3.0-or-later */
/* facade_uncertainty.c - what the samples of a search say about a parse: marginals of the labels, lines, a picture of both.
 *
 * The picture shows the photograph pale and grey, red where the samples differ about the label, and the lines of the parse:
 * green where nearly all samples have the line within a pixel or so, orange where they differ about its place or some have
 * no such line, dark red where most have none. */
#include "config.h"

#include "core/file.h"
#include "image/png_io.h"
#include "parse/facade_output_priv.h"

#include <math.h>
#include <stdlib.h>

/* ---- lines ---- */

static void print_number(double x, FILE *out)
{
    if (isnan(x))
        fputs("\t-", out);
    else
        fprintf(out, "\t%.3f", x);
}

static void print_line(const sg_facade_line *l, const sg_classes *classes, FILE *out)
{
    fprintf(out, "%s\t%u\t%u\t%u\t%s\t%s", l->vertical ? "vertical" : "horizontal", (unsigned)l->at, (unsigned)l->from,
            (unsigned)l->to, classes->names[l->before], classes->names[l->after]);
    print_number(l->share, out);
    print_number(l->mean, out);
    print_number(l->sd, out);
    fputc('\n', out);
}

static sg_status write_lines(const sg_facade_report *r, const sg_facade_line *lines, size_t n, sg_error *err)
{
    char path[SG_FACADE_PATH];
    sg_output out;
    SG_TRY(sg_facade_path(r, SG_FACADE_LINES, path, err));
    SG_TRY(sg_output_open(&out, path, err));
    fputs("orientation\tposition\tfrom\tto\tbefore\tafter\tshare\tmean\tsd\n", out.fp);
    for (size_t i = 0; i < n; i++)
        print_line(&lines[i], r->classes, out.fp);
    return sg_output_commit(&out, err);
}

/* ---- the picture ---- */

#define COLOR_SURE 0x00a040
#define COLOR_UNSURE 0xff9000
#define COLOR_DOUBTFUL 0xa00000
static const uint8_t COLOR_HEAT[3] = {255, 30, 30};
static const double HEAT_SHARE = 0.75;  /* of the colour where two labels are equally likely, and above */
static const double PHOTO_SHARE = 0.55; /* the rest is white */

static uint32_t line_color(const sg_facade_line *l)
{
    if (l->share < 0.5)
        return COLOR_DOUBTFUL;
    return l->share >= 0.9 && l->sd <= 1 ? COLOR_SURE : COLOR_UNSURE;
}

static void draw_line(const sg_facade_line *l, sg_image *im)
{
    const uint32_t color = line_color(l);
    for (size_t i = l->from; i < l->to; i++)
        sg_image_set(im, l->vertical ? l->at - 1 : i, l->vertical ? i : l->at - 1, color); /* as overlays have it */
}

/* Brightness of a pixel of the photograph, made pale; without one all is white. */
static double pale(const sg_image *photo, size_t i)
{
    if (photo == NULL)
        return 255;
    const uint8_t *p = photo->rgb + 3 * i;
    return PHOTO_SHARE * (0.299 * p[0] + 0.587 * p[1] + 0.114 * p[2]) + (1 - PHOTO_SHARE) * 255;
}

static sg_status draw_heat(const sg_facade_report *r, const sg_float_map *marginals, sg_image *out, sg_error *err)
{
    sg_float_map entropy;
    SG_TRY(sg_float_map_create(1, r->height, r->width, &entropy, err));
    const sg_status st = sg_image_create(r->width, r->height, out, err);
    if (st == SG_OK) {
        sg_marginals_entropy(marginals, entropy.values);
        for (size_t i = 0; i < r->width * r->height; i++) {
            const double heat = HEAT_SHARE * fmin((double)entropy.values[i] / M_LN2, 1), grey = pale(r->photo, i);
            for (size_t c = 0; c < 3; c++)
                out->rgb[3 * i + c] = (uint8_t)lround((1 - heat) * grey + heat * COLOR_HEAT[c]);
        }
    }
    sg_float_map_clear(&entropy);
    return st;
}

static sg_status write_picture(const sg_facade_report *r, const sg_float_map *marginals, const sg_facade_line *lines,
                               size_t n, sg_error *err)
{
    char path[SG_FACADE_PATH];
    sg_image im;
    SG_TRY(sg_facade_path(r, SG_FACADE_UNCERTAINTY, path, err));
    SG_TRY(draw_heat(r, marginals, &im, err));
    for (size_t i = 0; i < n; i++)
        draw_line(&lines[i], &im);
    const sg_status st = sg_png_write_rgb(path, &im, err);
    sg_image_clear(&im);
    return st;
}

/* ---- all ---- */

static sg_status find_lines(const sg_facade_report *r, sg_facade_line **lines, size_t *n, sg_error *err)
{
    sg_label_map map;
    SG_TRY(sg_facade_raster(r, true, &map, err));
    sg_status st = sg_facade_lines_find(&map, lines, n, err);
    sg_label_map_clear(&map);
    if (st == SG_OK)
        st = sg_facade_lines_judge(*lines, *n, &r->parse->samples, err);
    return st;
}

static sg_status write_marginals(const sg_facade_report *r, const sg_float_map *marginals, sg_error *err)
{
    char path[SG_FACADE_PATH];
    SG_TRY(sg_facade_path(r, SG_FACADE_MARGINALS, path, err));
    return sg_npy_write(path, marginals, err);
}

sg_status sg_facade_write_uncertainty(const sg_facade_report *r, unsigned formats, sg_error *err)
{
    sg_float_map marginals = {0};
    sg_facade_line *lines = NULL;
    size_t n = 0;
    sg_status st = SG_OK;
    if (formats & (SG_FACADE_MARGINALS | SG_FACADE_UNCERTAINTY))
        st = sg_facade_samples_marginals(&r->parse->samples, &marginals, err);
    if (st == SG_OK && (formats & SG_FACADE_MARGINALS))
        st = write_marginals(r, &marginals, err);
    if (st == SG_OK && (formats & (SG_FACADE_LINES | SG_FACADE_UNCERTAINTY)))
        st = find_lines(r, &lines, &n, err);
    if (st == SG_OK && (formats & SG_FACADE_LINES))
        st = write_lines(r, lines, n, err);
    if (st == SG_OK && (formats & SG_FACADE_UNCERTAINTY))
        st = write_picture(r, &marginals, lines, n, err);
    sg_float_map_clear(&marginals);
    free(lines);
    return st;
}
