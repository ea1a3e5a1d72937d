/* SPDX-License-Identifier: GPL-3.0-or-later */
/* derivation_json.c - written while it is walked, with a stack of its own: jansson prints the strings and numbers, but a
 * tree of its values would be written by recursion, and derivations may be deeper than a C stack. */
#include "scene/derivation_json.h"

#include "scene/placer.h"

#include <jansson.h>

/* A closing bracket on the stack of places. */
#define CLOSE SIZE_MAX

/* Print a value and let it go. */
static sg_status print_value(json_t *v, FILE *out, sg_error *err)
{
    if (v == NULL)
        return SG_FAIL_NOMEM(err);
    const int failed = json_dumpf(v, out, JSON_ENCODE_ANY | JSON_COMPACT);
    json_decref(v);
    return failed == 0 ? SG_OK : SG_FAIL(err, SG_EIO, "writing a derivation failed");
}

static json_t *numbers(const double *x, size_t n)
{
    json_t *list = json_array();
    for (size_t i = 0; list != NULL && i < n; i++) {
        if (json_array_append_new(list, json_real(x[i])) != 0) {
            json_decref(list);
            return NULL;
        }
    }
    return list;
}

static sg_status print_node(const sg_derivation *d, size_t node, sg_rect r, const sg_placer *p, sg_sym label, FILE *out,
                            sg_error *err)
{
    const sg_node *n = d->nodes + node;
    fprintf(out, "{\"rule\":%u,\"symbol\":", (unsigned)n->rule);
    SG_TRY(print_value(json_string(sg_grammar_symbol(d->grammar, n->symbol)->name), out, err));
    fputs(",\"rect\":", out);
    SG_TRY(print_value(numbers((const double[]){r.x0, r.y0, r.x1, r.y1}, 4), out, err));
    fputs(",\"sizes\":", out);
    SG_TRY(print_value(numbers(p->sizes, p->nsizes), out, err));
    if (label != SG_NONE) {
        fputs(",\"label\":", out);
        SG_TRY(print_value(json_string(sg_grammar_symbol(d->grammar, label)->name), out, err));
    }
    fputs(",\"children\":[", out);
    return SG_OK;
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
static sg_status print_label(const sg_grammar *g, const sg_place *place, FILE *out, sg_error *err)
{
    fputs("{\"label\":", out);
    SG_TRY(print_value(json_string(sg_grammar_symbol(g, place->label)->name), out, err));
    fputs(",\"rect\":", out);
    const sg_rect r = place->rect;
    SG_TRY(print_value(numbers((const double[]){r.x0, r.y0, r.x1, r.y1}, 4), out, err));
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
            SG_TRY(print_label(d->grammar, &top, out, err));
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
