/* SPDX-License-Identifier: GPL-3.0-or-later */
/* render_canvas.h - what a facade is painted on: colour, depth and glow of each point, lit only when all is painted.
 * The canvas is finer than the photograph (`unit` canvas pixels to one of its own) and in linear light. Depth is in canvas
 * pixels, positive towards the viewer, so that recesses, balconies and cornices get their shadows from one light. */
#ifndef SG_DATA_RENDER_CANVAS_H
#define SG_DATA_RENDER_CANVAS_H

#include "core/status.h"
#include "data/cv_draw.h"

#include <gsl/gsl_rng.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct {
    float r, g, b;
} sg_tint;

typedef struct {
    double x0, y0, x1, y1; /* canvas pixels, y down */
} sg_box;

enum { SG_NOISE_FINE, SG_NOISE_MOTTLE, SG_NOISE_STAIN, SG_NOISES };

/** Colour of a surface and how strongly each kind of noise marks it (share of its brightness, one sd). */
typedef struct {
    sg_tint tint;
    float noise[SG_NOISES];
} sg_material;

typedef struct {
    size_t width, height;
    double unit;
    float *albedo;            /* [height][width][3] */
    float *glow;              /* [height][width][3]: light that needs no lamp: sky, reflections in glass */
    float *depth;             /* [height][width] */
    float *noise[SG_NOISES];  /* [height][width], mean 0, sd 1 */
    sg_mask mask;             /* scratch of the shapes */
    gsl_rng *rng;             /* borrowed */
    bool failed;              /* memory ran out on the way: the picture is worthless */
} sg_canvas;

/** @return SG_OK, SG_ENOMEM; free with sg_canvas_clear() in either case */
sg_status sg_canvas_create(sg_canvas *c, size_t width, size_t height, double unit, gsl_rng *rng, sg_error *err);
void sg_canvas_clear(sg_canvas *c);

sg_tint sg_tint_srgb(uint32_t color);                           /* 0xRRGGBB, display values, to linear light */
sg_tint sg_tint_scaled(sg_tint t, double factor);
sg_tint sg_tint_mixed(sg_tint a, sg_tint b, double share_of_b);
/** A tint nearby: brightness and hue vary by about `spread` (a share). */
sg_tint sg_tint_varied(sg_canvas *c, sg_tint t, double spread);
sg_material sg_material_of(sg_tint tint, double fine, double mottle, double stain);

double sg_canvas_between(sg_canvas *c, double low, double high);
bool sg_canvas_chance(sg_canvas *c, double p);
size_t sg_canvas_pick(sg_canvas *c, size_t n);

static inline sg_box sg_box_of(double x0, double y0, double x1, double y1) { return (sg_box){x0, y0, x1, y1}; }
static inline sg_box sg_box_inset(sg_box b, double dx, double dy)
{
    return (sg_box){b.x0 + dx, b.y0 + dy, b.x1 - dx, b.y1 - dy};
}

/** Paint a box at a depth. Edges are rounded to canvas pixels. */
void sg_canvas_box(sg_canvas *c, sg_box b, const sg_material *m, double depth);
/** Add to the depth of what is there. */
void sg_canvas_raise(sg_canvas *c, sg_box b, double by);
/** Multiply the colour of what is there. */
void sg_canvas_tone(sg_canvas *c, sg_box b, double factor);
/** Let a box glow, from one tint at the top to another at the bottom; noise is the share of the mottle noise. */
void sg_canvas_glow(sg_canvas *c, sg_box b, sg_tint top, sg_tint bottom, double noise);

/** Shapes: begin, draw into c->mask with sg_cvdraw_*(), end. The box holds the whole shape. */
void sg_canvas_shape_begin(sg_canvas *c, sg_box b);
void sg_canvas_shape_end(sg_canvas *c, sg_box b, const sg_material *m, double depth, double opacity);

/** A plane of smooth noise, mean 0, sd 1: octaves that halve in size and weight, the first `size_px` wide.
 *  @param plane out [height][width] @return false when memory is out */
bool sg_render_noise(gsl_rng *rng, size_t width, size_t height, double size_px, int octaves, float *plane);

/** Whole pixels of a box inside the canvas. */
typedef struct {
    size_t x0, y0, x1, y1;
} sg_pixels;
sg_pixels sg_canvas_pixels(const sg_canvas *c, sg_box b);

#endif
