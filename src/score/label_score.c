/* SPDX-License-Identifier: GPL-3.0-or-later */
/* label_score.c - states of label scores: where a derivation stands, and what a change of it moves.
 *
 * A slice is placed beside the tree, in the spots of the node that it replaces; commit splices tables. New values of a node
 * give its children new spots, which are compared with the old ones: a child whose spots are the same is left alone with all
 * that stands below it, one that moved is placed anew beside the tree, and commit copies. A child may also move by less than
 * a pixel along an axis that nothing below it cuts: then its sums hold, and commit mends coordinates only. */
#include "core/array.h"
#include "scene/label_scene.h"
#include "score/label_score_priv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static sg_status create_state(const sg_score *target, sg_score_state **out, sg_error *err)
{
    const sg_grammar *g = ((const sg_label_target *)target)->g;
    sg_label_state *s = calloc(1, sizeof *s);
    double *frame = calloc(sg_grammar_frame_size(g) + 1, sizeof *frame);
    if (s == NULL || frame == NULL) {
        free(s);
        free(frame);
        return SG_FAIL_NOMEM(err);
    }
    s->state.target = target;
    s->frame = frame;
    sg_derivation_init(&s->whole, g);
    *out = &s->state;
    return SG_OK;
}

static void destroy_state(sg_score_state *state)
{
    sg_label_state *s = (sg_label_state *)state;
    sg_label_table_clear(&s->now);
    sg_label_table_clear(&s->next);
    sg_placer_clear(&s->scratch.placer);
    sg_derivation_clear(&s->whole);
    free(s->scratch.list.items);
    free(s->scratch.children);
    free(s->scratch.numbers);
    free(s->ranges);
    free(s->frame);
    free(s);
}

/* ---- values ---- */

static void set_value(const sg_label_target *t, int64_t sum, sg_score_value *out)
{
    out->log = -t->nats * (double)(t->image.base + sum);
    out->value = out->log / ((double)t->image.width * (double)t->image.height);
}

static const sg_score_value no_scene = {-INFINITY, -INFINITY};

/* The largest sum whose log is not below floor, and a little more. */
static int64_t most_of(const sg_label_target *t, double floor)
{
    const double units = floor / -t->nats, enough = units + fabs(units) * 0x1p-50 + 1;
    if (!(enough < 0x1p62))
        return INT64_MAX;
    return enough < -1 ? -1 : (int64_t)enough - t->image.base;
}

/* ---- placing ---- */

sg_label_placing sg_label_placing_of(sg_label_state *s, const sg_derivation *d)
{
    return (sg_label_placing){
        .t = sg_label_target_of(s), .d = d, .to = &s->next, .most = INT64_MAX, .scratch = &s->scratch};
}

/* Place w->d in n spots beside the tree. */
static sg_status place_tree(sg_label_placing *w, const sg_label_spot *spots, size_t n)
{
    sg_label_table *to = w->to;
    to->nnodes = to->nspots = w->d->nnodes;
    if (w->t->tied) {
        if (!sg_label_table_reserve(to, to->nnodes, 0, true))
            return SG_ENOMEM;
        SG_TRY(sg_label_number_spots(w, n));
        to->nspots = to->first[to->nnodes];
        w->first = to->first;
    }
    if (!sg_label_table_reserve(to, to->nnodes, to->nspots, w->t->tied))
        return SG_ENOMEM;
    memcpy(to->spots, spots, n * sizeof *spots);
    memset(to->sums, 0, n * sizeof *to->sums);
    if (sg_label_plan_of(w->t, w->d, 0)->kind == SG_PLAN_LABEL)
        sg_label_place_label(w, 0);
    return sg_label_place_nodes(w, 0, to->nnodes);
}

/* Places of what was placed, its root among them: a label stands in each spot of a lexical node, too. */
static size_t count_places(const sg_label_placing *w)
{
    size_t places = w->to->nspots + w->labels;
    for (size_t node = 0; node < w->d->nnodes; node++)
        if (sg_label_plan_of(w->t, w->d, node)->kind == SG_PLAN_LABEL)
            places += sg_label_spots_of(w, node);
    return places;
}

/* The same or more, quickly. */
static size_t bound_places(const sg_label_placing *w)
{
    return 2 * w->to->nspots + w->labels;
}

/* A whole derivation, from scratch. */
static sg_status place_whole(sg_label_state *s, const sg_derivation *d)
{
    const sg_label_target *t = sg_label_target_of(s);
    const int32_t width = (int32_t)t->image.width, height = (int32_t)t->image.height;
    const sg_label_spot spot = {{0, width, height, 0}, {0, width, height, 0}};
    sg_label_placing w = sg_label_placing_of(s, d);
    if (d->nnodes == 0)
        return SG_ENUMERIC;
    SG_TRY(place_tree(&w, &spot, 1));
    s->next_sum = w.sum;
    s->next_places = bound_places(&w);
    if (s->next_places > SG_LABEL_SCENE_MAX_PLACES)
        s->next_places = count_places(&w) - 1; /* the root is not placed by a body */
    return s->next_places <= SG_LABEL_SCENE_MAX_PLACES ? SG_OK : SG_ENUMERIC;
}

static void stand_at_next(sg_label_state *s)
{
    const sg_label_table swap = s->now;
    s->now = s->next;
    s->next = swap;
    s->places = s->next_places;
    s->stands = true;
}

static sg_status evaluate(sg_score_state *state, const sg_derivation *d, sg_score_value *out, sg_error *err)
{
    sg_label_state *s = (sg_label_state *)state;
    if (d->grammar != sg_label_target_of(s)->g)
        return SG_FAIL(err, SG_EINVAL, "the score was made for another grammar");
    s->pending = SG_PENDING_NONE;
    const sg_status st = place_whole(s, d);
    if (st == SG_ENOMEM)
        return SG_FAIL_NOMEM(err);
    s->stands = false;
    *out = no_scene;
    if (st == SG_OK) {
        stand_at_next(s);
        s->sum = s->next_sum;
        set_value(sg_label_target_of(s), s->sum, out);
    }
    return SG_OK;
}

/* ---- proposals ---- */

int64_t sg_label_sum_nodes(const sg_label_state *s, size_t first, size_t end)
{
    int64_t sum = 0;
    for (size_t i = sg_label_first_spot(s, first), n = sg_label_first_spot(s, end); i < n; i++)
        sum += s->now.sums[i];
    return sum;
}

/* The changed derivation from scratch: where there is nothing to start from. */
static sg_status propose_whole(sg_label_state *s, const sg_change *c)
{
    SG_TRY(sg_derivation_copy(&s->whole, c->current, NULL));
    if (c->slice != NULL) {
        SG_TRY(sg_derivation_splice(&s->whole, c->node, c->slice, NULL));
    } else {
        const sg_node *n = s->whole.nodes + c->node;
        const sg_rule *r = sg_grammar_rule(s->whole.grammar, n->rule);
        const uint32_t nparams = sg_grammar_symbol(s->whole.grammar, n->symbol)->nparams;
        memcpy(s->whole.values + n->values + nparams, c->values, r->nvalues * sizeof *c->values);
    }
    SG_TRY(place_whole(s, &s->whole));
    s->pending = SG_PENDING_WHOLE;
    return SG_OK;
}

static sg_status propose_slice(sg_label_state *s, const sg_change *c, int64_t most)
{
    const size_t end = c->node + c->current->nodes[c->node].length;
    const size_t first = sg_label_first_spot(s, c->node), behind = sg_label_first_spot(s, end);
    const size_t n = sg_label_target_of(s)->tied ? s->now.first[c->node + 1] - first : 1;
    sg_label_placing w = sg_label_placing_of(s, c->slice);
    w.sum = s->sum - sg_label_sum_nodes(s, c->node, end);
    w.most = most;
    SG_TRY(place_tree(&w, s->now.spots + first, n));
    s->next_sum = w.sum;
    s->next_places = s->places + bound_places(&w);
    if (s->next_places > SG_LABEL_SCENE_MAX_PLACES)
        return propose_whole(s, c); /* perhaps: places of what goes were not taken off */
    if (!sg_label_table_reserve(&s->now, s->now.nnodes - (end - c->node) + s->next.nnodes,
                                s->now.nspots - (behind - first) + s->next.nspots, sg_label_target_of(s)->tied))
        return SG_ENOMEM;
    s->pending = SG_PENDING_SLICE;
    return SG_OK;
}

static sg_status propose(sg_score_state *state, const sg_change *change, double floor, sg_score_value *out,
                         sg_error *err)
{
    sg_label_state *s = (sg_label_state *)state;
    const int64_t most = most_of(sg_label_target_of(s), floor);
    s->change = change;
    s->pending = SG_PENDING_NONE;
    const sg_status st = !s->stands              ? propose_whole(s, change)
                         : change->slice != NULL ? propose_slice(s, change, most)
                                                 : sg_label_propose_values(s, change, most);
    if (st == SG_ENOMEM)
        return SG_FAIL_NOMEM(err);
    *out = no_scene;
    if (st == SG_OK)
        set_value(sg_label_target_of(s), s->next_sum, out);
    return SG_OK;
}

/* ---- commit ---- */

static void splice_slice(sg_label_state *s)
{
    const size_t node = s->change->node, end = node + s->change->current->nodes[node].length;
    const size_t first = sg_label_first_spot(s, node), behind = sg_label_first_spot(s, end), tail = s->now.nspots - behind;
    sg_label_table *now = &s->now;
    const sg_label_table *next = &s->next;
    if (first + next->nspots != behind) {
        memmove(now->spots + first + next->nspots, now->spots + behind, tail * sizeof *now->spots);
        memmove(now->sums + first + next->nspots, now->sums + behind, tail * sizeof *now->sums);
    }
    memcpy(now->spots + first, next->spots, next->nspots * sizeof *now->spots);
    memcpy(now->sums + first, next->sums, next->nspots * sizeof *now->sums);
    if (sg_label_target_of(s)->tied) {
        uint32_t *const to = now->first + node + next->nnodes;
        memmove(to, now->first + end, (now->nnodes + 1 - end) * sizeof *to);
        for (size_t i = 0; i <= now->nnodes - end; i++)
            to[i] = (uint32_t)(to[i] - behind + first + next->nspots);
        for (size_t i = 0; i < next->nnodes; i++)
            now->first[node + i] = (uint32_t)(first + next->first[i]);
    }
    now->nnodes = now->nnodes - (end - node) + next->nnodes;
    now->nspots = first + next->nspots + tail;
    s->places = s->next_places;
}

static void commit(sg_score_state *state)
{
    sg_label_state *s = (sg_label_state *)state;
    switch (s->pending) {
    case SG_PENDING_NONE:
        return;
    case SG_PENDING_WHOLE:
        stand_at_next(s);
        break;
    case SG_PENDING_SLICE:
        splice_slice(s);
        break;
    case SG_PENDING_VALUES:
        sg_label_commit_values(s);
        break;
    }
    s->sum = s->next_sum;
    s->pending = SG_PENDING_NONE;
}

static void rollback(sg_score_state *state)
{
    ((sg_label_state *)state)->pending = SG_PENDING_NONE;
}

static sg_status copy_state(sg_score_state *dst, const sg_score_state *src, sg_error *err)
{
    sg_label_state *d = (sg_label_state *)dst;
    const sg_label_state *s = (const sg_label_state *)src;
    const bool tied = sg_label_target_of(s)->tied;
    if (d == s)
        return SG_OK;
    if (s->stands) {
        if (!sg_label_table_reserve(&d->now, s->now.nnodes, s->now.nspots, tied))
            return SG_FAIL_NOMEM(err);
        memcpy(d->now.spots, s->now.spots, s->now.nspots * sizeof *d->now.spots);
        memcpy(d->now.sums, s->now.sums, s->now.nspots * sizeof *d->now.sums);
        if (tied)
            memcpy(d->now.first, s->now.first, (s->now.nnodes + 1) * sizeof *d->now.first);
        d->now.nnodes = s->now.nnodes;
        d->now.nspots = s->now.nspots;
    }
    d->sum = s->sum;
    d->places = s->places;
    d->stands = s->stands;
    d->pending = SG_PENDING_NONE;
    return SG_OK;
}

const sg_score_ops sg_label_score_ops = {
    .name = "label",
    .destroy = sg_label_target_free,
    .create_state = create_state,
    .destroy_state = destroy_state,
    .evaluate = evaluate,
    .propose = propose,
    .commit = commit,
    .rollback = rollback,
    .copy_state = copy_state,
};
