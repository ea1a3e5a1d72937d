/* SPDX-License-Identifier: GPL-3.0-or-later */
/* earley_em.c - expectation and maximisation over the Earley parser. */
#include "config.h"

#include "parse/earley_em.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    const sg_split_form *form;
    const sg_cells *cells;
    size_t n;
    const sg_em_opts *opts;
    sg_parse_table *table;
    sg_chart *chart;
    double *counts;   /* [nrules] */
    double *totals;   /* [nsymbols] */
    double objective; /* of the probabilities that the counts were made with */
} em;

static sg_status count_lattice(em *e, size_t i, double *log_value, sg_error *err)
{
    const bool viterbi = e->opts->kind == SG_EM_VITERBI;
    SG_TRY((viterbi ? sg_earley_viterbi : sg_earley_inside)(e->table, &e->cells[i], e->chart, log_value, err));
    if (*log_value == -INFINITY)
        return SG_FAIL(err, SG_ENOPARSE, "lattice %zu is outside the language: nothing is re-estimated", i + 1);
    return (viterbi ? sg_earley_viterbi_counts : sg_earley_expected_counts)(e->table, e->chart, e->counts, err);
}

/* Counts and objective under the probabilities p. */
static sg_status expect(em *e, const double *p, sg_progress *progress, sg_error *err)
{
    SG_TRY(sg_parse_table_set_probabilities(e->table, p, err));
    memset(e->counts, 0, e->form->nrules * sizeof *e->counts);
    e->objective = 0;
    for (size_t i = 0; i < e->n; i++) {
        double log_value;
        if (sg_progress_stopped(progress))
            return SG_FAIL(err, SG_STOPPED, "stopped");
        SG_TRY(count_lattice(e, i, &log_value, err));
        e->objective += log_value;
    }
    for (size_t r = 0; e->opts->alpha != 1 && r < e->form->nrules; r++)
        e->objective += (e->opts->alpha - 1) * log(p[r]);
    return SG_OK;
}

static void maximise(em *e, double *p)
{
    memset(e->totals, 0, e->form->nsymbols * sizeof *e->totals);
    for (size_t r = 0; r < e->form->nrules; r++)
        e->totals[e->form->rules[r].lhs] += e->counts[r] + e->opts->alpha - 1;
    for (size_t r = 0; r < e->form->nrules; r++)
        if (e->totals[e->form->rules[r].lhs] > 0)
            p[r] = (e->counts[r] + e->opts->alpha - 1) / e->totals[e->form->rules[r].lhs];
}

static sg_status iterate(em *e, sg_progress *progress, double *p, double *objective, size_t *niterations, sg_error *err)
{
    size_t k = 0;
    SG_TRY(expect(e, p, progress, err));
    for (;; k++) {
        const double before = e->objective;
        if (objective != NULL)
            objective[k] = before;
        *niterations = k;
        if (k == e->opts->iterations)
            return SG_OK;
        sg_progress_report(progress, "iterations", k, e->opts->iterations);
        maximise(e, p);
        const sg_status st = expect(e, p, progress, err);
        if (st != SG_OK)
            return st;
        if (e->objective - before <= e->opts->tolerance * fabs(before)) {
            *niterations = k + 1;
            if (objective != NULL)
                objective[k + 1] = e->objective;
            return SG_OK;
        }
    }
}

static sg_status check(const sg_split_form *form, size_t n, const sg_em_opts *opts, sg_error *err)
{
    if (n == 0)
        return SG_FAIL(err, SG_EINVAL, "re-estimation wants a lattice");
    if (!(opts->alpha >= 1 && opts->alpha < INFINITY))
        return SG_FAIL(err, SG_EINVAL, "the prior's alpha is %g; re-estimation wants 1 or more", opts->alpha);
    for (size_t r = 0; r < form->nrules; r++)
        if (opts->alpha != 1 && form->rules[r].probability == 0)
            return SG_FAIL(err, SG_EINVAL, "rule %zu has probability 0, which a prior with alpha above 1 excludes", r);
    return SG_OK;
}

sg_status sg_em_reestimate(const sg_split_form *form, const sg_cells *cells, size_t n, const sg_em_opts *opts,
                           sg_progress *progress, double *probabilities, double *objective, size_t *niterations,
                           sg_error *err)
{
    em e = {.form = form, .cells = cells, .n = n, .opts = opts};
    size_t made = 0;
    SG_TRY(check(form, n, opts, err));
    sg_status st = sg_parse_table_create(form, opts->mode, &e.table, err);
    if (st == SG_OK)
        st = sg_chart_create(&e.chart, err);
    e.counts = calloc(form->nrules + 1, sizeof *e.counts);
    e.totals = calloc(form->nsymbols, sizeof *e.totals);
    if (st == SG_OK && (e.counts == NULL || e.totals == NULL))
        st = SG_FAIL_NOMEM(err);
    for (size_t r = 0; r < form->nrules; r++)
        probabilities[r] = form->rules[r].probability;
    if (st == SG_OK)
        st = iterate(&e, progress, probabilities, objective, &made, err);
    if (niterations != NULL)
        *niterations = made;
    free(e.counts);
    free(e.totals);
    sg_chart_free(e.chart);
    sg_parse_table_free(e.table);
    return st;
}
