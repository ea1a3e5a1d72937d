/* SPDX-License-Identifier: GPL-3.0-or-later */
/* compatible.c - kinds and typical sizes of symbols, as words that must be equal for a merge. */
#include "learn/compatible.h"

#include <math.h>
#include <stdlib.h>

enum { PASSES = 16 }; /* more than the depth of an initial grammar, so the sizes have reached every symbol */

typedef struct {
    double log2_w, log2_h, uses; /* sums over uses, then means */
} extent;

static double mean_log2(const sg_split_rule *r, uint32_t part)
{
    double sum = 0;
    for (size_t k = 0; k < r->nattributes; k++)
        sum += log2(fmax(r->attributes[k * r->n + part], 1e-6));
    return r->nattributes > 0 ? sum / (double)r->nattributes : -log2(r->n);
}

/* One pass from left-hand sides to the parts of their rules; before[] of the pass before gives after[]. */
static void pass(const sg_split_form *f, const double *counts, const extent *before, extent *after)
{
    for (size_t x = 0; x < f->nsymbols; x++)
        after[x] = (extent){0, 0, 0};
    for (size_t i = 0; i < f->nrules; i++) {
        const sg_split_rule *r = &f->rules[i];
        for (uint32_t k = 0; r->op != SG_SPLIT_LEXICAL && k < r->n; k++) {
            extent *to = &after[r->rhs[k]];
            const double size = mean_log2(r, k);
            to->log2_w += counts[i] * (before[r->lhs].log2_w + (r->op == SG_SPLIT_X ? size : 0));
            to->log2_h += counts[i] * (before[r->lhs].log2_h + (r->op == SG_SPLIT_Y ? size : 0));
            to->uses += counts[i];
        }
    }
    for (size_t x = 0; x < f->nsymbols; x++)
        if (after[x].uses > 0) {
            after[x].log2_w /= after[x].uses;
            after[x].log2_h /= after[x].uses;
        }
}

static uint64_t size_word(const extent *e)
{
    const long w = lround(-e->log2_w), h = lround(-e->log2_h);
    return ((uint64_t)w & 0xff) << 8 | ((uint64_t)h & 0xff) << 16;
}

static sg_status add_sizes(sg_rules *r, const sg_split_form *f, const double *counts, sg_error *err)
{
    extent *e = calloc(2 * f->nsymbols + 1, sizeof *e);
    if (e == NULL)
        return SG_FAIL_NOMEM(err);
    for (int i = 0; i < PASSES; i++)
        pass(f, counts, e + (i % 2 ? f->nsymbols : 0), e + (i % 2 ? 0 : f->nsymbols));
    for (size_t x = 0; x < f->nsymbols; x++)
        r->symbols[x].kinds |= size_word(&e[x]);
    free(e);
    return SG_OK;
}

sg_status sg_rules_restrict(sg_rules *r, sg_compatible what, const sg_split_form *form, const double *counts,
                            sg_error *err)
{
    r->by_kinds = what != SG_COMPATIBLE_LABELS;
    for (size_t x = 0; x < r->nsymbols; x++)
        r->symbols[x].kinds = 0;
    for (size_t i = 0; i < r->nrules && r->by_kinds; i++)
        if (r->rules[i].alive)
            r->symbols[r->rules[i].lhs].kinds |= (uint64_t)1 << r->rules[i].op;
    if (what == SG_COMPATIBLE_SIZES)
        SG_TRY(add_sizes(r, form, counts, err));
    return sg_rules_find_labels(r, err);
}
