/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shadow_map.h - what a mesh hides from light that comes from far away (Williams, "Casting curved shadows on curved
 * surfaces", 1978): a depth buffer as seen from the light. */
#ifndef SG_SCENE_SHADOW_MAP_H
#define SG_SCENE_SHADOW_MAP_H

#include "scene/raster.h"

/** Coordinates in which maps are looked up: the ball about the mesh has radius 1, and lies at the origin. */
typedef struct {
    double centre[3], radius;
} sg_ball;

/** A ball that has all vertices of a mesh; of radius 1 about the origin when it has none. */
sg_ball sg_ball_of(const sg_mesh *mesh);
void sg_ball_coordinates(const sg_ball *ball, const double *point, float *out);

/** A zeroed one is empty. */
typedef struct {
    sg_raster raster;
    float row[3][4]; /* column, row and key of the point (x, y, z, 1) in the coordinates of the ball */
} sg_shadow_map;

/** @param side  pixels of the square map. @return SG_OK, SG_EINVAL, SG_ENOMEM */
sg_status sg_shadow_map_create(size_t side, sg_shadow_map *out, sg_error *err);
void sg_shadow_map_clear(sg_shadow_map *map);
/** What light hides that comes from this direction, of length 1. @return as sg_raster_draw() */
sg_status sg_shadow_map_draw(sg_shadow_map *map, const sg_mesh *mesh, const sg_ball *ball, const double *towards_light,
                             sg_error *err);

/** How far a point must be lifted off its surface, in the coordinates of the ball, for the surface not to hide it. */
double sg_shadow_map_lift(size_t side);

/** Does the light reach a point, in the coordinates of the ball? */
static inline bool sg_shadow_map_lit(const sg_shadow_map *map, const float *p)
{
    const float *x = map->row[0], *y = map->row[1], *k = map->row[2];
    const float column = x[0] * p[0] + x[1] * p[1] + x[2] * p[2] + x[3];
    const float row = y[0] * p[0] + y[1] * p[1] + y[2] * p[2] + y[3];
    if (!(column >= 0 && row >= 0 && column < (float)map->raster.width && row < (float)map->raster.height))
        return true;
    return k[0] * p[0] + k[1] * p[1] + k[2] * p[2] + k[3] <= map->raster.keys[(size_t)row * map->raster.width + (size_t)column];
}

#endif
