/* SPDX-License-Identifier: GPL-3.0-or-later */
/* label_score_priv.h - the target and the state of label scores.
 *
 * A label scene is a partition, so in every pixel the cost of the cheapest label is paid whatever the scene says. It is summed
 * once, into `base`; the integral images hold what a label costs above it. What is placed so far then bounds the whole from
 * below, and tightly. */
#ifndef SG_SCORE_LABEL_SCORE_PRIV_H
#define SG_SCORE_LABEL_SCORE_PRIV_H

#include "score/label_score.h"

/** Costs are integers in units of 2^-28 nats: exact for 32-bit floats from 1/16 nat on. */
#define SG_LABEL_UNITS_PER_NAT 268435456.0

/** Labels of one corner stand side by side, so that they share a cache line. */
typedef struct {
    size_t width, height; /* px */
    size_t channels;      /* labels of the grammar that are told apart, padded to a cache line */
    int64_t *sums;        /* [height + 1][width + 1][channels] of the pixels above and to the left, above the cheapest */
    int64_t base;         /* sum over all pixels of the cheapest label's cost */
} sg_label_sums;

typedef struct {
    sg_score score; /* first */
    const sg_grammar *g;
    sg_label_sums image;
    uint32_t *channel; /* [symbols] of a label, in `image` */
    double nats;       /* weight of one unit */
} sg_label_target;

/** Sum over the pixels [x0, x1) x [y0, y1). */
static inline int64_t sg_label_sum(const sg_label_sums *s, uint32_t channel, size_t x0, size_t y0, size_t x1, size_t y1)
{
    const size_t row = s->width + 1;
    const int64_t *at = s->sums + channel;
    return at[(y1 * row + x1) * s->channels] - at[(y1 * row + x0) * s->channels] -
           at[(y0 * row + x1) * s->channels] + at[(y0 * row + x0) * s->channels];
}

void sg_label_target_free(sg_score *target);
extern const sg_score_ops sg_label_score_ops;

#endif
