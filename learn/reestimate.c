/* SPDX-License-Identifier: GPL-3.0-or-later */
/* reestimate.c - parsing what may have changed, and what follows from the counts. */
#include "config.h"

#include "learn/reestimate.h"

#include "learn/merge.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What the coarsest grammar tells about the lattices. */
typedef struct {
    bool valid;
    size_t nsymbols;
    bool *fixed;     /* [lattices]: one derivation, whatever is merged */
    bool *can_use;   /* [lattices][nsymbols]: the symbol may stand in a derivation */
    bool *lexical;   /* [nsymbols]: has a lexical rule */
    bool *was_alive; /* [nsymbols] */
    uint32_t *seen;  /* [nsymbols]: version at the last parse */
} outlook;

struct sg_reestimator {
    const sg_corpus *corpus;
    sg_reestimate_opts opts;
    sg_chart *chart;
    outlook outlook;
    size_t nrules;   /* of the grammar that the counts are about; 0: none yet */
    double *counts;  /* [lattices][nrules] */
    sg_arena *arena; /* of one call */
};

static void clear_outlook(outlook *o)
{
    free(o->fixed);
    free(o->can_use);
    free(o->lexical);
    free(o->was_alive);
    free(o->seen);
    memset(o, 0, sizeof *o);
}

sg_status sg_reestimator_create(const sg_corpus *corpus, const sg_reestimate_opts *opts, sg_reestimator **out,
                                sg_error *err)
{
    sg_reestimator *e = calloc(1, sizeof *e);
    if (e == NULL)
        return SG_FAIL_NOMEM(err);
    e->corpus = corpus;
    e->opts = *opts;
    e->arena = sg_arena_create();
    const sg_status st = e->arena != NULL ? sg_chart_create(&e->chart, err) : SG_FAIL_NOMEM(err);
    if (st != SG_OK) {
        sg_reestimator_free(e);
        return st;
    }
    *out = e;
    return SG_OK;
}

void sg_reestimator_forget(sg_reestimator *e)
{
    clear_outlook(&e->outlook);
    free(e->counts);
    e->counts = NULL;
    e->nrules = 0;
}

void sg_reestimator_free(sg_reestimator *e)
{
    if (e == NULL)
        return;
    sg_reestimator_forget(e);
    sg_chart_free(e->chart);
    sg_arena_free(e->arena);
    free(e);
}

/* ---- the coarsest grammar ---- */

static bool has_lexical_rule(const sg_rules *r, uint32_t symbol)
{
    for (uint32_t i = r->symbols[symbol].first_own; i != SG_NONE; i = r->rules[i].next_own)
        if (r->rules[i].alive && r->rules[i].op == SG_SPLIT_LEXICAL)
            return true;
    return false;
}

/* Merge every symbol without lexical rules into the first one of its labels. */
static sg_status coarsen(sg_rules *c, const bool *lexical, sg_error *err)
{
    for (uint32_t a = 0; a < c->nsymbols; a++) {
        if (lexical[a])
            continue;
        for (uint32_t b = a + 1; b < c->nsymbols; b++)
            if (!lexical[b] && sg_rules_compatible(c, a, b))
                SG_TRY(sg_merge_apply(c, a, b, err));
    }
    return SG_OK;
}

static uint32_t heir(const sg_rules *r, uint32_t rule)
{
    while (rule != SG_NONE && !r->rules[rule].alive)
        rule = r->rules[rule].united;
    return rule;
}

/* How many living rules of r each rule of the coarse grammar stands for. @return false when one of r's fell away as
 * X -> X there: a derivation could pass through it unseen */
static bool count_originals(const sg_rules *r, const sg_rules *coarse, uint32_t *originals)
{
    for (uint32_t i = 0; i < r->nrules; i++) {
        if (!r->rules[i].alive)
            continue;
        const uint32_t h = heir(coarse, i);
        if (h == SG_NONE)
            return false;
        originals[h]++;
    }
    return true;
}

static sg_status set_uniform(sg_parse_table *t, const sg_split_form *f, sg_arena *arena, sg_error *err)
{
    double *p = SG_NEW_ARRAY(arena, double, f->nrules + 1);
    if (p == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t i = 0, end; i < f->nrules; i = end) {
        for (end = i; end < f->nrules && f->rules[end].lhs == f->rules[i].lhs;)
            end++;
        for (size_t k = i; k < end; k++)
            p[k] = 1 / (double)(end - i);
    }
    return sg_parse_table_set_probabilities(t, p, err);
}

typedef struct {
    const sg_rules *rules, *coarse;
    const uint32_t *originals; /* by rule of the coarse grammar */
    const uint32_t *rule_of;   /* rule of the form to rule of the coarse grammar */
    const sg_split_form *form;
    const sg_parse_table *table;
    double *expected; /* [rules of the form], scratch */
    bool *in_forest;  /* [rules of the coarse grammar], scratch */
} coarse_view;

static sg_status look_at_lattice(sg_reestimator *e, const coarse_view *v, size_t lattice, sg_error *err)
{
    outlook *o = &e->outlook;
    double inside, viterbi;
    const sg_cells *cells = &e->corpus->cells[lattice];
    SG_TRY(sg_earley_viterbi(v->table, cells, e->chart, &viterbi, err));
    SG_TRY(sg_earley_inside(v->table, cells, e->chart, &inside, err));
    memset(v->expected, 0, v->form->nrules * sizeof *v->expected);
    memset(v->in_forest, 0, v->coarse->nrules * sizeof *v->in_forest);
    SG_TRY(sg_earley_expected_counts(v->table, e->chart, v->expected, err));
    bool single = fabs(inside - viterbi) <= 1e-9 * (1 + fabs(viterbi));
    for (size_t k = 0; k < v->form->nrules; k++)
        if (v->expected[k] > 0) {
            v->in_forest[v->rule_of[k]] = true;
            single = single && v->originals[v->rule_of[k]] == 1;
        }
    o->fixed[lattice] = single;
    for (uint32_t i = 0; i < v->rules->nrules; i++)
        if (v->rules->rules[i].alive && v->in_forest[heir(v->coarse, i)])
            o->can_use[lattice * o->nsymbols + v->rules->rules[i].lhs] = true;
    return SG_OK;
}

static sg_status look_at_all(sg_reestimator *e, const sg_rules *r, const sg_rules *coarse, const uint32_t *originals,
                             sg_error *err)
{
    sg_split_form form;
    uint32_t *rule_of;
    sg_parse_table *table = NULL;
    SG_TRY(sg_rules_form(coarse, false, e->arena, &form, &rule_of, NULL, err));
    coarse_view v = {.rules = r,
                     .coarse = coarse,
                     .originals = originals,
                     .rule_of = rule_of,
                     .form = &form,
                     .expected = SG_NEW_ARRAY(e->arena, double, form.nrules + 1),
                     .in_forest = SG_NEW_ARRAY(e->arena, bool, coarse->nrules + 1)};
    if (v.expected == NULL || v.in_forest == NULL)
        return SG_FAIL_NOMEM(err);
    sg_status st = sg_parse_table_create(&form, SG_CELL_MODE, &table, err);
    v.table = table;
    if (st == SG_OK)
        st = set_uniform(table, &form, e->arena, err);
    for (size_t i = 0; i < e->corpus->n && st == SG_OK; i++)
        st = look_at_lattice(e, &v, i, err);
    sg_parse_table_free(table);
    return st;
}

static sg_status start_outlook(sg_reestimator *e, const sg_rules *r, sg_error *err)
{
    outlook *o = &e->outlook;
    clear_outlook(o);
    o->nsymbols = r->nsymbols;
    o->fixed = calloc(e->corpus->n, sizeof *o->fixed);
    o->can_use = calloc(e->corpus->n * r->nsymbols, sizeof *o->can_use);
    o->lexical = calloc(r->nsymbols, sizeof *o->lexical);
    o->was_alive = calloc(r->nsymbols, sizeof *o->was_alive);
    o->seen = calloc(r->nsymbols, sizeof *o->seen);
    if (o->fixed == NULL || o->can_use == NULL || o->lexical == NULL || o->was_alive == NULL || o->seen == NULL)
        return SG_FAIL_NOMEM(err);
    for (uint32_t s = 0; s < r->nsymbols; s++) {
        o->was_alive[s] = r->symbols[s].alive;
        o->lexical[s] = o->was_alive[s] && has_lexical_rule(r, s);
        o->seen[s] = r->symbols[s].version;
    }
    return SG_OK;
}

/* Without an outlook everything is parsed each time, which is always right. */
static sg_status make_outlook(sg_reestimator *e, const sg_rules *r, sg_error *err)
{
    SG_TRY(start_outlook(e, r, err));
    sg_rules coarse = {0};
    uint32_t *originals = SG_NEW_ARRAY(e->arena, uint32_t, r->nrules + 1);
    sg_status st = originals != NULL ? sg_rules_copy(&coarse, r, err) : SG_FAIL_NOMEM(err);
    if (st == SG_OK)
        st = coarsen(&coarse, e->outlook.lexical, err);
    if (st == SG_OK && count_originals(r, &coarse, originals)) {
        st = look_at_all(e, r, &coarse, originals, err);
        e->outlook.valid = st == SG_OK;
        if (st == SG_ENUMERIC) /* the coarse unit rules have no closure: no outlook, then */
            st = SG_OK;
    }
    sg_rules_clear(&coarse);
    return st;
}

/* Follow the merges since; false when one of them joined a symbol with lexical rules to another. */
static bool follow_merges(sg_reestimator *e, const sg_rules *r)
{
    outlook *o = &e->outlook;
    for (uint32_t s = 0; s < o->nsymbols; s++) {
        if (!o->was_alive[s] || r->symbols[s].alive || r->symbols[s].merged == SG_NONE)
            continue;
        uint32_t to = s;
        while (!r->symbols[to].alive && r->symbols[to].merged != SG_NONE)
            to = r->symbols[to].merged;
        if (o->lexical[s] || o->lexical[to])
            return false;
        for (size_t i = 0; i < e->corpus->n; i++)
            o->can_use[i * o->nsymbols + to] |= o->can_use[i * o->nsymbols + s];
        o->was_alive[s] = false;
    }
    return true;
}

static bool may_have_changed(const sg_reestimator *e, const sg_rules *r, size_t lattice)
{
    const outlook *o = &e->outlook;
    if (o->fixed[lattice])
        return false;
    for (uint32_t s = 0; s < o->nsymbols; s++)
        if (r->symbols[s].alive && r->symbols[s].version != o->seen[s] && o->can_use[lattice * o->nsymbols + s])
            return true;
    return false;
}

/* ---- parsing ---- */

static sg_status no_parse(sg_error *err, size_t lattice)
{
    return SG_FAIL(err, SG_ENOPARSE, "lattice %zu is outside the language of the grammar", lattice + 1);
}

/* Counts of one lattice under the present probabilities, by rule of the form. */
static sg_status parse_one(sg_reestimator *e, const sg_parse_table *t, size_t lattice, double *counts, double *log_p,
                           sg_error *err)
{
    const sg_cells *cells = &e->corpus->cells[lattice];
    if (e->opts.expected)
        SG_TRY(sg_earley_inside(t, cells, e->chart, log_p, err));
    else
        SG_TRY(sg_earley_viterbi(t, cells, e->chart, log_p, err));
    if (!(*log_p > -INFINITY))
        return no_parse(err, lattice);
    return e->opts.expected ? sg_earley_expected_counts(t, e->chart, counts, err)
                            : sg_earley_viterbi_counts(t, e->chart, counts, err);
}

/* Parse one lattice and put the difference to its old counts into delta [rules of r]. */
static sg_status update_one(sg_reestimator *e, const sg_rules *r, const sg_split_form *form, const uint32_t *rule_of,
                            const sg_parse_table *t, size_t lattice, double *delta, double *scratch,
                            sg_reestimate_result *out, sg_error *err)
{
    double *own = e->counts + lattice * e->nrules, log_p;
    memset(scratch, 0, form->nrules * sizeof *scratch);
    SG_TRY(parse_one(e, t, lattice, scratch, &log_p, err));
    out->parsed++;
    out->log_parsed += log_p;
    for (uint32_t i = 0; i < e->nrules; i++) {
        const uint32_t h = own[i] != 0 ? heir(r, i) : SG_NONE;
        if (h != SG_NONE)
            delta[h] -= own[i];
        own[i] = 0;
    }
    for (size_t k = 0; k < form->nrules; k++) {
        own[rule_of[k]] += scratch[k];
        delta[rule_of[k]] += scratch[k];
    }
    return SG_OK;
}

static sg_status parse_lattices(sg_reestimator *e, const sg_rules *r, const bool *wanted, double *delta,
                                sg_reestimate_result *out, sg_error *err)
{
    sg_split_form form;
    uint32_t *rule_of;
    sg_parse_table *table;
    SG_TRY(sg_rules_form(r, false, e->arena, &form, &rule_of, NULL, err));
    double *scratch = SG_NEW_ARRAY(e->arena, double, form.nrules + 1);
    if (scratch == NULL)
        return SG_FAIL_NOMEM(err);
    SG_TRY(sg_parse_table_create(&form, SG_CELL_MODE, &table, err));
    sg_status st = SG_OK;
    for (size_t i = 0; i < e->corpus->n && st == SG_OK; i++)
        if (wanted[i])
            st = update_one(e, r, &form, rule_of, table, i, delta, scratch, out, err);
    sg_parse_table_free(table);
    return st;
}

/* ---- what follows from the counts ---- */

/* A count below this is that of a rule which is not used (expected counts are never exactly zero). */
#define LEAST_COUNT 1e-9

static sg_status set_counts(sg_rules *r, const double *delta, sg_reestimate_result *out, sg_error *err)
{
    r->changes.nrules = r->changes.nsymbols = 0;
    for (uint32_t i = 0; i < r->nrules; i++) {
        const sg_learn_rule *x = &r->rules[i];
        if (!x->alive || (delta[i] == 0 && x->count >= LEAST_COUNT))
            continue;
        const double count = x->count + delta[i];
        out->changed |= fabs(delta[i]) > 1e-9 * (1 + count);
        if (!sg_changes_add_symbol(&r->changes, x->lhs))
            return SG_FAIL_NOMEM(err);
        sg_rules_set_count(r, i, count > 0 ? count : 0);
        if (count >= LEAST_COUNT)
            continue;
        if (!sg_changes_add_rule(&r->changes, i))
            return SG_FAIL_NOMEM(err);
        sg_rules_remove_rule(r, i, SG_NONE);
        out->removed = true;
    }
    for (size_t k = 0; k < r->changes.nsymbols; k++) {
        const uint32_t s = r->changes.symbols[k];
        if (r->symbols[s].alive && r->symbols[s].nrules == 0)
            sg_rules_remove_symbol(r, s);
        sg_rules_refresh_symbol(r, s);
    }
    return out->removed ? sg_rules_find_labels(r, err) : SG_OK;
}

/* The first call: counts of the grammar are replaced, so the difference is to them. */
static sg_status begin_counts(sg_reestimator *e, const sg_rules *r, double *delta, sg_error *err)
{
    e->counts = calloc(e->corpus->n * r->nrules + 1, sizeof *e->counts);
    if (e->counts == NULL)
        return SG_FAIL_NOMEM(err);
    e->nrules = r->nrules;
    for (uint32_t i = 0; i < r->nrules; i++)
        delta[i] = r->rules[i].alive ? -r->rules[i].count : 0;
    return SG_OK;
}

static void note_versions(sg_reestimator *e, const sg_rules *r)
{
    for (uint32_t s = 0; s < e->outlook.nsymbols; s++)
        e->outlook.seen[s] = r->symbols[s].version;
}

sg_status sg_reestimate(sg_reestimator *e, sg_rules *r, sg_reestimate_result *out, sg_error *err)
{
    *out = (sg_reestimate_result){0};
    sg_arena_reset(e->arena);
    if (e->nrules != r->nrules) /* another grammar, or rules were added */
        sg_reestimator_forget(e);
    const bool first = e->nrules == 0, filter = !e->opts.expected && !e->opts.parse_all;
    double *delta = SG_NEW_ARRAY(e->arena, double, r->nrules + 1);
    bool *wanted = SG_NEW_ARRAY(e->arena, bool, e->corpus->n + 1);
    if (delta == NULL || wanted == NULL)
        return SG_FAIL_NOMEM(err);
    bool any = false;
    if (!first && filter && e->outlook.valid)
        e->outlook.valid = follow_merges(e, r);
    for (size_t i = 0; i < e->corpus->n; i++)
        any |= wanted[i] = first || !filter || !e->outlook.valid || may_have_changed(e, r, i);
    if (first)
        SG_TRY(begin_counts(e, r, delta, err));
    if (filter && e->outlook.valid)
        note_versions(e, r); /* of the probabilities that are used now: what the counts change counts as new */
    if (any)
        SG_TRY(parse_lattices(e, r, wanted, delta, out, err));
    if (filter && !e->outlook.valid)
        SG_TRY(make_outlook(e, r, err)); /* before the counts are set: rules that go were in it, which is no harm */
    return set_counts(r, delta, out, err);
}

sg_status sg_reestimate_until_stable(sg_reestimator *e, sg_rules *r, size_t rounds, size_t *nparsed, sg_error *err)
{
    for (size_t i = 0; i < rounds; i++) {
        sg_reestimate_result result;
        SG_TRY(sg_reestimate(e, r, &result, err));
        if (nparsed != NULL)
            *nparsed += result.parsed;
        if (!result.changed && !result.removed)
            break;
    }
    return SG_OK;
}

/* ---- sizes ---- */

/* One row of relative sizes of a node: of its children along the axis of its rule. */
static double *row_of(const sg_lattice *l, const sg_split_rule *rule, const sg_parse_node *node, sg_arena *arena)
{
    double *row = SG_NEW_ARRAY(arena, double, rule->n);
    const sg_parse_node *child = node + 1;
    if (row == NULL)
        return NULL;
    const bool x = rule->op == SG_SPLIT_X;
    const uint32_t *b = x ? l->x : l->y;
    const double whole = x ? (double)(b[node->x1] - b[node->x0]) : (double)(b[node->y1] - b[node->y0]);
    for (uint32_t i = 0; i < rule->n; i++, child += child->length)
        row[i] = (double)(b[x ? child->x1 : child->y1] - b[x ? child->x0 : child->y0]) / whole;
    return row;
}

static sg_status add_tree_sizes(sg_rules *r, const sg_lattice *l, const sg_split_form *form, const uint32_t *rule_of,
                                const sg_parse_node *nodes, size_t n, double *counts, sg_error *err)
{
    for (size_t i = 0; i < n; i++) {
        const sg_split_rule *rule = &form->rules[nodes[i].rule];
        const uint32_t id = rule_of[nodes[i].rule];
        counts[id]++;
        if (rule->op == SG_SPLIT_LEXICAL)
            continue;
        double *row = row_of(l, rule, &nodes[i], r->arena);
        if (row == NULL || !sg_rules_add_sizes(r, id, row, 1))
            return SG_FAIL_NOMEM(err);
    }
    return SG_OK;
}

static sg_status size_one(sg_reestimator *e, sg_rules *r, const sg_split_form *form, const uint32_t *rule_of,
                          const sg_parse_table *t, size_t lattice, double *counts, sg_error *err)
{
    double log_p;
    sg_parse_node *nodes = NULL;
    size_t n = 0;
    SG_TRY(sg_earley_viterbi(t, &e->corpus->cells[lattice], e->chart, &log_p, err));
    if (!(log_p > -INFINITY))
        return no_parse(err, lattice);
    SG_TRY(sg_earley_viterbi_tree(t, e->chart, &nodes, &n, err));
    const sg_status st = add_tree_sizes(r, &e->corpus->lattices[lattice], form, rule_of, nodes, n, counts, err);
    free(nodes);
    return st;
}

sg_status sg_reestimate_sizes(sg_reestimator *e, sg_rules *r, sg_error *err)
{
    sg_arena_reset(e->arena);
    sg_split_form form;
    uint32_t *rule_of;
    sg_parse_table *table;
    sg_reestimate_result result = {0};
    SG_TRY(sg_rules_form(r, false, e->arena, &form, &rule_of, NULL, err));
    double *counts = SG_NEW_ARRAY(e->arena, double, r->nrules + 1);
    if (counts == NULL)
        return SG_FAIL_NOMEM(err);
    SG_TRY(sg_parse_table_create(&form, SG_CELL_MODE, &table, err));
    sg_rules_drop_sizes(r);
    sg_status st = SG_OK;
    for (size_t i = 0; i < e->corpus->n && st == SG_OK; i++)
        st = size_one(e, r, &form, rule_of, table, i, counts, err);
    sg_parse_table_free(table);
    if (st != SG_OK)
        return st;
    for (uint32_t i = 0; i < r->nrules; i++)
        counts[i] -= r->rules[i].alive ? r->rules[i].count : 0;
    return set_counts(r, counts, &result, err);
}
