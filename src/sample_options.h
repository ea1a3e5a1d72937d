/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sample_options.h - the command line of sample-grammar. */
#ifndef SG_SAMPLE_OPTIONS_H
#define SG_SAMPLE_OPTIONS_H

#include "grammar/grammar.h"
#include "program/program.h"
#include "scene/camera.h"
#include "scene/tree_picture.h"

/** What is written. Up to the sheet: of label scenes. A sheet shows these, or pictures of models in space. */
enum { SAMPLE_LABELS = 1, SAMPLE_RGB = 2, SAMPLE_SVG = 4, SAMPLE_LAT = 8, SAMPLE_JSON = 16, SAMPLE_SHEET = 32,
       SAMPLE_OBJ = 64, SAMPLE_DERIVATION = 128, SAMPLE_RENDER = 256, SAMPLE_TREE = 512, SAMPLE_GLTF = 1024,
       SAMPLE_ALL_LABELS = 63 };
enum { SAMPLE_MAX_GIVEN = 1000 };

typedef struct {
    sg_common_opts common;
    const char *grammar, *folder, *name, *from; /* from: NULL when sampling */
    size_t n; /* 0: not said */
    size_t width, height; /* 0 until sample_settle() */
    size_t columns, rows, max_nodes, detail;
    double scope[3];
    sg_view view;
    unsigned formats; /* 0 until sample_settle(), unless said; and with statistics alone */
    bool dataset;
    bool stats;        /* on standard output */
    const char *table; /* NULL: none */
    const char *given[SAMPLE_MAX_GIVEN]; /* pins (derivation/pins.h) */
    size_t ngiven;
    sg_tree_picture_opts tree;
    bool in_space;    /* sheets show models in space */
} sample_options;

/** Are statistics asked for? */
static inline bool sample_counts(const sample_options *o)
{
    return o->stats || o->table != NULL;
}

/** @return -1: go on; else exit with this status */
int sample_parse_options(int argc, char **argv, sample_options *o);

/** What was not said, by the kind of the grammar. */
void sample_settle(sample_options *o, const sg_grammar *g);

#endif
