/* SPDX-License-Identifier: GPL-3.0-or-later */
/* finish.h - from the merged grammar to the one that samples and parses regions (DESIGN 5.2, "Finish").
 * Runs of one symbol in a right-hand side are collapsed (their sizes add), rules that are then equal unite, X -> X goes,
 * probabilities are normalised again, and a normal density is fitted to the relative sizes of each rule. */
#ifndef SG_LEARN_FINISH_H
#define SG_LEARN_FINISH_H

#include "core/arena.h"
#include "core/status.h"
#include "grammar/split.h"

/** How the density of a rule's sizes is fitted, by the axis of its split (sg_split_op). A concentration c > 0 shrinks it
 *  towards the covariance of a Dirichlet distribution with the rule's mean, (diag m - m m') / (c + 1), in place of its own
 *  diagonal: so a rule with one example has sizes that vary as those of other rules do. */
typedef struct {
    double concentration[2]; /* 0: its own diagonal; SG_CONCENTRATION_POOLED: as the sizes of all rules along the axis with
                                several examples vary (sg_pooled_concentration()), where there are such rules */
} sg_density_opts;

#define SG_CONCENTRATION_POOLED (-1.0)
#define SG_DENSITY_OPTS_INIT    {{0, 0}}

/** Finish a merged grammar.
 *
 *  A run is collapsed where one region of its symbol can stand for the run: where the symbol makes one label only, or
 *  where its one rule cuts the other axis into such symbols (a column of window over balcony, side by side with another).
 *  Departs from DESIGN 5.2, which collapses every run: that would turn four storeys of one symbol into one tall storey.
 *
 *  @param merged  rules with the relative sizes of their uses; probabilities of one symbol sum to 1
 *  @param out     in the arena; symbols that are no longer reachable are left out
 *  @return SG_OK, SG_ENOMEM */
sg_status sg_finish(const sg_split_form *merged, const sg_density_opts *densities, sg_arena *arena, sg_split_form *out,
                    sg_error *err);

/** Mean and shrunk covariance of the relative sizes of one rule: Sigma = (m S + nu0 S0) / (m + nu0) over the first n-1
 *  sizes, nu0 = n + 1, S the maximum-likelihood covariance of the m uses. S0 = diag S, and 0.01 squared the least variance,
 *  so that one use already gives a proper density; or, with a concentration, the Dirichlet's. (DESIGN 5.2; equation 5 of the
 *  paper is singular for m <= n-1 and undefined for m = 1.)
 *  @param sizes          [m][n], m >= 1, n >= 2; with a concentration none is 0 in all uses
 *  @param concentration  0: S0 = diag S
 *  @param mean           out [n]
 *  @param covariance     out [n-1][n-1] */
void sg_fit_sizes(const double *sizes, size_t m, size_t n, double concentration, double *mean, double *covariance);

/** The concentration with which the sizes of rules along the axis vary about the means of their rules, by moments: under a
 *  Dirichlet the variance of a size is m (1 - m) / (c + 1). 0 where no rule has several examples, or they do not differ. */
double sg_pooled_concentration(const sg_split_form *f, sg_split_op axis);

#endif
