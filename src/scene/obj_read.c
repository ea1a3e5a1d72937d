/* SPDX-License-Identifier: GPL-3.0-or-later */
/* obj_read.c - the statements of OBJ files, and the files that belong to a mesh. */
#include "config.h"

#include "scene/obj_priv.h"

#include "core/array.h"
#include "core/file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    sg_obj_text t;
    sg_obj *obj;
    uint32_t material;
} reader;

void sg_obj_clear(sg_obj *obj)
{
    free(obj->vertices);
    free(obj->normals);
    free(obj->uvs);
    free(obj->faces);
    free(obj->materials);
    free(obj->libraries);
    sg_names_clear(&obj->names);
    sg_arena_free(obj->arena);
    memset(obj, 0, sizeof *obj);
}

sg_status sg_obj_material_find(sg_obj *obj, const char *name, bool make, uint32_t *out, sg_error *err)
{
    *out = sg_names_get(&obj->names, name);
    if (*out != SG_NONE || !make)
        return SG_OK;
    if (!SG_GROW(obj->materials, obj->materials_capacity, obj->nmaterials + 1) ||
        !sg_names_put(&obj->names, name, (uint32_t)obj->nmaterials))
        return SG_FAIL_NOMEM(err);
    *out = (uint32_t)obj->nmaterials;
    obj->materials[obj->nmaterials++] = (sg_obj_material){name, SG_NONE};
    return SG_OK;
}

/* ---- numbers ---- */

/* Behind the numbers that are used up to `more` may follow: a weight, a colour. */
static sg_status read_numbers(reader *r, double *out, int n, int more)
{
    double unused;
    for (int i = 0; i < n; i++)
        SG_TRY(sg_obj_number(&r->t, out + i));
    for (int i = 0;; i++) {
        const size_t before = r->t.at;
        const sg_obj_word w = sg_obj_next_word(&r->t);
        if (w.length == 0)
            return SG_OK;
        if (i >= more)
            return sg_obj_fail(&r->t, w.at, "too many numbers; expected the end of the line");
        r->t.at = before;
        SG_TRY(sg_obj_number(&r->t, &unused));
    }
}

static sg_status read_vertex(reader *r)
{
    double at[3];
    SG_TRY(read_numbers(r, at, 3, 4));
    if (!SG_GROW(r->obj->vertices, r->obj->vertices_capacity, r->obj->nvertices + 1))
        return SG_FAIL_NOMEM(r->t.err);
    memcpy(r->obj->vertices[r->obj->nvertices++], at, sizeof at);
    return SG_OK;
}

static sg_status read_normal(reader *r)
{
    double n[3];
    SG_TRY(read_numbers(r, n, 3, 0));
    if (!SG_GROW(r->obj->normals, r->obj->normals_capacity, r->obj->nnormals + 1))
        return SG_FAIL_NOMEM(r->t.err);
    if (!sg_vec_normalize(n))
        memset(n, 0, sizeof n);
    memcpy(r->obj->normals[r->obj->nnormals++], n, sizeof n);
    return SG_OK;
}

static sg_status read_uv(reader *r)
{
    double uv[2] = {0, 0};
    SG_TRY(sg_obj_number(&r->t, uv));
    const size_t before = r->t.at;
    const bool has_v = sg_obj_next_word(&r->t).length > 0;
    r->t.at = before;
    if (has_v)
        SG_TRY(read_numbers(r, uv + 1, 1, 1));
    if (!SG_GROW(r->obj->uvs, r->obj->uvs_capacity, r->obj->nuvs + 1))
        return SG_FAIL_NOMEM(r->t.err);
    memcpy(r->obj->uvs[r->obj->nuvs++], uv, sizeof uv);
    return SG_OK;
}

/* ---- faces ---- */

/* A number from 1, or from -1 backwards, of the n there are so far. */
static sg_status read_index(reader *r, size_t *at, size_t end, size_t n, const char *what, const char *plural,
                            uint32_t *out)
{
    const char *text = r->t.source.text;
    const size_t first = *at;
    const bool negative = text[*at] == '-';
    size_t digits = 0, value = 0;
    *at += negative || text[*at] == '+';
    for (; *at < end && text[*at] >= '0' && text[*at] <= '9'; ++*at, digits++)
        value = value > UINT32_MAX ? value : 10 * value + (size_t)(text[*at] - '0');
    if (digits == 0)
        return sg_obj_fail(&r->t, first, "expected the number of a %s", what);
    if (value == 0 || value > n)
        return sg_obj_fail(&r->t, first, "there %s %zu %s so far, and no number %.*s", n == 1 ? "is" : "are", n,
                           n == 1 ? what : plural, (int)(*at - first < 20 ? *at - first : 20), text + first);
    *out = (uint32_t)(negative ? n - value : value - 1);
    return SG_OK;
}

/* v, v/vt, v//vn or v/vt/vn */
static sg_status read_corner(reader *r, sg_obj_word w, sg_mesh_corner *c)
{
    const char *text = r->t.source.text;
    const size_t end = w.at + w.length;
    size_t at = w.at;
    c->normal = c->uv = SG_NONE;
    SG_TRY(read_index(r, &at, end, r->obj->nvertices, "vertex", "vertices", &c->vertex));
    if (at < end && text[at] == '/') {
        at++;
        if (at == end || text[at] != '/')
            SG_TRY(read_index(r, &at, end, r->obj->nuvs, "texture coordinate", "texture coordinates", &c->uv));
        if (at < end && text[at] == '/') {
            at++;
            SG_TRY(read_index(r, &at, end, r->obj->nnormals, "normal", "normals", &c->normal));
        }
    }
    return at == end ? SG_OK : sg_obj_fail(&r->t, at, "expected a blank behind the corner");
}

static sg_status read_face(reader *r)
{
    sg_mesh_corner corners[SG_OBJ_MAX_CORNERS];
    size_t n = 0;
    sg_obj_word w;
    while ((w = sg_obj_next_word(&r->t)).length > 0) {
        if (n == SG_OBJ_MAX_CORNERS)
            return sg_obj_fail(&r->t, w.at, "a face of more than %d corners", SG_OBJ_MAX_CORNERS);
        SG_TRY(read_corner(r, w, corners + n++));
    }
    if (n < 3)
        return sg_obj_fail(&r->t, w.at, "a face of %zu corner%s; expected three or more", n, n == 1 ? "" : "s");
    return sg_obj_add_polygon(r->obj, corners, n, r->material, r->t.err);
}

/* ---- names ---- */

static sg_status read_material(reader *r)
{
    const char *name;
    const sg_obj_word w = sg_obj_rest(&r->t);
    SG_TRY(sg_obj_name(&r->t, w, r->obj, &name));
    SG_TRY(sg_obj_material_find(r->obj, name, true, &r->material, r->t.err));
    if (r->obj->nmaterials > SG_OBJ_MAX_MATERIALS)
        return sg_obj_fail(&r->t, w.at, "more than %d materials", SG_OBJ_MAX_MATERIALS);
    return SG_OK;
}

static sg_status read_library(reader *r)
{
    const sg_obj_word w = sg_obj_rest(&r->t);
    const char *name;
    SG_TRY(sg_obj_name(&r->t, w, r->obj, &name));
    if (!SG_GROW(r->obj->libraries, r->obj->libraries_capacity, r->obj->nlibraries + 1))
        return SG_FAIL_NOMEM(r->t.err);
    r->obj->libraries[r->obj->nlibraries++] = (sg_obj_library){name, w.at, NULL};
    return SG_OK;
}

static sg_status pass_line(reader *r)
{
    sg_obj_rest(&r->t);
    return SG_OK;
}

static sg_status read_statement(reader *r)
{
    static const struct {
        const char *word;
        sg_status (*read)(reader *r);
    } known[] = {{"v", read_vertex},       {"vt", read_uv},           {"vn", read_normal},
                 {"f", read_face},         {"fo", read_face},         {"usemtl", read_material},
                 {"mtllib", read_library}, {"o", pass_line},          {"g", pass_line},
                 {"s", pass_line},         {"mg", pass_line},         {"l", pass_line},
                 {"p", pass_line},         {"lod", pass_line},        {"bevel", pass_line},
                 {"usemap", pass_line},    {"maplib", pass_line},     {"c_interp", pass_line},
                 {"d_interp", pass_line},  {"shadow_obj", pass_line}, {"trace_obj", pass_line}};
    const sg_obj_word w = sg_obj_next_word(&r->t);
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (sg_obj_is_word(&r->t, w, known[i].word))
            return known[i].read(r);
    return sg_obj_fail(&r->t, w.at, "found '%.*s'; expected a statement of a polygon mesh, as v or f",
                       (int)(w.length < 40 ? w.length : 40), r->t.source.text + w.at);
}

/* ---- files ---- */

static void measure(sg_obj *obj)
{
    for (int i = 0; i < 3 && obj->nfaces > 0; i++) {
        obj->low[i] = INFINITY;
        obj->high[i] = -INFINITY;
    }
    for (size_t k = 0; k < obj->nfaces; k++)
        for (uint32_t c = 0; c < obj->faces[k].ncorners; c++)
            for (int i = 0; i < 3; i++) {
                const double x = obj->vertices[obj->faces[k].corner[c].vertex][i];
                obj->low[i] = fmin(obj->low[i], x);
                obj->high[i] = fmax(obj->high[i], x);
            }
}

static sg_status read_all(reader *r)
{
    r->obj->arena = sg_arena_create();
    if (r->obj->arena == NULL)
        return SG_FAIL_NOMEM(r->t.err);
    r->obj->names.arena = r->obj->arena;
    while (sg_obj_next_line(&r->t))
        SG_TRY(read_statement(r));
    measure(r->obj);
    return SG_OK;
}

sg_status sg_obj_parse(const char *text, size_t length, const char *name, sg_obj *obj, sg_error *err)
{
    reader r = {.obj = obj, .material = SG_NONE};
    memset(obj, 0, sizeof *obj);
    SG_TRY(sg_obj_text_open(&r.t, text, length, name, err));
    const sg_status st = read_all(&r);
    sg_obj_text_close(&r.t);
    if (st != SG_OK)
        sg_obj_clear(obj);
    return st;
}

static sg_status load_library(const char *text, size_t length, const char *path, sg_obj *obj, sg_obj_library *l,
                              sg_arena *arena, sg_error *err)
{
    const sg_obj_text t = {.source = {.name = path, .text = text, .length = length}, .err = err};
    char *library, *file = sg_file_beside(path, l->name, obj->arena);
    size_t n;
    if (file == NULL)
        return SG_FAIL_NOMEM(err);
    if (!sg_file_exists(file))
        return sg_obj_fail(&t, l->at, "there is no material library %.200s", file);
    SG_TRY(sg_file_read(file, SG_OBJ_MAX_BYTES, arena, &library, &n, err));
    l->path = file;
    return sg_obj_parse_materials(library, n, file, obj, err);
}

static sg_status load_all(const char *path, sg_obj *obj, sg_arena *arena, sg_error *err)
{
    char *text;
    size_t length;
    SG_TRY(sg_file_read(path, SG_OBJ_MAX_BYTES, arena, &text, &length, err));
    SG_TRY(sg_obj_parse(text, length, path, obj, err));
    for (size_t i = 0; i < obj->nlibraries; i++)
        SG_TRY(load_library(text, length, path, obj, obj->libraries + i, arena, err));
    return SG_OK;
}

sg_status sg_obj_load(const char *path, sg_obj *obj, sg_error *err)
{
    sg_arena *arena = sg_arena_create();
    memset(obj, 0, sizeof *obj);
    if (arena == NULL)
        return SG_FAIL_NOMEM(err);
    const sg_status st = load_all(path, obj, arena, err);
    sg_arena_free(arena);
    if (st != SG_OK)
        sg_obj_clear(obj);
    return st;
}
