/* SPDX-License-Identifier: GPL-3.0-or-later */
/* placer.c - cuts the scope of one body. */
#include "scene/placer.h"

#include "core/array.h"
#include "scene/label_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>


typedef struct {
    sg_placer *p;
    const sg_derivation *d;
    const sg_node *n;
    size_t node;
    const sg_rule *r;
    const double *frame;
    bool in_repeat;
    sg_error *err;
} body;

void sg_placer_clear(sg_placer *p)
{
    free(p->items);
    sg_stored_children_clear(&p->children);
    free(p->starts);
    free(p->sizes);
    memset(p, 0, sizeof *p);
}

void sg_placer_reset(sg_placer *p)
{
    p->n = p->nplaced = 0;
}

static void reverse_range(sg_place *items, size_t first, size_t end)
{
    while (first + 1 < end) {
        const sg_place swap = items[first];
        items[first++] = items[--end];
        items[end] = swap;
    }
}

void sg_placer_reverse(sg_placer *p, size_t first)
{
    reverse_range(p->items, first, p->n);
}

sg_status sg_placer_insert(sg_placer *p, size_t at, sg_place place, sg_error *err)
{
    if (!SG_GROW(p->items, p->items_capacity, p->n + 1))
        return SG_FAIL_NOMEM(err);
    memmove(p->items + at + 1, p->items + at, (p->n++ - at) * sizeof *p->items);
    p->items[at] = place;
    return SG_OK;
}

static sg_status fail(body *b, const char *what)
{
    SG_FAIL(b->err, SG_ENUMERIC, "%s", what);
    return b->d->nnodes > 0 ? sg_derivation_fail_at(b->d, b->node, SG_ENUMERIC, b->err) : SG_ENUMERIC;
}

static sg_status add_place(body *b, sg_rect rect, size_t node, sg_sym label)
{
    sg_placer *p = b->p;
    if (++p->nplaced > SG_LABEL_SCENE_MAX_PLACES)
        return fail(b, "more than 2^22 symbols and labels are placed");
    if (p->n == p->items_capacity && !SG_GROW(p->items, p->items_capacity, p->n + 1))
        return SG_FAIL_NOMEM(b->err);
    p->items[p->n++] = (sg_place){rect, node, label};
    return SG_OK;
}

static sg_status place_block(body *b, size_t first, size_t end, sg_rect rect, bool outermost);

static sg_status place_successor(body *b, const sg_op *op, sg_rect rect)
{
    if (sg_grammar_symbol(b->d->grammar, op->symbol)->kind == SG_SYMBOL_LABEL)
        return add_place(b, rect, b->node, op->symbol);
    size_t child;
    if (!sg_stored_children_next(&b->p->children, op, b->in_repeat, &child))
        return fail(b, "it has fewer children than its rule asks for");
    return add_place(b, rect, child, SG_NONE);
}

/* The piece of rect from share lo to share hi along the axis; the language's y runs up, the picture's down. */
static sg_rect piece(sg_rect r, sg_axis axis, double lo, double hi)
{
    if (axis == SG_AXIS_X)
        return (sg_rect){sg_placer_cut(r.x0, r.x1, lo), r.y0, sg_placer_cut(r.x0, r.x1, hi), r.y1};
    return (sg_rect){r.x0, sg_placer_cut(r.y1, r.y0, hi), r.x1, sg_placer_cut(r.y1, r.y0, lo)};
}

/* Parts of a label scene fill their scope. */
static sg_status begin_split(body *b, const sg_op *split, double length, sg_split_walk *w)
{
    const char *wrong = sg_split_walk_begin(w, b->d->grammar, b->r, split, b->frame, b->n->depth, length);
    if (wrong != NULL)
        return fail(b, wrong);
    if (w->fixed > 1 + SG_SPLIT_TOLERANCE)
        return fail(b, "the parts of a split are larger than its scope");
    return w->filled ? SG_OK : fail(b, "the parts of a split do not fill its scope");
}

static sg_status note_size(body *b, double share)
{
    sg_placer *p = b->p;
    if (!SG_GROW(p->sizes, p->sizes_capacity, p->nsizes + 1))
        return SG_FAIL_NOMEM(b->err);
    p->sizes[p->nsizes++] = share;
    return SG_OK;
}

static sg_status note_start(body *b)
{
    sg_placer *p = b->p;
    if (!SG_GROW(p->starts, p->starts_capacity, p->nstarts + 1))
        return SG_FAIL_NOMEM(b->err);
    p->starts[p->nstarts++] = p->n;
    return SG_OK;
}

/* The parts from mark on were placed bottom to top: turn the parts around, not what stands in each. */
static void turn_parts(sg_placer *p, size_t mark, bool outermost)
{
    const size_t first = p->starts[mark], end = p->n;
    reverse_range(p->items, first, end);
    for (size_t k = mark; k < p->nstarts; k++) {
        const size_t s = p->starts[k], e = k + 1 < p->nstarts ? p->starts[k + 1] : end;
        reverse_range(p->items, first + (end - e), first + (end - s));
    }
    if (!outermost)
        return;
    for (size_t i = 0, j = p->nsizes; i + 1 < j; i++) {
        const double swap = p->sizes[i];
        p->sizes[i] = p->sizes[--j];
        p->sizes[j] = swap;
    }
}

static double length_along(sg_rect r, sg_axis axis)
{
    return axis == SG_AXIS_X ? r.x1 - r.x0 : r.y1 - r.y0;
}

static sg_status place_split(body *b, size_t at, sg_rect rect, bool outermost)
{
    const sg_op *split = b->r->ops + at;
    if (split->axis == SG_AXIS_Z)
        return fail(b, "a split along z is no label scene");
    const size_t mark = b->p->nstarts;
    sg_split_walk walk;
    SG_TRY(begin_split(b, split, length_along(rect, split->axis), &walk));
    double from = 0;
    size_t part = at + 1;
    for (uint32_t k = 0; k < split->nparts; k++, part += b->r->ops[part].length) {
        const sg_op *op = b->r->ops + part;
        const double to = sg_split_walk_next(&walk);
        SG_TRY(note_start(b));
        if (outermost)
            SG_TRY(note_size(b, walk.share));
        SG_TRY(place_block(b, part + 1, part + op->length, piece(rect, split->axis, from, to), false));
        from = to;
    }
    if (split->axis == SG_AXIS_Y && split->nparts > 0)
        turn_parts(b->p, mark, outermost);
    b->p->nstarts = mark;
    return SG_OK;
}

static sg_status place_repeat(body *b, size_t at, sg_rect rect, bool outermost)
{
    const sg_op *op = b->r->ops + at;
    if (op->axis == SG_AXIS_Z)
        return fail(b, "a repeat along z is no label scene");
    const size_t mark = b->p->nstarts;
    size_t times = 0;
    const sg_status st = sg_op_repeat_count(b->d->grammar, op, b->frame, b->n->depth, &times, b->err);
    if (st != SG_OK)
        return sg_derivation_fail_at(b->d, b->node, st, b->err);
    if (times == 0)
        return fail(b, "a repeat of nothing leaves its scope empty");
    const bool nested = b->in_repeat;
    b->in_repeat = true;
    for (size_t t = 0; t < times; t++) {
        const double from = sg_placer_share((double)t / (double)times);
        const double to = sg_placer_share((double)(t + 1) / (double)times);
        SG_TRY(note_start(b));
        if (outermost)
            SG_TRY(note_size(b, 1 / (double)times));
        SG_TRY(place_block(b, at + 1, at + op->length, piece(rect, op->axis, from, to), false));
    }
    b->in_repeat = nested;
    if (op->axis == SG_AXIS_Y)
        turn_parts(b->p, mark, outermost);
    b->p->nstarts = mark;
    return SG_OK;
}

static sg_status place_op(body *b, size_t at, sg_rect rect, bool outermost)
{
    const sg_op *op = b->r->ops + at;
    switch (op->kind) {
    case SG_OP_SUCCESSOR:
        return place_successor(b, op, rect);
    case SG_OP_SPLIT:
        return place_split(b, at, rect, outermost);
    case SG_OP_REPEAT:
        return place_repeat(b, at, rect, outermost);
    case SG_OP_PUSH:
        return place_block(b, at + 1, at + op->length, rect, outermost);
    case SG_OP_PART:
    case SG_OP_SHAPE:
        break;
    }
    return fail(b, "a shape operation that is no split has no place in a label scene");
}

static sg_status place_block(body *b, size_t first, size_t end, sg_rect rect, bool outermost)
{
    if (first == end)
        return fail(b, "an empty body leaves a hole in a label scene");
    if (first + b->r->ops[first].length != end)
        return fail(b, "more than one thing in one scope is no label scene");
    return place_op(b, first, rect, outermost);
}

sg_status sg_placer_place(sg_placer *p, const sg_derivation *d, size_t node, sg_rect rect, sg_error *err)
{
    return sg_placer_place_frame(p, d, node, d->values + d->nodes[node].values, rect, err);
}

sg_status sg_placer_place_frame(sg_placer *p, const sg_derivation *d, size_t node, const double *frame, sg_rect rect,
                                sg_error *err)
{
    const sg_node *n = d->nodes + node;
    body b = {.p = p, .d = d, .n = n, .node = node, .frame = frame, .err = err};
    p->nsizes = p->nstarts = 0;
    if (n->rule == SG_NONE)
        return fail(&b, "not derived yet");
    if (n->rule == SG_RULE_EMPTY)
        return fail(&b, "cut at the depth limit, where it has no completion");
    b.r = sg_grammar_rule(d->grammar, n->rule);
    SG_TRY(sg_stored_children_find(&p->children, d, node, b.r, err));
    return place_block(&b, 0, b.r->nops, rect, true);
}

sg_status sg_placer_constant_ends(const sg_grammar *g, const sg_rule *r, const sg_op *split, double *ends)
{
    const sg_derivation d = {.grammar = g};
    const sg_node n = {.symbol = r->lhs};
    body b = {.d = &d, .n = &n, .r = r};
    sg_split_walk walk;
    SG_TRY(begin_split(&b, split, 1, &walk));
    for (uint32_t k = 0; k < split->nparts; k++)
        ends[k] = sg_split_walk_next(&walk);
    return SG_OK;
}
