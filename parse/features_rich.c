/* SPDX-License-Identifier: GPL-3.0-or-later */
/* features_rich.c - colour and position for now. */
#include "config.h"

#include "parse/features_priv.h"

#include <stdio.h>

enum { PLANE_R, PLANE_G, PLANE_B, PLANE_X, PLANE_Y, NPLANES };

static const char *const names[NPLANES] = {"R", "G", "B", "x/W", "y/H"};

static size_t count(const sg_feature_set *set)
{
    (void)set;
    return NPLANES;
}

static size_t planes(const sg_feature_set *set)
{
    (void)set;
    return NPLANES;
}

static size_t pad(const sg_feature_set *set)
{
    (void)set;
    return 0;
}

static sg_feature_place place(const sg_feature_set *set, size_t f)
{
    (void)set;
    return (sg_feature_place){f, 0, 0};
}

static void plane_name(const sg_feature_set *set, size_t plane, char *text, size_t n)
{
    (void)set;
    snprintf(text, n, "%s", names[plane]);
}

static void fill_position(sg_planes *p)
{
    float *const px = sg_planes_at(p, PLANE_X), *const py = sg_planes_at(p, PLANE_Y);
    for (size_t y = 0; y < p->height; y++)
        for (size_t x = 0; x < p->width; x++) {
            px[y * p->stride + x] = ((float)x + 0.5f) / (float)p->width;
            py[y * p->stride + x] = ((float)y + 0.5f) / (float)p->height;
        }
}

static sg_status fill(const sg_feature_set *set, const sg_image *photo, sg_planes *out, sg_error *err)
{
    (void)set;
    (void)err;
    sg_planes_fill_rgb(out, PLANE_R, photo);
    fill_position(out);
    return SG_OK;
}

const sg_feature_definition sg_features_rich = {
    .version = 1,
    .count = count,
    .planes = planes,
    .pad = pad,
    .place = place,
    .plane_name = plane_name,
    .fill = fill,
};
