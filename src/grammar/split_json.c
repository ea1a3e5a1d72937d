/* SPDX-License-Identifier: GPL-3.0-or-later */
/* split_json.c - the exchange form of split grammars (INTERFACES 6), through jansson. */
#include "config.h"

#include "grammar/json_text.h"
#include "grammar/label_color.h"
#include "grammar/names.h"
#include "grammar/source.h"
#include "grammar/split_priv.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const op_names[] = {"split-x", "split-y", "terminal"};

/* ---- writing ---- */

/* Set a member; false when the value or memory is missing. Takes the value over either way. */
static bool set(json_t *object, const char *key, json_t *value)
{
    return value != NULL && json_object_set_new(object, key, value) == 0;
}

static json_t *row(const double *values, size_t n)
{
    json_t *array = json_array();
    for (size_t i = 0; array != NULL && i < n; i++)
        if (json_array_append_new(array, json_real(values[i])) != 0) {
            json_decref(array);
            array = NULL;
        }
    return array;
}

static json_t *table(const double *values, size_t rows, size_t columns)
{
    json_t *array = json_array();
    for (size_t i = 0; array != NULL && i < rows; i++)
        if (json_array_append_new(array, row(values + i * columns, columns)) != 0) {
            json_decref(array);
            array = NULL;
        }
    return array;
}

static json_t *right_side(const sg_split_form *f, const sg_split_rule *r)
{
    const char *const *names = r->op == SG_SPLIT_LEXICAL ? f->terminal_names : f->symbol_names;
    json_t *array = json_array();
    for (uint32_t i = 0; array != NULL && i < r->n; i++)
        if (json_array_append_new(array, json_string(names[r->rhs[i]])) != 0) {
            json_decref(array);
            array = NULL;
        }
    return array;
}

static json_t *rule_value(const sg_split_form *f, const sg_split_rule *r)
{
    json_t *o = json_object();
    const size_t k = r->n;
    bool good = o != NULL && set(o, "lhs", json_string(f->symbol_names[r->lhs])) &&
                set(o, "op", json_string(op_names[r->op])) && set(o, "rhs", right_side(f, r)) &&
                set(o, "probability", json_real(r->probability));
    if (good && r->nattributes > 0)
        good = set(o, "attributes", table(r->attributes, r->nattributes, k));
    if (good && r->mean != NULL)
        good = set(o, "mean", row(r->mean, k)) && set(o, "covariance", table(r->covariance, k - 1, k - 1));
    if (good)
        return o;
    json_decref(o);
    return NULL;
}

static json_t *terminal_value(const sg_split_form *f, size_t t)
{
    json_t *o = json_object();
    if (o != NULL && set(o, "name", json_string(f->terminal_names[t])) &&
        set(o, "color", json_sprintf("#%06x", (unsigned)(f->terminal_colors[t] & 0xFFFFFF))))
        return o;
    json_decref(o);
    return NULL;
}

static bool fill_arrays(const sg_split_form *f, json_t *terminals, json_t *rules)
{
    for (size_t t = 0; t < f->nterminals; t++)
        if (json_array_append_new(terminals, terminal_value(f, t)) != 0)
            return false;
    for (size_t i = 0; i < f->nrules; i++)
        if (json_array_append_new(rules, rule_value(f, &f->rules[i])) != 0)
            return false;
    return true;
}

struct json_t *sg_split_form_json(const sg_split_form *f)
{
    json_t *o = json_object(), *terminals = json_array(), *rules = json_array();
    bool good = o != NULL && terminals != NULL && rules != NULL && fill_arrays(f, terminals, rules) &&
                set(o, "format", json_string("shapegram-grammar")) && set(o, "version", json_integer(1));
    if (good && f->name != NULL)
        good = set(o, "name", json_string(f->name));
    if (good && f->tied)
        good = set(o, "tied", json_true());
    good = good && set(o, "axiom", json_string(f->symbol_names[f->axiom])) &&
           json_object_set(o, "terminals", terminals) == 0 && json_object_set(o, "rules", rules) == 0;
    json_decref(terminals);
    json_decref(rules);
    if (good)
        return o;
    json_decref(o);
    return NULL;
}

sg_status sg_split_form_write_json(const sg_split_form *form, FILE *out, sg_error *err)
{
    json_t *value = sg_split_form_json(form);
    if (value == NULL)
        return SG_FAIL_NOMEM(err);
    const sg_status st = sg_json_write(value, 2, out, err);
    json_decref(value);
    return st;
}

/* ---- reading ---- */

typedef struct {
    sg_source source; /* without text: errors name rules */
    sg_arena *arena;
    sg_names symbols, terminals;
    sg_split_form *form;
    sg_error *err;
} reader;

#define FAIL(r, rule, ...) sg_source_fail(&(r)->source, (sg_pos){(uint32_t)(rule), 0}, (r)->err, __VA_ARGS__)

static sg_status get_string(const reader *r, size_t rule, const json_t *o, const char *key, const char **out)
{
    const json_t *v = json_object_get(o, key);
    if (!json_is_string(v) || json_string_length(v) == 0)
        return FAIL(r, rule, "\"%s\" is %s; expected a name", key, v == NULL ? "missing" : "no string");
    if (strlen(json_string_value(v)) != json_string_length(v))
        return FAIL(r, rule, "\"%s\" holds a NUL character", key);
    *out = sg_arena_string(r->arena, json_string_value(v));
    return *out != NULL ? SG_OK : SG_FAIL_NOMEM(r->err);
}

static sg_status read_color(const reader *r, const json_t *terminal, size_t number, uint32_t *color)
{
    const json_t *v = json_object_get(terminal, "color");
    *color = sg_label_color((uint32_t)number);
    if (v == NULL)
        return SG_OK;
    const char *s = json_is_string(v) ? json_string_value(v) : "";
    if (strlen(s) != 7 || s[0] != '#' || strspn(s + 1, "0123456789abcdefABCDEF") != 6)
        return FAIL(r, 0, "terminal %zu: \"color\" is no string like \"#ff0000\"", number + 1);
    *color = (uint32_t)strtoul(s + 1, NULL, 16);
    return SG_OK;
}

static sg_status read_terminals(reader *r, const json_t *root)
{
    const json_t *list = json_object_get(root, "terminals");
    const size_t n = json_array_size(list);
    const char **names = SG_NEW_ARRAY(r->arena, const char *, n);
    uint32_t *colors = SG_NEW_ARRAY(r->arena, uint32_t, n);
    if (!json_is_array(list))
        return FAIL(r, 0, "\"terminals\" is no array");
    if (names == NULL || colors == NULL)
        return SG_FAIL_NOMEM(r->err);
    for (size_t i = 0; i < n; i++) {
        const json_t *t = json_array_get(list, i);
        SG_TRY(get_string(r, 0, t, "name", &names[i]));
        SG_TRY(read_color(r, t, i, &colors[i]));
        if (sg_names_get(&r->terminals, names[i]) != UINT32_MAX)
            return FAIL(r, 0, "two terminals named '%.60s'", names[i]);
        if (!sg_names_put(&r->terminals, names[i], (uint32_t)i))
            return SG_FAIL_NOMEM(r->err);
    }
    r->form->nterminals = n;
    r->form->terminal_names = names;
    r->form->terminal_colors = colors;
    return SG_OK;
}

/* Non-terminals are numbered by their first rule. */
static sg_status number_symbols(reader *r, const json_t *rules, uint32_t *lhs)
{
    const size_t n = json_array_size(rules);
    const char **names = SG_NEW_ARRAY(r->arena, const char *, n);
    if (names == NULL)
        return SG_FAIL_NOMEM(r->err);
    for (size_t i = 0; i < n; i++) {
        const json_t *rule = json_array_get(rules, i);
        const char *name = NULL;
        if (!json_is_object(rule))
            return FAIL(r, i + 1, "no object");
        SG_TRY(get_string(r, i + 1, rule, "lhs", &name));
        lhs[i] = sg_names_get(&r->symbols, name);
        if (lhs[i] != UINT32_MAX)
            continue;
        lhs[i] = (uint32_t)r->form->nsymbols;
        names[r->form->nsymbols++] = name;
        if (!sg_names_put(&r->symbols, name, lhs[i]))
            return SG_FAIL_NOMEM(r->err);
    }
    r->form->symbol_names = names;
    return SG_OK;
}

static sg_status get_row(const reader *r, size_t rule, const json_t *v, const char *key, size_t n, double *out)
{
    if (!json_is_array(v) || json_array_size(v) != n)
        return FAIL(r, rule, "\"%s\": expected an array of %zu numbers", key, n);
    for (size_t i = 0; i < n; i++) {
        const json_t *x = json_array_get(v, i);
        if (!json_is_number(x))
            return FAIL(r, rule, "\"%s\": entry %zu is no number", key, i + 1);
        out[i] = json_number_value(x);
    }
    return SG_OK;
}

static sg_status get_table(const reader *r, size_t rule, const json_t *v, const char *key, size_t rows, size_t columns,
                           const double **out)
{
    if (!json_is_array(v) || json_array_size(v) != rows)
        return FAIL(r, rule, "\"%s\": expected an array of %zu rows", key, rows);
    double *values = SG_NEW_ARRAY(r->arena, double, rows * columns);
    if (values == NULL)
        return SG_FAIL_NOMEM(r->err);
    for (size_t i = 0; i < rows; i++)
        SG_TRY(get_row(r, rule, json_array_get(v, i), key, columns, values + i * columns));
    *out = values;
    return SG_OK;
}

static sg_status read_op(const reader *r, size_t rule, const json_t *o, sg_split_op *op)
{
    const char *name = NULL;
    SG_TRY(get_string(r, rule, o, "op", &name));
    for (int i = 0; i < 3; i++)
        if (strcmp(name, op_names[i]) == 0) {
            *op = (sg_split_op)i;
            return SG_OK;
        }
    return FAIL(r, rule, "\"op\" is \"%.60s\"; expected split-x, split-y or terminal", name);
}

static sg_status read_right_side(const reader *r, size_t rule, const json_t *o, sg_split_rule *out)
{
    const json_t *list = json_object_get(o, "rhs");
    const size_t n = json_array_size(list);
    const bool lexical = out->op == SG_SPLIT_LEXICAL;
    if (n == 0 || n > UINT32_MAX || (lexical && n != 1))
        return FAIL(r, rule, "\"rhs\": expected an array of %s", lexical ? "one terminal" : "symbols");
    uint32_t *rhs = SG_NEW_ARRAY(r->arena, uint32_t, n);
    if (rhs == NULL)
        return SG_FAIL_NOMEM(r->err);
    for (size_t i = 0; i < n; i++) {
        const char *name = json_string_value(json_array_get(list, i));
        rhs[i] = name != NULL ? sg_names_get(lexical ? &r->terminals : &r->symbols, name) : UINT32_MAX;
        if (rhs[i] == UINT32_MAX)
            return FAIL(r, rule, "\"rhs\": '%.60s' is no %s", name != NULL ? name : "?",
                        lexical ? "terminal" : "symbol with rules");
    }
    out->n = (uint32_t)n;
    out->rhs = rhs;
    return SG_OK;
}

static sg_status read_sizes(const reader *r, size_t rule, const json_t *o, sg_split_rule *out)
{
    const json_t *attributes = json_object_get(o, "attributes"), *mean = json_object_get(o, "mean"),
                 *covariance = json_object_get(o, "covariance");
    if (attributes != NULL && !json_is_array(attributes))
        return FAIL(r, rule, "\"attributes\" is no array");
    if (json_array_size(attributes) > 0) {
        out->nattributes = json_array_size(attributes);
        SG_TRY(get_table(r, rule, attributes, "attributes", out->nattributes, out->n, &out->attributes));
    }
    if (mean == NULL)
        return covariance == NULL ? SG_OK : FAIL(r, rule, "\"covariance\" without \"mean\"");
    double *values = SG_NEW_ARRAY(r->arena, double, out->n);
    if (values == NULL)
        return SG_FAIL_NOMEM(r->err);
    SG_TRY(get_row(r, rule, mean, "mean", out->n, values));
    out->mean = values;
    return get_table(r, rule, covariance, "covariance", out->n - 1, out->n - 1, &out->covariance);
}

static sg_status read_rule(const reader *r, size_t rule, const json_t *o, sg_split_rule *out)
{
    const json_t *p = json_object_get(o, "probability");
    SG_TRY(read_op(r, rule, o, &out->op));
    SG_TRY(read_right_side(r, rule, o, out));
    if (!json_is_number(p))
        return FAIL(r, rule, "\"probability\" is %s; expected a number", p == NULL ? "missing" : "no number");
    out->probability = json_number_value(p);
    if (!(out->probability >= 0 && out->probability <= 1 + 1e-6))
        return FAIL(r, rule, "the probability is %g; expected a number from 0 to 1", out->probability);
    out->source = SG_NONE;
    return out->op == SG_SPLIT_LEXICAL ? SG_OK : read_sizes(r, rule, o, out);
}

/* Probabilities per symbol; the error names the symbol's first rule in the file. */
static sg_status check_sums(const reader *r, const json_t *rules, const uint32_t *lhs)
{
    double *sum = SG_NEW_ARRAY(r->arena, double, r->form->nsymbols);
    if (sum == NULL)
        return SG_FAIL_NOMEM(r->err);
    const size_t n = json_array_size(rules);
    for (size_t i = 0; i < n; i++)
        sum[lhs[i]] += json_number_value(json_object_get(json_array_get(rules, i), "probability"));
    for (size_t i = 0; i < n; i++)
        if (!(fabs(sum[lhs[i]] - 1) <= 1e-6))
            return FAIL(r, i + 1, "the probabilities of '%.60s' sum to %.9g, not to 1", r->form->symbol_names[lhs[i]],
                        sum[lhs[i]]);
    return SG_OK;
}

/* Rules in the order of their symbols, otherwise in that of the file. */
static sg_status read_rules(reader *r, const json_t *root)
{
    const json_t *list = json_object_get(root, "rules");
    const size_t n = json_array_size(list);
    if (n == 0 || n >= UINT32_MAX)
        return FAIL(r, 0, "\"rules\": expected an array of rules");
    uint32_t *lhs = SG_NEW_ARRAY(r->arena, uint32_t, n);
    sg_split_rule *rules = SG_NEW_ARRAY(r->arena, sg_split_rule, n);
    if (lhs == NULL || rules == NULL)
        return SG_FAIL_NOMEM(r->err);
    SG_TRY(number_symbols(r, list, lhs));
    size_t *next = SG_NEW_ARRAY(r->arena, size_t, r->form->nsymbols + 1);
    if (next == NULL)
        return SG_FAIL_NOMEM(r->err);
    for (size_t i = 0; i < n; i++)
        next[lhs[i] + 1]++;
    for (size_t s = 0; s < r->form->nsymbols; s++)
        next[s + 1] += next[s];
    for (size_t i = 0; i < n; i++) {
        sg_split_rule *rule = &rules[next[lhs[i]]++];
        rule->lhs = lhs[i];
        SG_TRY(read_rule(r, i + 1, json_array_get(list, i), rule));
    }
    r->form->nrules = n;
    r->form->rules = rules;
    return check_sums(r, list, lhs);
}

static sg_status read_root(reader *r, const json_t *root)
{
    const char *format = NULL, *axiom = NULL;
    const json_t *name = json_object_get(root, "name");
    if (!json_is_object(root))
        return FAIL(r, 0, "no object");
    SG_TRY(get_string(r, 0, root, "format", &format));
    if (strcmp(format, "shapegram-grammar") != 0)
        return FAIL(r, 0, "\"format\" is \"%.60s\"; expected \"shapegram-grammar\"", format);
    if (json_integer_value(json_object_get(root, "version")) != 1)
        return FAIL(r, 0, "\"version\" is not 1");
    if (name != NULL)
        SG_TRY(get_string(r, 0, root, "name", &r->form->name));
    r->form->tied = json_is_true(json_object_get(root, "tied"));
    SG_TRY(read_terminals(r, root));
    SG_TRY(read_rules(r, root));
    SG_TRY(get_string(r, 0, root, "axiom", &axiom));
    r->form->axiom = sg_names_get(&r->symbols, axiom);
    return r->form->axiom != UINT32_MAX ? SG_OK : FAIL(r, 0, "the axiom '%.60s' has no rules", axiom);
}

sg_status sg_split_form_read_json(const char *text, size_t length, const char *name, sg_arena *arena,
                                  sg_split_form *out, sg_error *err)
{
    json_error_t at;
    const sg_source source = {.name = name, .text = text, .length = length};
    json_t *root = json_loadb(text, length, JSON_REJECT_DUPLICATES, &at);
    if (root == NULL)
        return at.text[0] == '\0' || json_error_code(&at) == json_error_out_of_memory /* it says nothing then */
                   ? SG_FAIL_NOMEM(err)
                   : sg_source_fail(&source, (sg_pos){at.position > 0 ? (uint32_t)at.position - 1 : 0, 0}, err, "%s",
                                    at.text);
    memset(out, 0, sizeof *out);
    reader r = {{.name = name}, arena, {NULL, arena}, {NULL, arena}, out, err};
    const sg_status st = read_root(&r, root);
    sg_names_clear(&r.symbols);
    sg_names_clear(&r.terminals);
    json_decref(root);
    return st;
}
