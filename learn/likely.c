/* SPDX-License-Identifier: GPL-3.0-or-later */
/* likely.c - the most probable derivation of each symbol. */
#include "learn/likely_priv.h"

#include <math.h>
#include <stdbool.h>

static double derivation_log_p(const sg_split_rule *r, const double *log_p)
{
    double sum = log(r->probability);
    for (uint32_t i = 0; r->op != SG_SPLIT_LEXICAL && i < r->n; i++)
        sum += log_p[r->rhs[i]];
    return sum;
}

sg_status sg_likely_of(const sg_split_form *f, sg_arena *arena, sg_likely *out, sg_error *err)
{
    *out = (sg_likely){f, SG_NEW_ARRAY(arena, uint32_t, f->nsymbols), SG_NEW_ARRAY(arena, double, f->nsymbols),
                       SG_NEW_ARRAY(arena, uint32_t, f->nsymbols + 1)};
    if (out->best == NULL || out->log_p == NULL || out->first == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t i = 0; i < f->nrules; i++)
        out->first[f->rules[i].lhs + 1]++;
    for (size_t x = 0; x < f->nsymbols; x++) {
        out->first[x + 1] += out->first[x];
        out->best[x] = SG_NONE;
        out->log_p[x] = -INFINITY;
    }
    /* Improvements are strict, and each round fixes at least one symbol for good: it ends. */
    for (bool changed = true; changed;) {
        changed = false;
        for (size_t i = 0; i < f->nrules; i++) {
            const double p = derivation_log_p(&f->rules[i], out->log_p);
            if (p > out->log_p[f->rules[i].lhs]) {
                out->log_p[f->rules[i].lhs] = p;
                out->best[f->rules[i].lhs] = (uint32_t)i;
                changed = true;
            }
        }
    }
    return SG_OK;
}

double sg_likely_size(const sg_split_rule *r, uint32_t i)
{
    if (r->mean != NULL)
        return r->mean[i];
    double sum = 0;
    for (size_t k = 0; k < r->nattributes; k++)
        sum += r->attributes[k * r->n + i];
    return r->nattributes > 0 ? sum / (double)r->nattributes : 1.0 / r->n;
}
