/* SPDX-License-Identifier: GPL-3.0-or-later */
/* exact_parse.c - costs per pixel, their lattice, the parse of its cells, a derivation. */
#include "config.h"

#include "image/classes.h"
#include "parse/exact_priv.h"
#include "score/label_score.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

typedef struct {
    sg_exact_problem p;
    const sg_exact_opts *opts;
    sg_exact_lines lines;
    sg_arena *arena;
    sg_exact_result *out;
    sg_error *err;
} work;

static double seconds_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Where the cheapest terminals differ, lines may begin. */
static uint8_t *cheapest(const sg_exact_costs *c, sg_arena *arena)
{
    const size_t n = c->width * c->height;
    uint8_t *labels = SG_NEW_ARRAY(arena, uint8_t, n);
    for (size_t t = 1; labels != NULL && t < c->nterminals; t++)
        for (size_t i = 0; i < n; i++)
            if (c->costs[t * n + i] < c->costs[labels[i] * n + i])
                labels[i] = (uint8_t)t;
    return labels;
}

static size_t longest(const uint32_t *line, size_t n)
{
    size_t best = 0;
    for (size_t i = 1; i < n; i++)
        if (line[i + 1] - line[i] > line[best + 1] - line[best])
            best = i;
    return best;
}

static void insert_middle(uint32_t *line, size_t n, size_t at)
{
    memmove(line + at + 2, line + at + 1, (n - at) * sizeof *line);
    line[at + 1] = (line[at] + line[at + 2]) / 2;
}

/* Cuts between equal labels show nowhere, and costs may say nothing of where cuts are at all: the longest sides are
 * halved as long as there may be more cells. */
static void halve(sg_exact_lines *l, size_t max_cells)
{
    for (;;) {
        const size_t column = longest(l->x, l->width), row = longest(l->y, l->height);
        const uint32_t across = l->x[column + 1] - l->x[column], down = l->y[row + 1] - l->y[row];
        const bool by_x = across > 1 && (l->width + 1) * l->height <= max_cells;
        const bool by_y = down > 1 && l->width * (l->height + 1) <= max_cells;
        if (by_x && (across >= down || !by_y))
            insert_middle(l->x, l->width++, column);
        else if (by_y)
            insert_middle(l->y, l->height++, row);
        else
            return;
    }
}

static sg_status take_lines(work *w, const sg_lattice_fit *fit)
{
    const size_t max_cells = w->opts->max_cells > 0 ? w->opts->max_cells : 2 * fit->width * fit->height;
    uint32_t *x = SG_NEW_ARRAY(w->arena, uint32_t, w->p.costs.width + 1);
    uint32_t *y = SG_NEW_ARRAY(w->arena, uint32_t, w->p.costs.height + 1);
    if (x == NULL || y == NULL)
        return SG_FAIL_NOMEM(w->err);
    memcpy(x, fit->x, (fit->width + 1) * sizeof *x);
    memcpy(y, fit->y, (fit->height + 1) * sizeof *y);
    w->lines = (sg_exact_lines){fit->width, fit->height, x, y};
    halve(&w->lines, max_cells);
    return SG_OK;
}

static sg_status fit_lattice(work *w)
{
    const uint8_t *labels = cheapest(&w->p.costs, w->arena);
    if (labels == NULL)
        return SG_FAIL_NOMEM(w->err);
    const sg_lattice_source source = {w->p.costs.width, w->p.costs.height, w->p.costs.nterminals, labels, w->p.costs.costs};
    const sg_lattice_fit_opts opts = SG_LATTICE_FIT_OPTS_INIT;
    sg_lattice_problem *problem = NULL;
    sg_lattice_fit fit;
    SG_TRY(sg_lattice_problem_create(&source, &opts, &problem, w->err));
    const sg_status st = w->opts->max_cells > 0
                             ? sg_lattice_fit_cells(problem, (w->opts->max_cells + 1) / 2, w->arena, &fit, w->err)
                             : sg_lattice_fit_length(problem, w->arena, &fit, w->err);
    sg_lattice_problem_free(problem);
    return st == SG_OK ? take_lines(w, &fit) : st;
}

static double *cell_costs(const work *w)
{
    const sg_exact_lines *f = &w->lines;
    double *costs = SG_NEW_ARRAY(w->arena, double, w->p.form.nterminals * f->width * f->height), *next = costs;
    for (uint32_t t = 0; costs != NULL && t < w->p.form.nterminals; t++)
        for (size_t y = 0; y < f->height; y++)
            for (size_t x = 0; x < f->width; x++)
                *next++ = fmax(0, sg_exact_cost(&w->p.costs, t, f->x[x], f->y[y], f->x[x + 1], f->y[y + 1]));
    return costs;
}

static sg_status parse_cells(work *w, const sg_parse_table *table, sg_chart *chart, sg_parse_node **nodes)
{
    size_t nnodes;
    const sg_cells cells = {w->lines.width, w->lines.height, NULL, cell_costs(w)};
    if (cells.costs == NULL)
        return SG_FAIL_NOMEM(w->err);
    double log_viterbi;
    SG_TRY(sg_earley_viterbi(table, &cells, chart, &log_viterbi, w->err));
    w->out->columns = w->lines.width;
    w->out->rows = w->lines.height;
    w->out->states = sg_chart_states(chart);
    w->out->energy_lattice = -log_viterbi;
    if (!isfinite(log_viterbi))
        return SG_FAIL(w->err, SG_ENOPARSE, "no derivation of the grammar fills a lattice of %zu x %zu cells",
                       w->lines.width, w->lines.height);
    return sg_earley_viterbi_tree(table, chart, nodes, &nnodes, w->err);
}

static sg_status parse_lattice(work *w, sg_parse_node **nodes)
{
    sg_split_form free_form = w->p.form;
    free_form.tied = false;
    sg_parse_table *table = NULL;
    sg_chart *chart = NULL;
    sg_status st = sg_parse_table_create(&free_form, SG_REGION_MODE, &table, w->err);
    if (st == SG_OK)
        st = sg_chart_create(&chart, w->err);
    if (st == SG_OK)
        st = parse_cells(w, table, chart, nodes);
    sg_chart_free(chart);
    sg_parse_table_free(table);
    return st;
}

/* The parse and what descent finds, if anything: the better one with all its parts. */
static sg_status refine(work *w, sg_exact_node **root)
{
    sg_exact_node *other = NULL;
    double *space = SG_NEW_ARRAY(w->arena, double, w->p.longest);
    if (space == NULL)
        return SG_FAIL_NOMEM(w->err);
    SG_TRY(sg_exact_move_cuts(&w->p, *root, w->arena, w->err));
    const sg_status st = sg_exact_descend(&w->p, w->opts->step_px, w->arena, &other, w->err);
    if (st != SG_OK)
        return st == SG_ENOPARSE ? SG_OK : st;
    SG_TRY(sg_exact_move_cuts(&w->p, other, w->arena, w->err));
    if (sg_exact_energy(&w->p, other, space) < sg_exact_energy(&w->p, *root, space))
        *root = other;
    return SG_OK;
}

static sg_status derive(work *w, const sg_parse_node *nodes)
{
    sg_exact_node *root;
    SG_TRY(sg_exact_tree_create(&w->p, nodes, &w->lines, w->arena, &root, w->err));
    sg_exact_tree_tie(&w->p, root);
    if (w->opts->refine)
        SG_TRY(refine(w, &root));
    return sg_exact_tree_derivation(&w->p, root, &w->out->derivation, w->err);
}

static sg_status image_energy(work *w, const sg_float_map *costs, const uint32_t *channel)
{
    sg_score *score = NULL;
    sg_score_state *state = NULL;
    sg_score_value value = {0, 0};
    sg_status st = sg_label_score_create(w->p.g, costs, channel, w->opts->weight, &score, w->err);
    if (st == SG_OK)
        st = sg_score_state_create(score, &state, w->err);
    if (st == SG_OK)
        st = sg_score_evaluate(state, &w->out->derivation, &value, w->err);
    w->out->energy_image = -value.log;
    sg_score_state_free(state);
    sg_score_free(score);
    return st;
}

static sg_status energies(work *w, const sg_float_map *costs, const uint32_t *channel)
{
    double log_prior, log_density;
    SG_TRY(sg_derivation_log_prior(&w->out->derivation, &log_prior, w->err));
    SG_TRY(sg_derivation_log_density(&w->out->derivation, &log_density, w->err));
    w->out->energy_rule = -log_prior;
    w->out->energy_attribute = -log_density;
    return image_energy(w, costs, channel);
}

static sg_status parse(work *w, const sg_float_map *costs, const uint32_t *channel)
{
    if (!(w->opts->weight > 0 && isfinite(w->opts->weight)) || !(w->opts->step_px >= 1))
        return SG_FAIL(w->err, SG_EINVAL, "the weight of the image and the step must be positive numbers");
    SG_TRY(sg_split_form_of(w->p.g, w->arena, &w->p.form, w->err));
    for (size_t r = 0; r < w->p.form.nrules; r++)
        if (w->p.form.rules[r].n > w->p.longest)
            w->p.longest = w->p.form.rules[r].n;
    SG_TRY(sg_exact_costs_create(w->p.g, &w->p.form, costs, channel, w->opts->weight, w->arena, &w->p.costs, w->err));
    SG_TRY(fit_lattice(w));
    sg_parse_node *nodes = NULL;
    sg_status st = parse_lattice(w, &nodes);
    if (st == SG_OK)
        st = derive(w, nodes);
    free(nodes);
    return st == SG_OK ? energies(w, costs, channel) : st;
}

sg_status sg_exact_parse(const sg_grammar *g, const sg_float_map *costs, const uint32_t *channel,
                         const sg_exact_opts *opts, sg_exact_result *out, sg_error *err)
{
    const double start = seconds_now();
    memset(out, 0, sizeof *out);
    sg_derivation_init(&out->derivation, g);
    work w = {.p = {.g = g}, .opts = opts, .arena = sg_arena_create(), .out = out, .err = err};
    const sg_status st = w.arena != NULL ? parse(&w, costs, channel) : SG_FAIL_NOMEM(err);
    sg_arena_free(w.arena);
    if (st != SG_OK)
        sg_exact_result_clear(out);
    out->seconds = seconds_now() - start;
    return st;
}

void sg_exact_result_clear(sg_exact_result *r)
{
    sg_derivation_clear(&r->derivation);
    memset(r, 0, sizeof *r);
}
