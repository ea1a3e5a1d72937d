/* SPDX-License-Identifier: GPL-3.0-or-later */
/* obj_polygon.c - the polygons of a mesh file as triangles and quadrilaterals. */
#include "scene/obj_priv.h"

#include "core/array.h"
#include "scene/triangulate.h"

#include <math.h>
#include <string.h>

static sg_status add_face(sg_obj *obj, const sg_mesh_corner *corners, const uint32_t *which, uint32_t n,
                          uint32_t material, sg_error *err)
{
    if (!SG_GROW(obj->faces, obj->faces_capacity, obj->nfaces + 1))
        return SG_FAIL_NOMEM(err);
    sg_mesh_face *f = obj->faces + obj->nfaces++;
    memset(f, 0, sizeof *f);
    for (uint32_t i = 0; i < n; i++)
        f->corner[i] = corners[which[i]];
    f->ncorners = n;
    f->group = material;
    return SG_OK;
}

/* Twice the area along the axes: Newell's sum. */
static void polygon_normal(const sg_obj *obj, const sg_mesh_corner *c, size_t n, double *out)
{
    const double *origin = obj->vertices[c[0].vertex];
    memset(out, 0, 3 * sizeof *out);
    for (size_t i = 1; i + 1 < n; i++) {
        double a[3], b[3], cross[3];
        sg_vec_add(obj->vertices[c[i].vertex], -1, origin, a);
        sg_vec_add(obj->vertices[c[i + 1].vertex], -1, origin, b);
        sg_vec_cross(a, b, cross);
        sg_vec_add(out, 1, cross, out);
    }
}

/* On the plane of two axes across which it is widest, counterclockwise. */
static void flatten(const sg_obj *obj, const sg_mesh_corner *c, size_t n, double (*out)[2])
{
    double normal[3];
    polygon_normal(obj, c, n, normal);
    int drop = fabs(normal[1]) > fabs(normal[0]) ? 1 : 0;
    drop = fabs(normal[2]) > fabs(normal[drop]) ? 2 : drop;
    const int x = normal[drop] < 0 ? (drop + 2) % 3 : (drop + 1) % 3, y = 3 - drop - x;
    for (size_t i = 0; i < n; i++) {
        out[i][0] = obj->vertices[c[i].vertex][x];
        out[i][1] = obj->vertices[c[i].vertex][y];
    }
}

/* Corners without those that repeat the one before. */
static size_t distinct(const sg_mesh_corner *corners, size_t n, sg_mesh_corner *out)
{
    size_t m = 0;
    for (size_t i = 0; i < n; i++)
        if (m == 0 || corners[i].vertex != out[m - 1].vertex)
            out[m++] = corners[i];
    while (m > 1 && out[m - 1].vertex == out[0].vertex)
        m--;
    return m;
}

sg_status sg_obj_add_polygon(sg_obj *obj, const sg_mesh_corner *corners, size_t n, uint32_t material, sg_error *err)
{
    static const uint32_t in_order[4] = {0, 1, 2, 3};
    sg_mesh_corner c[SG_OBJ_MAX_CORNERS];
    double flat[SG_OBJ_MAX_CORNERS][2];
    uint32_t triangles[SG_OBJ_MAX_CORNERS][3], left[SG_OBJ_MAX_CORNERS];
    const size_t m = distinct(corners, n, c);
    if (m < 3)
        return SG_OK;
    if (m == 3)
        return add_face(obj, c, in_order, 3, material, err);
    flatten(obj, c, m, flat);
    if (m == 4 && sg_polygon_convex((const double(*)[2])flat, m))
        return add_face(obj, c, in_order, 4, material, err);
    sg_triangulate((const double(*)[2])flat, m, triangles, left);
    for (size_t i = 0; i + 2 < m; i++)
        SG_TRY(add_face(obj, c, triangles[i], 3, material, err));
    return SG_OK;
}
