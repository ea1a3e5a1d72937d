/* SPDX-License-Identifier: GPL-3.0-or-later */
/* assets.c - looks for mesh names in the bodies of a grammar, and reads the files. */
#include "scene/assets.h"

#include "core/array.h"
#include "core/file.h"
#include "grammar/shape_ops.h"
#include "scene/scene_priv.h"

#include <stdlib.h>
#include <string.h>

typedef struct {
    uint32_t name;
    const char *path;
    sg_obj obj;
} asset;

struct sg_assets {
    asset *items;
    size_t n, capacity;
    sg_arena *arena; /* of the paths */
};

void sg_assets_free(sg_assets *a)
{
    if (a == NULL)
        return;
    for (size_t i = 0; i < a->n; i++)
        sg_obj_clear(&a->items[i].obj);
    free(a->items);
    sg_arena_free(a->arena);
    free(a);
}

const sg_obj *sg_assets_find(const sg_assets *a, uint32_t name)
{
    for (size_t i = 0; i < a->n; i++) /* a grammar names few */
        if (a->items[i].name == name)
            return &a->items[i].obj;
    return NULL;
}

bool sg_assets_has_file(const sg_assets *a, const char *path)
{
    for (size_t i = 0; i < a->n; i++) {
        const sg_obj *obj = &a->items[i].obj;
        if (sg_file_same(path, a->items[i].path))
            return true;
        for (size_t k = 0; k < obj->nlibraries; k++)
            if (obj->libraries[k].path != NULL && sg_file_same(path, obj->libraries[k].path))
                return true;
    }
    return false;
}

static sg_status load(sg_assets *a, const sg_grammar *g, const sg_rule *r, uint32_t name, const char *grammar,
                      sg_error *err)
{
    const char *path = sg_file_beside(grammar, sg_grammar_string(g, name), a->arena);
    if (path == NULL || !SG_GROW(a->items, a->capacity, a->n + 1))
        return SG_FAIL_NOMEM(err);
    if (!sg_file_exists(path))
        return SG_FAIL(err, SG_EINPUT, "%.250s:%u: error: insert(%.200s): there is no mesh file %.250s",
                       r->file != NULL ? r->file : grammar, (unsigned)r->line, sg_grammar_string(g, name), path);
    asset *made = a->items + a->n;
    *made = (asset){.name = name, .path = path};
    SG_TRY(sg_obj_load(path, &made->obj, err));
    a->n++;
    return made->obj.nfaces > 0 ? SG_OK : SG_FAIL(err, SG_EINPUT, "%.500s: this mesh has no faces", path);
}

static sg_status load_of_rule(sg_assets *a, const sg_grammar *g, const sg_rule *r, const char *grammar, sg_error *err)
{
    for (uint32_t i = 0; i < r->nops; i++) {
        double name;
        if (r->ops[i].kind != SG_OP_SHAPE || r->ops[i].shape != SG_SHAPE_INSERT ||
            !sg_grammar_constant(g, r->ops[i].args[0], &name))
            continue;
        const uint32_t index = (uint32_t)name;
        if (sg_scene_solid_find(sg_grammar_string(g, index)) == NULL && sg_assets_find(a, index) == NULL)
            SG_TRY(load(a, g, r, index, grammar, err));
    }
    return SG_OK;
}

static sg_status load_all(sg_assets *a, const sg_grammar *g, const char *path, sg_error *err)
{
    a->arena = sg_arena_create();
    if (a->arena == NULL)
        return SG_FAIL_NOMEM(err);
    for (sg_rule_id i = 0; i < sg_grammar_rule_count(g); i++)
        SG_TRY(load_of_rule(a, g, sg_grammar_rule(g, i), path, err));
    return SG_OK;
}

sg_status sg_assets_load(const sg_grammar *g, const char *path, sg_assets **out, sg_error *err)
{
    sg_assets *a = calloc(1, sizeof *a);
    if (a == NULL)
        return SG_FAIL_NOMEM(err);
    const sg_status st = load_all(a, g, path, err);
    if (st == SG_OK)
        *out = a;
    else
        sg_assets_free(a);
    return st;
}
