/* SPDX-License-Identifier: GPL-3.0-or-later */
/* render_window.c - casements in their reveals: surround, shutters, frames, glass with what it mirrors, curtains. */
#include "config.h"

#include "data/render_priv.h"

#include <math.h>

static void surround(sg_painter *p, sg_box b, bool dormer)
{
    sg_canvas *c = &p->canvas;
    const double u = c->unit, wide = (dormer ? 2.4 : 1.8) * u;
    const sg_material zinc = sg_material_of(sg_tint_srgb(0xb4b8ba), 0.03, 0.06, 0.08);
    const sg_material *m = dormer ? &zinc : &p->style.ledge;
    const double depth = dormer ? 2.5 * u : 0.5 * u;
    sg_canvas_box(c, sg_box_of(b.x0 - wide, b.y0 - wide, b.x1 + wide, b.y1), m, depth);
    if (dormer) {
        const sg_box cap = sg_box_of(b.x0 - 2 * wide, b.y0 - 3 * wide, b.x1 + 2 * wide, b.y0 - 0.6 * wide);
        sg_canvas_shape_begin(c, cap);
        c->failed |= !sg_cvdraw_arc(&c->mask, 0.5 * (b.x0 + b.x1), b.y0 - 0.7 * wide, 0.5 * (b.x1 - b.x0) + 1.5 * wide,
                                    1.9 * wide, 180, 360, 0);
        sg_canvas_shape_end(c, cap, m, 3.5 * u, 1);
    } else if (p->style.head == SG_HEAD_KEYSTONE) {
        const double x = 0.5 * (b.x0 + b.x1);
        sg_canvas_box(c, sg_box_of(x - 1.3 * u, b.y0 - 3 * u, x + 1.3 * u, b.y0), m, 1.4 * u);
    } else if (p->style.head == SG_HEAD_LINTEL) {
        sg_canvas_box(c, sg_box_of(b.x0 - 2.4 * u, b.y0 - 3.6 * u, b.x1 + 2.4 * u, b.y0 - 2.2 * u), m, 2 * u);
    }
}

static void sill(sg_painter *p, sg_box b)
{
    const double u = p->canvas.unit;
    sg_canvas_box(&p->canvas, sg_box_of(b.x0 - 2.2 * u, b.y1 - 0.4 * u, b.x1 + 2.2 * u, b.y1 + u), &p->style.ledge, 1.6 * u);
}

/* A pane mirrors the sky above the houses across the street, more of it higher up and in some panes than in others. */
static void glass(sg_painter *p, sg_box b, double mirror)
{
    sg_canvas *c = &p->canvas;
    const sg_material dark = sg_material_of(sg_tint_srgb(0x1b2126), 0.02, 0.1, 0.1);
    sg_canvas_box(c, b, &dark, -2.2 * c->unit);
    const sg_tint sky = sg_tint_mixed(p->style.zenith, p->style.horizon, 0.6);
    const double m = mirror * sg_canvas_between(c, 0.6, 1.4);
    sg_canvas_glow(c, b, sg_tint_scaled(sky, m), sg_tint_scaled(sky, 0.3 * m), 0.24);
}

static void curtain(sg_painter *p, sg_box b)
{
    sg_canvas *c = &p->canvas;
    const sg_tint cloth = sg_tint_varied(c, sg_tint_srgb(0xb9b4aa), 0.15);
    const sg_material m = sg_material_of(sg_tint_scaled(cloth, 0.55), 0.02, 0.12, 0);
    const double w = b.x1 - b.x0, h = b.y1 - b.y0;
    sg_box left = b, right = b;
    left.x1 = b.x0 + w * sg_canvas_between(c, 0.16, 0.4);
    right.x0 = b.x1 - w * sg_canvas_between(c, 0.16, 0.4);
    if (sg_canvas_chance(c, 0.4)) { /* a half curtain over the lower panes instead */
        left.x1 = b.x1;
        left.y0 = b.y0 + h * sg_canvas_between(c, 0.35, 0.6);
        right.x0 = b.x1;
    }
    sg_canvas_box(c, left, &m, -2.4 * c->unit);
    sg_canvas_box(c, right, &m, -2.4 * c->unit);
    for (double x = b.x0; x < b.x1; x += 1.1 * c->unit) /* folds; on bare glass they are lost in the dark */
        sg_canvas_tone(c, sg_box_of(x, b.y0, x + 1, b.y1), 0.85);
}

static void casement(sg_painter *p, sg_box b)
{
    sg_canvas *c = &p->canvas;
    const double u = c->unit, depth = -1.6 * u, x = 0.5 * (b.x0 + b.x1), edge = 1.0 * u, thin = fmax(1, 0.55 * u);
    const sg_material *m = &p->style.frame;
    sg_canvas_box(c, sg_box_of(b.x0, b.y0, b.x0 + edge, b.y1), m, depth);
    sg_canvas_box(c, sg_box_of(b.x1 - edge, b.y0, b.x1, b.y1), m, depth);
    sg_canvas_box(c, sg_box_of(b.x0, b.y0, b.x1, b.y0 + edge), m, depth);
    sg_canvas_box(c, sg_box_of(b.x0, b.y1 - edge, b.x1, b.y1), m, depth);
    if (b.x1 - b.x0 > 6 * u)
        sg_canvas_box(c, sg_box_of(x - 0.65 * u, b.y0, x + 0.65 * u, b.y1), m, depth + 0.3 * u);
    for (size_t k = 1; k <= p->style.bars; k++) {
        const double y = b.y0 + (b.y1 - b.y0) * (double)k / (double)(p->style.bars + 1);
        sg_canvas_box(c, sg_box_of(b.x0, y, b.x1, y + thin), m, depth);
    }
}

static void slats(sg_painter *p, sg_box b, double depth)
{
    sg_canvas *c = &p->canvas;
    sg_canvas_box(c, b, &p->style.shutter, depth);
    for (double y = b.y0 + 1; y < b.y1; y += fmax(2, 0.9 * c->unit))
        sg_canvas_tone(c, sg_box_of(b.x0, y, b.x1, y + 1), 0.72);
}

static void shutters(sg_painter *p, sg_box b)
{
    sg_canvas *c = &p->canvas;
    const double w = b.x1 - b.x0, h = b.y1 - b.y0;
    if (sg_canvas_chance(c, 0.05)) { /* nobody at home */
        slats(p, b, -0.5 * c->unit);
        sg_canvas_tone(c, sg_box_of(b.x0 + 0.5 * w - 1, b.y0, b.x0 + 0.5 * w + 1, b.y1), 0.6);
    } else if (p->style.shutters == SG_SHUTTERS_OPEN) {
        slats(p, sg_box_of(b.x0, b.y0, b.x0 + 0.13 * w, b.y1), -0.2 * c->unit);
        slats(p, sg_box_of(b.x1 - 0.13 * w, b.y0, b.x1, b.y1), -0.2 * c->unit);
    } else if (p->style.shutters == SG_SHUTTERS_ROLLED && sg_canvas_chance(c, 0.3)) {
        slats(p, sg_box_of(b.x0, b.y0, b.x1, b.y0 + h * sg_canvas_between(c, 0.12, 0.6)), -0.8 * c->unit);
    }
}

/* Balconies are painted over the foot of the window behind them. */
static sg_box behind_balcony(const sg_painter *p, size_t i, bool *has_balcony)
{
    sg_box b = p->box[i];
    const size_t below = sg_painter_neighbour(p, i, SG_BELOW, SG_PART_BALCONY);
    *has_balcony = below < p->n;
    if (*has_balcony)
        b.y1 = p->box[below].y1 - 0.15 * (p->box[below].y1 - p->box[below].y0);
    return b;
}

void sg_paint_window(sg_painter *p, size_t i)
{
    sg_canvas *c = &p->canvas;
    bool has_balcony = false;
    const sg_box b = behind_balcony(p, i, &has_balcony);
    const bool dormer = sg_painter_neighbour(p, i, SG_LEFT, SG_PART_ROOF) < p->n ||
                        sg_painter_neighbour(p, i, SG_RIGHT, SG_PART_ROOF) < p->n;
    surround(p, b, dormer);
    const bool bright = sg_canvas_chance(c, 0.15);
    glass(p, b, bright ? 0.5 : 0.13);
    if (sg_canvas_chance(c, 0.55))
        curtain(p, sg_box_inset(b, c->unit, c->unit));
    casement(p, b);
    shutters(p, b);
    if (!has_balcony && !dormer)
        sill(p, b);
}
