/* SPDX-License-Identifier: GPL-3.0-or-later */
/* earley_oracle.h - slow, obvious parsers to hold the Earley parser against, and random grammars to try them on. */
#ifndef SG_TESTS_EARLEY_ORACLE_H
#define SG_TESTS_EARLEY_ORACLE_H

#include "core/random.h"
#include "parse/earley.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ORACLE_SYMBOLS = 6, ORACLE_TERMINALS = 4, ORACLE_RULES = 64, ORACLE_RHS = 4, ORACLE_SIDE = 6 };

typedef struct {
    sg_split_form form;
    sg_split_rule rules[ORACLE_RULES];
    uint32_t rhs[ORACLE_RULES][ORACLE_RHS];
    const char *symbol_names[ORACLE_SYMBOLS];
    const char *terminal_names[ORACLE_TERMINALS];
} oracle_grammar;

typedef struct {
    sg_cells cells;
    uint16_t labels[ORACLE_SIDE * ORACLE_SIDE];
    double costs[ORACLE_TERMINALS * ORACLE_SIDE * ORACLE_SIDE];
} oracle_cells;

static inline uint32_t oracle_below(gsl_rng *rng, uint32_t n)
{
    return (uint32_t)(sg_random_uniform(rng) * n);
}

static inline void oracle_begin(oracle_grammar *g, uint32_t nsymbols, uint32_t nterminals)
{
    static const char *const names[] = {"A", "B", "C", "D", "E", "F"}, *const labels[] = {"a", "b", "c", "d"};
    memset(g, 0, sizeof *g);
    memcpy(g->symbol_names, names, sizeof g->symbol_names);
    memcpy(g->terminal_names, labels, sizeof g->terminal_names);
    g->form = (sg_split_form){.name = "random",
                              .nsymbols = nsymbols,
                              .symbol_names = g->symbol_names,
                              .nterminals = nterminals,
                              .terminal_names = g->terminal_names,
                              .rules = g->rules};
}

static inline void oracle_rule(oracle_grammar *g, uint32_t lhs, sg_split_op op, uint32_t n, const uint32_t *rhs,
                               double p)
{
    const size_t r = g->form.nrules++;
    memcpy(g->rhs[r], rhs, n * sizeof *rhs);
    g->rules[r] = (sg_split_rule){.lhs = lhs, .op = op, .n = n, .rhs = g->rhs[r], .probability = p};
}

/* Rules of all kinds, equal ones among them; unit rules may form cycles and loops, and a symbol in ten has no lexical
 * rule, so that it may derive nothing. */
static inline void oracle_random_grammar(oracle_grammar *g, gsl_rng *rng)
{
    oracle_begin(g, 2 + oracle_below(rng, 4), 1 + oracle_below(rng, 3));
    const uint32_t n = (uint32_t)g->form.nsymbols;
    for (uint32_t s = 0; s < n; s++) {
        const size_t first = g->form.nrules;
        const uint32_t extra = 1 + oracle_below(rng, 4), lexical = oracle_below(rng, 10) > 0;
        double sum = 0;
        for (uint32_t i = 0; i < extra; i++) {
            uint32_t rhs[ORACLE_RHS];
            const uint32_t kind = oracle_below(rng, 5), length = kind == 0 ? 1 : 2 + oracle_below(rng, 2);
            for (uint32_t k = 0; k < length; k++)
                rhs[k] = oracle_below(rng, n);
            oracle_rule(g, s, kind % 2 == 0 ? SG_SPLIT_X : SG_SPLIT_Y, length, rhs, 0.1 + sg_random_uniform(rng));
        }
        for (uint32_t i = 0; i < lexical; i++) {
            const uint32_t t = oracle_below(rng, (uint32_t)g->form.nterminals);
            oracle_rule(g, s, SG_SPLIT_LEXICAL, 1, &t, 0.1 + sg_random_uniform(rng));
        }
        for (size_t r = first; r < g->form.nrules; r++)
            sum += g->rules[r].probability;
        for (size_t r = first; r < g->form.nrules; r++)
            g->rules[r].probability /= sum;
    }
}

/* Paint the rectangle by a derivation of the symbol that is chosen at random; false when none was found. */
static inline bool oracle_paint(const oracle_grammar *g, sg_leaf_mode mode, oracle_cells *c, uint32_t symbol,
                                uint32_t x, uint32_t y, uint32_t x1, uint32_t y1, int depth, gsl_rng *rng)
{
    uint32_t candidates[ORACLE_RULES], n = 0;
    for (uint32_t r = 0; r < g->form.nrules; r++)
        if (g->rules[r].lhs == symbol)
            candidates[n++] = r;
    while (n > 0 && depth > 0) {
        const uint32_t pick = oracle_below(rng, n);
        const sg_split_rule *r = &g->rules[candidates[pick]];
        candidates[pick] = candidates[--n];
        if (r->op == SG_SPLIT_LEXICAL) {
            if (mode == SG_CELL_MODE && (x1 != x + 1 || y1 != y + 1))
                continue;
            for (uint32_t j = y; j < y1; j++)
                for (uint32_t i = x; i < x1; i++)
                    c->labels[j * c->cells.width + i] = (uint16_t)r->rhs[0];
            return true;
        }
        const uint32_t begin = r->op == SG_SPLIT_X ? x : y, end = r->op == SG_SPLIT_X ? x1 : y1;
        if (end - begin < r->n)
            continue;
        bool ok = true;
        for (uint32_t i = 0, at = begin; ok && i < r->n; i++) {
            const uint32_t room = end - at - (r->n - 1 - i);
            const uint32_t next = i + 1 == r->n ? end : at + 1 + oracle_below(rng, room);
            ok = r->op == SG_SPLIT_X ? oracle_paint(g, mode, c, r->rhs[i], at, y, next, y1, depth - 1, rng)
                                     : oracle_paint(g, mode, c, r->rhs[i], x, at, x1, next, depth - 1, rng);
            at = next;
        }
        if (ok)
            return true;
    }
    return false;
}

static inline void oracle_random_labels(const oracle_grammar *g, oracle_cells *c, size_t width, size_t height,
                                        gsl_rng *rng)
{
    c->cells = (sg_cells){width, height, c->labels, NULL};
    for (size_t i = 0; i < width * height; i++)
        c->labels[i] = (uint16_t)oracle_below(rng, (uint32_t)g->form.nterminals);
}

static inline void oracle_random_costs(const oracle_grammar *g, oracle_cells *c, size_t width, size_t height,
                                       gsl_rng *rng)
{
    c->cells = (sg_cells){width, height, NULL, c->costs};
    for (size_t i = 0; i < g->form.nterminals * width * height; i++)
        c->costs[i] = oracle_below(rng, 8) == 0 ? INFINITY : 3 * sg_random_uniform(rng);
}

/* ---- the tabular algorithm, all rectangles and all symbols ---- */

typedef struct {
    const oracle_grammar *g;
    const sg_cells *cells;
    sg_leaf_mode mode;
    bool maximum;
    const double *p; /* [nrules] */
    long double value[ORACLE_SIDE][ORACLE_SIDE][ORACLE_SIDE + 1][ORACLE_SIDE + 1][ORACLE_SYMBOLS];
} oracle_table;

static inline long double oracle_add(bool maximum, long double a, long double b)
{
    return maximum ? (a > b ? a : b) : a + b;
}

static inline long double oracle_leaf(const sg_cells *c, sg_leaf_mode mode, uint32_t terminal, size_t x, size_t y,
                                      size_t x1, size_t y1)
{
    if (mode == SG_CELL_MODE && (x1 != x + 1 || y1 != y + 1))
        return 0;
    long double cost = 0;
    for (size_t j = y; j < y1; j++)
        for (size_t i = x; i < x1; i++) {
            if (c->labels != NULL && c->labels[j * c->width + i] != terminal)
                return 0;
            if (c->costs != NULL)
                cost += c->costs[(terminal * c->height + j) * c->width + i];
        }
    return expl(-cost);
}

static inline long double oracle_split(const oracle_table *t, const sg_split_rule *r, size_t x, size_t y, size_t x1,
                                       size_t y1)
{
    const size_t begin = r->op == SG_SPLIT_X ? x : y, end = r->op == SG_SPLIT_X ? x1 : y1;
    long double d[ORACLE_SIDE + 1] = {0};
    d[begin] = 1;
    for (uint32_t i = 0; i < r->n; i++) {
        long double e[ORACLE_SIDE + 1] = {0};
        for (size_t a = begin; a < end; a++)
            for (size_t b = a + 1; b <= end; b++) {
                if (d[a] == 0 || (a == begin && b == end))
                    continue;
                const long double v =
                    r->op == SG_SPLIT_X ? t->value[a][y][b][y1][r->rhs[i]] : t->value[x][a][x1][b][r->rhs[i]];
                e[b] = oracle_add(t->maximum, e[b], d[a] * v);
            }
        memcpy(d, e, sizeof d);
    }
    return d[end];
}

static inline void oracle_rectangle(oracle_table *t, size_t x, size_t y, size_t x1, size_t y1)
{
    long double base[ORACLE_SYMBOLS] = {0}, *b = t->value[x][y][x1][y1];
    const sg_split_form *f = &t->g->form;
    for (size_t r = 0; r < f->nrules; r++) {
        const sg_split_rule *rule = &f->rules[r];
        if (rule->op != SG_SPLIT_LEXICAL && rule->n == 1)
            continue;
        const long double v = rule->op == SG_SPLIT_LEXICAL ? oracle_leaf(t->cells, t->mode, rule->rhs[0], x, y, x1, y1)
                                                           : oracle_split(t, rule, x, y, x1, y1);
        base[rule->lhs] = oracle_add(t->maximum, base[rule->lhs], t->p[r] * v);
    }
    memcpy(b, base, sizeof base);
    for (bool changed = true; changed;) { /* b = base + U b by iteration from below: no inverse to get wrong */
        long double next[ORACLE_SYMBOLS];
        memcpy(next, base, sizeof next);
        for (size_t r = 0; r < f->nrules; r++)
            if (f->rules[r].op != SG_SPLIT_LEXICAL && f->rules[r].n == 1)
                next[f->rules[r].lhs] = oracle_add(t->maximum, next[f->rules[r].lhs], t->p[r] * b[f->rules[r].rhs[0]]);
        changed = false;
        for (size_t s = 0; s < f->nsymbols; s++)
            changed |= next[s] - b[s] > 1e-18L * next[s];
        memcpy(b, next, sizeof next);
    }
}

/* log of the sum over derivations, or of the maximum. */
static inline double oracle_parse(const oracle_grammar *g, const sg_cells *cells, sg_leaf_mode mode, bool maximum,
                                  const double *p)
{
    oracle_table *t = calloc(1, sizeof *t);
    *t = (oracle_table){.g = g, .cells = cells, .mode = mode, .maximum = maximum, .p = p};
    for (size_t w = 1; w <= cells->width; w++)
        for (size_t h = 1; h <= cells->height; h++)
            for (size_t x = 0; x + w <= cells->width; x++)
                for (size_t y = 0; y + h <= cells->height; y++)
                    oracle_rectangle(t, x, y, x + w, y + h);
    const double v = (double)logl(t->value[0][0][cells->width][cells->height][g->form.axiom]);
    free(t);
    return v;
}

/* ---- brute force: every derivation that is no chain of unit rules by itself, one by one ---- */

typedef struct {
    const oracle_grammar *g;
    const sg_cells *cells;
    sg_leaf_mode mode;
    const double *p;
    long double closure[ORACLE_SYMBOLS][ORACLE_SYMBOLS]; /* sum over chains of unit rules: the power series */
} oracle_brute;

static inline void oracle_close(oracle_brute *b)
{
    long double u[ORACLE_SYMBOLS][ORACLE_SYMBOLS] = {{0}}, power[ORACLE_SYMBOLS][ORACLE_SYMBOLS] = {{0}};
    const sg_split_form *f = &b->g->form;
    bool live[ORACLE_SYMBOLS] = {false};
    for (int round = 0; round < ORACLE_SYMBOLS; round++)
        for (size_t r = 0; r < f->nrules; r++) {
            bool all = true;
            for (uint32_t i = 0; i < f->rules[r].n; i++)
                all = all && (f->rules[r].op == SG_SPLIT_LEXICAL || live[f->rules[r].rhs[i]]);
            live[f->rules[r].lhs] |= all;
        }
    for (size_t r = 0; r < f->nrules; r++)
        if (f->rules[r].op != SG_SPLIT_LEXICAL && f->rules[r].n == 1 && live[f->rules[r].rhs[0]])
            u[f->rules[r].lhs][f->rules[r].rhs[0]] += b->p[r];
    for (int i = 0; i < ORACLE_SYMBOLS; i++)
        power[i][i] = 1;
    for (long double largest = 1; largest > 1e-20L;) {
        long double next[ORACLE_SYMBOLS][ORACLE_SYMBOLS] = {{0}};
        largest = 0;
        for (int i = 0; i < ORACLE_SYMBOLS; i++)
            for (int j = 0; j < ORACLE_SYMBOLS; j++) {
                b->closure[i][j] += power[i][j];
                for (int k = 0; k < ORACLE_SYMBOLS; k++)
                    next[i][j] += power[i][k] * u[k][j];
                largest = next[i][j] > largest ? next[i][j] : largest;
            }
        memcpy(power, next, sizeof power);
    }
}

static inline long double oracle_brute_sum(const oracle_brute *b, uint32_t s, size_t x, size_t y, size_t x1, size_t y1);

static inline long double oracle_brute_rest(const oracle_brute *b, const sg_split_rule *r, uint32_t i, size_t x,
                                            size_t y, size_t x1, size_t y1)
{
    if (i + 1 == r->n)
        return oracle_brute_sum(b, r->rhs[i], x, y, x1, y1);
    long double sum = 0;
    const size_t begin = r->op == SG_SPLIT_X ? x : y, end = r->op == SG_SPLIT_X ? x1 : y1;
    for (size_t cut = begin + 1; cut < end; cut++) {
        const bool along_x = r->op == SG_SPLIT_X;
        const long double first =
            along_x ? oracle_brute_sum(b, r->rhs[i], x, y, cut, y1) : oracle_brute_sum(b, r->rhs[i], x, y, x1, cut);
        if (first > 0)
            sum += first * (along_x ? oracle_brute_rest(b, r, i + 1, cut, y, x1, y1)
                                    : oracle_brute_rest(b, r, i + 1, x, cut, x1, y1));
    }
    return sum;
}

static inline long double oracle_brute_sum(const oracle_brute *b, uint32_t s, size_t x, size_t y, size_t x1, size_t y1)
{
    long double sum = 0;
    for (size_t r = 0; r < b->g->form.nrules; r++) {
        const sg_split_rule *rule = &b->g->rules[r];
        if (b->closure[s][rule->lhs] == 0 || (rule->op != SG_SPLIT_LEXICAL && rule->n == 1))
            continue;
        sum += b->closure[s][rule->lhs] * b->p[r] *
               (rule->op == SG_SPLIT_LEXICAL ? oracle_leaf(b->cells, b->mode, rule->rhs[0], x, y, x1, y1)
                                             : oracle_brute_rest(b, rule, 0, x, y, x1, y1));
    }
    return sum;
}

static inline double oracle_enumerate(const oracle_grammar *g, const sg_cells *cells, sg_leaf_mode mode,
                                      const double *p)
{
    oracle_brute b = {.g = g, .cells = cells, .mode = mode, .p = p};
    oracle_close(&b);
    return (double)logl(oracle_brute_sum(&b, g->form.axiom, 0, 0, cells->width, cells->height));
}

/* ---- tied siblings in cell mode: within a node equal symbols have equal cells and count once ---- */

static inline bool oracle_equal_cells(const sg_cells *c, size_t x, size_t y, size_t x1, size_t y1, size_t to_x,
                                      size_t to_y)
{
    for (size_t j = 0; j < y1 - y; j++)
        for (size_t i = 0; i < x1 - x; i++)
            if (c->labels[(y + j) * c->width + x + i] != c->labels[(to_y + j) * c->width + to_x + i])
                return false;
    return true;
}

static inline long double oracle_tied_sum(const oracle_brute *b, bool maximum, uint32_t s, size_t x, size_t y,
                                          size_t x1, size_t y1);

static inline long double oracle_tied_rest(const oracle_brute *b, bool maximum, const sg_split_rule *r, uint32_t i,
                                           size_t *cut, size_t x, size_t y, size_t x1, size_t y1)
{
    const bool along_x = r->op == SG_SPLIT_X;
    const size_t end = along_x ? x1 : y1;
    uint32_t first = 0;
    long double sum = 0;
    if (i == r->n)
        return cut[i] == end ? 1 : 0;
    while (r->rhs[first] != r->rhs[i])
        first++;
    for (size_t e = cut[i] + 1; e <= end; e++) {
        if (i == 0 && e == end && r->n > 1)
            break;
        cut[i + 1] = e;
        const size_t cx = along_x ? cut[i] : x, cy = along_x ? y : cut[i], cx1 = along_x ? e : x1,
                     cy1 = along_x ? y1 : e;
        if (first < i) {
            const size_t fx = along_x ? cut[first] : x, fy = along_x ? y : cut[first];
            if (e - cut[i] == cut[first + 1] - cut[first] && oracle_equal_cells(b->cells, cx, cy, cx1, cy1, fx, fy))
                sum = oracle_add(maximum, sum, oracle_tied_rest(b, maximum, r, i + 1, cut, x, y, x1, y1));
            continue;
        }
        const long double v = oracle_tied_sum(b, maximum, r->rhs[i], cx, cy, cx1, cy1);
        if (v > 0)
            sum = oracle_add(maximum, sum, v * oracle_tied_rest(b, maximum, r, i + 1, cut, x, y, x1, y1));
    }
    return sum;
}

/* The closure is of sums: with maximum the grammar must have no unit rules. */
static inline long double oracle_tied_sum(const oracle_brute *b, bool maximum, uint32_t s, size_t x, size_t y,
                                          size_t x1, size_t y1)
{
    long double sum = 0;
    for (size_t r = 0; r < b->g->form.nrules; r++) {
        const sg_split_rule *rule = &b->g->rules[r];
        size_t cut[ORACLE_RHS + 1] = {rule->op == SG_SPLIT_X ? x : y};
        if (b->closure[s][rule->lhs] == 0 || (rule->op != SG_SPLIT_LEXICAL && rule->n == 1))
            continue;
        sum = oracle_add(maximum, sum,
                         b->closure[s][rule->lhs] * b->p[r] *
                             (rule->op == SG_SPLIT_LEXICAL ? oracle_leaf(b->cells, b->mode, rule->rhs[0], x, y, x1, y1)
                                                           : oracle_tied_rest(b, maximum, rule, 0, cut, x, y, x1, y1)));
    }
    return sum;
}

static inline double oracle_tied(const oracle_grammar *g, const sg_cells *cells, bool maximum, const double *p)
{
    oracle_brute b = {.g = g, .cells = cells, .mode = SG_CELL_MODE, .p = p};
    oracle_close(&b);
    return (double)logl(oracle_tied_sum(&b, maximum, g->form.axiom, 0, 0, cells->width, cells->height));
}

static inline void oracle_probabilities(const oracle_grammar *g, double *p)
{
    for (size_t r = 0; r < g->form.nrules; r++)
        p[r] = g->rules[r].probability;
}

#endif
