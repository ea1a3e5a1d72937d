/* SPDX-License-Identifier: GPL-3.0-or-later */
/* facade_output.h - the files that a parsed photograph becomes. */
#ifndef SG_PARSE_FACADE_OUTPUT_H
#define SG_PARSE_FACADE_OUTPUT_H

#include "core/arena.h"
#include "image/classes.h"
#include "image/image.h"
#include "parse/facade.h"
#include "parse/facade_lines.h"

/** What is written beside each other, as bits. */
typedef enum {
    SG_FACADE_LABELS = 1,       /* NAME.png: the label map, pixel values and palette of the class table */
    SG_FACADE_OVERLAY = 2,      /* NAME.overlay.png: the labels over the photograph; none without one */
    SG_FACADE_DERIVATION = 4,   /* NAME.json: the derivation, its root also holds the energies */
    SG_FACADE_TRACE = 8,        /* NAME.trace.tsv: energies along the runs; none where nothing was searched */
    SG_FACADE_MARGINALS = 16,   /* NAME.marginals.npy: the share of samples in which a pixel has a label */
    SG_FACADE_LINES = 32,       /* NAME.lines.tsv: how sure each boundary line is */
    SG_FACADE_UNCERTAINTY = 64, /* NAME.uncertainty.png: both as a picture */
    SG_FACADE_ALL = 127,
    SG_FACADE_OWN = 2 + 8 + 16 + 32 + 64, /* endings that nobody else uses: an earlier run's are removed where none is made */
} sg_facade_format;

enum { SG_FACADE_FORMATS = 7 };

/** Name of a format for options ("labels", "overlay", ...) and the ending of its file; format: 0..SG_FACADE_FORMATS-1. */
const char *sg_facade_format_name(int format);
const char *sg_facade_format_ending(int format);

/** What the files are made from; all borrowed. */
typedef struct {
    const char *folder, *name;
    const sg_image *photo;     /* NULL: none */
    const sg_grammar *g;
    const sg_classes *classes; /* of the channels */
    const uint32_t *channel;   /* [symbols of g] */
    size_t width, height;
    const sg_facade_parse *parse;
    sg_facade_stage stage;     /* whose result is shown */
} sg_facade_report;

/** The label map of the result; pixel values are those of the class table (first_index). map is made here.
 *  @return SG_OK, SG_ENUMERIC, SG_ENOMEM */
sg_status sg_facade_label_map(const sg_facade_report *r, sg_label_map *map, sg_error *err);

/** Write what is asked for, each file beside its place and renamed. What is made from samples is left out where there are
 *  none. Then those of SG_FACADE_OWN go that are of an earlier parse: files of one NAME belong together. @return SG_OK, SG_EIO, SG_ENUMERIC, SG_ENOMEM */
sg_status sg_facade_write(const sg_facade_report *r, unsigned formats, sg_error *err);

#endif
