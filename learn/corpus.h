/* SPDX-License-Identifier: GPL-3.0-or-later */
/* corpus.h - the lattices that a grammar is learned from, with their labels as terminals of the grammar. */
#ifndef SG_LEARN_CORPUS_H
#define SG_LEARN_CORPUS_H

#include "core/arena.h"
#include "core/status.h"
#include "grammar/split.h"
#include "parse/earley.h"
#include "parse/lattice.h"

typedef struct {
    size_t n;
    const sg_lattice *lattices; /* [n], borrowed */
    const sg_cells *cells;      /* [n], in the arena */
} sg_corpus;

/** @param form  its terminals; labels that it does not have become UINT16_MAX (no rule makes them)
 *  @return SG_OK, SG_ENOMEM */
sg_status sg_corpus_create(const sg_lattice *lattices, size_t n, const sg_split_form *form, sg_arena *arena,
                           sg_corpus *out, sg_error *err);

#endif
