/* SPDX-License-Identifier: GPL-3.0-or-later */
/* dataset.h - a data set folder (INTERFACES 3): class table, pictures, label maps, folds.
 * All faults are found and reported together, before any work starts. */
#ifndef SG_PARSE_DATASET_H
#define SG_PARSE_DATASET_H

#include "core/arena.h"
#include "core/status.h"
#include "image/classes.h"
#include "image/image.h"

#include <stdbool.h>
#include <stddef.h>

typedef enum { SG_SPLIT_TRAIN, SG_SPLIT_VALID, SG_SPLIT_TEST, SG_SPLIT_ALL } sg_dataset_part;

typedef struct {
    const char *name;
    const char *labels; /* path */
    const char *image;  /* path of the photograph (jpg, jpeg, png), or NULL when there is none */
} sg_dataset_item;

typedef struct {
    const char *folder;
    sg_classes classes;
    size_t nitems;
    sg_dataset_item *items; /* the chosen ones, in their order */
} sg_dataset;

typedef struct {
    const char *classes_file; /* NULL: FOLDER/classes.tsv */
    const char *names_file;   /* one NAME a line, the order counts; or NULL; not together with a fold */
    int fold;                 /* 0: none, then all of labels/ in the order of their names (bytes) */
    sg_dataset_part part;     /* which part of the fold */
    size_t max_images;        /* 0: no limit; the first ones count */
    bool need_images;         /* photographs are needed too, and whole; one of another size is a fault either way */
    bool one_image;           /* two photographs of one name are a fault, as they are with need_images */
    bool may_be_empty;        /* a list without a name of the part is no fault */
} sg_dataset_opts;

#define SG_DATASET_OPTS_INIT {NULL, NULL, 0, SG_SPLIT_TRAIN, 0, false, false, false}

/** Open a data set and check all that was asked for: every chosen file is there, readable, of equal sizes, with labels
 *  from the class table only. Faults go to `fault` one by one, each naming its file; then the call fails with a count.
 *  @param arena  names and paths live there, and must outlive the data set
 *  @param fault  called once a fault with a sentence; NULL: err then names the first and how many more there are
 *  @return SG_OK, SG_EINVAL (a fold and names), SG_EINPUT, SG_ENOMEM; on failure out is untouched */
sg_status sg_dataset_open(const char *folder, const sg_dataset_opts *opts, sg_arena *arena,
                          void (*fault)(void *user, const char *sentence), void *user, sg_dataset *out, sg_error *err);
/** The class table goes; the arena is the caller's. */
void sg_dataset_close(sg_dataset *d);

/** Read the label map of an item as classes: pixel values are sg_classes classes or SG_CLASS_IGNORE.
 *  @return SG_OK, SG_EINVAL (no such item), SG_EINPUT, SG_ENOMEM */
sg_status sg_dataset_read_labels(const sg_dataset *d, size_t item, sg_label_map *out, sg_error *err);

#endif
