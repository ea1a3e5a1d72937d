/* SPDX-License-Identifier: GPL-3.0-or-later */
/* scene_body.c - one body: its blocks, and which child stands where. It recurses once for each nested bracket, of which
 * the reader of grammars allows few. */
#include "scene/scene_priv.h"

#include "core/array.h"
#include "grammar/shape_ops.h"
#include "scene/placer.h"

/* States are passed by pointer and copied where a block begins. */
static sg_status read_block(sg_scene_body *b, size_t first, size_t end, sg_scene_state *s);

sg_status sg_scene_fail(sg_scene_body *b, const char *what)
{
    SG_FAIL(b->err, SG_ENUMERIC, "%s", what);
    return sg_derivation_fail_at(b->d, b->node, SG_ENUMERIC, b->err);
}

sg_status sg_scene_count(sg_scene_body *b)
{
    if (b->nplaced >= b->limit)
        return sg_scene_fail(b, "more symbols and primitives are placed than is allowed");
    b->nplaced++;
    return SG_OK;
}

static sg_status push_child(sg_scene_body *b, size_t node, const sg_scene_state *s)
{
    struct sg_scene_work *w = b->scene->work;
    SG_TRY(sg_scene_count(b));
    if (!SG_GROW(w->items, w->capacity, w->n + 1))
        return SG_FAIL_NOMEM(b->err);
    sg_scene_item *item = w->items + w->n++;
    item->node = node;
    item->parent = b->place;
    sg_scene_state_copy(&item->state, s);
    return SG_OK;
}

static sg_status read_successor(sg_scene_body *b, const sg_op *op, const sg_scene_state *s)
{
    if (sg_grammar_symbol(b->d->grammar, op->symbol)->kind == SG_SYMBOL_LABEL) {
        sg_scene_state labelled;
        sg_scene_state_copy(&labelled, s);
        labelled.label = op->symbol;
        return sg_scene_add_scope(b, &labelled, SG_PRIMITIVE_LABEL);
    }
    size_t child;
    if (!sg_stored_children_next(&b->scene->work->children, op, b->in_repeat, &child))
        return sg_scene_fail(b, "it has fewer children than its rule asks for");
    return b->unplaced == 0 ? push_child(b, child, s) : SG_OK;
}

/* The scope from one share of it to another along an axis: a scope of its own, where no segment ends. */
static void piece(const sg_scene_state *s, sg_axis axis, double from, double to, sg_scene_state *out)
{
    const double length = s->size[axis];
    const double a = sg_placer_cut(0, length, from), b = sg_placer_cut(0, length, to);
    sg_scene_state_copy(out, s);
    sg_frame_move(&out->frame, axis == SG_AXIS_X ? a : 0, axis == SG_AXIS_Y ? a : 0, axis == SG_AXIS_Z ? a : 0);
    out->size[axis] = b - a;
    out->joint = -1;
}

/* A block passed over: its successors count, but stand nowhere. */
static sg_status pass_over(sg_scene_body *b, size_t first, size_t end, const sg_scene_state *s)
{
    sg_scene_state unseen;
    sg_scene_state_copy(&unseen, s);
    b->unplaced++;
    const sg_status st = read_block(b, first, end, &unseen);
    b->unplaced--;
    return st;
}

/* A block in a piece of the scope. One without extent (of what is cut off, or of a scope that is flat) is passed over.
 */
static sg_status read_piece(sg_scene_body *b, size_t first, size_t end, const sg_scene_state *s, sg_axis axis,
                            double from, double to)
{
    sg_scene_state inner;
    piece(s, axis, from, to, &inner);
    return inner.size[axis] > 0 ? read_block(b, first, end, &inner) : pass_over(b, first, end, s);
}

static sg_status check_axis(sg_scene_body *b, sg_axis axis, const sg_scene_state *s)
{
    return s->ncorners == 0 || axis == SG_AXIS_Z ? SG_OK : sg_scene_fail(b, "a polygon is cut along z alone");
}

static sg_status read_split(sg_scene_body *b, size_t at, const sg_scene_state *s)
{
    const sg_op *split = b->r->ops + at;
    sg_split_walk walk;
    SG_TRY(check_axis(b, split->axis, s));
    const char *wrong = sg_split_walk_begin(&walk, b->d->grammar, b->r, split, b->frame, b->d->nodes[b->node].depth,
                                            s->size[split->axis]);
    if (wrong != NULL)
        return sg_scene_fail(b, wrong);
    double from = 0;
    size_t part = at + 1;
    for (uint32_t k = 0; k < split->nparts; k++, part += b->r->ops[part].length) {
        const double to = sg_split_walk_next(&walk);
        SG_TRY(read_piece(b, part + 1, part + b->r->ops[part].length, s, split->axis, from, to));
        from = to;
    }
    return SG_OK;
}

static sg_status read_repeat(sg_scene_body *b, size_t at, const sg_scene_state *s)
{
    const sg_op *op = b->r->ops + at;
    const bool nested = b->in_repeat;
    size_t times = 0;
    SG_TRY(check_axis(b, op->axis, s));
    const sg_status st = sg_op_repeat_count(b->d->grammar, op, b->frame, b->d->nodes[b->node].depth, &times, b->err);
    if (st != SG_OK)
        return sg_derivation_fail_at(b->d, b->node, st, b->err);
    b->in_repeat = true;
    for (size_t t = 0; t < times; t++) {
        const double from = sg_placer_share((double)t / (double)times);
        const double to = sg_placer_share((double)(t + 1) / (double)times);
        SG_TRY(read_piece(b, at + 1, at + op->length, s, op->axis, from, to));
    }
    b->in_repeat = nested;
    return SG_OK;
}

static bool selects(uint32_t selector, int face)
{
    return selector == (uint32_t)face || selector == SG_FACE_ALL || (selector == SG_FACE_SIDE && face < SG_FACE_TOP);
}

/* Read a part once for each face that it takes. Each time the cursor begins anew: all faces place the same children. */
static sg_status read_faces(sg_scene_body *b, size_t part, const sg_scene_state *s, bool *taken)
{
    const sg_op *op = b->r->ops + part;
    sg_child_cursor *at = &b->scene->work->children.at;
    const sg_child_cursor start = *at;
    bool any = false;
    for (size_t face = 0; face < sg_scene_face_count(s); face++) {
        sg_scene_state inner;
        if (taken[face] || !selects(op->shape, sg_scene_face_kind(s, face)))
            continue;
        taken[face] = true;
        if (!sg_scene_face_at(s, face, &inner))
            continue;
        *at = start;
        any = true;
        SG_TRY(read_block(b, part + 1, part + op->length, &inner));
    }
    return any ? SG_OK : pass_over(b, part + 1, part + op->length, s);
}

static sg_status read_components(sg_scene_body *b, size_t at, const sg_scene_state *s)
{
    bool taken[SG_SCENE_FACES] = {false};
    size_t part = at + 1;
    for (uint32_t k = 0; k < b->r->ops[at].nparts; k++, part += b->r->ops[part].length)
        SG_TRY(read_faces(b, part, s, taken));
    return SG_OK;
}

/* Does something in ops first..end-1 take over the solid that an extrusion has made? */
static bool taken_over(const sg_op *ops, size_t first, size_t end)
{
    for (size_t i = first; i < end; i++)
        if (ops[i].kind == SG_OP_SUCCESSOR || ops[i].kind == SG_OP_SPLIT || ops[i].kind == SG_OP_REPEAT ||
            (ops[i].kind == SG_OP_SHAPE && (ops[i].shape == SG_SHAPE_COMPONENTS || ops[i].shape == SG_SHAPE_INSERT)))
            return true;
    return false;
}

static sg_status read_op(sg_scene_body *b, size_t at, sg_scene_state *s)
{
    const sg_op *op = b->r->ops + at;
    sg_scene_state inner;
    switch (op->kind) {
    case SG_OP_SUCCESSOR:
        return read_successor(b, op, s);
    case SG_OP_SPLIT:
        return read_split(b, at, s);
    case SG_OP_REPEAT:
        return read_repeat(b, at, s);
    case SG_OP_PUSH:
        sg_scene_state_copy(&inner, s);
        return read_block(b, at + 1, at + op->length, &inner);
    case SG_OP_SHAPE:
        return op->shape == SG_SHAPE_COMPONENTS ? read_components(b, at, s) : sg_scene_read_shape(b, op, s);
    case SG_OP_PART:
        break;
    }
    return sg_scene_fail(b, "a part that stands alone");
}

static sg_status read_block(sg_scene_body *b, size_t first, size_t end, sg_scene_state *s)
{
    const sg_op *ops = b->r->ops;
    bool solid = false;
    for (size_t i = first; i < end; i += ops[i].length) {
        SG_TRY(read_op(b, i, s));
        if (ops[i].kind == SG_OP_SHAPE && ops[i].shape == SG_SHAPE_EXTRUDE)
            solid = !taken_over(ops, i + 1, end);
    }
    return solid ? sg_scene_add_scope(b, s, SG_PRIMITIVE_POLYGON) : SG_OK;
}

sg_status sg_scene_read_body(sg_scene_body *b, const sg_scene_state *state)
{
    sg_scene_state s;
    sg_scene_state_copy(&s, state);
    b->in_repeat = false;
    b->unplaced = 0;
    return read_block(b, 0, b->r->nops, &s);
}
