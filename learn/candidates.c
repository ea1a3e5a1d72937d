/* SPDX-License-Identifier: GPL-3.0-or-later */
/* candidates.c - the heap of plain pairs and the list of special ones. */
#include "config.h"

#include "learn/candidates.h"

#include "core/array.h"

#include <stdlib.h>
#include <string.h>

void sg_candidates_clear(sg_candidates *c)
{
    free(c->heap);
    free(c->coincidences);
    free(c->specials);
    free(c->scratch);
    free(c->old_specials);
    memset(c, 0, sizeof *c);
}

sg_status sg_candidates_copy(sg_candidates *dst, const sg_candidates *src, sg_error *err)
{
    if (!SG_GROW(dst->heap, dst->heap_capacity, src->nheap) ||
        !SG_GROW(dst->coincidences, dst->coincidences_capacity, src->ncoincidences) ||
        !SG_GROW(dst->specials, dst->specials_capacity, src->nspecials))
        return SG_FAIL_NOMEM(err);
    dst->nheap = src->nheap;
    dst->ncoincidences = src->ncoincidences;
    dst->nspecials = src->nspecials;
    if (src->nheap > 0)
        memcpy(dst->heap, src->heap, src->nheap * sizeof *src->heap);
    if (src->ncoincidences > 0)
        memcpy(dst->coincidences, src->coincidences, src->ncoincidences * sizeof *src->coincidences);
    if (src->nspecials > 0)
        memcpy(dst->specials, src->specials, src->nspecials * sizeof *src->specials);
    return SG_OK;
}

static bool before(const sg_candidate *x, const sg_candidate *y)
{
    if (x->key != y->key)
        return x->key < y->key;
    if (x->a != y->a)
        return x->a < y->a;
    return x->b < y->b;
}

/* ---- heap ---- */

static void sift_down(sg_candidates *c, size_t i)
{
    const sg_heap_entry e = c->heap[i];
    for (size_t child; (child = 2 * i + 1) < c->nheap; i = child) {
        if (child + 1 < c->nheap && before(&c->heap[child + 1].candidate, &c->heap[child].candidate))
            child++;
        if (!before(&c->heap[child].candidate, &e.candidate))
            break;
        c->heap[i] = c->heap[child];
    }
    c->heap[i] = e;
}

static void sift_up(sg_candidates *c, size_t i)
{
    const sg_heap_entry e = c->heap[i];
    for (size_t parent; i > 0; i = parent) {
        parent = (i - 1) / 2;
        if (!before(&e.candidate, &c->heap[parent].candidate))
            break;
        c->heap[i] = c->heap[parent];
    }
    c->heap[i] = e;
}

static void pop(sg_candidates *c)
{
    c->heap[0] = c->heap[--c->nheap];
    if (c->nheap > 0)
        sift_down(c, 0);
}

static bool append(sg_candidates *c, const sg_rules *r, uint32_t a, uint32_t b)
{
    if (!SG_GROW(c->heap, c->heap_capacity, c->nheap + 1))
        return false;
    const uint32_t low = a < b ? a : b, high = a < b ? b : a;
    c->heap[c->nheap++] = (sg_heap_entry){
        {sg_merge_plain_part(r, low, high), low, high}, r->symbols[low].version, r->symbols[high].version};
    return true;
}

static bool push(sg_candidates *c, const sg_rules *r, uint32_t a, uint32_t b)
{
    if (!append(c, r, a, b))
        return false;
    sift_up(c, c->nheap - 1);
    return true;
}

static bool fill_heap(sg_candidates *c, const sg_rules *r)
{
    c->nheap = 0;
    for (uint32_t a = 0; a < r->nsymbols; a++) {
        if (!r->symbols[a].alive || a == r->axiom)
            continue;
        for (uint32_t b = a + 1; b < r->nsymbols; b++)
            if (sg_rules_compatible(r, a, b) && !append(c, r, a, b))
                return false;
    }
    for (size_t i = c->nheap / 2; i-- > 0;)
        sift_down(c, i);
    return true;
}

/* ---- coincidences ---- */

static int by_pair(const void *p, const void *q)
{
    const sg_coincidence *x = p, *y = q;
    const uint32_t u[4] = {x->a, x->b, x->rule, x->other}, v[4] = {y->a, y->b, y->rule, y->other};
    for (int i = 0; i < 4; i++)
        if (u[i] != v[i])
            return u[i] < v[i] ? -1 : 1;
    return 0;
}

static bool add_fresh(sg_candidates *c, uint32_t a, uint32_t b, uint32_t rule, uint32_t other)
{
    if (!SG_GROW(c->coincidences, c->coincidences_capacity, c->ncoincidences + 1))
        return false;
    const bool swap = other != SG_NONE && other < rule;
    c->coincidences[c->ncoincidences++] = (sg_coincidence){a, b, swap ? other : rule, swap ? rule : other, true};
    return true;
}

/* Coincidences of one rule with the rules of its bucket; of two changed rules the lower one looks. */
static bool look_around(sg_candidates *c, const sg_rules *r, uint32_t rule, uint32_t changed_mark)
{
    const sg_learn_rule *x = &r->rules[rule];
    if (x->op != SG_SPLIT_LEXICAL && x->n == 1) {
        const uint32_t s = r->rhs[x->first];
        if (sg_rules_compatible(r, x->lhs, s) &&
            !add_fresh(c, x->lhs < s ? x->lhs : s, x->lhs < s ? s : x->lhs, rule, SG_NONE))
            return false;
    }
    for (uint32_t j = sg_rules_bucket(r, rule); j != SG_NONE; j = r->rules[j].next_in_bucket) {
        uint32_t a, b;
        if (j == rule || (j < rule && r->rules[j].stamp == changed_mark))
            continue;
        if (sg_rules_compare(r, rule, j, &a, &b) == SG_RULES_PAIR && !add_fresh(c, a, b, rule, j))
            return false;
    }
    return true;
}

/* Merge the two sorted runs [0, middle) and [middle, n) of the coincidences. */
static bool merge_runs(sg_candidates *c, size_t middle)
{
    const size_t n = c->ncoincidences;
    if (middle == n)
        return true;
    qsort(c->coincidences + middle, n - middle, sizeof *c->coincidences, by_pair);
    if (!SG_GROW(c->scratch, c->scratch_capacity, n))
        return false;
    size_t i = 0, j = middle;
    for (size_t k = 0; k < n; k++) {
        const bool left = j >= n || (i < middle && by_pair(&c->coincidences[i], &c->coincidences[j]) < 0);
        c->scratch[k] = c->coincidences[left ? i++ : j++];
    }
    memcpy(c->coincidences, c->scratch, n * sizeof *c->scratch);
    return true;
}

/* ---- special pairs ---- */

static int compare_pairs(uint32_t a, uint32_t b, const sg_special_pair *p)
{
    if (a != p->a)
        return a < p->a ? -1 : 1;
    return (b > p->b) - (b < p->b);
}

static bool is_special(const sg_candidates *c, uint32_t a, uint32_t b)
{
    size_t low = 0, high = c->nspecials;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        const int order = compare_pairs(a, b, &c->specials[middle]);
        if (order == 0)
            return true;
        if (order < 0)
            high = middle;
        else
            low = middle + 1;
    }
    return false;
}

/* A part may be kept when no coincidence came or went and no symbol that it speaks of changed. */
static bool is_unchanged(const sg_rules *r, const sg_coincidence *run, uint32_t n, const sg_special_pair *old,
                         uint32_t mark)
{
    if (old == NULL || old->n != n || r->symbols[run->a].stamp == mark || r->symbols[run->b].stamp == mark)
        return false;
    for (uint32_t i = 0; i < n; i++)
        if (run[i].fresh || r->symbols[r->rules[run[i].rule].lhs].stamp == mark)
            return false;
    return true;
}

/* A pair whose coincidences are gone is a plain one again. */
static bool release(sg_candidates *c, const sg_rules *r, const sg_special_pair *p)
{
    return !sg_rules_compatible(r, p->a, p->b) || push(c, r, p->a, p->b);
}

static sg_status list_specials(sg_candidates *c, sg_rules *r, uint32_t mark, sg_error *err)
{
    const size_t nold = c->nspecials;
    if (!SG_GROW(c->old_specials, c->old_capacity, nold) ||
        !SG_GROW(c->specials, c->specials_capacity, c->ncoincidences))
        return SG_FAIL_NOMEM(err);
    if (nold > 0)
        memcpy(c->old_specials, c->specials, nold * sizeof *c->specials);
    c->nspecials = 0;
    size_t old = 0;
    for (size_t i = 0, end; i < c->ncoincidences; i = end) {
        const sg_coincidence *run = &c->coincidences[i];
        for (end = i + 1;
             end < c->ncoincidences && c->coincidences[end].a == run->a && c->coincidences[end].b == run->b;)
            end++;
        for (; old < nold && compare_pairs(run->a, run->b, &c->old_specials[old]) > 0; old++)
            if (!release(c, r, &c->old_specials[old]))
                return SG_FAIL_NOMEM(err);
        const sg_special_pair *was =
            old < nold && compare_pairs(run->a, run->b, &c->old_specials[old]) == 0 ? &c->old_specials[old++] : NULL;
        sg_special_pair *p = &c->specials[c->nspecials++];
        *p = (sg_special_pair){.a = run->a, .b = run->b, .first = (uint32_t)i, .n = (uint32_t)(end - i)};
        if (is_unchanged(r, run, p->n, was, mark))
            p->part = was->part;
        else
            SG_TRY(sg_merge_part_of(r, run, p->n, &p->part, err));
    }
    for (; old < nold; old++)
        if (!release(c, r, &c->old_specials[old]))
            return SG_FAIL_NOMEM(err);
    return SG_OK;
}

/* ---- all of it ---- */

sg_status sg_candidates_fill(sg_candidates *c, sg_rules *r, sg_error *err)
{
    c->ncoincidences = c->nspecials = 0;
    const uint32_t mark = ++r->stamp;
    for (uint32_t i = 0; i < r->nrules; i++)
        r->rules[i].stamp = mark;
    for (uint32_t i = 0; i < r->nrules; i++)
        if (r->rules[i].alive && !look_around(c, r, i, mark))
            return SG_FAIL_NOMEM(err);
    if (c->ncoincidences > 0)
        qsort(c->coincidences, c->ncoincidences, sizeof *c->coincidences, by_pair);
    if (!fill_heap(c, r))
        return SG_FAIL_NOMEM(err);
    return list_specials(c, r, mark, err);
}

static bool has_changed(const sg_rules *r, uint32_t rule, uint32_t mark)
{
    return rule != SG_NONE && (!r->rules[rule].alive || r->rules[rule].stamp == mark);
}

static bool keep_unchanged_coincidences(sg_candidates *c, const sg_rules *r, uint32_t mark)
{
    size_t kept = 0;
    for (size_t i = 0; i < c->ncoincidences; i++) {
        sg_coincidence x = c->coincidences[i];
        x.fresh = false;
        if (!has_changed(r, x.rule, mark) && !has_changed(r, x.other, mark))
            c->coincidences[kept++] = x;
    }
    c->ncoincidences = kept;
    for (size_t i = 0; i < r->changes.nrules; i++) {
        const uint32_t rule = r->changes.rules[i];
        if (r->rules[rule].alive && !look_around(c, r, rule, mark))
            return false;
    }
    return merge_runs(c, kept);
}

/* Of two changed symbols the lower one pushes their pair. */
static bool push_changed(sg_candidates *c, const sg_rules *r, uint32_t a, uint32_t mark)
{
    for (uint32_t b = 0; b < r->nsymbols; b++) {
        if (!sg_rules_compatible(r, a, b) || (b < a && r->symbols[b].stamp == mark))
            continue;
        if (!push(c, r, a, b))
            return false;
    }
    return true;
}

/* Mark what changed, once each: the lists are left without repetitions. */
static void mark_changes(sg_rules *r, uint32_t mark)
{
    sg_changes *ch = &r->changes;
    size_t n = 0;
    for (size_t i = 0; i < ch->nrules; i++)
        if (r->rules[ch->rules[i]].stamp != mark) {
            r->rules[ch->rules[i]].stamp = mark;
            ch->rules[n++] = ch->rules[i];
        }
    ch->nrules = n;
    n = 0;
    for (size_t i = 0; i < ch->nsymbols; i++)
        if (r->symbols[ch->symbols[i]].stamp != mark) {
            r->symbols[ch->symbols[i]].stamp = mark;
            ch->symbols[n++] = ch->symbols[i];
        }
    ch->nsymbols = n;
}

sg_status sg_candidates_update(sg_candidates *c, sg_rules *r, sg_error *err)
{
    const uint32_t mark = ++r->stamp;
    mark_changes(r, mark);
    if (!keep_unchanged_coincidences(c, r, mark))
        return SG_FAIL_NOMEM(err);
    bool good = true;
    if (r->changes.nsymbols > r->live_symbols / 4 + 2) {
        good = fill_heap(c, r);
    } else {
        for (size_t i = 0; i < r->changes.nsymbols && good; i++)
            if (r->symbols[r->changes.symbols[i]].alive)
                good = push_changed(c, r, r->changes.symbols[i], mark);
    }
    return good ? list_specials(c, r, mark, err) : SG_FAIL_NOMEM(err);
}

static bool is_current(const sg_candidates *c, const sg_rules *r, const sg_heap_entry *e)
{
    const sg_learn_symbol *a = &r->symbols[e->candidate.a], *b = &r->symbols[e->candidate.b];
    return a->alive && b->alive && a->version == e->version_a && b->version == e->version_b &&
           !is_special(c, e->candidate.a, e->candidate.b);
}

bool sg_candidates_best(sg_candidates *c, const sg_rules *r, sg_candidate *out)
{
    while (c->nheap > 0 && !is_current(c, r, &c->heap[0]))
        pop(c);
    bool found = c->nheap > 0;
    if (found)
        *out = c->heap[0].candidate;
    for (size_t i = 0; i < c->nspecials; i++) {
        const sg_special_pair *p = &c->specials[i];
        const sg_candidate x = {sg_merge_key(r, &p->part), p->a, p->b};
        if (!found || before(&x, out))
            *out = x;
        found = true;
    }
    return found;
}

static int by_key(const void *p, const void *q)
{
    const sg_candidate *x = p, *y = q;
    return before(x, y) ? -1 : before(y, x) ? 1 : 0;
}

sg_status sg_candidates_top(sg_candidates *c, const sg_rules *r, size_t k, sg_candidate *out, size_t *n, sg_error *err)
{
    const size_t room = c->nspecials + k;
    sg_candidate *all = malloc((room + 1) * sizeof *all);
    sg_heap_entry *taken = malloc((k + 1) * sizeof *taken);
    size_t ntaken = 0, nall = 0;
    if (all == NULL || taken == NULL) {
        free(all);
        free(taken);
        return SG_FAIL_NOMEM(err);
    }
    for (; ntaken < k && c->nheap > 0; pop(c)) {
        if (!is_current(c, r, &c->heap[0]))
            continue;
        const sg_candidate *last = nall > 0 ? &all[nall - 1] : NULL;
        if (last != NULL && last->a == c->heap[0].candidate.a && last->b == c->heap[0].candidate.b)
            continue; /* a pair that was special and is plain again may stand here twice */
        taken[ntaken++] = c->heap[0];
        all[nall++] = c->heap[0].candidate;
    }
    for (size_t i = 0; i < ntaken; i++) {
        c->heap[c->nheap++] = taken[i]; /* there is room: they came from here */
        sift_up(c, c->nheap - 1);
    }
    for (size_t i = 0; i < c->nspecials; i++)
        all[nall++] = (sg_candidate){sg_merge_key(r, &c->specials[i].part), c->specials[i].a, c->specials[i].b};
    qsort(all, nall, sizeof *all, by_key);
    *n = nall < k ? nall : k;
    if (*n > 0)
        memcpy(out, all, *n * sizeof *out);
    free(all);
    free(taken);
    return SG_OK;
}
