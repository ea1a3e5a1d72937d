/* SPDX-License-Identifier: GPL-3.0-or-later */
/* raster.h - meshes as depth and triangle buffers: which triangle is seen in each pixel, and how deep it lies.
 *
 * A pixel is one sample. A sample belongs to a triangle when it lies inside (by the edge functions of Pineda, "A parallel
 * algorithm for polygon rasterization", 1988), or on a top or left edge: neighbours that share an edge neither both have a
 * sample of it nor leave one out. For that, corners are rounded to 1/256 px. Of several triangles the nearest is seen, of
 * equally near ones the first. Both sides of a triangle are seen. */
#ifndef SG_SCENE_RASTER_H
#define SG_SCENE_RASTER_H

#include "scene/camera.h"
#include "scene/mesh.h"

#define SG_RASTER_NONE UINT32_MAX

/** A zeroed one is empty. */
typedef struct {
    size_t width, height;
    float *keys;         /* [height][width] of sg_camera_key(); INFINITY where nothing is seen */
    uint32_t *triangles; /* [height][width] 2 face + half, see sg_raster_corners(); SG_RASTER_NONE where nothing is seen;
                            NULL when they are not asked for */
    struct sg_raster_vertex *work; /* kept from one mesh to the next */
    size_t work_capacity;
} sg_raster;

/** @return SG_OK, SG_EINVAL (a side is 0 or too large for a picture), SG_ENOMEM; on failure out is untouched */
sg_status sg_raster_create(size_t width, size_t height, bool triangles, sg_raster *out, sg_error *err);
void sg_raster_clear(sg_raster *r);
/** Nothing is seen. */
void sg_raster_wipe(sg_raster *r);

/** Draw a mesh over what is there.
 *  @param offset  place of the sample in its pixel, from (0, 0) to (1, 1); (0.5, 0.5) is its centre
 *  @return SG_OK, SG_ENUMERIC (2^31 faces or more), SG_ENOMEM */
sg_status sg_raster_draw(sg_raster *r, const sg_mesh *mesh, const sg_camera *camera, const double *offset, sg_error *err);

/** The three corners of a triangle: quadrilaterals are cut from their first corner to the third. */
static inline void sg_raster_corners(const sg_mesh *mesh, uint32_t triangle, sg_mesh_corner *out)
{
    const sg_mesh_face *f = mesh->faces + triangle / 2;
    out[0] = f->corner[0];
    out[1] = f->corner[1 + triangle % 2];
    out[2] = f->corner[2 + triangle % 2];
}

/** Shares of the corners in the point where a ray meets the plane of a triangle, by Moeller and Trumbore, "Fast, minimum
 *  storage ray/triangle intersection" (1997). They are linear in space: interpolation with them is that of perspective.
 *  A ray that just misses the triangle, by rounding, gets its edge.
 *  @param shares  out [3], none negative, sum 1
 *  @return false: the ray runs along the plane, and shares are those of the middle */
bool sg_raster_shares(const double *origin, const double *direction, const double *a, const double *b, const double *c,
                      double *shares);

#endif
