/* SPDX-License-Identifier: GPL-3.0-or-later */
/* node_draws.c - other draws for one node. */
#include "core/random.h"
#include "derivation/derivation_move.h"
#include "derivation/derivation_priv.h"
#include "grammar/simplex.h"

#include <gsl/gsl_randist.h>
#include <math.h>
#include <string.h>

/* Steps of a shift go down to this share of the largest. */
static const double SMALLEST = 1.0 / 64;

typedef struct {
    const sg_derivation *d;
    const sg_node *n;
    const sg_rule *r;
    uint32_t nparams;
} drawing;

static drawing drawing_at(const sg_derivation *d, size_t node)
{
    const sg_node *n = d->nodes + node;
    return (drawing){d, n, sg_grammar_rule(d->grammar, n->rule), sg_grammar_symbol(d->grammar, n->symbol)->nparams};
}

static void copy_values(double *to, const double *from, size_t n)
{
    if (n > 0)
        memcpy(to, from, n * sizeof *to);
}

/* Uniforms as they are, and the frame with this many of its values. */
static void begin(const drawing *w, size_t nvalues, sg_node_draws *out)
{
    copy_values(out->uniforms, w->d->uniforms + w->n->uniforms, w->r->nuniforms);
    copy_values(out->frame, w->d->values + w->n->values, w->nparams + nvalues);
    out->values = out->frame + w->nparams;
}

static sg_status make_values(const drawing *w, sg_node_draws *out, sg_error *err)
{
    return sg_derivation_transform(w->d->grammar, w->r, w->nparams, w->n->depth, out->uniforms, out->frame, err);
}

static size_t pick_below(double u, size_t n)
{
    const size_t i = (size_t)(u * (double)n);
    return i < n ? i : n - 1;
}

static size_t pick(gsl_rng *rng, size_t n)
{
    return pick_below(sg_random_uniform(rng), n);
}

sg_status sg_node_resample(const sg_derivation *d, size_t node, gsl_rng *rng, sg_node_draws *out, sg_error *err)
{
    const drawing w = drawing_at(d, node);
    begin(&w, 0, out);
    for (uint32_t i = 0; i < w.r->nuniforms; i++)
        out->uniforms[i] = sg_random_uniform(rng);
    return make_values(&w, out, err);
}

/* The real line folded onto (0,1). */
static double reflect(double u)
{
    u = fmod(fabs(u), 2);
    if (u > 1)
        u = 2 - u;
    return fmin(fmax(u, 0x1p-53), 1 - 0x1p-53);
}

sg_status sg_node_reflect(const sg_derivation *d, size_t node, double sd, gsl_rng *rng, sg_node_draws *out, sg_error *err)
{
    const drawing w = drawing_at(d, node);
    begin(&w, 0, out);
    if (w.r->nuniforms > 0) {
        double *u = out->uniforms + pick(rng, w.r->nuniforms);
        *u = reflect(sg_uniform_plain(*u) + gsl_ran_gaussian_ziggurat(rng, sd));
    }
    return make_values(&w, out, err);
}

static size_t boundaries(const sg_draw *draw)
{
    return draw->kind == SG_DRAW_SIMPLEX && draw->nvalues > 1 ? draw->nvalues - 1 : 0;
}

bool sg_rule_has_sizes(const sg_rule *r)
{
    for (uint32_t i = 0; i < r->ndraws; i++)
        if (boundaries(r->draws + i) > 0)
            return true;
    return false;
}

/* The size that loses: the next one, or any behind it. */
static size_t pick_other(size_t size, size_t nsizes, gsl_rng *rng)
{
    const size_t farther = nsizes - size - 2;
    const double u = sg_random_uniform(rng);
    return size + 1 + (farther > 0 && u < 0.5 ? 1 + pick_below(2 * u, farther) : 0);
}

/* What it does to the log density when size `at` grows by a step and size `other` shrinks by it: the sizes are moved. */
static double slide(const sg_simplex *s, double *size, size_t at, size_t other, double step)
{
    const double before = sg_simplex_log_density(s, size);
    size[at] += step;
    size[other] -= step;
    return sg_simplex_log_density(s, size) - before;
}

/* The same for neighbours, where little changes. */
static double shift(const sg_simplex *s, double *size, size_t at, double step)
{
    const double change = sg_simplex_shift(s, size, NULL, at, step, NULL);
    size[at] += step;
    size[at + 1] -= step;
    return change;
}

/* Any boundary of any simplex draw: the draw, and the size in front of it. */
static const sg_draw *pick_boundary(const sg_rule *r, gsl_rng *rng, size_t *size)
{
    size_t n = 0;
    for (uint32_t i = 0; i < r->ndraws; i++)
        n += boundaries(r->draws + i);
    *size = pick(rng, n);
    const sg_draw *draw = r->draws;
    for (; *size >= boundaries(draw); draw++)
        *size -= boundaries(draw);
    return draw;
}

void sg_node_shift(const sg_derivation *d, size_t node, double sd, gsl_rng *rng, sg_node_draws *out,
                        double *d_log_density, bool *inside)
{
    const drawing w = drawing_at(d, node);
    size_t at;
    const sg_draw *draw = pick_boundary(w.r, rng, &at);
    begin(&w, w.r->nvalues, out);
    double *size = out->frame + w.nparams + draw->first_value;
    const double scale = sd * pow(SMALLEST, sg_random_uniform(rng));
    const size_t other = pick_other(at, draw->nvalues, rng);
    const double step = gsl_ran_gaussian_ziggurat(rng, scale * (size[at] + size[other]));
    *d_log_density = other == at + 1 ? shift(draw->simplex, size, at, step) : slide(draw->simplex, size, at, other, step);
    *inside = *d_log_density > -INFINITY && size[draw->nvalues - 1] > 0;
    if (!*inside)
        return;
    if (other == at + 1)
        sg_simplex_invert_shifted(draw->simplex, at, size, NULL, out->uniforms + draw->first_uniform);
    else
        sg_simplex_invert_from(draw->simplex, at, size, NULL, out->uniforms + draw->first_uniform);
}

sg_status sg_node_draws_log_density(const sg_derivation *d, size_t node, const sg_node_draws *draws, double *log_density,
                                    sg_error *err)
{
    const drawing w = drawing_at(d, node);
    return sg_frame_log_density(d->grammar, w.r, w.nparams, w.n->depth, draws->frame, log_density, err);
}
