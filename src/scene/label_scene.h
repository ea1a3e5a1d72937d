/* SPDX-License-Identifier: GPL-3.0-or-later */
/* label_scene.h - a derivation of splits and labels as rectangles, and their raster.
 * Picture coordinates: x to the right, y down, the whole scope is [0,width] x [0,height]. */
#ifndef SG_SCENE_LABEL_SCENE_H
#define SG_SCENE_LABEL_SCENE_H

#include "derivation/derivation.h"
#include "image/image.h"

typedef struct {
    double x0, y0, x1, y1;
    sg_sym label; /* a symbol of kind SG_SYMBOL_LABEL */
    uint32_t node;
} sg_label_rect;

typedef struct {
    double width, height;
    sg_label_rect *rects;
    size_t nrects, capacity;
} sg_label_scene;

/** Interpret a complete derivation over a width x height scope. The scene is emptied first and keeps its memory; start
 *  from a zeroed one and free with sg_label_scene_clear().
 *  @return SG_OK, SG_ENUMERIC (absolute parts are larger than the scope, an operation that is no split), SG_ENOMEM */
sg_status sg_label_scene_interpret(sg_label_scene *scene, const sg_derivation *d, double width, double height,
                                   sg_error *err);
void sg_label_scene_clear(sg_label_scene *scene);

/** Paint into a label map of the scene's size rounded: pixel centres decide, so the map has no gaps and no overlaps.
 *  @param value_of  [symbols of the grammar] pixel value of each label */
void sg_label_scene_raster(const sg_label_scene *scene, const uint8_t *value_of, sg_label_map *map);

#endif
