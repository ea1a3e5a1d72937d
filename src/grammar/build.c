/* SPDX-License-Identifier: GPL-3.0-or-later */
/* build.c - from the syntax tree to the grammar: names are declared, rules compiled symbol by symbol, then the hidden
 * symbols that their bodies asked for get their rules (build_hidden.c). */
#include "config.h"

#include "core/array.h"
#include "grammar/build_priv.h"
#include "grammar/distribution_priv.h"
#include "grammar/label_color.h"
#include "grammar/number.h"
#include "grammar/shape_ops.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FAIL(b, where, ...) sg_source_fail((b)->source, (where), (b)->err, __VA_ARGS__)



sg_status sg_build_symbol(sg_builder *b, const sg_symbol *s, sg_pos at, sg_sym *out)
{
    if (b->nsymbols >= SG_NONE - 1)
        return FAIL(b, at, "too many symbols");
    if (!SG_GROW(b->symbols, b->symbols_capacity, b->nsymbols + 1) ||
        !SG_GROW(b->symbol_at, b->symbol_at_capacity, b->nsymbols + 1))
        return sg_build_fail_nomem(b);
    *out = (sg_sym)b->nsymbols;
    b->symbols[b->nsymbols] = *s;
    b->symbols[b->nsymbols].line = at.line;
    b->symbols[b->nsymbols].file = sg_source_imported(b->source, at);
    b->symbol_at[b->nsymbols++] = at;
    return SG_OK;
}

sg_status sg_build_rule(sg_builder *b, const sg_rule *r, sg_pos at)
{
    if (b->nrules >= SG_NONE - 1)
        return FAIL(b, at, "too many rules");
    if (!SG_GROW(b->rules, b->rules_capacity, b->nrules + 1) ||
        !SG_GROW(b->rule_at, b->rule_at_capacity, b->nrules + 1))
        return sg_build_fail_nomem(b);
    b->rules[b->nrules] = *r;
    b->rules[b->nrules].line = at.line;
    b->rules[b->nrules].file = sg_source_imported(b->source, at);
    b->rule_at[b->nrules++] = at;
    return SG_OK;
}

static sg_status put(sg_builder *b, sg_names *map, const char *name, uint32_t value)
{
    return sg_names_put(map, name, value) ? SG_OK : sg_build_fail_nomem(b);
}

sg_status sg_build_string(sg_builder *b, const char *s, uint32_t *index)
{
    *index = sg_names_get(&b->string_names, s);
    if (*index != UINT32_MAX)
        return SG_OK;
    if (!SG_GROW(b->strings, b->strings_capacity, b->nstrings + 1))
        return sg_build_fail_nomem(b);
    *index = (uint32_t)b->nstrings;
    b->strings[b->nstrings++] = s;
    return put(b, &b->string_names, s, *index);
}

/* ---- declarations ---- */

static sg_status check_params(sg_builder *b, const sg_ast_names *params)
{
    if (params->n > SG_MAX_PARAMS)
        return FAIL(b, params->first->at, "more than %d parameters", SG_MAX_PARAMS);
    for (const sg_ast_name *n = params->first; n != NULL; n = n->next) {
        if (sg_build_is_reserved(n->name))
            return FAIL(b, n->at, "'%s' has a meaning of its own and cannot be a parameter", n->name);
        for (const sg_ast_name *m = params->first; m != n; m = m->next)
            if (strcmp(m->name, n->name) == 0)
                return FAIL(b, n->at, "parameter '%.60s' a second time", n->name);
    }
    return SG_OK;
}

static const char *const *names_array(sg_arena *arena, const sg_ast_names *names)
{
    const char **array = SG_NEW_ARRAY(arena, const char *, names->n);
    uint32_t i = 0;
    if (array != NULL)
        for (const sg_ast_name *n = names->first; n != NULL; n = n->next)
            array[i++] = n->name;
    return array;
}

static const sg_symbol blank_symbol = SG_BLANK_SYMBOL;

static sg_status declare_nonterminal(sg_builder *b, const sg_ast_rule *r)
{
    const sg_sym old = sg_names_get(&b->symbol_names, r->name);
    SG_TRY(check_params(b, &r->params));
    if (old != SG_NONE) {
        const sg_symbol *s = &b->symbols[old];
        return s->nparams == r->params.n
                   ? SG_OK
                   : FAIL(b, r->at, "%.60s has %u parameter%s here and %u in line %u", r->name, r->params.n,
                          r->params.n == 1 ? "" : "s", s->nparams, s->line);
    }
    if (r->params.n > 0 && sg_shape_op_find(r->name) != SG_SHAPE_COUNT)
        return FAIL(b, r->at, "'%s' is a shape operation; expected another name for a symbol with parameters", r->name);
    sg_symbol s = blank_symbol;
    s.name = r->name;
    s.nparams = r->params.n;
    s.params = names_array(b->arena, &r->params);
    if (s.params == NULL)
        return sg_build_fail_nomem(b);
    sg_sym id = SG_NONE;
    SG_TRY(sg_build_symbol(b, &s, r->at, &id));
    return put(b, &b->symbol_names, r->name, id);
}

static sg_status declare_labels(sg_builder *b)
{
    uint32_t n = 0;
    for (const sg_ast_label *l = b->ast->labels; l != NULL; l = l->next, n++) {
        const sg_sym old = sg_names_get(&b->symbol_names, l->name);
        if (old != SG_NONE)
            return FAIL(b, l->at, "'%.60s' was declared before, in line %u", l->name, b->symbols[old].line);
        sg_symbol s = blank_symbol;
        s.name = l->name;
        s.kind = SG_SYMBOL_LABEL;
        s.color = l->has_color ? l->color : sg_label_color(n);
        sg_sym id = SG_NONE;
        SG_TRY(sg_build_symbol(b, &s, l->at, &id));
        SG_TRY(put(b, &b->symbol_names, l->name, id));
    }
    return SG_OK;
}

static sg_status declare_materials(sg_builder *b)
{
    for (const sg_ast_label *m = b->ast->materials; m != NULL; m = m->next) {
        if (sg_names_get(&b->material_names, m->name) != UINT32_MAX)
            return FAIL(b, m->at, "material '%.60s' was declared before", m->name);
        SG_TRY(put(b, &b->material_names, m->name, m->color));
    }
    return SG_OK;
}

static sg_status define_constant(sg_builder *b, const sg_ast_definition *d)
{
    const sg_scope scope = {NULL, 0, NULL, true, "a constant", NULL, NULL};
    sg_expr e = 0;
    double ignored;
    SG_TRY(sg_build_expr(b, &scope, d->value, &e));
    if (!sg_build_is_constant(b, e, &ignored))
        return FAIL(b, d->value->at, "the value of '%.60s' is not constant", d->name);
    return put(b, &b->constant_names, d->name, SG_OPERAND_INDEX(b->codes[e].result));
}

/* A function is compiled once by itself, its parameters in a frame, so that errors in it are found even if it is never
 * called. */
static sg_status define_function(sg_builder *b, sg_ast_definition *d)
{
    SG_TRY(check_params(b, &d->params));
    if (sg_operator_find(d->name) != SG_E_COUNT || sg_distribution_find(d->name) != NULL)
        return FAIL(b, d->at, "'%s' is a function or distribution of the language", d->name);
    sg_operand *slots = SG_NEW_ARRAY(b->arena, sg_operand, d->params.n);
    if (slots == NULL || !SG_GROW(b->functions, b->functions_capacity, b->nfunctions + 1))
        return sg_build_fail_nomem(b);
    for (uint32_t i = 0; i < d->params.n; i++)
        slots[i] = SG_OPERAND(SG_IN_FRAME, i);
    const sg_scope scope = {NULL, 0, NULL, true, "a function", &d->params, slots};
    sg_expr e = 0;
    SG_TRY(sg_build_expr(b, &scope, d->value, &e));
    b->functions[b->nfunctions] = d;
    return put(b, &b->function_names, d->name, (uint32_t)b->nfunctions++);
}

static sg_status define_all(sg_builder *b)
{
    for (sg_ast_definition *d = b->ast->definitions; d != NULL; d = d->next) {
        if (sg_build_is_reserved(d->name))
            return FAIL(b, d->at, "'%s' has a meaning of its own and cannot be defined", d->name);
        if (sg_names_get(&b->constant_names, d->name) != UINT32_MAX ||
            sg_names_get(&b->function_names, d->name) != UINT32_MAX)
            return FAIL(b, d->at, "'%.60s' is defined a second time", d->name);
        SG_TRY(d->is_function ? define_function(b, d) : define_constant(b, d));
    }
    return SG_OK;
}

/* ---- rules ---- */

static sg_status build_alternative(sg_builder *b, sg_sym lhs, const sg_ast_rule *r, const sg_ast_alternative *a)
{
    sg_rule rule;
    memset(&rule, 0, sizeof rule);
    rule.lhs = lhs;
    rule.guard = rule.weight = SG_NONE;
    sg_scope scope = {&r->params, r->params.n, NULL, false, "a guard", NULL, NULL};
    if (r->guard != NULL)
        SG_TRY(sg_build_expr(b, &scope, r->guard, &rule.guard));
    scope.what = "a weight";
    if (a->weight != NULL)
        SG_TRY(sg_build_expr(b, &scope, a->weight, &rule.weight));
    double weight = 0;
    if (a->weight != NULL && sg_build_is_constant(b, rule.weight, &weight) && weight < 0)
        return FAIL(b, a->weight->at, "the weight is %g; expected a number that is not negative", weight);
    SG_TRY(sg_build_body(b, &r->params, a->items, &rule));
    return sg_build_rule(b, &rule, a->at);
}

static sg_status build_completion(sg_builder *b, sg_sym lhs, const sg_ast_rule *r)
{
    if (!b->ast->has_limit)
        return FAIL(b, r->at, "a rule 'at limit' in a grammar without 'limit depth'");
    if (b->symbols[lhs].completion != SG_NONE)
        return FAIL(b, r->at, "a second rule of '%.60s' at the limit: the first is in line %u", r->name,
                    b->rule_at[b->symbols[lhs].completion].line);
    b->symbols[lhs].completion = (sg_rule_id)b->nrules;
    return build_alternative(b, lhs, r, r->alternatives);
}

/* The statements of a symbol are linked by `chain`, so that its rules come to stand together. */
static sg_status build_rules_of(sg_builder *b, sg_sym s, sg_ast_rule *const *statements, const uint32_t *chain,
                                uint32_t first)
{
    b->symbols[s].first_rule = (sg_rule_id)b->nrules;
    for (uint32_t i = first; i != UINT32_MAX; i = chain[i])
        if (!statements[i]->at_limit)
            for (const sg_ast_alternative *a = statements[i]->alternatives; a != NULL; a = a->next)
                SG_TRY(build_alternative(b, s, statements[i], a));
    b->symbols[s].nrules = (uint32_t)(b->nrules - b->symbols[s].first_rule);
    if (b->symbols[s].nrules == 0)
        return FAIL(b, b->symbol_at[s], "'%.60s' has only a rule at the limit", b->symbols[s].name);
    for (uint32_t i = first; i != UINT32_MAX; i = chain[i])
        if (statements[i]->at_limit)
            SG_TRY(build_completion(b, s, statements[i]));
    return SG_OK;
}

static sg_status link_statements(sg_builder *b, sg_ast_rule **statements, uint32_t *chain, uint32_t *first,
                                 uint32_t *last)
{
    uint32_t n = 0;
    for (size_t s = 0; s < b->nsymbols; s++)
        first[s] = UINT32_MAX;
    for (sg_ast_rule *r = b->ast->rules; r != NULL; r = r->next, n++) {
        const sg_sym s = sg_names_get(&b->symbol_names, r->name);
        statements[n] = r;
        chain[n] = UINT32_MAX;
        if (first[s] == UINT32_MAX)
            first[s] = n;
        else
            chain[last[s]] = n;
        last[s] = n;
    }
    return SG_OK;
}

static sg_status build_rules(sg_builder *b)
{
    size_t n = 0;
    for (const sg_ast_rule *r = b->ast->rules; r != NULL; r = r->next)
        n++;
    const size_t nsymbols = b->nsymbols; /* hidden ones come while we build */
    sg_ast_rule **statements = SG_NEW_ARRAY(b->arena, sg_ast_rule *, n);
    uint32_t *chain = SG_NEW_ARRAY(b->arena, uint32_t, n);
    uint32_t *first = SG_NEW_ARRAY(b->arena, uint32_t, nsymbols);
    uint32_t *last = SG_NEW_ARRAY(b->arena, uint32_t, nsymbols);
    if (statements == NULL || chain == NULL || first == NULL || last == NULL)
        return sg_build_fail_nomem(b);
    SG_TRY(link_statements(b, statements, chain, first, last));
    for (size_t s = 0; s < nsymbols; s++)
        if (b->symbols[s].kind == SG_SYMBOL_NONTERMINAL)
            SG_TRY(build_rules_of(b, (sg_sym)s, statements, chain, first[s]));
    return SG_OK;
}

/* ---- the whole ---- */

static sg_status build_start(sg_builder *b)
{
    const sg_pos end = {b->source->text != NULL ? (uint32_t)b->source->length : 0, 0};
    sg_ast_item *call = b->ast->start;
    if (call == NULL)
        return FAIL(b, end, "the grammar has no 'start'");
    b->start = sg_names_get(&b->symbol_names, call->name);
    if (b->start == SG_NONE)
        return FAIL(b, call->at, "unknown name '%.60s'; expected a symbol that has rules", call->name);
    if (call->nargs != b->symbols[b->start].nparams)
        return FAIL(b, call->at, "%.60s takes %u argument%s, not %u", call->name, b->symbols[b->start].nparams,
                    b->symbols[b->start].nparams == 1 ? "" : "s", call->nargs);
    call->parentheses = call->nargs > 0;
    b->start_args = SG_NEW_ARRAY(b->arena, double, call->nargs);
    if (b->start_args == NULL)
        return sg_build_fail_nomem(b);
    const sg_scope scope = {NULL, 0, NULL, true, "an argument of 'start'", NULL, NULL};
    uint32_t i = 0;
    for (const sg_ast_expr *a = call->args; a != NULL; a = a->next, i++) {
        sg_expr e = 0;
        SG_TRY(sg_build_expr(b, &scope, a, &e));
        if (!sg_build_is_constant(b, e, &b->start_args[i]))
            return FAIL(b, a->at, "an argument of 'start' that is not constant");
    }
    return b->symbols[b->start].kind == SG_SYMBOL_LABEL ? sg_build_lexical(b, b->start, &b->start) : SG_OK;
}

static sg_status build_all(sg_builder *b)
{
    for (const sg_ast_rule *r = b->ast->rules; r != NULL; r = r->next)
        SG_TRY(declare_nonterminal(b, r));
    SG_TRY(declare_labels(b));
    SG_TRY(declare_materials(b));
    SG_TRY(define_all(b));
    SG_TRY(build_rules(b));
    SG_TRY(build_start(b));
    SG_TRY(sg_build_hidden(b));
    SG_TRY(sg_build_check(b));
    return sg_build_tables(b);
}

static size_t frame_size(const sg_builder *b)
{
    size_t most = 1;
    for (size_t r = 0; r < b->nrules; r++) {
        const size_t n = (size_t)b->symbols[b->rules[r].lhs].nparams + b->rules[r].nvalues;
        if (n > most)
            most = n;
    }
    return most;
}

#define KEEP(array, n) sg_arena_copy(b->arena, (array), (n) * sizeof *(array))

static sg_status finish(sg_builder *b, sg_grammar **out)
{
    sg_grammar *g = SG_NEW(b->arena, sg_grammar);
    if (g == NULL)
        return sg_build_fail_nomem(b);
    g->arena = b->arena;
    g->ast = b->ast;
    g->name = b->ast->name != NULL ? b->ast->name : "grammar";
    g->source = sg_arena_string(b->arena, b->source->name);
    g->imported = b->source->parts;
    g->nimported = b->source->nparts;
    g->symbols = KEEP(b->symbols, b->nsymbols);
    g->rules = KEEP(b->rules, b->nrules);
    g->codes = KEEP(b->codes, b->ncodes);
    g->instructions = KEEP(b->instructions, b->ninstructions);
    g->constants = KEEP(b->constants, b->nconstants);
    g->strings = KEEP(b->strings, b->nstrings);
    g->string_colors = SG_NEW_ARRAY(b->arena, uint32_t, b->nstrings);
    if (g->symbols == NULL || g->rules == NULL || g->codes == NULL || g->instructions == NULL ||
        g->constants == NULL || g->strings == NULL || g->string_colors == NULL || g->source == NULL)
        return sg_build_fail_nomem(b);
    for (size_t i = 0; i < b->nstrings; i++)
        g->string_colors[i] = sg_names_get(&b->material_names, b->strings[i]);
    g->nsymbols = b->nsymbols;
    g->nrules = b->nrules;
    g->ncodes = b->ncodes;
    g->ninstructions = b->ninstructions;
    g->nconstants = b->nconstants;
    g->nstrings = b->nstrings;
    g->start = b->start;
    g->start_args = b->start_args;
    g->depth_limit = b->ast->has_limit ? b->ast->limit : SIZE_MAX;
    g->tied = b->ast->tied;
    g->frame_size = frame_size(b);
    *out = g;
    return SG_OK;
}

/* The last look, and what it had to say; then nothing can fail. */
static sg_status conclude(sg_builder *b, sg_grammar *g)
{
    SG_TRY(sg_build_examine(b, g));
    g->warnings = KEEP(b->warnings, b->nwarnings);
    if (g->warnings == NULL)
        return sg_build_fail_nomem(b);
    g->nwarnings = b->nwarnings;
    g->names = b->symbol_names;
    b->symbol_names.entries = NULL;
    return SG_OK;
}

static void clear(sg_builder *b)
{
    sg_names_clear(&b->symbol_names);
    sg_names_clear(&b->constant_names);
    sg_names_clear(&b->function_names);
    sg_names_clear(&b->hidden_names);
    sg_names_clear(&b->string_names);
    sg_names_clear(&b->number_names);
    sg_names_clear(&b->material_names);
    free(b->symbols);
    free(b->rules);
    free(b->codes);
    free(b->code_at);
    free(b->code_tuned);
    free(b->instructions);
    free(b->constants);
    free(b->strings);
    free(b->hidden);
    free(b->functions);
    free(b->symbol_at);
    free(b->rule_at);
}

sg_status sg_grammar_build(sg_arena *arena, sg_ast *ast, const sg_source *source, sg_grammar **out, sg_error *err)
{
    sg_builder b;
    memset(&b, 0, sizeof b);
    b.arena = arena;
    b.ast = ast;
    b.source = source;
    b.err = err;
    sg_names *const maps[] = {&b.symbol_names, &b.constant_names, &b.function_names,
                              &b.hidden_names, &b.string_names,   &b.number_names, &b.material_names};
    for (size_t i = 0; i < sizeof maps / sizeof *maps; i++)
        maps[i]->arena = arena;
    sg_grammar *g = NULL;
    sg_status st = build_all(&b);
    if (st == SG_OK)
        st = finish(&b, &g);
    if (st == SG_OK)
        st = conclude(&b, g);
    clear(&b);
    if (st == SG_OK)
        *out = g;
    return st;
}
