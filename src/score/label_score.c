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

typedef enum {
    SAME,
    SLID,  /* by less than a pixel: sums hold */
    MOVED, /* placed anew */
} motion;

/* A subtree: nodes first..end-1. */
typedef struct {
    size_t first, end;
    motion motion;
} moved_range;

typedef enum { NOTHING, WHOLE, SLICE, VALUES } pending_kind;

typedef struct {
    sg_score_state state; /* first */
    sg_label_table now;   /* where it stands */
    int64_t sum;
    size_t places; /* no fewer than the scene has */
    bool stands;   /* at a derivation that is a label scene */
    sg_label_table next; /* what is proposed: all of it, a slice, or the node's subtree with holes */
    int64_t next_sum;
    size_t next_places;
    pending_kind pending;
    const sg_change *change;
    moved_range *ranges;
    size_t nranges, ranges_capacity;
    double *frame; /* [frame size of the grammar] */
    sg_label_scratch scratch;
    sg_derivation whole;
} label_state;

static const sg_label_target *target_of(const label_state *s)
{
    return (const sg_label_target *)s->state.target;
}

static sg_status create_state(const sg_score *target, sg_score_state **out, sg_error *err)
{
    const sg_grammar *g = ((const sg_label_target *)target)->g;
    label_state *s = calloc(1, sizeof *s);
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
    label_state *s = (label_state *)state;
    sg_label_table_clear(&s->now);
    sg_label_table_clear(&s->next);
    sg_placer_clear(&s->scratch.placer);
    sg_derivation_clear(&s->whole);
    free(s->scratch.list.items);
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

static sg_label_placing placing_of(label_state *s, const sg_derivation *d, const uint32_t *first, size_t base)
{
    return (sg_label_placing){.t = target_of(s),
                              .d = d,
                              .to = &s->next,
                              .first = first,
                              .base = base,
                              .most = INT64_MAX,
                              .scratch = &s->scratch};
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
    return sg_label_place_nodes(w, 0, to->nnodes);
}

/* A whole derivation, from scratch. */
static sg_status place_whole(label_state *s, const sg_derivation *d)
{
    const sg_label_target *t = target_of(s);
    const int32_t width = (int32_t)t->image.width, height = (int32_t)t->image.height;
    const sg_label_spot spot = {{0, 0, width, height}, 0, 0, width, height};
    sg_label_placing w = placing_of(s, d, NULL, 0);
    if (d->nnodes == 0)
        return SG_ENUMERIC;
    SG_TRY(place_tree(&w, &spot, 1));
    s->next_sum = w.sum;
    s->next_places = w.places - 1; /* the root is there already */
    return s->next_places <= SG_LABEL_SCENE_MAX_PLACES ? SG_OK : SG_ENUMERIC;
}

static void stand_at_next(label_state *s)
{
    const sg_label_table swap = s->now;
    s->now = s->next;
    s->next = swap;
    s->places = s->next_places;
    s->stands = true;
}

static sg_status evaluate(sg_score_state *state, const sg_derivation *d, sg_score_value *out, sg_error *err)
{
    label_state *s = (label_state *)state;
    if (d->grammar != target_of(s)->g)
        return SG_FAIL(err, SG_EINVAL, "the score was made for another grammar");
    s->pending = NOTHING;
    const sg_status st = place_whole(s, d);
    if (st == SG_ENOMEM)
        return SG_FAIL_NOMEM(err);
    s->stands = false;
    *out = no_scene;
    if (st == SG_OK) {
        stand_at_next(s);
        s->sum = s->next_sum;
        set_value(target_of(s), s->sum, out);
    }
    return SG_OK;
}

/* ---- proposals ---- */

static size_t first_spot(const label_state *s, size_t node)
{
    return target_of(s)->tied ? s->now.first[node] : node;
}

/* Sum over the spots of nodes first..end-1. */
static int64_t sum_of(const label_state *s, size_t first, size_t end)
{
    int64_t sum = 0;
    for (size_t i = first_spot(s, first), n = first_spot(s, end); i < n; i++)
        sum += s->now.sums[i];
    return sum;
}

/* The changed derivation from scratch: where there is nothing to start from. */
static sg_status propose_whole(label_state *s, const sg_change *c)
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
    s->pending = WHOLE;
    return SG_OK;
}

static sg_status propose_slice(label_state *s, const sg_change *c, int64_t most)
{
    const size_t end = c->node + c->current->nodes[c->node].length;
    const size_t first = first_spot(s, c->node), behind = first_spot(s, end);
    const size_t n = target_of(s)->tied ? s->now.first[c->node + 1] - first : 1;
    sg_label_placing w = placing_of(s, c->slice, NULL, 0);
    w.sum = s->sum - sum_of(s, c->node, end);
    w.most = most;
    SG_TRY(place_tree(&w, s->now.spots + first, n));
    s->next_sum = w.sum;
    s->next_places = s->places + w.places;
    if (s->next_places > SG_LABEL_SCENE_MAX_PLACES)
        return propose_whole(s, c); /* perhaps: places of what goes were not taken off */
    if (!sg_label_table_reserve(&s->now, s->now.nnodes - (end - c->node) + s->next.nnodes,
                                s->now.nspots - (behind - first) + s->next.nspots, target_of(s)->tied))
        return SG_ENOMEM;
    s->pending = SLICE;
    return SG_OK;
}

static motion motion_of(const sg_label_spot *a, const sg_label_spot *b, uint8_t cuts)
{
    const bool x = a->at.x0 != b->at.x0 || a->at.x1 != b->at.x1, y = a->at.y0 != b->at.y0 || a->at.y1 != b->at.y1;
    if (!x && !y)
        return SAME;
    const bool pixels = a->x0 == b->x0 && a->x1 == b->x1 && a->y0 == b->y0 && a->y1 == b->y1;
    return pixels && !(x && (cuts & SG_CUTS_X)) && !(y && (cuts & SG_CUTS_Y)) ? SLID : MOVED;
}

static motion motion_of_child(const label_state *s, const sg_label_placing *w, size_t child)
{
    const uint8_t cuts = sg_label_plan_of(w->t, w->d, child)->cuts;
    const sg_label_spot *now = s->now.spots + first_spot(s, child), *next = s->next.spots + sg_label_spot_of(w, child);
    motion most = SAME;
    for (size_t i = 0, n = sg_label_spots_of(w, child); i < n && most != MOVED; i++) {
        const motion m = motion_of(now + i, next + i, cuts);
        most = m > most ? m : most;
    }
    return most;
}

static sg_status add_range(label_state *s, size_t first, size_t end, motion m)
{
    if (s->nranges == s->ranges_capacity && !SG_GROW(s->ranges, s->ranges_capacity, s->nranges + 1))
        return SG_ENOMEM;
    s->ranges[s->nranges++] = (moved_range){first, end, m};
    return SG_OK;
}

/* The children of the node that the new values move; the sums of those that are placed anew are taken off. */
static sg_status find_moved(label_state *s, sg_label_placing *w, size_t node)
{
    const sg_node *nodes = w->d->nodes;
    s->nranges = 0;
    for (size_t c = node + 1, end = node + nodes[node].length; c < end; c += nodes[c].length) {
        const motion m = motion_of_child(s, w, c);
        if (m == SAME)
            continue;
        SG_TRY(add_range(s, c, c + nodes[c].length, m));
        if (m == MOVED)
            w->sum -= sum_of(s, c, c + nodes[c].length);
    }
    return SG_OK;
}

static sg_status place_moved(label_state *s, sg_label_placing *w)
{
    for (const moved_range *r = s->ranges; r < s->ranges + s->nranges; r++)
        if (r->motion == MOVED)
            SG_TRY(sg_label_place_nodes(w, r->first, r->end));
    return SG_OK;
}

/* The frame of the node with the new values. */
static void make_frame(label_state *s, const sg_change *c)
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

static sg_status propose_values(label_state *s, const sg_change *c, int64_t most)
{
    const size_t end = c->node + c->current->nodes[c->node].length;
    const size_t first = first_spot(s, c->node), own = first_spot(s, c->node + 1) - first;
    sg_label_placing w = placing_of(s, c->current, target_of(s)->tied ? s->now.first : NULL, first);
    if (!sg_label_table_reserve(&s->next, 0, first_spot(s, end) - first, false))
        return SG_ENOMEM;
    memcpy(s->next.spots, s->now.spots + first, own * sizeof *s->next.spots);
    make_frame(s, c);
    w.sum = s->sum - sum_of(s, c->node, c->node + 1);
    SG_TRY(sg_label_place_body(&w, c->node, s->frame));
    SG_TRY(find_moved(s, &w, c->node));
    w.most = most;
    SG_TRY(place_moved(s, &w));
    s->next_sum = w.sum;
    s->pending = VALUES;
    return SG_OK;
}

static sg_status propose(sg_score_state *state, const sg_change *change, double floor, sg_score_value *out,
                         sg_error *err)
{
    label_state *s = (label_state *)state;
    const int64_t most = most_of(target_of(s), floor);
    s->change = change;
    s->pending = NOTHING;
    const sg_status st = !s->stands              ? propose_whole(s, change)
                         : change->slice != NULL ? propose_slice(s, change, most)
                                                 : propose_values(s, change, most);
    if (st == SG_ENOMEM)
        return SG_FAIL_NOMEM(err);
    *out = no_scene;
    if (st == SG_OK)
        set_value(target_of(s), s->next_sum, out);
    return SG_OK;
}

/* ---- commit ---- */

static void splice_slice(label_state *s)
{
    const size_t node = s->change->node, end = node + s->change->current->nodes[node].length;
    const size_t first = first_spot(s, node), behind = first_spot(s, end), tail = s->now.nspots - behind;
    sg_label_table *now = &s->now;
    const sg_label_table *next = &s->next;
    if (first + next->nspots != behind) {
        memmove(now->spots + first + next->nspots, now->spots + behind, tail * sizeof *now->spots);
        memmove(now->sums + first + next->nspots, now->sums + behind, tail * sizeof *now->sums);
    }
    memcpy(now->spots + first, next->spots, next->nspots * sizeof *now->spots);
    memcpy(now->sums + first, next->sums, next->nspots * sizeof *now->sums);
    if (target_of(s)->tied) {
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

/* What stands below a child that slid lies along its old coordinates where nothing is cut. */
static void mend_coordinates(label_state *s, const moved_range *r)
{
    const uint8_t cuts = sg_label_plan_of(target_of(s), s->change->current, r->first)->cuts;
    const sg_label_spot *of = s->now.spots + first_spot(s, r->first);
    const size_t n = first_spot(s, r->first + 1) - first_spot(s, r->first);
    for (size_t node = r->first + 1; node < r->end; node++) {
        sg_label_spot *spots = s->now.spots + first_spot(s, node);
        const size_t copies = (first_spot(s, node + 1) - first_spot(s, node)) / n;
        for (size_t i = 0; i < n * copies; i++) {
            const sg_rect at = of[i / copies].at;
            if (!(cuts & SG_CUTS_X)) {
                spots[i].at.x0 = at.x0;
                spots[i].at.x1 = at.x1;
            }
            if (!(cuts & SG_CUTS_Y)) {
                spots[i].at.y0 = at.y0;
                spots[i].at.y1 = at.y1;
            }
        }
    }
}

static void take_moved(label_state *s)
{
    const size_t base = first_spot(s, s->change->node);
    for (const moved_range *r = s->ranges; r < s->ranges + s->nranges; r++) {
        const size_t first = first_spot(s, r->first), end = first_spot(s, r->motion == SLID ? r->first + 1 : r->end);
        memcpy(s->now.spots + first, s->next.spots + (first - base), (end - first) * sizeof *s->now.spots);
        if (r->motion == SLID)
            mend_coordinates(s, r);
        else
            memcpy(s->now.sums + first, s->next.sums + (first - base), (end - first) * sizeof *s->now.sums);
    }
    /* The node's own spots stay; labels that its body places may have moved. */
    const size_t own = first_spot(s, s->change->node + 1) - base;
    memcpy(s->now.sums + base, s->next.sums, own * sizeof *s->now.sums);
}

static void commit(sg_score_state *state)
{
    label_state *s = (label_state *)state;
    switch (s->pending) {
    case NOTHING:
        return;
    case WHOLE:
        stand_at_next(s);
        break;
    case SLICE:
        splice_slice(s);
        break;
    case VALUES:
        take_moved(s);
        break;
    }
    s->sum = s->next_sum;
    s->pending = NOTHING;
}

static void rollback(sg_score_state *state)
{
    ((label_state *)state)->pending = NOTHING;
}

static sg_status copy_state(sg_score_state *dst, const sg_score_state *src, sg_error *err)
{
    label_state *d = (label_state *)dst;
    const label_state *s = (const label_state *)src;
    const bool tied = target_of(s)->tied;
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
    d->pending = NOTHING;
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
