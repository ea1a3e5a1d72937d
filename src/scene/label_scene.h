/* SPDX-License-Identifier: GPL-3.0-or-later */
/* label_scene.h - a derivation of splits and labels as rectangles, and their raster.
 * Picture coordinates: x to the right, y down, the whole scope is [0,width] x [0,height]. The language's y runs up, so the
 * first part of a "split y" is the lowest; the one reversal is made in interpretation.
 *
 * A label scene is a partition: each body places one thing in its scope (a symbol, a label, a split or a repeat along x
 * or y), the parts of a split fill it, neighbours share their boundary to the last bit. What cannot be one is an error. */
#ifndef SG_SCENE_LABEL_SCENE_H
#define SG_SCENE_LABEL_SCENE_H

#include "derivation/derivation.h"
#include "image/classes.h"
#include "image/image.h"

typedef struct {
    double x0, y0, x1, y1;
    sg_sym label; /* a symbol of kind SG_SYMBOL_LABEL */
    uint32_t node;
} sg_label_rect;

typedef struct {
    double width, height;
    sg_label_rect *rects; /* in the pre-order of the derivation, and of one split left to right or top to bottom */
    size_t nrects, capacity;
    struct sg_placer *placer; /* work space, kept from one interpretation to the next */
} sg_label_scene;

/** Most symbols and labels that one interpretation places. Tied siblings are placed at every occurrence, so a small
 *  derivation can ask for very many. */
#define SG_LABEL_SCENE_MAX_PLACES ((size_t)1 << 22)

/** Interpret a complete derivation over a width x height scope. The scene is emptied first and keeps its memory; start
 *  from a zeroed one and free with sg_label_scene_clear().
 *  @return SG_OK, SG_ENUMERIC (absolute parts are larger than the scope, parts do not fill it, an operation that is no
 *          split, a cut along z, an open node, an empty body; the sentence tells file, line and derivation path), SG_ENOMEM */
sg_status sg_label_scene_interpret(sg_label_scene *scene, const sg_derivation *d, double width, double height,
                                   sg_error *err);
void sg_label_scene_clear(sg_label_scene *scene);

/** First of n pixels whose centre is not in front of coordinate c of a scene that is `extent` long. */
size_t sg_label_scene_pixel(double c, double extent, size_t n);

/** Paint into a label map of any size, scaled to the scene: pixel centres decide, so the map has no gaps and no overlaps.
 *  @param value_of  [symbols of the grammar] pixel value of each label */
void sg_label_scene_raster(const sg_label_scene *scene, const uint8_t *value_of, sg_label_map *map);
/** The same as a picture in the labels' colours. */
void sg_label_scene_paint(const sg_label_scene *scene, const sg_grammar *g, sg_image *im);
/** Area shares of the labels. @param share out [symbols of the grammar], 0 for what is no label; the sum is 1 */
void sg_label_scene_shares(const sg_label_scene *scene, const sg_grammar *g, double *share);

/** The labels of a grammar as a class table, pixel indices 0..n-1 in the order of the grammar.
 *  @param value_of  out [symbols of the grammar]: pixel value of each label, 0 for other symbols
 *  @return SG_OK, SG_EINPUT (no label, too many for a class table, a name that is not one word), SG_ENOMEM; classes
 *          only on success, free with sg_classes_clear() */
sg_status sg_label_classes(const sg_grammar *g, sg_classes *classes, uint8_t *value_of, sg_error *err);

#endif
