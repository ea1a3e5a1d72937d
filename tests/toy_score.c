/* SPDX-License-Identifier: GPL-3.0-or-later */
/* toy_score.c - see toy_score.h. */
#include "tests/toy_score.h"

#include "tests/derivation_oracle.h"
#include "tests/support.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <string.h>

typedef struct {
    sg_score_state base;
    sg_derivation at, proposed;
    double log, proposed_log;
    bool somewhere, pending;
} toy_state;

static const toy_score *target_of(const sg_score_state *s)
{
    return (const toy_score *)s->target;
}

static void destroy_target(sg_score *target)
{
    (void)target;
}

static sg_status create_state(const sg_score *target, sg_score_state **out, sg_error *err)
{
    toy_state *t = calloc(1, sizeof *t);
    if (t == NULL)
        return SG_FAIL_NOMEM(err);
    t->base.target = target;
    *out = &t->base;
    return SG_OK;
}

static void destroy_state(sg_score_state *s)
{
    toy_state *t = (toy_state *)s;
    sg_derivation_clear(&t->at);
    sg_derivation_clear(&t->proposed);
    free(t);
}

/* Copies go through functions that are not under test. */
static void copy(sg_derivation *dst, const sg_derivation *src)
{
    oracle_replace(src, 0, src, dst);
}

static sg_status evaluate(sg_score_state *s, const sg_derivation *d, sg_score_value *out, sg_error *err)
{
    (void)err;
    toy_state *t = (toy_state *)s;
    const toy_score *target = target_of(s);
    t->log = target->log_of(d, target->user);
    t->somewhere = true;
    t->pending = false;
    if (target->strict)
        copy(&t->at, d);
    *out = (sg_score_value){t->log, t->log};
    return SG_OK;
}

void toy_apply(const sg_change *change, sg_derivation *out)
{
    if (change->slice != NULL) {
        oracle_replace(change->current, change->node, change->slice, out);
        return;
    }
    copy(out, change->current);
    const sg_node *n = out->nodes + change->node;
    const sg_rule *r = sg_grammar_rule(out->grammar, n->rule);
    const uint32_t nparams = sg_grammar_symbol(out->grammar, n->symbol)->nparams;
    memcpy(out->uniforms + n->uniforms, change->uniforms, r->nuniforms * sizeof(double));
    memcpy(out->values + n->values + nparams, change->values, r->nvalues * sizeof(double));
}

static void check_proposal(const toy_state *t, const sg_change *change)
{
    sg_error err = SG_ERROR_INIT;
    test_must(oracle_same(&t->at, change->current));
    test_must(change->node < change->current->nnodes);
    if (change->slice != NULL) {
        const sg_node *n = change->current->nodes + change->node, *root = change->slice->nodes;
        const uint32_t nparams = sg_grammar_symbol(t->at.grammar, n->symbol)->nparams;
        test_must(root->symbol == (n->symbol));
        test_must(root->depth == (n->depth));
        test_must(nparams == 0 || memcmp(change->slice->values + root->values, change->current->values + n->values,
                                         nparams * sizeof(double)) == 0);
    }
    test_must(sg_derivation_complete(&t->proposed));
    test_must_ok(sg_derivation_check(&t->proposed, &err));
    for (size_t i = 0; i < t->proposed.nuniforms; i++)
        test_must(t->proposed.uniforms[i] > 0 && t->proposed.uniforms[i] < 1);
}

static sg_status propose(sg_score_state *s, const sg_change *change, double floor, sg_score_value *out, sg_error *err)
{
    (void)err;
    toy_state *t = (toy_state *)s;
    const toy_score *target = target_of(s);
    test_must(t->somewhere && !t->pending);
    test_must(!isnan(floor));
    toy_apply(change, &t->proposed);
    if (target->strict)
        check_proposal(t, change);
    t->proposed_log = target->log_of(&t->proposed, target->user);
    if (target->stops_early && t->proposed_log < floor)
        t->proposed_log = -INFINITY;
    t->pending = true;
    if (target->listener != NULL)
        target->listener(target->listener_user, change, &t->proposed, floor, t->proposed_log);
    *out = (sg_score_value){t->proposed_log, t->proposed_log};
    return SG_OK;
}

static void commit(sg_score_state *s)
{
    toy_state *t = (toy_state *)s;
    test_must(t->pending);
    test_must(t->proposed_log > -INFINITY);
    t->pending = false;
    t->log = t->proposed_log;
    if (target_of(s)->strict)
        copy(&t->at, &t->proposed);
}

static void rollback(sg_score_state *s)
{
    toy_state *t = (toy_state *)s;
    test_must(t->pending);
    t->pending = false;
}

static sg_status copy_state(sg_score_state *dst, const sg_score_state *src, sg_error *err)
{
    (void)err;
    toy_state *d = (toy_state *)dst;
    const toy_state *s = (const toy_state *)src;
    d->log = s->log;
    d->somewhere = s->somewhere;
    d->pending = false;
    if (s->at.grammar != NULL)
        copy(&d->at, &s->at);
    return SG_OK;
}

static const sg_score_ops toy_ops = {
    "toy", destroy_target, create_state, destroy_state, evaluate, propose, commit, rollback, copy_state,
};

void toy_score_init(toy_score *s, toy_function *log_of, void *user)
{
    *s = (toy_score){.base = {&toy_ops}, .log_of = log_of, .user = user};
}

static uint64_t mix(uint64_t h, uint64_t x)
{
    h = (h ^ x) * 0x9e3779b97f4a7c15;
    h ^= h >> 32;
    h *= 0xd6e8feb86659fd93;
    return h ^ h >> 32;
}

double toy_hash_log(const sg_derivation *d, void *user)
{
    const toy_hash *t = user;
    uint64_t h = mix(t->seed, d->nnodes);
    for (size_t i = 0; i < d->nnodes; i++)
        h = mix(mix(h, d->nodes[i].symbol), d->nodes[i].rule);
    for (size_t i = 0; i < d->nvalues; i++) {
        uint64_t bits;
        memcpy(&bits, d->values + i, sizeof bits);
        h = mix(h, bits);
    }
    if ((double)(mix(h, 1) >> 11) * 0x1p-53 < t->impossible)
        return -INFINITY;
    return t->scale * gsl_cdf_ugaussian_Pinv(((double)(h >> 11) + 0.5) * 0x1p-53);
}
