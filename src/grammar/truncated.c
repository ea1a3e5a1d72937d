/* SPDX-License-Identifier: GPL-3.0-or-later */
/* truncated.c - truncated normal through Mills ratios (GSL's hazard function) and erf. */
#include "config.h"

#include "grammar/normal.h"
#include "grammar/truncated.h"

#include <gsl/gsl_sf_erf.h>
#include <math.h>

/* Gauss-Legendre with ten nodes on (0, t): exact to rounding where the exponent falls by less than one. */
static double short_mass(double a, double t)
{
    static const double node[5] = {0.1488743389816312, 0.4333953941292472, 0.6794095682990244, 0.8650633666889845,
                                   0.9739065285171717};
    static const double weight[5] = {0.2955242247147529, 0.2692667193099964, 0.2190863625159820, 0.1494513491505806,
                                     0.0666713443086881};
    double sum = 0;
    for (int i = 0; i < 5; i++) {
        const double s = t / 2 * (1 - node[i]), r = t / 2 * (1 + node[i]);
        sum += weight[i] * (exp(-s * (a + s / 2)) + exp(-r * (a + r / 2)));
    }
    return t / 2 * sum;
}

/* M(a, infinity), Mills' ratio. GSL multiplies the same two numbers below 25, by way of their logarithms. */
static double whole_mass_above(double a)
{
    return a < 25 ? sqrt(M_PI / 2) * erfc(a * M_SQRT1_2) * exp(a * a / 2) : 1 / gsl_sf_hazard(a);
}

/* M(a, t) for a >= 0. */
static double mass_above(double a, double t)
{
    const double fall = t * (a + t / 2);
    if (fall < 1)
        return short_mass(a, t);
    const double whole = whole_mass_above(a);
    return fall < 40 ? whole - exp(-fall) * whole_mass_above(a + t) : whole; /* beyond 40 it is less than an ulp */
}

/* Nearly that of tail_quantile(): by the inverse of the normal as far as it goes, else as if the density fell exponentially,
 * or not at all. */
static double first_guess(double a, double width, double u)
{
    const double fall = width * (a + width / 2);
    if (fall < 1)
        return a * width > 1e-3 ? -log1p(u * expm1(-a * width)) / a : u * width;
    if (a < 25) {
        const double beyond = fall < 40 ? u * erfc((a + width) * M_SQRT1_2) / 2 : 0;
        const double above = (1 - u) * erfc(a * M_SQRT1_2) / 2 + beyond;
        return sg_normal_quantile(1 - above, above) - a;
    }
    const double e = -log1p(u * expm1(-fall));
    return 2 * e / (a + sqrt(a * a + 2 * e));
}

/* t in [0, width] with M(a, t) = u M(a, width), which is total: Newton within a bracket. M is increasing and concave in t, so
 * the steps from the left never pass the root, and a few suffice; each squares the error. */
static double tail_quantile(double a, double width, double total, double u)
{
    const double target = u * total;
    double low = 0, high = width, t = first_guess(a, width, u);
    for (int i = 0; i < 60; i++) {
        if (!(t > low && t < high))
            t = low + (high - low) / 2;
        const double excess = mass_above(a, t) - target;
        if (excess > 0)
            high = t;
        else
            low = t;
        const double step = excess * exp(t * (a + t / 2));
        t -= step;
        if (!(fabs(step) > 1e-9 * t))
            break;
    }
    return fmin(fmax(t, 0), width);
}

/* t in [0, width] with the share u of the mass above it, u small: Newton on the logarithm of the mass above, which is
 * concave in t and has the slope -1 / M(a + t, width - t). */
static double far_quantile(double a, double width, double total, double u)
{
    const double target = log(u * total);
    double low = 0, high = width, t = width / 2;
    for (int i = 0; i < 100; i++) {
        const double mass = mass_above(a + t, width - t), excess = log(mass) - t * (a + t / 2) - target;
        if (excess > 0)
            low = t;
        else
            high = t;
        const double step = excess * mass;
        if (!(fabs(step) > 2e-16 * t) || !(high - low > 2e-16 * high))
            break;
        t += step;
        if (!(t > low && t < high))
            t = low + (high - low) / 2;
    }
    return fmin(fmax(t, 0), width);
}

/* Half of the erf difference: the normal mass of an interval around 0 without cancellation. */
static double central_mass(double a, double b)
{
    return (erf(b * M_SQRT1_2) - erf(a * M_SQRT1_2)) / 2;
}

double sg_truncated_unusual_mass(double a, double width)
{
    const double b = a + width;
    return a >= 0 ? mass_above(a, width) : b <= 0 ? mass_above(-b, width) : central_mass(a, b);
}

/* z in [a, b], narrow around 0: the inverse has an absolute error of an ulp of 1; a Newton step makes it relative. */
static double narrow_quantile(double a, double b, double u, double mass)
{
    const double below = sg_normal_above(-a) + u * mass, above = sg_normal_above(b) + (1 - u) * mass;
    const double z = sg_normal_quantile(below, above);
    return z - (central_mass(a, z) - u * mass) * sqrt(2 * M_PI) * exp(z * z / 2);
}

static double distance(double a, double width, double mass, double u)
{
    const double b = a + width;
    if (a >= 0)
        return tail_quantile(a, width, mass, u);
    if (b <= 0)
        return width - (u < 0.01 ? far_quantile(-b, width, mass, u) : tail_quantile(-b, width, mass, 1 - u));
    return narrow_quantile(a, b, u, mass) - a;
}

double sg_truncated_unusual_distance(double a, double width, double u, double *mass)
{
    *mass = sg_truncated_unusual_mass(a, width);
    return u >= 0 ? distance(a, width, *mass, u) : width - distance(-a - width, width, *mass, -u);
}

/* Share of the mass above t, for a >= 0. */
static double share_far(double a, double width, double mass, double t)
{
    return exp(-t * (a + t / 2)) * mass_above(a + t, width - t) / mass;
}

/* The same to an ulp of itself, for a share may be all of it. */
static double all_above(double x)
{
    return x < 1 ? sg_normal_above(x) : erfc(x * M_SQRT1_2) / 2;
}

double sg_truncated_share(double a, double width, double mass, double t)
{
    const double b = a + width, z = a + t;
    if (a >= 0)
        return mass_above(a, t) / mass;
    if (b <= 0)
        return share_far(-b, width, mass, width - t);
    if (mass < SG_TRUNCATED_NARROW)
        return central_mass(a, z) / mass;
    return z < 0 ? (all_above(-z) - sg_normal_above(-a)) / mass : 1 - (all_above(z) - sg_normal_above(b)) / mass;
}

double sg_truncated_share_above(double a, double width, double mass, double t)
{
    return sg_truncated_share(-a - width, width, mass, width - t);
}

double sg_truncated_quantile(double mean, double sd, double low, double high, double u)
{
    const double a = (low - mean) / sd, width = (high - low) / sd;
    double mass = 0;
    const double t = sg_truncated_distance(a, width, sg_truncated_below(a), u, &mass);
    const double x = t < width / 2 ? low + sd * t : high - sd * (width - t);
    return fmin(fmax(x, low), high);
}

double sg_truncated_cdf(double mean, double sd, double low, double high, double x)
{
    if (x <= low)
        return 0;
    if (x >= high)
        return 1;
    const double a = (low - mean) / sd, width = (high - low) / sd, below = sg_truncated_below(a);
    return sg_truncated_share(a, width, sg_truncated_mass(a, width, below), (x - low) / sd);
}

double sg_truncated_log_density(double mean, double sd, double low, double high, double x)
{
    if (!(x >= low && x <= high))
        return -INFINITY;
    const double a = (low - mean) / sd, width = (high - low) / sd;
    const double mass = sg_truncated_mass(a, width, sg_truncated_below(a));
    return sg_truncated_exponent(a, width, (x - low) / sd) - log(mass) - log(sd);
}
