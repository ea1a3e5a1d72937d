/* SPDX-License-Identifier: GPL-3.0-or-later */
/* program_grammar.h - the grammar that a program is given, with a word about what is odd in it. */
#ifndef SG_PROGRAM_PROGRAM_GRAMMAR_H
#define SG_PROGRAM_PROGRAM_GRAMMAR_H

#include "grammar/grammar.h"

/** sg_grammar_load(), and the grammar's warnings on standard error. */
sg_status sg_program_load_grammar(const char *path, sg_grammar **out, sg_error *err);

/** sg_program_spare() for the grammar's file and all that it imports. */
sg_status sg_program_spare_grammar(const char *output, const char *path, const sg_grammar *g, sg_error *err);

#endif
