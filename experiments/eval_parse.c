/* SPDX-License-Identifier: GPL-3.0-or-later */
/* eval_parse.c - how well do grammars explain facades that they were not learned from?
 *
 *   eval_parse [--fold K] [--classes FILE] [--max-images N] DATASET GRAMMAR...
 *
 * The lattice of each facade is parsed in region mode with cell costs: a cell costs, per pixel, -log 0.994 for the pixel's
 * label and -log 0.001 for any other (the published parser's hard unaries); ignored pixels cost nothing. Printed per
 * grammar: facades, those outside the language, pixel accuracy of the best derivation, the accuracy of the lattice itself
 * (its ceiling), and the energy per pixel, -log of the best derivation with its costs. Ties between siblings are left out
 * of account: each part of a split is derived by itself. */
#include "config.h"

#include "grammar/split.h"
#include "parse/dataset.h"
#include "parse/earley.h"
#include "parse/lattice_fit.h"
#include "program/program.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static const double RIGHT = 0.994, WRONG = 0.001;

static const char help[] =
    "Usage: eval_parse --fold 1 --classes classes7.tsv DATASET GRAMMAR...\n"
    "Parse the held-out facades of a fold with each grammar: accuracy and energy per pixel.\n\n"
    "  --fold K           test part of fold K (default: all facades)\n"
    "  --classes FILE     class table instead of DATASET/classes.tsv\n"
    "  --max-images N     the first N only\n"
    "  --header           print the head of the table first\n" SG_COMMON_HELP;

typedef struct {
    sg_common_opts common;
    sg_dataset_opts dataset;
    bool header;
} options;

typedef struct {
    sg_arena *arena;
    sg_dataset dataset;
    sg_split_form form;
    sg_parse_table *table;
    int *terminal_class; /* [nterminals] class, or -1 */
} model;

typedef struct {
    double right, right_of_lattice, pixels, energy, seconds, slowest;
    size_t facades, outside;
} score;

enum { OPT_FOLD = SG_OPT_OWN, OPT_CLASSES, OPT_MAX, OPT_HEADER };

/* Pixels of each class in each cell: [height][width][nclasses]. */
static void count_pixels(const sg_label_map *map, const sg_lattice_fit *l, size_t nclasses, double *count)
{
    size_t row = 0;
    for (size_t y = 0; y < map->height; y++) {
        row += y >= l->y[row + 1];
        size_t column = 0;
        for (size_t x = 0; x < map->width; x++) {
            column += x >= l->x[column + 1];
            const uint8_t c = map->labels[y * map->width + x];
            if (c < nclasses)
                count[(row * l->width + column) * nclasses + c]++;
        }
    }
}

static double *cell_costs(const model *m, const sg_lattice_fit *l, const double *count, sg_arena *arena)
{
    const size_t cells = l->width * l->height, nclasses = m->dataset.classes.nclasses;
    double *costs = SG_NEW_ARRAY(arena, double, m->form.nterminals * cells);
    for (size_t t = 0; costs != NULL && t < m->form.nterminals; t++)
        for (size_t i = 0; i < cells; i++)
            for (size_t c = 0; c < nclasses; c++)
                costs[t * cells + i] -= count[i * nclasses + c] * log((int)c == m->terminal_class[t] ? RIGHT : WRONG);
    return costs;
}

/* Pixels whose class the derivation's lexical rule over their cell makes. */
static double right_pixels(const model *m, const sg_parse_node *nodes, size_t nnodes, const sg_lattice_fit *l,
                           const double *count)
{
    const size_t nclasses = m->dataset.classes.nclasses;
    double right = 0;
    for (size_t i = 0; i < nnodes; i++) {
        const sg_split_rule *r = &m->form.rules[nodes[i].rule];
        if (r->op != SG_SPLIT_LEXICAL || m->terminal_class[r->rhs[0]] < 0)
            continue;
        for (uint32_t y = nodes[i].y0; y < nodes[i].y1; y++)
            for (uint32_t x = nodes[i].x0; x < nodes[i].x1; x++)
                right += count[(y * l->width + x) * nclasses + (size_t)m->terminal_class[r->rhs[0]]];
    }
    return right;
}

static double seconds_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static sg_status parse_facade(const model *m, const sg_lattice_fit *l, const double *count, sg_chart *chart, score *s,
                              sg_arena *arena, sg_error *err)
{
    const double *costs = cell_costs(m, l, count, arena);
    if (costs == NULL)
        return SG_FAIL_NOMEM(err);
    const sg_cells cells = {l->width, l->height, NULL, costs};
    const double start = seconds_now();
    double log_viterbi;
    SG_TRY(sg_earley_viterbi(m->table, &cells, chart, &log_viterbi, err));
    const double took = seconds_now() - start;
    s->seconds += took;
    s->slowest = fmax(s->slowest, took);
    s->facades++;
    s->pixels += (double)l->counted_px;
    s->right_of_lattice += (double)(l->counted_px - l->wrong_px);
    if (!isfinite(log_viterbi)) {
        s->outside++;
        return SG_OK;
    }
    s->energy -= log_viterbi;
    sg_parse_node *nodes;
    size_t nnodes;
    SG_TRY(sg_earley_viterbi_tree(m->table, chart, &nodes, &nnodes, err));
    s->right += right_pixels(m, nodes, nnodes, l, count);
    free(nodes);
    return SG_OK;
}

static sg_status evaluate_item(const model *m, size_t item, sg_chart *chart, score *s, sg_arena *arena, sg_error *err)
{
    sg_label_map map;
    SG_TRY(sg_dataset_read_labels(&m->dataset, item, &map, err));
    const size_t nclasses = m->dataset.classes.nclasses;
    const sg_lattice_source source = sg_lattice_source_of(&map, nclasses);
    const sg_lattice_fit_opts opts = SG_LATTICE_FIT_OPTS_INIT;
    sg_lattice_problem *problem = NULL;
    sg_lattice_fit fit;
    sg_status st = sg_lattice_problem_create(&source, &opts, &problem, err);
    if (st == SG_OK)
        st = sg_lattice_fit_length(problem, arena, &fit, err);
    if (st == SG_OK) {
        double *count = SG_NEW_ARRAY(arena, double, fit.width * fit.height * nclasses);
        if (count == NULL) {
            st = SG_FAIL_NOMEM(err);
        } else {
            count_pixels(&map, &fit, nclasses, count);
            st = parse_facade(m, &fit, count, chart, s, arena, err);
        }
    }
    sg_lattice_problem_free(problem);
    sg_label_map_clear(&map);
    return st;
}

static sg_status load_model(model *m, const char *path, sg_error *err)
{
    sg_grammar *g = NULL;
    SG_TRY(sg_grammar_load(path, &g, err));
    sg_status st = sg_split_form_of(g, m->arena, &m->form, err);
    m->form.tied = false; /* region mode has no exact parse for all tied grammars */
    if (st == SG_OK)
        st = sg_parse_table_create(&m->form, SG_REGION_MODE, &m->table, err);
    m->terminal_class = st == SG_OK ? SG_NEW_ARRAY(m->arena, int, m->form.nterminals) : NULL;
    for (size_t t = 0; m->terminal_class != NULL && t < m->form.nterminals; t++)
        m->terminal_class[t] = sg_classes_find(&m->dataset.classes, m->form.terminal_names[t]);
    sg_grammar_free(g); /* names of the form are borrowed from it: only numbers are used from here on */
    return st == SG_OK && m->terminal_class == NULL ? SG_FAIL_NOMEM(err) : st;
}

static sg_status evaluate(model *m, const char *path, const options *o, sg_error *err)
{
    SG_TRY(load_model(m, path, err));
    sg_progress progress = sg_program_progress(&o->common);
    score s = {0};
    sg_chart *chart = NULL;
    sg_status st = sg_chart_create(&chart, err);
    sg_arena *scratch = sg_arena_create();
    if (scratch == NULL)
        st = SG_FAIL_NOMEM(err);
    for (size_t i = 0; st == SG_OK && i < m->dataset.nitems; i++) {
        sg_progress_report(&progress, path, i, m->dataset.nitems);
        sg_arena_reset(scratch);
        st = evaluate_item(m, i, chart, &s, scratch, err);
        if (st == SG_OK && sg_progress_stopped(&progress))
            st = SG_STOPPED;
    }
    sg_arena_free(scratch);
    sg_chart_free(chart);
    sg_parse_table_free(m->table);
    m->table = NULL;
    if (st == SG_OK)
        printf("%s\t%zu\t%zu\t%.2f\t%.2f\t%.5f\t%.3f\t%.3f\n", path, s.facades, s.outside, 100 * s.right / s.pixels,
               100 * s.right_of_lattice / s.pixels, s.energy / s.pixels, s.seconds / (double)s.facades, s.slowest);
    fflush(stdout);
    return st;
}

/* 0: go on; else the exit status plus 1 */
static int read_options(int argc, char **argv, options *o)
{
    static const struct option list[] = {SG_COMMON_LONG_OPTIONS,
                                         {"fold", required_argument, NULL, OPT_FOLD},
                                         {"classes", required_argument, NULL, OPT_CLASSES},
                                         {"max-images", required_argument, NULL, OPT_MAX},
                                         {"header", no_argument, NULL, OPT_HEADER},
                                         {NULL, 0, NULL, 0}};
    size_t n;
    for (int opt; (opt = getopt_long(argc, argv, "", list, NULL)) != -1;) {
        const sg_option_result common = sg_program_option(opt, optarg, help, &o->common);
        if (common == SG_OPTION_EXIT_OK)
            return 1;
        bool good = common != SG_OPTION_BAD;
        if (opt == OPT_FOLD && (good = sg_program_size("--fold", optarg, 1, 1000, &n)))
            o->dataset.fold = (int)n;
        else if (opt == OPT_CLASSES)
            o->dataset.classes_file = optarg;
        else if (opt == OPT_MAX)
            good = sg_program_size("--max-images", optarg, 1, 1000000, &o->dataset.max_images);
        else if (opt == OPT_HEADER)
            o->header = true;
        if (!good)
            return 3;
    }
    return argc - optind < 2 ? sg_program_usage("a data set and a grammar are needed") + 1 : 0;
}

int main(int argc, char **argv)
{
    options o = {SG_COMMON_OPTS_INIT, SG_DATASET_OPTS_INIT, false};
    o.dataset.part = SG_SPLIT_TEST;
    sg_program_begin("eval_parse");
    const int end = read_options(argc, argv, &o);
    if (end > 0)
        return end - 1;
    sg_error err = SG_ERROR_INIT;
    model m = {.arena = sg_arena_create()};
    sg_status st = m.arena != NULL ? SG_OK : SG_FAIL_NOMEM(&err);
    if (st == SG_OK)
        st = sg_dataset_open(argv[optind], &o.dataset, m.arena, NULL, NULL, &m.dataset, &err);
    if (st == SG_OK) {
        if (o.header)
            puts("grammar\tfacades\toutside\taccuracy\tlattice\tenergy_per_pixel\tseconds\tslowest");
        for (int i = optind + 1; st == SG_OK && i < argc; i++)
            st = evaluate(&m, argv[i], &o, &err);
        sg_dataset_close(&m.dataset);
    }
    sg_arena_free(m.arena);
    return sg_program_end(st, &err);
}
