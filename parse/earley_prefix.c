/* SPDX-License-Identifier: GPL-3.0-or-later */
/* earley_prefix.c - the tries of right-hand sides, one for each split direction, over the rules of all symbols.
 * Rules are sorted by right-hand side, so that each is put in beside its predecessor in time linear in its length. */
#include "config.h"

#include "parse/earley_priv.h"

#include <stdlib.h>
#include <string.h>

typedef struct {
    const sg_table_rule *rule;
    uint32_t index;
} sort_item;

static int compare_rules(const void *a, const void *b)
{
    const sort_item *x = a, *y = b;
    if (x->rule->op != y->rule->op)
        return x->rule->op < y->rule->op ? -1 : 1;
    const uint32_t n = x->rule->n < y->rule->n ? x->rule->n : y->rule->n;
    for (uint32_t i = 0; i < n; i++)
        if (x->rule->rhs[i] != y->rule->rhs[i])
            return x->rule->rhs[i] < y->rule->rhs[i] ? -1 : 1;
    if (x->rule->n != y->rule->n)
        return x->rule->n < y->rule->n ? -1 : 1;
    return (x->index > y->index) - (x->index < y->index);
}

static uint32_t common_beginning(const sg_table_rule *a, const sg_table_rule *b)
{
    uint32_t n = 0;
    if (a->op == b->op)
        while (n < a->n && n < b->n && a->rhs[n] == b->rhs[n])
            n++;
    return n;
}

/* Nodes of the path of the last rule: path[i] is the one of its first i + 1 symbols. */
static void insert(sg_parse_table *t, const sort_item *item, uint32_t shared, uint32_t *path)
{
    const sg_table_rule *r = item->rule;
    for (uint32_t i = shared; i < r->n; i++) {
        const uint32_t id = (uint32_t)t->nnodes++;
        t->nodes[id] = (sg_prefix){.symbol = r->rhs[i], .lhs = r->lhs, .axis = (uint32_t)r->op};
        if (i == 0)
            t->root[r->op][r->rhs[0]] = id;
        else if (i > shared || t->nodes[path[i - 1]].child == 0)
            t->nodes[path[i - 1]].child = id;
        else
            t->nodes[path[i]].sibling = id; /* path[i] is still the last child: rules come sorted */
        path[i] = id;
    }
    for (uint32_t i = 0; i < r->n; i++) {
        sg_prefix *node = &t->nodes[path[i]];
        node->lhs = node->lhs == r->lhs ? r->lhs : SG_NONE;
        node->lhs_mask |= UINT64_C(1) << (r->lhs % 64);
    }
    sg_prefix *last = &t->nodes[path[r->n - 1]];
    if (last->nends++ == 0)
        last->end = (uint32_t)t->nends;
    t->ends[t->nends++] = (sg_prefix_end){.lhs = r->lhs, .rule = item->index};
}

/* Children have larger indices than their parents. */
static void find_rests(sg_parse_table *t)
{
    for (size_t i = t->nnodes; i-- > 1;) {
        sg_prefix *node = &t->nodes[i];
        node->rest = node->nends > 0 ? 0 : SG_EARLEY_NEVER;
        for (uint32_t c = node->child; c != 0; c = t->nodes[c].sibling) {
            const uint64_t rest = (uint64_t)t->nodes[c].rest + t->min_size[node->axis][t->nodes[c].symbol];
            if (rest < node->rest)
                node->rest = (uint32_t)rest;
        }
    }
}

static sg_status allocate(sg_parse_table *t, size_t nnodes, size_t nrules, sg_error *err)
{
    t->nodes = sg_arena_alloc(t->arena, (nnodes + 1) * sizeof *t->nodes);
    t->ends = sg_arena_alloc(t->arena, (nrules + 1) * sizeof *t->ends);
    t->root[0] = SG_NEW_ARRAY(t->arena, uint32_t, t->nsymbols);
    t->root[1] = SG_NEW_ARRAY(t->arena, uint32_t, t->nsymbols);
    return t->nodes != NULL && t->ends != NULL && t->root[0] != NULL && t->root[1] != NULL ? SG_OK : SG_FAIL_NOMEM(err);
}

static void insert_all(sg_parse_table *t, const sort_item *items, size_t n, uint32_t *path)
{
    t->nodes[0] = (sg_prefix){.lhs = SG_NONE};
    t->nnodes = 1;
    for (size_t i = 0; i < n; i++)
        insert(t, &items[i], i > 0 ? common_beginning(items[i - 1].rule, items[i].rule) : 0, path);
    find_rests(t);
}

/* Rules with tied siblings are followed one by one: only the end of each is a node, and no beginning leads to it. */
static void add_tied_nodes(sg_parse_table *t)
{
    for (uint32_t i = 0; i < t->nrules; i++) {
        sg_table_rule *r = &t->rules[i];
        if (!r->used || r->first_of == NULL)
            continue;
        r->tied_node = (uint32_t)t->nnodes++;
        t->nodes[r->tied_node] = (sg_prefix){.symbol = r->lhs,
                                             .lhs = r->lhs,
                                             .end = (uint32_t)t->nends,
                                             .nends = 1,
                                             .lhs_mask = UINT64_C(1) << (r->lhs % 64),
                                             .axis = (uint32_t)r->op};
        t->ends[t->nends++] = (sg_prefix_end){.lhs = r->lhs, .rule = i};
    }
}

sg_status sg_prefix_build(sg_parse_table *t, sg_error *err)
{
    size_t n = 0, total = 0, longest = 0, ntied = 0;
    sort_item *items = malloc((t->nrules + 1) * sizeof *items);
    if (items == NULL)
        return SG_FAIL_NOMEM(err);
    for (uint32_t r = 0; r < t->nrules; r++) {
        const sg_table_rule *rule = &t->rules[r];
        if (!rule->used || rule->op == SG_SPLIT_LEXICAL || rule->n < 2)
            continue;
        if (rule->first_of != NULL) {
            ntied++;
            continue;
        }
        items[n++] = (sort_item){rule, r};
        total += rule->n;
        longest = rule->n > longest ? rule->n : longest;
    }
    qsort(items, n, sizeof *items, compare_rules);
    uint32_t *path = malloc((longest + 1) * sizeof *path);
    sg_status st = path != NULL ? allocate(t, total + ntied, n + ntied, err) : SG_FAIL_NOMEM(err);
    if (st == SG_OK) {
        insert_all(t, items, n, path);
        add_tied_nodes(t);
    }
    free(path);
    free(items);
    return st;
}
