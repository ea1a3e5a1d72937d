/* SPDX-License-Identifier: GPL-3.0-or-later */
/* lattice_fit_priv.h - a map made ready for fitting. */
#ifndef SG_PARSE_LATTICE_FIT_PRIV_H
#define SG_PARSE_LATTICE_FIT_PRIV_H

#include "parse/lattice_fit.h"
#include "parse/lattice_priv.h"

struct sg_lattice_problem {
    sg_lattice_source source;
    sg_lattice_fit_opts opts;
    size_t counted_px;
    size_t noccurring; /* classes */
    sg_arena *arena;   /* what is below */
    sg_arena *scratch; /* empty between calls */
    sg_axis axis[2];   /* columns, rows */
    sg_places knots[2], candidates[2];
    sg_strip_table base[2];  /* over the knots, by the strips between the knots of the other axis */
    sg_strip_table first[2]; /* over the candidates, by the same strips */
    sg_places cuts[2], best[2]; /* room for all places */
};

/** sg_lattice_fit_weights() with another number of starts; the weights are good. */
sg_status sg_lattice_fit_starts(sg_lattice_problem *p, const sg_lattice_weights *w, size_t nstarts, sg_arena *arena,
                                sg_lattice_fit *out, sg_error *err);

#endif
