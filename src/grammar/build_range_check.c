/* SPDX-License-Identifier: GPL-3.0-or-later */
/* build_range_check.c - what ranges of values tell. An error is what fails for all values that can come there; a warning
 * what never comes to use. What may fail for some is left to examples (build_examples.c). */
#include "config.h"

#include "grammar/build_range_priv.h"
#include "grammar/distribution_priv.h"
#include "grammar/shape_ops.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define FAIL(w, where, ...) sg_source_fail((w)->b->source, (where), (w)->b->err, __VA_ARGS__)

static sg_pos at_of(const sg_ranges *w, sg_expr e, const sg_rule *r)
{
    const sg_pos at = w->b->code_at[e];
    return at.line != 0 || r == NULL ? at : w->b->rule_at[r - w->g->rules];
}

/* ---- ranges in words ---- */

static void say_range(sg_interval x, char *out, size_t size)
{
    if (!sg_interval_has_number(x))
        snprintf(out, size, "no number");
    else if (x.low == x.high)
        snprintf(out, size, "%g", x.low);
    else if (isinf(x.low) && isinf(x.high))
        snprintf(out, size, "any number");
    else if (isinf(x.high))
        snprintf(out, size, "%g or more", x.low);
    else if (isinf(x.low))
        snprintf(out, size, "%g or less", x.high);
    else
        snprintf(out, size, "from %g to %g", x.low, x.high);
}

static bool uses(const sg_grammar *g, sg_expr e, sg_operand wanted)
{
    const sg_code *code = &g->codes[e];
    bool found = code->result == wanted;
    for (uint32_t i = code->first; i < code->first + code->n; i++) {
        const sg_instruction *in = &g->instructions[i];
        found |= in->a == wanted || in->b == wanted || in->c == wanted;
    }
    return found;
}

/* ", as x is from 1 to 4 and y is 2": parameters of s that the expression uses, the first few. */
static void say_why(const sg_ranges *w, sg_sym s, sg_expr e, char *out, size_t size)
{
    enum { MANY = 3 };
    const sg_symbol *symbol = &w->g->symbols[s];
    size_t n = 0;
    int said = 0;
    out[0] = '\0';
    for (uint32_t i = 0; i <= symbol->nparams && said < MANY && n < size; i++) {
        const bool depth = i == symbol->nparams;
        char range[80];
        if (!uses(w->g, e, depth ? SG_OPERAND(SG_IN_DEPTH, 0) : SG_OPERAND(SG_IN_FRAME, i)))
            continue;
        say_range(depth ? w->ranges[s].depth : w->ranges[s].params[i], range, sizeof range);
        n += (size_t)snprintf(out + n, size - n, "%s%.30s is %s", said++ == 0 ? ", as " : " and ",
                              depth ? "depth" : symbol->params[i], range);
    }
}

/* ---- guards ---- */

/* Does a guard hold for any parameters at all, wherever they come from? */
static bool is_contradiction(sg_ranges *w, sg_sym s, sg_expr guard)
{
    const double limit = w->g->depth_limit == SIZE_MAX ? INFINITY : (double)w->g->depth_limit;
    for (uint32_t i = 0; i < w->g->symbols[s].nparams; i++)
        w->f.slots[i] = sg_interval_between(-INFINITY, INFINITY);
    w->f.depth = sg_interval_between(0, limit);
    return !sg_interval_assume(&w->f, guard);
}

static sg_status check_guards(sg_ranges *w, sg_sym s)
{
    const sg_symbol *symbol = &w->g->symbols[s];
    char why[320];
    bool any = false;
    for (sg_rule_id r = symbol->first_rule; r < symbol->first_rule + symbol->nrules; r++) {
        const sg_expr guard = w->g->rules[r].guard;
        if (guard != SG_NONE && !w->b->code_tuned[guard] && is_contradiction(w, s, guard))
            return FAIL(w, at_of(w, guard, NULL), "this guard can never hold");
        any |= sg_ranges_enter(w, s, r);
    }
    if (!sg_ranges_above_limit(w, s))
        return SG_OK;
    if (!any) { /* all of them have guards */
        say_why(w, s, w->g->rules[symbol->first_rule].guard, why, sizeof why);
        return FAIL(w, w->b->symbol_at[s], "no guard of '%.60s' ever holds%s", symbol->name, why);
    }
    for (sg_rule_id r = symbol->first_rule; r < symbol->first_rule + symbol->nrules; r++) {
        if (sg_ranges_enter(w, s, r) || w->b->code_tuned[w->g->rules[r].guard])
            continue;
        say_why(w, s, w->g->rules[r].guard, why, sizeof why);
        SG_TRY(sg_build_warn(w->b, at_of(w, w->g->rules[r].guard, NULL), "this guard never holds%s", why));
    }
    return SG_OK;
}

/* ---- weights ---- */

static sg_status check_weight(sg_ranges *w, const sg_rule *r, sg_interval weight)
{
    if (!sg_interval_has_number(weight))
        return FAIL(w, at_of(w, r->weight, r), "the weight is never a number");
    if (weight.high < 0)
        return FAIL(w, at_of(w, r->weight, r), "the weight is always negative: it is %g at most", weight.high);
    if (weight.low == INFINITY)
        return FAIL(w, at_of(w, r->weight, r), "the weight is never finite");
    w->suspect |= weight.nan || weight.low < 0 || weight.high == INFINITY;
    return SG_OK;
}

/* Some rule is sure to be possible: its guard holds and its weight is above 0 wherever the symbol stands. */
static bool is_sure(sg_ranges *w, sg_sym s, sg_rule_id r)
{
    const sg_rule *rule = &w->g->rules[r];
    memcpy(w->f.slots, w->ranges[s].params, w->g->symbols[s].nparams * sizeof *w->f.slots);
    w->f.depth = w->ranges[s].depth;
    const bool holds = rule->guard == SG_NONE || (!sg_interval_can_fail(sg_interval_eval(&w->f, rule->guard)) &&
                                                  !sg_interval_eval(&w->f, rule->guard).nan);
    return holds && sg_ranges_weight(w, rule).low > 0;
}

static sg_status check_weights(sg_ranges *w, sg_sym s)
{
    const sg_symbol *symbol = &w->g->symbols[s];
    bool positive = false, sure = false;
    for (sg_rule_id r = symbol->first_rule; r < symbol->first_rule + symbol->nrules; r++) {
        sure = sure || is_sure(w, s, r);
        if (!sg_ranges_enter(w, s, r))
            continue;
        const sg_interval weight = sg_ranges_weight(w, &w->g->rules[r]);
        SG_TRY(check_weight(w, &w->g->rules[r], weight));
        positive |= weight.high > 0;
    }
    w->suspect |= !sure;
    return positive ? SG_OK
                    : FAIL(w, w->b->rule_at[symbol->first_rule], "the weights of '%.60s' are always zero", symbol->name);
}

/* ---- bodies ---- */

static sg_status check_draw(sg_ranges *w, const sg_rule *r, const sg_draw *d)
{
    uint32_t arg = 0;
    if (d->nargs == 0 || d->constants != NULL)
        return SG_OK;
    const char *complaint = sg_interval_draw_complaint(&w->f, d, &arg);
    if (complaint != NULL)
        return FAIL(w, at_of(w, d->args[arg < d->nargs ? arg : 0], r), "%s: %s", sg_distribution_name(d->kind), complaint);
    w->suspect |= !sg_interval_draw_is_safe(&w->f, d);
    return SG_OK;
}

/* A number that must lie from low to high. */
static sg_status check_number(sg_ranges *w, const sg_rule *r, sg_expr e, double low, double high, const char *what)
{
    const sg_interval x = sg_interval_eval(&w->f, e);
    if (sg_interval_is_none(x)) /* after a draw that has no values */
        return SG_OK;
    if (!sg_interval_has_number(x))
        return FAIL(w, at_of(w, e, r), "%s is never a number", what);
    if (x.high < low)
        return FAIL(w, at_of(w, e, r), "%s is always too small: it is %g at most", what, x.high);
    if (x.low > high)
        return FAIL(w, at_of(w, e, r), "%s is always too large: it is %g at least", what, x.low);
    w->suspect |= x.nan || x.low < low || x.high > high;
    return SG_OK;
}

static sg_status check_shape(sg_ranges *w, const sg_rule *r, const sg_op *op)
{
    if (op->shape == SG_SHAPE_COMPONENTS)
        return SG_OK;
    const sg_shape_info *info = sg_shape_op_info((sg_shape_op)op->shape);
    for (uint32_t k = 0; k < op->nargs; k++)
        if (info->args[k] == 'n')
            SG_TRY(check_number(w, r, op->args[k], -HUGE_VAL, HUGE_VAL, "this argument"));
    return SG_OK;
}

static sg_status check_op(sg_ranges *w, const sg_rule *r, const sg_op *op)
{
    switch (op->kind) {
    case SG_OP_SUCCESSOR:
        for (uint32_t k = 0; k < op->nargs; k++) {
            const bool chance = k == 0 && w->chancy[op->symbol];
            SG_TRY(check_number(w, r, op->args[k], chance ? 0 : -HUGE_VAL, chance ? 1 : HUGE_VAL,
                                chance ? "the probability" : "this argument"));
        }
        return SG_OK;
    case SG_OP_REPEAT: /* -0.5 is rounded away from 0 */
        return check_number(w, r, op->args[0], nextafter(-0.5, 0), nextafter(SG_MAX_REPEAT + 0.5, 0), "the repeat count");
    case SG_OP_PART:
        return op->nargs > 0 ? check_number(w, r, op->args[0], 0, HUGE_VAL, "the size of this part") : SG_OK;
    case SG_OP_SHAPE:
        return check_shape(w, r, op);
    case SG_OP_SPLIT:
    case SG_OP_PUSH:
        break;
    }
    return SG_OK;
}

static sg_status check_body(sg_ranges *w, sg_sym s, sg_rule_id r)
{
    const sg_rule *rule = &w->g->rules[r];
    if (!sg_ranges_use(w, s, r))
        return SG_OK;
    for (uint32_t i = 0; i < rule->ndraws; i++)
        SG_TRY(check_draw(w, rule, &rule->draws[i]));
    for (uint32_t i = 0; i < rule->nops; i++)
        SG_TRY(check_op(w, rule, &rule->ops[i]));
    return SG_OK;
}

/* ---- all ---- */

static sg_status check_symbol(sg_ranges *w, sg_sym s)
{
    const sg_symbol *symbol = &w->g->symbols[s];
    if (symbol->kind == SG_SYMBOL_LABEL || symbol->hidden) /* `maybe` is looked at where it stands */
        return SG_OK;
    if (!w->ranges[s].reached && w->switched)
        return SG_OK;
    if (!w->ranges[s].reached)
        return sg_build_warn(w->b, w->b->symbol_at[s], "nothing that can be used leads to '%.60s'", symbol->name);
    SG_TRY(check_guards(w, s));
    if (!symbol->constant_weights && sg_ranges_above_limit(w, s))
        SG_TRY(check_weights(w, s));
    for (uint32_t i = 0; i < symbol->nrules; i++)
        SG_TRY(check_body(w, s, symbol->first_rule + i));
    return symbol->completion != SG_NONE ? check_body(w, s, symbol->completion) : SG_OK;
}

/* With what is known now, can every symbol still end? */
static sg_status check_endings(sg_ranges *w)
{
    bool *usable = SG_NEW_ARRAY(w->arena, bool, w->g->nrules);
    if (usable == NULL)
        return sg_build_fail_nomem(w->b);
    for (size_t r = 0; r < w->g->nrules; r++) {
        const sg_sym s = w->g->rules[r].lhs;
        usable[r] = !w->ranges[s].reached || sg_ranges_use(w, s, (sg_rule_id)r);
    }
    w->b->usable = usable;
    const sg_status st = w->g->depth_limit == SIZE_MAX ? sg_build_check_productive(w->b) : SG_OK;
    w->b->usable = NULL;
    return st;
}

static bool is_tuned(const sg_ranges *w, sg_expr e)
{
    return e != SG_NONE && w->b->code_tuned[e];
}

/* Is a rule out of use because of what constants are? A grammar may have switches. */
static bool has_switch(sg_ranges *w)
{
    for (size_t r = 0; r < w->g->nrules; r++) {
        const sg_rule *rule = &w->g->rules[r];
        if ((is_tuned(w, rule->guard) || is_tuned(w, rule->weight)) && w->ranges[rule->lhs].reached &&
            !sg_ranges_use(w, rule->lhs, (sg_rule_id)r))
            return true;
    }
    return false;
}

sg_status sg_ranges_check(sg_ranges *w)
{
    w->switched = has_switch(w);
    for (size_t s = 0; s < w->g->nsymbols; s++)
        SG_TRY(check_symbol(w, (sg_sym)s));
    return check_endings(w);
}

/* Expressions that depend on nothing were looked at when they were compiled. */
static bool has_variables(const sg_grammar *g)
{
    for (size_t i = 0; i < g->ncodes; i++)
        if (SG_OPERAND_SPACE(g->codes[i].result) != SG_IN_CONSTANTS)
            return true;
    for (size_t r = 0; r < g->nrules; r++)
        if (g->rules[r].guard != SG_NONE || (g->symbols[g->rules[r].lhs].constant_weights && g->rules[r].probability == 0))
            return true;
    return false;
}

sg_status sg_build_examine(sg_builder *b, const sg_grammar *g)
{
    if (!has_variables(g))
        return SG_OK;
    sg_arena *arena = sg_arena_create();
    if (arena == NULL)
        return sg_build_fail_nomem(b);
    sg_ranges w;
    sg_status st = sg_ranges_find(&w, b, g, arena);
    if (st == SG_OK)
        st = sg_ranges_check(&w);
    const bool suspect = w.suspect;
    sg_ranges_clear(&w);
    if (st == SG_OK && suspect)
        st = sg_build_try_examples(b, g, arena);
    sg_arena_free(arena);
    return st;
}
