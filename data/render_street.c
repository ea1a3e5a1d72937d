/* SPDX-License-Identifier: GPL-3.0-or-later */
/* render_street.c - what stands between the camera and the house: trees, lamps, signs, roofs of cars, people. */
#include "config.h"

#include "data/render_priv.h"

#include <math.h>

/* Lay the mask over the lit picture, in one tint with the mottle noise on it. */
static void lay(sg_painter *p, float *lit, sg_box b, sg_tint t, double mottle, double opacity)
{
    const sg_canvas *c = &p->canvas;
    const sg_pixels q = sg_canvas_pixels(c, b);
    const float color[3] = {t.r, t.g, t.b};
    for (size_t y = q.y0; y < q.y1; y++) {
        for (size_t x = q.x0; x < q.x1; x++) {
            const size_t i = y * c->width + x;
            const float a = (float)opacity * (float)c->mask.cover[i] / 255;
            const float s = (float)fmax(0.1, 1 + mottle * c->noise[SG_NOISE_MOTTLE][i]);
            for (size_t k = 0; k < 3; k++)
                lit[3 * i + k] += a * (s * color[k] - lit[3 * i + k]);
        }
    }
}

static sg_tint in_light(const sg_painter *p, uint32_t color, double share)
{
    return sg_tint_scaled(sg_tint_srgb(color), share * (p->style.ambient + p->style.sun));
}

static void blob(sg_painter *p, float *lit, double x, double y, double rx, double ry, sg_tint t, double mottle)
{
    sg_canvas *c = &p->canvas;
    const sg_box around = sg_box_of(x - rx - 2, y - ry - 2, x + rx + 2, y + ry + 2);
    sg_canvas_shape_begin(c, around);
    c->failed |= !sg_cvdraw_arc(&c->mask, x, y, rx, ry, 0, 360, 0);
    lay(p, lit, around, t, mottle, 1);
}

static void slab(sg_painter *p, float *lit, sg_box b, sg_tint t)
{
    sg_canvas *c = &p->canvas;
    const double corners[] = {b.x0, b.y0, b.x1, b.y0, b.x1, b.y1, b.x0, b.y1};
    const sg_box around = sg_box_inset(b, -2, -2);
    sg_canvas_shape_begin(c, around);
    c->failed |= !sg_cvdraw_polygon(&c->mask, corners, 4);
    lay(p, lit, around, t, 0.1, 1);
}

/* Leaves in many small tufts: dark ones first, lit ones last and further up. */
static void tree(sg_painter *p, float *lit)
{
    sg_canvas *c = &p->canvas;
    const double u = c->unit, w = (double)c->width, h = (double)c->height;
    const double x = sg_canvas_chance(c, 0.5) ? sg_canvas_between(c, -0.05, 0.2) * w : sg_canvas_between(c, 0.8, 1.05) * w;
    const double y = h * sg_canvas_between(c, 0.68, 0.82), r = u * sg_canvas_between(c, 14, 26);
    const uint32_t greens[] = {0x1e2c14, 0x34481f, 0x52692c, 0x71853a};
    const bool bare = sg_canvas_chance(c, 0.25);
    slab(p, lit, sg_box_of(x - 1.2 * u, y, x + 1.2 * u, h), in_light(p, 0x3a3129, 0.7));
    const size_t tufts = bare ? 60 : 260;
    for (size_t k = 0; k < tufts; k++) {
        const double angle = sg_canvas_between(c, 0, 2 * M_PI), far = r * sqrt(sg_canvas_between(c, 0, 1));
        const double bx = x + far * cos(angle), by = y + 1.25 * far * sin(angle);
        if (bare) {
            sg_canvas_shape_begin(c, sg_box_of(fmin(x, bx) - 3, fmin(y, by) - 3, fmax(x, bx) + 3, fmax(y, by) + r));
            c->failed |= !sg_cvdraw_line(&c->mask, x, y + 0.4 * r, bx, by, 1);
            lay(p, lit, sg_box_of(fmin(x, bx) - 3, fmin(y, by) - 3, fmax(x, bx) + 3, fmax(y, by) + r),
                in_light(p, 0x453a30, 0.6), 0.2, 0.8);
        } else {
            const size_t tone = (size_t)fmin(3, 4.0 * (double)k / (double)tufts * (by < y ? 1 : 0.7));
            const double size = u * sg_canvas_between(c, 0.9, 2.6);
            blob(p, lit, bx, by, size, 0.8 * size, in_light(p, greens[tone], 0.75), 0.35);
        }
    }
}

static void lamp(sg_painter *p, float *lit)
{
    sg_canvas *c = &p->canvas;
    const double u = c->unit, h = (double)c->height, x = sg_canvas_between(c, 0.05, 0.95) * (double)c->width;
    const double top = h - u * sg_canvas_between(c, 40, 62);
    const sg_tint iron = in_light(p, 0x22302a, 0.8);
    slab(p, lit, sg_box_of(x - 0.6 * u, top + 6 * u, x + 0.6 * u, h), iron);
    slab(p, lit, sg_box_of(x - 1.1 * u, h - 9 * u, x + 1.1 * u, h), iron);
    slab(p, lit, sg_box_of(x - 2 * u, top, x + 2 * u, top + 5.5 * u), in_light(p, 0xd8dcd4, 0.7));
    slab(p, lit, sg_box_of(x - 2.4 * u, top - 0.8 * u, x + 2.4 * u, top + 0.4 * u), iron);
    slab(p, lit, sg_box_of(x - 1.6 * u, top + 5.2 * u, x + 1.6 * u, top + 6.4 * u), iron);
    slab(p, lit, sg_box_of(x - 0.3 * u, top, x + 0.3 * u, top + 5.5 * u), iron);
}

static void outline(sg_painter *p, float *lit, sg_box around, const double *xy, size_t n, sg_tint t, double mottle)
{
    sg_canvas *c = &p->canvas;
    sg_canvas_shape_begin(c, around);
    c->failed |= !sg_cvdraw_polygon(&c->mask, xy, n);
    lay(p, lit, around, t, mottle, 1);
}

/* What is seen of a parked car above the lower edge of the picture: its roof, its windows and some of its doors. */
static void car(sg_painter *p, float *lit, double x)
{
    static const uint32_t paints[] = {0x26282c, 0x8d9296, 0xc4c6c6, 0x5a1416, 0x2a3c5c, 0x4c5054};
    sg_canvas *c = &p->canvas;
    const double u = c->unit, w = u * sg_canvas_between(c, 36, 48), up = u * sg_canvas_between(c, 7, 15);
    const double foot = (double)c->height + u, top = foot - up, belt = top + 6.5 * u, dir = sg_canvas_chance(c, 0.5) ? 1 : -1;
    const double nose = x + (dir > 0 ? 0 : w);
    const sg_tint paint = in_light(p, paints[sg_canvas_pick(c, sizeof paints / sizeof *paints)], 0.85);
    const double body[] = {nose - 0.16 * dir * w, foot, nose - 0.13 * dir * w, belt + 1.6 * u, nose + 0.12 * dir * w, belt,
                           nose + 0.28 * dir * w, top + 0.6 * u, nose + 0.36 * dir * w, top, nose + 0.74 * dir * w, top,
                           nose + 0.83 * dir * w, top + 0.8 * u, nose + 0.97 * dir * w, belt, nose + dir * w, foot};
    const double pane[] = {nose + 0.17 * dir * w, belt, nose + 0.31 * dir * w, top + 1.3 * u, nose + 0.76 * dir * w,
                           top + 1.3 * u, nose + 0.89 * dir * w, belt};
    const sg_box around = sg_box_of(x - 0.2 * w - 2, top - 2, x + 1.2 * w + 2, foot);
    outline(p, lit, around, body, 9, paint, 0.1);
    outline(p, lit, around, pane, 4, sg_tint_mixed(in_light(p, 0x1a2024, 0.8), p->style.horizon, 0.1), 0.4);
    for (int k = 0; k < 2; k++) {
        const double post = nose + (k == 0 ? 0.53 : 0.72) * dir * w;
        slab(p, lit, sg_box_of(post - 0.5 * u, top + u, post + 0.5 * u, belt), paint);
    }
    const double l = fmin(nose + 0.36 * dir * w, nose + 0.74 * dir * w), r = fmax(nose + 0.36 * dir * w, nose + 0.74 * dir * w);
    slab(p, lit, sg_box_of(l, top, r, top + 0.7 * u), sg_tint_mixed(paint, p->style.horizon, 0.35));
}

static void person(sg_painter *p, float *lit)
{
    static const uint32_t clothes[] = {0x23252b, 0x4a3b36, 0x7a2f2f, 0x2d3f5c, 0x8a8478, 0xc8c2b4};
    sg_canvas *c = &p->canvas;
    const double u = c->unit, x = sg_canvas_between(c, 0.05, 0.95) * (double)c->width, tall = u * sg_canvas_between(c, 17, 21);
    const double foot = (double)c->height + u * sg_canvas_between(c, 0, 5), head = foot - tall;
    const sg_tint coat = in_light(p, clothes[sg_canvas_pick(c, sizeof clothes / sizeof *clothes)], 0.7);
    blob(p, lit, x, head + 0.36 * tall, 0.13 * tall, 0.24 * tall, coat, 0.2);
    blob(p, lit, x - 0.05 * tall, head + 0.78 * tall, 0.055 * tall, 0.26 * tall, in_light(p, 0x24262e, 0.7), 0.1);
    blob(p, lit, x + 0.05 * tall, head + 0.78 * tall, 0.055 * tall, 0.26 * tall, in_light(p, 0x24262e, 0.7), 0.1);
    blob(p, lit, x, head + 0.07 * tall, 0.055 * tall, 0.075 * tall, in_light(p, 0xb58c74, 0.7), 0.1);
}

void sg_render_street(sg_painter *p, float *lit)
{
    sg_canvas *c = &p->canvas;
    for (size_t n = sg_canvas_pick(c, 4); n > 0; n--)
        person(p, lit);
    if (sg_canvas_chance(c, 0.3))
        tree(p, lit);
    if (sg_canvas_chance(c, 0.35))
        lamp(p, lit);
    if (sg_canvas_chance(c, 0.55))
        for (double x = sg_canvas_between(c, -30, 10) * c->unit; x < (double)c->width; x += 50 * c->unit)
            if (sg_canvas_chance(c, 0.6))
                car(p, lit, x + sg_canvas_between(c, -2, 8) * c->unit);
}
