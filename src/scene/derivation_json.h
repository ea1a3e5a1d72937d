/* SPDX-License-Identifier: GPL-3.0-or-later */
/* derivation_json.h - derivations of split grammars with their rectangles, as INTERFACES 7 has them. */
#ifndef SG_SCENE_DERIVATION_JSON_H
#define SG_SCENE_DERIVATION_JSON_H

#include "derivation/derivation.h"

#include <stdio.h>

/** Write {"rule", "symbol", "rect", "sizes", "children"}, nested: rule is the index of the rule in the grammar, rect
 *  [x0,y0,x1,y1] in picture coordinates of a width x height scope, sizes the relative sizes of the parts of the rule's
 *  split, sizes and children left to right and top to bottom. A rule that ends in a label has "label" and no children.
 *  Tied siblings are written at every place. The text ends without a line break.
 *  @return SG_OK, SG_ENUMERIC (no label scene, see sg_label_scene_interpret()), SG_EIO, SG_ENOMEM */
sg_status sg_derivation_write_json(const sg_derivation *d, double width, double height, FILE *out, sg_error *err);

#endif
