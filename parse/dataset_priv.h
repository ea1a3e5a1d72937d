/* SPDX-License-Identifier: GPL-3.0-or-later */
/* dataset_priv.h - collecting the faults of a data set while it is opened. */
#ifndef SG_PARSE_DATASET_PRIV_H
#define SG_PARSE_DATASET_PRIV_H

#include "parse/dataset.h"

/* A fault does not end the search for more; only lack of memory does, and only that is returned on the way. */
typedef struct {
    const char *folder;
    const sg_dataset_opts *opts;
    sg_arena *arena;
    void (*fault)(void *user, const char *sentence);
    void *user;
    size_t nfaults;
    char first[1024]; /* the first sentence */
} sg_dataset_check;

void sg_dataset_fault(sg_dataset_check *c, const char *format, ...) __attribute__((format(printf, 2, 3)));

typedef struct {
    const char **names;
    size_t count;
} sg_dataset_names;

/** The chosen names in their order: of a fold, of a list, or of all label maps. Whatever is wrong with the lists is a
 *  fault; names that cannot be used are left out.
 *  @return SG_OK, SG_ENOMEM */
sg_status sg_dataset_choose(sg_dataset_check *c, sg_dataset_names *out, sg_error *err);

#endif
