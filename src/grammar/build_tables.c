/* SPDX-License-Identifier: GPL-3.0-or-later */
/* build_tables.c - what can be said once about each rule and symbol so that searches need not find it out again and again. */
#include "config.h"

#include "grammar/build_priv.h"

#include <math.h>

static bool is_draw(sg_operand o, uint32_t nparams)
{
    return SG_OPERAND_SPACE(o) == SG_IN_FRAME && SG_OPERAND_INDEX(o) >= nparams;
}

static bool uses_draw(const sg_builder *b, sg_expr e, uint32_t nparams)
{
    const sg_code *code = &b->codes[e];
    for (uint32_t i = code->first; i < code->first + code->n; i++) {
        const sg_instruction *in = &b->instructions[i];
        if (is_draw(in->a, nparams) || is_draw(in->b, nparams) || is_draw(in->c, nparams))
            return true;
    }
    return is_draw(code->result, nparams);
}

static bool passes_draws(const sg_builder *b, const sg_rule *r)
{
    const uint32_t nparams = b->symbols[r->lhs].nparams;
    for (uint32_t i = 0; i < r->nops; i++) {
        const sg_op *op = &r->ops[i];
        if (op->kind != SG_OP_SUCCESSOR && op->kind != SG_OP_REPEAT)
            continue;
        for (uint32_t k = 0; k < op->nargs; k++)
            if (uses_draw(b, op->args[k], nparams))
                return true;
    }
    return false;
}

/* Children are numbered by first occurrence. */
static sg_status list_children(sg_builder *b, sg_rule *r)
{
    uint32_t *ops = SG_NEW_ARRAY(b->arena, uint32_t, r->nchildren), n = 0;
    if (ops == NULL)
        return sg_build_fail_nomem(b);
    for (uint32_t i = 0; i < r->nops; i++)
        if (r->ops[i].kind == SG_OP_SUCCESSOR && r->ops[i].child == n)
            ops[n++] = i;
    r->child_ops = ops;
    return SG_OK;
}

/* Sums of probabilities; from the last rule that is possible on they are infinite, for rounding may leave the sum below 1. */
static sg_status sum_probabilities(sg_builder *b, sg_symbol *s)
{
    double *sums = SG_NEW_ARRAY(b->arena, double, s->nrules), sum = 0;
    if (sums == NULL)
        return sg_build_fail_nomem(b);
    for (uint32_t i = 0; i < s->nrules; i++)
        sums[i] = sum += b->rules[s->first_rule + i].probability;
    for (uint32_t i = s->nrules; i-- > 0;) {
        sums[i] = INFINITY;
        if (b->rules[s->first_rule + i].probability > 0)
            break;
    }
    s->cumulative = sums;
    return SG_OK;
}

static sg_status tabulate_symbol(sg_builder *b, sg_symbol *s)
{
    if (!s->constant_weights)
        return SG_OK;
    const sg_rule *r = &b->rules[s->first_rule];
    s->leaf = s->nrules == 1 && s->nparams == 0 && r->ndraws == 0 && r->nchildren == 0 && !r->has_repeat;
    return sum_probabilities(b, s);
}

sg_status sg_build_tables(sg_builder *b)
{
    for (size_t i = 0; i < b->nsymbols; i++)
        if (b->symbols[i].kind == SG_SYMBOL_NONTERMINAL)
            SG_TRY(tabulate_symbol(b, &b->symbols[i]));
    for (size_t i = 0; i < b->nrules; i++) {
        b->rules[i].draws_passed = passes_draws(b, &b->rules[i]);
        if (!b->rules[i].has_repeat)
            SG_TRY(list_children(b, &b->rules[i]));
    }
    return SG_OK;
}
