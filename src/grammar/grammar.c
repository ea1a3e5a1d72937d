/* SPDX-License-Identifier: GPL-3.0-or-later */
/* grammar.c - reading grammars, looking into them, evaluating their expressions. */
#include "config.h"

#include "core/file.h"
#include "grammar/grammar_priv.h"
#include "grammar/import_priv.h"
#include "grammar/parse_priv.h"
#include "grammar/split.h"
#include "grammar/split_priv.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Much more than any grammar needs; what is made of it while it is read takes up to a hundred times as much memory. */
static const size_t MAX_FILE = (size_t)16 << 20;

static sg_status parse_language(const char *text, size_t length, const char *name, sg_arena *arena, sg_grammar **out,
                                sg_error *err)
{
    sg_parse *p = SG_NEW(arena, sg_parse);
    sg_ast *ast = SG_NEW(arena, sg_ast);
    char *copy = SG_NEW_ARRAY(arena, char, length + 2);
    if (p == NULL || ast == NULL || copy == NULL)
        return SG_FAIL_NOMEM(err);
    memcpy(copy, text, length);
    p->source = (sg_source){.name = name, .text = text, .length = length};
    p->arena = arena;
    p->ast = ast;
    p->err = err;
    SG_TRY(sg_source_check(&p->source, err));
    SG_TRY(sg_parse_text(p, copy, length));
    SG_TRY(sg_import_all(p, MAX_FILE));
    return sg_grammar_build(arena, ast, &p->source, out, err);
}

static sg_status parse_exchange(const char *text, size_t length, const char *name, sg_grammar **out, sg_error *err)
{
    sg_arena *arena = sg_arena_create();
    if (arena == NULL)
        return SG_FAIL_NOMEM(err);
    sg_split_form form;
    sg_status st = sg_split_form_read_json(text, length, name, arena, &form, err);
    if (st == SG_OK)
        st = sg_split_build(&form, name, out, err);
    sg_arena_free(arena);
    return st;
}

static bool is_exchange(const char *text, size_t length)
{
    for (size_t i = 0; i < length; i++)
        if (strchr(" \t\r\n", text[i]) == NULL || text[i] == '\0')
            return text[i] == '{';
    return false;
}

sg_status sg_grammar_parse(const char *text, size_t length, const char *name, sg_grammar **out, sg_error *err)
{
    if (length > MAX_FILE)
        return SG_FAIL(err, SG_EINPUT, "%.250s: larger than the %zu bytes that a grammar may have", name, MAX_FILE);
    if (is_exchange(text, length))
        return parse_exchange(text, length, name, out, err);
    sg_arena *arena = sg_arena_create();
    if (arena == NULL)
        return SG_FAIL_NOMEM(err);
    const sg_status st = parse_language(text, length, name, arena, out, err);
    if (st != SG_OK)
        sg_arena_free(arena);
    return st;
}

sg_status sg_grammar_load(const char *path, sg_grammar **out, sg_error *err)
{
    sg_arena *arena = sg_arena_create();
    char *text = NULL;
    size_t length = 0;
    if (arena == NULL)
        return SG_FAIL_NOMEM(err);
    sg_status st = sg_file_read(path, MAX_FILE, arena, &text, &length, err);
    if (st == SG_OK)
        st = sg_grammar_parse(text, length, strcmp(path, "-") == 0 ? "standard input" : path, out, err);
    sg_arena_free(arena);
    return st;
}

void sg_grammar_free(sg_grammar *g)
{
    if (g == NULL)
        return;
    sg_names_clear(&g->names);
    sg_arena_free(g->arena);
}

size_t sg_grammar_warning_count(const sg_grammar *g)
{
    return g->nwarnings;
}

const char *sg_grammar_warning(const sg_grammar *g, size_t i)
{
    return g->warnings[i];
}

const char *sg_grammar_name(const sg_grammar *g)
{
    return g->name;
}

const char *sg_grammar_source(const sg_grammar *g)
{
    return g->source;
}

size_t sg_grammar_import_count(const sg_grammar *g)
{
    return g->nimported;
}

const char *sg_grammar_import(const sg_grammar *g, size_t i)
{
    return g->imported[i].name;
}

size_t sg_grammar_symbol_count(const sg_grammar *g)
{
    return g->nsymbols;
}

size_t sg_grammar_rule_count(const sg_grammar *g)
{
    return g->nrules;
}

const sg_symbol *sg_grammar_symbol(const sg_grammar *g, sg_sym s)
{
    return &g->symbols[s];
}

const sg_rule *sg_grammar_rule(const sg_grammar *g, sg_rule_id r)
{
    return &g->rules[r];
}

sg_sym sg_grammar_find(const sg_grammar *g, const char *name)
{
    return sg_names_get(&g->names, name);
}

sg_sym sg_grammar_start(const sg_grammar *g)
{
    return g->start;
}

const double *sg_grammar_start_args(const sg_grammar *g)
{
    return g->start_args;
}

size_t sg_grammar_depth_limit(const sg_grammar *g)
{
    return g->depth_limit;
}

bool sg_grammar_tied(const sg_grammar *g)
{
    return g->tied;
}

size_t sg_grammar_frame_size(const sg_grammar *g)
{
    return g->frame_size;
}

const char *sg_grammar_string(const sg_grammar *g, uint32_t index)
{
    return g->strings[index];
}

uint32_t sg_grammar_material_color(const sg_grammar *g, uint32_t index)
{
    return g->string_colors[index];
}

bool sg_grammar_constant(const sg_grammar *g, sg_expr e, double *value)
{
    const sg_operand o = g->codes[e].result;
    if (SG_OPERAND_SPACE(o) != SG_IN_CONSTANTS)
        return false;
    *value = g->constants[SG_OPERAND_INDEX(o)];
    return true;
}

static double run(const sg_grammar *g, const sg_code *code, const double *frame, double depth)
{
    double registers[SG_MAX_REGISTERS];
    const double *const spaces[4] = {g->constants, frame, registers, &depth};
    const sg_instruction *i = g->instructions + code->first, *const end = i + code->n;
#define VALUE(o) spaces[SG_OPERAND_SPACE(o)][SG_OPERAND_INDEX(o)]
    for (; i < end; i++) {
        const double a = VALUE(i->a), b = VALUE(i->b);
        double r;
        switch ((sg_operator)i->op) { /* the usual ones without a call */
        case SG_E_ADD:
            r = a + b;
            break;
        case SG_E_SUB:
            r = a - b;
            break;
        case SG_E_MUL:
            r = a * b;
            break;
        case SG_E_DIV:
            r = a / b;
            break;
        case SG_E_LE:
            r = a <= b;
            break;
        default:
            r = sg_operator_apply((sg_operator)i->op, a, b, VALUE(i->c));
        }
        registers[i->to] = r;
    }
    return VALUE(code->result);
#undef VALUE
}

double sg_grammar_eval(const sg_grammar *g, sg_expr e, const double *frame, double depth)
{
    const sg_code *code = &g->codes[e];
    if (code->n > 0)
        return run(g, code, frame, depth);
    const uint32_t index = SG_OPERAND_INDEX(code->result);
    switch (SG_OPERAND_SPACE(code->result)) {
    case SG_IN_CONSTANTS:
        return g->constants[index];
    case SG_IN_FRAME:
        return frame[index];
    default:
        return depth;
    }
}

static sg_status weight_of(const sg_grammar *g, const sg_rule *r, const double *args, double depth, double *weight,
                           bool *holds, sg_error *err)
{
    *weight = 0;
    *holds = true;
    if (r->guard != SG_NONE) {
        const double guard = sg_grammar_eval(g, r->guard, args, depth);
        *holds = guard != 0 && !isnan(guard);
        if (!*holds)
            return SG_OK;
    }
    *weight = r->weight != SG_NONE ? sg_grammar_eval(g, r->weight, args, depth) : 1;
    if (*weight >= 0 && *weight <= DBL_MAX)
        return SG_OK;
    const sg_symbol *s = &g->symbols[r->lhs];
    if (s->hidden)
        return SG_FAIL(err, SG_ENUMERIC, "the probability of an optional successor is %g", args[0]);
    return SG_FAIL(err, SG_ENUMERIC, "the weight of a rule is %g (line %u)", *weight, (unsigned)r->line);
}

sg_status sg_grammar_rule_probabilities(const sg_grammar *g, sg_sym s, const double *args, double depth, double *p,
                                        sg_error *err)
{
    const sg_symbol *symbol = &g->symbols[s];
    const sg_rule *rules = g->rules + symbol->first_rule;
    if (symbol->constant_weights) {
        for (uint32_t i = 0; i < symbol->nrules; i++)
            p[i] = rules[i].probability;
        return SG_OK;
    }
    double sum = 0;
    bool any = false;
    for (uint32_t i = 0; i < symbol->nrules; i++) {
        bool holds = false;
        SG_TRY(weight_of(g, &rules[i], args, depth, &p[i], &holds, err));
        any |= holds;
        sum += p[i];
    }
    if (!any)
        return SG_FAIL(err, SG_ENUMERIC, "no guard of its rules holds");
    if (!(sum > 0 && sum <= DBL_MAX))
        return SG_FAIL(err, SG_ENUMERIC, "the weights of its rules sum to %g", sum);
    for (uint32_t i = 0; i < symbol->nrules; i++)
        p[i] /= sum;
    return SG_OK;
}

sg_status sg_op_repeat_count(const sg_grammar *g, const sg_op *op, const double *frame, double depth, size_t *n,
                             sg_error *err)
{
    const double count = round(sg_grammar_eval(g, op->args[0], frame, depth));
    if (!(count >= 0 && count <= SG_MAX_REPEAT))
        return SG_FAIL(err, SG_ENUMERIC, "a repeat count is %g", count);
    *n = (size_t)count;
    return SG_OK;
}

/* Children of ops[from, to) that are placed `times` times; *seen counts distinct children. */
static sg_status count_children(const sg_grammar *g, const sg_rule *r, uint32_t from, uint32_t to, size_t times,
                                const double *frame, double depth, uint32_t *seen, size_t *n, sg_error *err)
{
    for (uint32_t i = from; i < to;) {
        const sg_op *op = &r->ops[i];
        if (op->kind == SG_OP_SUCCESSOR && op->child == *seen) {
            ++*seen;
            *n += times;
            if (*n > SG_MAX_REPEAT)
                return SG_FAIL(err, SG_ENUMERIC, "it repeats more than %d children", SG_MAX_REPEAT);
        }
        if (op->kind != SG_OP_REPEAT) {
            i++;
            continue;
        }
        size_t count = 0;
        SG_TRY(sg_op_repeat_count(g, op, frame, depth, &count, err));
        if (count > 0 && times > SG_MAX_REPEAT / count)
            return SG_FAIL(err, SG_ENUMERIC, "it repeats more than %d times", SG_MAX_REPEAT);
        SG_TRY(count_children(g, r, i + 1, i + op->length, times * count, frame, depth, seen, n, err));
        i += op->length;
    }
    return SG_OK;
}

sg_status sg_rule_child_count(const sg_grammar *g, const sg_rule *r, const double *frame, double depth, size_t *n,
                              sg_error *err)
{
    *n = r->nchildren;
    if (!r->has_repeat)
        return SG_OK;
    uint32_t seen = 0;
    *n = 0;
    return count_children(g, r, 0, r->nops, 1, frame, depth, &seen, n, err);
}

bool sg_rule_is_flat_split(const sg_rule *r)
{
    const sg_op *split = r->ops;
    if (r->nops == 0 || split->kind != SG_OP_SPLIT || split->length != r->nops || split->nparts == 0 || split->axis == SG_AXIS_Z)
        return false;
    for (const sg_op *part = split + 1; part < split + split->length; part += part->length)
        if (part->length != 2 || part[1].kind != SG_OP_SUCCESSOR)
            return false;
    return true;
}
