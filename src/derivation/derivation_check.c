/* SPDX-License-Identifier: GPL-3.0-or-later */
/* derivation_check.c - every invariant of a derivation, for tests and for readers of files. No offset is trusted before it is
 * checked. */
#include "derivation/derivation_priv.h"

#include <math.h>
#include <stdlib.h>

static sg_status check_fail(sg_error *err, size_t node, const char *what)
{
    return SG_FAIL(err, SG_EINVAL, "node %zu: %s", node, what);
}

/* Symbols, rules, and the offsets of the three arrays: each node's pieces follow those of the node before it. */
static sg_status check_slices(const sg_derivation *d, sg_error *err)
{
    const sg_grammar *g = d->grammar;
    size_t value = 0, uniform = 0;
    for (size_t i = 0; i < d->nnodes; i++) {
        const sg_node *n = d->nodes + i;
        if (n->symbol >= sg_grammar_symbol_count(g) || sg_grammar_symbol(g, n->symbol)->kind != SG_SYMBOL_NONTERMINAL)
            return check_fail(err, i, "its symbol is no non-terminal of the grammar");
        const sg_rule *r = NULL;
        if (n->rule < SG_RULE_EMPTY) {
            if (n->rule >= sg_grammar_rule_count(g) || sg_grammar_rule(g, n->rule)->lhs != n->symbol)
                return check_fail(err, i, "its rule is none of its symbol");
            r = sg_grammar_rule(g, n->rule);
        }
        if (n->values != value || n->uniforms != uniform)
            return check_fail(err, i, "its values do not follow those of the node before it");
        value += sg_grammar_symbol(g, n->symbol)->nparams + (r != NULL ? r->nvalues : 0);
        uniform += r != NULL ? r->nuniforms : 0;
    }
    if (value != d->nvalues || uniform != d->nuniforms)
        return SG_FAIL(err, SG_EINVAL, "%zu values and %zu uniforms where the nodes own %zu and %zu", d->nvalues,
                       d->nuniforms, value, uniform);
    return SG_OK;
}

/* Parents, depths and lengths: the tree is walked with the parent of each node recomputed from lengths alone. */
static sg_status check_tree(const sg_derivation *d, sg_error *err)
{
    if (d->nodes[0].length != d->nnodes || d->nodes[0].parent != 0)
        return check_fail(err, 0, "the root does not span the tree");
    for (size_t i = 1; i < d->nnodes; i++) {
        const sg_node *n = d->nodes + i;
        if (n->parent == 0 || n->parent > i)
            return check_fail(err, i, "its parent is not in front of it");
        const size_t parent = i - n->parent;
        if (n->length == 0 || n->length > d->nnodes - i || i + n->length > parent + d->nodes[parent].length)
            return check_fail(err, i, "its subtree leaves that of its parent");
        if (n->depth != d->nodes[parent].depth + 1)
            return check_fail(err, i, "its depth is not one more than that of its parent");
    }
    size_t parent = 0; /* the innermost subtree that holds node i */
    for (size_t i = 1; i < d->nnodes; i++) {
        while (i >= parent + d->nodes[parent].length)
            parent -= d->nodes[parent].parent;
        if (i - d->nodes[i].parent != parent)
            return check_fail(err, i, "lengths and parents disagree");
        parent = i;
    }
    return SG_OK;
}

static bool close_to(double a, double b)
{
    return fabs(a - b) <= 1e-9 * (1 + fabs(b)) || (isnan(a) && isnan(b)) || (isinf(a) && isinf(b) && (a > 0) == (b > 0));
}

static sg_status check_draws(const sg_derivation *d, size_t node, const sg_rule *r, double *frame, sg_error *err)
{
    const sg_node *n = d->nodes + node;
    const uint32_t nparams = sg_grammar_symbol(d->grammar, n->symbol)->nparams;
    const double *stored = d->values + n->values;
    for (uint32_t i = 0; i < r->nuniforms; i++)
        if (!(sg_uniform_plain(d->uniforms[n->uniforms + i]) > 0 && d->uniforms[n->uniforms + i] < 1))
            return check_fail(err, node, "a uniform is not in (0,1)");
    for (uint32_t i = 0; i < nparams; i++)
        frame[i] = stored[i];
    if (sg_derivation_transform(d->grammar, r, nparams, n->depth, d->uniforms + n->uniforms, frame, err) != SG_OK)
        return check_fail(err, node, "its uniforms cannot be transformed");
    for (uint32_t i = 0; i < r->nvalues; i++)
        if (!close_to(stored[nparams + i], frame[nparams + i]))
            return check_fail(err, node, "its values are not those of its uniforms");
    return SG_OK;
}

static sg_status check_child(const sg_derivation *d, size_t child, const sg_op *op, const sg_node *parent, double *args,
                             sg_error *err)
{
    const sg_node *n = d->nodes + child;
    if (n->symbol != op->symbol)
        return check_fail(err, child, "its symbol is not the one that the parent's rule asks for");
    if (sg_derivation_eval_args(d->grammar, op, d->values + parent->values, parent->depth, args, NULL) != SG_OK)
        return check_fail(err, child, "an argument is not a number");
    for (uint32_t i = 0; i < op->nargs; i++)
        if (!close_to(d->values[n->values + i], args[i]))
            return check_fail(err, child, "its arguments are not those that its parent gives");
    return SG_OK;
}

static sg_status check_node(const sg_derivation *d, size_t node, double *scratch, sg_child_list *list, sg_error *err)
{
    const sg_node *n = d->nodes + node;
    const sg_rule *r = sg_node_rule(d, n);
    if (r == NULL)
        return n->length == 1 ? SG_OK : check_fail(err, node, "it has no rule, and children");
    SG_TRY(check_draws(d, node, r, scratch, err));
    list->n = 0;
    SG_TRY(sg_derivation_list_children(d->grammar, r, d->values + n->values, n->depth, (uint32_t)node, d->nnodes, list,
                                       err));
    const size_t end = node + n->length;
    size_t child = node + 1;
    for (size_t i = 0; i < list->n; i++) {
        if (child >= end)
            return check_fail(err, node, "it has fewer children than its rule asks for");
        SG_TRY(check_child(d, child, r->ops + list->items[i].op, n, scratch, err));
        child += d->nodes[child].length;
    }
    return child == end ? SG_OK : check_fail(err, node, "it has more children than its rule asks for");
}

/* Most values that a frame or a list of arguments of this derivation needs. */
static size_t scratch_size(const sg_derivation *d)
{
    size_t n = sg_grammar_frame_size(d->grammar) + 1;
    for (size_t i = 0; i < d->nnodes; i++) {
        const size_t nparams = sg_grammar_symbol(d->grammar, d->nodes[i].symbol)->nparams;
        n = nparams > n ? nparams : n;
    }
    return n;
}

sg_status sg_derivation_check(const sg_derivation *d, sg_error *err)
{
    if (d->nnodes == 0)
        return d->nvalues == 0 && d->nuniforms == 0 ? SG_OK : SG_FAIL(err, SG_EINVAL, "values, and no node");
    SG_TRY(check_slices(d, err));
    SG_TRY(check_tree(d, err));
    double *scratch = malloc(scratch_size(d) * sizeof *scratch);
    sg_child_list list = {0};
    sg_status st = scratch != NULL ? SG_OK : SG_FAIL_NOMEM(err);
    for (size_t i = 0; st == SG_OK && i < d->nnodes; i++)
        st = check_node(d, i, scratch, &list, err);
    free(scratch);
    free(list.items);
    return st == SG_ENUMERIC ? SG_EINVAL : st; /* a repeat count that is impossible */
}
