/* SPDX-License-Identifier: GPL-3.0-or-later */
/* finish.c - collapsing, uniting and the densities of sizes. */
#include "learn/finish.h"

#include "learn/label_sets_priv.h"
#include "learn/rule_builder_priv.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#define LEAST_VARIANCE (0.01 * 0.01)

static void mean_of(const double *sizes, size_t m, size_t n, double *mean)
{
    memset(mean, 0, n * sizeof *mean);
    for (size_t k = 0; k < m; k++)
        for (size_t i = 0; i < n; i++)
            mean[i] += sizes[k * n + i] / (double)m;
}

/* Towards its own diagonal, which leaves that as it is. */
static double shrink_to_diagonal(double s, double m, double nu0, bool diagonal)
{
    if (!diagonal)
        return s * m / (m + nu0);
    return s < LEAST_VARIANCE ? LEAST_VARIANCE : s;
}

void sg_fit_sizes(const double *sizes, size_t m, size_t n, double concentration, double *mean, double *covariance)
{
    const size_t free_sizes = n - 1;
    mean_of(sizes, m, n, mean);
    const double nu0 = (double)n + 1;
    for (size_t i = 0; i < free_sizes; i++)
        for (size_t j = 0; j <= i; j++) {
            double s = 0;
            for (size_t k = 0; k < m; k++)
                s += (sizes[k * n + i] - mean[i]) * (sizes[k * n + j] - mean[j]) / (double)m;
            if (concentration > 0)
                s = ((double)m * s + nu0 * mean[i] * ((i == j) - mean[j]) / (concentration + 1)) / ((double)m + nu0);
            else
                s = shrink_to_diagonal(s, (double)m, nu0, i == j);
            covariance[i * free_sizes + j] = covariance[j * free_sizes + i] = s;
        }
}

/* The mean of a size in the uses of a rule. */
static double mean_size(const sg_split_rule *r, uint32_t i)
{
    double sum = 0;
    for (size_t k = 0; k < r->nattributes; k++)
        sum += r->attributes[k * r->n + i];
    return sum / (double)r->nattributes;
}

double sg_pooled_concentration(const sg_split_form *f, sg_split_op axis)
{
    double varied = 0, possible = 0;
    for (size_t r = 0; r < f->nrules; r++) {
        const sg_split_rule *rule = &f->rules[r];
        const double m = (double)rule->nattributes;
        if (rule->op != axis || rule->n < 2 || m < 2)
            continue;
        for (uint32_t i = 0; i < rule->n; i++) {
            const double mean = mean_size(rule, i);
            for (size_t k = 0; k < rule->nattributes; k++)
                varied += m / (m - 1) * pow(rule->attributes[k * rule->n + i] - mean, 2);
            possible += m * mean * (1 - mean);
        }
    }
    return varied > 0 ? fmax(possible / varied - 1, 0) : 0;
}

/* invariant[X]: a region of X that is cut along the axis is two regions of X. Least fixed point, so no cycle counts. */
static void find_invariant(const sg_split_form *f, const sg_label_sets *sets, sg_split_op axis, bool *invariant)
{
    for (uint32_t x = 0; x < f->nsymbols; x++)
        invariant[x] = sg_label_sets_size(sets, x) == 1;
    for (bool changed = true; changed;) {
        changed = false;
        for (size_t r = 0; r < f->nrules; r++) {
            const sg_split_rule *rule = &f->rules[r];
            const bool only_rule = (r == 0 || f->rules[r - 1].lhs != rule->lhs) &&
                                   (r + 1 == f->nrules || f->rules[r + 1].lhs != rule->lhs);
            if (invariant[rule->lhs] || !only_rule || (rule->op == axis && rule->n > 1))
                continue;
            bool all = true;
            for (uint32_t i = 0; i < rule->n && all; i++)
                all = invariant[rule->rhs[i]];
            if (all)
                invariant[rule->lhs] = changed = true;
        }
    }
}

/* first[i]: where part i of the collapsed right-hand side begins in the old one. @return length of the new one */
static size_t collapse(const sg_split_rule *r, const bool *invariant, uint32_t *first)
{
    size_t n = 0;
    for (uint32_t i = 0; i < r->n; i++)
        if (i == 0 || r->rhs[i] != r->rhs[i - 1] || !invariant[r->rhs[i]])
            first[n++] = i;
    first[n] = r->n;
    return n;
}

typedef struct {
    const sg_split_form *form;
    sg_arena *arena;
    sg_rule_builder *builder;
    const bool *invariant[2]; /* by sg_split_op */
    uint32_t *symbol;         /* [nsymbols] in the builder, SG_NONE: not reached yet */
    uint32_t *stack;          /* reached, rules not taken over yet */
    size_t nstack;
} work;

static sg_status reach(work *w, uint32_t x)
{
    if (w->symbol[x] != SG_NONE)
        return SG_OK;
    w->symbol[x] = sg_rule_builder_symbol(w->builder, &x, 1, NULL);
    if (w->symbol[x] == SG_NONE)
        return SG_ENOMEM;
    sg_rule_builder_name(w->builder, w->symbol[x], w->form->symbol_names[x]);
    w->stack[w->nstack++] = x;
    return SG_OK;
}

static sg_status add_sizes(work *w, const sg_split_rule *r, uint32_t lhs, const uint32_t *rhs, const uint32_t *first,
                           size_t n)
{
    double *sum = SG_NEW_ARRAY(w->arena, double, n);
    if (sum == NULL)
        return SG_ENOMEM;
    for (size_t k = 0; k < r->nattributes; k++) {
        memset(sum, 0, n * sizeof *sum);
        for (size_t i = 0; i < n; i++)
            for (uint32_t j = first[i]; j < first[i + 1]; j++)
                sum[i] += r->attributes[k * r->n + j];
        SG_TRY(sg_rule_builder_use(w->builder, lhs, r->op, rhs, n, 0, sum));
    }
    return SG_OK;
}

static sg_status take_split(work *w, const sg_split_rule *r)
{
    uint32_t *first = SG_NEW_ARRAY(w->arena, uint32_t, r->n + 1), *rhs = SG_NEW_ARRAY(w->arena, uint32_t, r->n);
    if (first == NULL || rhs == NULL)
        return SG_ENOMEM;
    const size_t n = collapse(r, w->invariant[r->op], first);
    if (n == 1 && r->rhs[0] == r->lhs)
        return SG_OK;
    for (size_t i = 0; i < n; i++) {
        SG_TRY(reach(w, r->rhs[first[i]]));
        rhs[i] = w->symbol[r->rhs[first[i]]];
    }
    const uint32_t lhs = w->symbol[r->lhs];
    SG_TRY(sg_rule_builder_use(w->builder, lhs, r->op, rhs, n, r->probability, NULL));
    return add_sizes(w, r, lhs, rhs, first, n);
}

static sg_status take_rules(work *w, uint32_t x)
{
    for (size_t i = 0; i < w->form->nrules; i++) {
        const sg_split_rule *r = &w->form->rules[i];
        if (r->lhs != x || r->probability <= 0)
            continue;
        if (r->op == SG_SPLIT_LEXICAL)
            SG_TRY(sg_rule_builder_use(w->builder, w->symbol[x], r->op, r->rhs, 1, r->probability, NULL));
        else
            SG_TRY(take_split(w, r));
    }
    return SG_OK;
}

static sg_status fit_all(const sg_split_form *f, const sg_density_opts *densities, sg_split_rule *rules, sg_arena *arena)
{
    double concentration[2];
    for (int axis = SG_SPLIT_X; axis <= SG_SPLIT_Y; axis++) {
        const double c = densities->concentration[axis];
        concentration[axis] = c == SG_CONCENTRATION_POOLED ? sg_pooled_concentration(f, (sg_split_op)axis) : c;
    }
    for (size_t i = 0; i < f->nrules; i++) {
        sg_split_rule *r = &rules[i];
        if (r->op == SG_SPLIT_LEXICAL || r->nattributes == 0 || r->n < 2)
            continue;
        double *mean = SG_NEW_ARRAY(arena, double, r->n);
        double *covariance = SG_NEW_ARRAY(arena, double, (size_t)(r->n - 1) * (r->n - 1));
        if (mean == NULL || covariance == NULL)
            return SG_ENOMEM;
        sg_fit_sizes(r->attributes, r->nattributes, r->n, concentration[r->op], mean, covariance);
        r->mean = mean;
        r->covariance = covariance;
    }
    return SG_OK;
}

static sg_status begin(work *w, sg_error *err)
{
    const sg_split_form *f = w->form;
    sg_label_sets sets;
    SG_TRY(sg_label_sets_of(f, w->arena, &sets, err));
    bool *invariant = SG_NEW_ARRAY(w->arena, bool, 2 * f->nsymbols);
    w->builder = sg_rule_builder_create(w->arena);
    w->symbol = SG_NEW_ARRAY(w->arena, uint32_t, f->nsymbols);
    w->stack = SG_NEW_ARRAY(w->arena, uint32_t, f->nsymbols);
    if (invariant == NULL || w->builder == NULL || w->symbol == NULL || w->stack == NULL)
        return SG_FAIL_NOMEM(err);
    for (uint32_t x = 0; x < f->nsymbols; x++)
        w->symbol[x] = SG_NONE;
    for (int axis = SG_SPLIT_X; axis <= SG_SPLIT_Y; axis++) {
        find_invariant(f, &sets, (sg_split_op)axis, invariant + (size_t)axis * f->nsymbols);
        w->invariant[axis] = invariant + (size_t)axis * f->nsymbols;
    }
    return SG_OK;
}

sg_status sg_finish(const sg_split_form *merged, const sg_density_opts *densities, sg_arena *arena, sg_split_form *out,
                    sg_error *err)
{
    work w = {.form = merged, .arena = arena};
    SG_TRY(begin(&w, err));
    sg_status st = reach(&w, merged->axiom);
    for (size_t next = 0; st == SG_OK && next < w.nstack; next++)
        st = take_rules(&w, w.stack[next]);
    if (st != SG_OK)
        return SG_FAIL_NOMEM(err);
    SG_TRY(sg_rule_builder_form(w.builder, out, NULL, err));
    out->name = merged->name;
    out->axiom = w.symbol[merged->axiom];
    out->nterminals = merged->nterminals;
    out->terminal_names = merged->terminal_names;
    out->terminal_colors = merged->terminal_colors;
    out->tied = merged->tied;
    sg_split_rule *rules = sg_arena_copy(arena, out->rules, out->nrules * sizeof *rules);
    if (rules == NULL || fit_all(out, densities, rules, arena) != SG_OK)
        return SG_FAIL_NOMEM(err);
    out->rules = rules;
    return SG_OK;
}
