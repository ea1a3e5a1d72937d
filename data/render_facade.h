/* SPDX-License-Identifier: GPL-3.0-or-later */
/* render_facade.h - a facade, given as labelled rectangles, as a photograph of a Haussmannian house.
 * Each rectangle is painted by what its label says and by what is around it (a balcony shows the window behind it, a window
 * in the roof is a dormer); then one light falls on all of it, the street stands before it, and a camera takes it. */
#ifndef SG_DATA_RENDER_FACADE_H
#define SG_DATA_RENDER_FACADE_H

#include "core/status.h"
#include "data/render_canvas.h"
#include "image/image.h"

typedef enum {
    SG_PART_SKY,
    SG_PART_WALL,
    SG_PART_ROOF,
    SG_PART_CHIMNEY,
    SG_PART_SHOP,
    SG_PART_DOOR,
    SG_PART_WINDOW,
    SG_PART_BALCONY,
    SG_PARTS,
} sg_part;

/** Part of a label's name, or SG_PARTS. */
sg_part sg_part_named(const char *name);

typedef struct {
    sg_part part;
    sg_box box; /* photograph pixels, y down */
} sg_facade_element;

typedef struct {
    size_t width, height; /* of the photograph, px */
    size_t nelements;
    const sg_facade_element *elements;
} sg_facade;

/** Render with the random streams (seed, picture, ...). out is made here.
 *  @return SG_OK, SG_EINVAL (no elements), SG_ENOMEM */
sg_status sg_facade_render(const sg_facade *f, uint64_t seed, uint32_t picture, sg_image *out, sg_error *err);

#endif
