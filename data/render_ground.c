/* SPDX-License-Identifier: GPL-3.0-or-later */
/* render_ground.c - shop fronts with signs, awnings and goods behind glass; house doors. */
#include "config.h"

#include "data/render_priv.h"

#include <math.h>

static const char *const signs[] = {"CAFE", "TABAC", "BOULANGERIE", "LIVRES", "OPTIQUE", "PHARMACIE", "FLEURS", "BRASSERIE",
                                    "VINS", "PRESSING", "MODE", "COIFFURE", "EPICERIE", "GALERIE", "BANQUE", "HOTEL"};

static void sign(sg_painter *p, sg_box b, sg_tint paint)
{
    sg_canvas *c = &p->canvas;
    const double u = c->unit, high = 0.46 * (b.y1 - b.y0);
    const sg_material board = sg_material_of(paint, 0.02, 0.03, 0.05);
    const bool dark = paint.r + paint.g + paint.b < 0.7F;
    const sg_material ink = sg_material_of(sg_tint_srgb(dark ? 0xe9dfc0 : 0x2a2522), 0.02, 0.03, 0);
    sg_canvas_box(c, b, &board, 1.8 * u);
    sg_canvas_box(c, sg_box_of(b.x0, b.y0, b.x1, b.y0 + 0.7 * u), &board, 2.8 * u);
    const char *text = signs[sg_canvas_pick(c, sizeof signs / sizeof *signs)];
    sg_canvas_shape_begin(c, b);
    const double x = b.x0 + (b.x1 - b.x0) * sg_canvas_between(c, 0.06, 0.2);
    c->failed |= !sg_cvdraw_text(&c->mask, text, x, 0.5 * (b.y0 + b.y1) + 0.5 * high, high, 0.3 * u);
    sg_canvas_shape_end(c, sg_box_inset(b, 2 * u, 0), &ink, 1.9 * u, 0.9);
}

static void goods(sg_painter *p, sg_box b)
{
    sg_canvas *c = &p->canvas;
    const double u = c->unit, h = b.y1 - b.y0;
    for (double x = b.x0 + u; x < b.x1 - u;) {
        const double w = sg_canvas_between(c, 1.2, 5) * u, top = b.y1 - h * sg_canvas_between(c, 0.1, 0.55);
        const sg_tint t = {(float)sg_canvas_between(c, 0.05, 0.4), (float)sg_canvas_between(c, 0.04, 0.26),
                           (float)sg_canvas_between(c, 0.03, 0.18)};
        const sg_material m = sg_material_of(t, 0.02, 0.2, 0);
        sg_canvas_box(c, sg_box_of(x, top, fmin(x + w, b.x1), b.y1), &m, -4 * u);
        x += w + sg_canvas_between(c, 0, 3) * u;
    }
}

static void shop_window(sg_painter *p, sg_box b, sg_tint paint, bool door)
{
    sg_canvas *c = &p->canvas;
    const double u = c->unit;
    const sg_material inside = sg_material_of(sg_tint_srgb(0x2b2622), 0.02, 0.08, 0.12);
    const sg_material post = sg_material_of(paint, 0.02, 0.04, 0.05);
    sg_canvas_box(c, b, &inside, -4 * u);
    const sg_tint lamp = sg_tint_scaled(sg_tint_srgb(0xffd9a0), sg_canvas_chance(c, 0.35) ? 0.16 : 0.03);
    if (!door)
        goods(p, b);
    const sg_tint sky = sg_tint_scaled(p->style.horizon, sg_canvas_between(c, 0.02, 0.12));
    const sg_tint top = {lamp.r + sky.r, lamp.g + sky.g, lamp.b + sky.b};
    sg_canvas_glow(c, b, top, sg_tint_scaled(sky, 0.6), 0.22);
    if (!door) {
        const double plinth = b.y1 - 0.14 * (b.y1 - b.y0);
        sg_canvas_box(c, sg_box_of(b.x0, plinth, b.x1, b.y1), &post, 0.4 * u);
    }
    sg_canvas_box(c, sg_box_of(b.x0, b.y0, b.x1, b.y0 + 0.8 * u), &post, 0);
    sg_canvas_box(c, sg_box_of(b.x0 - 0.9 * u, b.y0, b.x0 + 0.9 * u, b.y1), &post, 0.5 * u);
    sg_canvas_box(c, sg_box_of(b.x1 - 0.9 * u, b.y0, b.x1 + 0.9 * u, b.y1), &post, 0.5 * u);
}

static void awning(sg_painter *p, sg_box b, sg_tint cloth)
{
    sg_canvas *c = &p->canvas;
    const double u = c->unit, drop = b.y1 - b.y0, spread = 1.2 * u, stripe = 4 * u;
    const bool striped = sg_canvas_chance(c, 0.5);
    const sg_material m[2] = {sg_material_of(cloth, 0.02, 0.05, 0.06),
                              sg_material_of(striped ? sg_tint_srgb(0xe8e4d8) : cloth, 0.02, 0.05, 0.06)};
    size_t k = 0;
    for (double x = b.x0; x < b.x1; x += stripe, k++) {
        const double end = fmin(x + stripe, b.x1), middle = 0.5 * (b.x0 + b.x1), half = 0.5 * (b.x1 - b.x0);
        const double lean0 = spread * (x - middle) / half, lean1 = spread * (end - middle) / half;
        const double corners[] = {x, b.y0, end, b.y0, end + lean1, b.y1, x + lean0, b.y1};
        const sg_box around = sg_box_of(x - 2 * spread, b.y0 - 1, end + 2 * spread, b.y1 + 1);
        sg_canvas_shape_begin(c, around);
        c->failed |= !sg_cvdraw_polygon(&c->mask, corners, 4);
        sg_canvas_shape_end(c, around, &m[k % 2], 9 * u, 1);
    }
    sg_canvas_tone(c, sg_box_of(b.x0 - spread, b.y0 + 0.8 * drop, b.x1 + spread, b.y1), 0.75);
}

/* One shop. */
static void front(sg_painter *p, sg_box b)
{
    static const uint32_t paints[] = {0x7c1f22, 0x1f3d2c, 0x1e2f50, 0x2a2a2c, 0xd8d2c2, 0x6a4a2c, 0x93a8b0, 0xb08a3a,
                                      0x3a5a5c, 0xc9c3b8};
    sg_canvas *c = &p->canvas;
    const double u = c->unit, w = b.x1 - b.x0, h = b.y1 - b.y0;
    const sg_tint paint = sg_tint_varied(c, sg_tint_srgb(paints[sg_canvas_pick(c, sizeof paints / sizeof *paints)]), 0.15);
    const double board = b.y0 + h * sg_canvas_between(c, 0.18, 0.28);
    const size_t bays = (size_t)fmax(1, floor(w / (17 * u)));
    const size_t door = sg_canvas_pick(c, bays + 1);
    for (size_t k = 0; k < bays; k++) {
        const double x0 = b.x0 + w * (double)k / (double)bays, x1 = b.x0 + w * (double)(k + 1) / (double)bays;
        shop_window(p, sg_box_of(x0, board, x1, b.y1), paint, k == door);
    }
    sign(p, sg_box_of(b.x0, b.y0, b.x1, board), paint);
    if (sg_canvas_chance(c, 0.45)) {
        const sg_tint cloth = sg_canvas_chance(c, 0.6) ? sg_tint_varied(c, paint, 0.2) : sg_tint_srgb(0xa02c28);
        awning(p, sg_box_of(b.x0 + u, board - 0.4 * u, b.x1 - u, board + h * sg_canvas_between(c, 0.14, 0.3)), cloth);
    }
}

void sg_paint_shop(sg_painter *p, sg_box b)
{
    sg_canvas *c = &p->canvas;
    const double u = c->unit, w = b.x1 - b.x0;
    const size_t n = (size_t)fmax(1, floor(w / (sg_canvas_between(c, 45, 80) * u)));
    sg_canvas_box(c, b, &p->style.ledge, 0);
    for (size_t k = 0; k < n; k++) {
        const double gap = 1.2 * u;
        front(p, sg_box_of(b.x0 + w * (double)k / (double)n + gap, b.y0, b.x0 + w * (double)(k + 1) / (double)n - gap, b.y1));
    }
}

static void leaf(sg_painter *p, sg_box b, const sg_material *wood)
{
    sg_canvas *c = &p->canvas;
    const double u = c->unit, h = b.y1 - b.y0;
    sg_canvas_box(c, b, wood, -3 * u);
    const double cut[] = {0.06, 0.38, 0.44, 0.66, 0.72, 0.95};
    for (size_t k = 0; k < 3; k++) {
        const sg_box panel = sg_box_of(b.x0 + 1.2 * u, b.y0 + cut[2 * k] * h, b.x1 - 1.2 * u, b.y0 + cut[2 * k + 1] * h);
        sg_canvas_raise(c, panel, -0.9 * u);
        sg_canvas_tone(c, panel, 0.86);
    }
}

void sg_paint_door(sg_painter *p, sg_box b)
{
    static const uint32_t woods[] = {0x24382c, 0x4a2e1e, 0x1f2c44, 0x3b2a20, 0x5c1d1c, 0x2c2c2c};
    sg_canvas *c = &p->canvas;
    const double u = c->unit, h = b.y1 - b.y0, x = 0.5 * (b.x0 + b.x1), light = b.y0 + 0.24 * h;
    const sg_tint wood = sg_tint_varied(c, sg_tint_srgb(woods[sg_canvas_pick(c, sizeof woods / sizeof *woods)]), 0.15);
    const sg_material m = sg_material_of(wood, 0.03, 0.08, 0.05), dark = sg_material_of(sg_tint_srgb(0x15191c), 0.02, 0.2, 0);
    sg_canvas_box(c, sg_box_of(b.x0 - 2.2 * u, b.y0 - 2.2 * u, b.x1 + 2.2 * u, b.y1), &p->style.ledge, 1.2 * u);
    sg_canvas_box(c, sg_box_of(x - 1.6 * u, b.y0 - 3.6 * u, x + 1.6 * u, b.y0), &p->style.ledge, 2.4 * u);
    sg_canvas_box(c, sg_box_of(b.x0, b.y0, b.x1, light), &dark, -3.5 * u);
    sg_canvas_glow(c, sg_box_of(b.x0, b.y0, b.x1, light), sg_tint_scaled(p->style.horizon, 0.12),
                   sg_tint_scaled(p->style.horizon, 0.04), 0.3);
    for (double y = b.x0 + 2 * u; y < b.x1; y += 2.4 * u)
        sg_canvas_box(c, sg_box_of(y, b.y0, y + 1, light), &p->style.iron, -2.5 * u);
    leaf(p, sg_box_of(b.x0, light, x - 0.3 * u, b.y1), &m);
    leaf(p, sg_box_of(x + 0.3 * u, light, b.x1, b.y1), &m);
    sg_canvas_box(c, sg_box_of(b.x0, light - 0.5 * u, b.x1, light + 0.6 * u), &m, -2.2 * u);
    const sg_material brass = sg_material_of(sg_tint_srgb(0xb89a4c), 0.02, 0.05, 0);
    sg_canvas_box(c, sg_box_of(x + u, b.y0 + 0.62 * h, x + 1.8 * u, b.y0 + 0.65 * h), &brass, -1.5 * u);
}
