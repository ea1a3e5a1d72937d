/* SPDX-License-Identifier: GPL-3.0-or-later */
/* incorporate.h - data incorporation: label lattices to the initial grammar of model merging (DESIGN 5.2).
 * Per lattice: axiom -> split-y rows, row -> split-x cells, cell -> label. Lexical symbols are shared per label and carry
 * the label's name. Source: Martinovic and Van Gool, CVPR 2013, section 3; MATHEMATICS B4 for the regrouping. */
#ifndef SG_LEARN_INCORPORATE_H
#define SG_LEARN_INCORPORATE_H

#include "core/arena.h"
#include "core/status.h"
#include "grammar/split.h"
#include "parse/lattice.h"

/** Which rows share a symbol: none do; those of equal label sequences; those of sequences that are equal once runs of
 *  one label are collapsed (their rules stay apart, since they cover different numbers of cells). */
typedef enum { SG_SHARE_NONE, SG_SHARE_EQUAL, SG_SHARE_COLLAPSED } sg_share;

/** Which neighbouring rows become one row of columns, column -> split-y cells: none; pairs whose cells correspond one to
 *  one (a bijection of at least two labels), frequent ones first, as in the paper; or bands of any height, as many as give
 *  the shortest description (so that the storeys of a facade share their columns). */
typedef enum { SG_REGROUP_NONE, SG_REGROUP_PAIRS, SG_REGROUP_FLOORS } sg_regroup_kind;

typedef struct {
    sg_share share;
    sg_regroup_kind regroup;
    size_t nterminals; /* 0: the labels of the lattices in their order of appearance, grey levels as colours */
    const char *const *terminal_names;
    const uint32_t *terminal_colors; /* 0xRRGGBB; only terminals that occur go into the grammar */
} sg_incorporate_opts;

#define SG_INCORPORATE_OPTS_INIT {SG_SHARE_EQUAL, SG_REGROUP_FLOORS, 0, NULL, NULL}

/** Build the initial grammar.
 *  @param lattices  [n], n >= 1
 *  @param out       the grammar, in the arena; probabilities are relative counts; each rule has the relative sizes of each use
 *  @param counts    out [out->nrules] in the arena: uses of each rule in the data
 *  @return SG_OK, SG_EINVAL (n is 0), SG_EINPUT (a label that terminal_names does not have), SG_ENOMEM */
sg_status sg_incorporate(const sg_lattice *lattices, size_t n, const sg_incorporate_opts *opts, sg_arena *arena,
                         sg_split_form *out, double **counts, sg_error *err);

#endif
