/* SPDX-License-Identifier: GPL-3.0-or-later */
/* kernel_oracle.c - see kernel_oracle.h. Slow and plain: loops over states, nodes and subtrees. */
#include "tests/kernel_oracle.h"

#include "tests/grammar_support.h"

static void *grab(size_t n, size_t size)
{
    void *p = calloc(n > 0 ? n : 1, size);
    test_must(p != NULL);
    return p;
}

/* A property of the symbol, so that it does not change with the subtree: several rules, or one of them draws. */
static bool has_choice(const sg_grammar *g, sg_sym symbol)
{
    const sg_symbol *s = sg_grammar_symbol(g, symbol);
    bool draws = s->completion != SG_NONE && sg_grammar_rule(g, s->completion)->ndraws > 0;
    for (uint32_t r = 0; r < s->nrules; r++)
        draws |= sg_grammar_rule(g, s->first_rule + r)->ndraws > 0;
    return draws || s->nrules > 1;
}

static void set_jumps(kernel_model *m)
{
    for (size_t x = 0; x < m->space.n; x++)
        m->width = m->space.d[x].nnodes > m->width ? m->space.d[x].nnodes : m->width;
    m->jumps = grab(m->space.n * m->width, sizeof *m->jumps);
    for (size_t x = 0; x < m->space.n; x++)
        for (size_t v = 0; v < m->space.d[x].nnodes; v++)
            m->jumps[x * m->width + v] = has_choice(m->g, m->space.d[x].nodes[v].symbol);
}

void kernel_model_init(kernel_model *m, const char *grammar, unsigned cells, size_t max_nodes, kernel_score *score,
                       void *user)
{
    sg_error err = SG_ERROR_INIT;
    *m = (kernel_model){.g = test_grammar(grammar), .max_nodes = max_nodes};
    oracle_space_init(&m->space, cells);
    oracle_space_fill(&m->space, m->g, max_nodes);
    m->log_score = grab(m->space.n, sizeof(double));
    m->log_rules = grab(m->space.n, sizeof(double));
    m->log_density = grab(m->space.n, sizeof(double));
    m->pi = grab(m->space.n, sizeof(double));
    for (size_t x = 0; x < m->space.n; x++) {
        m->log_score[x] = score(m->space.d + x, user);
        m->log_rules[x] = log(oracle_rule_probability(m->space.d + x, 0));
        ck_ok(sg_derivation_log_density(m->space.d + x, m->log_density + x, &err));
    }
    set_jumps(m);
}

void kernel_model_clear(kernel_model *m)
{
    for (size_t i = 0; i < m->nsubtrees; i++)
        oracle_space_clear(m->subtrees + i);
    free(m->subtrees);
    oracle_space_clear(&m->space);
    free(m->log_score);
    free(m->log_rules);
    free(m->log_density);
    free(m->pi);
    free(m->jumps);
    sg_grammar_free(m->g);
}

/* Log of the target over the prior in the space of uniforms. */
static double log_weight_of(const kernel_model *m, size_t x)
{
    return m->sharpness * m->beta * m->log_score[x] + (m->sharpness - 1) * (m->log_rules[x] + m->log_density[x]);
}

void kernel_model_temper(kernel_model *m, double beta, double base, double sharpness)
{
    double sum = 0;
    m->beta = beta;
    m->base = base;
    m->sharpness = sharpness;
    m->delayed_nodes = SIZE_MAX;
    for (size_t x = 0; x < m->space.n; x++) {
        m->pi[x] = isfinite(m->log_score[x]) ? m->space.prior[x] * exp(log_weight_of(m, x)) : 0;
        sum += m->pi[x];
    }
    for (size_t x = 0; x < m->space.n; x++)
        m->pi[x] /= sum;
}

double kernel_log_weight(const kernel_model *m, size_t x)
{
    double sum = 0;
    for (size_t v = 0; v < m->space.d[x].nnodes; v++)
        if (kernel_jumps_at(m, x, v))
            sum += pow(m->base, -(double)m->space.d[x].nodes[v].depth);
    return log(sum);
}

/* All subtrees that may stand at node v of x. */
static const oracle_space *subtrees_at(kernel_model *m, const sg_derivation *x, size_t v)
{
    const sg_node *n = x->nodes + v;
    const size_t size = sg_grammar_symbol(m->g, n->symbol)->nparams * sizeof(double);
    for (size_t i = 0; i < m->nsubtrees; i++) {
        const sg_node *root = m->subtrees[i].d->nodes;
        if (root->symbol == n->symbol && root->depth == n->depth &&
            (size == 0 || memcmp(m->subtrees[i].d->values, x->values + n->values, size) == 0))
            return m->subtrees + i;
    }
    m->subtrees = realloc(m->subtrees, (m->nsubtrees + 1) * sizeof *m->subtrees);
    test_must(m->subtrees != NULL);
    oracle_space *s = m->subtrees + m->nsubtrees++;
    oracle_space_init(s, m->space.cells);
    oracle_space_fill_symbol(s, m->g, n->symbol, x->values + n->values, n->depth, m->max_nodes);
    return s;
}

static double first_stage(const kernel_model *m, const kernel_step *s)
{
    if (s->y == SIZE_MAX || m->log_score[s->y] == -INFINITY)
        return -INFINITY;
    double r = log_weight_of(m, s->y) - log_weight_of(m, s->x);
    if (s->kind > SG_MOVE_JUMP_COPY)
        r += m->log_rules[s->y] - m->log_rules[s->x];
    else if (kernel_jumps_at(m, s->y, s->v))
        r += kernel_log_weight(m, s->x) - kernel_log_weight(m, s->y); /* the depth of v is the same */
    else
        return -INFINITY;
    return r < 0 ? r : 0;
}

double kernel_right_accept(void *user, const kernel_model *m, const kernel_step *s, double p)
{
    (void)user, (void)p;
    if (s->z == SIZE_MAX)
        return first_stage(m, s);
    const double forth = first_stage(m, s); /* x -> y, rejected */
    const double back = first_stage(m, &(kernel_step){s->kind, s->z, s->v, s->back, SIZE_MAX, SIZE_MAX});
    if (m->log_score[s->z] == -INFINITY || !kernel_jumps_at(m, s->z, s->v) || back >= 0)
        return -INFINITY;
    const double r = log_weight_of(m, s->z) - log_weight_of(m, s->x) + kernel_log_weight(m, s->x) -
                     kernel_log_weight(m, s->z) + m->log_rules[s->z] - m->log_rules[s->y] + m->log_rules[s->back] -
                     m->log_rules[s->x] + log1p(-exp(back)) - log1p(-exp(forth));
    return r < 0 ? r : 0;
}

void kernel_flow_init(kernel_flow *f, const kernel_model *m)
{
    *f = (kernel_flow){.flow = grab(m->space.n * m->space.n, sizeof(double))};
}

void kernel_flow_clear(kernel_flow *f)
{
    free(f->flow);
}

/* What all steps from node v of x have in common. */
typedef struct {
    kernel_flow *f;
    const kernel_model *m;
    sg_move_kind kind;
    size_t x, v;
    const oracle_space *subs;
    size_t old;    /* subtree of x at v, among subs */
    size_t *state; /* [subs->n] of the whole space, with each subtree in place; SIZE_MAX: outside */
    kernel_accept *accept;
    void *user;
} jump_at;

static bool same_rules(const sg_derivation *a, const sg_derivation *b)
{
    if (a->nnodes != b->nnodes)
        return false;
    for (size_t i = 0; i < a->nnodes; i++)
        if (a->nodes[i].rule != b->nodes[i].rule)
            return false;
    return true;
}

/* Probability that the uniforms of subtree `to`, whose rules are given, are proposed from subtree `from`. */
static double uniforms_probability(const jump_at *j, size_t from, size_t to)
{
    const sg_derivation *a = j->subs->d + from, *b = j->subs->d + to;
    if (j->kind == SG_MOVE_JUMP_FRESH)
        return pow(j->subs->cells, -(double)b->nuniforms);
    for (size_t i = 0; i < a->nuniforms && i < b->nuniforms; i++)
        if (oracle_cell(j->subs, a, i) != oracle_cell(j->subs, b, i))
            return 0;
    return b->nuniforms > a->nuniforms ? pow(j->subs->cells, (double)a->nuniforms - (double)b->nuniforms) : 1;
}

static void add_flow(const jump_at *j, size_t to, double p)
{
    if (to != SIZE_MAX && p > 0)
        j->f->flow[j->x * j->m->space.n + to] += p;
}

/* y was rejected: all z with its rules, all ways back. */
static void second_stages(const jump_at *j, size_t y, double p)
{
    for (size_t z = 0; z < j->subs->n; z++) {
        if (!same_rules(j->subs->d + y, j->subs->d + z) || j->state[z] == SIZE_MAX)
            continue;
        const double pz = pow(j->subs->cells, -(double)j->subs->d[z].nuniforms);
        for (size_t back = 0; back < j->subs->n; back++) {
            const double pb = uniforms_probability(j, z, back);
            if (pb == 0 || !same_rules(j->subs->d + j->old, j->subs->d + back))
                continue;
            const kernel_step s = {j->kind, j->x, j->v, j->state[y], j->state[z], j->state[back]};
            j->f->second++;
            const double proposed = p * pz * pb;
            add_flow(j, j->state[z], proposed * exp(j->accept(j->user, j->m, &s, proposed)));
        }
    }
}

static void first_stages(const jump_at *j, bool delayed, double p)
{
    for (size_t y = 0; y < j->subs->n; y++) {
        const sg_derivation *s = j->subs->d + y;
        const double py =
            p * j->subs->prior[y] * pow(j->subs->cells, (double)s->nuniforms) * uniforms_probability(j, j->old, y);
        if (py == 0)
            continue;
        const kernel_step step = {j->kind, j->x, j->v, j->state[y], SIZE_MAX, SIZE_MAX};
        const double accept = exp(j->accept(j->user, j->m, &step, py));
        j->f->first++;
        j->f->proposed += py;
        add_flow(j, j->state[y], py * accept);
        const bool small = s->nnodes <= j->m->delayed_nodes && j->subs->d[j->old].nnodes <= j->m->delayed_nodes;
        if (delayed && small && accept < 1 && j->state[y] != SIZE_MAX)
            second_stages(j, y, py * (1 - accept));
    }
}

static void place_subtrees(jump_at *j)
{
    const sg_derivation *x = j->m->space.d + j->x;
    sg_derivation whole;
    sg_derivation_init(&whole, j->m->g);
    j->state = grab(j->subs->n, sizeof *j->state);
    for (size_t i = 0; i < j->subs->n; i++) {
        oracle_replace(x, j->v, j->subs->d + i, &whole);
        j->state[i] = oracle_space_find(&j->m->space, &whole);
        if (j->state[i] == j->x)
            j->old = i;
    }
    sg_derivation_clear(&whole);
}

static void add_jumps(kernel_flow *f, kernel_model *m, sg_move_kind kind, bool delayed, double share,
                      kernel_accept *accept, void *user, size_t x)
{
    const double weight = exp(kernel_log_weight(m, x));
    for (size_t v = 0; v < m->space.d[x].nnodes; v++) {
        if (!kernel_jumps_at(m, x, v))
            continue;
        jump_at j = {f, m, kind, x, v, subtrees_at(m, m->space.d + x, v), 0, NULL, accept, user};
        place_subtrees(&j);
        first_stages(&j, delayed, share * m->pi[x] * pow(m->base, -(double)m->space.d[x].nodes[v].depth) / weight);
        free(j.state);
    }
}

static size_t nuniforms_of(const sg_derivation *d, size_t v)
{
    return d->nodes[v].rule >= SG_RULE_EMPTY ? 0 : sg_grammar_rule(d->grammar, d->nodes[v].rule)->nuniforms;
}

/* The state with other cells at node v, SIZE_MAX when the tree cannot be with them. code: the cells as digits. */
static size_t with_cells(const kernel_model *m, size_t x, size_t v, size_t n, size_t code)
{
    sg_derivation d;
    sg_derivation_init(&d, m->g);
    oracle_replace(m->space.d + x, 0, m->space.d + x, &d);
    for (size_t i = 0; i < n; i++, code /= m->space.cells)
        d.uniforms[d.nodes[v].uniforms + i] = ((double)(code % m->space.cells) + 0.5) / m->space.cells;
    const bool possible = oracle_refresh(&d, v) && oracle_rule_probability(&d, v) > 0;
    const size_t state = possible ? oracle_space_find(&m->space, &d) : SIZE_MAX;
    test_must(!possible || state != SIZE_MAX);
    sg_derivation_clear(&d);
    return state;
}

static void add_resampling(kernel_flow *f, const kernel_model *m, double share, kernel_accept *accept, void *user,
                           size_t x)
{
    const sg_derivation *d = m->space.d + x;
    double weight = 0;
    for (size_t v = 0; v < d->nnodes; v++)
        weight += nuniforms_of(d, v) > 0 ? pow(m->base, -(double)d->nodes[v].depth) : 0;
    for (size_t v = 0; v < d->nnodes; v++) {
        const size_t n = nuniforms_of(d, v), combinations = (size_t)pow(m->space.cells, (double)n);
        for (size_t code = 0; n > 0 && code < combinations; code++) {
            const kernel_step s = {SG_MOVE_RESAMPLE, x, v, with_cells(m, x, v, n, code), SIZE_MAX, SIZE_MAX};
            const double p =
                share * m->pi[x] * pow(m->base, -(double)d->nodes[v].depth) / weight / (double)combinations;
            f->first++;
            f->proposed += p;
            const double moved = p * exp(accept(user, m, &s, p));
            if (s.y != SIZE_MAX)
                f->flow[x * m->space.n + s.y] += moved;
        }
    }
}

void kernel_add(kernel_flow *f, kernel_model *m, sg_move_kind kind, bool delayed, double share, kernel_accept *accept,
                void *user)
{
    for (size_t x = 0; x < m->space.n; x++) {
        if (m->pi[x] == 0)
            continue;
        if (kind == SG_MOVE_RESAMPLE)
            add_resampling(f, m, share, accept, user, x);
        else
            add_jumps(f, m, kind, delayed, share, accept, user, x);
    }
}

double kernel_imbalance(const kernel_flow *f, const kernel_model *m)
{
    double sum = 0;
    for (size_t x = 0; x < m->space.n; x++) {
        double in_minus_out = 0;
        for (size_t y = 0; y < m->space.n; y++)
            in_minus_out += f->flow[y * m->space.n + x] - f->flow[x * m->space.n + y];
        sum += fabs(in_minus_out);
    }
    return sum;
}

double kernel_irreversibility(const kernel_flow *f, const kernel_model *m)
{
    double largest = 0;
    for (size_t x = 0; x < m->space.n; x++)
        for (size_t y = 0; y < x; y++)
            largest = fmax(largest, fabs(f->flow[y * m->space.n + x] - f->flow[x * m->space.n + y]));
    return largest;
}
