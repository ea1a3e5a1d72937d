/* SPDX-License-Identifier: GPL-3.0-or-later */
/* function_score.h - a score that is any function of a derivation, computed from scratch each time: the slow and obvious
 * member of score.h, for tests of what stands on it. */
#ifndef SG_TESTS_FUNCTION_SCORE_H
#define SG_TESTS_FUNCTION_SCORE_H

#include "score/score.h"

#include <math.h>
#include <stdlib.h>

typedef struct {
    sg_score base;
    double (*log_of)(const sg_derivation *d);
    bool stops_early; /* -INFINITY for what is below the floor */
} function_score;

typedef struct {
    sg_score_state base;
    sg_derivation proposed;
} function_state;

static inline void function_destroy(sg_score *target)
{
    (void)target;
}

static inline sg_status function_create_state(const sg_score *target, sg_score_state **out, sg_error *err)
{
    function_state *s = calloc(1, sizeof *s);
    if (s == NULL)
        return SG_FAIL_NOMEM(err);
    s->base.target = target;
    *out = &s->base;
    return SG_OK;
}

static inline void function_destroy_state(sg_score_state *state)
{
    function_state *s = (function_state *)state;
    sg_derivation_clear(&s->proposed);
    free(s);
}

static inline sg_status function_evaluate(sg_score_state *state, const sg_derivation *d, sg_score_value *out, sg_error *err)
{
    (void)err;
    const double log_score = ((const function_score *)state->target)->log_of(d);
    *out = (sg_score_value){log_score, log_score};
    return SG_OK;
}

static inline sg_status function_propose(sg_score_state *state, const sg_change *change, double floor, sg_score_value *out,
                                         sg_error *err)
{
    function_state *s = (function_state *)state;
    SG_TRY(sg_derivation_copy(&s->proposed, change->current, err));
    sg_change copy = *change;
    copy.current = &s->proposed;
    SG_TRY(sg_derivation_apply(&s->proposed, &copy, err));
    SG_TRY(function_evaluate(state, &s->proposed, out, err));
    if (((const function_score *)state->target)->stops_early && out->log < floor)
        *out = (sg_score_value){-INFINITY, -INFINITY};
    return SG_OK;
}

static inline void function_end(sg_score_state *state)
{
    (void)state;
}

static inline sg_status function_copy_state(sg_score_state *dst, const sg_score_state *src, sg_error *err)
{
    (void)dst, (void)src, (void)err;
    return SG_OK;
}

static const sg_score_ops function_ops = {
    "function",       function_destroy, function_create_state, function_destroy_state, function_evaluate,
    function_propose, function_end,     function_end,          function_copy_state,
};

#endif
