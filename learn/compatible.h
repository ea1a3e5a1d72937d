/* SPDX-License-Identifier: GPL-3.0-or-later */
/* compatible.h - which symbols may be merged, beyond that they reach the same labels.
 * The paper asks for equal labels only. In a grammar of bands (split-x) and columns (split-y) that lets a band of storeys
 * become a column, or a column of five storeys one of a single window: both change what the grammar makes far more than
 * its description length says. */
#ifndef SG_LEARN_COMPATIBLE_H
#define SG_LEARN_COMPATIBLE_H

#include "learn/rules.h"

typedef enum {
    SG_COMPATIBLE_LABELS, /* equal labels: the paper's condition */
    SG_COMPATIBLE_KINDS,  /* and rules of the same kinds: split-x, split-y, lexical */
    SG_COMPATIBLE_SIZES,  /* and typical regions of about the same width and height: equal once rounded to powers of two of
                             the whole */
} sg_compatible;

/** Restrict the merges of r, which must be fresh from sg_rules_create(form, counts): its symbols are the form's. Kinds and
 *  sizes are those of the symbols at this time.
 *  @param counts  [rules of the form] uses
 *  @return SG_OK, SG_ENOMEM */
sg_status sg_rules_restrict(sg_rules *r, sg_compatible what, const sg_split_form *form, const double *counts,
                            sg_error *err);

#endif
