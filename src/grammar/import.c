/* SPDX-License-Identifier: GPL-3.0-or-later */
/* import.c - imported grammars: their texts, their trees. */
#include "config.h"

#include "grammar/import_priv.h"

#include "core/file.h"
#include "grammar/import_rename_priv.h"
#include "grammar/names.h"

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

/* What a tree has, by name; the numbers mean nothing. */
typedef struct {
    sg_names rules, labels, materials;
} known_names;

static bool has(const sg_names *names, const char *name)
{
    return sg_names_get(names, name) != UINT32_MAX;
}

static bool note(sg_names *names, const char *name)
{
    return has(names, name) || sg_names_put(names, name, 0);
}

static bool note_rules(known_names *known, const sg_ast_rule *rules)
{
    bool good = true;
    for (const sg_ast_rule *r = rules; good && r != NULL; r = r->next)
        good = note(&known->rules, r->name);
    return good;
}

static bool note_all(known_names *known, const sg_ast *ast)
{
    bool good = note_rules(known, ast->rules);
    for (const sg_ast_label *l = ast->labels; good && l != NULL; l = l->next)
        good = note(&known->labels, l->name);
    for (const sg_ast_label *m = ast->materials; good && m != NULL; m = m->next)
        good = note(&known->materials, m->name);
    return good;
}

static bool has_rule(const sg_ast *ast, const char *name)
{
    for (const sg_ast_rule *r = ast->rules; r != NULL; r = r->next)
        if (strcmp(r->name, name) == 0)
            return true;
    return false;
}

static sg_status check_fit(importer *im, const sg_ast *into, const known_names *known, const sg_ast_import *i,
                           const sg_ast *from)
{
    if (from->start == NULL || !has_rule(from, from->start->name))
        return FAIL(im, i->file_at, "a grammar without a start symbol that has rules");
    if (has(&known->rules, i->name) || has(&known->labels, i->name))
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

/* Materials that are declared here look as they do here. */
static bool move_materials(sg_ast *into, known_names *known, const sg_ast *from)
{
    bool good = true;
    for (sg_ast_label *m = from->materials, *next; good && m != NULL; m = next) {
        next = m->next;
        m->next = NULL;
        if (has(&known->materials, m->name))
            continue;
        SG_AST_APPEND(into->materials, into->last_material, m);
        good = note(&known->materials, m->name);
    }
    return good;
}

/* Labels that are symbols here, or labels already, are not declared again. */
static bool move_labels(sg_ast *into, known_names *known, const sg_ast *from)
{
    bool good = true;
    for (sg_ast_label *l = from->labels, *next; good && l != NULL; l = next) {
        next = l->next;
        l->next = NULL;
        if (has(&known->rules, l->name) || has(&known->labels, l->name))
            continue;
        SG_AST_APPEND(into->labels, into->last_label, l);
        good = note(&known->labels, l->name);
    }
    return good;
}

static bool join(sg_ast *into, known_names *known, const sg_ast *from)
{
    if (!move_labels(into, known, from) || !move_materials(into, known, from) || !note_rules(known, from->rules))
        return false;
    if (from->definitions != NULL) {
        SG_AST_APPEND(into->definitions, into->last_definition, from->definitions);
        into->last_definition = from->last_definition;
    }
    if (from->rules != NULL) {
        SG_AST_APPEND(into->rules, into->last_rule, from->rules);
        into->last_rule = from->last_rule;
    }
    return true;
}

static sg_status import_into(importer *im, sg_ast *into, const char *path, size_t depth);

/* @param by  path of the file that imports */
static sg_status import_one(importer *im, sg_ast *into, known_names *known, const sg_ast_import *i, const char *by,
                            size_t depth)
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
    SG_TRY(check_fit(im, into, known, i, from));
    if (sg_import_rename(from, i->name, i->file, im->arena) != SG_OK)
        return SG_FAIL_NOMEM(im->err);
    return join(into, known, from) ? SG_OK : SG_FAIL_NOMEM(im->err);
}

static sg_status import_into(importer *im, sg_ast *into, const char *path, size_t depth)
{
    known_names known = {{.arena = im->arena}, {.arena = im->arena}, {.arena = im->arena}};
    sg_status st = into->imports == NULL || note_all(&known, into) ? SG_OK : SG_FAIL_NOMEM(im->err);
    for (const sg_ast_import *i = into->imports; st == SG_OK && i != NULL; i = i->next)
        st = import_one(im, into, &known, i, path, depth);
    sg_names_clear(&known.rules);
    sg_names_clear(&known.labels);
    sg_names_clear(&known.materials);
    return st;
}

sg_status sg_import_all(sg_parse *p, size_t limit)
{
    importer im = {p->arena, &p->source, p->err, limit, 0};
    return import_into(&im, p->ast, p->source.name, 0);
}
