/* SPDX-License-Identifier: GPL-3.0-or-later */
/* label_svg.h - label scenes as scalable vector graphics. */
#ifndef SG_SCENE_LABEL_SVG_H
#define SG_SCENE_LABEL_SVG_H

#include "scene/label_scene.h"

#include <stdio.h>

/** One <g> a label in the label's colour, one <rect> a rectangle, in scene units.
 *  @return SG_OK, SG_EIO (also found later, when the file is flushed) */
sg_status sg_label_svg_write(const sg_label_scene *scene, const sg_grammar *g, FILE *out, sg_error *err);

#endif
