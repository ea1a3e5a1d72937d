/* SPDX-License-Identifier: GPL-3.0-or-later */
/* render_light.c - one sun and a sky: shadows of whatever stands out, edges towards the light, dim recesses. */
#include "config.h"

#include "data/render_priv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 40 }; /* canvas px that a shadow is looked for, along the depth axis */

/* Walk towards the sun: whoever is higher than the ray on the way keeps it out. */
static float sunlit(const sg_canvas *c, const sg_style *s, size_t x, size_t y)
{
    const float here = c->depth[y * c->width + x];
    for (int k = 1; k <= STEPS; k++) {
        const double sx = (double)x - k * s->sun_x, sy = (double)y - k * s->sun_y;
        if (sx < 0 || sy < 0 || sx >= (double)c->width || sy >= (double)c->height)
            break;
        if (c->depth[(size_t)sy * c->width + (size_t)sx] > here + (float)k + 0.5F)
            return 0;
    }
    return 1;
}

static void cast_shadows(const sg_painter *p, float *sun)
{
    const sg_canvas *c = &p->canvas;
    for (size_t y = 0; y < c->height; y++)
        for (size_t x = 0; x < c->width; x++)
            sun[y * c->width + x] = sunlit(c, &p->style, x, y);
}

/* The shadow of the house across the street: below a slanting line with steps no direct light comes. */
static void cast_opposite_house(sg_painter *p, float *sun)
{
    sg_canvas *c = &p->canvas;
    if (p->style.clouds > 0.7 || !sg_canvas_chance(c, 0.4))
        return;
    const double level = sg_canvas_between(c, 0.55, 1.05) * (double)c->height, slope = sg_canvas_between(c, -0.5, 0.5);
    const double chimney = sg_canvas_between(c, 0.1, 0.8) * (double)c->width, wide = 12 * c->unit;
    for (size_t y = 0; y < c->height; y++) {
        for (size_t x = 0; x < c->width; x++) {
            double edge = level + slope * ((double)x - 0.5 * (double)c->width);
            if (fabs((double)x - chimney) < wide)
                edge -= 14 * c->unit;
            const double inside = ((double)y - edge) / (2 * c->unit);
            sun[y * c->width + x] *= (float)(1 - 1 / (1 + exp(-inside)));
        }
    }
}

/* Openness: 1 where the surroundings are as deep as the point or deeper, less in recesses and under ledges. */
static bool openness(const sg_canvas *c, float *open)
{
    const size_t n = c->width * c->height;
    for (size_t i = 0; i < n; i++)
        open[i] = fmaxf(c->depth[i], -6 * (float)c->unit);
    if (!sg_cvdraw_blur(open, c->width, c->height, 1, 3.5 * c->unit))
        return false;
    for (size_t i = 0; i < n; i++) {
        const float below = (open[i] - fmaxf(c->depth[i], -6 * (float)c->unit)) / (float)c->unit;
        open[i] = 1 - 0.5F * (1 - expf(-0.55F * fmaxf(0, below)));
    }
    return true;
}

/* How much more an inclined bit of surface faces the sun than the flat wall does. */
static float facing(const sg_canvas *c, const sg_style *s, size_t x, size_t y)
{
    if (x == 0 || y == 0)
        return 1;
    const size_t i = y * c->width + x;
    const float dx = fmaxf(-1, fminf(1, c->depth[i] - c->depth[i - 1]));
    const float dy = fmaxf(-1, fminf(1, c->depth[i] - c->depth[i - c->width]));
    return fmaxf(0.25F, 1 + 0.45F * (float)(s->sun_x * dx + s->sun_y * dy));
}

static void add_up(const sg_painter *p, const float *sun, const float *open, float *lit)
{
    const sg_canvas *c = &p->canvas;
    static const float sunlight[3] = {1.06F, 1.0F, 0.9F}, skylight[3] = {0.93F, 1.0F, 1.09F};
    for (size_t y = 0; y < c->height; y++) {
        /* Less sky reaches the street. */
        const float sky = (float)(p->style.ambient * (1.08 - 0.3 * (double)y / (double)c->height));
        for (size_t x = 0; x < c->width; x++) {
            const size_t i = y * c->width + x;
            const float direct = (float)p->style.sun * sun[i] * facing(c, &p->style, x, y);
            for (size_t k = 0; k < 3; k++)
                lit[3 * i + k] = c->albedo[3 * i + k] * (direct * sunlight[k] + sky * open[i] * skylight[k]) +
                                 c->glow[3 * i + k] * (c->depth[i] < -20 * (float)c->unit ? 1 : open[i]);
        }
    }
}

sg_status sg_render_light(sg_painter *p, float *lit, sg_error *err)
{
    const sg_canvas *c = &p->canvas;
    const size_t n = c->width * c->height;
    float *sun = malloc(n * sizeof *sun), *open = malloc(n * sizeof *open);
    bool good = sun != NULL && open != NULL;
    if (good) {
        cast_shadows(p, sun);
        cast_opposite_house(p, sun);
        const double soft = p->style.clouds > 0.7 ? 1.6 : 0.35;
        good = sg_cvdraw_blur(sun, c->width, c->height, 1, soft * c->unit) && openness(c, open);
    }
    if (good)
        add_up(p, sun, open, lit);
    free(sun);
    free(open);
    return good ? SG_OK : SG_FAIL_NOMEM(err);
}
