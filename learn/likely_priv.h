/* SPDX-License-Identifier: GPL-3.0-or-later */
/* likely_priv.h - the most probable derivation of each symbol, for pictures. */
#ifndef SG_LEARN_LIKELY_PRIV_H
#define SG_LEARN_LIKELY_PRIV_H

#include "core/arena.h"
#include "grammar/split.h"

typedef struct {
    const sg_split_form *form;
    uint32_t *best;    /* [nsymbols] rule that begins the most probable derivation, SG_NONE: none ends */
    double *log_p;     /* [nsymbols] its log probability */
    uint32_t *first;   /* [nsymbols + 1] first rule of each symbol */
} sg_likely;

/** @return SG_OK, SG_ENOMEM */
sg_status sg_likely_of(const sg_split_form *f, sg_arena *arena, sg_likely *out, sg_error *err);

/** Relative size of part i of a rule: its mean, else the mean of its training sizes, else an equal share. */
double sg_likely_size(const sg_split_rule *r, uint32_t i);

#endif
