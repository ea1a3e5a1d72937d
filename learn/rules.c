/* SPDX-License-Identifier: GPL-3.0-or-later */
/* rules.c - the working form: making, copying, comparing and bookkeeping. */
#include "config.h"

#include "learn/rules.h"

#include "core/array.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool sg_changes_add_rule(sg_changes *c, uint32_t rule)
{
    if (!SG_GROW(c->rules, c->rules_capacity, c->nrules + 1))
        return false;
    c->rules[c->nrules++] = rule;
    return true;
}

bool sg_changes_add_symbol(sg_changes *c, uint32_t symbol)
{
    if (!SG_GROW(c->symbols, c->symbols_capacity, c->nsymbols + 1))
        return false;
    c->symbols[c->nsymbols++] = symbol;
    return true;
}

void sg_rules_clear(sg_rules *r)
{
    free(r->symbols);
    free(r->rules);
    free(r->rhs);
    free(r->uses);
    free(r->blocks);
    for (int op = 0; op < 3; op++)
        free(r->buckets[op]);
    free(r->label_sets);
    free(r->changes.rules);
    free(r->changes.symbols);
    memset(r, 0, sizeof *r);
}

/* Energy bookkeeping of one rule that comes (sign 1) or goes (-1). */
static void account_rule(sg_rules *r, const sg_learn_rule *rule, int sign)
{
    r->live_rules[rule->op] += (size_t)sign;
    r->data += sign * sg_energy_rule_term(&r->energy_opts, rule->count);
    if (rule->op == SG_SPLIT_LEXICAL)
        return;
    r->rhs_total += (size_t)sign * rule->n;
    r->log_lengths += sign * sg_energy_log_length(&r->energy_opts, rule->n);
}

void sg_rules_refresh_symbol(sg_rules *r, uint32_t symbol)
{
    sg_learn_symbol *s = &r->symbols[symbol];
    const double term = s->alive ? sg_energy_symbol_term(&r->energy_opts, s->nrules, s->count) : 0;
    r->data += term - s->term;
    s->term = term;
    s->version++;
}

static size_t bucket_index(const sg_rules *r, const sg_learn_rule *rule)
{
    return rule->op == SG_SPLIT_LEXICAL ? r->rhs[rule->first] : rule->n;
}

uint32_t sg_rules_bucket(const sg_rules *r, uint32_t rule)
{
    const sg_learn_rule *x = &r->rules[rule];
    return r->buckets[x->op][bucket_index(r, x)];
}

static bool make_bucket(sg_rules *r, sg_split_op op, size_t index)
{
    const size_t had = r->nbuckets[op];
    if (index < had)
        return true;
    if (!sg_array_grow(&r->buckets[op], &r->nbuckets[op], index + 1, sizeof(uint32_t)))
        return false;
    for (size_t i = had; i < r->nbuckets[op]; i++)
        r->buckets[op][i] = SG_NONE;
    return true;
}

void sg_rules_enter_bucket(sg_rules *r, uint32_t rule)
{
    sg_learn_rule *x = &r->rules[rule];
    uint32_t *head = &r->buckets[x->op][bucket_index(r, x)];
    x->next_in_bucket = *head;
    x->previous_in_bucket = SG_NONE;
    if (*head != SG_NONE)
        r->rules[*head].previous_in_bucket = rule;
    *head = rule;
}

void sg_rules_leave_bucket(sg_rules *r, uint32_t rule)
{
    sg_learn_rule *x = &r->rules[rule];
    if (x->previous_in_bucket != SG_NONE)
        r->rules[x->previous_in_bucket].next_in_bucket = x->next_in_bucket;
    else
        r->buckets[x->op][bucket_index(r, x)] = x->next_in_bucket;
    if (x->next_in_bucket != SG_NONE)
        r->rules[x->next_in_bucket].previous_in_bucket = x->previous_in_bucket;
}

uint32_t sg_rules_add_symbol(sg_rules *r, const char *name, uint32_t label_set)
{
    if (!SG_GROW(r->symbols, r->symbols_capacity, r->nsymbols + 1))
        return SG_NONE;
    const uint32_t s = (uint32_t)r->nsymbols++;
    const uint64_t members = sg_rules_mix(s);
    r->symbols[s] = (sg_learn_symbol){.name = name,
                                      .label_set = label_set,
                                      .first_own = SG_NONE,
                                      .last_own = SG_NONE,
                                      .first_use = SG_NONE,
                                      .last_use = SG_NONE,
                                      .merged = SG_NONE,
                                      .members = members,
                                      .alive = true};
    r->live_symbols++;
    r->partition += sg_rules_mix(members);
    return s;
}

bool sg_rules_add_use(sg_rules *r, uint32_t symbol, uint32_t rule)
{
    if (!SG_GROW(r->uses, r->uses_capacity, r->nuses + 1))
        return false;
    const uint32_t link = (uint32_t)r->nuses++;
    r->uses[link] = (sg_use){rule, SG_NONE};
    sg_learn_symbol *s = &r->symbols[symbol];
    if (s->first_use == SG_NONE)
        s->first_use = link;
    else
        r->uses[s->last_use].next = link;
    s->last_use = link;
    return true;
}

static bool add_uses(sg_rules *r, uint32_t rule)
{
    const sg_learn_rule *x = &r->rules[rule];
    for (uint32_t i = 0; i < x->n; i++) {
        const uint32_t s = r->rhs[x->first + i];
        const uint32_t last = r->symbols[s].last_use;
        if (last != SG_NONE && r->uses[last].rule == rule)
            continue; /* its last link says it already */
        if (!sg_rules_add_use(r, s, rule))
            return false;
    }
    return true;
}

uint32_t sg_rules_add_rule(sg_rules *r, uint32_t lhs, sg_split_op op, const uint32_t *rhs, uint32_t n, double count)
{
    if (!SG_GROW(r->rules, r->rules_capacity, r->nrules + 1) || !SG_GROW(r->rhs, r->rhs_capacity, r->nrhs + n) ||
        !make_bucket(r, op, op == SG_SPLIT_LEXICAL ? rhs[0] : n))
        return SG_NONE;
    const uint32_t id = (uint32_t)r->nrules++;
    sg_learn_rule *x = &r->rules[id];
    *x = (sg_learn_rule){.lhs = lhs,
                         .op = op,
                         .n = n,
                         .first = (uint32_t)r->nrhs,
                         .count = count,
                         .sizes = SG_NONE,
                         .last_sizes = SG_NONE,
                         .next_own = SG_NONE,
                         .united = SG_NONE,
                         .alive = true};
    memcpy(r->rhs + r->nrhs, rhs, n * sizeof *rhs);
    r->nrhs += n;
    if (op != SG_SPLIT_LEXICAL && !add_uses(r, id))
        return SG_NONE;
    sg_learn_symbol *s = &r->symbols[lhs];
    if (s->first_own == SG_NONE)
        s->first_own = id;
    else
        r->rules[s->last_own].next_own = id;
    s->last_own = id;
    s->nrules++;
    s->count += count;
    sg_rules_enter_bucket(r, id);
    account_rule(r, x, 1);
    return id;
}

bool sg_rules_add_sizes(sg_rules *r, uint32_t rule, const double *rows, size_t nrows)
{
    if (nrows == 0)
        return true;
    if (!SG_GROW(r->blocks, r->blocks_capacity, r->nblocks + 1))
        return false;
    const uint32_t b = (uint32_t)r->nblocks++;
    r->blocks[b] = (sg_size_block){rows, nrows, SG_NONE};
    sg_learn_rule *x = &r->rules[rule];
    if (x->sizes == SG_NONE)
        x->sizes = b;
    else
        r->blocks[x->last_sizes].next = b;
    x->last_sizes = b;
    return true;
}

size_t sg_rules_size_count(const sg_rules *r, uint32_t rule)
{
    size_t n = 0;
    for (uint32_t b = r->rules[rule].sizes; b != SG_NONE; b = r->blocks[b].next)
        n += r->blocks[b].nrows;
    return n;
}

void sg_rules_drop_sizes(sg_rules *r)
{
    r->nblocks = 0;
    for (size_t i = 0; i < r->nrules; i++)
        r->rules[i].sizes = r->rules[i].last_sizes = SG_NONE;
}

static void concatenate_sizes(sg_rules *r, uint32_t from, uint32_t to)
{
    const sg_learn_rule *f = &r->rules[from];
    sg_learn_rule *t = &r->rules[to];
    if (f->sizes == SG_NONE)
        return;
    if (t->sizes == SG_NONE)
        t->sizes = f->sizes;
    else
        r->blocks[t->last_sizes].next = f->sizes;
    t->last_sizes = f->last_sizes;
}

void sg_rules_set_length(sg_rules *r, uint32_t rule, uint32_t n)
{
    sg_learn_rule *x = &r->rules[rule];
    r->rhs_total = r->rhs_total - x->n + n;
    r->log_lengths += sg_energy_log_length(&r->energy_opts, n) - sg_energy_log_length(&r->energy_opts, x->n);
    x->n = n;
}

void sg_rules_remove_symbol(sg_rules *r, uint32_t symbol)
{
    sg_learn_symbol *s = &r->symbols[symbol];
    s->alive = false;
    sg_rules_refresh_symbol(r, symbol);
    r->partition -= sg_rules_mix(s->members);
    r->live_symbols--;
}

void sg_rules_set_count(sg_rules *r, uint32_t rule, double count)
{
    sg_learn_rule *x = &r->rules[rule];
    r->data += sg_energy_rule_term(&r->energy_opts, count) - sg_energy_rule_term(&r->energy_opts, x->count);
    r->symbols[x->lhs].count += count - x->count;
    x->count = count;
}

void sg_rules_remove_rule(sg_rules *r, uint32_t rule, uint32_t heir)
{
    sg_learn_rule *x = &r->rules[rule];
    account_rule(r, x, -1);
    sg_rules_leave_bucket(r, rule);
    r->symbols[x->lhs].nrules--;
    r->symbols[x->lhs].count -= x->count;
    x->alive = false;
    x->united = heir;
    if (heir == SG_NONE)
        return;
    concatenate_sizes(r, rule, heir);
    sg_rules_set_count(r, heir, r->rules[heir].count + x->count);
}

bool sg_rules_compatible(const sg_rules *r, uint32_t a, uint32_t b)
{
    return a != b && a != r->axiom && b != r->axiom && r->symbols[a].alive && r->symbols[b].alive &&
           r->symbols[a].label_set == r->symbols[b].label_set;
}

sg_rules_relation sg_rules_compare(const sg_rules *r, uint32_t rule, uint32_t other, uint32_t *low, uint32_t *high)
{
    const sg_learn_rule *x = &r->rules[rule], *y = &r->rules[other];
    const uint32_t *p = r->rhs + x->first, *q = r->rhs + y->first;
    uint32_t a = x->lhs, b = y->lhs;
    bool differ = a != b;
    if (differ && !sg_rules_compatible(r, a, b))
        return SG_RULES_DIFFER;
    const uint32_t n = x->op == SG_SPLIT_LEXICAL ? 0 : x->n; /* lexical: the bucket says the terminal */
    for (uint32_t i = 0; i < n; i++) {
        if (p[i] == q[i])
            continue;
        if (!differ) {
            if (!sg_rules_compatible(r, p[i], q[i]))
                return SG_RULES_DIFFER;
            differ = true;
            a = p[i];
            b = q[i];
        } else if (!(p[i] == a && q[i] == b) && !(p[i] == b && q[i] == a)) {
            return SG_RULES_DIFFER;
        }
    }
    if (!differ)
        return SG_RULES_EQUAL;
    *low = a < b ? a : b;
    *high = a < b ? b : a;
    return SG_RULES_PAIR;
}

double sg_rules_energy(const sg_rules *r)
{
    const double dl = (double)r->rhs_total * log((double)r->live_symbols) - r->log_lengths +
                      (double)r->live_rules[SG_SPLIT_LEXICAL] * r->log_terminals;
    return r->energy_opts.weight * dl - r->data;
}

sg_status sg_rules_energy_parts(const sg_rules *r, sg_energy_parts *out, sg_error *err)
{
    sg_arena *scratch = sg_arena_create();
    if (scratch == NULL)
        return SG_FAIL_NOMEM(err);
    sg_split_form form;
    double *counts;
    sg_status st = sg_rules_form(r, false, scratch, &form, NULL, &counts, err);
    if (st == SG_OK)
        st = sg_energy_of_form(&r->energy_opts, &form, counts, out, err);
    sg_arena_free(scratch);
    return st;
}

/* ---- labels ---- */

uint32_t sg_rules_label_set(sg_rules *r, const uint64_t *words)
{
    const size_t w = r->label_words;
    for (size_t i = 0; i < r->nlabel_sets; i++)
        if (memcmp(r->label_sets + i * w, words, w * sizeof *words) == 0)
            return (uint32_t)i;
    if (!SG_GROW(r->label_sets, r->label_sets_capacity, (r->nlabel_sets + 1) * w))
        return SG_NONE;
    memcpy(r->label_sets + r->nlabel_sets * w, words, w * sizeof *words);
    return (uint32_t)r->nlabel_sets++;
}

/* One round of the closure: each left-hand side takes what its right-hand side reaches. */
static bool spread_labels(const sg_rules *r, uint64_t *reach)
{
    const size_t w = r->label_words;
    bool changed = false;
    for (size_t i = r->nrules; i-- > 0;) {
        const sg_learn_rule *x = &r->rules[i];
        if (!x->alive)
            continue;
        uint64_t *to = reach + x->lhs * w;
        for (uint32_t k = 0; k < x->n; k++) {
            const uint32_t s = r->rhs[x->first + k];
            for (size_t j = 0; j < w; j++) {
                const uint64_t from = x->op != SG_SPLIT_LEXICAL ? reach[s * w + j]
                                      : s / 64 == j             ? (uint64_t)1 << (s % 64)
                                                                : 0;
                changed |= (from & ~to[j]) != 0;
                to[j] |= from;
            }
        }
    }
    return changed;
}

sg_status sg_rules_find_labels(sg_rules *r, sg_error *err)
{
    uint64_t *reach = calloc(r->nsymbols * r->label_words + 1, sizeof *reach);
    if (reach == NULL)
        return SG_FAIL_NOMEM(err);
    while (spread_labels(r, reach)) {
    }
    for (size_t s = 0; s < r->nsymbols; s++)
        reach[(s + 1) * r->label_words - 1] = r->symbols[s].kinds;
    sg_status st = SG_OK;
    r->nlabel_sets = 0;
    for (size_t s = 0; s < r->nsymbols && st == SG_OK; s++) {
        if (!r->symbols[s].alive)
            continue;
        r->symbols[s].label_set = sg_rules_label_set(r, reach + s * r->label_words);
        if (r->symbols[s].label_set == SG_NONE)
            st = SG_FAIL_NOMEM(err);
    }
    free(reach);
    return st;
}

/* ---- from and to the split form ---- */

static bool is_self(const sg_split_rule *rule)
{
    return rule->op != SG_SPLIT_LEXICAL && rule->n == 1 && rule->rhs[0] == rule->lhs;
}

static sg_status fill(sg_rules *r, const sg_split_form *form, const double *counts, sg_error *err)
{
    for (size_t s = 0; s < form->nsymbols; s++) {
        const char *name = sg_arena_string(r->arena, form->symbol_names[s]);
        if (name == NULL || sg_rules_add_symbol(r, name, 0) == SG_NONE)
            return SG_FAIL_NOMEM(err);
    }
    for (size_t i = 0; i < form->nrules; i++) {
        const sg_split_rule *rule = &form->rules[i];
        const double count = counts != NULL ? counts[i] : (double)rule->nattributes;
        if (!(count >= 0 && isfinite(count)))
            return SG_FAIL(err, SG_EINVAL, "rule %zu has the impossible count %g", i, count);
        if (is_self(rule))
            continue;
        const uint32_t id = sg_rules_add_rule(r, rule->lhs, rule->op, rule->rhs, rule->n, count);
        if (id == SG_NONE || !sg_rules_add_sizes(r, id, rule->attributes, rule->nattributes))
            return SG_FAIL_NOMEM(err);
    }
    return SG_OK;
}

/* Two rules of the form may be equal; here they are one. */
static void unite_equal_rules(sg_rules *r)
{
    for (uint32_t i = 0; i < r->nrules; i++) {
        uint32_t low, high, next;
        for (uint32_t j = sg_rules_bucket(r, i); r->rules[i].alive && j != SG_NONE; j = next) {
            next = r->rules[j].next_in_bucket;
            if (j > i && sg_rules_compare(r, i, j, &low, &high) == SG_RULES_EQUAL)
                sg_rules_remove_rule(r, j, i);
        }
    }
}

sg_status sg_rules_create(sg_rules *out, const sg_split_form *form, const double *counts, const sg_energy_opts *o,
                          sg_arena *arena, sg_error *err)
{
    sg_rules r = {.energy_opts = *o,
                  .arena = arena,
                  .tied = form->tied,
                  .axiom = form->axiom,
                  .nterminals = form->nterminals,
                  .terminal_names = form->terminal_names,
                  .terminal_colors = form->terminal_colors,
                  .label_words = form->nterminals / 64 + 2,
                  .log_terminals = log((double)form->nterminals)};
    r.name = form->name;
    sg_status st = fill(&r, form, counts, err);
    if (st == SG_OK)
        unite_equal_rules(&r);
    if (st == SG_OK)
        st = sg_rules_find_labels(&r, err);
    if (st != SG_OK) {
        sg_rules_clear(&r);
        return st;
    }
    for (uint32_t s = 0; s < r.nsymbols; s++)
        sg_rules_refresh_symbol(&r, s);
    *out = r;
    return SG_OK;
}

/* Copy one array; the destination keeps its memory when that is large enough. */
static bool copy_array(void *dst_items, size_t *capacity, const void *src, size_t n, size_t size)
{
    void **dst = dst_items;
    if (n > *capacity && !sg_array_grow(dst_items, capacity, n, size))
        return false;
    if (n > 0)
        memcpy(*dst, src, n * size);
    return true;
}

#define COPY(field, n, capacity) copy_array(&out.field, &out.capacity, src->field, src->n, sizeof *src->field)

sg_status sg_rules_copy(sg_rules *dst, const sg_rules *src, sg_error *err)
{
    sg_rules out = *src;
    out.symbols = dst->symbols, out.symbols_capacity = dst->symbols_capacity;
    out.rules = dst->rules, out.rules_capacity = dst->rules_capacity;
    out.rhs = dst->rhs, out.rhs_capacity = dst->rhs_capacity;
    out.uses = dst->uses, out.uses_capacity = dst->uses_capacity;
    out.blocks = dst->blocks, out.blocks_capacity = dst->blocks_capacity;
    out.label_sets = dst->label_sets, out.label_sets_capacity = dst->label_sets_capacity;
    out.changes = dst->changes;
    bool good = COPY(symbols, nsymbols, symbols_capacity) && COPY(rules, nrules, rules_capacity) &&
                COPY(rhs, nrhs, rhs_capacity) && COPY(uses, nuses, uses_capacity) &&
                COPY(blocks, nblocks, blocks_capacity) &&
                copy_array(&out.label_sets, &out.label_sets_capacity, src->label_sets,
                           src->nlabel_sets * src->label_words, sizeof *src->label_sets);
    for (int op = 0; op < 3; op++) {
        out.buckets[op] = dst->buckets[op];
        out.nbuckets[op] = dst->nbuckets[op];
        good = good && copy_array(&out.buckets[op], &out.nbuckets[op], src->buckets[op], src->nbuckets[op],
                                  sizeof *src->buckets[op]);
        for (size_t i = src->nbuckets[op]; good && i < out.nbuckets[op]; i++)
            out.buckets[op][i] = SG_NONE;
    }
    *dst = out; /* whether good or not: the arrays may have moved */
    return good ? SG_OK : SG_FAIL_NOMEM(err);
}

static const double *gather_sizes(const sg_rules *r, const sg_learn_rule *x, sg_arena *arena, size_t nrows)
{
    double *rows = SG_NEW_ARRAY(arena, double, nrows * x->n);
    size_t at = 0;
    for (uint32_t b = x->sizes; rows != NULL && b != SG_NONE; b = r->blocks[b].next) {
        const size_t n = r->blocks[b].nrows * x->n;
        memcpy(rows + at, r->blocks[b].rows, n * sizeof *rows);
        at += n;
    }
    return rows;
}

static bool export_rule(const sg_rules *r, uint32_t id, const uint32_t *number, bool sizes, sg_arena *arena,
                        sg_split_rule *out)
{
    const sg_learn_rule *x = &r->rules[id];
    const sg_learn_symbol *s = &r->symbols[x->lhs];
    uint32_t *rhs = sg_arena_copy(arena, r->rhs + x->first, x->n * sizeof *rhs);
    if (rhs == NULL)
        return false;
    for (uint32_t i = 0; i < x->n && x->op != SG_SPLIT_LEXICAL; i++)
        rhs[i] = number[rhs[i]];
    *out = (sg_split_rule){.lhs = number[x->lhs],
                           .op = x->op,
                           .n = x->n,
                           .rhs = rhs,
                           .source = SG_NONE,
                           .probability = sg_energy_probability(&r->energy_opts, x->count, s->nrules, s->count),
                           .nattributes = sizes ? sg_rules_size_count(r, id) : 0};
    if (out->nattributes > 0)
        out->attributes = gather_sizes(r, x, arena, out->nattributes);
    return out->nattributes == 0 || out->attributes != NULL;
}

static int by_index(const void *a, const void *b)
{
    const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

/* Living rules of a symbol by increasing index: merges concatenate the lists in another order. */
static size_t own_rules(const sg_rules *r, uint32_t symbol, uint32_t *out)
{
    size_t n = 0;
    for (uint32_t i = r->symbols[symbol].first_own; i != SG_NONE; i = r->rules[i].next_own)
        if (r->rules[i].alive)
            out[n++] = i;
    qsort(out, n, sizeof *out, by_index);
    return n;
}

sg_status sg_rules_form(const sg_rules *r, bool sizes, sg_arena *arena, sg_split_form *out, uint32_t **rule_of,
                        double **counts, sg_error *err)
{
    const size_t nrules = r->live_rules[0] + r->live_rules[1] + r->live_rules[2];
    uint32_t *number = SG_NEW_ARRAY(arena, uint32_t, r->nsymbols + 1);
    uint32_t *ids = SG_NEW_ARRAY(arena, uint32_t, r->nrules + 1);
    const char **names = SG_NEW_ARRAY(arena, const char *, r->live_symbols + 1);
    sg_split_rule *rules = SG_NEW_ARRAY(arena, sg_split_rule, nrules + 1);
    double *c = SG_NEW_ARRAY(arena, double, nrules + 1);
    if (number == NULL || ids == NULL || names == NULL || rules == NULL || c == NULL)
        return SG_FAIL_NOMEM(err);
    uint32_t nsymbols = 0;
    for (uint32_t s = 0; s < r->nsymbols; s++) {
        if (!r->symbols[s].alive)
            continue;
        names[nsymbols] = r->symbols[s].name;
        number[s] = nsymbols++;
    }
    size_t at = 0;
    for (uint32_t s = 0; s < r->nsymbols; s++)
        if (r->symbols[s].alive)
            at += own_rules(r, s, ids + at);
    for (size_t i = 0; i < nrules; i++) {
        c[i] = r->rules[ids[i]].count;
        if (!export_rule(r, ids[i], number, sizes, arena, &rules[i]))
            return SG_FAIL_NOMEM(err);
    }
    *out = (sg_split_form){.name = r->name,
                           .nsymbols = nsymbols,
                           .symbol_names = names,
                           .nterminals = r->nterminals,
                           .terminal_names = r->terminal_names,
                           .terminal_colors = r->terminal_colors,
                           .axiom = number[r->axiom],
                           .tied = r->tied,
                           .nrules = nrules,
                           .rules = rules};
    if (rule_of != NULL)
        *rule_of = ids;
    if (counts != NULL)
        *counts = c;
    return SG_OK;
}
