/* SPDX-License-Identifier: GPL-3.0-or-later */
/* facade_photos.h - which photographs a run parses, and that none of the files it writes is another or one that it reads. */
#ifndef SG_PARSE_FACADE_PHOTOS_H
#define SG_PARSE_FACADE_PHOTOS_H

#include "core/arena.h"
#include "core/status.h"
#include "parse/dataset.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct {
    const char *name;  /* what its results are called: the file's name without folder and ending */
    const char *image; /* path of the photograph; NULL: there are only its probabilities */
    const char *probabilities; /* path of NAME.npy, or NULL */
    const char *truth; /* path of its true label map, or NULL */
} sg_facade_photo;

typedef struct {
    const char *probabilities;      /* folder of NAME.npy; NULL: from a classifier, which needs photographs */
    const char *truth;              /* a data set, or a folder of NAME.png; NULL: that of a data set among the arguments, if any */
    const sg_dataset_opts *dataset; /* which photographs of data sets among the arguments */
} sg_facade_photo_opts;

typedef struct {
    size_t n;
    sg_facade_photo *items;
    size_t ndatasets; /* folders among the arguments */
} sg_facade_photos;

/** What the arguments name: photographs, data set folders (those of their photographs that opts->dataset asks for, with
 *  their label maps for truth), or with opts->probabilities names of which there is NAME.npy only. Photographs are not looked at:
 *  one that is missing is found when its turn comes.
 *  @param arena  everything lives there
 *  @param fault  as for sg_dataset_open(); is also told, in one sentence, which photographs of a data set have no label map and
 *                are left out, which is no failure
 *  @return SG_OK, SG_EINVAL (no photograph; two of one name; a name that is none), SG_EINPUT (a faulty data set), SG_ENOMEM */
sg_status sg_facade_photos_list(char *const *args, size_t nargs, const sg_facade_photo_opts *opts, sg_arena *arena,
                                void (*fault)(void *user, const char *sentence), void *user, sg_facade_photos *out,
                                sg_error *err);

/** Is any of the outputs the same path as another, or one file with any of the inputs? Inputs may be NULL or missing.
 *  @return SG_OK, SG_EINVAL (the sentence names the file), SG_ENOMEM. O(n log n) */
sg_status sg_facade_spare_files(const char *const *outputs, size_t noutputs, const char *const *inputs, size_t ninputs,
                                sg_error *err);

#endif
