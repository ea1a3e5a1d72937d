/* SPDX-License-Identifier: GPL-3.0-or-later */
/* build_body.c - bodies of rules to flat operations, and the draws that stand in them. */
#include "config.h"

#include "core/array.h"
#include "grammar/build_priv.h"
#include "grammar/distribution_priv.h"
#include "grammar/shape_ops.h"
#include "grammar/simplex_priv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    sg_builder *b;
    sg_scope scope;
    sg_draw_list draws;
    sg_op *ops;
    size_t nops, capacity;
    uint32_t nchildren;
    size_t *tied; /* operations that are the first to place their child, outside of repeats; with tied siblings only */
    size_t ntied, tied_capacity;
    unsigned repeats;  /* how many repeats we are in */
    unsigned blocks;   /* splits, repeats, components: labels in them stand for lexical symbols */
    const sg_ast_sizes *examples; /* the split whose training sizes the rule keeps */
} body;

#define FAIL(y, where, ...) sg_source_fail((y)->b->source, (where), (y)->b->err, __VA_ARGS__)

static sg_status build_items(body *y, sg_ast_item *items);

/* The scope of the moment: draws may have moved when their list grew. */
static const sg_scope *scope_for(body *y, const char *what)
{
    y->scope.what = what;
    y->scope.draws = &y->draws;
    return &y->scope;
}

static sg_status add_op(body *y, sg_op_kind kind, size_t *index)
{
    if (!SG_GROW(y->ops, y->capacity, y->nops + 1))
        return sg_build_fail_nomem(y->b);
    sg_op *op = &y->ops[y->nops];
    memset(op, 0, sizeof *op);
    op->kind = kind;
    op->length = 1;
    op->symbol = op->child = op->draw = SG_NONE;
    *index = y->nops++;
    return SG_OK;
}

/* Space for the arguments of an op. */
static sg_status new_args(body *y, uint32_t n, sg_expr **args)
{
    *args = SG_NEW_ARRAY(y->b->arena, sg_expr, n);
    return *args != NULL ? SG_OK : sg_build_fail_nomem(y->b);
}

static sg_status one_arg(body *y, const sg_ast_expr *e, const char *what, sg_expr **args)
{
    SG_TRY(new_args(y, 1, args));
    return sg_build_expr(y->b, scope_for(y, what), e, *args);
}

static void set_args(body *y, size_t op, const sg_expr *args, uint32_t n)
{
    y->ops[op].args = args;
    y->ops[op].nargs = n;
}

static bool is_equal_call(const body *y, const sg_op *a, const sg_op *b)
{
    if (a->symbol != b->symbol)
        return false;
    uint32_t equal = 0;
    while (equal < b->nargs && sg_build_equal(y->b, a->args[equal], b->args[equal]))
        equal++;
    return equal == b->nargs;
}

/* With tied siblings an earlier equal successor outside of repeats places the child, else a new one. */
static sg_status tie_child(body *y, size_t index)
{
    for (size_t i = 0; i < y->ntied; i++) {
        const sg_op *q = &y->ops[y->tied[i]];
        if (is_equal_call(y, q, &y->ops[index])) {
            y->ops[index].child = q->child;
            return SG_OK;
        }
    }
    if (!SG_GROW(y->tied, y->tied_capacity, y->ntied + 1))
        return sg_build_fail_nomem(y->b);
    y->tied[y->ntied++] = index;
    y->ops[index].child = y->nchildren++;
    return SG_OK;
}

static sg_status add_successor(body *y, sg_sym symbol, const sg_expr *args, uint32_t nargs, sg_pos at)
{
    size_t op = 0;
    SG_TRY(add_op(y, SG_OP_SUCCESSOR, &op));
    y->ops[op].symbol = symbol;
    set_args(y, op, args, nargs);
    if (y->b->symbols[symbol].kind != SG_SYMBOL_NONTERMINAL)
        return SG_OK;
    if (!y->b->ast->tied || y->repeats > 0) {
        y->ops[op].child = y->nchildren++;
        return SG_OK;
    }
    if (y->ntied > SG_MAX_TIED)
        return FAIL(y, at, "more than %d different successors in a rule of a grammar with tied siblings", SG_MAX_TIED);
    return tie_child(y, op);
}

static sg_status successor_args(body *y, const sg_ast_item *call, sg_sym symbol, uint32_t before, sg_expr **args)
{
    const sg_symbol *s = &y->b->symbols[symbol];
    if (call->nargs != s->nparams)
        return FAIL(y, call->at, "%.60s takes %u argument%s, not %u", call->name, s->nparams,
                    s->nparams == 1 ? "" : "s", call->nargs);
    SG_TRY(new_args(y, before + call->nargs, args));
    uint32_t i = before;
    for (const sg_ast_expr *a = call->args; a != NULL; a = a->next, i++)
        SG_TRY(sg_build_expr(y->b, scope_for(y, "an argument"), a, &(*args)[i]));
    return SG_OK;
}

static sg_status build_string_arg(body *y, const sg_ast_expr *a, double base, sg_expr *out)
{
    uint32_t index = 0;
    SG_TRY(sg_build_string(y->b, a->name, &index));
    return sg_build_constant(y->b, base + index, out);
}

static sg_status build_label_arg(body *y, const sg_ast_expr *a, sg_expr *out)
{
    const sg_sym s = a->kind == SG_AST_NAME ? sg_names_get(&y->b->symbol_names, a->name) : SG_NONE;
    if (s == SG_NONE || y->b->symbols[s].kind != SG_SYMBOL_LABEL)
        return FAIL(y, a->at, "expected a label");
    return sg_build_constant(y->b, s, out);
}

static sg_status build_op_arg(body *y, char kind, const sg_ast_expr *a, sg_expr *out)
{
    if (kind == 'n')
        return sg_build_expr(y->b, scope_for(y, "an argument"), a, out);
    if (kind == 'l')
        return build_label_arg(y, a, out);
    if (kind == 'c' && a->kind == SG_AST_COLOR)
        return sg_build_constant(y->b, a->value, out);
    if (a->kind != SG_AST_NAME)
        return FAIL(y, a->at, "expected a name%s", kind == 'c' ? " or a colour" : "");
    if (kind == 'c' && y->b->ast->materials != NULL && sg_names_get(&y->b->material_names, a->name) == UINT32_MAX)
        SG_TRY(sg_build_warn(y->b, a->at, "material '%.60s' is not declared, as others are", a->name));
    return build_string_arg(y, a, kind == 'c' ? SG_SHAPE_STRING_ARG : 0, out);
}

static sg_status add_shape(body *y, const sg_ast_item *call, sg_shape_op shape)
{
    const sg_shape_info *info = sg_shape_op_info(shape);
    const uint32_t most = (uint32_t)strlen(info->args);
    if (call->nargs < info->required || call->nargs > most)
        return info->required == most
                   ? FAIL(y, call->at, "%s takes %u argument%s, not %u", info->name, most, most == 1 ? "" : "s",
                          call->nargs)
                   : FAIL(y, call->at, "%s takes %u to %u arguments, not %u", info->name, info->required, most,
                          call->nargs);
    if (shape == SG_SHAPE_POLYGON && call->nargs % 2 != 0)
        return FAIL(y, call->at, "polygon takes two numbers for each corner, not %u in all", call->nargs);
    sg_expr *args = NULL;
    SG_TRY(new_args(y, call->nargs, &args));
    uint32_t i = 0;
    for (const sg_ast_expr *a = call->args; a != NULL; a = a->next, i++)
        SG_TRY(build_op_arg(y, info->args[i], a, &args[i]));
    double slope = 0;
    if ((shape == SG_SHAPE_GABLE_ROOF || shape == SG_SHAPE_HIP_ROOF) && sg_build_is_constant(y->b, args[0], &slope) &&
        slope >= 90)
        SG_TRY(sg_build_warn(y->b, call->args->at, "a roof with a slope of %g degrees; expected less than 90", slope));
    size_t op = 0;
    SG_TRY(add_op(y, SG_OP_SHAPE, &op));
    y->ops[op].shape = shape;
    set_args(y, op, args, call->nargs);
    return SG_OK;
}

static sg_status unknown_call(body *y, const sg_ast_item *call)
{
    if (call->parentheses)
        return FAIL(y, call->at, "unknown name '%.60s'; expected a symbol that has rules or a shape operation",
                    call->name);
    return FAIL(y, call->at, "unknown name '%.60s'; expected a symbol that has rules or a declared label%s",
                call->name, sg_shape_op_find(call->name) != SG_SHAPE_COUNT ? " (operations take parentheses)" : "");
}

static sg_status build_call(body *y, sg_ast_item *call)
{
    sg_sym s = sg_names_get(&y->b->symbol_names, call->name);
    const bool is_label = s != SG_NONE && y->b->symbols[s].kind == SG_SYMBOL_LABEL;
    const sg_shape_op shape = call->parentheses ? sg_shape_op_find(call->name) : SG_SHAPE_COUNT;
    if (shape != SG_SHAPE_COUNT && (s == SG_NONE || is_label || y->b->symbols[s].nparams == 0))
        return add_shape(y, call, shape);
    if (s == SG_NONE)
        return unknown_call(y, call);
    sg_expr *args = NULL;
    SG_TRY(successor_args(y, call, s, 0, &args));
    call->parentheses = call->nargs > 0; /* X() is X */
    if (is_label && y->blocks > 0)
        SG_TRY(sg_build_lexical(y->b, s, &s));
    return add_successor(y, s, args, call->nargs, call->at);
}

static sg_status build_maybe(body *y, sg_ast_item *item)
{
    sg_ast_item *call = item->items;
    const sg_sym target = sg_names_get(&y->b->symbol_names, call->name);
    if (target == SG_NONE)
        return FAIL(y, call->at, "unknown name '%.60s'; expected a symbol that has rules or a declared label",
                    call->name);
    sg_expr p = 0;
    double value = 0;
    SG_TRY(sg_build_expr(y->b, scope_for(y, "a probability"), item->args, &p));
    const bool constant = sg_build_is_constant(y->b, p, &value);
    if (constant && !(value >= 0 && value <= 1))
        return FAIL(y, item->args->at, "the probability is %g; expected a number from 0 to 1", value);
    sg_expr *args = NULL;
    SG_TRY(successor_args(y, call, target, !constant, &args));
    call->parentheses = call->nargs > 0;
    if (!constant)
        args[0] = p;
    sg_sym hidden = SG_NONE;
    SG_TRY(sg_build_optional(y->b, target, constant, value, item->at, &hidden));
    return add_successor(y, hidden, args, call->nargs + !constant, call->at);
}

static sg_status build_block(body *y, size_t op, sg_ast_item *items)
{
    SG_TRY(build_items(y, items));
    y->ops[op].length = (uint32_t)(y->nops - op);
    return SG_OK;
}

static sg_status axis_of(body *y, const sg_ast_item *item, sg_axis *axis)
{
    static const char *const names[] = {"x", "y", "z"};
    for (int i = 0; i < 3; i++)
        if (strcmp(item->name, names[i]) == 0) {
            *axis = (sg_axis)i;
            return SG_OK;
        }
    return FAIL(y, item->at, "found axis '%.60s'; expected x, y or z", item->name);
}

static sg_status build_repeat(body *y, sg_ast_item *item)
{
    sg_axis axis = SG_AXIS_X;
    sg_expr *args = NULL;
    double count = 0;
    SG_TRY(axis_of(y, item, &axis));
    SG_TRY(one_arg(y, item->args, "a repeat count", &args));
    if (sg_build_is_constant(y->b, *args, &count) && !(count >= 0 && count <= SG_MAX_REPEAT))
        return FAIL(y, item->args->at, "the repeat count is %g; expected a number from 0 to %d", count, SG_MAX_REPEAT);
    size_t op = 0;
    SG_TRY(add_op(y, SG_OP_REPEAT, &op));
    y->ops[op].axis = axis;
    set_args(y, op, args, 1);
    y->repeats++;
    y->blocks++;
    SG_TRY(build_block(y, op, item->items));
    y->blocks--;
    y->repeats--;
    return SG_OK;
}

static sg_status build_part(body *y, sg_ast_item *part, bool drawn)
{
    size_t op = 0;
    sg_expr *args = NULL;
    double size = 0;
    if (drawn && part->args != NULL)
        return FAIL(y, part->args->at, "a part with a size in a split whose sizes are drawn");
    if (part->args != NULL)
        SG_TRY(one_arg(y, part->args, "a size", &args));
    else if (!drawn)
        SG_TRY(new_args(y, 1, &args));
    if (part->args == NULL && !drawn)
        SG_TRY(sg_build_constant(y->b, 1, args));
    if (args != NULL && sg_build_is_constant(y->b, *args, &size) && !(size >= 0))
        return FAIL(y, part->args->at, "the size is %g; expected a number that is not negative", size);
    SG_TRY(add_op(y, SG_OP_PART, &op));
    y->ops[op].size = drawn ? SG_SIZE_DRAWN : part->size;
    set_args(y, op, args, args != NULL);
    return build_block(y, op, part->items);
}

static size_t count_parts(const sg_ast_item *split)
{
    size_t n = 0;
    for (const sg_ast_item *p = split->items; p != NULL; p = p->next)
        n++;
    return n;
}

static sg_status build_split(body *y, sg_ast_item *item)
{
    sg_axis axis = SG_AXIS_X;
    size_t op = 0;
    const size_t nparts = count_parts(item);
    SG_TRY(axis_of(y, item, &axis));
    uint32_t draw = SG_NONE;
    if (item->sizes != NULL) {
        SG_TRY(sg_build_simplex(y->b, scope_for(y, "a size"), item->sizes, nparts, &draw));
        if (item->sizes->examples != NULL)
            y->examples = item->sizes;
    }
    SG_TRY(add_op(y, SG_OP_SPLIT, &op));
    y->ops[op].axis = axis;
    y->ops[op].nparts = (uint32_t)nparts;
    y->ops[op].draw = draw;
    y->blocks++;
    for (sg_ast_item *p = item->items; p != NULL; p = p->next)
        SG_TRY(build_part(y, p, draw != SG_NONE));
    y->blocks--;
    y->ops[op].length = (uint32_t)(y->nops - op);
    return SG_OK;
}

static sg_status build_components(body *y, sg_ast_item *item)
{
    size_t op = 0;
    bool taken[SG_FACE_COUNT] = {false};
    SG_TRY(add_op(y, SG_OP_SHAPE, &op));
    y->ops[op].shape = SG_SHAPE_COMPONENTS;
    y->blocks++;
    for (sg_ast_item *p = item->items; p != NULL; p = p->next) {
        size_t part = 0;
        const sg_face face = sg_face_find(p->name);
        if (face == SG_FACE_COUNT)
            return FAIL(y, p->at,
                        "found face '%.60s'; expected front, back, left, right, top, bottom, side or all", p->name);
        if (taken[face])
            return FAIL(y, p->at, "face '%s' a second time", p->name);
        taken[face] = true;
        SG_TRY(add_op(y, SG_OP_PART, &part));
        y->ops[part].shape = face;
        SG_TRY(build_block(y, part, p->items));
    }
    y->blocks--;
    y->ops[op].nparts = (uint32_t)count_parts(item);
    y->ops[op].length = (uint32_t)(y->nops - op);
    return SG_OK;
}

static sg_status build_named_draw(body *y, const sg_ast_item *item)
{
    uint32_t slot = 0;
    if (sg_build_is_reserved(item->name))
        return FAIL(y, item->at, "'%s' has a meaning of its own and cannot be the name of a draw", item->name);
    for (const sg_ast_name *n = y->scope.params->first; n != NULL; n = n->next)
        if (strcmp(n->name, item->name) == 0)
            return FAIL(y, item->at, "draw '%.60s' has the name of a parameter", item->name);
    for (size_t i = 0; i < y->draws.n; i++)
        if (y->draws.draws[i].name != NULL && strcmp(y->draws.draws[i].name, item->name) == 0)
            return FAIL(y, item->at, "a second draw '%.60s' in this rule", item->name);
    if (item->args->kind != SG_AST_CALL || sg_distribution_find(item->args->name) == NULL)
        return FAIL(y, item->args->at,
                    "found '%.60s'; expected a distribution: uniform, normal, truncated_normal, mixture or discrete",
                    item->args->name != NULL ? item->args->name : "a number");
    return sg_build_draw(y->b, scope_for(y, "a parameter of a distribution"), item->args, item->name, &slot);
}

static sg_status build_item(body *y, sg_ast_item *item)
{
    size_t op = 0;
    switch (item->kind) {
    case SG_ITEM_CALL:
        return build_call(y, item);
    case SG_ITEM_DRAW:
        return build_named_draw(y, item);
    case SG_ITEM_PUSH:
        SG_TRY(add_op(y, SG_OP_PUSH, &op));
        return build_block(y, op, item->items);
    case SG_ITEM_SPLIT:
        return build_split(y, item);
    case SG_ITEM_REPEAT:
        return build_repeat(y, item);
    case SG_ITEM_MAYBE:
        return build_maybe(y, item);
    case SG_ITEM_COMPONENTS:
        return build_components(y, item);
    case SG_ITEM_PART:
        break;
    }
    return SG_EINVAL;
}

static sg_status build_items(body *y, sg_ast_item *items)
{
    for (sg_ast_item *i = items; i != NULL; i = i->next)
        SG_TRY(build_item(y, i));
    return SG_OK;
}

static sg_status keep(body *y, const sg_ast_item *items, sg_rule *rule)
{
    const bool one_split = items != NULL && items->kind == SG_ITEM_SPLIT && items->next == NULL;
    if (y->examples != NULL && !(one_split && items->sizes == y->examples))
        return FAIL(y, y->examples->at, "examples are kept for bodies of exactly one split");
    if (y->examples != NULL) {
        rule->nattributes = y->examples->examples->rows;
        rule->attributes = y->examples->examples->values;
    }
    rule->ops = sg_arena_copy(y->b->arena, y->ops, y->nops * sizeof *y->ops);
    rule->draws = sg_arena_copy(y->b->arena, y->draws.draws, y->draws.n * sizeof *y->draws.draws);
    if (rule->ops == NULL || rule->draws == NULL)
        return sg_build_fail_nomem(y->b);
    rule->nops = (uint32_t)y->nops;
    rule->ndraws = (uint32_t)y->draws.n;
    rule->nuniforms = y->draws.nuniforms;
    rule->nvalues = y->draws.nvalues;
    rule->nchildren = y->nchildren;
    for (size_t i = 0; i < y->nops; i++)
        rule->has_repeat |= y->ops[i].kind == SG_OP_REPEAT;
    return SG_OK;
}

sg_status sg_build_body(sg_builder *b, const sg_ast_names *params, sg_ast_item *items, sg_rule *rule)
{
    body y;
    memset(&y, 0, sizeof y);
    y.b = b;
    y.scope = (sg_scope){params, params->n, NULL, false, "", NULL, NULL};
    sg_status st = build_items(&y, items);
    if (st == SG_OK)
        st = keep(&y, items, rule);
    free(y.ops);
    free(y.draws.draws);
    free(y.tied);
    return st;
}
