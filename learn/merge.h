/* SPDX-License-Identifier: GPL-3.0-or-later */
/* merge.h - merging two symbols: the change of energy in closed form, and the merge itself.
 * Source: MATHEMATICS B4 (the paper parses the whole corpus for each candidate; counts are enough).
 *
 * A merge of a and b changes the energy by
 *     w T log((N-1)/N)              the same for every pair
 *   + w (-t log(N-1)) + rest        this pair: t is the length of the rules that fall away because they become equal to
 *                                   another one or to X -> X, rest does not depend on N
 * and for most pairs, those that make no rules equal, t = 0 and rest needs the counts of a and b only. */
#ifndef SG_LEARN_MERGE_H
#define SG_LEARN_MERGE_H

#include "learn/rules.h"

/** Two rules that the merge of symbols a < b makes equal (rule < other), or one that it makes X -> X (other SG_NONE).
 */
typedef struct {
    uint32_t a, b, rule, other;
    bool fresh; /* found by the last operation (candidates.c) */
} sg_coincidence;

/** The pair's own part of the change. */
typedef struct {
    double rest;
    uint32_t length; /* t */
} sg_merge_part;

/** Part of a pair that makes no rules equal. */
double sg_merge_plain_part(const sg_rules *r, uint32_t a, uint32_t b);
/** Part of a pair with all its coincidences.
 *  @param c  [n] all coincidences of a and b, sorted by rule, then other */
sg_status sg_merge_part_of(sg_rules *r, const sg_coincidence *c, size_t n, sg_merge_part *out, sg_error *err);
/** Change of energy of a pair with this part, the common part left out. */
double sg_merge_key(const sg_rules *r, const sg_merge_part *part);
/** The common part of the change. */
double sg_merge_common(const sg_rules *r);

/** The whole change for one pair, its coincidences found by looking at the rules that hold a or b. For tests, random
 *  walks and single questions: candidates.h keeps coincidences up to date instead.
 *  @return SG_OK, SG_EINVAL (not compatible), SG_ENOMEM */
sg_status sg_merge_delta(sg_rules *r, uint32_t a, uint32_t b, double *delta, sg_error *err);

/** Merge a and b into the one with the lower index: relabel, unite equal rules (counts add, sizes concatenate), drop
 *  X -> X. r->changes says what was touched. O(length of the touched rules + their buckets).
 *  @return SG_OK, SG_EINVAL (not compatible), SG_ENOMEM (the rules are then unusable but for clearing) */
sg_status sg_merge_apply(sg_rules *r, uint32_t a, uint32_t b, sg_error *err);

/** After an operation: unite each rule of r->changes with one that equals it, drop it if it is X -> X, and bring the
 *  symbols of r->changes up to date. Shared by the operations. */
sg_status sg_merge_settle(sg_rules *r, sg_error *err);

#endif
