/* SPDX-License-Identifier: GPL-3.0-or-later */
/* distribution.c - draws: uniforms to values and back, densities. */
#include "config.h"

#include "grammar/distribution_priv.h"
#include "grammar/grammar_priv.h"
#include "grammar/normal.h"
#include "grammar/simplex_priv.h"
#include "grammar/truncated.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* In the order of sg_draw_kind. */
static const sg_distribution_info distributions[] = {
    {"uniform", SG_DRAW_UNIFORM, 2, false, "low, high", 1},
    {"normal", SG_DRAW_NORMAL, 2, false, "mean, sd", 1},
    {"truncated_normal", SG_DRAW_TRUNCATED_NORMAL, 4, false, "mean, sd, low, high", 1},
    {"mixture", SG_DRAW_MIXTURE, 3, true, "(weight, mean, sd), ...", 2},
    {"discrete", SG_DRAW_DISCRETE, 2, true, "(weight, value), ...", 1},
};

const sg_distribution_info *sg_distribution_find(const char *name)
{
    for (size_t i = 0; i < sizeof distributions / sizeof *distributions; i++)
        if (strcmp(distributions[i].name, name) == 0)
            return &distributions[i];
    return NULL;
}

const char *sg_distribution_name(sg_draw_kind kind)
{
    for (size_t i = 0; i < sizeof distributions / sizeof *distributions; i++)
        if (distributions[i].kind == kind)
            return distributions[i].name;
    return NULL;
}

/* Weights stand at every stride-th place; the sum must be a positive number. */
static const char *complaint_of_weights(const double *args, uint32_t nargs, uint32_t stride)
{
    double sum = 0;
    for (uint32_t i = 0; i < nargs; i += stride) {
        if (!(args[i] >= 0))
            return "a weight is negative or not a number";
        sum += args[i];
    }
    return sum > 0 && isfinite(sum) ? NULL : "all weights are zero";
}

const char *sg_distribution_complaint(sg_draw_kind kind, const double *args, uint32_t nargs)
{
    static const char *const bad_sd = "the standard deviation must be greater than 0";
    static const char *const bad_interval = "low must be less than high";
    for (uint32_t i = 0; i < nargs; i++)
        if (!isfinite(args[i]))
            return "a parameter is not finite";
    switch (kind) {
    case SG_DRAW_UNIFORM:
        return args[0] < args[1] ? NULL : bad_interval;
    case SG_DRAW_NORMAL:
        return args[1] > 0 ? NULL : bad_sd;
    case SG_DRAW_TRUNCATED_NORMAL:
        return !(args[1] > 0) ? bad_sd : !(args[2] < args[3]) ? bad_interval : NULL;
    case SG_DRAW_MIXTURE:
        for (uint32_t i = 0; i < nargs; i += 3)
            if (!(args[i + 2] > 0))
                return bad_sd;
        return complaint_of_weights(args, nargs, 3);
    case SG_DRAW_DISCRETE:
        return complaint_of_weights(args, nargs, 2);
    case SG_DRAW_SIMPLEX:
        return NULL;
    }
    return "unknown distribution";
}

typedef sg_draw_arguments arguments;

static sg_status evaluate(const sg_grammar *g, const sg_draw *d, const double *frame, double depth, arguments *a,
                          sg_error *err)
{
    a->many = NULL;
    a->n = d->nargs;
    a->v = d->constants;
    if (d->constants != NULL) /* they were looked at when the grammar was made */
        return SG_OK;
    if (d->nargs > SG_DRAW_FEW_ARGUMENTS && (a->many = malloc(d->nargs * sizeof *a->many)) == NULL)
        return SG_FAIL_NOMEM(err);
    double *v = a->many != NULL ? a->many : a->few;
    for (uint32_t i = 0; i < d->nargs; i++)
        v[i] = sg_grammar_eval(g, d->args[i], frame, depth);
    a->v = v;
    const char *complaint = sg_distribution_complaint(d->kind, v, d->nargs);
    if (complaint == NULL)
        return SG_OK;
    free(a->many);
    return SG_FAIL(err, SG_ENUMERIC, "draw%s%s: %s", d->name != NULL ? " " : "", d->name != NULL ? d->name : "",
                   complaint);
}

sg_status sg_draw_evaluate(const sg_grammar *g, const sg_draw *d, const double *frame, double depth, sg_draw_arguments *a,
                           sg_error *err)
{
    return evaluate(g, d, frame, depth, a, err);
}

static double total_weight(const arguments *a, uint32_t stride)
{
    double sum = 0;
    for (uint32_t i = 0; i < a->n; i += stride)
        sum += a->v[i];
    return sum;
}

/* Place of the component in whose share of (0, total) the point u * total lies. */
static uint32_t pick(const arguments *a, uint32_t stride, double u)
{
    double left = u * total_weight(a, stride);
    uint32_t last = 0;
    for (uint32_t i = 0; i < a->n; i += stride) {
        if (!(a->v[i] > 0))
            continue;
        last = i;
        if (left < a->v[i])
            break;
        left -= a->v[i];
    }
    return last;
}

/* The uniform in the middle of a component's share. */
static double middle(const arguments *a, uint32_t stride, uint32_t component)
{
    double before = 0;
    for (uint32_t i = 0; i < component; i += stride)
        before += a->v[i];
    return (before + a->v[component] / 2) / total_weight(a, stride);
}

static double standard_quantile(double u)
{
    return u >= 0 ? sg_normal_quantile(u, 1 - u) : sg_normal_quantile(1 + u, -u);
}

/* The value that uniforms give; no sizes. */
static double transform(const sg_draw *d, const arguments *a, const double *u)
{
    uint32_t i = 0;
    switch (d->kind) {
    case SG_DRAW_UNIFORM:
        return a->v[0] + sg_uniform_plain(u[0]) * (a->v[1] - a->v[0]);
    case SG_DRAW_NORMAL:
        return a->v[0] + a->v[1] * standard_quantile(u[0]);
    case SG_DRAW_TRUNCATED_NORMAL:
        return sg_truncated_quantile(a->v[0], a->v[1], a->v[2], a->v[3], u[0]);
    case SG_DRAW_MIXTURE:
        i = pick(a, 3, sg_uniform_plain(u[0]));
        return a->v[i + 1] + a->v[i + 2] * standard_quantile(u[1]);
    case SG_DRAW_DISCRETE:
        return a->v[pick(a, 2, sg_uniform_plain(u[0])) + 1];
    case SG_DRAW_SIMPLEX:
        break;
    }
    return NAN;
}

sg_status sg_draw_transform(const sg_grammar *g, const sg_draw *d, const double *frame, double depth, const double *u,
                            double *value, sg_error *err)
{
    if (d->kind == SG_DRAW_SIMPLEX) {
        sg_simplex_transform(d->simplex, u, value);
        return SG_OK;
    }
    arguments a;
    SG_TRY(evaluate(g, d, frame, depth, &a, err));
    *value = transform(d, &a, u);
    free(a.many);
    return SG_OK;
}

static double log_normal_density(double x, double mean, double sd)
{
    const double z = (x - mean) / sd;
    return -z * z / 2 - log(2 * M_PI) / 2 - log(sd);
}

/* The component that most probably made x, and the log density of the mixture at x. */
static uint32_t likeliest(const arguments *a, double x, double *log_density)
{
    uint32_t best = 0;
    double highest = -INFINITY, sum = 0;
    const double log_total = log(total_weight(a, 3));
    for (uint32_t i = 0; i < a->n; i += 3) {
        const double l = a->v[i] > 0 ? log(a->v[i]) + log_normal_density(x, a->v[i + 1], a->v[i + 2]) : -INFINITY;
        if (l > highest) {
            best = i;
            sum = sum * exp(highest - l) + 1;
            highest = l;
        } else if (l > -INFINITY) {
            sum += exp(l - highest);
        }
    }
    *log_density = highest > -INFINITY ? highest + log(sum) - log_total : -INFINITY;
    return best;
}

/* Sum of the weights of a discrete value; *component is one that has it. */
static double weight_of(const arguments *a, double x, uint32_t *component)
{
    double sum = 0;
    for (uint32_t i = 0; i < a->n; i += 2)
        if (a->v[i + 1] == x && a->v[i] > 0) {
            *component = i;
            sum += a->v[i];
        }
    return sum;
}

static double inside(double u)
{
    return fmin(fmax(u, 0x1p-1022), 1 - 0x1p-53);
}

/* Uniforms of a value that is in the support; false when it is not. */
static bool invert(const sg_draw *d, const arguments *a, double x, double *u)
{
    uint32_t i = 0;
    double ignored;
    switch (d->kind) {
    case SG_DRAW_UNIFORM:
        u[0] = inside((x - a->v[0]) / (a->v[1] - a->v[0]));
        return x >= a->v[0] && x <= a->v[1];
    case SG_DRAW_NORMAL:
        u[0] = inside(gsl_cdf_ugaussian_P((x - a->v[0]) / a->v[1]));
        return isfinite(x);
    case SG_DRAW_TRUNCATED_NORMAL:
        u[0] = inside(sg_truncated_cdf(a->v[0], a->v[1], a->v[2], a->v[3], x));
        return x >= a->v[2] && x <= a->v[3];
    case SG_DRAW_MIXTURE:
        i = likeliest(a, x, &ignored);
        u[0] = inside(middle(a, 3, i));
        u[1] = inside(gsl_cdf_ugaussian_P((x - a->v[i + 1]) / a->v[i + 2]));
        return isfinite(x);
    case SG_DRAW_DISCRETE:
        if (!(weight_of(a, x, &i) > 0))
            return false;
        u[0] = inside(middle(a, 2, i));
        return true;
    case SG_DRAW_SIMPLEX:
        break;
    }
    return false;
}

sg_status sg_draw_invert(const sg_grammar *g, const sg_draw *d, const double *frame, double depth, const double *value,
                         double *u, sg_error *err)
{
    bool good;
    if (d->kind == SG_DRAW_SIMPLEX) {
        good = sg_simplex_invert(d->simplex, value, u);
    } else {
        arguments a;
        SG_TRY(evaluate(g, d, frame, depth, &a, err));
        good = invert(d, &a, *value, u);
        free(a.many);
    }
    return good ? SG_OK : SG_FAIL(err, SG_ENUMERIC, "a value outside the support of its distribution");
}

static double log_density_of(const sg_draw *d, const arguments *a, double x)
{
    uint32_t i = 0;
    double log_density = NAN;
    switch (d->kind) {
    case SG_DRAW_UNIFORM:
        return x >= a->v[0] && x <= a->v[1] ? -log(a->v[1] - a->v[0]) : -INFINITY;
    case SG_DRAW_NORMAL:
        return log_normal_density(x, a->v[0], a->v[1]);
    case SG_DRAW_TRUNCATED_NORMAL:
        return sg_truncated_log_density(a->v[0], a->v[1], a->v[2], a->v[3], x);
    case SG_DRAW_MIXTURE:
        likeliest(a, x, &log_density);
        break;
    case SG_DRAW_DISCRETE:
        return log(weight_of(a, x, &i) / total_weight(a, 2));
    case SG_DRAW_SIMPLEX:
        break;
    }
    return log_density;
}

sg_status sg_draw_log_density(const sg_grammar *g, const sg_draw *d, const double *frame, double depth,
                              const double *value, double *log_density, sg_error *err)
{
    if (d->kind == SG_DRAW_SIMPLEX) {
        *log_density = sg_simplex_log_density(d->simplex, value);
        return SG_OK;
    }
    arguments a;
    SG_TRY(evaluate(g, d, frame, depth, &a, err));
    *log_density = log_density_of(d, &a, *value);
    free(a.many);
    return SG_OK;
}

sg_status sg_draw_transform_density(const sg_grammar *g, const sg_draw *d, const double *frame, double depth,
                                    const double *u, double *value, double *log_density, sg_error *err)
{
    if (d->kind == SG_DRAW_SIMPLEX) {
        *log_density = sg_simplex_draw(d->simplex, u, value);
        return SG_OK;
    }
    arguments a;
    SG_TRY(evaluate(g, d, frame, depth, &a, err));
    *value = transform(d, &a, u);
    *log_density = log_density_of(d, &a, *value);
    free(a.many);
    return SG_OK;
}
