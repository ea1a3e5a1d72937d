/* SPDX-License-Identifier: GPL-3.0-or-later */
/* earley_print.h - the derivation of a lattice for people and for programs (INTERFACES 7). */
#ifndef SG_PARSE_EARLEY_PRINT_H
#define SG_PARSE_EARLEY_PRINT_H

#include "grammar/split.h"
#include "parse/earley.h"
#include "parse/lattice.h"

#include <stdio.h>

/** The derivation as nested objects: rule (index in the exchange form), symbol, rect [x0,y0,x1,y1] in cells, sizes (of
 * the children relative to the node, from the lattice's pixel boundaries) and children; a lexical node has "label" in
 * place of the last two. Where siblings are tied and share a derivation, children holds each once, and sizes all of
 * them.
 *  @param lattice  its boundaries give the sizes
 *  @return a jansson value (json_t) that the caller owns, NULL when memory is out */
struct json_t *sg_parse_tree_json(const sg_split_form *form, const sg_parse_node *nodes, size_t n,
                                  const sg_lattice *lattice);

/** One node a line, children indented: symbol, operation or label, columns and rows that it covers. */
void sg_parse_tree_print(const sg_split_form *form, const sg_parse_node *nodes, size_t n, FILE *out);

#endif
