/* SPDX-License-Identifier: GPL-3.0-or-later */
/* rule_builder.c - makes a split form rule by rule. */
#include "learn/rule_builder_priv.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#define HASH_NONFATAL_OOM 1
#define uthash_nonfatal_oom(item) ((item)->failed = true)
/* tables live in the arena too, and go with it */
#define uthash_malloc(size) sg_arena_alloc(b->arena, (size))
#define uthash_free(pointer, size) ((void)(pointer))
#include <uthash.h>

typedef struct symbol {
    uint32_t *key;
    uint32_t index;
    bool failed;
    const char *name;
    struct symbol *next; /* in order of making */
    UT_hash_handle hh;
} symbol;

typedef struct sizes {
    struct sizes *next;
    double s[];
} sizes;

typedef struct rule {
    uint32_t *key; /* lhs, op, rhs... */
    size_t n;
    double count;
    size_t nsizes;
    sizes *first, *last;
    bool failed;
    struct rule *next;
    UT_hash_handle hh;
} rule;

struct sg_rule_builder {
    sg_arena *arena;
    symbol *symbols, *first_symbol, *last_symbol;
    rule *rules, *first_rule, *last_rule;
    size_t nsymbols, nrules;
};

sg_rule_builder *sg_rule_builder_create(sg_arena *arena)
{
    sg_rule_builder *b = SG_NEW(arena, sg_rule_builder);
    if (b != NULL)
        b->arena = arena;
    return b;
}

uint32_t sg_rule_builder_symbol(sg_rule_builder *b, const uint32_t *key, size_t nkey, bool *is_new)
{
    symbol *s = NULL;
    HASH_FIND(hh, b->symbols, key, nkey * sizeof *key, s);
    if (is_new != NULL)
        *is_new = s == NULL;
    if (s != NULL)
        return s->index;
    s = SG_NEW(b->arena, symbol);
    if (s == NULL || (s->key = sg_arena_copy(b->arena, key, nkey * sizeof *key)) == NULL)
        return SG_NONE;
    s->index = (uint32_t)b->nsymbols;
    HASH_ADD_KEYPTR(hh, b->symbols, s->key, nkey * sizeof *key, s);
    if (s->failed)
        return SG_NONE;
    if (b->last_symbol != NULL)
        b->last_symbol->next = s;
    else
        b->first_symbol = s;
    b->last_symbol = s;
    b->nsymbols++;
    return s->index;
}

void sg_rule_builder_name(sg_rule_builder *b, uint32_t index, const char *name)
{
    if (b->last_symbol != NULL && b->last_symbol->index == index) { /* nearly always: named as soon as made */
        b->last_symbol->name = name;
        return;
    }
    for (symbol *s = b->first_symbol; s != NULL; s = s->next)
        if (s->index == index)
            s->name = name;
}

static rule *find_or_add(sg_rule_builder *b, uint32_t *key, size_t n)
{
    rule *r = NULL;
    HASH_FIND(hh, b->rules, key, (n + 2) * sizeof *key, r);
    if (r != NULL)
        return r;
    r = SG_NEW(b->arena, rule);
    if (r == NULL)
        return NULL;
    r->key = key;
    r->n = n;
    HASH_ADD_KEYPTR(hh, b->rules, r->key, (n + 2) * sizeof *key, r);
    if (r->failed)
        return NULL;
    if (b->last_rule != NULL)
        b->last_rule->next = r;
    else
        b->first_rule = r;
    b->last_rule = r;
    b->nrules++;
    return r;
}

sg_status sg_rule_builder_use(sg_rule_builder *b, uint32_t lhs, sg_split_op op, const uint32_t *rhs, size_t n,
                              double count, const double *s)
{
    uint32_t *key = sg_arena_alloc(b->arena, (n + 2) * sizeof *key);
    if (key == NULL)
        return SG_ENOMEM;
    key[0] = lhs;
    key[1] = op;
    memcpy(key + 2, rhs, n * sizeof *key);
    rule *r = find_or_add(b, key, n);
    if (r == NULL)
        return SG_ENOMEM;
    r->count += count;
    if (s == NULL)
        return SG_OK;
    sizes *item = sg_arena_alloc(b->arena, sizeof *item + n * sizeof(double));
    if (item == NULL)
        return SG_ENOMEM;
    item->next = NULL;
    memcpy(item->s, s, n * sizeof(double));
    if (r->last != NULL)
        r->last->next = item;
    else
        r->first = item;
    r->last = item;
    r->nsizes++;
    return SG_OK;
}

static sg_status fill_rule(sg_arena *arena, const rule *r, sg_split_rule *to)
{
    to->lhs = r->key[0];
    to->op = (sg_split_op)r->key[1];
    to->n = (uint32_t)r->n;
    to->rhs = r->key + 2;
    to->source = SG_NONE;
    to->nattributes = r->nsizes;
    if (r->nsizes == 0)
        return SG_OK;
    double *a = SG_NEW_ARRAY(arena, double, r->nsizes * r->n);
    if (a == NULL)
        return SG_ENOMEM;
    to->attributes = a;
    for (const sizes *s = r->first; s != NULL; s = s->next, a += r->n)
        memcpy(a, s->s, r->n * sizeof(double));
    return SG_OK;
}

/* Counting sort by left-hand symbol: stable, so rules of one symbol keep the order of their first use. */
static sg_status fill_rules(sg_rule_builder *b, sg_split_rule *rules, double *count, double *total)
{
    size_t *start = SG_NEW_ARRAY(b->arena, size_t, b->nsymbols + 1);
    if (start == NULL)
        return SG_ENOMEM;
    for (const rule *r = b->first_rule; r != NULL; r = r->next) {
        start[r->key[0] + 1]++;
        total[r->key[0]] += r->count;
    }
    for (size_t s = 0; s < b->nsymbols; s++)
        start[s + 1] += start[s];
    for (const rule *r = b->first_rule; r != NULL; r = r->next) {
        const size_t i = start[r->key[0]]++;
        count[i] = r->count;
        rules[i].probability = r->count / total[r->key[0]];
        SG_TRY(fill_rule(b->arena, r, &rules[i]));
    }
    return SG_OK;
}

sg_status sg_rule_builder_form(sg_rule_builder *b, sg_split_form *out, double **counts, sg_error *err)
{
    sg_split_rule *rules = SG_NEW_ARRAY(b->arena, sg_split_rule, b->nrules);
    double *count = SG_NEW_ARRAY(b->arena, double, b->nrules);
    double *total = SG_NEW_ARRAY(b->arena, double, b->nsymbols);
    const char **names = SG_NEW_ARRAY(b->arena, const char *, b->nsymbols);
    if (rules == NULL || count == NULL || total == NULL || names == NULL ||
        fill_rules(b, rules, count, total) != SG_OK)
        return SG_FAIL_NOMEM(err);
    for (const symbol *s = b->first_symbol; s != NULL; s = s->next) {
        names[s->index] = s->name != NULL ? s->name : sg_arena_printf(b->arena, "X%u", s->index);
        if (names[s->index] == NULL)
            return SG_FAIL_NOMEM(err);
    }
    *out = (sg_split_form){.nsymbols = b->nsymbols, .symbol_names = names, .nrules = b->nrules, .rules = rules};
    if (counts != NULL)
        *counts = count;
    return SG_OK;
}
