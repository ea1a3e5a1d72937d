/* SPDX-License-Identifier: GPL-3.0-or-later */
/* gltf_check.c - the container, then what each object refers to, then the numbers themselves.
 * Source: Khronos Group, "glTF 2.0 Specification" (2021), sections 3.6 to 3.9, 4.4 and 5. */
#include "tests/gltf_check.h"

#include <jansson.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define TRY(expr)                                                                                                      \
    do {                                                                                                               \
        const char *try_rule_ = (expr);                                                                                \
        if (try_rule_ != NULL)                                                                                         \
            return try_rule_;                                                                                          \
    } while (0)
#define MUST(condition, rule)                                                                                          \
    do {                                                                                                               \
        if (!(condition))                                                                                              \
            return (rule);                                                                                             \
    } while (0)

enum { BYTE = 5120, UBYTE = 5121, USHORT = 5123, UINT = 5125, FLOAT = 5126, VERTICES = 34962, ELEMENTS = 34963 };
enum { NODES, MESHES, MATERIALS, ACCESSORS, VIEWS, BUFFERS, NLISTS };
static const char *const list_names[NLISTS] = {"nodes", "meshes", "materials", "accessors", "bufferViews", "buffers"};

typedef struct {
    json_t *root;
    const unsigned char *bin;
    size_t bin_length;
    json_t *list[NLISTS];
    bool *used[NLISTS];
    gltf_counts counts;
} glb;

typedef struct {
    const unsigned char *data;
    size_t count, stride, size; /* size: of one component */
    unsigned ncomponents;
    int type;
} view;

static uint32_t u32(const unsigned char *p)
{
    return p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

static float f32(const unsigned char *p)
{
    const uint32_t bits = u32(p);
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* ---- container ---- */

static const char *read_container(const unsigned char *b, size_t n, glb *g, const char **json, size_t *json_length)
{
    MUST(n >= 20 && memcmp(b, "glTF", 4) == 0, "magic");
    MUST(u32(b + 4) == 2, "container version");
    MUST(u32(b + 8) == n, "length of the file");
    *json_length = u32(b + 12);
    MUST(*json_length % 4 == 0 && *json_length <= n - 20, "length of the JSON chunk");
    MUST(memcmp(b + 16, "JSON", 4) == 0, "the first chunk is JSON");
    *json = (const char *)b + 20;
    const size_t at = 20 + *json_length;
    if (at == n)
        return NULL;
    MUST(n - at >= 8 && u32(b + at) % 4 == 0 && u32(b + at) == n - at - 8, "length of the binary chunk");
    MUST(memcmp(b + at + 4, "BIN", 4) == 0, "the second chunk is binary");
    g->bin = b + at + 8;
    g->bin_length = n - at - 8;
    return NULL;
}

static const char *read_json(glb *g, const char *json, size_t n)
{
    json_error_t error;
    size_t end = n;
    g->root = json_loadb(json, n, JSON_DISABLE_EOF_CHECK | JSON_REJECT_DUPLICATES, &error);
    MUST(json_is_object(g->root), "JSON");
    MUST(json[0] == '{', "JSON begins with a brace");
    while (end > 0 && json[end - 1] == ' ')
        end--;
    MUST(end > 0 && json[end - 1] == '}' && n - end < 4, "JSON is padded with spaces");
    return NULL;
}

/* ---- references ---- */

static const char *read_lists(glb *g)
{
    for (int i = 0; i < NLISTS; i++) {
        g->list[i] = json_object_get(g->root, list_names[i]);
        MUST(g->list[i] == NULL || (json_is_array(g->list[i]) && json_array_size(g->list[i]) > 0),
             "a list is not empty");
        g->used[i] = calloc(json_array_size(g->list[i]) + 1, sizeof(bool));
    }
    return NULL;
}

/* The object that a member of `from` refers to; it is used then. NULL: none. */
static json_t *refer(glb *g, const json_t *index, int list)
{
    const json_int_t i = json_integer_value(index);
    if (!json_is_integer(index) || i < 0 || (size_t)i >= json_array_size(g->list[list]))
        return NULL;
    g->used[list][i] = true;
    return json_array_get(g->list[list], (size_t)i);
}

static bool is_named(const json_t *object)
{
    const char *name = json_string_value(json_object_get(object, "name"));
    return name != NULL && name[0] != '\0';
}

/* A whole number of 0 or more, or a default where there is none. */
static bool get_size(const json_t *object, const char *name, size_t otherwise, size_t *out)
{
    const json_t *v = json_object_get(object, name);
    *out = v != NULL ? (size_t)json_integer_value(v) : otherwise;
    return v == NULL || (json_is_integer(v) && json_integer_value(v) >= 0);
}

/* ---- accessors ---- */

static size_t size_of(int type)
{
    return type == FLOAT || type == UINT        ? 4
           : type == USHORT || type == BYTE + 2 ? 2
           : type == BYTE || type == UBYTE      ? 1
                                                : 0;
}

static unsigned ncomponents_of(const char *shape)
{
    static const char *const shapes[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
    for (unsigned i = 0; i < 4 && shape != NULL; i++)
        if (strcmp(shape, shapes[i]) == 0)
            return i + 1;
    return 0;
}

static const char *read_view(glb *g, const json_t *accessor, int target, view *v, size_t *begin, size_t *end)
{
    const json_t *bv = refer(g, json_object_get(accessor, "bufferView"), VIEWS);
    MUST(bv != NULL, "a buffer view that is there");
    MUST(refer(g, json_object_get(bv, "buffer"), BUFFERS) != NULL, "a buffer that is there");
    size_t length;
    MUST(get_size(bv, "byteOffset", 0, begin) && get_size(bv, "byteLength", 0, &length) && length > 0,
         "a buffer view's place");
    MUST(*begin <= g->bin_length && length <= g->bin_length - *begin, "a buffer view stays in the buffer");
    MUST(json_integer_value(json_object_get(bv, "target")) == target, "target of a buffer view");
    const json_t *stride = json_object_get(bv, "byteStride");
    MUST(target == VERTICES || stride == NULL, "indices have no stride");
    v->stride = stride != NULL ? (size_t)json_integer_value(stride) : 0;
    MUST(stride == NULL || (v->stride >= 4 && v->stride <= 252 && v->stride % 4 == 0), "stride of a buffer view");
    *end = *begin + length;
    return NULL;
}

static const char *read_accessor(glb *g, const json_t *index, int target, view *v)
{
    const json_t *a = refer(g, index, ACCESSORS);
    size_t begin, end, offset;
    MUST(a != NULL, "an accessor that is there");
    TRY(read_view(g, a, target, v, &begin, &end));
    v->type = (int)json_integer_value(json_object_get(a, "componentType"));
    v->size = size_of(v->type);
    v->ncomponents = ncomponents_of(json_string_value(json_object_get(a, "type")));
    MUST(v->size > 0 && v->ncomponents > 0, "type of an accessor");
    MUST(get_size(a, "count", 0, &v->count) && v->count > 0, "count of an accessor");
    MUST(get_size(a, "byteOffset", 0, &offset) && offset % v->size == 0 && (begin + offset) % v->size == 0 &&
             (target == ELEMENTS || (offset % 4 == 0 && begin % 4 == 0)),
         "alignment of an accessor");
    const size_t each = v->size * v->ncomponents;
    v->stride = v->stride > 0 ? v->stride : each;
    MUST(v->stride >= each && v->count <= g->bin_length && offset <= end - begin &&
             (v->count - 1) * v->stride + each <= end - begin - offset,
         "an accessor stays in its view");
    v->data = g->bin + begin + offset;
    return NULL;
}

/* Of a float accessor. */
static const char *check_box(const view *v, const json_t *accessor, bool required)
{
    const json_t *box[2] = {json_object_get(accessor, "min"), json_object_get(accessor, "max")};
    MUST(!required || (box[0] != NULL && box[1] != NULL), "positions have a min and max");
    for (int side = 0; side < 2 && box[side] != NULL; side++) {
        MUST(json_array_size(box[side]) == v->ncomponents, "size of min and max");
        for (unsigned c = 0; c < v->ncomponents; c++) {
            float most = f32(v->data + 4 * c);
            for (size_t i = 0; i < v->count; i++) {
                const float x = f32(v->data + i * v->stride + 4 * c);
                most = side == 0 ? fminf(most, x) : fmaxf(most, x);
            }
            MUST((float)json_number_value(json_array_get(box[side], c)) == most, "min and max are those of the data");
        }
    }
    return NULL;
}

static const char *read_attribute(glb *g, const json_t *attributes, const char *name, unsigned ncomponents,
                                  size_t count, view *v)
{
    const json_t *index = json_object_get(attributes, name);
    MUST(index != NULL, "an attribute is missing");
    TRY(read_accessor(g, index, VERTICES, v));
    MUST(v->type == FLOAT && v->ncomponents == ncomponents, "type of an attribute");
    MUST(count == 0 || v->count == count, "attributes of one length");
    for (size_t i = 0; i < v->count; i++)
        for (unsigned c = 0; c < ncomponents; c++)
            MUST(isfinite(f32(v->data + i * v->stride + 4 * c)), "finite numbers");
    return check_box(v, json_array_get(g->list[ACCESSORS], (size_t)json_integer_value(index)),
                     strcmp(name, "POSITION") == 0);
}

static uint32_t index_at(const view *v, size_t i)
{
    const unsigned char *p = v->data + i * v->size;
    return v->size == 4 ? u32(p) : v->size == 2 ? p[0] | (uint32_t)p[1] << 8 : p[0];
}

static const char *check_indices(const view *v, size_t nvertices)
{
    bool *used = calloc(nvertices, 1);
    const uint32_t restart = v->size == 4 ? UINT32_MAX : v->size == 2 ? UINT16_MAX : UINT8_MAX;
    const char *rule = v->count % 3 != 0 ? "whole triangles" : NULL;
    for (size_t i = 0; i < v->count && rule == NULL; i++) {
        const uint32_t k = index_at(v, i);
        rule = k == restart ? "no index restarts a primitive" : k >= nvertices ? "indices in range" : NULL;
        if (rule == NULL)
            used[k] = true;
    }
    for (size_t i = 0; i < nvertices && rule == NULL; i++)
        rule = used[i] ? NULL : "all vertices are used";
    free(used);
    return rule;
}

static const char *check_normals(const view *v)
{
    for (size_t i = 0; i < v->count; i++) {
        const unsigned char *p = v->data + i * v->stride;
        const double x = f32(p), y = f32(p + 4), z = f32(p + 8);
        MUST(fabs(sqrt(x * x + y * y + z * z) - 1) < 1e-5, "normals of length 1");
    }
    return NULL;
}

/* ---- objects ---- */

static const char *check_primitive(glb *g, const json_t *p)
{
    const json_t *attributes = json_object_get(p, "attributes");
    view positions, normals, uvs, indices;
    MUST(json_integer_value(json_object_get(p, "mode")) == (json_object_get(p, "mode") != NULL ? 4 : 0), "triangles");
    TRY(read_attribute(g, attributes, "POSITION", 3, 0, &positions));
    TRY(read_attribute(g, attributes, "NORMAL", 3, positions.count, &normals));
    TRY(read_attribute(g, attributes, "TEXCOORD_0", 2, positions.count, &uvs));
    TRY(check_normals(&normals));
    TRY(read_accessor(g, json_object_get(p, "indices"), ELEMENTS, &indices));
    MUST((indices.type == USHORT || indices.type == UINT) && indices.ncomponents == 1, "type of indices");
    TRY(check_indices(&indices, positions.count));
    MUST(refer(g, json_object_get(p, "material"), MATERIALS) != NULL, "a material that is there");
    g->counts.vertices += positions.count;
    g->counts.triangles += indices.count / 3;
    g->counts.primitives++;
    return NULL;
}

static const char *check_meshes(glb *g)
{
    size_t i, k;
    json_t *mesh, *primitive;
    json_array_foreach(g->list[MESHES], i, mesh)
    {
        json_t *list = json_object_get(mesh, "primitives");
        MUST(is_named(mesh), "meshes have names");
        MUST(json_array_size(list) > 0, "a mesh has primitives");
        json_array_foreach(list, k, primitive) TRY(check_primitive(g, primitive));
    }
    return NULL;
}

static const char *check_materials(const glb *g)
{
    size_t i, k;
    json_t *m, *x;
    json_array_foreach(g->list[MATERIALS], i, m)
    {
        const json_t *pbr = json_object_get(m, "pbrMetallicRoughness"),
                     *color = json_object_get(pbr, "baseColorFactor");
        MUST(is_named(m), "materials have names");
        MUST(json_array_size(color) == 4, "a base colour of four numbers");
        json_array_foreach(color, k, x) MUST(
            json_is_number(x) && json_number_value(x) >= 0 && json_number_value(x) <= 1, "a base colour from 0 to 1");
        for (int f = 0; f < 2; f++) {
            const json_t *factor = json_object_get(pbr, f == 0 ? "metallicFactor" : "roughnessFactor");
            MUST(json_is_number(factor) && json_number_value(factor) >= 0 && json_number_value(factor) <= 1,
                 "factors from 0 to 1");
        }
    }
    return NULL;
}

static const char *check_scene(glb *g)
{
    json_t *scenes = json_object_get(g->root, "scenes"), *node;
    size_t i;
    MUST(json_array_size(scenes) == 1 && json_integer_value(json_object_get(g->root, "scene")) == 0, "one scene");
    json_t *nodes = json_object_get(json_array_get(scenes, 0), "nodes");
    MUST(nodes == NULL || json_array_size(nodes) > 0, "a list is not empty");
    json_array_foreach(nodes, i, node) MUST(refer(g, node, NODES) != NULL, "a node that is there");
    json_array_foreach(g->list[NODES], i, node)
    {
        MUST(is_named(node), "nodes have names");
        MUST(refer(g, json_object_get(node, "mesh"), MESHES) != NULL, "a mesh that is there");
    }
    return NULL;
}

static const char *check_buffer(const glb *g)
{
    const size_t n = json_array_size(g->list[BUFFERS]);
    if (n == 0) {
        MUST(g->bin == NULL, "no binary chunk without a buffer");
        return NULL;
    }
    const json_int_t length = json_integer_value(json_object_get(json_array_get(g->list[BUFFERS], 0), "byteLength"));
    MUST(n == 1 && json_object_get(json_array_get(g->list[BUFFERS], 0), "uri") == NULL,
         "the buffer is the binary chunk");
    MUST(length > 0 && (size_t)length <= g->bin_length && g->bin_length - (size_t)length < 4, "length of the buffer");
    for (size_t i = (size_t)length; i < g->bin_length; i++)
        MUST(g->bin[i] == 0, "the binary chunk is padded with zeros");
    return NULL;
}

static const char *check_used(const glb *g)
{
    for (int i = 0; i < NLISTS; i++)
        for (size_t k = 0; k < json_array_size(g->list[i]); k++)
            MUST(g->used[i][k], "all is used");
    return NULL;
}

static const char *check_all(glb *g, const unsigned char *bytes, size_t n)
{
    const char *json = NULL;
    size_t length = 0;
    TRY(read_container(bytes, n, g, &json, &length));
    TRY(read_json(g, json, length));
    const json_t *asset = json_object_get(g->root, "asset");
    const char *version = json_string_value(json_object_get(asset, "version"));
    const char *generator = json_string_value(json_object_get(asset, "generator"));
    MUST(version != NULL && strcmp(version, "2.0") == 0, "asset version");
    MUST(generator != NULL && strcmp(generator, "shapegram") == 0, "generator");
    TRY(read_lists(g));
    TRY(check_buffer(g));
    TRY(check_scene(g));
    TRY(check_meshes(g));
    TRY(check_materials(g));
    return check_used(g);
}

const char *gltf_check(const unsigned char *bytes, size_t n, gltf_counts *counts)
{
    glb g = {0};
    const char *rule = check_all(&g, bytes, n);
    g.counts.meshes = json_array_size(g.list[MESHES]);
    g.counts.materials = json_array_size(g.list[MATERIALS]);
    g.counts.nodes = json_array_size(g.list[NODES]);
    if (counts != NULL && rule == NULL)
        *counts = g.counts;
    for (int i = 0; i < NLISTS; i++)
        free(g.used[i]);
    json_decref(g.root);
    return rule;
}
