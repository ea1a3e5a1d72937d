/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shade.h - the points of surfaces that a depth and triangle buffer shows, and their colours. */
#ifndef SG_SCENE_SHADE_H
#define SG_SCENE_SHADE_H

#include "scene/light.h"

/** Material of points on the ground, which is what the picture's background shows where light falls on it. */
#define SG_SHADE_GROUND UINT32_MAX

/** What a buffer shows: one point for each pixel in which there is a surface. A zeroed one is empty. */
typedef struct {
    sg_light_point *points;
    uint32_t *pixels;    /* [n] increasing */
    uint32_t *materials; /* [n] of the mesh, or SG_SHADE_GROUND */
    size_t n, capacity, pixels_capacity, materials_capacity;
} sg_shade_points;

typedef struct {
    const sg_mesh *mesh;
    const sg_camera *camera;
    const sg_ball *ball;
    double lift;         /* off the surface, in the coordinates of the ball */
    const double *ground; /* height of the level ground, NULL: none */
} sg_shade_view;

/** Find the points of a buffer that was drawn with this mesh, camera and offset. Normals are those of the mesh, turned to
 *  the side that is seen. @return SG_OK, SG_ENOMEM */
sg_status sg_shade_find(const sg_raster *r, const sg_shade_view *view, const double *offset, sg_shade_points *out,
                        sg_error *err);
void sg_shade_points_clear(sg_shade_points *p);

#endif
