/* SPDX-License-Identifier: GPL-3.0-or-later */
/* features_patch.c - the RGB values of a square patch round the pixel, channel by channel, row by row. */
#include "config.h"

#include "parse/features_priv.h"

#include <stdio.h>

#define MAX_SIDE 63 /* px */

static size_t count(const sg_feature_set *set)
{
    return set->patch % 2 == 1 && set->patch <= MAX_SIDE ? (size_t)3 * set->patch * set->patch : 0;
}

static size_t planes(const sg_feature_set *set)
{
    (void)set;
    return 3;
}

static size_t pad(const sg_feature_set *set)
{
    return set->patch / 2;
}

static sg_feature_place place(const sg_feature_set *set, size_t f)
{
    const size_t side = set->patch, at = f % (side * side);
    const int half = (int)(side / 2);
    return (sg_feature_place){f / (side * side), (int)(at % side) - half, (int)(at / side) - half};
}

static void plane_name(const sg_feature_set *set, size_t plane, char *text, size_t n)
{
    (void)set;
    snprintf(text, n, "%c", "RGB"[plane]);
}

static sg_status fill(const sg_feature_set *set, const sg_image *photo, sg_planes *out, sg_error *err)
{
    (void)set;
    (void)err;
    sg_planes_fill_rgb(out, 0, photo);
    return SG_OK;
}

const sg_feature_definition sg_features_patch = {
    .version = 1,
    .count = count,
    .planes = planes,
    .pad = pad,
    .place = place,
    .plane_name = plane_name,
    .fill = fill,
};
