/* SPDX-License-Identifier: GPL-3.0-or-later */
/* earley_em.h - rule probabilities from lattices by expectation and maximisation (DESIGN 5.1).
 *
 * Each iteration counts the uses of the rules, expected ones (true EM: inside and outside values) or those of the best
 * derivations (Viterbi EM), and sets P(r) to (c(r) + alpha - 1) / sum over the rules of the same symbol. The objective
 *     sum over lattices of log inside (or log Viterbi) + (alpha - 1) * sum over rules of log P
 * never falls. Source: Dempster, Laird and Rubin, "Maximum likelihood from incomplete data via the EM algorithm", JRSS
 * B 39 (1977); Baker, "Trainable grammars for speech recognition" (1979). In region mode inside values are weights and
 * no probabilities, and they still rise. */
#ifndef SG_PARSE_EARLEY_EM_H
#define SG_PARSE_EARLEY_EM_H

#include "core/progress.h"
#include "core/status.h"
#include "parse/earley.h"

typedef enum { SG_EM_TRUE, SG_EM_VITERBI } sg_em_kind;

typedef struct {
    sg_em_kind kind;
    sg_leaf_mode mode;
    size_t iterations; /* at most */
    double alpha;      /* >= 1; Dirichlet prior of the rules of each symbol, 1: none */
    double tolerance;  /* ends when an iteration raises the objective by less than this share of its size */
} sg_em_opts;

#define SG_EM_OPTS_INIT                                                                                                \
    {                                                                                                                  \
        SG_EM_TRUE, SG_CELL_MODE, 100, 1.0, 1e-10                                                                      \
    }

/** Re-estimate the rule probabilities of a form from those it has.
 *  Rules of a symbol that is not used keep theirs. With alpha 1 a rule that is never used gets 0 and stays there.
 *  @param cells          [n], n >= 1
 *  @param progress       may be NULL
 *  @param probabilities  out [nrules of the form]
 *  @param objective      out NULL or [iterations + 1]: before the first iteration and after each
 *  @param niterations    out NULL or how many were made
 *  @return SG_OK, SG_STOPPED (probabilities are those of the last iteration), SG_ENOPARSE (a lattice is outside the
 *          language; its number is named), SG_EINVAL, SG_ENUMERIC, SG_ENOMEM; on failure the outputs are undefined */
sg_status sg_em_reestimate(const sg_split_form *form, const sg_cells *cells, size_t n, const sg_em_opts *opts,
                           sg_progress *progress, double *probabilities, double *objective, size_t *niterations,
                           sg_error *err);

#endif
