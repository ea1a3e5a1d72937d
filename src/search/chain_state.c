/* SPDX-License-Identifier: GPL-3.0-or-later */
/* chain_state.c - where a chain stands: the derivation, what each node adds to the posterior, which nodes can be picked. All of it
 * is carried from change to change. Sums are differences of what the changed nodes add; they are made anew from the nodes
 * now and then, at changes that are counted, so that a result depends on nothing but the chain. */
#include "core/array.h"
#include "core/random.h"
#include "derivation/derivation_priv.h"
#include "search/chain_priv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CHANGES_BETWEEN_SUMS = 4096 };

/* exp of depth times this: beyond it weights stay the same, and stay finite. */
static const double MOST_LOG_WEIGHT = 300;

sg_status sg_chain_state_create(const sg_grammar *g, const sg_score *score, sg_chain_state **out, sg_error *err)
{
    sg_chain_state *s = calloc(1, sizeof *s);
    if (s == NULL)
        return SG_FAIL_NOMEM(err);
    sg_derivation_init(&s->d, g);
    const sg_status st = sg_score_state_create(score, &s->score, err);
    if (st != SG_OK)
        sg_chain_state_free(s);
    else
        *out = s;
    return st;
}

void sg_chain_state_free(sg_chain_state *s)
{
    if (s == NULL)
        return;
    sg_derivation_clear(&s->d);
    sg_score_state_free(s->score);
    free(s->terms.log_rules);
    free(s->terms.log_density);
    for (int k = 0; k < SG_LISTS; k++) {
        free(s->lists[k].nodes);
        free(s->lists[k].sums);
    }
    free(s);
}

/* ---- terms ---- */

static sg_status room_for_terms(sg_node_terms *t, size_t n, sg_error *err)
{
    return SG_GROW(t->log_rules, t->rules_capacity, n) && SG_GROW(t->log_density, t->density_capacity, n)
               ? SG_OK
               : SG_FAIL_NOMEM(err);
}

static sg_status log_rule(const sg_chain *c, const sg_derivation *d, const sg_node *n, double *log_p, sg_error *err)
{
    *log_p = 0;
    if (n->depth > sg_grammar_depth_limit(d->grammar))
        return SG_OK;
    if (sg_grammar_symbol(d->grammar, n->symbol)->constant_weights) {
        *log_p = c->log_probability[n->rule];
        return SG_OK;
    }
    double p;
    SG_TRY(sg_node_probability(d, n, &p, err));
    *log_p = log(p);
    return SG_OK;
}

static sg_status find_terms(const sg_chain *c, const sg_derivation *d, sg_node_terms *t, double *log_rules,
                            double *log_density, sg_error *err)
{
    SG_TRY(room_for_terms(t, d->nnodes, err));
    *log_rules = *log_density = 0;
    for (size_t i = 0; i < d->nnodes; i++) {
        SG_TRY(log_rule(c, d, d->nodes + i, t->log_rules + i, err));
        SG_TRY(sg_node_log_density(d, d->nodes + i, t->log_density + i, err));
        *log_rules += t->log_rules[i];
        *log_density += t->log_density[i];
    }
    return SG_OK;
}

sg_status sg_chain_sum(sg_chain *c, sg_candidate *s, sg_error *err)
{
    if (!s->summed)
        SG_TRY(find_terms(c, &s->d, &s->terms, &s->log_rules, &s->log_density, err));
    s->summed = true;
    return SG_OK;
}

void sg_chain_sum_subtree(const sg_chain *c, size_t node, double *log_rules, double *log_density)
{
    const sg_node_terms *t = &c->at->terms;
    *log_rules = *log_density = 0;
    for (size_t i = node; i < node + c->at->d.nodes[node].length; i++) {
        *log_rules += t->log_rules[i];
        *log_density += t->log_density[i];
    }
}

/* ---- lists ---- */

static double weight(const sg_chain *c, uint32_t depth)
{
    if (c->log_base == 0)
        return 1;
    return exp(fmax(-MOST_LOG_WEIGHT, fmin(-c->log_base * depth, MOST_LOG_WEIGHT)));
}

static unsigned lists_of(const sg_chain *c, const sg_node *n)
{
    return c->of_symbol[n->symbol] | (n->rule < SG_RULE_EMPTY ? c->of_rule[n->rule] : 0u);
}

static sg_status room_in_lists(const sg_chain *c, sg_chain_state *s, size_t nodes, sg_error *err)
{
    for (int k = 0; k < SG_LISTS; k++) {
        sg_node_list *l = s->lists + k;
        if (!SG_GROW(l->nodes, l->capacity, nodes) || (c->log_base != 0 && !SG_GROW(l->sums, l->sums_capacity, nodes)))
            return SG_FAIL_NOMEM(err);
    }
    return SG_OK;
}

static void add_to_list(const sg_chain *c, sg_node_list *l, size_t node, uint32_t depth)
{
    l->nodes[l->n++] = (uint32_t)node;
    l->total += weight(c, depth);
    if (c->log_base != 0)
        l->sums[l->n - 1] = l->total;
}

/* Room has been made. */
static void fill_lists(const sg_chain *c, sg_chain_state *s)
{
    for (int k = 0; k < SG_LISTS; k++) {
        s->lists[k].n = 0;
        s->lists[k].total = 0;
    }
    for (size_t i = 0; i < s->d.nnodes; i++) {
        const sg_node *n = s->d.nodes + i;
        const unsigned lists = lists_of(c, n);
        for (int k = 0; lists != 0 && k < SG_LISTS; k++)
            if (lists & 1u << k)
                add_to_list(c, s->lists + k, i, n->depth);
    }
}

static size_t first_above(const double *sums, size_t n, double x)
{
    size_t low = 0, high = n - 1;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (sums[middle] > x)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

size_t sg_chain_pick(const sg_chain *c, sg_list_kind kind)
{
    const sg_node_list *l = c->at->lists + kind;
    if (l->n == 0)
        return SIZE_MAX;
    const double x = sg_random_uniform(c->rng) * l->total;
    if (c->log_base != 0)
        return l->nodes[first_above(l->sums, l->n, x)];
    const size_t i = (size_t)x;
    return l->nodes[i < l->n ? i : l->n - 1];
}

/* Weight of jumps in nodes [first, end). */
static double jump_weight(const sg_chain *c, const sg_derivation *d, size_t first, size_t end)
{
    double sum = 0;
    for (size_t i = first; i < end; i++)
        if (c->of_symbol[d->nodes[i].symbol] & 1u << SG_LIST_JUMPS)
            sum += weight(c, d->nodes[i].depth);
    return sum;
}

double sg_chain_log_select(const sg_chain *c, size_t node, const sg_derivation *slice)
{
    const sg_derivation *d = &c->at->d;
    const size_t end = node + d->nodes[node].length;
    const double before = c->at->lists[SG_LIST_JUMPS].total, more = jump_weight(c, slice, 0, slice->nnodes);
    double others; /* where weights differ, a difference might cancel */
    if (c->log_base == 0)
        others = before - jump_weight(c, d, node, end);
    else
        others = jump_weight(c, d, 0, node) + jump_weight(c, d, end, d->nnodes);
    return log(before / (others + more));
}

/* ---- changes ---- */

bool sg_chain_same_rules(const sg_derivation *d, size_t node, const sg_derivation *slice)
{
    if (d->nodes[node].length != slice->nnodes)
        return false;
    for (size_t i = 0; i < slice->nnodes; i++)
        if (d->nodes[node + i].rule != slice->nodes[i].rule)
            return false;
    return true;
}

sg_status sg_chain_settle(sg_chain *c, sg_error *err)
{
    sg_chain_state *s = c->at;
    SG_TRY(find_terms(c, &s->d, &s->terms, &s->posterior.log_rules, &s->posterior.log_density, err));
    SG_TRY(room_in_lists(c, s, s->d.nnodes, err));
    fill_lists(c, s);
    s->changes = 0;
    return SG_OK;
}

/* The best is copied when the chain is about to leave it for something worse. */
static sg_status keep_best(sg_chain *c, const sg_posterior *next, sg_error *err)
{
    if (!c->at_best || sg_posterior_log(next) >= sg_posterior_log(&c->best_posterior))
        return SG_OK;
    SG_TRY(sg_derivation_copy(&c->best, &c->at->d, err));
    c->at_best = false;
    return SG_OK;
}

static void arrive(sg_chain *c, const sg_posterior *p)
{
    c->at->posterior = *p;
    c->at->changes++;
    if (sg_posterior_log(p) > sg_posterior_log(&c->best_posterior)) {
        c->best_posterior = *p;
        c->at_best = true;
    }
}

static void splice_array(double *a, size_t total, size_t at, size_t old, const double *slice, size_t n)
{
    if (n != old)
        memmove(a + at + n, a + at + old, (total - at - old) * sizeof *a);
    memcpy(a + at, slice, n * sizeof *a);
}

/* Everything that can fail, so that a commit is followed by all of the change. */
static sg_status prepare(sg_chain *c, const sg_change *change, const sg_posterior *next, sg_error *err)
{
    sg_chain_state *s = c->at;
    SG_TRY(sg_derivation_make_room(&s->d, change, err));
    if (change->slice != NULL) {
        const size_t nodes = s->d.nnodes + change->slice->nnodes;
        SG_TRY(room_for_terms(&s->terms, nodes, err));
        SG_TRY(room_in_lists(c, s, nodes, err));
    }
    return keep_best(c, next, err);
}

/* Sums are made anew after so many changes, with what the nodes add. */
static sg_status renew(sg_chain *c, sg_error *err)
{
    sg_chain_state *s = c->at;
    if (s->changes < CHANGES_BETWEEN_SUMS)
        return SG_OK;
    s->changes = 0;
    return find_terms(c, &s->d, &s->terms, &s->posterior.log_rules, &s->posterior.log_density, err);
}

sg_status sg_chain_accept(sg_chain *c, const sg_change *change, sg_candidate *s, const sg_score_value *score,
                          sg_error *err)
{
    sg_chain_state *at = c->at;
    const size_t node = change->node, old = at->d.nodes[node].length, total = at->d.nnodes;
    double log_rules, log_density;
    sg_chain_sum_subtree(c, node, &log_rules, &log_density);
    sg_status st = sg_chain_sum(c, s, err);
    const sg_posterior next = {*score, at->posterior.log_rules - log_rules + s->log_rules,
                               at->posterior.log_density - log_density + s->log_density};
    if (st == SG_OK)
        st = prepare(c, change, &next, err);
    if (st != SG_OK) {
        sg_score_rollback(at->score);
        return st;
    }
    const bool same = sg_chain_same_rules(&at->d, node, &s->d);
    sg_score_commit(at->score);
    SG_TRY(sg_derivation_apply(&at->d, change, err));
    splice_array(at->terms.log_rules, total, node, old, s->terms.log_rules, s->d.nnodes);
    splice_array(at->terms.log_density, total, node, old, s->terms.log_density, s->d.nnodes);
    if (!same)
        fill_lists(c, at);
    arrive(c, &next);
    return renew(c, err);
}

sg_status sg_chain_accept_draws(sg_chain *c, const sg_change *change, double d_log_density, const sg_score_value *score,
                                sg_error *err)
{
    sg_chain_state *at = c->at;
    double *log_density = at->terms.log_density + change->node, after = *log_density + d_log_density;
    sg_status st = SG_OK;
    if (isnan(d_log_density))
        st = sg_node_draws_log_density(&at->d, change->node, &c->draws, &after, err);
    const sg_posterior next = {*score, at->posterior.log_rules, at->posterior.log_density - *log_density + after};
    if (st == SG_OK)
        st = prepare(c, change, &next, err);
    if (st != SG_OK) {
        sg_score_rollback(at->score);
        return st;
    }
    sg_score_commit(at->score);
    SG_TRY(sg_derivation_apply(&at->d, change, err));
    *log_density = after;
    arrive(c, &next);
    return renew(c, err);
}
