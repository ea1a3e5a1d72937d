/* SPDX-License-Identifier: GPL-3.0-or-later */
/* distribution_priv.h - names and shapes of the distributions, for builder and printer. */
#ifndef SG_GRAMMAR_DISTRIBUTION_PRIV_H
#define SG_GRAMMAR_DISTRIBUTION_PRIV_H

#include "grammar/distribution.h"

typedef struct {
    const char *name;
    sg_draw_kind kind;
    uint32_t nargs;      /* numbers, or numbers in each tuple */
    bool tuples;         /* one or more tuples in place of numbers */
    const char *args;    /* for messages */
    uint32_t nuniforms;
} sg_distribution_info;

/** NULL when no distribution has this name. */
const sg_distribution_info *sg_distribution_find(const char *name);
/** What is wrong with parameters, NULL when nothing is. */
const char *sg_distribution_complaint(sg_draw_kind kind, const double *args, uint32_t nargs);

#endif
