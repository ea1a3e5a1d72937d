/* SPDX-License-Identifier: GPL-3.0-or-later */
/* search.c - lines, and the alternation of merging with chunking. */
#include "config.h"

#include "learn/search_priv.h"

#include "core/array.h"
#include "learn/chunk.h"

#include <stdlib.h>
#include <string.h>

void sg_search_history_clear(sg_search_history *h)
{
    free(h->steps);
    memset(h, 0, sizeof *h);
}

static sg_status copy_history(sg_search_history *dst, const sg_search_history *src, sg_error *err)
{
    if (!SG_GROW(dst->steps, dst->capacity, src->n))
        return SG_FAIL_NOMEM(err);
    const sg_search_history kept = *dst;
    *dst = *src;
    dst->steps = kept.steps;
    dst->capacity = kept.capacity;
    if (src->n > 0)
        memcpy(dst->steps, src->steps, src->n * sizeof *src->steps);
    return SG_OK;
}

void sg_line_clear(sg_line *l)
{
    sg_rules_clear(&l->rules);
    sg_candidates_clear(&l->candidates);
    sg_search_history_clear(&l->history);
}

sg_status sg_line_copy(sg_line *dst, const sg_line *src, sg_error *err)
{
    SG_TRY(sg_rules_copy(&dst->rules, &src->rules, err));
    SG_TRY(sg_candidates_copy(&dst->candidates, &src->candidates, err));
    return copy_history(&dst->history, &src->history, err);
}

static sg_status note_step(sg_line *l, sg_step_kind kind, const char *first, const char *second, sg_error *err)
{
    sg_search_history *h = &l->history;
    if (!SG_GROW(h->steps, h->capacity, h->n + 1))
        return SG_FAIL_NOMEM(err);
    const double energy = sg_line_energy(l);
    h->steps[h->n++] = (sg_search_step){kind,
                                        first,
                                        second,
                                        energy,
                                        energy,
                                        l->rules.live_symbols,
                                        l->rules.live_rules[SG_SPLIT_X],
                                        l->rules.live_rules[SG_SPLIT_Y]};
    h->merges += kind == SG_STEP_MERGE;
    h->chunks += kind == SG_STEP_CHUNK;
    return SG_OK;
}

sg_status sg_line_merge(sg_line *l, uint32_t a, uint32_t b, sg_error *err)
{
    SG_TRY(sg_merge_apply(&l->rules, a, b, err));
    SG_TRY(sg_candidates_update(&l->candidates, &l->rules, err));
    return note_step(l, SG_STEP_MERGE, l->rules.symbols[a].name, l->rules.symbols[b].name, err);
}

sg_status sg_line_reestimate(sg_line *l, const sg_search_opts *o, bool fresh, sg_error *err)
{
    if (o->every == NULL)
        return SG_OK;
    sg_reestimate_result result;
    if (fresh)
        sg_reestimator_forget(o->every);
    SG_TRY(sg_reestimate(o->every, &l->rules, &result, err));
    l->history.parsed += result.parsed;
    if (result.removed)
        SG_TRY(sg_candidates_fill(&l->candidates, &l->rules, err));
    else if (l->rules.changes.nsymbols > 0)
        SG_TRY(sg_candidates_update(&l->candidates, &l->rules, err));
    if (l->history.n > 0) {
        sg_search_step *last = &l->history.steps[l->history.n - 1];
        last->energy = sg_line_energy(l);
        last->nonterminals = l->rules.live_symbols;
        last->rules_x = l->rules.live_rules[SG_SPLIT_X];
        last->rules_y = l->rules.live_rules[SG_SPLIT_Y];
    }
    return SG_OK;
}

bool sg_line_best(sg_line *l, sg_candidate *best, double *delta)
{
    if (!sg_candidates_best(&l->candidates, &l->rules, best))
        return false;
    *delta = best->key + sg_merge_common(&l->rules);
    return true;
}

bool sg_search_goes_on(const sg_search_opts *o, const sg_line *l)
{
    sg_progress_report(o->progress, "merging", l->history.merges, 0);
    return !sg_progress_stopped(o->progress);
}

static sg_status run_merging(sg_line *l, const sg_search_opts *o, sg_error *err)
{
    switch (o->kind) {
    case SG_SEARCH_LOOKAHEAD:
        return sg_search_lookahead(l, o, err);
    case SG_SEARCH_BEAM:
        return sg_search_beam(l, o, err);
    case SG_SEARCH_ANNEAL:
        return sg_search_anneal(l, o, err);
    case SG_SEARCH_GREEDY:
    default:
        return sg_search_greedy(l, o, err);
    }
}

/* K1, K2, ... by the chunks so far; a label of the data may be called so too. */
static const char *name_chunk(sg_line *l)
{
    for (size_t k = l->history.chunks + 1;; k++) {
        const char *name = sg_arena_printf(l->rules.arena, "K%zu", k);
        bool taken = false;
        for (size_t s = 0; name != NULL && s < l->rules.nsymbols && !taken; s++)
            taken = strcmp(l->rules.symbols[s].name, name) == 0;
        if (!taken)
            return name;
    }
}

/* Chunks as long as they lower the energy. */
static sg_status run_chunking(sg_line *l, const sg_search_opts *o, bool *any, sg_error *err)
{
    *any = false;
    for (;;) {
        sg_chunk chunk;
        bool found;
        uint32_t symbol;
        SG_TRY(sg_chunk_best(&l->rules, &chunk, &found, err));
        if (!found || chunk.delta > -SG_LEAST_GAIN)
            break;
        const char *name = name_chunk(l);
        if (name == NULL)
            return SG_FAIL_NOMEM(err);
        SG_TRY(sg_chunk_apply(&l->rules, &chunk, name, &symbol, err));
        SG_TRY(note_step(l, SG_STEP_CHUNK, name, NULL, err));
        *any = true;
        if (!sg_search_goes_on(o, l))
            return SG_STOPPED;
    }
    if (*any)
        SG_TRY(sg_candidates_fill(&l->candidates, &l->rules, err));
    return *any ? sg_line_reestimate(l, o, true, err) : SG_OK;
}

static sg_status run(sg_line *l, const sg_search_opts *o, sg_error *err)
{
    SG_TRY(sg_candidates_fill(&l->candidates, &l->rules, err));
    SG_TRY(note_step(l, SG_STEP_START, NULL, NULL, err));
    SG_TRY(sg_line_reestimate(l, o, true, err));
    SG_TRY(run_merging(l, o, err));
    for (bool any = o->chunk; any;) {
        SG_TRY(run_chunking(l, o, &any, err));
        const size_t merges = l->history.merges;
        if (any)
            SG_TRY(run_merging(l, o, err));
        any = any && l->history.merges > merges; /* only a merge makes a new chunk worth while */
    }
    return SG_OK;
}

sg_status sg_search(sg_rules *r, const sg_search_opts *opts, sg_search_history *h, sg_error *err)
{
    sg_line line = {.rules = *r};
    const sg_status st = run(&line, opts, err);
    *r = line.rules;
    *h = line.history;
    sg_candidates_clear(&line.candidates);
    return st;
}
