/* SPDX-License-Identifier: GPL-3.0-or-later */
/* build_draw.c - draws: checked, compiled, added to the list of their rule. */
#include "config.h"

#include "core/array.h"
#include "grammar/build_priv.h"
#include "grammar/distribution_priv.h"
#include "grammar/simplex_priv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FAIL(b, where, ...) sg_source_fail((b)->source, (where), (b)->err, __VA_ARGS__)

static sg_status bad_arity(sg_builder *b, const sg_ast_expr *call, const sg_distribution_info *info)
{
    return FAIL(b, call->at, "expected %s(%s)", info->name, info->args);
}

/* Arguments without their tuples, compiled into args, which has room for all. */
static sg_status compile_args(sg_builder *b, const sg_scope *scope, const sg_ast_expr *call,
                              const sg_distribution_info *info, sg_expr *args)
{
    uint32_t n = 0;
    for (const sg_ast_expr *a = call->args; a != NULL; a = a->next) {
        if (!info->tuples) {
            SG_TRY(sg_build_expr(b, scope, a, &args[n++]));
            continue;
        }
        if (a->kind != SG_AST_TUPLE || a->nargs != info->nargs)
            return bad_arity(b, call, info);
        for (const sg_ast_expr *x = a->args; x != NULL; x = x->next)
            SG_TRY(sg_build_expr(b, scope, x, &args[n++]));
    }
    return SG_OK;
}

/* What can be said without a frame is said now. constants: out, the parameters when none depends on a frame, else NULL */
static sg_status check_constant(sg_builder *b, const sg_ast_expr *call, sg_draw_kind kind, const sg_expr *args,
                                uint32_t n, const double **constants)
{
    double *v = SG_NEW_ARRAY(b->arena, double, n);
    if (v == NULL)
        return sg_build_fail_nomem(b);
    *constants = NULL;
    for (uint32_t i = 0; i < n; i++)
        if (!sg_build_is_constant(b, args[i], &v[i]))
            return SG_OK;
    const char *complaint = sg_distribution_complaint(kind, v, n);
    if (complaint != NULL)
        return FAIL(b, call->at, "%s: %s", call->name, complaint);
    *constants = v;
    return SG_OK;
}

static sg_status add_draw(sg_builder *b, const sg_scope *scope, sg_draw d, uint32_t *slot)
{
    sg_draw_list *list = scope->draws;
    if (!SG_GROW(list->draws, list->capacity, list->n + 1))
        return sg_build_fail_nomem(b);
    d.first_uniform = list->nuniforms;
    d.first_value = list->nvalues;
    list->nuniforms += d.nuniforms;
    list->nvalues += d.nvalues;
    list->draws[list->n++] = d;
    *slot = scope->nparams + d.first_value;
    return SG_OK;
}

sg_status sg_build_draw(sg_builder *b, const sg_scope *scope, const sg_ast_expr *call, const char *name,
                        uint32_t *slot)
{
    const sg_distribution_info *info = sg_distribution_find(call->name);
    if (info == NULL)
        return FAIL(b, call->at, "unknown function or distribution '%.60s' in %s", call->name, scope->what);
    if (scope->draws == NULL)
        return FAIL(b, call->at, "a random draw in %s; draws belong into bodies", scope->what);
    if (scope->draws->n >= SG_MAX_DRAWS)
        return FAIL(b, call->at, "more than %d draws in a rule", SG_MAX_DRAWS);
    if (info->tuples ? call->nargs == 0 : call->nargs != info->nargs)
        return bad_arity(b, call, info);
    const uint32_t n = info->tuples ? call->nargs * info->nargs : call->nargs;
    sg_expr *args = SG_NEW_ARRAY(b->arena, sg_expr, n);
    if (args == NULL)
        return sg_build_fail_nomem(b);
    SG_TRY(compile_args(b, scope, call, info, args));
    sg_draw d = {.kind = info->kind, .name = name, .nargs = n, .args = args, .nuniforms = info->nuniforms, .nvalues = 1};
    SG_TRY(check_constant(b, call, info->kind, args, n, &d.constants));
    return add_draw(b, scope, d, slot);
}

static sg_status check_rows(sg_builder *b, const sg_ast_matrix *m, size_t k, const char *what)
{
    if (m->columns != k)
        return FAIL(b, m->at, "%s with %zu sizes for a split of %zu parts", what, m->columns, k);
    for (size_t r = 0; r < m->rows; r++) {
        double sum = 0;
        for (size_t c = 0; c < k; c++) {
            const double v = m->values[r * k + c];
            if (!(v >= 0 && v <= 1 + 1e-6))
                return FAIL(b, m->at, "%s: size %g is not between 0 and 1", what, v);
            sum += v;
        }
        if (!(fabs(sum - 1) <= 1e-6))
            return FAIL(b, m->at, "%s: sizes that sum to %.9g, not to 1", what, sum);
    }
    return SG_OK;
}

static sg_status check_mean(sg_builder *b, const sg_ast_matrix *m, size_t k)
{
    double sum = 0;
    if (m->columns != k)
        return FAIL(b, m->at, "a mean with %zu sizes for a split of %zu parts", m->columns, k);
    for (size_t i = 0; i < k; i++)
        sum += m->values[i];
    return fabs(sum - 1) <= 1e-6 ? SG_OK : FAIL(b, m->at, "a mean whose sizes sum to %.9g, not to 1", sum);
}

static sg_status check_covariance(sg_builder *b, const sg_ast_matrix *m, size_t k)
{
    const size_t n = k - 1;
    if (n == 0 ? m->n != 0 : m->rows != n || m->columns != n)
        return FAIL(b, m->at, "a covariance of %zu rows and %zu columns; expected %zu of each, one less than parts",
                    m->rows, m->columns, n);
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < i; j++) {
            const double x = m->values[i * n + j], y = m->values[j * n + i];
            if (!(fabs(x - y) <= 1e-9 * fmax(fabs(x), fabs(y))))
                return FAIL(b, m->at, "the covariance is not symmetric: %g and %g", y, x);
        }
    return SG_OK;
}

/* Independent normals with these standard deviations, given that they sum to 1: D - d d' / sum d over the first k-1. */
static sg_status covariance_of_sd(sg_builder *b, const sg_ast_matrix *sd, size_t k, double *covariance)
{
    double total = 0;
    if (sd->columns != k)
        return FAIL(b, sd->at, "%zu standard deviations for a split of %zu parts", sd->columns, k);
    for (size_t i = 0; i < k; i++) {
        if (!(sd->values[i] > 0 && isfinite(sd->values[i] * sd->values[i])))
            return FAIL(b, sd->at, "standard deviation %g; expected a number greater than 0", sd->values[i]);
        total += sd->values[i] * sd->values[i];
    }
    for (size_t i = 0; i + 1 < k; i++)
        for (size_t j = 0; j + 1 < k; j++) {
            const double x = sd->values[i] * sd->values[i], y = sd->values[j] * sd->values[j];
            covariance[i * (k - 1) + j] = (i == j ? x : 0) - x * y / total;
        }
    return SG_OK;
}

static sg_status check_sizes(sg_builder *b, const sg_ast_sizes *s, size_t k)
{
    if (s->examples != NULL && s->examples->rows > 0)
        SG_TRY(check_rows(b, s->examples, k, "an example"));
    if (s->mean == NULL)
        return s->covariance == NULL && s->sd == NULL
                   ? SG_OK
                   : FAIL(b, s->at, "a spread of sizes without their mean; expected 'mean'");
    if ((s->covariance == NULL) == (s->sd == NULL))
        return FAIL(b, s->at, "expected 'covariance' or 'sd' with the mean, one of them");
    SG_TRY(check_mean(b, s->mean, k));
    return s->covariance != NULL ? check_covariance(b, s->covariance, k) : SG_OK;
}

sg_status sg_build_simplex(sg_builder *b, const sg_scope *scope, const sg_ast_sizes *sizes, size_t nparts,
                           uint32_t *draw)
{
    if (nparts > SG_MAX_SIZES)
        return FAIL(b, sizes->at, "sizes for %zu parts; they can be drawn for at most %d", nparts, SG_MAX_SIZES);
    SG_TRY(check_sizes(b, sizes, nparts));
    if (sizes->mean == NULL)
        return SG_OK;
    const size_t n = nparts - 1;
    double *covariance = sizes->covariance != NULL ? sizes->covariance->values : SG_NEW_ARRAY(b->arena, double, n * n);
    if (covariance == NULL && n > 0)
        return sg_build_fail_nomem(b);
    if (sizes->sd != NULL)
        SG_TRY(covariance_of_sd(b, sizes->sd, nparts, covariance));
    sg_draw d = {.kind = SG_DRAW_SIMPLEX, .nuniforms = (uint32_t)n, .nvalues = (uint32_t)nparts};
    const sg_status st = sg_simplex_create(b->arena, nparts, sizes->mean->values, covariance, &d.simplex, b->err);
    if (st == SG_ENUMERIC)
        return FAIL(b, sizes->at, "the covariance of the sizes is not positive definite");
    SG_TRY(st);
    uint32_t slot = 0;
    *draw = (uint32_t)scope->draws->n;
    return add_draw(b, scope, d, &slot);
}
