/* SPDX-License-Identifier: GPL-3.0-or-later */
/* frame.c - frames in space. */
#include "scene/frame.h"

#include <float.h>
#include <math.h>
#include <string.h>

double sg_vec_length(const double *a)
{
    return sqrt(sg_vec_dot(a, a));
}

bool sg_vec_normalize(double *a)
{
    const double length = sg_vec_length(a);
    if (!(length > sqrt(DBL_MIN)) || !isfinite(length))
        return false;
    for (int i = 0; i < 3; i++)
        a[i] /= length;
    return true;
}

void sg_frame_direction(const sg_frame *f, double x, double y, double z, double *out)
{
    for (int i = 0; i < 3; i++)
        out[i] = x * f->x[i] + y * f->y[i] + z * f->z[i];
}

void sg_frame_point(const sg_frame *f, double x, double y, double z, double *out)
{
    double d[3];
    sg_frame_direction(f, x, y, z, d);
    sg_vec_add(f->origin, 1, d, out);
}

void sg_frame_move(sg_frame *f, double x, double y, double z)
{
    sg_frame_point(f, x, y, z, f->origin);
}

/* Rodrigues' formula. */
static void turn_vector(double *v, const double *axis, double c, double s)
{
    double across[3];
    sg_vec_cross(axis, v, across);
    const double along = sg_vec_dot(axis, v) * (1 - c);
    for (int i = 0; i < 3; i++)
        v[i] = c * v[i] + s * across[i] + along * axis[i];
}

/* Turn a towards b, at a right angle to it. */
static void turn_pair(double *a, double *b, double c, double s)
{
    for (int i = 0; i < 3; i++) {
        const double ai = a[i], bi = b[i];
        a[i] = c * ai + s * bi;
        b[i] = c * bi - s * ai;
    }
}

/* Of a vector whose length is 1 up to a little rounding: a step of Newton's method for 1 / sqrt from 1, which is as good as
 * the root itself and takes no division. */
static void settle_length(double *a)
{
    const double factor = 1.5 - 0.5 * sg_vec_dot(a, a);
    for (int i = 0; i < 3; i++)
        a[i] *= factor;
}

void sg_frame_turn(sg_frame *f, const double *axis, double radians)
{
    const double c = cos(radians), s = sin(radians);
    if (axis == f->x)
        turn_pair(f->y, f->z, c, s);
    else if (axis == f->y)
        turn_pair(f->z, f->x, c, s);
    else if (axis == f->z)
        turn_pair(f->x, f->y, c, s);
    else {
        turn_vector(f->x, axis, c, s);
        turn_vector(f->y, axis, c, s);
    }
    settle_length(f->y);
    sg_vec_add(f->x, -sg_vec_dot(f->x, f->y), f->y, f->x);
    settle_length(f->x);
    sg_vec_cross(f->x, f->y, f->z);
}

static void signed_axis(const sg_frame *f, int which, double *out)
{
    const double *axis = which == 1 || which == -1 ? f->x : which == 2 || which == -2 ? f->y : f->z;
    for (int i = 0; i < 3; i++)
        out[i] = which > 0 ? axis[i] : -axis[i];
}

sg_frame sg_frame_permute(const sg_frame *f, int x, int y)
{
    /* +1 for x y -> z and its turns, -1 for the other order, and once more for each reversed axis. */
    const int ax = x < 0 ? -x : x, ay = y < 0 ? -y : y, third = 6 - ax - ay;
    const int order = ay % 3 == (ax + 1) % 3 ? 1 : -1;
    sg_frame out;
    memcpy(out.origin, f->origin, sizeof out.origin);
    signed_axis(f, x, out.x);
    signed_axis(f, y, out.y);
    signed_axis(f, third * order * (x < 0 ? -1 : 1) * (y < 0 ? -1 : 1), out.z);
    return out;
}
