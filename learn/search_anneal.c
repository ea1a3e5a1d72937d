/* SPDX-License-Identifier: GPL-3.0-or-later */
/* search_anneal.c - random walks over merges with falling temperature. */
#include "config.h"

#include "learn/search_priv.h"

#include "core/random.h"

#include <math.h>
#include <string.h>

enum { CHOICES = 64 }; /* a merge is drawn among this many best ones */

/* Draw one of the n candidates with probability in proportion to exp(-key/temperature). */
static const sg_candidate *draw(const sg_candidate *c, size_t n, double temperature, gsl_rng *rng)
{
    double sum = 0, at = 0;
    for (size_t i = 0; i < n; i++)
        sum += exp((c[0].key - c[i].key) / temperature);
    const double u = sg_random_uniform(rng) * sum;
    for (size_t i = 0; i < n; i++) {
        at += exp((c[0].key - c[i].key) / temperature);
        if (u < at)
            return &c[i];
    }
    return &c[n - 1];
}

/* While it is warm; lookahead does the rest. */
static sg_status walk(sg_line *l, const sg_search_opts *o, gsl_rng *rng, sg_error *err)
{
    sg_candidate choices[CHOICES];
    for (double t = o->temperature; t > 1e-3 * o->temperature; t *= o->cooling) {
        size_t n;
        if (!sg_search_goes_on(o, l))
            return SG_STOPPED;
        SG_TRY(sg_candidates_top(&l->candidates, &l->rules, CHOICES, choices, &n, err));
        if (n == 0 || choices[0].key + sg_merge_common(&l->rules) > -SG_LEAST_GAIN)
            break;
        const sg_candidate *c = draw(choices, n, t, rng);
        SG_TRY(sg_line_merge(l, c->a, c->b, err));
    }
    return SG_OK;
}

/* Further walks, each from the start; the best stays in l. */
static sg_status walk_again(sg_line *l, const sg_line *start, const sg_search_opts *o, gsl_rng *rng, sg_error *err)
{
    sg_line line;
    memset(&line, 0, sizeof line);
    sg_status st = SG_OK;
    for (size_t i = 1; i < o->walks && st == SG_OK; i++) {
        sg_random_stream(rng, o->seed, (uint32_t)i, 0);
        st = sg_line_copy(&line, start, err);
        if (st == SG_OK)
            st = walk(&line, o, rng, err);
        if (st == SG_OK)
            st = sg_search_lookahead(&line, o, err);
        if (st != SG_OK || sg_line_energy(&line) > sg_line_energy(l) - SG_LEAST_GAIN)
            continue;
        sg_line_swap(l, &line);
    }
    sg_line_clear(&line);
    return st;
}

sg_status sg_search_anneal(sg_line *l, const sg_search_opts *o, sg_error *err)
{
    sg_line start;
    memset(&start, 0, sizeof start);
    sg_search_opts cold = *o;
    cold.every = NULL; /* walks carry counts along; the best one is re-estimated */
    gsl_rng *rng = sg_random_create(o->seed);
    sg_status st = rng != NULL ? sg_line_copy(&start, l, err) : SG_FAIL_NOMEM(err);
    if (st == SG_OK)
        st = sg_search_lookahead(l, &cold, err);
    if (st == SG_OK)
        st = walk_again(l, &start, &cold, rng, err);
    if (rng != NULL)
        gsl_rng_free(rng);
    sg_line_clear(&start);
    return st == SG_OK ? sg_line_reestimate(l, o, true, err) : st;
}
