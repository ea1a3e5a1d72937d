/* SPDX-License-Identifier: GPL-3.0-or-later */
/* lattice_starts.c - how far from the lowest energy the fits of a data set end: against descents from many random starts.
 * Usage: lattice_starts DATASET CLASSES RANDOM-STARTS */
#include "config.h"

#include "core/random.h"
#include "parse/dataset.h"
#include "parse/lattice_fit.h"
#include "parse/lattice_priv.h"
#include "program/program.h"

#include <math.h>
#include <stdlib.h>

enum { NPRICES = 2, NFITS = 3 };

static const double SHARES[NPRICES] = {3.3e-5, 6.6e-5}; /* price of a cell: about 600 and 400 cells a facade */
static const size_t STARTS[NFITS] = {1, 2, 4};

/* Both axes of a map with sums over all its places. */
typedef struct {
    sg_axis axis[2];
    sg_places places[2];
    sg_strip_table sums[2];
    double pixels; /* counted */
} ground;

/* A descent from a random choice of the places of one axis; places and steps are the fit's own. */
static sg_status descend(const ground *g, double price, gsl_rng *rng, sg_arena *arena, double *energy, sg_error *err)
{
    const sg_places *places = g->places;
    int d = (int)gsl_rng_uniform_int(rng, 2);
    const double keep = sg_random_uniform(rng);
    sg_places cuts[2];
    cuts[d] = (sg_places){0, SG_NEW_ARRAY(arena, uint32_t, places[d].n)};
    if (cuts[d].at == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t i = 0; i < places[d].n; i++)
        if (i == 0 || i + 1 == places[d].n || sg_random_uniform(rng) < keep)
            cuts[d].at[cuts[d].n++] = places[d].at[i];
    *energy = INFINITY;
    for (double before = INFINITY;; before = *energy) {
        const int other = d;
        d = 1 - d;
        sg_strip_table table;
        double value;
        SG_TRY(sg_strip_table_coarsen(&g->sums[d], &places[other], &places[d], &cuts[other], arena, &table, err));
        SG_TRY(sg_cuts_solve(&table, price * (double)(cuts[other].n - 1), arena, &cuts[d], &value, err));
        *energy = g->pixels - value;
        if (!(*energy < before))
            return SG_OK;
    }
}

typedef struct {
    double energy[NFITS], best; /* sums over maps, as shares of their pixels */
    size_t beaten[NFITS];       /* maps on which a random start ends lower */
} tally;

static sg_status fits_of(const sg_lattice_source *s, double share, sg_arena *arena, double *energy, double *pixels,
                         sg_error *err)
{
    for (size_t k = 0; k < NFITS; k++) {
        sg_lattice_fit_opts opts = SG_LATTICE_FIT_OPTS_INIT;
        opts.starts = STARTS[k];
        sg_lattice_problem *p;
        sg_lattice_fit f;
        SG_TRY(sg_lattice_problem_create(s, &opts, &p, err));
        const sg_status st = sg_lattice_fit_share(p, share, arena, &f, err);
        sg_lattice_problem_free(p);
        SG_TRY(st);
        energy[k] = f.energy;
        *pixels = (double)f.counted_px;
    }
    return SG_OK;
}

static sg_status prepare(const sg_lattice_source *s, sg_arena *arena, ground *g, sg_error *err)
{
    uint8_t *turned = sg_arena_alloc(arena, s->width * s->height);
    if (turned == NULL)
        return SG_FAIL_NOMEM(err);
    g->pixels = 0;
    for (size_t i = 0; i < s->width * s->height; i++) {
        turned[i % s->width * s->height + i / s->width] = s->labels[i];
        g->pixels += s->labels[i] != SG_CLASS_IGNORE;
    }
    g->axis[0] = (sg_axis){s->width, s->height, s->nclasses, s->labels, NULL};
    g->axis[1] = (sg_axis){s->height, s->width, s->nclasses, turned, NULL};
    for (int d = 0; d < 2; d++)
        SG_TRY(sg_axis_knots(&g->axis[d], 1024, arena, &g->places[d], err));
    for (int d = 0; d < 2; d++)
        SG_TRY(sg_strip_table_create(&g->axis[d], &g->places[d], &g->places[1 - d], arena, &g->sums[d], err));
    return SG_OK;
}

static sg_status try_map(const sg_lattice_source *s, double share, size_t nrandom, gsl_rng *rng, sg_arena *arena,
                         tally *t, sg_error *err)
{
    double energy[NFITS], pixels = 1;
    SG_TRY(fits_of(s, share, arena, energy, &pixels, err));
    ground g;
    SG_TRY(prepare(s, arena, &g, err));
    double best = energy[NFITS - 1];
    for (size_t k = 0; k < nrandom; k++) {
        const sg_mark mark = sg_arena_mark(arena);
        double found = 0;
        SG_TRY(descend(&g, share * pixels, rng, arena, &found, err));
        best = found < best ? found : best;
        sg_arena_rewind(arena, mark);
    }
    for (size_t k = 0; k < NFITS; k++) {
        t->energy[k] += energy[k] / pixels;
        t->beaten[k] += best < energy[k] * (1 - 1e-9);
    }
    t->best += best / pixels;
    return SG_OK;
}

static sg_status run(const char *folder, const char *classes, size_t nrandom, sg_arena *arena, sg_error *err)
{
    sg_dataset_opts opts = SG_DATASET_OPTS_INIT;
    opts.classes_file = classes;
    sg_dataset d;
    SG_TRY(sg_dataset_open(folder, &opts, arena, NULL, NULL, &d, err));
    tally t[NPRICES] = {0};
    gsl_rng *rng = sg_random_create(1);
    sg_status st = rng != NULL ? SG_OK : SG_FAIL_NOMEM(err);
    for (size_t i = 0; st == SG_OK && i < d.nitems; i++) {
        sg_label_map map = {0};
        st = sg_dataset_read_labels(&d, i, &map, err);
        const sg_lattice_source source = sg_lattice_source_of(&map, d.classes.nclasses);
        for (size_t k = 0; st == SG_OK && k < NPRICES; k++) {
            const sg_mark mark = sg_arena_mark(arena);
            sg_random_stream(rng, 1, (uint32_t)k, i);
            st = try_map(&source, SHARES[k], nrandom, rng, arena, &t[k], err);
            sg_arena_rewind(arena, mark);
        }
        sg_label_map_clear(&map);
    }
    const double n = (double)d.nitems;
    for (size_t k = 0; st == SG_OK && k < NPRICES; k++) {
        printf("price of a cell %.1f in 100000; mean energy, %% of pixels: best of %zu random starts too %.4f\n",
               1e5 * SHARES[k], nrandom, 100 * t[k].best / n);
        for (size_t s = 0; s < NFITS; s++)
            printf("  %zu starts %.4f, beaten on %zu of %zu maps\n", STARTS[s], 100 * t[k].energy[s] / n, t[k].beaten[s],
                   d.nitems);
    }
    gsl_rng_free(rng);
    sg_dataset_close(&d);
    return st;
}

int main(int argc, char **argv)
{
    sg_program_begin("lattice_starts");
    size_t nrandom;
    if (argc != 4 || !sg_program_size("RANDOM-STARTS", argv[3], 0, 1000000, &nrandom))
        return sg_program_usage("expected DATASET CLASSES RANDOM-STARTS");
    sg_error err = SG_ERROR_INIT;
    sg_arena *arena = sg_arena_create();
    const sg_status st = arena != NULL ? run(argv[1], argv[2], nrandom, arena, &err) : SG_FAIL_NOMEM(&err);
    sg_arena_free(arena);
    return sg_program_end(st, &err);
}
