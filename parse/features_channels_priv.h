/* SPDX-License-Identifier: GPL-3.0-or-later */
/* features_channels_priv.h - channels: what is measured in every pixel of a photograph before it is summed up over
 * boxes, rows and columns. */
#ifndef SG_PARSE_FEATURES_CHANNELS_PRIV_H
#define SG_PARSE_FEATURES_CHANNELS_PRIV_H

#include "parse/cv_features.h"

#define SG_ORIENTATIONS 8
#define SG_PATTERNS     10

typedef enum {
    SG_CHANNEL_L, /* CIE Lab */
    SG_CHANNEL_A,
    SG_CHANNEL_B,
    SG_CHANNEL_HUE,
    SG_CHANNEL_SATURATION,
    SG_CHANNEL_VALUE,
    SG_CHANNEL_GRADIENT, /* of L: magnitude, |dL/dx|, |dL/dy| */
    SG_CHANNEL_GRADIENT_X,
    SG_CHANNEL_GRADIENT_Y,
    SG_CHANNEL_BLUR_L1, /* the filter bank of Winn et al.: Gaussians of L, a and b of 1, 2 and 4 px, */
    SG_CHANNEL_BLUR_A1,
    SG_CHANNEL_BLUR_B1,
    SG_CHANNEL_BLUR_L2,
    SG_CHANNEL_BLUR_A2,
    SG_CHANNEL_BLUR_B2,
    SG_CHANNEL_BLUR_L4,
    SG_CHANNEL_BLUR_A4,
    SG_CHANNEL_BLUR_B4,
    SG_CHANNEL_LAPLACIAN1, /* Laplacians of Gaussians of L of 1, 2, 4 and 8 px, */
    SG_CHANNEL_LAPLACIAN2,
    SG_CHANNEL_LAPLACIAN4,
    SG_CHANNEL_LAPLACIAN8,
    SG_CHANNEL_SLOPE_X2, /* and derivatives of Gaussians of L of 2 and 4 px */
    SG_CHANNEL_SLOPE_X4,
    SG_CHANNEL_SLOPE_Y2,
    SG_CHANNEL_SLOPE_Y4,
    SG_CHANNEL_X, /* 0 to 1 */
    SG_CHANNEL_Y,
    SG_CHANNEL_SIDE_PX, /* to the nearer side, px */
    SG_CHANNEL_TOP_PX,
    SG_CHANNEL_BOTTOM_PX,
    SG_CHANNEL_ORIENTATION, /* and SG_ORIENTATIONS - 1 more: gradients of one direction modulo 180 degrees */
    SG_CHANNEL_PATTERN =
        SG_CHANNEL_ORIENTATION + SG_ORIENTATIONS, /* and more: 1 where the local binary pattern is such */
    SG_NCHANNELS = SG_CHANNEL_PATTERN + SG_PATTERNS
} sg_channel;

/** Of one photograph: what most channels are made from. */
typedef struct {
    const sg_image *photo;
    sg_plane lab[3], dx, dy, scratch;
    sg_plane gradient, angle; /* of L; angles in orientations, clockwise from the right */
    sg_plane pattern;         /* sg_binary_pattern() */
    float *data;
} sg_channels;

/** @return SG_OK, SG_ENOMEM, SG_ENUMERIC; sg_channels_clear() it either way */
sg_status sg_channels_create(const sg_image *photo, sg_channels *out, sg_error *err);
void sg_channels_clear(sg_channels *c);
/** Make one channel. `to` has the photograph's size. */
sg_status sg_channels_make(sg_channels *c, unsigned channel, sg_plane to, sg_error *err);
const char *sg_channel_name(unsigned channel, char *text, size_t n);

/** Kind of the local binary pattern of pixel (x, y), 0 to 9: how many of the 8 neighbours are brighter than or as
 * bright as it if those lie side by side, 9 if not (rotation-invariant uniform patterns of Ojala, Pietikainen and
 * Maenpaa, 2002; neighbours are taken on the grid and not on the circle). Borders are repeated. */
unsigned sg_binary_pattern(sg_plane lightness, size_t x, size_t y);

#endif
