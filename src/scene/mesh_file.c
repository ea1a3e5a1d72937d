/* SPDX-License-Identifier: GPL-3.0-or-later */
/* mesh_file.c - meshes from files, scaled to fill their scopes. A mesh that is flat along an axis stands in the middle of
 * the scope there. Where the file gives no normal or texture coordinate, faces are flat, and u runs along their first
 * side. */
#include "scene/mesh_priv.h"

#include <string.h>

typedef struct {
    sg_mesh_builder *b;
    const sg_primitive *p;
    const sg_obj *obj;
    double factor[3], low[3];        /* from the file to the scope */
    uint32_t vertices, normals, uvs; /* the first of each */
    uint32_t material, group;        /* of the face before */
    bool any;                        /* there was one */
} placing;

static void place_point(const placing *w, const double *at, double *out)
{
    const double *size = w->p->size;
    double x[3];
    for (int i = 0; i < 3; i++)
        x[i] = w->factor[i] > 0 ? (at[i] - w->low[i]) * w->factor[i] : size[i] / 2;
    sg_frame_point(&w->p->frame, x[0], x[1], x[2], out);
}

/* Normals turn by the inverse of the scaling. */
static bool place_normal(const placing *w, const double *n, double *out)
{
    double x[3];
    for (int i = 0; i < 3; i++)
        x[i] = w->factor[i] > 0 ? n[i] / w->factor[i] : n[i];
    if (!sg_vec_normalize(x))
        return false;
    sg_frame_direction(&w->p->frame, x[0], x[1], x[2], out);
    return sg_vec_normalize(out);
}

static void put_arrays(placing *w)
{
    const sg_mesh *m = w->b->mesh;
    w->vertices = (uint32_t)m->nvertices;
    w->normals = (uint32_t)m->nnormals;
    w->uvs = (uint32_t)m->nuvs;
    double x[3];
    for (size_t i = 0; i < w->obj->nvertices; i++) {
        place_point(w, w->obj->vertices[i], x);
        sg_mesh_add_vertex(w->b, x);
    }
    for (size_t i = 0; i < w->obj->nnormals; i++) {
        if (!place_normal(w, w->obj->normals[i], x))
            memcpy(x, w->p->frame.y, sizeof x); /* no corner uses it */
        sg_mesh_add_normal(w->b, x);
    }
    for (size_t i = 0; i < w->obj->nuvs; i++)
        sg_mesh_add_uv(w->b, w->obj->uvs[i][0], w->obj->uvs[i][1]);
}

/* Axes along the face and across it. @return false when it has no area */
static bool face_axes(const placing *w, const sg_mesh_face *f, double *u, double *v, double *normal)
{
    const double(*at)[3] = (const double(*)[3])(w->b->mesh->vertices + w->vertices);
    const double *first = at[f->corner[0].vertex];
    sg_vec_add(at[f->corner[1].vertex], -1, first, u);
    sg_vec_add(at[f->corner[2].vertex], -1, first, v);
    if (!sg_vec_normalize(u) || !sg_vec_normalize(v))
        return false;
    sg_vec_cross(u, v, normal);
    if (sg_vec_length(normal) < 1e-9 || !sg_vec_normalize(normal))
        return false;
    sg_vec_cross(normal, u, v);
    return true;
}

/* A normal that is there, and does not look through the face to its back. */
static bool has_normal(const placing *w, const sg_mesh_corner *c, const double *face)
{
    return c->normal != SG_NONE && sg_vec_dot(w->obj->normals[c->normal], w->obj->normals[c->normal]) > 0 &&
           sg_vec_dot(w->b->mesh->normals[w->normals + c->normal], face) > 0;
}

static sg_status group_of(placing *w, uint32_t material)
{
    if (w->any && w->material == material)
        return SG_OK;
    w->any = true;
    w->material = material;
    const sg_obj_material *m = material != SG_NONE ? w->obj->materials + material : NULL;
    if (m == NULL || m->color == SG_NONE)
        return sg_mesh_group_of(w->b, w->p, &w->group);
    return sg_mesh_group_of_part(w->b, w->p, material, (sg_mesh_material){m->color, m->name}, &w->group);
}

static sg_status put_face(placing *w, const sg_mesh_face *f)
{
    double u[3], v[3], normal[3];
    sg_mesh_corner corner[4];
    uint32_t flat = SG_NONE;
    if (!face_axes(w, f, u, v, normal))
        return SG_OK;
    SG_TRY(group_of(w, f->group));
    SG_TRY(sg_mesh_reserve(w->b, 0, 1, 4, 1));
    const double(*at)[3] = (const double(*)[3])(w->b->mesh->vertices + w->vertices);
    for (uint32_t i = 0; i < f->ncorners; i++) {
        const sg_mesh_corner *c = f->corner + i;
        double d[3];
        const bool smooth = has_normal(w, c, normal);
        if (!smooth && flat == SG_NONE)
            flat = sg_mesh_add_normal(w->b, normal);
        sg_vec_add(at[c->vertex], -1, at[f->corner[0].vertex], d);
        corner[i].vertex = w->vertices + c->vertex;
        corner[i].normal = smooth ? w->normals + c->normal : flat;
        corner[i].uv = c->uv != SG_NONE ? w->uvs + c->uv : sg_mesh_add_uv(w->b, sg_vec_dot(d, u), sg_vec_dot(d, v));
    }
    sg_mesh_add_face(w->b, corner, f->ncorners, w->group);
    return SG_OK;
}

/* @return false when the scope is too thin for it */
static bool find_factors(placing *w)
{
    int nflat = 0;
    for (int i = 0; i < 3; i++) {
        const double extent = w->obj->high[i] - w->obj->low[i];
        const bool flat = !(extent > 0);
        if (!flat && sg_mesh_thin(w->p, w->p->size[i]))
            return false;
        nflat += flat;
        w->factor[i] = flat ? 0 : w->p->size[i] / extent;
        w->low[i] = w->obj->low[i];
    }
    return nflat < 2;
}

sg_status sg_mesh_add_file(sg_mesh_builder *b, const sg_primitive *p, const sg_obj *obj)
{
    placing w = {.b = b, .p = p, .obj = obj};
    if (!find_factors(&w))
        return SG_OK;
    SG_TRY(sg_mesh_reserve(b, obj->nvertices, obj->nnormals, obj->nuvs, 0));
    put_arrays(&w);
    for (size_t i = 0; i < obj->nfaces; i++)
        SG_TRY(put_face(&w, obj->faces + i));
    return SG_OK;
}
