/* SPDX-License-Identifier: GPL-3.0-or-later */
/* build_examples.c - derivations that are tried when a grammar is read, to show what can go wrong in it.
 *
 * Ranges tell what may happen; an example proves that it does. Nodes are derived breadth first from the start, with all
 * rules that are possible and a few sets of draws that are nothing special (quantiles 0.03, 0.5 and 0.97), until enough of them
 * have been seen. So nothing is warned of that does not happen, and what takes long to happen is left to the run. */
#include "config.h"

#include "grammar/build_range_priv.h"
#include "grammar/distribution_priv.h"
#include "grammar/shape_ops.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { MAX_NODES = 2000, MAX_WORK = 100000 /* operations */, TABLE = 8192 };

typedef struct {
    sg_sym symbol;
    uint32_t parent; /* itself for the start */
    double depth;
    double *args;
} node;

typedef struct {
    sg_builder *b;
    const sg_grammar *g;
    sg_arena *arena;
    node nodes[MAX_NODES];
    uint32_t n, at; /* at: the node that is looked at */
    uint64_t seen[TABLE]; /* hashes of symbol, depth and arguments; 0: free */
    size_t work;
    uint32_t ndrawn; /* draws of the rule that is looked at, so far */
    double *frame, *uniforms;
} examples;

/* ---- telling ---- */

/* "S > A(1, 2) > B": of a long way the end. */
static void say_path(const examples *x, uint32_t at, char *out, size_t size)
{
    enum { MANY = 5, ARGS = 4 };
    uint32_t way[MANY], n = 0;
    for (uint32_t i = at; n < MANY; i = x->nodes[i].parent) {
        way[n++] = i;
        if (x->nodes[i].parent == i)
            break;
    }
    size_t used = (size_t)snprintf(out, size, "%s", x->nodes[way[n - 1]].parent == way[n - 1] ? "" : "... > ");
    while (n-- > 0 && used < size) {
        const node *v = &x->nodes[way[n]];
        const sg_symbol *s = &x->g->symbols[v->symbol];
        used += (size_t)snprintf(out + used, size - used, "%.40s", s->name);
        for (uint32_t i = 0; i < s->nparams && i <= ARGS && used < size; i++) {
            if (i == ARGS)
                used += (size_t)snprintf(out + used, size - used, ", ...");
            else
                used += (size_t)snprintf(out + used, size - used, "%s%g", i == 0 ? "(" : ", ", v->args[i]);
        }
        if (used < size)
            used += (size_t)snprintf(out + used, size - used, "%s%s", s->nparams > 0 ? ")" : "", n > 0 ? " > " : "");
    }
}

/* " with u = 0.03 and v = 2": the first few named draws of r that have been made. */
static void say_draws(const examples *x, const sg_rule *r, char *out, size_t size)
{
    enum { MANY = 3 };
    const uint32_t nparams = x->g->symbols[r->lhs].nparams;
    size_t used = 0;
    int said = 0;
    out[0] = '\0';
    for (uint32_t i = 0; i < x->ndrawn && said < MANY && used < size; i++)
        if (r->draws[i].name != NULL)
            used += (size_t)snprintf(out + used, size - used, "%s%.30s = %g", said++ == 0 ? " with " : " and ",
                                     r->draws[i].name, x->frame[nparams + r->draws[i].first_value]);
}

static sg_status tell(examples *x, sg_pos at, const sg_rule *r, const char *what)
{
    char path[240], draws[140] = "";
    say_path(x, x->at, path, sizeof path);
    if (r != NULL)
        say_draws(x, r, draws, sizeof draws);
    return sg_build_warn(x->b, at.line != 0 || r == NULL ? at : x->b->rule_at[r - x->g->rules], "%s, as in %s%s", what, path,
                         draws);
}

static sg_status tell_number(examples *x, sg_expr e, const sg_rule *r, const char *what, double value)
{
    char text[120];
    if (isnan(value))
        snprintf(text, sizeof text, "%s can be no number", what);
    else
        snprintf(text, sizeof text, "%s can be %g", what, value);
    return tell(x, x->b->code_at[e], r, text);
}

/* ---- nodes ---- */

/* The finalizer of SplitMix64 (Steele, Lea and Flood, 2014). */
static uint64_t mix(uint64_t h, uint64_t v)
{
    h += v + 0x9E3779B97F4A7C15u;
    h = (h ^ (h >> 30)) * 0xBF58476D1CE4E5B9u;
    h = (h ^ (h >> 27)) * 0x94D049BB133111EBu;
    return h ^ (h >> 31);
}

/* True when such a node was there before (or the table is full). */
static bool was_seen(examples *x, sg_sym s, double depth, const double *args)
{
    uint64_t h = mix(mix(1, s), (uint64_t)depth);
    for (uint32_t i = 0; i < x->g->symbols[s].nparams; i++) {
        uint64_t bits;
        memcpy(&bits, &args[i], sizeof bits);
        h = mix(h, bits);
    }
    h |= 1;
    for (uint32_t i = 0; i < TABLE; i++) {
        uint64_t *place = &x->seen[(h + i) % TABLE];
        if (*place == h)
            return true;
        if (*place == 0) {
            *place = h;
            return false;
        }
    }
    return true;
}

static sg_status add_node(examples *x, sg_sym s, uint32_t parent, double depth, const double *args)
{
    if (x->n == MAX_NODES || was_seen(x, s, depth, args))
        return SG_OK;
    const size_t size = x->g->symbols[s].nparams * sizeof *args;
    x->work += x->g->symbols[s].nparams;
    double *copy = sg_arena_alloc(x->arena, size + 1);
    if (copy == NULL)
        return sg_build_fail_nomem(x->b);
    memcpy(copy, args, size);
    x->nodes[x->n] = (node){s, parent, depth, copy};
    x->n++;
    return SG_OK;
}

/* ---- bodies ---- */

static double eval(examples *x, sg_expr e)
{
    return sg_grammar_eval(x->g, e, x->frame, x->nodes[x->at].depth);
}

static sg_status try_successor(examples *x, const sg_rule *r, const sg_op *op)
{
    const sg_symbol *s = &x->g->symbols[op->symbol];
    double few[16], *args = few;
    if (s->kind != SG_SYMBOL_NONTERMINAL)
        return SG_OK;
    if (op->nargs > sizeof few / sizeof *few && (args = SG_NEW_ARRAY(x->arena, double, op->nargs)) == NULL)
        return sg_build_fail_nomem(x->b);
    bool good = true;
    for (uint32_t k = 0; k < op->nargs; k++) {
        args[k] = eval(x, op->args[k]);
        const bool chance = k == 0 && s->hidden && s->nparams > 0 && strncmp(s->name, "maybe ", 6) == 0;
        if (isnan(args[k]) || (chance && !(args[k] >= 0 && args[k] <= 1))) {
            good = false;
            SG_TRY(tell_number(x, op->args[k], r, chance ? "the probability" : "this argument", args[k]));
        }
    }
    return good ? add_node(x, op->symbol, x->at, x->nodes[x->at].depth + 1, args) : SG_OK;
}

static sg_status try_shape(examples *x, const sg_rule *r, const sg_op *op)
{
    if (op->shape == SG_SHAPE_COMPONENTS)
        return SG_OK;
    for (uint32_t k = 0; k < op->nargs; k++) {
        const double value = eval(x, op->args[k]);
        if (!isfinite(value))
            return tell_number(x, op->args[k], r, "this argument", value);
    }
    return SG_OK;
}

/* One operation; *skip: the block behind it is placed no time. */
static sg_status try_op(examples *x, const sg_rule *r, const sg_op *op, bool *skip)
{
    *skip = false;
    if (op->kind == SG_OP_SUCCESSOR)
        return try_successor(x, r, op);
    if (op->kind == SG_OP_SHAPE)
        return try_shape(x, r, op);
    if (op->nargs == 0 || (op->kind != SG_OP_REPEAT && op->kind != SG_OP_PART))
        return SG_OK;
    const double value = eval(x, op->args[0]), count = round(value);
    if (op->kind == SG_OP_PART)
        return value >= 0 && isfinite(value) ? SG_OK : tell_number(x, op->args[0], r, "the size of this part", value);
    *skip = !(count >= 1 && count <= SG_MAX_REPEAT);
    return count >= 0 && count <= SG_MAX_REPEAT ? SG_OK : tell_number(x, op->args[0], r, "the repeat count", value);
}

static sg_status try_body(examples *x, const sg_rule *r)
{
    for (uint32_t i = 0; i < r->nops && x->work < MAX_WORK; i++) {
        bool skip = false;
        x->work++;
        SG_TRY(try_op(x, r, &r->ops[i], &skip));
        if (skip)
            i += r->ops[i].length - 1;
    }
    return SG_OK;
}

/* ---- draws ---- */

static sg_status complain_of_draw(examples *x, const sg_rule *r, const sg_draw *d)
{
    char text[160];
    double few[8], *values = few;
    if (d->nargs > sizeof few / sizeof *few && (values = SG_NEW_ARRAY(x->arena, double, d->nargs)) == NULL)
        return sg_build_fail_nomem(x->b);
    for (uint32_t i = 0; i < d->nargs; i++)
        values[i] = eval(x, d->args[i]);
    const char *complaint = sg_distribution_complaint(d->kind, values, d->nargs);
    snprintf(text, sizeof text, "%s can fail: %s", sg_distribution_name(d->kind),
             complaint != NULL ? complaint : "impossible parameters");
    return tell(x, x->b->code_at[d->args[0]], r, text);
}

/* Draws of the rule into the frame, all from the quantiles `even` and `odd` in turn. */
static sg_status draw(examples *x, const sg_rule *r, double even, double odd, bool *good)
{
    const uint32_t nparams = x->g->symbols[r->lhs].nparams;
    *good = true;
    x->ndrawn = 0;
    for (uint32_t i = 0; i < r->nuniforms; i++)
        x->uniforms[i] = i % 2 == 0 ? even : odd;
    x->work += r->nuniforms;
    for (uint32_t i = 0; i < r->ndraws; i++) {
        const sg_draw *d = &r->draws[i];
        sg_error ignored;
        const sg_status st = sg_draw_transform(x->g, d, x->frame, x->nodes[x->at].depth, x->uniforms + d->first_uniform,
                                               x->frame + nparams + d->first_value, &ignored);
        if (st == SG_ENOMEM)
            return sg_build_fail_nomem(x->b);
        if (st != SG_OK) {
            *good = false;
            return complain_of_draw(x, r, d);
        }
        x->ndrawn++;
    }
    return SG_OK;
}

static sg_status try_rule(examples *x, sg_rule_id id)
{
    static const double quantiles[][2] = {{0.5, 0.5}, {0.03, 0.03}, {0.97, 0.97}, {0.03, 0.97}, {0.97, 0.03}};
    const sg_rule *r = &x->g->rules[id];
    const size_t n = r->nuniforms == 0 ? 1 : r->nuniforms == 1 ? 3 : 5;
    for (size_t k = 0; k < n && x->work < MAX_WORK; k++) {
        bool good = false;
        SG_TRY(draw(x, r, quantiles[k][0], quantiles[k][1], &good));
        if (good)
            SG_TRY(try_body(x, r));
    }
    return SG_OK;
}

/* ---- choices ---- */

static bool holds(examples *x, const sg_rule *r)
{
    const double guard = r->guard != SG_NONE ? eval(x, r->guard) : 1;
    return guard != 0 && !isnan(guard);
}

static sg_status try_choice(examples *x, const sg_symbol *s)
{
    double sum = 0;
    x->ndrawn = 0;
    bool any = false, good = true;
    for (sg_rule_id r = s->first_rule; r < s->first_rule + s->nrules; r++) {
        const sg_rule *rule = &x->g->rules[r];
        x->work++;
        if (!holds(x, rule))
            continue;
        const double weight = rule->weight != SG_NONE ? eval(x, rule->weight) : 1;
        any = true;
        sum += weight;
        if (weight >= 0 && weight <= DBL_MAX)
            continue;
        good = false;
        if (!s->hidden)
            SG_TRY(tell_number(x, rule->weight, rule, "the weight", weight));
    }
    if (s->hidden || !good)
        return SG_OK;
    char text[120];
    if (any && sum > 0)
        return SG_OK;
    snprintf(text, sizeof text, any ? "the weights of '%.60s' can all be zero" : "it can be that no guard of '%.60s' holds",
             s->name);
    return tell(x, x->b->symbol_at[s - x->g->symbols], NULL, text);
}

static sg_status try_node(examples *x)
{
    const node *v = &x->nodes[x->at];
    const sg_symbol *s = &x->g->symbols[v->symbol];
    memcpy(x->frame, v->args, s->nparams * sizeof *x->frame);
    if (x->g->depth_limit != SIZE_MAX && v->depth > (double)x->g->depth_limit)
        return s->completion != SG_NONE ? try_rule(x, s->completion) : SG_OK;
    if (!s->constant_weights)
        SG_TRY(try_choice(x, s));
    for (sg_rule_id r = s->first_rule; r < s->first_rule + s->nrules && x->work < MAX_WORK; r++) {
        const sg_rule *rule = &x->g->rules[r];
        const double weight = s->constant_weights ? rule->probability : rule->weight != SG_NONE ? eval(x, rule->weight) : 1;
        if (holds(x, rule) && weight > 0)
            SG_TRY(try_rule(x, r));
    }
    return SG_OK;
}

static sg_status try_all(examples *x)
{
    SG_TRY(add_node(x, x->g->start, 0, 0, x->g->start_args));
    for (x->at = 0; x->at < x->n && x->work < MAX_WORK && x->b->nwarnings < SG_MAX_WARNINGS; x->at++)
        SG_TRY(try_node(x));
    return SG_OK;
}

sg_status sg_build_try_examples(sg_builder *b, const sg_grammar *g, sg_arena *arena)
{
    examples *x = SG_NEW(arena, examples);
    uint32_t nuniforms = 0;
    for (size_t r = 0; r < g->nrules; r++)
        nuniforms = g->rules[r].nuniforms > nuniforms ? g->rules[r].nuniforms : nuniforms;
    if (x == NULL)
        return sg_build_fail_nomem(b);
    x->b = b;
    x->g = g;
    x->arena = arena;
    x->frame = SG_NEW_ARRAY(arena, double, g->frame_size);
    x->uniforms = SG_NEW_ARRAY(arena, double, nuniforms);
    if (x->frame == NULL || x->uniforms == NULL)
        return sg_build_fail_nomem(b);
    return try_all(x);
}
