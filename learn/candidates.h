/* SPDX-License-Identifier: GPL-3.0-or-later */
/* candidates.h - all merges that may be made next, best first, kept up to date from what an operation changed.
 *
 * Most pairs make no rules equal: their part of the change depends on the counts of the two symbols alone and stands in
 * a heap. The others, found as coincidences between rules of one bucket, are few and stand in a list with their parts
 * (which depend on the number of symbols as well). After an operation only coincidences of changed rules are looked for
 * again, and only parts of pairs with changed symbols are computed again; entries of the heap are dropped when they
 * come up with an old version of a symbol. */
#ifndef SG_LEARN_CANDIDATES_H
#define SG_LEARN_CANDIDATES_H

#include "learn/merge.h"

typedef struct {
    double key; /* change of energy without the common part */
    uint32_t a, b;
} sg_candidate;

typedef struct {
    sg_candidate candidate;
    uint32_t version_a, version_b;
} sg_heap_entry;

/** A pair with coincidences [first, first + n). */
typedef struct {
    uint32_t a, b, first, n;
    sg_merge_part part;
} sg_special_pair;

typedef struct {
    sg_heap_entry *heap;
    size_t nheap, heap_capacity;
    sg_coincidence *coincidences; /* sorted by a, b, rule, other */
    size_t ncoincidences, coincidences_capacity;
    sg_special_pair *specials; /* sorted by a, b */
    size_t nspecials, specials_capacity;
    sg_coincidence *scratch;
    size_t scratch_capacity;
    sg_special_pair *old_specials;
    size_t old_capacity;
} sg_candidates;

/** All candidates of the rules, from scratch. `c` must be zeroed or made before. @return SG_OK, SG_ENOMEM */
sg_status sg_candidates_fill(sg_candidates *c, sg_rules *r, sg_error *err);
/** Bring up to date after one operation on r (r->changes). @return SG_OK, SG_ENOMEM */
sg_status sg_candidates_update(sg_candidates *c, sg_rules *r, sg_error *err);
/** The best: lowest key, then lowest a, then lowest b. @return false when there is none */
bool sg_candidates_best(sg_candidates *c, const sg_rules *r, sg_candidate *out);
/** The k best in that order. @param out [k]; @param n out: how many there are, at most k. @return SG_OK, SG_ENOMEM */
sg_status sg_candidates_top(sg_candidates *c, const sg_rules *r, size_t k, sg_candidate *out, size_t *n, sg_error *err);
sg_status sg_candidates_copy(sg_candidates *dst, const sg_candidates *src, sg_error *err);
void sg_candidates_clear(sg_candidates *c);

#endif
