/* SPDX-License-Identifier: GPL-3.0-or-later */
/* derivation_statistics.c - counts of symbols and parameters. */
#include "derivation/derivation_statistics.h"

#include "derivation/derivation_priv.h"
#include "grammar/shape_ops.h"

#include <string.h>

/* A body of which terminals are counted. */
typedef struct {
    const sg_grammar *g;
    const sg_rule *r;
    const double *frame;
    double depth;
    sg_derivation_statistics *out;
    sg_error *err;
} counting;

static size_t numbers_of(const sg_op *op)
{
    const char *kinds = sg_shape_op_info((sg_shape_op)op->shape)->args;
    size_t n = 0;
    for (uint32_t i = 0; i < op->nargs; i++)
        n += kinds[i] == 'n';
    return n;
}

static void count_op(const counting *c, const sg_op *op, size_t times)
{
    const bool label = op->kind == SG_OP_SUCCESSOR && sg_grammar_symbol(c->g, op->symbol)->kind == SG_SYMBOL_LABEL;
    const bool shape = op->kind == SG_OP_SHAPE && op->shape != SG_SHAPE_COMPONENTS;
    if (!label && !shape)
        return;
    c->out->terminals += times;
    if (shape)
        c->out->terminal_arguments += times * numbers_of(op);
}

/* Recurses once a nested repeat. */
static sg_status count_block(const counting *c, size_t first, size_t end, size_t times)
{
    for (size_t i = first; i < end; i++) {
        const sg_op *op = c->r->ops + i;
        if (op->kind != SG_OP_REPEAT) {
            count_op(c, op, times);
            continue;
        }
        size_t placed = 0;
        SG_TRY(sg_op_repeat_count(c->g, op, c->frame, c->depth, &placed, c->err));
        SG_TRY(count_block(c, i + 1, i + op->length, times * placed));
        i += op->length - 1;
    }
    return SG_OK;
}

static sg_status count_node(const sg_derivation *d, size_t node, sg_derivation_statistics *out, sg_error *err)
{
    const sg_node *n = d->nodes + node;
    const sg_rule *r = sg_node_rule(d, n);
    const sg_symbol *s = sg_grammar_symbol(d->grammar, n->symbol);
    out->nonterminals += !(s->hidden && s->completion != SG_NONE); /* hidden, and the same at the limit: a label's */
    out->arguments += s->nparams;
    const size_t depth = n->depth - d->nodes[0].depth;
    out->depth = depth > out->depth ? depth : out->depth;
    if (r == NULL)
        return SG_OK;
    for (uint32_t k = 0; k < r->ndraws; k++)
        out->draws += r->draws[k].nvalues - (r->draws[k].kind == SG_DRAW_SIMPLEX);
    const counting c = {d->grammar, r, d->values + n->values, n->depth, out, err};
    const sg_status st = count_block(&c, 0, r->nops, 1);
    return st == SG_OK ? SG_OK : sg_derivation_fail_at(d, node, st, err);
}

sg_status sg_derivation_statistics_of(const sg_derivation *d, sg_derivation_statistics *out, sg_error *err)
{
    memset(out, 0, sizeof *out);
    for (size_t i = 0; i < d->nnodes; i++)
        SG_TRY(count_node(d, i, out, err));
    out->symbols = out->nonterminals + out->terminals;
    out->parameters = out->arguments + out->terminal_arguments + out->draws;
    return SG_OK;
}
