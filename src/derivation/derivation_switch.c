/* SPDX-License-Identifier: GPL-3.0-or-later */
/* derivation_switch.c - see derivation_switch.h.
 *
 * Let the rules have n and m parts, of which p in front and q behind are the same, and blocks of a = n - p - q and
 * b = m - p - q >= 1 parts between them, of extent L. With the first p + a - 1 and the last q sizes as coordinates (any
 * n - 1 will do, since the sizes sum to 1), the kept ones stay as they are, a - 1 go and b - 1 come. New sizes are
 * L times a Dirichlet draw, of density D_b / L^(b-1). So with f the density of the root's sizes
 *     reverse / forward = [f_m D_a / L^(a-1)] / [f_n D_b / L^(b-1)].
 * How many parts are common in front is drawn evenly from what is possible, which is the same in both directions. */
#include "derivation/derivation_switch.h"

#include "core/array.h"
#include "core/random.h"
#include "derivation/derivation_priv.h"
#include "grammar/simplex.h"

#include <gsl/gsl_randist.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A flat rule's right-hand side. */
typedef struct {
    uint32_t n;                /* parts; 0: not flat */
    sg_axis axis;              /* n > 1 */
    const sg_simplex *simplex; /* n > 1 */
    const double *mean;        /* n > 1: [n] of the sizes */
    uint32_t first;            /* part in `parts` */
} flat_rule;

typedef struct {
    sg_sym symbol;
    uint32_t child; /* stored child, SG_NONE for a label */
} flat_part;

struct sg_switcher {
    const sg_grammar *g;
    bool tied, useful;
    flat_rule *rules; /* [rules] */
    flat_part *parts;
    size_t nparts, parts_capacity;
    double *sizes, *alpha, *ratio; /* [most parts] */
    size_t *kept;                  /* [most parts] for each stored child of the new rule: the old node, or SIZE_MAX */
    size_t *old_child;             /* [most parts] nodes of the old rule's stored children */
    uint32_t most;
    sg_derivation open, fresh;
};

/* How concentrated new sizes are about the means of the rule: 1 + this times a mean's share of the block. */
static const double CONCENTRATION = 20;

/* ---- rules ---- */

static bool plain_successor(const sg_op *op)
{
    return op->kind == SG_OP_SUCCESSOR && op->nargs == 0;
}

static bool is_drawn_split(const sg_rule *r)
{
    if (!sg_rule_is_flat_split(r) || r->ops->nparts < 2)
        return false;
    for (const sg_op *part = r->ops + 1; part < r->ops + r->nops; part += part->length)
        if (part->size != SG_SIZE_DRAWN || !plain_successor(part + 1))
            return false;
    return r->ndraws == 1 && r->draws[0].kind == SG_DRAW_SIMPLEX && r->draws[0].simplex != NULL;
}

static sg_status add_parts(sg_switcher *w, const sg_rule *r, flat_rule *flat, sg_error *err)
{
    flat->first = (uint32_t)w->nparts;
    for (const sg_op *op = r->ops; op < r->ops + r->nops; op++) {
        if (op->kind != SG_OP_SUCCESSOR)
            continue;
        if (!SG_GROW(w->parts, w->parts_capacity, w->nparts + 1))
            return SG_FAIL_NOMEM(err);
        w->parts[w->nparts++] = (flat_part){op->symbol, op->child};
    }
    return SG_OK;
}

static sg_status look_at_rule(sg_switcher *w, const sg_rule *r, flat_rule *flat, sg_error *err)
{
    const bool one = r->nops == 1 && plain_successor(r->ops) && r->ndraws == 0;
    if (r->has_repeat || r->nops == 0 || r->guard != SG_NONE || !(one || is_drawn_split(r)))
        return SG_OK;
    flat->n = one ? 1 : r->ops->nparts;
    if (!one) {
        flat->axis = r->ops->axis;
        flat->simplex = r->draws[0].simplex;
        flat->mean = sg_simplex_mean(flat->simplex);
    }
    w->most = flat->n > w->most ? flat->n : w->most;
    return add_parts(w, r, flat, err);
}

/* Symbols whose rules do not depend on arguments, so that the prior draws a rule without them. */
static sg_status look_at_symbol(sg_switcher *w, const sg_symbol *s, sg_error *err)
{
    size_t flat = 0;
    if (s->kind != SG_SYMBOL_NONTERMINAL || !s->constant_weights || s->nrules < 2)
        return SG_OK;
    for (sg_rule_id r = s->first_rule; r < s->first_rule + s->nrules; r++) {
        SG_TRY(look_at_rule(w, sg_grammar_rule(w->g, r), w->rules + r, err));
        flat += w->rules[r].n > 0;
    }
    w->useful = w->useful || flat > 1;
    return SG_OK;
}

static sg_status take_memory(sg_switcher *w, sg_error *err)
{
    const size_t n = (size_t)w->most + 1;
    w->sizes = calloc(n, sizeof *w->sizes);
    w->alpha = calloc(n, sizeof *w->alpha);
    w->ratio = calloc(n, sizeof *w->ratio);
    w->kept = calloc(n, sizeof *w->kept);
    w->old_child = calloc(n, sizeof *w->old_child);
    const bool all = w->sizes != NULL && w->alpha != NULL && w->ratio != NULL && w->kept != NULL && w->old_child != NULL;
    return all ? SG_OK : SG_FAIL_NOMEM(err);
}

static sg_status look(sg_switcher *w, sg_error *err)
{
    w->rules = calloc(sg_grammar_rule_count(w->g) + 1, sizeof *w->rules);
    if (w->rules == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t s = 0; s < sg_grammar_symbol_count(w->g); s++)
        SG_TRY(look_at_symbol(w, sg_grammar_symbol(w->g, (sg_sym)s), err));
    return take_memory(w, err);
}

sg_status sg_switcher_create(const sg_grammar *g, sg_switcher **out, sg_error *err)
{
    sg_switcher *w = calloc(1, sizeof *w);
    if (w == NULL)
        return SG_FAIL_NOMEM(err);
    w->g = g;
    w->tied = sg_grammar_tied(g);
    sg_derivation_init(&w->open, g);
    sg_derivation_init(&w->fresh, g);
    const sg_status st = look(w, err);
    if (st != SG_OK)
        sg_switcher_free(w);
    else
        *out = w;
    return st;
}

void sg_switcher_free(sg_switcher *w)
{
    if (w == NULL)
        return;
    sg_derivation_clear(&w->open);
    sg_derivation_clear(&w->fresh);
    free(w->rules);
    free(w->parts);
    free(w->sizes);
    free(w->alpha);
    free(w->ratio);
    free(w->kept);
    free(w->old_child);
    free(w);
}

bool sg_switcher_useful(const sg_switcher *w)
{
    return w->useful;
}

/* ---- alignment ---- */

/* One switch on its way. */
typedef struct {
    sg_switcher *w;
    const sg_derivation *d;
    size_t node;
    gsl_rng *rng;
    size_t max_nodes;
    sg_rule_id to_rule;
    const flat_rule *from, *to;
    const flat_part *from_parts, *to_parts;
    uint32_t front, behind; /* parts that are the same */
    sg_derivation *slice;
    sg_error *err;
} switching;

static uint32_t smaller(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

static uint32_t common_front(const switching *x)
{
    const uint32_t n = smaller(x->from->n, x->to->n);
    uint32_t k = 0;
    while (k < n && x->from_parts[k].symbol == x->to_parts[k].symbol)
        k++;
    return k;
}

static uint32_t common_behind(const switching *x, uint32_t most)
{
    uint32_t k = 0;
    while (k < most && x->from_parts[x->from->n - 1 - k].symbol == x->to_parts[x->to->n - 1 - k].symbol)
        k++;
    return k;
}

/* Blocks are not empty: at least one part of each changes its size. */
static void align(switching *x)
{
    const uint32_t n = smaller(x->from->n, x->to->n), possible = common_front(x);
    const uint32_t drawn = (uint32_t)(sg_random_uniform(x->rng) * (possible + 1));
    x->front = smaller(smaller(drawn, possible), n - 1);
    x->behind = common_behind(x, n - 1 - x->front);
}

/* ---- children ---- */

static void list_old_children(switching *x)
{
    const sg_node *nodes = x->d->nodes;
    const size_t end = x->node + nodes[x->node].length;
    size_t k = 0;
    for (size_t c = x->node + 1; c < end && k <= x->w->most; c += nodes[c].length)
        x->w->old_child[k++] = c;
}

static void keep(switching *x, uint32_t to, uint32_t from)
{
    const flat_part *a = x->from_parts + from, *b = x->to_parts + to;
    if (a->child != SG_NONE && b->child != SG_NONE)
        x->w->kept[b->child] = x->w->old_child[a->child];
}

/* The part of the old block that has the same symbol for the same time. */
static void match_in_block(switching *x, uint32_t to)
{
    const sg_sym symbol = x->to_parts[to].symbol;
    uint32_t times = 0;
    for (uint32_t k = x->front; k < to; k++)
        times += x->to_parts[k].symbol == symbol;
    for (uint32_t k = x->front; k < x->from->n - x->behind; k++) {
        if (x->from_parts[k].symbol != symbol)
            continue;
        if (times-- == 0) {
            keep(x, to, k);
            return;
        }
    }
}

/* Tied: a symbol is derived once, wherever its parts are. */
static void match_anywhere(switching *x, uint32_t to)
{
    for (uint32_t k = 0; k < x->from->n; k++)
        if (x->from_parts[k].symbol == x->to_parts[to].symbol) {
            keep(x, to, k);
            return;
        }
}

static void match_children(switching *x)
{
    const uint32_t n = x->from->n, m = x->to->n;
    list_old_children(x);
    for (uint32_t k = 0; k < m; k++)
        x->w->kept[k] = SIZE_MAX;
    for (uint32_t k = 0; k < m; k++) {
        if (x->w->tied)
            match_anywhere(x, k);
        else if (k < x->front)
            keep(x, k, k);
        else if (k >= m - x->behind)
            keep(x, k, n - (m - k));
        else
            match_in_block(x, k);
    }
}

/* ---- sizes ---- */

/* Parameters of the Dirichlet distribution of a block's sizes. */
static void set_alpha(double *alpha, const flat_rule *r, uint32_t front, uint32_t block)
{
    double sum = 0;
    for (uint32_t k = 0; k < block; k++)
        sum += fmax(r->mean[front + k], 0);
    for (uint32_t k = 0; k < block; k++)
        alpha[k] = 1 + (sum > 0 ? CONCENTRATION * fmax(r->mean[front + k], 0) / sum : 0);
}

static double sum_of(const double *x, uint32_t n)
{
    double sum = 0;
    for (uint32_t k = 0; k < n; k++)
        sum += x[k];
    return sum;
}

/* log of D_n / L^(n-1) of the sizes of a block. */
static double log_block_density(switching *x, const flat_rule *r, const double *sizes, uint32_t block, double extent)
{
    sg_switcher *w = x->w;
    if (block < 2)
        return 0;
    set_alpha(w->alpha, r, x->front, block);
    for (uint32_t k = 0; k < block; k++)
        w->ratio[k] = sizes[k] / extent;
    return gsl_ran_dirichlet_lnpdf(block, w->alpha, w->ratio) - (block - 1) * log(extent);
}

static void draw_block(switching *x, double *sizes, uint32_t block, double extent)
{
    sg_switcher *w = x->w;
    sizes[0] = extent;
    if (block < 2)
        return;
    set_alpha(w->alpha, x->to, x->front, block);
    gsl_ran_dirichlet(x->rng, block, w->alpha, w->ratio);
    for (uint32_t k = 0; k < block; k++)
        sizes[k] = extent * w->ratio[k];
}

static const double *old_sizes(const switching *x)
{
    static const double whole[] = {1};
    const sg_node *n = x->d->nodes + x->node;
    return x->from->n == 1 ? whole : x->d->values + n->values + sg_grammar_symbol(x->w->g, n->symbol)->nparams;
}

static double log_density(const flat_rule *r, const double *sizes)
{
    return r->n == 1 ? 0 : sg_simplex_log_density(r->simplex, sizes);
}

/* New sizes into w->sizes. @return log of reverse over forward, -INFINITY outside of the simplex */
static double make_sizes(switching *x)
{
    const double *old = old_sizes(x);
    double *sizes = x->w->sizes;
    const uint32_t a = x->from->n - x->front - x->behind, b = x->to->n - x->front - x->behind;
    const double extent = sum_of(old + x->front, a);
    for (uint32_t k = 0; k < x->front; k++)
        sizes[k] = old[k];
    draw_block(x, sizes + x->front, b, extent);
    for (uint32_t k = 0; k < x->behind; k++)
        sizes[x->front + b + k] = old[x->front + a + k];
    const double forward = log_density(x->from, old) + log_block_density(x, x->to, sizes + x->front, b, extent);
    const double back = log_density(x->to, sizes) + log_block_density(x, x->from, old + x->front, a, extent);
    const double ratio = back - forward;
    return isfinite(ratio) ? ratio : -INFINITY;
}

/* ---- the slice ---- */

static void copy_numbers(double *to, const double *from, size_t n)
{
    if (n > 0)
        memcpy(to, from, n * sizeof *to);
}

/* Append nodes first..end-1 of a tree, a subtree, as a child of the slice's root. */
static sg_status append_subtree(switching *x, const sg_derivation *from, size_t first)
{
    sg_derivation *s = x->slice;
    const sg_node root = from->nodes[first];
    const size_t end = first + root.length, n = root.length, at = s->nnodes;
    const size_t values = (end == from->nnodes ? from->nvalues : from->nodes[end].values) - root.values;
    const size_t uniforms = (end == from->nnodes ? from->nuniforms : from->nodes[end].uniforms) - root.uniforms;
    SG_TRY(sg_derivation_room(s, n, uniforms, values, x->err));
    memcpy(s->nodes + at, from->nodes + first, n * sizeof *s->nodes);
    copy_numbers(s->values + s->nvalues, from->values + root.values, values);
    copy_numbers(s->uniforms + s->nuniforms, from->uniforms + root.uniforms, uniforms);
    for (size_t i = at; i < at + n; i++) {
        s->nodes[i].values = (uint32_t)(s->nodes[i].values - root.values + s->nvalues);
        s->nodes[i].uniforms = (uint32_t)(s->nodes[i].uniforms - root.uniforms + s->nuniforms);
    }
    s->nodes[at].parent = (uint32_t)at;
    s->nodes[0].length += (uint32_t)n;
    s->nnodes += n;
    s->nvalues += values;
    s->nuniforms += uniforms;
    return SG_OK;
}

static sg_status append_fresh(switching *x, sg_sym symbol, bool *inside)
{
    sg_switcher *w = x->w;
    const size_t others = x->d->nnodes - x->d->nodes[x->node].length + x->slice->nnodes;
    sg_uniforms fresh = {NULL, 0, 0, x->rng};
    *inside = others < x->max_nodes;
    if (!*inside)
        return SG_OK;
    SG_TRY(sg_derivation_open(&w->open, symbol, NULL, x->slice->nodes[0].depth + 1, x->err));
    SG_TRY(sg_derivation_regenerate(&w->open, 0, &fresh, x->max_nodes - others, &w->fresh, inside, x->err));
    return *inside ? append_subtree(x, &w->fresh, 0) : SG_OK;
}

/* The root with the new rule, its arguments, uniforms and sizes. */
static sg_status append_root(switching *x, bool *inside)
{
    sg_derivation *s = x->slice;
    const sg_node *n = x->d->nodes + x->node;
    const uint32_t nparams = sg_grammar_symbol(x->w->g, n->symbol)->nparams, m = x->to->n;
    SG_TRY(sg_derivation_open(s, n->symbol, x->d->values + n->values, n->depth, x->err));
    SG_TRY(sg_derivation_room(s, 0, m, m, x->err));
    s->nodes[0].rule = x->to_rule;
    *inside = true;
    if (m == 1)
        return SG_OK;
    *inside = sg_simplex_invert(x->to->simplex, x->w->sizes, s->uniforms);
    copy_numbers(s->values + nparams, x->w->sizes, m);
    s->nvalues += m;
    s->nuniforms += m - 1;
    return SG_OK;
}

static sg_status append_children(switching *x, bool *inside)
{
    uint32_t next = 0;
    for (uint32_t k = 0; k < x->to->n && *inside; k++) {
        const flat_part *part = x->to_parts + k;
        if (part->child == SG_NONE || part->child < next)
            continue;
        next = part->child + 1;
        const size_t kept = x->w->kept[part->child];
        if (kept != SIZE_MAX)
            SG_TRY(append_subtree(x, x->d, kept));
        else
            SG_TRY(append_fresh(x, part->symbol, inside));
    }
    const size_t others = x->d->nnodes - x->d->nodes[x->node].length;
    *inside = *inside && others + x->slice->nnodes <= x->max_nodes;
    return SG_OK;
}

static bool can_be_aligned(const switching *x)
{
    return x->from->n > 0 && x->to->n > 0 && x->from != x->to &&
           (x->from->n == 1 || x->to->n == 1 || x->from->axis == x->to->axis);
}

sg_status sg_switcher_propose(sg_switcher *w, const sg_derivation *d, size_t node, gsl_rng *rng, size_t max_nodes,
                              sg_derivation *slice, double *log_propose, bool *inside, sg_error *err)
{
    const sg_node *n = d->nodes + node;
    *inside = false;
    *log_propose = -INFINITY;
    if (n->rule >= SG_RULE_EMPTY || n->depth > sg_grammar_depth_limit(w->g) || w->rules[n->rule].n == 0)
        return SG_OK;
    switching x = {.w = w, .d = d, .node = node, .rng = rng, .max_nodes = max_nodes, .slice = slice, .err = err};
    SG_TRY(sg_derivation_draw_rule(d, node, rng, &x.to_rule, err));
    x.from = w->rules + n->rule;
    x.to = w->rules + x.to_rule;
    if (!can_be_aligned(&x))
        return SG_OK;
    x.from_parts = w->parts + x.from->first;
    x.to_parts = w->parts + x.to->first;
    align(&x);
    *log_propose = make_sizes(&x);
    if (!(*log_propose > -INFINITY))
        return SG_OK;
    match_children(&x);
    SG_TRY(append_root(&x, inside));
    return *inside ? append_children(&x, inside) : SG_OK;
}
