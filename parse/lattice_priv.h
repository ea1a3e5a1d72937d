/* SPDX-License-Identifier: GPL-3.0-or-later */
/* lattice_priv.h - what fitting a lattice is made of: one axis at a time, its evidence for lines, its strip sums and
 * the exact choice of its lines. Columns and rows are the same to all of this: rows are the columns of the transposed map. */
#ifndef SG_PARSE_LATTICE_PRIV_H
#define SG_PARSE_LATTICE_PRIV_H

#include "core/arena.h"
#include "core/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** A label map seen along the axis that lines cut. Lines are places between pixels: place p is before pixel p. */
typedef struct {
    size_t length;         /* px along the axis: lines are chosen among 0..length */
    size_t breadth;        /* px across it */
    size_t nclasses;
    const uint8_t *labels; /* [breadth][length], below nclasses, or SG_CLASS_IGNORE */
    const float *costs;    /* [nclasses][breadth][length], nats, 0 for all classes where ignored; NULL: 1 for a wrong label */
} sg_axis;

/** Places in increasing order; the first is 0 and the last the axis' length (across it: the breadth). */
typedef struct {
    size_t n;
    uint32_t *at;
} sg_places;

/** e(p) = number of pixels across whose label differs from that of the last pixel before p that is not ignored, exactly.
 *  @param profile  out [length + 1]; 0 at both ends
 *  @param run      out [length + 1]: the longest run of such pixels, side by side across the axis
 *  @return SG_OK, SG_ENOMEM */
sg_status sg_axis_evidence(const sg_axis *a, sg_arena *scratch, uint32_t *profile, uint32_t *run, sg_error *err);

/** Topological persistence of the maxima of a sequence: how far one must go down from a maximum before a higher one can
 *  be reached; the highest has its height above the smallest value. Merge tree by union-find (Edelsbrunner, Letscher and
 *  Zomorodian, "Topological persistence and simplification", 2002, in one dimension). A plateau counts at its first place.
 *  @param persistence  out [n]: 0 where there is no maximum
 *  @return SG_OK, SG_ENOMEM. O(n log n) */
sg_status sg_persistence(const uint32_t *value, size_t n, sg_arena *scratch, uint32_t *persistence, sg_error *err);

typedef struct {
    double persistence; /* share of the breadth that a maximum of the profile must stand out by */
    size_t min_run;     /* px: a straight run this long makes a candidate on its own */
    size_t max_places;
} sg_candidate_opts;

/** Candidate places: persistent maxima of the profile (box of 3) and places with long straight runs, the strongest
 *  max_places of them. Both ends are always there.
 *  @param among  places to choose from; NULL: all
 *  @return SG_OK, SG_ENOMEM */
sg_status sg_axis_candidates(const sg_axis *a, const sg_candidate_opts *opts, const sg_places *among, sg_arena *arena,
                             sg_places *out, sg_error *err);
/** Places between pixel columns that are not equal; with costs, all places. A line elsewhere is never needed: between two
 *  such places the gain is a sum of maxima of linear functions of the line's place, hence convex, and is largest at one of
 *  the two. As strips of the other axis they lose nothing either: equal pixel rows have one best class.
 *  With more than max_places of them, those with the strongest evidence. @return SG_OK, SG_ENOMEM */
sg_status sg_axis_knots(const sg_axis *a, size_t max_places, sg_arena *arena, sg_places *out, sg_error *err);
/** Sums of gains (pixels of a class, or minus costs) from the first place up to each place, by class and strip. */
typedef struct {
    sg_places places;
    size_t nclasses, nstrips, stride; /* stride: floats from one class to the next, a multiple of 8 */
    float *sum;                       /* [places.n][nclasses][stride] */
} sg_strip_table;

/** @param strips  places across the axis. @return SG_OK, SG_ENOMEM */
sg_status sg_strip_table_create(const sg_axis *a, const sg_places *places, const sg_places *strips, sg_arena *arena,
                                sg_strip_table *out, sg_error *err);
/** The sums over some of the places and some of the strip borders of another table: all of theirs must be among its own.
 *  @param base_strips  the strips that base was made with
 *  @return SG_OK, SG_ENOMEM */
sg_status sg_strip_table_coarsen(const sg_strip_table *base, const sg_places *base_strips, const sg_places *places,
                                 const sg_places *strips, sg_arena *arena, sg_strip_table *out, sg_error *err);
/** Gain of the interval between places i < j: the sum over strips of the largest class gain. */
double sg_strip_table_gain(const sg_strip_table *t, size_t i, size_t j);

/** The lines that maximise (sum of the intervals' gains) - penalty * (number of intervals): the exact optimum, by dynamic
 *  programming. Gains are subadditive, so a start that cannot win any more is dropped for good (Killick, Fearnhead and
 *  Eckley, "Optimal detection of changepoints with a linear computational cost", JASA 2012). Ties: fewer intervals, then the
 *  leftmost last line.
 *  @param penalty  >= 0
 *  @param out      chosen places, both ends among them, in the arena
 *  @param value    out: the optimum
 *  @return SG_OK, SG_ENOMEM */
sg_status sg_cuts_solve(const sg_strip_table *t, double penalty, sg_arena *arena, sg_places *out, double *value,
                        sg_error *err);

#endif
