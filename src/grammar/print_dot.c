/* SPDX-License-Identifier: GPL-3.0-or-later */
/* print_dot.c - a grammar as a graph for Graphviz: symbols are ellipses, labels boxes filled with their colour, rules
 * small points between a symbol and what it becomes. */
#include "config.h"

#include "grammar/grammar_priv.h"

#include <errno.h>
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
    if (shown(g, id) != id)
        return;
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

static const char *rule_shape(const sg_rule *r)
{
    static const char *const axes[] = {"x", "y", "z"};
    return r->nops > 0 && r->ops[0].kind == SG_OP_SPLIT ? axes[r->ops[0].axis] : "";
}

/* Edges from a rule to each distinct symbol of its body, with how often it stands there. */
static void put_successors(FILE *out, const sg_grammar *g, sg_rule_id id)
{
    const sg_rule *r = &g->rules[id];
    for (uint32_t i = 0; i < r->nops; i++) {
        uint32_t times = 0, before = 0;
        if (r->ops[i].kind != SG_OP_SUCCESSOR)
            continue;
        for (uint32_t j = 0; j < r->nops; j++)
            if (r->ops[j].kind == SG_OP_SUCCESSOR && r->ops[j].symbol == r->ops[i].symbol) {
                times++;
                before += j < i;
            }
        if (before > 0)
            continue;
        fprintf(out, "  r%u -> s%u", id, shown(g, r->ops[i].symbol));
        if (times > 1)
            fprintf(out, " [label=\"%u\"]", times);
        fputs(";\n", out);
    }
}

static void put_rule(FILE *out, const sg_grammar *g, sg_rule_id id)
{
    const sg_rule *r = &g->rules[id];
    const sg_symbol *s = &g->symbols[r->lhs];
    if (shown(g, r->lhs) != r->lhs)
        return;
    fprintf(out, "  r%u [shape=circle, width=0.15, fixedsize=true, fontsize=9, label=\"%s\"];\n", id, rule_shape(r));
    fprintf(out, "  s%u -> r%u [arrowhead=none", r->lhs, id);
    if (id == s->completion)
        fputs(", label=\"limit\", style=dotted", out);
    else if (s->constant_weights)
        fprintf(out, ", label=\"%.3g\"", r->probability);
    else
        fputs(", label=\"?\"", out);
    fputs("];\n", out);
    put_successors(out, g, id);
}

sg_status sg_grammar_print_dot(const sg_grammar *g, FILE *out, sg_error *err)
{
    errno = 0;
    fputs("digraph \"", out);
    put_text(out, g->name);
    fputs("\" {\n  rankdir=LR;\n  node [fontname=\"Helvetica\"];\n  edge [fontname=\"Helvetica\", fontsize=9];\n", out);
    for (size_t s = 0; s < g->nsymbols; s++)
        put_symbol(out, g, (sg_sym)s);
    for (size_t r = 0; r < g->nrules; r++)
        put_rule(out, g, (sg_rule_id)r);
    fputs("}\n", out);
    return ferror(out) ? SG_FAIL(err, SG_EIO, "%s", errno != 0 ? strerror(errno) : "writing failed") : SG_OK;
}
