/* SPDX-License-Identifier: GPL-3.0-or-later */
/* energy.h - the energy of a grammar given data, in nats (DESIGN 5.2):
 *
 *     E(G|D) = w DL(G_S) - w log P(theta|G_S) - log P(D|G)
 *
 * with Viterbi counts c_r of the rules. Both data terms have one shape, a term a rule and a term a left-hand side,
 *
 *     w log P(theta|G_S) + log P(D|G) = sum_X [ z(k_X, C_X) + sum_r g(c_r) ],
 *
 * so that whoever changes a grammar needs to know g and z only:
 *   marginal   g(c) = lgamma(alpha + c) - lgamma(alpha),  z(k,C) = lgamma(k alpha) - lgamma(k alpha + C)
 *   viterbi    g(c) = (c + w a) log(c + a),  z(k,C) = w [lgamma(k alpha) - k lgamma(alpha)] - (C + w k a) log(C + k a)
 * with a = alpha - 1. Source: Stolcke and Omohundro, "Inducing probabilistic grammars by Bayesian model merging"
 * (1994); Martinovic and Van Gool, CVPR 2013, for w. Departs from the latter's program: its Dirichlet term has the
 * normaliser upside down, and it has no marginal form. */
#ifndef SG_LEARN_ENERGY_H
#define SG_LEARN_ENERGY_H

#include "grammar/split.h"

#include <stdbool.h>
#include <stddef.h>

typedef enum { SG_DATA_MARGINAL, SG_DATA_VITERBI } sg_data_term;

typedef struct {
    double weight; /* w >= 0 */
    sg_data_term data_term;
    double alpha; /* > 0 */
    bool poisson; /* lengths of right-hand sides are Poisson(n - 1; mu); else free of charge */
    double mu;
} sg_energy_opts;

/** The weight is a measured one: FOLDS="1 2 3 5" IMAGES=4 experiments/weight_sweep.sh ECP --regroup floors, energy per
 *  pixel of the best parses of held-out facades: 0.718 (initial grammar), 0.267 (w = 0.3, the paper's), 0.204 (w = 1),
 *  0.201 (w = 2). */
#define SG_ENERGY_OPTS_INIT                                                                                            \
    {                                                                                                                  \
        1.0, SG_DATA_MARGINAL, 1.0, true, 2.0                                                                          \
    }

/** g(c) above; c >= 0. */
double sg_energy_rule_term(const sg_energy_opts *o, double count);
/** z(k, C) above; 0 for k = 0. */
double sg_energy_symbol_term(const sg_energy_opts *o, size_t nrules, double count);
/** log P(n): the length prior of a non-lexical right-hand side of n symbols, 0 without one. */
double sg_energy_log_length(const sg_energy_opts *o, size_t n);
/** The probability of a rule with this count, among nrules rules with this total: the maximising one of the viterbi
 * term (M-step with c + alpha - 1), the posterior mean of the marginal one. */
double sg_energy_probability(const sg_energy_opts *o, double count, size_t nrules, double total);

typedef struct {
    double energy;
    double log_structure_prior; /* -DL */
    double log_parameter_prior; /* 0 with the marginal data term */
    double log_likelihood;
} sg_energy_parts;

/** The energy from scratch, by its definition and not by g and z: what carried energies are checked against.
 *  @param counts  [nrules] uses of each rule of the form
 *  @return SG_OK, SG_ENUMERIC (a count for which the data term is undefined), SG_ENOMEM */
sg_status sg_energy_of_form(const sg_energy_opts *o, const sg_split_form *form, const double *counts,
                            sg_energy_parts *out, sg_error *err);

#endif
