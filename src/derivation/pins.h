/* SPDX-License-Identifier: GPL-3.0-or-later */
/* pins.h - draws and rule choices of a sample that are given and not left to chance.
 *
 * A pin is NODE[:RULE][.DRAW]=VALUE. NODE is a path of symbols, "A > B > C" as errors write it: it means every node C below a
 * B below an A, wherever they stand; a symbol by itself means every node of it. "(N more)" in a path stands for any N
 * symbols. "#K" behind the path means the K-th such node in pre-order, from 1.
 *   A.h=3        the draw h of every A, in each rule that has one; draws without a name are called by their number in the
 *                rule, from 1: A.1=3; all sizes of a drawn split together: A.1=0.2,0.3,0.5
 *   A:2.h=3      the same where A uses its second rule, in the order of the file
 *   A=2          every A uses its second rule; of `maybe(P) B` the first rule is B and the second nothing
 * Of pins for one draw or choice the last one counts.
 *
 * A pinned draw takes the uniforms that sampling would have used, so the other draws of a sample are those of the same seed
 * without pins as long as the tree stays the same. Its uniforms become those of the value (sg_draw_condition()). What
 * comes out is a derivation like any other. Where no draw that is pinned has parameters, or guards and weights before it, that
 * depend on other draws, samples are those of the prior given the pins; else they are once they are weighted by
 * sg_pin_run_log_weight() (likelihood weighting). */
#ifndef SG_DERIVATION_PINS_H
#define SG_DERIVATION_PINS_H

#include "derivation/derivation.h"

typedef struct sg_pins sg_pins;
/** What one thread counts while it samples. */
typedef struct sg_pin_run sg_pin_run;

/** None yet. @param g  must outlive it. @return SG_OK, SG_ENOMEM */
sg_status sg_pins_create(const sg_grammar *g, sg_pins **out, sg_error *err);
void sg_pins_free(sg_pins *p);
/** One more; the text is copied.
 *  @return SG_OK, SG_EINVAL (it is not written so; no such symbol, rule or draw: the sentence lists what there is), SG_ENOMEM */
sg_status sg_pins_add(sg_pins *p, const char *text, sg_error *err);
/** How many there are, and the text of one of them. @param pin  below the count; so in all that follows */
size_t sg_pins_count(const sg_pins *p);
const char *sg_pins_text(const sg_pins *p, size_t pin);

/** @param pins  must outlive it, and take no more pins. @return SG_OK, SG_ENOMEM */
sg_status sg_pin_run_create(const sg_pins *pins, sg_pin_run **out, sg_error *err);
void sg_pin_run_free(sg_pin_run *r);
/** How many draws and choices the pin has decided, over all samples of this run. */
size_t sg_pin_run_uses(const sg_pin_run *r, size_t pin);
/** Of the last sample: log density of the pinned draws and log probability of the pinned choices where they stand. */
double sg_pin_run_log_weight(const sg_pin_run *r);

/** As sg_derivation_sample(), with the pins.
 *  @return also SG_ENUMERIC for a value outside of a draw's support, a rule of probability 0 where it is pinned */
sg_status sg_derivation_sample_given(sg_derivation *d, sg_pin_run *r, gsl_rng *rng, size_t max_nodes, sg_error *err);

#endif
