/* SPDX-License-Identifier: GPL-3.0-or-later */
/* interval_code.h - compiled expressions over sets of numbers, and what a guard that holds says about them. */
#ifndef SG_GRAMMAR_INTERVAL_CODE_H
#define SG_GRAMMAR_INTERVAL_CODE_H

#include "grammar/grammar.h"
#include "grammar/interval.h"

/** What a frame can hold, the depth of its node, and work space. Start from a zeroed one. */
typedef struct {
    const sg_grammar *g;
    sg_interval *slots; /* the frame: parameters, then draws */
    sg_interval depth;
    sg_interval *values;  /* of the instructions that were looked at last */
    uint32_t (*sources)[3]; /* which instruction made each argument; UINT32_MAX: none did */
    size_t capacity;
} sg_interval_frame;

/** Room for the longest expression and the largest frame of g. @return SG_OK, SG_ENOMEM */
sg_status sg_interval_frame_open(sg_interval_frame *f, const sg_grammar *g, sg_error *err);
void sg_interval_frame_clear(sg_interval_frame *f);

/** What an expression can be. */
sg_interval sg_interval_eval(sg_interval_frame *f, sg_expr e);

/** Narrow the frame to what it can be where the condition holds: comparisons of parameters, draws and the depth, and
 *  their conjunctions, are understood; others narrow nothing.
 *  @return false when the condition holds nowhere in the frame, which is then undefined */
bool sg_interval_assume(sg_interval_frame *f, sg_expr condition);

/** What a value of a draw can be, when its parameters are possible ones. */
sg_interval sg_interval_of_draw(sg_interval_frame *f, const sg_draw *d);

/** NULL, or what is wrong with the parameters of a draw whatever they are; *arg is the parameter that it is about, or
 *  nargs when it is about all. */
const char *sg_interval_draw_complaint(sg_interval_frame *f, const sg_draw *d, uint32_t *arg);
/** True when nothing can be wrong with them. */
bool sg_interval_draw_is_safe(sg_interval_frame *f, const sg_draw *d);

#endif
