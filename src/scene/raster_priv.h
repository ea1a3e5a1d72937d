/* SPDX-License-Identifier: GPL-3.0-or-later */
/* raster_priv.h - what the files of the rasteriser share. */
#ifndef SG_SCENE_RASTER_PRIV_H
#define SG_SCENE_RASTER_PRIV_H

#include "scene/raster.h"

enum { SG_RASTER_FINE = 256 /* steps of a pixel */, SG_RASTER_GUARD = 1 << 20 /* px: corners farther away are clipped */ };

/** A corner in the picture. */
typedef struct sg_raster_vertex {
    int32_t x, y; /* 1/256 px from the sample of pixel (0, 0) */
    double key;
} sg_raster_vertex;

#define SG_RASTER_OUTSIDE INT32_MIN /* as x: the corner cannot be projected, or lies too far away */

typedef struct {
    sg_raster *raster;
    const sg_camera *camera;
    const double *offset;
} sg_raster_job;

/** In the picture, or marked as outside, a corner with these coordinates before the camera. */
sg_raster_vertex sg_raster_place(const sg_raster_job *j, const double *coordinates);
/** Draw a triangle all of whose corners are inside. */
void sg_raster_triangle(sg_raster *r, const sg_raster_vertex *a, const sg_raster_vertex *b, const sg_raster_vertex *c,
                        uint32_t index);
/** Clip the triangle with these coordinates before the camera, and draw what is left. */
void sg_raster_clipped(const sg_raster_job *j, const double (*corners)[3], uint32_t index);

#endif
