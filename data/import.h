/* SPDX-License-Identifier: GPL-3.0-or-later */
/* import.h - label maps of other projects into a data set of ours (INTERFACES 3).
 * Each source file becomes labels/NAME.png, NAME being its name without ending; classes.tsv and, when asked for, the
 * photographs stand beside. Bad files are told one by one and left out; the good ones are imported. */
#ifndef SG_DATA_IMPORT_H
#define SG_DATA_IMPORT_H

#include "core/progress.h"
#include "core/status.h"

#include <stddef.h>

typedef enum {
    SG_IMPORT_RGB,     /* PNG in the colours of the class table */
    SG_IMPORT_PALETTE, /* grey or palette PNG, values counted from base */
    SG_IMPORT_MATRIX,  /* text: a row a line, whole numbers with blanks, tabs, commas or semicolons between */
    SG_IMPORT_DIGITS,  /* text: a row a line, a digit a pixel */
    SG_IMPORT_LABELME, /* LabelMe JSON: polygons, rectangles and circles, drawn in their order */
} sg_import_kind;

typedef struct {
    sg_import_kind kind;
    const char *source;       /* a file, or a folder: then every file in it with the kind's ending */
    const char *dataset;      /* the folder to write */
    const char *classes_file; /* NULL: the data set's own classes.tsv */
    const char *images;       /* folder of photographs with the same names, or NULL */
    const char *suffix;       /* taken off the ends of names that have it ("_labels"), or NULL */
    int base;                 /* value of class index 0; lower values are void: the table's first ignored index */
    double tolerance;         /* rgb: a pixel may be so far from its colour (Euclidean, 0 to 441) */
    const char *background;   /* labelme: class of what no shape covers; NULL: the table's first ignored index */
} sg_import_opts;

#define SG_IMPORT_OPTS_INIT {SG_IMPORT_RGB, NULL, NULL, NULL, NULL, NULL, 0, 0, NULL}

typedef struct {
    size_t found, imported; /* source files */
} sg_import_result;

/** Import. No input is ever written to: where source and target are the same file the import is refused.
 *  @param fault  called once a bad file with a sentence that names it; may be NULL
 *  @param result what was done, also when the call fails
 *  @return SG_OK, SG_EINPUT (a bad class table, nothing to import, or some file was bad: the rest is imported),
 *          SG_EIO (then it ends at once), SG_ENOMEM, SG_STOPPED */
sg_status sg_import_run(const sg_import_opts *opts, void (*fault)(void *user, const char *sentence), void *user,
                        sg_progress *progress, sg_import_result *result, sg_error *err);

#endif
