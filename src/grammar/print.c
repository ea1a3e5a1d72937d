/* SPDX-License-Identifier: GPL-3.0-or-later */
/* print.c - canonical text of a grammar, from its syntax tree. */
#include "config.h"

#include "grammar/distribution_priv.h"
#include "grammar/grammar_priv.h"
#include "grammar/number.h"
#include "grammar/parse_priv.h"

#include <errno.h>
#include <string.h>

static void print_name(FILE *out, const char *name)
{
    if (!sg_name_needs_quotes(name)) {
        fputs(name, out);
        return;
    }
    fputc('"', out);
    for (const char *c = name; *c != '\0'; c++) {
        if (*c == '"' || *c == '\\')
            fputc('\\', out);
        fputc(*c, out);
    }
    fputc('"', out);
}

static void print_number(FILE *out, double v)
{
    char text[SG_NUMBER_SIZE];
    fputs(sg_number_format(v, text), out);
}

/* ---- expressions ---- */

static void print_expr(FILE *out, const sg_ast_expr *e, int precedence);

static void print_args(FILE *out, const sg_ast_expr *args)
{
    fputc('(', out);
    for (const sg_ast_expr *a = args; a != NULL; a = a->next) {
        print_expr(out, a, 0);
        if (a->next != NULL)
            fputs(", ", out);
    }
    fputc(')', out);
}

static void print_binary(FILE *out, const sg_ast_expr *e, const sg_operator_info *op)
{
    /* Left-associative ones need parentheses on the right at the same level, powers on the left; comparisons on both. */
    const bool compares = e->op >= SG_E_LT && e->op <= SG_E_NE;
    print_expr(out, e->args, op->precedence + (compares || e->op == SG_E_POW));
    fprintf(out, e->op == SG_E_POW ? "%s" : " %s ", op->name);
    print_expr(out, e->args->next, op->precedence + (e->op != SG_E_POW));
}

static void print_operator(FILE *out, const sg_ast_expr *e, int precedence)
{
    const sg_operator_info *op = sg_operator_get(e->op);
    if (e->op >= SG_E_IF) {
        fputs(op->name, out);
        print_args(out, e->args);
        return;
    }
    const bool parentheses = op->precedence < precedence;
    if (parentheses)
        fputc('(', out);
    if (e->op == SG_E_NOT || e->op == SG_E_NEG) {
        fputs(e->op == SG_E_NOT ? "not " : "-", out);
        print_expr(out, e->args, op->precedence);
    } else {
        print_binary(out, e, op);
    }
    if (parentheses)
        fputc(')', out);
}

static void print_expr(FILE *out, const sg_ast_expr *e, int precedence)
{
    switch (e->kind) {
    case SG_AST_NUMBER:
        print_number(out, e->value);
        break;
    case SG_AST_COLOR:
        fprintf(out, "#%06x", (unsigned)e->value);
        break;
    case SG_AST_NAME:
        print_name(out, e->name);
        break;
    case SG_AST_OPERATOR:
        print_operator(out, e, precedence);
        break;
    case SG_AST_CALL:
        print_name(out, e->name);
        print_args(out, e->args);
        break;
    case SG_AST_TUPLE:
        print_args(out, e->args);
        break;
    }
}

/* ---- bodies ---- */

static void print_items(FILE *out, const sg_ast_item *items);

static void print_row(FILE *out, const double *values, size_t n)
{
    fputc('(', out);
    for (size_t i = 0; i < n; i++) {
        if (i > 0)
            fputs(", ", out);
        print_number(out, values[i]);
    }
    fputc(')', out);
}

static void print_matrix(FILE *out, const char *word, const sg_ast_matrix *m, bool vector)
{
    if (m == NULL)
        return;
    fprintf(out, " %s ", word);
    if (vector) {
        print_row(out, m->values, m->n);
        return;
    }
    fputc('(', out);
    for (size_t r = 0; r < m->rows; r++) {
        if (r > 0)
            fputs(", ", out);
        print_row(out, m->values + r * m->columns, m->columns);
    }
    fputc(')', out);
}

static void print_part(FILE *out, const sg_ast_item *p)
{
    if (p->name != NULL) {
        print_name(out, p->name);
        fputs(" : ", out);
    } else if (p->args != NULL) {
        fputs(p->size == SG_SIZE_FLOATING ? "~" : p->size == SG_SIZE_RELATIVE ? "'" : "", out);
        print_expr(out, p->args, 0);
        fputs(" : ", out);
    }
    print_items(out, p->items);
}

static void print_parts(FILE *out, const sg_ast_item *block)
{
    fputs("{ ", out);
    for (const sg_ast_item *p = block->items; p != NULL; p = p->next) {
        print_part(out, p);
        fputs(p->next != NULL ? " | " : " }", out);
    }
    if (block->sizes == NULL)
        return;
    fputs(" sizes", out);
    print_matrix(out, "mean", block->sizes->mean, true);
    print_matrix(out, "covariance", block->sizes->covariance, false);
    print_matrix(out, "sd", block->sizes->sd, true);
    print_matrix(out, "examples", block->sizes->examples, false);
}

static void print_item(FILE *out, const sg_ast_item *i)
{
    switch (i->kind) {
    case SG_ITEM_CALL:
        print_name(out, i->name);
        if (i->parentheses)
            print_args(out, i->args);
        break;
    case SG_ITEM_DRAW:
        print_name(out, i->name);
        fputs(" ~ ", out);
        print_expr(out, i->args, 0);
        break;
    case SG_ITEM_PUSH:
        fputs("[ ", out);
        print_items(out, i->items);
        fputs(" ]", out);
        break;
    case SG_ITEM_SPLIT:
        fprintf(out, "split %s ", i->name);
        print_parts(out, i);
        break;
    case SG_ITEM_REPEAT:
        fprintf(out, "repeat %s ", i->name);
        print_expr(out, i->args, 0);
        fputs(" { ", out);
        print_items(out, i->items);
        fputs(" }", out);
        break;
    case SG_ITEM_MAYBE:
        fputs("maybe(", out);
        print_expr(out, i->args, 0);
        fputs(") ", out);
        print_items(out, i->items);
        break;
    case SG_ITEM_COMPONENTS:
        fputs("components ", out);
        print_parts(out, i);
        break;
    case SG_ITEM_PART:
        break;
    }
}

static void print_items(FILE *out, const sg_ast_item *items)
{
    if (items == NULL)
        fputs("nothing", out);
    for (const sg_ast_item *i = items; i != NULL; i = i->next) {
        print_item(out, i);
        if (i->next != NULL)
            fputc(' ', out);
    }
}

/* ---- statements ---- */

static void print_params(FILE *out, const sg_ast_names *params)
{
    if (params->n == 0)
        return;
    fputc('(', out);
    for (const sg_ast_name *n = params->first; n != NULL; n = n->next) {
        print_name(out, n->name);
        fputs(n->next != NULL ? ", " : ")", out);
    }
}

static void print_rule(FILE *out, const sg_ast_rule *r)
{
    fputs("rule ", out);
    print_name(out, r->name);
    print_params(out, &r->params);
    if (r->guard != NULL) {
        fputs(" if ", out);
        print_expr(out, r->guard, 0);
    }
    if (r->at_limit)
        fputs(" at limit", out);
    fputc('\n', out);
    for (const sg_ast_alternative *a = r->alternatives; a != NULL; a = a->next) {
        fputs("  -> ", out);
        if (a->weight != NULL) {
            print_expr(out, a->weight, 0);
            fputs(" : ", out);
        }
        print_items(out, a->items);
        fputc('\n', out);
    }
}

static void print_colored(FILE *out, const char *word, const sg_ast_label *list)
{
    for (const sg_ast_label *l = list; l != NULL; l = l->next) {
        fprintf(out, "%s ", word);
        print_name(out, l->name);
        if (l->has_color)
            fprintf(out, " #%06x", (unsigned)l->color);
        fputc('\n', out);
    }
}

static void print_definitions(FILE *out, const sg_ast *ast)
{
    for (const sg_ast_definition *d = ast->definitions; d != NULL; d = d->next) {
        fputs(d->is_function ? "function " : "const ", out);
        print_name(out, d->name);
        print_params(out, &d->params);
        fputs(" = ", out);
        print_expr(out, d->value, 0);
        fputc('\n', out);
    }
    print_colored(out, "label", ast->labels);
    print_colored(out, "material", ast->materials);
}

sg_status sg_grammar_print(const sg_grammar *g, FILE *out, sg_error *err)
{
    const sg_ast *ast = g->ast;
    errno = 0;
    if (ast->name != NULL) {
        fputs("grammar ", out);
        print_name(out, ast->name);
        fputc('\n', out);
    }
    if (ast->has_limit)
        fprintf(out, "limit depth %zu\n", ast->limit);
    if (ast->tied)
        fputs("tied\n", out);
    if (ast->relative_weights)
        fputs("weights\n", out);
    print_definitions(out, ast);
    fputs("start ", out);
    print_item(out, ast->start);
    fputc('\n', out);
    for (const sg_ast_rule *r = ast->rules; r != NULL; r = r->next)
        print_rule(out, r);
    return ferror(out) ? SG_FAIL(err, SG_EIO, "%s", errno != 0 ? strerror(errno) : "writing failed") : SG_OK;
}
