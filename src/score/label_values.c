/* SPDX-License-Identifier: GPL-3.0-or-later */
/* label_values.c - new values of one node: its children get new spots, which are compared with the old ones. A child whose
 * spots are the same is left alone with all that stands below it; one that moved is placed anew beside the tree, and commit
 * copies. A child may also slide: then its sums hold, and commit mends coordinates only. */
#include "core/array.h"
#include "score/label_score_priv.h"

#include <string.h>

/* A child of the node, and what it does. The sums of what will be placed anew are taken off. */
static inline sg_status add_child(sg_label_state *s, sg_label_placing *w, size_t child, sg_label_motion m)
{
    const size_t end = child + w->d->nodes[child].length;
    if (s->nranges == s->ranges_capacity && !SG_GROW(s->ranges, s->ranges_capacity, s->nranges + 1))
        return SG_ENOMEM;
    s->ranges[s->nranges++] = (sg_label_range){child, end, m};
    if (m == SG_MOVED)
        w->sum -= sg_label_sum_nodes(s, child, end);
    return SG_OK;
}

static sg_label_motion motion_along(const sg_label_spot *a, const sg_label_spot *b, unsigned axis, uint8_t cuts)
{
    const unsigned begin = 2 * axis, behind = begin + 1;
    if (a->at[begin] == b->at[begin] && a->at[behind] == b->at[behind])
        return SG_SAME;
    const bool pixels = a->px[begin] == b->px[begin] && a->px[behind] == b->px[behind];
    return pixels && !(cuts >> axis & 1) ? SG_SLID : SG_MOVED;
}

static sg_label_motion larger(sg_label_motion a, sg_label_motion b)
{
    return a > b ? a : b;
}

static sg_label_motion motion_of_child(const sg_label_state *s, const sg_label_placing *w, size_t child)
{
    const uint8_t cuts = sg_label_plan_of(w->t, w->d, child)->cuts;
    const sg_label_spot *now = s->now.spots + sg_label_first_spot(s, child);
    const sg_label_spot *next = s->next.spots + sg_label_spot_of(w, child);
    sg_label_motion most = SG_SAME;
    for (size_t i = 0, n = sg_label_spots_of(w, child); i < n && most != SG_MOVED; i++) {
        most = larger(most, motion_along(now + i, next + i, 0, cuts));
        most = larger(most, motion_along(now + i, next + i, 1, cuts));
    }
    return most;
}

/* ---- any body ---- */

/* The frame of the node with the new values. */
static void make_frame(sg_label_state *s, const sg_change *c)
{
    const sg_derivation *d = c->current;
    const sg_node *n = d->nodes + c->node;
    const uint32_t nparams = sg_grammar_symbol(d->grammar, n->symbol)->nparams;
    const uint32_t nvalues = n->rule < SG_RULE_EMPTY ? sg_grammar_rule(d->grammar, n->rule)->nvalues : 0;
    for (uint32_t i = 0; i < nparams; i++)
        s->frame[i] = d->values[n->values + i];
    for (uint32_t i = 0; i < nvalues; i++)
        s->frame[nparams + i] = c->values[i];
}

static sg_status add_moved(sg_label_state *s, sg_label_placing *w, size_t child)
{
    if (sg_label_plan_of(w->t, w->d, child)->kind == SG_PLAN_LABEL) { /* summed again, whether it moved or not */
        w->sum -= sg_label_sum_nodes(s, child, child + 1);
        return add_child(s, w, child, SG_PLACED);
    }
    const sg_label_motion m = motion_of_child(s, w, child);
    return m == SG_SAME ? SG_OK : add_child(s, w, child, m);
}

static sg_status move_children(sg_label_state *s, sg_label_placing *w, const sg_change *c)
{
    const sg_node *nodes = c->current->nodes;
    const size_t own = sg_label_first_spot(s, c->node), n = sg_label_first_spot(s, c->node + 1) - own;
    memcpy(s->next.spots, s->now.spots + own, n * sizeof *s->next.spots);
    make_frame(s, c);
    w->sum -= sg_label_sum_nodes(s, c->node, c->node + 1);
    SG_TRY(sg_label_place_body(w, c->node, s->frame));
    SG_TRY(add_child(s, w, c->node, SG_PLACED));
    s->ranges[s->nranges - 1].end = c->node + 1;
    for (size_t child = c->node + 1, end = c->node + nodes[c->node].length; child < end; child += nodes[child].length)
        SG_TRY(add_moved(s, w, child));
    return SG_OK;
}

/* ---- splits ---- */

/* Pass the parts in front of the first size that is new: they stay. Returns how many. */
static uint32_t skip_parts(sg_label_walk *walk, const sg_label_plan *p, const sg_change *c)
{
    if (!p->drawn)
        return 0;
    const double *old = c->current->values + c->current->nodes[c->node].values + p->nparams + p->first;
    for (; walk->k + 1 < walk->n && walk->sizes[walk->k] == old[walk->k]; walk->k++)
        walk->sum += old[walk->k];
    return walk->k;
}

/* Stand at the begin of a part that is there already. */
static void stand_at(sg_label_walk *walk, const sg_label_spot *part)
{
    walk->at = part->at[walk->along];
    walk->px = part->px[walk->along];
}

/* A part that ends where it did, and begins there, too; then the walk goes on. */
static inline bool pass_part(sg_label_walk *walk, double end, const sg_label_spot *now)
{
    if (walk->at != now->at[walk->along] || end != now->at[walk->along + 1])
        return false;
    walk->at = end;
    walk->px = now->px[walk->along + 1];
    return true;
}

static sg_status move_split(sg_label_state *s, sg_label_placing *w, const sg_label_plan *p, const sg_change *c)
{
    const sg_node *nodes = c->current->nodes;
    const sg_label_spot *const now = s->now.spots;
    sg_label_walk walk = sg_label_walk_of(w->t, p, c->values, now + c->node);
    size_t child = c->node + 1;
    for (uint32_t skip = skip_parts(&walk, p, c); skip > 0; skip--)
        child += nodes[child].length;
    stand_at(&walk, now + child);
    for (; walk.k < walk.n; child += nodes[child].length) {
        const double end = sg_label_walk_end(&walk);
        if (pass_part(&walk, end, now + child))
            continue;
        const sg_label_plan *part = sg_label_plan_of(w->t, w->d, child);
        sg_label_spot *next = s->next.spots + (child - w->base);
        const int64_t sum = s->next.sums[child - w->base] = sg_label_walk_to(&walk, end, part, next);
        if (part->kind == SG_PLAN_LABEL)
            w->sum += sum - s->now.sums[child];
        SG_TRY(add_child(s, w, child,
                         part->kind == SG_PLAN_LABEL ? SG_PLACED : motion_along(now + child, next, p->axis, part->cuts)));
    }
    return SG_OK;
}

/* A part of a tied split that moved, whose spot is there. Spots of the child's other copies stay, so far. */
static void move_tied_part(sg_label_state *s, sg_label_placing *w, sg_label_child *c, size_t spot, sg_label_walk *walk,
                           double end)
{
    const sg_label_spot *now = s->now.spots + w->base;
    const int64_t *sums = s->now.sums + w->base;
    const size_t n = sg_label_spots_of(w, c->node);
    if (c->motion == SG_SAME) {
        memcpy(s->next.spots + c->spot, now + c->spot, n * sizeof *now);
        memcpy(s->next.sums + c->spot, sums + c->spot, n * sizeof *sums);
    }
    const int64_t sum = sg_label_walk_to(walk, end, c->plan, s->next.spots + spot);
    if (c->plan->kind == SG_PLAN_LABEL) {
        w->sum += sum - sums[spot];
        s->next.sums[spot] = sum;
        c->motion = SG_PLACED;
    } else {
        c->motion = larger(c->motion, motion_along(now + spot, s->next.spots + spot, walk->along / 2, c->plan->cuts));
    }
}

static void move_tied_parts(sg_label_state *s, sg_label_placing *w, const sg_label_plan *p, const sg_change *c, size_t i)
{
    const sg_label_part *const parts = w->t->plans.parts + p->part;
    const sg_label_spot *const now = s->now.spots + w->base;
    sg_label_walk walk = sg_label_walk_of(w->t, p, c->values, now + i);
    const uint32_t skip = skip_parts(&walk, p, c);
    for (const sg_label_part *q = parts + skip; q < parts + p->n; q++) {
        sg_label_child *child = s->scratch.children + q->child;
        const size_t spot = child->spot + i * q->copies + q->copy;
        if (q == parts + skip)
            stand_at(&walk, now + spot);
        const double end = sg_label_walk_end(&walk);
        if (!pass_part(&walk, end, now + spot))
            move_tied_part(s, w, child, spot, &walk, end);
    }
}

static sg_status move_tied_split(sg_label_state *s, sg_label_placing *w, const sg_label_plan *p, const sg_change *c)
{
    const sg_label_part *const parts = w->t->plans.parts + p->part;
    if (!sg_label_list_children(w, p, c->node))
        return SG_ENOMEM;
    for (size_t i = 0, n = sg_label_spots_of(w, c->node); i < n; i++)
        move_tied_parts(s, w, p, c, i);
    for (const sg_label_part *q = parts; q < parts + p->n; q++) {
        const sg_label_child *child = s->scratch.children + q->child;
        if (q->copy == 0 && child->motion != SG_SAME)
            SG_TRY(add_child(s, w, child->node, child->motion));
    }
    w->now = &s->now;
    return SG_OK;
}

/* ---- proposals ---- */

static sg_status place_moved(sg_label_state *s, sg_label_placing *w)
{
    for (const sg_label_range *r = s->ranges; r < s->ranges + s->nranges; r++)
        if (r->motion == SG_MOVED)
            SG_TRY(sg_label_place_nodes(w, r->first, r->end));
    return SG_OK;
}

sg_status sg_label_propose_values(sg_label_state *s, const sg_change *c, int64_t most)
{
    const size_t first = sg_label_first_spot(s, c->node);
    const size_t end = sg_label_first_spot(s, c->node + c->current->nodes[c->node].length);
    const sg_label_plan *p = sg_label_plan_of(sg_label_target_of(s), c->current, c->node);
    sg_label_placing w = sg_label_placing_of(s, c->current);
    w.first = s->now.first;
    w.base = first;
    w.sum = s->sum;
    s->nranges = 0;
    if (!sg_label_table_reserve(&s->next, 0, end - first, false))
        return SG_ENOMEM;
    if (p->kind != SG_PLAN_SPLIT)
        SG_TRY(move_children(s, &w, c));
    else
        SG_TRY((w.first != NULL ? move_tied_split : move_split)(s, &w, p, c));
    w.most = most;
    SG_TRY(place_moved(s, &w));
    s->next_sum = w.sum;
    s->pending = SG_PENDING_VALUES;
    return SG_OK;
}

/* ---- commit ---- */

/* What stands below a child that slid lies along its old coordinates where nothing is cut. */
static void mend_coordinates(sg_label_state *s, const sg_label_range *r)
{
    const uint8_t cuts = sg_label_plan_of(sg_label_target_of(s), s->change->current, r->first)->cuts;
    const size_t own = sg_label_first_spot(s, r->first), n = sg_label_first_spot(s, r->first + 1) - own;
    for (size_t node = r->first + 1; node < r->end; node++) {
        const size_t first = sg_label_first_spot(s, node), all = sg_label_first_spot(s, node + 1) - first;
        for (size_t i = 0; i < all; i++)
            for (unsigned edge = 0; edge < 4; edge++)
                if (!(cuts >> edge / 2 & 1))
                    s->now.spots[first + i].at[edge] = s->now.spots[own + i / (all / n)].at[edge];
    }
}

static void copy_range(sg_label_state *s, const sg_label_range *r, size_t base)
{
    const size_t end = r->motion == SG_SLID ? r->first + 1 : r->end;
    const size_t first = sg_label_first_spot(s, r->first), n = sg_label_first_spot(s, end) - first;
    memcpy(s->now.spots + first, s->next.spots + (first - base), n * sizeof *s->now.spots);
    if (r->motion == SG_SLID)
        mend_coordinates(s, r);
    else
        memcpy(s->now.sums + first, s->next.sums + (first - base), n * sizeof *s->now.sums);
}

void sg_label_commit_values(sg_label_state *s)
{
    for (const sg_label_range *r = s->ranges; r < s->ranges + s->nranges; r++)
        copy_range(s, r, sg_label_first_spot(s, s->change->node));
}
