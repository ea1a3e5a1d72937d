/* SPDX-License-Identifier: GPL-3.0-or-later */
/* kernel_grammars.h - finite grammars that between them use all that a derivation can hold. */
#ifndef SG_TESTS_KERNEL_GRAMMARS_H
#define SG_TESTS_KERNEL_GRAMMARS_H

#include <stddef.h>
#include <stdint.h>

typedef struct {
    const char *name;
    unsigned cells; /* weights of discrete draws are multiples of 1/cells */
    size_t max_nodes;
    const char *text;
} finite_grammar;

static const finite_grammar finite_grammars[] = {
    {"branching", 1, 100,
     "weights label a label b start X\n"
     "rule X if depth < 2 -> 5 : split x { X | X } -> 2 : a -> 3 : b\n"
     "rule X if depth >= 2 -> 4 : a -> 6 : b\n"},
    {"cut off by size", 1, 4,
     "label a label b start X\n"
     "rule X -> 0.3 : split x { X | X } -> 0.2 : X -> 0.3 : a -> 0.2 : b\n"},
    {"depth limit", 1, 100,
     "weights limit depth 2 label a label b label c start S(2)\n"
     "rule S(n) if n > 0 -> 1 + n : split x { S(n - 1) | T(n) } "
     "  -> 2 : split y { T(n) | maybe(0.3) S(n / 2) } -> 1 : a\n"
     "rule S(n) if n <= 1 -> a -> 3 : b\n"
     "rule S(n) at limit -> split x { b | c }\n"
     "rule T(n) if n > 1 -> n : a -> b\n"
     "rule T(n) if n <= 1 -> a -> c -> split x { U | U }\n"
     "rule U -> a -> b\n"},
    {"tied", 1, 100,
     "tied label a label b start S\n"
     "rule S -> 0.5 : split y { A | A | B } -> 0.3 : split y { A | B | A } -> 0.2 : split x { B | B }\n"
     "rule A -> 0.6 : split x { B | a | B } -> 0.4 : b\n"
     "rule B -> 0.3 : a -> 0.7 : b\n"},
    {"repeats", 1, 100,
     "weights label a label b start S(2)\n"
     "rule S(n) -> repeat x n { A(n) } -> 2 : repeat y n + 1 { A(1) } -> 1 : split x { A(2) | repeat y 2 { B } }\n"
     "rule A(n) -> a -> n : b\n"
     "rule B -> a -> A(1)\n"},
    /* from here on with values; the first is small enough for all second stages to be seen */
    {"coins", 2, 100,
     "label a start S\n"
     "rule S -> 0.4 : x ~ discrete((1, 1), (1, 4)) scale(x, 1, 1) a -> 0.6 : split x { B | B }\n"
     "rule B -> x ~ discrete((1, 0), (1, 3)) scale(x, 1, 1) a\n"},
    /* S -> A (one) | B B (two), as in MATHEMATICS B5.2 */
    {"one or two values", 3, 100,
     "label a start S\n"
     "rule S -> 0.4 : A -> 0.6 : split x { B | B }\n"
     "rule A -> x ~ discrete((1, 1), (2, 4)) scale(x, 1, 1) a\n"
     "rule B -> x ~ discrete((2, 0), (1, 3)) scale(x, 1, 1) a\n"},
    {"values decide what follows", 2, 100,
     "weights label a label b label c start S\n"
     "rule S -> x ~ discrete((1, 1), (1, 3)) split x { T(x) | maybe(x / 4) b } -> T(2)\n"
     "rule T(x) if x < 3 -> x : a -> y ~ discrete((1, 1), (1, 2)) U(x + y)\n"
     "rule T(x) if x >= 2 -> 1 : b -> x : y ~ discrete((1, 1), (1, 5)) split x { U(y) | a }\n"
     "rule U(x) -> 1 : a -> x : b\n"},
    {"draws over draws", 4, 100,
     "weights label a start S\n"
     "rule S -> 3 : x ~ discrete((1, 1), (2, 2), (1, 3)) z ~ discrete((1, x), (3, 2)) U(z)\n"
     "  -> 1 : x ~ discrete((3, 1), (1, 2)) U(x)\n"
     "rule U(x) -> 1 : a -> x : scale(x, 1, 1) a\n"},
    {"a value decides how many", 2, 100,
     "weights label a start S\n"
     "rule S -> n ~ discrete((1, 1), (1, 2)) repeat x n { A(n) }\n"
     "  -> 1 : m ~ discrete((1, 0), (1, 2)) split x { A(3) | repeat y m { a } }\n"
     "rule A(n) -> n : y ~ discrete((1, 1), (1, 2)) scale(y, 1, 1) a -> a\n"},
    {"values that forbid", 3, 100,
     "weights label a label b start S\n"
     "rule S -> 1 : x ~ discrete((1, 0), (1, 1), (1, 2)) A(x) -> 2 : A(1) -> 1 : B(1)\n"
     "rule A(x) if x > 0 -> 1 : B(x) -> x : split x { B(x) | b }\n"
     "rule A(x) if x <= 0 -> b\n"
     "rule B(x) if x > 1 -> a\n"
     "rule B(x) if x <= 1 -> 1 : y ~ discrete((1, x), (2, 3)) scale(y, 1, 1) a -> 2 : b\n"},
    {"limit with values", 2, 100,
     "weights limit depth 1 label a start S\n"
     "rule S -> 1 : x ~ discrete((1, 1), (1, 2)) split x { S | T(x) } -> 3 : T(1)\n"
     "rule S at limit -> y ~ discrete((1, 1), (1, 2)) scale(y, 1, 1) a\n"
     "rule T(x) -> a -> x : y ~ discrete((1, 3), (1, 2)) scale(y, 1, 1) a\n"},
    {"tied values", 2, 100,
     "tied label a start S\n"
     "rule S -> 0.5 : x ~ discrete((1, 1), (1, 2)) split y { A(x) | A(x) | A(1) } -> 0.5 : split y { A(1) | A(1) }\n"
     "rule A(x) -> 0.6 : y ~ discrete((1, x), (1, 2)) scale(y, 1, 1) a -> 0.4 : a\n"},
};

enum { NFINITE = sizeof finite_grammars / sizeof *finite_grammars, FIRST_WITH_VALUES = 5 };

#endif
