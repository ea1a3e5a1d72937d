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
    free(p->materials);
    *p = (sg_shade_points){0};
}

static void set_point(const sg_shade_view *view, const double *at, const double *normal, const double *side,
                      sg_light_point *p)
{
    sg_ball_coordinates(view->ball, at, p->at);
    for (int i = 0; i < 3; i++) {
        p->at[i] += (float)(view->lift * side[i]);
        p->normal[i] = (float)normal[i];
    }
}

/* What pixels in a row have in common as long as they show the same triangle. */
typedef struct {
    uint32_t triangle;
    sg_mesh_corner corner[3];
    const double *vertex[3];
    double side[3]; /* its front; zero when it has no plane */
    bool flat;      /* one normal for all of it, of length 1 */
} look;

static void look_at(const sg_mesh *m, uint32_t triangle, look *l)
{
    double ab[3], ac[3];
    l->triangle = triangle;
    sg_raster_corners(m, triangle, l->corner);
    for (int i = 0; i < 3; i++)
        l->vertex[i] = m->vertices[l->corner[i].vertex];
    l->flat = l->corner[0].normal == l->corner[1].normal && l->corner[0].normal == l->corner[2].normal &&
              sg_vec_dot(m->normals[l->corner[0].normal], m->normals[l->corner[0].normal]) > 0;
    sg_vec_add(l->vertex[1], -1, l->vertex[0], ab);
    sg_vec_add(l->vertex[2], -1, l->vertex[0], ac);
    sg_vec_normalize(ab);
    sg_vec_normalize(ac);
    sg_vec_cross(ab, ac, l->side);
    if (!sg_vec_normalize(l->side))
        memset(l->side, 0, sizeof l->side);
}

/* @return its material */
static uint32_t find_surface(const sg_shade_view *view, const double *origin, const double *direction, const look *l,
                             sg_light_point *p)
{
    const sg_mesh *m = view->mesh;
    double share[3], at[3] = {0, 0, 0}, normal[3] = {0, 0, 0}, side[3];
    const double sign = sg_vec_dot(l->side, direction) <= 0 ? 1 : -1; /* is the front seen? */
    sg_raster_shares(origin, direction, l->vertex[0], l->vertex[1], l->vertex[2], share);
    for (int i = 0; i < 3; i++) {
        sg_vec_add(at, share[i], l->vertex[i], at);
        side[i] = sign * l->side[i];
    }
    for (int i = 0; i < (l->flat ? 1 : 3); i++)
        sg_vec_add(normal, l->flat ? sign : sign * share[i], m->normals[l->corner[i].normal], normal);
    if (!l->flat && !sg_vec_normalize(normal))
        memcpy(normal, side, sizeof normal);
    if (sg_vec_dot(side, side) == 0)
        memcpy(side, normal, sizeof side);
    set_point(view, at, normal, side, p);
    return m->groups[m->faces[l->triangle / 2].group].material;
}

/* Where a ray from above comes down to the level ground. */
static uint32_t find_ground(const sg_shade_view *view, const double *origin, const double *direction, sg_light_point *p)
{
    static const double up[3] = {0, 1, 0};
    double at[3];
    if (view->ground == NULL || origin[1] <= *view->ground || direction[1] >= 0)
        return SG_SHADE_NOTHING;
    const double t = (*view->ground - origin[1]) / direction[1];
    sg_vec_add(origin, t, direction, at);
    if (!isfinite(t) || t >= 1e6 * view->ball->radius)
        return SG_SHADE_NOTHING;
    set_point(view, at, up, up, p);
    return SG_SHADE_GROUND;
}

static void find_row(const sg_raster *r, const sg_shade_view *view, const double *offset, size_t row, sg_shade_points *out)
{
    look l = {.triangle = SG_RASTER_NONE};
    for (size_t x = 0, i = row * r->width; x < r->width; x++, i++) {
        const uint32_t triangle = r->triangles[i];
        double origin[3], direction[3];
        sg_light_point *p = out->points + i;
        *p = (sg_light_point){0};
        sg_camera_ray(view->camera, (double)x + offset[0], (double)row + offset[1], r->width, r->height, origin, direction);
        if (triangle != SG_RASTER_NONE && triangle != l.triangle)
            look_at(view->mesh, triangle, &l);
        out->materials[i] = triangle != SG_RASTER_NONE ? find_surface(view, origin, direction, &l, p)
                                                       : find_ground(view, origin, direction, p);
    }
}

sg_status sg_shade_find(const sg_raster *r, const sg_shade_view *view, const double *offset, sg_shade_points *out,
                        sg_error *err)
{
    const size_t n = r->width * r->height;
    if (!SG_GROW(out->points, out->capacity, n) || !SG_GROW(out->materials, out->materials_capacity, n))
        return SG_FAIL_NOMEM(err);
    for (size_t row = 0; row < r->height; row++)
        find_row(r, view, offset, row, out);
    return SG_OK;
}
