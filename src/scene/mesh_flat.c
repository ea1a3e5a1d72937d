/* SPDX-License-Identifier: GPL-3.0-or-later */
/* mesh_flat.c - primitives whose faces are flat. */
#include "scene/mesh_priv.h"

#include "scene/skeleton.h"
#include "scene/triangulate.h"

#include <string.h>

enum { MAX_FACES = 6 * SG_PRIMITIVE_CORNERS };

/* Of a solid, counterclockwise from outside. Texture coordinates count from `origin`, in the direction of `along`. */
typedef struct {
    uint8_t corner[4], n, origin, along;
} solid_face;

/* A shape of flat faces, in the frame of the primitive. */
typedef struct {
    size_t nvertices, nfaces;
    double at[SG_SKELETON_NODES][3]; /* room for the two ends of a prism too */
    solid_face face[MAX_FACES];
} solid;

static void put_point(solid *s, double x, double y, double z)
{
    double *at = s->at[s->nvertices++];
    at[0] = x;
    at[1] = y;
    at[2] = z;
}

static void put_face(solid *s, uint8_t n, uint8_t a, uint8_t b, uint8_t c, uint8_t d)
{
    s->face[s->nfaces++] = (solid_face){{a, b, c, d}, n, a, b};
}

/* One that is counterclockwise in x and y; looking down, when it is turned. Not convex, or of many corners: triangles. */
static void put_polygon(solid *s, const uint8_t *corner, size_t n, bool turned)
{
    double p[SG_SKELETON_NODES][2];
    uint32_t triangles[SG_SKELETON_NODES][3], left[SG_SKELETON_NODES];
    for (size_t i = 0; i < n; i++)
        memcpy(p[i], s->at[corner[i]], sizeof p[i]);
    if (n == 4 && sg_polygon_convex((const double(*)[2])p, n)) {
        put_face(s, 4, corner[turned ? 3 : 0], corner[turned ? 2 : 1], corner[turned ? 1 : 2], corner[turned ? 0 : 3]);
        return;
    }
    sg_triangulate((const double(*)[2])p, n, triangles, left);
    for (size_t i = 0; i + 2 < n && s->nfaces < MAX_FACES; i++) {
        const uint32_t *t = triangles[i];
        put_face(s, 3, corner[t[turned ? 2 : 0]], corner[t[1]], corner[t[turned ? 0 : 2]], 0);
        s->face[s->nfaces - 1].origin = corner[turned ? n - 1 : 0];
        s->face[s->nfaces - 1].along = corner[turned ? n - 2 : 1];
    }
}

static void put_range(solid *s, uint8_t first, size_t n, bool turned)
{
    uint8_t corner[SG_PRIMITIVE_CORNERS] = {0};
    for (size_t i = 0; i < n; i++)
        corner[i] = (uint8_t)(first + i);
    put_polygon(s, corner, n, turned);
}

/* The polygon at z = 0, and for a prism the one at its far end and the sides between them. */
static void put_prism(solid *s, const double (*corner)[2], uint8_t n, double depth)
{
    for (uint8_t i = 0; i < n; i++)
        put_point(s, corner[i][0], corner[i][1], depth);
    put_range(s, 0, n, false);
    if (depth == 0)
        return;
    for (uint8_t i = 0; i < n; i++)
        put_point(s, corner[i][0], corner[i][1], 0);
    put_range(s, n, n, true);
    for (uint8_t i = 0; i < n; i++) {
        const uint8_t j = (uint8_t)((i + 1) % n);
        put_face(s, 4, (uint8_t)(n + i), (uint8_t)(n + j), j, i);
    }
}

static void put_rectangle(solid *s, const double *size, double depth)
{
    const double corner[4][2] = {{0, 0}, {size[0], 0}, {size[0], size[1]}, {0, size[1]}};
    put_prism(s, corner, 4, depth);
}

/* Base corners 0 to 3 (counterclockwise as seen from above), then the ridge, or the point of a pyramid. */
static void put_hip(const sg_primitive *p, solid *s)
{
    const double w = p->size[0], h = p->size[1], l = p->size[2];
    const bool point = sg_mesh_thin(p, l - w);
    put_point(s, 0, 0, l);
    put_point(s, w, 0, l);
    put_point(s, w, 0, 0);
    put_point(s, 0, 0, 0);
    put_point(s, w / 2, h, point ? l / 2 : l - w / 2);
    if (!point)
        put_point(s, w / 2, h, w / 2);
    put_face(s, 4, 3, 2, 1, 0);
    put_face(s, 3, 0, 1, 4, 0);
    put_face(s, 3, 2, 3, point ? 4 : 5, 0);
    put_face(s, point ? 3 : 4, 1, 2, point ? 4 : 5, 4);
    put_face(s, point ? 3 : 4, 3, 0, 4, 5);
}

/* The faces of the skeleton, lifted, over the polygon. */
static bool put_polygon_hip(const sg_primitive *p, const double (*corners)[2], solid *s)
{
    sg_skeleton k;
    if (!sg_skeleton_find(corners, p->ncorners, &k))
        return false;
    if (p->radius[1] > 0)
        sg_skeleton_raise_gables(corners, p->ncorners, &k);
    for (size_t i = 0; i < k.nnodes; i++)
        put_point(s, k.node[i][0], k.node[i][1], k.node[i][2] * p->radius[0]);
    put_range(s, 0, p->ncorners, true);
    for (uint32_t i = 0; i < p->ncorners; i++)
        put_polygon(s, k.face[i].corner, k.face[i].ncorners, false);
    return true;
}

static bool put_solid(const sg_primitive *p, const double (*corners)[2], solid *s)
{
    const bool flat = p->kind == SG_PRIMITIVE_POLYGON || p->kind == SG_PRIMITIVE_LABEL;
    const bool thin[3] = {sg_mesh_thin(p, p->size[0]), sg_mesh_thin(p, p->size[1]), sg_mesh_thin(p, p->size[2])};
    memset(s, 0, sizeof *s);
    if (thin[0] || thin[1] || (!flat && thin[2]))
        return false;
    if (p->kind == SG_PRIMITIVE_HIP && p->ncorners > 0)
        return put_polygon_hip(p, corners, s);
    if (p->kind == SG_PRIMITIVE_HIP)
        put_hip(p, s);
    else if (p->kind == SG_PRIMITIVE_PRISM || p->kind == SG_PRIMITIVE_POLYGON)
        put_prism(s, corners, (uint8_t)p->ncorners, flat ? 0 : p->size[2]);
    else
        put_rectangle(s, p->size, flat ? 0 : p->size[2]);
    return true;
}

/* One normal for the face; u runs along its first side, or that of the polygon it is cut from. */
static void add_face(sg_mesh_builder *b, const solid *s, size_t k, uint32_t base, uint32_t group)
{
    const solid_face *f = s->face + k;
    const double(*v)[3] = (const double(*)[3])(b->mesh->vertices + base);
    double u[3], w[3], normal[3];
    sg_mesh_corner corner[4];
    sg_vec_add(v[f->corner[1]], -1, v[f->corner[0]], u);
    sg_vec_add(v[f->corner[2]], -1, v[f->corner[0]], w);
    sg_vec_normalize(u);
    sg_vec_normalize(w);
    sg_vec_cross(u, w, normal);
    sg_vec_normalize(normal);
    sg_vec_add(v[f->along], -1, v[f->origin], u);
    sg_vec_normalize(u);
    sg_vec_cross(normal, u, w);
    const uint32_t n = sg_mesh_add_normal(b, normal);
    for (uint32_t i = 0; i < f->n; i++) {
        double d[3];
        sg_vec_add(v[f->corner[i]], -1, v[f->origin], d);
        corner[i] = (sg_mesh_corner){base + f->corner[i], n, sg_mesh_add_uv(b, sg_vec_dot(d, u), sg_vec_dot(d, w))};
    }
    sg_mesh_add_face(b, corner, f->n, group);
}

sg_status sg_mesh_add_flat(sg_mesh_builder *b, const sg_primitive *p)
{
    solid s;
    uint32_t group;
    if (!put_solid(p, sg_primitive_corners(b->scene, p), &s))
        return SG_OK;
    SG_TRY(sg_mesh_group_of(b, p, &group));
    SG_TRY(sg_mesh_reserve(b, s.nvertices, s.nfaces, 4 * s.nfaces, s.nfaces));
    const uint32_t base = (uint32_t)b->mesh->nvertices;
    for (size_t i = 0; i < s.nvertices; i++) {
        double at[3];
        sg_frame_point(&p->frame, s.at[i][0], s.at[i][1], s.at[i][2], at);
        sg_mesh_add_vertex(b, at);
    }
    for (size_t k = 0; k < s.nfaces; k++)
        add_face(b, &s, k, base, group);
    return SG_OK;
}
