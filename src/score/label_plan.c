/* SPDX-License-Identifier: GPL-3.0-or-later */
/* label_plan.c - what rules do to a scope, in a few numbers each. */
#include "core/array.h"
#include "score/label_score_priv.h"

#include <stdlib.h>

enum { BOTH = 3 }; /* axes that are cut */

void sg_label_plans_clear(sg_label_plans *p)
{
    free(p->rules);
    free(p->ends);
    free(p->parts);
}

/* A successor that is a stored child. */
static bool is_child(const sg_op *op)
{
    return op->kind == SG_OP_SUCCESSOR && op->child != SG_NONE;
}

/* A flat split whose parts hold a child each, with shares that the scope's length has no part in. */
static bool is_shared_out(const sg_grammar *g, const sg_rule *r)
{
    double size;
    if (!sg_rule_is_flat_split(r))
        return false;
    const bool drawn = r->ops[1].size == SG_SIZE_DRAWN;
    for (const sg_op *part = r->ops + 1; part < r->ops + r->nops; part += part->length) {
        if (!is_child(part + 1) || (part->size == SG_SIZE_DRAWN) != drawn)
            return false;
        if (!drawn && (part->size == SG_SIZE_ABSOLUTE || !sg_grammar_constant(g, part->args[0], &size)))
            return false;
    }
    return true;
}

static double *new_ends(sg_label_plans *p, size_t n)
{
    if (!SG_GROW(p->ends, p->ends_capacity, p->nends + n))
        return NULL;
    p->nends += n;
    return p->ends + p->nends - n;
}

/* Each part's child, and which copy of it: children are numbered by their first successors. */
static sg_status list_parts(sg_label_plans *p, const sg_rule *r, sg_label_plan *plan, sg_error *err)
{
    plan->part = (uint32_t)p->nparts;
    if (!SG_GROW(p->parts, p->parts_capacity, p->nparts + plan->n))
        return SG_FAIL_NOMEM(err);
    sg_label_part *const first = p->parts + p->nparts, *end = first;
    for (const sg_op *op = r->ops; op < r->ops + r->nops; op++) {
        if (!is_child(op))
            continue;
        *end = (sg_label_part){op->child, 0, 0};
        for (const sg_label_part *q = first; q < end; q++)
            end->copy += q->child == op->child;
        end++;
    }
    for (sg_label_part *a = first; a < end; a++)
        for (const sg_label_part *b = first; b < end; b++)
            a->copies += a->child == b->child;
    p->nparts += plan->n;
    return SG_OK;
}

static sg_status plan_split(sg_label_target *t, const sg_rule *r, sg_label_plan *plan, sg_error *err)
{
    const sg_op *split = r->ops;
    const bool unit = split->kind == SG_OP_SUCCESSOR;
    plan->n = unit ? 1 : split->nparts;
    plan->nparams = sg_grammar_symbol(t->g, r->lhs)->nparams;
    plan->axis = !unit && split->axis == SG_AXIS_Y;
    plan->cuts = plan->n == 1 ? 0 : (uint8_t)(1 << plan->axis);
    plan->drawn = !unit && split[1].size == SG_SIZE_DRAWN;
    if (plan->drawn) {
        plan->first = r->draws[split->draw].first_value;
    } else {
        double *ends = new_ends(&t->plans, plan->n);
        if (ends == NULL)
            return SG_FAIL_NOMEM(err);
        plan->first = (uint32_t)(ends - t->plans.ends);
        ends[0] = 1;
        if (!unit && sg_placer_constant_ends(t->g, r, split, ends) != SG_OK) {
            *plan = (sg_label_plan){.kind = SG_PLAN_BODY, .cuts = BOTH};
            return SG_OK; /* it fails wherever it is placed */
        }
    }
    plan->kind = SG_PLAN_SPLIT;
    return t->tied ? list_parts(&t->plans, r, plan, err) : SG_OK;
}

static sg_status plan_rule(sg_label_target *t, const sg_rule *r, sg_label_plan *plan, sg_error *err)
{
    *plan = (sg_label_plan){.kind = SG_PLAN_BODY, .cuts = BOTH};
    if (r->nops == 1 && r->ops[0].kind == SG_OP_SUCCESSOR && r->ops[0].child == SG_NONE)
        *plan = (sg_label_plan){.kind = SG_PLAN_LABEL, .channel = t->channel[r->ops[0].symbol]};
    else if (r->nops > 0 && ((r->nops == 1 && is_child(r->ops)) || is_shared_out(t->g, r)))
        return plan_split(t, r, plan, err);
    return SG_OK;
}

/* Axes along which the rules of a symbol cut, as known so far. */
static uint8_t cuts_of_symbol(const sg_label_target *t, sg_sym s)
{
    const sg_symbol *symbol = sg_grammar_symbol(t->g, s);
    uint8_t cuts = 0;
    for (uint32_t k = 0; k < symbol->nrules; k++)
        cuts |= t->plans.rules[symbol->first_rule + k].cuts;
    if (symbol->completion != SG_NONE)
        cuts |= t->plans.rules[symbol->completion].cuts;
    return cuts;
}

static bool add_cuts(sg_label_target *t, sg_rule_id rule)
{
    const sg_rule *r = sg_grammar_rule(t->g, rule);
    sg_label_plan *plan = t->plans.rules + rule;
    const uint8_t before = plan->cuts;
    for (const sg_op *op = r->ops; op < r->ops + r->nops; op++)
        if (is_child(op))
            plan->cuts |= cuts_of_symbol(t, op->symbol);
    return plan->cuts != before;
}

sg_status sg_label_plans_create(sg_label_target *t, sg_error *err)
{
    const size_t n = sg_grammar_rule_count(t->g);
    t->plans.open = (sg_label_plan){.kind = SG_PLAN_OPEN};
    t->plans.hole = (sg_label_plan){.kind = SG_PLAN_HOLE};
    t->plans.rules = calloc(n + 1, sizeof *t->plans.rules);
    if (t->plans.rules == NULL)
        return SG_FAIL_NOMEM(err);
    for (sg_rule_id r = 0; r < n; r++)
        SG_TRY(plan_rule(t, sg_grammar_rule(t->g, r), t->plans.rules + r, err));
    for (bool more = true; more;) {
        more = false;
        for (sg_rule_id r = 0; r < n; r++)
            more = add_cuts(t, r) || more;
    }
    return SG_OK;
}
