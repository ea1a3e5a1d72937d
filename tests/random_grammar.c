/* SPDX-License-Identifier: GPL-3.0-or-later */
/* random_grammar.c - random valid grammars. Symbol i is placed by one with a smaller number in a rule that is always
 * possible, and that rule places only symbols with larger numbers: so all symbols are reachable and productive. */
#include "tests/random_grammar.h"

#include "core/random.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_SYMBOLS = 12, MAX_LABELS = 4, MAX_NAMES = 40, MAX_FUNCTIONS = 3 };

typedef struct {
    FILE *out;
    gsl_rng *rng;
    const random_grammar_opts *opts;
    const char *symbol[MAX_SYMBOLS], *label[MAX_LABELS];
    unsigned nparams[MAX_SYMBOLS], parent[MAX_SYMBOLS], nsymbols, nlabels;
    unsigned nconstants, nfunctions, arity[MAX_FUNCTIONS];
    bool tied, weights, limit;
    const char *name[MAX_NAMES]; /* numbers' names in scope */
    char draw_name[MAX_NAMES][8];
    unsigned nnames, ndraws;
    bool draws_allowed;
} writer;

static unsigned below(writer *w, unsigned n)
{
    return (unsigned)gsl_rng_uniform_int(w->rng, n);
}

static bool chance(writer *w, double p)
{
    return gsl_rng_uniform(w->rng) < p;
}

/* A token, with something between it and the next. */
static void put(writer *w, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void put(writer *w, const char *format, ...)
{
    static const char *const strange[] = {" ", "  ", "\n", "\t", " # a note: rule -> { 1\n", "\r\n", " #\n"};
    va_list ap;
    va_start(ap, format);
    vfprintf(w->out, format, ap);
    va_end(ap);
    fputs(w->opts->strange_layout && chance(w, 0.3) ? strange[below(w, 7)] : " ", w->out);
}

static const char *const plain_symbols[MAX_SYMBOLS] = {"A", "Be", "C_1", "D", "E", "Facade", "Gx", "H2", "I", "J", "K", "L"};
static const char *const strange_symbols[MAX_SYMBOLS] = {"Tür", "\"split\"",  "\"two words\"", "_", "\"q\\\"uote\\\\\"",
                                                         "étage", "\"3x\"",   "窓",            "x", "depth_",
                                                         "turn", "roof"};

static void put_number(writer *w)
{
    static const char *const some[] = {"0", "1", "0.5", "3", "2.5e-3", ".25", "7.", "12.125", "1e2", "0.1"};
    if (chance(w, 0.3))
        put(w, "%.17g", gsl_rng_uniform(w->rng) * 4);
    else
        put(w, "%s", some[below(w, 10)]);
}

static void put_expr(writer *w, unsigned depth);
static void put_distribution(writer *w, unsigned depth);

static void put_binary(writer *w, unsigned depth)
{
    static const char *const ops[] = {"+", "-", "*", "<", "<=", ">", ">=", "==", "!=", "and", "or"};
    put(w, "(");
    put_expr(w, depth);
    put(w, "%s", ops[below(w, 11)]);
    put_expr(w, depth);
    put(w, ")");
}

/* Without parentheses of its own where precedence makes it unambiguous anyway. */
static void put_chain(writer *w, unsigned depth)
{
    static const char *const ops[] = {"+", "-", "*"};
    for (unsigned n = 1 + below(w, 3); n > 0; n--) {
        put_expr(w, depth);
        put(w, "%s", ops[below(w, 3)]);
    }
    put_expr(w, depth);
}

static void put_call(writer *w, unsigned depth)
{
    static const struct {
        const char *name;
        unsigned arity;
    } functions[] = {{"abs", 1}, {"sign", 1}, {"floor", 1}, {"ceil", 1}, {"round", 1}, {"sin", 1},
                     {"cos", 1}, {"atan", 1}, {"min", 2},   {"max", 2},  {"atan2", 2}, {"hypot", 2}, {"if", 3}};
    const unsigned f = below(w, 13 + w->nfunctions);
    const unsigned arity = f < 13 ? functions[f].arity : w->arity[f - 13];
    if (f < 13)
        put(w, "%s", functions[f].name);
    else
        put(w, "f%u", f - 13);
    put(w, "(");
    for (unsigned i = 0; i < arity; i++) {
        put_expr(w, depth);
        put(w, i + 1 < arity ? "," : ")");
    }
    if (arity == 0)
        put(w, ")");
}

/* All values stay finite whatever the names stand for, up to sizes that do not matter. */
static void put_expr(writer *w, unsigned depth)
{
    const unsigned kind = depth == 0 ? below(w, 4) : below(w, 12);
    if (kind < 2) {
        put_number(w);
    } else if (kind < 4) {
        const unsigned n = below(w, w->nnames + w->nconstants + 2);
        if (n < w->nnames)
            put(w, "%s", w->name[n]);
        else if (n < w->nnames + w->nconstants)
            put(w, "K%u", n - w->nnames);
        else
            put(w, n % 2 == 0 ? "pi" : "true");
    } else if (kind < 6) {
        put_binary(w, depth - 1);
    } else if (kind == 6) {
        put_chain(w, depth - 1);
    } else if (kind == 7) {
        put(w, chance(w, 0.5) ? "-" : "not");
        put_expr(w, depth - 1);
    } else if (kind == 8) {
        put(w, "(");
        put_expr(w, depth - 1);
        put(w, ")");
    } else if (kind == 9 && w->draws_allowed) {
        put_distribution(w, depth - 1);
    } else if (kind == 10) {
        put(w, "-");
        put_number(w);
        put(w, "^ 2");
    } else {
        put_call(w, depth - 1);
    }
}

static void put_positive(writer *w, unsigned depth)
{
    if (chance(w, 0.5)) {
        put(w, "%g", 0.1 + below(w, 30) / 10.0);
        return;
    }
    put(w, "0.25 + min ( 3 , abs (");
    put_expr(w, depth);
    put(w, ") )");
}

static void put_mixture(writer *w, unsigned depth, bool discrete)
{
    put(w, discrete ? "discrete (" : "mixture (");
    for (unsigned n = 1 + below(w, 3); n > 0; n--) {
        put(w, "(");
        put_positive(w, 0);
        put(w, ",");
        put_expr(w, depth);
        if (!discrete) {
            put(w, ",");
            put_positive(w, depth);
        }
        put(w, n > 1 ? ") ," : ")");
    }
    put(w, ")");
}

static void put_distribution(writer *w, unsigned depth)
{
    const unsigned kind = below(w, 5);
    if (kind >= 3) {
        put_mixture(w, depth, kind == 3);
        return;
    }
    if (kind == 0) {
        const int low = (int)below(w, 9) - 4;
        put(w, "uniform ( %d , %d )", low, low + 1 + (int)below(w, 3));
        return;
    }
    put(w, kind == 1 ? "normal (" : "truncated_normal (");
    put_expr(w, depth);
    put(w, ",");
    put_positive(w, depth);
    if (kind == 2) {
        put(w, ", -1 , ");
        put_positive(w, 0);
    }
    put(w, ")");
}

/* ---- bodies ---- */

static void put_items(writer *w, unsigned from, unsigned depth);

static void put_args(writer *w, unsigned n)
{
    if (n == 0)
        return;
    put(w, "(");
    for (unsigned i = 0; i < n; i++) {
        put_expr(w, 2);
        put(w, i + 1 < n ? "," : ")");
    }
}

static void put_successor(writer *w, unsigned symbol)
{
    put(w, "%s", w->symbol[symbol]);
    put_args(w, w->nparams[symbol]);
}

/* A label, or a symbol with at least this number. */
static void put_target(writer *w, unsigned from)
{
    const unsigned later = w->nsymbols - from;
    const unsigned n = below(w, w->nlabels + later);
    if (n < w->nlabels)
        put(w, "%s", w->label[n]);
    else
        put_successor(w, from + n - w->nlabels);
}

static void put_shape(writer *w)
{
    static const struct {
        const char *name;
        unsigned arity;
    } ops[] = {{"draw", 1},      {"move", 1},   {"turn", 1},      {"pitch", 1},     {"roll", 1}, {"width", 1},
               {"tropism", 4},   {"scale", 3},  {"translate", 3}, {"rotate", 3},    {"size", 3}, {"extrude", 1},
               {"flat_roof", 0}, {"hip_roof", 1}, {"gable_roof", 2}};
    const unsigned n = below(w, 19);
    if (n == 15) {
        put(w, "insert ( \"a mesh.obj\" )");
    } else if (n == 16) {
        put(w, "set_material ( #%02xab3f )", below(w, 256));
    } else if (n == 17) {
        put(w, "set_material ( brick )");
    } else if (n == 18) {
        put(w, "set_label ( %s )", w->label[below(w, w->nlabels)]);
    } else {
        put(w, "%s", ops[n].name);
        if (ops[n].arity == 0)
            put(w, "( )");
        put_args(w, ops[n].arity);
    }
}

static void put_named_draw(writer *w)
{
    if (w->nnames == MAX_NAMES || w->ndraws == MAX_NAMES)
        return;
    char *name = w->draw_name[w->ndraws];
    snprintf(name, sizeof w->draw_name[0], "d%u", w->ndraws++);
    put(w, "%s ~", name);
    put_distribution(w, 2);
    w->name[w->nnames++] = name;
}

static void put_covariance(writer *w, unsigned k)
{
    put(w, "covariance (");
    for (unsigned i = 0; i + 1 < k; i++) {
        put(w, "(");
        for (unsigned j = 0; j + 1 < k; j++)
            put(w, "%s %s", i == j ? "0.01" : i + j == 3 ? "-.002" : "1e-3", j + 2 < k ? "," : ")");
        if (i + 2 < k)
            put(w, ",");
    }
    put(w, ")");
}

static void put_sizes(writer *w, unsigned k)
{
    put(w, "sizes");
    if (chance(w, 0.8)) {
        put(w, "mean (");
        for (unsigned i = 0; i < k; i++)
            put(w, "%.17g %s", 1.0 / k, i + 1 < k ? "," : ")");
        if (chance(w, 0.5)) {
            put_covariance(w, k);
        } else {
            put(w, "sd (");
            for (unsigned i = 0; i < k; i++)
                put(w, "%.2g %s", 0.01 + gsl_rng_uniform(w->rng), i + 1 < k ? "," : ")");
        }
        return;
    }
    put(w, "examples (");
    for (unsigned rows = below(w, 3); rows < 3; rows++) {
        for (unsigned i = 0; i < k; i++)
            put(w, "%s %.17g %s", i == 0 ? "(" : "", 1.0 / k, i + 1 < k ? "," : ")");
        put(w, rows < 2 ? "," : ")");
    }
}

static void put_part_size(writer *w)
{
    const unsigned kind = below(w, 4);
    if (kind == 0)
        return;
    put(w, kind == 1 ? " " : kind == 2 ? "~" : "'");
    put_positive(w, 1);
    put(w, ":");
}

static void put_split(writer *w, unsigned from, unsigned depth, bool alone)
{
    const unsigned k = 1 + below(w, 4);
    const bool learned = alone && chance(w, 0.5);
    put(w, "split %c {", "xyz"[below(w, 3)]);
    for (unsigned i = 0; i < k; i++) {
        if (!learned)
            put_part_size(w);
        if (chance(w, 0.6))
            put_target(w, from);
        else
            put_items(w, from, depth);
        put(w, i + 1 < k ? "|" : "}");
    }
    if (learned)
        put_sizes(w, k);
}

static void put_components(writer *w, unsigned from)
{
    static const char *const faces[] = {"front", "top", "side", "all"};
    const unsigned n = 1 + below(w, 4);
    put(w, "components {");
    for (unsigned i = 0; i < n; i++) {
        put(w, "%s :", faces[i]);
        put_target(w, from);
        put(w, i + 1 < n ? "|" : "}");
    }
}

/* Between 0 and 1 whatever it depends on. */
static void put_wave(writer *w)
{
    put(w, "0.5 + 0.5 * sin (");
    put_expr(w, 1);
    put(w, ")");
}

static void put_item(writer *w, unsigned from, unsigned depth)
{
    switch (depth == 0 ? below(w, 3) : below(w, 9)) {
    case 0:
        put_target(w, from);
        break;
    case 1:
    case 2:
        put_shape(w);
        break;
    case 3:
        put_named_draw(w);
        put_shape(w); /* an item, whether a draw came or not */
        break;
    case 4:
        put(w, "[");
        put_items(w, from, depth - 1);
        put(w, "]");
        break;
    case 5:
        put_split(w, from, depth - 1, false);
        break;
    case 6:
        put(w, "repeat %c", "xyz"[below(w, 3)]);
        if (chance(w, 0.5))
            put(w, "%u", below(w, 4));
        else
            put_positive(w, 1);
        put(w, "{");
        put_items(w, from, depth - 1);
        put(w, "}");
        break;
    case 7:
        put(w, "maybe (");
        if (chance(w, 0.5))
            put(w, "0.%u", below(w, 10));
        else
            put_wave(w);
        put(w, ")");
        put_target(w, from);
        break;
    default:
        put_components(w, from);
    }
}

static void put_items(writer *w, unsigned from, unsigned depth)
{
    if (chance(w, 0.1)) {
        put(w, "nothing");
        return;
    }
    for (unsigned n = 1 + below(w, 3); n > 0; n--)
        put_item(w, from, depth);
}

/* ---- statements ---- */

static void in_scope(writer *w, unsigned nparams)
{
    static const char *const params[] = {"l", "w", "größe"};
    w->nnames = w->ndraws = 0;
    for (unsigned i = 0; i < nparams; i++)
        w->name[w->nnames++] = params[i];
    w->name[w->nnames++] = "depth";
}

static void put_head(writer *w, unsigned s)
{
    in_scope(w, w->nparams[s]);
    put(w, "rule %s", w->symbol[s]);
    if (w->nparams[s] == 0)
        return;
    for (unsigned i = 0; i < w->nparams[s]; i++)
        put(w, "%s %s", i == 0 ? "(" : ",", w->name[i]);
    put(w, ")");
}

/* The first body places the symbols whose reachability depends on this one. */
static void put_body(writer *w, unsigned s, bool first)
{
    w->draws_allowed = true;
    bool placed = false;
    for (unsigned child = s + 1; first && child < w->nsymbols; child++)
        if (w->parent[child] == s) {
            put_successor(w, child);
            placed = true;
        }
    const unsigned from = first || !w->limit ? s + 1 : w->opts->derivable ? s : 0;
    if (!placed && chance(w, 0.3))
        put_split(w, from, 1, true);
    else if (!placed)
        put_items(w, from, 2);
    for (unsigned n = placed ? below(w, 3) : 0; n > 0; n--)
        put_item(w, from, 2);
    w->draws_allowed = false;
}

static void put_alternatives(writer *w, unsigned s, bool first)
{
    const unsigned n = 1 + below(w, 3);
    const unsigned style = below(w, 3);
    for (unsigned i = 0; i < n; i++) {
        in_scope(w, w->nparams[s]);
        put(w, "->");
        if (style == 0 || (style == 1 && w->weights)) {
            put(w, "%g :", n == 1 ? 1 : n == 2 ? (i == 0 ? 0.375 : 0.625) : i == 2 ? 0.5 : 0.25);
        } else if (style == 1) {
            put_positive(w, 2);
            put(w, "+ 0.01 * mod ( depth , 2 ) :"); /* never a constant */
        }
        put_body(w, s, first && i == 0);
    }
}

static void put_rules(writer *w, unsigned s)
{
    const bool guarded = chance(w, 0.3);
    put_head(w, s);
    if (guarded) {
        put(w, "if depth < 30 or");
        put_expr(w, 2);
    }
    put_alternatives(w, s, true);
    if (guarded) {
        put_head(w, s);
        put(w, "if");
        if (w->opts->derivable)
            put(w, "true");
        else {
            put(w, "depth == 0 or"); /* no guard may be one that never holds */
            put_expr(w, 2);
        }
        put_alternatives(w, s, false);
    }
    if (w->limit && chance(w, 0.4)) {
        put_head(w, s);
        put(w, "at limit ->");
        w->draws_allowed = true;
        put_shape(w);
        w->draws_allowed = false;
    }
}

static void choose(writer *w)
{
    w->nsymbols = 1 + below(w, w->opts->max_symbols < MAX_SYMBOLS ? w->opts->max_symbols : MAX_SYMBOLS);
    w->nlabels = 1 + below(w, MAX_LABELS);
    const bool strange = w->opts->strange_layout && chance(w, 0.5);
    static const char *const labels[MAX_LABELS] = {"wall", "window", "sky", "door"};
    static const char *const strange_labels[MAX_LABELS] = {"\"rule\"", "fenêtre", "\"a b\"", "draw"};
    for (unsigned s = 0; s < w->nsymbols; s++) {
        w->symbol[s] = (strange ? strange_symbols : plain_symbols)[s];
        w->nparams[s] = strange && s == 10 ? 0 : below(w, 4); /* `turn` with arguments is an operation */
        w->parent[s] = s > 0 ? below(w, s) : 0;
    }
    for (unsigned l = 0; l < w->nlabels; l++)
        w->label[l] = (strange ? strange_labels : labels)[l];
    w->tied = chance(w, 0.3);
    w->weights = chance(w, 0.3);
    w->limit = w->opts->derivable || chance(w, 0.5);
}

static void put_declarations(writer *w)
{
    if (chance(w, 0.7))
        put(w, "grammar %s", chance(w, 0.5) ? "g" : "\"my grammar\"");
    if (w->limit)
        put(w, "limit depth %u", w->opts->derivable ? 4 : below(w, 20));
    if (w->tied)
        put(w, "tied");
    if (w->weights)
        put(w, "weights");
    for (unsigned n = below(w, 4); w->nconstants < n; w->nconstants++) {
        put(w, "const K%u =", w->nconstants);
        put_expr(w, 2);
    }
    for (unsigned n = below(w, MAX_FUNCTIONS + 1); w->nfunctions < n; w->nfunctions++) {
        in_scope(w, w->arity[w->nfunctions] = 1 + below(w, 3));
        put(w, "function f%u (", w->nfunctions);
        w->nnames--; /* a function knows no depth */
        for (unsigned i = 0; i < w->nnames; i++)
            put(w, "%s %s", i > 0 ? "," : "", w->name[i]);
        put(w, ") =");
        put_expr(w, 2);
        w->nnames = 0;
    }
    for (unsigned l = 0; l < w->nlabels; l++) {
        fprintf(w->out, "label %s ", w->label[l]);
        if (chance(w, 0.5))
            put(w, "#%06x", below(w, 0xFFFFFF));
    }
    fputc('\n', w->out);
    if (chance(w, 0.3))
        put(w, "material brick #%06x", below(w, 0xFFFFFF));
}

char *random_grammar_text(gsl_rng *rng, const random_grammar_opts *opts)
{
    char *text = NULL;
    size_t size = 0;
    writer w;
    memset(&w, 0, sizeof w);
    w.out = open_memstream(&text, &size);
    w.rng = rng;
    w.opts = opts;
    if (w.out == NULL)
        return NULL;
    choose(&w);
    put_declarations(&w);
    w.nnames = 0;
    put(&w, "start");
    put_successor(&w, 0);
    for (unsigned s = 0; s < w.nsymbols; s++)
        put_rules(&w, s);
    return fclose(w.out) == 0 ? text : NULL;
}

/* ---- split forms ---- */

/* Probabilities with sum 1 up to rounding. */
static void draw_probabilities(gsl_rng *rng, double *p, size_t n)
{
    double left = 1;
    for (size_t i = 0; i + 1 < n; i++) {
        p[i] = left * (0.1 + 0.5 * gsl_rng_uniform(rng));
        left -= p[i];
    }
    p[n - 1] = left;
}

static void draw_sizes(gsl_rng *rng, double *s, size_t n)
{
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += s[i] = 0.05 + gsl_rng_uniform(rng);
    for (size_t i = 0; i < n; i++)
        s[i] /= sum;
}

static void add_sizes(gsl_rng *rng, const random_split_opts *opts, sg_arena *arena, sg_split_rule *r)
{
    const size_t k = r->n, n = k - 1;
    if (opts->attributes && gsl_rng_uniform(rng) < 0.5) {
        r->nattributes = 1 + gsl_rng_uniform_int(rng, 4);
        double *a = SG_NEW_ARRAY(arena, double, r->nattributes * k);
        for (size_t i = 0; i < r->nattributes; i++)
            draw_sizes(rng, a + i * k, k);
        r->attributes = a;
    }
    if (!opts->sizes || gsl_rng_uniform(rng) < 0.4)
        return;
    double *mean = SG_NEW_ARRAY(arena, double, k), *covariance = SG_NEW_ARRAY(arena, double, n * n);
    double *factor = SG_NEW_ARRAY(arena, double, n * n);
    draw_sizes(rng, mean, k);
    for (size_t i = 0; i < n * n; i++)
        factor[i] = 0.1 * (gsl_rng_uniform(rng) - 0.5);
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j <= i; j++) {
            double sum = i == j ? 1e-4 : 0;
            for (size_t c = 0; c < n; c++)
                sum += factor[i * n + c] * factor[j * n + c];
            covariance[i * n + j] = covariance[j * n + i] = sum;
        }
    r->mean = mean;
    r->covariance = covariance;
}

/* A rule of symbol s: lexical, or a split into symbols from `from` on. */
static void draw_rule(gsl_rng *rng, const random_split_opts *opts, const sg_split_form *f, uint32_t s, uint32_t from,
                      sg_arena *arena, sg_split_rule *r)
{
    r->lhs = s;
    r->source = SG_NONE;
    r->op = from >= f->nsymbols ? SG_SPLIT_LEXICAL : (sg_split_op)gsl_rng_uniform_int(rng, 3);
    r->n = r->op == SG_SPLIT_LEXICAL ? 1 : 1 + (uint32_t)gsl_rng_uniform_int(rng, opts->max_length);
    uint32_t *rhs = SG_NEW_ARRAY(arena, uint32_t, r->n);
    for (uint32_t i = 0; i < r->n; i++)
        rhs[i] = r->op == SG_SPLIT_LEXICAL ? (uint32_t)gsl_rng_uniform_int(rng, f->nterminals)
                                           : from + (uint32_t)gsl_rng_uniform_int(rng, f->nsymbols - from);
    r->rhs = rhs;
    if (r->op != SG_SPLIT_LEXICAL)
        add_sizes(rng, opts, arena, r);
}

/* The rule of s that places the symbols whose parent s is, in any order of axes. */
static void draw_parent_rule(gsl_rng *rng, const random_split_opts *opts, const sg_split_form *f, const uint32_t *parent,
                             uint32_t s, sg_arena *arena, sg_split_rule *r)
{
    uint32_t *rhs = SG_NEW_ARRAY(arena, uint32_t, f->nsymbols), n = 0;
    for (uint32_t c = s + 1; c < f->nsymbols; c++)
        if (parent[c] == s)
            rhs[n++] = c;
    if (n == 0) {
        draw_rule(rng, opts, f, s, s + 1, arena, r);
        return;
    }
    r->lhs = s;
    r->source = SG_NONE;
    r->op = (sg_split_op)gsl_rng_uniform_int(rng, 2);
    r->n = n;
    r->rhs = rhs;
    add_sizes(rng, opts, arena, r);
}

void random_split_form(gsl_rng *rng, const random_split_opts *opts, sg_arena *arena, sg_split_form *out)
{
    enum { MAX_RULES = 4 };
    memset(out, 0, sizeof *out);
    out->name = "random";
    out->tied = gsl_rng_uniform(rng) < 0.3;
    out->nsymbols = 1 + gsl_rng_uniform_int(rng, opts->max_symbols);
    out->nterminals = 1 + gsl_rng_uniform_int(rng, opts->max_terminals);
    const char **names = SG_NEW_ARRAY(arena, const char *, out->nsymbols);
    const char **terminals = SG_NEW_ARRAY(arena, const char *, out->nterminals);
    uint32_t *colors = SG_NEW_ARRAY(arena, uint32_t, out->nterminals);
    uint32_t *parent = SG_NEW_ARRAY(arena, uint32_t, out->nsymbols);
    sg_split_rule *rules = SG_NEW_ARRAY(arena, sg_split_rule, out->nsymbols * MAX_RULES);
    for (uint32_t t = 0; t < out->nterminals; t++) {
        terminals[t] = sg_arena_printf(arena, "t%u", t);
        colors[t] = (uint32_t)gsl_rng_uniform_int(rng, 0x1000000);
    }
    for (uint32_t s = 0; s < out->nsymbols; s++) {
        names[s] = sg_arena_printf(arena, s % 3 == 2 ? "split %u" : "S%u", s);
        parent[s] = s > 0 ? (uint32_t)gsl_rng_uniform_int(rng, s) : 0;
    }
    out->symbol_names = names;
    out->terminal_names = terminals;
    out->terminal_colors = colors;
    for (uint32_t s = 0; s < out->nsymbols; s++) {
        const size_t n = 1 + gsl_rng_uniform_int(rng, MAX_RULES), first = out->nrules;
        double p[MAX_RULES];
        draw_probabilities(rng, p, n);
        for (size_t i = 0; i < n; i++, out->nrules++) {
            sg_split_rule *r = &rules[out->nrules];
            if (i == 0)
                draw_parent_rule(rng, opts, out, parent, s, arena, r);
            else
                draw_rule(rng, opts, out, s, 0, arena, r);
            r->probability = p[out->nrules - first];
        }
    }
    out->rules = rules;
}
