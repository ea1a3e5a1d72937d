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

/* ---- sums ---- */

static int64_t sum_spot(const sg_label_sums *s, uint32_t channel, const sg_label_spot *p)
{
    const size_t row = s->width + 1;
    const int64_t *const top = s->sums + channel + (size_t)p->y0 * row * s->channels;
    const int64_t *const bottom = s->sums + channel + (size_t)p->y1 * row * s->channels;
    const size_t left = (size_t)p->x0 * s->channels, right = (size_t)p->x1 * s->channels;
    return bottom[right] - bottom[left] - (top[right] - top[left]);
}

static sg_status place_label(sg_label_placing *w, const sg_label_plan *p, size_t node)
{
    const size_t first = sg_label_spot_of(w, node), end = first + sg_label_spots_of(w, node);
    for (size_t i = first; i < end; i++)
        w->sum += w->to->sums[i] = sum_spot(&w->t->image, p->channel, w->to->spots + i);
    w->places += end - first;
    return w->sum > w->most ? SG_ENUMERIC : SG_OK;
}

/* ---- splits ---- */

/* Walks along a split from part to part. */
typedef struct {
    const double *sizes, *ends; /* one of them is NULL */
    double from, to;            /* the scope: where shares 0 and 1 lie */
    uint32_t k, n;
    double sum;
    sg_label_spot spot; /* of the part */
    bool y;
} cutter;

static cutter cutter_of(const sg_label_target *t, const sg_label_plan *p, const double *draws, const sg_label_spot *s)
{
    return (cutter){.sizes = p->drawn ? draws + p->first : NULL,
                    .ends = p->drawn ? NULL : t->plans.ends + p->first,
                    .from = p->y ? s->at.y1 : s->at.x0,
                    .to = p->y ? s->at.y0 : s->at.x1,
                    .n = p->n,
                    .spot = *s,
                    .y = p->y};
}

/* Move to the first part. */
static inline void cut_first(cutter *c)
{
    if (c->y) {
        c->spot.at.y0 = c->spot.at.y1;
        c->spot.y0 = c->spot.y1;
    } else {
        c->spot.at.x1 = c->spot.at.x0;
        c->spot.x1 = c->spot.x0;
    }
}

/* The spot of the next part. */
static inline const sg_label_spot *cut_next(cutter *c)
{
    double share = 1;
    if (c->ends != NULL)
        share = c->ends[c->k];
    else if (c->k + 1 < c->n)
        share = sg_placer_share(c->sum += c->sizes[c->k]);
    c->k++;
    const double at = sg_placer_cut(c->from, c->to, share);
    if (c->y) {
        c->spot.at.y1 = c->spot.at.y0;
        c->spot.y1 = c->spot.y0;
        c->spot.at.y0 = at;
        c->spot.y0 = sg_label_pixel(at);
    } else {
        c->spot.at.x0 = c->spot.at.x1;
        c->spot.x0 = c->spot.x1;
        c->spot.at.x1 = at;
        c->spot.x1 = sg_label_pixel(at);
    }
    return &c->spot;
}

static sg_status place_split(sg_label_placing *w, const sg_label_plan *p, size_t node, const double *draws)
{
    const sg_node *nodes = w->d->nodes;
    sg_label_spot *const spots = w->to->spots;
    const size_t end = node + nodes[node].length;
    cutter c = cutter_of(w->t, p, draws, spots + (node - w->base));
    w->to->sums[node - w->base] = 0;
    cut_first(&c);
    size_t child = node + 1;
    for (; c.k < c.n && child < end; child += nodes[child].length)
        spots[child - w->base] = *cut_next(&c);
    return c.k == c.n && child == end ? SG_OK : SG_ENUMERIC;
}

static size_t *numbers(sg_label_placing *w, size_t n)
{
    sg_label_scratch *s = w->scratch;
    return SG_GROW(s->numbers, s->numbers_capacity, n) ? s->numbers : NULL;
}

static sg_status place_tied_split(sg_label_placing *w, const sg_label_plan *p, size_t node, const double *draws)
{
    const sg_label_part *parts = w->t->plans.parts + p->part;
    const size_t own = sg_label_spot_of(w, node), n = sg_label_spots_of(w, node);
    size_t child = node + 1, *const spot_of = numbers(w, p->n);
    if (spot_of == NULL)
        return SG_ENOMEM;
    for (uint32_t k = 0; k < p->n; k++)
        if (parts[k].copy == 0) {
            spot_of[parts[k].child] = sg_label_spot_of(w, child);
            child += w->d->nodes[child].length;
        }
    for (size_t i = 0; i < n; i++) {
        cutter c = cutter_of(w->t, p, draws, w->to->spots + own + i);
        w->to->sums[own + i] = 0;
        cut_first(&c);
        for (const sg_label_part *part = parts; part < parts + p->n; part++)
            w->to->spots[spot_of[part->child] + i * part->copies + part->copy] = *cut_next(&c);
    }
    return SG_OK;
}

/* ---- other bodies ---- */

static sg_label_spot spot_at(sg_rect r)
{
    return (sg_label_spot){r, sg_label_pixel(r.x0), sg_label_pixel(r.y0), sg_label_pixel(r.x1), sg_label_pixel(r.y1)};
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
            sum += sum_spot(&w->t->image, w->t->channel[p->label], &spot);
            w->places++;
            continue;
        }
        const size_t copies = copies_of(w, p->node, n), copy = seen[p->node - node]++;
        if (copy >= copies)
            return SG_ENUMERIC;
        w->to->spots[sg_label_spot_of(w, p->node) + i * copies + copy] = spot;
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
        const sg_rect at = w->to->spots[sg_label_spot_of(w, node) + i].at;
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

static sg_status place_nothing(sg_label_placing *w, size_t node)
{
    memset(w->to->sums + sg_label_spot_of(w, node), 0, sg_label_spots_of(w, node) * sizeof *w->to->sums);
    return SG_OK;
}

sg_status sg_label_place_body(sg_label_placing *w, size_t node, const double *frame)
{
    const sg_label_plan *p = sg_label_plan_of(w->t, w->d, node);
    switch ((sg_plan_kind)p->kind) {
    case SG_PLAN_LABEL:
        return place_label(w, p, node);
    case SG_PLAN_SPLIT:
        return (w->first != NULL ? place_tied_split : place_split)(w, p, node, frame + p->nparams);
    case SG_PLAN_BODY:
        return place_general(w, node, frame);
    case SG_PLAN_OPEN:
        return place_nothing(w, node);
    case SG_PLAN_HOLE:
        break;
    }
    return SG_ENUMERIC;
}

sg_status sg_label_place_nodes(sg_label_placing *w, size_t first, size_t end)
{
    for (size_t node = first; node < end; node++)
        SG_TRY(sg_label_place_body(w, node, w->d->values + w->d->nodes[node].values));
    w->places += sg_label_spot_of(w, end) - sg_label_spot_of(w, first);
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
