/* SPDX-License-Identifier: GPL-3.0-or-later */
/* earley_walk.h - the recursion over corners, once for sums and once for maxima. No header in the usual sense: each of
 * earley_inside.c and earley_viterbi.c includes it after it has defined
 *   value, VALUE_ZERO, value_is_zero(), value_mul(), value_add()   the semiring
 *   value_of_cost(cost)                                            of a terminal over its cells
 *   PREFIX_END_P(e), LEAF_P(leaf), UNIT_P(unit), CLOSURE(component) the probabilities in it
 * so that the inner loops are compiled for either. See earley_priv.h for the algorithm. */

typedef struct {
    sg_chart *c;
    const sg_parse_table *t;
    bool replay; /* all rectangles are known: only the items of a corner are made again */
} walk;

typedef struct {
    const uint16_t *along;
    const value *v;
    const uint32_t *index;
    uint32_t first, n; /* first: place of the first one in its form */
} slice;

static bool transpose(sg_chart *c, sg_comps *k)
{
    const sg_comps_form *from = &k->form[SG_SPLIT_X];
    uint32_t low = UINT32_MAX, high = 0;
    for (uint32_t i = 0; i < k->n; i++) {
        low = from->along[i] < low ? from->along[i] : low;
        high = from->along[i] > high ? from->along[i] : high;
    }
    const uint32_t span = high - low + 1;
    uint32_t *start = SG_NEW_ARRAY(c->arena, uint32_t, span + 2);
    uint16_t *along = sg_arena_alloc(c->arena, k->n * sizeof *along);
    value *v = sg_arena_alloc(c->arena, k->n * sizeof *v);
    uint32_t *index = sg_arena_alloc(c->arena, k->n * sizeof *index);
    if (start == NULL || along == NULL || v == NULL || index == NULL)
        return false;
    for (uint32_t i = 0; i < k->n; i++)
        start[from->along[i] - low + 2]++;
    for (uint32_t i = 0; i < span; i++)
        start[i + 2] += start[i + 1];
    for (uint32_t s = 0; s < from->span; s++)
        for (uint32_t i = from->start[s]; i < from->start[s + 1]; i++) {
            const uint32_t at = start[from->along[i] - low + 1]++;
            along[at] = (uint16_t)(from->base + s);
            v[at] = ((const value *)from->value)[i];
            index[at] = i;
        }
    k->form[SG_SPLIT_Y] = (sg_comps_form){low, span, start, along, v, index};
    return true;
}

/* Rectangles of k whose end across the axis is this; false when memory is out. */
static bool slice_of(sg_chart *c, const sg_comps *k, uint32_t axis, uint32_t across, slice *out)
{
    const sg_comps_form *f = &k->form[axis];
    out->n = 0;
    if (k->n == 0)
        return true;
    if (f->start == NULL && !transpose(c, (sg_comps *)(uintptr_t)k))
        return false;
    const uint32_t at = across - f->base;
    if (at >= f->span)
        return true;
    const uint32_t first = f->start[at];
    *out = (slice){f->along + first, (const value *)f->value + first, f->index != NULL ? f->index + first : NULL, first,
                   f->start[at + 1] - first};
    return true;
}

/* One rectangle, both ways. */
static void set_single(const sg_chart *c, sg_comps *k, uint32_t x1, uint32_t y1, void *v)
{
    static const uint32_t one[2] = {0, 1};
    k->n = 1;
    k->form[SG_SPLIT_X] = (sg_comps_form){y1, 1, one, &c->iota[x1], v, NULL};
    k->form[SG_SPLIT_Y] = (sg_comps_form){x1, 1, one, &c->iota[y1], v, NULL};
}

/* The rectangles of a symbol from a corner at which it is predicted (or where it has none). */
static const sg_comps *comps_at(const walk *w, uint32_t s, uint32_t x, uint32_t y, sg_comps *scratch)
{
    const sg_chart *c = w->c;
    if (!sg_chart_may_start(c, w->t, s, x, y))
        return &sg_no_comps;
    const size_t cell = (size_t)y * c->width + x;
    if (sg_chart_leaf_inline(c, w->t, s)) {
        const sg_leaf *leaf = sg_table_leaf(w->t, s, c->labels[cell]);
        memset(scratch, 0, sizeof *scratch);
        if (leaf == NULL || value_is_zero(LEAF_P(leaf)))
            return &sg_no_comps;
        set_single(c, scratch, x + 1, y + 1, (void *)(uintptr_t)&LEAF_P(leaf));
        scratch->leaf = (uint32_t)(leaf - w->t->leaves) + 1;
        return scratch;
    }
    return c->index[cell] != NULL && c->index[cell][s] != NULL ? c->index[cell][s] : &sg_no_comps;
}

/* Whether this symbol at this corner is still to be computed. */
static bool unknown(const walk *w, uint32_t s, uint32_t x, uint32_t y)
{
    sg_comps **row = w->c->index[(size_t)y * w->c->width + x];
    return (row == NULL || row[s] == NULL) && sg_chart_may_start(w->c, w->t, s, x, y)
           && !sg_chart_leaf_inline(w->c, w->t, s);
}

/* ---- ends and lines of a corner in progress ---- */

static sg_row *row_of(const walk *w, sg_level *l, uint32_t y1)
{
    if (l->rows[y1] == NULL)
        l->rows[y1] = sg_chart_row(w->c);
    return l->rows[y1];
}

static bool set_end(const walk *w, sg_level *l, uint32_t x1, uint32_t y1)
{
    sg_row *row = row_of(w, l, y1);
    if (row != NULL)
        row->bits[x1 / 64] |= UINT64_C(1) << (x1 % 64);
    return row != NULL;
}

/* The next end in this row from x1 on; above the width when there is none. */
static uint32_t next_end(const sg_chart *c, const sg_row *row, uint32_t x1)
{
    const uint32_t words = c->width / 64 + 1;
    uint32_t k = x1 / 64;
    if (k >= words)
        return UINT32_MAX;
    uint64_t bits = row->bits[k] & (~UINT64_C(0) << (x1 % 64));
    while (bits == 0) {
        if (++k == words)
            return UINT32_MAX;
        bits = row->bits[k];
    }
    return k * 64 + (uint32_t)__builtin_ctzll(bits);
}

static void clean_row(sg_chart *c, sg_row *row)
{
    for (uint32_t x1 = next_end(c, row, 0); x1 <= c->width; x1 = next_end(c, row, x1 + 1))
        row->head[x1] = 0;
    memset(row->bits, 0, (c->width / 64 + 1) * sizeof *row->bits);
    row->next_free = c->free_rows;
    c->free_rows = row;
}

static size_t slot_hash(uint32_t node, uint32_t across)
{
    const uint64_t key = ((uint64_t)node << 16 | across) * UINT64_C(0x9E3779B97F4A7C15);
    return (size_t)(key >> 20);
}

static size_t find_slot(const sg_level *l, uint32_t node, uint32_t across)
{
    size_t k = slot_hash(node, across) & (l->nslots - 1);
    while (l->slots[k] != 0
           && (l->lines[l->slots[k] - 1].node != node || l->lines[l->slots[k] - 1].across != across))
        k = (k + 1) & (l->nslots - 1);
    return k;
}

static bool widen_slots(sg_level *l)
{
    uint32_t *slots = calloc(2 * l->nslots, sizeof *slots);
    if (slots == NULL)
        return false;
    free(l->slots);
    l->slots = slots;
    l->nslots *= 2;
    for (uint32_t i = 0; i < l->nlines; i++) {
        const size_t k = find_slot(l, l->lines[i].node, l->lines[i].across);
        l->slots[k] = i + 1;
        l->lines[i].slot = (uint32_t)k;
    }
    return true;
}

/* The line of a node and an end across; made when it is new. UINT32_MAX: memory is out. */
static uint32_t line_of(sg_level *l, uint32_t node, uint32_t across)
{
    size_t k = find_slot(l, node, across);
    if (l->slots[k] != 0)
        return l->slots[k] - 1;
    if (2 * (l->nlines + 1) > l->nslots) {
        if (!widen_slots(l))
            return UINT32_MAX;
        k = find_slot(l, node, across);
    }
    if (!SG_GROW(l->lines, l->lines_capacity, l->nlines + 1)
        || !sg_array_grow(&l->values, &l->values_capacity, (l->nlines + 1) * l->stride * sizeof(value), 1))
        return UINT32_MAX;
    value *v = (value *)l->values + l->nlines * l->stride;
    for (uint32_t i = 0; i < l->stride; i++)
        v[i] = VALUE_ZERO;
    l->lines[l->nlines] = (sg_line){node, across, (uint32_t)k};
    l->slots[k] = (uint32_t)++l->nlines;
    return l->slots[k] - 1;
}

/* ---- prediction ---- */

static bool predict(const walk *w, size_t depth, uint32_t x, uint32_t y, const uint32_t *ask, size_t nask);

static bool add_to_group(const walk *w, sg_level *l, uint32_t s)
{
    sg_comps ***row = &w->c->index[(size_t)l->y * w->c->width + l->x];
    if (*row == NULL)
        *row = SG_NEW_ARRAY(w->c->arena, sg_comps *, w->t->nsymbols);
    if (*row == NULL)
        return false;
    if (!w->replay)
        (*row)[s] = (sg_comps *)(uintptr_t)&sg_no_comps;
    l->in[s] = 1;
    l->mask |= UINT64_C(1) << (s % 64);
    l->symbols[l->nsymbols++] = s;
    return true;
}

/* The group grows by its own left corners: symbols[] is the queue. */
static bool collect_group(const walk *w, sg_level *l)
{
    for (uint32_t i = 0; i < l->nsymbols; i++) {
        const uint32_t s = l->symbols[i];
        for (uint32_t k = w->t->corner_start[s]; k < w->t->corner_start[s + 1]; k++)
            if (unknown(w, w->t->corners[k], l->x, l->y) && !add_to_group(w, l, w->t->corners[k]))
                return false;
    }
    return true;
}

/* Left corners of the group that are known already. */
static bool collect_olds(const walk *w, sg_level *l)
{
    sg_comps scratch;
    for (uint32_t i = 0; i < l->nsymbols; i++)
        for (uint32_t k = w->t->corner_start[l->symbols[i]]; k < w->t->corner_start[l->symbols[i] + 1]; k++) {
            const uint32_t s = w->t->corners[k];
            if (l->in[s] != 0)
                continue;
            const sg_comps *comps = comps_at(w, s, l->x, l->y, &scratch);
            if (comps->n == 0)
                continue;
            if (!SG_GROW(l->olds, l->olds_capacity, l->nolds + 1))
                return false;
            l->in[s] = 2;
            sg_old *old = &l->olds[l->nolds++];
            *old = (sg_old){.symbol = s, .comps = comps == &scratch ? NULL : comps};
            if (comps == &scratch)
                old->own = scratch;
        }
    return true;
}

static const sg_comps *old_comps(const sg_old *old)
{
    return old->comps != NULL ? old->comps : &old->own;
}

static int compare_ranks(const uint32_t *rank, uint32_t a, uint32_t b)
{
    return (rank[a] > rank[b]) - (rank[a] < rank[b]);
}

/* Symbols of the group with unit rules, in the order in which they can be closed. */
static void collect_units_of(const walk *w, sg_level *l)
{
    const sg_unit_graph *g = &w->t->units;
    l->nunit_symbols = 0;
    if (g->nunits == 0)
        return;
    for (uint32_t i = 0; i < l->nsymbols; i++) {
        const uint32_t s = l->symbols[i];
        if (g->start[s] == g->start[s + 1])
            continue;
        uint32_t at = l->nunit_symbols++;
        for (; at > 0 && compare_ranks(g->rank, l->unit_symbols[at - 1], s) > 0; at--)
            l->unit_symbols[at] = l->unit_symbols[at - 1];
        l->unit_symbols[at] = s;
    }
}

/* Where leaves may end: limit[y1] is the largest x1. */
static void find_limits(const walk *w, sg_level *l)
{
    const sg_chart *c = w->c;
    uint32_t limit = c->width;
    for (uint32_t y1 = l->y + 1; y1 <= c->height; y1++) {
        const size_t cell = (size_t)(y1 - 1) * c->width + l->x;
        if (w->t->mode == SG_CELL_MODE) {
            limit = y1 == l->y + 1 ? l->x + 1 : 0;
        } else if (c->labels != NULL) {
            const uint32_t run = l->x + c->runs[cell];
            const bool same = c->labels[cell] == c->labels[(size_t)l->y * c->width + l->x];
            limit = !same ? 0 : run < limit ? run : limit;
        }
        l->limit[y1] = (uint16_t)limit;
    }
}

static bool collect_leaves(const walk *w, sg_level *l)
{
    const sg_chart *c = w->c;
    l->nleaves = 0;
    for (uint32_t i = 0; i < l->nsymbols; i++)
        for (uint32_t k = w->t->leaf_start[l->symbols[i]]; k < w->t->leaf_start[l->symbols[i] + 1]; k++)
            if (c->labels == NULL || c->labels[(size_t)l->y * c->width + l->x] == w->t->leaves[k].terminal)
                l->leaves[l->nleaves++] = k;
    find_limits(w, l);
    if (l->nleaves == 0)
        return true;
    for (uint32_t y1 = l->y + 1; y1 <= c->height && l->limit[y1] > l->x; y1++)
        for (uint32_t x1 = l->x + 1; x1 <= l->limit[y1]; x1++)
            if (!set_end(w, l, x1, y1))
                return false;
    return true;
}

static bool seed_olds(const walk *w, sg_level *l)
{
    for (size_t i = 0; i < l->nolds; i++) {
        const sg_comps_form *f = &old_comps(&l->olds[i])->form[SG_SPLIT_X];
        for (uint32_t s = 0; s < f->span; s++)
            for (uint32_t k = f->start[s]; k < f->start[s + 1]; k++)
                if (!set_end(w, l, f->along[k], f->base + s))
                    return false;
    }
    return true;
}

/* ---- the values of one rectangle ---- */

static void add_value(sg_level *l, uint32_t s, value v)
{
    value *b = (value *)l->b;
    if (value_is_zero(v))
        return;
    if (value_is_zero(b[s])) {
        b[s] = v;
        l->touched[l->ntouched++] = s;
    } else {
        b[s] = value_add(b[s], v);
    }
}

static void add_leaves(const walk *w, sg_level *l, uint32_t x1, uint32_t y1)
{
    uint32_t terminal = UINT32_MAX;
    value v = VALUE_ZERO;
    for (uint32_t i = 0; i < l->nleaves; i++) {
        const sg_leaf *leaf = &w->t->leaves[l->leaves[i]];
        if (leaf->terminal != terminal) {
            terminal = leaf->terminal;
            v = value_of_cost(sg_chart_leaf_cost(w->c, terminal, l->x, l->y, x1, y1));
        }
        add_value(l, leaf->symbol, value_mul(LEAF_P(leaf), v));
    }
}

static value *item_value(const sg_level *l, uint32_t line, uint32_t x1, uint32_t y1, uint32_t axis)
{
    return (value *)l->values + (size_t)line * l->stride + (axis == SG_SPLIT_X ? x1 - l->x : y1 - l->y) - 1;
}

static void complete_items(const walk *w, sg_level *l, uint32_t x1, uint32_t y1)
{
    for (uint32_t k = l->rows[y1]->head[x1]; k != 0; k = l->links[k].next) {
        const uint32_t line = l->links[k].line;
        const sg_prefix *node = &w->t->nodes[l->lines[line].node];
        const value v = *item_value(l, line, x1, y1, node->axis);
        for (uint32_t e = node->end; e < node->end + node->nends; e++)
            if (l->in[w->t->ends[e].lhs] == 1)
                add_value(l, w->t->ends[e].lhs, value_mul(v, PREFIX_END_P(w->t->ends[e])));
    }
}

static void load_olds(sg_level *l, uint32_t x1, uint32_t y1)
{
    for (size_t i = 0; i < l->nolds; i++) {
        sg_old *old = &l->olds[i];
        const sg_comps *k = old_comps(old);
        const sg_comps_form *f = &k->form[SG_SPLIT_X];
        old->here = y1 - f->base < f->span && old->cursor < f->start[y1 - f->base + 1]
                    && old->cursor >= f->start[y1 - f->base] && f->along[old->cursor] == x1;
        if (old->here)
            ((value *)l->b)[old->symbol] = ((const value *)f->value)[old->cursor++];
    }
}

static void unload_olds(sg_level *l)
{
    for (size_t i = 0; i < l->nolds; i++)
        if (l->olds[i].here)
            ((value *)l->b)[l->olds[i].symbol] = VALUE_ZERO;
}

static void add_outer_units(const walk *w, sg_level *l, uint32_t s)
{
    const sg_unit_graph *g = &w->t->units;
    for (uint32_t k = g->start[s]; k < g->start[s + 1]; k++) {
        const sg_unit *u = &g->units[k];
        const value v = ((const value *)l->b)[u->rhs];
        if (!value_is_zero(v) && g->component[u->rhs] != g->component[s])
            add_value(l, s, value_mul(UNIT_P(u), v));
    }
}

/* Symbols of one component are predicted together, and all have unit rules: they stand side by side from `at`. */
static void close_cycle(const walk *w, sg_level *l, uint32_t at, const sg_unit_component *c)
{
    value *b = l->b, *sum = l->b2; /* b2 is of use to outside values only, and larger than any component */
    const uint32_t *member = &w->t->units.order[c->first];
    for (uint32_t i = 0; i < c->n; i++)
        add_outer_units(w, l, l->unit_symbols[at + i]);
    for (uint32_t i = 0; i < c->n; i++) {
        sum[i] = VALUE_ZERO;
        for (uint32_t j = 0; j < c->n; j++)
            if (!value_is_zero(b[member[j]]) && !value_is_zero(CLOSURE(c)[(size_t)i * c->n + j]))
                sum[i] = value_add(sum[i], value_mul(CLOSURE(c)[(size_t)i * c->n + j], b[member[j]]));
    }
    for (uint32_t i = 0; i < c->n; i++) {
        if (value_is_zero(b[member[i]]))
            add_value(l, member[i], sum[i]);
        else
            b[member[i]] = sum[i];
    }
}

static void close_units(const walk *w, sg_level *l)
{
    const sg_unit_graph *g = &w->t->units;
    for (uint32_t i = 0; i < l->nunit_symbols;) {
        const uint32_t s = l->unit_symbols[i];
        const sg_unit_component *c = &g->components[g->component[s]];
        if (c->sum == NULL)
            add_outer_units(w, l, s);
        else
            close_cycle(w, l, i, c);
        i += c->n;
    }
}

/* ---- advancing ---- */

static bool wanted(const sg_level *l, const sg_prefix *node)
{
    return node->lhs != SG_NONE ? l->in[node->lhs] == 1 : (node->lhs_mask & l->mask) != 0;
}

/* Where the child that extends an item ending at (x1, y1) stands, and how far it can reach along the split. */
typedef struct {
    uint32_t axis, x, y, across, room;
} corner;

static corner corner_of(const walk *w, const sg_level *l, uint32_t axis, uint32_t x1, uint32_t y1)
{
    if (axis == SG_SPLIT_X)
        return (corner){axis, x1, l->y, y1, w->c->width - x1};
    return (corner){axis, l->x, y1, x1, w->c->height - y1};
}

static bool can_extend(const walk *w, const sg_level *l, const sg_prefix *child, const corner *at)
{
    return wanted(l, child) && w->t->min_size[at->axis][child->symbol] + child->rest <= at->room
           && sg_chart_may_start(w->c, w->t, child->symbol, at->x, at->y);
}

static bool predict_children(const walk *w, size_t depth, const sg_level *l, uint32_t node, const corner *at)
{
    uint32_t ask[64];
    size_t n = 0;
    for (uint32_t k = w->t->nodes[node].child; k != 0; k = w->t->nodes[k].sibling) {
        const sg_prefix *child = &w->t->nodes[k];
        if (!can_extend(w, l, child, at) || !unknown(w, child->symbol, at->x, at->y))
            continue;
        ask[n++] = child->symbol;
        if (n == sizeof ask / sizeof *ask) {
            if (!predict(w, depth + 1, at->x, at->y, ask, n))
                return false;
            n = 0;
        }
    }
    return n == 0 || predict(w, depth + 1, at->x, at->y, ask, n);
}

static bool new_item(const walk *w, sg_level *l, uint32_t line, const corner *at, uint32_t along)
{
    const uint32_t x1 = at->axis == SG_SPLIT_X ? along : at->across, y1 = at->axis == SG_SPLIT_X ? at->across : along;
    if (!SG_GROW(l->links, l->links_capacity, l->nlinks + 1) || !set_end(w, l, x1, y1))
        return false;
    uint32_t *head = &l->rows[y1]->head[x1];
    l->links[l->nlinks] = (sg_link){line, *head};
    *head = (uint32_t)l->nlinks++;
    w->c->states += !w->replay;
    return true;
}

static bool extend(const walk *w, sg_level *l, uint32_t k, const corner *at, value v)
{
    const sg_prefix *child = &w->t->nodes[k];
    sg_comps scratch;
    slice s;
    if (!slice_of(w->c, comps_at(w, child->symbol, at->x, at->y, &scratch), at->axis, at->across, &s))
        return false;
    const uint32_t origin = (at->axis == SG_SPLIT_X ? l->x : l->y) + 1;
    const uint32_t last = (at->axis == SG_SPLIT_X ? w->c->width : w->c->height) - child->rest;
    while (s.n > 0 && s.along[s.n - 1] > last)
        s.n--;
    if (s.n == 0)
        return true;
    const uint32_t line = line_of(l, k, at->across);
    if (line == UINT32_MAX)
        return false;
    value *to = (value *)l->values + (size_t)line * l->stride;
    for (uint32_t i = 0; i < s.n; i++) {
        value *slot = &to[s.along[i] - origin];
        if (!value_is_zero(*slot))
            *slot = value_add(*slot, value_mul(v, s.v[i]));
        else if (*slot = value_mul(v, s.v[i]), !new_item(w, l, line, at, s.along[i]))
            return false;
    }
    return true;
}

/* Extend an item that ends at (x1, y1) by each possible next child. */
static bool advance(const walk *w, size_t depth, sg_level *l, uint32_t node, uint32_t x1, uint32_t y1, value v)
{
    const corner at = corner_of(w, l, w->t->nodes[node].axis, x1, y1);
    if (at.room == 0 || w->t->nodes[node].child == 0)
        return true;
    if (!w->replay && !predict_children(w, depth, l, node, &at))
        return false;
    for (uint32_t k = w->t->nodes[node].child; k != 0; k = w->t->nodes[k].sibling)
        if (can_extend(w, l, &w->t->nodes[k], &at) && !extend(w, l, k, &at, v))
            return false;
    return true;
}

static bool advance_symbol(const walk *w, size_t depth, sg_level *l, uint32_t s, uint32_t x1, uint32_t y1)
{
    const value v = ((const value *)l->b)[s];
    for (int axis = 0; axis < 2; axis++) {
        const uint32_t node = w->t->root[axis][s];
        if (node != 0 && wanted(l, &w->t->nodes[node]) && !advance(w, depth, l, node, x1, y1, v))
            return false;
    }
    return true;
}

static bool advance_items(const walk *w, size_t depth, sg_level *l, uint32_t x1, uint32_t y1)
{
    /* Items that are made meanwhile end further on: the list of this end stays as it is. */
    for (uint32_t k = l->rows[y1]->head[x1]; k != 0; k = l->links[k].next) {
        const uint32_t line = l->links[k].line, node = l->lines[line].node;
        const value v = *item_value(l, line, x1, y1, w->t->nodes[node].axis);
        if (!advance(w, depth, l, node, x1, y1, v))
            return false;
    }
    return true;
}

/* ---- the sweep ---- */

static bool record(const walk *w, sg_level *l, uint32_t x1, uint32_t y1)
{
    const size_t need = l->ndone + l->ntouched;
    if (w->replay)
        return true;
    if (!SG_GROW(l->done_symbol, l->done_symbol_capacity, need) || !SG_GROW(l->done_end, l->done_end_capacity, need)
        || !sg_array_grow(&l->done_value, &l->done_value_capacity, need * sizeof(value), 1))
        return false;
    for (uint32_t i = 0; i < l->ntouched; i++) {
        l->done_symbol[l->ndone] = l->touched[i];
        l->done_end[l->ndone] = y1 << 16 | x1;
        ((value *)l->done_value)[l->ndone++] = ((const value *)l->b)[l->touched[i]];
    }
    w->c->states += l->ntouched;
    return true;
}

static bool visit(const walk *w, size_t depth, sg_level *l, uint32_t x1, uint32_t y1)
{
    l->ntouched = 0;
    if (x1 <= l->limit[y1])
        add_leaves(w, l, x1, y1);
    complete_items(w, l, x1, y1);
    load_olds(l, x1, y1);
    close_units(w, l);
    bool ok = record(w, l, x1, y1) && advance_items(w, depth, l, x1, y1);
    for (uint32_t i = 0; ok && i < l->ntouched; i++)
        ok = advance_symbol(w, depth, l, l->touched[i], x1, y1);
    for (size_t i = 0; ok && i < l->nolds; i++)
        if (l->olds[i].here)
            ok = advance_symbol(w, depth, l, l->olds[i].symbol, x1, y1);
    for (uint32_t i = 0; i < l->ntouched; i++)
        ((value *)l->b)[l->touched[i]] = VALUE_ZERO;
    unload_olds(l);
    return ok;
}

static bool sweep(const walk *w, size_t depth, sg_level *l)
{
    for (uint32_t y1 = l->y + 1; y1 <= w->c->height; y1++) {
        sg_row *row = l->rows[y1];
        if (row == NULL)
            continue;
        for (uint32_t x1 = next_end(w->c, row, l->x + 1); x1 <= w->c->width; x1 = next_end(w->c, row, x1 + 1))
            if (!visit(w, depth, l, x1, y1))
                return false;
        if (!w->replay) {
            clean_row(w->c, row);
            l->rows[y1] = NULL;
        }
    }
    return true;
}

/* ---- a group from begin to end ---- */

static void begin_level(const walk *w, sg_level *l, uint32_t x, uint32_t y)
{
    const uint32_t width = w->c->width - x, height = w->c->height - y;
    l->x = x;
    l->y = y;
    l->stride = width > height ? width : height;
    l->mask = 0;
    l->nsymbols = 0;
    l->nolds = l->nlines = l->ndone = 0;
    l->nlinks = 1;
}

static bool fill_level(const walk *w, sg_level *l)
{
    for (uint32_t i = 0; i < l->nsymbols; i++)
        ((value *)l->b)[l->symbols[i]] = VALUE_ZERO;
    if (!collect_olds(w, l) || !SG_GROW(l->links, l->links_capacity, 1))
        return false;
    for (uint32_t i = 0; i < l->nsymbols; i++) /* what unit rules lead to may have no value and be in no list */
        for (uint32_t k = w->t->units.start[l->symbols[i]]; k < w->t->units.start[l->symbols[i] + 1]; k++)
            ((value *)l->b)[w->t->units.units[k].rhs] = VALUE_ZERO;
    collect_units_of(w, l);
    return collect_leaves(w, l) && seed_olds(w, l);
}

static void clean_level(const walk *w, sg_level *l)
{
    for (uint32_t i = 0; i < l->nsymbols; i++)
        l->in[l->symbols[i]] = 0;
    for (size_t i = 0; i < l->nolds; i++)
        l->in[l->olds[i].symbol] = 0;
    for (size_t i = 0; i < l->nlines; i++)
        l->slots[l->lines[i].slot] = 0;
    for (uint32_t y1 = l->y + 1; y1 <= w->c->height; y1++)
        if (l->rows[y1] != NULL) {
            clean_row(w->c, l->rows[y1]);
            l->rows[y1] = NULL;
        }
}

static sg_comps *new_comps(sg_chart *c, uint32_t n, uint32_t first_end, uint32_t last_end)
{
    sg_comps *k = SG_NEW(c->arena, sg_comps);
    value *v = sg_arena_alloc(c->arena, n * sizeof *v);
    if (k == NULL || v == NULL)
        return NULL;
    if (n == 1) {
        set_single(c, k, first_end & 0xffff, first_end >> 16, v);
        return k;
    }
    const uint32_t base = first_end >> 16, span = (last_end >> 16) - base + 1;
    uint32_t *start = SG_NEW_ARRAY(c->arena, uint32_t, span + 1);
    uint16_t *along = sg_arena_alloc(c->arena, n * sizeof *along);
    if (start == NULL || along == NULL)
        return NULL;
    k->n = n;
    k->form[SG_SPLIT_X] = (sg_comps_form){base, span, start, along, v, NULL};
    return k;
}

/* Sort the finished rectangles by symbol; they stay in the order of the sweep. count[] becomes the places. */
static bool store_comps(const walk *w, sg_level *l)
{
    sg_comps **row = w->c->index[(size_t)l->y * w->c->width + l->x];
    for (uint32_t i = 0; i < l->nsymbols; i++)
        l->count[l->symbols[i]] = 0;
    uint32_t *last = l->unit_symbols; /* no longer needed: place of the last rectangle of each symbol of the group */
    for (size_t i = 0; i < l->ndone; i++) {
        l->count[l->done_symbol[i]]++;
        last[l->done_symbol[i]] = (uint32_t)i;
    }
    for (size_t i = 0; i < l->ndone; i++) {
        const uint32_t s = l->done_symbol[i], end = l->done_end[i];
        if (row[s]->n == 0) {
            row[s] = new_comps(w->c, l->count[s], end, l->done_end[last[s]]);
            if (row[s] == NULL)
                return false;
            l->count[s] = 0;
        }
        sg_comps_form *f = &row[s]->form[SG_SPLIT_X];
        const uint32_t at = l->count[s]++;
        ((value *)f->value)[at] = ((const value *)l->done_value)[i];
        if (row[s]->n > 1) {
            ((uint16_t *)(uintptr_t)f->along)[at] = (uint16_t)(end & 0xffff);
            ((uint32_t *)(uintptr_t)f->start)[(end >> 16) - f->base + 1] = at + 1;
        }
    }
    return true;
}

/* Rows without a rectangle have no place of their own yet. */
static void fill_starts(const walk *w, const sg_level *l)
{
    sg_comps **row = w->c->index[(size_t)l->y * w->c->width + l->x];
    for (uint32_t i = 0; i < l->nsymbols; i++) {
        const sg_comps_form *f = &row[l->symbols[i]]->form[SG_SPLIT_X];
        uint32_t *start = (uint32_t *)(uintptr_t)f->start;
        for (uint32_t k = 0; row[l->symbols[i]]->n > 1 && k < f->span; k++)
            start[k + 1] = start[k + 1] > start[k] ? start[k + 1] : start[k];
    }
}

static bool store_group(const walk *w, const sg_level *l)
{
    sg_group *g = sg_arena_alloc(w->c->arena, sizeof *g + l->nsymbols * sizeof *g->symbols);
    if (g == NULL)
        return false;
    sg_group **head = &w->c->groups[(size_t)l->y * w->c->width + l->x];
    g->next = *head;
    g->n = l->nsymbols;
    memcpy(g->symbols, l->symbols, l->nsymbols * sizeof *g->symbols);
    *head = g;
    return true;
}

static bool predict(const walk *w, size_t depth, uint32_t x, uint32_t y, const uint32_t *ask, size_t nask)
{
    sg_level *l = sg_chart_level(w->c, depth);
    if (l == NULL)
        return false;
    begin_level(w, l, x, y);
    for (size_t i = 0; i < nask; i++)
        if (unknown(w, ask[i], x, y) && !add_to_group(w, l, ask[i]))
            return false;
    if (l->nsymbols == 0)
        return true;
    if (!collect_group(w, l) || !fill_level(w, l) || !sweep(w, depth, l) || !store_comps(w, l) || !store_group(w, l))
        return false;
    fill_starts(w, l);
    clean_level(w, l);
    return true;
}

/* Everything that the axiom over all cells needs. */
static bool run(sg_chart *c)
{
    const walk w = {c, c->table, false};
    const bool ok = !unknown(&w, c->table->axiom, 0, 0) || predict(&w, 0, 0, 0, &c->table->axiom, 1);
    if (!ok)
        sg_chart_drop_levels(c);
    return ok;
}

/* The value of a symbol over a rectangle; zero when it is not in the chart. */
static bool value_at(sg_chart *c, uint32_t s, uint32_t x, uint32_t y, uint32_t x1, uint32_t y1, value *out)
{
    const walk w = {c, c->table, true};
    sg_comps scratch;
    slice k;
    if (!slice_of(c, comps_at(&w, s, x, y, &scratch), SG_SPLIT_X, y1, &k))
        return false;
    *out = VALUE_ZERO;
    for (uint32_t i = 0; i < k.n; i++)
        if (k.along[i] == x1)
            *out = k.v[i];
    return true;
}
