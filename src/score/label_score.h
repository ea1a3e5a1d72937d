/* SPDX-License-Identifier: GPL-3.0-or-later */
/* label_score.h - per-pixel label costs: E_img of DESIGN 5.4 for derivations that make label scenes.
 *
 * log = -weight * sum over pixels of cost(label of the pixel), where the label is that of the scene's raster
 * (label_scene.h: pixel centres decide); value = log / pixels. Sums over rectangles come from integral images in fixed
 * point, so that they are exact: what is carried over any number of changes equals what is computed from scratch to the
 * last bit. Tied siblings are scored at every occurrence. The scope is as large as the costs, in pixels.
 *
 * Pixels of open nodes cost what the cheapest label does there: the log of a partial derivation is no less than that of any
 * of its completions. */
#ifndef SG_SCORE_LABEL_SCORE_H
#define SG_SCORE_LABEL_SCORE_H

#include "image/npy.h"
#include "score/score.h"

/** @param costs    [channels][height][width] nats, finite, >= 0
 *  @param channel  [symbols of g] the channel of each label; for other symbols not read
 *  @param weight   > 0, 1 as published; less where neighbouring pixels say the same thing twice
 *  @return SG_OK, SG_EINVAL (a cost that is negative or not finite, or a sum of them out of range; a channel that is not
 *          there; a weight that is no positive number), SG_ENOMEM; *out is freed with sg_score_free(), g must outlive it */
sg_status sg_label_score_create(const sg_grammar *g, const sg_float_map *costs, const uint32_t *channel, double weight,
                                sg_score **out, sg_error *err);

#endif
