/* SPDX-License-Identifier: GPL-3.0-or-later */
/* import_priv.h - what the readers of the kinds share. */
#ifndef SG_DATA_IMPORT_PRIV_H
#define SG_DATA_IMPORT_PRIV_H

#include "core/arena.h"
#include "data/import.h"
#include "image/classes.h"
#include "image/image.h"

#include <stdbool.h>

typedef struct {
    const sg_import_opts *opts;
    sg_classes classes;
    int void_index; /* the first ignored pixel index; -1 when the table has none */
    int background; /* labelme: pixel index */
    sg_arena *scratch; /* of one file */
} sg_importer;

/** Where a file's picture has its size from when the file does not say: 0 x 0 when there is no photograph. */
typedef struct {
    size_t width, height;
} sg_import_size;

/** Readers, one a kind: pixel values of out are indices of the class table.
 *  @return SG_OK, SG_EINPUT (one sentence with all that is wrong), SG_ENOMEM; on failure out is untouched */
typedef sg_status sg_import_reader(const sg_importer *im, const char *path, sg_import_size photo, sg_label_map *out,
                                   sg_error *err);
sg_import_reader sg_import_rgb, sg_import_palette, sg_import_matrix, sg_import_digits, sg_import_labelme;

/* ---- things that are not in the class table, counted ---- */

typedef struct sg_import_tally sg_import_tally;

/** An empty tally in the arena, NULL when memory is out; sg_import_tally_end() frees the rest. */
sg_import_tally *sg_import_tally_begin(sg_arena *arena);
/** One more of it, at pixel (x, y). @return SG_OK, SG_ENOMEM */
sg_status sg_import_tally_add(sg_import_tally *t, const char *what, size_t x, size_t y, sg_error *err);
/** SG_OK when it is empty; else SG_EINPUT with a sentence: the most frequent first, with their counts.
 *  @param noun   "label", "colour", "class name"
 *  @param unit   what is counted: "pixel", "shape" (then no positions are given) */
sg_status sg_import_tally_end(sg_import_tally *t, const char *path, const char *noun, const char *unit, sg_error *err);

/** Pixel index of a counted value: base taken off, what is below is void. -1 when the table does not have it. */
int sg_import_index(const sg_importer *im, long value);

#endif
