/* SPDX-License-Identifier: GPL-3.0-or-later */
/* draw_grammar.h - a split grammar as a picture (SVG): a card for each non-terminal with what its rules make, in layers
 * by distance from the axiom, and a line from each symbol to those that its rules use. */
#ifndef SG_LEARN_DRAW_GRAMMAR_H
#define SG_LEARN_DRAW_GRAMMAR_H

#include "core/status.h"
#include "grammar/split.h"

#include <stdio.h>

/** Write an <svg> element that can stand alone or inside a page. Each rule is drawn as its most probable derivation with
 *  mean sizes; of a symbol with many rules the most probable are shown.
 *  @return SG_OK, SG_ENOMEM, SG_EIO */
sg_status sg_draw_grammar(const sg_split_form *f, FILE *out, sg_error *err);

#endif
