/* SPDX-License-Identifier: GPL-3.0-or-later */
/* mesh_strands.c - which segment continues which: by the place and the radius at its start, to the last bit. Of several
 * that start in one place the straightest continues, the others are branches. */
#include "scene/mesh_priv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Cosine of the largest turn that is no corner. */
static const double sharpest = 0.25;
/* Most segments that are looked at in one place. */
enum { MOST_BRANCHES = 64 };

typedef struct {
    double at[3];
    uint32_t index;
} start;

static int compare_places(const double *a, const double *b)
{
    for (int i = 0; i < 3; i++)
        if (a[i] != b[i])
            return a[i] < b[i] ? -1 : 1;
    return 0;
}

static int compare_starts(const void *a, const void *b)
{
    const start *x = a, *y = b;
    const int order = compare_places(x->at, y->at);
    return order != 0 ? order : (x->index > y->index) - (x->index < y->index);
}

static start *sorted_starts(const sg_scene *scene, size_t *n)
{
    start *starts = malloc((scene->n + 1) * sizeof *starts);
    *n = 0;
    for (size_t i = 0; starts != NULL && i < scene->n; i++) {
        if (scene->items[i].kind != SG_PRIMITIVE_SEGMENT)
            continue;
        memcpy(starts[*n].at, scene->items[i].frame.origin, sizeof starts->at);
        starts[(*n)++].index = (uint32_t)i;
    }
    if (starts != NULL)
        qsort(starts, *n, sizeof *starts, compare_starts);
    return starts;
}

/* First start that is not in front of a place. */
static size_t lower_bound(const start *starts, size_t n, const double *at)
{
    size_t low = 0, high = n;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (compare_places(starts[middle].at, at) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* Can q continue p as one surface? The ring at the joint leans by half the angle between them, and must not lean over
 * the middle of either. */
static bool joins(const sg_primitive *p, const sg_primitive *q, double straight)
{
    const double lean = q->radius[0] * sqrt((1 - straight) / (1 + straight));
    return q->radius[0] == p->radius[1] && straight > sharpest && 2 * lean <= p->size[1] && 2 * lean <= q->size[1];
}

/* What continues stands behind in the scene, so that no strand is a circle. */
static uint32_t continuation(const sg_scene *scene, const start *starts, size_t n, uint32_t i, const bool *inner)
{
    const sg_primitive *p = scene->items + i;
    double end[3], best = -1;
    uint32_t found = SG_NONE;
    sg_frame_point(&p->frame, 0, p->size[1], 0, end);
    const size_t first = lower_bound(starts, n, end);
    for (size_t k = first; k < n && k - first < MOST_BRANCHES && compare_places(starts[k].at, end) == 0; k++) {
        const sg_primitive *q = scene->items + starts[k].index;
        const double straight = fmin(1, sg_vec_dot(p->frame.y, q->frame.y));
        if (starts[k].index <= i || inner[starts[k].index] || !(straight > best) || !joins(p, q, straight))
            continue;
        best = straight;
        found = starts[k].index;
    }
    return found;
}

sg_status sg_mesh_strands_find(const sg_scene *scene, sg_mesh_strands *s, sg_error *err)
{
    size_t n;
    start *starts = sorted_starts(scene, &n);
    s->next = malloc((scene->n + 1) * sizeof *s->next);
    s->inner = calloc(scene->n + 1, sizeof *s->inner);
    if (starts == NULL || s->next == NULL || s->inner == NULL) {
        free(starts);
        sg_mesh_strands_clear(s);
        return SG_FAIL_NOMEM(err);
    }
    for (size_t i = 0; i < scene->n; i++) {
        s->next[i] = SG_NONE;
        if (scene->items[i].kind != SG_PRIMITIVE_SEGMENT)
            continue;
        s->next[i] = continuation(scene, starts, n, (uint32_t)i, s->inner);
        if (s->next[i] != SG_NONE)
            s->inner[s->next[i]] = true;
    }
    free(starts);
    return SG_OK;
}

void sg_mesh_strands_clear(sg_mesh_strands *s)
{
    free(s->next);
    free(s->inner);
    *s = (sg_mesh_strands){0};
}
