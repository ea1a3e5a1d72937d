/* SPDX-License-Identifier: GPL-3.0-or-later */
/* scene_lattice.h - label scenes as lattices. */
#ifndef SG_PARSE_SCENE_LATTICE_H
#define SG_PARSE_SCENE_LATTICE_H

#include "parse/lattice.h"
#include "scene/label_scene.h"

/** The lattice of a scene in pixels: its grid lines are all cuts, rounded as the raster rounds them (so lattice and label
 *  map agree in every pixel; cuts that fall together become one line). Labels are numbered as in the grammar.
 *  @param width, height  of the label map, px
 *  @return SG_OK, SG_EINVAL (more than SG_LATTICE_MAX_SIDE cells along a side, an empty scene), SG_ENOMEM */
sg_status sg_lattice_of_scene(const sg_label_scene *scene, const sg_grammar *g, size_t width, size_t height,
                              sg_arena *arena, sg_lattice *out, sg_error *err);

#endif
