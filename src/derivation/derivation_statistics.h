/* SPDX-License-Identifier: GPL-3.0-or-later */
/* derivation_statistics.h - how large a derivation is: the columns of table I of Talton et al., "Metropolis procedural
 * modeling", ACM Transactions on Graphics 30(2) (2011), and what they are made of. */
#ifndef SG_DERIVATION_DERIVATION_STATISTICS_H
#define SG_DERIVATION_DERIVATION_STATISTICS_H

#include "derivation/derivation.h"

/** Counts are of what is stored: tied siblings count once, and so does a part that `components` puts onto several faces. */
typedef struct {
    size_t nonterminals; /* nodes but those that stand for a label in a split; optional successors are symbols of their own */
    size_t terminals;    /* labels and shape operations in the bodies of the rules used, those in a repeat as often as it
                            places them. Splits, repeats, components and brackets are no symbols */
    size_t symbols;      /* the two together */
    size_t arguments;    /* numbers that non-terminals carry */
    size_t terminal_arguments; /* numbers that terminals carry; names, colours and labels are none */
    size_t draws;        /* random numbers: drawn values, of sizes that sum to 1 all but the last */
    size_t parameters;   /* arguments, terminal_arguments and draws together: a number that is drawn and handed on counts as a
                            draw and as an argument */
    size_t depth;        /* of the deepest node, labels in splits included; the start symbol has 0 */
} sg_derivation_statistics;

/** @return SG_OK, SG_ENUMERIC (a repeat count of a derivation that does not pass sg_derivation_check()) */
sg_status sg_derivation_statistics_of(const sg_derivation *d, sg_derivation_statistics *out, sg_error *err);

#endif
