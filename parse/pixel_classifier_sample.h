/* SPDX-License-Identifier: GPL-3.0-or-later */
/* pixel_classifier_sample.h - the pixels of a data set: how many of each class there are, and samples of them. Ignored pixels
 * take no part. */
#ifndef SG_PARSE_PIXEL_CLASSIFIER_SAMPLE_H
#define SG_PARSE_PIXEL_CLASSIFIER_SAMPLE_H

#include "core/arena.h"
#include "core/progress.h"
#include "parse/dataset.h"
#include "parse/features.h"
#include "parse/forest_grow.h"

#include <stdbool.h>

/** Pixels of each class in each label map. */
typedef struct {
    size_t nitems, nclasses, npixels;
    uint64_t *of_item;  /* [nitems][nclasses] */
    uint64_t *of_class; /* [nclasses] */
} sg_pixel_census;

/** @return SG_OK, SG_EINPUT, SG_ENOMEM; it lives in the arena */
sg_status sg_pixel_census_take(const sg_dataset *d, sg_arena *arena, sg_pixel_census *out, sg_error *err);

/** How many pixels of each class a sample of n has. By frequency, but at least n / (20 nclasses) of each class that there is,
 *  as far as it goes; or the same number of each.
 *  @param quotas  out [nclasses], at most of_class */
void sg_pixel_quotas(const sg_pixel_census *c, size_t n, bool balanced, uint64_t *quotas);

typedef struct {
    sg_feature_set features;
    uint64_t seed;
    int threads;
    sg_progress *progress; /* or NULL */
} sg_pixel_sample_opts;

/** Draw quotas[c] pixels of each class c, without replacement: each photograph gives its share, and within it each pixel of a
 *  class is as likely. Samples stand in the order of photographs and of rows. x and classes are malloc'd here.
 *  @return SG_OK, SG_EINPUT, SG_ENOMEM, SG_STOPPED (nothing is made) */
sg_status sg_pixel_sample_draw(const sg_dataset *d, const sg_pixel_census *c, const uint64_t *quotas,
                               const sg_pixel_sample_opts *opts, sg_sample_matrix *out, sg_error *err);

/** A photograph with its features and classes; sg_pixel_photo_clear(). */
typedef struct {
    sg_features features;
    sg_label_map labels;
} sg_pixel_photo;

sg_status sg_pixel_photo_open(const sg_dataset *d, size_t item, const sg_feature_set *set, sg_pixel_photo *out,
                              sg_error *err);
void sg_pixel_photo_clear(sg_pixel_photo *p);
/** Pixels that are not ignored, of every `step`-th row and column, as sg_forest_find() takes them. Both arrays are given, with
 *  room for all of them. @return their number */
size_t sg_pixel_photo_list(const sg_pixel_photo *p, size_t step, ptrdiff_t *pixels, uint8_t *classes);

/** Do work(user, item, photograph) for all photographs of a data set, in any order and on some threads. The failure that is
 *  returned is that of the first one, in order.
 *  @return SG_OK, SG_STOPPED, or what opening or working returns */
sg_status sg_pixel_photos_each(const sg_dataset *d, const sg_pixel_sample_opts *opts, const char *step,
                               sg_status (*work)(void *user, size_t item, const sg_pixel_photo *p, sg_error *err),
                               void *user, sg_error *err);

#endif
