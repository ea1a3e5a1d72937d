/* SPDX-License-Identifier: GPL-3.0-or-later */
/* camera.c - projections, rays, and cameras that see all of a model. */
#include "scene/camera.h"

#include <math.h>
#include <string.h>

static const double degree = 0.017453292519943295;

/* z points from the model to the viewer, x is level, so that looking straight down or up is nothing special. */
static sg_frame view_axes(const sg_view *v)
{
    const double a = v->azimuth * degree, e = v->elevation * degree;
    return (sg_frame){{0, 0, 0},
                      {cos(a), 0, -sin(a)},
                      {-sin(a) * sin(e), cos(e), -cos(a) * sin(e)},
                      {sin(a) * cos(e), sin(e), cos(a) * cos(e)}};
}

/* How far points reach in the axes of a view, and in the directions that bound its pyramid. */
typedef struct {
    double low[3], high[3];
    double side[2][2]; /* for x and y: most of z t + x, and of z t - x */
} extent;

/* fmax() is a call, and this is done for each vertex and each direction of light. */
static double greater(double a, double b)
{
    return a > b ? a : b;
}

static void extend(extent *e, const sg_frame *axes, const double *tangent, const double *point)
{
    const double at[3] = {sg_vec_dot(point, axes->x), sg_vec_dot(point, axes->y), sg_vec_dot(point, axes->z)};
    for (int i = 0; i < 3; i++) {
        e->low[i] = at[i] < e->low[i] ? at[i] : e->low[i];
        e->high[i] = greater(e->high[i], at[i]);
    }
    for (int i = 0; i < 2; i++) {
        e->side[i][0] = greater(e->side[i][0], at[2] * tangent[i] + at[i]);
        e->side[i][1] = greater(e->side[i][1], at[2] * tangent[i] - at[i]);
    }
}

static extent extent_of(const double (*points)[3], size_t n, const sg_frame *axes, const double *tangent)
{
    static const double ball[6][3] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    const double inf = INFINITY;
    extent e = {{inf, inf, inf}, {-inf, -inf, -inf}, {{-inf, -inf}, {-inf, -inf}}};
    for (size_t i = 0; i < (n > 0 ? n : 6); i++)
        extend(&e, axes, tangent, n > 0 ? points[i] : ball[i]);
    return e;
}

/* Length of the diagonal; a point, which has none, is looked at as if it had a size. */
static double diagonal(const extent *e)
{
    double span[3], far = 0;
    for (int i = 0; i < 3; i++) {
        span[i] = e->high[i] - e->low[i];
        far = fmax(far, fmax(fabs(e->low[i]), fabs(e->high[i])));
    }
    const double length = sg_vec_length(span), least = far > 0 ? 1e-6 * far : 1;
    return length > least ? length : least;
}

/* The four sides of the pyramid touch the points, or two of them do and the points are in the middle of the others. */
static void place_perspective(sg_camera *c, const extent *e, const double *tangent, double size)
{
    double eye[3];
    eye[2] = e->high[2] + size / 2;
    for (int i = 0; i < 2; i++) {
        eye[i] = (e->side[i][0] - e->side[i][1]) / 2;
        eye[2] = fmax(eye[2], (e->side[i][0] + e->side[i][1]) / (2 * tangent[i]));
    }
    c->near = (eye[2] - e->high[2]) / 2;
    c->scale = c->near;
    sg_frame_move(&c->frame, eye[0], eye[1], eye[2]);
}

static void place_orthographic(sg_camera *c, const extent *e, double aspect, double margin, double size)
{
    const double width = (e->high[0] - e->low[0]) / 2, height = (e->high[1] - e->low[1]) / 2;
    c->half[1] = fmax(fmax(height, width / aspect), size / 1000 / fmin(1, aspect)) / (1 - margin);
    c->half[0] = c->half[1] * aspect;
    c->near = 0;
    c->scale = size;
    sg_frame_move(&c->frame, (e->low[0] + e->high[0]) / 2, (e->low[1] + e->high[1]) / 2, e->high[2] + size / 100);
}

sg_camera sg_camera_fit(const double (*points)[3], size_t n, const sg_view *view, double aspect)
{
    sg_camera c = {.frame = view_axes(view), .projection = view->projection};
    const double t = tan(view->angle * degree / 2), inner = 1 - view->margin;
    c.half[0] = t * fmin(1, aspect);
    c.half[1] = t * fmin(1, 1 / aspect);
    const double tangent[2] = {inner * c.half[0], inner * c.half[1]};
    const extent e = extent_of(points, n, &c.frame, tangent);
    const double size = diagonal(&e);
    if (view->projection == SG_PROJECTION_PERSPECTIVE)
        place_perspective(&c, &e, tangent, size);
    else
        place_orthographic(&c, &e, aspect, view->margin, size);
    return c;
}

void sg_camera_coordinates(const sg_camera *c, const double *point, double *out)
{
    double d[3];
    sg_vec_add(point, -1, c->frame.origin, d);
    out[0] = sg_vec_dot(d, c->frame.x);
    out[1] = sg_vec_dot(d, c->frame.y);
    out[2] = -sg_vec_dot(d, c->frame.z);
}

void sg_camera_project(const sg_camera *c, const double *point, size_t width, size_t height, double *out)
{
    double at[3];
    sg_camera_coordinates(c, point, at);
    const double w = c->projection == SG_PROJECTION_PERSPECTIVE ? at[2] : 1;
    out[0] = (1 + at[0] / (c->half[0] * w)) * (double)width / 2;
    out[1] = (1 - at[1] / (c->half[1] * w)) * (double)height / 2;
    out[2] = sg_camera_key(c, at[2]);
}

void sg_camera_ray(const sg_camera *c, double x, double y, size_t width, size_t height, double *origin, double *direction)
{
    const double right = (2 * x / (double)width - 1) * c->half[0], up = (1 - 2 * y / (double)height) * c->half[1];
    if (c->projection == SG_PROJECTION_PERSPECTIVE) {
        memcpy(origin, c->frame.origin, sizeof c->frame.origin);
        sg_frame_direction(&c->frame, right, up, -1, direction);
    } else {
        sg_frame_point(&c->frame, right, up, 0, origin);
        sg_frame_direction(&c->frame, 0, 0, -1, direction);
    }
}
