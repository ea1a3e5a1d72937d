/* SPDX-License-Identifier: GPL-3.0-or-later */
/* derivation_oracle.h - all derivations of a finite grammar with their probabilities, by plain recursion.
 *
 * Uniforms count by cells: each is one of `cells` equal parts of (0,1) and stands in the middle of it. For grammars
 * whose draws are discrete with weights that are multiples of 1/cells this is exact, and what copies or redraws
 * uniforms is a Markov chain on cells. For other grammars it is the midpoint rule. */
#ifndef SG_TESTS_DERIVATION_ORACLE_H
#define SG_TESTS_DERIVATION_ORACLE_H

#include "derivation/derivation.h"

/** One derivation and its prior: rule probabilities times cells^-uniforms. The derivation dies after the call. */
typedef void oracle_visit(void *user, const sg_derivation *d, double prior);

/** Visit all derivations of symbol with these arguments at this depth that have at most max_nodes nodes. */
void oracle_each(const sg_grammar *g, unsigned cells, sg_sym symbol, const double *args, uint32_t depth,
                 size_t max_nodes, oracle_visit *visit, void *user);
/** The same of the start symbol. */
void oracle_each_start(const sg_grammar *g, unsigned cells, size_t max_nodes, oracle_visit *visit, void *user);

/** A set of derivations that can be found again by their rules and cells. */
typedef struct {
    unsigned cells;
    sg_derivation *d; /* [n] */
    double *prior;    /* [n] */
    size_t n, capacity;
    size_t *slots; /* [nslots] index + 1, 0: free */
    size_t nslots;
} oracle_space;

void oracle_space_init(oracle_space *s, unsigned cells);
void oracle_space_clear(oracle_space *s);
void oracle_space_add(oracle_space *s, const sg_derivation *d, double prior);
/** All derivations of a symbol, and of the start symbol. */
void oracle_space_fill_symbol(oracle_space *s, const sg_grammar *g, sg_sym symbol, const double *args, uint32_t depth,
                              size_t max_nodes);
void oracle_space_fill(oracle_space *s, const sg_grammar *g, size_t max_nodes);
/** SIZE_MAX where there is none. */
size_t oracle_space_find(const oracle_space *s, const sg_derivation *d);

/** The cell of uniform i of d. */
static inline unsigned oracle_cell(const oracle_space *s, const sg_derivation *d, size_t i)
{
    return (unsigned)(d->uniforms[i] * s->cells);
}

/** First uniform of the subtree of node, and how many it has. */
size_t oracle_uniforms(const sg_derivation *d, size_t node, size_t *n);

/** out = x with the subtree of node replaced: written without sg_derivation_splice(). */
void oracle_replace(const sg_derivation *x, size_t node, const sg_derivation *slice, sg_derivation *out);

/** Product of the rule probabilities in the subtree of node, 0 where a rule is not possible. */
double oracle_rule_probability(const sg_derivation *d, size_t node);

/** Recompute values from uniforms in the subtree of node. @return false when the tree cannot be with these uniforms
 *  (a repeat asks for another number of children) */
bool oracle_refresh(sg_derivation *d, size_t node);

bool oracle_same(const sg_derivation *a, const sg_derivation *b);

#endif
