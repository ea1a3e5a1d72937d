/* SPDX-License-Identifier: GPL-3.0-or-later */
/* energy.c - the two data terms and the description length. */
#include "config.h"

#include "learn/energy.h"

#include <math.h>
#include <stdlib.h>

/* lgamma() writes the global signgam, which threads must not share. */
static double log_gamma(double x)
{
    int sign;
    return lgamma_r(x, &sign);
}

/* x log y with 0 log 0 = 0. */
static double x_log_y(double x, double y)
{
    return x != 0 ? x * log(y) : 0;
}

double sg_energy_rule_term(const sg_energy_opts *o, double count)
{
    if (o->data_term == SG_DATA_MARGINAL)
        return log_gamma(o->alpha + count) - log_gamma(o->alpha);
    const double a = o->alpha - 1;
    return x_log_y(count + o->weight * a, count + a);
}

double sg_energy_symbol_term(const sg_energy_opts *o, size_t nrules, double count)
{
    const double k = (double)nrules;
    if (nrules == 0)
        return 0;
    if (o->data_term == SG_DATA_MARGINAL)
        return log_gamma(k * o->alpha) - log_gamma(k * o->alpha + count);
    const double a = o->alpha - 1;
    return o->weight * (log_gamma(k * o->alpha) - k * log_gamma(o->alpha)) -
           x_log_y(count + o->weight * k * a, count + k * a);
}

double sg_energy_log_length(const sg_energy_opts *o, size_t n)
{
    if (!o->poisson)
        return 0;
    return (double)(n - 1) * log(o->mu) - o->mu - log_gamma((double)n);
}

double sg_energy_probability(const sg_energy_opts *o, double count, size_t nrules, double total)
{
    const double a = o->data_term == SG_DATA_MARGINAL ? o->alpha : o->alpha - 1;
    const double mass = total + (double)nrules * a;
    return mass > 0 ? fmax(count + a, 0) / mass : 1 / (double)nrules;
}

static double structure_prior(const sg_energy_opts *o, const sg_split_form *form)
{
    double log_prior = 0;
    for (size_t r = 0; r < form->nrules; r++) {
        const sg_split_rule *rule = &form->rules[r];
        if (rule->op == SG_SPLIT_LEXICAL)
            log_prior -= log((double)form->nterminals);
        else
            log_prior += sg_energy_log_length(o, rule->n) - (double)rule->n * log((double)form->nsymbols);
    }
    return log_prior;
}

/* Dirichlet-multinomial of the uses of one symbol: the sequence of its uses, theta integrated out. */
static double marginal_likelihood(double alpha, const double *c, size_t k)
{
    double total = 0, log_p = 0;
    for (size_t r = 0; r < k; r++) {
        total += c[r];
        log_p += log_gamma(alpha + c[r]) - log_gamma(alpha);
    }
    return log_p + log_gamma((double)k * alpha) - log_gamma((double)k * alpha + total);
}

static void add_viterbi_parts(const sg_energy_opts *o, const double *c, size_t k, sg_energy_parts *out)
{
    double total = 0;
    for (size_t r = 0; r < k; r++)
        total += c[r];
    out->log_parameter_prior += log_gamma((double)k * o->alpha) - (double)k * log_gamma(o->alpha);
    for (size_t r = 0; r < k; r++) {
        const double theta = sg_energy_probability(o, c[r], k, total);
        out->log_likelihood += x_log_y(c[r], theta);
        out->log_parameter_prior += x_log_y(o->alpha - 1, theta);
    }
}

sg_status sg_energy_of_form(const sg_energy_opts *o, const sg_split_form *form, const double *counts,
                            sg_energy_parts *out, sg_error *err)
{
    sg_energy_parts parts = {.log_structure_prior = structure_prior(o, form)};
    for (size_t r = 0, end; r < form->nrules; r = end) {
        for (end = r; end < form->nrules && form->rules[end].lhs == form->rules[r].lhs;)
            end++;
        if (o->data_term == SG_DATA_MARGINAL)
            parts.log_likelihood += marginal_likelihood(o->alpha, counts + r, end - r);
        else
            add_viterbi_parts(o, counts + r, end - r, &parts);
    }
    parts.energy = -o->weight * (parts.log_structure_prior + parts.log_parameter_prior) - parts.log_likelihood;
    if (!isfinite(parts.energy))
        return SG_FAIL(err, SG_ENUMERIC, "the energy is not finite: a rule has a count for which it is undefined");
    *out = parts;
    return SG_OK;
}
