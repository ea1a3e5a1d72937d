/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shadow_map.c - orthographic depth buffers, and the map from points to their pixels. */
#include "scene/shadow_map.h"

#include <math.h>

sg_ball sg_ball_of(const sg_mesh *mesh)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, half[3];
    sg_ball ball = {{0, 0, 0}, 1};
    if (mesh->nvertices == 0)
        return ball;
    for (size_t i = 0; i < mesh->nvertices; i++)
        for (int k = 0; k < 3; k++) {
            low[k] = fmin(low[k], mesh->vertices[i][k]);
            high[k] = fmax(high[k], mesh->vertices[i][k]);
        }
    for (int k = 0; k < 3; k++) {
        ball.centre[k] = (low[k] + high[k]) / 2;
        half[k] = (high[k] - low[k]) / 2;
    }
    const double radius = sg_vec_length(half);
    ball.radius = radius > 0 ? radius : 1;
    return ball;
}

void sg_ball_coordinates(const sg_ball *ball, const double *point, float *out)
{
    for (int k = 0; k < 3; k++)
        out[k] = (float)((point[k] - ball->centre[k]) / ball->radius);
}

sg_status sg_shadow_map_create(size_t side, sg_shadow_map *out, sg_error *err)
{
    sg_shadow_map map = {0};
    SG_TRY(sg_raster_create(side, side, false, &map.raster, err));
    *out = map;
    return SG_OK;
}

void sg_shadow_map_clear(sg_shadow_map *map)
{
    sg_raster_clear(&map->raster);
}

/* value = factor * (p - eye) . axis + term, p = centre + radius q */
static void set_row(float *row, const sg_camera *c, const sg_ball *ball, const double *axis, double factor, double term)
{
    double d[3];
    sg_vec_add(ball->centre, -1, c->frame.origin, d);
    for (int k = 0; k < 3; k++)
        row[k] = (float)(factor * ball->radius * axis[k]);
    row[3] = (float)(factor * sg_vec_dot(d, axis) + term);
}

sg_status sg_shadow_map_draw(sg_shadow_map *map, const sg_mesh *mesh, const sg_ball *ball, const double *towards_light,
                             sg_error *err)
{
    static const double centre[2] = {0.5, 0.5};
    const double degrees = 57.29577951308232;
    sg_view view = SG_VIEW_INIT;
    view.projection = SG_PROJECTION_ORTHOGRAPHIC;
    view.azimuth = degrees * atan2(towards_light[0], towards_light[2]);
    view.elevation = degrees * asin(fmin(1, fmax(-1, towards_light[1])));
    view.margin = 0.01;
    const sg_camera c = sg_camera_fit((const double(*)[3])mesh->vertices, mesh->nvertices, &view, 1);
    const double half = (double)map->raster.width / 2;
    set_row(map->row[0], &c, ball, c.frame.x, half / c.half[0], half);
    set_row(map->row[1], &c, ball, c.frame.y, -half / c.half[1], half);
    set_row(map->row[2], &c, ball, c.frame.z, -1 / c.scale, 0);
    sg_raster_wipe(&map->raster);
    return sg_raster_draw(&map->raster, mesh, &c, centre, err);
}

/* Over half a pixel's diagonal a plane at angle t to the light rises by tan t; lifted along its normal it stands 1 / cos t
 * deeper. A little more is for what is curved, and for rounding. */
double sg_shadow_map_lift(size_t side)
{
    return 1.2 * 2 / (double)side;
}
