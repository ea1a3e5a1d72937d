/* SPDX-License-Identifier: GPL-3.0-or-later */
/* polygon.c - polygons into label maps, row by row.
 * OpenCV's fillPoly() is not used: it rounds corners to rows and draws the outline too, so a hand-drawn facade gains
 * half a pixel on each side, and two that share a side overlap. */
#include "config.h"

#include "image/image.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Where the sides cross the horizontal line at y, in order. A side is always walked downwards, so that two polygons get
 * the very same number for a side that they share. */
static size_t crossings(const double *xy, size_t n, double y, double *out)
{
    size_t count = 0;
    for (size_t i = 0, j = n - 1; i < n; j = i++) {
        const double *top = xy + 2 * i, *bottom = xy + 2 * j;
        if (top[1] > bottom[1]) {
            const double *t = top;
            top = bottom;
            bottom = t;
        }
        if (top[1] <= y && y < bottom[1])
            out[count++] = top[0] + (bottom[0] - top[0]) * ((y - top[1]) / (bottom[1] - top[1]));
    }
    qsort(out, count, sizeof *out, compare_doubles);
    return count;
}

/* Index of the first pixel whose centre is not before x, within 0..width. */
static size_t first_centre(double x, size_t width)
{
    const double index = ceil(x - 0.5);
    return index <= 0 ? 0 : index >= (double)width ? width : (size_t)index;
}

static void fill_rows(sg_label_map *m, const double *xy, size_t n, uint8_t label, double *scratch)
{
    double low = xy[1], high = xy[1];
    for (size_t i = 1; i < n; i++) {
        low = fmin(low, xy[2 * i + 1]);
        high = fmax(high, xy[2 * i + 1]);
    }
    const size_t end = first_centre(high, m->height);
    for (size_t y = first_centre(low, m->height); y < end; y++) {
        const size_t count = crossings(xy, n, (double)y + 0.5, scratch);
        for (size_t k = 0; k + 1 < count; k += 2) {
            const size_t x0 = first_centre(scratch[k], m->width), x1 = first_centre(scratch[k + 1], m->width);
            memset(m->labels + y * m->width + x0, label, x1 - x0);
        }
    }
}

sg_status sg_label_map_fill_polygon(sg_label_map *m, const double *xy, size_t n, uint8_t label, sg_error *err)
{
    if (n < 3)
        return SG_FAIL(err, SG_EINVAL, "a polygon of %zu corners", n);
    for (size_t i = 0; i < 2 * n; i++)
        if (!(fabs(xy[i]) <= 1e6))
            return SG_FAIL(err, SG_EINVAL, "a polygon with a corner at %g", xy[i]);
    double *scratch = calloc(n, sizeof *scratch);
    if (scratch == NULL)
        return SG_FAIL_NOMEM(err);
    fill_rows(m, xy, n, label, scratch);
    free(scratch);
    return SG_OK;
}
