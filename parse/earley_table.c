/* SPDX-License-Identifier: GPL-3.0-or-later */
/* earley_table.c - a split grammar compiled for parsing: what can be derived at all, least sizes, first labels, left
 * corners, lexical rules, probabilities. */
#include "config.h"

#include "parse/earley_priv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static sg_status check_rule(const sg_split_form *form, size_t r, sg_error *err)
{
    const sg_split_rule *rule = &form->rules[r];
    const bool lexical = rule->op == SG_SPLIT_LEXICAL;
    if (rule->lhs >= form->nsymbols || rule->n == 0 || (lexical && rule->n != 1) || rule->op > SG_SPLIT_LEXICAL)
        return SG_FAIL(err, SG_EINVAL, "rule %zu of the split form is malformed", r);
    for (uint32_t i = 0; i < rule->n; i++)
        if (rule->rhs[i] >= (lexical ? form->nterminals : form->nsymbols))
            return SG_FAIL(err, SG_EINVAL, "rule %zu of the split form names a symbol that does not exist", r);
    return SG_OK;
}

static sg_status check_form(const sg_split_form *form, sg_error *err)
{
    if (form->nsymbols == 0 || form->axiom >= form->nsymbols)
        return SG_FAIL(err, SG_EINVAL, "the split form has no axiom");
    if (form->nsymbols >= SG_EARLEY_NEVER || form->nrules >= SG_EARLEY_NEVER || form->nterminals >= UINT16_MAX)
        return SG_FAIL(err, SG_EINVAL, "the grammar has too many symbols or rules");
    for (size_t r = 0; r < form->nrules; r++)
        SG_TRY(check_rule(form, r, err));
    return SG_OK;
}

static sg_status copy_rules(sg_parse_table *t, const sg_split_form *form, sg_error *err)
{
    t->rules = SG_NEW_ARRAY(t->arena, sg_table_rule, form->nrules + 1);
    t->rule_start = SG_NEW_ARRAY(t->arena, uint32_t, form->nsymbols + 2);
    t->rule_order = SG_NEW_ARRAY(t->arena, uint32_t, form->nrules + 1);
    if (t->rules == NULL || t->rule_start == NULL || t->rule_order == NULL)
        return SG_FAIL_NOMEM(err);
    size_t total = 0;
    for (size_t r = 0; r < form->nrules; r++)
        total += form->rules[r].n;
    uint32_t *rhs = SG_NEW_ARRAY(t->arena, uint32_t, total + 1);
    if (rhs == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t r = 0; r < form->nrules; r++) {
        const sg_split_rule *from = &form->rules[r];
        t->rules[r] = (sg_table_rule){.lhs = from->lhs,
                                      .n = from->n,
                                      .op = from->op,
                                      .rhs = rhs,
                                      .nchildren = from->op == SG_SPLIT_LEXICAL ? 0 : from->n};
        memcpy(rhs, from->rhs, from->n * sizeof *rhs);
        rhs += from->n;
        t->rule_start[from->lhs + 2]++;
    }
    for (uint32_t s = 0; s < t->nsymbols; s++)
        t->rule_start[s + 2] += t->rule_start[s + 1];
    for (uint32_t r = 0; r < t->nrules; r++)
        t->rule_order[t->rule_start[t->rules[r].lhs + 1]++] = r;
    return SG_OK;
}

static uint32_t saturate(uint64_t v)
{
    return v < SG_EARLEY_NEVER ? (uint32_t)v : SG_EARLEY_NEVER;
}

/* Least size of the right-hand side: along a split the sizes add, across it the largest counts. */
static bool shrink(sg_parse_table *t, const sg_table_rule *r)
{
    uint32_t size[2] = {1, 1};
    if (r->op != SG_SPLIT_LEXICAL) {
        uint64_t along = 0;
        uint32_t across = 0;
        for (uint32_t i = 0; i < r->n; i++) {
            along += t->min_size[r->op][r->rhs[i]];
            const uint32_t other = t->min_size[1 - r->op][r->rhs[i]];
            across = other > across ? other : across;
        }
        size[r->op] = saturate(along);
        size[1 - r->op] = across;
    }
    bool changed = false;
    for (int axis = 0; axis < 2; axis++)
        if (size[SG_SPLIT_X] < SG_EARLEY_NEVER && size[SG_SPLIT_Y] < SG_EARLEY_NEVER &&
            size[axis] < t->min_size[axis][r->lhs]) {
            t->min_size[axis][r->lhs] = size[axis];
            changed = true;
        }
    return changed;
}

static sg_status find_sizes(sg_parse_table *t, sg_error *err)
{
    for (int axis = 0; axis < 2; axis++) {
        t->min_size[axis] = sg_arena_alloc(t->arena, t->nsymbols * sizeof(uint32_t));
        if (t->min_size[axis] == NULL)
            return SG_FAIL_NOMEM(err);
        for (uint32_t s = 0; s < t->nsymbols; s++)
            t->min_size[axis][s] = SG_EARLEY_NEVER;
    }
    for (bool changed = true; changed;) {
        changed = false;
        for (uint32_t r = t->nrules; r-- > 0;)
            changed |= shrink(t, &t->rules[r]);
    }
    return SG_OK;
}

static bool productive(const sg_parse_table *t, const sg_table_rule *r)
{
    if (r->op == SG_SPLIT_LEXICAL)
        return true;
    for (uint32_t i = 0; i < r->n; i++)
        if (t->min_size[0][r->rhs[i]] == SG_EARLEY_NEVER)
            return false;
    return true;
}

/* Rules that some derivation from the axiom uses; the symbols of the others get a size that nothing has. */
static sg_status find_used(sg_parse_table *t, sg_error *err)
{
    const sg_mark mark = sg_arena_mark(t->arena);
    bool *reached = SG_NEW_ARRAY(t->arena, bool, t->nsymbols);
    uint32_t *stack = SG_NEW_ARRAY(t->arena, uint32_t, t->nsymbols);
    if (reached == NULL || stack == NULL)
        return SG_FAIL_NOMEM(err);
    size_t n = 0;
    if (t->min_size[0][t->axiom] < SG_EARLEY_NEVER) {
        reached[t->axiom] = true;
        stack[n++] = t->axiom;
    }
    while (n > 0) {
        const uint32_t s = stack[--n];
        for (uint32_t i = t->rule_start[s]; i < t->rule_start[s + 1]; i++) {
            sg_table_rule *r = &t->rules[t->rule_order[i]];
            r->used = productive(t, r);
            for (uint32_t j = 0; r->used && r->op != SG_SPLIT_LEXICAL && j < r->n; j++)
                if (!reached[r->rhs[j]]) {
                    reached[r->rhs[j]] = true;
                    stack[n++] = r->rhs[j];
                }
        }
    }
    for (uint32_t s = 0; s < t->nsymbols; s++)
        if (!reached[s])
            t->min_size[0][s] = t->min_size[1][s] = SG_EARLEY_NEVER;
    sg_arena_rewind(t->arena, mark);
    return SG_OK;
}

static bool add_first(sg_parse_table *t, const sg_table_rule *r)
{
    uint64_t *to = &t->first[r->lhs * t->words];
    if (r->op == SG_SPLIT_LEXICAL) {
        const uint64_t bit = UINT64_C(1) << (r->rhs[0] % 64);
        const bool had = (to[r->rhs[0] / 64] & bit) != 0;
        to[r->rhs[0] / 64] |= bit;
        return !had;
    }
    const uint64_t *from = &t->first[r->rhs[0] * t->words];
    bool changed = false;
    for (size_t w = 0; w < t->words; w++) {
        changed |= (from[w] & ~to[w]) != 0;
        to[w] |= from[w];
    }
    return changed;
}

static sg_status find_first_labels(sg_parse_table *t, sg_error *err)
{
    t->words = t->nterminals / 64 + 1;
    t->first = SG_NEW_ARRAY(t->arena, uint64_t, t->nsymbols * t->words);
    if (t->first == NULL)
        return SG_FAIL_NOMEM(err);
    for (bool changed = true; changed;) {
        changed = false;
        for (uint32_t r = t->nrules; r-- > 0;)
            if (t->rules[r].used)
                changed |= add_first(t, &t->rules[r]);
    }
    return SG_OK;
}

/* Distinct first symbols of the right-hand sides of each symbol. */
static sg_status find_left_corners(sg_parse_table *t, sg_error *err)
{
    t->corner_start = SG_NEW_ARRAY(t->arena, uint32_t, t->nsymbols + 1);
    t->corners = SG_NEW_ARRAY(t->arena, uint32_t, t->nrules + 1);
    t->only_leaves = SG_NEW_ARRAY(t->arena, bool, t->nsymbols);
    if (t->corner_start == NULL || t->corners == NULL || t->only_leaves == NULL)
        return SG_FAIL_NOMEM(err);
    const sg_mark mark = sg_arena_mark(t->arena);
    uint32_t *seen = SG_NEW_ARRAY(t->arena, uint32_t, t->nsymbols); /* symbol + 1 of the last one that has it */
    if (seen == NULL)
        return SG_FAIL_NOMEM(err);
    uint32_t n = 0;
    for (uint32_t s = 0; s < t->nsymbols; s++) {
        t->only_leaves[s] = t->min_size[0][s] < SG_EARLEY_NEVER;
        for (uint32_t i = t->rule_start[s]; i < t->rule_start[s + 1]; i++) {
            const sg_table_rule *r = &t->rules[t->rule_order[i]];
            if (!r->used || r->op == SG_SPLIT_LEXICAL)
                continue;
            t->only_leaves[s] = false;
            if (seen[r->rhs[0]] == s + 1)
                continue;
            seen[r->rhs[0]] = s + 1;
            t->corners[n++] = r->rhs[0];
        }
        t->corner_start[s + 1] = n;
    }
    sg_arena_rewind(t->arena, mark);
    return SG_OK;
}

static int compare_leaves(const void *a, const void *b)
{
    const sg_leaf *x = a, *y = b;
    if (x->symbol != y->symbol)
        return x->symbol < y->symbol ? -1 : 1;
    return (x->terminal > y->terminal) - (x->terminal < y->terminal);
}

static int compare_units(const void *a, const void *b)
{
    const sg_unit *x = a, *y = b;
    if (x->lhs != y->lhs)
        return x->lhs < y->lhs ? -1 : 1;
    return (x->rhs > y->rhs) - (x->rhs < y->rhs);
}

static sg_status collect_leaves(sg_parse_table *t, sg_error *err)
{
    t->leaves = SG_NEW_ARRAY(t->arena, sg_leaf, t->nrules + 1);
    t->leaf_start = SG_NEW_ARRAY(t->arena, uint32_t, t->nsymbols + 1);
    if (t->leaves == NULL || t->leaf_start == NULL)
        return SG_FAIL_NOMEM(err);
    size_t n = 0, kept = 0;
    for (uint32_t r = 0; r < t->nrules; r++)
        if (t->rules[r].used && t->rules[r].op == SG_SPLIT_LEXICAL)
            t->leaves[n++] = (sg_leaf){.symbol = t->rules[r].lhs, .terminal = t->rules[r].rhs[0]};
    qsort(t->leaves, n, sizeof *t->leaves, compare_leaves);
    for (size_t i = 0; i < n; i++)
        if (kept == 0 || compare_leaves(&t->leaves[kept - 1], &t->leaves[i]) != 0)
            t->leaves[kept++] = t->leaves[i];
    t->nleaves = kept;
    for (size_t i = 0; i < kept; i++)
        t->leaf_start[t->leaves[i].symbol + 1]++;
    for (uint32_t s = 0; s < t->nsymbols; s++)
        t->leaf_start[s + 1] += t->leaf_start[s];
    for (uint32_t r = 0; r < t->nrules; r++)
        if (t->rules[r].used && t->rules[r].op == SG_SPLIT_LEXICAL)
            t->rules[r].leaf = (uint32_t)(sg_table_leaf(t, t->rules[r].lhs, t->rules[r].rhs[0]) - t->leaves);
    return SG_OK;
}

static sg_status collect_units(sg_parse_table *t, sg_error *err)
{
    sg_unit_graph *g = &t->units;
    g->units = SG_NEW_ARRAY(t->arena, sg_unit, t->nrules + 1);
    g->start = SG_NEW_ARRAY(t->arena, uint32_t, t->nsymbols + 1);
    if (g->units == NULL || g->start == NULL)
        return SG_FAIL_NOMEM(err);
    size_t n = 0, kept = 0;
    for (uint32_t r = 0; r < t->nrules; r++)
        if (t->rules[r].used && t->rules[r].op != SG_SPLIT_LEXICAL && t->rules[r].n == 1)
            g->units[n++] = (sg_unit){.lhs = t->rules[r].lhs, .rhs = t->rules[r].rhs[0]};
    qsort(g->units, n, sizeof *g->units, compare_units);
    for (size_t i = 0; i < n; i++)
        if (kept == 0 || compare_units(&g->units[kept - 1], &g->units[i]) != 0)
            g->units[kept++] = g->units[i];
    g->nunits = kept;
    for (size_t i = 0; i < kept; i++)
        g->start[g->units[i].lhs + 1]++;
    for (uint32_t s = 0; s < t->nsymbols; s++)
        g->start[s + 1] += g->start[s];
    for (uint32_t r = 0; r < t->nrules; r++) {
        sg_table_rule *rule = &t->rules[r];
        if (!rule->used || rule->op == SG_SPLIT_LEXICAL || rule->n != 1)
            continue;
        const sg_unit key = {.lhs = rule->lhs, .rhs = rule->rhs[0]};
        rule->leaf = (uint32_t)((sg_unit *)bsearch(&key, g->units, kept, sizeof key, compare_units) - g->units);
    }
    return sg_unit_graph_build(t, err);
}

static sg_status compile(sg_parse_table *t, const sg_split_form *form, sg_error *err)
{
    t->nsymbols = (uint32_t)form->nsymbols;
    t->nterminals = (uint32_t)form->nterminals;
    t->nrules = (uint32_t)form->nrules;
    t->axiom = form->axiom;
    SG_TRY(copy_rules(t, form, err));
    SG_TRY(find_sizes(t, err));
    SG_TRY(find_used(t, err));
    if (form->tied)
        SG_TRY(sg_tied_find(t, form, err));
    SG_TRY(find_first_labels(t, err));
    SG_TRY(find_left_corners(t, err));
    SG_TRY(collect_leaves(t, err));
    SG_TRY(collect_units(t, err));
    return sg_prefix_build(t, err);
}

static sg_status set_rule_probabilities(sg_parse_table *t, const double *p, size_t stride, sg_error *err)
{
    for (uint32_t r = 0; r < t->nrules; r++) {
        const double v = *(const double *)(const void *)((const char *)p + r * stride);
        if (!(v >= 0 && v <= 1 + 1e-9))
            return SG_FAIL(err, SG_EINVAL, "rule %u has the probability %g", r, v);
    }
    for (uint32_t r = 0; r < t->nrules; r++) {
        t->rules[r].p = *(const double *)(const void *)((const char *)p + r * stride);
        t->rules[r].log_p = fmin(log(t->rules[r].p), 0); /* bounds rely on it */
    }
    return SG_OK;
}

static void set_leaves(sg_parse_table *t)
{
    for (size_t i = 0; i < t->nleaves; i++) {
        t->leaves[i].p = sg_ext_zero();
        t->leaves[i].best_rule = SG_NONE;
    }
    for (uint32_t r = 0; r < t->nrules; r++) {
        const sg_table_rule *rule = &t->rules[r];
        if (!rule->used || rule->op != SG_SPLIT_LEXICAL)
            continue;
        sg_leaf *leaf = &t->leaves[rule->leaf];
        leaf->p = sg_ext_add(leaf->p, sg_ext_of(rule->p));
        if (leaf->best_rule == SG_NONE || rule->log_p > leaf->log_p) {
            leaf->best_rule = r;
            leaf->log_p = rule->log_p;
        }
    }
}

static void set_units(sg_parse_table *t)
{
    sg_unit_graph *g = &t->units;
    for (size_t i = 0; i < g->nunits; i++) {
        g->units[i].sum = 0;
        g->units[i].best_rule = SG_NONE;
    }
    for (uint32_t r = 0; r < t->nrules; r++) {
        const sg_table_rule *rule = &t->rules[r];
        if (!rule->used || rule->op == SG_SPLIT_LEXICAL || rule->n != 1)
            continue;
        sg_unit *u = &g->units[rule->leaf];
        u->sum += rule->p;
        if (u->best_rule == SG_NONE || rule->log_p > u->log_p) {
            u->best_rule = r;
            u->log_p = rule->log_p;
        }
    }
    for (size_t i = 0; i < g->nunits; i++)
        g->units[i].p = sg_ext_of(g->units[i].sum);
}

static sg_status set_probabilities(sg_parse_table *t, const double *p, size_t stride, sg_error *err)
{
    SG_TRY(set_rule_probabilities(t, p, stride, err));
    set_leaves(t);
    set_units(t);
    for (size_t i = 0; i < t->nends; i++) {
        t->ends[i].p = sg_ext_of(t->rules[t->ends[i].rule].p);
        t->ends[i].log_p = t->rules[t->ends[i].rule].log_p;
    }
    return sg_unit_graph_close(t, err);
}

sg_status sg_parse_table_set_probabilities(sg_parse_table *t, const double *p, sg_error *err)
{
    return set_probabilities(t, p, sizeof *p, err);
}

sg_status sg_parse_table_create(const sg_split_form *form, sg_leaf_mode mode, sg_parse_table **out, sg_error *err)
{
    SG_TRY(check_form(form, err));
    sg_arena *arena = sg_arena_create();
    sg_parse_table *t = arena != NULL ? SG_NEW(arena, sg_parse_table) : NULL;
    if (t == NULL) {
        sg_arena_free(arena);
        return SG_FAIL_NOMEM(err);
    }
    t->arena = arena;
    t->mode = mode;
    sg_status st = compile(t, form, err);
    if (st == SG_OK && form->nrules > 0)
        st = set_probabilities(t, &form->rules[0].probability, sizeof form->rules[0], err);
    if (st != SG_OK) {
        sg_parse_table_free(t);
        return st;
    }
    *out = t;
    return SG_OK;
}

void sg_parse_table_free(sg_parse_table *t)
{
    if (t != NULL)
        sg_arena_free(t->arena);
}
