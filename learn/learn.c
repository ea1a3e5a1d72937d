/* SPDX-License-Identifier: GPL-3.0-or-later */
/* learn.c - the way from lattices to a finished grammar. */
#include "config.h"

#include "learn/learn.h"

#include "learn/finish.h"

#include <math.h>
#include <string.h>
#include <time.h>

enum { LAST_ROUNDS = 20 }; /* of the last re-estimation */

void sg_learn_result_clear(sg_learn_result *r)
{
    sg_search_history_clear(&r->history);
}

static double now_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* The last re-estimation with the sizes of the uses. A lower bound that was carried along may, with the marginal data
 * term, lie below what the re-estimated counts give: then the carried grammar stays. */
static sg_status reestimate_last(sg_rules *r, sg_reestimator *e, sg_learn_result *out, sg_error *err)
{
    sg_rules kept = {0};
    const double carried = sg_rules_energy(r);
    sg_reestimator_forget(e);
    sg_status st = sg_rules_copy(&kept, r, err);
    if (st == SG_OK)
        st = sg_reestimate_until_stable(e, r, LAST_ROUNDS, &out->parsed, err);
    if (st == SG_OK)
        st = sg_reestimate_sizes(e, r, err);
    if (st == SG_OK && sg_rules_energy(r) > carried + 1e-9 * fabs(carried)) {
        const sg_rules t = *r;
        *r = kept;
        kept = t;
    }
    sg_rules_clear(&kept);
    return st;
}

static sg_status search(sg_rules *r, sg_reestimator *e, const sg_learn_opts *opts, sg_learn_result *out, sg_error *err)
{
    sg_search_opts o = opts->search;
    o.every = opts->reestimate_every ? e : NULL;
    const double began = now_s();
    sg_status st = sg_search(r, &o, &out->history, err);
    out->search_s = now_s() - began;
    out->parsed += out->history.parsed;
    out->searched_energy = sg_rules_energy(r);
    if (st != SG_OK && st != SG_STOPPED)
        return st;
    /* counts that were re-estimated on the way have left the size lists behind: those need one more parse */
    if (st == SG_OK || opts->reestimate_every) {
        const double start = now_s();
        SG_TRY(reestimate_last(r, e, out, err));
        out->reestimate_s = now_s() - start;
    }
    return st;
}

static sg_status check_energy(const sg_learn_result *out, sg_error *err)
{
    if (fabs(out->carried_energy - out->energy.energy) <= 1e-9 * (1 + fabs(out->energy.energy)))
        return SG_OK;
    return SG_FAIL(err, SG_ENUMERIC, "the carried energy %.12g is not the recomputed one, %.12g", out->carried_energy,
                   out->energy.energy);
}

static sg_status conclude(sg_rules *r, const sg_learn_opts *opts, sg_arena *arena, sg_learn_result *out, sg_error *err)
{
    out->carried_energy = sg_rules_energy(r);
    SG_TRY(sg_rules_form(r, true, arena, &out->merged, NULL, &out->merged_counts, err));
    out->merged.name = "merged";
    SG_TRY(sg_energy_of_form(&opts->energy, &out->merged, out->merged_counts, &out->energy, err));
    SG_TRY(check_energy(out, err));
    SG_TRY(sg_finish(&out->initial, &opts->densities, arena, &out->initial_finished, err));
    SG_TRY(sg_finish(&out->merged, &opts->densities, arena, &out->finished, err));
    out->finished.name = "learned";
    out->finished.tied = opts->tied; /* merged is what was scored: each sibling by itself */
    return SG_OK;
}

static sg_status learn(const sg_corpus *corpus, const sg_learn_opts *opts, sg_arena *arena, sg_learn_result *out,
                       sg_error *err)
{
    sg_rules r = {0};
    sg_reestimator *e = NULL;
    const sg_reestimate_opts plain = {false, false};
    SG_TRY(sg_reestimator_create(corpus, &plain, &e, err));
    sg_status st = sg_rules_create(&r, &out->initial, out->initial_counts, &opts->energy, arena, err);
    if (st == SG_OK)
        st = sg_rules_restrict(&r, opts->compatible, &out->initial, out->initial_counts, err);
    if (st == SG_OK)
        st = search(&r, e, opts, out, err);
    if (st == SG_OK || st == SG_STOPPED) {
        const sg_status end = conclude(&r, opts, arena, out, err);
        st = end == SG_OK ? st : end;
    }
    sg_reestimator_free(e);
    sg_rules_clear(&r);
    return st;
}

static sg_status learn_with(const sg_lattice *lattices, size_t n, const sg_learn_opts *opts, sg_regroup_kind regroup,
                            sg_arena *arena, sg_learn_result *out, sg_error *err)
{
    sg_corpus corpus;
    sg_incorporate_opts incorporate = opts->incorporate;
    memset(out, 0, sizeof *out);
    out->regroup = incorporate.regroup = regroup;
    SG_TRY(sg_incorporate(lattices, n, &incorporate, arena, &out->initial, &out->initial_counts, err));
    SG_TRY(sg_energy_of_form(&opts->energy, &out->initial, out->initial_counts, &out->initial_energy, err));
    SG_TRY(sg_corpus_create(lattices, n, &out->initial, arena, &corpus, err));
    const sg_status st = learn(&corpus, opts, arena, out, err);
    if (st != SG_OK && st != SG_STOPPED)
        sg_learn_result_clear(out);
    return st;
}

static void swap_results(sg_learn_result *a, sg_learn_result *b)
{
    const sg_learn_result t = *a;
    *a = *b;
    *b = t;
}

/* The same data and the same energy, so that the energy may choose. Times and parses are those of all. */
static sg_status learn_with_each(const sg_lattice *lattices, size_t n, const sg_learn_opts *opts, sg_arena *arena,
                                 sg_learn_result *out, sg_error *err)
{
    static const sg_regroup_kind kinds[] = {SG_REGROUP_FLOORS, SG_REGROUP_PAIRS, SG_REGROUP_NONE};
    sg_status st = learn_with(lattices, n, opts, kinds[0], arena, out, err);
    for (size_t i = 1; i < sizeof kinds / sizeof *kinds && st == SG_OK; i++) {
        sg_learn_result other;
        st = learn_with(lattices, n, opts, kinds[i], arena, &other, err);
        if (st != SG_OK && st != SG_STOPPED)
            break;
        if (st == SG_OK && other.energy.energy < out->energy.energy)
            swap_results(out, &other);
        out->parsed += other.parsed;
        out->search_s += other.search_s;
        out->reestimate_s += other.reestimate_s;
        sg_learn_result_clear(&other);
    }
    if (st != SG_OK && st != SG_STOPPED)
        sg_learn_result_clear(out);
    return st;
}

sg_status sg_learn(const sg_lattice *lattices, size_t n, const sg_learn_opts *opts, sg_arena *arena,
                   sg_learn_result *out, sg_error *err)
{
    return opts->best_regroup ? learn_with_each(lattices, n, opts, arena, out, err)
                              : learn_with(lattices, n, opts, opts->incorporate.regroup, arena, out, err);
}
