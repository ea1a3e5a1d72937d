/* SPDX-License-Identifier: GPL-3.0-or-later */
/* facade_samples.h - the parses that the cold chains of a search pass through, kept as rectangles of pixels: what
 * marginals and the uncertainty of lines are made from.
 *
 * How long a search will run is not always known, so samples are kept all the way, at intervals that double whenever there
 * are too many; at the end a window of iterations is chosen, which leaves out what came before the chains had settled. */
#ifndef SG_PARSE_FACADE_SAMPLES_H
#define SG_PARSE_FACADE_SAMPLES_H

#include "image/npy.h"
#include "scene/label_scene.h"
#include "search/metropolis.h"

#include <stddef.h>
#include <stdint.h>

typedef struct {
    uint16_t x0, y0, x1, y1; /* px, half open */
    uint8_t channel;
} sg_pixel_rect;

typedef struct {
    uint32_t run;
    uint64_t iteration;
    size_t first, nrects; /* its rectangles: they tile the picture */
} sg_facade_sample;

typedef struct {
    size_t width, height, nchannels; /* of the picture; channels below SG_MAX_CLASSES */
    const uint32_t *channel;         /* [symbols of the grammar], borrowed */
    size_t most;                     /* samples of a run: at most so many, and after the first doubling at least half */
    uint64_t unit, interval;         /* iterations between calls; between samples */
    sg_facade_sample *samples;       /* by iteration, then run */
    size_t nsamples, samples_capacity;
    sg_pixel_rect *rects;
    size_t nrects, rects_capacity;
    sg_label_scene scene;            /* work space */
} sg_facade_samples;

/** None yet. @param most  2 or more. @param unit  a sample is offered every so many iterations. Free with
 *  sg_facade_samples_clear() */
void sg_facade_samples_init(sg_facade_samples *s, size_t width, size_t height, const uint32_t *channel, size_t nchannels,
                            size_t most, uint64_t unit);
/** Free and zero; a zeroed one is fine. */
void sg_facade_samples_clear(sg_facade_samples *s);

/** For sg_metropolis_run(): keeps samples in s. */
sg_sampler sg_facade_samples_sampler(sg_facade_samples *s);
/** Offer the derivation of a run after an iteration: runs of one iteration in order, then the next iteration.
 *  @return SG_OK, SG_ENUMERIC (no label scene), SG_ENOMEM */
sg_status sg_facade_samples_add(sg_facade_samples *s, uint32_t run, uint64_t iteration, const sg_derivation *d,
                                sg_error *err);

/** Drop the samples outside of the iterations (first, last]. */
void sg_facade_samples_window(sg_facade_samples *s, uint64_t first, uint64_t last);

/** The channel of each pixel in a sample. @param map  of the picture's size */
void sg_facade_samples_raster(const sg_facade_samples *s, size_t sample, sg_label_map *map);

/** Share of the samples in which a pixel has a channel, [nchannels][height][width]: sums to 1 over the channels.
 *  @return SG_OK, SG_EINVAL (no sample), SG_ENOMEM; out is made here */
sg_status sg_facade_samples_marginals(const sg_facade_samples *s, sg_float_map *out, sg_error *err);

/** Entropy of the marginals of each pixel, nats. @param out  [height][width] */
void sg_marginals_entropy(const sg_float_map *marginals, float *out);

#endif
