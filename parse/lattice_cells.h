/* SPDX-License-Identifier: GPL-3.0-or-later */
/* lattice_cells.h - a label lattice as a parse takes it: names of labels become terminals of a grammar. */
#ifndef SG_PARSE_LATTICE_CELLS_H
#define SG_PARSE_LATTICE_CELLS_H

#include "core/arena.h"
#include "core/status.h"
#include "grammar/split.h"
#include "parse/earley.h"
#include "parse/lattice.h"

/** Labels by name; one that the grammar does not have becomes UINT16_MAX, which no rule makes.
 *  @param out  in the arena
 *  @return SG_OK, SG_EINVAL (the grammar has more terminals than a cell can tell), SG_ENOMEM */
sg_status sg_lattice_cells(const sg_lattice *l, const sg_split_form *form, sg_arena *arena, sg_cells *out,
                           sg_error *err);

#endif
