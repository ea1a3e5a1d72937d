/* SPDX-License-Identifier: GPL-3.0-or-later */
/* truncated.h - the normal distribution truncated to [low, high], exact in the far tails.
 * Needs sd > 0 and low < high, both finite. With a = (low - mean)/sd >= 0 everything is expressed by
 *   M(a, t) = int_0^t exp(-a s - s^2/2) ds,
 * the mass above a relative to the density at a, which neither underflows nor cancels however large a is. */
#ifndef SG_GRAMMAR_TRUNCATED_H
#define SG_GRAMMAR_TRUNCATED_H

/** The value with u of the mass below it, in [low, high]. */
double sg_truncated_quantile(double mean, double sd, double low, double high, double u);
/** The mass below x. */
double sg_truncated_cdf(double mean, double sd, double low, double high, double x);
/** Log density at x; -INFINITY outside. */
double sg_truncated_log_density(double mean, double sd, double low, double high, double x);

/* The standard normal on [a, a + width], for those who do the same to many: points are distances t above a, and the mass is
 * found once. Where a >= 0 or a + width <= 0, mass and density are relative to the density at the end that is nearer to 0. */

double sg_truncated_mass(double a, double width);
/** The distance with u of the mass below it. */
double sg_truncated_distance(double a, double width, double mass, double u);
/** The share of the mass below t. */
double sg_truncated_share(double a, double width, double mass, double t);
/** The same with the mass above: shares are relatively exact where they are small, so each tail has its function. */
double sg_truncated_distance_above(double a, double width, double mass, double u);
double sg_truncated_share_above(double a, double width, double mass, double t);
/** Log of the density at t, not divided by the mass. */
double sg_truncated_exponent(double a, double width, double t);

#endif
