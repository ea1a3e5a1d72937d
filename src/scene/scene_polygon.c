/* SPDX-License-Identifier: GPL-3.0-or-later */
/* scene_polygon.c - scopes that are polygons across z: how they are made, and their faces. */
#include "scene/scene_priv.h"

#include "grammar/shape_ops.h"
#include "scene/triangulate.h"

#include <math.h>
#include <string.h>

enum { MAX_CORNERS = SG_PRIMITIVE_CORNERS };

/* ---- making them ---- */

/* Is c beside the line from a to b, and on which side? Distances under a billionth are none. */
static int side_of(const double *a, const double *b, const double *c, double small)
{
    const double distance = sg_triangle_area(a, b, c) / hypot(b[0] - a[0], b[1] - a[1]);
    return (distance > small) - (distance < -small);
}

static bool between(const double *a, const double *b, const double *c)
{
    return c[0] >= fmin(a[0], b[0]) && c[0] <= fmax(a[0], b[0]) && c[1] >= fmin(a[1], b[1]) && c[1] <= fmax(a[1], b[1]);
}

/* Do two sides that share no corner touch? */
static bool touch(const double *a, const double *b, const double *c, const double *d, double small)
{
    const int s[4] = {side_of(a, b, c, small), side_of(a, b, d, small), side_of(c, d, a, small),
                      side_of(c, d, b, small)};
    if (s[0] * s[1] < 0 && s[2] * s[3] < 0)
        return true;
    return (s[0] == 0 && between(a, b, c)) || (s[1] == 0 && between(a, b, d)) || (s[2] == 0 && between(c, d, a)) ||
           (s[3] == 0 && between(c, d, b));
}

/* Counterclockwise, no side without a length, none that turns back or meets another one. */
static bool is_simple(const double (*p)[2], size_t n, double extent)
{
    const double small = 1e-9 * extent;
    if (!(sg_polygon_area(p, n) > small * extent))
        return false;
    for (size_t i = 0; i < n; i++) {
        const double *a = p[i], *b = p[(i + 1) % n], *c = p[(i + 2) % n];
        const double forward = (b[0] - a[0]) * (c[0] - b[0]) + (b[1] - a[1]) * (c[1] - b[1]);
        if (!(hypot(b[0] - a[0], b[1] - a[1]) > small))
            return false;
        if (side_of(a, b, c, small) == 0 && forward < 0)
            return false;
        for (size_t k = i + 2; k < n; k++)
            if ((k + 1) % n != i && touch(a, b, p[k], p[(k + 1) % n], small))
                return false;
    }
    return true;
}

/* The scope becomes what the corners, in lengths, reach over. @return false when they make no simple polygon */
static bool fit(sg_scene_state *face, const double (*p)[2], size_t n)
{
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (size_t i = 0; i < n; i++)
        for (int k = 0; k < 2; k++) {
            low[k] = fmin(low[k], p[i][k]);
            high[k] = fmax(high[k], p[i][k]);
        }
    if (!is_simple(p, n, fmax(high[0] - low[0], high[1] - low[1])))
        return false;
    for (size_t i = 0; i < n; i++)
        for (int k = 0; k < 2; k++)
            face->corner[i][k] = p[i][k] == high[k] ? 1 : (p[i][k] - low[k]) / (high[k] - low[k]);
    face->ncorners = (uint32_t)n;
    sg_frame_move(&face->frame, low[0], low[1], 0);
    face->size[0] = high[0] - low[0];
    face->size[1] = high[1] - low[1];
    return true;
}

static void reverse(double (*p)[2], size_t n)
{
    for (size_t i = 0; i + 1 < n; i++, n--)
        for (int k = 0; k < 2; k++) {
            const double swap = p[i][k];
            p[i][k] = p[n - 1][k];
            p[n - 1][k] = swap;
        }
}

sg_status sg_scene_make_polygon(sg_scene_body *b, const double *args, uint32_t nargs, sg_scene_state *s)
{
    double p[MAX_CORNERS][2] = {{0}};
    const size_t n = nargs / 2;
    sg_scene_state face;
    if (!sg_scene_base(s, &face))
        return SG_OK;
    for (size_t i = 0; i < n; i++)
        for (int k = 0; k < 2; k++)
            p[i][k] = args[2 * i + (size_t)k] * face.size[k];
    if (sg_polygon_area((const double(*)[2])p, n) < 0)
        reverse(p, n);
    if (!fit(&face, (const double(*)[2])p, n))
        return sg_scene_fail(b, "the sides of a polygon cross or touch, or it has no area");
    sg_scene_state_copy(s, &face);
    return SG_OK;
}

void sg_scene_corners_of(const sg_scene_state *s, double (*p)[2])
{
    for (uint32_t i = 0; i < s->ncorners; i++)
        for (int k = 0; k < 2; k++)
            p[i][k] = s->corner[i][k] * s->size[k];
}

/* Where the lines by the two sides of a corner, moved outwards, cross. */
static void move_corner(const double *a, const double *b, const double *c, double by, double *out)
{
    double u[2], v[2];
    const double one = hypot(b[0] - a[0], b[1] - a[1]), two = hypot(c[0] - b[0], c[1] - b[1]);
    for (int k = 0; k < 2; k++) {
        u[k] = (b[k] - a[k]) / one;
        v[k] = (c[k] - b[k]) / two;
    }
    const double det = u[0] * v[1] - u[1] * v[0];
    if (fabs(det) > 1e-7) { /* outwards is to the right of a side */
        out[0] = b[0] + by * (u[0] - v[0]) / det;
        out[1] = b[1] + by * (u[1] - v[1]) / det;
    } else {
        out[0] = b[0] + by * u[1];
        out[1] = b[1] - by * u[0];
    }
}

bool sg_scene_widen_polygon(sg_scene_state *s, double by)
{
    double p[MAX_CORNERS][2], moved[MAX_CORNERS][2];
    const size_t n = s->ncorners;
    sg_scene_corners_of(s, p);
    for (size_t i = 0; i < n; i++) {
        move_corner(p[(i + n - 1) % n], p[i], p[(i + 1) % n], by, moved[i]);
        const double *was = p[i], *is = moved[i]; /* sides that were turned around are simple, but no roof */
        if (!isfinite(is[0]) || !isfinite(is[1]) || !isfinite(was[0]))
            return false;
    }
    for (size_t i = 0; i < n; i++) {
        const double *a = p[i], *b = p[(i + 1) % n], *c = moved[i], *d = moved[(i + 1) % n];
        if (!((b[0] - a[0]) * (d[0] - c[0]) + (b[1] - a[1]) * (d[1] - c[1]) > 0))
            return false;
    }
    return fit(s, (const double(*)[2])moved, n);
}

/* ---- their faces ---- */

bool sg_scene_base(const sg_scene_state *s, sg_scene_state *out)
{
    if (s->ncorners > 0)
        return sg_scene_face_at(s, s->ncorners, out);
    return sg_scene_face(s, s->size[2] > 0 ? SG_FACE_TOP : SG_FACE_FRONT, out);
}

size_t sg_scene_face_count(const sg_scene_state *s)
{
    return s->ncorners > 0 ? s->ncorners + 2 : SG_FACE_SIDE;
}

/* From corner k to the next one, in lengths. */
static void side_at(const sg_scene_state *s, size_t k, double *out)
{
    const double *a = s->corner[k], *b = s->corner[(k + 1) % s->ncorners];
    for (int i = 0; i < 2; i++)
        out[i] = (b[i] - a[i]) * s->size[i];
}

int sg_scene_face_kind(const sg_scene_state *s, size_t k)
{
    double side[2];
    if (s->ncorners == 0)
        return (int)k;
    if (k >= s->ncorners)
        return k == s->ncorners ? SG_FACE_TOP : SG_FACE_BOTTOM;
    side_at(s, k, side);
    if (fabs(side[1]) > fabs(side[0])) /* it looks to the right of its direction */
        return side[1] > 0 ? SG_FACE_RIGHT : SG_FACE_LEFT;
    return side[0] > 0 ? SG_FACE_FRONT : SG_FACE_BACK;
}

/* Upright: x along the side, y along the scope's z. */
static bool wall_at(const sg_scene_state *s, size_t k, sg_scene_state *out)
{
    double side[2];
    side_at(s, k, side);
    const double length = hypot(side[0], side[1]);
    if (!(length > 0) || !(s->size[2] > 0))
        return false;
    sg_frame_point(&s->frame, s->corner[k][0] * s->size[0], s->corner[k][1] * s->size[1], 0, out->frame.origin);
    sg_frame_direction(&s->frame, side[0] / length, side[1] / length, 0, out->frame.x);
    memcpy(out->frame.y, s->frame.z, sizeof out->frame.y);
    sg_vec_cross(out->frame.x, out->frame.y, out->frame.z);
    out->ncorners = 0;
    out->size[0] = length;
    out->size[1] = s->size[2];
    return true;
}

/* As one looks at it from outside, y is down in the scope. */
static bool bottom_of(const sg_scene_state *s, sg_scene_state *out)
{
    if (!(s->size[2] > 0))
        return false;
    sg_frame_move(&out->frame, 0, s->size[1], 0);
    out->frame = sg_frame_permute(&out->frame, 1, -2);
    for (uint32_t i = 0; i < s->ncorners; i++)
        out->corner[i][1] = 1 - s->corner[i][1];
    reverse(out->corner, s->ncorners);
    return true;
}

bool sg_scene_face_at(const sg_scene_state *s, size_t k, sg_scene_state *out)
{
    if (s->ncorners == 0)
        return sg_scene_face(s, (int)k, out);
    sg_scene_state_copy(out, s);
    out->joint = -1;
    out->size[2] = 0;
    if (!(s->size[0] > 0 && s->size[1] > 0))
        return false;
    if (k < s->ncorners)
        return wall_at(s, k, out);
    if (k > s->ncorners)
        return bottom_of(s, out);
    sg_frame_move(&out->frame, 0, 0, s->size[2]);
    return true;
}
