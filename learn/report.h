/* SPDX-License-Identifier: GPL-3.0-or-later */
/* report.h - one page that shows what learning did: settings, sizes, the trace of the energy, the history of the merges,
 * the grammar as a picture, training lattices and samples. */
#ifndef SG_LEARN_REPORT_H
#define SG_LEARN_REPORT_H

#include "core/status.h"
#include "grammar/split.h"

#include <stddef.h>

typedef struct {
    const char *name, *value;
} sg_report_line;

/** A picture that stands in the report's folder. */
typedef struct {
    const char *file; /* relative to the folder */
    const char *caption;
} sg_report_picture;

/** The state after a step of the search; the first one is the initial grammar. */
typedef struct {
    const char *what; /* "merge R3 R7", "chunk R1 R2" */
    double energy;    /* nats */
    size_t nonterminals, rules_x, rules_y, rules_lexical;
} sg_report_step;

typedef struct {
    const char *title;
    const sg_report_line *settings;
    size_t nsettings;
    const sg_report_line *results;
    size_t nresults;
    const sg_report_step *steps;
    size_t nsteps;
    const sg_split_form *initial, *merged, *finished; /* sizes of all three, picture of the last */
    const sg_report_picture *lattices;
    size_t nlattices;
    const sg_report_picture *samples;
    size_t nsamples;
} sg_report;

/** Write FOLDER/index.html and FOLDER/grammar.svg; the folder is there and holds the pictures.
 *  @return SG_OK, SG_EIO, SG_ENOMEM */
sg_status sg_report_write(const char *folder, const sg_report *r, sg_error *err);

/** Non-terminals and rules by kind, as Table 1 of the paper counts them. */
typedef struct {
    size_t nonterminals, rules_x, rules_y, rules_lexical;
} sg_grammar_sizes;
sg_grammar_sizes sg_split_form_sizes(const sg_split_form *f);

#endif
