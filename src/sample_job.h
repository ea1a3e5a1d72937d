/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sample_job.h - what the files of sample-grammar share. */
#ifndef SG_SAMPLE_JOB_H
#define SG_SAMPLE_JOB_H

#include "core/arena.h"
#include "derivation/derivation_io.h"
#include "derivation/pins.h"
#include "sample_options.h"
#include "scene/assets.h"
#include "scene/label_scene.h"
#include "scene/mesh.h"
#include "scene/model_statistics.h"

typedef struct {
    bool done;
    size_t nodes, rects, faces;
    double log_prior, log_density, log_given;
} sample_stats;

/** What all threads share. */
typedef struct {
    const sample_options *opts;
    const sg_grammar *g;
    sg_derivation_file stored; /* none when sampling */
    sg_assets *assets;         /* NULL without models in space */
    size_t n;                  /* samples */
    int workers;               /* samples made at once */
    int render_threads;        /* that each of them may draw with */
    char name[256];
    sg_classes classes;
    uint8_t *value_of;   /* [symbols] */
    size_t nsymbols;
    sample_stats *stats; /* [n] */
    sg_model_statistics *models; /* [n] when statistics are asked for, else NULL */
    sg_pins *pins;       /* NULL: none */
    size_t *pin_uses;    /* [pins] */
    float *share;        /* [n][classes], area shares */
    sg_image *thumbs;    /* [nthumbs], the first samples */
    size_t nthumbs, thumb_width, thumb_height;
    size_t failed; /* lowest sample that failed, n: none */
    sg_error err;  /* its sentence */
    sg_progress *progress; /* while samples are made */
} sample_job;

/** Work space of one thread. */
typedef struct {
    sg_derivation d;
    sg_label_scene scene;
    sg_scene space;
    sg_mesh mesh;
    sg_pin_run *given; /* NULL: nothing is */
    gsl_rng *rng;
    sg_arena *arena;
    double *share; /* [symbols] */
} sample_worker;

/** Does a format ask for label scenes? A grammar of models in space need not have any. */
static inline bool sample_wants_labels(const sample_options *o)
{
    return (o->formats & SAMPLE_ALL_LABELS & ~(o->in_space ? (unsigned)SAMPLE_SHEET : 0)) != 0;
}

/** Does a format ask for models in space? */
static inline bool sample_wants_space(const sample_options *o)
{
    return (o->formats & (SAMPLE_OBJ | SAMPLE_GLTF | SAMPLE_RENDER | (o->in_space ? (unsigned)SAMPLE_SHEET : 0))) != 0;
}

/** How primitives become faces, with the meshes that were read. */
sg_mesh_opts sample_mesh_opts(const sample_job *j);
/** Never what is read: -o may name the folder it stands in. @return SG_OK, SG_EINVAL */
sg_status sample_check_not_input(const sample_job *j, const char *path, sg_error *err);
/** The folder, those in it, and the class table. @return SG_OK, SG_EINVAL, SG_EIO, SG_ENOMEM */
sg_status sample_make_folders(const sample_job *j, sg_error *err);
/** All files of sample i, which the worker holds, and the picture of models in space for the sheet.
 *  @return SG_OK, SG_EINVAL, SG_ENUMERIC, SG_EIO, SG_ENOMEM */
sg_status sample_write(const sample_job *j, sample_worker *w, size_t i, sg_error *err);
/** How many pictures the sheet has, and how large they are. */
void sample_plan_sheet(sample_job *j);
/** @return SG_OK, SG_EINVAL, SG_EIO, SG_ENOMEM */
sg_status sample_write_sheet(sample_job *j, sg_error *err);
/** What --json asks for. @return SG_OK, SG_EIO, SG_ENOMEM */
sg_status sample_write_report(const sample_job *j, sg_error *err);

/* Pins. */
/** Read what --given asks for. @return SG_OK, SG_EINVAL, SG_ENOMEM */
sg_status sample_read_pins(sample_job *j, sg_error *err);
/** A worker is done: add its counts up. The caller sees to it that one does at a time. */
void sample_count_pins(sample_job *j, const sample_worker *w);
/** A pin that nothing asked for is likely a mistake: warn of it. */
void sample_warn_of_pins(const sample_job *j);

/* Statistics. */
/** Count sample i, which the worker holds. @return SG_OK, SG_ENUMERIC, SG_ENOMEM */
sg_status sample_count(sample_job *j, sample_worker *w, size_t i, sg_error *err);
/** Those that are done, together: after an interrupt some may be missing. @param models  [n of j] out. @return how many */
size_t sample_done_models(const sample_job *j, sg_model_statistics *models);
/** What --stats and --table ask for. @return SG_OK, SG_EIO, SG_ENOMEM */
sg_status sample_write_statistics(const sample_job *j, sg_error *err);

#endif
