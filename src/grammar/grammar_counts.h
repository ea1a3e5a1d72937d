/* SPDX-License-Identifier: GPL-3.0-or-later */
/* grammar_counts.h - how large a grammar is. */
#ifndef SG_GRAMMAR_GRAMMAR_COUNTS_H
#define SG_GRAMMAR_GRAMMAR_COUNTS_H

#include "grammar/grammar.h"

/** Of what is written: the hidden symbols that stand for labels in splits and for optional successors, and their rules, are
 *  counted apart. */
typedef struct {
    size_t nonterminals;
    size_t labels;
    size_t hidden;
    size_t rules;      /* alternatives, those at the depth limit included */
    size_t arguments;  /* formal parameters of non-terminals */
    size_t draws;      /* random numbers that rules draw: of sizes that sum to 1 all but the last */
    size_t operations; /* shape operations in bodies */
    size_t successors; /* symbols and labels in bodies */
} sg_grammar_counts;

/** Count a grammar: one pass over its symbols and rules. */
sg_grammar_counts sg_grammar_count(const sg_grammar *g);

#endif
