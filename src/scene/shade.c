/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shade.c - from pixels back to points of surfaces. */
#include "scene/shade.h"

#include "core/array.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void sg_shade_points_clear(sg_shade_points *p)
{
    free(p->points);
    free(p->pixels);
    free(p->materials);
    *p = (sg_shade_points){0};
}

static void add_point(sg_shade_points *out, const sg_shade_view *view, const double *at, const double *normal,
                      const double *side, size_t pixel, uint32_t material)
{
    sg_light_point *p = out->points + out->n;
    *p = (sg_light_point){0};
    sg_ball_coordinates(view->ball, at, p->at);
    for (int i = 0; i < 3; i++) {
        p->at[i] += (float)(view->lift * side[i]);
        p->normal[i] = (float)normal[i];
    }
    out->pixels[out->n] = (uint32_t)pixel;
    out->materials[out->n++] = material;
}

/* Of the plane of a triangle, on the side that is seen. @return -1 when that is its back, 0 when it has no plane */
static int seen_side(const double *a, const double *b, const double *c, const double *direction, double *side)
{
    double ab[3], ac[3];
    sg_vec_add(b, -1, a, ab);
    sg_vec_add(c, -1, a, ac);
    sg_vec_normalize(ab);
    sg_vec_normalize(ac);
    sg_vec_cross(ab, ac, side);
    if (!sg_vec_normalize(side))
        return 0;
    const bool front = sg_vec_dot(side, direction) <= 0;
    for (int i = 0; i < 3 && !front; i++)
        side[i] = -side[i];
    return front ? 1 : -1;
}

static void add_surface(const sg_shade_view *view, const double *origin, const double *direction, uint32_t triangle,
                        size_t pixel, sg_shade_points *out)
{
    const sg_mesh *m = view->mesh;
    sg_mesh_corner corner[3];
    double share[3], at[3] = {0, 0, 0}, normal[3] = {0, 0, 0}, side[3];
    sg_raster_corners(m, triangle, corner);
    const double *a = m->vertices[corner[0].vertex], *b = m->vertices[corner[1].vertex], *c = m->vertices[corner[2].vertex];
    sg_raster_shares(origin, direction, a, b, c, share);
    for (int i = 0; i < 3; i++) {
        sg_vec_add(at, share[i], m->vertices[corner[i].vertex], at);
        sg_vec_add(normal, share[i], m->normals[corner[i].normal], normal);
    }
    const int front = seen_side(a, b, c, direction, side);
    for (int i = 0; i < 3; i++)
        normal[i] *= front < 0 ? -1 : 1;
    if (!sg_vec_normalize(normal))
        memcpy(normal, side, sizeof normal);
    if (front == 0)
        memcpy(side, normal, sizeof side);
    add_point(out, view, at, normal, side, pixel, m->groups[m->faces[triangle / 2].group].material);
}

/* Where a ray from above comes down to the level ground. */
static void add_ground(const sg_shade_view *view, const double *origin, const double *direction, size_t pixel,
                       sg_shade_points *out)
{
    static const double up[3] = {0, 1, 0};
    double at[3];
    if (view->ground == NULL || origin[1] <= *view->ground || direction[1] >= 0)
        return;
    const double t = (*view->ground - origin[1]) / direction[1];
    sg_vec_add(origin, t, direction, at);
    if (isfinite(t) && t < 1e6 * view->ball->radius)
        add_point(out, view, at, up, up, pixel, SG_SHADE_GROUND);
}

sg_status sg_shade_find(const sg_raster *r, const sg_shade_view *view, const double *offset, sg_shade_points *out,
                        sg_error *err)
{
    const size_t most = r->width * r->height;
    out->n = 0;
    if (!SG_GROW(out->points, out->capacity, most) || !SG_GROW(out->pixels, out->pixels_capacity, most) ||
        !SG_GROW(out->materials, out->materials_capacity, most))
        return SG_FAIL_NOMEM(err);
    for (size_t i = 0; i < most; i++) {
        double origin[3], direction[3];
        sg_camera_ray(view->camera, (double)(i % r->width) + offset[0], (double)(i / r->width) + offset[1], r->width,
                      r->height, origin, direction);
        if (r->triangles[i] != SG_RASTER_NONE)
            add_surface(view, origin, direction, r->triangles[i], i, out);
        else
            add_ground(view, origin, direction, i, out);
    }
    return SG_OK;
}
