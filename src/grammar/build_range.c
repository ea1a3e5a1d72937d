/* SPDX-License-Identifier: GPL-3.0-or-later */
/* build_range.c - ranges of parameters by abstract interpretation: from the arguments of the start along all successors,
 * until nothing grows any more. A range that grows again and again (a parameter that counts) is widened to infinity;
 * two rounds from what was found then bring back what guards bound.
 * Source: Cousot and Cousot, "Abstract interpretation" (POPL 1977), sections 9.1 and 9.3. */
#include "config.h"

#include "grammar/build_range_priv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PATIENCE = 8, LAST_PATIENCE = 24, ROUNDS = 2 };

static sg_range *new_ranges(sg_ranges *w)
{
    const sg_grammar *g = w->g;
    sg_range *ranges = SG_NEW_ARRAY(w->arena, sg_range, g->nsymbols);
    if (ranges == NULL)
        return NULL;
    for (size_t s = 0; s < g->nsymbols; s++) {
        ranges[s].depth = sg_interval_none();
        ranges[s].params = SG_NEW_ARRAY(w->arena, sg_interval, g->symbols[s].nparams);
        if (ranges[s].params == NULL)
            return NULL;
        for (uint32_t i = 0; i < g->symbols[s].nparams; i++)
            ranges[s].params[i] = sg_interval_none();
    }
    return ranges;
}

/* ---- joining ---- */

/* old takes in what is new; bounds that move are moved to the end when patience is over. */
static bool take_in(sg_interval *old, sg_interval new, bool impatient)
{
    const sg_interval joined = sg_interval_join(*old, new);
    if (joined.low >= old->low && joined.high <= old->high && joined.nan == old->nan)
        return false;
    const bool had = sg_interval_has_number(*old);
    const bool lower = had && joined.low < old->low, higher = had && joined.high > old->high;
    *old = joined;
    if (impatient && lower)
        old->low = -INFINITY;
    if (impatient && higher)
        old->high = INFINITY;
    return true;
}

static void join_range(sg_ranges *w, sg_sym s, const sg_interval *args, sg_interval depth)
{
    sg_range *r = &w->into[s];
    const bool impatient = w->queue != NULL && r->grown > PATIENCE;
    bool grew = !r->reached;
    r->reached = true;
    grew |= take_in(&r->depth, depth, impatient);
    for (uint32_t i = 0; i < w->g->symbols[s].nparams; i++) {
        const bool all = w->queue != NULL && r->grown > LAST_PATIENCE;
        grew |= take_in(&r->params[i], all ? sg_interval_between(-INFINITY, INFINITY) : args[i], impatient);
    }
    if (!grew || w->queue == NULL)
        return;
    r->grown++;
    if (!r->queued) {
        r->queued = true;
        w->queue[(w->first + w->nqueued++) % w->g->nsymbols] = s;
    }
}

static sg_status join_start(sg_ranges *w)
{
    const sg_sym s = w->g->start;
    sg_interval *args = SG_NEW_ARRAY(w->arena, sg_interval, w->g->symbols[s].nparams);
    if (args == NULL)
        return sg_build_fail_nomem(w->b);
    for (uint32_t i = 0; i < w->g->symbols[s].nparams; i++)
        args[i] = sg_interval_point(w->g->start_args[i]);
    join_range(w, s, args, sg_interval_point(0));
    return SG_OK;
}

/* ---- one rule ---- */

static double limit_of(const sg_grammar *g)
{
    return g->depth_limit == SIZE_MAX ? INFINITY : (double)g->depth_limit;
}

bool sg_ranges_above_limit(const sg_ranges *w, sg_sym s)
{
    return w->ranges[s].reached && w->ranges[s].depth.low <= limit_of(w->g);
}

/* One of the rules that are chosen from; the one rule of a label's hidden symbol is its completion, too. */
static bool is_ordinary(const sg_symbol *s, sg_rule_id r)
{
    return r >= s->first_rule && r < s->first_rule + s->nrules;
}

bool sg_ranges_enter(sg_ranges *w, sg_sym s, sg_rule_id r)
{
    const sg_symbol *symbol = &w->g->symbols[s];
    const sg_rule *rule = &w->g->rules[r];
    const double limit = limit_of(w->g);
    memcpy(w->f.slots, w->ranges[s].params, symbol->nparams * sizeof *w->f.slots);
    w->f.depth = w->ranges[s].depth;
    if (r != symbol->completion)
        w->f.depth.high = fmin(w->f.depth.high, limit);
    else if (!is_ordinary(symbol, r))
        w->f.depth.low = fmax(w->f.depth.low, limit + 1);
    return w->ranges[s].reached && sg_interval_has_number(w->f.depth) &&
           (rule->guard == SG_NONE || sg_interval_assume(&w->f, rule->guard));
}

sg_interval sg_ranges_weight(sg_ranges *w, const sg_rule *r)
{
    return r->weight != SG_NONE ? sg_interval_eval(&w->f, r->weight) : sg_interval_point(1);
}

static void add_draws(sg_ranges *w, const sg_rule *r)
{
    const uint32_t nparams = w->g->symbols[r->lhs].nparams;
    for (uint32_t i = 0; i < r->ndraws; i++) {
        const sg_interval value = sg_interval_of_draw(&w->f, &r->draws[i]);
        for (uint32_t k = 0; k < r->draws[i].nvalues; k++)
            w->f.slots[nparams + r->draws[i].first_value + k] = value;
    }
}

bool sg_ranges_use(sg_ranges *w, sg_sym s, sg_rule_id r)
{
    const sg_rule *rule = &w->g->rules[r];
    if (!sg_ranges_enter(w, s, r) || !(r == w->g->symbols[s].completion || sg_ranges_weight(w, rule).high > 0))
        return false;
    add_draws(w, rule);
    return true;
}

static void follow_rule(sg_ranges *w, sg_sym s, sg_rule_id r, sg_interval *args)
{
    const sg_rule *rule = &w->g->rules[r];
    if (!sg_ranges_use(w, s, r))
        return;
    const sg_interval deeper = sg_interval_apply(SG_E_ADD, w->f.depth, sg_interval_point(1), w->f.depth);
    for (uint32_t i = 0; i < rule->nops; i++) {
        const sg_op *op = &rule->ops[i];
        if (op->kind != SG_OP_SUCCESSOR || w->g->symbols[op->symbol].kind != SG_SYMBOL_NONTERMINAL)
            continue;
        bool possible = true;
        for (uint32_t k = 0; k < op->nargs; k++) {
            args[k] = sg_interval_eval(&w->f, op->args[k]);
            args[k].nan = false; /* that ends a run */
            possible &= sg_interval_has_number(args[k]);
        }
        if (possible)
            join_range(w, op->symbol, args, deeper);
    }
}

static void follow(sg_ranges *w, sg_sym s, sg_interval *args)
{
    const sg_symbol *symbol = &w->g->symbols[s];
    for (uint32_t i = 0; i < symbol->nrules; i++)
        follow_rule(w, s, symbol->first_rule + i, args);
    if (symbol->completion != SG_NONE && !is_ordinary(symbol, symbol->completion))
        follow_rule(w, s, symbol->completion, args);
}

/* ---- all ---- */

static sg_status ascend(sg_ranges *w, sg_interval *args)
{
    w->queue = SG_NEW_ARRAY(w->arena, sg_sym, w->g->nsymbols);
    if (w->queue == NULL)
        return sg_build_fail_nomem(w->b);
    SG_TRY(join_start(w));
    while (w->nqueued > 0) {
        const sg_sym s = w->queue[w->first];
        w->first = (w->first + 1) % w->g->nsymbols;
        w->nqueued--;
        w->ranges[s].queued = false;
        follow(w, s, args);
    }
    w->queue = NULL;
    return SG_OK;
}

/* What one step from all that was found leads to, and the start: still all that can be, for what was found is. */
static sg_status round_again(sg_ranges *w, sg_interval *args)
{
    w->into = new_ranges(w);
    if (w->into == NULL)
        return sg_build_fail_nomem(w->b);
    SG_TRY(join_start(w));
    for (size_t s = 0; s < w->g->nsymbols; s++)
        if (w->ranges[s].reached)
            follow(w, (sg_sym)s, args);
    w->ranges = w->into;
    return SG_OK;
}

sg_status sg_ranges_find(sg_ranges *w, sg_builder *b, const sg_grammar *g, sg_arena *arena)
{
    memset(w, 0, sizeof *w);
    w->b = b;
    w->g = g;
    w->arena = arena;
    uint32_t most = 0;
    for (size_t s = 0; s < g->nsymbols; s++)
        most = g->symbols[s].nparams > most ? g->symbols[s].nparams : most;
    sg_interval *args = SG_NEW_ARRAY(arena, sg_interval, most);
    w->ranges = w->into = new_ranges(w);
    w->chancy = SG_NEW_ARRAY(arena, bool, g->nsymbols);
    if (args == NULL || w->ranges == NULL || w->chancy == NULL)
        return sg_build_fail_nomem(b);
    for (size_t i = 0; i < b->nhidden; i++)
        w->chancy[b->hidden[i].symbol] = b->hidden[i].optional && !b->hidden[i].constant;
    SG_TRY(sg_interval_frame_open(&w->f, g, b->err));
    SG_TRY(ascend(w, args));
    for (int i = 0; i < ROUNDS; i++)
        SG_TRY(round_again(w, args));
    return SG_OK;
}

void sg_ranges_clear(sg_ranges *w)
{
    sg_interval_frame_clear(&w->f);
}
