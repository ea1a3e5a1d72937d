/* SPDX-License-Identifier: GPL-3.0-or-later */
/* import_rename.c - names of an imported grammar. */
#include "config.h"

#include "grammar/import_rename_priv.h"

#include "core/array.h"
#include "core/file.h"
#include "grammar/names.h"
#include "grammar/shape_ops.h"

#include <stdlib.h>
#include <string.h>

typedef struct {
    const char *name, *file;
    sg_arena *arena;
    sg_names symbols, constants, functions; /* that the tree defines; the numbers mean nothing */
    const char *start;
    const sg_ast_names *params; /* of the rule or function at hand: they hide constants */
    const char **draws;         /* of the alternative at hand, likewise; malloc'd */
    size_t ndraws, draws_capacity;
    bool failed; /* memory is out */
} renamer;

static void know(renamer *r, sg_names *names, const char *name)
{
    r->failed = r->failed || !sg_names_put(names, name, 0);
}

static bool is_known(const sg_names *names, const char *name)
{
    return sg_names_get(names, name) != UINT32_MAX;
}

/* What is known is renamed. */
static void rename_known(renamer *r, const sg_names *names, const char **name)
{
    if (*name == NULL || !is_known(names, *name))
        return;
    const bool start = names == &r->symbols && strcmp(*name, r->start) == 0;
    const char *longer = start ? r->name : sg_arena_printf(r->arena, "%s.%s", r->name, *name);
    r->failed = r->failed || longer == NULL;
    if (longer != NULL)
        *name = longer;
}

/* ---- expressions ---- */

static bool is_hidden(const renamer *r, const char *name)
{
    for (const sg_ast_name *p = r->params != NULL ? r->params->first : NULL; p != NULL; p = p->next)
        if (strcmp(p->name, name) == 0)
            return true;
    for (size_t i = 0; i < r->ndraws; i++)
        if (strcmp(r->draws[i], name) == 0)
            return true;
    return false;
}

static void rename_exprs(renamer *r, sg_ast_expr *e)
{
    for (; e != NULL; e = e->next) {
        if (e->kind == SG_AST_NAME && !is_hidden(r, e->name))
            rename_known(r, &r->constants, &e->name);
        if (e->kind == SG_AST_CALL)
            rename_known(r, &r->functions, &e->name);
        rename_exprs(r, e->args);
    }
}

/* ---- bodies ---- */

static void add_draw(renamer *r, const char *name)
{
    if (SG_GROW(r->draws, r->draws_capacity, r->ndraws + 1))
        r->draws[r->ndraws++] = name;
    else
        r->failed = true;
}

static bool is_file(const char *name)
{
    return strchr(name, '.') != NULL && name[0] != '/';
}

/* Names of materials, labels and primitives stay; those of files are seen from the importer. */
static void rename_shape(renamer *r, sg_ast_item *call, sg_shape_op shape)
{
    const char *kinds = sg_shape_op_info(shape)->args;
    size_t i = 0;
    for (sg_ast_expr *a = call->args; a != NULL && kinds[i] != '\0'; a = a->next, i++) {
        if (kinds[i] == 'n') {
            sg_ast_expr *const next = a->next;
            a->next = NULL;
            rename_exprs(r, a);
            a->next = next;
        } else if (shape == SG_SHAPE_INSERT && a->kind == SG_AST_NAME && is_file(a->name)) {
            const char *longer = sg_file_beside(r->file, a->name, r->arena);
            r->failed = r->failed || longer == NULL;
            a->name = longer != NULL ? longer : a->name;
        }
    }
}

static void rename_items(renamer *r, sg_ast_item *item)
{
    for (; item != NULL; item = item->next) {
        const sg_shape_op shape =
            item->kind == SG_ITEM_CALL && item->parentheses ? sg_shape_op_find(item->name) : SG_SHAPE_COUNT;
        if (shape != SG_SHAPE_COUNT) {
            rename_shape(r, item, shape);
            continue;
        }
        rename_exprs(r, item->args);
        if (item->kind == SG_ITEM_CALL)
            rename_known(r, &r->symbols, &item->name);
        if (item->kind == SG_ITEM_DRAW)
            add_draw(r, item->name);
        rename_items(r, item->items);
    }
}

static void rename_rule(renamer *r, sg_ast_rule *rule)
{
    rename_known(r, &r->symbols, &rule->name);
    r->params = &rule->params;
    r->ndraws = 0;
    rename_exprs(r, rule->guard);
    for (sg_ast_alternative *a = rule->alternatives; a != NULL; a = a->next) {
        r->ndraws = 0;
        rename_exprs(r, a->weight);
        rename_items(r, a->items);
    }
}

/* ---- all ---- */

static void know_all(renamer *r, const sg_ast *ast)
{
    for (const sg_ast_rule *rule = ast->rules; rule != NULL; rule = rule->next)
        if (!is_known(&r->symbols, rule->name))
            know(r, &r->symbols, rule->name);
    for (const sg_ast_definition *d = ast->definitions; d != NULL; d = d->next)
        know(r, d->is_function ? &r->functions : &r->constants, d->name);
}

static void rename_all(renamer *r, sg_ast *ast)
{
    for (sg_ast_definition *d = ast->definitions; d != NULL; d = d->next) {
        r->params = &d->params;
        rename_exprs(r, d->value);
        rename_known(r, d->is_function ? &r->functions : &r->constants, &d->name);
    }
    for (sg_ast_rule *rule = ast->rules; rule != NULL; rule = rule->next)
        rename_rule(r, rule);
    rename_known(r, &r->symbols, &ast->start->name);
}

sg_status sg_import_rename(sg_ast *ast, const char *name, const char *file, sg_arena *arena)
{
    renamer r = {.name = name, .file = file, .arena = arena, .start = ast->start->name};
    r.symbols.arena = r.constants.arena = r.functions.arena = arena;
    know_all(&r, ast);
    if (!r.failed)
        rename_all(&r, ast);
    sg_names_clear(&r.symbols);
    sg_names_clear(&r.constants);
    sg_names_clear(&r.functions);
    free(r.draws);
    return r.failed ? SG_ENOMEM : SG_OK;
}
