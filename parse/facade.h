/* SPDX-License-Identifier: GPL-3.0-or-later */
/* facade.h - a photograph parsed by a grammar: per-pixel label costs in, the derivation of least energy out.
 *
 * Energy is DESIGN 5.4's, E = E_img + E_rule + E_attr in nats. Two ways to a low one: a search (metropolis.h), which also
 * tells what else is likely, and dynamic programming on a lattice (exact_parse.h). Each can be run alone, the search can
 * begin at the exact parse, and to measure the gap between them all three are run. */
#ifndef SG_PARSE_FACADE_H
#define SG_PARSE_FACADE_H

#include "image/npy.h"
#include "parse/exact_parse.h"
#include "parse/facade_samples.h"
#include "search/metropolis.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** Parts of an energy, nats. */
typedef struct {
    double image;     /* weight * sum over pixels of the cost of their label */
    double rule;      /* -sum of log rule probabilities */
    double attribute; /* -sum of log densities of the sizes */
} sg_energy;

static inline double sg_energy_sum(const sg_energy *e)
{
    return e->image + e->rule + e->attribute;
}

typedef enum {
    SG_FACADE_EXACT,
    SG_FACADE_SEARCH,            /* from samples of the prior */
    SG_FACADE_SEARCH_FROM_EXACT,
    SG_FACADE_STAGES,
} sg_facade_stage;

/** Name of a stage for reports: "exact", "mcmc", "mcmc_from_exact". */
const char *sg_facade_stage_name(sg_facade_stage stage);

typedef struct {
    bool stages[SG_FACADE_STAGES]; /* which are run; a search from the exact parse asks for both */
    double weight;                 /* of the costs, > 0 */
    double burn_in;                /* share of the iterations, in [0, 1), whose samples are dropped */
    size_t samples;                /* kept of a run at most; 0: none are taken */
    sg_metropolis_opts search;     /* its seed: sg_facade_seed() */
    sg_exact_opts exact;           /* its weight is not read */
} sg_facade_opts;

#define SG_FACADE_OPTS_INIT {{false, true, false}, 1, 0.5, 256, SG_METROPOLIS_OPTS_INIT, SG_EXACT_OPTS_INIT}

/** What one stage came to. */
typedef struct {
    bool done;
    sg_derivation derivation;
    sg_energy energy; /* computed from scratch */
    double seconds;   /* wall clock */
} sg_facade_result;

typedef struct {
    sg_facade_result results[SG_FACADE_STAGES];
    sg_facade_stage best;         /* the one of least energy, the first of equals: what is reported */
    size_t columns, rows, states; /* of the exact parse's lattice, cells, and of its chart */
    double energy_lattice;        /* of the exact parse before its cuts moved, without E_attr */
    bool searched;
    sg_metropolis_result search;  /* the first one that was made */
    sg_facade_samples samples;    /* of that search, burn-in left out; when it anneals, from the half before that */
} sg_facade_parse;

/** Seed of a photograph: what it is called decides, so it is parsed alike alone and among others. */
uint64_t sg_facade_seed(uint64_t seed, const char *name);

/** @param costs    [channels][height][width] nats, finite, >= 0
 *  @param channel  [symbols of g] the channel of each label (sg_unaries_channels()); read until out is cleared
 *  @return SG_OK; SG_STOPPED: asked to stop, out holds the best so far; SG_ENOPARSE (nothing that was tried fills the
 *          picture), SG_EINVAL, SG_EINPUT (exact: no split grammar), SG_ENUMERIC, SG_ENOMEM: out holds nothing.
 *          Clear out in every case; g must outlive it */
sg_status sg_facade_run(const sg_grammar *g, const sg_float_map *costs, const uint32_t *channel,
                        const sg_facade_opts *opts, sg_progress *progress, sg_facade_parse *out, sg_error *err);
/** Free and zero; a zeroed one is fine. */
void sg_facade_parse_clear(sg_facade_parse *p);

#endif
