/* SPDX-License-Identifier: GPL-3.0-or-later */
/* render.h - pictures of meshes and scenes: a sun, a sky, shadows, on a light ground.
 *
 * A picture is the mean, in linear light, of several that are drawn with one sample in each pixel, at another place in
 * it each time. Each of these sees light from other directions, so their mean has as many directions as all together. */
#ifndef SG_SCENE_RENDER_H
#define SG_SCENE_RENDER_H

#include "core/progress.h"
#include "image/image.h"
#include "scene/light.h"
#include "scene/scene.h"

typedef struct {
    size_t samples;      /* in each pixel, 1 to 256 */
    size_t sky, sun;     /* directions of light for each of them, 0: none is hidden */
    double sun_azimuth;  /* degrees from the camera towards the front of the model, so that its front is lit; to the left
                            of a camera that stands right before it */
    double sun_elevation;
    uint32_t background; /* 0xRRGGBB, of the ground too */
    bool ground;         /* is there ground that catches shadows, at the lowest point of the mesh? */
    int threads;         /* that may draw at once; the picture does not depend on it; less than 1: one */
    sg_progress *progress; /* asked before each sample whether to stop, by any thread; NULL: nobody is */
} sg_render_opts;

#define SG_RENDER_OPTS_INIT {16, 10, 2, 60, 45, 0xf4f4f2, true, 1, NULL}

/** Draw a mesh into a picture, of the size that it has. Directions of light become fewer when very many triangles are in
 *  its way.
 *  @param casts  what hides the light: a coarser mesh of the same scene, or NULL: the mesh itself
 *  @return SG_OK, SG_EINVAL (options out of range), SG_ENUMERIC (2^31 faces), SG_ENOMEM, SG_STOPPED
 *  O(samples (sky + sun) (faces + pixels)) time; 12 bytes a pixel beside the picture, and for each thread about 52 and
 *  10 MB: large pictures have no more threads than 1 GB allows */
sg_status sg_render_mesh(const sg_mesh *mesh, const sg_mesh *casts, const sg_camera *camera, const sg_render_opts *opts,
                         sg_image *im, sg_error *err);

/** Draw a scene as this view shows it. Segments that would be thinner than about half a pixel are drawn that wide: twigs
 *  do not vanish. An empty scene is an empty picture. What is round in a large mesh hides the light as if it had few sides.
 *  @param mesh   work space: holds the mesh that is drawn afterwards
 *  @return as above and as sg_mesh_from_scene() */
sg_status sg_render_scene(const sg_scene *scene, const sg_mesh_opts *mesh_opts, const sg_view *view,
                          const sg_render_opts *opts, sg_mesh *mesh, sg_image *im, sg_error *err);

#endif
