/* SPDX-License-Identifier: GPL-3.0-or-later */
/* raster_clip.c - triangles that reach before the near plane or too far out of the picture, by Sutherland and Hodgman,
 * "Reentrant polygon clipping" (1974). An edge is always cut from its inner end, so that the two triangles that share it
 * get the same corner to the last bit. */
#include "scene/raster_priv.h"

#include <string.h>

enum { MOST_CORNERS = 3 + 5, PLANES = 5 };

typedef struct {
    double at[MOST_CORNERS][3];
    int n;
} polygon;

/* What can be drawn of an axis at a corner's depth, to both sides: a little less than the guard, for the offset of samples. */
static double reach(const sg_raster_job *j, int axis, const double *at)
{
    const sg_camera *c = j->camera;
    const double guard = 1.9 * SG_RASTER_GUARD / (double)(axis == 0 ? j->raster->width : j->raster->height) - 2;
    return guard * c->half[axis] * (c->projection == SG_PROJECTION_PERSPECTIVE ? at[2] : 1);
}

/* How far inside of a plane a corner lies: the near one, then left, right, bottom, top of what can be drawn. */
static double inside(const sg_raster_job *j, int plane, const double *at)
{
    if (plane == 0)
        return at[2] - j->camera->near;
    const int axis = (plane - 1) / 2;
    return reach(j, axis, at) + (plane % 2 == 1 ? at[axis] : -at[axis]);
}

/* The corner where an edge leaves. It is put on the plane, which rounding can miss by much when the outer end is far. */
static void cut(const sg_raster_job *j, int plane, const double *in, const double *out, double *at)
{
    const double d_in = inside(j, plane, in), d_out = inside(j, plane, out), t = d_in / (d_in - d_out);
    for (int i = 0; i < 3; i++)
        at[i] = in[i] + t * (out[i] - in[i]);
    if (plane == 0)
        at[2] = j->camera->near;
    else
        at[(plane - 1) / 2] = (plane % 2 == 1 ? -1 : 1) * reach(j, (plane - 1) / 2, at);
}

static void clip(const sg_raster_job *j, int plane, const polygon *p, polygon *out)
{
    out->n = 0;
    for (int i = 0; i < p->n; i++) {
        const double *a = p->at[i], *b = p->at[(i + 1) % p->n];
        const bool a_in = inside(j, plane, a) >= 0, b_in = inside(j, plane, b) >= 0;
        if (a_in)
            memcpy(out->at[out->n++], a, sizeof out->at[0]);
        if (a_in && !b_in)
            cut(j, plane, a, b, out->at[out->n++]);
        else if (b_in && !a_in)
            cut(j, plane, b, a, out->at[out->n++]);
    }
}

void sg_raster_clipped(const sg_raster_job *j, const double (*corners)[3], uint32_t index)
{
    polygon p = {.n = 3}, clipped;
    memcpy(p.at, corners, 3 * sizeof p.at[0]);
    for (int plane = 0; plane < PLANES && p.n > 0; plane++) {
        clip(j, plane, &p, &clipped);
        p = clipped;
    }
    sg_raster_vertex v[MOST_CORNERS];
    for (int i = 0; i < p.n; i++) {
        v[i] = sg_raster_place(j, p.at[i]);
        if (v[i].x == SG_RASTER_OUTSIDE)
            return;
    }
    for (int i = 1; i + 1 < p.n; i++)
        sg_raster_triangle(j->raster, v, v + i, v + i + 1, index);
}
