/* SPDX-License-Identifier: GPL-3.0-or-later */
/* split_priv.h - the split form between its own files. */
#ifndef SG_GRAMMAR_SPLIT_PRIV_H
#define SG_GRAMMAR_SPLIT_PRIV_H

#include "grammar/split.h"

/** sg_grammar_from_split() with a name for messages. */
sg_status sg_split_build(const sg_split_form *form, const char *name, sg_grammar **out, sg_error *err);

/** Covariance [k-1][k-1] of the first k-1 of k sizes that sum to 1, or of the first k-1 in reversed order. */
void sg_split_turn_covariance(size_t k, const double *covariance, bool reverse, double *out);

#endif
