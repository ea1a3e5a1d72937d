/* SPDX-License-Identifier: GPL-3.0-or-later */
/* reestimate.h - counts of the rules by parsing the lattices (DESIGN 5.1, 5.2): Viterbi counts, or expected ones.
 *
 * After each merge only those lattices are parsed again whose best derivation may have changed, and the result is the
 * same as if all were. A lattice is left out
 *   - for good, when it has one derivation only in the coarsest grammar that merges can still lead to (all symbols of
 *     equal labels in one; those with lexical rules apart, until one of them is merged), and each rule of that
 * derivation stands for one rule of the present grammar: then it has one derivation in every grammar on the way;
 *   - this time, when no symbol whose rules changed can stand in a derivation of it, as the coarsest grammar tells. */
#ifndef SG_LEARN_REESTIMATE_H
#define SG_LEARN_REESTIMATE_H

#include "learn/corpus.h"
#include "learn/rules.h"

typedef struct sg_reestimator sg_reestimator;

typedef struct {
    bool expected;  /* expected counts (EM proper) in place of those of the best derivations; then every lattice is
                       parsed */
    bool parse_all; /* leave nothing out: the plain way, for comparison */
} sg_reestimate_opts;

/** @param corpus  borrowed */
sg_status sg_reestimator_create(const sg_corpus *corpus, const sg_reestimate_opts *opts, sg_reestimator **out,
                                sg_error *err);
void sg_reestimator_free(sg_reestimator *e);
/** The next call is about another grammar, or one that was changed in another way than by merges. */
void sg_reestimator_forget(sg_reestimator *e);

typedef struct {
    size_t parsed;     /* lattices parsed in this call */
    double log_parsed; /* sum over them of log Viterbi or log inside, under the probabilities before the call */
    bool changed;      /* some count is another one now */
    bool removed;      /* rules without uses, and symbols without rules, went */
} sg_reestimate_result;

/** Parse, set the counts, remove rules that are not used and symbols without rules. r->changes says what was touched.
 *  @return SG_OK; SG_ENOPARSE when a lattice is outside the language (its number is named); SG_ENOMEM, SG_ENUMERIC */
sg_status sg_reestimate(sg_reestimator *e, sg_rules *r, sg_reestimate_result *out, sg_error *err);

/** Until the counts stay as they are, at most `rounds` times. @param nparsed  in/out, NULL or added to */
sg_status sg_reestimate_until_stable(sg_reestimator *e, sg_rules *r, size_t rounds, size_t *nparsed, sg_error *err);

/** Relative sizes of all uses in the best derivations, in pixels of the lattices; those that were there are forgotten.
 *  Counts become those of these derivations. @return as above */
sg_status sg_reestimate_sizes(sg_reestimator *e, sg_rules *r, sg_error *err);

#endif
