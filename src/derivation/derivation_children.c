/* SPDX-License-Identifier: GPL-3.0-or-later */
/* derivation_children.c - which children a rule asks for, their arguments, its draws; and where in the tree something went wrong. */
#include "core/array.h"
#include "derivation/derivation_priv.h"

#include <math.h>
#include <stdarg.h>
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

sg_status sg_derivation_eval_args(const sg_grammar *g, const sg_op *op, const double *frame, double depth, double *args,
                                  sg_error *err)
{
    for (uint32_t i = 0; i < op->nargs; i++) {
        args[i] = sg_grammar_eval(g, op->args[i], frame, depth);
        if (isnan(args[i]))
            return SG_FAIL(err, SG_ENUMERIC, "argument %lu of %.60s is not a number", i + 1UL,
                           sg_grammar_symbol(g, op->symbol)->name);
    }
    return SG_OK;
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

/* Appends to text, as much as there is room for. */
static void add(char *text, size_t size, size_t *used, const char *format, ...) __attribute__((format(printf, 4, 5)));

static void add(char *text, size_t size, size_t *used, const char *format, ...)
{
    if (*used >= size)
        return;
    va_list ap;
    va_start(ap, format);
    *used += (size_t)vsnprintf(text + *used, size - *used, format, ap);
    va_end(ap);
}

/* "A(1, 2)"; of many arguments the first few. */
static void add_node(const sg_derivation *d, size_t node, char *text, size_t size, size_t *used)
{
    enum { MANY = 4 };
    const sg_node *n = d->nodes + node;
    const sg_symbol *s = sg_grammar_symbol(d->grammar, n->symbol);
    add(text, size, used, "%.60s", s->name);
    for (uint32_t i = 0; i < s->nparams && i < MANY; i++)
        add(text, size, used, "%s%g", i == 0 ? "(" : ", ", d->values[n->values + i]);
    if (s->nparams > 0)
        add(text, size, used, s->nparams > MANY ? ", ...)" : ")");
}

/* Symbols from the root down to node: of a long path the first and the last few. */
void sg_derivation_path(const sg_derivation *d, size_t node, char *text, size_t size)
{
    enum { HEAD = 3, TAIL = 5 };
    const size_t levels = d->nodes[node].depth - d->nodes[0].depth + 1;
    size_t used = 0;
    text[0] = '\0';
    for (size_t level = 0; level < levels && used < size; level++) {
        if (levels > HEAD + TAIL && level == HEAD) {
            level = levels - TAIL;
            add(text, size, &used, " > (%zu more)", levels - HEAD - TAIL);
        }
        size_t at = node;
        for (size_t up = levels - 1; up > level; up--)
            at -= d->nodes[at].parent;
        add(text, size, &used, "%s", level > 0 ? " > " : "");
        add_node(d, at, text, size, &used);
    }
}

/* "FILE:LINE" of a node's rule, or of its symbol; "FILE" where there are no lines. */
static void print_place(const sg_derivation *d, size_t node, char *text, size_t size)
{
    const sg_node *n = d->nodes + node;
    const sg_rule *r = sg_node_rule(d, n);
    const sg_symbol *s = sg_grammar_symbol(d->grammar, n->symbol);
    const bool of_rule = r != NULL && r->line > 0;
    const unsigned line = (unsigned)(of_rule ? r->line : s->line);
    const char *file = of_rule ? r->file : s->file;
    file = file != NULL ? file : sg_grammar_source(d->grammar);
    if (line > 0)
        snprintf(text, size, "%.200s:%u", file, line);
    else
        snprintf(text, size, "%.200s", file);
}

sg_status sg_derivation_fail_at(const sg_derivation *d, size_t node, sg_status code, sg_error *err)
{
    if (err == NULL || code == SG_ENOMEM)
        return code;
    const sg_error inner = *err;
    char path[480], place[220];
    sg_derivation_path(d, node, path, sizeof path);
    print_place(d, node, place, sizeof place);
    return sg_fail(err, code, "%s: error: deriving %s: %.300s", place, path, inner.msg);
}
