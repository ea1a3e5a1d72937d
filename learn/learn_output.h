/* SPDX-License-Identifier: GPL-3.0-or-later */
/* learn_output.h - what learning writes: the grammar file, the result as JSON (INTERFACES 7), the report folder. */
#ifndef SG_LEARN_LEARN_OUTPUT_H
#define SG_LEARN_LEARN_OUTPUT_H

#include "learn/learn.h"
#include "learn/learn_input.h"
#include "learn/report.h"

/** A grammar file: the exchange form when the path ends in .json, else the language. @return SG_OK, SG_EIO, SG_ENOMEM
 */
sg_status sg_learn_write_grammar(const sg_split_form *form, const char *path, sg_error *err);

/** @param seconds  of the learning, fitting of lattices left out */
sg_status sg_learn_write_json(const sg_learn_result *r, const sg_learn_opts *opts, double seconds, const char *path,
                              sg_error *err);

/** The report: lattices/NAME.png, samples/K.png (a fixed number of samples of the finished grammar, from `seed`),
 *  grammar.svg and index.html. The folder is made when it is not there.
 *  @param settings  [nsettings] lines for the page */
sg_status sg_learn_write_report(const char *folder, const sg_learn_input *in, const sg_learn_result *r,
                                const sg_report_line *settings, size_t nsettings, uint64_t seed, double seconds,
                                sg_error *err);

#endif
