/* SPDX-License-Identifier: GPL-3.0-or-later */
/* derivation_oracle.c - enumeration of derivations node by node, with a generator that says what it is told to. */
#include "tests/derivation_oracle.h"

#include "tests/support.h"

#include <math.h>
#include <string.h>

/* A gsl_rng that gives the middles of prescribed cells. */
typedef struct {
    const unsigned *cell;
    unsigned cells;
    size_t words; /* handed out: two 32-bit words make a uniform */
} script;

static unsigned long script_get(void *vstate)
{
    script *s = vstate;
    const double middle = (s->cell[s->words / 2] + 0.5) / s->cells;
    const uint64_t bits = (uint64_t)(middle * 0x1p52);
    return s->words++ % 2 == 0 ? (unsigned long)(bits >> 20) : (unsigned long)(bits << 12 & 0xffffffff);
}

static void script_set(void *vstate, unsigned long seed)
{
    (void)seed;
    memset(vstate, 0, sizeof(script));
}

static double script_get_double(void *vstate)
{
    return (double)script_get(vstate) / 4294967296.0;
}

static const gsl_rng_type script_type = {"script",   0xffffffff,       0, sizeof(script), script_set,
                                         script_get, script_get_double};

typedef struct {
    const sg_grammar *g;
    unsigned cells;
    size_t max_nodes;
    oracle_visit *visit;
    void *user;
    gsl_rng *rng;
} enumeration;

static void visit_completions(enumeration *e, const sg_derivation *d, double prior);

static size_t first_open(const sg_derivation *d)
{
    size_t i = 0;
    while (i < d->nnodes && d->nodes[i].rule != SG_NONE)
        i++;
    return i;
}

static void expand_with_cells(enumeration *e, const sg_derivation *d, size_t node, sg_rule_id rule,
                              const unsigned *cell, double prior)
{
    sg_error err = SG_ERROR_INIT;
    sg_derivation next;
    sg_derivation_init(&next, d->grammar);
    test_must_ok(sg_derivation_copy(&next, d, &err));
    *(script *)e->rng->state = (script){cell, e->cells, 0};
    test_must_ok(sg_derivation_expand(&next, node, rule, e->rng, &err));
    visit_completions(e, &next, prior);
    sg_derivation_clear(&next);
}

/* Counts up in base `cells`. @return false after the last */
static bool next_cells(unsigned *cell, uint32_t n, unsigned cells)
{
    for (uint32_t i = 0; i < n; i++) {
        if (++cell[i] < cells)
            return true;
        cell[i] = 0;
    }
    return false;
}

/* All ways to put the uniforms of a rule into cells. */
static void expand(enumeration *e, const sg_derivation *d, size_t node, sg_rule_id rule, double prior)
{
    enum { MAX = 8 };
    unsigned cell[MAX] = {0};
    const uint32_t n = rule == SG_RULE_EMPTY ? 0 : sg_grammar_rule(e->g, rule)->nuniforms;
    test_must(n <= MAX);
    do
        expand_with_cells(e, d, node, rule, cell, prior * pow(e->cells, -(double)n));
    while (next_cells(cell, n, e->cells));
}

/* Probability of a rule at a node, from its symbol's guards and weights; at the limit one rule must be. */
static double probability_of(const sg_derivation *d, size_t node, sg_rule_id rule)
{
    enum { MAX = 16 };
    const sg_node *n = d->nodes + node;
    const sg_symbol *s = sg_grammar_symbol(d->grammar, n->symbol);
    double p[MAX];
    sg_error err = SG_ERROR_INIT;
    if (n->depth > sg_grammar_depth_limit(d->grammar))
        return rule == (s->completion == SG_NONE ? SG_RULE_EMPTY : s->completion) ? 1 : 0;
    if (rule < s->first_rule || rule - s->first_rule >= s->nrules)
        return 0;
    test_must(s->nrules <= MAX);
    test_must_ok(sg_grammar_rule_probabilities(d->grammar, n->symbol, d->values + n->values, n->depth, p, &err));
    return p[rule - s->first_rule];
}

static void visit_completions(enumeration *e, const sg_derivation *d, double prior)
{
    const size_t node = first_open(d);
    if (d->nnodes > e->max_nodes)
        return;
    if (node == d->nnodes) {
        e->visit(e->user, d, prior);
        return;
    }
    const sg_symbol *s = sg_grammar_symbol(e->g, d->nodes[node].symbol);
    if (d->nodes[node].depth > sg_grammar_depth_limit(e->g)) {
        expand(e, d, node, s->completion == SG_NONE ? SG_RULE_EMPTY : s->completion, prior);
        return;
    }
    for (sg_rule_id r = s->first_rule; r < s->first_rule + s->nrules; r++) {
        const double p = probability_of(d, node, r);
        if (p > 0)
            expand(e, d, node, r, prior * p);
    }
}

void oracle_each(const sg_grammar *g, unsigned cells, sg_sym symbol, const double *args, uint32_t depth,
                 size_t max_nodes, oracle_visit *visit, void *user)
{
    sg_error err = SG_ERROR_INIT;
    enumeration e = {g, cells, max_nodes, visit, user, gsl_rng_alloc(&script_type)};
    sg_derivation d;
    sg_derivation_init(&d, g);
    test_must_ok(sg_derivation_open(&d, symbol, args, depth, &err));
    visit_completions(&e, &d, 1);
    sg_derivation_clear(&d);
    gsl_rng_free(e.rng);
}

void oracle_each_start(const sg_grammar *g, unsigned cells, size_t max_nodes, oracle_visit *visit, void *user)
{
    oracle_each(g, cells, sg_grammar_start(g), sg_grammar_start_args(g), 0, max_nodes, visit, user);
}

void oracle_space_init(oracle_space *s, unsigned cells)
{
    *s = (oracle_space){.cells = cells};
}

void oracle_space_clear(oracle_space *s)
{
    for (size_t i = 0; i < s->n; i++)
        sg_derivation_clear(s->d + i);
    free(s->d);
    free(s->prior);
    free(s->slots);
    oracle_space_init(s, s->cells);
}

static uint64_t mix(uint64_t h, uint64_t x)
{
    h = (h ^ x) * 0x9e3779b97f4a7c15;
    return h ^ h >> 29;
}

static uint64_t hash(const oracle_space *s, const sg_derivation *d)
{
    uint64_t h = d->nnodes;
    for (size_t i = 0; i < d->nnodes; i++)
        h = mix(mix(h, d->nodes[i].symbol), d->nodes[i].rule);
    for (size_t i = 0; i < d->nuniforms; i++)
        h = mix(h, oracle_cell(s, d, i));
    return h;
}

static bool same_cells(const oracle_space *s, const sg_derivation *a, const sg_derivation *b)
{
    if (a->nnodes != b->nnodes || a->nuniforms != b->nuniforms)
        return false;
    for (size_t i = 0; i < a->nnodes; i++)
        if (a->nodes[i].symbol != b->nodes[i].symbol || a->nodes[i].rule != b->nodes[i].rule)
            return false;
    for (size_t i = 0; i < a->nuniforms; i++)
        if (oracle_cell(s, a, i) != oracle_cell(s, b, i))
            return false;
    return true;
}

static size_t slot_of(const oracle_space *s, const sg_derivation *d)
{
    size_t slot = hash(s, d) & (s->nslots - 1);
    while (s->slots[slot] != 0 && !same_cells(s, s->d + s->slots[slot] - 1, d))
        slot = (slot + 1) & (s->nslots - 1);
    return slot;
}

static void grow(oracle_space *s)
{
    s->capacity = s->capacity > 0 ? 2 * s->capacity : 64;
    s->nslots = 4 * s->capacity;
    s->d = realloc(s->d, s->capacity * sizeof *s->d);
    s->prior = realloc(s->prior, s->capacity * sizeof *s->prior);
    free(s->slots);
    s->slots = calloc(s->nslots, sizeof *s->slots);
    test_must(s->d != NULL && s->prior != NULL && s->slots != NULL);
    for (size_t i = 0; i < s->n; i++)
        s->slots[slot_of(s, s->d + i)] = i + 1;
}

void oracle_space_add(oracle_space *s, const sg_derivation *d, double prior)
{
    sg_error err = SG_ERROR_INIT;
    if (s->n == s->capacity)
        grow(s);
    const size_t slot = slot_of(s, d);
    test_must(s->slots[slot] == 0);
    sg_derivation_init(s->d + s->n, d->grammar);
    test_must_ok(sg_derivation_copy(s->d + s->n, d, &err));
    s->prior[s->n] = prior;
    s->slots[slot] = ++s->n;
}

static void add_visited(void *user, const sg_derivation *d, double prior)
{
    oracle_space_add(user, d, prior);
}

void oracle_space_fill_symbol(oracle_space *s, const sg_grammar *g, sg_sym symbol, const double *args, uint32_t depth,
                              size_t max_nodes)
{
    oracle_each(g, s->cells, symbol, args, depth, max_nodes, add_visited, s);
}

void oracle_space_fill(oracle_space *s, const sg_grammar *g, size_t max_nodes)
{
    oracle_each_start(g, s->cells, max_nodes, add_visited, s);
}

size_t oracle_space_find(const oracle_space *s, const sg_derivation *d)
{
    const size_t found = s->slots[slot_of(s, d)];
    return found == 0 ? SIZE_MAX : found - 1;
}

size_t oracle_uniforms(const sg_derivation *d, size_t node, size_t *n)
{
    const size_t end = node + d->nodes[node].length;
    const size_t first = d->nodes[node].uniforms;
    *n = (end < d->nnodes ? d->nodes[end].uniforms : d->nuniforms) - first;
    return first;
}

static size_t values_end(const sg_derivation *d, size_t node)
{
    const size_t end = node + d->nodes[node].length;
    return end < d->nnodes ? d->nodes[end].values : d->nvalues;
}

static void append_nodes(sg_derivation *out, const sg_derivation *from, size_t first, size_t end)
{
    memcpy(out->nodes + out->nnodes, from->nodes + first, (end - first) * sizeof *out->nodes);
    for (size_t i = first; i < end; i++) {
        sg_node *n = out->nodes + out->nnodes + (i - first);
        n->values = (uint32_t)(out->nvalues + (n->values - from->nodes[first].values));
        n->uniforms = (uint32_t)(out->nuniforms + (n->uniforms - from->nodes[first].uniforms));
    }
    if (first == end)
        return;
    const size_t values = end < from->nnodes ? from->nodes[end].values : from->nvalues;
    const size_t uniforms = end < from->nnodes ? from->nodes[end].uniforms : from->nuniforms;
    const size_t value = from->nodes[first].values, uniform = from->nodes[first].uniforms;
    if (values > value)
        memcpy(out->values + out->nvalues, from->values + value, (values - value) * sizeof *out->values);
    if (uniforms > uniform)
        memcpy(out->uniforms + out->nuniforms, from->uniforms + uniform, (uniforms - uniform) * sizeof *out->uniforms);
    out->nnodes += end - first;
    out->nvalues += values - value;
    out->nuniforms += uniforms - uniform;
}

static void make_room(sg_derivation *d, size_t nodes, size_t values, size_t uniforms)
{
    if (d->nodes_capacity < nodes)
        d->nodes = realloc(d->nodes, (d->nodes_capacity = nodes) * sizeof *d->nodes);
    if (d->values_capacity < values)
        d->values = realloc(d->values, (d->values_capacity = values) * sizeof *d->values);
    if (d->uniforms_capacity < uniforms)
        d->uniforms = realloc(d->uniforms, (d->uniforms_capacity = uniforms) * sizeof *d->uniforms);
    test_must(d->nodes != NULL && (values == 0 || d->values != NULL) && (uniforms == 0 || d->uniforms != NULL));
}

/* Distances to parents and lengths from symbols' order alone: depths in pre-order say who is whose child. */
static void mend_links(sg_derivation *d)
{
    for (size_t i = 0; i < d->nnodes; i++) {
        size_t end = i + 1, parent = i;
        while (end < d->nnodes && d->nodes[end].depth > d->nodes[i].depth)
            end++;
        while (parent > 0 && d->nodes[parent].depth >= d->nodes[i].depth)
            parent--;
        d->nodes[i].length = (uint32_t)(end - i);
        d->nodes[i].parent = (uint32_t)(i - parent);
    }
}

void oracle_replace(const sg_derivation *x, size_t node, const sg_derivation *slice, sg_derivation *out)
{
    out->grammar = x->grammar;
    make_room(out, x->nnodes + slice->nnodes, x->nvalues + slice->nvalues, x->nuniforms + slice->nuniforms);
    out->nnodes = out->nvalues = out->nuniforms = 0;
    append_nodes(out, x, 0, node);
    const size_t before = out->nvalues;
    test_must(before == (node == 0 ? 0 : x->nodes[node].values));
    append_nodes(out, slice, 0, slice->nnodes);
    append_nodes(out, x, node + x->nodes[node].length, x->nnodes);
    test_must(out->nvalues == (x->nvalues - (values_end(x, node) - x->nodes[node].values) + slice->nvalues));
    mend_links(out);
}

double oracle_rule_probability(const sg_derivation *d, size_t node)
{
    double p = 1;
    for (size_t i = node; i < node + d->nodes[node].length; i++)
        p *= probability_of(d, i, d->nodes[i].rule);
    return p;
}

bool oracle_refresh(sg_derivation *d, size_t node)
{
    const sg_status st = sg_derivation_refresh(d, node, NULL);
    test_must(st == SG_OK || st == SG_ENUMERIC);
    return st == SG_OK;
}

bool oracle_same(const sg_derivation *a, const sg_derivation *b)
{
    return a->nnodes == b->nnodes && a->nvalues == b->nvalues && a->nuniforms == b->nuniforms &&
           (a->nnodes == 0 || memcmp(a->nodes, b->nodes, a->nnodes * sizeof *a->nodes) == 0) &&
           (a->nvalues == 0 || memcmp(a->values, b->values, a->nvalues * sizeof *a->values) == 0) &&
           (a->nuniforms == 0 || memcmp(a->uniforms, b->uniforms, a->nuniforms * sizeof *a->uniforms) == 0);
}
