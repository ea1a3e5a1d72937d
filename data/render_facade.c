/* SPDX-License-Identifier: GPL-3.0-or-later */
/* render_facade.c - see render_facade.h: the order of painting, and who stands beside whom. */
#include "config.h"

#include "data/render_priv.h"

#include "core/random.h"

#include <gsl/gsl_randist.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { UNIT = 3 }; /* canvas px to one of the photograph */

sg_part sg_part_named(const char *name)
{
    static const char *const names[SG_PARTS] = {"sky", "wall", "roof", "chimney", "shop", "door", "window", "balcony"};
    int part = 0;
    while (part < SG_PARTS && strcmp(names[part], name) != 0)
        part++;
    return (sg_part)part;
}

/* Share of a that b covers, along one axis. */
static double overlap(double a0, double a1, double b0, double b1)
{
    return (fmin(a1, b1) - fmax(a0, b0)) / (a1 - a0);
}

static bool touches(const sg_painter *p, sg_box a, sg_box b, sg_side side)
{
    const double near = 2.5 * p->canvas.unit;
    switch (side) {
    case SG_ABOVE:
        return fabs(b.y1 - a.y0) < near && overlap(a.x0, a.x1, b.x0, b.x1) > 0.5;
    case SG_BELOW:
        return fabs(b.y0 - a.y1) < near && overlap(a.x0, a.x1, b.x0, b.x1) > 0.5;
    case SG_LEFT:
        return fabs(b.x1 - a.x0) < near && overlap(a.y0, a.y1, b.y0, b.y1) > 0.5;
    default:
        return fabs(b.x0 - a.x1) < near && overlap(a.y0, a.y1, b.y0, b.y1) > 0.5;
    }
}

size_t sg_painter_neighbour(const sg_painter *p, size_t i, sg_side side, sg_part part)
{
    for (size_t j = 0; j < p->n; j++)
        if (j != i && p->part[j] == part && touches(p, p->box[i], p->box[j], side))
            return j;
    return p->n;
}

/* The label map is exact; the house was not built so, and its edges are not where the annotator drew them. */
static void move_boxes(sg_painter *p, const sg_facade *f)
{
    gsl_rng *rng = p->canvas.rng;
    const double u = p->canvas.unit;
    for (size_t i = 0; i < f->nelements; i++) {
        const sg_facade_element *e = &f->elements[i];
        const bool loose = e->part == SG_PART_WINDOW || e->part == SG_PART_BALCONY || e->part == SG_PART_DOOR;
        const double sd = loose ? 0.45 : 0;
        const double dx = fmax(-2, fmin(2, sd * gsl_ran_ugaussian(rng))), dy = fmax(-2, fmin(2, sd * gsl_ran_ugaussian(rng)));
        const double dw = 0.3 * sd * gsl_ran_ugaussian(rng);
        p->part[i] = e->part;
        p->box[i] = sg_box_of(u * (e->box.x0 + dx - dw), u * (e->box.y0 + dy), u * (e->box.x1 + dx + dw), u * (e->box.y1 + dy));
    }
}

static void paint_one(sg_painter *p, size_t i)
{
    switch (p->part[i]) {
    case SG_PART_ROOF:
        sg_paint_roof(p, i);
        break;
    case SG_PART_CHIMNEY:
        sg_paint_chimney(p, p->box[i]);
        break;
    case SG_PART_SHOP:
        sg_paint_shop(p, p->box[i]);
        break;
    case SG_PART_DOOR:
        sg_paint_door(p, p->box[i]);
        break;
    case SG_PART_WINDOW:
        sg_paint_window(p, i);
        break;
    case SG_PART_BALCONY:
        sg_paint_balcony(p, i);
        break;
    default:
        break;
    }
}

/* The bare house: what is behind windows, balconies and doors is wall, or roof where they stand in the roof. */
static void paint_ground(sg_painter *p)
{
    for (size_t i = 0; i < p->n; i++) {
        const sg_part part = p->part[i];
        const bool in_roof = sg_painter_neighbour(p, i, SG_ABOVE, SG_PART_ROOF) < p->n ||
                             sg_painter_neighbour(p, i, SG_LEFT, SG_PART_ROOF) < p->n ||
                             sg_painter_neighbour(p, i, SG_RIGHT, SG_PART_ROOF) < p->n;
        const double slack = 2.5 * p->canvas.unit;
        if (part == SG_PART_WALL || part == SG_PART_SHOP)
            sg_paint_wall(p, p->box[i]);
        else if (part == SG_PART_WINDOW || part == SG_PART_BALCONY || part == SG_PART_DOOR)
            in_roof ? sg_paint_roof(p, i) : sg_paint_wall(p, sg_box_inset(p->box[i], -slack, -slack));
    }
    for (size_t i = 0; i < p->n; i++)
        if (p->part[i] == SG_PART_ROOF)
            sg_paint_roof(p, i);
}

static void paint(sg_painter *p)
{
    static const sg_part order[] = {SG_PART_CHIMNEY, SG_PART_SHOP, SG_PART_DOOR, SG_PART_WINDOW, SG_PART_BALCONY};
    sg_paint_sky(p);
    paint_ground(p);
    sg_paint_ledges(p);
    for (size_t k = 0; k < sizeof order / sizeof *order; k++)
        for (size_t i = 0; i < p->n; i++)
            if (p->part[i] == order[k])
                paint_one(p, i);
}

static sg_status photograph(sg_painter *p, const sg_facade *f, sg_image *out, sg_error *err)
{
    float *lit = malloc(3 * p->canvas.width * p->canvas.height * sizeof *lit);
    sg_status st = lit != NULL ? sg_render_light(p, lit, err) : SG_FAIL_NOMEM(err);
    if (st == SG_OK) {
        sg_render_street(p, lit);
        st = p->canvas.failed ? SG_FAIL_NOMEM(err) : sg_render_camera(p, lit, f->width, f->height, out, err);
    }
    free(lit);
    return st;
}

static sg_status render_on(sg_painter *p, const sg_facade *f, gsl_rng *rng, sg_image *out, sg_error *err)
{
    p->n = f->nelements;
    p->part = calloc(p->n, sizeof *p->part);
    p->box = calloc(p->n, sizeof *p->box);
    if (p->part == NULL || p->box == NULL)
        return SG_FAIL_NOMEM(err);
    SG_TRY(sg_canvas_create(&p->canvas, UNIT * f->width, UNIT * f->height, UNIT, rng, err));
    sg_style_draw(p);
    move_boxes(p, f);
    paint(p);
    return photograph(p, f, out, err);
}

sg_status sg_facade_render(const sg_facade *f, uint64_t seed, uint32_t picture, sg_image *out, sg_error *err)
{
    if (f->nelements == 0)
        return SG_FAIL(err, SG_EINVAL, "a facade without elements cannot be rendered");
    gsl_rng *rng = sg_random_create(seed);
    if (rng == NULL)
        return SG_FAIL_NOMEM(err);
    /* Stream 1: the derivation of the picture is stream 0, so that the label map does not depend on the renderer. */
    sg_random_stream(rng, seed, picture, 1);
    sg_painter p;
    memset(&p, 0, sizeof p);
    const sg_status st = render_on(&p, f, rng, out, err);
    sg_canvas_clear(&p.canvas);
    free(p.part);
    free(p.box);
    gsl_rng_free(rng);
    return st;
}
