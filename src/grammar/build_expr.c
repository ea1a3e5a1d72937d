/* SPDX-License-Identifier: GPL-3.0-or-later */
/* build_expr.c - expressions to register code. Constants are folded on the way, user functions are inlined: their
 * arguments are computed once into registers, which the names of the parameters then stand for. */
#include "config.h"

#include "core/array.h"
#include "grammar/build_priv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Code of the expression that is being compiled. */
typedef struct {
    sg_builder *b;
    sg_instruction *code;
    size_t n, capacity;
    sg_pos at;
    bool tuned; /* a constant with a name was met */
    unsigned depth, steps; /* bounds of what nested and repeated calls of functions can ask for */
} assembler;

static const sg_pos nowhere = {0, 0}; /* of expressions that nobody wrote */

enum { MAX_DEPTH = 2 * SG_MAX_HEIGHT, MAX_STEPS = 10 * SG_MAX_CODE };

sg_status sg_build_fail_nomem(sg_builder *b)
{
    return SG_FAIL_NOMEM(b->err);
}

bool sg_build_is_reserved(const char *name)
{
    return strcmp(name, "pi") == 0 || strcmp(name, "depth") == 0 || strcmp(name, "true") == 0 ||
           strcmp(name, "false") == 0;
}

/* Equal constants share a place, so that equal code is equal byte for byte. */
static sg_status constant_operand(sg_builder *b, double value, sg_operand *out)
{
    char key[32];
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    snprintf(key, sizeof key, "%llx", (unsigned long long)bits);
    uint32_t index = sg_names_get(&b->number_names, key);
    if (index == UINT32_MAX) {
        char *kept = sg_arena_string(b->arena, key);
        index = (uint32_t)b->nconstants;
        if (kept == NULL || !SG_GROW(b->constants, b->constants_capacity, b->nconstants + 1) ||
            !sg_names_put(&b->number_names, kept, index))
            return sg_build_fail_nomem(b);
        b->constants[b->nconstants++] = value;
    }
    *out = SG_OPERAND(SG_IN_CONSTANTS, index);
    return SG_OK;
}

static sg_status too_large(const assembler *as)
{
    return sg_source_fail(as->b->source, as->at, as->b->err,
                          "this expression is too large once its functions are inlined");
}

static unsigned after(sg_operand o, unsigned reg)
{
    const unsigned next = SG_OPERAND_INDEX(o) + 1;
    return SG_OPERAND_SPACE(o) == SG_IN_REGISTERS && next > reg ? next : reg;
}

static sg_status emit(assembler *as, sg_operator op, const sg_operand *args, uint32_t nargs, unsigned reg,
                      sg_operand *out)
{
    sg_builder *b = as->b;
    sg_operand x[3] = {0, 0, 0};
    double v[3] = {0, 0, 0};
    bool constant = true;
    for (uint32_t i = 0; i < nargs; i++) {
        x[i] = args[i];
        if (SG_OPERAND_SPACE(x[i]) == SG_IN_CONSTANTS)
            v[i] = b->constants[SG_OPERAND_INDEX(x[i])];
        else
            constant = false;
    }
    if (constant)
        return constant_operand(b, sg_operator_apply(op, v[0], v[1], v[2]), out);
    if (reg >= SG_MAX_REGISTERS || as->n >= SG_MAX_CODE)
        return too_large(as);
    if (!SG_GROW(as->code, as->capacity, as->n + 1))
        return sg_build_fail_nomem(b);
    for (uint32_t i = nargs; i < 3; i++)
        x[i] = x[0];
    as->code[as->n++] = (sg_instruction){(uint16_t)op, (uint16_t)reg, x[0], x[1], x[2]};
    *out = SG_OPERAND(SG_IN_REGISTERS, reg);
    return SG_OK;
}

static sg_status compile(assembler *as, const sg_scope *scope, const sg_ast_expr *e, unsigned reg, sg_operand *out);

static bool find_bound(const sg_scope *scope, const char *name, sg_operand *out)
{
    uint32_t i = 0;
    for (const sg_ast_name *n = scope->bound->first; n != NULL; n = n->next, i++)
        if (strcmp(n->name, name) == 0) {
            *out = scope->operands[i];
            return true;
        }
    return false;
}

static bool find_local(const sg_scope *scope, const char *name, sg_operand *out)
{
    if (scope->bound != NULL)
        return find_bound(scope, name, out);
    if (scope->draws != NULL)
        for (size_t i = 0; i < scope->draws->n; i++) {
            const sg_draw *d = &scope->draws->draws[i];
            if (d->name != NULL && strcmp(d->name, name) == 0) {
                *out = SG_OPERAND(SG_IN_FRAME, scope->nparams + d->first_value);
                return true;
            }
        }
    uint32_t i = 0;
    if (scope->params != NULL)
        for (const sg_ast_name *n = scope->params->first; n != NULL; n = n->next, i++)
            if (strcmp(n->name, name) == 0) {
                *out = SG_OPERAND(SG_IN_FRAME, i);
                return true;
            }
    return false;
}

static sg_status compile_name(assembler *as, const sg_scope *scope, const sg_ast_expr *e, sg_operand *out)
{
    sg_builder *b = as->b;
    if (find_local(scope, e->name, out))
        return SG_OK;
    const uint32_t constant = sg_names_get(&b->constant_names, e->name);
    if (constant != UINT32_MAX) {
        *out = SG_OPERAND(SG_IN_CONSTANTS, constant);
        as->tuned = true;
        return SG_OK;
    }
    if (strcmp(e->name, "pi") == 0)
        return constant_operand(b, M_PI, out);
    if (strcmp(e->name, "true") == 0 || strcmp(e->name, "false") == 0)
        return constant_operand(b, e->name[0] == 't', out);
    if (strcmp(e->name, "depth") == 0 && !scope->no_depth) {
        *out = SG_OPERAND(SG_IN_DEPTH, 0);
        return SG_OK;
    }
    return sg_source_fail(b->source, e->at, b->err,
                          "unknown name '%.60s' in %s; expected a constant, a parameter%s or a function with arguments",
                          e->name, scope->what, scope->draws != NULL ? ", a draw that stands before" : "");
}

static sg_status compile_call(assembler *as, const sg_scope *scope, const sg_ast_expr *e, unsigned reg, sg_operand *out)
{
    sg_builder *b = as->b;
    const uint32_t number = sg_names_get(&b->function_names, e->name);
    if (number == UINT32_MAX) {
        uint32_t slot = 0;
        SG_TRY(sg_build_draw(b, scope, e, NULL, &slot));
        *out = SG_OPERAND(SG_IN_FRAME, slot);
        return SG_OK;
    }
    const sg_ast_definition *f = b->functions[number];
    if (e->nargs != f->params.n)
        return sg_source_fail(b->source, e->at, b->err, "function %.60s takes %u argument%s, not %u", e->name,
                              f->params.n, f->params.n == 1 ? "" : "s", e->nargs);
    sg_operand *operands = SG_NEW_ARRAY(b->arena, sg_operand, e->nargs);
    if (operands == NULL)
        return sg_build_fail_nomem(b);
    uint32_t i = 0;
    for (const sg_ast_expr *a = e->args; a != NULL; a = a->next, i++) {
        SG_TRY(compile(as, scope, a, reg, &operands[i]));
        reg = after(operands[i], reg);
    }
    sg_scope inner = *scope;
    inner.bound = &f->params;
    inner.operands = operands;
    inner.draws = NULL;
    inner.no_depth = true; /* a function depends on its parameters alone */
    return compile(as, &inner, f->value, reg, out);
}

static sg_status compile_operator(assembler *as, const sg_scope *scope, const sg_ast_expr *e, unsigned reg,
                                  sg_operand *out)
{
    sg_operand x[3] = {0, 0, 0};
    uint32_t i = 0;
    unsigned next = reg;
    for (const sg_ast_expr *a = e->args; a != NULL && i < 3; a = a->next, i++) {
        SG_TRY(compile(as, scope, a, next, &x[i]));
        next = after(x[i], next);
    }
    return emit(as, e->op, x, i, reg, out);
}

static sg_status compile_kind(assembler *as, const sg_scope *scope, const sg_ast_expr *e, unsigned reg,
                              sg_operand *out)
{
    switch (e->kind) {
    case SG_AST_NUMBER:
        return constant_operand(as->b, e->value, out);
    case SG_AST_NAME:
        return compile_name(as, scope, e, out);
    case SG_AST_OPERATOR:
        return compile_operator(as, scope, e, reg, out);
    case SG_AST_CALL:
        return compile_call(as, scope, e, reg, out);
    case SG_AST_COLOR:
        return sg_source_fail(as->b->source, e->at, as->b->err, "a colour in %s; expected a number", scope->what);
    case SG_AST_TUPLE:
        return sg_source_fail(as->b->source, e->at, as->b->err, "a tuple in %s; expected a number", scope->what);
    }
    return SG_EINVAL;
}

static sg_status compile(assembler *as, const sg_scope *scope, const sg_ast_expr *e, unsigned reg, sg_operand *out)
{
    if (++as->steps > MAX_STEPS || as->depth >= MAX_DEPTH)
        return too_large(as);
    as->depth++;
    const sg_status st = compile_kind(as, scope, e, reg, out);
    as->depth--;
    return st;
}

static sg_status add_code(sg_builder *b, const sg_instruction *code, size_t n, sg_operand result, sg_pos at, sg_expr *out)
{
    if (!SG_GROW(b->codes, b->codes_capacity, b->ncodes + 1) ||
        !SG_GROW(b->code_at, b->code_at_capacity, b->ncodes + 1) ||
        !SG_GROW(b->code_tuned, b->code_tuned_capacity, b->ncodes + 1) ||
        !SG_GROW(b->instructions, b->instructions_capacity, b->ninstructions + n))
        return sg_build_fail_nomem(b);
    if (n > 0)
        memcpy(b->instructions + b->ninstructions, code, n * sizeof *code);
    *out = (sg_expr)b->ncodes;
    b->code_at[b->ncodes] = at;
    b->code_tuned[b->ncodes] = false;
    b->codes[b->ncodes++] = (sg_code){(uint32_t)b->ninstructions, (uint32_t)n, result};
    b->ninstructions += n;
    return SG_OK;
}

sg_status sg_build_expr(sg_builder *b, const sg_scope *scope, const sg_ast_expr *e, sg_expr *out)
{
    assembler as = {b, NULL, 0, 0, e->at, false, 0, 0};
    sg_operand result = 0;
    sg_status st = compile(&as, scope, e, 0, &result);
    if (st == SG_OK && SG_OPERAND_SPACE(result) == SG_IN_CONSTANTS &&
        !isfinite(b->constants[SG_OPERAND_INDEX(result)]))
        st = sg_source_fail(b->source, e->at, b->err, "%s is not finite: its value is %g", scope->what,
                            b->constants[SG_OPERAND_INDEX(result)]);
    if (st == SG_OK)
        st = add_code(b, as.code, as.n, result, e->at, out);
    if (st == SG_OK)
        b->code_tuned[*out] = as.tuned;
    free(as.code);
    return st;
}

sg_status sg_build_constant(sg_builder *b, double value, sg_expr *out)
{
    sg_operand result;
    SG_TRY(constant_operand(b, value, &result));
    return add_code(b, NULL, 0, result, nowhere, out);
}

sg_status sg_build_slot(sg_builder *b, uint32_t slot, sg_expr *out)
{
    return add_code(b, NULL, 0, SG_OPERAND(SG_IN_FRAME, slot), nowhere, out);
}

sg_status sg_build_complement(sg_builder *b, uint32_t slot, sg_expr *out)
{
    sg_operand one;
    SG_TRY(constant_operand(b, 1, &one));
    const sg_instruction subtract = {SG_E_SUB, 0, one, SG_OPERAND(SG_IN_FRAME, slot), one};
    return add_code(b, &subtract, 1, SG_OPERAND(SG_IN_REGISTERS, 0), nowhere, out);
}

bool sg_build_is_constant(const sg_builder *b, sg_expr e, double *value)
{
    const sg_operand o = b->codes[e].result;
    if (SG_OPERAND_SPACE(o) != SG_IN_CONSTANTS)
        return false;
    *value = b->constants[SG_OPERAND_INDEX(o)];
    return true;
}

bool sg_build_equal(const sg_builder *b, sg_expr x, sg_expr y)
{
    const sg_code *p = &b->codes[x], *q = &b->codes[y];
    return p->n == q->n && p->result == q->result &&
           (p->n == 0 ||
            memcmp(b->instructions + p->first, b->instructions + q->first, p->n * sizeof *b->instructions) == 0);
}
