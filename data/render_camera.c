/* SPDX-License-Identifier: GPL-3.0-or-later */
/* render_camera.c - a hand-held camera with a good but not a perfect lens, and the rectification that followed: a little
 * rotation and perspective are left. */
#include "config.h"

#include "data/render_priv.h"

#include <gsl/gsl_randist.h>
#include <math.h>
#include <stdlib.h>

typedef struct {
    double exposure, contrast, vignette, noise, blur_px;
    double balance[3];
} development;

static development draw_development(sg_canvas *c, const sg_style *s)
{
    development d;
    /* The meter looks at the wall and the light on it. */
    const double wall = s->stone.tint.g * (s->ambient + 0.75 * s->sun);
    d.exposure = 0.5 / wall * exp(0.16 * gsl_ran_ugaussian(c->rng));
    d.contrast = sg_canvas_between(c, 0.9, 1.35);
    d.vignette = sg_canvas_between(c, 0, 0.25);
    d.noise = sg_canvas_between(c, 0.004, 0.016);
    d.blur_px = sg_canvas_between(c, 0.3, 0.65);
    const double warm = 0.07 * gsl_ran_ugaussian(c->rng), green = 0.02 * gsl_ran_ugaussian(c->rng);
    d.balance[0] = 1 + warm;
    d.balance[1] = 1 + green;
    d.balance[2] = 1 - warm;
    return d;
}

/* Rotation about the middle and a keystone, at most about 1.5 px of the photograph at its corners. */
static void draw_perspective(sg_canvas *c, double m[9])
{
    const double angle = 0.004 * gsl_ran_ugaussian(c->rng), cx = 0.5 * (double)c->width, cy = 0.5 * (double)c->height;
    const double gx = 0.006 * gsl_ran_ugaussian(c->rng) / (double)c->width;
    const double gy = 0.006 * gsl_ran_ugaussian(c->rng) / (double)c->height;
    const double a = fmax(-0.008, fmin(0.008, angle));
    /* p -> centre + R (p - centre) / (1 + g (p - centre)) */
    const double w0 = 1 - gx * cx - gy * cy;
    m[6] = gx;
    m[7] = gy;
    m[8] = w0;
    m[0] = 1 + cx * gx;
    m[1] = -a + cx * gy;
    m[2] = cx * w0 - cx + a * cy;
    m[3] = a + cy * gx;
    m[4] = 1 + cy * gy;
    m[5] = cy * w0 - cy - a * cx;
}

/* Linear light to a display value: exposure, a curve with a toe and a shoulder, the display's gamma. */
static double developed(const development *d, double light)
{
    const double v = pow(fmax(0, d->exposure * light), d->contrast) * pow(0.4, 1 - d->contrast);
    const double shouldered = v < 0.6 ? v : 0.6 + 0.4 * (1 - exp(-(v - 0.6) / 0.4));
    return pow(shouldered, 1 / 2.2);
}

static uint8_t byte_of(double v)
{
    return (uint8_t)fmax(0, fmin(255, floor(255 * v + 0.5)));
}

static void expose(sg_painter *p, const development *d, const float *seen, sg_image *out)
{
    gsl_rng *rng = p->canvas.rng;
    for (size_t y = 0; y < out->height; y++) {
        for (size_t x = 0; x < out->width; x++) {
            const size_t i = 3 * (y * out->width + x);
            const double rx = 2 * (double)x / (double)out->width - 1, ry = 2 * (double)y / (double)out->height - 1;
            const double dim = 1 - d->vignette * 0.5 * (rx * rx + ry * ry);
            const double grain = d->noise * gsl_ran_ugaussian(rng);
            for (size_t k = 0; k < 3; k++) {
                const double v = developed(d, seen[i + k] * dim * d->balance[k]);
                out->rgb[i + k] = byte_of(v + grain + 0.5 * d->noise * gsl_ran_ugaussian(rng));
            }
        }
    }
}

sg_status sg_render_camera(sg_painter *p, const float *lit, size_t width, size_t height, sg_image *out, sg_error *err)
{
    sg_canvas *c = &p->canvas;
    const development d = draw_development(c, &p->style);
    double perspective[9];
    draw_perspective(c, perspective);
    float *seen = malloc(3 * width * height * sizeof *seen);
    bool good = seen != NULL && sg_cvdraw_photograph(lit, c->width, c->height, perspective, seen, width, height) &&
                sg_cvdraw_blur(seen, width, height, 3, d.blur_px);
    sg_status st = good ? sg_image_create(width, height, out, err) : SG_FAIL_NOMEM(err);
    if (st == SG_OK)
        expose(p, &d, seen, out);
    free(seen);
    return st;
}
