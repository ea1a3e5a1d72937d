/* SPDX-License-Identifier: GPL-3.0-or-later */
/* contact_sheet.c - many pictures on one page. */
#include "scene/contact_sheet.h"

#include <string.h>

static void fill(sg_image *im, uint32_t color)
{
    for (size_t y = 0; y < im->height; y++)
        for (size_t x = 0; x < im->width; x++)
            sg_image_set(im, x, y, color);
}

static void put(const sg_image *im, size_t x0, size_t y0, sg_image *sheet)
{
    for (size_t y = 0; y < im->height; y++)
        memcpy(sheet->rgb + 3 * ((y0 + y) * sheet->width + x0), im->rgb + 3 * y * im->width, 3 * im->width);
}

sg_status sg_contact_sheet(const sg_image *pictures, size_t n, const sg_sheet_opts *opts, sg_image *out, sg_error *err)
{
    if (n == 0 || opts->columns == 0 || opts->columns > SG_IMAGE_MAX_SIDE || opts->rows > SG_IMAGE_MAX_SIDE ||
        opts->margin_px > SG_IMAGE_MAX_SIDE)
        return SG_FAIL(err, SG_EINVAL, "a contact sheet of %zu pictures in %zu columns", n, opts->columns);
    if (opts->rows > 0 && n > opts->columns * opts->rows)
        n = opts->columns * opts->rows;
    const size_t rows = opts->rows > 0 ? opts->rows : (n + opts->columns - 1) / opts->columns;
    size_t width = 0, height = 0;
    for (size_t i = 0; i < n; i++) {
        width = pictures[i].width > width ? pictures[i].width : width;
        height = pictures[i].height > height ? pictures[i].height : height;
    }
    const size_t dx = width + opts->margin_px, dy = height + opts->margin_px;
    SG_TRY(sg_image_create(opts->margin_px + opts->columns * dx, opts->margin_px + rows * dy, out, err));
    fill(out, opts->background);
    for (size_t i = 0; i < n; i++) {
        const size_t x = opts->margin_px + i % opts->columns * dx + (width - pictures[i].width) / 2;
        const size_t y = opts->margin_px + i / opts->columns * dy + (height - pictures[i].height) / 2;
        put(pictures + i, x, y, out);
    }
    return SG_OK;
}
