/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cell_sample.h - label lattices drawn from a split grammar in cell mode: every lexical symbol is one cell.
 * Parts side by side must have equally many rows, parts one above the other equally many columns; derivations that do
 * not fit make no lattice (the mass deficiency of MATHEMATICS B1.3), so what is drawn is the grammar's distribution
 * given that there is one. */
#ifndef SG_LEARN_CELL_SAMPLE_H
#define SG_LEARN_CELL_SAMPLE_H

#include "grammar/split.h"
#include "parse/lattice.h"

#include <gsl/gsl_rng.h>

/** Draw until a derivation fits. Its boundaries are unit cells, its labels the form's terminals.
 *  @param tries      at most so many derivations
 *  @param max_cells  larger ones count as not fitting
 *  @param ntried     out, NULL or how many it took
 *  @return SG_OK, SG_ENUMERIC (none fitted), SG_EINVAL (tied siblings: cell mode has no such lattices), SG_ENOMEM */
sg_status sg_cell_sample(const sg_split_form *form, gsl_rng *rng, size_t tries, size_t max_cells, sg_arena *arena,
                         sg_lattice *out, size_t *ntried, sg_error *err);

#endif
