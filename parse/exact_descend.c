/* SPDX-License-Identifier: GPL-3.0-or-later */
/* exact_descend.c - derivations for grammars whose sizes, or whose ties, the parse of cells leaves out of account.
 *
 * From every rule of a symbol in turn: its cuts begin where its mean sizes have them; then its children are derived where
 * they stand, which is this same step once more, and its cuts are placed anew given the children, until the energy falls no
 * further. Where the parts of a rule are labels that is one step, and its result the best there is. Tied siblings are
 * derived once, over the sum of their places. Cuts are placed by dynamic programming over a grid, E_attr included: of
 * sizes as independent normals with the rule's means and variances, given their sum (which is what `sd` in the language
 * means, and near a full covariance). */
#include "parse/exact_priv.h"

#include <math.h>
#include <string.h>

enum { MAX_DEPTH = 8, ROUNDS = 8, LEAST_GRID = 24 };

/* Sizes of a rule: energy = constant + sum over parts of half_precision * (size - mean)^2. */
typedef struct {
    const double *mean;
    double *half_precision;
    double constant;
} size_model;

typedef struct {
    const sg_exact_problem *p;
    double step;
    size_model *models;          /* [nrules] */
    const sg_split_rule **first; /* [nsymbols + 1] its rules are first[s] .. first[s + 1] */
    bool *lexical;               /* [nsymbols] all rules are */
    sg_arena *candidate[MAX_DEPTH], *best[MAX_DEPTH];
    double budget; /* steps of dynamic programming that are left */
    sg_error *err;
} descent;

typedef struct {
    sg_exact_node *node; /* NULL: none fits */
    double own, image;   /* E_rule + E_attr, E_img */
} found;

static double total(const found *f)
{
    return f->node != NULL ? f->own + f->image : INFINITY;
}

/* Places that share one derivation. */
typedef struct {
    const sg_exact_place *at;
    size_t n;
} places;

/* ---- sizes ---- */

/* Variances d of independent normals whose variances given their sum are c: d - d^2 / sum d = c. */
static void independent_variances(const double *c, uint32_t n, double *d)
{
    memcpy(d, c, n * sizeof *d);
    for (int round = 0; round < 100; round++) {
        double sum = 0;
        for (uint32_t i = 0; i < n; i++)
            sum += d[i];
        for (uint32_t i = 0; i < n; i++)
            d[i] = fmin(c[i] + d[i] * d[i] / sum, 100 * c[i]);
    }
}

static void variances_of(const sg_split_rule *r, double *c)
{
    const uint32_t k = r->n - 1;
    c[k] = 0;
    for (uint32_t i = 0; i < k; i++) {
        c[i] = r->covariance[i * k + i];
        for (uint32_t j = 0; j < k; j++)
            c[k] += r->covariance[i * k + j];
    }
}

static sg_status make_model(const sg_split_rule *r, sg_arena *arena, size_model *out, sg_error *err)
{
    double *mean = SG_NEW_ARRAY(arena, double, r->n), *c = SG_NEW_ARRAY(arena, double, r->n);
    double *d = SG_NEW_ARRAY(arena, double, r->n), sum = 0;
    if (mean == NULL || c == NULL || d == NULL)
        return SG_FAIL_NOMEM(err);
    *out = (size_model){mean, d, 0};
    for (uint32_t i = 0; i < r->n; i++)
        mean[i] = r->mean != NULL ? r->mean[i] : 1.0 / r->n;
    if (r->mean == NULL || r->n < 2)
        return SG_OK; /* equal parts: the cuts do not move */
    variances_of(r, c);
    independent_variances(c, r->n, d);
    for (uint32_t i = 0; i < r->n; i++) {
        sum += d[i];
        out->constant += log(2 * M_PI * d[i]) / 2;
        d[i] = 1 / (2 * d[i]);
    }
    out->constant -= log(2 * M_PI * sum) / 2;
    return SG_OK;
}

/* ---- one split, its parts given ---- */

/* What part i costs from place a to place b of the grid: the least of options, each a difference of sums. */
typedef struct {
    const double *sums; /* [grid + 1] */
    double constant;
} option;

typedef struct {
    const option *options;
    size_t noptions;
    const double *table; /* [grid + 1][grid + 1] instead, where nothing adds up along the axis */
} part;

typedef struct {
    const sg_split_rule *rule;
    const size_model *model;
    size_t grid; /* steps along the axis */
    const part *parts;
    double *size;                  /* [grid + 1] energy of a size of so many steps */
    double *value[2];              /* [grid + 1] */
    uint16_t *from;                /* [n][grid + 1] */
    size_t *cut;                   /* out: [n + 1] */
} placing;

static void size_energies(placing *s, uint32_t i)
{
    for (size_t k = 0; k <= s->grid; k++) {
        const double d = (double)k / (double)s->grid - s->model->mean[i];
        s->size[k] = s->model->half_precision[i] * d * d;
    }
}

/* The best start of part i for an end at b. */
static double best_start(const placing *s, uint32_t i, const double *before, size_t b, size_t first, uint16_t *from)
{
    const part *p = &s->parts[i];
    double least = INFINITY;
    for (size_t a = first; p->table != NULL && a < b; a++) {
        const double v = before[a] + p->table[a * (s->grid + 1) + b] + s->size[b - a];
        if (v < least) {
            least = v;
            *from = (uint16_t)a;
        }
    }
    for (size_t k = 0; k < p->noptions; k++) {
        const double *sums = p->options[k].sums, end = sums[b] + p->options[k].constant;
        for (size_t a = first; a < b; a++) {
            const double v = before[a] - sums[a] + s->size[b - a] + end;
            if (v < least) {
                least = v;
                *from = (uint16_t)a;
            }
        }
    }
    return least;
}

/* Best cuts; INFINITY when the grid has too few places. */
static double place_cuts(descent *d, placing *s)
{
    const uint32_t n = s->rule->n;
    double *before = s->value[0], *now = s->value[1];
    if (n > s->grid)
        return INFINITY;
    for (size_t a = 0; a <= s->grid; a++)
        before[a] = a == 0 ? 0 : INFINITY;
    for (uint32_t i = 0; i < n; i++) {
        const bool last = i + 1 == n;
        size_energies(s, i);
        for (size_t b = 0; b <= s->grid; b++)
            now[b] = b > i && (!last || b == s->grid) ? best_start(s, i, before, b, i, &s->from[i * (s->grid + 1) + b])
                                                     : INFINITY;
        double *swap = before;
        before = now;
        now = swap;
        d->budget -= (double)s->grid * (double)s->grid / (last ? (double)s->grid : 2);
    }
    s->cut[n] = s->grid;
    for (uint32_t i = n; i-- > 0 && before[s->grid] < INFINITY;)
        s->cut[i] = s->from[i * (s->grid + 1) + s->cut[i + 1]];
    return before[s->grid];
}

static sg_status begin_placing(const descent *d, const sg_split_rule *r, size_t grid, sg_arena *arena, placing *s)
{
    *s = (placing){.rule = r,
                   .model = &d->models[r - d->p->form.rules],
                   .grid = grid,
                   .size = SG_NEW_ARRAY(arena, double, grid + 1),
                   .value = {SG_NEW_ARRAY(arena, double, grid + 1), SG_NEW_ARRAY(arena, double, grid + 1)},
                   .from = SG_NEW_ARRAY(arena, uint16_t, r->n * (grid + 1)),
                   .cut = SG_NEW_ARRAY(arena, size_t, r->n + 1)};
    const bool good = s->size != NULL && s->value[0] != NULL && s->value[1] != NULL && s->from != NULL && s->cut != NULL;
    return good ? SG_OK : SG_FAIL_NOMEM(d->err);
}

/* ---- what parts cost ---- */

static size_t grid_of(const descent *d, const sg_split_rule *r, places at)
{
    double length = 0;
    for (size_t k = 0; k < at.n; k++)
        length = fmax(length, sg_exact_length(r, at.at[k]));
    const double steps = fmax(ceil(length / d->step), fmin(LEAST_GRID, floor(length)));
    return steps < 1 ? 1 : steps > UINT16_MAX ? UINT16_MAX : (size_t)steps;
}

/* Sums of a terminal along the axis, over all places. */
static double *sums_of(const descent *d, const sg_split_rule *r, places at, size_t grid, uint32_t terminal,
                       sg_arena *arena)
{
    double *sums = SG_NEW_ARRAY(arena, double, grid + 1);
    for (size_t k = 0; sums != NULL && k < at.n; k++)
        for (size_t i = 1; i <= grid; i++)
            sums[i] += sg_exact_leaf_energy(d->p, terminal,
                                            sg_exact_part(r, at.at[k], 0, (double)i / (double)grid));
    return sums;
}

/* What lies below a set of places, by axis, made when it is first asked for. */
typedef struct {
    places at;
    size_t grid[2];
    double **sums[2]; /* [nterminals] */
    sg_arena *arena;
} field;

static sg_status see_axis(const descent *d, const sg_split_rule *r, field *f)
{
    const size_t n = d->p->form.nterminals;
    if (f->sums[r->op] != NULL)
        return SG_OK;
    f->grid[r->op] = grid_of(d, r, f->at);
    f->sums[r->op] = SG_NEW_ARRAY(f->arena, double *, n);
    for (uint32_t t = 0; f->sums[r->op] != NULL && t < n; t++)
        if ((f->sums[r->op][t] = sums_of(d, r, f->at, f->grid[r->op], t, f->arena)) == NULL)
            return SG_FAIL_NOMEM(d->err);
    return f->sums[r->op] != NULL ? SG_OK : SG_FAIL_NOMEM(d->err);
}

static size_t rules_of(const descent *d, uint32_t symbol)
{
    return (size_t)(d->first[symbol + 1] - d->first[symbol]);
}

/* A part that is labels: one option a rule. */
static sg_status label_part(const descent *d, uint32_t symbol, double *const *sums, sg_arena *arena, part *out)
{
    const size_t n = rules_of(d, symbol);
    option *options = SG_NEW_ARRAY(arena, option, n);
    if (options == NULL)
        return SG_FAIL_NOMEM(d->err);
    for (size_t k = 0; k < n; k++) {
        const sg_split_rule *r = d->first[symbol] + k;
        options[k] = (option){sums[r->rhs[0]], -log(r->probability)};
    }
    *out = (part){options, n, NULL};
    return SG_OK;
}

static double part_cost(const part *p, size_t grid, size_t a, size_t b, size_t *which)
{
    double least = INFINITY;
    *which = 0;
    if (p->table != NULL)
        return p->table[a * (grid + 1) + b];
    for (size_t k = 0; k < p->noptions; k++) {
        const double v = p->options[k].sums[b] - p->options[k].sums[a] + p->options[k].constant;
        if (v < least) {
            least = v;
            *which = k;
        }
    }
    return least;
}

static void take_sizes(const placing *s, sg_exact_node *e)
{
    for (uint32_t i = 0; i < s->rule->n; i++)
        e->sizes[i] = (double)(s->cut[i + 1] - s->cut[i]) / (double)s->grid;
}

/* All parts are labels: one step. */
static sg_status derive_labels(descent *d, const sg_split_rule *r, field *f, sg_arena *arena, found *out)
{
    placing s;
    part *parts = SG_NEW_ARRAY(arena, part, r->n);
    sg_exact_node *e = sg_exact_node_create(r, arena);
    if (parts == NULL || e == NULL)
        return SG_FAIL_NOMEM(d->err);
    SG_TRY(see_axis(d, r, f));
    SG_TRY(begin_placing(d, r, f->grid[r->op], arena, &s));
    for (uint32_t i = 0; i < r->n; i++)
        SG_TRY(label_part(d, r->rhs[i], f->sums[r->op], arena, &parts[i]));
    s.parts = parts;
    const double value = place_cuts(d, &s);
    if (value == INFINITY)
        return SG_OK;
    take_sizes(&s, e);
    *out = (found){e, value + s.model->constant - log(r->probability), 0};
    for (uint32_t i = 0; i < r->n; i++) {
        size_t k;
        const double cost = part_cost(&parts[i], s.grid, s.cut[i], s.cut[i + 1], &k);
        out->image += cost - parts[i].options[k].constant;
        if ((e->children[i] = sg_exact_node_create(d->first[r->rhs[i]] + k, arena)) == NULL)
            return SG_FAIL_NOMEM(d->err);
    }
    out->own -= out->image;
    return SG_OK;
}

static sg_status derive(descent *d, uint32_t symbol, places at, size_t depth, sg_arena *arena, found *out);

/* Cuts where the mean sizes have them, each part at least one step. */
static bool mean_cuts(const placing *s)
{
    double sum = 0;
    const uint32_t n = s->rule->n;
    if (n > s->grid)
        return false;
    s->cut[0] = 0;
    for (uint32_t i = 0; i < n; i++) {
        sum += s->model->mean[i];
        const double at = round(sum * (double)s->grid), most = (double)(s->grid - (n - 1 - i));
        s->cut[i + 1] = (size_t)fmin(fmax(at, (double)s->cut[i] + 1), most);
    }
    s->cut[n] = s->grid;
    return true;
}

/* The children where the cuts are now; own: the sum of theirs. */
static sg_status derive_children(descent *d, const placing *s, places at, size_t depth, sg_arena *arena,
                                 sg_exact_node *e, double *own)
{
    const sg_split_rule *r = s->rule;
    sg_exact_place *below = SG_NEW_ARRAY(arena, sg_exact_place, at.n * r->n);
    if (below == NULL)
        return SG_FAIL_NOMEM(d->err);
    *own = 0;
    for (uint32_t i = 0; i < r->n; i++) {
        const uint32_t first = sg_exact_first(d->p, r, i);
        size_t n = 0;
        if (first < i) {
            e->children[i] = e->children[first];
            continue;
        }
        for (uint32_t j = i; j < r->n; j++)
            for (size_t k = 0; k < at.n && sg_exact_first(d->p, r, j) == i; k++)
                below[n++] = sg_exact_part(r, at.at[k], (double)s->cut[j] / (double)s->grid,
                                           (double)s->cut[j + 1] / (double)s->grid);
        found child = {NULL, 0, 0};
        SG_TRY(derive(d, r->rhs[i], (places){below, n}, depth + 1, arena, &child));
        e->children[i] = child.node;
        *own += child.node != NULL ? child.own : INFINITY;
    }
    return SG_OK;
}

/* Whether cuts across the axis are all that there is below. */
static bool adds_up(const sg_exact_node *e, sg_split_op axis)
{
    if (e->rule->op == SG_SPLIT_LEXICAL)
        return true;
    for (uint32_t i = 0; i < e->rule->n; i++)
        if (!adds_up(e->children[i], axis))
            return false;
    return e->rule->op != axis || e->rule->n == 1;
}

static double energy_between(const descent *d, const sg_split_rule *r, const sg_exact_node *child, places at, double from,
                             double to)
{
    double sum = 0;
    for (size_t k = 0; k < at.n; k++)
        sum += sg_exact_image_energy(d->p, child, sg_exact_part(r, at.at[k], from, to));
    return sum;
}

/* Near the present cuts only. */
static sg_status child_table(descent *d, const placing *s, const sg_exact_node *child, uint32_t i, places at,
                             sg_arena *arena, part *out)
{
    const size_t grid = s->grid, reach = grid / 8 + 3, a0 = s->cut[i], b0 = s->cut[i + 1];
    double *table = SG_NEW_ARRAY(arena, double, (grid + 1) * (grid + 1));
    if (table == NULL)
        return SG_FAIL_NOMEM(d->err);
    for (size_t k = 0; k < (grid + 1) * (grid + 1); k++)
        table[k] = INFINITY;
    for (size_t a = a0 > reach ? a0 - reach : 0; a <= a0 + reach && a < grid; a++)
        for (size_t b = b0 > a + reach ? b0 - reach : a + 1; b <= b0 + reach && b <= grid; b++)
            table[a * (grid + 1) + b] =
                energy_between(d, s->rule, child, at, (double)a / (double)grid, (double)b / (double)grid);
    d->budget -= 20 * (double)(reach * reach);
    *out = (part){NULL, 0, table};
    return SG_OK;
}

static sg_status child_part(descent *d, const placing *s, const sg_exact_node *e, uint32_t i, places at, sg_arena *arena,
                            part *out)
{
    const sg_exact_node *child = e->children[i];
    if (!adds_up(child, s->rule->op))
        return child_table(d, s, child, i, at, arena, out);
    double *sums = SG_NEW_ARRAY(arena, double, s->grid + 1);
    option *o = SG_NEW(arena, option);
    if (sums == NULL || o == NULL)
        return SG_FAIL_NOMEM(d->err);
    for (size_t k = 1; k <= s->grid; k++)
        sums[k] = energy_between(d, s->rule, child, at, 0, (double)k / (double)s->grid);
    *o = (option){sums, 0};
    *out = (part){o, 1, NULL};
    return SG_OK;
}

/* Cuts for these children. @param value out: E_img + the part of E_attr that depends on the cuts */
static sg_status place_children(descent *d, placing *s, const sg_exact_node *e, places at, sg_arena *arena, double *value,
                                double *image)
{
    part *parts = SG_NEW_ARRAY(arena, part, s->rule->n);
    if (parts == NULL)
        return SG_FAIL_NOMEM(d->err);
    for (uint32_t i = 0; i < s->rule->n; i++) {
        const uint32_t first = sg_exact_first(d->p, s->rule, i);
        if (first < i && parts[first].table == NULL)
            parts[i] = parts[first];
        else
            SG_TRY(child_part(d, s, e, i, at, arena, &parts[i]));
    }
    s->parts = parts;
    *image = 0;
    *value = place_cuts(d, s);
    for (uint32_t i = 0; i < s->rule->n && *value < INFINITY; i++) {
        size_t k;
        *image += part_cost(&parts[i], s->grid, s->cut[i], s->cut[i + 1], &k);
    }
    return SG_OK;
}

/* Children and cuts in turn. */
static sg_status derive_split(descent *d, const sg_split_rule *r, field *f, size_t depth, sg_arena *arena, found *out)
{
    placing s;
    SG_TRY(begin_placing(d, r, grid_of(d, r, f->at), arena, &s));
    const bool movable = r->mean != NULL && r->n > 1;
    if (!mean_cuts(&s))
        return SG_OK;
    for (int round = 0; round < ROUNDS; round++) {
        sg_exact_node *e = sg_exact_node_create(r, arena);
        double own = 0, value = 0, image = 0;
        if (e == NULL)
            return SG_FAIL_NOMEM(d->err);
        SG_TRY(derive_children(d, &s, f->at, depth, arena, e, &own));
        if (own == INFINITY)
            return SG_OK;
        SG_TRY(place_children(d, &s, e, f->at, arena, &value, &image));
        take_sizes(&s, e);
        const found now = {e, own + value - image + s.model->constant - log(r->probability), image};
        if (!(total(&now) < total(out) - 1e-6))
            return SG_OK;
        *out = now;
        if (!movable)
            return SG_OK;
    }
    return SG_OK;
}

static sg_status derive_leaf(descent *d, const sg_split_rule *r, places at, sg_arena *arena, found *out)
{
    *out = (found){sg_exact_node_create(r, arena), -log(r->probability), 0};
    for (size_t k = 0; k < at.n; k++)
        out->image += sg_exact_leaf_energy(d->p, r->rhs[0], at.at[k]);
    return out->node != NULL ? SG_OK : SG_FAIL_NOMEM(d->err);
}

static sg_status derive_rule(descent *d, const sg_split_rule *r, field *f, size_t depth, sg_arena *arena, found *out)
{
    *out = (found){NULL, 0, 0};
    if (d->budget < 0 || r->probability <= 0)
        return SG_OK;
    if (r->op == SG_SPLIT_LEXICAL)
        return derive_leaf(d, r, f->at, arena, out);
    bool labels = r->mean != NULL && r->n > 1;
    for (uint32_t i = 0; i < r->n; i++)
        labels = labels && d->lexical[r->rhs[i]];
    return labels ? derive_labels(d, r, f, arena, out) : derive_split(d, r, f, depth, arena, out);
}

static sg_status keep(descent *d, const found *f, sg_arena *arena, found *best)
{
    if (!(total(f) < total(best)))
        return SG_OK;
    sg_arena_reset(arena);
    *best = *f;
    best->node = sg_exact_tree_copy(f->node, arena);
    return best->node != NULL ? SG_OK : SG_FAIL_NOMEM(d->err);
}

/* The best derivation of a symbol that stands in all the places at once. */
static sg_status derive(descent *d, uint32_t symbol, places at, size_t depth, sg_arena *arena, found *out)
{
    found best = {NULL, 0, 0};
    *out = best;
    if (depth == MAX_DEPTH)
        return SG_OK;
    sg_arena *work = d->candidate[depth];
    sg_arena_reset(work);
    field f = {.at = at, .arena = work};
    for (int axis = SG_SPLIT_X; axis <= SG_SPLIT_Y; axis++)
        for (size_t k = 0; k < rules_of(d, symbol); k++)
            if (d->first[symbol][k].op == (sg_split_op)axis) {
                SG_TRY(see_axis(d, &d->first[symbol][k], &f));
                break;
            }
    const sg_mark mark = sg_arena_mark(work);
    for (size_t k = 0; k < rules_of(d, symbol); k++) {
        found rule = {NULL, 0, 0};
        sg_arena_rewind(work, mark);
        SG_TRY(derive_rule(d, d->first[symbol] + k, &f, depth, work, &rule));
        SG_TRY(keep(d, &rule, d->best[depth], &best));
    }
    *out = best;
    if (best.node != NULL && (out->node = sg_exact_tree_copy(best.node, arena)) == NULL)
        return SG_FAIL_NOMEM(d->err);
    return SG_OK;
}

/* ---- all of it ---- */

static sg_status prepare(descent *d, sg_arena *arena)
{
    const sg_split_form *f = &d->p->form;
    d->models = SG_NEW_ARRAY(arena, size_model, f->nrules);
    d->first = SG_NEW_ARRAY(arena, const sg_split_rule *, f->nsymbols + 1);
    d->lexical = SG_NEW_ARRAY(arena, bool, f->nsymbols);
    if (d->models == NULL || d->first == NULL || d->lexical == NULL)
        return SG_FAIL_NOMEM(d->err);
    for (size_t s = 0, r = 0; s < f->nsymbols; s++) {
        d->first[s] = f->rules + r;
        d->lexical[s] = true;
        for (; r < f->nrules && f->rules[r].lhs == s; r++) {
            d->lexical[s] = d->lexical[s] && f->rules[r].op == SG_SPLIT_LEXICAL;
            if (f->rules[r].op != SG_SPLIT_LEXICAL)
                SG_TRY(make_model(&f->rules[r], arena, &d->models[r], d->err));
        }
        d->first[s + 1] = f->rules + r;
    }
    for (int i = 0; i < MAX_DEPTH; i++)
        if ((d->candidate[i] = sg_arena_create()) == NULL || (d->best[i] = sg_arena_create()) == NULL)
            return SG_FAIL_NOMEM(d->err);
    return SG_OK;
}

sg_status sg_exact_descend(const sg_exact_problem *p, double step, sg_arena *arena, sg_exact_node **out, sg_error *err)
{
    const sg_exact_place whole = sg_exact_whole(p);
    descent d = {.p = p, .step = step, .budget = 4e9, .err = err};
    found best = {NULL, 0, 0};
    sg_status st = prepare(&d, arena);
    if (st == SG_OK)
        st = derive(&d, p->form.axiom, (places){&whole, 1}, 0, arena, &best);
    for (int i = 0; i < MAX_DEPTH; i++) {
        sg_arena_free(d.candidate[i]);
        sg_arena_free(d.best[i]);
    }
    if (st == SG_OK && best.node == NULL)
        st = SG_FAIL(err, SG_ENOPARSE, "no rule of the axiom fits");
    *out = best.node;
    return st;
}
