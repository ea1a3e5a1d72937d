/* SPDX-License-Identifier: GPL-3.0-or-later */
/* chain.h - one Metropolis chain over derivations (DESIGN 5.3, MATHEMATICS B5): jump, diffusion, delayed rejection.
 *
 * The target is pi_beta(d) = prior(d) * exp(beta * log score(d)): inverse temperature weighs the score alone. All ratios
 * are in the space of uniforms, where every draw has density 1. A chain is a pure function of its derivation, the seed,
 * its number and the iteration: it owns no generator, each step starts the stream (seed, id, iteration). */
#ifndef SG_SEARCH_CHAIN_H
#define SG_SEARCH_CHAIN_H

#include "core/progress.h"
#include "derivation/derivation.h"
#include "score/score.h"

#include <gsl/gsl_rng.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum {
    SG_MOVE_JUMP_FRESH,  /* the subtree of a node anew from the rules, all values fresh */
    SG_MOVE_JUMP_COPY,   /* the same, values copied in pre-order, surplus dropped, lack filled with fresh uniforms */
    SG_MOVE_RESAMPLE,    /* all uniforms of one node anew */
    SG_MOVE_REFLECT,     /* one uniform of one node by a reflected Gaussian step */
    SG_MOVE_SHIFT,       /* one size of a split grows by a Gaussian step in value space, a later one shrinks by it: a boundary
                            moves, or all that stands between two sizes slides */
    SG_MOVE_SWITCH,      /* another rule for a split, which keeps what the two have in common (derivation_switch.h) */
    SG_MOVE_KINDS,
} sg_move_kind;

/** What one step did, every term apart, so that each can be tested and drawn. */
typedef struct {
    sg_move_kind kind;
    size_t node;           /* SIZE_MAX: nothing to move (no eligible node); the step left the state as it was */
    double d_log_score;    /* first proposal minus current; -INFINITY below the floor */
    double d_log_rules;    /* log of the ratio of rule probabilities where they do not cancel */
    double d_log_select;   /* log q_new(v) - log q_old(v); 0 for diffusions */
    double d_log_propose;  /* log of reverse over forward proposal density in the space of uniforms; 0 where symmetric */
    double d_log_anneal;   /* what annealing adds: 0 unless the sharpness is other than 1 */
    double log_accept;     /* of the first stage, at most 0 */
    bool second_stage;     /* a second stage was tried, with */
    double log_accept2;
    bool accepted;         /* by either stage */
} sg_move;

/** Shares are relative to each other; a move that the grammar has no use for (no draws, say) takes no share. */
typedef struct {
    double share[SG_MOVE_KINDS];
    bool delayed_rejection;   /* after rejected jumps, where */
    size_t delayed_nodes;     /* neither the old nor the new subtree is larger: second tries of large ones cost most */
    double depth_base;        /* b of q(v) = b^-depth(v) / Z */
    double reflect_step;      /* sd in the space of uniforms */
    double shift_step;        /* sd as a share of the two sizes' sum; each step also draws its scale, so that small and large
                                 steps both happen */
    size_t max_nodes;         /* larger derivations are outside of the target: a proposal of one is rejected */
} sg_kernel_opts;

#define SG_KERNEL_OPTS_INIT {{0.08, 0.02, 0.06, 0.1, 0.66, 0.08}, true, 64, 3.0, 0.1, 0.5, 1000000}

/** The parts of the posterior at a derivation. */
typedef struct {
    sg_score_value score;
    double log_rules;   /* sum of log rule probabilities */
    double log_density; /* sum of log densities of all draws in value space */
} sg_posterior;

/** What is reported as the best is best by this: -(E_img + E_rule + E_attr) of DESIGN 5.4. */
static inline double sg_posterior_log(const sg_posterior *p)
{
    return p->score.log + p->log_rules + p->log_density;
}

typedef struct sg_chain sg_chain;

/** @param score  target; g and score must outlive the chain
 *  @param id     number of the chain: its streams
 *  @return SG_OK, SG_EINVAL (shares negative or all zero, a step or base that is no positive number), SG_ENOMEM */
sg_status sg_chain_create(const sg_grammar *g, const sg_score *score, const sg_kernel_opts *opts, uint64_t seed,
                          uint32_t id, double beta, sg_chain **out, sg_error *err);
void sg_chain_free(sg_chain *c);

/** Begin at a copy of d, or (NULL) at the best of `tries` samples of the prior, drawn from the stream of iteration 0.
 *  @param progress  may be NULL; asked between samples whether to stop. Then the best so far will do
 *  @return SG_OK, SG_STOPPED (before any sample could be scored), SG_ENOPARSE (the score is -INFINITY at d, or at every one of the samples), SG_ENUMERIC, SG_ENOMEM */
sg_status sg_chain_start(sg_chain *c, const sg_derivation *d, size_t tries, sg_progress *progress, sg_error *err);

/** One iteration (numbered from 1), all its stages. @param move  out, may be NULL
 *  @return SG_OK, SG_ENUMERIC (the grammar itself fails), SG_ENOMEM */
sg_status sg_chain_step(sg_chain *c, uint64_t iteration, sg_move *move, sg_error *err);

/** Exchange the derivations (and scores) of two chains of one target with probability min(1, exp((beta_a - beta_b)
 *  (log_b - log_a))), or what it is with annealing; the streams and inverse temperatures stay. Neither is exchanged when
 *  memory for what one of them leaves as its best is out. @param u  a uniform. @return true: exchanged */
bool sg_chain_swap(sg_chain *a, sg_chain *b, double u);

const sg_derivation *sg_chain_derivation(const sg_chain *c);
const sg_posterior *sg_chain_posterior(const sg_chain *c);
double sg_chain_beta(const sg_chain *c);
void sg_chain_set_beta(sg_chain *c, double beta);
/** Annealing: the target becomes (prior * density * exp(beta * log score))^sharpness as a density of values, so that with
 *  beta 1 and growing sharpness the chain comes to what is reported as best. 1, where a chain begins: the posterior. */
void sg_chain_set_sharpness(sg_chain *c, double sharpness);
/** Best derivation that this chain has been at since it began, and its posterior; kept without a copy at each improvement
 *  where that can be avoided. */
const sg_derivation *sg_chain_best(const sg_chain *c, sg_posterior *p);

typedef struct {
    uint64_t proposed[SG_MOVE_KINDS], accepted[SG_MOVE_KINDS]; /* accepted by the first stage */
    uint64_t second_proposed, second_accepted;
} sg_chain_stats;
const sg_chain_stats *sg_chain_statistics(const sg_chain *c);

#endif
