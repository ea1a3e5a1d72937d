/* SPDX-License-Identifier: GPL-3.0-or-later */
/* earley_tree.c - the best derivation, found again from the values of the chart.
 * At each node all rules of its symbol are weighed again, along the strip that the node covers; that is little work
 * beside the parse, which keeps no back-pointers for it. Among equals the first rule wins, then the derivation with
 * fewer unit rules, then the smaller last cut, then the smaller last but one, and so on (where siblings are tied: the
 * smaller first cut, then the second). */
#include "config.h"

#include "core/array.h"
#include "parse/earley_priv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    uint32_t symbol, x, y, x1, y1;
} place;

typedef struct {
    sg_chart *c;
    const sg_parse_table *t;
    place *stack;
    size_t nstack, stack_capacity;
    sg_parse_node *nodes;
    size_t nnodes, nodes_capacity;
    double *best; /* [n][length + 1] of the rule that is being weighed: its first i + 1 children end here */
    size_t best_capacity;
    uint32_t *lengths;
    size_t lengths_capacity;
    uint32_t *bounds, *best_bounds; /* of the children of a rule with tied siblings */
    size_t bounds_capacity, best_bounds_capacity;
} extraction;

typedef struct {
    uint32_t axis, begin, end, across;
} strip;

static strip strip_of(const place *p, uint32_t axis)
{
    return axis == SG_SPLIT_X ? (strip){axis, p->x, p->x1, p->y1} : (strip){axis, p->y, p->y1, p->x1};
}

static bool child_slice(extraction *x, const place *p, const strip *s, uint32_t symbol, uint32_t begin,
                        sg_viterbi_slice *out)
{
    return s->axis == SG_SPLIT_X ? sg_viterbi_slice_of(x->c, symbol, begin, p->y, s->axis, s->across, out)
                                 : sg_viterbi_slice_of(x->c, symbol, p->x, begin, s->axis, s->across, out);
}

/* best[i] from best[i - 1] (i = 0: from the beginning of the strip); *any tells whether an end was reached. */
static bool extend_best(extraction *x, const place *p, const strip *s, const sg_table_rule *r, uint32_t i, bool *any)
{
    const size_t width = s->end - s->begin + 1;
    const double *from = i > 0 ? x->best + (i - 1) * width : NULL;
    double *to = x->best + i * width;
    for (size_t e = 0; e < width; e++)
        to[e] = -INFINITY;
    *any = false;
    const uint32_t low = i + 1 == r->n ? s->end : 0, high = s->end - (r->n - 1 - i);
    for (uint32_t b = s->begin + i; b < s->begin + (i == 0 ? 1 : width - 1); b++) {
        if (from != NULL && from[b - s->begin] == -INFINITY)
            continue;
        sg_viterbi_slice k;
        if (!child_slice(x, p, s, r->rhs[i], b, &k))
            return false;
        for (uint32_t j = 0; j < k.n && k.along[j] <= high; j++) {
            const double v = from != NULL ? from[b - s->begin] + k.log_value[j] : k.log_value[j];
            if (k.along[j] >= low && v > to[k.along[j] - s->begin]) {
                to[k.along[j] - s->begin] = v;
                *any = true;
            }
        }
    }
    return true;
}

/* Place child i and those behind it in all ways, and keep the best: the first of equals, which has the smaller cuts. */
static bool weigh_tied(extraction *x, const place *p, const strip *s, const sg_table_rule *r, uint32_t i, double before,
                       double *best)
{
    if (i == r->n) {
        if (x->bounds[i] == s->end && before > *best) {
            *best = before;
            memcpy(x->best_bounds, x->bounds, (r->n + (size_t)1) * sizeof *x->bounds);
        }
        return true;
    }
    if (r->first_of[i] != i)
        return !sg_tied_repeats(x->c, r, i, x->bounds, p->x, p->y, s->across) ||
               weigh_tied(x, p, s, r, i + 1, before, best);
    sg_viterbi_slice k;
    if (x->bounds[i] >= s->end)
        return true;
    if (!child_slice(x, p, s, r->rhs[i], x->bounds[i], &k))
        return false;
    for (uint32_t j = 0; j < k.n; j++) {
        x->bounds[i + 1] = k.along[j];
        if (!weigh_tied(x, p, s, r, i + 1, before + k.log_value[j], best))
            return false;
    }
    return true;
}

static bool weigh_tied_rule(extraction *x, const place *p, const sg_table_rule *r, double *v)
{
    const strip s = strip_of(p, (uint32_t)r->op);
    if (!SG_GROW(x->bounds, x->bounds_capacity, r->n + (size_t)1) ||
        !SG_GROW(x->best_bounds, x->best_bounds_capacity, r->n + (size_t)1))
        return false;
    *v = -INFINITY;
    x->bounds[0] = s.begin;
    if (!weigh_tied(x, p, &s, r, 0, 0, v))
        return false;
    *v += r->log_p;
    return true;
}

static bool weigh_split(extraction *x, const place *p, const sg_table_rule *r, double *v)
{
    const strip s = strip_of(p, (uint32_t)r->op);
    const size_t width = s.end - s.begin + 1;
    if (r->first_of != NULL)
        return weigh_tied_rule(x, p, r, v);
    *v = -INFINITY;
    if (r->n > width - 1)
        return true;
    if (!SG_GROW(x->best, x->best_capacity, r->n * width))
        return false;
    bool any = true;
    for (uint32_t i = 0; i < r->n && any; i++)
        if (!extend_best(x, p, &s, r, i, &any))
            return false;
    if (any)
        *v = x->best[r->n * width - 1] + r->log_p;
    return true;
}

static bool weigh_unit(extraction *x, const place *p, const sg_table_rule *r, double *v)
{
    const uint32_t *component = x->t->units.component;
    sg_viterbi_slice k;
    *v = -INFINITY;
    if (component[r->rhs[0]] == component[r->lhs])
        return true; /* links of a cycle: chain_start() */
    if (!sg_viterbi_slice_of(x->c, r->rhs[0], p->x, p->y, SG_SPLIT_X, p->y1, &k))
        return false;
    for (uint32_t i = 0; i < k.n; i++)
        if (k.along[i] == p->x1)
            *v = k.log_value[i] + r->log_p;
    return true;
}

/* The best rule of a symbol over a rectangle that is no link of a unit cycle. */
static bool weigh_rules(extraction *x, const place *p, uint32_t *rule, double *value)
{
    *value = -INFINITY;
    *rule = SG_NONE;
    for (uint32_t i = x->t->rule_start[p->symbol]; i < x->t->rule_start[p->symbol + 1]; i++) {
        const sg_table_rule *r = &x->t->rules[x->t->rule_order[i]];
        double v = -INFINITY;
        if (!r->used || r->log_p == -INFINITY)
            continue;
        if (r->op == SG_SPLIT_LEXICAL) {
            if (sg_chart_leaf_fits(x->c, p->x, p->y, p->x1, p->y1))
                v = r->log_p - sg_chart_leaf_cost(x->c, r->rhs[0], p->x, p->y, p->x1, p->y1);
        } else if (!(r->n == 1 ? weigh_unit(x, p, r, &v) : weigh_split(x, p, r, &v))) {
            return false;
        }
        if (v > *value) {
            *value = v;
            *rule = x->t->rule_order[i];
        }
    }
    return true;
}

static bool emit(extraction *x, const place *p, uint32_t rule)
{
    if (!SG_GROW(x->nodes, x->nodes_capacity, x->nnodes + 1))
        return false;
    x->nodes[x->nnodes++] = (sg_parse_node){rule, 0, p->x, p->y, p->x1, p->y1};
    return true;
}

/* Emit the chain of unit rules to the best member of the symbol's cycle, and find that member's rule. */
static bool follow_chain(extraction *x, place *p, const sg_unit_component *c, uint32_t *rule)
{
    const sg_unit_graph *g = &x->t->units;
    const uint32_t i = g->rank[p->symbol] - c->first;
    uint32_t to = i;
    double best = -INFINITY;
    *rule = SG_NONE;
    for (uint32_t k = 0; k < c->n; k++) {
        const uint32_t j = (i + k) % c->n; /* itself first: without a chain */
        const double chain = c->best[(size_t)i * c->n + j];
        place at = *p;
        uint32_t r;
        double v;
        at.symbol = g->order[c->first + j];
        if (chain == -INFINITY)
            continue;
        if (!weigh_rules(x, &at, &r, &v))
            return false;
        if (chain + v > best) {
            best = chain + v;
            to = j;
            *rule = r;
        }
    }
    for (uint32_t at = i; at != to; at = g->rank[p->symbol] - c->first) {
        const sg_unit *u = &g->units[c->next[(size_t)at * c->n + to]];
        if (!emit(x, p, u->best_rule))
            return false;
        p->symbol = u->rhs;
    }
    return true;
}

static bool push(extraction *x, const place *p, uint32_t axis, uint32_t symbol, uint32_t begin, uint32_t end)
{
    if (!SG_GROW(x->stack, x->stack_capacity, x->nstack + 1))
        return false;
    x->stack[x->nstack++] =
        axis == SG_SPLIT_X ? (place){symbol, begin, p->y, end, p->y1} : (place){symbol, p->x, begin, p->x1, end};
    return true;
}

/* The smallest beginning of child i that explains its end. */
static bool find_cut(extraction *x, const place *p, const strip *s, const sg_table_rule *r, uint32_t i, uint32_t end,
                     uint32_t *cut)
{
    const size_t width = s->end - s->begin + 1;
    for (uint32_t b = s->begin + i; b < end; b++) {
        const double from = x->best[(i - 1) * width + (b - s->begin)];
        sg_viterbi_slice k;
        if (from == -INFINITY)
            continue;
        if (!child_slice(x, p, s, r->rhs[i], b, &k))
            return false;
        for (uint32_t j = 0; j < k.n; j++)
            if (k.along[j] == end && from + k.log_value[j] == x->best[i * width + (end - s->begin)]) {
                *cut = b;
                return true;
            }
    }
    return false;
}

/* Push the children of a split, the last one first: the stack turns them round. */
static bool push_children(extraction *x, const place *p, const sg_table_rule *r)
{
    const strip s = strip_of(p, (uint32_t)r->op);
    double v;
    uint32_t end = s.end;
    if (!weigh_split(x, p, r, &v)) /* fills best[] */
        return false;
    for (uint32_t i = r->n; r->first_of != NULL && i-- > 0;)
        if (r->first_of[i] == i && !push(x, p, s.axis, r->rhs[i], x->best_bounds[i], x->best_bounds[i + 1]))
            return false;
    for (uint32_t i = r->n; r->first_of == NULL && i-- > 0;) {
        uint32_t begin = s.begin;
        if ((i > 0 && !find_cut(x, p, &s, r, i, end, &begin)) || !push(x, p, s.axis, r->rhs[i], begin, end))
            return false;
        end = begin;
    }
    return true;
}

static bool expand(extraction *x, place p)
{
    const sg_unit_graph *g = &x->t->units;
    const sg_unit_component *c = g->nunits > 0 ? &g->components[g->component[p.symbol]] : NULL;
    uint32_t rule;
    double v;
    if (c != NULL && c->best != NULL && c->n > 1) {
        if (!follow_chain(x, &p, c, &rule))
            return false;
    } else if (!weigh_rules(x, &p, &rule, &v)) {
        return false;
    }
    if (rule == SG_NONE || !emit(x, &p, rule))
        return false;
    const sg_table_rule *r = &x->t->rules[rule];
    if (r->op == SG_SPLIT_LEXICAL)
        return true;
    return r->n == 1 ? push(x, &p, SG_SPLIT_X, r->rhs[0], p.x, p.x1) : push_children(x, &p, r);
}

/* Lengths from the numbers of children, backwards: the stack holds the lengths of the subtrees to the right. */
static bool find_lengths(extraction *x)
{
    size_t n = 0;
    if (!SG_GROW(x->lengths, x->lengths_capacity, x->nnodes + 1))
        return false;
    for (size_t i = x->nnodes; i-- > 0;) {
        const sg_table_rule *r = &x->t->rules[x->nodes[i].rule];
        uint32_t length = 1;
        for (uint32_t k = 0; k < r->nchildren; k++)
            length += x->lengths[--n];
        x->nodes[i].length = x->lengths[n++] = length;
    }
    return true;
}

static sg_status extract(const sg_parse_table *t, sg_chart *c, extraction *x, sg_error *err)
{
    *x = (extraction){.c = c, .t = t};
    if (c->kind != SG_CHART_VITERBI || c->table != t)
        return SG_FAIL(err, SG_EINVAL, "a best derivation wants the chart of a Viterbi pass with this table");
    if (c->log_value == -INFINITY)
        return SG_FAIL(err, SG_ENOPARSE, "outside the language: there is no derivation");
    const place all = {t->axiom, 0, 0, c->width, c->height};
    bool ok = push(x, &all, SG_SPLIT_X, t->axiom, 0, c->width);
    while (ok && x->nstack > 0)
        ok = expand(x, x->stack[--x->nstack]);
    return ok && find_lengths(x) ? SG_OK : SG_FAIL_NOMEM(err);
}

static void clear(extraction *x)
{
    free(x->stack);
    free(x->nodes);
    free(x->best);
    free(x->lengths);
    free(x->bounds);
    free(x->best_bounds);
}

sg_status sg_earley_viterbi_tree(const sg_parse_table *t, sg_chart *c, sg_parse_node **nodes, size_t *nnodes,
                                 sg_error *err)
{
    extraction x;
    const sg_status st = extract(t, c, &x, err);
    if (st == SG_OK) {
        *nodes = x.nodes;
        *nnodes = x.nnodes;
        x.nodes = NULL;
    }
    clear(&x);
    return st;
}

sg_status sg_earley_viterbi_counts(const sg_parse_table *t, sg_chart *c, double *counts, sg_error *err)
{
    extraction x;
    const sg_status st = extract(t, c, &x, err);
    for (size_t i = 0; st == SG_OK && i < x.nnodes; i++)
        counts[x.nodes[i].rule]++;
    clear(&x);
    return st;
}
