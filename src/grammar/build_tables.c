/* SPDX-License-Identifier: GPL-3.0-or-later */
/* build_tables.c - what can be said once about each rule so that searches need not find it out again and again. */
#include "config.h"

#include "grammar/build_priv.h"

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

sg_status sg_build_tables(sg_builder *b)
{
    for (size_t i = 0; i < b->nrules; i++) {
        b->rules[i].draws_passed = passes_draws(b, &b->rules[i]);
        if (!b->rules[i].has_repeat)
            SG_TRY(list_children(b, &b->rules[i]));
    }
    return SG_OK;
}
