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

#endif
