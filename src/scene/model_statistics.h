/* SPDX-License-Identifier: GPL-3.0-or-later */
/* model_statistics.h - how large models are: derivation, primitives, mesh; of one and over many, as tables. */
#ifndef SG_SCENE_MODEL_STATISTICS_H
#define SG_SCENE_MODEL_STATISTICS_H

#include "derivation/derivation_statistics.h"
#include "scene/mesh.h"

#include <stdio.h>

typedef struct {
    sg_derivation_statistics derivation;
    size_t primitives, vertices, faces; /* of the scene, and of its mesh */
    double log_prior, log_density;      /* sg_derivation_log_prior(), sg_derivation_log_density() */
} sg_model_statistics;

/** Count a derivation, its scene and its mesh.
 *  @param scene, mesh  work space; they hold the model afterwards
 *  @return SG_OK, SG_EINVAL, SG_ENUMERIC (as interpretation, mesh and priors), SG_ENOMEM */
sg_status sg_model_statistics_of(const sg_derivation *d, const sg_scene_opts *scene_opts, const sg_mesh_opts *mesh_opts,
                                 sg_scene *scene, sg_mesh *mesh, sg_model_statistics *out, sg_error *err);

/** The columns: names as in tables and JSON, and their values. @param column  below sg_model_statistics_columns() */
size_t sg_model_statistics_columns(void);
const char *sg_model_statistics_name(size_t column);
double sg_model_statistics_value(const sg_model_statistics *s, size_t column);

typedef struct {
    double mean, low, high;
} sg_model_summary;

/** One column over n > 0 models. */
sg_model_summary sg_model_statistics_summary(const sg_model_statistics *models, size_t n, size_t column);

/** A line of column names, one for each model, then mean, least and greatest: NAME<TAB>... or, aligned, columns for the eye.
 *  @param names  [n]
 *  @return SG_OK, SG_EIO (also found later, when the file is flushed) */
sg_status sg_model_statistics_write(const sg_model_statistics *models, const char *const *names, size_t n, bool aligned,
                                    FILE *out, sg_error *err);

#endif
