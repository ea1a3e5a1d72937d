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

static sg_status fit_one(sg_lattice_problem *p, double share, outcome *o)
{
    sg_arena *arena = sg_arena_create();
    if (arena == NULL)
        return SG_ENOMEM;
    const sg_lattice_weights w = {0, 0, share * (double)p->counted_px};
    sg_lattice_fit f;
    const sg_status st = sg_lattice_fit_starts(p, &w, 1, arena, &f, NULL);
    if (st == SG_OK)
        *o = (outcome){f.width * f.height, sg_lattice_accuracy(&f)};
    sg_arena_free(arena);
    return st;
}

/* Means over the set; sums in the maps' order, so they do not depend on threads. */
static sg_status fit_all(sg_lattice_problem *const *problems, size_t n, double share, int threads, outcome *each,
                         double *cells, double *accuracy, sg_error *err)
{
    sg_status st = SG_OK;
#pragma omp parallel for schedule(dynamic) num_threads(threads)
    for (size_t i = 0; i < n; i++) {
        const sg_status s = fit_one(problems[i], share, &each[i]);
        if (s != SG_OK)
#pragma omp critical(sg_lattice_set)
            st = s;
    }
    if (st != SG_OK)
        return SG_FAIL(err, st, "out of memory"); /* nothing else can go wrong: the prices are good */
    *cells = *accuracy = 0;
    for (size_t i = 0; i < n; i++) {
        *cells += (double)each[i].cells / (double)n;
        *accuracy += each[i].accuracy / (double)n;
    }
    return SG_OK;
}

sg_status sg_lattice_common_price(sg_lattice_problem *const *problems, size_t n, double cells, double accuracy,
                                  int threads, sg_progress *progress, double *share, sg_error *err)
{
    if (n == 0 || !(cells >= 0) || !(cells > 0 || (accuracy >= 0 && accuracy <= 1)))
        return SG_FAIL(err, SG_EINVAL, "a common price needs maps, and a mean size or an accuracy from 0 to 1");
    outcome *each = calloc(n, sizeof *each);
    if (each == NULL)
        return SG_FAIL_NOMEM(err);
    double low = 1e-6, high = 1;
    sg_status st = SG_OK;
    const size_t rounds = (size_t)ceil(log2(log(high / low) / log(1.01)));
    for (size_t done = 0; st == SG_OK && high > 1.01 * low; done++) {
        double mean_cells = 0, mean_accuracy = 0;
        const double price = sqrt(low * high);
        sg_progress_report(progress, "price of a cell", done, rounds);
        st = fit_all(problems, n, price, threads, each, &mean_cells, &mean_accuracy, err);
        if (st != SG_OK)
            break;
        const bool small = cells > 0 ? mean_cells <= cells : mean_accuracy < accuracy; /* price is high enough */
        *(small ? &high : &low) = price;
        if (sg_progress_stopped(progress))
            st = SG_FAIL(err, SG_STOPPED, "stopped");
    }
    free(each);
    if (st == SG_OK)
        *share = cells > 0 ? high : low;
    return st;
}
