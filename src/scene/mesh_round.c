/* SPDX-License-Identifier: GPL-3.0-or-later */
/* mesh_round.c - surfaces along rings: cylinders, cones, spheres, and what strands of segments are made of. */
#include "scene/mesh_priv.h"

#include <math.h>
#include <stdlib.h>

static const double two_pi = 6.283185307179586;

static bool is_point(const sg_mesh_ring *r)
{
    return sg_vec_dot(r->a, r->a) == 0 && sg_vec_dot(r->b, r->b) == 0;
}

static void ring_point(const sg_mesh_ring *r, double t, double *out)
{
    sg_vec_add(r->centre, cos(t), r->a, out);
    sg_vec_add(out, sin(t), r->b, out);
}

/* Across the surface: around the ring (or the next one, where it is a point) times along it, from the ring before to
 * the ring behind. On circular arcs of evenly spaced rings that is exact. */
static void surface_normal(const sg_mesh_ring *rings, size_t n, size_t k, double t, double *out)
{
    const sg_mesh_ring *wide = is_point(rings + k) ? (k == 0 ? rings + 1 : rings + k - 1) : rings + k;
    double around[3] = {0, 0, 0}, from[3], to[3];
    sg_vec_add(around, -sin(t), wide->a, around);
    sg_vec_add(around, cos(t), wide->b, around);
    ring_point(rings + (k > 0 ? k - 1 : 0), t, from);
    ring_point(rings + (k + 1 < n ? k + 1 : k), t, to);
    sg_vec_add(to, -1, from, to);
    sg_vec_normalize(around);
    sg_vec_normalize(to);
    sg_vec_cross(around, to, out);
    if (sg_vec_normalize(out))
        return;
    sg_vec_cross(wide->a, wide->b, to); /* the rings fold back: away from the axis */
    sg_vec_cross(around, to, out);
    sg_vec_normalize(out);
}

/* First corner of a ring; its vertices, normals and uvs stand together. A ring has a second uv at its seam; a point has
 * one vertex, and a normal and a uv for each side. */
static sg_mesh_corner put_ring(sg_mesh_builder *b, const sg_mesh_ring *rings, size_t n, size_t k)
{
    const unsigned sides = b->radial;
    const sg_mesh_ring *r = rings + k;
    const bool point = is_point(r);
    const sg_mesh *m = b->mesh;
    const sg_mesh_corner first = {(uint32_t)m->nvertices, (uint32_t)m->nnormals, (uint32_t)m->nuvs};
    for (unsigned i = 0; i < sides; i++) {
        const double t = two_pi * (i + (point ? 0.5 : 0)) / sides;
        double at[3];
        ring_point(r, t, at);
        if (!point || i == 0)
            sg_mesh_add_vertex(b, at);
        surface_normal(rings, n, k, t, at);
        sg_mesh_add_normal(b, at);
        sg_mesh_add_uv(b, (i + (point ? 0.5 : 0)) / sides, r->v);
    }
    sg_mesh_add_uv(b, 1, r->v);
    return first;
}

static sg_mesh_corner corner_at(sg_mesh_corner first, bool point, unsigned i, unsigned sides)
{
    const uint32_t around = i % sides;
    return (sg_mesh_corner){first.vertex + (point ? 0 : around), first.normal + around, first.uv + i};
}

static void put_row(sg_mesh_builder *b, sg_mesh_corner low, bool low_point, sg_mesh_corner high, bool high_point,
                    uint32_t group)
{
    for (unsigned i = 0; i < b->radial; i++) {
        sg_mesh_corner c[4];
        uint32_t n = 0;
        c[n++] = corner_at(low, low_point, i, b->radial);
        if (!low_point)
            c[n++] = corner_at(low, low_point, i + 1, b->radial);
        if (!high_point)
            c[n++] = corner_at(high, high_point, i + 1, b->radial);
        c[n++] = corner_at(high, high_point, i, b->radial);
        sg_mesh_add_face(b, c, n, group);
    }
}

/* A flat fan about the centre of the ring, which looks along the axis, or against it. */
static void put_lid(sg_mesh_builder *b, const sg_mesh_ring *r, sg_mesh_corner ring, bool along, uint32_t group)
{
    double axis[3];
    sg_vec_cross(along ? r->a : r->b, along ? r->b : r->a, axis);
    sg_vec_normalize(axis);
    const uint32_t centre = sg_mesh_add_vertex(b, r->centre), normal = sg_mesh_add_normal(b, axis);
    const double width = sg_vec_length(r->a), height = sg_vec_length(r->b);
    const uint32_t middle = sg_mesh_add_uv(b, 0, 0), uv = (uint32_t)b->mesh->nuvs;
    for (unsigned i = 0; i < b->radial; i++)
        sg_mesh_add_uv(b, width * cos(two_pi * i / b->radial), height * (along ? 1 : -1) * sin(two_pi * i / b->radial));
    for (unsigned i = 0; i < b->radial; i++) {
        const unsigned j = (i + 1) % b->radial, one = along ? i : j, two = along ? j : i;
        const sg_mesh_corner c[3] = {
            {centre, normal, middle}, {ring.vertex + one, normal, uv + one}, {ring.vertex + two, normal, uv + two}};
        sg_mesh_add_face(b, c, 3, group);
    }
}

sg_status sg_mesh_add_rings(sg_mesh_builder *b, const sg_mesh_ring *rings, size_t n)
{
    const size_t sides = b->radial, each = n + 2;
    SG_TRY(sg_mesh_reserve(b, each * (sides + 1), each * (sides + 1), each * (sides + 1), each * sides));
    sg_mesh_corner low = put_ring(b, rings, n, 0);
    if (!is_point(rings))
        put_lid(b, rings, low, false, rings[0].group);
    for (size_t k = 1; k < n; k++) {
        const sg_mesh_corner high = put_ring(b, rings, n, k);
        put_row(b, low, is_point(rings + k - 1), high, is_point(rings + k), rings[k - 1].group);
        low = high;
    }
    if (!is_point(rings + n - 1))
        put_lid(b, rings + n - 1, low, true, rings[n - 2].group);
    return SG_OK;
}

/* The ring of an ellipsoid or an elliptic cylinder at this height, as wide as this share of the scope. */
static sg_mesh_ring ring_in_scope(const sg_primitive *p, double height, double share, double v, uint32_t group)
{
    sg_mesh_ring r = {.v = v, .group = group};
    sg_frame_point(&p->frame, p->size[0] / 2, height, p->size[2] / 2, r.centre);
    sg_frame_direction(&p->frame, share * p->size[0] / 2, 0, 0, r.a);
    sg_frame_direction(&p->frame, 0, 0, -share * p->size[2] / 2, r.b);
    return r;
}

static sg_status add_cylinder(sg_mesh_builder *b, const sg_primitive *p, uint32_t group)
{
    const sg_mesh_ring rings[2] = {ring_in_scope(p, 0, p->radius[0], 0, group),
                                   ring_in_scope(p, p->size[1], p->radius[1], p->size[1], group)};
    return sg_mesh_add_rings(b, rings, 2);
}

static sg_status add_sphere(sg_mesh_builder *b, const sg_primitive *p, uint32_t group)
{
    const size_t n = b->radial / 2 + (b->radial < 6) + 1;
    sg_mesh_ring *rings = malloc(n * sizeof *rings);
    if (rings == NULL)
        return SG_FAIL_NOMEM(b->err);
    for (size_t k = 0; k < n; k++) {
        const double v = (double)k / (double)(n - 1), t = two_pi / 2 * v;
        const bool pole = k == 0 || k + 1 == n;
        rings[k] = ring_in_scope(p, p->size[1] * (1 - cos(t)) / 2, pole ? 0 : sin(t), v, group);
    }
    const sg_status st = sg_mesh_add_rings(b, rings, n);
    free(rings);
    return st;
}

sg_status sg_mesh_add_round(sg_mesh_builder *b, const sg_primitive *p)
{
    uint32_t group;
    for (int i = 0; i < 3; i++)
        if (sg_mesh_thin(p, p->size[i]))
            return SG_OK;
    SG_TRY(sg_mesh_group_of(b, p, &group));
    return p->kind == SG_PRIMITIVE_SPHERE ? add_sphere(b, p, group) : add_cylinder(b, p, group);
}
