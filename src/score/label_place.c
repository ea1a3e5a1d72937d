/* SPDX-License-Identifier: GPL-3.0-or-later */
/* label_place.c - places trees top down, node by node in pre-order: a node's spots stand in the table when its turn comes,
 * its parent has put them there. So nothing recurses and memory is walked forward. */
#include "core/array.h"
#include "scene/label_scene.h"
#include "score/label_score_priv.h"

#include <stdlib.h>
#include <string.h>

void sg_label_table_clear(sg_label_table *t)
{
    free(t->spots);
    free(t->sums);
    free(t->first);
    memset(t, 0, sizeof *t);
}

bool sg_label_table_reserve(sg_label_table *t, size_t nodes, size_t spots, bool tied)
{
    if (spots <= t->spots_capacity && spots <= t->sums_capacity && (!tied || nodes < t->first_capacity))
        return true;
    return SG_GROW(t->spots, t->spots_capacity, spots) && SG_GROW(t->sums, t->sums_capacity, spots) &&
           (!tied || SG_GROW(t->first, t->first_capacity, nodes + 1));
}

/* ---- labels ---- */

static inline int64_t sum_spot(const sg_label_sums *s, uint32_t channel, const int32_t *px)
{
    const int64_t *const bottom = s->sums + channel + (size_t)px[SG_BOTTOM] * s->row;
    const int64_t *const top = s->sums + channel + (size_t)px[SG_TOP] * s->row;
    const size_t left = (size_t)px[SG_LEFT] * s->channels, right = (size_t)px[SG_RIGHT] * s->channels;
    return bottom[right] - bottom[left] - (top[right] - top[left]);
}

void sg_label_place_label(sg_label_placing *w, size_t node)
{
    const uint32_t channel = sg_label_plan_of(w->t, w->d, node)->channel;
    const size_t first = sg_label_spot_of(w, node), end = first + sg_label_spots_of(w, node);
    for (size_t i = first; i < end; i++)
        w->sum += w->to->sums[i] = sum_spot(&w->t->image, channel, w->to->spots[i].px);
}

/* ---- splits ---- */

static inline sg_status place_split(sg_label_placing *w, const sg_label_plan *p, size_t node, const double *draws)
{
    const sg_node *nodes = w->d->nodes;
    sg_label_spot *const spots = w->to->spots;
    int64_t *const sums = w->to->sums, sum = 0;
    sg_label_walk walk = sg_label_walk_of(w->t, p, draws, spots + (node - w->base));
    const size_t end = node + nodes[node].length;
    size_t child = node + 1;
    sums[node - w->base] = 0;
    for (; walk.k < walk.n && child < end; child += nodes[child].length) {
        const sg_label_plan *part = sg_label_plan_of(w->t, w->d, child);
        sum += sums[child - w->base] =
            sg_label_walk_to(&walk, sg_label_walk_end(&walk), part, spots + (child - w->base));
    }
    w->sum += sum;
    return walk.k == walk.n && child == end && w->sum <= w->most ? SG_OK : SG_ENUMERIC;
}

bool sg_label_list_children(sg_label_placing *w, const sg_label_plan *p, size_t node)
{
    const sg_label_part *const parts = w->t->plans.parts + p->part;
    sg_label_scratch *s = w->scratch;
    size_t child = node + 1;
    if (p->n > s->children_capacity && !SG_GROW(s->children, s->children_capacity, p->n))
        return false;
    for (uint32_t k = 0; k < p->n; k++)
        if (parts[k].copy == 0) {
            s->children[parts[k].child] = (sg_label_child){child, sg_label_spot_of(w, child),
                                                           sg_label_plan_of(w->t, w->d, child), SG_SAME};
            child += w->d->nodes[child].length;
        }
    return true;
}

/* Occurrence i of a node, whose own spot is number `own`. */
static void place_tied_parts(sg_label_placing *w, const sg_label_plan *p, size_t own, size_t i, const double *draws)
{
    const sg_label_part *const parts = w->t->plans.parts + p->part;
    const sg_label_child *const children = w->scratch->children;
    int64_t sum = 0;
    sg_label_walk walk = sg_label_walk_of(w->t, p, draws, w->to->spots + own);
    for (const sg_label_part *q = parts; q < parts + p->n; q++) {
        const sg_label_child *c = children + q->child;
        const size_t spot = c->spot + i * q->copies + q->copy;
        sum += w->to->sums[spot] = sg_label_walk_to(&walk, sg_label_walk_end(&walk), c->plan, w->to->spots + spot);
    }
    w->sum += sum;
}

static bool stays(const sg_label_placing *w, size_t spot)
{
    const double *const now = w->now->spots[w->base + spot].at, *const next = w->to->spots[spot].at;
    return now[0] == next[0] && now[1] == next[1] && now[2] == next[2] && now[3] == next[3];
}

/* The same, when the node's spot is where it was. */
static void copy_tied_parts(sg_label_placing *w, const sg_label_plan *p, size_t i)
{
    const sg_label_part *const parts = w->t->plans.parts + p->part;
    const sg_label_child *const children = w->scratch->children;
    for (const sg_label_part *q = parts; q < parts + p->n; q++) {
        const size_t spot = children[q->child].spot + i * q->copies + q->copy;
        w->to->spots[spot] = w->now->spots[w->base + spot];
        w->to->sums[spot] = children[q->child].plan->kind == SG_PLAN_LABEL ? w->now->sums[w->base + spot] : 0;
        w->sum += w->to->sums[spot];
    }
}

static sg_status place_tied_split(sg_label_placing *w, const sg_label_plan *p, size_t node, const double *draws)
{
    const size_t own = sg_label_spot_of(w, node), n = sg_label_spots_of(w, node);
    if (!sg_label_list_children(w, p, node))
        return SG_ENOMEM;
    for (size_t i = 0; i < n; i++)
        if (w->now != NULL && stays(w, own + i))
            copy_tied_parts(w, p, i);
        else
            place_tied_parts(w, p, own + i, i, draws);
    return w->sum <= w->most ? SG_OK : SG_ENUMERIC;
}

/* ---- other bodies ---- */

static sg_label_spot spot_at(sg_rect r)
{
    return (sg_label_spot){{r.x0, r.x1, r.y1, r.y0},
                           {sg_label_pixel(r.x0), sg_label_pixel(r.x1), sg_label_pixel(r.y1), sg_label_pixel(r.y0)}};
}

static sg_rect rect_of(const sg_label_spot *s)
{
    return (sg_rect){s->at[SG_LEFT], s->at[SG_TOP], s->at[SG_RIGHT], s->at[SG_BOTTOM]};
}

static size_t *numbers(sg_label_placing *w, size_t n)
{
    sg_label_scratch *s = w->scratch;
    return SG_GROW(s->numbers, s->numbers_capacity, n) ? s->numbers : NULL;
}

/* Copies of the child in one occurrence of its parent, which has n. */
static size_t copies_of(const sg_label_placing *w, size_t child, size_t n)
{
    return sg_label_spots_of(w, child) / n;
}

/* What the placer has put for occurrence i of the node, which has n; seen[] counts the copies of each child, by its distance. */
static sg_status take_places(sg_label_placing *w, size_t node, size_t i, size_t n, size_t *seen)
{
    const sg_placer *placer = &w->scratch->placer;
    int64_t sum = 0;
    for (const sg_place *p = placer->items; p < placer->items + placer->n; p++) {
        const sg_label_spot spot = spot_at(p->rect);
        if (p->label != SG_NONE) {
            sum += sum_spot(&w->t->image, w->t->channel[p->label], spot.px);
            w->labels++;
            continue;
        }
        const size_t copies = copies_of(w, p->node, n), copy = seen[p->node - node]++;
        if (copy >= copies)
            return SG_ENUMERIC;
        const sg_label_plan *child = sg_label_plan_of(w->t, w->d, p->node);
        const size_t at = sg_label_spot_of(w, p->node) + i * copies + copy;
        w->to->spots[at] = spot;
        w->to->sums[at] = child->kind == SG_PLAN_LABEL ? sum_spot(&w->t->image, child->channel, spot.px) : 0;
        w->sum += w->to->sums[at];
    }
    w->to->sums[sg_label_spot_of(w, node) + i] = sum;
    w->sum += sum;
    return SG_OK;
}

static sg_status place_general(sg_label_placing *w, size_t node, const double *frame)
{
    const size_t n = sg_label_spots_of(w, node), end = node + w->d->nodes[node].length;
    size_t *const seen = numbers(w, end - node);
    sg_placer *placer = &w->scratch->placer;
    if (seen == NULL)
        return SG_ENOMEM;
    for (size_t i = 0; i < n; i++) {
        const sg_rect at = rect_of(w->to->spots + sg_label_spot_of(w, node) + i);
        memset(seen, 0, (end - node) * sizeof *seen);
        sg_placer_reset(placer);
        SG_TRY(sg_placer_place_frame(placer, w->d, node, frame, at, NULL));
        SG_TRY(take_places(w, node, i, n, seen));
        for (size_t c = node + 1; c < end; c += w->d->nodes[c].length)
            if (seen[c - node] != copies_of(w, c, n))
                return SG_ENUMERIC; /* more children than its rule asks for */
    }
    return w->sum > w->most ? SG_ENUMERIC : SG_OK;
}

/* ---- trees ---- */

sg_status sg_label_place_body(sg_label_placing *w, size_t node, const double *frame)
{
    const sg_label_plan *p = sg_label_plan_of(w->t, w->d, node);
    switch ((sg_plan_kind)p->kind) {
    case SG_PLAN_SPLIT:
        return w->first != NULL ? place_tied_split(w, p, node, frame + p->nparams)
                                : place_split(w, p, node, frame + p->nparams);
    case SG_PLAN_BODY:
        return place_general(w, node, frame);
    case SG_PLAN_LABEL: /* its parent has summed it */
    case SG_PLAN_OPEN:
        return SG_OK;
    case SG_PLAN_HOLE:
        break;
    }
    return SG_ENUMERIC;
}

/* The usual cases stand in the loop itself. */
sg_status sg_label_place_nodes(sg_label_placing *w, size_t first, size_t end)
{
    const sg_node *const nodes = w->d->nodes;
    for (size_t node = first; node < end; node++) {
        const sg_label_plan *p = sg_label_plan_of(w->t, w->d, node);
        const double *frame = w->d->values + nodes[node].values;
        if (p->kind == SG_PLAN_LABEL)
            continue;
        if (p->kind == SG_PLAN_SPLIT && w->first == NULL)
            SG_TRY(place_split(w, p, node, frame + p->nparams));
        else
            SG_TRY(sg_label_place_body(w, node, frame));
    }
    return SG_OK;
}

/* ---- numbers of spots ---- */

/* How often the op of a body places the child that it stands for. */
static size_t copies_of_op(const sg_rule *r, size_t at)
{
    size_t copies = 0;
    bool outside = false;
    for (size_t i = 0; i < r->nops; i++) {
        if (r->ops[i].kind == SG_OP_REPEAT) {
            i += r->ops[i].length - 1;
        } else if (r->ops[i].kind == SG_OP_SUCCESSOR && r->ops[i].child == r->ops[at].child) {
            copies++;
            outside = outside || i == at;
        }
    }
    return outside ? copies : 1;
}

/* Spots of a child, for now in the place of its first spot. */
static sg_status count_child(sg_label_placing *w, size_t node, size_t child, size_t copies)
{
    if (child >= node + w->d->nodes[node].length || copies > SG_LABEL_SCENE_MAX_PLACES)
        return SG_ENUMERIC;
    const size_t n = w->to->first[node] * copies;
    if (n > SG_LABEL_SCENE_MAX_PLACES)
        return SG_ENUMERIC;
    w->to->first[child] = (uint32_t)n;
    return SG_OK;
}

static sg_status count_general(sg_label_placing *w, size_t node)
{
    const sg_node *n = w->d->nodes + node;
    const sg_rule *r = sg_grammar_rule(w->d->grammar, n->rule);
    sg_child_list *list = &w->scratch->list;
    list->n = 0;
    const sg_status st = sg_derivation_list_children(w->d->grammar, r, w->d->values + n->values, n->depth, 0, n->length,
                                                     list, NULL);
    if (st != SG_OK)
        return st == SG_ENOMEM ? st : SG_ENUMERIC;
    size_t child = node + 1;
    for (size_t k = 0; k < list->n; k++) {
        SG_TRY(count_child(w, node, child, copies_of_op(r, list->items[k].op)));
        child += w->d->nodes[child].length;
    }
    return child == node + n->length ? SG_OK : SG_ENUMERIC;
}

static sg_status count_split(sg_label_placing *w, const sg_label_plan *p, size_t node)
{
    const sg_label_part *part = w->t->plans.parts + p->part, *const end = part + p->n;
    size_t child = node + 1;
    for (; part < end; part++) {
        if (part->copy > 0)
            continue;
        SG_TRY(count_child(w, node, child, part->copies));
        child += w->d->nodes[child].length;
    }
    return child == node + w->d->nodes[node].length ? SG_OK : SG_ENUMERIC;
}

sg_status sg_label_number_spots(sg_label_placing *w, size_t copies)
{
    uint32_t *first = w->to->first;
    const size_t n = w->d->nnodes;
    size_t sum = 0;
    first[0] = (uint32_t)copies;
    for (size_t node = 0; node < n; node++) {
        const sg_label_plan *p = sg_label_plan_of(w->t, w->d, node);
        if (p->kind == SG_PLAN_SPLIT)
            SG_TRY(count_split(w, p, node));
        else if (p->kind == SG_PLAN_BODY)
            SG_TRY(count_general(w, node));
    }
    for (size_t node = 0; node < n; node++) {
        const uint32_t count = first[node];
        first[node] = (uint32_t)sum;
        if ((sum += count) > SG_LABEL_SCENE_MAX_PLACES + 1)
            return SG_ENUMERIC;
    }
    first[n] = (uint32_t)sum;
    return SG_OK;
}
