/* SPDX-License-Identifier: GPL-3.0-or-later */
/* pixel_classifier.c - photographs to class probabilities. */
#include "config.h"

#include "parse/pixel_classifier_priv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LEAST_PROBABILITY 1e-30f /* of a class after calibration */

const sg_classes *sg_pixel_classifier_classes(const sg_pixel_classifier *c)
{
    return &c->classes;
}

sg_feature_set sg_pixel_classifier_features(const sg_pixel_classifier *c)
{
    return c->features;
}

sg_calibration sg_pixel_classifier_calibration(const sg_pixel_classifier *c)
{
    return c->calibration;
}

sg_pixel_classifier_sizes sg_pixel_classifier_sizes_of(const sg_pixel_classifier *c)
{
    const sg_forest *f = &c->forest;
    return (sg_pixel_classifier_sizes){f->nfeatures, f->ntrees, f->nnodes, f->nleaves};
}

void sg_pixel_classifier_free(sg_pixel_classifier *c)
{
    if (c == NULL)
        return;
    sg_classes_clear(&c->classes);
    sg_forest_clear(&c->forest);
    free(c);
}

sg_status sg_pixel_classifier_check(const sg_pixel_classifier *c, sg_error *err)
{
    const size_t nfeatures = sg_feature_set_count(&c->features);
    double sum = 0;
    if (nfeatures == 0)
        return SG_FAIL(err, SG_EINPUT, "features of kind %d, patch %u and version %u are not known here: train it again",
                       (int)c->features.kind, (unsigned)c->features.patch, (unsigned)c->features.version);
    if (nfeatures != c->forest.nfeatures || c->classes.nclasses != c->forest.nclasses)
        return SG_FAIL(err, SG_EINPUT, "a forest over %zu features and %zu classes, but there are %zu and %zu",
                       c->forest.nfeatures, c->forest.nclasses, nfeatures, c->classes.nclasses);
    if (!(c->calibration.temperature > 0) || !isfinite(c->calibration.temperature) || !isfinite(c->calibration.exponent))
        return SG_FAIL(err, SG_EINPUT, "a calibration that makes no sense");
    for (size_t k = 0; k < c->classes.nclasses; k++) {
        if (!(c->frequency[k] >= 0 && c->frequency[k] <= 1))
            return SG_FAIL(err, SG_EINPUT, "a class frequency of %g", c->frequency[k]);
        sum += c->frequency[k];
    }
    if (fabs(sum - 1) > 1e-6)
        return SG_FAIL(err, SG_EINPUT, "class frequencies sum to %g", sum);
    return sg_forest_check(&c->forest, err);
}

void sg_pixel_calibration_shift(const sg_calibration *c, const double *frequency, size_t nclasses, float *shift)
{
    for (size_t k = 0; k < nclasses; k++)
        shift[k] = frequency[k] > 0 ? (float)(c->exponent * log(frequency[k])) : 0;
}

void sg_pixel_calibrate(const sg_calibration *c, const float *shift, size_t nclasses, float *p)
{
    const float scale = (float)(1 / c->temperature);
    float most = -INFINITY, sum = 0;
    for (size_t k = 0; k < nclasses; k++) {
        p[k] = logf(p[k]) - shift[k];
        most = p[k] > most ? p[k] : most;
    }
    for (size_t k = 0; k < nclasses; k++) {
        p[k] = fmaxf(expf((p[k] - most) * scale), LEAST_PROBABILITY);
        sum += p[k];
    }
    for (size_t k = 0; k < nclasses; k++)
        p[k] /= sum;
}

static void calibrate_map(const sg_pixel_classifier *c, int threads, sg_float_map *map)
{
    const size_t n = map->channels, plane = map->width * map->height;
    float shift[SG_MAX_CLASSES];
    sg_pixel_calibration_shift(&c->calibration, c->frequency, n, shift);
#pragma omp parallel for schedule(static) num_threads(threads)
    for (size_t i = 0; i < plane; i++) {
        float p[SG_MAX_CLASSES];
        for (size_t k = 0; k < n; k++)
            p[k] = map->values[k * plane + i];
        sg_pixel_calibrate(&c->calibration, shift, n, p);
        for (size_t k = 0; k < n; k++)
            map->values[k * plane + i] = p[k];
    }
}

sg_status sg_pixel_classifier_apply(const sg_pixel_classifier *c, const sg_image *photo, int threads, sg_float_map *out,
                                    sg_error *err)
{
    sg_features features;
    SG_TRY(sg_features_create(&c->features, photo, &features, err));
    const sg_status st = sg_forest_apply(&c->forest, &features, threads, out, err);
    sg_features_clear(&features);
    if (st == SG_OK && (c->calibration.temperature != 1 || c->calibration.exponent != 0))
        calibrate_map(c, threads, out);
    return st;
}
