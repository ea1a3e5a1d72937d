/* SPDX-License-Identifier: GPL-3.0-or-later */
/* label_sets.c - which labels a symbol can reach. */
#include "learn/label_sets_priv.h"

/* Add set b to set a; true when that changed a. */
static bool unite(uint64_t *a, const uint64_t *b, size_t nwords)
{
    bool changed = false;
    for (size_t i = 0; i < nwords; i++) {
        const uint64_t u = a[i] | b[i];
        changed |= u != a[i];
        a[i] = u;
    }
    return changed;
}

sg_status sg_label_sets_of(const sg_split_form *f, sg_arena *arena, sg_label_sets *out, sg_error *err)
{
    out->nsymbols = f->nsymbols;
    out->nwords = f->nterminals / 64 + 1;
    out->bits = SG_NEW_ARRAY(arena, uint64_t, out->nsymbols * out->nwords);
    if (out->bits == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t i = 0; i < f->nrules; i++) {
        const sg_split_rule *r = &f->rules[i];
        if (r->op == SG_SPLIT_LEXICAL)
            out->bits[r->lhs * out->nwords + r->rhs[0] / 64] |= UINT64_C(1) << r->rhs[0] % 64;
    }
    for (bool changed = true; changed;) {
        changed = false;
        for (size_t i = f->nrules; i-- > 0;) { /* symbols made later tend to stand below earlier ones */
            const sg_split_rule *r = &f->rules[i];
            uint64_t *to = out->bits + r->lhs * out->nwords;
            for (uint32_t k = 0; r->op != SG_SPLIT_LEXICAL && k < r->n; k++)
                changed |= unite(to, out->bits + r->rhs[k] * out->nwords, out->nwords);
        }
    }
    return SG_OK;
}

size_t sg_label_sets_size(const sg_label_sets *sets, uint32_t symbol)
{
    size_t n = 0;
    for (size_t i = 0; i < sets->nwords; i++)
        n += (size_t)__builtin_popcountll(sets->bits[symbol * sets->nwords + i]);
    return n;
}
