/* SPDX-License-Identifier: GPL-3.0-or-later */
/* rules.h - the working form of learning: a split grammar that changes, with counts and size lists.
 *
 * Rules are unique by (left-hand side, operation, right-hand side). Each rule stands in a bucket with the rules of its
 * operation and length: rules that are equal, or that one merge would make equal, stand in one bucket. Each symbol
 * knows its own rules and the rules that use it. All links are indices, so a copy is a few memcpy and shares only the
 * size lists. The parts of the energy are carried along. */
#ifndef SG_LEARN_RULES_H
#define SG_LEARN_RULES_H

#include "core/arena.h"
#include "core/status.h"
#include "grammar/split.h"
#include "learn/energy.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** Rows of relative sizes of a rule's uses: a linked list of blocks, so that lists concatenate in O(1). */
typedef struct {
    const double *rows; /* [nrows][n of the rule] */
    size_t nrows;
    uint32_t next;
} sg_size_block;

typedef struct {
    uint32_t lhs;
    sg_split_op op;
    uint32_t n;
    uint32_t first; /* of its right-hand side in sg_rules.rhs; lexical: one terminal */
    double count;
    uint32_t sizes, last_sizes; /* size blocks, SG_NONE: none */
    uint32_t next_in_bucket, previous_in_bucket;
    uint32_t next_own;
    uint32_t united; /* dead rules: the rule that took its uses over, or SG_NONE */
    uint32_t stamp;  /* scratch marks of the algorithms */
    bool alive;
} sg_learn_rule;

typedef struct {
    const char *name;
    uint32_t label_set; /* symbols that reach the same labels have the same number */
    uint32_t nrules;
    double count; /* of all its rules */
    double term;  /* z(nrules, count) */
    uint32_t first_own, last_own;
    uint32_t first_use, last_use; /* links in sg_rules.uses */
    uint32_t version;             /* changes with nrules and count */
    uint32_t merged;              /* dead symbols: the symbol it became, or SG_NONE */
    uint64_t members;             /* sum of random words of the symbols merged into it */
    uint64_t kinds;               /* what else must be equal for a merge (compatible.h); 0: nothing */
    uint32_t stamp;               /* scratch mark */
    bool alive;
} sg_learn_symbol;

typedef struct {
    uint32_t rule, next;
} sg_use;

/** What an operation changed: read by candidate lists. Lists may name a thing twice, and dead ones. */
typedef struct {
    uint32_t *rules, *symbols;
    size_t nrules, rules_capacity, nsymbols, symbols_capacity;
} sg_changes;

typedef struct {
    sg_energy_opts energy_opts;
    sg_arena *arena; /* of size rows and names; borrowed, shared by copies */
    const char *name;
    bool tied;
    uint32_t axiom;
    size_t nterminals;
    const char *const *terminal_names;
    const uint32_t *terminal_colors;
    double log_terminals;

    sg_learn_symbol *symbols;
    size_t nsymbols, symbols_capacity;
    sg_learn_rule *rules;
    size_t nrules, rules_capacity;
    uint32_t *rhs;
    size_t nrhs, rhs_capacity;
    sg_use *uses;
    size_t nuses, uses_capacity;
    sg_size_block *blocks;
    size_t nblocks, blocks_capacity;
    uint32_t *buckets[3]; /* [op][n], lexical: [op][terminal]: first rule */
    size_t nbuckets[3];
    uint64_t *label_sets; /* [nlabel_sets][label_words]; the last word: sg_learn_symbol.kinds */
    size_t nlabel_sets, label_sets_capacity, label_words;
    bool by_kinds; /* symbols have kinds: compatible.h */

    size_t live_symbols, live_rules[3];
    size_t rhs_total;   /* T: lengths of the living non-lexical rules */
    double log_lengths; /* sum of their log length priors */
    double data;        /* sum of z and g: see energy.h */
    uint64_t partition; /* hash of the way the first symbols are grouped */
    uint32_t stamp;
    sg_changes changes; /* of the last operation; not copied */
} sg_rules;

/** Make the working form of a grammar; self rules X -> X are dropped. Free with sg_rules_clear().
 *  @param counts  [nrules] uses of each rule, or NULL: the number of attributes, 0 for rules without
 *  @param arena   keeps names and sizes; must outlive the rules and their copies
 *  @return SG_OK, SG_EINVAL (a count is negative or no number), SG_ENOMEM */
sg_status sg_rules_create(sg_rules *out, const sg_split_form *form, const double *counts, const sg_energy_opts *o,
                          sg_arena *arena, sg_error *err);
void sg_rules_clear(sg_rules *r);
/** dst becomes a copy; it must be zeroed or a grammar before, and keeps its memory. @return SG_OK, SG_ENOMEM */
sg_status sg_rules_copy(sg_rules *dst, const sg_rules *src, sg_error *err);

/** The living rules as a split form: symbols renumbered by increasing index, rules by symbol, then index.
 *  @param sizes      put the rows of sizes in as attributes
 *  @param rule_of    out, NULL or [rules of the form] the rule each was made from, put into the arena
 *  @param counts     out, NULL or their counts */
sg_status sg_rules_form(const sg_rules *r, bool sizes, sg_arena *arena, sg_split_form *out, uint32_t **rule_of,
                        double **counts, sg_error *err);

/** Carried energy. */
double sg_rules_energy(const sg_rules *r);
/** From scratch, through the split form. */
sg_status sg_rules_energy_parts(const sg_rules *r, sg_energy_parts *out, sg_error *err);

/** A bijection that spreads bits (finaliser of splitmix64, Steele, Lea and Flood 2014): the hash of a group of symbols.
 */
static inline uint64_t sg_rules_mix(uint64_t x)
{
    x += 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

static inline const uint32_t *sg_rules_rhs(const sg_rules *r, uint32_t rule)
{
    return r->rhs + r->rules[rule].first;
}

/** True when a and b may be merged: both alive and different, neither the axiom, the same reachable labels. */
bool sg_rules_compatible(const sg_rules *r, uint32_t a, uint32_t b);

typedef enum { SG_RULES_DIFFER, SG_RULES_EQUAL, SG_RULES_PAIR } sg_rules_relation;
/** How two rules of one bucket stand: equal, or PAIR: equal once symbols *low < *high are merged. */
sg_rules_relation sg_rules_compare(const sg_rules *r, uint32_t rule, uint32_t other, uint32_t *low, uint32_t *high);

/** First rule of the bucket that holds `rule`; follow next_in_bucket. */
uint32_t sg_rules_bucket(const sg_rules *r, uint32_t rule);

/* Building blocks of the operations (merge.c, chunk.c, reestimate.c). Those that can fail are asked for room first. */

/** A new symbol without rules, or SG_NONE when memory is out. */
uint32_t sg_rules_add_symbol(sg_rules *r, const char *name, uint32_t label_set);
/** A new rule, known not to be there yet, or SG_NONE when memory is out. */
uint32_t sg_rules_add_rule(sg_rules *r, uint32_t lhs, sg_split_op op, const uint32_t *rhs, uint32_t n, double count);
/** Note that `rule` uses `symbol`. @return false when memory is out */
bool sg_rules_add_use(sg_rules *r, uint32_t symbol, uint32_t rule);
/** Append rows of sizes to a rule; the rows are borrowed. @return false when memory is out */
bool sg_rules_add_sizes(sg_rules *r, uint32_t rule, const double *rows, size_t nrows);
size_t sg_rules_size_count(const sg_rules *r, uint32_t rule);
/** Forget all sizes of all rules. */
void sg_rules_drop_sizes(sg_rules *r);
/** Take a rule out of the grammar; its uses go to `heir` (SG_NONE: they are gone). */
void sg_rules_remove_rule(sg_rules *r, uint32_t rule, uint32_t heir);
/** Put a living rule into the bucket of its operation and length, or take it out: for those who change the length. */
void sg_rules_enter_bucket(sg_rules *r, uint32_t rule);
void sg_rules_leave_bucket(sg_rules *r, uint32_t rule);
/** Set the length of a non-lexical rule, whose right-hand side has been written over; it must be in no bucket. */
void sg_rules_set_length(sg_rules *r, uint32_t rule, uint32_t n);
/** Take a symbol without rules out of the grammar. */
void sg_rules_remove_symbol(sg_rules *r, uint32_t symbol);
/** Set a rule's count. */
void sg_rules_set_count(sg_rules *r, uint32_t rule, double count);
/** Bring a symbol's term and version up to date after its rules or counts changed. */
void sg_rules_refresh_symbol(sg_rules *r, uint32_t symbol);
/** Compute anew which labels each symbol reaches. @return SG_OK, SG_ENOMEM */
sg_status sg_rules_find_labels(sg_rules *r, sg_error *err);
/** Number of a label set, added when it is new; SG_NONE when memory is out. */
uint32_t sg_rules_label_set(sg_rules *r, const uint64_t *words);

bool sg_changes_add_rule(sg_changes *c, uint32_t rule);
bool sg_changes_add_symbol(sg_changes *c, uint32_t symbol);

#endif
