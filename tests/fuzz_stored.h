/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fuzz_stored.h - the grammar whose derivations the fuzzers of both readers take their bytes for. */
#ifndef SG_TESTS_FUZZ_STORED_H
#define SG_TESTS_FUZZ_STORED_H

#include "grammar/grammar.h"
#include "tests/derivation_grammars.h"
#include "tests/fuzz.h"

#include <string.h>

/** Read once for all inputs. */
static inline const sg_grammar *fuzz_stored_grammar(void)
{
    static const char text[] = GRAMMAR_OF_DERIVATIONS;
    static sg_grammar *g;
    if (g == NULL)
        fuzz_must(sg_grammar_parse(text, strlen(text), "stored", &g, NULL) == SG_OK);
    return g;
}

#endif
