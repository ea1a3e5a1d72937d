/* SPDX-License-Identifier: GPL-3.0-or-later */
/* scene.c - walks a derivation with states on a stack of its own, so depth costs no C stack. */
#include "scene/scene_priv.h"

#include "core/array.h"
#include "grammar/shape_ops.h"

#include <stdlib.h>
#include <string.h>

static void free_work(struct sg_scene_work *w)
{
    if (w == NULL)
        return;
    free(w->items);
    sg_stored_children_clear(&w->children);
    free(w);
}

void sg_scene_clear(sg_scene *scene)
{
    free(scene->items);
    free(scene->corners);
    free_work(scene->work);
    *scene = (sg_scene){0};
}

void sg_scene_states_clear(sg_scene_states *states)
{
    free(states->places);
    *states = (sg_scene_states){0};
}

bool sg_primitive_equal(const sg_scene *scene, const sg_primitive *p, const sg_scene *other, const sg_primitive *q)
{
    return memcmp(p, q, offsetof(sg_primitive, corner)) == 0 &&
           (p->ncorners == 0 || memcmp(sg_primitive_corners(scene, p), sg_primitive_corners(other, q),
                                       p->ncorners * sizeof scene->corners[0]) == 0);
}

sg_status sg_scene_put(sg_scene *scene, const sg_primitive *p, const double (*corners)[2], sg_error *err)
{
    if (!SG_GROW(scene->items, scene->capacity, scene->n + 1) ||
        (p->ncorners > 0 && !SG_GROW(scene->corners, scene->corners_capacity, scene->ncorners + p->ncorners)))
        return SG_FAIL_NOMEM(err);
    sg_primitive *to = scene->items + scene->n++;
    *to = *p;
    to->corner = 0;
    if (p->ncorners == 0)
        return SG_OK;
    to->corner = scene->ncorners;
    memcpy(scene->corners + scene->ncorners, corners, p->ncorners * sizeof *corners);
    scene->ncorners += p->ncorners;
    return SG_OK;
}

sg_status sg_scene_append(sg_scene *to, const sg_scene *from, size_t first, size_t n, sg_error *err)
{
    const size_t mark = to->n, corners = to->ncorners;
    sg_status st = SG_OK;
    for (size_t i = first; st == SG_OK && i < first + n; i++)
        st = sg_scene_put(to, from->items + i, sg_primitive_corners(from, from->items + i), err);
    if (st != SG_OK) {
        to->n = mark;
        to->ncorners = corners;
    }
    return st;
}

bool sg_scene_state_equal(const sg_scene_state *a, const sg_scene_state *b)
{
    return memcmp(a, b, offsetof(sg_scene_state, corner)) == 0 &&
           memcmp(a->corner, b->corner, a->ncorners * sizeof a->corner[0]) == 0;
}

sg_scene_state sg_scene_first_state(const sg_scene_opts *opts)
{
    sg_scene_state s;
    memset(&s, 0, sizeof s);
    s.frame = (sg_frame)SG_FRAME_INIT;
    memcpy(s.size, opts->size, sizeof s.size);
    s.width = opts->width;
    s.joint = -1;
    s.material = s.label = SG_NONE;
    return s;
}

/* Its length counts itself alone until the walk is over. */
static sg_status enter(sg_scene_states *states, const sg_scene_item *item, size_t first, sg_error *err)
{
    if (!SG_GROW(states->places, states->capacity, states->n + 1))
        return SG_FAIL_NOMEM(err);
    const uint32_t parent = item->parent != SIZE_MAX ? (uint32_t)(states->n - item->parent) : 0;
    sg_scene_place *place = states->places + states->n++;
    place->node = (uint32_t)item->node;
    place->parent = parent;
    place->length = 1;
    place->first = first;
    sg_scene_state_copy(&place->state, &item->state);
    return SG_OK;
}

static void add_lengths(sg_scene_states *states, size_t base)
{
    for (size_t i = states->n; i-- > base;) {
        const sg_scene_place *p = states->places + i;
        if (p->parent > 0)
            states->places[i - p->parent].length += p->length;
    }
}

static void copy_item(sg_scene_item *to, const sg_scene_item *from)
{
    to->node = from->node;
    to->parent = from->parent;
    sg_scene_state_copy(&to->state, &from->state);
}

static void reverse_items(sg_scene_item *items, size_t n)
{
    sg_scene_item swap;
    for (size_t i = 0; i + 1 < n; i++) {
        copy_item(&swap, items + i);
        copy_item(items + i, items + --n);
        copy_item(items + n, &swap);
    }
}

static sg_status place_item(sg_scene_body *b, const sg_scene_item *item, sg_scene_states *states)
{
    struct sg_scene_work *w = b->scene->work;
    const sg_node *node = b->d->nodes + item->node;
    const size_t mark = w->n;
    b->place = states != NULL ? states->n : 0;
    if (states != NULL)
        SG_TRY(enter(states, item, b->scene->n, b->err));
    if (node->rule >= SG_RULE_EMPTY)
        return SG_OK;
    b->node = item->node;
    b->r = sg_grammar_rule(b->d->grammar, node->rule);
    b->frame = b->d->values != NULL ? b->d->values + node->values : NULL; /* no rule draws */
    SG_TRY(sg_stored_children_find(&w->children, b->d, item->node, b->r, b->err));
    SG_TRY(sg_scene_read_body(b, &item->state));
    if (w->n > mark)
        reverse_items(w->items + mark, w->n - mark); /* the first child is placed first */
    return SG_OK;
}

static sg_status walk(sg_scene_body *b, const sg_scene_state *state, sg_scene_states *states)
{
    struct sg_scene_work *w = b->scene->work;
    const size_t base = states != NULL ? states->n : 0;
    w->n = 0;
    sg_scene_item top;
    top.node = b->node;
    top.parent = SIZE_MAX;
    sg_scene_state_copy(&top.state, state);
    for (;;) {
        SG_TRY(place_item(b, &top, states));
        if (w->n == 0)
            break;
        copy_item(&top, w->items + --w->n);
    }
    if (states != NULL)
        add_lengths(states, base);
    return SG_OK;
}

sg_status sg_scene_interpret_slice(const sg_derivation *d, size_t node, const sg_scene_state *state,
                                   const sg_scene_opts *opts, sg_scene *scene, sg_scene_states *states, sg_error *err)
{
    if (node >= d->nnodes)
        return SG_FAIL(err, SG_EINVAL, "node %zu of a derivation of %zu nodes", node, d->nnodes);
    if (scene->work == NULL && (scene->work = calloc(1, sizeof *scene->work)) == NULL)
        return SG_FAIL_NOMEM(err);
    const size_t mark = scene->n, corners = scene->ncorners, places = states != NULL ? states->n : 0;
    scene->grammar = d->grammar;
    sg_scene_body b = {.d = d, .node = node, .scene = scene, .limit = opts->max_places, .nplaced = 1, .err = err};
    const sg_status st = walk(&b, state, states);
    if (st != SG_OK) {
        scene->n = mark;
        scene->ncorners = corners;
        if (states != NULL)
            states->n = places;
    }
    return st;
}

sg_status sg_scene_interpret(const sg_derivation *d, const sg_scene_opts *opts, sg_scene *scene, sg_error *err)
{
    const sg_scene_state state = sg_scene_first_state(opts);
    scene->n = scene->ncorners = 0;
    return sg_scene_interpret_slice(d, 0, &state, opts, scene, NULL, err);
}

uint32_t sg_scene_material(const sg_grammar *g, const sg_primitive *p, const char **name)
{
    enum { LIGHT_GREY = 0xc8c8c8 };
    const uint32_t of_label = p->label != SG_NONE ? sg_grammar_symbol(g, p->label)->color : LIGHT_GREY;
    *name = NULL;
    if (p->material == SG_NONE)
        return of_label;
    if (p->material < SG_SHAPE_STRING_ARG)
        return p->material;
    *name = sg_grammar_string(g, p->material - SG_SHAPE_STRING_ARG);
    const uint32_t declared = sg_grammar_material_color(g, p->material - SG_SHAPE_STRING_ARG);
    return declared != SG_NONE ? declared : of_label;
}
