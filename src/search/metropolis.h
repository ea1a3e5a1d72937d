/* SPDX-License-Identifier: GPL-3.0-or-later */
/* metropolis.h - parallel tempering over derivations: several runs of several chains (DESIGN 5.3).
 *
 * Chain i of a run has inverse temperature beta_i = t_c^-i. All chains of all runs advance in blocks of `swap_every`
 * iterations, spread over the threads; between blocks neighbours are exchanged, even and odd pairs in turn. Since streams
 * are keyed by (seed, chain, iteration), the result does not depend on the number of threads. */
#ifndef SG_SEARCH_METROPOLIS_H
#define SG_SEARCH_METROPOLIS_H

#include "core/progress.h"
#include "search/chain.h"

typedef struct {
    size_t runs, iterations, chains; /* iterations of each chain */
    double tempering;                /* t_c >= 1 */
    size_t swap_every;
    size_t tries;                    /* samples of the prior from which a chain begins at the best */
    double anneal;                   /* 1: none; else in the last half of the iterations all inverse temperatures, and with
                                        them the prior, rise to this: annealing sharpens the full posterior */
    double time_s;                   /* starting included; 0: no limit. The result then depends on the machine */
    uint64_t seed;
    int threads;                     /* 0: all */
    sg_kernel_opts kernel;
} sg_metropolis_opts;

#define SG_METROPOLIS_OPTS_INIT {5, 100000, 8, 1.3, 100, 100, 1, 0, 1, 0, SG_KERNEL_OPTS_INIT}

/** One line of the trace: after so many iterations, the coldest chain of a run and the best of the run so far. */
typedef struct {
    uint32_t run;
    uint64_t iteration;
    sg_posterior cold, best;
} sg_trace_line;

/** Hears of samples: called between blocks, from the calling thread, runs in order; same calls with any number of threads. */
typedef struct {
    size_t every; /* iterations, rounded up to blocks */
    sg_status (*sample)(void *user, size_t run, uint64_t iteration, const sg_derivation *cold, const sg_posterior *p,
                        sg_error *err);
    void *user;
} sg_sampler;

typedef struct {
    sg_derivation best;
    sg_posterior posterior;    /* of best */
    size_t best_run;
    sg_posterior *run_best;    /* [nruns] */
    size_t nruns;
    sg_trace_line *trace;      /* about 200 lines a run, by iteration, then run */
    size_t ntrace;
    sg_chain_stats stats;      /* over all chains */
    uint64_t swaps_proposed, swaps_accepted;
    uint64_t moves;            /* iterations over all chains that were made */
    double seconds;            /* of the moves: wall clock */
} sg_metropolis_result;

/** @param start    derivation where all chains begin, or NULL
 *  @param sampler  may be NULL
 *  @return SG_OK; SG_STOPPED (asked to stop, out of time is SG_OK): out holds the best so far, or is empty when nothing was
 *          found yet; SG_EINVAL, SG_ENOPARSE, SG_ENUMERIC,
 *          SG_ENOMEM: out is empty. Clear out in every case */
sg_status sg_metropolis_run(const sg_grammar *g, const sg_score *score, const sg_metropolis_opts *opts,
                            const sg_derivation *start, const sg_sampler *sampler, sg_progress *progress,
                            sg_metropolis_result *out, sg_error *err);
void sg_metropolis_result_clear(sg_metropolis_result *r);

#endif
