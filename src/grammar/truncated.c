/* SPDX-License-Identifier: GPL-3.0-or-later */
/* truncated.c - truncated normal through Mills ratios (GSL's hazard function) and erf. */
#include "config.h"

#include "grammar/truncated.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_sf_erf.h>
#include <math.h>
#include <stdbool.h>

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

/* M(a, t) for a >= 0. */
static double mass_above(double a, double t)
{
    const double fall = t * (a + t / 2);
    if (fall < 1)
        return short_mass(a, t);
    const double far = exp(-fall);
    return 1 / gsl_sf_hazard(a) - (far > 0 ? far / gsl_sf_hazard(a + t) : 0);
}

/* t in [0, width] with M(a, t) = u M(a, width): Newton within a bracket. M is increasing and concave in t, so the
 * steps from the left never pass the root, and a few suffice. */
static double tail_quantile(double a, double width, double u)
{
    const double total = mass_above(a, width), target = u * total;
    double low = 0, high = width;
    double t = a > 0 ? -log1p(-u * -expm1(-a * width)) / a : u * width;
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
        if (!(fabs(step) > 2e-16 * t))
            break;
    }
    return fmin(fmax(t, 0), width);
}

/* Half of the erf difference: the normal mass of an interval around 0 without cancellation. */
static double central_mass(double a, double b)
{
    return (erf(b * M_SQRT1_2) - erf(a * M_SQRT1_2)) / 2;
}

static double central_quantile(double a, double b, double u)
{
    const double total = central_mass(a, b);
    const double below = gsl_cdf_ugaussian_P(a) + u * total;
    double z = below < 0.5 ? gsl_cdf_ugaussian_Pinv(below)
                           : gsl_cdf_ugaussian_Qinv(gsl_cdf_ugaussian_Q(b) + (1 - u) * total);
    /* In the middle the inverse above has an absolute error of an ulp of 1; one Newton step makes it relative. */
    if (fabs(z) < 2)
        z -= (central_mass(a, z) - u * total) * sqrt(2 * M_PI) * exp(z * z / 2);
    return fmin(fmax(z, a), b);
}

double sg_truncated_quantile(double mean, double sd, double low, double high, double u)
{
    const double a = (low - mean) / sd, b = (high - mean) / sd, width = (high - low) / sd;
    double x;
    if (a >= 0)
        x = low + sd * tail_quantile(a, width, u);
    else if (b <= 0)
        x = high - sd * tail_quantile(-b, width, 1 - u);
    else
        x = mean + sd * central_quantile(a, b, u);
    return fmin(fmax(x, low), high);
}

double sg_truncated_cdf(double mean, double sd, double low, double high, double x)
{
    if (x <= low)
        return 0;
    if (x >= high)
        return 1;
    const double a = (low - mean) / sd, b = (high - mean) / sd, width = (high - low) / sd;
    if (a >= 0)
        return mass_above(a, (x - low) / sd) / mass_above(a, width);
    if (b <= 0)
        return 1 - mass_above(-b, (high - x) / sd) / mass_above(-b, width);
    return central_mass(a, (x - mean) / sd) / central_mass(a, b);
}

double sg_truncated_log_density(double mean, double sd, double low, double high, double x)
{
    if (!(x >= low && x <= high))
        return -INFINITY;
    const double a = (low - mean) / sd, b = (high - mean) / sd, width = (high - low) / sd;
    if (a >= 0) {
        const double t = (x - low) / sd;
        return -t * (a + t / 2) - log(mass_above(a, width)) - log(sd);
    }
    if (b <= 0) {
        const double t = (high - x) / sd;
        return -t * (t / 2 - b) - log(mass_above(-b, width)) - log(sd);
    }
    const double z = (x - mean) / sd;
    return -z * z / 2 - log(2 * M_PI) / 2 - log(central_mass(a, b)) - log(sd);
}
