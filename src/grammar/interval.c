/* SPDX-License-Identifier: GPL-3.0-or-later */
/* interval.c - operators over intervals. Source of the method: Moore, Kearfott and Cloud, Introduction to Interval
 * Analysis (2009), chapters 2 and 5; NaN and infinities are values here, since they are values of expressions. */
#include "config.h"

#include "grammar/interval.h"

#include <float.h>
#include <math.h>

enum { WIDER = 4 }; /* units in the last place: more than the functions of the library are wrong by */

sg_interval sg_interval_all(void)
{
    return (sg_interval){-INFINITY, INFINITY, true};
}

sg_interval sg_interval_none(void)
{
    return (sg_interval){INFINITY, -INFINITY, false};
}

sg_interval sg_interval_between(double low, double high)
{
    return (sg_interval){low, high, false};
}

sg_interval sg_interval_point(double value)
{
    return isnan(value) ? (sg_interval){INFINITY, -INFINITY, true} : (sg_interval){value, value, false};
}

bool sg_interval_has_number(sg_interval a)
{
    return a.low <= a.high;
}

bool sg_interval_is_none(sg_interval a)
{
    return !sg_interval_has_number(a) && !a.nan;
}

bool sg_interval_contains(sg_interval a, double value)
{
    return isnan(value) ? a.nan : a.low <= value && value <= a.high;
}

sg_interval sg_interval_join(sg_interval a, sg_interval b)
{
    return (sg_interval){fmin(a.low, b.low), fmax(a.high, b.high), a.nan || b.nan};
}

sg_interval sg_interval_widen(sg_interval a)
{
    for (int i = 0; i < WIDER && sg_interval_has_number(a); i++) {
        a.low = nextafter(a.low, -INFINITY);
        a.high = nextafter(a.high, INFINITY);
    }
    return a;
}

bool sg_interval_can_hold(sg_interval a)
{
    return a.nan || a.low < 0 || a.high > 0;
}

bool sg_interval_can_fail(sg_interval a)
{
    return sg_interval_contains(a, 0);
}

static bool is_point(sg_interval a)
{
    return a.low == a.high && !a.nan;
}

static bool has_infinity(sg_interval a)
{
    return sg_interval_has_number(a) && (isinf(a.low) || isinf(a.high));
}

static double largest(sg_interval a)
{
    return fmax(fabs(a.low), fabs(a.high));
}

static double smallest(sg_interval a)
{
    return sg_interval_contains(a, 0) ? 0 : fmin(fabs(a.low), fabs(a.high));
}

/* The hull of one operator at the four corners; corners that are NaN count as `instead`, or not at all when that is NaN. */
static sg_interval corners(sg_operator op, sg_interval a, sg_interval b, double instead)
{
    const double x[2] = {a.low, a.high}, y[2] = {b.low, b.high};
    sg_interval hull = sg_interval_none();
    for (int i = 0; i < 4; i++) {
        double v = sg_operator_apply(op, x[i & 1], y[i >> 1], 0);
        if (isnan(v)) {
            hull.nan = true;
            v = instead;
        }
        if (!isnan(v))
            hull = sg_interval_join(hull, sg_interval_point(v));
    }
    return hull;
}

/* ---- truth ---- */

static sg_interval truth(bool can_hold, bool can_fail)
{
    return sg_interval_between(can_fail ? 0 : 1, can_hold ? 1 : 0);
}

/* a < b, or a <= b. NaN is in no order: then the comparison fails. */
static sg_interval less(sg_interval a, sg_interval b, bool or_equal)
{
    const bool numbers = sg_interval_has_number(a) && sg_interval_has_number(b);
    const bool can_hold = numbers && (or_equal ? a.low <= b.high : a.low < b.high);
    const bool must_hold = numbers && !a.nan && !b.nan && (or_equal ? a.high <= b.low : a.high < b.low);
    return truth(can_hold, !must_hold);
}

static sg_interval equal(sg_interval a, sg_interval b, bool negated)
{
    const bool can_hold = a.low <= b.high && b.low <= a.high && sg_interval_has_number(a) && sg_interval_has_number(b);
    const bool must_hold = is_point(a) && is_point(b) && a.low == b.low;
    return negated ? truth(!must_hold, can_hold) : truth(can_hold, !must_hold);
}

static sg_interval connective(sg_operator op, sg_interval a, sg_interval b)
{
    const bool a1 = sg_interval_can_hold(a), a0 = sg_interval_can_fail(a);
    const bool b1 = sg_interval_can_hold(b), b0 = sg_interval_can_fail(b);
    return op == SG_E_AND ? truth(a1 && b1, a0 || b0) : truth(a1 || b1, a0 && b0);
}

/* ---- arithmetic ---- */

static sg_interval sum(sg_operator op, sg_interval a, sg_interval b)
{
    const sg_interval c = op == SG_E_ADD ? b : sg_interval_between(-b.high, -b.low);
    sg_interval r = {a.low + c.low, a.high + c.high, false};
    r.nan = (a.high == INFINITY && c.low == -INFINITY) || (a.low == -INFINITY && c.high == INFINITY);
    if (isnan(r.low)) /* infinities against each other: the finite values between them can be anything */
        r.low = -INFINITY;
    if (isnan(r.high))
        r.high = INFINITY;
    return r;
}

static sg_interval product(sg_interval a, sg_interval b)
{
    sg_interval r = corners(SG_E_MUL, a, b, 0); /* 0 times all that grows is 0; 0 times infinity is not */
    r.nan = (sg_interval_contains(a, 0) && has_infinity(b)) || (sg_interval_contains(b, 0) && has_infinity(a));
    return r;
}

static sg_interval quotient(sg_interval a, sg_interval b)
{
    const bool nan = (sg_interval_contains(a, 0) && sg_interval_contains(b, 0)) || (has_infinity(a) && has_infinity(b));
    if (sg_interval_contains(b, 0)) /* of either sign */
        return (sg_interval){-INFINITY, INFINITY, nan};
    sg_interval r = corners(SG_E_DIV, a, b, NAN);
    r.nan = nan;
    return r;
}

static sg_interval whole_power(sg_interval a, double n)
{
    sg_interval r;
    if (n < 0 && sg_interval_contains(a, 0))
        return (sg_interval){-INFINITY, INFINITY, false};
    if (fmod(n, 2) != 0 || a.low >= 0) {
        r = corners(SG_E_POW, a, sg_interval_point(n), NAN);
    } else {
        const sg_interval size = {smallest(a), largest(a), false};
        r = corners(SG_E_POW, size, sg_interval_point(n), NAN);
    }
    return sg_interval_widen(r);
}

static sg_interval power(sg_interval a, sg_interval b)
{
    if (is_point(b) && b.low == floor(b.low) && fabs(b.low) < 0x1p53) {
        sg_interval r = whole_power(a, b.low);
        if (fmod(b.low, 2) == 0 && b.low > 0)
            r.low = fmax(r.low, 0);
        return r;
    }
    if (!(a.low > 0))
        return sg_interval_all();
    sg_interval r = sg_interval_widen(corners(SG_E_POW, a, b, 1));
    r.low = fmax(r.low, 0);
    r.nan = false;
    return r;
}

/* ---- functions ---- */

static sg_interval rising(sg_operator op, sg_interval a, bool exact)
{
    const sg_interval r =
        sg_interval_between(sg_operator_apply(op, a.low, 0, 0), sg_operator_apply(op, a.high, 0, 0));
    return exact ? r : sg_interval_widen(r);
}

/* A function that is defined from low to high only. */
static sg_interval on_part(sg_operator op, sg_interval a, double low, double high)
{
    sg_interval r = sg_interval_none();
    const sg_interval inside = {fmax(a.low, low), fmin(a.high, high), false};
    if (sg_interval_has_number(inside))
        r = op == SG_E_ACOS ? sg_interval_widen(sg_interval_between(acos(inside.high), acos(inside.low)))
                            : rising(op, inside, op == SG_E_SQRT);
    r.nan = a.low < low || a.high > high;
    return r;
}

static sg_interval absolute(sg_interval a)
{
    return sg_interval_between(smallest(a), largest(a));
}

static sg_interval remainder_of(sg_interval a, sg_interval b)
{
    if (sg_interval_contains(b, 0) || has_infinity(a) || has_infinity(b) || isinf(largest(a) / smallest(b)) ||
        largest(a) + largest(b) > DBL_MAX / 2)
        return sg_interval_all();
    const double slack = 8 * DBL_EPSILON * fmax(largest(a), largest(b)); /* a - b * floor(a / b) is rounded */
    return sg_interval_between(fmin(0, b.low) - slack, fmax(0, b.high) + slack);
}

static sg_interval unary(sg_operator op, sg_interval a)
{
    switch (op) {
    case SG_E_NEG:
        return sg_interval_between(-a.high, -a.low);
    case SG_E_ABS:
        return absolute(a);
    case SG_E_SIGN:
    case SG_E_FLOOR:
    case SG_E_CEIL:
    case SG_E_ROUND:
        return rising(op, a, true);
    case SG_E_EXP: {
        const sg_interval r = rising(op, a, false);
        return sg_interval_between(fmax(r.low, 0), r.high);
    }
    case SG_E_ATAN:
        return rising(op, a, false);
    case SG_E_SQRT:
    case SG_E_LOG:
        return on_part(op, a, 0, INFINITY);
    case SG_E_ASIN:
    case SG_E_ACOS:
        return on_part(op, a, -1, 1);
    case SG_E_SIN:
    case SG_E_COS:
        return (sg_interval){-1, 1, has_infinity(a)};
    default: /* tan */
        return (sg_interval){-INFINITY, INFINITY, has_infinity(a)};
    }
}

static sg_interval binary(sg_operator op, sg_interval a, sg_interval b)
{
    switch (op) {
    case SG_E_ADD:
    case SG_E_SUB:
        return sum(op, a, b);
    case SG_E_MUL:
        return product(a, b);
    case SG_E_DIV:
        return quotient(a, b);
    case SG_E_POW:
        return power(a, b);
    case SG_E_MIN:
        return sg_interval_between(fmin(a.low, b.low), fmin(a.high, b.high));
    case SG_E_MAX:
        return sg_interval_between(fmax(a.low, b.low), fmax(a.high, b.high));
    case SG_E_HYPOT:
        return sg_interval_widen(corners(op, absolute(a), absolute(b), NAN));
    case SG_E_MOD:
        return remainder_of(a, b);
    default: /* atan2 */
        return sg_interval_between(-3.15, 3.15);
    }
}

static sg_interval choice(sg_interval condition, sg_interval a, sg_interval b)
{
    sg_interval r = sg_interval_none();
    if (sg_interval_can_hold(condition))
        r = a;
    if (sg_interval_can_fail(condition))
        r = sg_interval_join(r, b);
    return r;
}

/* Numbers that come of a NaN in an argument: pow(NaN, 0) and pow(1, NaN) are 1, hypot(NaN, infinity) is infinite, sign(NaN)
 * is 0. */
static sg_interval of_nan(sg_operator op, sg_interval a, sg_interval b)
{
    if (op == SG_E_POW && ((a.nan && sg_interval_contains(b, 0)) || (b.nan && (a.nan || sg_interval_contains(a, 1)))))
        return sg_interval_point(1);
    if (op == SG_E_HYPOT && (has_infinity(a) || has_infinity(b)))
        return sg_interval_point(INFINITY);
    return op == SG_E_SIGN ? sg_interval_point(0) : sg_interval_none();
}

/* Arithmetic on the numbers of the arguments; a NaN in one makes a NaN, with few exceptions. */
static sg_interval arithmetic(sg_operator op, uint32_t arity, sg_interval a, sg_interval b)
{
    sg_interval r = sg_interval_none();
    if (sg_interval_has_number(a) && (arity < 2 || sg_interval_has_number(b)))
        r = arity < 2 ? unary(op, a) : binary(op, a, b);
    if (!a.nan && !(arity > 1 && b.nan))
        return r;
    r.nan = op != SG_E_SIGN;
    return sg_interval_join(r, of_nan(op, a, b));
}

sg_interval sg_interval_apply(sg_operator op, sg_interval a, sg_interval b, sg_interval c)
{
    const uint32_t arity = sg_operator_get(op)->arity;
    if (sg_interval_is_none(a) || (arity > 1 && sg_interval_is_none(b)) || (arity > 2 && sg_interval_is_none(c)))
        return sg_interval_none();
    /* Zeros have signs, which quotients, powers and angles tell apart and intervals do not. */
    const bool zero = (op == SG_E_DIV || op == SG_E_POW || op == SG_E_ATAN2) && (a.low == 0 || b.low == 0);
    if (is_point(a) && (arity < 2 || is_point(b)) && arity < 3 && !zero)
        return sg_interval_point(sg_operator_apply(op, a.low, b.low, 0));
    switch (op) {
    case SG_E_OR:
    case SG_E_AND:
        return connective(op, a, b);
    case SG_E_NOT:
        return truth(sg_interval_can_fail(a), sg_interval_can_hold(a));
    case SG_E_LT:
    case SG_E_LE:
        return less(a, b, op == SG_E_LE);
    case SG_E_GT:
    case SG_E_GE:
        return less(b, a, op == SG_E_GE);
    case SG_E_EQ:
    case SG_E_NE:
        return equal(a, b, op == SG_E_NE);
    case SG_E_IF:
        return choice(a, b, c);
    default:
        return arithmetic(op, arity, a, b);
    }
}
