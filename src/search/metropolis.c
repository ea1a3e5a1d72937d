/* SPDX-License-Identifier: GPL-3.0-or-later */
/* metropolis.c - runs of tempered chains, in blocks: within a block every chain goes by itself, in any thread; between blocks
 * one thread exchanges neighbours, listens and reports, in a fixed order. */
#include "search/metropolis.h"

#include "core/array.h"
#include "core/random.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { TRACE_LINES = 200 };

typedef struct {
    const sg_metropolis_opts *opts;
    const sg_sampler *sampler;
    sg_metropolis_result *out;
    sg_error *err;
    sg_chain **chains; /* [n], those of a run side by side, coldest first */
    size_t n;
    sg_status *status; /* [n] */
    sg_error *errors;  /* [n] */
    int threads;
    gsl_rng *rng;      /* of swaps */
    sg_progress *progress; /* the caller's */
    double begin_s;
    size_t done, block; /* iterations, blocks */
    size_t trace_capacity;
} search;

static double now_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static sg_status check_opts(const sg_metropolis_opts *o, sg_error *err)
{
    if (o->runs == 0 || o->chains == 0 || o->swap_every == 0)
        return SG_FAIL(err, SG_EINVAL, "%zu runs of %zu chains with swaps every %zu iterations: each must be at least 1",
                       o->runs, o->chains, o->swap_every);
    if (o->runs > UINT32_MAX / 2 / o->chains)
        return SG_FAIL(err, SG_EINVAL, "%zu runs of %zu chains are too many", o->runs, o->chains);
    if (!(o->tempering >= 1) || !isfinite(o->tempering) || !(o->anneal >= 1) || !isfinite(o->anneal))
        return SG_FAIL(err, SG_EINVAL, "tempering %g and annealing %g must be at least 1", o->tempering, o->anneal);
    if (!(o->time_s >= 0) || o->threads < 0)
        return SG_FAIL(err, SG_EINVAL, "a time of %g s and %d threads must not be negative", o->time_s, o->threads);
    return SG_OK;
}

static sg_chain *chain(const search *s, size_t run, size_t i)
{
    return s->chains[run * s->opts->chains + i];
}

/* ---- all chains at once ---- */

typedef sg_status work(search *s, size_t chain, sg_error *err);

/* The error that counts is that of the first chain that has one: the same with any number of threads. */
static sg_status for_each_chain(search *s, work *w)
{
#pragma omp parallel for schedule(dynamic, 1) num_threads(s->threads) if (s->threads > 1)
    for (size_t i = 0; i < s->n; i++)
        s->status[i] = w(s, i, s->errors + i);
    for (size_t i = 0; i < s->n; i++)
        if (s->status[i] != SG_OK) {
            if (s->err != NULL)
                *s->err = s->errors[i];
            return s->status[i];
        }
    return SG_OK;
}

static size_t block_length(const search *s)
{
    const size_t left = s->opts->iterations - s->done;
    return left < s->opts->swap_every ? left : s->opts->swap_every;
}

static sg_status step_block(search *s, size_t i, sg_error *err)
{
    const size_t n = block_length(s);
    for (size_t k = 1; k <= n; k++)
        SG_TRY(sg_chain_step(s->chains[i], s->done + k, NULL, err));
    return SG_OK;
}

/* ---- between blocks ---- */

/* Even and odd pairs of neighbours in turn. The stream is one that no chain has. */
static void swap_neighbours(search *s, size_t run)
{
    sg_random_stream(s->rng, s->opts->seed, UINT32_MAX - (uint32_t)run, s->block);
    for (size_t i = s->block % 2; i + 1 < s->opts->chains; i += 2) {
        s->out->swaps_proposed++;
        s->out->swaps_accepted += sg_chain_swap(chain(s, run, i), chain(s, run, i + 1), sg_random_uniform(s->rng));
    }
}

/* Nothing in the first half, then geometrically to all of it. */
static void anneal(search *s)
{
    if (s->opts->anneal == 1)
        return;
    const double past = 2.0 * (double)s->done / (double)s->opts->iterations - 1;
    const double sharpness = pow(s->opts->anneal, fmax(past, 0));
    for (size_t i = 0; i < s->n; i++)
        sg_chain_set_sharpness(s->chains[i], sharpness);
}

/* Of the chains of a run, the one that has been at the best. */
static const sg_chain *best_of_run(const search *s, size_t run, sg_posterior *best)
{
    const sg_chain *which = NULL;
    for (size_t i = 0; i < s->opts->chains; i++) {
        sg_posterior p;
        sg_chain_best(chain(s, run, i), &p);
        if (which == NULL || sg_posterior_log(&p) > sg_posterior_log(best)) {
            which = chain(s, run, i);
            *best = p;
        }
    }
    return which;
}

static sg_status trace(search *s)
{
    const size_t blocks = (s->opts->iterations - 1) / s->opts->swap_every + 1, every = (blocks - 1) / TRACE_LINES + 1;
    if (s->block % every != 0 && s->done < s->opts->iterations)
        return SG_OK;
    sg_metropolis_result *out = s->out;
    if (!SG_GROW(out->trace, s->trace_capacity, out->ntrace + s->opts->runs))
        return SG_FAIL_NOMEM(s->err);
    for (size_t run = 0; run < s->opts->runs; run++) {
        sg_trace_line *line = &out->trace[out->ntrace++];
        *line = (sg_trace_line){.run = (uint32_t)run, .iteration = s->done, .cold = *sg_chain_posterior(chain(s, run, 0))};
        best_of_run(s, run, &line->best);
    }
    return SG_OK;
}

static sg_status sample(search *s, size_t before)
{
    const sg_sampler *l = s->sampler;
    if (l == NULL || l->every == 0 || s->done / l->every == before / l->every)
        return SG_OK;
    for (size_t run = 0; run < s->opts->runs; run++) {
        const sg_chain *cold = chain(s, run, 0);
        SG_TRY(l->sample(l->user, run, s->done, sg_chain_derivation(cold), sg_chain_posterior(cold), s->err));
    }
    return SG_OK;
}

static sg_status one_block(search *s)
{
    const size_t before = s->done, n = block_length(s);
    anneal(s);
    SG_TRY(for_each_chain(s, step_block));
    s->done += n;
    s->block++;
    s->out->moves += (uint64_t)n * s->n;
    for (size_t run = 0; run < s->opts->runs; run++)
        swap_neighbours(s, run);
    SG_TRY(trace(s));
    return sample(s, before);
}

static bool out_of_time(const search *s)
{
    return s->opts->time_s > 0 && now_s() - s->begin_s >= s->opts->time_s;
}

static sg_status all_blocks(search *s)
{
    const double start = now_s();
    sg_status st = SG_OK;
    while (st == SG_OK && s->done < s->opts->iterations) {
        if (sg_progress_stopped(s->progress)) {
            st = SG_FAIL(s->err, SG_STOPPED, "stopped after %zu of %zu iterations", s->done, s->opts->iterations);
            break;
        }
        st = one_block(s);
        sg_progress_report(s->progress, "moves", s->out->moves, s->opts->iterations * s->n);
        s->out->seconds = now_s() - start;
        if (out_of_time(s))
            break;
    }
    return st;
}

/* ---- beginning and end ---- */

static sg_status make_chains(search *s, const sg_grammar *g, const sg_score *score)
{
    const sg_metropolis_opts *o = s->opts;
    s->chains = calloc(s->n, sizeof *s->chains);
    s->status = calloc(s->n, sizeof *s->status);
    s->errors = calloc(s->n, sizeof *s->errors);
    s->rng = sg_random_create(o->seed);
    if (s->chains == NULL || s->status == NULL || s->errors == NULL || s->rng == NULL)
        return SG_FAIL_NOMEM(s->err);
    for (size_t i = 0; i < s->n; i++) {
        const double beta = pow(o->tempering, -(double)(i % o->chains));
        SG_TRY(sg_chain_create(g, score, &o->kernel, o->seed, (uint32_t)i, beta, &s->chains[i], s->err));
    }
    return SG_OK;
}

static bool start_is_over(sg_progress *self)
{
    const search *s = self->user;
    return out_of_time(s) || sg_progress_stopped(s->progress);
}

/* The result begins as a copy of where chains begin: work() takes no more arguments. */
static sg_status start_chain(search *s, size_t i, sg_error *err)
{
    const sg_derivation *start = s->out->best.nnodes > 0 ? &s->out->best : NULL;
    sg_progress until = {.stop = start_is_over, .user = s};
    return sg_chain_start(s->chains[i], start, s->opts->tries, &until, err);
}

static void add_stats(sg_chain_stats *sum, const sg_chain_stats *s)
{
    for (int k = 0; k < SG_MOVE_KINDS; k++) {
        sum->proposed[k] += s->proposed[k];
        sum->accepted[k] += s->accepted[k];
    }
    sum->second_proposed += s->second_proposed;
    sum->second_accepted += s->second_accepted;
}

static sg_status collect(search *s)
{
    sg_metropolis_result *out = s->out;
    const sg_chain *best = NULL;
    out->run_best = calloc(s->opts->runs, sizeof *out->run_best);
    if (out->run_best == NULL)
        return SG_FAIL_NOMEM(s->err);
    out->nruns = s->opts->runs;
    for (size_t run = 0; run < out->nruns; run++) {
        const sg_chain *c = best_of_run(s, run, &out->run_best[run]);
        if (best != NULL && sg_posterior_log(&out->run_best[run]) <= sg_posterior_log(&out->posterior))
            continue;
        best = c;
        out->best_run = run;
        out->posterior = out->run_best[run];
    }
    for (size_t i = 0; i < s->n; i++)
        add_stats(&out->stats, sg_chain_statistics(s->chains[i]));
    return sg_derivation_copy(&out->best, sg_chain_best(best, NULL), s->err);
}

static void clear_search(search *s)
{
    for (size_t i = 0; s->chains != NULL && i < s->n; i++)
        sg_chain_free(s->chains[i]);
    if (s->rng != NULL)
        gsl_rng_free(s->rng);
    free(s->chains);
    free(s->status);
    free(s->errors);
}

static sg_status run(search *s, const sg_grammar *g, const sg_score *score, const sg_derivation *start)
{
    SG_TRY(make_chains(s, g, score));
    if (start != NULL)
        SG_TRY(sg_derivation_copy(&s->out->best, start, s->err));
    sg_status st = for_each_chain(s, start_chain);
    if (st == SG_STOPPED && !sg_progress_stopped(s->progress)) /* out of time is no wish to stop, but nothing was found */
        return SG_FAIL(s->err, SG_ENOPARSE, "in %g s no sample of the grammar was found that can be scored", s->opts->time_s);
    if (st != SG_OK)
        return st;
    st = all_blocks(s);
    if (st != SG_OK && st != SG_STOPPED)
        return st;
    SG_TRY(collect(s));
    return st;
}

sg_status sg_metropolis_run(const sg_grammar *g, const sg_score *score, const sg_metropolis_opts *opts,
                            const sg_derivation *start, const sg_sampler *sampler, sg_progress *progress,
                            sg_metropolis_result *out, sg_error *err)
{
    memset(out, 0, sizeof *out);
    sg_derivation_init(&out->best, g);
    SG_TRY(check_opts(opts, err));
    search s = {.opts = opts, .sampler = sampler, .out = out, .err = err, .n = opts->runs * opts->chains};
    s.threads = opts->threads > 0 ? opts->threads : omp_get_max_threads();
    s.progress = progress;
    s.begin_s = now_s();
    const sg_status st = run(&s, g, score, start);
    clear_search(&s);
    if ((st != SG_OK && st != SG_STOPPED) || out->run_best == NULL) /* stopped before there was anything to collect */
        sg_metropolis_result_clear(out);
    return st;
}

void sg_metropolis_result_clear(sg_metropolis_result *r)
{
    const sg_grammar *g = r->best.grammar;
    sg_derivation_clear(&r->best);
    free(r->run_best);
    free(r->trace);
    memset(r, 0, sizeof *r);
    sg_derivation_init(&r->best, g);
}
