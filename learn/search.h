/* SPDX-License-Identifier: GPL-3.0-or-later */
/* search.h - the search for the grammar of least energy: merges, and chunks on request.
 *   greedy     the best merge, as long as it lowers the energy
 *   lookahead  the same, but goes on through up to `patience` steps that do not, and keeps the best grammar on the way
 *   beam       the `width` best grammars side by side; the greedy line is always one of them
 *   anneal     random walks: merges drawn by exp(-change/temperature) with falling temperature, each ended by
 * lookahead; the first walk is at temperature 0 so none of the last three ends above greedy, as long as counts are
 * carried along. Source: Stolcke and Omohundro 1994 (best-first, lookahead, beam). */
#ifndef SG_LEARN_SEARCH_H
#define SG_LEARN_SEARCH_H

#include "core/progress.h"
#include "learn/reestimate.h"
#include "learn/rules.h"

typedef enum { SG_SEARCH_GREEDY, SG_SEARCH_LOOKAHEAD, SG_SEARCH_BEAM, SG_SEARCH_ANNEAL } sg_search_kind;

typedef struct {
    sg_search_kind kind;
    bool chunk;         /* alternate merging with chunking until neither lowers the energy */
    size_t patience;    /* steps without a new best: lookahead, beam */
    size_t width;       /* of the beam */
    size_t walks;       /* of annealing */
    double temperature; /* nats, at the start of a walk */
    double cooling;     /* factor a step */
    uint64_t seed;
    sg_reestimator *every; /* re-estimate after each accepted step (greedy, lookahead), or each time a grammar becomes
                              the best (beam, anneal); NULL: counts are carried along */
    sg_progress *progress; /* or NULL */
} sg_search_opts;

#define SG_SEARCH_OPTS_INIT                                                                                            \
    {                                                                                                                  \
        SG_SEARCH_GREEDY, false, 10, 5, 4, 3.0, 0.98, 1, NULL, NULL                                                    \
    }

typedef enum { SG_STEP_START, SG_STEP_MERGE, SG_STEP_CHUNK } sg_step_kind;

/** One step on the way to the result. */
typedef struct {
    sg_step_kind kind;
    const char *first, *second; /* merge: both symbols, `first` lives on; chunk: the new symbol and NULL */
    double energy;              /* after the step and its re-estimation */
    double carried;             /* after the step, before */
    size_t nonterminals, rules_x, rules_y;
} sg_search_step;

typedef struct {
    sg_search_step *steps; /* [n], the first is the start */
    size_t n, capacity;
    size_t merges, chunks; /* on the way to the result */
    size_t parsed;         /* lattices parsed in re-estimations */
} sg_search_history;

void sg_search_history_clear(sg_search_history *h);

/** Improve r.
 *  @param r  in/out
 *  @param h  out: the way from the first grammar to the result; zeroed before, free with sg_search_history_clear()
 *  @return SG_OK; SG_STOPPED when progress asked for it (r is the best so far); SG_ENOMEM, and what sg_reestimate()
 * returns */
sg_status sg_search(sg_rules *r, const sg_search_opts *opts, sg_search_history *h, sg_error *err);

#endif
