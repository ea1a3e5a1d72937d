/* SPDX-License-Identifier: GPL-3.0-or-later */
/* learn_support.h - random split grammars with counts, for the tests of learning. */
#ifndef SG_TESTS_LEARN_SUPPORT_H
#define SG_TESTS_LEARN_SUPPORT_H

#include "core/arena.h"
#include "core/random.h"
#include "grammar/split.h"
#include "parse/lattice.h"

typedef struct {
    sg_split_form form;
    double *counts;
} test_grammar;

/* Distinct rules by construction of the working form; equal ones are united there. Self rules are put in now and then.
 */
static inline test_grammar test_random_grammar(gsl_rng *rng, sg_arena *a, uint32_t nsymbols, uint32_t nterminals,
                                               uint32_t max_rules, uint32_t max_length)
{
    sg_split_rule *rules = SG_NEW_ARRAY(a, sg_split_rule, nsymbols * (max_rules + 1));
    double *counts = SG_NEW_ARRAY(a, double, nsymbols *(max_rules + 1));
    const char **names = SG_NEW_ARRAY(a, const char *, nsymbols),
               **terminals = SG_NEW_ARRAY(a, const char *, nterminals);
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
                                         .n = length,
                                         .rhs = rhs,
                                         .source = SG_NONE};
        }
    }
    return (test_grammar){{.name = "random",
                           .nsymbols = nsymbols,
                           .symbol_names = names,
                           .nterminals = nterminals,
                           .terminal_names = terminals,
                           .terminal_colors = colors,
                           .nrules = n,
                           .rules = rules},
                          counts};
}

/* A facade of w columns and some floors: sky, rows of windows with or without balconies below them, a shop; each cell
 * is another label with probability `noise`. Boundaries are random. */
static inline sg_lattice test_random_facade(gsl_rng *rng, sg_arena *a, double noise)
{
    static const char *labels[] = {"wall", "window", "balcony", "sky", "shop"};
    const size_t w = 2 + gsl_rng_uniform_int(rng, 5), floors = 1 + gsl_rng_uniform_int(rng, 4);
    const size_t first = gsl_rng_uniform_int(rng, 2);
    uint16_t cells[16 * 16];
    size_t h = 0;
    for (size_t x = 0; x < w; x++)
        cells[x] = 3;
    h++;
    for (size_t f = 0; f < floors; f++) {
        const bool balcony = gsl_rng_uniform(rng) < 0.6;
        for (size_t x = 0; x < w; x++) {
            cells[h * w + x] = (x + first) % 2 == 0 ? 1 : 0;
            cells[(h + 1) * w + x] = (x + first) % 2 == 0 && balcony ? 2 : 0;
        }
        h += balcony || gsl_rng_uniform(rng) < 0.5 ? 2 : 1;
    }
    for (size_t x = 0; x < w; x++)
        cells[h * w + x] = 4;
    h++;
    for (size_t i = 0; i < w * h; i++)
        if (gsl_rng_uniform(rng) < noise)
            cells[i] = (uint16_t)gsl_rng_uniform_int(rng, 5);
    sg_lattice l = {.width = w, .height = h, .nlabels = 5, .label_names = labels};
    l.x = SG_NEW_ARRAY(a, uint32_t, w + 1);
    l.y = SG_NEW_ARRAY(a, uint32_t, h + 1);
    l.labels = sg_arena_copy(a, cells, w * h * sizeof *cells);
    for (size_t i = 0; i < w; i++)
        l.x[i + 1] = l.x[i] + 1 + (uint32_t)gsl_rng_uniform_int(rng, 20);
    for (size_t i = 0; i < h; i++)
        l.y[i + 1] = l.y[i] + 1 + (uint32_t)gsl_rng_uniform_int(rng, 20);
    return l;
}

#endif
