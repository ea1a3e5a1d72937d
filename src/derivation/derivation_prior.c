/* SPDX-License-Identifier: GPL-3.0-or-later */
/* derivation_prior.c - log prior and log density of a derivation, and its values made anew from its uniforms. */
#include "derivation/derivation_priv.h"

#include <math.h>
#include <stdlib.h>

static sg_status conditional_probability(const sg_grammar *g, sg_sym symbol, const double *args, double depth,
                                         uint32_t index, double *probability, sg_error *err)
{
    enum { USUAL = 64 };
    const uint32_t n = sg_grammar_symbol(g, symbol)->nrules;
    double few[USUAL], *p = few;
    if (n > USUAL && (p = malloc(n * sizeof *p)) == NULL)
        return SG_FAIL_NOMEM(err);
    const sg_status st = sg_grammar_rule_probabilities(g, symbol, args, depth, p, err);
    if (st == SG_OK)
        *probability = p[index];
    if (p != few)
        free(p);
    return st;
}

sg_status sg_node_probability(const sg_derivation *d, const sg_node *n, double *p, sg_error *err)
{
    const sg_symbol *s = sg_grammar_symbol(d->grammar, n->symbol);
    const bool ordinary = n->rule >= s->first_rule && n->rule - s->first_rule < s->nrules;
    if (n->depth > sg_grammar_depth_limit(d->grammar)) {
        *p = n->rule == (s->completion == SG_NONE ? SG_RULE_EMPTY : s->completion) ? 1 : 0;
        return SG_OK;
    }
    *p = 0;
    if (!ordinary)
        return SG_OK;
    if (!s->constant_weights)
        return conditional_probability(d->grammar, n->symbol, d->values + n->values, n->depth, n->rule - s->first_rule, p,
                                       err);
    *p = sg_grammar_rule(d->grammar, n->rule)->probability;
    return SG_OK;
}

sg_status sg_derivation_rule_probability(const sg_derivation *d, size_t node, double *p, sg_error *err)
{
    const sg_status st = sg_node_probability(d, d->nodes + node, p, err);
    return st == SG_OK ? SG_OK : sg_derivation_fail_at(d, node, st, err);
}

sg_status sg_derivation_log_prior(const sg_derivation *d, double *log_prior, sg_error *err)
{
    double sum = 0;
    for (size_t i = 0; i < d->nnodes; i++) {
        if (d->nodes[i].rule == SG_NONE)
            continue;
        double p;
        SG_TRY(sg_derivation_rule_probability(d, i, &p, err));
        if (p != 1)
            sum += log(p);
    }
    *log_prior = sum;
    return SG_OK;
}

sg_status sg_frame_log_density(const sg_grammar *g, const sg_rule *r, uint32_t nparams, double depth, const double *frame,
                               double *log_density, sg_error *err)
{
    *log_density = 0;
    for (uint32_t k = 0; k < r->ndraws; k++) {
        double log_phi;
        SG_TRY(sg_draw_log_density(g, r->draws + k, frame, depth, frame + nparams + r->draws[k].first_value, &log_phi, err));
        *log_density += log_phi;
    }
    return SG_OK;
}

sg_status sg_node_log_density(const sg_derivation *d, const sg_node *n, double *log_density, sg_error *err)
{
    const sg_rule *r = sg_node_rule(d, n);
    *log_density = 0;
    if (r == NULL || r->ndraws == 0)
        return SG_OK;
    const uint32_t nparams = sg_grammar_symbol(d->grammar, n->symbol)->nparams;
    return sg_frame_log_density(d->grammar, r, nparams, n->depth, d->values + n->values, log_density, err);
}

sg_status sg_derivation_log_density(const sg_derivation *d, double *log_density, sg_error *err)
{
    double sum = 0;
    for (size_t i = 0; i < d->nnodes; i++) {
        double log_phi;
        const sg_status st = sg_node_log_density(d, d->nodes + i, &log_phi, err);
        if (st != SG_OK)
            return sg_derivation_fail_at(d, i, st, err);
        sum += log_phi;
    }
    *log_density = sum;
    return SG_OK;
}

/* The children of a body without repeats are those of its rule. */
static sg_status hand_down_plain(sg_derivation *d, size_t node, const sg_rule *r, sg_error *err)
{
    const sg_node *n = d->nodes + node;
    size_t child = node + 1;
    for (uint32_t i = 0; i < r->nchildren; i++) {
        const sg_op *op = r->ops + r->child_ops[i];
        if (op->nargs > 0)
            SG_TRY(sg_derivation_eval_args(d->grammar, op, d->values + n->values, n->depth,
                                           d->values + d->nodes[child].values, err));
        child += d->nodes[child].length;
    }
    return SG_OK;
}

sg_status sg_derivation_hand_down(sg_derivation *d, size_t node, const sg_rule *r, bool *fits, sg_error *err)
{
    *fits = true;
    if (!r->has_repeat)
        return hand_down_plain(d, node, r, err);
    const sg_node *n = d->nodes + node;
    d->pending.n = 0;
    sg_status st = sg_derivation_list_children(d->grammar, r, d->values + n->values, n->depth, (uint32_t)node,
                                               n->length, &d->pending, err);
    *fits = st != SG_EINVAL; /* more children than there are nodes */
    const size_t end = node + n->length, nchildren = d->pending.n;
    size_t child = node + 1;
    for (size_t i = 0; st == SG_OK && *fits && i < nchildren; i++) {
        const sg_op *op = r->ops + d->pending.items[i].op;
        *fits = child < end && d->nodes[child].symbol == op->symbol;
        if (!*fits)
            break;
        st = sg_derivation_eval_args(d->grammar, op, d->values + n->values, n->depth,
                                     d->values + d->nodes[child].values, err);
        child += d->nodes[child].length;
    }
    *fits = *fits && child == end;
    d->pending.n = 0;
    return st == SG_EINVAL ? SG_OK : st;
}

/* Draw values of one node, then the arguments of its children. */
static sg_status refresh_node(sg_derivation *d, size_t node, sg_error *err)
{
    const sg_node *n = d->nodes + node;
    const sg_rule *r = sg_node_rule(d, n);
    if (r == NULL)
        return SG_OK;
    const uint32_t nparams = sg_grammar_symbol(d->grammar, n->symbol)->nparams;
    SG_TRY(sg_derivation_transform(d->grammar, r, nparams, n->depth, d->uniforms + n->uniforms, d->values + n->values,
                                   err));
    bool fits;
    SG_TRY(sg_derivation_hand_down(d, node, r, &fits, err));
    return fits ? SG_OK : SG_FAIL(err, SG_ENUMERIC, "a repeat asks for other children now than before");
}

sg_status sg_derivation_refresh(sg_derivation *d, size_t node, sg_error *err)
{
    const size_t end = node + d->nodes[node].length;
    for (size_t i = node; i < end; i++) {
        const sg_status st = refresh_node(d, i, err);
        if (st != SG_OK)
            return sg_derivation_fail_at(d, i, st, err);
    }
    return SG_OK;
}
