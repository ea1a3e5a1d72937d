/* SPDX-License-Identifier: GPL-3.0-or-later */
/* lattice_set.c - one price of a cell for a set of maps. */
#include "parse/lattice_fit_priv.h"

#include <math.h>
#include <stdlib.h>

typedef struct {
    size_t cells;
    double accuracy;
} outcome;

sg_status sg_lattice_fit_share(sg_lattice_problem *p, double share, sg_arena *arena, sg_lattice_fit *out, sg_error *err)
{
    const sg_lattice_weights w = {0, 0, share * (double)p->counted_px};
    return sg_lattice_fit_weights(p, &w, arena, out, err);
}

static sg_status fit_one(sg_lattice_problem *p, double share, size_t starts, outcome *o)
{
    sg_arena *arena = sg_arena_create();
    if (arena == NULL)
        return SG_ENOMEM;
    const sg_lattice_weights w = {0, 0, share * (double)p->counted_px};
    sg_lattice_fit f;
    const sg_status st = sg_lattice_fit_starts(p, &w, starts, arena, &f, NULL);
    if (st == SG_OK)
        *o = (outcome){f.width * f.height, sg_lattice_accuracy(&f)};
    sg_arena_free(arena);
    return st;
}

typedef struct {
    sg_lattice_problem *const *problems;
    size_t n;
    double cells, accuracy; /* wanted */
    int threads;
    outcome *each; /* [n] */
} search;

/* Is a price so high that no lattices are too large, or that they are too inaccurate? Means are summed in the maps' order, so
 * they do not depend on threads. `all`: with all the starts that a fit has. */
static sg_status is_high(const search *s, double share, bool all, bool *high, sg_error *err)
{
    sg_status st = SG_OK;
#pragma omp parallel for schedule(dynamic) num_threads(s->threads)
    for (size_t i = 0; i < s->n; i++) {
        const sg_status one = fit_one(s->problems[i], share, all ? s->problems[i]->opts.starts : 1, &s->each[i]);
        if (one != SG_OK)
#pragma omp critical(sg_lattice_set)
            st = one;
    }
    if (st != SG_OK)
        return SG_FAIL(err, st, "out of memory"); /* nothing else can go wrong: the prices are good */
    double cells = 0, accuracy = 0;
    for (size_t i = 0; i < s->n; i++) {
        cells += (double)s->each[i].cells / (double)s->n;
        accuracy += s->each[i].accuracy / (double)s->n;
    }
    *high = s->cells > 0 ? cells <= s->cells : accuracy < s->accuracy;
    return SG_OK;
}

/* Bisection with one start a fit; then, with all of them, on to the first price that does what is asked. */
static sg_status find_price(const search *s, sg_progress *progress, double *share, sg_error *err)
{
    const double step = 1.01, lowest = 1e-6, highest = 1;
    double low = lowest, high = highest;
    const size_t rounds = (size_t)ceil(log2(log(high / low) / log(step)));
    bool is;
    for (size_t done = 0; high > step * low; done++) {
        sg_progress_report(progress, "price of a cell", done, rounds);
        if (sg_progress_stopped(progress))
            return SG_FAIL(err, SG_STOPPED, "stopped");
        const double price = sqrt(low * high);
        SG_TRY(is_high(s, price, false, &is, err));
        *(is ? &high : &low) = price;
    }
    const bool want_high = s->cells > 0;
    double price = want_high ? high : low;
    for (;; price *= want_high ? step : 1 / step) {
        if (sg_progress_stopped(progress))
            return SG_FAIL(err, SG_STOPPED, "stopped");
        SG_TRY(is_high(s, price, true, &is, err));
        if (is == want_high || price < lowest || price > highest)
            break;
    }
    *share = price;
    return SG_OK;
}

sg_status sg_lattice_common_price(sg_lattice_problem *const *problems, size_t n, double cells, double accuracy,
                                  int threads, sg_progress *progress, double *share, sg_error *err)
{
    if (n == 0 || threads < 1 || !(cells >= 0) || !(cells > 0 || (accuracy >= 0 && accuracy <= 1)))
        return SG_FAIL(err, SG_EINVAL, "a common price needs maps, and a mean size or an accuracy from 0 to 1");
    search s = {problems, n, cells, accuracy, threads, calloc(n, sizeof *s.each)};
    if (s.each == NULL)
        return SG_FAIL_NOMEM(err);
    const sg_status st = find_price(&s, progress, share, err);
    free(s.each);
    return st;
}
