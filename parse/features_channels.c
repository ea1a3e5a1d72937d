/* SPDX-License-Identifier: GPL-3.0-or-later */
/* features_channels.c - colours, gradients, filter responses, binary patterns and positions of a photograph.
 * The filter bank is that of Winn, Criminisi and Minka, "Object categorization by learned universal visual dictionary"
 * (2005); its derivatives are scaled by their width, so that all scales answer alike to one edge. */
#include "config.h"

#include "parse/features_channels_priv.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const names[SG_CHANNEL_ORIENTATION] = {
    "L",         "a",         "b",           "hue",         "saturation",  "value",       "gradient",    "|dL/dx|",
    "|dL/dy|",   "L blur 1",  "a blur 1",    "b blur 1",    "L blur 2",    "a blur 2",    "b blur 2",    "L blur 4",
    "a blur 4",  "b blur 4",  "laplacian 1", "laplacian 2", "laplacian 4", "laplacian 8", "slope x 2",   "slope x 4",
    "slope y 2", "slope y 4", "x/W",         "y/H",         "px to side",  "px to top",   "px to bottom"};

const char *sg_channel_name(unsigned channel, char *text, size_t n)
{
    if (channel >= SG_CHANNEL_PATTERN)
        snprintf(text, n, "pattern %u", channel - SG_CHANNEL_PATTERN);
    else if (channel >= SG_CHANNEL_ORIENTATION)
        snprintf(text, n, "orientation %u", channel - SG_CHANNEL_ORIENTATION);
    else
        snprintf(text, n, "%s", names[channel]);
    return text;
}

static inline float *row_of(sg_plane p, size_t y)
{
    return p.at + y * p.stride;
}

/* ---- colour ---- */

static sg_status copy(sg_plane from, sg_plane to)
{
    for (size_t y = 0; y < to.height; y++)
        memcpy(row_of(to, y), row_of(from, y), to.width * sizeof *to.at);
    return SG_OK;
}

/* One of three is wanted; the others go where nothing is lost. */
static sg_status make_hsv(sg_channels *c, unsigned which, sg_plane to, sg_error *err)
{
    sg_plane planes[3] = {c->scratch, c->scratch, c->scratch};
    planes[which] = to;
    return sg_cv_hsv(c->photo, planes[0], planes[1], planes[2], err);
}

/* ---- gradients ---- */

static void measure_gradients(const sg_channels *c)
{
    for (size_t y = 0; y < c->dx.height; y++)
        for (size_t x = 0; x < c->dx.width; x++) {
            const float dx = row_of(c->dx, y)[x], dy = row_of(c->dy, y)[x];
            row_of(c->gradient, y)[x] = sqrtf(dx * dx + dy * dy);
            row_of(c->angle, y)[x] = atan2f(dy, dx) * (SG_ORIENTATIONS / (float)M_PI);
        }
}

static sg_status make_slant(sg_plane from, sg_plane to)
{
    for (size_t y = 0; y < to.height; y++)
        for (size_t x = 0; x < to.width; x++)
            row_of(to, y)[x] = fabsf(row_of(from, y)[x]);
    return SG_OK;
}

/* A gradient is shared between the two orientations that it lies between; an angle lies within one turn, so the nearest
 * of `which` modulo half a turn is at most one half turn off. */
static sg_status make_orientation(const sg_channels *c, unsigned which, sg_plane to)
{
    for (size_t y = 0; y < to.height; y++)
        for (size_t x = 0; x < to.width; x++) {
            float off = fabsf(row_of(c->angle, y)[x] - (float)which);
            off = off > SG_ORIENTATIONS ? off - SG_ORIENTATIONS : off;
            off = off > SG_ORIENTATIONS / 2 ? SG_ORIENTATIONS - off : off;
            row_of(to, y)[x] = off < 1 ? row_of(c->gradient, y)[x] * (1 - off) : 0;
        }
    return SG_OK;
}

/* ---- filter bank ---- */

static sg_status make_blur(const sg_channels *c, unsigned which, sg_plane to, sg_error *err)
{
    return sg_cv_gaussian(c->lab[which % 3], to, (double)(1u << which / 3), err);
}

static void scale(sg_plane p, float factor)
{
    for (size_t y = 0; y < p.height; y++)
        for (size_t x = 0; x < p.width; x++)
            row_of(p, y)[x] *= factor;
}

static sg_status make_laplacian(const sg_channels *c, unsigned which, sg_plane to, sg_error *err)
{
    const double sigma = (double)(1u << which);
    SG_TRY(sg_cv_gaussian(c->lab[0], c->scratch, sigma, err));
    SG_TRY(sg_cv_laplacian(c->scratch, to, err));
    scale(to, (float)(sigma * sigma));
    return SG_OK;
}

static sg_status make_slope(const sg_channels *c, unsigned which, sg_plane to, sg_error *err)
{
    const double sigma = which % 2 == 0 ? 2 : 4;
    SG_TRY(sg_cv_gaussian(c->lab[0], c->scratch, sigma, err));
    SG_TRY(sg_cv_derivative(c->scratch, to, which < 2, which >= 2, err));
    scale(to, (float)sigma);
    return SG_OK;
}

/* ---- local binary patterns ---- */

/* Neighbours in their order round the pixel; a pattern is uniform when it changes at most twice on the way. */
unsigned sg_binary_pattern(sg_plane p, size_t x, size_t y)
{
    const size_t left = x > 0 ? x - 1 : 0, right = x + 1 < p.width ? x + 1 : x;
    const float *above = row_of(p, y > 0 ? y - 1 : 0), *here = row_of(p, y);
    const float *below = row_of(p, y + 1 < p.height ? y + 1 : y);
    const float middle = here[x];
    const float ring[8] = {above[left],  above[x], above[right], here[right],
                           below[right], below[x], below[left],  here[left]};
    unsigned set = 0, changes = 0;
    for (unsigned i = 0; i < 8; i++) {
        set += ring[i] >= middle;
        changes += (ring[i] >= middle) != (ring[(i + 1) % 8] >= middle);
    }
    return changes <= 2 ? set : 9;
}

static void find_patterns(const sg_channels *c)
{
    for (size_t y = 0; y < c->pattern.height; y++)
        for (size_t x = 0; x < c->pattern.width; x++)
            row_of(c->pattern, y)[x] = (float)sg_binary_pattern(c->lab[0], x, y);
}

static sg_status make_pattern(const sg_channels *c, unsigned which, sg_plane to)
{
    for (size_t y = 0; y < to.height; y++)
        for (size_t x = 0; x < to.width; x++)
            row_of(to, y)[x] = row_of(c->pattern, y)[x] == (float)which ? 1 : 0;
    return SG_OK;
}

/* ---- position ---- */

static float position(unsigned channel, size_t x, size_t y, size_t width, size_t height)
{
    switch (channel) {
    case SG_CHANNEL_X:
        return ((float)x + 0.5f) / (float)width;
    case SG_CHANNEL_Y:
        return ((float)y + 0.5f) / (float)height;
    case SG_CHANNEL_SIDE_PX:
        return (float)(x < width - 1 - x ? x : width - 1 - x);
    case SG_CHANNEL_TOP_PX:
        return (float)y;
    default:
        return (float)(height - 1 - y);
    }
}

static sg_status make_position(unsigned channel, sg_plane to)
{
    for (size_t y = 0; y < to.height; y++)
        for (size_t x = 0; x < to.width; x++)
            row_of(to, y)[x] = position(channel, x, y, to.width, to.height);
    return SG_OK;
}

/* ---- all of them ---- */

sg_status sg_channels_make(sg_channels *c, unsigned channel, sg_plane to, sg_error *err)
{
    if (channel < SG_CHANNEL_HUE)
        return copy(c->lab[channel - SG_CHANNEL_L], to);
    if (channel < SG_CHANNEL_GRADIENT)
        return make_hsv(c, channel - SG_CHANNEL_HUE, to, err);
    if (channel == SG_CHANNEL_GRADIENT)
        return copy(c->gradient, to);
    if (channel < SG_CHANNEL_BLUR_L1)
        return make_slant(channel == SG_CHANNEL_GRADIENT_X ? c->dx : c->dy, to);
    if (channel < SG_CHANNEL_LAPLACIAN1)
        return make_blur(c, channel - SG_CHANNEL_BLUR_L1, to, err);
    if (channel < SG_CHANNEL_SLOPE_X2)
        return make_laplacian(c, channel - SG_CHANNEL_LAPLACIAN1, to, err);
    if (channel < SG_CHANNEL_X)
        return make_slope(c, channel - SG_CHANNEL_SLOPE_X2, to, err);
    if (channel < SG_CHANNEL_ORIENTATION)
        return make_position(channel, to);
    if (channel < SG_CHANNEL_PATTERN)
        return make_orientation(c, channel - SG_CHANNEL_ORIENTATION, to);
    return make_pattern(c, channel - SG_CHANNEL_PATTERN, to);
}

sg_status sg_channels_create(const sg_image *photo, sg_channels *out, sg_error *err)
{
    const size_t n = photo->width * photo->height;
    sg_plane *const planes[] = {&out->lab[0],  &out->lab[1],   &out->lab[2], &out->dx,     &out->dy,
                                &out->scratch, &out->gradient, &out->angle,  &out->pattern};
    enum { NPLANES = sizeof planes / sizeof planes[0] };
    *out = (sg_channels){.photo = photo, .data = malloc(NPLANES * n * sizeof(float))};
    if (out->data == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t i = 0; i < NPLANES; i++)
        *planes[i] = (sg_plane){out->data + i * n, photo->width, photo->height, photo->width};
    SG_TRY(sg_cv_lab(photo, out->lab[0], out->lab[1], out->lab[2], err));
    SG_TRY(sg_cv_derivative(out->lab[0], out->dx, 1, 0, err));
    SG_TRY(sg_cv_derivative(out->lab[0], out->dy, 0, 1, err));
    measure_gradients(out);
    find_patterns(out);
    return SG_OK;
}

void sg_channels_clear(sg_channels *c)
{
    free(c->data);
    *c = (sg_channels){0};
}
