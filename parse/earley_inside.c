/* SPDX-License-Identifier: GPL-3.0-or-later */
/* earley_inside.c - inside values, outside values, expected counts.
 *
 * Outside values flow from users to used. A rectangle is used as a later child by corners to its left or above it, and
 * as a first child at its own corner, by groups that were predicted later or by larger rectangles of its own group. So
 * corners go from the top left to the bottom right, groups of a corner backwards; each group makes its items again and
 * sweeps back over them. Source: Baker, "Trainable grammars for speech recognition" (1979), over the edges of the
 * chart; MATHEMATICS B1.2. */
#include "config.h"

#include "core/array.h"
#include "parse/earley_priv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef sg_ext value;
#define VALUE_ZERO                  sg_ext_zero()
#define value_is_zero(v)            sg_ext_is_zero(v)
#define value_mul(a, b)             sg_ext_mul((a), (b))
#define value_add(a, b)             sg_ext_add((a), (b))
#define value_of_cost(cost)         sg_ext_exp(-(cost))
#define value_is_hopeless(v, chart) ((void)(chart), false)
#define PREFIX_END_P(e)             ((e).p)
#define LEAF_P(leaf)                ((leaf)->p)
#define UNIT_P(u)                   ((u)->p)
#define CLOSURE(c)                  ((c)->sum)
#include "parse/earley_walk.inc"

sg_status sg_earley_inside(const sg_parse_table *t, const sg_cells *cells, sg_chart *c, double *log_inside,
                           sg_error *err)
{
    SG_TRY(sg_chart_begin(c, t, cells, SG_CHART_INSIDE, err));
    value v;
    if (!run(c) || !value_at(c, t->axiom, 0, 0, c->width, c->height, &v)) {
        c->kind = SG_CHART_EMPTY;
        return SG_FAIL_NOMEM(err);
    }
    c->log_value = sg_ext_log(v) - c->least_cost;
    *log_inside = c->log_value;
    return SG_OK;
}

/* ---- outside ---- */

typedef struct {
    walk w;
    sg_level *l;
    double *counts;
    sg_ext *leaf_outside; /* [nleaves] summed over the rectangles of leaves that are not stored */
} backward;

static bool ready_outside(sg_chart *c, const sg_comps *k)
{
    sg_comps *own = (sg_comps *)(uintptr_t)k;
    if (k->n == 0 || k->leaf != 0 || k->outside != NULL)
        return true;
    own->outside = sg_arena_alloc(c->arena, k->n * sizeof *k->outside);
    for (uint32_t i = 0; own->outside != NULL && i < k->n; i++)
        own->outside[i] = sg_ext_zero();
    return own->outside != NULL;
}

static void add_outside(const backward *b, const sg_comps *k, uint32_t place, sg_ext v)
{
    sg_ext *to = k->leaf != 0 ? &b->leaf_outside[k->leaf - 1] : &k->outside[place];
    *to = sg_ext_add(*to, v);
}

static sg_ext *item_outside(const sg_level *l, uint32_t line, uint32_t x1, uint32_t y1, uint32_t axis)
{
    return (sg_ext *)l->outside + (item_value(l, line, x1, y1, axis) - (value *)l->values);
}

/* Outside value of an item from those of the items that it was extended to; the children get theirs. */
static bool pull_child(const backward *b, uint32_t node, const corner *at, sg_ext inside, sg_ext *sum)
{
    const sg_level *l = b->l;
    const size_t slot = find_slot(l, node, at->across);
    if (l->slots[slot] == 0)
        return true;
    const sg_prefix *child = &b->w.t->nodes[node];
    sg_comps scratch;
    const sg_comps *k = comps_at(&b->w, child->symbol, at->x, at->y, &scratch);
    slice s;
    if (!ready_outside(b->w.c, k) || !slice_of(b->w.c, k, at->axis, at->across, &s))
        return false;
    const uint32_t origin = (at->axis == SG_SPLIT_X ? l->x : l->y) + 1;
    const uint32_t last = (at->axis == SG_SPLIT_X ? b->w.c->width : b->w.c->height) - child->rest;
    const sg_ext *from = (const sg_ext *)l->outside + (size_t)(l->slots[slot] - 1) * l->stride;
    for (uint32_t i = 0; i < s.n && s.along[i] <= last; i++) {
        const sg_ext a = from[s.along[i] - origin];
        if (sg_ext_is_zero(a))
            continue;
        *sum = sg_ext_add(*sum, sg_ext_mul(a, s.v[i]));
        add_outside(b, k, s.index != NULL ? s.index[i] : s.first + i, sg_ext_mul(a, inside));
    }
    return true;
}

static bool pull(const backward *b, uint32_t node, uint32_t x1, uint32_t y1, sg_ext inside, sg_ext *sum)
{
    const corner at = corner_of(&b->w, b->l, b->w.t->nodes[node].axis, x1, y1);
    for (uint32_t k = b->w.t->nodes[node].child; at.room > 0 && k != 0; k = b->w.t->nodes[k].sibling)
        if (can_extend(&b->w, b->l, &b->w.t->nodes[k], &at) && !pull_child(b, k, &at, inside, sum))
            return false;
    return true;
}

/* The same for a rule with tied siblings: the sum over all ways to place child i and those behind it of the outside
 * value of the whole times their inside values. before: the inside value of those before them. */
static bool pull_tied(const backward *b, const sg_table_rule *r, uint32_t i, const corner *strip, sg_ext before,
                      sg_ext *sum)
{
    const sg_level *l = b->l;
    if (i == r->n) {
        const size_t slot = find_slot(l, r->tied_node, strip->across);
        if (l->slots[slot] != 0)
            *sum = ((const sg_ext *)
                        l->outside)[(size_t)(l->slots[slot] - 1) * l->stride + l->bounds[i] - l->bounds[0] - 1];
        return true;
    }
    if (r->first_of[i] != i)
        return !sg_tied_repeats(b->w.c, r, i, l->bounds, l->x, l->y, strip->across) ||
               pull_tied(b, r, i + 1, strip, before, sum);
    const corner at = tied_corner(&b->w, l, strip, l->bounds[i]);
    sg_comps scratch;
    slice s = {0};
    if (at.room < r->n - i)
        return true;
    const sg_comps *k = comps_at(&b->w, r->rhs[i], at.x, at.y, &scratch);
    if (!ready_outside(b->w.c, k) || !slice_of(b->w.c, k, at.axis, at.across, &s))
        return false;
    for (uint32_t j = 0; j < s.n; j++) {
        sg_ext behind = sg_ext_zero();
        l->bounds[i + 1] = s.along[j];
        if (!pull_tied(b, r, i + 1, strip, sg_ext_mul(before, s.v[j]), &behind))
            return false;
        add_outside(b, k, s.index != NULL ? s.index[j] : s.first + j, sg_ext_mul(before, behind));
        *sum = sg_ext_add(*sum, sg_ext_mul(s.v[j], behind));
    }
    return true;
}

static bool pull_tied_rules(const backward *b, uint32_t s, uint32_t x1, uint32_t y1, sg_ext inside, sg_ext *sum)
{
    const sg_parse_table *t = b->w.t;
    for (uint32_t k = t->tied_rules != NULL ? t->tied_start[s] : 0; t->tied_rules != NULL && k < t->tied_start[s + 1];
         k++) {
        const sg_table_rule *r = &t->rules[t->tied_rules[k]];
        if (b->l->in[r->lhs] != 1)
            continue;
        const corner strip = corner_of(&b->w, b->l, (uint32_t)r->op, x1, y1);
        sg_ext behind = sg_ext_zero();
        b->l->bounds[0] = r->op == SG_SPLIT_X ? b->l->x : b->l->y;
        b->l->bounds[1] = r->op == SG_SPLIT_X ? x1 : y1;
        if (!pull_tied(b, r, 1, &strip, inside, &behind))
            return false;
        *sum = sg_ext_add(*sum, behind);
    }
    return true;
}

static bool pull_symbol(const backward *b, uint32_t s, uint32_t x1, uint32_t y1, sg_ext inside, sg_ext *sum)
{
    for (int axis = 0; axis < 2; axis++) {
        const uint32_t node = b->w.t->root[axis][s];
        if (node != 0 && wanted(b->l, &b->w.t->nodes[node]) && !pull(b, node, x1, y1, inside, sum))
            return false;
    }
    return pull_tied_rules(b, s, x1, y1, inside, sum);
}

/* The place of a rectangle among those of its symbol, for a sweep backwards; UINT32_MAX: it is none. */
static uint32_t place_back(const sg_comps_form *f, uint32_t *cursor, uint32_t x1, uint32_t y1)
{
    while (*cursor > 0) {
        const uint32_t at = *cursor - 1;
        uint32_t row = y1 - f->base;
        if (row >= f->span || at < f->start[row] || (at < f->start[row + 1] && f->along[at] < x1))
            return UINT32_MAX; /* at is above or to the left: it comes later */
        if (at < f->start[row + 1] && f->along[at] == x1)
            return at;
        (*cursor)--;
    }
    return UINT32_MAX;
}

/* Unit rules backwards: users before used. The outside value of a symbol becomes the one of its derivations by other
 * than unit rules; a rule counts with the outside value of its user and the inside value of what it leads to. */
static void spread_units(const backward *b, uint32_t s)
{
    const sg_unit_graph *g = &b->w.t->units;
    sg_ext *a = b->l->b2;
    const sg_ext *in = b->l->b;
    for (uint32_t k = g->start[s]; k < g->start[s + 1]; k++) {
        const uint32_t to = g->units[k].rhs;
        if (sg_ext_is_zero(in[to]) || sg_ext_is_zero(a[s]))
            continue;
        if (g->component[to] != g->component[s])
            a[to] = sg_ext_add(a[to], sg_ext_mul(a[s], g->units[k].p));
    }
}

/* Uses of the unit rules of s, from the closed outside value. */
static void count_units(const backward *b, uint32_t s)
{
    const sg_parse_table *t = b->w.t;
    const sg_ext *a = b->l->b2, *in = b->l->b;
    for (uint32_t i = t->rule_start[s]; i < t->rule_start[s + 1]; i++) {
        const sg_table_rule *r = &t->rules[t->rule_order[i]];
        if (!r->used || r->op == SG_SPLIT_LEXICAL || r->n != 1 || sg_ext_is_zero(in[r->rhs[0]]))
            continue;
        const sg_ext uses = sg_ext_mul(sg_ext_mul(a[s], in[r->rhs[0]]), sg_ext_of(r->p));
        b->counts[t->rule_order[i]] += sg_ext_double(uses);
    }
}

static void close_cycle_back(const backward *b, const sg_unit_component *c)
{
    const uint32_t *member = &b->w.t->units.order[c->first];
    sg_ext *a = b->l->b2, *sum = b->l->done_value; /* free while nothing is recorded, and made large enough */
    for (uint32_t j = 0; j < c->n; j++) {
        sum[j] = sg_ext_zero();
        for (uint32_t i = 0; i < c->n; i++)
            if (!sg_ext_is_zero(a[member[i]]))
                sum[j] = sg_ext_add(sum[j], sg_ext_mul(c->sum[(size_t)i * c->n + j], a[member[i]]));
    }
    for (uint32_t j = 0; j < c->n; j++)
        a[member[j]] = sum[j];
}

static void units_back(const backward *b)
{
    const sg_unit_graph *g = &b->w.t->units;
    for (uint32_t i = b->l->nunit_symbols; i > 0;) {
        const uint32_t s = b->l->unit_symbols[i - 1];
        const sg_unit_component *c = &g->components[g->component[s]];
        if (c->sum != NULL)
            close_cycle_back(b, c);
        for (uint32_t k = 0; k < c->n; k++)
            spread_units(b, b->l->unit_symbols[i - 1 - k]);
        for (uint32_t k = 0; k < c->n; k++)
            count_units(b, b->l->unit_symbols[i - 1 - k]);
        i -= c->n;
    }
}

static void count_leaf(const backward *b, const sg_leaf *leaf, sg_ext outside)
{
    const sg_parse_table *t = b->w.t;
    const double uses = sg_ext_double(outside);
    if (uses == 0)
        return;
    for (uint32_t i = t->rule_start[leaf->symbol]; i < t->rule_start[leaf->symbol + 1]; i++) {
        const sg_table_rule *r = &t->rules[t->rule_order[i]];
        if (r->used && r->op == SG_SPLIT_LEXICAL && r->rhs[0] == leaf->terminal)
            b->counts[t->rule_order[i]] += uses * r->p;
    }
}

static void leaves_back(const backward *b, uint32_t x1, uint32_t y1)
{
    const sg_level *l = b->l;
    for (uint32_t i = 0; x1 <= l->limit[y1] && i < l->nleaves; i++) {
        const sg_leaf *leaf = &b->w.t->leaves[l->leaves[i]];
        const sg_ext a = ((const sg_ext *)l->b2)[leaf->symbol];
        if (!sg_ext_is_zero(a))
            count_leaf(b, leaf,
                       sg_ext_mul(a, value_of_cost(sg_chart_leaf_cost(b->w.c, leaf->terminal, l->x, l->y, x1, y1))));
    }
}

static bool items_back(const backward *b, uint32_t x1, uint32_t y1)
{
    const sg_level *l = b->l;
    const sg_parse_table *t = b->w.t;
    for (uint32_t k = l->rows[y1]->head[x1]; k != 0; k = l->links[k].next) {
        const uint32_t line = l->links[k].line;
        const sg_prefix *node = &t->nodes[l->lines[line].node];
        const sg_ext inside = *item_value(l, line, x1, y1, node->axis);
        sg_ext sum = sg_ext_zero();
        for (uint32_t e = node->end; e < node->end + node->nends; e++) {
            if (l->in[t->ends[e].lhs] != 1)
                continue;
            const sg_ext a = sg_ext_mul(((const sg_ext *)l->b2)[t->ends[e].lhs], t->ends[e].p);
            sum = sg_ext_add(sum, a);
            b->counts[t->ends[e].rule] += sg_ext_double(sg_ext_mul(a, inside));
        }
        if (!pull(b, l->lines[line].node, x1, y1, inside, &sum))
            return false;
        *item_outside(l, line, x1, y1, node->axis) = sum;
    }
    return true;
}

/* The inside and outside values of the group and of the old ones at this rectangle go into b and b2. */
static bool load_back(const backward *b, uint32_t x1, uint32_t y1)
{
    sg_level *l = b->l;
    sg_comps **row = b->w.c->index[(size_t)l->y * b->w.c->width + l->x];
    sg_ext *in = l->b, *out = l->b2;
    for (uint32_t i = 0; i < l->nsymbols; i++) {
        const uint32_t s = l->symbols[i];
        const sg_comps_form *f = &row[s]->form[SG_SPLIT_X];
        in[s] = out[s] = sg_ext_zero();
        const uint32_t at = row[s]->n > 0 ? place_back(f, &l->count[s], x1, y1) : UINT32_MAX;
        if (at == UINT32_MAX)
            continue;
        in[s] = ((const sg_ext *)f->value)[at];
        out[s] = row[s]->outside[at];
        if (!pull_symbol(b, s, x1, y1, in[s], &out[s]))
            return false;
        row[s]->outside[at] = out[s];
    }
    for (size_t i = 0; i < l->nolds; i++) {
        sg_old *old = &l->olds[i];
        const sg_comps_form *f = &old_comps(old)->form[SG_SPLIT_X];
        in[old->symbol] = out[old->symbol] = sg_ext_zero();
        const uint32_t at = place_back(f, &old->cursor, x1, y1);
        old->here = at != UINT32_MAX;
        if (old->here) {
            in[old->symbol] = ((const sg_ext *)f->value)[at];
            if (!pull_symbol(b, old->symbol, x1, y1, in[old->symbol], &out[old->symbol]))
                return false;
        }
    }
    return true;
}

static bool visit_back(const backward *b, uint32_t x1, uint32_t y1)
{
    sg_level *l = b->l;
    if (!load_back(b, x1, y1))
        return false;
    units_back(b);
    leaves_back(b, x1, y1);
    if (!items_back(b, x1, y1))
        return false;
    for (size_t i = 0; i < l->nolds; i++)
        if (l->olds[i].here)
            add_outside(b, old_comps(&l->olds[i]), l->olds[i].cursor - 1, ((sg_ext *)l->b2)[l->olds[i].symbol]);
    return true;
}

static bool ready_back(const backward *b)
{
    sg_level *l = b->l;
    sg_chart *c = b->w.c;
    sg_comps **row = c->index[(size_t)l->y * c->width + l->x];
    for (uint32_t i = 0; i < l->nsymbols; i++) {
        l->count[l->symbols[i]] = row[l->symbols[i]]->n;
        if (!ready_outside(c, row[l->symbols[i]]))
            return false;
    }
    for (size_t i = 0; i < l->nolds; i++) {
        l->olds[i].cursor = old_comps(&l->olds[i])->n;
        if (!ready_outside(c, old_comps(&l->olds[i])))
            return false;
    }
    const size_t n = l->nlines * l->stride;
    if (!sg_array_grow(&l->outside, &l->outside_capacity, n * sizeof(sg_ext), 1) ||
        !sg_array_grow(&l->done_value, &l->done_value_capacity, b->w.t->units.largest * sizeof(sg_ext), 1))
        return false;
    for (size_t i = 0; i < n; i++)
        ((sg_ext *)l->outside)[i] = sg_ext_zero();
    return true;
}

static bool sweep_back(const backward *b)
{
    const sg_level *l = b->l;
    for (uint32_t y1 = b->w.c->height; y1 > l->y; y1--)
        for (uint32_t x1 = b->w.c->width; l->rows[y1] != NULL && x1 > l->x; x1--)
            if ((l->rows[y1]->bits[x1 / 64] >> (x1 % 64) & 1) != 0 && !visit_back(b, x1, y1))
                return false;
    return true;
}

static bool group_back(backward *b, uint32_t x, uint32_t y, const sg_group *g)
{
    sg_level *l = b->l;
    begin_level(&b->w, l, x, y);
    for (uint32_t i = 0; i < g->n; i++)
        if (!add_to_group(&b->w, l, g->symbols[i]))
            return false;
    const bool ok = fill_level(&b->w, l) && sweep(&b->w, 0, l) && ready_back(b) && sweep_back(b);
    clean_level(&b->w, l);
    return ok;
}

static bool start_outside(backward *b)
{
    const sg_parse_table *t = b->w.t;
    sg_comps scratch;
    slice s;
    const sg_comps *k = comps_at(&b->w, t->axiom, 0, 0, &scratch);
    if (!ready_outside(b->w.c, k) || !slice_of(b->w.c, k, SG_SPLIT_X, b->w.c->height, &s))
        return false;
    for (uint32_t i = 0; i < s.n; i++)
        if (s.along[i] == b->w.c->width)
            add_outside(b, k, s.first + i, sg_ext_inverse(s.v[i]));
    return true;
}

static bool run_back(backward *b)
{
    const sg_chart *c = b->w.c;
    if (!start_outside(b))
        return false;
    for (uint32_t y = 0; y < c->height; y++)
        for (uint32_t x = 0; x < c->width; x++)
            for (const sg_group *g = c->groups[(size_t)y * c->width + x]; g != NULL; g = g->next)
                if (!group_back(b, x, y, g))
                    return false;
    for (size_t i = 0; i < b->w.t->nleaves; i++)
        count_leaf(b, &b->w.t->leaves[i], b->leaf_outside[i]);
    return true;
}

sg_status sg_earley_expected_counts(const sg_parse_table *t, sg_chart *c, double *counts, sg_error *err)
{
    if (c->kind != SG_CHART_INSIDE || c->table != t)
        return SG_FAIL(err, SG_EINVAL, "expected counts want the chart of an inside pass with this table");
    if (c->log_value == -INFINITY)
        return SG_OK;
    backward b = {{c, t, true}, sg_chart_level(c, 0), NULL, NULL};
    b.counts = calloc(t->nrules + (size_t)1, sizeof *b.counts);
    b.leaf_outside = malloc((t->nleaves + 1) * sizeof *b.leaf_outside);
    bool ok = b.l != NULL && b.counts != NULL && b.leaf_outside != NULL;
    for (size_t i = 0; ok && i < t->nleaves; i++)
        b.leaf_outside[i] = sg_ext_zero();
    ok = ok && run_back(&b);
    for (uint32_t r = 0; ok && r < t->nrules; r++)
        counts[r] += b.counts[r];
    free(b.counts);
    free(b.leaf_outside);
    c->kind = SG_CHART_EMPTY; /* the outside values are not to be added to twice */
    if (!ok)
        sg_chart_drop_levels(c);
    return ok ? SG_OK : SG_FAIL_NOMEM(err);
}
