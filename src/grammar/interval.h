/* SPDX-License-Identifier: GPL-3.0-or-later */
/* interval.h - the operators of expressions over sets of numbers: what a value can be when its arguments are known only
 * to lie somewhere (interval arithmetic: R. E. Moore, "Interval Analysis", 1966).
 *
 * Every result holds each double that sg_operator_apply() gives for arguments out of the sets, rounding included: bounds
 * of operations that round correctly are computed as the values are, for rounding never turns an order around; those of
 * the library's functions are widened by a few units in the last place. */
#ifndef SG_GRAMMAR_INTERVAL_H
#define SG_GRAMMAR_INTERVAL_H

#include "grammar/operators.h"

#include <stdbool.h>

/** All doubles from low to high, infinite ones included, and NaN when nan is set. low > high: no number. */
typedef struct {
    double low, high;
    bool nan;
} sg_interval;

/** Every double, NaN too. */
sg_interval sg_interval_all(void);
/** Nothing at all. */
sg_interval sg_interval_none(void);
sg_interval sg_interval_between(double low, double high);
/** One value, which may be NaN. */
sg_interval sg_interval_point(double value);

/** Is there a double other than NaN in it? Is there nothing, not even NaN? Is this value in it (NaN may be asked for)? */
bool sg_interval_has_number(sg_interval a);
bool sg_interval_is_none(sg_interval a);
bool sg_interval_contains(sg_interval a, double value);
/** The smallest that holds both. */
sg_interval sg_interval_join(sg_interval a, sg_interval b);
/** Bounds moved outwards by a few units in the last place. */
sg_interval sg_interval_widen(sg_interval a);

/** As a condition: can it be anything but 0, can it be 0? */
bool sg_interval_can_hold(sg_interval a);
bool sg_interval_can_fail(sg_interval a);

/** Values of an operator; arguments over its arity are ignored. None when an argument is none. */
sg_interval sg_interval_apply(sg_operator op, sg_interval a, sg_interval b, sg_interval c);

#endif
