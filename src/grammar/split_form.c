/* SPDX-License-Identifier: GPL-3.0-or-later */
/* split_form.c - from a grammar to the split form. The language cuts y bottom to top, the form top to bottom: the order
 * of parts, sizes, examples, means and covariances is reversed here. */
#include "config.h"

#include "grammar/grammar_priv.h"
#include "grammar/split_priv.h"

#include <string.h>

typedef struct {
    const sg_grammar *g;
    sg_arena *arena;
    uint32_t *number; /* of a symbol among the non-terminals or among the terminals */
    sg_error *err;
} converter;

static sg_status too_much(const converter *c, const sg_rule *r, const char *what)
{
    const char *name = c->g->symbols[r->lhs].name;
    if (r->line == 0)
        return SG_FAIL(c->err, SG_EINPUT, "%.250s: error: no split grammar: rule of %.60s: %s", c->g->source, name, what);
    return SG_FAIL(c->err, SG_EINPUT, "%.250s:%u: error: no split grammar: rule of %.60s: %s", c->g->source, r->line,
                   name, what);
}

/* The one non-terminal of a part; false when it holds anything else. */
static bool part_symbol(const sg_grammar *g, const sg_op *part, sg_sym *symbol)
{
    const sg_op *child = part + 1;
    *symbol = SG_NONE;
    if (part->length != 2 || child->kind != SG_OP_SUCCESSOR || child->nargs != 0)
        return false;
    *symbol = child->symbol;
    return g->symbols[child->symbol].kind == SG_SYMBOL_NONTERMINAL;
}

static bool floats_equally(const sg_grammar *g, const sg_op *part)
{
    double size;
    return part->size == SG_SIZE_DRAWN ||
           (part->size == SG_SIZE_FLOATING && sg_grammar_constant(g, part->args[0], &size) && size == 1);
}

static sg_status convert_parts(const converter *c, const sg_rule *r, sg_split_rule *out)
{
    const sg_op *split = r->ops;
    uint32_t *rhs = SG_NEW_ARRAY(c->arena, uint32_t, split->nparts);
    if (rhs == NULL)
        return SG_FAIL_NOMEM(c->err);
    const bool reverse = split->axis == SG_AXIS_Y;
    uint32_t n = 0;
    for (uint32_t i = 1; i < split->length; i += r->ops[i].length, n++) {
        sg_sym symbol;
        if (!part_symbol(c->g, &r->ops[i], &symbol))
            return too_much(c, r, "a part that is not one symbol without arguments");
        if (!floats_equally(c->g, &r->ops[i]))
            return too_much(c, r, "sizes that are neither drawn nor equal");
        rhs[reverse ? split->nparts - 1 - n : n] = c->number[symbol];
    }
    out->n = n;
    out->rhs = rhs;
    return SG_OK;
}

static void copy_row(double *to, const double *from, size_t n, bool reverse)
{
    for (size_t i = 0; i < n; i++)
        to[i] = from[reverse ? n - 1 - i : i];
}

/* Element of the covariance of all k sizes, the last of which is what the others leave. */
static double full_covariance(size_t k, const double *covariance, size_t i, size_t j)
{
    const size_t n = k - 1;
    double sum = 0;
    if (i < n && j < n)
        return covariance[i * n + j];
    if (i < n || j < n) {
        const size_t row = i < n ? i : j;
        for (size_t c = 0; c < n; c++)
            sum -= covariance[row * n + c];
        return sum;
    }
    for (size_t e = 0; e < n * n; e++)
        sum += covariance[e];
    return sum;
}

void sg_split_turn_covariance(size_t k, const double *covariance, bool reverse, double *out)
{
    const size_t n = k - 1;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j <= i; j++)
            out[i * n + j] = out[j * n + i] = reverse ? full_covariance(k, covariance, k - 1 - i, k - 1 - j)
                                                      : covariance[i * n + j];
}

static sg_status convert_sizes(const converter *c, const sg_rule *r, sg_split_rule *out)
{
    const sg_op *split = r->ops;
    const bool reverse = split->axis == SG_AXIS_Y;
    const size_t k = out->n;
    if (r->nattributes > 0) {
        double *attributes = SG_NEW_ARRAY(c->arena, double, r->nattributes * k);
        if (attributes == NULL)
            return SG_FAIL_NOMEM(c->err);
        for (size_t i = 0; i < r->nattributes; i++)
            copy_row(attributes + i * k, r->attributes + i * k, k, reverse);
        out->nattributes = r->nattributes;
        out->attributes = attributes;
    }
    if (split->draw == SG_NONE)
        return SG_OK;
    const sg_simplex *simplex = r->draws[split->draw].simplex;
    double *mean = SG_NEW_ARRAY(c->arena, double, k);
    double *covariance = SG_NEW_ARRAY(c->arena, double, (k - 1) * (k - 1));
    if (mean == NULL || covariance == NULL)
        return SG_FAIL_NOMEM(c->err);
    copy_row(mean, sg_simplex_mean(simplex), k, reverse);
    sg_split_turn_covariance(k, sg_simplex_covariance(simplex), reverse, covariance);
    out->mean = mean;
    out->covariance = covariance;
    return SG_OK;
}

static sg_status convert_body(const converter *c, const sg_rule *r, sg_split_rule *out)
{
    const sg_op *op = r->ops;
    if (r->nops == 1 && op->kind == SG_OP_SUCCESSOR && op->nargs == 0) {
        const bool lexical = c->g->symbols[op->symbol].kind == SG_SYMBOL_LABEL;
        uint32_t *rhs = SG_NEW(c->arena, uint32_t);
        if (rhs == NULL)
            return SG_FAIL_NOMEM(c->err);
        *rhs = c->number[op->symbol];
        out->op = lexical ? SG_SPLIT_LEXICAL : SG_SPLIT_X; /* a bare symbol is a split into one part */
        out->n = 1;
        out->rhs = rhs;
        return SG_OK;
    }
    if (r->nops == 0 || op->kind != SG_OP_SPLIT || op->length != r->nops)
        return too_much(c, r, "a body that is not one split or one label");
    if (op->axis == SG_AXIS_Z)
        return too_much(c, r, "a split along z");
    out->op = op->axis == SG_AXIS_X ? SG_SPLIT_X : SG_SPLIT_Y;
    SG_TRY(convert_parts(c, r, out));
    return convert_sizes(c, r, out);
}

static sg_status convert_rule(const converter *c, sg_rule_id id, sg_split_rule *out)
{
    const sg_rule *r = &c->g->rules[id];
    out->lhs = c->number[r->lhs];
    out->probability = r->probability;
    out->source = id;
    return convert_body(c, r, out);
}

static sg_status check_symbol(const converter *c, const sg_symbol *s)
{
    const sg_rule *r = &c->g->rules[s->first_rule];
    if (s->nparams > 0)
        return too_much(c, r, "parameters");
    if (!s->constant_weights)
        return too_much(c, r, "a guard, or a weight that is not constant");
    if (s->completion != SG_NONE && !s->hidden)
        return too_much(c, r, "a rule for the depth limit");
    return SG_OK;
}

static sg_status list_symbols(const converter *c, sg_split_form *out)
{
    const sg_grammar *g = c->g;
    const char **names = SG_NEW_ARRAY(c->arena, const char *, g->nsymbols);
    const char **terminals = SG_NEW_ARRAY(c->arena, const char *, g->nsymbols);
    uint32_t *colors = SG_NEW_ARRAY(c->arena, uint32_t, g->nsymbols);
    if (names == NULL || terminals == NULL || colors == NULL)
        return SG_FAIL_NOMEM(c->err);
    for (size_t s = 0; s < g->nsymbols; s++) {
        if (g->symbols[s].kind == SG_SYMBOL_LABEL) {
            c->number[s] = (uint32_t)out->nterminals;
            colors[out->nterminals] = g->symbols[s].color;
            terminals[out->nterminals++] = g->symbols[s].name;
        } else {
            SG_TRY(check_symbol(c, &g->symbols[s]));
            c->number[s] = (uint32_t)out->nsymbols;
            names[out->nsymbols++] = g->symbols[s].name;
        }
    }
    out->symbol_names = names;
    out->terminal_names = terminals;
    out->terminal_colors = colors;
    return SG_OK;
}

sg_status sg_split_form_of(const sg_grammar *g, sg_arena *arena, sg_split_form *out, sg_error *err)
{
    memset(out, 0, sizeof *out);
    const converter c = {g, arena, SG_NEW_ARRAY(arena, uint32_t, g->nsymbols), err};
    sg_split_rule *rules = SG_NEW_ARRAY(arena, sg_split_rule, g->nrules);
    if (c.number == NULL || rules == NULL)
        return SG_FAIL_NOMEM(err);
    if (g->depth_limit != SIZE_MAX)
        return SG_FAIL(err, SG_EINPUT, "%.250s: error: no split grammar: it has a depth limit", g->source);
    SG_TRY(list_symbols(&c, out));
    size_t n = 0;
    for (size_t s = 0; s < g->nsymbols; s++)
        for (uint32_t i = 0; i < g->symbols[s].nrules; i++)
            SG_TRY(convert_rule(&c, g->symbols[s].first_rule + i, &rules[n++]));
    out->name = g->name;
    out->axiom = c.number[g->start];
    out->tied = g->tied;
    out->nrules = n;
    out->rules = rules;
    return SG_OK;
}
