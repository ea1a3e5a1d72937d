/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench_plain.c - a plain sampler of derivations: see bench_plain.h. */
#include "bench_plain.h"

#include <gsl/gsl_cdf.h>
#include <stdlib.h>

typedef struct plain_node {
    const sg_rule *rule;
    double *arguments, *uniforms, *values;
    struct plain_node **children;
    size_t nchildren;
} plain_node;

static void *get(size_t n, size_t size)
{
    void *p = calloc(n > 0 ? n : 1, size);
    if (p == NULL)
        abort();
    return p;
}

static const sg_rule *choose(const sg_grammar *g, sg_sym symbol, const double *args, double depth, gsl_rng *rng)
{
    const sg_symbol *s = sg_grammar_symbol(g, symbol);
    double *p = get(s->nrules, sizeof *p), u = gsl_rng_uniform(rng);
    if (sg_grammar_rule_probabilities(g, symbol, args, depth, p, NULL) != SG_OK)
        abort();
    uint32_t i = 0;
    while (i + 1 < s->nrules && u >= p[i])
        u -= p[i++];
    free(p);
    return sg_grammar_rule(g, s->first_rule + i);
}

static plain_node *derive(const sg_grammar *g, sg_sym symbol, const double *args, double depth, gsl_rng *rng, size_t *count)
{
    plain_node *n = get(1, sizeof *n);
    const uint32_t nparams = sg_grammar_symbol(g, symbol)->nparams;
    n->rule = choose(g, symbol, args, depth, rng);
    n->arguments = get(nparams, sizeof *n->arguments);
    n->uniforms = get(n->rule->nuniforms, sizeof *n->uniforms);
    n->values = get(nparams + n->rule->nvalues, sizeof *n->values);
    for (uint32_t i = 0; i < nparams; i++)
        n->arguments[i] = n->values[i] = args[i];
    for (uint32_t k = 0; k < n->rule->ndraws; k++) {
        const sg_draw *d = n->rule->draws + k;
        n->uniforms[k] = gsl_rng_uniform_pos(rng);
        n->values[nparams + k] = d->constants[0] + d->constants[1] * gsl_cdf_ugaussian_Pinv(n->uniforms[k]);
    }
    n->children = get(n->rule->nchildren, sizeof *n->children);
    for (uint32_t i = 0; i < n->rule->nchildren; i++) {
        const sg_op *op = n->rule->ops + n->rule->child_ops[i];
        double *child = get(op->nargs, sizeof *child);
        for (uint32_t a = 0; a < op->nargs; a++)
            child[a] = sg_grammar_eval(g, op->args[a], n->values, depth);
        n->children[n->nchildren++] = derive(g, op->symbol, child, depth + 1, rng, count);
        free(child);
    }
    ++*count;
    return n;
}

static void clear(plain_node *n)
{
    for (size_t i = 0; i < n->nchildren; i++)
        clear(n->children[i]);
    free(n->children);
    free(n->values);
    free(n->uniforms);
    free(n->arguments);
    free(n);
}

size_t bench_plain_sample(const sg_grammar *g, gsl_rng *rng)
{
    size_t count = 0;
    clear(derive(g, sg_grammar_start(g), sg_grammar_start_args(g), 0, rng, &count));
    return count;
}
