/* SPDX-License-Identifier: GPL-3.0-or-later */
/* kernel_oracle.h - the Markov kernel that a chain has on the cells of a finite grammar (derivation_oracle.h), put
 * together from the grammar's proposal probabilities and any acceptance probabilities.
 *
 * With pi the target and F(x,z) = pi(x) K(x,z) the flow, the target is kept when in each state as much flows in as out;
 * || pi K - pi ||_1 is the sum of the differences. What stays where it is needs no account. */
#ifndef SG_TESTS_KERNEL_ORACLE_H
#define SG_TESTS_KERNEL_ORACLE_H

#include "search/chain.h"
#include "tests/derivation_oracle.h"

/** A jump proposes y at node v of x; its second stage z, with `back` (y* of MATHEMATICS B5.4) on the way back. */
typedef struct {
    sg_move_kind kind;
    size_t x, v, y; /* states; y is SIZE_MAX when it is outside of the target */
    size_t z, back; /* z is SIZE_MAX in the first stage */
} kernel_step;

typedef struct kernel_model kernel_model;
/** Log acceptance of a step, which is proposed with probability p (that of its state in pi included). */
typedef double kernel_accept(void *user, const kernel_model *m, const kernel_step *step, double p);
typedef double kernel_score(const sg_derivation *d, void *user);

struct kernel_model {
    sg_grammar *g;
    oracle_space space;
    size_t max_nodes;
    double *log_score;   /* [space.n] */
    double *log_rules;   /* [space.n] sum of log rule probabilities */
    double *log_density; /* [space.n] of draws in value space */
    double *pi;          /* [space.n] the target, normalised; 0 where the score is -INFINITY */
    double beta, base, sharpness;
    size_t delayed_nodes;   /* second stages where neither subtree is larger */
    size_t width;           /* most nodes of a state */
    bool *jumps;            /* [space.n][width] nodes where jumps are tried */
    oracle_space *subtrees; /* one for each symbol, depth and arguments that came up; only its root tells which */
    size_t nsubtrees;
};

/** All derivations of the grammar with at most max_nodes nodes. Jumps are tried at nodes whose symbol has several
 *  rules, or where one of them draws. */
void kernel_model_init(kernel_model *m, const char *grammar, unsigned cells, size_t max_nodes, kernel_score *score,
                       void *user);
void kernel_model_clear(kernel_model *m);
/** The target prior * exp(beta * log score), in values to the power of sharpness; weights b^-depth. Begin with this; second
 *  stages are then of subtrees of any size. */
void kernel_model_temper(kernel_model *m, double beta, double base, double sharpness);

/** log of the sum of b^-depth over the nodes of x where jumps are tried. */
double kernel_log_weight(const kernel_model *m, size_t x);
static inline bool kernel_jumps_at(const kernel_model *m, size_t x, size_t v)
{
    return v < m->space.d[x].nnodes && m->jumps[x * m->width + v];
}

/** The acceptances of MATHEMATICS B5 and DESIGN 5.3, both stages, written down once more. */
double kernel_right_accept(void *user, const kernel_model *m, const kernel_step *step, double p);

/** Off the diagonal: [n][n] pi(x) K(x,z), of so many first and second stages. */
typedef struct {
    double *flow;
    size_t first, second;
    double proposed; /* probability of all first stages */
} kernel_flow;

void kernel_flow_init(kernel_flow *f, const kernel_model *m);
void kernel_flow_clear(kernel_flow *f);
/** Add share times the kernel of this kind of move (a jump, or resampling). Steps are asked for in a fixed order, from
 *  states that have probability; second stages where the first can be rejected. */
void kernel_add(kernel_flow *f, kernel_model *m, sg_move_kind kind, bool delayed, double share, kernel_accept *accept,
                void *user);
double kernel_imbalance(const kernel_flow *f, const kernel_model *m);       /* || pi K - pi ||_1 */
double kernel_irreversibility(const kernel_flow *f, const kernel_model *m); /* largest |F(x,y) - F(y,x)| */

#endif
