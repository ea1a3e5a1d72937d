/* SPDX-License-Identifier: GPL-3.0-or-later */
/* earley_viterbi.c - the value of the best derivation, in logs. The derivation itself: earley_tree.c. */
#include "config.h"

#include "core/array.h"
#include "parse/earley_priv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef double value;
#define VALUE_ZERO                  (-INFINITY)
#define value_is_zero(v)            ((v) == -INFINITY)
#define value_mul(a, b)             ((a) + (b))
#define value_add(a, b)             ((a) > (b) ? (a) : (b))
#define value_of_cost(cost)         (-(cost))
#define value_is_hopeless(v, chart) ((v) < (chart)->floor)
#define PREFIX_END_P(e)             ((e).log_p)
#define LEAF_P(leaf)                ((leaf)->log_p)
#define UNIT_P(u)                   ((u)->log_p)
#define CLOSURE(c)                  ((c)->best)
#include "parse/earley_walk.inc"

/* One pass that keeps no value below the floor. */
static sg_status parse_above(const sg_parse_table *t, const sg_cells *cells, sg_chart *c, double floor, sg_error *err)
{
    SG_TRY(sg_chart_begin(c, t, cells, SG_CHART_VITERBI, err));
    c->floor = floor;
    if (run(c) && value_at(c, t->axiom, 0, 0, c->width, c->height, &c->log_value)) {
        c->log_value -= c->least_cost;
        return SG_OK;
    }
    c->kind = SG_CHART_EMPTY;
    return SG_FAIL_NOMEM(err);
}

/* Over costs nearly every rectangle can be every symbol, at a price. Costs in the chart are what a cell costs above its
 * cheapest terminal, so no part of a derivation has a larger log value than a part of that part; a part below the value
 * of the whole cannot belong to the best derivation. Its value is not known: passes with lower and lower floors, until
 * one finds a derivation. It is the best one, with all its equals, since those pass every floor below their value. */
sg_status sg_earley_viterbi(const sg_parse_table *t, const sg_cells *cells, sg_chart *c, double *log_viterbi,
                            sg_error *err)
{
    for (double floor = cells->costs != NULL ? -64 : -INFINITY;; floor = floor > -1e6 ? 3 * floor : -INFINITY) {
        SG_TRY(parse_above(t, cells, c, floor, err));
        if (c->log_value != -INFINITY || floor == -INFINITY)
            break;
    }
    *log_viterbi = c->log_value;
    return SG_OK;
}

bool sg_viterbi_slice_of(sg_chart *c, uint32_t symbol, uint32_t x, uint32_t y, uint32_t axis, uint32_t across,
                         sg_viterbi_slice *out)
{
    const walk w = {c, c->table, true};
    sg_comps scratch;
    slice s;
    if (!slice_of(c, comps_at(&w, symbol, x, y, &scratch), axis, across, &s))
        return false;
    *out = (sg_viterbi_slice){s.along, s.v, s.n};
    return true;
}
