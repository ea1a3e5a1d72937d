/* SPDX-License-Identifier: GPL-3.0-or-later */
/* lattice_draw.h - lattices as label maps and as pictures. */
#ifndef SG_PARSE_LATTICE_DRAW_H
#define SG_PARSE_LATTICE_DRAW_H

#include "image/image.h"
#include "parse/lattice.h"

/** Paint the cells as a label map of (x[W] - x[0]) x (y[H] - y[0]) pixels, made here.
 *  @param value_of  [l->nlabels] pixel value of each label
 *  @return SG_OK, SG_EINVAL (larger than a picture may be), SG_ENOMEM */
sg_status sg_lattice_paint(const sg_lattice *l, const uint8_t *value_of, sg_label_map *out, sg_error *err);

/** Draw the cells in their labels' colours, with lines between them, as a picture made here.
 *  @param colors  [l->nlabels] 0xRRGGBB
 *  @param scale   picture px per lattice px, 1 to 16; a line darkens one picture px
 *  @return SG_OK, SG_EINVAL (no such scale, larger than a picture may be), SG_ENOMEM */
sg_status sg_lattice_draw(const sg_lattice *l, const uint32_t *colors, size_t scale, sg_image *out, sg_error *err);

/** Draw the cells pale and, in full colour, the true label of each pixel that is not its cell's; ignored pixels grey.
 *  @param classes  [l->nlabels] class of each label in the map
 *  @param truth    classes or SG_CLASS_IGNORE, of the lattice's size
 *  @param colors   [number of classes] 0xRRGGBB
 *  @return SG_OK, SG_EINVAL (another size, no such scale), SG_ENOMEM */
sg_status sg_lattice_draw_errors(const sg_lattice *l, const uint8_t *classes, const sg_label_map *truth,
                                 const uint32_t *colors, size_t scale, sg_image *out, sg_error *err);

#endif
