/* SPDX-License-Identifier: GPL-3.0-or-later */
/* features_channels.c - colours, gradients, filter responses, binary patterns and positions of a photograph.
 * The filter bank is that of Winn, Criminisi and Minka, "Object categorization by learned universal visual dictionary"
 * (2005); its derivatives are scaled by their width, so that all scales answer alike to one edge. */
#include "config.h"

#include "parse/features_channels_priv.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const char *const names[SG_CHANNEL_ORIENTATION] = {
    "L",         "a",         "b",           "hue",         "saturation",  "value",       "gradient",    "|dL/dx|",
    "|dL/dy|",   "L blur 1",  "L blur 2",    "L blur 4",    "a blur 1",    "a blur 2",    "a blur 4",    "b blur 1",
    "b blur 2",  "b blur 4",  "laplacian 1", "laplacian 2", "laplacian 4", "laplacian 8", "slope x 2",   "slope x 4",
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

static sg_status make_lab(const sg_channels *c, unsigned which, sg_plane to)
{
    for (size_t y = 0; y < to.height; y++)
        for (size_t x = 0; x < to.width; x++)
            row_of(to, y)[x] = row_of(c->lab[which], y)[x];
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

static sg_status make_gradient(const sg_channels *c, unsigned channel, sg_plane to)
{
    for (size_t y = 0; y < to.height; y++)
        for (size_t x = 0; x < to.width; x++) {
            const float dx = row_of(c->dx, y)[x], dy = row_of(c->dy, y)[x];
            row_of(to, y)[x] = channel == SG_CHANNEL_GRADIENT     ? sqrtf(dx * dx + dy * dy)
                               : channel == SG_CHANNEL_GRADIENT_X ? fabsf(dx)
                                                                  : fabsf(dy);
        }
    return SG_OK;
}

/* A gradient is shared between the two directions it lies between. */
static sg_status make_orientation(const sg_channels *c, unsigned which, sg_plane to)
{
    for (size_t y = 0; y < to.height; y++)
        for (size_t x = 0; x < to.width; x++) {
            const float dx = row_of(c->dx, y)[x], dy = row_of(c->dy, y)[x];
            float angle = atan2f(dy, dx) * (SG_ORIENTATIONS / (float)M_PI) - (float)which; /* in bins */
            angle -= SG_ORIENTATIONS * roundf(angle / SG_ORIENTATIONS);
            row_of(to, y)[x] = sqrtf(dx * dx + dy * dy) * fmaxf(0, 1 - fabsf(angle));
        }
    return SG_OK;
}

/* ---- filter bank ---- */

static sg_status make_blur(const sg_channels *c, unsigned which, sg_plane to, sg_error *err)
{
    return sg_cv_gaussian(c->lab[which / 3], to, (double)(1u << which % 3), err);
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

/* Neighbours in their order round the pixel, bit by bit; a pattern is uniform when it changes at most twice on the way.
 */
static unsigned kind_of(unsigned bits)
{
    const unsigned changes = bits ^ ((bits >> 1) | (bits & 1) << 7);
    return __builtin_popcount(changes) <= 2 ? (unsigned)__builtin_popcount(bits) : 9;
}

unsigned sg_binary_pattern(sg_plane p, size_t x, size_t y)
{
    const size_t left = x > 0 ? x - 1 : 0, right = x + 1 < p.width ? x + 1 : x;
    const float *above = row_of(p, y > 0 ? y - 1 : 0), *here = row_of(p, y);
    const float *below = row_of(p, y + 1 < p.height ? y + 1 : y);
    const float middle = here[x];
    const float ring[8] = {above[left],  above[x], above[right], here[right],
                           below[right], below[x], below[left],  here[left]};
    unsigned bits = 0;
    for (unsigned i = 0; i < 8; i++)
        bits |= (unsigned)(ring[i] >= middle) << i;
    return kind_of(bits);
}

static sg_status make_pattern(const sg_channels *c, unsigned which, sg_plane to)
{
    for (size_t y = 0; y < to.height; y++)
        for (size_t x = 0; x < to.width; x++)
            row_of(to, y)[x] = sg_binary_pattern(c->lab[0], x, y) == which ? 1 : 0;
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
        return make_lab(c, channel - SG_CHANNEL_L, to);
    if (channel < SG_CHANNEL_GRADIENT)
        return make_hsv(c, channel - SG_CHANNEL_HUE, to, err);
    if (channel < SG_CHANNEL_BLUR_L1)
        return make_gradient(c, channel, to);
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
    *out = (sg_channels){.photo = photo, .data = malloc(6 * n * sizeof(float))};
    if (out->data == NULL)
        return SG_FAIL_NOMEM(err);
    sg_plane *const planes[6] = {&out->lab[0], &out->lab[1], &out->lab[2], &out->dx, &out->dy, &out->scratch};
    for (size_t i = 0; i < 6; i++)
        *planes[i] = (sg_plane){out->data + i * n, photo->width, photo->height, photo->width};
    SG_TRY(sg_cv_lab(photo, out->lab[0], out->lab[1], out->lab[2], err));
    SG_TRY(sg_cv_derivative(out->lab[0], out->dx, 1, 0, err));
    return sg_cv_derivative(out->lab[0], out->dy, 0, 1, err);
}

void sg_channels_clear(sg_channels *c)
{
    free(c->data);
    *c = (sg_channels){0};
}
