/* SPDX-License-Identifier: GPL-3.0-or-later */
/* draw_condition.c - uniforms of a draw given its value, and what to say of a value that it cannot have. */
#include "config.h"

#include "grammar/distribution_priv.h"
#include "grammar/grammar.h"
#include "grammar/simplex.h"
#include "grammar/truncated.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LEAST 0x1p-1022
static const double NEAR = 1e-9; /* derivations are checked to this */

static double limited(double u)
{
    return fmin(fmax(u, LEAST), 1 - 0x1p-53);
}

/* The form of distribution.h: near 1 the distance from it. */
static double uniform_of(double below, double above)
{
    return below <= 1 - 1e-6 ? fmax(below, LEAST) : -fmax(above, LEAST);
}

static double normal_uniform(double z)
{
    return uniform_of(gsl_cdf_ugaussian_P(z), gsl_cdf_ugaussian_Q(z));
}

static double truncated_uniform(const double *v, double x)
{
    return uniform_of(sg_truncated_cdf(v[0], v[1], v[2], v[3], x), sg_truncated_cdf(-v[0], v[1], -v[3], -v[2], -x));
}

/* Log of weight times likelihood of a component at x, -INFINITY when it cannot be the one. */
static double component_score(const sg_draw *d, const double *c, double x)
{
    if (!(c[0] > 0))
        return -INFINITY;
    if (d->kind == SG_DRAW_DISCRETE)
        return c[1] == x ? log(c[0]) : -INFINITY;
    const double z = (x - c[1]) / c[2];
    return log(c[0]) - log(c[2]) - z * z / 2;
}

/* Draw a component from its posterior by *u, which becomes a uniform of the prior: what is left of it says where in the
 * component's share. @return its first parameter, or a->n when none can be the one */
static uint32_t draw_component(const sg_draw *d, const sg_draw_arguments *a, double x, double *u)
{
    const uint32_t stride = d->kind == SG_DRAW_DISCRETE ? 2 : 3;
    double highest = -INFINITY, sum = 0, total = 0, before = 0;
    for (uint32_t i = 0; i < a->n; i += stride)
        highest = fmax(highest, component_score(d, a->v + i, x));
    if (!(highest > -INFINITY))
        return a->n;
    for (uint32_t i = 0; i < a->n; i += stride) {
        sum += exp(component_score(d, a->v + i, x) - highest);
        total += a->v[i];
    }
    double left = sg_uniform_plain(*u) * sum;
    uint32_t chosen = 0;
    double share = 0, chosen_before = 0;
    for (uint32_t i = 0; i < a->n; i += stride) {
        const double p = exp(component_score(d, a->v + i, x) - highest);
        if (p > 0) {
            chosen = i;
            chosen_before = before;
            share = fmin(left / p, 1);
            if (left < p)
                break;
            left -= p;
        }
        before += a->v[i];
    }
    /* Away from the ends, where rounding would make it the neighbour's. */
    share = fmin(fmax(share, 1e-9), 1 - 1e-9);
    *u = limited((chosen_before + share * a->v[chosen]) / total);
    return chosen;
}

/* @return false when x is outside of the support */
static bool condition(const sg_draw *d, const sg_draw_arguments *a, double x, double *u)
{
    uint32_t i = 0;
    if (!isfinite(x))
        return false;
    switch (d->kind) {
    case SG_DRAW_UNIFORM:
        u[0] = limited((x - a->v[0]) / (a->v[1] - a->v[0]));
        return x >= a->v[0] && x <= a->v[1];
    case SG_DRAW_NORMAL:
        u[0] = normal_uniform((x - a->v[0]) / a->v[1]);
        return true;
    case SG_DRAW_TRUNCATED_NORMAL:
        u[0] = truncated_uniform(a->v, x);
        return x >= a->v[2] && x <= a->v[3];
    case SG_DRAW_MIXTURE:
        i = draw_component(d, a, x, u);
        if (i < a->n)
            u[1] = normal_uniform((x - a->v[i + 1]) / a->v[i + 2]);
        return i < a->n;
    case SG_DRAW_DISCRETE:
        return draw_component(d, a, x, u) < a->n;
    case SG_DRAW_SIMPLEX:
        break;
    }
    return false;
}

/* The support in words, of a discrete draw its first few values. */
static void describe(const sg_draw *d, const sg_draw_arguments *a, char *text, size_t size)
{
    enum { SHOWN = 12 };
    size_t n = 0;
    switch (d->kind) {
    case SG_DRAW_UNIFORM:
        snprintf(text, size, "from %.9g to %.9g", a->v[0], a->v[1]);
        return;
    case SG_DRAW_TRUNCATED_NORMAL:
        snprintf(text, size, "from %.9g to %.9g", a->v[2], a->v[3]);
        return;
    case SG_DRAW_DISCRETE:
        text[0] = '\0';
        for (uint32_t i = 0; i < a->n && n < size; i += 2) {
            if (!(a->v[i] > 0))
                continue;
            if (i / 2 == SHOWN) {
                snprintf(text + n, size - n, ", ...");
                return;
            }
            n += (size_t)snprintf(text + n, size - n, "%s%.9g", n > 0 ? ", " : "", a->v[i + 1]);
        }
        return;
    case SG_DRAW_NORMAL:
    case SG_DRAW_MIXTURE:
    case SG_DRAW_SIMPLEX:
        break;
    }
    snprintf(text, size, "all finite numbers");
}

static bool near_to(double a, double b)
{
    return fabs(a - b) <= NEAR * (1 + fabs(b));
}

/* Look among the neighbours of a uniform for one that gives x and no other double. */
static sg_status sharpen(const sg_grammar *g, const sg_draw *d, const double *frame, double depth, double x, double *u,
                         double *made, sg_error *err)
{
    enum { STEPS = 6 };
    double *const last = u + d->nuniforms - 1, found = *last;
    SG_TRY(sg_draw_transform(g, d, frame, depth, u, made, err));
    for (int way = 0; way < 2 && *made != x; way++) {
        *last = found;
        for (int i = 0; i < STEPS; i++) {
            const double next = nextafter(*last, way == 0 ? 2 : -2), plain = sg_uniform_plain(next);
            if (!(plain > 0 && plain < 1 && next < 1 && (next > 0) == (found > 0)))
                break;
            double value;
            *last = next;
            SG_TRY(sg_draw_transform(g, d, frame, depth, u, &value, err));
            if (value == x) {
                *made = x;
                return SG_OK;
            }
        }
    }
    if (*made != x)
        *last = found;
    return SG_OK;
}

static sg_status condition_sizes(const sg_draw *d, const double *value, double *u, sg_error *err)
{
    const uint32_t k = d->nvalues;
    double sum = 0;
    bool good = true;
    for (uint32_t i = 0; i < k; i++) {
        good = good && value[i] > 0;
        sum += value[i];
    }
    if (!good || !(fabs(sum - 1) <= 1e-6) || !sg_simplex_invert(d->simplex, value, u))
        return SG_FAIL(err, SG_ENUMERIC, "these are no %u sizes greater than 0 that sum to 1", (unsigned)k);
    double *made = malloc(k * sizeof *made);
    if (made == NULL)
        return SG_FAIL_NOMEM(err);
    sg_simplex_transform(d->simplex, u, made);
    for (uint32_t i = 0; i + 1 < k; i++)
        good = good && near_to(made[i], value[i]);
    free(made);
    return good ? SG_OK : SG_FAIL(err, SG_ENUMERIC, "these sizes are too far in a tail of their distribution");
}

sg_status sg_draw_condition(const sg_grammar *g, const sg_draw *d, const double *frame, double depth, const double *value,
                            double *u, sg_error *err)
{
    if (d->kind == SG_DRAW_SIMPLEX)
        return condition_sizes(d, value, u, err);
    sg_draw_arguments a;
    SG_TRY(sg_draw_evaluate(g, d, frame, depth, &a, err));
    const bool good = condition(d, &a, *value, u);
    char support[400];
    describe(d, &a, support, sizeof support);
    free(a.many);
    const char *kind = sg_distribution_name(d->kind);
    if (!good)
        return SG_FAIL(err, SG_ENUMERIC, "%.9g is outside of the support of this %s: %s", *value, kind, support);
    double made;
    SG_TRY(sharpen(g, d, frame, depth, *value, u, &made, err));
    return near_to(made, *value) ? SG_OK
                                 : SG_FAIL(err, SG_ENUMERIC, "%.9g is too far in a tail of this %s", *value, kind);
}
