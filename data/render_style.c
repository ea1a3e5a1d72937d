/* SPDX-License-Identifier: GPL-3.0-or-later */
/* render_style.c - the house and the day: stone, iron, roof, weather, light. */
#include "config.h"

#include "data/render_priv.h"

#include <math.h>

static sg_tint one_of(sg_canvas *c, const uint32_t *colors, size_t n, double spread)
{
    return sg_tint_varied(c, sg_tint_srgb(colors[sg_canvas_pick(c, n)]), spread);
}
#define ONE_OF(c, colors, spread) one_of((c), (colors), sizeof(colors) / sizeof *(colors), (spread))

static void draw_materials(sg_canvas *c, sg_style *s)
{
    static const uint32_t stones[] = {0xd8c9a8, 0xcfc2a6, 0xe0d6c0, 0xc7b898, 0xb9ad98, 0xd9c59c, 0xe6dfce};
    static const uint32_t irons[] = {0x16181a, 0x1c211f, 0x23262a, 0x15201c};
    static const uint32_t frames[] = {0xe8e6e0, 0xdcd8cc, 0xf0efec, 0xcfc7b4, 0x7a5a40};
    static const uint32_t slates[] = {0x4a525c, 0x555b63, 0x42474e};
    static const uint32_t zincs[] = {0x8c9499, 0x9aa1a5, 0x7c858c};
    static const uint32_t shutters[] = {0xd8d6ce, 0xb5b3ab, 0x8f9894, 0xe4e2da};
    const sg_tint stone = ONE_OF(c, stones, 0.06);
    const double dirt = sg_canvas_between(c, 0.04, 0.16);
    s->stone = sg_material_of(stone, 0.035, 0.045, dirt);
    s->ledge = sg_material_of(sg_tint_scaled(stone, sg_canvas_between(c, 0.98, 1.12)), 0.03, 0.05, dirt);
    s->iron = sg_material_of(ONE_OF(c, irons, 0.1), 0.05, 0.1, 0);
    s->frame = sg_material_of(ONE_OF(c, frames, 0.04), 0.02, 0.03, 0.03);
    s->shutter = sg_material_of(ONE_OF(c, shutters, 0.05), 0.03, 0.05, 0.05);
    s->zinc = sg_canvas_chance(c, 0.45);
    const sg_tint roof = s->zinc ? ONE_OF(c, zincs, 0.08) : ONE_OF(c, slates, 0.08);
    s->roof = sg_material_of(roof, 0.06, 0.1, 0.12);
}

static void draw_ornament(sg_canvas *c, sg_style *s)
{
    s->course_px = c->unit * sg_canvas_between(c, 4.2, 6.2);
    s->rustication = sg_canvas_chance(c, 0.4) ? sg_canvas_between(c, 1.5, 2.6) : sg_canvas_between(c, 0.3, 1);
    s->railing = (sg_railing)sg_canvas_pick(c, SG_RAILINGS);
    s->shutters = (sg_shutters)sg_canvas_pick(c, SG_SHUTTERS);
    s->head = (sg_head)sg_canvas_pick(c, SG_HEADS);
    s->string_courses = sg_canvas_chance(c, 0.7);
    s->consoles = sg_canvas_chance(c, 0.7);
    s->bars = 1 + sg_canvas_pick(c, 3);
}

static void draw_weather(sg_canvas *c, sg_style *s)
{
    s->clouds = sg_canvas_chance(c, 0.4) ? sg_canvas_between(c, 0.75, 1) : sg_canvas_between(c, 0.05, 0.55);
    const sg_tint blue = sg_tint_varied(c, sg_tint_srgb(0x6f9fd8), 0.12), pale = sg_tint_srgb(0xc4d8ea);
    const sg_tint grey = sg_tint_varied(c, sg_tint_srgb(0xd4d8dc), 0.06);
    s->zenith = sg_tint_mixed(blue, grey, s->clouds > 0.7 ? 0.9 : s->clouds * 0.3);
    s->horizon = sg_tint_mixed(pale, grey, s->clouds > 0.7 ? 1 : 0.2);
    const double side = sg_canvas_chance(c, 0.5) ? 1 : -1;
    s->sun_x = side * sg_canvas_between(c, 0.15, 0.9);
    s->sun_y = sg_canvas_between(c, 0.45, 1.1);
    s->sun = s->clouds > 0.7 ? sg_canvas_between(c, 0.1, 0.25) : sg_canvas_between(c, 0.6, 1);
    s->ambient = s->clouds > 0.7 ? sg_canvas_between(c, 0.65, 0.85) : sg_canvas_between(c, 0.32, 0.5);
}

void sg_style_draw(sg_painter *p)
{
    draw_materials(&p->canvas, &p->style);
    draw_ornament(&p->canvas, &p->style);
    draw_weather(&p->canvas, &p->style);
}
