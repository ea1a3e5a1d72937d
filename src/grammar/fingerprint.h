/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fingerprint.h - a number that tells grammars apart: what is stored with a grammar's derivations. */
#ifndef SG_GRAMMAR_FINGERPRINT_H
#define SG_GRAMMAR_FINGERPRINT_H

#include "grammar/grammar.h"

/** Hash (FNV-1a, 64 bits) of the canonical text that sg_grammar_print() writes. Layout, comments and the form of the file
 *  make no difference; it guards against mistakes, not against forgery. @return SG_OK, SG_ENOMEM */
sg_status sg_grammar_fingerprint(const sg_grammar *g, uint64_t *out, sg_error *err);

#endif
