/* SPDX-License-Identifier: GPL-3.0-or-later */
/* facade_process.h - one photograph from its file to its results: unaries, parse, scores, files. */
#ifndef SG_PARSE_FACADE_PROCESS_H
#define SG_PARSE_FACADE_PROCESS_H

#include "parse/evaluation.h"
#include "parse/facade.h"
#include "parse/facade_output.h"
#include "parse/facade_photos.h"
#include "parse/pixel_classifier.h"

#include <jansson.h>

/** What all photographs of a run share. */
typedef struct {
    const sg_grammar *g;
    const sg_pixel_classifier *classifier; /* NULL: probabilities come from files */
    const sg_classes *classes;             /* of the channels */
    const uint32_t *channel;               /* [symbols of g] */
    const sg_classes *truth_classes;       /* NULL: nothing is scored */
    uint8_t truth_of[256];                 /* class of the truth of a pixel value of `classes`: sg_evaluation_classes() */
    double hard;                           /* of sg_unaries_harden(); 0: probabilities as they are */
    float floor;                           /* of sg_unaries_lift() */
    sg_facade_opts opts;                   /* the seed is that of the run */
    const char *folder;
    unsigned formats;                      /* sg_facade_format bits */
    int threads;                           /* of the classifier; the search has its own */
} sg_facade_setup;

/** What a stage came to. */
typedef struct {
    bool done;
    sg_energy energy;
    double seconds, accuracy; /* accuracy NAN: no truth */
} sg_facade_stage_outcome;

/** What is told of a photograph. */
typedef struct {
    sg_status status; /* SG_OK and SG_STOPPED: it was parsed */
    sg_error error;
    size_t width, height;
    sg_facade_stage best;
    sg_facade_stage_outcome stages[SG_FACADE_STAGES];
    double unary_seconds, seconds; /* seconds: of all stages */
    bool scored;
    sg_confusion found, map;       /* the parse, and the most probable class of each pixel, against the truth */
    bool searched;
    uint64_t moves, swaps_proposed, swaps_accepted;
    double search_seconds;         /* of the moves */
    sg_chain_stats stats;
    size_t nruns, best_run, nsamples;
    double *run_energies;          /* [nruns] */
    size_t columns, rows, states;  /* of the exact parse */
    double energy_lattice;
} sg_facade_outcome;

/** Parse one photograph and write its files.
 *  @param arena  what outlives the call is put there
 *  @param out    its status and sentence say what became of it
 *  @return out->status: SG_OK; SG_STOPPED, with the best so far written; SG_EINPUT (photograph, probabilities or truth
 *          cannot be used), SG_ENOPARSE, SG_ENUMERIC, SG_EINVAL, SG_EIO, SG_ENOMEM */
sg_status sg_facade_process(const sg_facade_setup *setup, const sg_facade_photo *photo, sg_progress *progress,
                            sg_arena *arena, sg_facade_outcome *out);

/** Pixel accuracy of one confusion; NAN: no pixels. */
double sg_confusion_accuracy(const sg_confusion *c);

/** The outcome as INTERFACES 7 has it, and what else there is to tell. @return NULL: out of memory */
json_t *sg_facade_outcome_json(const sg_facade_photo *photo, const sg_facade_outcome *o);

/** Name of a kind of moves for options and reports: "jump-fresh" and so on. */
const char *sg_move_name(sg_move_kind kind);

#endif
