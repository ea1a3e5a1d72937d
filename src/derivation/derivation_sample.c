/* SPDX-License-Identifier: GPL-3.0-or-later */
/* derivation_sample.c - derivations from the prior, whole or node by node.
 * Pending children stand on a stack of their own, so depth is bounded by memory and not by the C stack. The order of
 * draws is part of what a seed means: pre-order, and in each node first the rule (when there is a choice), then its
 * uniforms. */
#include "core/array.h"
#include "core/random.h"
#include "derivation/derivation_move.h"
#include "derivation/derivation_priv.h"

#include <stdlib.h>

static sg_rule_id pick(const double *p, sg_rule_id first, uint32_t n, double u)
{
    uint32_t last = 0; /* rounding may leave u above the sum: then the last rule that is possible */
    for (uint32_t i = 0; i < n; i++) {
        if (p[i] > 0)
            last = i;
        if (u < p[i])
            return first + i;
        u -= p[i];
    }
    return first + last;
}

static sg_rule_id pick_constant(const sg_grammar *g, const sg_symbol *s, double u)
{
    const sg_rule *rules = sg_grammar_rule(g, s->first_rule); /* they stand together */
    uint32_t last = 0;
    for (uint32_t i = 0; i < s->nrules; i++) {
        const double p = rules[i].probability;
        if (p > 0)
            last = i;
        if (u < p)
            return s->first_rule + i;
        u -= p;
    }
    return s->first_rule + last;
}

static sg_status pick_conditional(const sg_grammar *g, sg_sym symbol, const double *args, double depth, gsl_rng *rng,
                                  sg_rule_id *rule, sg_error *err)
{
    enum { USUAL = 64 };
    const sg_symbol *s = sg_grammar_symbol(g, symbol);
    double few[USUAL], *p = few;
    if (s->nrules > USUAL && (p = malloc(s->nrules * sizeof *p)) == NULL)
        return SG_FAIL_NOMEM(err);
    const sg_status st = sg_grammar_rule_probabilities(g, symbol, args, depth, p, err);
    if (st == SG_OK)
        *rule = pick(p, s->first_rule, s->nrules, s->nrules > 1 ? sg_random_uniform(rng) : 0);
    if (p != few)
        free(p);
    return st;
}

static sg_status choose_rule(const sg_grammar *g, sg_sym symbol, const double *args, uint32_t depth, gsl_rng *rng,
                             sg_rule_id *rule, sg_error *err)
{
    const sg_symbol *s = sg_grammar_symbol(g, symbol);
    if (depth > sg_grammar_depth_limit(g)) {
        *rule = s->completion == SG_NONE ? SG_RULE_EMPTY : s->completion;
        return SG_OK;
    }
    if (!s->constant_weights)
        return pick_conditional(g, symbol, args, depth, rng, rule, err);
    *rule = s->nrules > 1 ? pick_constant(g, s, sg_random_uniform(rng)) : s->first_rule;
    return SG_OK;
}

void sg_uniforms_take(sg_uniforms *from, double *u, size_t n)
{
    size_t i = 0;
    while (i < n && from->next < from->nkept)
        u[i++] = from->kept[from->next++];
    while (i < n)
        u[i++] = sg_random_uniform(from->rng);
}

/* Give the last node of d its rule, uniforms and draw values. */
static sg_status derive_last(sg_derivation *d, size_t node, sg_rule_id rule, sg_uniforms *from, sg_error *err)
{
    d->nodes[node].rule = rule;
    if (rule == SG_RULE_EMPTY)
        return SG_OK;
    const sg_rule *r = sg_grammar_rule(d->grammar, rule);
    if (r->ndraws == 0)
        return SG_OK;
    SG_TRY(sg_derivation_room(d, 0, r->nuniforms, r->nvalues, err));
    double *u = d->uniforms + d->nodes[node].uniforms, *frame = d->values + d->nodes[node].values;
    sg_uniforms_take(from, u, r->nuniforms);
    const uint32_t nparams = sg_grammar_symbol(d->grammar, r->lhs)->nparams;
    SG_TRY(sg_derivation_transform(d->grammar, r, nparams, d->nodes[node].depth, u, frame, err));
    d->nuniforms += r->nuniforms;
    d->nvalues += r->nvalues;
    return SG_OK;
}

/* Append the child that `c` asks for, open, with its arguments. */
static sg_status append_child(sg_derivation *d, sg_child_op c, sg_error *err)
{
    const sg_node parent = d->nodes[c.parent];
    const sg_op *op = sg_grammar_rule(d->grammar, parent.rule)->ops + c.op;
    SG_TRY(sg_derivation_room(d, 1, 0, op->nargs, err));
    const size_t node =
        sg_derivation_append(d, op->symbol, (uint32_t)(d->nnodes - c.parent), parent.depth + 1, op->nargs);
    sg_derivation_eval_args(d->grammar, op, d->values + parent.values, parent.depth, d->values + d->nodes[node].values);
    return SG_OK;
}

static void reverse(sg_child_op *items, size_t n)
{
    for (size_t i = 0; i < n / 2; i++) {
        const sg_child_op swap = items[i];
        items[i] = items[n - 1 - i];
        items[n - 1 - i] = swap;
    }
}

/* Put the children of a body without repeats on the stack, the first one on top. */
static sg_status push_children(sg_derivation *d, const sg_rule *r, size_t node, size_t limit, sg_error *err)
{
    sg_child_list *list = &d->pending;
    if (r->nchildren > limit || list->n > limit - r->nchildren)
        return SG_EINVAL;
    if (list->n + r->nchildren > list->capacity && !SG_GROW(list->items, list->capacity, list->n + r->nchildren))
        return SG_FAIL_NOMEM(err);
    for (uint32_t i = r->nchildren; i-- > 0;)
        list->items[list->n++] = (sg_child_op){(uint32_t)node, r->child_ops[i]};
    return SG_OK;
}

static sg_status push_repeated(sg_derivation *d, const sg_rule *r, size_t node, size_t limit, sg_error *err)
{
    const sg_node *n = d->nodes + node;
    const size_t before = d->pending.n;
    SG_TRY(sg_derivation_list_children(d->grammar, r, d->values + n->values, n->depth, (uint32_t)node, limit,
                                       &d->pending, err));
    reverse(d->pending.items + before, d->pending.n - before);
    return SG_OK;
}

/* Derive the last node, and put its children on the stack. @return also SG_EINVAL: more than max_nodes */
static sg_status derive_node(sg_derivation *d, size_t node, gsl_rng *rng, sg_uniforms *from, size_t max_nodes,
                             sg_error *err)
{
    const sg_node n = d->nodes[node];
    sg_rule_id rule;
    SG_TRY(choose_rule(d->grammar, n.symbol, d->values + n.values, n.depth, rng, &rule, err));
    SG_TRY(derive_last(d, node, rule, from, err));
    if (rule == SG_RULE_EMPTY)
        return SG_OK;
    const sg_rule *r = sg_grammar_rule(d->grammar, rule);
    const size_t limit = max_nodes - d->nnodes;
    return r->has_repeat ? push_repeated(d, r, node, limit, err) : push_children(d, r, node, limit, err);
}

/* Lengths are sums over children: behind the tree's end first. */
static void sum_lengths(sg_derivation *d)
{
    for (size_t i = d->nnodes; i-- > 1;)
        d->nodes[i - d->nodes[i].parent].length += d->nodes[i].length;
}

static sg_status derive_all(sg_derivation *d, gsl_rng *rng, sg_uniforms *from, size_t max_nodes, bool *fits,
                            sg_error *err)
{
    *fits = true;
    for (size_t node = 0;; node++) {
        const sg_status st = derive_node(d, node, rng, from, max_nodes, err);
        if (st == SG_EINVAL) {
            *fits = false;
            return sg_derivation_fail_at(d, node, SG_FAIL(err, SG_ENUMERIC, "more than %zu nodes", max_nodes), err);
        }
        if (st != SG_OK)
            return sg_derivation_fail_at(d, node, st, err);
        if (d->pending.n == 0)
            return SG_OK;
        SG_TRY(append_child(d, d->pending.items[--d->pending.n], err));
    }
}

/* fits: false when it is the number of nodes that the call failed on. */
static sg_status derive(sg_derivation *slice, sg_sym symbol, const double *args, uint32_t depth, gsl_rng *rng,
                        sg_uniforms *from, size_t max_nodes, bool *fits, sg_error *err)
{
    if (max_nodes > SG_DERIVATION_MAX_ITEMS)
        max_nodes = SG_DERIVATION_MAX_ITEMS;
    slice->pending.n = 0;
    *fits = true;
    sg_status st = max_nodes > 0 ? sg_derivation_open(slice, symbol, args, depth, err)
                                 : SG_FAIL(err, SG_EINVAL, "a derivation has at least one node");
    if (st == SG_OK)
        st = derive_all(slice, rng, from, max_nodes, fits, err);
    slice->pending.n = 0;
    if (st != SG_OK)
        slice->nnodes = slice->nuniforms = slice->nvalues = 0;
    else
        sum_lengths(slice);
    return st;
}

sg_status sg_derivation_sample_subtree(sg_derivation *slice, sg_sym symbol, const double *args, uint32_t depth,
                                       gsl_rng *rng, size_t max_nodes, sg_error *err)
{
    sg_uniforms fresh = {NULL, 0, 0, rng};
    bool fits;
    return derive(slice, symbol, args, depth, rng, &fresh, max_nodes, &fits, err);
}

sg_status sg_derivation_regenerate(const sg_derivation *d, size_t node, sg_uniforms *from, size_t max_nodes,
                                   sg_derivation *slice, bool *inside, sg_error *err)
{
    const sg_node *n = d->nodes + node;
    const size_t others = d->nnodes - n->length;
    slice->grammar = d->grammar;
    *inside = others < max_nodes;
    if (!*inside)
        return SG_OK;
    const sg_status st = derive(slice, n->symbol, d->values + n->values, n->depth, from->rng, from, max_nodes - others,
                                inside, err);
    return *inside ? st : SG_OK;
}

sg_status sg_derivation_sample(sg_derivation *d, gsl_rng *rng, size_t max_nodes, sg_error *err)
{
    const sg_grammar *g = d->grammar;
    return sg_derivation_sample_subtree(d, sg_grammar_start(g), sg_grammar_start_args(g), 0, rng, max_nodes, err);
}

sg_status sg_derivation_choose(const sg_derivation *d, size_t node, gsl_rng *rng, sg_rule_id *rule, sg_error *err)
{
    const sg_node *n = d->nodes + node;
    if (n->rule != SG_NONE)
        return SG_FAIL(err, SG_EINVAL, "node %zu is not open", node);
    const sg_status st = choose_rule(d->grammar, n->symbol, d->values + n->values, n->depth, rng, rule, err);
    return st == SG_OK ? SG_OK : sg_derivation_fail_at(d, node, st, err);
}

static bool is_rule_of(const sg_grammar *g, sg_rule_id rule, sg_sym symbol)
{
    return rule == SG_RULE_EMPTY ||
           (rule < sg_grammar_rule_count(g) && sg_grammar_rule(g, rule)->lhs == symbol);
}

/* Uniforms and draw values of the rule, put in at the node. */
static sg_status insert_draws(sg_derivation *d, size_t node, const sg_rule *r, gsl_rng *rng, sg_error *err)
{
    if (r->ndraws == 0)
        return SG_OK;
    SG_TRY(sg_derivation_reserve(d, 0, r->nuniforms, r->nvalues, err));
    const uint32_t nparams = sg_grammar_symbol(d->grammar, r->lhs)->nparams;
    const size_t value = d->nodes[node].values + nparams, uniform = d->nodes[node].uniforms;
    sg_derivation_shift(d, node, 0, value, (ptrdiff_t)r->nvalues, uniform, (ptrdiff_t)r->nuniforms);
    for (uint32_t i = 0; i < r->nuniforms; i++)
        d->uniforms[uniform + i] = sg_random_uniform(rng);
    const sg_status st = sg_derivation_transform(d->grammar, r, nparams, d->nodes[node].depth, d->uniforms + uniform,
                                                 d->values + value - nparams, err);
    if (st != SG_OK)
        sg_derivation_shift(d, node, 0, value + r->nvalues, -(ptrdiff_t)r->nvalues, uniform + r->nuniforms,
                            -(ptrdiff_t)r->nuniforms);
    return st;
}

/* The children in d->pending become open nodes behind the node; value, uniform: where its own end. */
static sg_status insert_children(sg_derivation *d, size_t node, const sg_rule *r, size_t value, size_t uniform,
                                 sg_error *err)
{
    const size_t n = d->pending.n;
    size_t nargs = 0;
    for (size_t i = 0; i < n; i++)
        nargs += r->ops[d->pending.items[i].op].nargs;
    SG_TRY(sg_derivation_reserve(d, n, 0, nargs, err));
    sg_derivation_shift(d, node, (ptrdiff_t)n, value, (ptrdiff_t)nargs, uniform, 0);
    const sg_node parent = d->nodes[node];
    for (size_t i = 0; i < n; i++) {
        const sg_op *op = r->ops + d->pending.items[i].op;
        d->nodes[node + 1 + i] = (sg_node){.symbol = op->symbol,
                                           .rule = SG_NONE,
                                           .parent = (uint32_t)(1 + i),
                                           .length = 1,
                                           .depth = parent.depth + 1,
                                           .values = (uint32_t)value,
                                           .uniforms = (uint32_t)uniform};
        sg_derivation_eval_args(d->grammar, op, d->values + parent.values, parent.depth, d->values + value);
        value += op->nargs;
    }
    d->nodes[node].length += (uint32_t)n;
    sg_derivation_stretch(d, node, (ptrdiff_t)n);
    return SG_OK;
}

static sg_status expand_children(sg_derivation *d, size_t node, const sg_rule *r, sg_error *err)
{
    const sg_node n = d->nodes[node];
    d->pending.n = 0;
    sg_status st = sg_derivation_list_children(d->grammar, r, d->values + n.values, n.depth, (uint32_t)node,
                                               SG_DERIVATION_MAX_ITEMS - d->nnodes, &d->pending, err);
    const size_t value = n.values + sg_grammar_symbol(d->grammar, n.symbol)->nparams + r->nvalues;
    const size_t uniform = n.uniforms + r->nuniforms;
    if (st == SG_OK)
        st = insert_children(d, node, r, value, uniform, err);
    d->pending.n = 0;
    if (st != SG_OK)
        sg_derivation_shift(d, node, 0, value, -(ptrdiff_t)r->nvalues, uniform, -(ptrdiff_t)r->nuniforms);
    return st;
}

sg_status sg_derivation_expand(sg_derivation *d, size_t node, sg_rule_id rule, gsl_rng *rng, sg_error *err)
{
    if (d->nodes[node].rule != SG_NONE || !is_rule_of(d->grammar, rule, d->nodes[node].symbol))
        return SG_FAIL(err, SG_EINVAL, "node %zu is not open, or rule %u is none of its symbol", node, (unsigned)rule);
    if (rule != SG_RULE_EMPTY) {
        const sg_rule *r = sg_grammar_rule(d->grammar, rule);
        sg_status st = insert_draws(d, node, r, rng, err);
        if (st == SG_OK)
            st = expand_children(d, node, r, err);
        if (st != SG_OK)
            return sg_derivation_fail_at(d, node, st, err);
    }
    d->nodes[node].rule = rule;
    return SG_OK;
}
