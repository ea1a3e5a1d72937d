/* SPDX-License-Identifier: GPL-3.0-or-later */
/* print_dot.c - a grammar as a graph for Graphviz, the generator graph of Haubenwallner et al., "ShapeGenetics: using genetic
 * algorithms for procedural modeling", Computer Graphics Forum 36(2) (2017): nodes are symbols, ellipses; an edge leads from a
 * symbol to each one that it may produce, to itself where it is recursive. Terminals stand apart, at the end: labels as boxes
 * in their colours, shape operations that leave something behind in grey. An edge tells the probability that one use of the
 * symbol produces the other at all, where it is constant. */
#include "config.h"

#include "grammar/grammar_priv.h"
#include "grammar/shape_ops.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

static void put_text(FILE *out, const char *s)
{
    for (; *s != '\0'; s++) {
        if (*s == '"' || *s == '\\')
            fputc('\\', out);
        fputc(*s, out);
    }
}

/* Dark labels get white letters (weights of ITU-R BT.601). */
static const char *letters(uint32_t color)
{
    const unsigned luma = 299 * (color >> 16 & 255) + 587 * (color >> 8 & 255) + 114 * (color & 255);
    return luma < 128000 ? "white" : "black";
}

/* A hidden lexical symbol is drawn as the label that it stands for. */
static sg_sym shown(const sg_grammar *g, sg_sym s)
{
    const sg_symbol *x = &g->symbols[s];
    return x->hidden && x->completion != SG_NONE ? g->rules[x->first_rule].ops[0].symbol : s;
}

static void put_symbol(FILE *out, const sg_grammar *g, sg_sym id)
{
    const sg_symbol *s = &g->symbols[id];
    fprintf(out, "  s%u [label=\"", id);
    put_text(out, s->name);
    for (uint32_t i = 0; i < s->nparams; i++) {
        fputs(i == 0 ? "(" : ", ", out);
        put_text(out, s->params[i]);
    }
    fputs(s->nparams > 0 ? ")\"" : "\"", out);
    if (s->kind == SG_SYMBOL_LABEL)
        fprintf(out, ", shape=box, style=filled, fillcolor=\"#%06x\", fontcolor=%s", s->color, letters(s->color));
    else if (s->hidden)
        fputs(", style=dashed", out);
    else if (id == g->start)
        fputs(", penwidth=2", out);
    fputs("];\n", out);
}

/* What leaves something behind in space: these operations are the terminals of grammars without labels. */
static bool is_visible(const sg_op *op)
{
    if (op->kind != SG_OP_SHAPE)
        return false;
    switch ((sg_shape_op)op->shape) {
    case SG_SHAPE_DRAW:
    case SG_SHAPE_EXTRUDE:
    case SG_SHAPE_FLAT_ROOF:
    case SG_SHAPE_GABLE_ROOF:
    case SG_SHAPE_HIP_ROOF:
    case SG_SHAPE_INSERT:
        return true;
    default:
        return false;
    }
}

/* The mesh that is put in, -1 for other operations: different meshes are different terminals. */
static long mesh_of(const sg_grammar *g, const sg_op *op)
{
    return op->shape == SG_SHAPE_INSERT ? (long)sg_grammar_eval(g, op->args[0], NULL, 0) : -1;
}

/* What an operation places, as a number: symbols first, then operations, then meshes. @return false for the others */
static bool target_of(const sg_grammar *g, const sg_op *op, size_t *target)
{
    if (op->kind == SG_OP_SUCCESSOR) {
        *target = shown(g, op->symbol);
        return true;
    }
    if (!is_visible(op))
        return false;
    const long mesh = mesh_of(g, op);
    *target = g->nsymbols + (mesh < 0 ? op->shape : SG_SHAPE_COUNT + (size_t)mesh);
    return true;
}

static void put_terminal(FILE *out, const sg_grammar *g, size_t target)
{
    const size_t k = target - g->nsymbols;
    fprintf(out, "  s%zu [label=\"", target);
    if (k < SG_SHAPE_COUNT)
        put_text(out, sg_shape_op_info((sg_shape_op)k)->name);
    else
        put_text(out, sg_grammar_string(g, (uint32_t)(k - SG_SHAPE_COUNT)));
    fputs("\", shape=box, style=filled, fillcolor=\"#d8d8d8\"];\n", out);
}

/* What a symbol's rules place, while they are looked through. */
typedef struct {
    double *probability; /* [targets] of the rules that place it, added up */
    uint32_t *most;      /* [targets] how often one rule places it at most; 0: no rule does */
    uint32_t *here;      /* [targets] how often this rule does */
    bool *chosen;        /* [targets] a rule that is chosen, not only one at the limit */
    size_t n;
} targets;

static void read_rule(const sg_grammar *g, sg_rule_id id, targets *t)
{
    const sg_rule *r = &g->rules[id];
    const bool limit = id == g->symbols[r->lhs].completion;
    size_t target;
    for (uint32_t i = 0; i < r->nops; i++) {
        if (!target_of(g, r->ops + i, &target))
            continue;
        if (t->here[target]++ == 0 && !limit) {
            t->probability[target] += r->probability;
            t->chosen[target] = true;
        }
        t->most[target] = t->here[target] > t->most[target] ? t->here[target] : t->most[target];
    }
    for (uint32_t i = 0; i < r->nops; i++)
        if (target_of(g, r->ops + i, &target))
            t->here[target] = 0;
}

static void put_edges(FILE *out, const sg_grammar *g, sg_sym id, targets *t)
{
    const sg_symbol *s = &g->symbols[id];
    memset(t->probability, 0, t->n * sizeof *t->probability);
    memset(t->most, 0, t->n * sizeof *t->most);
    memset(t->chosen, 0, t->n * sizeof *t->chosen);
    for (uint32_t i = 0; i < s->nrules; i++)
        read_rule(g, s->first_rule + i, t);
    if (s->completion != SG_NONE)
        read_rule(g, s->completion, t);
    for (size_t k = 0; k < t->n; k++) {
        if (t->most[k] == 0)
            continue;
        fprintf(out, "  s%u -> s%zu [label=\"", id, k);
        if (!t->chosen[k])
            fputs("limit", out);
        else if (!s->constant_weights)
            fputc('?', out);
        else if (t->probability[k] < 1 - 1e-9)
            fprintf(out, "%.3g", t->probability[k]);
        if (t->most[k] > 1)
            fprintf(out, " (%u)", t->most[k]);
        fprintf(out, "\"%s];\n", t->chosen[k] ? "" : ", style=dotted");
    }
}

static void put_nodes(FILE *out, const sg_grammar *g, targets *t)
{
    size_t target;
    for (size_t s = 0; s < g->nsymbols; s++)
        if (g->symbols[s].kind != SG_SYMBOL_LABEL && shown(g, (sg_sym)s) == s)
            put_symbol(out, g, (sg_sym)s);
    for (size_t r = 0; r < g->nrules; r++)
        for (uint32_t i = 0; i < g->rules[r].nops; i++)
            if (target_of(g, g->rules[r].ops + i, &target))
                t->most[target] = 1;
    fputs("  subgraph terminals {\n  rank=sink;\n", out);
    for (size_t s = 0; s < g->nsymbols; s++)
        if (g->symbols[s].kind == SG_SYMBOL_LABEL)
            put_symbol(out, g, (sg_sym)s);
    for (size_t k = g->nsymbols; k < t->n; k++)
        if (t->most[k] > 0)
            put_terminal(out, g, k);
    fputs("  }\n", out);
}

static void put_graph(FILE *out, const sg_grammar *g, targets *t)
{
    fputs("digraph \"", out);
    put_text(out, g->name);
    fputs("\" {\n  rankdir=LR;\n  node [fontname=\"Helvetica\"];\n  edge [fontname=\"Helvetica\", fontsize=9];\n", out);
    put_nodes(out, g, t);
    for (size_t s = 0; s < g->nsymbols; s++)
        if (g->symbols[s].kind != SG_SYMBOL_LABEL && shown(g, (sg_sym)s) == s)
            put_edges(out, g, (sg_sym)s, t);
    fputs("}\n", out);
}

sg_status sg_grammar_print_dot(const sg_grammar *g, FILE *out, sg_error *err)
{
    targets t = {.n = g->nsymbols + SG_SHAPE_COUNT + g->nstrings};
    t.probability = calloc(t.n, sizeof *t.probability);
    t.most = calloc(t.n, sizeof *t.most);
    t.here = calloc(t.n, sizeof *t.here);
    t.chosen = calloc(t.n, sizeof *t.chosen);
    const bool good = t.probability != NULL && t.most != NULL && t.here != NULL && t.chosen != NULL;
    errno = 0;
    if (good)
        put_graph(out, g, &t);
    const int failure = errno;
    free(t.probability);
    free(t.most);
    free(t.here);
    free(t.chosen);
    if (!good)
        return SG_FAIL_NOMEM(err);
    return ferror(out) ? SG_FAIL(err, SG_EIO, "%s", failure != 0 ? strerror(failure) : "writing failed") : SG_OK;
}
