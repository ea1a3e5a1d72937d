/* SPDX-License-Identifier: GPL-3.0-or-later */
/* build_check.c - what only the whole grammar can tell: probabilities, unreachable and unproductive symbols; and the list of
 * warnings. */
#include "config.h"

#include "grammar/build_priv.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FAIL(b, where, ...) sg_source_fail((b)->source, (where), (b)->err, __VA_ARGS__)

/* ---- weights ---- */

static bool constant_weights(const sg_builder *b, const sg_symbol *s)
{
    double ignored;
    for (sg_rule_id r = s->first_rule; r < s->first_rule + s->nrules; r++)
        if (b->rules[r].guard != SG_NONE ||
            (b->rules[r].weight != SG_NONE && !sg_build_is_constant(b, b->rules[r].weight, &ignored)))
            return false;
    return true;
}

/* Weights of a symbol whose weights are constants; their sum, and how many of them were written down. */
static double read_weights(sg_builder *b, const sg_symbol *s, uint32_t *given)
{
    double sum = 0;
    *given = 0;
    for (sg_rule_id r = s->first_rule; r < s->first_rule + s->nrules; r++) {
        double w = 1;
        if (b->rules[r].weight != SG_NONE) {
            sg_build_is_constant(b, b->rules[r].weight, &w);
            ++*given;
        }
        b->rules[r].probability = w;
        sum += w;
    }
    return sum;
}

static sg_status check_weights(sg_builder *b, sg_symbol *s)
{
    uint32_t given = 0;
    s->constant_weights = constant_weights(b, s);
    if (!s->constant_weights)
        return SG_OK;
    const double sum = read_weights(b, s, &given);
    const sg_pos at = b->rule_at[s->first_rule];
    if (!b->ast->relative_weights && given > 0 && given < s->nrules)
        return FAIL(b, at, "only some rules of '%.60s' have a probability; expected all or none (or declare 'weights')",
                    s->name);
    if (!b->ast->relative_weights && given > 0 && !(fabs(sum - 1) <= 1e-6))
        return FAIL(b, at, "the probabilities of '%.60s' sum to %.9g, not to 1 (declare 'weights' if they are relative)",
                    s->name, sum);
    if (!(sum > 0) || !isfinite(sum))
        return FAIL(b, at, "the weights of '%.60s' sum to %g", s->name, sum);
    /* Probabilities that sum to 1 but for rounding keep their bits, so that writing and reading does not wear them. */
    if (fabs(sum - 1) > 4 * DBL_EPSILON * s->nrules)
        for (sg_rule_id r = s->first_rule; r < s->first_rule + s->nrules; r++)
            b->rules[r].probability /= sum;
    return SG_OK;
}

/* ---- which symbols a rule needs ---- */

/* A block that may be placed no time at all. */
static bool may_vanish(const sg_builder *b, const sg_op *op)
{
    double count;
    return op->kind == SG_OP_REPEAT && !(sg_build_is_constant(b, op->args[0], &count) && count >= 1);
}

/* Next successor to a non-terminal from op i on, nops when there is none; those in blocks that may vanish are skipped
 * when only `required` ones count. */
static uint32_t next_child(const sg_builder *b, const sg_rule *r, uint32_t i, bool required)
{
    while (i < r->nops) {
        const sg_op *op = &r->ops[i];
        if (op->kind == SG_OP_SUCCESSOR && b->symbols[op->symbol].kind == SG_SYMBOL_NONTERMINAL)
            return i;
        i += required && may_vanish(b, op) ? op->length : 1;
    }
    return r->nops;
}

static bool may_be_chosen(const sg_builder *b, sg_rule_id r)
{
    const sg_symbol *s = &b->symbols[b->rules[r].lhs];
    if (b->usable != NULL && !b->usable[r])
        return false;
    return !s->constant_weights || b->rules[r].probability > 0 || r == s->completion;
}

/* ---- reachable ---- */

static void reach_from_rule(const sg_builder *b, const sg_rule *r, bool *reached, sg_sym *stack, size_t *n)
{
    for (uint32_t i = next_child(b, r, 0, false); i < r->nops; i = next_child(b, r, i + 1, false)) {
        const sg_sym s = r->ops[i].symbol;
        if (!reached[s]) {
            reached[s] = true;
            stack[(*n)++] = s;
        }
    }
}

static sg_status check_reachable(sg_builder *b)
{
    bool *reached = SG_NEW_ARRAY(b->arena, bool, b->nsymbols);
    sg_sym *stack = SG_NEW_ARRAY(b->arena, sg_sym, b->nsymbols);
    if (reached == NULL || stack == NULL)
        return sg_build_fail_nomem(b);
    size_t n = 0;
    reached[b->start] = true;
    stack[n++] = b->start;
    while (n > 0) {
        const sg_symbol *s = &b->symbols[stack[--n]];
        for (sg_rule_id r = s->first_rule; r < s->first_rule + s->nrules; r++)
            reach_from_rule(b, &b->rules[r], reached, stack, &n);
        if (s->completion != SG_NONE)
            reach_from_rule(b, &b->rules[s->completion], reached, stack, &n);
    }
    for (size_t s = 0; s < b->nsymbols; s++)
        if (!reached[s] && b->symbols[s].kind == SG_SYMBOL_NONTERMINAL)
            return FAIL(b, b->symbol_at[s], "'%.60s' cannot be reached from the start symbol '%.60s'",
                        b->symbols[s].name, b->symbols[b->start].name);
    return SG_OK;
}

/* ---- productive: some choice of rules ends ---- */

typedef struct {
    uint32_t *missing;     /* [nrules] required children whose symbol is not known to be productive */
    uint32_t *first;       /* [nsymbols+1] into uses */
    sg_rule_id *uses;      /* rules that require a symbol, as often as they do */
    bool *productive;
    sg_sym *stack;
    size_t n;
} productivity;

static void found_productive(productivity *p, sg_sym s)
{
    if (p->productive[s])
        return;
    p->productive[s] = true;
    p->stack[p->n++] = s;
}

static sg_status index_uses(sg_builder *b, productivity *p)
{
    size_t total = 0;
    for (size_t r = 0; r < b->nrules; r++)
        for (uint32_t i = next_child(b, &b->rules[r], 0, true); i < b->rules[r].nops;
             i = next_child(b, &b->rules[r], i + 1, true), total++) {
            p->first[b->rules[r].ops[i].symbol + 1]++;
            p->missing[r]++;
        }
    p->uses = SG_NEW_ARRAY(b->arena, sg_rule_id, total);
    uint32_t *at = SG_NEW_ARRAY(b->arena, uint32_t, b->nsymbols);
    if (p->uses == NULL || at == NULL)
        return sg_build_fail_nomem(b);
    for (size_t s = 0; s < b->nsymbols; s++) {
        p->first[s + 1] += p->first[s];
        at[s] = p->first[s];
    }
    for (size_t r = 0; r < b->nrules; r++)
        for (uint32_t i = next_child(b, &b->rules[r], 0, true); i < b->rules[r].nops;
             i = next_child(b, &b->rules[r], i + 1, true))
            p->uses[at[b->rules[r].ops[i].symbol]++] = (sg_rule_id)r;
    return SG_OK;
}

/* With a depth limit every derivation comes to the completions at last: then these alone must end. */
static bool counts(const sg_builder *b, sg_rule_id r)
{
    return b->ast->has_limit ? r == b->symbols[b->rules[r].lhs].completion : may_be_chosen(b, r);
}

static sg_status fail_unproductive(sg_builder *b, sg_sym s)
{
    if (b->ast->has_limit)
        return FAIL(b, b->rule_at[b->symbols[s].completion], "this rule 'at limit' of '%.60s' never ends",
                    b->symbols[s].name);
    return FAIL(b, b->symbol_at[s], "'%.60s' is unproductive: no choice of its rules %sever ends", b->symbols[s].name,
                b->usable != NULL ? "that can be used " : "");
}

sg_status sg_build_check_productive(sg_builder *b)
{
    productivity p = {SG_NEW_ARRAY(b->arena, uint32_t, b->nrules),
                      SG_NEW_ARRAY(b->arena, uint32_t, b->nsymbols + 1),
                      NULL,
                      SG_NEW_ARRAY(b->arena, bool, b->nsymbols),
                      SG_NEW_ARRAY(b->arena, sg_sym, b->nsymbols),
                      0};
    if (p.missing == NULL || p.first == NULL || p.productive == NULL || p.stack == NULL)
        return sg_build_fail_nomem(b);
    SG_TRY(index_uses(b, &p));
    for (size_t s = 0; b->ast->has_limit && s < b->nsymbols; s++)
        if (b->symbols[s].completion == SG_NONE) /* the empty body */
            found_productive(&p, (sg_sym)s);
    for (size_t r = 0; r < b->nrules; r++)
        if (p.missing[r] == 0 && counts(b, (sg_rule_id)r))
            found_productive(&p, b->rules[r].lhs);
    while (p.n > 0) {
        const sg_sym s = p.stack[--p.n];
        for (uint32_t i = p.first[s]; i < p.first[s + 1]; i++)
            if (--p.missing[p.uses[i]] == 0 && counts(b, p.uses[i]))
                found_productive(&p, b->rules[p.uses[i]].lhs);
    }
    for (size_t s = 0; s < b->nsymbols; s++)
        if (!p.productive[s] && b->symbols[s].kind == SG_SYMBOL_NONTERMINAL)
            return fail_unproductive(b, (sg_sym)s);
    return SG_OK;
}

sg_status sg_build_check(sg_builder *b)
{
    for (size_t s = 0; s < b->nsymbols; s++)
        if (b->symbols[s].kind == SG_SYMBOL_NONTERMINAL)
            SG_TRY(check_weights(b, &b->symbols[s]));
    SG_TRY(check_reachable(b));
    return sg_build_check_productive(b);
}

/* ---- warnings ---- */

sg_status sg_build_warn(sg_builder *b, sg_pos at, const char *format, ...)
{
    char sentence[480], message[1024];
    for (size_t i = 0; i < b->nwarnings; i++) /* one example for a place is enough */
        if (b->warned_at[i].offset == at.offset)
            return SG_OK;
    if (b->nwarnings >= SG_MAX_WARNINGS)
        return SG_OK;
    va_list ap;
    va_start(ap, format);
    vsnprintf(sentence, sizeof sentence, format, ap);
    va_end(ap);
    sg_source_warning(b->source, at, message, sizeof message, sentence);
    b->warned_at[b->nwarnings] = at;
    b->warnings[b->nwarnings] = sg_arena_string(b->arena, message);
    return b->warnings[b->nwarnings] != NULL ? (b->nwarnings++, SG_OK) : sg_build_fail_nomem(b);
}
