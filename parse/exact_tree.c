/* SPDX-License-Identifier: GPL-3.0-or-later */
/* exact_tree.c - from the tree of a parse to a derivation of the grammar: sizes from lines, and siblings tied. */
#include "core/random.h"
#include "parse/exact_priv.h"
#include "scene/label_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

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

sg_exact_node *sg_exact_node_create(const sg_split_rule *rule, sg_arena *arena)
{
    sg_exact_node *e = SG_NEW(arena, sg_exact_node);
    if (e == NULL)
        return NULL;
    e->rule = rule;
    if (rule->op == SG_SPLIT_LEXICAL)
        return e;
    e->sizes = SG_NEW_ARRAY(arena, double, rule->n);
    e->children = SG_NEW_ARRAY(arena, sg_exact_node *, rule->n);
    return e->sizes != NULL && e->children != NULL ? e : NULL;
}

static sg_status build(const builder *b, size_t node, sg_exact_node **out, sg_error *err)
{
    sg_exact_node *e = sg_exact_node_create(&b->form->rules[b->nodes[node].rule], b->arena);
    if (e == NULL)
        return SG_FAIL_NOMEM(err);
    *out = e;
    if (e->rule->op == SG_SPLIT_LEXICAL)
        return SG_OK;
    sizes_of(b, node, e);
    size_t child = node + 1;
    for (uint32_t i = 0; i < e->rule->n; i++, child += b->nodes[child].length)
        SG_TRY(build(b, child, &e->children[i], err));
    return SG_OK;
}

sg_status sg_exact_tree_create(const sg_exact_problem *p, const sg_parse_node *nodes, const sg_exact_lines *lines,
                               sg_arena *arena, sg_exact_node **out, sg_error *err)
{
    const builder b = {&p->form, nodes, lines, arena};
    return build(&b, 0, out, err);
}

sg_exact_node *sg_exact_tree_copy(const sg_exact_node *e, sg_arena *arena)
{
    sg_exact_node *copy = sg_exact_node_create(e->rule, arena);
    if (copy == NULL || e->rule->op == SG_SPLIT_LEXICAL)
        return copy;
    memcpy(copy->sizes, e->sizes, e->rule->n * sizeof *e->sizes);
    for (uint32_t i = 0; i < e->rule->n; i++) {
        for (uint32_t j = 0; j < i && copy->children[i] == NULL; j++)
            if (e->children[j] == e->children[i])
                copy->children[i] = copy->children[j];
        if (copy->children[i] == NULL && (copy->children[i] = sg_exact_tree_copy(e->children[i], arena)) == NULL)
            return NULL;
    }
    return copy;
}

/* ---- energies ---- */

uint32_t sg_exact_first(const sg_exact_problem *p, const sg_split_rule *r, uint32_t i)
{
    for (uint32_t j = 0; p->form.tied && j < i; j++)
        if (r->rhs[j] == r->rhs[i])
            return j;
    return i;
}

double sg_exact_leaf_energy(const sg_exact_problem *p, uint32_t terminal, sg_exact_place at)
{
    const sg_exact_costs *c = &p->costs;
    const double w = (double)c->width, h = (double)c->height;
    return sg_exact_cost(c, terminal, sg_label_scene_pixel(at.x0, w, c->width),
                         sg_label_scene_pixel(at.y0, h, c->height), sg_label_scene_pixel(at.x1, w, c->width),
                         sg_label_scene_pixel(at.y1, h, c->height));
}

double sg_exact_image_energy(const sg_exact_problem *p, const sg_exact_node *e, sg_exact_place at)
{
    if (e->rule->op == SG_SPLIT_LEXICAL)
        return sg_exact_leaf_energy(p, e->rule->rhs[0], at);
    double sum = 0, from = 0;
    for (uint32_t i = 0; i < e->rule->n; i++) {
        const double to = i + 1 == e->rule->n ? 1 : from + e->sizes[i];
        sum += sg_exact_image_energy(p, e->children[i], sg_exact_part(e->rule, at, from, to));
        from = to;
    }
    return sum;
}

/* The language cuts y from the bottom. */
static void body_order(const sg_split_rule *r, const double *sizes, double *out)
{
    for (uint32_t i = 0; i < r->n; i++)
        out[i] = sizes[r->op == SG_SPLIT_Y ? r->n - 1 - i : i];
}

double sg_exact_size_energy(const sg_exact_problem *p, const sg_split_rule *r, const double *sizes, double *work)
{
    const sg_rule *rule = sg_grammar_rule(p->g, r->source);
    double log_density = 0;
    if (rule->ndraws == 0)
        return 0;
    body_order(r, sizes, work);
    if (sg_draw_log_density(p->g, &rule->draws[0], NULL, 0, work, &log_density, NULL) != SG_OK)
        return INFINITY;
    return -log_density;
}

static double own_energy(const sg_exact_problem *p, const sg_exact_node *e, double *work)
{
    double sum = -log(e->rule->probability);
    if (e->rule->op == SG_SPLIT_LEXICAL)
        return sum;
    sum += sg_exact_size_energy(p, e->rule, e->sizes, work);
    for (uint32_t i = 0; i < e->rule->n; i++)
        if (sg_exact_first(p, e->rule, i) == i)
            sum += own_energy(p, e->children[i], work);
    return sum;
}

double sg_exact_energy(const sg_exact_problem *p, const sg_exact_node *root, double *work)
{
    return sg_exact_image_energy(p, root, sg_exact_whole(p)) + own_energy(p, root, work);
}

/* ---- ties ---- */

static double rule_energy(const sg_exact_problem *p, const sg_exact_node *e)
{
    double sum = -log(e->rule->probability);
    for (uint32_t i = 0; e->rule->op != SG_SPLIT_LEXICAL && i < e->rule->n; i++)
        if (sg_exact_first(p, e->rule, i) == i)
            sum += rule_energy(p, e->children[i]);
    return sum;
}

/* Of `child` in all parts that are derived with part `first`. */
static double shared_energy(const sg_exact_problem *p, const sg_exact_node *e, uint32_t first,
                            const sg_exact_node *child, sg_exact_place at)
{
    double sum = rule_energy(p, child), from = 0;
    for (uint32_t i = 0; i < e->rule->n; i++) {
        if (sg_exact_first(p, e->rule, i) == first)
            sum += sg_exact_image_energy(p, child, sg_exact_part(e->rule, at, from, from + e->sizes[i]));
        from += e->sizes[i];
    }
    return sum;
}

static void share(const sg_exact_problem *p, sg_exact_node *e, uint32_t first, sg_exact_place at)
{
    sg_exact_node *best = e->children[first];
    double least = INFINITY;
    for (uint32_t i = first; i < e->rule->n; i++) {
        if (sg_exact_first(p, e->rule, i) != first)
            continue;
        const double energy = shared_energy(p, e, first, e->children[i], at);
        if (energy < least) {
            best = e->children[i];
            least = energy;
        }
    }
    for (uint32_t i = first; i < e->rule->n; i++)
        if (sg_exact_first(p, e->rule, i) == first)
            e->children[i] = best;
}

static void tie(const sg_exact_problem *p, sg_exact_node *e, sg_exact_place at)
{
    if (e->rule->op == SG_SPLIT_LEXICAL)
        return;
    double from = 0;
    for (uint32_t i = 0; i < e->rule->n; from += e->sizes[i++])
        tie(p, e->children[i], sg_exact_part(e->rule, at, from, from + e->sizes[i]));
    for (uint32_t i = 0; i < e->rule->n; i++)
        if (sg_exact_first(p, e->rule, i) == i)
            share(p, e, i, at);
}

void sg_exact_tree_tie(const sg_exact_problem *p, sg_exact_node *root)
{
    if (p->form.tied)
        tie(p, root, sg_exact_whole(p));
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
    body_order(e->rule, e->sizes, value);
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

sg_status sg_exact_tree_derivation(const sg_exact_problem *p, const sg_exact_node *root, sg_derivation *out,
                                   sg_error *err)
{
    gsl_rng *rng = sg_random_create(1); /* for uniforms that are then replaced */
    double *work = calloc(p->longest, sizeof *work);
    sg_status st = rng != NULL && work != NULL ? SG_OK : SG_FAIL_NOMEM(err);
    if (st == SG_OK)
        st = sg_derivation_open(out, sg_grammar_start(p->g), sg_grammar_start_args(p->g), 0, err);
    if (st == SG_OK)
        st = expand(out, 0, root, rng, work, err);
    free(work);
    gsl_rng_free(rng);
    return st;
}
