/* SPDX-License-Identifier: GPL-3.0-or-later */
/* normal.h - the standard normal's upper tail and quantile, inlined: draws of sizes ask for one of each a size.
 * GSL and libm know both (gsl_cdf_ugaussian_Pinv, erfc) and are what the tests compare with. In the middle of the
 * distribution these here take half their time, and a chain of dependent sizes waits for each of them in turn; beyond it they
 * leave the work to GSL. bench_derivation prints the difference. */
#ifndef SG_GRAMMAR_NORMAL_H
#define SG_GRAMMAR_NORMAL_H

#include <gsl/gsl_cdf.h>
#include <math.h>

/* Polynomial of degree 7, in an order that keeps the multipliers busy. */
static inline double sg_normal_polynomial(const double c[8], double x)
{
    const double x2 = x * x, x4 = x2 * x2;
    return (c[0] + c[1] * x + (c[2] + c[3] * x) * x2) + (c[4] + c[5] * x + (c[6] + c[7] * x) * x2) * x4;
}

/** Mass above x >= 0, to 3e-16 and, from 2 on, 6e-17: absolute errors, for differences of masses. Beyond 8.3 there is less
 *  than half an ulp of 1, and 0 stands for that. Source: J. F. Hart et al., Computer Approximations (1968), algorithm 5666. */
static inline double sg_normal_above(double x)
{
    static const double numerator[8] = {220.206867912376,   221.213596169931,  112.079291497871,   33.912866078383,
                                        6.37396220353165,   0.700383064443688, 0.0352624965998911, 0};
    static const double denominator[8] = {440.413735824752, 793.826512519948, 637.333633378831, 296.564248779674,
                                          86.7807322029461, 16.064177579207,  1.75566716318264, 0.0883883476483184};
    if (!(x < 8.3))
        return 0;
    return exp(-x * x / 2) * (sg_normal_polynomial(numerator, x) / sg_normal_polynomial(denominator, x));
}

/** The point that has these masses below and above it (> 0, their sum 1): two numbers, so that both tails are exact. As
 *  accurate as GSL's. Source: M. J. Wichura, "Algorithm AS 241: the percentage points of the normal distribution", Applied
 *  Statistics 37 (1988), PPND16. */
static inline double sg_normal_quantile(double below, double above)
{
    static const double a[8] = {3.3871328727963666080e0, 1.3314166789178437745e2, 1.9715909503065514427e3,
                                1.3731693765509461125e4, 4.5921953931549871457e4, 6.7265770927008700853e4,
                                3.3430575583588128105e4, 2.5090809287301226727e3};
    static const double b[8] = {1,
                                4.2313330701600911252e1,
                                6.8718700749205790830e2,
                                5.3941960214247511077e3,
                                2.1213794301586595867e4,
                                3.9307895800092710610e4,
                                2.8729085735721942674e4,
                                5.2264952788528545610e3};
    static const double c[8] = {1.42343711074968357734e0, 4.63033784615654529590e0, 5.76949722146069140550e0,
                                3.64784832476320460504e0, 1.27045825245236838258e0, 2.41780725177450611770e-1,
                                2.27238449892691845833e-2, 7.74545014278341407640e-4};
    static const double d[8] = {1,
                                2.05319162663775882187e0,
                                1.67638483018380384940e0,
                                6.89767334985100004550e-1,
                                1.48103976427480074590e-1,
                                1.51986665636164571966e-2,
                                5.47593808499534494600e-4,
                                1.05075007164441684324e-9};
    const double q = below - 0.5;
    if (fabs(q) <= 0.425) {
        const double r = 0.180625 - q * q;
        return q * (sg_normal_polynomial(a, r) / sg_normal_polynomial(b, r));
    }
    const double tail = q < 0 ? below : above, r = sqrt(-log(tail)) - 1.6;
    const double z = r <= 3.4 ? sg_normal_polynomial(c, r) / sg_normal_polynomial(d, r) : gsl_cdf_ugaussian_Qinv(tail);
    return q < 0 ? -z : z;
}

#endif
