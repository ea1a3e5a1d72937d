/* SPDX-License-Identifier: GPL-3.0-or-later */
/* render_roof.c - slate in rows or zinc with standing seams; chimneys of brick with their pots. */
#include "config.h"

#include "data/render_priv.h"

#include <math.h>

static void slates(sg_painter *p, sg_box b)
{
    sg_canvas *c = &p->canvas;
    const double high = 1.7 * c->unit, wide = 1.9 * c->unit;
    for (long row = (long)floor(b.y0 / high); (double)row * high < b.y1; row++) {
        for (long column = (long)floor(b.x0 / wide) - 1; (double)column * wide < b.x1; column++) {
            const double x = ((double)column + (row % 2 == 0 ? 0 : 0.5)) * wide, y = (double)row * high;
            const sg_box tile = sg_box_of(fmax(x, b.x0), fmax(y, b.y0), fmin(x + wide, b.x1), fmin(y + high, b.y1));
            if (tile.x1 <= tile.x0 || tile.y1 <= tile.y0)
                continue;
            const size_t i = ((size_t)tile.y0 * c->width + (size_t)tile.x0) % (c->width * c->height);
            sg_canvas_tone(c, tile, fmax(0.6, 1 + 0.16 * c->noise[SG_NOISE_FINE][i]));
            sg_canvas_tone(c, sg_box_of(tile.x0, tile.y1 - 1, tile.x1, tile.y1), 0.72);
        }
    }
}

static void seams(sg_painter *p, sg_box b)
{
    sg_canvas *c = &p->canvas;
    const double step = 6.5 * c->unit;
    for (double x = ceil(b.x0 / step) * step; x < b.x1; x += step) {
        sg_canvas_raise(c, sg_box_of(x, b.y0, x + 2, b.y1), 2);
        sg_canvas_tone(c, sg_box_of(x + 2, b.y0, x + 4, b.y1), 0.86);
    }
}

void sg_paint_roof(sg_painter *p, size_t i)
{
    sg_canvas *c = &p->canvas;
    const sg_box b = p->box[i];
    /* Roofs lean back: they see more of the sky, and the depth says so to what stands before them. */
    sg_canvas_box(c, b, &p->style.roof, -3 * c->unit);
    if (p->style.zinc)
        seams(p, b);
    else
        slates(p, b);
    if (sg_painter_neighbour(p, i, SG_ABOVE, SG_PART_SKY) < p->n) {
        const sg_material ridge = sg_material_of(sg_tint_scaled(p->style.roof.tint, 1.25), 0.03, 0.08, 0.05);
        sg_canvas_box(c, sg_box_of(b.x0, b.y0, b.x1, b.y0 + 1.6 * c->unit), &ridge, -c->unit);
    }
    if (sg_painter_neighbour(p, i, SG_BELOW, SG_PART_WALL) < p->n ||
        sg_painter_neighbour(p, i, SG_BELOW, SG_PART_BALCONY) < p->n) {
        const sg_material gutter = sg_material_of(sg_tint_srgb(0x70767a), 0.03, 0.08, 0.05);
        sg_canvas_box(c, sg_box_of(b.x0, b.y1 - 1.3 * c->unit, b.x1, b.y1), &gutter, 2 * c->unit);
    }
}

static void bricks(sg_painter *p, sg_box b)
{
    sg_canvas *c = &p->canvas;
    for (double y = b.y0; y < b.y1; y += 1.2 * c->unit)
        sg_canvas_tone(c, sg_box_of(b.x0, y, b.x1, y + 1), 0.86);
}

void sg_paint_chimney(sg_painter *p, sg_box b)
{
    sg_canvas *c = &p->canvas;
    const sg_material brick = sg_material_of(sg_tint_varied(c, sg_tint_srgb(0xa98b74), 0.12), 0.05, 0.1, 0.12);
    const sg_material pot = sg_material_of(sg_tint_varied(c, sg_tint_srgb(0xb06a48), 0.1), 0.05, 0.1, 0);
    const double u = c->unit, step = 2.6 * u, rim = fmin(3 * u, 0.35 * (b.y1 - b.y0));
    for (double x = b.x0 + 0.6 * u; x + 1.6 * u < b.x1; x += step)
        sg_canvas_box(c, sg_box_of(x, b.y0 + sg_canvas_between(c, 0, 0.5) * rim, x + 1.5 * u, b.y0 + rim), &pot, 0);
    sg_canvas_box(c, sg_box_of(b.x0, b.y0 + rim, b.x1, b.y1), &brick, 0);
    bricks(p, sg_box_of(b.x0, b.y0 + rim, b.x1, b.y1));
    sg_canvas_box(c, sg_box_of(b.x0, b.y0 + rim, b.x1, b.y0 + rim + u), &p->style.ledge, 1.5 * u);
}
