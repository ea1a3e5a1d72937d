/* SPDX-License-Identifier: GPL-3.0-or-later */
/* earley_tied.c - tied siblings: within one node equal symbols of the right-hand side share one derivation.
 *
 * Where the symbol has one derivation only, sharing changes nothing, and the rule is an ordinary one. Otherwise:
 * - over labels in cell mode a derivation fixes every cell that it covers, so the occurrences share one exactly when
 * they are equal cell by cell; then all derivations of the one are derivations of the other, and the rectangle counts
 * once. Such a rule is followed child by child with the cuts made so far (no trie: what may come depends on them). The
 * work grows with the number of ways to place the distinct symbols, which labels keep small.
 * - in region mode and over costs the occurrences can differ in size and contents under one derivation. Their value is
 * a sum over pairs of rectangles and does not factor over rectangles: there is no exact parse here, and the call says
 * so. */
#include "config.h"

#include "parse/earley_priv.h"

#include <stdlib.h>
#include <string.h>

/* Symbols with exactly one derivation. */
static void find_rigid(const sg_parse_table *t, bool *rigid)
{
    for (bool changed = true; changed;) {
        changed = false;
        for (uint32_t s = 0; s < t->nsymbols; s++) {
            if (rigid[s] || t->rule_start[s + 1] - t->rule_start[s] != 1)
                continue;
            const sg_table_rule *r = &t->rules[t->rule_order[t->rule_start[s]]];
            bool all = r->used;
            for (uint32_t i = 0; all && i < r->nchildren; i++)
                all = rigid[r->rhs[i]];
            rigid[s] = all;
            changed |= all;
        }
    }
}

/* Place of the first equal symbol of each; whether any symbol with several derivations is repeated; how many differ. */
static bool find_repeats(const sg_table_rule *r, const bool *rigid, uint32_t *first_seen, uint32_t *first_of,
                         uint32_t *distinct)
{
    bool repeats = false;
    *distinct = 0;
    for (uint32_t i = 0; i < r->n; i++) {
        uint32_t *seen = &first_seen[r->rhs[i]];
        first_of[i] = *seen < i && r->rhs[*seen] == r->rhs[i] ? *seen : i;
        *seen = first_of[i];
        repeats |= first_of[i] != i && !rigid[r->rhs[i]];
        *distinct += first_of[i] == i;
    }
    return repeats;
}

static sg_status mark_rules(sg_parse_table *t, const sg_split_form *form, const bool *rigid, uint32_t *first_seen,
                            size_t *ntied, sg_error *err)
{
    for (uint32_t k = 0; k < t->nrules; k++) {
        sg_table_rule *r = &t->rules[k];
        if (!r->used || r->op == SG_SPLIT_LEXICAL || r->n < 2)
            continue;
        uint32_t distinct;
        uint32_t *first_of = sg_arena_alloc(t->arena, r->n * sizeof *first_of);
        if (first_of == NULL)
            return SG_FAIL_NOMEM(err);
        if (!find_repeats(r, rigid, first_seen, first_of, &distinct))
            continue;
        if (t->mode == SG_REGION_MODE)
            return SG_FAIL(err, SG_EINVAL,
                           "tied siblings: a rule of %s repeats a symbol with several derivations; there is "
                           "no exact parse by regions",
                           form->symbol_names[r->lhs]);
        r->first_of = first_of;
        r->nchildren = distinct;
        t->longest_tied = r->n > t->longest_tied ? r->n : t->longest_tied;
        (*ntied)++;
    }
    return SG_OK;
}

static sg_status index_rules(sg_parse_table *t, size_t ntied, sg_error *err)
{
    t->tied_start = SG_NEW_ARRAY(t->arena, uint32_t, t->nsymbols + 2);
    t->tied_rules = SG_NEW_ARRAY(t->arena, uint32_t, ntied);
    if (t->tied_start == NULL || t->tied_rules == NULL)
        return SG_FAIL_NOMEM(err);
    for (uint32_t k = 0; k < t->nrules; k++)
        if (t->rules[k].first_of != NULL)
            t->tied_start[t->rules[k].rhs[0] + 2]++;
    for (uint32_t s = 0; s < t->nsymbols; s++)
        t->tied_start[s + 2] += t->tied_start[s + 1];
    for (uint32_t k = 0; k < t->nrules; k++)
        if (t->rules[k].first_of != NULL)
            t->tied_rules[t->tied_start[t->rules[k].rhs[0] + 1]++] = k;
    return SG_OK;
}

sg_status sg_tied_find(sg_parse_table *t, const sg_split_form *form, sg_error *err)
{
    bool *rigid = calloc(t->nsymbols, sizeof *rigid);
    uint32_t *first_seen = calloc(t->nsymbols, sizeof *first_seen);
    size_t ntied = 0;
    sg_status st = rigid != NULL && first_seen != NULL ? SG_OK : SG_FAIL_NOMEM(err);
    if (st == SG_OK) {
        find_rigid(t, rigid);
        st = mark_rules(t, form, rigid, first_seen, &ntied, err);
    }
    free(rigid);
    free(first_seen);
    return st == SG_OK && ntied > 0 ? index_rules(t, ntied, err) : st;
}

bool sg_tied_repeats(const sg_chart *c, const sg_table_rule *r, uint32_t i, uint32_t *bounds, uint32_t x, uint32_t y,
                     uint32_t across)
{
    const uint32_t first = r->first_of[i], length = bounds[first + 1] - bounds[first];
    const bool along_x = r->op == SG_SPLIT_X;
    if (bounds[i] + length > (along_x ? c->width : c->height))
        return false;
    const uint32_t x0 = along_x ? bounds[first] : x, y0 = along_x ? y : bounds[first];
    const uint32_t shift_x = along_x ? bounds[i] - bounds[first] : 0, shift_y = along_x ? 0 : bounds[i] - bounds[first];
    const uint32_t width = along_x ? length : across - x, height = along_x ? across - y : length;
    for (uint32_t j = y0; j < y0 + height; j++) {
        const uint16_t *row = c->labels + (size_t)j * c->width + x0;
        if (memcmp(row, row + (size_t)shift_y * c->width + shift_x, width * sizeof *row) != 0)
            return false;
    }
    bounds[i + 1] = bounds[i] + length;
    return true;
}
