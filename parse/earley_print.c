/* SPDX-License-Identifier: GPL-3.0-or-later */
/* earley_print.c - derivations as JSON and as text. */
#include "config.h"

#include "core/array.h"
#include "parse/earley_print.h"

#include <jansson.h>
#include <stdlib.h>

/* A node that is open while its subtree is written. */
typedef struct {
    size_t end;
    json_t *children; /* borrowed */
} open_node;

typedef struct {
    open_node *open;
    size_t nopen, capacity;
} path;

static void close_finished(path *p, size_t at)
{
    while (p->nopen > 0 && p->open[p->nopen - 1].end <= at)
        p->nopen--;
}

/* The stored child that place i of the right-hand side shows: with tied siblings, the first one of its symbol. */
static const sg_parse_node *child_at(const sg_split_rule *r, const sg_parse_node *node, uint32_t i)
{
    uint32_t stored = 0, place = 0;
    for (const sg_parse_node *c = node + 1; c < node + node->length; c += c->length)
        stored++;
    if (stored == r->n) {
        place = i;
    } else {
        for (uint32_t k = 0; r->rhs[k] != r->rhs[i]; k++) {
            bool fresh = true;
            for (uint32_t j = 0; j < k && fresh; j++)
                fresh = r->rhs[j] != r->rhs[k];
            place += fresh;
        }
    }
    const sg_parse_node *c = node + 1;
    for (; place > 0; place--)
        c += c->length;
    return c;
}

static json_t *sizes_of(const sg_split_rule *r, const sg_parse_node *node, const sg_lattice *l)
{
    const bool along_x = r->op == SG_SPLIT_X;
    const uint32_t *px = along_x ? l->x : l->y;
    uint32_t at = along_x ? node->x0 : node->y0;
    const double whole = (double)px[along_x ? node->x1 : node->y1] - px[at];
    json_t *sizes = json_array();
    for (uint32_t i = 0; i < r->n; i++) {
        const sg_parse_node *c = child_at(r, node, i);
        const uint32_t next = at + (along_x ? c->x1 - c->x0 : c->y1 - c->y0);
        if (json_array_append_new(sizes, json_real(((double)px[next] - px[at]) / whole)) != 0) {
            json_decref(sizes);
            return NULL;
        }
        at = next;
    }
    return sizes;
}

/* One node without its children; *children is the list that they go to. */
static json_t *node_to_json(const sg_split_form *form, const sg_parse_node *node, const sg_lattice *l,
                            json_t **children)
{
    const sg_split_rule *r = &form->rules[node->rule];
    json_t *o =
        json_pack("{s:I, s:s, s:[I,I,I,I]}", "rule", (json_int_t)node->rule, "symbol", form->symbol_names[r->lhs],
                  "rect", (json_int_t)node->x0, (json_int_t)node->y0, (json_int_t)node->x1, (json_int_t)node->y1);
    *children = NULL;
    if (o == NULL || r->op == SG_SPLIT_LEXICAL) {
        if (o != NULL)
            json_object_set_new(o, "label", json_string(form->terminal_names[r->rhs[0]]));
        return o;
    }
    *children = json_array();
    if (json_object_set_new(o, "sizes", sizes_of(r, node, l)) != 0 ||
        json_object_set_new(o, "children", *children) != 0) {
        json_decref(o);
        return NULL;
    }
    return o;
}

struct json_t *sg_parse_tree_json(const sg_split_form *form, const sg_parse_node *nodes, size_t n,
                                  const sg_lattice *lattice)
{
    path p = {0};
    json_t *root = NULL;
    bool ok = true;
    for (size_t i = 0; i < n && ok; i++) {
        json_t *children, *o = node_to_json(form, &nodes[i], lattice, &children);
        close_finished(&p, i);
        ok = o != NULL && SG_GROW(p.open, p.capacity, p.nopen + 1);
        if (!ok)
            json_decref(o);
        else if (p.nopen == 0)
            root = o;
        else
            ok = json_array_append_new(p.open[p.nopen - 1].children, o) == 0;
        if (ok && children != NULL)
            p.open[p.nopen++] = (open_node){i + nodes[i].length, children};
    }
    free(p.open);
    if (!ok) {
        json_decref(root);
        root = NULL;
    }
    return root;
}

static void print_node(const sg_split_form *form, const sg_parse_node *node, size_t depth, FILE *out)
{
    static const char *const ops[] = {"split-x", "split-y"};
    const sg_split_rule *r = &form->rules[node->rule];
    fprintf(out, "%*s%s -> ", (int)(2 * depth), "", form->symbol_names[r->lhs]);
    if (r->op == SG_SPLIT_LEXICAL)
        fprintf(out, "label %s", form->terminal_names[r->rhs[0]]);
    else
        fputs(ops[r->op], out);
    fprintf(out, "  columns %u-%u rows %u-%u\n", node->x0 + 1, node->x1, node->y0 + 1, node->y1);
}

void sg_parse_tree_print(const sg_split_form *form, const sg_parse_node *nodes, size_t n, FILE *out)
{
    size_t depth = 0, capacity = 0, *ends = NULL;
    for (size_t i = 0; i < n && SG_GROW(ends, capacity, depth + 1); i++) {
        while (depth > 0 && ends[depth - 1] <= i)
            depth--;
        print_node(form, &nodes[i], depth, out);
        ends[depth++] = i + nodes[i].length;
    }
    free(ends);
}
