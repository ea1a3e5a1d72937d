/* SPDX-License-Identifier: GPL-3.0-or-later */
/* gltf_pack.c - corners to vertices: where a mesh has separate indices for places, normals and texture coordinates, glTF
 * has one, so each different corner of a primitive becomes a vertex. Quadrilaterals are cut from their first corner. */
#include "scene/gltf_priv.h"

#include "core/array.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    const sg_mesh *mesh;
    sg_gltf_pack *pack;
    /* The vertices of the primitive in the making, found by their corners: open addressing, numbers from 1, 0 is free. */
    uint32_t *table;
    size_t table_size; /* a power of two */
    sg_mesh_corner *corners;
    size_t ncorners, corners_capacity;
    uint32_t *indices;
    size_t nindices, indices_capacity;
    sg_error *err;
} packer;

void sg_gltf_pack_clear(sg_gltf_pack *pack)
{
    sg_bytes_clear(&pack->positions);
    sg_bytes_clear(&pack->normals);
    sg_bytes_clear(&pack->uvs);
    sg_bytes_clear(&pack->indices);
    free(pack->primitives);
    free(pack->materials);
    memset(pack, 0, sizeof *pack);
}

static bool same_name(const char *a, const char *b)
{
    return a == NULL || b == NULL ? a == b : strcmp(a, b) == 0;
}

/* As in OBJ files: lengths under half a micrometre, and the sign of zero, are rounding. */
static float snap(double x)
{
    return fabs(x) < 5e-7 ? 0 : (float)x;
}

static sg_status put_vertex(packer *k, const sg_mesh_corner *c, sg_gltf_primitive *p)
{
    const double *at = k->mesh->vertices[c->vertex], *normal = k->mesh->normals[c->normal], *uv = k->mesh->uvs[c->uv];
    for (int i = 0; i < 3; i++) {
        const float x = snap(at[i]);
        if (!isfinite(x))
            return SG_FAIL(k->err, SG_ENUMERIC, "a place that is farther than the numbers of glTF go");
        p->low[i] = fminf(p->low[i], x);
        p->high[i] = fmaxf(p->high[i], x);
        sg_bytes_put_f32(&k->pack->positions, x);
        sg_bytes_put_f32(&k->pack->normals, snap(normal[i]));
    }
    const float u = snap(uv[0]), v = snap(1 - uv[1]); /* glTF counts from the top */
    sg_bytes_put_f32(&k->pack->uvs, u);
    sg_bytes_put_f32(&k->pack->uvs, v);
    if (!isfinite(u) || !isfinite(v))
        return SG_FAIL(k->err, SG_ENUMERIC, "a texture coordinate that is larger than the numbers of glTF go");
    return SG_OK;
}

static size_t hash(const sg_mesh_corner *c)
{
    uint64_t h = c->vertex * UINT64_C(0x9e3779b97f4a7c15);
    h = (h ^ h >> 29 ^ c->normal) * UINT64_C(0xbf58476d1ce4e5b9);
    h = (h ^ h >> 32 ^ c->uv) * UINT64_C(0x94d049bb133111eb);
    return (size_t)(h ^ h >> 31);
}

/* The vertex of a corner, counted in its primitive; made when it is the first of its kind. */
static sg_status vertex_of(packer *k, const sg_mesh_corner *c, sg_gltf_primitive *p, uint32_t *out)
{
    size_t at = hash(c) & (k->table_size - 1);
    for (; k->table[at] != 0; at = (at + 1) & (k->table_size - 1))
        if (memcmp(k->corners + k->table[at] - 1, c, sizeof *c) == 0) {
            *out = k->table[at] - 1;
            return SG_OK;
        }
    if (!SG_GROW(k->corners, k->corners_capacity, k->ncorners + 1))
        return SG_FAIL_NOMEM(k->err);
    *out = (uint32_t)k->ncorners;
    k->corners[k->ncorners++] = *c;
    k->table[at] = *out + 1;
    return put_vertex(k, c, p);
}

static sg_status add_face(packer *k, const sg_mesh_face *f, sg_gltf_primitive *p)
{
    uint32_t v[4];
    for (uint32_t i = 0; i < f->ncorners; i++)
        SG_TRY(vertex_of(k, f->corner + i, p, v + i));
    if (!SG_GROW(k->indices, k->indices_capacity, k->nindices + 6))
        return SG_FAIL_NOMEM(k->err);
    for (uint32_t i = 1; i + 1 < f->ncorners; i++) {
        k->indices[k->nindices++] = v[0];
        k->indices[k->nindices++] = v[i];
        k->indices[k->nindices++] = v[i + 1];
    }
    return SG_OK;
}

static bool belongs(const packer *k, size_t group, size_t to)
{
    const sg_mesh_group *a = k->mesh->groups + group, *b = k->mesh->groups + to;
    return a->n > 0 && a->material == b->material && same_name(a->name, b->name);
}

/* Room for twice the corners of all groups of the primitive. */
static sg_status empty_table(packer *k, size_t group)
{
    size_t need = 1;
    for (size_t i = group; i < k->mesh->ngroups; i++)
        need += belongs(k, i, group) ? 8 * k->mesh->groups[i].n : 0;
    if (need > k->table_size) {
        size_t size = 64;
        while (size < need)
            size *= 2;
        free(k->table);
        k->table_size = size;
        k->table = malloc(size * sizeof *k->table);
        if (k->table == NULL) {
            k->table_size = 0;
            return SG_FAIL_NOMEM(k->err);
        }
    }
    memset(k->table, 0, k->table_size * sizeof *k->table);
    k->ncorners = k->nindices = 0;
    return SG_OK;
}

/* 65535 and 2^32 - 1 are not used: they restart primitives. */
static void put_indices(packer *k, sg_gltf_primitive *p)
{
    sg_bytes *out = &k->pack->indices;
    p->nvertices = k->ncorners;
    p->nindices = k->nindices;
    p->index_offset = out->n;
    p->index_size = k->ncorners <= UINT16_MAX ? 2 : 4;
    for (size_t i = 0; i < k->nindices; i++)
        sg_bytes_put(out, k->indices[i], p->index_size);
    if (out->n % 4 != 0)
        sg_bytes_put(out, 0, 4 - out->n % 4);
}

static sg_status pack_primitive(packer *k, size_t group, bool first)
{
    const sg_mesh *m = k->mesh;
    sg_gltf_primitive p = {.group = (uint32_t)group, .first = first, .first_vertex = k->pack->nvertices};
    for (int i = 0; i < 3; i++) {
        p.low[i] = INFINITY;
        p.high[i] = -INFINITY;
    }
    SG_TRY(empty_table(k, group));
    for (size_t i = group; i < m->ngroups; i++)
        for (size_t f = 0; belongs(k, i, group) && f < m->groups[i].n; f++)
            SG_TRY(add_face(k, m->faces + m->groups[i].first + f, &p));
    put_indices(k, &p);
    k->pack->nvertices += p.nvertices;
    uint32_t *material = k->pack->materials + m->groups[group].material;
    if (*material == SG_NONE)
        *material = k->pack->nmaterials++;
    p.material = *material;
    if (!SG_GROW(k->pack->primitives, k->pack->capacity, k->pack->nprimitives + 1))
        return SG_FAIL_NOMEM(k->err);
    k->pack->primitives[k->pack->nprimitives++] = p;
    return SG_OK;
}

static bool is_first_of_name(const sg_mesh *m, size_t group)
{
    for (size_t i = 0; i < group; i++)
        if (m->groups[i].n > 0 && same_name(m->groups[i].name, m->groups[group].name))
            return false;
    return m->groups[group].n > 0;
}

static bool is_first_of_primitive(const packer *k, size_t group)
{
    for (size_t i = 0; i < group; i++)
        if (belongs(k, i, group))
            return false;
    return k->mesh->groups[group].n > 0;
}

/* Names in the order of the groups, and in each its materials: there are few of both. */
static sg_status pack_all(packer *k)
{
    const sg_mesh *m = k->mesh;
    for (size_t i = 0; i < m->ngroups; i++) {
        if (!is_first_of_name(m, i))
            continue;
        for (size_t j = i; j < m->ngroups; j++)
            if (same_name(m->groups[j].name, m->groups[i].name) && is_first_of_primitive(k, j))
                SG_TRY(pack_primitive(k, j, j == i));
    }
    const sg_gltf_pack *p = k->pack;
    if (p->positions.failed || p->normals.failed || p->uvs.failed || p->indices.failed)
        return SG_FAIL_NOMEM(k->err);
    if (p->positions.n + p->normals.n + p->uvs.n + p->indices.n > UINT32_MAX - ((size_t)1 << 26))
        return SG_FAIL(k->err, SG_ENUMERIC, "a mesh that is too large for a file of 4 GiB");
    return SG_OK;
}

sg_status sg_gltf_pack_mesh(const sg_mesh *mesh, sg_gltf_pack *pack, sg_error *err)
{
    packer k = {.mesh = mesh, .pack = pack, .err = err};
    memset(pack, 0, sizeof *pack);
    pack->materials = malloc((mesh->nmaterials + 1) * sizeof *pack->materials);
    if (pack->materials == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t i = 0; i < mesh->nmaterials; i++)
        pack->materials[i] = SG_NONE;
    const sg_status st = pack_all(&k);
    free(k.table);
    free(k.corners);
    free(k.indices);
    return st;
}
