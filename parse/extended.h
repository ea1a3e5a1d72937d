/* SPDX-License-Identifier: GPL-3.0-or-later */
/* extended.h - non-negative numbers with the precision of a double and a range that no lattice leaves.
 *
 * A number is m * 2^(512 e). With so large a radix two numbers that are worth adding nearly always have one exponent,
 * so that an addition is one comparison dearer than a double's. The probability of a lattice of a thousand cells is far
 * below the least double; logarithms would cost an exponential and a logarithm for each of the edges of a chart. */
#ifndef SG_PARSE_EXTENDED_H
#define SG_PARSE_EXTENDED_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

typedef struct {
    double m;  /* 0, or 2^-256 <= m < 2^256 */
    int32_t e; /* of zero: SG_EXT_ZERO_EXPONENT, so that zero is the smaller one in every sum */
} sg_ext;

#define SG_EXT_ZERO_EXPONENT (-(1 << 29))
#define SG_EXT_LOG_RADIX     (512 * 0.693147180559945309417232121458)

static inline sg_ext sg_ext_zero(void)
{
    return (sg_ext){0, SG_EXT_ZERO_EXPONENT};
}

static inline bool sg_ext_is_zero(sg_ext a)
{
    return a.m == 0;
}

/** A product or a sum of two mantissas is at most one step away from its range. */
static inline sg_ext sg_ext_normal(double m, int32_t e)
{
    if (m >= 0x1p256)
        return (sg_ext){m * 0x1p-512, e + 1};
    if (m < 0x1p-256)
        return m == 0 ? sg_ext_zero() : (sg_ext){m * 0x1p512, e - 1};
    return (sg_ext){m, e};
}

static inline sg_ext sg_ext_mul(sg_ext a, sg_ext b)
{
    return sg_ext_normal(a.m * b.m, a.e + b.e);
}

static inline sg_ext sg_ext_add(sg_ext a, sg_ext b)
{
    if (a.e == b.e)
        return sg_ext_normal(a.m + b.m, a.e);
    if (a.e < b.e) {
        const sg_ext swap = a;
        a = b;
        b = swap;
    }
    return a.e - b.e > 1 ? a : sg_ext_normal(a.m + b.m * 0x1p-512, a.e);
}

/** @param v  finite, not negative */
static inline sg_ext sg_ext_of(double v)
{
    sg_ext a = {v, 0};
    if (v == 0)
        return sg_ext_zero();
    while (a.m >= 0x1p256 || a.m < 0x1p-256)
        a = sg_ext_normal(a.m, a.e);
    return a;
}

/** exp(l); -INFINITY gives zero. */
static inline sg_ext sg_ext_exp(double l)
{
    if (l == -INFINITY)
        return sg_ext_zero();
    const double e = nearbyint(l / SG_EXT_LOG_RADIX);
    /* |e| is below 2^28 for any sum of costs that a lattice can hold; beyond, the value is as good as zero. */
    if (e < -0x1p27)
        return sg_ext_zero();
    return sg_ext_normal(exp(l - e * SG_EXT_LOG_RADIX), (int32_t)e);
}

static inline double sg_ext_log(sg_ext a)
{
    return a.m == 0 ? -INFINITY : log(a.m) + a.e * SG_EXT_LOG_RADIX;
}

static inline sg_ext sg_ext_inverse(sg_ext a)
{
    return sg_ext_normal(1 / a.m, -a.e);
}

/** As a double: infinite or zero where a double is. */
static inline double sg_ext_double(sg_ext a)
{
    return ldexp(a.m, a.e > 8 ? 4096 : a.e < -8 ? -4096 : 512 * a.e);
}

#endif
