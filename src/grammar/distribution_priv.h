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
/** NULL for drawn sizes. */
const char *sg_distribution_name(sg_draw_kind kind);
/** What is wrong with parameters, NULL when nothing is. */
const char *sg_distribution_complaint(sg_draw_kind kind, const double *args, uint32_t nargs);

enum { SG_DRAW_FEW_ARGUMENTS = 24 };

/** Evaluated parameters; many of them (long mixtures) go to the heap. */
typedef struct {
    double few[SG_DRAW_FEW_ARGUMENTS], *many;
    const double *v;
    uint32_t n;
} sg_draw_arguments;

/** Parameters of a draw that is no simplex; free a->many when done. @return SG_OK, SG_ENUMERIC (impossible ones), SG_ENOMEM */
sg_status sg_draw_evaluate(const struct sg_grammar *g, const sg_draw *d, const double *frame, double depth,
                           sg_draw_arguments *a, sg_error *err);

#endif
