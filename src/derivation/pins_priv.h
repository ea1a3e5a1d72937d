/* SPDX-License-Identifier: GPL-3.0-or-later */
/* pins_priv.h - pins as sampling asks them. */
#ifndef SG_DERIVATION_PINS_PRIV_H
#define SG_DERIVATION_PINS_PRIV_H

#include "derivation/pins.h"

/** A step of a path: a symbol, or any `skipped` ones. */
typedef struct {
    sg_sym symbol;
    size_t skipped;
} sg_pin_step;

typedef struct {
    char *text;
    sg_pin_step *steps; /* [nsteps] root side first; the last one is a symbol: the node's */
    size_t nsteps, steps_capacity;
    size_t occurrence;  /* 0: all */
    sg_rule_id rule;    /* nodes that use it; SG_NONE: any */
    sg_rule_id choice;  /* the rule that is pinned; SG_NONE: a draw is */
    char *draw;         /* its name or number, as written */
    double *values;     /* [nvalues] */
    size_t nvalues, values_capacity;
} sg_pin;

struct sg_pins {
    const sg_grammar *grammar;
    sg_pin *items;
    size_t n, capacity;
    bool *concerns; /* [symbols] */
};

struct sg_pin_run {
    const sg_pins *pins;
    size_t *met;  /* [pins] nodes of its path so far, in this sample */
    bool *here;   /* [pins] it is about the node in work */
    size_t *uses; /* [pins] */
    double log_weight;
};

static inline bool sg_pins_concern(const sg_pin_run *r, sg_sym symbol)
{
    return r->pins->concerns[symbol];
}

/** Is draw k of rule r the one that the pin means? */
bool sg_pin_means_draw(const sg_pin *p, const sg_rule *r, uint32_t k);

/** A sample begins. */
void sg_pin_run_begin(sg_pin_run *r);
/** The last node of d, with its arguments and no rule yet: see which pins are about it, and put the rule that is pinned in place
 *  of the one that was chosen.
 *  @param limited  it is beyond the depth limit, where nothing is chosen */
sg_status sg_pin_run_choose(sg_pin_run *r, const sg_derivation *d, bool limited, sg_rule_id *rule, sg_error *err);
/** Uniforms and values of its draws: as sg_derivation_transform(), but the uniforms of pinned ones are changed first. */
sg_status sg_pin_run_transform(sg_pin_run *r, const sg_grammar *g, const sg_rule *rule, uint32_t nparams, double depth,
                               double *uniforms, double *frame, sg_error *err);

#endif
