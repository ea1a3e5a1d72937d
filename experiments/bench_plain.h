/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench_plain.h - derivations and scenes as one would write them first: a node is an allocation of its own, rules are chosen from
 * probabilities that are worked out each time, quantiles are GSL's. What the library is measured against. */
#ifndef SG_EXPERIMENTS_BENCH_PLAIN_H
#define SG_EXPERIMENTS_BENCH_PLAIN_H

#include "derivation/derivation.h"

#include <gsl/gsl_rng.h>

/** Sample from the prior of a grammar without guards, repeats, ties and depth limit, whose draws are normals with constant
 *  parameters, and free it again. @return its nodes */
size_t bench_plain_sample(const sg_grammar *g, gsl_rng *rng);

/** Interpret a derivation of turtle operations, brackets and insert() alone: a homogeneous matrix for each state, multiplied at
 *  each operation, and an allocation for each primitive, freed again. @return its primitives */
size_t bench_plain_interpret(const sg_derivation *d);

#endif
