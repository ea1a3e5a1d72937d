/* SPDX-License-Identifier: GPL-3.0-or-later */
/* render_balcony.c - a slab on consoles, and before it a railing of wrought iron through which the house is seen. */
#include "config.h"

#include "data/render_priv.h"

#include <math.h>

static void iron_line(sg_canvas *c, double x0, double y0, double x1, double y1, double thick)
{
    c->failed |= !sg_cvdraw_line(&c->mask, x0, y0, x1, y1, thick);
}

static void iron_ring(sg_canvas *c, double x, double y, double rx, double ry, double from, double to)
{
    c->failed |= !sg_cvdraw_arc(&c->mask, x, y, rx, ry, from, to, 1);
}

static void bars(sg_canvas *c, sg_box b, double step)
{
    for (double x = b.x0 + 0.5 * step; x < b.x1; x += step)
        iron_line(c, x, b.y0, x, b.y1, 1);
}

static void rings(sg_canvas *c, sg_box b)
{
    const double r = 0.19 * (b.y1 - b.y0), y = 0.5 * (b.y0 + b.y1);
    for (double x = b.x0 + r; x < b.x1; x += 2.2 * r)
        iron_ring(c, x, y, r, r, 0, 360);
    bars(c, sg_box_of(b.x0, y + r, b.x1, b.y1), 2.2 * r);
    bars(c, sg_box_of(b.x0, b.y0, b.x1, y - r), 2.2 * r);
}

static void crosses(sg_canvas *c, sg_box b)
{
    const double w = 0.8 * (b.y1 - b.y0);
    for (double x = b.x0; x < b.x1; x += w) {
        const double end = fmin(x + w, b.x1);
        iron_line(c, x, b.y0, end, b.y1, 1);
        iron_line(c, x, b.y1, end, b.y0, 1);
        iron_line(c, x, b.y0, x, b.y1, 1);
        iron_ring(c, 0.5 * (x + end), 0.5 * (b.y0 + b.y1), 0.22 * w, 0.22 * w, 0, 360);
    }
}

static void scrolls(sg_canvas *c, sg_box b)
{
    const double w = 0.62 * (b.y1 - b.y0), h = b.y1 - b.y0;
    for (double x = b.x0 + 0.5 * w; x < b.x1; x += w) {
        iron_ring(c, x - 0.22 * w, b.y0 + 0.3 * h, 0.22 * w, 0.2 * h, 90, 400);
        iron_ring(c, x + 0.22 * w, b.y0 + 0.3 * h, 0.22 * w, 0.2 * h, 140, 450);
        iron_ring(c, x, b.y0 + 0.74 * h, 0.3 * w, 0.22 * h, 180, 360);
        iron_line(c, x, b.y0 + 0.2 * h, x, b.y1, 1);
    }
}

static void railing(sg_painter *p, sg_box b)
{
    sg_canvas *c = &p->canvas;
    const double u = c->unit;
    sg_canvas_shape_begin(c, b);
    switch (p->style.railing) {
    case SG_RAILING_RINGS:
        rings(c, b);
        break;
    case SG_RAILING_CROSSES:
        crosses(c, b);
        break;
    case SG_RAILING_SCROLLS:
        scrolls(c, b);
        break;
    default:
        bars(c, b, 1.35 * u);
        break;
    }
    iron_line(c, b.x0, b.y0 + 0.5 * u, b.x1, b.y0 + 0.5 * u, 1.1 * u);
    iron_line(c, b.x0, b.y0 + 0.24 * (b.y1 - b.y0), b.x1, b.y0 + 0.24 * (b.y1 - b.y0), 1);
    iron_line(c, b.x0, b.y1 - 0.6 * u, b.x1, b.y1 - 0.6 * u, 0.7 * u);
    for (double x = b.x0 + 1; x < b.x1; x += 14 * u)
        iron_line(c, x, b.y0, x, b.y1, 0.8 * u);
    iron_line(c, b.x1 - 1, b.y0, b.x1 - 1, b.y1, 0.8 * u);
    sg_canvas_shape_end(c, b, &p->style.iron, 3.4 * u, 0.96);
}

static void consoles(sg_painter *p, sg_box b, double depth)
{
    sg_canvas *c = &p->canvas;
    const double u = c->unit, step = 13 * u;
    const size_t n = (size_t)fmax(2, floor((b.x1 - b.x0) / step));
    for (size_t k = 0; k < n; k++) {
        const double x = b.x0 + (b.x1 - b.x0) * ((double)k + 0.5) / (double)n;
        sg_canvas_box(c, sg_box_of(x - 1.1 * u, b.y1, x + 1.1 * u, b.y1 + 2.2 * u), &p->style.ledge, 0.75 * depth);
        sg_canvas_box(c, sg_box_of(x - 0.9 * u, b.y1 + 2.2 * u, x + 0.9 * u, b.y1 + 3.6 * u), &p->style.ledge, 0.4 * depth);
    }
}

void sg_paint_balcony(sg_painter *p, size_t i)
{
    sg_canvas *c = &p->canvas;
    const sg_box b = p->box[i];
    const double u = c->unit, slab = fmin(2.2 * u, 0.2 * (b.y1 - b.y0)), depth = 4.2 * u;
    const bool on_wall = sg_painter_neighbour(p, i, SG_BELOW, SG_PART_WALL) < p->n;
    if (on_wall && p->style.consoles)
        consoles(p, b, depth);
    sg_canvas_box(c, sg_box_of(b.x0, b.y1 - slab, b.x1, b.y1), &p->style.ledge, depth);
    railing(p, sg_box_of(b.x0, b.y0, b.x1, b.y1 - slab));
}
