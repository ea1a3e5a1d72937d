/* SPDX-License-Identifier: GPL-3.0-or-later */
/* frame.h - right-handed orthonormal frames in space, and the few vector operations that they need. */
#ifndef SG_SCENE_FRAME_H
#define SG_SCENE_FRAME_H

#include <stdbool.h>

/** A place and three axes of length 1, z = x cross y. */
typedef struct {
    double origin[3], x[3], y[3], z[3];
} sg_frame;

#define SG_FRAME_INIT {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}

static inline double sg_vec_dot(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void sg_vec_cross(const double *a, const double *b, double *out)
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/** a + s b, where out may be a or b. */
static inline void sg_vec_add(const double *a, double s, const double *b, double *out)
{
    for (int i = 0; i < 3; i++)
        out[i] = a[i] + s * b[i];
}

double sg_vec_length(const double *a);
/** Scale a to length 1. @return false when it is too short to have a direction; then it is as it was */
bool sg_vec_normalize(double *a);

/** The point with these coordinates in the frame. */
void sg_frame_point(const sg_frame *f, double x, double y, double z, double *out);
/** The direction with these coordinates in the frame. */
void sg_frame_direction(const sg_frame *f, double x, double y, double z, double *out);
/** Move the origin to the point with these coordinates. */
void sg_frame_move(sg_frame *f, double x, double y, double z);
/** Turn the axes about a direction of length 1 through the origin, by the right-hand rule: one of its own, which is quickest,
 *  or any that is not part of the frame. The axes are made orthonormal again, so that rounding does not add up over long
 *  chains. */
void sg_frame_turn(sg_frame *f, const double *axis, double radians);
/** The same frame with axes (x, z, -y) or its like: new axes are signed old ones, 1 x, 2 y, 3 z, negative: reversed.
 *  @param x, y  the new axes; the third follows */
sg_frame sg_frame_permute(const sg_frame *f, int x, int y);

#endif
