/* SPDX-License-Identifier: GPL-3.0-or-later */
/* render_stone.c - cut stone in courses, cornices and string courses. */
#include "config.h"

#include "data/render_priv.h"

#include <math.h>

/* A number in [-1,1] that belongs to a block of stone: the stain noise read at a place far from the block. */
static double block_tone(const sg_canvas *c, long row, long column)
{
    const size_t x = (size_t)labs(row * 7919 + column * 104729) % c->width;
    const size_t y = (size_t)labs(row * 15485863 + column * 32452843) % c->height;
    return fmax(-1, fmin(1, 0.5 * c->noise[SG_NOISE_FINE][y * c->width + x]));
}

static void block(sg_painter *p, sg_box b, long row, long column)
{
    sg_canvas *c = &p->canvas;
    sg_canvas_tone(c, b, 1 + 0.055 * block_tone(c, row, column));
    const double joint = p->style.rustication > 1 ? 2 : 1, depth = p->style.rustication;
    sg_canvas_raise(c, sg_box_of(b.x0, b.y1 - joint, b.x1, b.y1), -depth);
    sg_canvas_raise(c, sg_box_of(b.x1 - 1, b.y0, b.x1, b.y1 - joint), -0.8 * depth);
    sg_canvas_tone(c, sg_box_of(b.x0, b.y1 - 1, b.x1, b.y1), 0.84);
    sg_canvas_tone(c, sg_box_of(b.x1 - 1, b.y0, b.x1, b.y1), 0.9);
}

/* Courses and blocks follow the whole house, not the box, so that neighbouring walls join without a seam. */
void sg_paint_wall(sg_painter *p, sg_box b)
{
    sg_canvas *c = &p->canvas;
    sg_canvas_box(c, b, &p->style.stone, 0);
    const double high = p->style.course_px, wide = 2.3 * high;
    for (long row = (long)floor(b.y0 / high); (double)row * high < b.y1; row++) {
        const double shift = row % 2 == 0 ? 0 : wide / 2;
        for (long column = (long)floor((b.x0 - shift) / wide); (double)column * wide + shift < b.x1; column++) {
            const double x = (double)column * wide + shift, y = (double)row * high;
            const sg_box whole = sg_box_of(x, y, x + wide, y + high);
            const sg_box part = sg_box_of(fmax(whole.x0, b.x0), fmax(whole.y0, b.y0), fmin(whole.x1, b.x1),
                                          fmin(whole.y1, b.y1));
            block(p, part, row, column);
        }
    }
}

/* Moulding of three fillets, its upper edge furthest out, with dentils when it is large. */
static void moulding(sg_painter *p, double x0, double x1, double y, double high, double depth)
{
    sg_canvas *c = &p->canvas;
    sg_canvas_box(c, sg_box_of(x0, y, x1, y + high), &p->style.ledge, 0.3 * depth);
    sg_canvas_box(c, sg_box_of(x0, y, x1, y + 0.62 * high), &p->style.ledge, 0.65 * depth);
    sg_canvas_box(c, sg_box_of(x0, y, x1, y + 0.34 * high), &p->style.ledge, depth);
    if (high < 3 * c->unit)
        return;
    const double step = 2.4 * c->unit;
    for (double x = x0 + 0.5 * step; x + 0.5 * step < x1; x += step)
        sg_canvas_box(c, sg_box_of(x, y + 0.62 * high, x + 0.5 * step, y + high), &p->style.ledge, 0.5 * depth);
}

/* A wall below a window row carries a string course, where no window or balcony stands in its way. */
static void string_course(sg_painter *p, size_t i)
{
    const double u = p->canvas.unit;
    const sg_box b = p->box[i];
    if (b.y1 - b.y0 < 5 * u || b.x1 - b.x0 < 2 * u)
        return;
    if (sg_painter_neighbour(p, i, SG_BELOW, SG_PART_SHOP) < p->n)
        moulding(p, b.x0, b.x1, b.y1 - 3.4 * u, 3.4 * u, 2.4 * u);
    else if (p->style.string_courses && sg_painter_neighbour(p, i, SG_ABOVE, SG_PART_WINDOW) < p->n)
        moulding(p, b.x0, b.x1, b.y0 + 0.8 * u, 1.8 * u, 1.2 * u);
}

void sg_paint_ledges(sg_painter *p)
{
    const double u = p->canvas.unit;
    for (size_t i = 0; i < p->n; i++) {
        if (p->part[i] == SG_PART_WALL) {
            string_course(p, i);
            if (sg_painter_neighbour(p, i, SG_ABOVE, SG_PART_ROOF) < p->n)
                moulding(p, p->box[i].x0, p->box[i].x1, p->box[i].y0, 4.2 * u, 3.4 * u);
        }
    }
}
