/* SPDX-License-Identifier: GPL-3.0-or-later */
/* merge.c - closed-form changes of energy, and the merge. */
#include "config.h"

#include "learn/merge.h"

#include "core/array.h"

#include <math.h>
#include <stdlib.h>

double sg_merge_plain_part(const sg_rules *r, uint32_t a, uint32_t b)
{
    const sg_learn_symbol *x = &r->symbols[a], *y = &r->symbols[b];
    return x->term + y->term - sg_energy_symbol_term(&r->energy_opts, x->nrules + y->nrules, x->count + y->count);
}

double sg_merge_key(const sg_rules *r, const sg_merge_part *part)
{
    if (part->length == 0)
        return part->rest;
    return part->rest - r->energy_opts.weight * part->length * log((double)(r->live_symbols - 1));
}

double sg_merge_common(const sg_rules *r)
{
    const double n = (double)r->live_symbols;
    return r->energy_opts.weight * (double)r->rhs_total * (log(n - 1) - log(n));
}

/* ---- the part of one pair ---- */

/* Rules that other left-hand sides lose: few, so a list with linear search. */
typedef struct {
    uint32_t symbol, lost;
} loss;

typedef struct {
    loss *losses;
    size_t nlosses, capacity;
    double dl, data; /* changes of description length (the t log N term left out) and of the data sum */
    uint32_t length, lost;
    double self_count;
} tally;

static bool lose(tally *t, uint32_t symbol, uint32_t n)
{
    for (size_t i = 0; i < t->nlosses; i++)
        if (t->losses[i].symbol == symbol) {
            t->losses[i].lost += n;
            return true;
        }
    if (!SG_GROW(t->losses, t->capacity, t->nlosses + 1))
        return false;
    t->losses[t->nlosses++] = (loss){symbol, n};
    return true;
}

/* Rules a -> b and b -> a become X -> X and go. */
static void tally_self_rules(sg_rules *r, const sg_coincidence *c, size_t n, uint32_t self_mark, tally *t)
{
    for (size_t i = 0; i < n; i++) {
        if (c[i].other != SG_NONE)
            continue;
        sg_learn_rule *x = &r->rules[c[i].rule];
        x->stamp = self_mark;
        t->length += 1;
        t->dl += sg_energy_log_length(&r->energy_opts, 1);
        t->data -= sg_energy_rule_term(&r->energy_opts, x->count);
        t->self_count += x->count;
        t->lost++;
    }
}

/* Rules c[0].rule, c[0].other, c[1].other ... become one. */
static bool tally_group(sg_rules *r, const sg_coincidence *c, size_t n, uint32_t taken_mark, tally *t)
{
    const sg_energy_opts *o = &r->energy_opts;
    const sg_learn_rule *first = &r->rules[c[0].rule];
    double total = first->count;
    t->data -= sg_energy_rule_term(o, first->count);
    for (size_t i = 0; i < n; i++) {
        sg_learn_rule *x = &r->rules[c[i].other];
        x->stamp = taken_mark;
        total += x->count;
        t->data -= sg_energy_rule_term(o, x->count);
    }
    t->data += sg_energy_rule_term(o, total);
    if (first->op == SG_SPLIT_LEXICAL) {
        t->dl -= (double)n * r->log_terminals;
    } else {
        t->length += (uint32_t)n * first->n;
        t->dl += (double)n * sg_energy_log_length(o, first->n);
    }
    if (first->lhs == c[0].a || first->lhs == c[0].b) {
        t->lost += (uint32_t)n;
        return true;
    }
    return lose(t, first->lhs, (uint32_t)n);
}

/* All rules of a group are pairwise coincident, so the run of its lowest rule names all the others. */
static bool tally_groups(sg_rules *r, const sg_coincidence *c, size_t n, uint32_t self_mark, uint32_t taken_mark,
                         tally *t)
{
    for (size_t i = 0, end; i < n; i = end) {
        for (end = i + 1; end < n && c[end].rule == c[i].rule;)
            end++;
        const uint32_t mark = r->rules[c[i].rule].stamp;
        if (mark != self_mark && mark != taken_mark && !tally_group(r, c + i, end - i, taken_mark, t))
            return false;
    }
    return true;
}

sg_status sg_merge_part_of(sg_rules *r, const sg_coincidence *c, size_t n, sg_merge_part *out, sg_error *err)
{
    if (n == 0)
        return SG_FAIL(err, SG_EINVAL, "a pair without coincidences has a plain part");
    const sg_energy_opts *o = &r->energy_opts;
    const sg_learn_symbol *x = &r->symbols[c[0].a], *y = &r->symbols[c[0].b];
    tally t = {0};
    const uint32_t self_mark = ++r->stamp, taken_mark = ++r->stamp;
    tally_self_rules(r, c, n, self_mark, &t);
    const bool good = tally_groups(r, c, n, self_mark, taken_mark, &t);
    t.data += sg_energy_symbol_term(o, x->nrules + y->nrules - t.lost, x->count + y->count - t.self_count) - x->term -
              y->term;
    for (size_t i = 0; i < t.nlosses; i++) {
        const sg_learn_symbol *z = &r->symbols[t.losses[i].symbol];
        t.data += sg_energy_symbol_term(o, z->nrules - t.losses[i].lost, z->count) - z->term;
    }
    free(t.losses);
    if (!good)
        return SG_FAIL_NOMEM(err);
    *out = (sg_merge_part){o->weight * t.dl - t.data, t.length};
    return SG_OK;
}

/* ---- finding coincidences of one pair ---- */

typedef struct {
    sg_coincidence *items;
    size_t n, capacity;
} coincidence_list;

static bool is_self_for(const sg_rules *r, const sg_learn_rule *x, uint32_t a, uint32_t b)
{
    if (x->op == SG_SPLIT_LEXICAL || x->n != 1)
        return false;
    const uint32_t s = r->rhs[x->first];
    return (x->lhs == a && s == b) || (x->lhs == b && s == a);
}

/* A self rule has no coincidence with other rules of the list: it goes and is not united. */
static bool find_partners(sg_rules *r, uint32_t rule, uint32_t a, uint32_t b, coincidence_list *list)
{
    if (is_self_for(r, &r->rules[rule], a, b)) {
        if (!SG_GROW(list->items, list->capacity, list->n + 1))
            return false;
        list->items[list->n++] = (sg_coincidence){a, b, rule, SG_NONE, false};
        return true;
    }
    for (uint32_t j = sg_rules_bucket(r, rule); j != SG_NONE; j = r->rules[j].next_in_bucket) {
        uint32_t low, high;
        if (j <= rule || sg_rules_compare(r, rule, j, &low, &high) != SG_RULES_PAIR || low != a || high != b)
            continue;
        if (!SG_GROW(list->items, list->capacity, list->n + 1))
            return false;
        list->items[list->n++] = (sg_coincidence){a, b, rule, j, false};
    }
    return true;
}

static bool visit_touched(sg_rules *r, uint32_t symbol, uint32_t a, uint32_t b, coincidence_list *list)
{
    const sg_learn_symbol *s = &r->symbols[symbol];
    for (uint32_t i = s->first_own; i != SG_NONE; i = r->rules[i].next_own)
        if (r->rules[i].alive && r->rules[i].stamp != r->stamp) {
            r->rules[i].stamp = r->stamp;
            if (!find_partners(r, i, a, b, list))
                return false;
        }
    for (uint32_t u = s->first_use; u != SG_NONE; u = r->uses[u].next) {
        const uint32_t i = r->uses[u].rule;
        if (!r->rules[i].alive || r->rules[i].stamp == r->stamp)
            continue;
        r->rules[i].stamp = r->stamp;
        if (!find_partners(r, i, a, b, list))
            return false;
    }
    return true;
}

static int by_rules(const void *p, const void *q)
{
    const sg_coincidence *x = p, *y = q;
    if (x->rule != y->rule)
        return x->rule < y->rule ? -1 : 1;
    return (x->other > y->other) - (x->other < y->other);
}

sg_status sg_merge_delta(sg_rules *r, uint32_t a, uint32_t b, double *delta, sg_error *err)
{
    if (!sg_rules_compatible(r, a, b))
        return SG_FAIL(err, SG_EINVAL, "symbols %u and %u cannot be merged", a, b);
    const uint32_t low = a < b ? a : b, high = a < b ? b : a;
    coincidence_list list = {0};
    r->stamp++;
    sg_status st = SG_OK;
    sg_merge_part part = {sg_merge_plain_part(r, low, high), 0};
    if (!visit_touched(r, low, low, high, &list) || !visit_touched(r, high, low, high, &list))
        st = SG_FAIL_NOMEM(err);
    if (st == SG_OK && list.n > 0) {
        qsort(list.items, list.n, sizeof *list.items, by_rules);
        st = sg_merge_part_of(r, list.items, list.n, &part, err);
    }
    free(list.items);
    if (st == SG_OK)
        *delta = sg_merge_common(r) + sg_merge_key(r, &part);
    return st;
}

/* ---- the merge ---- */

static bool change_rule(sg_rules *r, uint32_t rule)
{
    sg_learn_rule *x = &r->rules[rule];
    if (!x->alive || x->stamp == r->stamp)
        return true;
    x->stamp = r->stamp;
    return sg_changes_add_rule(&r->changes, rule);
}

/* Name the rules that hold b, once each. */
static bool find_touched(sg_rules *r, uint32_t b)
{
    const sg_learn_symbol *s = &r->symbols[b];
    for (uint32_t i = s->first_own; i != SG_NONE; i = r->rules[i].next_own)
        if (!change_rule(r, i))
            return false;
    for (uint32_t u = s->first_use; u != SG_NONE; u = r->uses[u].next)
        if (!change_rule(r, r->uses[u].rule))
            return false;
    return true;
}

static void relabel_rule(sg_rules *r, uint32_t rule, uint32_t from, uint32_t to)
{
    sg_learn_rule *x = &r->rules[rule];
    if (x->lhs == from)
        x->lhs = to;
    if (x->op == SG_SPLIT_LEXICAL)
        return;
    for (uint32_t i = 0; i < x->n; i++)
        if (r->rhs[x->first + i] == from)
            r->rhs[x->first + i] = to;
}

static void append_lists(sg_rules *r, sg_learn_symbol *to, const sg_learn_symbol *from)
{
    if (from->first_own != SG_NONE) {
        if (to->first_own == SG_NONE)
            to->first_own = from->first_own;
        else
            r->rules[to->last_own].next_own = from->first_own;
        to->last_own = from->last_own;
    }
    if (from->first_use == SG_NONE)
        return;
    if (to->first_use == SG_NONE)
        to->first_use = from->first_use;
    else
        r->uses[to->last_use].next = from->first_use;
    to->last_use = from->last_use;
}

static void unite_symbols(sg_rules *r, uint32_t a, uint32_t b)
{
    sg_learn_symbol *x = &r->symbols[a], *y = &r->symbols[b];
    append_lists(r, x, y);
    r->partition -= sg_rules_mix(x->members) + sg_rules_mix(y->members);
    x->members += y->members;
    r->partition += sg_rules_mix(x->members);
    x->nrules += y->nrules;
    x->count += y->count;
    y->nrules = 0;
    y->count = 0;
    y->alive = false;
    y->merged = a;
    y->first_own = y->last_own = y->first_use = y->last_use = SG_NONE;
    r->live_symbols--;
}

static bool settle_rule(sg_rules *r, uint32_t rule)
{
    sg_learn_rule *x = &r->rules[rule];
    if (!x->alive)
        return true;
    if (x->op != SG_SPLIT_LEXICAL && x->n == 1 && r->rhs[x->first] == x->lhs) {
        sg_rules_remove_rule(r, rule, SG_NONE);
        return sg_changes_add_symbol(&r->changes, x->lhs);
    }
    for (uint32_t j = sg_rules_bucket(r, rule); j != SG_NONE; j = r->rules[j].next_in_bucket) {
        uint32_t low, high;
        if (j == rule || sg_rules_compare(r, rule, j, &low, &high) != SG_RULES_EQUAL)
            continue;
        sg_rules_remove_rule(r, rule > j ? rule : j, rule > j ? j : rule);
        return sg_changes_add_rule(&r->changes, rule > j ? j : rule) && sg_changes_add_symbol(&r->changes, x->lhs);
    }
    return true;
}

sg_status sg_merge_settle(sg_rules *r, sg_error *err)
{
    /* the list grows at its end while rules unite: those are settled again, since a group may have three members */
    for (size_t i = 0; i < r->changes.nrules; i++)
        if (!settle_rule(r, r->changes.rules[i]))
            return SG_FAIL_NOMEM(err);
    for (size_t i = 0; i < r->changes.nsymbols; i++)
        sg_rules_refresh_symbol(r, r->changes.symbols[i]);
    return SG_OK;
}

sg_status sg_merge_apply(sg_rules *r, uint32_t a, uint32_t b, sg_error *err)
{
    if (!sg_rules_compatible(r, a, b))
        return SG_FAIL(err, SG_EINVAL, "symbols %u and %u cannot be merged", a, b);
    const uint32_t low = a < b ? a : b, high = a < b ? b : a;
    r->changes.nrules = r->changes.nsymbols = 0;
    r->stamp++;
    if (!find_touched(r, high))
        return SG_FAIL_NOMEM(err);
    for (size_t i = 0; i < r->changes.nrules; i++)
        relabel_rule(r, r->changes.rules[i], high, low);
    unite_symbols(r, low, high);
    if (!sg_changes_add_symbol(&r->changes, low) || !sg_changes_add_symbol(&r->changes, high))
        return SG_FAIL_NOMEM(err);
    return sg_merge_settle(r, err);
}
