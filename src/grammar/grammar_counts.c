/* SPDX-License-Identifier: GPL-3.0-or-later */
/* grammar_counts.c - counts of symbols, rules and draws. */
#include "config.h"

#include "grammar/grammar_counts.h"

static void count_rule(const sg_rule *r, sg_grammar_counts *c)
{
    c->rules++;
    for (uint32_t k = 0; k < r->ndraws; k++)
        c->draws += r->draws[k].nvalues - (r->draws[k].kind == SG_DRAW_SIMPLEX);
    for (uint32_t i = 0; i < r->nops; i++) {
        c->operations += r->ops[i].kind == SG_OP_SHAPE;
        c->successors += r->ops[i].kind == SG_OP_SUCCESSOR;
    }
}

sg_grammar_counts sg_grammar_count(const sg_grammar *g)
{
    sg_grammar_counts c = {0};
    for (sg_sym s = 0; s < sg_grammar_symbol_count(g); s++) {
        const sg_symbol *symbol = sg_grammar_symbol(g, s);
        c.hidden += symbol->hidden;
        c.labels += symbol->kind == SG_SYMBOL_LABEL;
        if (symbol->hidden || symbol->kind == SG_SYMBOL_LABEL)
            continue;
        c.nonterminals++;
        c.arguments += symbol->nparams;
    }
    for (sg_rule_id r = 0; r < sg_grammar_rule_count(g); r++)
        if (!sg_grammar_symbol(g, sg_grammar_rule(g, r)->lhs)->hidden)
            count_rule(sg_grammar_rule(g, r), &c);
    return c;
}
