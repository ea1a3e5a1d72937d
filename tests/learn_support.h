/* SPDX-License-Identifier: GPL-3.0-or-later */
/* learn_support.h - random split grammars with counts, for the tests of learning. */
#ifndef SG_TESTS_LEARN_SUPPORT_H
#define SG_TESTS_LEARN_SUPPORT_H

#include "core/arena.h"
#include "core/random.h"
#include "grammar/split.h"

typedef struct {
    sg_split_form form;
    double *counts;
} test_grammar;

/* Distinct rules by construction of the working form; equal ones are united there. Self rules are put in now and then. */
static inline test_grammar test_random_grammar(gsl_rng *rng, sg_arena *a, uint32_t nsymbols, uint32_t nterminals,
                                               uint32_t max_rules, uint32_t max_length)
{
    sg_split_rule *rules = SG_NEW_ARRAY(a, sg_split_rule, nsymbols * (max_rules + 1));
    double *counts = SG_NEW_ARRAY(a, double, nsymbols * (max_rules + 1));
    const char **names = SG_NEW_ARRAY(a, const char *, nsymbols), **terminals = SG_NEW_ARRAY(a, const char *, nterminals);
    uint32_t *colors = SG_NEW_ARRAY(a, uint32_t, nterminals);
    size_t n = 0;
    for (uint32_t t = 0; t < nterminals; t++)
        terminals[t] = sg_arena_printf(a, "t%u", t);
    for (uint32_t s = 0; s < nsymbols; s++) {
        names[s] = sg_arena_printf(a, "X%u", s);
        const uint32_t k = 1 + (uint32_t)gsl_rng_uniform_int(rng, max_rules);
        for (uint32_t i = 0; i <= k && i < max_rules + 1; i++) {
            const bool lexical = i == 0 || gsl_rng_uniform(rng) < 0.2;
            const uint32_t length = lexical ? 1 : 1 + (uint32_t)gsl_rng_uniform_int(rng, max_length);
            uint32_t *rhs = SG_NEW_ARRAY(a, uint32_t, length);
            for (uint32_t j = 0; j < length; j++)
                rhs[j] = (uint32_t)gsl_rng_uniform_int(rng, lexical ? nterminals : nsymbols);
            counts[n] = (double)gsl_rng_uniform_int(rng, 7);
            rules[n++] = (sg_split_rule){.lhs = s,
                                         .op = lexical ? SG_SPLIT_LEXICAL : (sg_split_op)gsl_rng_uniform_int(rng, 2),
                                         .n = length, .rhs = rhs, .source = SG_NONE};
        }
    }
    return (test_grammar){{.name = "random", .nsymbols = nsymbols, .symbol_names = names, .nterminals = nterminals,
                           .terminal_names = terminals, .terminal_colors = colors, .nrules = n, .rules = rules}, counts};
}

#endif
