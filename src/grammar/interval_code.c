/* SPDX-License-Identifier: GPL-3.0-or-later */
/* interval_code.c - register code over intervals, forwards for values and backwards for conditions. */
#include "config.h"

#include "grammar/interval_code.h"

#include "grammar/grammar_priv.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

sg_status sg_interval_frame_open(sg_interval_frame *f, const sg_grammar *g, sg_error *err)
{
    memset(f, 0, sizeof *f);
    f->g = g;
    for (size_t i = 0; i < g->ncodes; i++)
        if (g->codes[i].n > f->capacity)
            f->capacity = g->codes[i].n;
    f->slots = calloc(g->frame_size, sizeof *f->slots);
    f->values = calloc(f->capacity + 1, sizeof *f->values);
    f->sources = calloc(f->capacity + 1, sizeof *f->sources);
    if (f->slots != NULL && f->values != NULL && f->sources != NULL)
        return SG_OK;
    sg_interval_frame_clear(f);
    return SG_FAIL_NOMEM(err);
}

void sg_interval_frame_clear(sg_interval_frame *f)
{
    free(f->slots);
    free(f->values);
    free(f->sources);
    memset(f, 0, sizeof *f);
}

static sg_interval value_of(const sg_interval_frame *f, sg_operand o, uint32_t source)
{
    switch (SG_OPERAND_SPACE(o)) {
    case SG_IN_CONSTANTS:
        return sg_interval_point(f->g->constants[SG_OPERAND_INDEX(o)]);
    case SG_IN_FRAME:
        return f->slots[SG_OPERAND_INDEX(o)];
    case SG_IN_DEPTH:
        return f->depth;
    default:
        return f->values[source];
    }
}

static uint32_t source_of(const uint32_t *last, sg_operand o)
{
    return SG_OPERAND_SPACE(o) == SG_IN_REGISTERS ? last[SG_OPERAND_INDEX(o)] : UINT32_MAX;
}

/* Values of all instructions; *source: the one that makes the result. */
static sg_interval run(sg_interval_frame *f, const sg_code *code, uint32_t *source)
{
    uint32_t last[SG_MAX_REGISTERS];
    for (uint32_t k = 0; k < code->n; k++) {
        const sg_instruction *i = &f->g->instructions[code->first + k];
        const sg_operand operands[3] = {i->a, i->b, i->c};
        sg_interval x[3];
        for (int j = 0; j < 3; j++) {
            f->sources[k][j] = source_of(last, operands[j]);
            x[j] = value_of(f, operands[j], f->sources[k][j]);
        }
        f->values[k] = sg_interval_apply((sg_operator)i->op, x[0], x[1], x[2]);
        last[i->to] = k;
    }
    *source = source_of(last, code->result);
    return value_of(f, code->result, *source);
}

sg_interval sg_interval_eval(sg_interval_frame *f, sg_expr e)
{
    uint32_t source;
    return run(f, &f->g->codes[e], &source);
}

/* ---- conditions ---- */

/* What can be narrowed: a slot or the depth; NULL for anything else. */
static sg_interval *variable(sg_interval_frame *f, sg_operand o)
{
    if (SG_OPERAND_SPACE(o) == SG_IN_FRAME)
        return &f->slots[SG_OPERAND_INDEX(o)];
    return SG_OPERAND_SPACE(o) == SG_IN_DEPTH ? &f->depth : NULL;
}

static bool narrow(sg_interval *x, double low, double high, bool is_number)
{
    x->low = fmax(x->low, low);
    x->high = fmin(x->high, high);
    if (is_number)
        x->nan = false;
    return !sg_interval_is_none(*x);
}

/* x <= y holds, or x < y. is_number: neither is NaN then. */
static bool assume_less(sg_interval_frame *f, const sg_operand *o, const sg_interval *v, int x, int y, bool strict,
                        bool is_number)
{
    sg_interval *left = variable(f, o[x]), *right = variable(f, o[y]);
    bool possible = true;
    if (left != NULL)
        possible = narrow(left, -INFINITY, strict ? nextafter(v[y].high, -INFINITY) : v[y].high, is_number);
    if (right != NULL)
        possible &= narrow(right, strict ? nextafter(v[x].low, INFINITY) : v[x].low, INFINITY, is_number);
    return possible;
}

static bool assume_equal(sg_interval_frame *f, const sg_operand *o, const sg_interval *v)
{
    bool possible = true;
    for (int j = 0; j < 2; j++) {
        sg_interval *x = variable(f, o[j]);
        if (x != NULL)
            possible &= narrow(x, v[1 - j].low, v[1 - j].high, true);
    }
    return possible;
}

/* A comparison that fails is the opposite one that holds, unless NaN is in it: then nothing is known of the bounds. */
static bool assume_comparison(sg_interval_frame *f, sg_operator op, const sg_operand *o, const sg_interval *v, bool holds)
{
    if (!holds && (v[0].nan || v[1].nan))
        return true;
    switch (op) {
    case SG_E_LT:
        return holds ? assume_less(f, o, v, 0, 1, true, true) : assume_less(f, o, v, 1, 0, false, false);
    case SG_E_LE:
        return holds ? assume_less(f, o, v, 0, 1, false, true) : assume_less(f, o, v, 1, 0, true, false);
    case SG_E_GT:
        return holds ? assume_less(f, o, v, 1, 0, true, true) : assume_less(f, o, v, 0, 1, false, false);
    case SG_E_GE:
        return holds ? assume_less(f, o, v, 1, 0, false, true) : assume_less(f, o, v, 0, 1, true, false);
    case SG_E_EQ:
        return holds ? assume_equal(f, o, v) : true;
    default:
        return holds ? true : assume_equal(f, o, v);
    }
}

/* Instruction k is true (or false). It recurses as deep as the condition is nested. */
static bool assume(sg_interval_frame *f, const sg_code *code, uint32_t k, bool holds)
{
    if (k == UINT32_MAX)
        return true;
    const sg_instruction *i = &f->g->instructions[code->first + k];
    const uint32_t *from = f->sources[k];
    const sg_operand o[2] = {i->a, i->b};
    const sg_interval v[2] = {value_of(f, i->a, from[0]), value_of(f, i->b, from[1])};
    const bool conjunction = i->op == (holds ? SG_E_AND : SG_E_OR); /* of operands that are each true (or false) */
    switch ((sg_operator)i->op) {
    case SG_E_AND:
    case SG_E_OR:
        for (int j = 0; j < 2; j++) {
            const bool other_can = holds ? sg_interval_can_hold(v[1 - j]) : sg_interval_can_fail(v[1 - j]);
            if ((conjunction || !other_can) && !assume(f, code, from[j], holds))
                return false;
        }
        return true;
    case SG_E_NOT:
        return assume(f, code, from[0], !holds);
    case SG_E_LT:
    case SG_E_LE:
    case SG_E_GT:
    case SG_E_GE:
    case SG_E_EQ:
    case SG_E_NE:
        return assume_comparison(f, (sg_operator)i->op, o, v, holds);
    default:
        return true;
    }
}

bool sg_interval_assume(sg_interval_frame *f, sg_expr condition)
{
    const sg_code *code = &f->g->codes[condition];
    enum { TIMES = 2 }; /* what one comparison says about a slot can tell another more */
    for (int t = 0; t < TIMES; t++) {
        uint32_t source;
        sg_interval value = run(f, code, &source);
        value.nan = false; /* a guard that is NaN does not hold */
        if (!sg_interval_can_hold(value) || !assume(f, code, source, true))
            return false;
    }
    return true;
}

/* ---- draws ---- */

static sg_interval argument(sg_interval_frame *f, const sg_draw *d, uint32_t i)
{
    return d->constants != NULL ? sg_interval_point(d->constants[i]) : sg_interval_eval(f, d->args[i]);
}

static sg_interval hull_of_values(sg_interval_frame *f, const sg_draw *d)
{
    sg_interval r = sg_interval_none();
    for (uint32_t i = 0; i < d->nargs; i += 2)
        if (argument(f, d, i).high > 0)
            r = sg_interval_join(r, argument(f, d, i + 1));
    return r;
}

/* low + u (high - low), which rounding may put a little outside. */
static sg_interval of_uniform(sg_interval low, sg_interval high)
{
    const bool constant = low.low == low.high && high.low == high.high;
    const double slack = constant ? 0 : 4 * DBL_EPSILON * fmax(fabs(low.low), fabs(high.high));
    return sg_interval_between(low.low - slack, fmax(high.high, low.low + (high.high - low.low)) + slack);
}

sg_interval sg_interval_of_draw(sg_interval_frame *f, const sg_draw *d)
{
    static const double simplex_slack = 1e-9; /* the last size is what the others leave, rounded */
    sg_interval r = sg_interval_all();
    switch (d->kind) {
    case SG_DRAW_UNIFORM:
        r = of_uniform(argument(f, d, 0), argument(f, d, 1));
        break;
    case SG_DRAW_TRUNCATED_NORMAL:
        r = sg_interval_between(argument(f, d, 2).low, argument(f, d, 3).high);
        break;
    case SG_DRAW_DISCRETE:
        r = hull_of_values(f, d);
        break;
    case SG_DRAW_SIMPLEX:
        r = sg_interval_between(-simplex_slack, 1 + simplex_slack);
        break;
    case SG_DRAW_NORMAL:
    case SG_DRAW_MIXTURE:
        break;
    }
    if (isnan(r.low) || isnan(r.high))
        r = sg_interval_all();
    r.nan = false;
    return r;
}

typedef enum { ANY, POSITIVE, WEIGHT } meaning;

static meaning meaning_of(const sg_draw *d, uint32_t i)
{
    switch (d->kind) {
    case SG_DRAW_NORMAL:
    case SG_DRAW_TRUNCATED_NORMAL:
        return i == 1 ? POSITIVE : ANY;
    case SG_DRAW_MIXTURE:
        return i % 3 == 0 ? WEIGHT : i % 3 == 2 ? POSITIVE : ANY;
    case SG_DRAW_DISCRETE:
        return i % 2 == 0 ? WEIGHT : ANY;
    default:
        return ANY;
    }
}

static const char *complaint_of_argument(sg_interval x, meaning m)
{
    if (!sg_interval_has_number(x) || x.low == INFINITY || x.high == -INFINITY)
        return "a parameter is never finite";
    if (m == POSITIVE && x.high <= 0)
        return "the standard deviation is never greater than 0";
    return m == WEIGHT && x.high < 0 ? "a weight is always negative" : NULL;
}

/* Where low and high stand among the arguments; false for other draws. */
static bool interval_arguments(const sg_draw *d, uint32_t *low)
{
    *low = d->kind == SG_DRAW_TRUNCATED_NORMAL ? 2 : 0;
    return d->kind == SG_DRAW_UNIFORM || d->kind == SG_DRAW_TRUNCATED_NORMAL;
}

const char *sg_interval_draw_complaint(sg_interval_frame *f, const sg_draw *d, uint32_t *arg)
{
    bool any_weight = false, weights = false;
    for (uint32_t i = 0; i < d->nargs; i++) {
        const sg_interval x = argument(f, d, i);
        const meaning m = meaning_of(d, i);
        const char *complaint = complaint_of_argument(x, m);
        *arg = i;
        if (complaint != NULL)
            return complaint;
        weights |= m == WEIGHT;
        any_weight |= m == WEIGHT && x.high > 0;
    }
    *arg = d->nargs;
    if (weights && !any_weight)
        return "all weights are always zero";
    uint32_t low;
    if (interval_arguments(d, &low) && argument(f, d, low).low >= argument(f, d, low + 1).high)
        return "low is never less than high";
    return NULL;
}

bool sg_interval_draw_is_safe(sg_interval_frame *f, const sg_draw *d)
{
    bool certain_weight = false, weights = false;
    for (uint32_t i = 0; i < d->nargs; i++) {
        const sg_interval x = argument(f, d, i);
        const meaning m = meaning_of(d, i);
        if (x.nan || isinf(x.low) || isinf(x.high) || (m == POSITIVE && !(x.low > 0)) || (m == WEIGHT && x.low < 0))
            return false;
        weights |= m == WEIGHT;
        certain_weight |= m == WEIGHT && x.low > 0;
    }
    uint32_t low;
    if (interval_arguments(d, &low) && !(argument(f, d, low).high < argument(f, d, low + 1).low))
        return false;
    return !weights || certain_weight;
}
