/* SPDX-License-Identifier: GPL-3.0-or-later */
/* features_priv.h - what a set of features is made of: planes, and look-ups in them. */
#ifndef SG_PARSE_FEATURES_PRIV_H
#define SG_PARSE_FEATURES_PRIV_H

#include "parse/features.h"

/** Planes of one photograph, each padded alike on all sides, one after the other. */
typedef struct {
    size_t width, height; /* of the photograph */
    size_t pad;           /* px on each side */
    size_t stride, rows;  /* of a padded plane */
    size_t nplanes;
    float *data; /* [nplanes][rows][stride] */
} sg_planes;

/** A feature: pixel (x + dx, y + dy) of a plane. */
typedef struct {
    size_t plane;
    int dx, dy; /* px, at most the padding */
} sg_feature_place;

/** One kind of set. */
typedef struct {
    uint32_t version;
    size_t (*count)(const sg_feature_set *set); /* 0: no such set */
    size_t (*planes)(const sg_feature_set *set);
    size_t (*pad)(const sg_feature_set *set);
    sg_feature_place (*place)(const sg_feature_set *set, size_t f);
    void (*plane_name)(const sg_feature_set *set, size_t plane, char *text, size_t n);
    /* All planes within the photograph: the padding is filled afterwards. */
    sg_status (*fill)(const sg_feature_set *set, const sg_image *photo, sg_planes *out, sg_error *err);
} sg_feature_definition;

extern const sg_feature_definition sg_features_patch, sg_features_rich;

/** Where pixel (0,0) of a plane lies. */
static inline float *sg_planes_at(const sg_planes *p, size_t plane)
{
    return p->data + plane * p->rows * p->stride + p->pad * p->stride + p->pad;
}

/** Planes `first` to `first` + 2 become R, G and B, 0 to 255. */
void sg_planes_fill_rgb(sg_planes *p, size_t first, const sg_image *photo);

#endif
