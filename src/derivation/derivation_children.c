/* SPDX-License-Identifier: GPL-3.0-or-later */
/* derivation_children.c - which children a rule asks for, their arguments, its draws; and where in the tree something went wrong. */
#include "core/array.h"
#include "derivation/derivation_priv.h"

#include <stdio.h>

/* Most blocks that the repeats of one body place: nested ones multiply, and may place nothing that is ever counted. */
#define MAX_PLACED ((size_t)1 << 24)

/* State of one listing. Successors outside repeats are numbered by first occurrence: what is below next_id is known. */
typedef struct {
    const sg_grammar *g;
    const sg_rule *r;
    const double *frame;
    double depth;
    uint32_t parent, next_id;
    size_t limit, nplaced;
    sg_child_list *list;
    sg_error *err;
} listing;

static sg_status add_child(listing *l, size_t op)
{
    sg_child_list *list = l->list;
    if (list->n >= l->limit)
        return SG_FAIL(l->err, SG_EINVAL, "more than %zu children", l->limit);
    if (list->n == list->capacity && !SG_GROW(list->items, list->capacity, list->n + 1))
        return SG_FAIL_NOMEM(l->err);
    list->items[list->n++] = (sg_child_op){l->parent, (uint32_t)op};
    return SG_OK;
}

/* Recurses once a nested repeat. */
static sg_status list_block(listing *l, size_t first, size_t end, bool in_repeat)
{
    const sg_op *ops = l->r->ops;
    for (size_t i = first; i < end; i++) {
        const sg_op *op = ops + i;
        if (op->kind == SG_OP_REPEAT) {
            size_t times = 0;
            SG_TRY(sg_op_repeat_count(l->g, op, l->frame, l->depth, &times, l->err));
            l->nplaced += times;
            if (l->nplaced > MAX_PLACED)
                return SG_FAIL(l->err, SG_ENUMERIC, "its repeats place more than %zu blocks", MAX_PLACED);
            for (size_t t = 0; t < times; t++)
                SG_TRY(list_block(l, i + 1, i + op->length, true));
            i += op->length - 1;
        } else if (op->kind == SG_OP_SUCCESSOR && op->child != SG_NONE) { /* a label is no child */
            if (!in_repeat && op->child < l->next_id)
                continue; /* tied to one before it */
            if (!in_repeat)
                l->next_id = op->child + 1;
            SG_TRY(add_child(l, i));
        }
    }
    return SG_OK;
}

sg_status sg_derivation_list_children(const sg_grammar *g, const sg_rule *r, const double *frame, double depth,
                                      uint32_t parent, size_t limit, sg_child_list *list, sg_error *err)
{
    listing l = {g, r, frame, depth, parent, 0, limit, 0, list, err};
    return list_block(&l, 0, r->nops, false);
}

void sg_derivation_eval_args(const sg_grammar *g, const sg_op *op, const double *frame, double depth, double *args)
{
    for (uint32_t i = 0; i < op->nargs; i++)
        args[i] = sg_grammar_eval(g, op->args[i], frame, depth);
}

sg_status sg_derivation_transform(const sg_grammar *g, const sg_rule *r, uint32_t nparams, double depth,
                                  const double *uniforms, double *frame, sg_error *err)
{
    for (uint32_t i = 0; i < r->ndraws; i++) {
        const sg_draw *draw = r->draws + i;
        SG_TRY(sg_draw_transform(g, draw, frame, depth, uniforms + draw->first_uniform,
                                 frame + nparams + draw->first_value, err));
    }
    return SG_OK;
}

void sg_derivation_path(const sg_derivation *d, size_t node, char *text, size_t size)
{
    enum { HEAD = 3, TAIL = 6 };
    const size_t levels = d->nodes[node].depth - d->nodes[0].depth + 1;
    size_t used = 0;
    text[0] = '\0';
    for (size_t level = 0; level < levels && used < size; level++) {
        if (levels > HEAD + TAIL && level == HEAD) {
            level = levels - TAIL;
            used += (size_t)snprintf(text + used, size - used, " > (%zu more)", levels - HEAD - TAIL);
            if (used >= size)
                return;
        }
        size_t at = node;
        for (size_t up = levels - 1; up > level; up--)
            at -= d->nodes[at].parent;
        const char *name = sg_grammar_symbol(d->grammar, d->nodes[at].symbol)->name;
        used += (size_t)snprintf(text + used, size - used, "%s%.60s", level > 0 ? " > " : "", name);
    }
}

sg_status sg_derivation_fail_at(const sg_derivation *d, size_t node, sg_status code, sg_error *err)
{
    if (err == NULL || code == SG_ENOMEM)
        return code;
    sg_error inner = *err;
    char path[480];
    sg_derivation_path(d, node, path, sizeof path);
    return sg_fail(err, code, "deriving %s: %.500s", path, inner.msg);
}
