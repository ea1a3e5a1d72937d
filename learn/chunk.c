/* SPDX-License-Identifier: GPL-3.0-or-later */
/* chunk.c - finding repeated sequences and giving them a symbol. */
#include "config.h"

#include "learn/chunk.h"

#include "core/array.h"
#include "learn/merge.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A place where a sequence of `n` symbols stands. */
typedef struct {
    uint64_t hash;
    uint32_t rule, at;
} place;

static const uint32_t *symbols_at(const sg_rules *r, const place *p)
{
    return r->rhs + r->rules[p->rule].first + p->at;
}

static bool is_split(const sg_learn_rule *x)
{
    return x->alive && x->op != SG_SPLIT_LEXICAL;
}

static bool occurs_at(const sg_rules *r, const sg_learn_rule *x, uint32_t at, const uint32_t *rhs, uint32_t n)
{
    return at + n <= x->n && memcmp(r->rhs + x->first + at, rhs, n * sizeof *rhs) == 0;
}

/* Non-overlapping occurrences from the left. */
static uint32_t count_in_rule(const sg_rules *r, const sg_learn_rule *x, const uint32_t *rhs, uint32_t n)
{
    uint32_t m = 0;
    for (uint32_t at = 0; at + n <= x->n;) {
        const bool here = occurs_at(r, x, at, rhs, n);
        m += here;
        at += here ? n : 1;
    }
    return m;
}

/* What a number of replacements does to the description length, the parts without log N. */
typedef struct {
    double log_lengths;
    size_t replaced;
} effect;

static void add_effect(const sg_rules *r, const sg_learn_rule *x, uint32_t m, uint32_t n, effect *e)
{
    if (m == 0)
        return;
    e->replaced += m;
    e->log_lengths +=
        sg_energy_log_length(&r->energy_opts, x->n - m * (n - 1)) - sg_energy_log_length(&r->energy_opts, x->n);
}

static double energy_change(const sg_rules *r, const effect *e, uint32_t n)
{
    const double symbols = (double)r->live_symbols, total = (double)r->rhs_total;
    const double after = total + n - (double)e->replaced * (n - 1);
    const double dl =
        after * log(symbols + 1) - total * log(symbols) - e->log_lengths - sg_energy_log_length(&r->energy_opts, n);
    return r->energy_opts.weight * dl;
}

double sg_chunk_delta(const sg_rules *r, sg_split_op op, const uint32_t *rhs, uint32_t n)
{
    effect e = {0, 0};
    for (size_t i = 0; i < r->nrules; i++)
        if (is_split(&r->rules[i]) && r->rules[i].op == op)
            add_effect(r, &r->rules[i], count_in_rule(r, &r->rules[i], rhs, n), n, &e);
    return energy_change(r, &e, n);
}

static int by_hash_and_place(const void *p, const void *q)
{
    const place *x = p, *y = q;
    if (x->hash != y->hash)
        return x->hash < y->hash ? -1 : 1;
    if (x->rule != y->rule)
        return x->rule < y->rule ? -1 : 1;
    return (x->at > y->at) - (x->at < y->at);
}

/* All sequences of n symbols; the hash depends on the operation too. */
static size_t list_places(const sg_rules *r, uint32_t n, place *out)
{
    size_t count = 0;
    for (uint32_t i = 0; i < r->nrules; i++) {
        const sg_learn_rule *x = &r->rules[i];
        if (!is_split(x))
            continue;
        for (uint32_t at = 0; at + n <= x->n; at++) {
            uint64_t hash = sg_rules_mix(x->op);
            for (uint32_t k = 0; k < n; k++)
                hash = sg_rules_mix(hash ^ r->rhs[x->first + at + k]);
            out[count++] = (place){hash, i, at};
        }
    }
    qsort(out, count, sizeof *out, by_hash_and_place);
    return count;
}

/* Places of one hash, in the order of the rules: the non-overlapping ones of the first one's sequence. */
static double score_group(const sg_rules *r, const place *p, size_t count, uint32_t n)
{
    effect e = {0, 0};
    const uint32_t *rhs = symbols_at(r, &p[0]);
    for (size_t i = 0, end; i < count; i = end) {
        uint32_t m = 0, free_from = 0;
        for (end = i; end < count && p[end].rule == p[i].rule; end++) {
            if (p[end].at < free_from || memcmp(symbols_at(r, &p[end]), rhs, n * sizeof *rhs) != 0)
                continue;
            m++;
            free_from = p[end].at + n;
        }
        add_effect(r, &r->rules[p[i].rule], m, n, &e);
    }
    return energy_change(r, &e, n);
}

/* Better, or as good and earlier in the rules, or there and longer. */
static bool improves(double delta, const place *p, uint32_t n, const sg_chunk *best, const place *best_place,
                     bool found)
{
    if (!found || delta != best->delta)
        return !found || delta < best->delta;
    if (p->rule != best_place->rule)
        return p->rule < best_place->rule;
    return p->at != best_place->at ? p->at < best_place->at : n > best->n;
}

sg_status sg_chunk_best(const sg_rules *r, sg_chunk *out, bool *found, sg_error *err)
{
    place *places = malloc((r->rhs_total + 1) * sizeof *places);
    if (places == NULL)
        return SG_FAIL_NOMEM(err);
    place best_place = {0, 0, 0};
    *found = false;
    for (uint32_t n = 2; n <= SG_CHUNK_MAX; n++) {
        const size_t count = list_places(r, n, places);
        for (size_t i = 0, end; i < count; i = end) {
            for (end = i + 1; end < count && places[end].hash == places[i].hash;)
                end++;
            if (end - i < 2)
                continue;
            const double delta = score_group(r, places + i, end - i, n);
            if (!improves(delta, &places[i], n, out, &best_place, *found))
                continue;
            best_place = places[i];
            *found = true;
            out->op = r->rules[places[i].rule].op;
            out->n = n;
            out->delta = delta;
            memcpy(out->rhs, symbols_at(r, &places[i]), n * sizeof *out->rhs);
        }
    }
    free(places);
    return SG_OK;
}

/* ---- applying ---- */

static uint64_t chunk_kinds(const sg_rules *r, sg_split_op op)
{
    return r->by_kinds ? (uint64_t)1 << op : 0;
}

static uint32_t label_set_of(sg_rules *r, sg_split_op op, const uint32_t *rhs, uint32_t n)
{
    const size_t w = r->label_words;
    uint64_t *words = calloc(w, sizeof *words);
    if (words == NULL)
        return SG_NONE;
    for (uint32_t i = 0; i < n; i++)
        for (size_t j = 0; j < w; j++)
            words[j] |= r->label_sets[r->symbols[rhs[i]].label_set * w + j];
    words[w - 1] = chunk_kinds(r, op);
    const uint32_t set = sg_rules_label_set(r, words);
    free(words);
    return set;
}

/* New right-hand side over the old one; starts[] says where each part began. @return its length */
static uint32_t replace(sg_rules *r, const sg_learn_rule *x, const sg_chunk *c, uint32_t symbol, uint32_t *starts)
{
    uint32_t *rhs = r->rhs + x->first, n = 0;
    for (uint32_t at = 0; at < x->n; n++) {
        const bool here = occurs_at(r, x, at, c->rhs, c->n);
        starts[n] = at;
        rhs[n] = here ? symbol : rhs[at];
        at += here ? c->n : 1;
    }
    starts[n] = x->n;
    return n;
}

/* One old row of sizes to a shorter one, and to a row of the new rule's for each part that is a chunk. */
static void split_row(const double *row, const uint32_t *starts, uint32_t n, uint32_t chunk_n, double *shorter,
                      double **chunk_row)
{
    for (uint32_t i = 0; i < n; i++) {
        double sum = 0;
        for (uint32_t k = starts[i]; k < starts[i + 1]; k++)
            sum += row[k];
        shorter[i] = sum;
        if (starts[i + 1] - starts[i] < 2)
            continue;
        for (uint32_t k = 0; k < chunk_n; k++)
            (*chunk_row)[k] = sum > 0 ? row[starts[i] + k] / sum : 1.0 / chunk_n;
        *chunk_row += chunk_n;
    }
}

static bool split_sizes(sg_rules *r, uint32_t rule, uint32_t chunk_rule, const uint32_t *starts, uint32_t old_n,
                        uint32_t m)
{
    const size_t nrows = sg_rules_size_count(r, rule);
    const uint32_t n = r->rules[rule].n, chunk_n = r->rules[chunk_rule].n;
    if (nrows == 0)
        return true;
    double *shorter = SG_NEW_ARRAY(r->arena, double, nrows *n);
    double *chunks = SG_NEW_ARRAY(r->arena, double, nrows *m *chunk_n), *next = chunks;
    if (shorter == NULL || chunks == NULL)
        return false;
    size_t at = 0;
    for (uint32_t b = r->rules[rule].sizes; b != SG_NONE; b = r->blocks[b].next)
        for (size_t i = 0; i < r->blocks[b].nrows; i++)
            split_row(r->blocks[b].rows + i * old_n, starts, n, chunk_n, shorter + n * at++, &next);
    r->rules[rule].sizes = r->rules[rule].last_sizes = SG_NONE;
    return sg_rules_add_sizes(r, rule, shorter, nrows) && sg_rules_add_sizes(r, chunk_rule, chunks, nrows * m);
}

static bool chunk_rule(sg_rules *r, uint32_t rule, const sg_chunk *c, uint32_t symbol, uint32_t new_rule, uint32_t m)
{
    sg_learn_rule *x = &r->rules[rule];
    uint32_t *starts = malloc((x->n + 1) * sizeof *starts);
    if (starts == NULL)
        return false;
    const uint32_t old_n = x->n;
    sg_rules_leave_bucket(r, rule);
    sg_rules_set_length(r, rule, replace(r, x, c, symbol, starts));
    sg_rules_enter_bucket(r, rule);
    sg_rules_set_count(r, new_rule, r->rules[new_rule].count + m * x->count);
    const bool good = split_sizes(r, rule, new_rule, starts, old_n, m) && sg_rules_add_use(r, symbol, rule) &&
                      sg_changes_add_rule(&r->changes, rule);
    free(starts);
    return good;
}

sg_status sg_chunk_apply(sg_rules *r, const sg_chunk *c, const char *name, uint32_t *symbol, sg_error *err)
{
    r->changes.nrules = r->changes.nsymbols = 0;
    const uint32_t set = label_set_of(r, c->op, c->rhs, c->n), had = (uint32_t)r->nrules;
    *symbol = set != SG_NONE ? sg_rules_add_symbol(r, name, set) : SG_NONE;
    const uint32_t new_rule = *symbol != SG_NONE ? sg_rules_add_rule(r, *symbol, c->op, c->rhs, c->n, 0) : SG_NONE;
    if (new_rule == SG_NONE || !sg_changes_add_rule(&r->changes, new_rule) ||
        !sg_changes_add_symbol(&r->changes, *symbol))
        return SG_FAIL_NOMEM(err);
    r->symbols[*symbol].kinds = chunk_kinds(r, c->op);
    for (uint32_t i = 0; i < had; i++) {
        const sg_learn_rule *x = &r->rules[i];
        const uint32_t m = is_split(x) && x->op == c->op ? count_in_rule(r, x, c->rhs, c->n) : 0;
        if (m > 0 && !chunk_rule(r, i, c, *symbol, new_rule, m))
            return SG_FAIL_NOMEM(err);
    }
    return sg_merge_settle(r, err);
}
