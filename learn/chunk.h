/* SPDX-License-Identifier: GPL-3.0-or-later */
/* chunk.h - chunking: a new symbol Y -> Z1..Zk for a sequence that right-hand sides repeat.
 * Each derivation goes through Y in exactly one way, so the data term stays as it is and the change of energy is that
 * of the description length alone (Stolcke and Omohundro 1994; closed form in MATHEMATICS B4). */
#ifndef SG_LEARN_CHUNK_H
#define SG_LEARN_CHUNK_H

#include "learn/rules.h"

#define SG_CHUNK_MAX 12 /* symbols */

typedef struct {
    sg_split_op op;
    uint32_t n;
    uint32_t rhs[SG_CHUNK_MAX];
    double delta; /* change of energy */
} sg_chunk;

/** The chunk that lowers the energy most, or that raises it least; ties go to the one that stands first in the rules.
 *  Occurrences do not overlap and are taken from the left. found: false when no sequence occurs twice.
 *  @return SG_OK, SG_ENOMEM */
sg_status sg_chunk_best(const sg_rules *r, sg_chunk *out, bool *found, sg_error *err);

/** Change of energy of one chunk. */
double sg_chunk_delta(const sg_rules *r, sg_split_op op, const uint32_t *rhs, uint32_t n);

/** Make the symbol and put it in place of every occurrence; sizes are split up between the rules. r->changes says what
 *  was touched. @param symbol  out: the new one
 *  @return SG_OK, SG_ENOMEM (the rules are then unusable but for clearing) */
sg_status sg_chunk_apply(sg_rules *r, const sg_chunk *chunk, const char *name, uint32_t *symbol, sg_error *err);

#endif
