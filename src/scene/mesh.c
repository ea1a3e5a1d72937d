/* SPDX-License-Identifier: GPL-3.0-or-later */
/* mesh.c - the arrays of a mesh, its groups, and the walk over a scene. */
#include "scene/mesh_priv.h"

#include "core/array.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void sg_mesh_clear(sg_mesh *mesh)
{
    free(mesh->vertices);
    free(mesh->normals);
    free(mesh->uvs);
    free(mesh->faces);
    free(mesh->groups);
    free(mesh->materials);
    memset(mesh, 0, sizeof *mesh);
}

static void empty(sg_mesh *m)
{
    m->nvertices = m->nnormals = m->nuvs = m->nfaces = m->ngroups = m->nmaterials = 0;
}

sg_status sg_mesh_reserve(sg_mesh_builder *b, size_t vertices, size_t normals, size_t uvs, size_t faces)
{
    sg_mesh *m = b->mesh;
    const size_t most = UINT32_MAX - 1;
    if (m->nvertices + vertices > most || m->nnormals + normals > most || m->nuvs + uvs > most ||
        m->nfaces + faces > most)
        return SG_FAIL(b->err, SG_ENUMERIC, "a mesh of more than 2^32 vertices");
    if (!SG_GROW(m->vertices, m->vertices_capacity, m->nvertices + vertices) ||
        !SG_GROW(m->normals, m->normals_capacity, m->nnormals + normals) ||
        !SG_GROW(m->uvs, m->uvs_capacity, m->nuvs + uvs) || !SG_GROW(m->faces, m->faces_capacity, m->nfaces + faces))
        return SG_FAIL_NOMEM(b->err);
    return SG_OK;
}

uint32_t sg_mesh_add_vertex(sg_mesh_builder *b, const double *at)
{
    memcpy(b->mesh->vertices[b->mesh->nvertices], at, sizeof *b->mesh->vertices);
    return (uint32_t)b->mesh->nvertices++;
}

uint32_t sg_mesh_add_normal(sg_mesh_builder *b, const double *direction)
{
    memcpy(b->mesh->normals[b->mesh->nnormals], direction, sizeof *b->mesh->normals);
    return (uint32_t)b->mesh->nnormals++;
}

uint32_t sg_mesh_add_uv(sg_mesh_builder *b, double u, double v)
{
    b->mesh->uvs[b->mesh->nuvs][0] = u;
    b->mesh->uvs[b->mesh->nuvs][1] = v;
    return (uint32_t)b->mesh->nuvs++;
}

void sg_mesh_add_face(sg_mesh_builder *b, const sg_mesh_corner *corners, uint32_t n, uint32_t group)
{
    sg_mesh_face *f = b->mesh->faces + b->mesh->nfaces++;
    memset(f, 0, sizeof *f);
    memcpy(f->corner, corners, n * sizeof *corners);
    f->ncorners = n;
    f->group = group;
}

static sg_status material_of(sg_mesh_builder *b, sg_mesh_material wanted, uint32_t *material)
{
    sg_mesh *m = b->mesh;
    const char *name = wanted.name;
    for (size_t i = 0; i < m->nmaterials; i++) {
        const sg_mesh_material *k = m->materials + i;
        if (k->color == wanted.color && (k->name == NULL) == (name == NULL) &&
            (name == NULL || strcmp(k->name, name) == 0)) {
            *material = (uint32_t)i;
            return SG_OK;
        }
    }
    if (!SG_GROW(m->materials, m->materials_capacity, m->nmaterials + 1))
        return SG_FAIL_NOMEM(b->err);
    *material = (uint32_t)m->nmaterials;
    m->materials[m->nmaterials++] = wanted;
    return SG_OK;
}

/* There are few: the grammar and its mesh files name all materials and labels. */
sg_status sg_mesh_group_of_part(sg_mesh_builder *b, const sg_primitive *p, uint32_t part, sg_mesh_material own,
                                uint32_t *group)
{
    sg_mesh *m = b->mesh;
    const sg_grammar *g = b->scene->grammar;
    for (size_t i = 0; i < m->ngroups; i++) {
        const sg_mesh_group *k = m->groups + i;
        if (k->key_material == p->material && k->key_label == p->label && k->key_mesh == p->mesh && k->key_part == part) {
            *group = (uint32_t)i;
            return SG_OK;
        }
    }
    sg_mesh_group made = {.key_material = p->material, .key_label = p->label, .key_mesh = p->mesh, .key_part = part};
    made.name = p->mesh != SG_NONE    ? sg_grammar_string(g, p->mesh)
                : p->label != SG_NONE ? sg_grammar_symbol(g, p->label)->name
                                      : NULL;
    SG_TRY(material_of(b, own, &made.material));
    if (!SG_GROW(m->groups, m->groups_capacity, m->ngroups + 1))
        return SG_FAIL_NOMEM(b->err);
    *group = (uint32_t)m->ngroups;
    m->groups[m->ngroups++] = made;
    return SG_OK;
}

sg_status sg_mesh_group_of(sg_mesh_builder *b, const sg_primitive *p, uint32_t *group)
{
    sg_mesh_material own;
    own.color = sg_scene_material(b->scene->grammar, p, &own.name);
    return sg_mesh_group_of_part(b, p, SG_NONE, own, group);
}

static double largest(const double *x)
{
    return fmax(fabs(x[0]), fmax(fabs(x[1]), fabs(x[2])));
}

bool sg_mesh_thin(const sg_primitive *p, double length)
{
    return !(length > 1e-9 * (1 + largest(p->frame.origin) + largest(p->size)));
}

static sg_status check_extent(const sg_primitive *p, sg_error *err)
{
    const double far = 1e100;
    if (largest(p->frame.origin) <= far && largest(p->size) <= far && p->radius[0] <= far && p->radius[1] <= far)
        return SG_OK;
    return SG_FAIL(err, SG_ENUMERIC, "a primitive that is larger or farther than 1e100");
}

static sg_status add_primitive(sg_mesh_builder *b, const sg_primitive *p)
{
    const sg_obj *obj;
    SG_TRY(check_extent(p, b->err));
    switch ((sg_primitive_kind)p->kind) {
    case SG_PRIMITIVE_CYLINDER:
    case SG_PRIMITIVE_SPHERE:
        return sg_mesh_add_round(b, p);
    case SG_PRIMITIVE_BOX:
    case SG_PRIMITIVE_PRISM:
    case SG_PRIMITIVE_HIP:
    case SG_PRIMITIVE_POLYGON:
    case SG_PRIMITIVE_LABEL:
        return sg_mesh_add_flat(b, p);
    case SG_PRIMITIVE_MESH:
        obj = b->assets != NULL ? sg_assets_find(b->assets, p->mesh) : NULL;
        return obj != NULL ? sg_mesh_add_file(b, p, obj) : sg_mesh_add_flat(b, p);
    case SG_PRIMITIVE_SEGMENT: /* with those that it continues */
    case SG_PRIMITIVE_COUNT:
        break;
    }
    return SG_OK;
}

/* Put the faces of each group together; their order in it stays. */
static sg_status sort_faces(sg_mesh *m, sg_error *err)
{
    sg_mesh_face *sorted = m->nfaces > 0 ? malloc(m->nfaces * sizeof *sorted) : NULL;
    if (sorted == NULL)
        return m->nfaces > 0 ? SG_FAIL_NOMEM(err) : SG_OK;
    for (size_t i = 0; i < m->nfaces; i++)
        m->groups[m->faces[i].group].n++;
    for (size_t k = 0, first = 0; k < m->ngroups; k++) {
        m->groups[k].first = first;
        first += m->groups[k].n;
        m->groups[k].n = 0;
    }
    for (size_t i = 0; i < m->nfaces; i++) {
        sg_mesh_group *g = m->groups + m->faces[i].group;
        sorted[g->first + g->n++] = m->faces[i];
    }
    memcpy(m->faces, sorted, m->nfaces * sizeof *sorted);
    free(sorted);
    return SG_OK;
}

static sg_status build(sg_mesh_builder *b)
{
    for (size_t i = 0; i < b->scene->n; i++)
        SG_TRY(add_primitive(b, b->scene->items + i));
    SG_TRY(sg_mesh_add_segments(b));
    return sort_faces(b->mesh, b->err);
}

sg_status sg_mesh_from_scene(const sg_scene *scene, const sg_mesh_opts *opts, sg_mesh *mesh, sg_error *err)
{
    empty(mesh);
    if (opts->radial < 3 || opts->radial > 1024)
        return SG_FAIL(err, SG_EINVAL, "round primitives of %u sides; expected 3 to 1024", opts->radial);
    const unsigned halved = opts->detail < 16 ? opts->radial >> opts->detail : 0;
    sg_mesh_builder b = {scene, mesh, opts->assets, halved > 3 ? halved : 3, err};
    const sg_status st = build(&b);
    if (st != SG_OK)
        empty(mesh);
    return st;
}
