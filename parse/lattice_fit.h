/* SPDX-License-Identifier: GPL-3.0-or-later */
/* lattice_fit.h - from a label map (or from costs of labels per pixel) to an irregular lattice (MATHEMATICS B2).
 *
 * A lattice with W columns and H rows has the energy
 *     E = loss + per_column W + per_row H + per_cell W H,
 * loss the number of pixels whose label is not their cell's, or the sum of their costs of their cell's label. Columns given
 * rows, and rows given columns, are found exactly by dynamic programming; the two alternate until nothing changes, from
 * several starts, and the lowest energy wins. No step raises E. With per_cell alone, a set of maps fitted at one price a
 * cell loses the least that any lattices with as many cells in all can lose (as far as each fit is the optimum). */
#ifndef SG_PARSE_LATTICE_FIT_H
#define SG_PARSE_LATTICE_FIT_H

#include "core/arena.h"
#include "core/progress.h"
#include "core/status.h"
#include "image/image.h"
#include "parse/lattice.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** What a lattice is fitted to. */
typedef struct {
    size_t width, height; /* px */
    size_t nclasses;      /* at most SG_MAX_CLASSES */
    const uint8_t *labels; /* [height][width], below nclasses, or SG_CLASS_IGNORE: such a pixel costs nothing */
    const float *costs;   /* [nclasses][height][width] nats, finite, >= 0; then labels are needed too (the cheapest ones
                             say where lines may begin). NULL: a wrong label costs 1 */
} sg_lattice_source;

static inline sg_lattice_source sg_lattice_source_of(const sg_label_map *map, size_t nclasses)
{
    return (sg_lattice_source){map->width, map->height, nclasses, map->labels, NULL};
}

/** Prices in units of the loss: wrong pixels, or nats where there are costs. */
typedef struct {
    double per_column, per_row, per_cell;
} sg_lattice_weights;

typedef struct {
    size_t max_candidates; /* of each axis, in the first step; where more places than that have different pixels on their
                              two sides, the candidates are: */
    double persistence;    /* maxima of the evidence that stand out by this share of the other side, and */
    size_t min_run;        /* px: straight runs at least this long */
    size_t max_places;     /* of each axis, in the other steps: beyond that the strongest */
    size_t starts;         /* 1 to 4: columns or rows first, with the usual and with more lines */
} sg_lattice_fit_opts;

#define SG_LATTICE_FIT_OPTS_INIT {256, 0.05, 10, 1024, 4}

/** A fitted lattice, in the arena it was made in. */
typedef struct {
    size_t width, height; /* cells */
    uint32_t *x, *y;      /* [width + 1], [height + 1] px */
    uint8_t *classes;     /* [height][width] */
    size_t counted_px;    /* pixels that are not ignored */
    size_t wrong_px;      /* of these, pixels whose label is not their cell's */
    double loss;          /* wrong_px, or the sum of the costs */
    double energy;
    sg_lattice_weights weights;
    double *trace;        /* [nsteps] energy after each step of the winning start, the first one after both axes */
    size_t nsteps;
} sg_lattice_fit;

/** Share of the counted pixels that the lattice shows right. */
static inline double sg_lattice_accuracy(const sg_lattice_fit *f)
{
    return 1 - (double)f->wrong_px / (double)f->counted_px;
}

/** A map made ready: its evidence, candidates and first sums are shared by all fits to it. One thread at a time. */
typedef struct sg_lattice_problem sg_lattice_problem;

/** @param source  borrowed until the problem is freed
 *  @return SG_OK, SG_EINVAL (a side is 0 or too long, a label outside the classes, a cost that is negative or not finite),
 *          SG_EINPUT (every pixel is ignored), SG_ENOMEM */
sg_status sg_lattice_problem_create(const sg_lattice_source *source, const sg_lattice_fit_opts *opts,
                                    sg_lattice_problem **out, sg_error *err);
void sg_lattice_problem_free(sg_lattice_problem *p);

/** Fit with given weights (>= 0, finite). @return SG_OK, SG_EINVAL, SG_ENOMEM */
sg_status sg_lattice_fit_weights(sg_lattice_problem *p, const sg_lattice_weights *weights, sg_arena *arena,
                                 sg_lattice_fit *out, sg_error *err);
/** Weights from description length: a line costs log(length of its axis in px) nats, a cell log(number of classes that
 *  occur), a wrong pixel what it costs on the average to name the wrong ones (sg_lattice_residual_length()), which depends
 *  on the lattice: repeated until the price stands. With costs, the loss itself is in nats. */
sg_status sg_lattice_fit_length(sg_lattice_problem *p, sg_arena *arena, sg_lattice_fit *out, sg_error *err);
/** The most accurate of the fits with at most so many cells, bisecting the price of a cell.
 *  @return SG_OK, SG_EINVAL (no cells), SG_ENOMEM */
sg_status sg_lattice_fit_cells(sg_lattice_problem *p, size_t cells, sg_arena *arena, sg_lattice_fit *out,
                               sg_error *err);
/** The smallest of the fits with at least this accuracy, bisecting the price of a cell. An accuracy that no lattice reaches
 *  (more different pixel columns than max_places) gives the most accurate one.
 *  @param accuracy  in [0,1]. @return SG_OK, SG_EINVAL (out of range, or the source has costs), SG_ENOMEM */
sg_status sg_lattice_fit_accuracy(sg_lattice_problem *p, double accuracy, sg_arena *arena, sg_lattice_fit *out,
                                     sg_error *err);

/** The price of a cell, the same share of every map, at which lattices of all maps together have a wanted mean size or
 *  accuracy: what a set of maps can be shown with best. Bisection to one per cent.
 *  @param problems  [n]; threads work on different ones
 *  @param cells     the largest mean number of cells a map, or 0
 *  @param accuracy  with cells 0: the least mean accuracy
 *  @param share     out: price of a cell as a share of the map's counted pixels
 *  @return SG_OK, SG_EINVAL, SG_ENOMEM, SG_STOPPED */
sg_status sg_lattice_common_price(sg_lattice_problem *const *problems, size_t n, double cells, double accuracy,
                                  int threads, sg_progress *progress, double *share, sg_error *err);
/** The fit with a cell at this share of the map's counted pixels. */
sg_status sg_lattice_fit_share(sg_lattice_problem *p, double share, sg_arena *arena, sg_lattice_fit *out,
                               sg_error *err);

/** Nats that it takes to name the wrong pixels of a lattice and their labels: a pixel is right or wrong given which of its
 *  four neighbours before it (left, above left, above, above right) are wrong; a wrong one has the label of the wrong
 *  pixel left of it, else of the one above, or another. Krichevsky-Trofimov estimates throughout. */
double sg_lattice_residual_length(const sg_lattice_source *source, const sg_lattice_fit *f, sg_arena *scratch);

/** Cell classes by majority (or least cost) over given boundaries; ignored pixels have no vote, and ties go to the lower
 *  class. A cell of ignored pixels only takes the class of the neighbour it shares the longest border with (ties: left,
 *  right, above, below; cells next to classed ones first). Fills classes, counted_px, wrong_px and loss.
 *  @return SG_OK, SG_EINPUT (every pixel is ignored), SG_ENOMEM */
sg_status sg_lattice_vote(const sg_lattice_source *source, sg_arena *scratch, sg_lattice_fit *f, sg_error *err);

/** As a lattice with names. @param names  [nclasses], borrowed by the lattice */
sg_status sg_lattice_from_fit(const sg_lattice_fit *f, const char *const *names, size_t nclasses, sg_arena *arena,
                              sg_lattice *out, sg_error *err);

#endif
