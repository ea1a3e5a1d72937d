/* SPDX-License-Identifier: GPL-3.0-or-later */
/* derivation_json.c - written while it is walked, with a stack of its own: jansson prints the strings and numbers, but a
 * tree of its values would be written by recursion, and derivations may be deeper than a C stack. */
#include "scene/derivation_json.h"

#include "scene/json_node.h"
#include "scene/placer.h"

/* A closing bracket on the stack of places. */
#define CLOSE SIZE_MAX

static sg_status print_rect(sg_rect r, FILE *out, sg_error *err)
{
    fputs(",\"rect\":", out);
    return sg_json_numbers((const double[]){r.x0, r.y0, r.x1, r.y1}, 4, out, err);
}

static sg_status print_label(const sg_derivation *d, sg_sym label, FILE *out, sg_error *err)
{
    fputs("\"label\":", out);
    return sg_json_name(sg_grammar_symbol(d->grammar, label)->name, out, err);
}

static sg_status print_node(const sg_derivation *d, size_t node, sg_rect r, const sg_placer *p, sg_sym label, FILE *out,
                            sg_error *err)
{
    SG_TRY(sg_json_node_begin(d, node, out, err));
    SG_TRY(print_rect(r, out, err));
    fputs(",\"sizes\":", out);
    SG_TRY(sg_json_numbers(p->sizes, p->nsizes, out, err));
    if (label != SG_NONE) {
        fputs(",", out);
        SG_TRY(print_label(d, label, out, err));
    }
    fprintf(out, ",\"node\":%zu", node); /* children do not stand in the order of nodes, and tied ones come again */
    return sg_json_node_end(d, node, out, err);
}

/* A node: its own fields are written, its closing bracket and then its children stand on the stack. */
static sg_status open_node(sg_placer *p, const sg_derivation *d, size_t node, sg_rect r, FILE *out, sg_error *err)
{
    const size_t first = p->n;
    SG_TRY(sg_placer_place(p, d, node, r, err));
    const bool lexical = p->n == first + 1 && p->items[first].label != SG_NONE && p->nsizes == 0;
    SG_TRY(print_node(d, node, r, p, lexical ? p->items[first].label : SG_NONE, out, err));
    if (lexical) {
        p->n = first;
        fputs("]}", out);
        return SG_OK;
    }
    sg_placer_reverse(p, first);
    return sg_placer_insert(p, first, (sg_place){r, CLOSE, SG_NONE}, err);
}

/* A label that stands in a split without a symbol of its own. */
static sg_status print_lone_label(const sg_derivation *d, const sg_place *place, FILE *out, sg_error *err)
{
    fputs("{", out);
    SG_TRY(print_label(d, place->label, out, err));
    SG_TRY(print_rect(place->rect, out, err));
    fputs("}", out);
    return SG_OK;
}

static sg_status walk(sg_placer *p, const sg_derivation *d, sg_rect scope, FILE *out, sg_error *err)
{
    SG_TRY(open_node(p, d, 0, scope, out, err));
    bool first = true;
    while (p->n > 0) {
        const sg_place top = p->items[--p->n];
        if (top.label == SG_NONE && top.node == CLOSE) {
            fputs("]}", out);
            first = false;
            continue;
        }
        if (!first)
            fputs(",", out);
        const size_t before = p->n;
        if (top.label != SG_NONE)
            SG_TRY(print_lone_label(d, &top, out, err));
        else
            SG_TRY(open_node(p, d, top.node, top.rect, out, err));
        first = p->n > before; /* its children follow */
    }
    return SG_OK;
}

sg_status sg_derivation_write_json(const sg_derivation *d, double width, double height, FILE *out, sg_error *err)
{
    if (d->nnodes == 0)
        return SG_FAIL(err, SG_ENUMERIC, "an empty derivation");
    sg_placer p = {0};
    const sg_status st = walk(&p, d, (sg_rect){0, 0, width, height}, out, err);
    sg_placer_clear(&p);
    if (st != SG_OK)
        return st;
    return ferror(out) ? SG_FAIL(err, SG_EIO, "writing a derivation failed") : SG_OK;
}
