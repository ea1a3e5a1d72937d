/* SPDX-License-Identifier: GPL-3.0-or-later */
/* mesh_segment.c - generalised cylinders along strands of segments. Rings stand half way between the directions of the
 * segments that meet, and are carried from one to the next by the least turn, so that they do not twist. */
#include "scene/mesh_priv.h"

#include "core/array.h"

#include <stdlib.h>
#include <string.h>

typedef struct {
    sg_mesh_builder *b;
    sg_mesh_strands strands;
    sg_mesh_ring *rings;
    size_t n, capacity;
    double side[3]; /* where angle 0 of the last ring is: of length 1, across the direction */
    double v;
} sweep;

/* The part of w->side across the direction; any side, where it runs along. */
static void turn_side(sweep *w, const double *direction)
{
    static const double axes[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int i = -1; i < 3; i++) {
        double side[3];
        const double *from = i < 0 ? w->side : axes[i];
        sg_vec_add(from, -sg_vec_dot(from, direction), direction, side);
        if (sg_vec_length(side) < 0.3 || !sg_vec_normalize(side))
            continue;
        memcpy(w->side, side, sizeof side);
        return;
    }
}

static sg_status add_ring(sweep *w, const double *centre, const double *direction, double radius, uint32_t group)
{
    sg_mesh_ring r = {.v = w->v, .group = group};
    if (!SG_GROW(w->rings, w->capacity, w->n + 1))
        return SG_FAIL_NOMEM(w->b->err);
    turn_side(w, direction);
    memcpy(r.centre, centre, sizeof r.centre);
    sg_vec_cross(direction, w->side, r.b);
    for (int i = 0; i < 3; i++) {
        r.a[i] = radius * w->side[i];
        r.b[i] *= radius;
    }
    w->rings[w->n++] = r;
    return SG_OK;
}

/* Radii too small to be seen are points. */
static double radius_of(const sg_primitive *p, int end)
{
    return sg_mesh_thin(p, p->radius[end]) ? 0 : p->radius[end];
}

/* What is gathered becomes a surface. */
static sg_status finish(sweep *w)
{
    const size_t n = w->n;
    w->n = 0;
    return n >= 2 ? sg_mesh_add_rings(w->b, w->rings, n) : SG_OK;
}

/* The rings of one segment: its first, unless the one before it left it there, and its last. */
static sg_status add_segment(sweep *w, const sg_primitive *p, const sg_primitive *next)
{
    const double from = radius_of(p, 0), to = radius_of(p, 1);
    uint32_t group;
    double end[3], direction[3];
    if (sg_mesh_thin(p, p->size[1]) || (from == 0 && to == 0))
        return finish(w);
    SG_TRY(sg_mesh_group_of(w->b, p, &group));
    if (w->n == 0)
        SG_TRY(add_ring(w, p->frame.origin, p->frame.y, from, group));
    w->rings[w->n - 1].group = group;
    sg_frame_point(&p->frame, 0, p->size[1], 0, end);
    sg_vec_add(p->frame.y, next != NULL ? 1 : 0, next != NULL ? next->frame.y : p->frame.y, direction);
    sg_vec_normalize(direction);
    w->v += p->size[1];
    SG_TRY(add_ring(w, end, direction, to, group));
    return next == NULL || to == 0 ? finish(w) : SG_OK;
}

static sg_status add_strand(sweep *w, size_t first)
{
    const sg_primitive *items = w->b->scene->items;
    w->n = 0;
    w->v = 0;
    memcpy(w->side, items[first].frame.x, sizeof w->side);
    for (size_t i = first; i != SG_NONE; i = w->strands.next[i]) {
        const uint32_t next = w->strands.next[i];
        SG_TRY(add_segment(w, items + i, next != SG_NONE ? items + next : NULL));
    }
    return finish(w);
}

static sg_status add_strands(sweep *w)
{
    const sg_scene *scene = w->b->scene;
    for (size_t i = 0; i < scene->n; i++)
        if (scene->items[i].kind == SG_PRIMITIVE_SEGMENT && !w->strands.inner[i])
            SG_TRY(add_strand(w, i));
    return SG_OK;
}

sg_status sg_mesh_add_segments(sg_mesh_builder *b)
{
    sweep w = {.b = b};
    SG_TRY(sg_mesh_strands_find(b->scene, &w.strands, b->err));
    const sg_status st = add_strands(&w);
    free(w.rings);
    sg_mesh_strands_clear(&w.strands);
    return st;
}
