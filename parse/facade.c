/* SPDX-License-Identifier: GPL-3.0-or-later */
/* facade.c - the stages of a parse, and which of them won. */
#include "config.h"

#include "parse/facade.h"

#include "core/random.h"
#include "scene/label_scene.h"
#include "score/label_score.h"

#include <math.h>
#include <string.h>
#include <time.h>

const char *sg_facade_stage_name(sg_facade_stage stage)
{
    static const char *const names[SG_FACADE_STAGES] = {"exact", "mcmc", "mcmc_from_exact"};
    return names[stage];
}

/* FNV-1a over the name, then the finishing steps of splitmix64, so that seeds that are close have streams that are not.
 * Sources: Fowler, Noll and Vo, "The FNV non-cryptographic hash algorithm"; Steele, Lea and Flood, "Fast splittable
 * pseudorandom number generators", OOPSLA 2014. */
uint64_t sg_facade_seed(uint64_t seed, const char *name)
{
    uint64_t h = 0xcbf29ce484222325U;
    for (const char *p = name; *p != '\0'; p++)
        h = (h ^ (unsigned char)*p) * 0x100000001b3U;
    h += seed * 0x9e3779b97f4a7c15U;
    h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9U;
    h = (h ^ (h >> 27)) * 0x94d049bb133111ebU;
    return h ^ (h >> 31);
}

/* What all stages share. */
typedef struct {
    const sg_grammar *g;
    const sg_float_map *costs;
    const uint32_t *channel;
    const sg_facade_opts *opts;
    sg_progress *progress;
    sg_score *score;
    sg_facade_parse *out;
} job;

static double now_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ---- energies ---- */

static sg_status energy_of(const job *j, const sg_derivation *d, sg_energy *out, sg_error *err)
{
    sg_score_state *state = NULL;
    sg_score_value value = {-INFINITY, -INFINITY};
    double rules = 0, density = 0;
    SG_TRY(sg_score_state_create(j->score, &state, err));
    sg_status st = sg_score_evaluate(state, d, &value, err);
    sg_score_state_free(state);
    if (st == SG_OK)
        st = sg_derivation_log_prior(d, &rules, err);
    if (st == SG_OK)
        st = sg_derivation_log_density(d, &density, err);
    *out = (sg_energy){0 - value.log, 0 - rules, 0 - density}; /* no negative zeros */
    return st;
}

/* A stage's derivation is taken over from what found it. */
static sg_status finish_stage(job *j, sg_facade_stage stage, sg_derivation *found, double begin, sg_error *err)
{
    sg_facade_result *r = &j->out->results[stage];
    r->derivation = *found;
    sg_derivation_init(found, j->g);
    r->seconds = now_s() - begin;
    SG_TRY(energy_of(j, &r->derivation, &r->energy, err));
    r->done = true;
    return SG_OK;
}

/* ---- stages ---- */

static sg_status run_exact(job *j, sg_error *err)
{
    sg_exact_result result;
    sg_exact_opts opts = j->opts->exact;
    const double begin = now_s();
    memset(&result, 0, sizeof result);
    opts.weight = j->opts->weight;
    sg_progress_report(j->progress, "exact parse", 0, 0);
    sg_status st = sg_exact_parse(j->g, j->costs, j->channel, &opts, &result, err);
    if (st == SG_OK) {
        j->out->columns = result.columns;
        j->out->rows = result.rows;
        j->out->states = result.states;
        j->out->energy_lattice = result.energy_lattice;
        st = finish_stage(j, SG_FACADE_EXACT, &result.derivation, begin, err);
    }
    sg_exact_result_clear(&result);
    return st;
}

/* The iterations whose samples are of the posterior: after the burn-in, and before the annealing. */
static void choose_window(const job *j, const sg_metropolis_result *r)
{
    const sg_metropolis_opts *o = &j->opts->search;
    uint64_t last = r->moves / (o->runs * o->chains);
    if (o->anneal != 1 && last > o->iterations / 2)
        last = o->iterations / 2;
    sg_facade_samples_window(&j->out->samples, (uint64_t)(j->opts->burn_in * (double)last), last);
}

static sg_status search(job *j, sg_facade_stage stage, const sg_derivation *start, sg_metropolis_result *result,
                        sg_error *err)
{
    const bool sampled = j->opts->samples > 0 && !j->out->searched;
    const double begin = now_s();
    sg_sampler sampler = {0};
    if (sampled) {
        sg_facade_samples_init(&j->out->samples, j->costs->width, j->costs->height, j->channel, j->costs->channels,
                               j->opts->samples, j->opts->search.swap_every);
        sampler = sg_facade_samples_sampler(&j->out->samples);
    }
    const sg_status st = sg_metropolis_run(j->g, j->score, &j->opts->search, start, sampled ? &sampler : NULL,
                                           j->progress, result, err);
    if ((st != SG_OK && st != SG_STOPPED) || result->nruns == 0)
        return st;
    if (sampled)
        choose_window(j, result);
    SG_TRY(finish_stage(j, stage, &result->best, begin, err));
    return st;
}

/* Why no sample could be scored: what one of them is refused for. The search's sentence stays when it is not. */
static void explain(const job *j, sg_error *err)
{
    sg_derivation d;
    sg_label_scene scene = {0};
    sg_error why = SG_ERROR_INIT, first = *err;
    gsl_rng *rng = sg_random_create(j->opts->search.seed);
    sg_derivation_init(&d, j->g);
    if (rng != NULL && (sg_derivation_sample(&d, rng, j->opts->search.kernel.max_nodes, &why) != SG_OK ||
                        sg_label_scene_interpret(&scene, &d, (double)j->costs->width, (double)j->costs->height, &why) != SG_OK))
        SG_FAIL(err, first.code, "%.400s: %.500s", first.msg, why.msg);
    sg_label_scene_clear(&scene);
    sg_derivation_clear(&d);
    if (rng != NULL)
        gsl_rng_free(rng);
}

/* The first search is kept for reports. */
static sg_status run_search(job *j, sg_facade_stage stage, const sg_derivation *start, sg_error *err)
{
    sg_metropolis_result result;
    memset(&result, 0, sizeof result);
    const sg_status st = search(j, stage, start, &result, err);
    if (st == SG_ENOPARSE)
        explain(j, err);
    if ((st == SG_OK || st == SG_STOPPED) && result.nruns > 0 && !j->out->searched) {
        j->out->search = result;
        j->out->searched = true;
    } else {
        sg_metropolis_result_clear(&result);
    }
    return st;
}

static sg_status run_stages(job *j, sg_error *err)
{
    const bool *asked = j->opts->stages;
    const sg_derivation *exact = &j->out->results[SG_FACADE_EXACT].derivation;
    if (asked[SG_FACADE_EXACT] || asked[SG_FACADE_SEARCH_FROM_EXACT])
        SG_TRY(run_exact(j, err));
    if (asked[SG_FACADE_SEARCH])
        SG_TRY(run_search(j, SG_FACADE_SEARCH, NULL, err));
    if (sg_progress_stopped(j->progress))
        return SG_FAIL(err, SG_STOPPED, "stopped");
    return asked[SG_FACADE_SEARCH_FROM_EXACT] ? run_search(j, SG_FACADE_SEARCH_FROM_EXACT, exact, err) : SG_OK;
}

/* False: none was done. */
static bool choose_best(sg_facade_parse *p)
{
    bool any = false;
    for (int s = 0; s < SG_FACADE_STAGES; s++) {
        const sg_facade_result *r = &p->results[s];
        if (!r->done || (any && sg_energy_sum(&r->energy) >= sg_energy_sum(&p->results[p->best].energy)))
            continue;
        p->best = (sg_facade_stage)s;
        any = true;
    }
    return any;
}

sg_status sg_facade_run(const sg_grammar *g, const sg_float_map *costs, const uint32_t *channel,
                        const sg_facade_opts *opts, sg_progress *progress, sg_facade_parse *out, sg_error *err)
{
    job j = {g, costs, channel, opts, progress, NULL, out};
    memset(out, 0, sizeof *out);
    for (int s = 0; s < SG_FACADE_STAGES; s++)
        sg_derivation_init(&out->results[s].derivation, g);
    SG_TRY(sg_label_score_create(g, costs, channel, opts->weight, &j.score, err));
    sg_status st = run_stages(&j, err);
    sg_score_free(j.score);
    if (st != SG_OK && st != SG_STOPPED)
        sg_facade_parse_clear(out);
    else if (!choose_best(out))
        st = SG_FAIL(err, st == SG_OK ? SG_EINVAL : st, "nothing was parsed");
    return st;
}

void sg_facade_parse_clear(sg_facade_parse *p)
{
    for (int s = 0; s < SG_FACADE_STAGES; s++)
        if (p->results[s].derivation.grammar != NULL)
            sg_derivation_clear(&p->results[s].derivation);
    if (p->searched)
        sg_metropolis_result_clear(&p->search);
    sg_facade_samples_clear(&p->samples);
    memset(p, 0, sizeof *p);
}
