/* SPDX-License-Identifier: GPL-3.0-or-later */
/* derivation_sample.c - derivations from the prior, whole or node by node.
 * Pending children stand on a stack of their own, so depth is bounded by memory and not by the C stack. The order of
 * draws is part of what a seed means: pre-order, and in each node first the rule (when there is a choice), then its
 * uniforms. */
#include "core/array.h"
#include "core/random.h"
#include "derivation/derivation_move.h"
#include "derivation/derivation_priv.h"
#include "derivation/pins_priv.h"

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

/* The first sum that is greater than u. Counted where there are few, for no branch then depends on chance. */
static uint32_t pick_constant(const double *cumulative, uint32_t n, double u)
{
    enum { FEW = 8 };
    uint32_t low = 0;
    while (n - low > FEW) {
        const uint32_t middle = low + (n - low) / 2;
        if (cumulative[middle] > u)
            n = middle + 1;
        else
            low = middle + 1;
    }
    uint32_t before = 0;
    for (uint32_t i = low; i < n; i++)
        before += !(cumulative[i] > u);
    return low + before;
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
    *rule = s->first_rule + (s->nrules > 1 ? pick_constant(s->cumulative, s->nrules, sg_random_uniform(rng)) : 0);
    return SG_OK;
}

void sg_uniforms_take(sg_uniforms *from, double *u, size_t n)
{
    size_t i = 0;
    while (i < n && from->next < from->nkept)
        u[i++] = from->kept[from->next++];
    sg_random_uniforms(from->rng, u + i, n - i);
}

/* A derivation that grows at its end. Rules and symbols stand in arrays. */
typedef struct {
    sg_derivation *d;
    const sg_rule *rules;
    const sg_symbol *symbols;
    size_t depth_limit;
    gsl_rng *rng;
    sg_uniforms *from;
    size_t max_nodes;
    sg_error *err;
    sg_pin_run *given; /* NULL: nothing is */
} growth;

static bool is_given(const growth *w, sg_sym symbol)
{
    return w->given != NULL && sg_pins_concern(w->given, symbol);
}

/* Uniforms and draw values of the last node. */
static sg_status draw_last(growth *w, const sg_node *n, const sg_rule *r)
{
    sg_derivation *d = w->d;
    SG_TRY(sg_derivation_room(d, 0, r->nuniforms, r->nvalues, w->err));
    double *u = d->uniforms + n->uniforms, *frame = d->values + n->values;
    sg_uniforms_take(w->from, u, r->nuniforms);
    const uint32_t nparams = w->symbols[r->lhs].nparams;
    SG_TRY(is_given(w, n->symbol) ? sg_pin_run_transform(w->given, d->grammar, r, nparams, n->depth, u, frame, w->err)
                                  : sg_derivation_transform(d->grammar, r, nparams, n->depth, u, frame, w->err));
    d->nuniforms += r->nuniforms;
    d->nvalues += r->nvalues;
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
static sg_status push_children(growth *w, const sg_rule *r, size_t node, size_t limit)
{
    sg_child_list *list = &w->d->pending;
    if (r->nchildren > limit || list->n > limit - r->nchildren)
        return SG_EINVAL;
    if (list->n + r->nchildren > list->capacity && !SG_GROW(list->items, list->capacity, list->n + r->nchildren))
        return SG_FAIL_NOMEM(w->err);
    for (uint32_t i = r->nchildren; i-- > 0;)
        list->items[list->n++] = (sg_child_op){(uint32_t)node, r->child_ops[i]};
    return SG_OK;
}

static sg_status push_repeated(growth *w, const sg_rule *r, size_t node, size_t limit)
{
    sg_derivation *d = w->d;
    const sg_node *n = d->nodes + node;
    const size_t before = d->pending.n;
    SG_TRY(sg_derivation_list_children(d->grammar, r, d->values + n->values, n->depth, (uint32_t)node, limit,
                                       &d->pending, w->err));
    if (d->pending.n > before)
        reverse(d->pending.items + before, d->pending.n - before);
    return SG_OK;
}

/* Derive the last node, and put its children on the stack. @return also SG_EINVAL: more than max_nodes */
static sg_status derive_last(growth *w)
{
    sg_derivation *d = w->d;
    const size_t node = d->nnodes - 1;
    const sg_node n = d->nodes[node];
    const sg_symbol *s = w->symbols + n.symbol;
    sg_rule_id rule = s->first_rule;
    if (!s->constant_weights || n.depth > w->depth_limit)
        SG_TRY(choose_rule(d->grammar, n.symbol, d->values + n.values, n.depth, w->rng, &rule, w->err));
    else if (s->nrules > 1)
        rule += pick_constant(s->cumulative, s->nrules, sg_random_uniform(w->rng));
    if (is_given(w, n.symbol))
        SG_TRY(sg_pin_run_choose(w->given, d, n.depth > w->depth_limit, &rule, w->err));
    d->nodes[node].rule = rule;
    if (rule == SG_RULE_EMPTY)
        return SG_OK;
    const sg_rule *r = w->rules + rule;
    if (r->ndraws > 0)
        SG_TRY(draw_last(w, &n, r));
    const size_t limit = w->max_nodes - d->nnodes;
    return r->has_repeat ? push_repeated(w, r, node, limit) : push_children(w, r, node, limit);
}

/* Append the child that is on top of the stack, open, with its arguments. */
static sg_status append_next(growth *w)
{
    sg_derivation *d = w->d;
    const sg_child_op c = d->pending.items[--d->pending.n];
    const sg_node *parent = d->nodes + c.parent;
    const uint32_t depth = parent->depth, values = parent->values;
    const sg_op *op = w->rules[parent->rule].ops + c.op;
    SG_TRY(sg_derivation_room(d, 1, 0, op->nargs, w->err));
    const size_t node = sg_derivation_append(d, op->symbol, (uint32_t)(d->nnodes - c.parent), depth + 1, op->nargs);
    if (op->nargs == 0)
        return SG_OK;
    const sg_status st =
        sg_derivation_eval_args(d->grammar, op, d->values + values, depth, d->values + d->nodes[node].values, w->err);
    return st == SG_OK ? SG_OK : sg_derivation_fail_at(d, c.parent, st, w->err);
}

/* True when there is nothing to choose or to draw for the last node: then it has its rule. */
static bool finish_leaf(growth *w)
{
    sg_node *n = w->d->nodes + w->d->nnodes - 1;
    const sg_symbol *s = w->symbols + n->symbol;
    if (!s->leaf || n->depth > w->depth_limit || is_given(w, n->symbol))
        return false;
    n->rule = s->first_rule;
    return true;
}

/* Lengths are sums over children: behind the tree's end first. */
static void sum_lengths(sg_derivation *d)
{
    for (size_t i = d->nnodes; i-- > 1;)
        d->nodes[i - d->nodes[i].parent].length += d->nodes[i].length;
}

static sg_status grow(growth *w, bool *fits)
{
    sg_derivation *d = w->d;
    for (;;) {
        const sg_status st = derive_last(w);
        if (st == SG_EINVAL) {
            *fits = false;
            SG_FAIL(w->err, SG_ENUMERIC, "more than %zu nodes", w->max_nodes);
        }
        if (st != SG_OK)
            return sg_derivation_fail_at(d, d->nnodes - 1, st == SG_EINVAL ? SG_ENUMERIC : st, w->err);
        do {
            if (d->pending.n == 0)
                return SG_OK;
            SG_TRY(append_next(w));
        } while (finish_leaf(w));
    }
}

/* fits: false when it is the number of nodes that the call failed on. */
static sg_status derive(sg_derivation *slice, sg_sym symbol, const double *args, uint32_t depth, gsl_rng *rng,
                        sg_uniforms *from, sg_pin_run *given, size_t max_nodes, bool *fits, sg_error *err)
{
    if (max_nodes > SG_DERIVATION_MAX_ITEMS)
        max_nodes = SG_DERIVATION_MAX_ITEMS;
    const sg_grammar *g = slice->grammar;
    growth w = {slice, sg_grammar_rule(g, 0), sg_grammar_symbol(g, 0), sg_grammar_depth_limit(g), rng, from, max_nodes, err,
                given};
    slice->pending.n = 0;
    *fits = true;
    sg_status st = max_nodes > 0 ? sg_derivation_open(slice, symbol, args, depth, err)
                                 : SG_FAIL(err, SG_EINVAL, "a derivation has at least one node");
    if (st == SG_OK)
        st = grow(&w, fits);
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
    return derive(slice, symbol, args, depth, rng, &fresh, NULL, max_nodes, &fits, err);
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
    const sg_status st = derive(slice, n->symbol, d->values + n->values, n->depth, from->rng, from, NULL,
                                max_nodes - others, inside, err);
    return *inside ? st : SG_OK;
}

sg_status sg_derivation_sample(sg_derivation *d, gsl_rng *rng, size_t max_nodes, sg_error *err)
{
    const sg_grammar *g = d->grammar;
    return sg_derivation_sample_subtree(d, sg_grammar_start(g), sg_grammar_start_args(g), 0, rng, max_nodes, err);
}

sg_status sg_derivation_sample_given(sg_derivation *d, sg_pin_run *given, gsl_rng *rng, size_t max_nodes, sg_error *err)
{
    const sg_grammar *g = d->grammar;
    sg_uniforms fresh = {NULL, 0, 0, rng};
    bool fits;
    sg_pin_run_begin(given);
    return derive(d, sg_grammar_start(g), sg_grammar_start_args(g), 0, rng, &fresh, given, max_nodes, &fits, err);
}

sg_status sg_derivation_draw_rule(const sg_derivation *d, size_t node, gsl_rng *rng, sg_rule_id *rule, sg_error *err)
{
    const sg_node *n = d->nodes + node;
    const sg_status st = choose_rule(d->grammar, n->symbol, d->values + n->values, n->depth, rng, rule, err);
    return st == SG_OK ? SG_OK : sg_derivation_fail_at(d, node, st, err);
}

sg_status sg_derivation_choose(const sg_derivation *d, size_t node, gsl_rng *rng, sg_rule_id *rule, sg_error *err)
{
    const sg_node *n = d->nodes + node;
    if (n->rule != SG_NONE)
        return SG_FAIL(err, SG_EINVAL, "node %zu is not open", node);
    return sg_derivation_draw_rule(d, node, rng, rule, err);
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
    sg_random_uniforms(rng, d->uniforms + uniform, r->nuniforms);
    const sg_status st = sg_derivation_transform(d->grammar, r, nparams, d->nodes[node].depth, d->uniforms + uniform,
                                                 d->values + value - nparams, err);
    if (st != SG_OK)
        sg_derivation_shift(d, node, 0, value + r->nvalues, -(ptrdiff_t)r->nvalues, uniform + r->nuniforms,
                            -(ptrdiff_t)r->nuniforms);
    return st;
}

static sg_status check_args(const sg_derivation *d, const sg_node *parent, const sg_op *op, sg_error *err)
{
    double arg;
    for (uint32_t i = 0; i < op->nargs; i++) {
        const sg_op one = {.nargs = 1, .args = op->args + i, .symbol = op->symbol};
        SG_TRY(sg_derivation_eval_args(d->grammar, &one, d->values + parent->values, parent->depth, &arg, err));
    }
    return SG_OK;
}

/* The children in d->pending become open nodes behind the node; value, uniform: where its own end. */
static sg_status insert_children(sg_derivation *d, size_t node, const sg_rule *r, size_t value, size_t uniform,
                                 sg_error *err)
{
    const size_t n = d->pending.n;
    size_t nargs = 0;
    for (size_t i = 0; i < n; i++) {
        const sg_op *op = r->ops + d->pending.items[i].op;
        SG_TRY(check_args(d, d->nodes + node, op, err)); /* nothing may fail once the tree is open */
        nargs += op->nargs;
    }
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
        SG_TRY(sg_derivation_eval_args(d->grammar, op, d->values + parent.values, parent.depth, d->values + value, err));
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
