/* SPDX-License-Identifier: GPL-3.0-or-later */
/* derivation_grammars.h - the grammars of which tests and fuzzers read derivations: between them they use every kind of
 * body that decides what is stored. The files in tests/corpus hold derivations of the first. */
#ifndef SG_TESTS_DERIVATION_GRAMMARS_H
#define SG_TESTS_DERIVATION_GRAMMARS_H

/* Tied siblings, parameters, guards, weights that depend on them, draws of several kinds, repeats, a depth limit with a
 * completion and without, optional successors, labels as symbols. A label scene when it is not cut at the limit. */
#define GRAMMAR_OF_DERIVATIONS                                                                                         \
    "grammar stored\n"                                                                                                 \
    "tied\n"                                                                                                           \
    "weights\n"                                                                                                        \
    "limit depth 6\n"                                                                                                  \
    "label t\n"                                                                                                        \
    "label w\n"                                                                                                        \
    "start S(2)\n"                                                                                                     \
    "rule S(a) if a > 0.3\n"                                                                                           \
    "  -> 1 + a : u ~ uniform(0.1, a) split x { T(u) | S(a / 2) | T(u) | t }\n"                                        \
    "  -> 1 : split y { S(a * 0.7) | T(1) | t } sizes mean (0.2, 0.5, 0.3) sd (0.1, 0.2, 0.1)\n"                       \
    "  -> 1 : repeat x 1 + floor(a + 0.5) { split y { S(a / 3) | T(a) } }\n"                                           \
    "rule S(a) if a <= 0.3\n"                                                                                          \
    "  -> 1 : w\n"                                                                                                     \
    "rule S(a) at limit -> w\n"                                                                                        \
    "rule T(b)\n"                                                                                                      \
    "  -> 2 : t\n"                                                                                                     \
    "  -> 1 : v ~ mixture((1, b, 0.5), (2, 0, 1)) split x { '0.5 : U(v) | '0.5 : t }\n"                                \
    "rule U(v)\n"                                                                                                      \
    "  -> 1 : t\n"                                                                                                     \
    "  -> 1 : k ~ discrete((1, 1), (3, 2)) repeat y k { w }\n"

#endif
