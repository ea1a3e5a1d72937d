/* SPDX-License-Identifier: GPL-3.0-or-later */
/* derivation_switch.h - another rule for a node that keeps what the two rules have in common.
 *
 * A jump of the usual kind derives the whole subtree anew: where much stands below, hardly any is accepted. Rules of learned
 * split grammars often differ by a few parts only. A switch draws another rule from the prior, aligns the two
 * right-hand sides by a prefix and a suffix, and changes only the block between them: parts outside keep their sizes and
 * subtrees, the block keeps its extent. Within it sizes are drawn anew, and children whose symbols both blocks have are
 * kept, the k-th of a symbol for the k-th; the others are derived anew. With tied siblings every child whose symbol both
 * rules have is kept.
 *
 * It is its own reverse (Green, "Reversible jump Markov chain Monte Carlo computation", Biometrika 82(4), 1995): alignment
 * and matching do not depend on the direction, rules and new subtrees are drawn with the probability that the prior
 * gives them, and what remains is the density of the root's sizes, told in `log_propose`.
 *
 * Flat rules take part: one split along x or y whose sizes are all drawn, each part one symbol without arguments, or a body of
 * one symbol. */
#ifndef SG_DERIVATION_DERIVATION_SWITCH_H
#define SG_DERIVATION_DERIVATION_SWITCH_H

#include "derivation/derivation_move.h"

typedef struct sg_switcher sg_switcher; /* what is known of a grammar's rules, and work space: one for each thread */

/** @param g  must outlive it. @return SG_OK, SG_ENOMEM */
sg_status sg_switcher_create(const sg_grammar *g, sg_switcher **out, sg_error *err);
void sg_switcher_free(sg_switcher *w);

/** True when some symbol has two rules that can be switched. */
bool sg_switcher_useful(const sg_switcher *w);

/** Propose another rule for `node` into `slice`.
 *  @param max_nodes    of d with the slice in it
 *  @param log_propose  out: log of reverse over forward proposal density in the space of uniforms
 *  @param inside       out: false when there is nothing to propose: rules that cannot be aligned, the rule that is there
 *                      already, sizes outside of the simplex, too many nodes
 *  @return SG_OK, SG_ENUMERIC (the grammar fails as in sg_derivation_sample()), SG_ENOMEM */
sg_status sg_switcher_propose(sg_switcher *w, const sg_derivation *d, size_t node, gsl_rng *rng, size_t max_nodes,
                              sg_derivation *slice, double *log_propose, bool *inside, sg_error *err);

#endif
