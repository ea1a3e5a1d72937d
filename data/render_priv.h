/* SPDX-License-Identifier: GPL-3.0-or-later */
/* render_priv.h - what the painters of facade parts share. */
#ifndef SG_DATA_RENDER_PRIV_H
#define SG_DATA_RENDER_PRIV_H

#include "data/render_facade.h"

typedef enum { SG_RAILING_BARS, SG_RAILING_RINGS, SG_RAILING_CROSSES, SG_RAILING_SCROLLS, SG_RAILINGS } sg_railing;
typedef enum { SG_SHUTTERS_NONE, SG_SHUTTERS_OPEN, SG_SHUTTERS_ROLLED, SG_SHUTTERS } sg_shutters;
typedef enum { SG_HEAD_PLAIN, SG_HEAD_KEYSTONE, SG_HEAD_LINTEL, SG_HEADS } sg_head;

/** What one house and one day have in common. */
typedef struct {
    sg_material stone, ledge, iron, frame, roof, shutter;
    bool zinc;
    double course_px;     /* height of a course of stone */
    double rustication;   /* depth of the joints, canvas px */
    sg_railing railing;
    sg_shutters shutters;
    sg_head head;
    bool string_courses, consoles;
    size_t bars;          /* cross bars of a casement */
    sg_tint zenith, horizon; /* of the sky, which glass reflects */
    double clouds;           /* 0 clear, 1 grey */
    double sun_x, sun_y;     /* shadow of a depth of 1, canvas px to the right and down */
    double sun, ambient;     /* strength of direct light and of the sky's */
} sg_style;

typedef struct {
    sg_canvas canvas;
    sg_style style;
    size_t n;
    sg_part *part; /* [n] */
    sg_box *box;   /* [n] canvas pixels, moved a little from where the label map has them */
} sg_painter;

void sg_style_draw(sg_painter *p);

/** Whether an element of that part touches the box on a side (within 2 photograph px, overlapping by over half). */
typedef enum { SG_ABOVE, SG_BELOW, SG_LEFT, SG_RIGHT } sg_side;
/** Index of the touching element, or p->n. */
size_t sg_painter_neighbour(const sg_painter *p, size_t i, sg_side side, sg_part part);

void sg_paint_sky(sg_painter *p);
void sg_paint_wall(sg_painter *p, sg_box b);
void sg_paint_ledges(sg_painter *p); /* cornices and string courses, after the walls */
void sg_paint_roof(sg_painter *p, size_t i);
void sg_paint_chimney(sg_painter *p, sg_box b);
void sg_paint_shop(sg_painter *p, sg_box b);
void sg_paint_door(sg_painter *p, sg_box b);
void sg_paint_window(sg_painter *p, size_t i);
void sg_paint_balcony(sg_painter *p, size_t i);

/** Light falls on the canvas. @param lit out [height][width][3], linear */
sg_status sg_render_light(sg_painter *p, float *lit, sg_error *err);
/** Trees, lamps, cars and people before the house, painted over the lit picture. */
void sg_render_street(sg_painter *p, float *lit);
/** Lens, sensor and development. out is made here, width x height. */
sg_status sg_render_camera(sg_painter *p, const float *lit, size_t width, size_t height, sg_image *out, sg_error *err);

#endif
