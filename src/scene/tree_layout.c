/* SPDX-License-Identifier: GPL-3.0-or-later */
/* tree_layout.c - tidy trees in linear time. Names are those of the paper where it has them. */
#include "scene/tree_layout.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

#define NONE SIZE_MAX

typedef struct {
    size_t first, last, next, previous; /* children and siblings */
    size_t number;                      /* among the siblings */
    size_t thread, ancestor;
    double prelim, modifier, change, shift;
} node;

typedef struct {
    sg_tree_item *items;
    node *nodes;
    size_t n;
    double gap;
} layout;

static void add_child(layout *l, size_t parent, size_t child)
{
    node *p = l->nodes + parent, *c = l->nodes + child;
    c->previous = p->last;
    c->number = p->last != NONE ? l->nodes[p->last].number + 1 : 0;
    if (p->last != NONE)
        l->nodes[p->last].next = child;
    else
        p->first = child;
    p->last = child;
}

/* In pre-order the parent of a node is the node before it, or one above that: what is on the path to the root. */
static sg_status link_nodes(layout *l, sg_error *err)
{
    for (size_t v = 0; v < l->n; v++)
        l->nodes[v] = (node){NONE, NONE, NONE, NONE, 0, NONE, v, 0, 0, 0, 0};
    for (size_t v = 1; v < l->n; v++) {
        const size_t parent = l->items[v].parent;
        size_t up = v - 1;
        while (up != parent && up != 0 && up != NONE)
            up = l->items[up].parent;
        if (up != parent)
            return SG_FAIL(err, SG_EINVAL, "node %zu of a tree does not stand in pre-order", v);
        add_child(l, parent, v);
    }
    return SG_OK;
}

/* The next node down a contour: a child, or where the subtree ends the thread to what stands below its neighbours. */
static size_t next_left(const layout *l, size_t v)
{
    return l->nodes[v].first != NONE ? l->nodes[v].first : l->nodes[v].thread;
}

static size_t next_right(const layout *l, size_t v)
{
    return l->nodes[v].last != NONE ? l->nodes[v].last : l->nodes[v].thread;
}

/* Least distance of two neighbours. */
static double distance(const layout *l, size_t a, size_t b)
{
    return l->items[a].right + l->gap + l->items[b].left;
}

/* Shift the subtree of b, and spread the shift over the siblings between a and b later. */
static void move_subtree(layout *l, size_t a, size_t b, double shift)
{
    node *na = l->nodes + a, *nb = l->nodes + b;
    const double share = shift / (double)(nb->number - na->number);
    nb->change -= share;
    nb->shift += shift;
    na->change += share;
    nb->prelim += shift;
    nb->modifier += shift;
}

/* The sibling of v that vi stands under, or the default one when vi's ancestor is no sibling. */
static size_t ancestor_of(const layout *l, size_t vi, size_t v, size_t default_ancestor)
{
    const size_t a = l->nodes[vi].ancestor;
    return l->items[a].parent == l->items[v].parent ? a : default_ancestor;
}

/* Put the subtree of v beside those of its left siblings: walk down the right contour of these (in: i, out: o) and its own
 * left one together. */
static size_t apportion(layout *l, size_t v, size_t default_ancestor)
{
    node *const nodes = l->nodes;
    const size_t w = nodes[v].previous;
    if (w == NONE)
        return default_ancestor;
    size_t in_right = v, out_right = v, in_left = w, out_left = nodes[l->items[v].parent].first;
    double s_in_right = nodes[v].modifier, s_out_right = s_in_right, s_in_left = nodes[w].modifier,
           s_out_left = nodes[out_left].modifier;
    while (next_right(l, in_left) != NONE && next_left(l, in_right) != NONE) {
        in_left = next_right(l, in_left);
        in_right = next_left(l, in_right);
        out_left = next_left(l, out_left);
        out_right = next_right(l, out_right);
        nodes[out_right].ancestor = v;
        const double shift = nodes[in_left].prelim + s_in_left - nodes[in_right].prelim - s_in_right +
                             distance(l, in_left, in_right);
        if (shift > 0) {
            move_subtree(l, ancestor_of(l, in_left, v, default_ancestor), v, shift);
            s_in_right += shift;
            s_out_right += shift;
        }
        s_in_left += nodes[in_left].modifier;
        s_in_right += nodes[in_right].modifier;
        s_out_left += nodes[out_left].modifier;
        s_out_right += nodes[out_right].modifier;
    }
    if (next_right(l, in_left) != NONE && next_right(l, out_right) == NONE) {
        nodes[out_right].thread = next_right(l, in_left);
        nodes[out_right].modifier += s_in_left - s_out_right;
    }
    if (next_left(l, in_right) != NONE && next_left(l, out_left) == NONE) {
        nodes[out_left].thread = next_left(l, in_right);
        nodes[out_left].modifier += s_in_right - s_out_left;
        default_ancestor = v;
    }
    return default_ancestor;
}

static void execute_shifts(layout *l, size_t v)
{
    double shift = 0, change = 0;
    for (size_t w = l->nodes[v].last; w != NONE; w = l->nodes[w].previous) {
        node *n = l->nodes + w;
        n->prelim += shift;
        n->modifier += shift;
        change += n->change;
        shift += n->shift + change;
    }
}

/* All subtrees of v's children are laid out, but not beside each other. */
static void place_children(layout *l, size_t v)
{
    node *const nodes = l->nodes;
    size_t default_ancestor = nodes[v].first;
    for (size_t w = nodes[v].first; w != NONE; w = nodes[w].next) {
        const size_t left = nodes[w].previous;
        /* So far w stands above the middle of its children, and they around 0 of their own. */
        const double middle = nodes[w].prelim;
        if (left != NONE) {
            nodes[w].prelim = nodes[left].prelim + distance(l, left, w);
            nodes[w].modifier = nodes[w].first != NONE ? nodes[w].prelim - middle : 0;
        }
        default_ancestor = apportion(l, w, default_ancestor);
    }
    execute_shifts(l, v);
    nodes[v].prelim = (nodes[nodes[v].first].prelim + nodes[nodes[v].last].prelim) / 2;
}

static double place(layout *l)
{
    double left = INFINITY, right = -INFINITY;
    for (size_t v = 0; v < l->n; v++) { /* modifiers add up on the way down; prelim of a parent is no more needed */
        const size_t parent = l->items[v].parent;
        const double above = v > 0 ? l->nodes[parent].shift : 0;
        l->items[v].x = l->nodes[v].prelim + above;
        l->nodes[v].shift = above + (l->nodes[v].first != NONE ? l->nodes[v].modifier : 0);
        left = fmin(left, l->items[v].x - l->items[v].left);
        right = fmax(right, l->items[v].x + l->items[v].right);
    }
    for (size_t v = 0; v < l->n; v++)
        l->items[v].x -= left;
    return right - left;
}

sg_status sg_tree_layout(sg_tree_item *items, size_t n, double gap, double *width, sg_error *err)
{
    if (n == 0 || items[0].parent != NONE)
        return SG_FAIL(err, SG_EINVAL, "a tree has a root");
    layout l = {items, calloc(n, sizeof(node)), n, gap};
    if (l.nodes == NULL)
        return SG_FAIL_NOMEM(err);
    const sg_status st = link_nodes(&l, err);
    if (st == SG_OK) {
        for (size_t v = n; v-- > 0;) /* children before parents */
            if (l.nodes[v].first != NONE)
                place_children(&l, v);
        *width = place(&l);
    }
    free(l.nodes);
    return st;
}
