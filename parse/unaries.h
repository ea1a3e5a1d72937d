/* SPDX-License-Identifier: GPL-3.0-or-later */
/* unaries.h - per-pixel class probabilities and what is made of them: checks, MAP label maps, hard ones, costs. */
#ifndef SG_PARSE_UNARIES_H
#define SG_PARSE_UNARIES_H

#include "grammar/grammar.h"
#include "image/classes.h"
#include "image/image.h"
#include "image/npy.h"

/** Read DIR/NAME.npy; probabilities must be finite, >= 0 and sum to 1 over the channels within 1e-3 in every pixel.
 *  They are lifted to the floor: sg_unaries_lift().
 *  @param nclasses  channels that the file must have
 *  @param floor     as sg_unaries_lift() has it
 *  @return SG_OK, SG_EINVAL (the floor), SG_EINPUT (missing, wrong shape or type, NaN, no distribution: file and first pixel
 *          are named), SG_ENOMEM; out only on success, free with sg_float_map_clear() */
sg_status sg_unaries_read(const char *dir, const char *name, size_t nclasses, float floor, sg_float_map *out,
                          sg_error *err);

/** Probabilities below `floor` become the floor, and the pixel is normalised again: -log 0 would decide a parse alone. Pixels
 *  that are above it in all channels are not touched. @param floor  in [0, 1 / channels); 0: nothing is done */
sg_status sg_unaries_lift(sg_float_map *p, float floor, sg_error *err);

/** The most probable class of every pixel; ties go to the lower class.
 *  @return SG_OK, SG_EINVAL (more channels than a label map tells apart), SG_ENOMEM; map is made here */
sg_status sg_unaries_map(const sg_float_map *p, sg_label_map *map, sg_error *err);

/** Replace probabilities by those of their MAP alone: `right` for the MAP class, (1 - right) / (classes - 1) for each other
 *  one (0.994 makes 0.001 with seven classes, the published setting).
 *  @param right  in (1 / classes, 1)
 *  @return SG_OK, SG_EINVAL (right) */
sg_status sg_unaries_harden(sg_float_map *p, double right, sg_error *err);

/** -log of every probability, nats, in place; at least 0, and finite where the probability is not 0. */
void sg_unaries_to_costs(sg_float_map *p);

/** The channel of each label of a grammar, by name.
 *  @param channel  out [symbols of g], UINT32_MAX for other symbols
 *  @return SG_OK, SG_EINPUT (a label of the grammar is no class: all such labels are named, and the classes that there are) */
sg_status sg_unaries_channels(const sg_grammar *g, const sg_classes *classes, uint32_t *channel, sg_error *err);

#endif
