/* SPDX-License-Identifier: GPL-3.0-or-later */
/* derivation_json.h - derivations as JSON: of split grammars with their rectangles, as INTERFACES 7 has them, and of any
 * grammar without. Both read back bit for bit. */
#ifndef SG_SCENE_DERIVATION_JSON_H
#define SG_SCENE_DERIVATION_JSON_H

#include "derivation/derivation.h"
#include "derivation/derivation_io.h"

#include <stdio.h>

/** Write {"rule", "symbol", "rect", "sizes", "children"}, nested: rule is the index of the rule in the grammar, rect
 *  [x0,y0,x1,y1] in picture coordinates of a width x height scope, sizes the relative sizes of the parts of the rule's
 *  split, sizes and children left to right and top to bottom. A rule that ends in a label has "label" and no children.
 *  Tied siblings are written at every place. The text ends without a line break.
 *
 *  What the derivation is stored as stands beside that: "node", the index of the node (the same wherever a tied sibling is
 *  placed), its "uniforms", and its "values", arguments and then draws; empty ones are left out. A root that is not at depth
 *  0 has "depth".
 *  @return SG_OK, SG_ENUMERIC (no label scene, see sg_label_scene_interpret()), SG_EIO, SG_ENOMEM */
sg_status sg_derivation_write_json(const sg_derivation *d, double width, double height, FILE *out, sg_error *err);

/** Write a derivation of any grammar, open or not: the same without "rect", "sizes", "label" and "node", each node once and
 *  children in the order in which they are stored. An open node has "rule":null, one that is cut at the depth limit
 *  "rule":"empty", and both have "symbol_number", since names of hidden symbols may be those of labels.
 *  @return SG_OK, SG_EINVAL (an empty derivation), SG_EIO, SG_ENOMEM */
sg_status sg_derivation_write_json_tree(const sg_derivation *d, FILE *out, sg_error *err);

/** Derivations of g from what either of them wrote: one, or an array of them. "rule", "symbol", "uniforms", "values",
 *  "children", "node" and "depth" are read, and each derivation passes sg_derivation_check(); without "node" children
 *  stand in the order in which they are stored. JSON may nest about 1000 nodes deep, not more.
 *  @param name  stands for the file in messages: NAME:LINE:COL where it is no JSON, else the number of the derivation and
 *               of the node
 *  @return SG_OK, SG_EINPUT, SG_ENOMEM; out only on success */
sg_status sg_derivation_parse_json(const char *text, size_t length, const char *name, const sg_grammar *g,
                                   sg_derivation_file *out, sg_error *err);

#endif
