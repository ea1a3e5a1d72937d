/* SPDX-License-Identifier: GPL-3.0-or-later */
/* build_hidden.c - symbols that nobody wrote, but that bodies ask for.
 *
 * A label in a split stands for a hidden symbol with the one rule "-> label" (also at the depth limit). `maybe(p) X(...)`
 * is a hidden symbol with the rules X(...) (p) and the empty body (1 - p); its parameters are those of X, behind the
 * probability itself unless that is a constant. Equal ones are one symbol. */
#include "config.h"

#include "core/array.h"
#include "grammar/build_priv.h"
#include "grammar/number.h"

#include <string.h>

static sg_status add_hidden(sg_builder *b, const sg_symbol *s, sg_hidden h, const char *key, sg_pos at, sg_sym *out)
{
    if (key == NULL || !SG_GROW(b->hidden, b->hidden_capacity, b->nhidden + 1))
        return sg_build_fail_nomem(b);
    SG_TRY(sg_build_symbol(b, s, at, out));
    h.symbol = *out;
    b->hidden[b->nhidden++] = h;
    return sg_names_put(&b->hidden_names, key, *out) ? SG_OK : sg_build_fail_nomem(b);
}

sg_status sg_build_lexical(sg_builder *b, sg_sym label, sg_sym *out)
{
    const sg_mark mark = sg_arena_mark(b->arena);
    const char *key = sg_arena_printf(b->arena, "label %s", b->symbols[label].name);
    *out = key != NULL ? sg_names_get(&b->hidden_names, key) : SG_NONE;
    if (*out != SG_NONE) {
        sg_arena_rewind(b->arena, mark);
        return SG_OK;
    }
    sg_symbol s = SG_BLANK_SYMBOL;
    s.name = b->symbols[label].name;
    s.hidden = true;
    const sg_hidden h = {SG_NONE, label, false, true, 1};
    return add_hidden(b, &s, h, key, b->symbol_at[label], out);
}

/* [probability,] parameters of the target. */
static const char *const *optional_params(sg_builder *b, const sg_symbol *target, bool constant)
{
    const char **params = SG_NEW_ARRAY(b->arena, const char *, target->nparams + 1);
    uint32_t n = 0;
    if (params == NULL)
        return NULL;
    if (!constant)
        params[n++] = "probability";
    for (uint32_t i = 0; i < target->nparams; i++)
        params[n++] = target->params[i];
    return params;
}

sg_status sg_build_optional(sg_builder *b, sg_sym target, bool constant, double probability, sg_pos at, sg_sym *out)
{
    char number[SG_NUMBER_SIZE];
    const char *name = constant ? sg_arena_printf(b->arena, "maybe(%s) %s", sg_number_format(probability, number),
                                                  b->symbols[target].name)
                                : sg_arena_printf(b->arena, "maybe %s", b->symbols[target].name);
    if (name == NULL)
        return sg_build_fail_nomem(b);
    *out = sg_names_get(&b->hidden_names, name);
    if (*out != SG_NONE)
        return SG_OK;
    sg_symbol s = SG_BLANK_SYMBOL;
    s.name = name;
    s.hidden = true;
    s.params = optional_params(b, &b->symbols[target], constant);
    s.nparams = b->symbols[target].nparams + !constant;
    if (s.params == NULL)
        return sg_build_fail_nomem(b);
    const sg_hidden h = {SG_NONE, target, true, constant, probability};
    return add_hidden(b, &s, h, name, at, out);
}

/* The rule of a hidden symbol that places its target, with the parameters from `skip` on as arguments. */
static sg_status hidden_body(sg_builder *b, sg_sym target, uint32_t skip, sg_rule *r)
{
    const sg_symbol *t = &b->symbols[target];
    sg_op *op = SG_NEW(b->arena, sg_op);
    sg_expr *args = SG_NEW_ARRAY(b->arena, sg_expr, t->nparams);
    if (op == NULL || args == NULL)
        return sg_build_fail_nomem(b);
    for (uint32_t i = 0; i < t->nparams; i++)
        SG_TRY(sg_build_slot(b, skip + i, &args[i]));
    const bool is_label = t->kind == SG_SYMBOL_LABEL;
    op->kind = SG_OP_SUCCESSOR;
    op->length = 1;
    op->nargs = t->nparams;
    op->args = args;
    op->symbol = target;
    op->child = is_label ? SG_NONE : 0;
    op->draw = SG_NONE;
    r->nops = 1;
    r->ops = op;
    r->nchildren = !is_label;
    return SG_OK;
}

static sg_status build_one(sg_builder *b, const sg_hidden *h)
{
    const sg_pos at = b->symbol_at[h->symbol];
    const uint32_t skip = h->optional && !h->constant;
    sg_rule r, empty;
    memset(&r, 0, sizeof r);
    r.lhs = h->symbol;
    r.guard = r.weight = SG_NONE;
    empty = r;
    if (h->optional && h->constant) {
        SG_TRY(sg_build_constant(b, h->probability, &r.weight));
        SG_TRY(sg_build_constant(b, 1 - h->probability, &empty.weight));
    } else if (h->optional) {
        SG_TRY(sg_build_slot(b, 0, &r.weight));
        SG_TRY(sg_build_complement(b, 0, &empty.weight));
    }
    SG_TRY(hidden_body(b, h->target, skip, &r));
    b->symbols[h->symbol].first_rule = (sg_rule_id)b->nrules;
    b->symbols[h->symbol].nrules = h->optional ? 2 : 1;
    if (!h->optional) /* a label stays what it is at the depth limit */
        b->symbols[h->symbol].completion = (sg_rule_id)b->nrules;
    SG_TRY(sg_build_rule(b, &r, at));
    return h->optional ? sg_build_rule(b, &empty, at) : SG_OK;
}

sg_status sg_build_hidden(sg_builder *b)
{
    for (size_t i = 0; i < b->nhidden; i++)
        SG_TRY(build_one(b, &b->hidden[i]));
    for (size_t i = 0; i < b->nhidden; i++) {
        const sg_hidden *h = &b->hidden[i];
        const char *name = b->symbols[h->symbol].name;
        if (h->optional && sg_names_get(&b->symbol_names, name) == SG_NONE &&
            !sg_names_put(&b->symbol_names, name, h->symbol))
            return sg_build_fail_nomem(b);
    }
    return SG_OK;
}
