/* SPDX-License-Identifier: GPL-3.0-or-later */
/* render_scene.c - a scene before a camera that sees all of it, with twigs wide enough to be seen. */
#include "scene/render.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Least width of a segment, in pixels. */
static const double thinnest = 0.6;

/* Width of a pixel where the middle of the model lies. */
static double pixel_width(const sg_mesh *mesh, const sg_camera *c, const sg_image *im)
{
    const sg_ball ball = sg_ball_of(mesh);
    double at[3];
    sg_camera_coordinates(c, ball.centre, at);
    return 2 * c->half[1] * (c->projection == SG_PROJECTION_PERSPECTIVE ? at[2] : 1) / (double)im->height;
}

static bool is_thin(const sg_primitive *p, double radius)
{
    return p->kind == SG_PRIMITIVE_SEGMENT && (p->radius[0] > 0 || p->radius[1] > 0) &&
           (p->radius[0] < radius || p->radius[1] < radius);
}

/* Joints keep fitting: both sides of one have the same radius, before and after. */
static sg_status thicken(const sg_scene *scene, double radius, sg_scene *out, bool *any, sg_error *err)
{
    *any = false;
    for (size_t i = 0; i < scene->n && !*any; i++)
        *any = is_thin(scene->items + i, radius);
    if (!*any)
        return SG_OK;
    *out = *scene; /* all but the items is shared */
    if ((out->items = malloc(scene->n * sizeof *out->items)) == NULL)
        return SG_FAIL_NOMEM(err);
    memcpy(out->items, scene->items, scene->n * sizeof *out->items);
    for (size_t i = 0; i < out->n; i++)
        for (int k = 0; k < 2 && is_thin(out->items + i, radius); k++)
            out->items[i].radius[k] = fmax(out->items[i].radius[k], radius);
    return SG_OK;
}

/* Few sides lie within many: a coarse mesh does not hide the light from the fine one. */
static sg_status draw(const sg_scene *scene, const sg_mesh_opts *mesh_opts, const sg_mesh *mesh, const sg_camera *camera,
                      const sg_render_opts *opts, sg_image *im, sg_error *err)
{
    enum { LARGE = 50000 /* faces */, SIDES = 5 };
    const sg_mesh_opts coarse = {SIDES, 0, mesh_opts->assets};
    if (mesh->nfaces < LARGE || mesh_opts->detail > 15 || mesh_opts->radial >> mesh_opts->detail <= SIDES)
        return sg_render_mesh(mesh, NULL, camera, opts, im, err);
    sg_mesh casts = {0};
    sg_status st = sg_mesh_from_scene(scene, &coarse, &casts, err);
    if (st == SG_OK)
        st = sg_render_mesh(mesh, &casts, camera, opts, im, err);
    sg_mesh_clear(&casts);
    return st;
}

sg_status sg_render_scene(const sg_scene *scene, const sg_mesh_opts *mesh_opts, const sg_view *view,
                          const sg_render_opts *opts, sg_mesh *mesh, sg_image *im, sg_error *err)
{
    sg_scene thick;
    bool any;
    SG_TRY(sg_mesh_from_scene(scene, mesh_opts, mesh, err));
    const double aspect = (double)im->width / (double)im->height;
    const sg_camera camera = sg_camera_fit((const double(*)[3])mesh->vertices, mesh->nvertices, view, aspect);
    SG_TRY(thicken(scene, thinnest / 2 * pixel_width(mesh, &camera, im), &thick, &any, err));
    if (!any)
        return draw(scene, mesh_opts, mesh, &camera, opts, im, err);
    sg_status st = sg_mesh_from_scene(&thick, mesh_opts, mesh, err);
    if (st == SG_OK)
        st = draw(&thick, mesh_opts, mesh, &camera, opts, im, err);
    free(thick.items);
    return st;
}
