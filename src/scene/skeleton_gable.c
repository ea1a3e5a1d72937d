/* SPDX-License-Identifier: GPL-3.0-or-later */
/* skeleton_gable.c - gables at the ends of hip roofs. */
#include "scene/skeleton.h"

#include <math.h>

typedef struct {
    double normal[2], at; /* the distance of x from the edge, inwards, is normal . x - at */
} edge_line;

static edge_line line_of(const double (*p)[2], size_t n, size_t i)
{
    const double *a = p[i], *b = p[(i + 1) % n];
    const double length = hypot(b[0] - a[0], b[1] - a[1]);
    edge_line l = {{(a[1] - b[1]) / length, (b[0] - a[0]) / length}, 0};
    l.at = l.normal[0] * a[0] + l.normal[1] * a[1];
    return l;
}

static double distance_to(const edge_line *l, const double *x)
{
    return l->normal[0] * x[0] + l->normal[1] * x[1] - l->at;
}

/* How many faces meet in a node. */
static size_t count_faces(const sg_skeleton *s, size_t n, uint8_t node)
{
    size_t count = 0;
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < s->face[i].ncorners; k++)
            count += s->face[i].corner[k] == node;
    return count;
}

/* The faces beside it meet along the ridge, on which both edges are as far: so they are where it stands over this edge. */
static bool raise(const double (*p)[2], size_t n, size_t i, sg_skeleton *s)
{
    const edge_line before = line_of(p, n, (i + n - 1) % n), after = line_of(p, n, (i + 1) % n);
    const double *a = p[i], *b = p[(i + 1) % n];
    const double from = distance_to(&before, a) - distance_to(&after, a); /* of the differences, at both ends */
    const double to = distance_to(&before, b) - distance_to(&after, b);
    const double share = from / (from - to);
    if (!(share > 1e-6 && share < 1 - 1e-6))
        return false;
    double *node = s->node[s->face[i].corner[2]];
    for (int k = 0; k < 2; k++)
        node[k] = a[k] + share * (b[k] - a[k]);
    node[2] = distance_to(&before, node);
    s->height = fmax(s->height, node[2]);
    return true;
}

size_t sg_skeleton_raise_gables(const double (*p)[2], size_t n, sg_skeleton *s)
{
    size_t raised = 0;
    for (size_t i = 0; i < n; i++)
        if (s->face[i].ncorners == 3 && count_faces(s, n, s->face[i].corner[2]) == 3)
            raised += raise(p, n, i, s);
    return raised;
}
