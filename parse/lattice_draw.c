/* SPDX-License-Identifier: GPL-3.0-or-later */
/* lattice_draw.c - lattices as label maps and as pictures. */
#include "parse/lattice_draw.h"

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
