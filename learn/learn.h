/* SPDX-License-Identifier: GPL-3.0-or-later */
/* learn.h - learning a split grammar from lattices, start to end: incorporation, merging, re-estimation, finishing. */
#ifndef SG_LEARN_LEARN_H
#define SG_LEARN_LEARN_H

#include "learn/compatible.h"
#include "learn/energy.h"
#include "learn/finish.h"
#include "learn/incorporate.h"
#include "learn/search.h"

typedef struct {
    sg_incorporate_opts incorporate;
    bool best_regroup; /* learn with each kind of regrouping and keep the grammar of least energy; else
                          incorporate.regroup */
    sg_energy_opts energy;
    sg_search_opts search;    /* its `every` is set here */
    bool reestimate_every;    /* by Earley parsing after each accepted step; else once, at the end */
    sg_compatible compatible; /* what may be merged */
    bool tied;                /* the learned grammar declares tied siblings */
    sg_density_opts densities; /* of sizes */
} sg_learn_opts;

#define SG_LEARN_OPTS_INIT                                                                                             \
    {                                                                                                                  \
        SG_INCORPORATE_OPTS_INIT, true, SG_ENERGY_OPTS_INIT, SG_SEARCH_OPTS_INIT, false, SG_COMPATIBLE_KINDS, false,   \
        SG_DENSITY_OPTS_INIT                                                                                           \
    }

/** Everything is in the arena, but for the history. */
typedef struct {
    sg_regroup_kind regroup;                 /* of the initial grammar */
    sg_split_form initial, merged, finished; /* merged: before finishing */
    sg_split_form initial_finished;          /* the initial grammar, finished: what merging is compared with */
    double *initial_counts, *merged_counts;
    sg_energy_parts initial_energy, energy; /* of initial and merged, from scratch */
    double searched_energy;                 /* where the search ended, before the last re-estimation */
    double carried_energy;                  /* of merged, as it was carried along */
    sg_search_history history;
    size_t parsed;                 /* lattices parsed in all */
    double search_s, reestimate_s; /* seconds: the search with its re-estimations, the last re-estimation */
} sg_learn_result;

/** @param arena  keeps the result
 *  @return SG_OK; SG_STOPPED when progress asked for it: the result is the best so far; SG_EINPUT, SG_ENOMEM,
 * SG_ENUMERIC (carried and recomputed energy differ: a fault of ours), SG_ENOPARSE */
sg_status sg_learn(const sg_lattice *lattices, size_t n, const sg_learn_opts *opts, sg_arena *arena,
                   sg_learn_result *out, sg_error *err);
void sg_learn_result_clear(sg_learn_result *r);

#endif
