/* SPDX-License-Identifier: GPL-3.0-or-later */
/* features.h - per-pixel features of photographs for the pixel classifier.
 *
 * Every feature is a look-up in a plane at an offset: planes (colour, gradients, filter responses, box means, position,
 * ...) are computed once a photograph, padded by replication so that no look-up needs a bound, and lie in one block of one
 * stride. So a feature is one offset into the block, a tree touches only the features it asks for, and nothing is
 * gathered for prediction.
 *
 * Two sets. patch: the RGB values of a square patch round the pixel (Teboul, Simon, Koutsourakis and Paragios, "Segmentation
 * of building facades using procedural shape priors", 2010). rich: see features_rich.c. */
#ifndef SG_PARSE_FEATURES_H
#define SG_PARSE_FEATURES_H

#include "core/status.h"
#include "image/image.h"

#include <stddef.h>
#include <stdint.h>

typedef enum { SG_FEATURES_PATCH, SG_FEATURES_RICH } sg_feature_kind;

/** Which features: written into model files, so that a model says what it was trained on. */
typedef struct {
    sg_feature_kind kind;
    uint32_t patch;   /* PATCH: side, odd, 1..63 px */
    uint32_t version; /* of the definition of the set; a model of another version is refused */
} sg_feature_set;

/** The set of this kind in this version. */
sg_feature_set sg_feature_set_of(sg_feature_kind kind, uint32_t patch);
/** How many features; 0 when the set makes no sense (a kind, side or version that this program does not know). */
size_t sg_feature_set_count(const sg_feature_set *set);
/** What feature f is, for reports ("lab.b mean 9x9 at +32,0"): at most n bytes, ended by 0. */
void sg_feature_set_describe(const sg_feature_set *set, size_t f, char *text, size_t n);

/** The planes of one photograph. */
typedef struct {
    size_t width, height; /* of the photograph */
    size_t stride;        /* floats from one row to the next */
    float *data;          /* the block */
    size_t nfeatures;
    ptrdiff_t *offsets;   /* [nfeatures] into the block, for pixel (0,0) */
} sg_features;

/** @return SG_OK, SG_EINVAL (an unknown set), SG_EINPUT (so many pixels that the planes pass 8 GiB: said with the size that would
 *          do), SG_ENOMEM; free with sg_features_clear() */
sg_status sg_features_create(const sg_feature_set *set, const sg_image *photo, sg_features *out, sg_error *err);
/** Free and zero; a zeroed one is fine. */
void sg_features_clear(sg_features *f);

/** Feature at pixel (x, y): finite. No bounds are checked. */
static inline float sg_features_value(const sg_features *f, size_t feature, size_t x, size_t y)
{
    return f->data[f->offsets[feature] + (ptrdiff_t)(y * f->stride + x)];
}

#endif
