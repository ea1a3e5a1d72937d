/* SPDX-License-Identifier: GPL-3.0-or-later */
/* lattice_draw.c - lattices as label maps and as pictures. */
#include "parse/lattice_draw.h"

#include "image/classes.h"

#include <string.h>

static void paint_pixel_row(const sg_lattice *l, size_t row, const uint8_t *value_of, uint8_t *pixels)
{
    for (size_t column = 0; column < l->width; column++)
        memset(pixels + (l->x[column] - l->x[0]), value_of[sg_lattice_label(l, column, row)],
               l->x[column + 1] - l->x[column]);
}

sg_status sg_lattice_paint(const sg_lattice *l, const uint8_t *value_of, sg_label_map *out, sg_error *err)
{
    sg_label_map map;
    SG_TRY(sg_label_map_create(l->x[l->width] - l->x[0], l->y[l->height] - l->y[0], &map, err));
    for (size_t row = 0; row < l->height; row++) {
        uint8_t *first = map.labels + (size_t)(l->y[row] - l->y[0]) * map.width;
        paint_pixel_row(l, row, value_of, first);
        for (uint32_t y = l->y[row] + 1; y < l->y[row + 1]; y++)
            memcpy(first + (size_t)(y - l->y[row]) * map.width, first, map.width);
    }
    *out = map;
    return SG_OK;
}

enum { MAX_SCALE = 16, PALE = 75, DARK = 55 }; /* per cent of white, of black */

static uint32_t blend(uint32_t color, uint32_t with, unsigned percent)
{
    uint32_t out = 0;
    for (int shift = 0; shift < 24; shift += 8)
        out |= (((color >> shift & 255) * (100 - percent) + (with >> shift & 255) * percent) / 100) << shift;
    return out;
}

static sg_status make_picture(const sg_lattice *l, size_t scale, sg_image *out, sg_error *err)
{
    if (scale == 0 || scale > MAX_SCALE)
        return SG_FAIL(err, SG_EINVAL, "a lattice is drawn 1 to %d times as large, not %zu", MAX_SCALE, scale);
    return sg_image_create((size_t)(l->x[l->width] - l->x[0]) * scale, (size_t)(l->y[l->height] - l->y[0]) * scale, out,
                           err);
}

static void fill(sg_image *im, size_t x0, size_t y0, size_t x1, size_t y1, uint32_t color)
{
    for (size_t y = y0; y < y1; y++)
        for (size_t x = x0; x < x1; x++)
            sg_image_set(im, x, y, color);
}

/* A cell with the lines at its left and at its top; the outermost ones are the picture's border. */
static void draw_cell(const sg_lattice *l, size_t column, size_t row, uint32_t color, size_t scale, sg_image *im)
{
    const size_t x0 = (l->x[column] - l->x[0]) * scale, x1 = (l->x[column + 1] - l->x[0]) * scale;
    const size_t y0 = (l->y[row] - l->y[0]) * scale, y1 = (l->y[row + 1] - l->y[0]) * scale;
    const uint32_t line = blend(color, 0x000000, DARK);
    fill(im, x0, y0, x1, y1, color);
    if (column > 0)
        fill(im, x0, y0, x0 + 1, y1, line);
    if (row > 0)
        fill(im, x0, y0, x1, y0 + 1, line);
}

sg_status sg_lattice_draw(const sg_lattice *l, const uint32_t *colors, size_t scale, sg_image *out, sg_error *err)
{
    SG_TRY(make_picture(l, scale, out, err));
    for (size_t row = 0; row < l->height; row++)
        for (size_t column = 0; column < l->width; column++)
            draw_cell(l, column, row, colors[sg_lattice_label(l, column, row)], scale, out);
    return SG_OK;
}

static void draw_errors_of_cell(const sg_lattice *l, size_t column, size_t row, uint8_t class,
                                const sg_label_map *truth, const uint32_t *colors, size_t scale, sg_image *im)
{
    for (size_t y = l->y[row] - l->y[0]; y < l->y[row + 1] - l->y[0]; y++)
        for (size_t x = l->x[column] - l->x[0]; x < l->x[column + 1] - l->x[0]; x++) {
            const uint8_t label = truth->labels[y * truth->width + x];
            uint32_t color = blend(colors[class], 0xffffff, PALE);
            if (label == SG_CLASS_IGNORE)
                color = 0x808080;
            else if (label != class)
                color = colors[label];
            fill(im, x * scale, y * scale, (x + 1) * scale, (y + 1) * scale, color);
        }
}

sg_status sg_lattice_draw_errors(const sg_lattice *l, const uint8_t *classes, const sg_label_map *truth,
                                 const uint32_t *colors, size_t scale, sg_image *out, sg_error *err)
{
    if (truth->width != l->x[l->width] - l->x[0] || truth->height != l->y[l->height] - l->y[0])
        return SG_FAIL(err, SG_EINVAL, "a lattice of %lu x %lu pixels over a map of %zu x %zu",
                       (unsigned long)(l->x[l->width] - l->x[0]), (unsigned long)(l->y[l->height] - l->y[0]),
                       truth->width, truth->height);
    SG_TRY(make_picture(l, scale, out, err));
    for (size_t row = 0; row < l->height; row++)
        for (size_t column = 0; column < l->width; column++)
            draw_errors_of_cell(l, column, row, classes[sg_lattice_label(l, column, row)], truth, colors, scale, out);
    return SG_OK;
}
