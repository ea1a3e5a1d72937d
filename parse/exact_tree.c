/* SPDX-License-Identifier: GPL-3.0-or-later */
/* exact_tree.c - from the tree of a parse to a derivation of the grammar: sizes from lines, and siblings tied. */
#include "core/random.h"
#include "parse/exact_priv.h"
#include "scene/label_scene.h"

#include <math.h>
#include <stdlib.h>

/* ---- from the parse ---- */

typedef struct {
    const sg_split_form *form;
    const sg_parse_node *nodes;
    const sg_exact_lines *lines;
    sg_arena *arena;
} builder;

static void sizes_of(const builder *b, size_t node, sg_exact_node *out)
{
    const sg_parse_node *n = b->nodes + node;
    const bool x = out->rule->op == SG_SPLIT_X;
    const uint32_t *line = x ? b->lines->x : b->lines->y;
    const double extent = x ? line[n->x1] - line[n->x0] : line[n->y1] - line[n->y0];
    size_t child = node + 1;
    for (uint32_t i = 0; i < out->rule->n; i++, child += b->nodes[child].length) {
        const sg_parse_node *c = b->nodes + child;
        out->sizes[i] = (x ? line[c->x1] - line[c->x0] : line[c->y1] - line[c->y0]) / extent;
    }
}

static sg_status build(const builder *b, size_t node, sg_exact_node **out, sg_error *err)
{
    sg_exact_node *e = SG_NEW(b->arena, sg_exact_node);
    if (e == NULL)
        return SG_FAIL_NOMEM(err);
    *out = e;
    e->rule = &b->form->rules[b->nodes[node].rule];
    if (e->rule->op == SG_SPLIT_LEXICAL)
        return SG_OK;
    e->sizes = SG_NEW_ARRAY(b->arena, double, e->rule->n);
    e->children = SG_NEW_ARRAY(b->arena, sg_exact_node *, e->rule->n);
    if (e->sizes == NULL || e->children == NULL)
        return SG_FAIL_NOMEM(err);
    sizes_of(b, node, e);
    size_t child = node + 1;
    for (uint32_t i = 0; i < e->rule->n; i++, child += b->nodes[child].length)
        SG_TRY(build(b, child, &e->children[i], err));
    return SG_OK;
}

sg_status sg_exact_tree_create(const sg_split_form *form, const sg_parse_node *nodes, const sg_exact_lines *lines,
                               sg_arena *arena, sg_exact_node **out, sg_error *err)
{
    const builder b = {form, nodes, lines, arena};
    return build(&b, 0, out, err);
}

/* ---- ties ---- */

typedef struct {
    double x0, y0, x1, y1; /* px */
} place;

static place part_of(const sg_exact_node *e, uint32_t i, place at)
{
    const bool x = e->rule->op == SG_SPLIT_X;
    const double start = x ? at.x0 : at.y0, length = x ? at.x1 - at.x0 : at.y1 - at.y0;
    double low = 0;
    for (uint32_t j = 0; j < i; j++)
        low += e->sizes[j];
    const double from = start + low * length, to = start + (low + e->sizes[i]) * length;
    return x ? (place){from, at.y0, to, at.y1} : (place){at.x0, from, at.x1, to};
}

static double image_energy(const sg_exact_node *e, const sg_exact_costs *c, place at)
{
    if (e->rule->op == SG_SPLIT_LEXICAL) {
        const double w = (double)c->width, h = (double)c->height;
        return sg_exact_cost(c, e->rule->rhs[0], sg_label_scene_pixel(at.x0, w, c->width),
                             sg_label_scene_pixel(at.y0, h, c->height), sg_label_scene_pixel(at.x1, w, c->width),
                             sg_label_scene_pixel(at.y1, h, c->height));
    }
    double sum = 0;
    for (uint32_t i = 0; i < e->rule->n; i++)
        sum += image_energy(e->children[i], c, part_of(e, i, at));
    return sum;
}

/* Equal siblings are derived once. */
static bool is_repeated(const sg_split_rule *r, uint32_t i)
{
    for (uint32_t j = 0; j < i; j++)
        if (r->rhs[j] == r->rhs[i])
            return true;
    return false;
}

static double rule_energy(const sg_exact_node *e)
{
    double sum = -log(e->rule->probability);
    for (uint32_t i = 0; e->rule->op != SG_SPLIT_LEXICAL && i < e->rule->n; i++)
        if (!is_repeated(e->rule, i))
            sum += rule_energy(e->children[i]);
    return sum;
}

static double shared_energy(const sg_exact_node *e, uint32_t child, uint32_t symbol, const sg_exact_costs *c, place at)
{
    double sum = rule_energy(e->children[child]);
    for (uint32_t i = 0; i < e->rule->n; i++)
        if (e->rule->rhs[i] == symbol)
            sum += image_energy(e->children[child], c, part_of(e, i, at));
    return sum;
}

static void share(sg_exact_node *e, uint32_t symbol, const sg_exact_costs *c, place at)
{
    sg_exact_node *best = NULL;
    double least = INFINITY;
    for (uint32_t i = 0; i < e->rule->n; i++) {
        if (e->rule->rhs[i] != symbol)
            continue;
        const double energy = shared_energy(e, i, symbol, c, at);
        if (best == NULL || energy < least) {
            best = e->children[i];
            least = energy;
        }
    }
    for (uint32_t i = 0; i < e->rule->n; i++)
        if (e->rule->rhs[i] == symbol)
            e->children[i] = best;
}

static void tie(sg_exact_node *e, const sg_exact_costs *c, place at)
{
    if (e->rule->op == SG_SPLIT_LEXICAL)
        return;
    for (uint32_t i = 0; i < e->rule->n; i++)
        tie(e->children[i], c, part_of(e, i, at));
    for (uint32_t i = 0; i < e->rule->n; i++)
        if (!is_repeated(e->rule, i))
            share(e, e->rule->rhs[i], c, at);
}

void sg_exact_tree_tie(sg_exact_node *root, const sg_exact_costs *costs)
{
    tie(root, costs, (place){0, 0, (double)costs->width, (double)costs->height});
}

/* ---- to a derivation ---- */

/* Size j became `got`: the next one makes up for it, so that the cuts behind it stand where they should, or, where it
 * would all but vanish, all that follow do. */
static void make_up(double *value, uint32_t n, uint32_t j, double got)
{
    const double lack = value[j] - got;
    double rest = 0;
    for (uint32_t i = j + 1; i < n; i++)
        rest += value[i];
    value[j] = got;
    if (value[j + 1] + lack > value[j + 1] / 4) {
        value[j + 1] += lack;
        return;
    }
    for (uint32_t i = j + 1; i < n; i++)
        value[i] *= (rest + lack) / rest;
}

/* Uniforms of the sizes, and the sizes that they make. In the far tails of a normal no uniform tells one size from the
 * next: then they end short of what is wanted, about eight standard deviations out. */
static sg_status set_sizes(sg_derivation *d, size_t node, const sg_exact_node *e, double *got, sg_error *err)
{
    const sg_rule *r = sg_grammar_rule(d->grammar, e->rule->source);
    if (r->ndraws == 0)
        return SG_OK;
    const sg_node *at = d->nodes + node;
    const uint32_t n = e->rule->n;
    const double *frame = d->values + at->values;
    double *value = d->values + at->values + r->draws[0].first_value;
    double *u = d->uniforms + at->uniforms + r->draws[0].first_uniform;
    for (uint32_t i = 0; i < n; i++)
        value[i] = e->sizes[e->rule->op == SG_SPLIT_Y ? n - 1 - i : i];
    for (uint32_t j = 0; j + 1 < n; j++) {
        SG_TRY(sg_draw_invert(d->grammar, &r->draws[0], frame, at->depth, value, u, err));
        SG_TRY(sg_draw_transform(d->grammar, &r->draws[0], frame, at->depth, u, got, err));
        if (fabs(got[j] - value[j]) > 1e-9)
            make_up(value, n, j, got[j]);
    }
    return sg_draw_transform(d->grammar, &r->draws[0], frame, at->depth, u, value, err);
}

/* Stored children in the order of the body, which cuts bottom to top. */
static sg_status expand(sg_derivation *d, size_t node, const sg_exact_node *e, gsl_rng *rng, double *work,
                        sg_error *err)
{
    SG_TRY(sg_derivation_expand(d, node, e->rule->source, rng, err));
    if (e->rule->op == SG_SPLIT_LEXICAL)
        return SG_OK;
    SG_TRY(set_sizes(d, node, e, work, err));
    const uint32_t n = e->rule->n;
    const bool tied = sg_grammar_tied(d->grammar);
    size_t child = node + 1;
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t part = e->rule->op == SG_SPLIT_Y ? n - 1 - i : i;
        bool stored = true;
        for (uint32_t j = 0; tied && j < i; j++)
            stored = stored && e->rule->rhs[e->rule->op == SG_SPLIT_Y ? n - 1 - j : j] != e->rule->rhs[part];
        if (!stored)
            continue;
        SG_TRY(expand(d, child, e->children[part], rng, work, err));
        child += d->nodes[child].length;
    }
    return SG_OK;
}

sg_status sg_exact_tree_derivation(const sg_exact_node *root, const sg_grammar *g, sg_derivation *out, sg_error *err)
{
    gsl_rng *rng = sg_random_create(1); /* for uniforms that are then replaced */
    double *work = calloc(sg_grammar_frame_size(g) + 1, sizeof *work);
    sg_status st = rng != NULL && work != NULL ? SG_OK : SG_FAIL_NOMEM(err);
    if (st == SG_OK)
        st = sg_derivation_open(out, sg_grammar_start(g), sg_grammar_start_args(g), 0, err);
    if (st == SG_OK)
        st = expand(out, 0, root, rng, work, err);
    free(work);
    gsl_rng_free(rng);
    return st;
}
