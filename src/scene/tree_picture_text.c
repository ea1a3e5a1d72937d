/* SPDX-License-Identifier: GPL-3.0-or-later */
/* tree_picture_text.c - what stands in and beside the nodes of a drawn tree. */
#include "config.h"

#include "grammar/shape_ops.h"
#include "scene/tree_picture_priv.h"

#include <stdarg.h>
#include <string.h>

enum { MAX_TEXT = 48, MAX_LINES = 14, SIZES_A_LINE = 4, LINE = 48 };

/* A text that grows in place and is cut where it becomes too long. */
typedef struct {
    char text[MAX_LINES * LINE];
    size_t n;
} words;

static void add(words *w, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void add(words *w, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    const int n = vsnprintf(w->text + w->n, sizeof w->text - w->n, format, args);
    va_end(args);
    if (n > 0)
        w->n = w->n + (size_t)n < sizeof w->text ? w->n + (size_t)n : sizeof w->text - 1;
}

/* Where a text that is longer may be cut: not in the middle of a letter of several bytes. */
static size_t cut_at(const char *text, size_t end)
{
    while (end > 0 && ((unsigned char)text[end] & 0xC0) == 0x80)
        end--;
    return end;
}

static const char *one_line(sg_arena *arena, words *w)
{
    if (w->n > MAX_TEXT)
        strcpy(w->text + cut_at(w->text, MAX_TEXT - 3), "...");
    return sg_arena_string(arena, w->text);
}

sg_sym sg_tree_label_of(const sg_grammar *g, sg_sym symbol)
{
    const sg_symbol *s = sg_grammar_symbol(g, symbol);
    return s->hidden && s->completion != SG_NONE ? sg_grammar_rule(g, s->first_rule)->ops[0].symbol : SG_NONE;
}

const char *sg_tree_node_text(sg_arena *arena, const sg_derivation *d, size_t node)
{
    const sg_symbol *s = sg_grammar_symbol(d->grammar, d->nodes[node].symbol);
    const double *args = d->values + d->nodes[node].values;
    words w = {.n = 0};
    add(&w, "%.100s", s->name);
    for (uint32_t i = 0; i < s->nparams; i++)
        add(&w, "%s%.4g", i == 0 ? "(" : ", ", args[i]);
    if (s->nparams > 0)
        add(&w, ")");
    return one_line(arena, &w);
}

const char *sg_tree_label_text(sg_arena *arena, const sg_grammar *g, sg_sym label)
{
    words w = {.n = 0};
    add(&w, "%.100s", sg_grammar_symbol(g, label)->name);
    return one_line(arena, &w);
}

static void add_argument(words *w, const sg_grammar *g, char kind, double value)
{
    if (kind == 'n')
        add(w, "%.4g", value);
    else if (kind == 'l')
        add(w, "%.100s", sg_grammar_symbol(g, (sg_sym)value)->name);
    else if (kind == 'c' && value < SG_SHAPE_STRING_ARG)
        add(w, "#%06x", (unsigned)value);
    else
        add(w, "%.100s", sg_grammar_string(g, (uint32_t)value - (kind == 'c' ? SG_SHAPE_STRING_ARG : 0)));
}

const char *sg_tree_operation_text(sg_arena *arena, const sg_derivation *d, size_t node, const sg_op *op)
{
    const sg_shape_info *info = sg_shape_op_info((sg_shape_op)op->shape);
    const sg_node *n = d->nodes + node;
    words w = {.n = 0};
    add(&w, "%s(", info->name);
    for (uint32_t i = 0; i < op->nargs; i++) {
        add(&w, "%s", i > 0 ? ", " : "");
        add_argument(&w, d->grammar, info->args[i], sg_grammar_eval(d->grammar, op->args[i], d->values + n->values, n->depth));
    }
    add(&w, ")");
    return one_line(arena, &w);
}

/* Sizes: a few on a line, and of many the first ones. */
static void add_sizes(words *w, const double *value, uint32_t n)
{
    enum { SHOWN = 3 * SIZES_A_LINE };
    for (uint32_t i = 0; i < n && i < SHOWN; i++)
        add(w, "%s%.3f", i % SIZES_A_LINE == 0 ? "\n" : " ", value[i]);
    if (n > SHOWN)
        add(w, " (%u more)", (unsigned)(n - SHOWN));
}

static void add_value(words *w, const char *name, double value)
{
    enum { LONGEST = 24 };
    if (name == NULL)
        add(w, "\n~ %.4g", value);
    else
        add(w, "\n%.*s = %.4g", (int)(strlen(name) > LONGEST ? cut_at(name, LONGEST) : LONGEST), name, value);
}

static void add_draws(words *w, const sg_rule *r, const double *values)
{
    size_t lines = 1;
    for (uint32_t k = 0; k < r->ndraws; k++) {
        const sg_draw *draw = r->draws + k;
        const bool sizes = draw->kind == SG_DRAW_SIMPLEX;
        if (lines + (sizes ? 3 : 1) > MAX_LINES - 1 && k + 1 < r->ndraws) {
            add(w, "\n(%u more draws)", (unsigned)(r->ndraws - k));
            return;
        }
        if (sizes) {
            add_sizes(w, values + draw->first_value, draw->nvalues);
            lines += 3;
        } else {
            add_value(w, draw->name, values[draw->first_value]);
            lines++;
        }
    }
}

/* Nothing is said of a rule that has no other one beside it. */
sg_status sg_tree_beside_text(sg_arena *arena, const sg_derivation *d, size_t node, const char **text, sg_error *err)
{
    const sg_node *n = d->nodes + node;
    const sg_symbol *s = sg_grammar_symbol(d->grammar, n->symbol);
    words w = {.n = 0};
    if (n->rule == SG_NONE)
        add(&w, "\nopen");
    else if (n->depth > sg_grammar_depth_limit(d->grammar))
        add(&w, "\nat the limit");
    else if (s->nrules > 1) {
        double p;
        SG_TRY(sg_derivation_rule_probability(d, node, &p, err));
        add(&w, "\np = %.3g", p);
    }
    if (n->rule < SG_RULE_EMPTY) {
        const sg_rule *r = sg_grammar_rule(d->grammar, n->rule);
        add_draws(&w, r, d->values + n->values + s->nparams);
    }
    *text = sg_arena_string(arena, w.text + (w.n > 0));
    return *text != NULL ? SG_OK : SG_FAIL_NOMEM(err);
}

size_t sg_tree_columns(const char *text, size_t *lines)
{
    size_t most = 0, here = 0;
    *lines = text[0] != '\0';
    for (; *text != '\0'; text++) {
        *lines += *text == '\n';
        here = *text == '\n' ? 0 : here + (((unsigned char)*text & 0xC0) != 0x80);
        most = here > most ? here : most;
    }
    return most;
}
