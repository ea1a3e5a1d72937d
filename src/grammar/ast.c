/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ast.c - constructors of the syntax tree. */
#include "config.h"

#include "grammar/ast.h"

#include <string.h>

sg_ast_expr *sg_ast_number(sg_arena *arena, double value, sg_pos at)
{
    sg_ast_expr *e = SG_NEW(arena, sg_ast_expr);
    if (e == NULL)
        return NULL;
    e->kind = SG_AST_NUMBER;
    e->height = 1;
    e->value = value;
    e->at = at;
    return e;
}

sg_ast_exprs sg_ast_exprs_add(sg_ast_exprs list, sg_ast_expr *e)
{
    SG_AST_APPEND(list.first, list.last, e);
    list.n++;
    return list;
}

sg_ast_expr *sg_ast_named(sg_arena *arena, sg_ast_kind kind, const char *name, sg_ast_exprs args, sg_pos at)
{
    sg_ast_expr *e = sg_ast_number(arena, 0, at);
    if (e == NULL)
        return NULL;
    e->kind = kind;
    e->name = name;
    e->args = args.first;
    e->nargs = args.n;
    for (const sg_ast_expr *a = args.first; a != NULL; a = a->next)
        if (a->height >= e->height)
            e->height = a->height + 1;
    return e;
}

sg_ast_expr *sg_ast_operate(sg_arena *arena, sg_operator op, sg_ast_expr *a, sg_ast_expr *b, sg_ast_expr *c, sg_pos at)
{
    sg_ast_exprs args = {NULL, NULL, 0};
    sg_ast_expr *const given[3] = {a, b, c};
    for (int i = 0; i < 3 && given[i] != NULL; i++) {
        given[i]->next = NULL;
        args = sg_ast_exprs_add(args, given[i]);
    }
    sg_ast_expr *e = sg_ast_named(arena, SG_AST_OPERATOR, NULL, args, at);
    if (e != NULL)
        e->op = op;
    return e;
}

sg_ast_item *sg_ast_item_new(sg_arena *arena, sg_item_kind kind, const char *name, sg_pos at)
{
    sg_ast_item *item = SG_NEW(arena, sg_ast_item);
    if (item == NULL)
        return NULL;
    item->kind = kind;
    item->name = name;
    item->at = at;
    return item;
}

sg_ast_matrix *sg_ast_matrix_new(sg_arena *arena, sg_pos at)
{
    sg_ast_matrix *m = SG_NEW(arena, sg_ast_matrix);
    if (m != NULL)
        m->at = at;
    return m;
}

bool sg_ast_matrix_add(sg_arena *arena, sg_ast_matrix *m, const double *values, size_t n)
{
    if (m->n + n > m->capacity) {
        size_t capacity = m->capacity < 8 ? 8 : 2 * m->capacity;
        if (capacity < m->n + n)
            capacity = m->n + n;
        double *larger = SG_NEW_ARRAY(arena, double, capacity);
        if (larger == NULL)
            return false;
        if (m->n > 0)
            memcpy(larger, m->values, m->n * sizeof *larger);
        m->values = larger;
        m->capacity = capacity;
    }
    if (n > 0)
        memcpy(m->values + m->n, values, n * sizeof *values);
    m->n += n;
    return true;
}

sg_ast_matrix *sg_ast_matrix_of(sg_arena *arena, const double *values, size_t rows, size_t columns)
{
    sg_ast_matrix *m = sg_ast_matrix_new(arena, (sg_pos){0, 0});
    if (m == NULL || !sg_ast_matrix_add(arena, m, values, rows * columns))
        return NULL;
    m->rows = rows;
    m->columns = columns;
    return m;
}
