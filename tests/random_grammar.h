/* SPDX-License-Identifier: GPL-3.0-or-later */
/* random_grammar.h - random grammars for property tests: valid texts over the whole language, and random split forms. */
#ifndef SG_TESTS_RANDOM_GRAMMAR_H
#define SG_TESTS_RANDOM_GRAMMAR_H

#include "core/arena.h"
#include "grammar/split.h"

#include <gsl/gsl_rng.h>

typedef struct {
    unsigned max_symbols; /* non-terminals */
    bool derivable;       /* every derivation can be drawn: guards in complementary pairs, weights positive, a depth limit */
    bool strange_layout;  /* comments and line ends between tokens, quoted and non-Latin names */
} random_grammar_opts;

#define RANDOM_GRAMMAR_OPTS_INIT {5, false, true}

/** The text of a valid grammar; free() it. All constructs of the language come up sooner or later. */
char *random_grammar_text(gsl_rng *rng, const random_grammar_opts *opts);

typedef struct {
    unsigned max_symbols, max_terminals, max_length; /* the last: of right-hand sides */
    bool sizes, attributes;                          /* with size models and training sizes in some rules */
} random_split_opts;

#define RANDOM_SPLIT_OPTS_INIT {6, 4, 5, true, true}

/** A valid split form: every symbol is reachable and productive, probabilities sum to 1. */
void random_split_form(gsl_rng *rng, const random_split_opts *opts, sg_arena *arena, sg_split_form *out);

#endif
