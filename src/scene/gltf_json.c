/* SPDX-License-Identifier: GPL-3.0-or-later */
/* gltf_json.c - the JSON chunk: what the bytes of the buffer are. A jansson value that could not be made is NULL, which
 * makes all that it stands in NULL too; so one test at the end finds that memory is out. */
#include "scene/gltf_priv.h"

#include "scene/srgb.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FLOAT = 5126, UNSIGNED_SHORT = 5123, UNSIGNED_INT = 5125, ARRAY_BUFFER = 34962, ELEMENT_ARRAY_BUFFER = 34963 };
enum { POSITIONS, NORMALS, UVS, INDICES, ACCESSORS_EACH }; /* buffer views, and the accessors of each primitive */

/* A list that takes over its items; NULL once one of them is. */
static void append(json_t **list, json_t *item)
{
    if (*list != NULL && item != NULL && json_array_append_new(*list, item) == 0)
        return;
    if (*list == NULL)
        json_decref(item);
    json_decref(*list);
    *list = NULL;
}

/* Rounded, so that the colour does not depend on the last bit of pow(). */
static json_t *material_json(const sg_mesh_material *m)
{
    char name[8];
    double rgb[3];
    snprintf(name, sizeof name, "%06x", (unsigned)(m->color & 0xffffff));
    sg_srgb_to_linear(m->color, rgb);
    for (int i = 0; i < 3; i++)
        rgb[i] = round(rgb[i] * 1e6) / 1e6;
    return json_pack("{s:s, s:{s:[f,f,f,f], s:f, s:f}, s:b}", "name", m->name != NULL ? m->name : name,
                     "pbrMetallicRoughness", "baseColorFactor", rgb[0], rgb[1], rgb[2], 1.0, "metallicFactor", 0.0,
                     "roughnessFactor", 1.0, "doubleSided", 1);
}

/* In the order of their numbers, in which primitives use them first. */
static json_t *materials_json(const sg_mesh *mesh, const sg_gltf_pack *pack)
{
    json_t *list = json_array();
    uint32_t n = 0;
    for (size_t i = 0; i < pack->nprimitives; i++)
        if (pack->primitives[i].material == n) {
            append(&list, material_json(mesh->materials + mesh->groups[pack->primitives[i].group].material));
            n++;
        }
    return list;
}

static json_t *primitive_json(const sg_gltf_primitive *p, size_t k)
{
    const json_int_t first = (json_int_t)k * ACCESSORS_EACH;
    return json_pack("{s:{s:I, s:I, s:I}, s:I, s:I}", "attributes", "POSITION", first + POSITIONS, "NORMAL",
                     first + NORMALS, "TEXCOORD_0", first + UVS, "indices", first + INDICES, "material",
                     (json_int_t)p->material);
}

static const char *name_of(const sg_mesh *mesh, const sg_gltf_primitive *p)
{
    const char *name = mesh->groups[p->group].name;
    return name != NULL ? name : "unnamed";
}

/* A mesh for each name, of the primitives from its first to the next name's. */
static json_t *meshes_json(const sg_mesh *mesh, const sg_gltf_pack *pack)
{
    json_t *list = json_array();
    for (size_t i = 0; i < pack->nprimitives;) {
        const char *name = name_of(mesh, pack->primitives + i);
        json_t *primitives = json_array();
        do {
            append(&primitives, primitive_json(pack->primitives + i, i));
            i++;
        } while (i < pack->nprimitives && !pack->primitives[i].first);
        append(&list, json_pack("{s:s, s:o}", "name", name, "primitives", primitives));
    }
    return list;
}

static json_t *nodes_json(const sg_mesh *mesh, const sg_gltf_pack *pack)
{
    json_t *list = json_array();
    json_int_t n = 0;
    for (size_t i = 0; i < pack->nprimitives; i++)
        if (pack->primitives[i].first)
            append(&list, json_pack("{s:s, s:I}", "name", name_of(mesh, pack->primitives + i), "mesh", n++));
    return list;
}

static json_t *scene_json(const sg_gltf_pack *pack)
{
    json_t *nodes = json_array();
    json_int_t n = 0;
    for (size_t i = 0; i < pack->nprimitives; i++)
        if (pack->primitives[i].first)
            append(&nodes, json_integer(n++));
    return json_pack("[{s:o}]", "nodes", nodes);
}

static json_t *accessor_json(int view, size_t offset, int type, size_t count, const char *shape)
{
    return json_pack("{s:i, s:I, s:i, s:I, s:s}", "bufferView", view, "byteOffset", (json_int_t)offset, "componentType",
                     type, "count", (json_int_t)count, "type", shape);
}

static json_t *position_json(const sg_gltf_primitive *p)
{
    json_t *a = accessor_json(POSITIONS, 12 * p->first_vertex, FLOAT, p->nvertices, "VEC3");
    json_t *box = json_pack("{s:[f,f,f], s:[f,f,f]}", "min", (double)p->low[0], (double)p->low[1], (double)p->low[2],
                            "max", (double)p->high[0], (double)p->high[1], (double)p->high[2]);
    if (a != NULL && (box == NULL || json_object_update(a, box) != 0)) {
        json_decref(a);
        a = NULL;
    }
    json_decref(box);
    return a;
}

static json_t *accessors_json(const sg_gltf_pack *pack)
{
    json_t *list = json_array();
    for (size_t i = 0; i < pack->nprimitives; i++) {
        const sg_gltf_primitive *p = pack->primitives + i;
        append(&list, position_json(p));
        append(&list, accessor_json(NORMALS, 12 * p->first_vertex, FLOAT, p->nvertices, "VEC3"));
        append(&list, accessor_json(UVS, 8 * p->first_vertex, FLOAT, p->nvertices, "VEC2"));
        append(&list, accessor_json(INDICES, p->index_offset, p->index_size == 2 ? UNSIGNED_SHORT : UNSIGNED_INT,
                                    p->nindices, "SCALAR"));
    }
    return list;
}

static json_t *views_json(const sg_gltf_pack *pack)
{
    const size_t length[] = {pack->positions.n, pack->normals.n, pack->uvs.n, pack->indices.n};
    const int stride[] = {12, 12, 8};
    json_t *list = json_array();
    size_t offset = 0;
    for (int i = POSITIONS; i <= INDICES; offset += length[i], i++) {
        const json_int_t at = (json_int_t)offset, n = (json_int_t)length[i];
        append(&list, i < INDICES ? json_pack("{s:i, s:I, s:I, s:i, s:i}", "buffer", 0, "byteOffset", at, "byteLength",
                                              n, "byteStride", stride[i], "target", ARRAY_BUFFER)
                                  : json_pack("{s:i, s:I, s:I, s:i}", "buffer", 0, "byteOffset", at, "byteLength", n,
                                              "target", ELEMENT_ARRAY_BUFFER));
    }
    return list;
}

/* A list may not be empty: a mesh without faces has none. */
static json_t *root_json(const sg_mesh *mesh, const sg_gltf_pack *pack)
{
    const json_int_t n = (json_int_t)(pack->positions.n + pack->normals.n + pack->uvs.n + pack->indices.n);
    if (pack->nprimitives == 0)
        return json_pack("{s:{s:s, s:s}, s:i, s:[{}]}", "asset", "generator", "shapegram", "version", "2.0", "scene", 0,
                         "scenes");
    return json_pack("{s:{s:s, s:s}, s:i, s:o, s:o, s:o, s:o, s:o, s:o, s:[{s:I}]}", "asset", "generator", "shapegram",
                     "version", "2.0", "scene", 0, "scenes", scene_json(pack), "nodes", nodes_json(mesh, pack),
                     "meshes", meshes_json(mesh, pack), "materials", materials_json(mesh, pack), "accessors",
                     accessors_json(pack), "bufferViews", views_json(pack), "buffers", "byteLength", n);
}

/* Nine digits tell all 32-bit numbers apart. */
sg_status sg_gltf_json(const sg_mesh *mesh, const sg_gltf_pack *pack, char **text, size_t *length, sg_error *err)
{
    json_t *root = root_json(mesh, pack);
    char *made = root != NULL ? json_dumps(root, JSON_COMPACT | JSON_REAL_PRECISION(9)) : NULL;
    const size_t n = made != NULL ? strlen(made) : 0, padded = (n + 3) / 4 * 4;
    json_decref(root);
    *text = made != NULL ? malloc(padded + 1) : NULL;
    if (*text == NULL) {
        free(made);
        return SG_FAIL_NOMEM(err);
    }
    memset(*text, ' ', padded);
    memcpy(*text, made, n);
    (*text)[padded] = '\0';
    *length = padded;
    free(made);
    return SG_OK;
}
