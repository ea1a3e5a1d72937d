/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shade.h - the points of surfaces that a depth and triangle buffer shows, and their colours. */
#ifndef SG_SCENE_SHADE_H
#define SG_SCENE_SHADE_H

#include "scene/light.h"

/** In place of a material: the ground, which is what the picture's background shows where light falls on it. */
#define SG_SHADE_GROUND UINT32_MAX
/** In place of a material: there is no surface in this pixel. */
#define SG_SHADE_NOTHING (UINT32_MAX - 1)

/** What a buffer shows: a point for each pixel. A zeroed one is empty. */
typedef struct {
    sg_light_point *points; /* zero where there is no surface */
    uint32_t *materials;    /* of the mesh, or as above */
    size_t capacity, materials_capacity;
} sg_shade_points;

typedef struct {
    const sg_mesh *mesh;
    const sg_camera *camera;
    const sg_ball *ball;
    double lift;         /* off the surface, in the coordinates of the ball */
    const double *ground; /* height of the level ground, NULL: none */
} sg_shade_view;

/** Find the points of a buffer that was drawn with this mesh, camera and offset. Normals are those of the mesh, turned to
 *  the side that is seen.
 *  @param out  [height][width]
 *  @return SG_OK, SG_ENOMEM */
sg_status sg_shade_find(const sg_raster *r, const sg_shade_view *view, const double *offset, sg_shade_points *out,
                        sg_error *err);
void sg_shade_points_clear(sg_shade_points *p);

#endif
