/* SPDX-License-Identifier: GPL-3.0-or-later */
/* search_priv.h - what the searches share: a grammar on its way, with its candidates and its history. */
#ifndef SG_LEARN_SEARCH_PRIV_H
#define SG_LEARN_SEARCH_PRIV_H

#include "learn/candidates.h"
#include "learn/search.h"

typedef struct {
    sg_rules rules;
    sg_candidates candidates;
    sg_search_history history;
} sg_line;

/** A change of energy must be this much below 0 to count: rounding must not keep a search going. */
#define SG_LEAST_GAIN 1e-9

void sg_line_clear(sg_line *l);
/** dst must be zeroed or a line before; it keeps its memory. */
sg_status sg_line_copy(sg_line *dst, const sg_line *src, sg_error *err);
static inline void sg_line_swap(sg_line *a, sg_line *b)
{
    const sg_line t = *a;
    *a = *b;
    *b = t;
}
/** Merge, bring candidates up to date, note the step. */
sg_status sg_line_merge(sg_line *l, uint32_t a, uint32_t b, sg_error *err);
/** Re-estimate with o->every, if it is there; the last step's energy becomes the new one.
 *  @param fresh  the last re-estimation was about another line */
sg_status sg_line_reestimate(sg_line *l, const sg_search_opts *o, bool fresh, sg_error *err);
/** The best candidate with its whole change of energy. */
bool sg_line_best(sg_line *l, sg_candidate *best, double *delta);
static inline double sg_line_energy(const sg_line *l)
{
    return sg_rules_energy(&l->rules);
}
bool sg_search_goes_on(const sg_search_opts *o, const sg_line *l);

/* One search each, by merges only: improve the line. @return SG_OK, SG_STOPPED, errors */
sg_status sg_search_greedy(sg_line *l, const sg_search_opts *o, sg_error *err);
sg_status sg_search_lookahead(sg_line *l, const sg_search_opts *o, sg_error *err);
sg_status sg_search_beam(sg_line *l, const sg_search_opts *o, sg_error *err);
sg_status sg_search_anneal(sg_line *l, const sg_search_opts *o, sg_error *err);

#endif
