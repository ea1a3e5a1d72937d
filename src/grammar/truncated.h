/* SPDX-License-Identifier: GPL-3.0-or-later */
/* truncated.h - the normal distribution truncated to [low, high], exact in the far tails.
 * Needs sd > 0 and low < high, both finite. With a = (low - mean)/sd >= 0 everything is expressed by
 *   M(a, t) = int_0^t exp(-a s - s^2/2) ds,
 * the mass above a relative to the density at a, which neither underflows nor cancels however large a is. */
#ifndef SG_GRAMMAR_TRUNCATED_H
#define SG_GRAMMAR_TRUNCATED_H

#include "grammar/normal.h"

#include <gsl/gsl_math.h> /* M_PI, also where the C library keeps it back */

/** The value with u of the mass below it, in [low, high]; u in (0,1), or in (-1,0): then -u of the mass is above it. */
double sg_truncated_quantile(double mean, double sd, double low, double high, double u);
/** The mass below x. */
double sg_truncated_cdf(double mean, double sd, double low, double high, double x);
/** Log density at x; -INFINITY outside. */
double sg_truncated_log_density(double mean, double sd, double low, double high, double x);

/* The standard normal on [a, a + width], for those who do the same to many; the usual case, an interval around 0, is inlined.
 * Points are distances t above a. Where a >= 0 or a + width <= 0, mass and density are relative to the density at the end
 * that is nearer to 0. */

/** Intervals around 0 that hold less than this are measured by differences, not by what they lack. */
#define SG_TRUNCATED_NARROW 0.25

/** What the normal has below a, 0 where a >= 0: for those who meet the same a again and again. */
static inline double sg_truncated_below(double a)
{
    return a < 0 ? sg_normal_above(-a) : 0;
}

/* The other cases of the functions below. */
double sg_truncated_unusual_mass(double a, double width);
double sg_truncated_unusual_distance(double a, double width, double u, double *mass);

/** @param below  sg_truncated_below(a) */
static inline double sg_truncated_mass(double a, double width, double below)
{
    const double mass = a < 0 && a + width > 0 ? 1 - below - sg_normal_above(a + width) : 0;
    return mass >= SG_TRUNCATED_NARROW ? mass : sg_truncated_unusual_mass(a, width);
}

/** The distance with u of the mass below it, and the mass itself. Rounding may leave it a little outside.
 *  @param u  in (0,1), or in (-1,0): then -u of the mass is above it */
static inline double sg_truncated_distance(double a, double width, double below, double u, double *mass)
{
    const double above = a < 0 && a + width > 0 ? sg_normal_above(a + width) : 1;
    *mass = 1 - below - above;
    if (!(*mass >= SG_TRUNCATED_NARROW))
        return sg_truncated_unusual_distance(a, width, u, mass);
    /* Shares of either side, so that no operation waits for the mass. */
    const double v = u >= 0 ? u : 1 + u, w = u >= 0 ? 1 - u : -u;
    return sg_normal_quantile(below * w + v * (1 - above), (1 - below) * w + v * above) - a;
}

/** The share of the mass that lies below t, and above it. Shares are relatively exact where they are small, so each tail has
 *  its function. */
double sg_truncated_share(double a, double width, double mass, double t);
double sg_truncated_share_above(double a, double width, double mass, double t);

/** Log of the density at t, not divided by the mass. */
static inline double sg_truncated_exponent(double a, double width, double t)
{
    const double b = a + width, z = a + t;
    if (a >= 0)
        return -t * (a + t / 2);
    if (b <= 0)
        return (width - t) * (b - (width - t) / 2);
    return -z * z / 2 - log(2 * M_PI) / 2;
}

#endif
