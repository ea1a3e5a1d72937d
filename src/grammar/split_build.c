/* SPDX-License-Identifier: GPL-3.0-or-later */
/* split_build.c - from the split form to a grammar: a syntax tree is made and built like one that was read, so that the
 * checks are the same and the result can be printed. */
#include "config.h"

#include "grammar/grammar_priv.h"
#include "grammar/names.h"
#include "grammar/split_priv.h"

#include <math.h>
#include <string.h>

typedef struct {
    const sg_split_form *form;
    sg_arena *arena;
    sg_ast *ast;
    sg_source source;
    const char **names; /* of symbols in the language: that of the terminal for implicit ones */
    bool *implicit;
    size_t *first;      /* [nsymbols+1] first rule of each symbol */
    sg_error *err;
} maker;

static sg_pos rule_at(size_t rule)
{
    return (sg_pos){(uint32_t)rule + 1, 0};
}

static sg_status check_name(const maker *m, const char *name, const char *what)
{
    if (name == NULL || name[0] == '\0')
        return sg_source_fail(&m->source, (sg_pos){0, 0}, m->err, "a %s without a name", what);
    const sg_source text = {.name = m->source.name, .text = name, .length = strlen(name)};
    sg_error inner = SG_ERROR_INIT;
    if (strchr(name, '\n') != NULL || sg_source_check(&text, &inner) != SG_OK)
        return sg_source_fail(&m->source, (sg_pos){0, 0}, m->err, "the name of a %s is no line of UTF-8 text", what);
    return SG_OK;
}

static sg_status check_rule(const maker *m, size_t i)
{
    const sg_split_rule *r = &m->form->rules[i];
    const size_t limit = r->op == SG_SPLIT_LEXICAL ? m->form->nterminals : m->form->nsymbols;
    if (r->lhs >= m->form->nsymbols)
        return sg_source_fail(&m->source, rule_at(i), m->err, "an unknown left-hand symbol");
    if (r->n == 0 || (r->op == SG_SPLIT_LEXICAL && r->n != 1))
        return sg_source_fail(&m->source, rule_at(i), m->err, "a right-hand side of %u symbols", r->n);
    for (uint32_t c = 0; c < r->n; c++)
        if (r->rhs[c] >= limit)
            return sg_source_fail(&m->source, rule_at(i), m->err, "an unknown symbol on the right-hand side");
    if (!(r->probability >= 0 && isfinite(r->probability)))
        return sg_source_fail(&m->source, rule_at(i), m->err, "the probability is %g", r->probability);
    if (i > 0 && r->lhs < m->form->rules[i - 1].lhs)
        return sg_source_fail(&m->source, rule_at(i), m->err, "rules are not in the order of their symbols");
    return SG_OK;
}

static sg_status check_form(const maker *m)
{
    const sg_split_form *f = m->form;
    if (f->nrules >= UINT32_MAX - 1 || f->nsymbols >= UINT32_MAX - 1 || f->nterminals >= UINT32_MAX - 1)
        return sg_source_fail(&m->source, (sg_pos){0, 0}, m->err, "too many rules or symbols");
    if (f->axiom >= f->nsymbols)
        return sg_source_fail(&m->source, (sg_pos){0, 0}, m->err, "an unknown axiom");
    for (size_t i = 0; i < f->nsymbols; i++)
        SG_TRY(check_name(m, f->symbol_names[i], "symbol"));
    for (size_t i = 0; i < f->nterminals; i++)
        SG_TRY(check_name(m, f->terminal_names[i], "terminal"));
    for (size_t i = 0; i < f->nrules; i++)
        SG_TRY(check_rule(m, i));
    return SG_OK;
}

static sg_status index_rules(maker *m)
{
    const sg_split_form *f = m->form;
    m->first = SG_NEW_ARRAY(m->arena, size_t, f->nsymbols + 1);
    m->names = SG_NEW_ARRAY(m->arena, const char *, f->nsymbols);
    m->implicit = SG_NEW_ARRAY(m->arena, bool, f->nsymbols);
    if (m->first == NULL || m->names == NULL || m->implicit == NULL)
        return SG_FAIL_NOMEM(m->err);
    for (size_t i = 0; i < f->nrules; i++)
        m->first[f->rules[i].lhs + 1]++;
    for (size_t s = 0; s < f->nsymbols; s++) {
        m->first[s + 1] += m->first[s];
        if (m->first[s + 1] == m->first[s])
            return sg_source_fail(&m->source, (sg_pos){0, 0}, m->err, "symbol '%.60s' has no rule", f->symbol_names[s]);
    }
    return SG_OK;
}

static bool is_implicit(const maker *m, size_t s)
{
    const sg_split_rule *r = &m->form->rules[m->first[s]];
    return m->first[s + 1] - m->first[s] == 1 && r->op == SG_SPLIT_LEXICAL && r->probability == 1 &&
           strcmp(m->form->symbol_names[s], m->form->terminal_names[r->rhs[0]]) == 0;
}

/* A symbol that shares its name with a terminal (the exchange form allows it, the language does not) gets a number. */
static const char *free_name(const maker *m, const sg_names *taken, const char *name)
{
    const char *other = name;
    for (unsigned i = 2; other != NULL && sg_names_get(taken, other) != UINT32_MAX; i++)
        other = sg_arena_printf(m->arena, "%s_%u", name, i);
    return other;
}

static sg_status name_symbols_with(maker *m, sg_names *taken, sg_names *symbols)
{
    const sg_split_form *f = m->form;
    for (size_t t = 0; t < f->nterminals; t++)
        if (!sg_names_put(taken, f->terminal_names[t], 0))
            return SG_FAIL_NOMEM(m->err);
    for (size_t s = 0; s < f->nsymbols; s++) {
        if (sg_names_get(symbols, f->symbol_names[s]) != UINT32_MAX)
            return sg_source_fail(&m->source, (sg_pos){0, 0}, m->err, "two symbols named '%.60s'", f->symbol_names[s]);
        if (!sg_names_put(symbols, f->symbol_names[s], 0))
            return SG_FAIL_NOMEM(m->err);
        m->implicit[s] = is_implicit(m, s);
    }
    for (size_t s = 0; s < f->nsymbols; s++)
        if (sg_names_get(taken, f->symbol_names[s]) == UINT32_MAX && !sg_names_put(taken, f->symbol_names[s], 1))
            return SG_FAIL_NOMEM(m->err);
    for (size_t s = 0; s < f->nsymbols; s++) {
        m->names[s] = f->symbol_names[s];
        if (m->implicit[s] || sg_names_get(taken, m->names[s]) != 0)
            continue;
        m->names[s] = free_name(m, taken, m->names[s]);
        if (m->names[s] == NULL || !sg_names_put(taken, m->names[s], 1))
            return SG_FAIL_NOMEM(m->err);
    }
    return SG_OK;
}

static sg_status name_symbols(maker *m)
{
    sg_names taken = {NULL, m->arena}, symbols = {NULL, m->arena};
    const sg_status st = name_symbols_with(m, &taken, &symbols);
    sg_names_clear(&taken);
    sg_names_clear(&symbols);
    return st;
}

/* Names are copied: the form may go before the grammar. */
static sg_ast_item *make_call(const maker *m, const char *name, sg_pos at)
{
    const char *copy = sg_arena_string(m->arena, name);
    return copy != NULL ? sg_ast_item_new(m->arena, SG_ITEM_CALL, copy, at) : NULL;
}

static sg_status make_sizes(const maker *m, const sg_split_rule *r, sg_ast_item *split)
{
    const bool reverse = r->op == SG_SPLIT_Y;
    const size_t k = r->n;
    if (r->mean == NULL && r->nattributes == 0)
        return SG_OK;
    if (r->mean != NULL && r->covariance == NULL && k > 1)
        return sg_source_fail(&m->source, split->at, m->err, "a mean without a covariance");
    sg_ast_sizes *s = split->sizes = SG_NEW(m->arena, sg_ast_sizes);
    if (s == NULL)
        return SG_FAIL_NOMEM(m->err);
    s->at = split->at;
    if (r->mean != NULL) {
        s->mean = sg_ast_matrix_of(m->arena, r->mean, 1, k);
        double *turned = SG_NEW_ARRAY(m->arena, double, (k - 1) * (k - 1));
        if (s->mean == NULL || turned == NULL)
            return SG_FAIL_NOMEM(m->err);
        sg_split_turn_covariance(k, r->covariance, reverse, turned);
        s->covariance = sg_ast_matrix_of(m->arena, turned, k - 1, k - 1);
    }
    if (r->nattributes > 0)
        s->examples = sg_ast_matrix_of(m->arena, r->attributes, r->nattributes, k);
    if ((r->mean != NULL && s->covariance == NULL) || (r->nattributes > 0 && s->examples == NULL))
        return SG_FAIL_NOMEM(m->err);
    for (size_t i = 0; reverse && r->mean != NULL && i < k; i++)
        s->mean->values[i] = r->mean[k - 1 - i];
    for (size_t i = 0; reverse && i < r->nattributes; i++)
        for (size_t j = 0; j < k; j++)
            s->examples->values[i * k + j] = r->attributes[i * k + k - 1 - j];
    sg_ast_matrix *const all[] = {s->mean, s->covariance, s->examples};
    for (size_t i = 0; i < 3; i++)
        if (all[i] != NULL)
            all[i]->at = split->at;
    return SG_OK;
}

static sg_status make_split(const maker *m, const sg_split_rule *r, sg_pos at, sg_ast_item **out)
{
    sg_ast_item *split = sg_ast_item_new(m->arena, SG_ITEM_SPLIT, r->op == SG_SPLIT_X ? "x" : "y", at);
    sg_ast_items parts = {NULL, NULL};
    if (split == NULL)
        return SG_FAIL_NOMEM(m->err);
    for (uint32_t i = 0; i < r->n; i++) {
        const uint32_t symbol = r->rhs[r->op == SG_SPLIT_Y ? r->n - 1 - i : i];
        sg_ast_item *part = sg_ast_item_new(m->arena, SG_ITEM_PART, NULL, at);
        if (part == NULL || (part->items = make_call(m, m->names[symbol], at)) == NULL)
            return SG_FAIL_NOMEM(m->err);
        part->size = SG_SIZE_FLOATING;
        SG_AST_APPEND(parts.first, parts.last, part);
    }
    split->items = parts.first;
    *out = split;
    return make_sizes(m, r, split);
}

static sg_status make_alternative(const maker *m, size_t i, bool certain, sg_ast_alternative **out)
{
    const sg_split_rule *r = &m->form->rules[i];
    sg_ast_alternative *a = SG_NEW(m->arena, sg_ast_alternative);
    if (a == NULL)
        return SG_FAIL_NOMEM(m->err);
    a->at = rule_at(i);
    if (!certain && (a->weight = sg_ast_number(m->arena, r->probability, a->at)) == NULL)
        return SG_FAIL_NOMEM(m->err);
    *out = a;
    if (r->op != SG_SPLIT_LEXICAL)
        return make_split(m, r, a->at, &a->items);
    a->items = make_call(m, m->form->terminal_names[r->rhs[0]], a->at);
    return a->items != NULL ? SG_OK : SG_FAIL_NOMEM(m->err);
}

static sg_status make_rules(const maker *m, size_t s)
{
    const size_t n = m->first[s + 1] - m->first[s];
    const bool certain = n == 1 && m->form->rules[m->first[s]].probability == 1;
    sg_ast_rule *rule = SG_NEW(m->arena, sg_ast_rule);
    sg_ast_alternatives list = {NULL, NULL};
    if (rule == NULL || (rule->name = sg_arena_string(m->arena, m->names[s])) == NULL)
        return SG_FAIL_NOMEM(m->err);
    rule->at = rule_at(m->first[s]);
    for (size_t i = m->first[s]; i < m->first[s + 1]; i++) {
        sg_ast_alternative *a = NULL;
        SG_TRY(make_alternative(m, i, certain, &a));
        SG_AST_APPEND(list.first, list.last, a);
    }
    rule->alternatives = list.first;
    SG_AST_APPEND(m->ast->rules, m->ast->last_rule, rule);
    return SG_OK;
}

static sg_status make_labels(const maker *m)
{
    for (size_t t = 0; t < m->form->nterminals; t++) {
        sg_ast_label *l = SG_NEW(m->arena, sg_ast_label);
        if (l == NULL || (l->name = sg_arena_string(m->arena, m->form->terminal_names[t])) == NULL)
            return SG_FAIL_NOMEM(m->err);
        l->has_color = true;
        l->color = m->form->terminal_colors[t] & 0xFFFFFF;
        SG_AST_APPEND(m->ast->labels, m->ast->last_label, l);
    }
    return SG_OK;
}

static sg_status make_tree(maker *m)
{
    const sg_split_form *f = m->form;
    SG_TRY(check_form(m));
    SG_TRY(index_rules(m));
    SG_TRY(name_symbols(m));
    if (f->name != NULL && f->name[0] != '\0') {
        SG_TRY(check_name(m, f->name, "grammar"));
        if ((m->ast->name = sg_arena_string(m->arena, f->name)) == NULL)
            return SG_FAIL_NOMEM(m->err);
    }
    m->ast->tied = f->tied;
    SG_TRY(make_labels(m));
    m->ast->start = make_call(m, m->names[f->axiom], (sg_pos){0, 0});
    if (m->ast->start == NULL)
        return SG_FAIL_NOMEM(m->err);
    for (size_t s = 0; s < f->nsymbols; s++)
        if (!m->implicit[s])
            SG_TRY(make_rules(m, s));
    return SG_OK;
}

sg_status sg_split_build(const sg_split_form *form, const char *name, sg_grammar **out, sg_error *err)
{
    sg_arena *arena = sg_arena_create();
    sg_ast *ast = arena != NULL ? SG_NEW(arena, sg_ast) : NULL;
    sg_status st = SG_OK;
    if (ast != NULL) {
        maker m = {form, arena, ast, {.name = name}, NULL, NULL, NULL, err};
        st = make_tree(&m);
        if (st == SG_OK)
            st = sg_grammar_build(arena, ast, &m.source, out, err);
    } else {
        st = SG_FAIL_NOMEM(err);
    }
    if (st != SG_OK)
        sg_arena_free(arena);
    return st;
}

sg_status sg_grammar_from_split(const sg_split_form *form, sg_grammar **out, sg_error *err)
{
    return sg_split_build(form, form->name != NULL ? form->name : "grammar", out, err);
}
