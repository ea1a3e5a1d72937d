/* SPDX-License-Identifier: GPL-3.0-or-later */
/* import.c - imported grammars: their texts, their trees. */
#include "config.h"

#include "grammar/import_priv.h"

#include "core/file.h"
#include "grammar/import_rename_priv.h"

#include <string.h>

enum { MAX_DEPTH = 16, MAX_IMPORTS = 1000 };

/* What all imports of one grammar share. */
typedef struct {
    sg_arena *arena;
    sg_source *source; /* grows by every text */
    sg_error *err;
    size_t limit, nimports;
} importer;

#define FAIL(im, at, ...) sg_source_fail((im)->source, (at), (im)->err, __VA_ARGS__)

/* ---- texts ---- */

static sg_status read_text(importer *im, const sg_ast_import *i, const char *path, char **text, size_t *length)
{
    sg_error inner = SG_ERROR_INIT;
    const size_t left = im->limit > im->source->length ? im->limit - im->source->length : 0;
    if (strcmp(path, "-") == 0)
        return FAIL(im, i->file_at, "standard input cannot be imported");
    const sg_status st = sg_file_read(path, left, im->arena, text, length, &inner);
    if (st == SG_ENOMEM)
        return SG_FAIL_NOMEM(im->err);
    return st == SG_OK ? SG_OK : FAIL(im, i->file_at, "%.400s", inner.msg);
}

/* ---- trees ---- */

/* The other file's own text is checked before it is a part of all. */
static sg_status parse_imported(importer *im, const char *path, const char *text, size_t length, sg_ast *ast)
{
    const sg_source alone = {.name = path, .text = text, .length = length};
    sg_parse *p = SG_NEW(im->arena, sg_parse);
    char *copy = SG_NEW_ARRAY(im->arena, char, length + 2);
    if (p == NULL || copy == NULL)
        return SG_FAIL_NOMEM(im->err);
    SG_TRY(sg_source_check(&alone, im->err));
    memcpy(copy, text, length);
    SG_TRY(sg_source_add(im->source, &alone, im->arena, &p->base, im->err));
    p->source = *im->source;
    p->arena = im->arena;
    p->ast = ast;
    p->err = im->err;
    return sg_parse_text(p, copy, length);
}

static bool has_rule(const sg_ast *ast, const char *name)
{
    for (const sg_ast_rule *r = ast->rules; r != NULL; r = r->next)
        if (strcmp(r->name, name) == 0)
            return true;
    return false;
}

static bool has_label(const sg_ast *ast, const char *name)
{
    for (const sg_ast_label *l = ast->labels; l != NULL; l = l->next)
        if (strcmp(l->name, name) == 0)
            return true;
    return false;
}

static sg_status check_fit(importer *im, const sg_ast *into, const sg_ast_import *i, const sg_ast *from)
{
    if (from->start == NULL || !has_rule(from, from->start->name))
        return FAIL(im, i->file_at, "a grammar without a start symbol that has rules");
    if (has_rule(into, i->name) || has_label(into, i->name))
        return FAIL(im, i->at, "'%.60s' is defined here as well", i->name);
    if (from->tied != into->tied)
        return FAIL(im, i->file_at, "this grammar is%s tied and the one that imports it is%s", from->tied ? "" : " not",
                    into->tied ? "" : " not");
    if (from->relative_weights && !into->relative_weights)
        return FAIL(im, i->file_at, "the weights of this grammar are relative: the one that imports it must say 'weights'");
    if (from->has_limit && !into->has_limit)
        return FAIL(im, i->file_at, "this grammar has a depth limit: the one that imports it must have one");
    return SG_OK;
}

static bool has_material(const sg_ast *ast, const char *name)
{
    for (const sg_ast_label *m = ast->materials; m != NULL; m = m->next)
        if (strcmp(m->name, name) == 0)
            return true;
    return false;
}

/* Materials that are declared here look as they do here. */
static void move_materials(sg_ast *into, const sg_ast *from)
{
    for (sg_ast_label *m = from->materials, *next; m != NULL; m = next) {
        next = m->next;
        m->next = NULL;
        if (!has_material(into, m->name))
            SG_AST_APPEND(into->materials, into->last_material, m);
    }
}

/* Labels that are symbols here, or labels already, are not declared again. */
static void move_labels(sg_ast *into, const sg_ast *from)
{
    for (sg_ast_label *l = from->labels, *next; l != NULL; l = next) {
        next = l->next;
        l->next = NULL;
        if (!has_rule(into, l->name) && !has_label(into, l->name))
            SG_AST_APPEND(into->labels, into->last_label, l);
    }
}

static void join(sg_ast *into, const sg_ast *from)
{
    move_labels(into, from);
    move_materials(into, from);
    if (from->definitions != NULL) {
        SG_AST_APPEND(into->definitions, into->last_definition, from->definitions);
        into->last_definition = from->last_definition;
    }
    if (from->rules != NULL) {
        SG_AST_APPEND(into->rules, into->last_rule, from->rules);
        into->last_rule = from->last_rule;
    }
}

static sg_status import_into(importer *im, sg_ast *into, const char *path, size_t depth);

/* @param by  path of the file that imports */
static sg_status import_one(importer *im, sg_ast *into, const sg_ast_import *i, const char *by, size_t depth)
{
    char *text = NULL;
    size_t length = 0;
    const char *path = sg_file_beside(by, i->file, im->arena);
    sg_ast *from = SG_NEW(im->arena, sg_ast);
    if (path == NULL || from == NULL)
        return SG_FAIL_NOMEM(im->err);
    if (depth >= MAX_DEPTH)
        return FAIL(im, i->at, "imports more than %d deep: do they go in a circle?", MAX_DEPTH);
    if (im->nimports++ >= MAX_IMPORTS)
        return FAIL(im, i->at, "more than %d imports", MAX_IMPORTS);
    SG_TRY(read_text(im, i, path, &text, &length));
    SG_TRY(parse_imported(im, path, text, length, from));
    SG_TRY(import_into(im, from, path, depth + 1));
    SG_TRY(check_fit(im, into, i, from));
    if (sg_import_rename(from, i->name, i->file, im->arena) != SG_OK)
        return SG_FAIL_NOMEM(im->err);
    join(into, from);
    return SG_OK;
}

static sg_status import_into(importer *im, sg_ast *into, const char *path, size_t depth)
{
    for (const sg_ast_import *i = into->imports; i != NULL; i = i->next)
        SG_TRY(import_one(im, into, i, path, depth));
    return SG_OK;
}

sg_status sg_import_all(sg_parse *p, size_t limit)
{
    importer im = {p->arena, &p->source, p->err, limit, 0};
    return import_into(&im, p->ast, p->source.name, 0);
}
