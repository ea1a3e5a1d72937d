/* SPDX-License-Identifier: GPL-3.0-or-later */
/* earley_unit.c - unit rules: an order in which they can be applied, and exact closures of their cycles.
 *
 * Symbols that lead to each other by unit rules are a component (Tarjan, "Depth-first search and linear graph
 * algorithms", SIAM J. Comput. 1, 1972). Between components rules apply once, in order; within one, sums are closed by
 * (1 - U)^-1 and maxima by Floyd and Warshall's recursion: a cycle never improves a maximum. */
#include "config.h"

#include "parse/earley_priv.h"

#include <lapacke.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    uint32_t *number, *low; /* 0: not visited */
    uint32_t *stack, *frame, *edge;
    bool *on_stack;
    uint32_t next, nstack;
} search;

static void close_component(sg_unit_graph *g, search *s, uint32_t root, uint32_t *placed)
{
    sg_unit_component *c = &g->components[g->ncomponents];
    c->first = *placed;
    uint32_t v;
    do {
        v = s->stack[--s->nstack];
        s->on_stack[v] = false;
        g->component[v] = (uint32_t)g->ncomponents;
        g->rank[v] = *placed;
        g->order[(*placed)++] = v;
    } while (v != root);
    c->n = *placed - c->first;
    g->largest = c->n > g->largest ? c->n : g->largest;
    g->ncomponents++;
}

static void enter(search *s, uint32_t v, uint32_t first_edge)
{
    s->number[v] = s->low[v] = ++s->next;
    s->stack[s->nstack++] = v;
    s->on_stack[v] = true;
    s->edge[v] = first_edge;
}

/* Depth first from one symbol, with a stack of our own: chains of unit rules can be long. */
static void visit(sg_unit_graph *g, search *s, uint32_t root, uint32_t *placed)
{
    uint32_t depth = 0;
    s->frame[depth++] = root;
    enter(s, root, g->start[root]);
    while (depth > 0) {
        const uint32_t v = s->frame[depth - 1];
        if (s->edge[v] < g->start[v + 1]) {
            const uint32_t w = g->units[s->edge[v]++].rhs;
            if (s->number[w] == 0) {
                enter(s, w, g->start[w]);
                s->frame[depth++] = w;
            } else if (s->on_stack[w] && s->number[w] < s->low[v]) {
                s->low[v] = s->number[w];
            }
            continue;
        }
        depth--;
        if (depth > 0 && s->low[v] < s->low[s->frame[depth - 1]])
            s->low[s->frame[depth - 1]] = s->low[v];
        if (s->low[v] == s->number[v])
            close_component(g, s, v, placed);
    }
}

static bool has_loop(const sg_unit_graph *g, uint32_t v)
{
    for (uint32_t i = g->start[v]; i < g->start[v + 1]; i++)
        if (g->units[i].rhs == v)
            return true;
    return false;
}

static bool allocate_closures(sg_parse_table *t)
{
    for (size_t i = 0; i < t->units.ncomponents; i++) {
        sg_unit_component *c = &t->units.components[i];
        if (c->n == 1 && !has_loop(&t->units, t->units.order[c->first]))
            continue;
        const size_t nn = (size_t)c->n * c->n;
        c->sum = SG_NEW_ARRAY(t->arena, sg_ext, nn);
        c->best = SG_NEW_ARRAY(t->arena, double, nn);
        c->next = SG_NEW_ARRAY(t->arena, uint32_t, nn);
        if (c->sum == NULL || c->best == NULL || c->next == NULL)
            return false;
    }
    return true;
}

sg_status sg_unit_graph_build(sg_parse_table *t, sg_error *err)
{
    sg_unit_graph *g = &t->units;
    const size_t n = t->nsymbols;
    g->order = SG_NEW_ARRAY(t->arena, uint32_t, n);
    g->rank = SG_NEW_ARRAY(t->arena, uint32_t, n);
    g->component = SG_NEW_ARRAY(t->arena, uint32_t, n);
    g->components = SG_NEW_ARRAY(t->arena, sg_unit_component, n);
    if (g->order == NULL || g->rank == NULL || g->component == NULL || g->components == NULL)
        return SG_FAIL_NOMEM(err);
    if (g->nunits == 0)
        return SG_OK;
    uint32_t *numbers = calloc(5 * n, sizeof *numbers);
    bool *flags = calloc(n, sizeof *flags);
    if (numbers == NULL || flags == NULL) {
        free(numbers);
        free(flags);
        return SG_FAIL_NOMEM(err);
    }
    search s = {numbers, numbers + n, numbers + 2 * n, numbers + 3 * n, numbers + 4 * n, flags, 0, 0};
    uint32_t placed = 0;
    for (uint32_t v = 0; v < n; v++)
        if (s.number[v] == 0)
            visit(g, &s, v, &placed);
    free(numbers);
    free(flags);
    return allocate_closures(t) ? SG_OK : SG_FAIL_NOMEM(err);
}

/* Symbols that derive something with rules of positive probability. A cycle of symbols that do not has value 0,
 * whatever its closure; its rules are left out, or the closure could be singular. */
static void find_live(const sg_parse_table *t, bool *live)
{
    for (bool changed = true; changed;) {
        changed = false;
        for (uint32_t r = t->nrules; r-- > 0;) {
            const sg_table_rule *rule = &t->rules[r];
            bool all = rule->used && rule->p > 0 && !live[rule->lhs];
            for (uint32_t i = 0; all && rule->op != SG_SPLIT_LEXICAL && i < rule->n; i++)
                all = live[rule->rhs[i]];
            live[rule->lhs] |= all;
            changed |= all;
        }
    }
}

static void fill_matrix(const sg_parse_table *t, const sg_unit_component *c, const bool *live, double *u)
{
    const sg_unit_graph *g = &t->units;
    memset(u, 0, (size_t)c->n * c->n * sizeof *u);
    for (uint32_t i = 0; i < c->n; i++) {
        const uint32_t v = g->order[c->first + i];
        for (uint32_t k = g->start[v]; k < g->start[v + 1]; k++) {
            const uint32_t w = g->units[k].rhs;
            if (g->component[w] == g->component[v] && live[w])
                u[(size_t)i * c->n + (g->rank[w] - c->first)] = g->units[k].sum;
        }
    }
}

static double spectral_radius(double *u, uint32_t n, double *re, double *im)
{
    if (LAPACKE_dgeev(LAPACK_ROW_MAJOR, 'N', 'N', (int)n, u, (int)n, re, im, NULL, (int)n, NULL, (int)n) != 0)
        return INFINITY;
    double radius = 0;
    for (uint32_t i = 0; i < n; i++)
        radius = fmax(radius, hypot(re[i], im[i]));
    return radius;
}

/* work: 2 n^2 + 2 n doubles, then n pivots. */
static sg_status close_sum(const sg_parse_table *t, sg_unit_component *c, const bool *live, double *work, int *pivot,
                           sg_error *err)
{
    const uint32_t n = c->n;
    double *u = work, *inverse = u + (size_t)n * n, *re = inverse + (size_t)n * n;
    fill_matrix(t, c, live, u);
    if (!(spectral_radius(u, n, re, re + n) < 1 - 1e-12))
        return SG_FAIL(err, SG_ENUMERIC, "unit rules in a cycle have spectral radius 1 or more: no inside probability");
    fill_matrix(t, c, live, u);
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++) {
            u[(size_t)i * n + j] = (i == j) - u[(size_t)i * n + j];
            inverse[(size_t)i * n + j] = i == j;
        }
    if (LAPACKE_dgesv(LAPACK_ROW_MAJOR, (int)n, (int)n, u, (int)n, pivot, inverse, (int)n) != 0)
        return SG_FAIL(err, SG_ENUMERIC, "the closure of the unit rules is singular");
    for (size_t i = 0; i < (size_t)n * n; i++)
        c->sum[i] = sg_ext_of(fmax(inverse[i], 0)); /* the inverse of an M-matrix is not negative but for rounding */
    return SG_OK;
}

static void close_best(const sg_parse_table *t, sg_unit_component *c)
{
    const sg_unit_graph *g = &t->units;
    const size_t n = c->n;
    for (size_t i = 0; i < n * n; i++) {
        c->best[i] = i % (n + 1) == 0 ? 0 : -INFINITY;
        c->next[i] = SG_NONE;
    }
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t v = g->order[c->first + i];
        for (uint32_t k = g->start[v]; k < g->start[v + 1]; k++) {
            const uint32_t w = g->units[k].rhs;
            const size_t at = i * n + (g->rank[w] - c->first);
            if (g->component[w] == g->component[v] && g->units[k].log_p > c->best[at]) {
                c->best[at] = g->units[k].log_p;
                c->next[at] = k;
            }
        }
    }
    for (size_t k = 0; k < n; k++)
        for (size_t i = 0; i < n; i++)
            for (size_t j = 0; j < n; j++) {
                const double through = c->best[i * n + k] + c->best[k * n + j];
                if (i != k && k != j && through > c->best[i * n + j]) {
                    c->best[i * n + j] = through;
                    c->next[i * n + j] = c->next[i * n + k];
                }
            }
}

sg_status sg_unit_graph_close(sg_parse_table *t, sg_error *err)
{
    const size_t n = t->units.largest;
    if (t->units.nunits == 0)
        return SG_OK;
    bool *live = calloc(t->nsymbols, sizeof *live);
    double *work = malloc((2 * n * n + 2 * n) * sizeof *work);
    int *pivot = malloc(n * sizeof *pivot);
    sg_status st = live != NULL && work != NULL && pivot != NULL ? SG_OK : SG_FAIL_NOMEM(err);
    if (st == SG_OK)
        find_live(t, live);
    for (size_t i = 0; i < t->units.ncomponents && st == SG_OK; i++)
        if (t->units.components[i].sum != NULL) {
            st = close_sum(t, &t->units.components[i], live, work, pivot, err);
            close_best(t, &t->units.components[i]);
        }
    free(live);
    free(work);
    free(pivot);
    return st;
}
