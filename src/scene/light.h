/* SPDX-License-Identifier: GPL-3.0-or-later */
/* light.h - the light of a sun and of the whole sky on points of a mesh, with what of it the mesh itself hides: ambient
 * occlusion, and shadows with soft edges.
 *
 * Light comes from many directions, and there is a shadow map for each. Directions are those of a Halton sequence, so
 * that any few that follow each other are spread well. What is wanted are shares of what would come if nothing stood in
 * the way: a point that sees all of the sky has exactly 1. */
#ifndef SG_SCENE_LIGHT_H
#define SG_SCENE_LIGHT_H

#include "scene/shadow_map.h"

typedef struct {
    double sun[3];   /* direction towards it, of length 1 */
    double sun_size; /* half the angle that it fills, degrees: the softness of its shadows */
    double sky[3], ground[3]; /* light of all of the sky, from above and from below, on a face that looks up or down */
    double sun_light[3];      /* on a face that looks at it */
    size_t sky_side, sun_side; /* of shadow maps, px; the sun's has no fewer */
} sg_lights;

/** Round, white, and soft; the sun stands where the caller puts it. */
#define SG_LIGHTS_INIT {{0, 1, 0}, 3, {0.56, 0.58, 0.61}, {0.30, 0.295, 0.29}, {0.74, 0.71, 0.66}, 512, 1440}

/** Work space: one map for all directions of each. A zeroed one is empty. */
typedef struct {
    sg_shadow_map sky, sun;
} sg_light_maps;

/** @return SG_OK, SG_EINVAL, SG_ENOMEM; free it with sg_light_maps_clear() also on failure */
sg_status sg_light_maps_create(const sg_lights *lights, sg_light_maps *maps, sg_error *err);
void sg_light_maps_clear(sg_light_maps *maps);

/** A point of a surface, and what has come to it so far. */
typedef struct {
    float at[3];     /* in the coordinates of the ball, lifted off the surface as the sun's map asks for */
    float normal[3]; /* of length 1; zero: there is nothing */
    float open, whole;         /* sky light that came, and that would have come */
    float sun_open, sun_whole; /* likewise of the sun, not weighted with the angle */
} sg_light_point;

/** Shares of the light of directions first, first + 1, ... in the sequences of sky and sun. The sun is left out behind a
 *  point's back, where it cannot be seen.
 *  @param nsky, nsun  how many of each
 *  @return SG_OK, SG_ENUMERIC, SG_ENOMEM (as sg_raster_draw()) */
sg_status sg_light_gather(const sg_lights *lights, const sg_mesh *mesh, const sg_ball *ball, sg_light_maps *maps,
                          size_t first_sky, size_t nsky, size_t first_sun, size_t nsun, sg_light_point *points, size_t n,
                          sg_error *err);

/** What comes to a point, in linear light: 1 is what a white face needs to be white. */
void sg_light_sum(const sg_lights *lights, const sg_light_point *p, double *rgb);

#endif
