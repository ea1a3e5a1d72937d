/* SPDX-License-Identifier: GPL-3.0-or-later */
/* overlay.h - what was found in a photograph, drawn over it. */
#ifndef SG_SCENE_OVERLAY_H
#define SG_SCENE_OVERLAY_H

#include "image/image.h"
#include "scene/label_scene.h"

/** The photograph with a label map laid over it: each pixel half photograph, half colour of its label; regions of one label
 *  are parted by black lines one pixel wide (the last pixels of a region to the right and at the bottom). A pixel whose
 *  label has no colour shows the photograph.
 *  @param map     as large as the photograph
 *  @param colors  [ncolors] 0xRRGGBB by label
 *  @param out     made here
 *  @return SG_OK, SG_EINVAL (sizes differ), SG_ENOMEM; out only on success */
sg_status sg_overlay_labels(const sg_image *photo, const sg_label_map *map, const uint32_t *colors, size_t ncolors,
                            sg_image *out, sg_error *err);

/** The outlines of a scene's rectangles, scaled to the picture as its raster is, drawn into im: neighbours of one label are
 *  told apart too. The line runs where rectangles meet, one pixel wide, inside of the left or upper one; the picture's own
 *  frame is left. @param color  0xRRGGBB */
void sg_overlay_outlines(const sg_label_scene *scene, uint32_t color, sg_image *im);

/** A value of each pixel as heat: from black (0) over violet and red to white (1), brighter throughout (cubehelix; Green,
 *  "A colour scheme for the display of astronomical intensity images", 2011), so that it reads in grey as well.
 *  @param photo    shows through, in grey; its width and height are those of value01
 *  @param value01  [height][width], taken as 0 below it or where it is no number, as 1 above it
 *  @param out      made here
 *  @return SG_OK, SG_ENOMEM; out only on success */
sg_status sg_overlay_heat(const sg_image *photo, const float *value01, sg_image *out, sg_error *err);

/** Colour of the ramp at a value in [0, 1], 0xRRGGBB: for legends. */
uint32_t sg_overlay_ramp(double value01);

#endif
