/* SPDX-License-Identifier: GPL-3.0-or-later */
/* light.c - directions of light, and the gathering of it. */
#include "scene/light.h"

#include <math.h>

static const double two_pi = 6.283185307179586;

/* The digits of i mirrored at the point: Halton, "On the efficiency of certain quasi-random sequences of points" (1960). */
static double radical_inverse(size_t i, size_t base)
{
    double x = 0, place = 1.0 / (double)base;
    for (; i > 0; i /= base, place /= (double)base)
        x += place * (double)(i % base);
    return x;
}

/* Three of four come from above, where most light is; all of a half are equally dense. */
static bool sky_direction(size_t i, double *out)
{
    const bool below = i % 4 == 3;
    const size_t k = (below ? i / 4 : i - i / 4) + 1;
    const double height = radical_inverse(k, 2), t = two_pi * radical_inverse(k, 3), r = sqrt(fmax(0, 1 - height * height));
    out[0] = r * cos(t);
    out[1] = below ? -height : height;
    out[2] = r * sin(t);
    return below;
}

static void sun_direction(const sg_lights *lights, size_t i, double *out)
{
    const double *s = lights->sun;
    const double up[3] = {fabs(s[1]) < 0.9 ? 0 : 1, fabs(s[1]) < 0.9 ? 1 : 0, 0};
    double a[3], b[3];
    sg_vec_cross(up, s, a);
    sg_vec_normalize(a);
    sg_vec_cross(s, a, b);
    const double r = tan(lights->sun_size * two_pi / 360) * sqrt(radical_inverse(i + 1, 2));
    const double t = two_pi * radical_inverse(i + 1, 3);
    sg_vec_add(s, r * cos(t), a, out);
    sg_vec_add(out, r * sin(t), b, out);
    sg_vec_normalize(out);
}

static double brightness(const double *rgb)
{
    return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

sg_status sg_light_maps_create(const sg_lights *lights, sg_light_maps *maps, sg_error *err)
{
    *maps = (sg_light_maps){0};
    SG_TRY(sg_shadow_map_create(lights->sky_side, &maps->sky, err));
    return sg_shadow_map_create(lights->sun_side, &maps->sun, err);
}

void sg_light_maps_clear(sg_light_maps *maps)
{
    sg_shadow_map_clear(&maps->sky);
    sg_shadow_map_clear(&maps->sun);
}

static float facing(const sg_light_point *p, const float *direction)
{
    return p->normal[0] * direction[0] + p->normal[1] * direction[1] + p->normal[2] * direction[2];
}

/* @param lift  more than the points have */
static void gather_sky(const sg_shadow_map *map, const double *direction, float lift, double light, sg_light_point *points,
                       size_t n)
{
    const float d[3] = {(float)direction[0], (float)direction[1], (float)direction[2]};
    for (size_t i = 0; i < n; i++) {
        sg_light_point *p = points + i;
        const float cosine = facing(p, d);
        if (cosine <= 0)
            continue;
        const float comes = (float)light * cosine;
        p->whole += comes;
        const float at[3] = {p->at[0] + lift * p->normal[0], p->at[1] + lift * p->normal[1], p->at[2] + lift * p->normal[2]};
        if (sg_shadow_map_lit(map, at))
            p->open += comes;
    }
}

/* @param sun  the middle of it */
static void gather_sun(const sg_shadow_map *map, const double *sun, sg_light_point *points, size_t n)
{
    const float d[3] = {(float)sun[0], (float)sun[1], (float)sun[2]};
    for (size_t i = 0; i < n; i++) {
        if (facing(points + i, d) <= 0)
            continue;
        points[i].sun_whole += 1;
        points[i].sun_open += sg_shadow_map_lit(map, points[i].at) ? 1 : 0;
    }
}

sg_status sg_light_gather(const sg_lights *lights, const sg_mesh *mesh, const sg_ball *ball, sg_light_maps *maps,
                          size_t first_sky, size_t nsky, size_t first_sun, size_t nsun, sg_light_point *points, size_t n,
                          sg_error *err)
{
    const float lift = (float)(sg_shadow_map_lift(lights->sky_side) - sg_shadow_map_lift(lights->sun_side));
    double d[3];
    for (size_t i = first_sky; i < first_sky + nsky; i++) {
        const bool below = sky_direction(i, d);
        SG_TRY(sg_shadow_map_draw(&maps->sky, mesh, ball, d, err));
        gather_sky(&maps->sky, d, lift, below ? 3 * brightness(lights->ground) : brightness(lights->sky), points, n);
    }
    for (size_t i = first_sun; i < first_sun + nsun; i++) {
        sun_direction(lights, i, d);
        SG_TRY(sg_shadow_map_draw(&maps->sun, mesh, ball, d, err));
        gather_sun(&maps->sun, lights->sun, points, n);
    }
    return SG_OK;
}

void sg_light_sum(const sg_lights *lights, const sg_light_point *p, double *rgb)
{
    const double open = p->whole > 0 ? (double)p->open / (double)p->whole : 1, up = (1 + (double)p->normal[1]) / 2;
    const double cosine = lights->sun[0] * (double)p->normal[0] + lights->sun[1] * (double)p->normal[1] +
                          lights->sun[2] * (double)p->normal[2];
    const double sun = p->sun_whole > 0 ? fmax(0, cosine) * (double)p->sun_open / (double)p->sun_whole : fmax(0, cosine);
    for (int i = 0; i < 3; i++)
        rgb[i] = open * (up * lights->sky[i] + (1 - up) * lights->ground[i]) + sun * lights->sun_light[i];
}
