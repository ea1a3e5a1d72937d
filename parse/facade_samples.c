/* SPDX-License-Identifier: GPL-3.0-or-later */
/* facade_samples.c - rectangles of all samples lie one behind the other; marginals are sums of their corners. */
#include "config.h"

#include "parse/facade_samples.h"

#include "core/array.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void sg_facade_samples_init(sg_facade_samples *s, size_t width, size_t height, const uint32_t *channel, size_t nchannels,
                            size_t most, uint64_t unit)
{
    *s = (sg_facade_samples){.width = width, .height = height, .nchannels = nchannels, .channel = channel};
    s->most = most;
    s->unit = s->interval = unit;
}

void sg_facade_samples_clear(sg_facade_samples *s)
{
    free(s->samples);
    free(s->rects);
    sg_label_scene_clear(&s->scene);
    *s = (sg_facade_samples){0};
}

/* ---- keeping ---- */

/* Keep the samples for which `keep` holds; rectangles move together. */
static void filter(sg_facade_samples *s, bool (*keep)(const sg_facade_sample *sample, uint64_t a, uint64_t b), uint64_t a,
                   uint64_t b)
{
    size_t n = 0, nrects = 0;
    for (size_t i = 0; i < s->nsamples; i++) {
        sg_facade_sample sample = s->samples[i];
        if (!keep(&sample, a, b))
            continue;
        memmove(s->rects + nrects, s->rects + sample.first, sample.nrects * sizeof *s->rects);
        sample.first = nrects;
        nrects += sample.nrects;
        s->samples[n++] = sample;
    }
    s->nsamples = n;
    s->nrects = nrects;
}

static bool is_multiple(const sg_facade_sample *sample, uint64_t interval, uint64_t unused)
{
    (void)unused;
    return sample->iteration % interval == 0;
}

static bool is_within(const sg_facade_sample *sample, uint64_t first, uint64_t last)
{
    return sample->iteration > first && sample->iteration <= last;
}

static size_t count_run(const sg_facade_samples *s, uint32_t run)
{
    size_t n = 0;
    for (size_t i = 0; i < s->nsamples; i++)
        n += s->samples[i].run == run;
    return n;
}

/* Label rectangles of the scene as pixels; what covers no pixel centre is left out. */
static sg_status add_rects(sg_facade_samples *s, sg_error *err)
{
    const sg_label_scene *scene = &s->scene;
    if (!SG_GROW(s->rects, s->rects_capacity, s->nrects + scene->nrects))
        return SG_FAIL_NOMEM(err);
    for (size_t i = 0; i < scene->nrects; i++) {
        const sg_label_rect *r = &scene->rects[i];
        const size_t x0 = sg_label_scene_pixel(r->x0, scene->width, s->width);
        const size_t x1 = sg_label_scene_pixel(r->x1, scene->width, s->width);
        const size_t y0 = sg_label_scene_pixel(r->y0, scene->height, s->height);
        const size_t y1 = sg_label_scene_pixel(r->y1, scene->height, s->height);
        if (x0 < x1 && y0 < y1)
            s->rects[s->nrects++] = (sg_pixel_rect){(uint16_t)x0, (uint16_t)y0, (uint16_t)x1, (uint16_t)y1,
                                                    (uint8_t)s->channel[r->label]};
    }
    return SG_OK;
}

sg_status sg_facade_samples_add(sg_facade_samples *s, uint32_t run, uint64_t iteration, const sg_derivation *d,
                                sg_error *err)
{
    if (iteration % s->interval == 0 && run == 0 && count_run(s, 0) >= s->most) {
        s->interval *= 2;
        filter(s, is_multiple, s->interval, 0);
    }
    if (iteration % s->interval != 0)
        return SG_OK;
    const size_t first = s->nrects;
    SG_TRY(sg_label_scene_interpret(&s->scene, d, (double)s->width, (double)s->height, err));
    if (!SG_GROW(s->samples, s->samples_capacity, s->nsamples + 1))
        return SG_FAIL_NOMEM(err);
    SG_TRY(add_rects(s, err));
    s->samples[s->nsamples++] = (sg_facade_sample){run, iteration, first, s->nrects - first};
    return SG_OK;
}

static sg_status take_sample(void *user, size_t run, uint64_t iteration, const sg_derivation *cold,
                             const sg_posterior *p, sg_error *err)
{
    (void)p;
    return sg_facade_samples_add(user, (uint32_t)run, iteration, cold, err);
}

sg_sampler sg_facade_samples_sampler(sg_facade_samples *s)
{
    return (sg_sampler){(size_t)s->unit, take_sample, s};
}

void sg_facade_samples_window(sg_facade_samples *s, uint64_t first, uint64_t last)
{
    filter(s, is_within, first, last);
}

/* ---- what is made of them ---- */

void sg_facade_samples_raster(const sg_facade_samples *s, size_t sample, sg_label_map *map)
{
    const sg_pixel_rect *r = s->rects + s->samples[sample].first, *end = r + s->samples[sample].nrects;
    for (; r < end; r++)
        for (size_t y = r->y0; y < r->y1; y++)
            memset(map->labels + y * map->width + r->x0, r->channel, (size_t)(r->x1 - r->x0));
}

/* A rectangle as four corners: sums to the right and then downwards make it 1 inside and 0 outside. */
static void add_corners(sg_float_map *m, const sg_pixel_rect *r)
{
    float *plane = m->values + r->channel * m->height * m->width;
    plane[r->y0 * m->width + r->x0] += 1;
    if (r->x1 < m->width)
        plane[r->y0 * m->width + r->x1] -= 1;
    if (r->y1 < m->height)
        plane[r->y1 * m->width + r->x0] -= 1;
    if (r->x1 < m->width && r->y1 < m->height)
        plane[r->y1 * m->width + r->x1] += 1;
}

/* Counts are whole numbers far below 2^24, so floats hold them exactly. */
static void sum_corners(sg_float_map *m)
{
    for (size_t c = 0; c < m->channels; c++) {
        float *plane = m->values + c * m->height * m->width;
        for (size_t i = 0; i < m->height * m->width; i++)
            plane[i] += i % m->width > 0 ? plane[i - 1] : 0;
        for (size_t i = m->width; i < m->height * m->width; i++)
            plane[i] += plane[i - m->width];
    }
}

sg_status sg_facade_samples_marginals(const sg_facade_samples *s, sg_float_map *out, sg_error *err)
{
    if (s->nsamples == 0)
        return SG_FAIL(err, SG_EINVAL, "no samples to take marginals of");
    SG_TRY(sg_float_map_create(s->nchannels, s->height, s->width, out, err));
    for (size_t i = 0; i < s->nrects; i++)
        add_corners(out, &s->rects[i]);
    sum_corners(out);
    for (size_t i = 0; i < out->channels * out->height * out->width; i++)
        out->values[i] /= (float)s->nsamples;
    return SG_OK;
}

void sg_marginals_entropy(const sg_float_map *marginals, float *out)
{
    const size_t n = marginals->height * marginals->width;
    memset(out, 0, n * sizeof *out);
    for (size_t c = 0; c < marginals->channels; c++)
        for (size_t i = 0; i < n; i++) {
            const float p = marginals->values[c * n + i];
            out[i] -= p > 0 ? p * logf(p) : 0;
        }
    for (size_t i = 0; i < n; i++)
        out[i] = out[i] > 0 ? out[i] : 0;
}
