/* SPDX-License-Identifier: GPL-3.0-or-later */
/* learn_input.h - the lattices to learn from: fitted to the label maps of a data set, or read from a folder of *.lat.
 */
#ifndef SG_LEARN_LEARN_INPUT_H
#define SG_LEARN_LEARN_INPUT_H

#include "core/progress.h"
#include "core/status.h"
#include "parse/dataset.h"
#include "parse/lattice.h"

typedef struct {
    sg_dataset_opts dataset; /* for a folder of lattices only names_file, max_images and classes_file count */
    size_t cells;            /* fit each lattice with at most so many cells; 0: see below */
    double accuracy;         /* or with at least this share of the pixels right; 0: weights from description length */
    void (*fault)(void *user, const char *sentence); /* faults of a data set, one by one; may be NULL */
    sg_progress *progress;
} sg_learn_input_opts;

#define SG_LEARN_INPUT_OPTS_INIT                                                                                       \
    {                                                                                                                  \
        SG_DATASET_OPTS_INIT, 0, 0, NULL, NULL                                                                         \
    }

typedef struct {
    size_t n;
    sg_lattice *lattices; /* [n] */
    const char **names;   /* [n] of the items */
    size_t nterminals;
    const char **terminal_names;
    uint32_t *terminal_colors;
    double cells;      /* mean number a lattice */
    double accuracy;   /* mean share of the pixels that the lattices show right; NaN for lattices from files */
    sg_arena **arenas; /* [n] of the lattices */
    sg_arena *arena;
} sg_learn_input;

/** A folder with classes.tsv (or with --classes and labels/) is a data set, else it is a folder of lattices.
 *  @return SG_OK, SG_STOPPED (nothing is made then), SG_EINPUT, SG_EINVAL, SG_ENOMEM */
sg_status sg_learn_input_read(const char *folder, const sg_learn_input_opts *o, sg_learn_input *out, sg_error *err);
void sg_learn_input_clear(sg_learn_input *in);

#endif
