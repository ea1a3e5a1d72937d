/* SPDX-License-Identifier: GPL-3.0-or-later */
/* pins_run.c - pins at work: which are about a node, and what they decide. */
#include "derivation/derivation_priv.h"
#include "derivation/pins_priv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

sg_status sg_pin_run_create(const sg_pins *pins, sg_pin_run **out, sg_error *err)
{
    sg_pin_run *r = calloc(1, sizeof *r);
    if (r == NULL)
        return SG_FAIL_NOMEM(err);
    r->pins = pins;
    r->met = calloc(pins->n + 1, sizeof *r->met);
    r->here = calloc(pins->n + 1, sizeof *r->here);
    r->uses = calloc(pins->n + 1, sizeof *r->uses);
    if (r->met == NULL || r->here == NULL || r->uses == NULL) {
        sg_pin_run_free(r);
        return SG_FAIL_NOMEM(err);
    }
    *out = r;
    return SG_OK;
}

void sg_pin_run_free(sg_pin_run *r)
{
    if (r == NULL)
        return;
    free(r->met);
    free(r->here);
    free(r->uses);
    free(r);
}

size_t sg_pin_run_uses(const sg_pin_run *r, size_t pin)
{
    return r->uses[pin];
}

double sg_pin_run_log_weight(const sg_pin_run *r)
{
    return r->log_weight;
}

void sg_pin_run_begin(sg_pin_run *r)
{
    memset(r->met, 0, r->pins->n * sizeof *r->met);
    r->log_weight = 0;
}

/* Does the path end at this node? */
static bool is_at(const sg_pin *p, const sg_derivation *d, size_t node)
{
    for (size_t step = p->nsteps; step-- > 0;) {
        const sg_pin_step *s = p->steps + step;
        for (size_t i = 1; i < s->skipped; i++) { /* of n skipped ones the last is left below as any other step */
            if (d->nodes[node].parent == 0)
                return false;
            node -= d->nodes[node].parent;
        }
        if (s->symbol != SG_NONE && d->nodes[node].symbol != s->symbol)
            return false;
        if (step == 0)
            return true;
        if (d->nodes[node].parent == 0)
            return false;
        node -= d->nodes[node].parent;
    }
    return false;
}

static bool is_about(sg_pin_run *r, const sg_derivation *d, size_t node, size_t pin)
{
    const sg_pin *p = r->pins->items + pin;
    if (!is_at(p, d, node))
        return false;
    r->met[pin]++;
    return p->occurrence == 0 || p->occurrence == r->met[pin];
}

static sg_status take_choice(sg_pin_run *r, const sg_derivation *d, size_t node, size_t pin, sg_rule_id *rule, sg_error *err)
{
    sg_node n = d->nodes[node];
    double p;
    n.rule = r->pins->items[pin].choice;
    SG_TRY(sg_node_probability(d, &n, &p, err));
    if (!(p > 0))
        return SG_FAIL(err, SG_ENUMERIC, "given %.80s: this rule has probability 0 here", r->pins->items[pin].text);
    *rule = n.rule;
    r->uses[pin]++;
    r->log_weight += log(p);
    return SG_OK;
}

sg_status sg_pin_run_choose(sg_pin_run *r, const sg_derivation *d, bool limited, sg_rule_id *rule, sg_error *err)
{
    const size_t node = d->nnodes - 1;
    size_t choice = SIZE_MAX;
    for (size_t i = 0; i < r->pins->n; i++) {
        r->here[i] = is_about(r, d, node, i);
        if (r->here[i] && r->pins->items[i].choice != SG_NONE && !limited)
            choice = i;
    }
    return choice != SIZE_MAX ? take_choice(r, d, node, choice, rule, err) : SG_OK;
}

/* The last pin that is about this draw of the node in work, SIZE_MAX: none. */
static size_t pin_of(const sg_pin_run *r, const sg_grammar *g, const sg_rule *rule, uint32_t k)
{
    for (size_t i = r->pins->n; i-- > 0;) {
        const sg_pin *p = r->pins->items + i;
        if (r->here[i] && (p->rule == SG_NONE || sg_grammar_rule(g, p->rule) == rule) && sg_pin_means_draw(p, rule, k))
            return i;
    }
    return SIZE_MAX;
}

static sg_status take_value(sg_pin_run *r, const sg_grammar *g, const sg_draw *draw, size_t pin, double depth,
                            const double *frame, double *u, double *value, sg_error *err)
{
    const sg_pin *p = r->pins->items + pin;
    double log_density = 0;
    sg_status st = sg_draw_condition(g, draw, frame, depth, p->values, u, err);
    if (st == SG_OK && draw->kind == SG_DRAW_SIMPLEX)
        st = sg_draw_transform(g, draw, frame, depth, u, value, err); /* the last size is the remainder */
    else if (st == SG_OK)
        *value = *p->values;
    if (st == SG_OK)
        st = sg_draw_log_density(g, draw, frame, depth, value, &log_density, err);
    if (st == SG_ENUMERIC && err != NULL) {
        const sg_error inner = *err;
        return sg_fail(err, st, "given %.80s: %.700s", p->text, inner.msg);
    }
    r->uses[pin]++;
    r->log_weight += log_density;
    return st;
}

sg_status sg_pin_run_transform(sg_pin_run *r, const sg_grammar *g, const sg_rule *rule, uint32_t nparams, double depth,
                               double *uniforms, double *frame, sg_error *err)
{
    for (uint32_t k = 0; k < rule->ndraws; k++) {
        const sg_draw *draw = rule->draws + k;
        double *u = uniforms + draw->first_uniform, *value = frame + nparams + draw->first_value;
        const size_t pin = pin_of(r, g, rule, k);
        SG_TRY(pin == SIZE_MAX ? sg_draw_transform(g, draw, frame, depth, u, value, err)
                               : take_value(r, g, draw, pin, depth, frame, u, value, err));
    }
    return SG_OK;
}
