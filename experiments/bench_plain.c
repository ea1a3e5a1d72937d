/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench_plain.c - a plain sampler and a plain interpreter: see bench_plain.h. */
#include "bench_plain.h"

#include "grammar/shape_ops.h"
#include "scene/scene.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_math.h>
#include <stdlib.h>
#include <string.h>

typedef struct plain_node {
    const sg_rule *rule;
    double *arguments, *uniforms, *values;
    struct plain_node **children;
    size_t nchildren;
} plain_node;

static void *get(size_t n, size_t size)
{
    void *p = calloc(n > 0 ? n : 1, size);
    if (p == NULL)
        abort();
    return p;
}

static const sg_rule *choose(const sg_grammar *g, sg_sym symbol, const double *args, double depth, gsl_rng *rng)
{
    const sg_symbol *s = sg_grammar_symbol(g, symbol);
    double *p = get(s->nrules, sizeof *p), u = gsl_rng_uniform(rng);
    if (sg_grammar_rule_probabilities(g, symbol, args, depth, p, NULL) != SG_OK)
        abort();
    uint32_t i = 0;
    while (i + 1 < s->nrules && u >= p[i])
        u -= p[i++];
    free(p);
    return sg_grammar_rule(g, s->first_rule + i);
}

static plain_node *derive(const sg_grammar *g, sg_sym symbol, const double *args, double depth, gsl_rng *rng, size_t *count)
{
    plain_node *n = get(1, sizeof *n);
    const uint32_t nparams = sg_grammar_symbol(g, symbol)->nparams;
    n->rule = choose(g, symbol, args, depth, rng);
    n->arguments = get(nparams, sizeof *n->arguments);
    n->uniforms = get(n->rule->nuniforms, sizeof *n->uniforms);
    n->values = get(nparams + n->rule->nvalues, sizeof *n->values);
    for (uint32_t i = 0; i < nparams; i++)
        n->arguments[i] = n->values[i] = args[i];
    for (uint32_t k = 0; k < n->rule->ndraws; k++) {
        const sg_draw *d = n->rule->draws + k;
        n->uniforms[k] = gsl_rng_uniform_pos(rng);
        n->values[nparams + k] = d->constants[0] + d->constants[1] * gsl_cdf_ugaussian_Pinv(n->uniforms[k]);
    }
    n->children = get(n->rule->nchildren, sizeof *n->children);
    for (uint32_t i = 0; i < n->rule->nchildren; i++) {
        const sg_op *op = n->rule->ops + n->rule->child_ops[i];
        double *child = get(op->nargs, sizeof *child);
        for (uint32_t a = 0; a < op->nargs; a++)
            child[a] = sg_grammar_eval(g, op->args[a], n->values, depth);
        n->children[n->nchildren++] = derive(g, op->symbol, child, depth + 1, rng, count);
        free(child);
    }
    ++*count;
    return n;
}

static void clear(plain_node *n)
{
    for (size_t i = 0; i < n->nchildren; i++)
        clear(n->children[i]);
    free(n->children);
    free(n->values);
    free(n->uniforms);
    free(n->arguments);
    free(n);
}

size_t bench_plain_sample(const sg_grammar *g, gsl_rng *rng)
{
    size_t count = 0;
    clear(derive(g, sg_grammar_start(g), sg_grammar_start_args(g), 0, rng, &count));
    return count;
}

typedef struct {
    double m[4][4], width;
} plain_state;

typedef struct {
    sg_primitive **items;
    size_t n;
} plain_scene;

static void multiply(double a[4][4], double b[4][4])
{
    double out[4][4];
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) {
            out[i][j] = 0;
            for (int k = 0; k < 4; k++)
                out[i][j] += a[i][k] * b[k][j];
        }
    memcpy(a, out, sizeof out);
}

/* About axis k, by degrees. */
static void turn(plain_state *s, int k, double degrees)
{
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const double c = cos(degrees * M_PI / 180), z = sin(degrees * M_PI / 180);
    double r[4][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
    r[i][i] = r[j][j] = c;
    r[j][i] = z;
    r[i][j] = -z;
    multiply(s->m, r);
}

static void stretch(plain_state *s, const double *size)
{
    double r[4][4] = {{size[0], 0, 0, 0}, {0, size[1], 0, 0}, {0, 0, size[2], 0}, {0, 0, 0, 1}};
    multiply(s->m, r);
}

static void add(plain_scene *scene, const plain_state *s, uint32_t kind)
{
    sg_primitive *p = get(1, sizeof *p);
    for (int i = 0; i < 3; i++) {
        p->frame.x[i] = s->m[i][0];
        p->frame.y[i] = s->m[i][1];
        p->frame.z[i] = s->m[i][2];
        p->frame.origin[i] = s->m[i][3];
    }
    p->radius[0] = s->width / 2;
    p->kind = kind;
    if ((scene->n & (scene->n - 1)) == 0 &&
        (scene->items = realloc(scene->items, (2 * scene->n + 1) * sizeof *scene->items)) == NULL)
        abort();
    scene->items[scene->n++] = p;
}

static void draw(plain_scene *scene, plain_state *s, double length)
{
    double r[4][4] = {{1, 0, 0, 0}, {0, 1, 0, length}, {0, 0, 1, 0}, {0, 0, 0, 1}};
    add(scene, s, SG_PRIMITIVE_SEGMENT);
    multiply(s->m, r);
}

static void operate(plain_scene *scene, plain_state *s, const sg_op *op, const double *a)
{
    switch ((sg_shape_op)op->shape) {
    case SG_SHAPE_DRAW:
        draw(scene, s, a[0]);
        break;
    case SG_SHAPE_TURN:
        turn(s, 2, a[0]);
        break;
    case SG_SHAPE_PITCH:
        turn(s, 0, -a[0]);
        break;
    case SG_SHAPE_ROLL:
        turn(s, 1, a[0]);
        break;
    case SG_SHAPE_WIDTH:
        s->width = a[0];
        break;
    case SG_SHAPE_SCALE:
        stretch(s, a);
        break;
    case SG_SHAPE_INSERT:
        add(scene, s, SG_PRIMITIVE_SPHERE);
        break;
    default:
        abort();
    }
}

static void interpret(plain_scene *scene, const sg_derivation *d, size_t node, plain_state s);

static void read_block(plain_scene *scene, const sg_derivation *d, size_t node, size_t first, size_t end, plain_state *s,
                       size_t *child)
{
    const sg_node *n = d->nodes + node;
    const sg_rule *r = sg_grammar_rule(d->grammar, n->rule);
    for (size_t i = first; i < end; i += r->ops[i].length) {
        const sg_op *op = r->ops + i;
        double a[4];
        for (uint32_t k = 0; k < op->nargs && op->kind == SG_OP_SHAPE; k++)
            a[k] = sg_grammar_eval(d->grammar, op->args[k], d->values + n->values, n->depth);
        if (op->kind == SG_OP_SHAPE) {
            operate(scene, s, op, a);
        } else if (op->kind == SG_OP_PUSH) {
            plain_state inner = *s;
            read_block(scene, d, node, i + 1, i + op->length, &inner, child);
        } else {
            interpret(scene, d, *child, *s);
            *child += d->nodes[*child].length;
        }
    }
}

static void interpret(plain_scene *scene, const sg_derivation *d, size_t node, plain_state s)
{
    size_t child = node + 1;
    if (d->nodes[node].rule < SG_RULE_EMPTY)
        read_block(scene, d, node, 0, sg_grammar_rule(d->grammar, d->nodes[node].rule)->nops, &s, &child);
}

size_t bench_plain_interpret(const sg_derivation *d)
{
    plain_scene scene = {NULL, 0};
    interpret(&scene, d, 0, (plain_state){{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}, 0.1});
    for (size_t i = 0; i < scene.n; i++)
        free(scene.items[i]);
    free(scene.items);
    return scene.n;
}
