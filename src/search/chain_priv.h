/* SPDX-License-Identifier: GPL-3.0-or-later */
/* chain_priv.h - the inside of a chain, for its files: chain.c makes and steps it, chain_state.c keeps where it stands,
 * chain_jump.c and chain_draws.c are the two families of moves. */
#ifndef SG_SEARCH_CHAIN_PRIV_H
#define SG_SEARCH_CHAIN_PRIV_H

#include "derivation/derivation_switch.h"
#include "search/chain.h"

/** Nodes that a move can pick. What belongs on a list is a property of the symbol (jumps) or of the rule (draws). */
typedef enum { SG_LIST_JUMPS, SG_LIST_DRAWS, SG_LIST_SIZES, SG_LISTS } sg_list_kind;

typedef struct {
    uint32_t *nodes; /* [n] in pre-order */
    double *sums;    /* [n] of weights up to and with this one; not kept where all are 1 */
    size_t n, capacity, sums_capacity;
    double total;
} sg_node_list;

/** What each node adds to the posterior. */
typedef struct {
    double *log_rules, *log_density; /* [nodes] */
    size_t rules_capacity, density_capacity;
} sg_node_terms;

/** Where a chain stands; two chains exchange it as a whole. */
typedef struct {
    sg_derivation d;
    sg_score_state *score;
    sg_posterior posterior;
    sg_node_terms terms;
    sg_node_list lists[SG_LISTS];
    unsigned changes; /* since the sums were exact */
} sg_chain_state;

/** A subtree that is proposed, with its terms once they are asked for. */
typedef struct {
    sg_derivation d;
    sg_node_terms terms;
    double log_rules, log_density; /* sums */
    bool summed;
} sg_candidate;

struct sg_chain {
    const sg_grammar *g;
    sg_kernel_opts opts;
    uint64_t seed;
    uint32_t id;
    double beta, sharpness;
    double shares[SG_MOVE_KINDS]; /* cumulative, of the moves that the grammar has a use for; the last is 1, or 0: none */
    double log_base;
    gsl_rng *rng;
    sg_chain_state *at;
    sg_derivation best;
    sg_posterior best_posterior;
    bool at_best;                 /* the best is where the chain stands, and `best` is out of date */
    sg_candidate old, y, z, back; /* subtrees of x, the first and the second proposal, and of y* */
    sg_node_draws draws;
    sg_switcher *switcher;
    unsigned char *of_symbol, *of_rule; /* bit 1 << list */
    double *log_probability;      /* of each rule, where weights are constant */
    sg_chain_stats stats;
};

/* ---- chain_state.c ---- */

sg_status sg_chain_state_create(const sg_grammar *g, const sg_score *score, sg_chain_state **out, sg_error *err);
void sg_chain_state_free(sg_chain_state *s);
/** Terms, sums and lists anew from the derivation; posterior.score is the caller's. @return SG_OK, SG_ENUMERIC, SG_ENOMEM */
sg_status sg_chain_settle(sg_chain *c, sg_error *err);
/** Terms and sums of a candidate. */
sg_status sg_chain_sum(sg_chain *c, sg_candidate *s, sg_error *err);
/** Sums over the subtree of `node` where the chain stands. */
void sg_chain_sum_subtree(const sg_chain *c, size_t node, double *log_rules, double *log_density);

/** True when the subtree of node has the rules of the slice. */
bool sg_chain_same_rules(const sg_derivation *d, size_t node, const sg_derivation *slice);

/** A node of the list, any by weight; SIZE_MAX when it is empty. */
size_t sg_chain_pick(const sg_chain *c, sg_list_kind kind);
/** log of Z before over Z after the slice has replaced the subtree of node: log q_new(node) - log q_old(node) of jumps. */
double sg_chain_log_select(const sg_chain *c, size_t node, const sg_derivation *slice);

/** Make the change that the score has pending. On failure the proposal is rolled back, and the chain is as it was.
 *  @param score  of the proposal
 *  @param s      the slice of the change */
sg_status sg_chain_accept(sg_chain *c, const sg_change *change, sg_candidate *s, const sg_score_value *score,
                          sg_error *err);
/** The same for draws of one node. @param d_log_density NAN: not known */
sg_status sg_chain_accept_draws(sg_chain *c, const sg_change *change, double d_log_density, const sg_score_value *score,
                                sg_error *err);

/* ---- chain.c ---- */

/** log of an acceptance probability below which nothing is accepted: exp of it is nothing next to 1, and less than any
 *  uniform. */
#define SG_LOG_NEVER (-45.0)

/** weight of the score * d_log_score + the other terms; -INFINITY where the score is. */
double sg_chain_log_ratio(const sg_chain *c, double d_log_score, double others);
/** The same, at most 0. */
double sg_chain_log_alpha(const sg_chain *c, double d_log_score, double others);
/** Log score below which log alpha is less than SG_LOG_NEVER, whatever else: a score that stops there loses nothing. */
double sg_chain_floor(const sg_chain *c, double log_score, double others);
/** True with probability exp(log_alpha). */
bool sg_chain_draw(const sg_chain *c, double log_alpha);
/** What annealing adds to the log of a ratio: d_log_prior is of rules and densities. */
double sg_chain_sharpen(const sg_chain *c, double d_log_prior);

/* ---- moves ---- */

sg_status sg_chain_jump(sg_chain *c, sg_move *m, sg_error *err);
sg_status sg_chain_move_draws(sg_chain *c, sg_move *m, sg_error *err);

#endif
