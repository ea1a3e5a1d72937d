/* SPDX-License-Identifier: GPL-3.0-or-later */
/* tree_picture.c - which part of a derivation is drawn, and where it stands. */
#include "config.h"

#include "core/array.h"
#include "grammar/shape_ops.h"
#include "scene/stored_children.h"
#include "scene/tree_layout.h"
#include "scene/tree_picture_priv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double MARGIN = 16, GAP = 12, LEVEL_GAP = 36, PADDING = 8;

enum { MAX_STACK = 12 };

/* What a body places, in its order: a child, or (node: SIZE_MAX) an operation or a label. */
typedef struct {
    size_t node;   /* of the child */
    size_t owner;  /* node of the body */
    size_t parent; /* mark */
    const sg_op *op;
} item;

typedef struct {
    const sg_derivation *d;
    const sg_tree_picture_opts *opts;
    sg_tree_picture *p;
    bool *expanded; /* [nodes] */
    item *items;    /* a list, then a stack */
    size_t n, capacity;
    sg_stored_children children;
    sg_error *err;
} drawing;

void sg_tree_picture_clear(sg_tree_picture *p)
{
    free(p->marks);
    free(p->level_top);
    free(p->level_bottom);
    sg_arena_free(p->arena);
    *p = (sg_tree_picture){0};
}

static sg_status add_item(drawing *w, size_t node, size_t owner, const sg_op *op)
{
    if (!SG_GROW(w->items, w->capacity, w->n + 1))
        return SG_FAIL_NOMEM(w->err);
    w->items[w->n++] = (item){node, owner, 0, op};
    return SG_OK;
}

/* A child that is tied to one before it stands there. */
static sg_status list_successor(drawing *w, size_t owner, const sg_op *op, bool in_repeat)
{
    if (sg_grammar_symbol(w->d->grammar, op->symbol)->kind == SG_SYMBOL_LABEL)
        return add_item(w, SIZE_MAX, owner, op);
    const size_t before = w->children.at.next;
    size_t child;
    if (!sg_stored_children_next(&w->children, op, in_repeat, &child) || w->children.at.next == before)
        return SG_OK;
    return add_item(w, child, owner, op);
}

static sg_status list_block(drawing *w, size_t owner, const sg_rule *r, size_t first, size_t end, bool in_repeat)
{
    const sg_node *n = w->d->nodes + owner;
    for (size_t i = first; i < end; i++) {
        const sg_op *op = r->ops + i;
        if (op->kind == SG_OP_REPEAT) {
            size_t times = 0;
            SG_TRY(sg_op_repeat_count(w->d->grammar, op, w->d->values + n->values, n->depth, &times, w->err));
            for (size_t t = 0; t < times; t++)
                SG_TRY(list_block(w, owner, r, i + 1, i + op->length, true));
            i += op->length - 1;
        } else if (op->kind == SG_OP_SUCCESSOR)
            SG_TRY(list_successor(w, owner, op, in_repeat));
        else if (op->kind == SG_OP_SHAPE && op->shape != SG_SHAPE_COMPONENTS)
            SG_TRY(add_item(w, SIZE_MAX, owner, op));
    }
    return SG_OK;
}

/* Append what the body of a node places to the items. */
static sg_status list_body(drawing *w, size_t node)
{
    if (w->d->nodes[node].rule >= SG_RULE_EMPTY)
        return SG_OK;
    const sg_rule *r = sg_grammar_rule(w->d->grammar, w->d->nodes[node].rule);
    SG_TRY(sg_stored_children_find(&w->children, w->d, node, r, w->err));
    return list_block(w, node, r, 0, r->nops, false);
}

/* Expand level by level while there is room. The items are the queue. */
static sg_status choose_expanded(drawing *w)
{
    const uint32_t top = w->d->nodes[0].depth;
    size_t marks = 1;
    SG_TRY(add_item(w, 0, 0, NULL));
    for (size_t i = 0; i < w->n; i++) {
        const size_t node = w->items[i].node;
        if (node == SIZE_MAX || sg_tree_label_of(w->d->grammar, w->d->nodes[node].symbol) != SG_NONE)
            continue;
        const size_t before = w->n;
        if (w->d->nodes[node].depth - top < w->opts->max_depth && marks < w->opts->max_marks)
            SG_TRY(list_body(w, node));
        w->expanded[node] = w->n > before && marks + w->n - before <= w->opts->max_marks;
        if (w->expanded[node])
            marks += w->n - before;
        else
            w->n = before;
    }
    return SG_OK;
}

static sg_status put_mark(drawing *w, const item *from, sg_tree_shape shape, const char *text, uint32_t fill)
{
    sg_tree_picture *p = w->p;
    if (text == NULL || !SG_GROW(p->marks, p->capacity, p->n + 1))
        return SG_FAIL_NOMEM(w->err);
    sg_tree_mark *m = p->marks + p->n++;
    *m = (sg_tree_mark){.shape = shape, .node = from->owner, .parent = from->parent, .text = text, .beside = "", .fill = fill};
    m->level = from->parent == SIZE_MAX ? 0 : p->marks[from->parent].level + 1;
    return SG_OK;
}

/* How much is not drawn below a node that is not expanded: one mark for all of it. */
static sg_status put_elided(drawing *w, size_t node)
{
    const item below = {SIZE_MAX, node, w->p->n - 1, NULL};
    const size_t before = w->n, nodes = w->d->nodes[node].length - 1;
    SG_TRY(list_body(w, node));
    const size_t terminals = w->n - before;
    w->n = before;
    if (nodes + terminals == 0)
        return SG_OK;
    const size_t count = nodes > 0 ? nodes : terminals;
    const char *what = nodes > 0 ? "node" : "terminal", *plural = count == 1 ? "" : "s";
    const char *text = sg_arena_printf(w->p->arena, "\xE2\x80\xA6 %zu %s%s", count, what, plural);
    return put_mark(w, &below, SG_TREE_ELIDED, text, 0xffffff);
}

static sg_status put_operation(drawing *w, const item *from)
{
    sg_arena *arena = w->p->arena;
    sg_tree_mark *last = w->p->marks + w->p->n - 1;
    const char *text = sg_tree_operation_text(arena, w->d, from->owner, from->op);
    if (text == NULL || last->shape != SG_TREE_TERMINAL || last->parent != from->parent || last->lines == 0 ||
        last->lines == MAX_STACK) {
        SG_TRY(put_mark(w, from, SG_TREE_TERMINAL, text, 0xececec));
        w->p->marks[w->p->n - 1].lines = 1;
        return SG_OK;
    }
    last->text = sg_arena_printf(arena, "%s\n%s", last->text, text);
    last->lines++;
    return last->text != NULL ? SG_OK : SG_FAIL_NOMEM(w->err);
}

static sg_status put_terminal(drawing *w, const item *from)
{
    const sg_grammar *g = w->d->grammar;
    if (from->op->kind != SG_OP_SUCCESSOR)
        return put_operation(w, from);
    return put_mark(w, from, SG_TREE_TERMINAL, sg_tree_label_text(w->p->arena, g, from->op->symbol),
                    sg_grammar_symbol(g, from->op->symbol)->color);
}

static sg_status put_node(drawing *w, const item *from)
{
    const sg_grammar *g = w->d->grammar;
    const size_t node = from->node, mark = w->p->n, before = w->n;
    const sg_sym label = sg_tree_label_of(g, w->d->nodes[node].symbol);
    const item own = {node, node, from->parent, from->op};
    if (label != SG_NONE)
        return put_mark(w, &own, SG_TREE_TERMINAL, sg_tree_label_text(w->p->arena, g, label), sg_grammar_symbol(g, label)->color);
    SG_TRY(put_mark(w, &own, SG_TREE_NONTERMINAL, sg_tree_node_text(w->p->arena, w->d, node), 0xffffff));
    if (!w->expanded[node])
        SG_TRY(put_elided(w, node));
    if (w->p->n == mark + 1) /* nothing is left out below it */
        SG_TRY(sg_tree_beside_text(w->p->arena, w->d, node, &w->p->marks[mark].beside, w->err));
    if (!w->expanded[node])
        return SG_OK;
    SG_TRY(list_body(w, node));
    for (size_t i = before, j = w->n; i < j; i++) { /* the first one on top of the stack */
        const item swap = w->items[--j];
        w->items[j] = w->items[i];
        w->items[i] = swap;
    }
    for (size_t i = before; i < w->n; i++)
        w->items[i].parent = mark;
    return SG_OK;
}

static sg_status put_marks(drawing *w)
{
    w->n = 0;
    SG_TRY(add_item(w, 0, 0, NULL));
    w->items[0].parent = SIZE_MAX;
    while (w->n > 0) {
        const item top = w->items[--w->n];
        SG_TRY(top.node == SIZE_MAX ? put_terminal(w, &top) : put_node(w, &top));
    }
    return SG_OK;
}

static void measure(sg_tree_mark *m)
{
    m->columns = sg_tree_columns(m->text, &m->lines);
    m->beside_columns = sg_tree_columns(m->beside, &m->beside_lines);
    m->width = (double)m->columns * SG_TREE_ADVANCE * SG_TREE_LETTER_PX + 2 * PADDING;
    m->height = (double)m->lines * SG_TREE_BOX_PX;
}

/* Rows as high as the highest of what stands in them. */
static sg_status place_levels(sg_tree_picture *p, sg_error *err)
{
    for (size_t i = 0; i < p->n; i++)
        p->nlevels = p->marks[i].level + 1 > p->nlevels ? p->marks[i].level + 1 : p->nlevels;
    p->level_top = calloc(p->nlevels, sizeof *p->level_top);
    p->level_bottom = calloc(p->nlevels, sizeof *p->level_bottom);
    if (p->level_top == NULL || p->level_bottom == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t i = 0; i < p->n; i++) {
        const sg_tree_mark *m = p->marks + i;
        p->level_bottom[m->level] = fmax(p->level_bottom[m->level], fmax(m->height, sg_tree_beside_end(m)));
    }
    double y = MARGIN;
    for (size_t k = 0; k < p->nlevels; k++) {
        p->level_top[k] = y;
        y = p->level_bottom[k] += y;
        y += LEVEL_GAP;
    }
    p->height = y - LEVEL_GAP + MARGIN;
    return SG_OK;
}

static sg_status place_marks(sg_tree_picture *p, sg_error *err)
{
    sg_tree_item *items = malloc(p->n * sizeof *items);
    if (items == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t i = 0; i < p->n; i++) {
        sg_tree_mark *m = p->marks + i;
        measure(m);
        const double beside = (double)m->beside_columns * SG_TREE_ADVANCE * SG_TREE_SMALL_PX;
        items[i] = (sg_tree_item){m->parent, m->width / 2, m->width / 2 + (beside > 0 ? SG_TREE_BESIDE_PX + beside : 0), 0};
    }
    sg_status st = sg_tree_layout(items, p->n, GAP, &p->width, err);
    if (st == SG_OK)
        st = place_levels(p, err);
    for (size_t i = 0; st == SG_OK && i < p->n; i++) {
        p->marks[i].x = MARGIN + items[i].x;
        p->marks[i].y = p->level_top[p->marks[i].level] + p->marks[i].height / 2;
    }
    p->width += 2 * MARGIN;
    free(items);
    return st;
}

sg_status sg_tree_picture_make(const sg_derivation *d, const sg_tree_picture_opts *opts, sg_tree_picture *out, sg_error *err)
{
    if (d->nnodes == 0)
        return SG_FAIL(err, SG_EINVAL, "a derivation without a node");
    sg_tree_picture p = {.arena = sg_arena_create()};
    drawing w = {.d = d, .opts = opts, .p = &p, .expanded = calloc(d->nnodes, sizeof *w.expanded), .err = err};
    sg_status st = p.arena != NULL && w.expanded != NULL ? SG_OK : SG_FAIL_NOMEM(err);
    if (st == SG_OK)
        st = choose_expanded(&w);
    if (st == SG_OK)
        st = put_marks(&w);
    if (st == SG_OK)
        st = place_marks(&p, err);
    free(w.expanded);
    free(w.items);
    sg_stored_children_clear(&w.children);
    if (st == SG_OK)
        *out = p;
    else
        sg_tree_picture_clear(&p);
    return st;
}
