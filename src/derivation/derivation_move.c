/* SPDX-License-Identifier: GPL-3.0-or-later */
/* derivation_move.c - the same rules with other uniforms. Values are made anew from the root of the slice down, and only where
 * an argument or a uniform differs from those of the tree that was copied. A rule is looked at before its draws are:
 * where it has probability 0 the draws may be impossible, and that is no fault of the grammar's. */
#include "derivation/derivation_move.h"

#include "derivation/derivation_priv.h"

#include <math.h>
#include <string.h>

typedef struct {
    const sg_derivation *like;
    sg_derivation *slice;
    double d_log_rules;
    bool inside;
    sg_error *err;
} revaluation;

static bool equal(const double *a, const double *b, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (a[i] != b[i])
            return false;
    return true;
}

/* What other arguments do to the probability of the node's rule. */
static sg_status weigh(revaluation *v, size_t node)
{
    const sg_grammar *g = v->like->grammar;
    const sg_node *n = v->slice->nodes + node;
    if (n->rule == SG_NONE || sg_grammar_symbol(g, n->symbol)->constant_weights)
        return SG_OK;
    double before = 0, after = 0;
    SG_TRY(sg_node_probability(v->slice, n, &after, v->err));
    SG_TRY(sg_node_probability(v->like, v->like->nodes + node, &before, v->err));
    v->inside = after > 0;
    if (v->inside)
        v->d_log_rules += log(after) - log(before);
    return SG_OK;
}

static sg_status draw(revaluation *v, const sg_node *n, const sg_rule *r, uint32_t nparams)
{
    return sg_derivation_transform(v->slice->grammar, r, nparams, n->depth, v->slice->uniforms + n->uniforms,
                                   v->slice->values + n->values, v->err);
}

static sg_status hand_down(revaluation *v, size_t node, const sg_rule *r)
{
    return sg_derivation_hand_down(v->slice, node, r, &v->inside, v->err);
}

/* moved: the arguments are others. */
static sg_status revalue_node(revaluation *v, size_t node, bool moved)
{
    if (moved)
        SG_TRY(weigh(v, node));
    const sg_node *n = v->slice->nodes + node;
    const sg_rule *r = sg_node_rule(v->slice, n);
    if (r == NULL || !v->inside)
        return SG_OK;
    const uint32_t nparams = sg_grammar_symbol(v->slice->grammar, n->symbol)->nparams;
    const bool drawn = !equal(v->slice->uniforms + n->uniforms, v->like->uniforms + n->uniforms, r->nuniforms);
    if (r->ndraws > 0 && (moved || drawn))
        SG_TRY(draw(v, n, r, nparams));
    return moved || (drawn && r->draws_passed) ? hand_down(v, node, r) : SG_OK;
}

/* deep: uniforms below the root have changed too, so that no subtree can be skipped. */
static sg_status revalue_all(revaluation *v, bool deep)
{
    const sg_derivation *slice = v->slice;
    for (size_t i = 0; v->inside && i < slice->nnodes;) {
        const sg_node *n = slice->nodes + i;
        const uint32_t nparams = sg_grammar_symbol(slice->grammar, n->symbol)->nparams;
        const bool moved = i > 0 && !equal(slice->values + n->values, v->like->values + n->values, nparams);
        if (i > 0 && !moved && !deep) {
            i += n->length;
            continue;
        }
        const sg_status st = revalue_node(v, i, moved);
        if (st != SG_OK)
            return sg_derivation_fail_at(slice, i, st, v->err);
        i++;
    }
    return SG_OK;
}

static sg_status finish(const revaluation *v, sg_status st, double *d_log_rules, bool *inside)
{
    *inside = v->inside;
    *d_log_rules = v->inside ? v->d_log_rules : -INFINITY;
    return st;
}

sg_status sg_derivation_revalue(const sg_derivation *like, sg_uniforms *from, sg_derivation *slice, double *d_log_rules,
                                bool *inside, sg_error *err)
{
    SG_TRY(sg_derivation_copy(slice, like, err));
    sg_uniforms_take(from, slice->uniforms, slice->nuniforms);
    revaluation v = {like, slice, 0, true, err};
    const sg_status st = revalue_all(&v, true);
    return finish(&v, st, d_log_rules, inside);
}

sg_status sg_derivation_revalue_root(const sg_derivation *like, const double *uniforms, sg_derivation *slice,
                                     double *d_log_rules, bool *inside, sg_error *err)
{
    SG_TRY(sg_derivation_copy(slice, like, err));
    const sg_rule *r = sg_node_rule(slice, slice->nodes);
    if (r != NULL && r->nuniforms > 0)
        memcpy(slice->uniforms, uniforms, r->nuniforms * sizeof *uniforms);
    revaluation v = {like, slice, 0, true, err};
    const sg_status st = revalue_all(&v, false);
    return finish(&v, st, d_log_rules, inside);
}

const double *sg_derivation_uniforms(const sg_derivation *d, size_t node, size_t *n)
{
    const size_t end = node + d->nodes[node].length;
    *n = (end == d->nnodes ? d->nuniforms : d->nodes[end].uniforms) - d->nodes[node].uniforms;
    return d->uniforms + d->nodes[node].uniforms;
}
