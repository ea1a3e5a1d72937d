/* SPDX-License-Identifier: GPL-3.0-or-later */
/* camera.h - orthographic and perspective cameras: where a point of space falls in a picture, and how deep it lies.
 *
 * Pictures have x to the right and y down, in pixels; (0, 0) is the upper left corner of the upper left pixel. Depth is
 * measured along the view, not along the ray. The key of a depth grows with it, and is linear in the picture over any
 * plane of space: so depth buffers hold keys. */
#ifndef SG_SCENE_CAMERA_H
#define SG_SCENE_CAMERA_H

#include "scene/frame.h"

#include <stddef.h>

typedef enum { SG_PROJECTION_PERSPECTIVE, SG_PROJECTION_ORTHOGRAPHIC } sg_projection;

typedef struct {
    sg_frame frame; /* origin: the eye; x to the right, y up, z backwards, out of the picture */
    double half[2]; /* perspective: tangents of half the angles of view, across and upright; else half the extents */
    double near;    /* what is less deep is not seen */
    double scale;   /* length that keys are measured with, about the distance or size of what is seen */
    sg_projection projection;
} sg_camera;

/** Where a model is looked at from. */
typedef struct {
    double azimuth;   /* degrees; 0: from the front, along -z; 90: from the right, along -x */
    double elevation; /* degrees above the horizon, -90 to 90 */
    sg_projection projection;
    double angle;  /* of the longer side of a perspective picture, degrees */
    double margin; /* share of the picture's half that stays free at each side */
} sg_view;

#define SG_VIEW_INIT {35, 18, SG_PROJECTION_PERSPECTIVE, 30, 0.08}

/** The nearest camera of this view that has all points in its picture, in the middle. All points lie behind `near`.
 *  Without points it looks at a ball of radius 1 at the origin.
 *  @param points  [n], finite, under 1e100
 *  @param aspect  width of the picture over its height */
sg_camera sg_camera_fit(const double (*points)[3], size_t n, const sg_view *view, double aspect);

/** Coordinates to the right of the eye, above it, and depth. */
void sg_camera_coordinates(const sg_camera *c, const double *point, double *out);
/** Place in a picture of this size, in pixels, and key. The point must not be less deep than `near`. */
void sg_camera_project(const sg_camera *c, const double *point, size_t width, size_t height, double *out);
/** The ray through a place in the picture: origin + t direction, t is the depth. */
void sg_camera_ray(const sg_camera *c, double x, double y, size_t width, size_t height, double *origin, double *direction);

static inline double sg_camera_key(const sg_camera *c, double depth)
{
    return c->projection == SG_PROJECTION_PERSPECTIVE ? -c->scale / depth : depth / c->scale;
}

static inline double sg_camera_depth(const sg_camera *c, double key)
{
    return c->projection == SG_PROJECTION_PERSPECTIVE ? -c->scale / key : key * c->scale;
}

#endif
