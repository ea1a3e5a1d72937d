/* SPDX-License-Identifier: GPL-3.0-or-later */
/* derivation_json_read.c - derivations from JSON. The nodes are collected by their numbers first, then stored in that order;
 * lengths follow from parents, and sg_derivation_check() has the last word. Recursion is as deep as jansson lets JSON nest. */
#include "config.h"

#include "scene/derivation_json.h"

#include "derivation/derivation_priv.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* jansson takes up to a hundred times as much memory as the text. */
#define TEXT_LIMIT ((size_t)64 << 20) /* bytes */

typedef struct {
    const json_t *json; /* NULL: no node of this number yet */
    size_t parent;
} slot;

typedef struct {
    const sg_grammar *g;
    const char *name;
    size_t number; /* of the derivation, from 1 */
    slot *slots;   /* [count] by number of node */
    size_t count, nread;
    sg_derivation *d;
    sg_error *err;
} reader;

#define FAIL(r, node, format, ...)                                                                                     \
    SG_FAIL((r)->err, SG_EINPUT, "%.250s: derivation %zu: node %zu: error: " format, (r)->name, (r)->number, (node),   \
            __VA_ARGS__)

/* A label that stands in a split without a symbol of its own is nothing that is stored. */
static bool is_node(const json_t *v)
{
    return json_object_get(v, "symbol") != NULL || json_object_get(v, "label") == NULL;
}

static size_t count_nodes(const json_t *v)
{
    const json_t *children = json_object_get(v, "children");
    size_t n = 1;
    for (size_t i = 0; i < json_array_size(children); i++)
        if (is_node(json_array_get(children, i)))
            n += count_nodes(json_array_get(children, i));
    return n;
}

static bool same_field(const json_t *a, const json_t *b, const char *key)
{
    const json_t *x = json_object_get(a, key), *y = json_object_get(b, key);
    return (x == NULL && y == NULL) || json_equal(x, y) != 0;
}

/* A tied sibling at another place. */
static sg_status check_again(const reader *r, size_t number, const json_t *v, size_t parent)
{
    static const char *const fields[] = {"rule", "symbol", "uniforms", "values"};
    const slot *s = r->slots + number;
    bool same = s->parent == parent;
    for (size_t k = 0; same && k < sizeof fields / sizeof *fields; k++)
        same = same_field(s->json, v, fields[k]);
    return same ? SG_OK : FAIL(r, number, "%s", "it comes a second time, and differs");
}

static sg_status number_of(reader *r, const json_t *v, size_t *number)
{
    const json_t *given = json_object_get(v, "node");
    *number = r->nread++;
    if (given == NULL)
        return SG_OK;
    const json_int_t n = json_is_integer(given) ? json_integer_value(given) : -1;
    if (n < 0 || (uint64_t)n >= r->count)
        return FAIL(r, *number, "%s", "\"node\" is no index of a node");
    *number = (size_t)n;
    return SG_OK;
}

static sg_status collect(reader *r, const json_t *v, size_t parent)
{
    size_t number = 0;
    SG_TRY(number_of(r, v, &number));
    if (!json_is_object(v))
        return FAIL(r, number, "%s", "expected an object");
    const json_t *children = json_object_get(v, "children");
    if (children != NULL && !json_is_array(children))
        return FAIL(r, number, "%s", "\"children\" is no array");
    if (r->slots[number].json != NULL)
        SG_TRY(check_again(r, number, v, parent));
    r->slots[number] = (slot){v, parent};
    for (size_t i = 0; i < json_array_size(children); i++)
        if (is_node(json_array_get(children, i)))
            SG_TRY(collect(r, json_array_get(children, i), number));
    return SG_OK;
}

static sg_status get_symbol(const reader *r, size_t node, const json_t *v, sg_node *n)
{
    const char *name = json_string_value(json_object_get(v, "symbol"));
    if (n->rule < SG_RULE_EMPTY) {
        n->symbol = sg_grammar_rule(r->g, n->rule)->lhs;
    } else {
        const json_t *number = json_object_get(v, "symbol_number");
        const json_int_t k = json_is_integer(number) ? json_integer_value(number) : -1;
        if (k < 0 || (uint64_t)k >= sg_grammar_symbol_count(r->g))
            return FAIL(r, node, "%s", "\"symbol_number\" is no symbol of the grammar");
        n->symbol = (sg_sym)k;
    }
    if (name == NULL)
        return FAIL(r, node, "%s", "\"symbol\" is missing, or no name");
    const char *want = sg_grammar_symbol(r->g, n->symbol)->name;
    return strcmp(name, want) == 0 ? SG_OK : FAIL(r, node, "\"symbol\" is \"%.60s\"; expected \"%.60s\"", name, want);
}

static sg_status get_rule(const reader *r, size_t node, const json_t *v, sg_rule_id *rule)
{
    const json_t *given = json_object_get(v, "rule");
    const char *word = json_string_value(given);
    *rule = json_is_null(given) ? SG_NONE : SG_RULE_EMPTY;
    if (json_is_null(given) || (word != NULL && strcmp(word, "empty") == 0))
        return SG_OK;
    const json_int_t k = json_is_integer(given) ? json_integer_value(given) : -1;
    if (k < 0 || (uint64_t)k >= sg_grammar_rule_count(r->g))
        return FAIL(r, node, "%s", "\"rule\" is missing, or no rule of the grammar");
    *rule = (sg_rule_id)k;
    return SG_OK;
}

static bool get_number(const json_t *v, double *x)
{
    const char *word = json_string_value(v);
    *x = json_number_value(v);
    if (word == NULL)
        return json_is_number(v);
    const double sign = word[0] == '-' ? -1 : 1;
    word += word[0] == '-';
    *x = copysign(strcmp(word, "inf") == 0 ? (double)INFINITY : (double)NAN, sign);
    return strcmp(word, "inf") == 0 || strcmp(word, "nan") == 0;
}

static sg_status get_numbers(const reader *r, size_t node, const json_t *v, const char *key, double *x, size_t n)
{
    const json_t *list = json_object_get(v, key);
    if ((list != NULL && !json_is_array(list)) || json_array_size(list) != n)
        return FAIL(r, node, "\"%s\": expected an array of %zu numbers", key, n);
    for (size_t i = 0; i < n; i++)
        if (!get_number(json_array_get(list, i), x + i))
            return FAIL(r, node, "\"%s\": item %zu is no number", key, i + 1);
    return SG_OK;
}

static sg_status get_depth(const reader *r, size_t node, const json_t *v, size_t parent, uint32_t *depth)
{
    const json_t *given = json_object_get(v, "depth");
    *depth = node > 0 ? r->d->nodes[parent].depth + 1 : 0;
    if (node > 0 || given == NULL)
        return SG_OK;
    const json_int_t k = json_is_integer(given) ? json_integer_value(given) : -1;
    if (k < 0 || k > UINT32_MAX)
        return FAIL(r, node, "%s", "\"depth\" is no depth");
    *depth = (uint32_t)k;
    return SG_OK;
}

static sg_status store(const reader *r, size_t node)
{
    sg_derivation *d = r->d;
    const slot *s = r->slots + node;
    if (s->json == NULL)
        return FAIL(r, node, "%s", "it is missing");
    if (node > 0 ? s->parent >= node : s->parent > 0)
        return FAIL(r, node, "%s", "its parent is not in front of it");
    sg_node n = {.parent = (uint32_t)(node - s->parent), .length = 1};
    SG_TRY(get_rule(r, node, s->json, &n.rule));
    SG_TRY(get_symbol(r, node, s->json, &n));
    SG_TRY(get_depth(r, node, s->json, s->parent, &n.depth));
    const sg_rule *rule = sg_node_rule(d, &n);
    const size_t nuniforms = rule != NULL ? rule->nuniforms : 0;
    const size_t nvalues = sg_grammar_symbol(r->g, n.symbol)->nparams + (rule != NULL ? rule->nvalues : 0);
    SG_TRY(sg_derivation_reserve(d, 1, nuniforms + 1, nvalues + 1, r->err)); /* so that both arrays are there */
    SG_TRY(get_numbers(r, node, s->json, "uniforms", d->uniforms + d->nuniforms, nuniforms));
    SG_TRY(get_numbers(r, node, s->json, "values", d->values + d->nvalues, nvalues));
    n.uniforms = (uint32_t)d->nuniforms;
    n.values = (uint32_t)d->nvalues;
    d->nuniforms += nuniforms;
    d->nvalues += nvalues;
    d->nodes[d->nnodes++] = n;
    return SG_OK;
}

/* Tied siblings stand in the text more often than in the derivation. */
static size_t highest(const reader *r)
{
    size_t n = r->count;
    while (n > 1 && r->slots[n - 1].json == NULL)
        n--;
    return n;
}

static sg_status store_all(const reader *r)
{
    const size_t n = highest(r);
    for (size_t i = 0; i < n; i++)
        SG_TRY(store(r, i));
    for (size_t i = n - 1; i > 0; i--)
        r->d->nodes[i - r->d->nodes[i].parent].length += r->d->nodes[i].length;
    return SG_OK;
}

static sg_status read_one(reader *r, const json_t *v, sg_derivation_file *out)
{
    r->count = count_nodes(v);
    r->nread = 0;
    r->number = out->n + 1;
    r->slots = calloc(r->count, sizeof *r->slots);
    if (r->slots == NULL)
        return SG_FAIL_NOMEM(r->err);
    SG_TRY(sg_derivation_file_add(out, r->g, r->err));
    r->d = out->items + out->n - 1;
    SG_TRY(collect(r, v, 0));
    SG_TRY(store_all(r));
    sg_error inner = SG_ERROR_INIT;
    const sg_status st = sg_derivation_file_check_last(out, &inner);
    if (st == SG_ENOMEM)
        return SG_FAIL_NOMEM(r->err);
    return st == SG_OK ? SG_OK
                       : SG_FAIL(r->err, st, "%.250s: derivation %zu: error: %.600s", r->name, r->number, inner.msg);
}

static sg_status read_root(const json_t *root, const char *name, const sg_grammar *g, sg_derivation_file *out, sg_error *err)
{
    const size_t n = json_is_array(root) ? json_array_size(root) : 1;
    for (size_t i = 0; i < n; i++) {
        reader r = {.g = g, .name = name, .err = err};
        const sg_status st = read_one(&r, json_is_array(root) ? json_array_get(root, i) : root, out);
        free(r.slots);
        SG_TRY(st);
    }
    return SG_OK;
}

static sg_status fail_syntax(const char *name, const json_error_t *at, sg_error *err)
{
    if (at->text[0] == '\0' || json_error_code(at) == json_error_out_of_memory) /* it says nothing then */
        return SG_FAIL_NOMEM(err);
    return SG_FAIL(err, SG_EINPUT, "%.250s:%d:%d: error: %s", name, at->line > 0 ? at->line : 1,
                   at->column > 0 ? at->column : 1, at->text);
}

sg_status sg_derivation_parse_json(const char *text, size_t length, const char *name, const sg_grammar *g,
                                   sg_derivation_file *out, sg_error *err)
{
    json_error_t at;
    if (length > TEXT_LIMIT)
        return SG_FAIL(err, SG_EINPUT, "%.250s: larger than the %zu bytes that derivations in JSON may have", name, TEXT_LIMIT);
    json_t *root = json_loadb(text, length, JSON_REJECT_DUPLICATES, &at);
    if (root == NULL)
        return fail_syntax(name, &at, err);
    sg_derivation_file f = {0};
    const sg_status st = read_root(root, name, g, &f, err);
    json_decref(root);
    if (st == SG_OK)
        *out = f;
    else
        sg_derivation_file_clear(&f);
    return st;
}
