/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench_earley.c - how long the Earley parser takes, and how that grows with the lattice.
 *
 *   bench_earley [--largest N]                  synthetic facades, then lattices of growing size
 *   bench_earley --mode MODE GRAMMAR LATTICE... one line of figures for a grammar file and lattices
 * (experiments/earley.sh)
 *
 * One thread. Times are means over the lattices, in milliseconds; of each parse the fastest of a few runs counts. */
#include "config.h"

#include "core/random.h"
#include "grammar/grammar.h"
#include "learn/incorporate.h"
#include "parse/earley.h"
#include "parse/lattice_cells.h"
#include "program/program.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

static const char HELP[] =
    "Usage: bench_earley [--largest N]\n"
    "       bench_earley --mode cell|region [--name TEXT] [--costs] GRAMMAR LATTICE...\n"
    "Times of the Earley parser: on synthetic facades and on lattices of growing size, or on files.\n"
    "\n"
    "  --mode cell|region  for files: what a label covers\n"
    "  --costs             for files: cell costs of hard labels, -log .994 a pixel that is right and -log .001 one "
    "that is not\n"
    "  --name TEXT         for files: what to call the line\n"
    "  --largest N         side of the largest lattice (default 60)\n" SG_COMMON_HELP;

typedef struct {
    double table, viterbi, slowest, counts, inside, expected; /* ms */
    double states, megabytes;
    size_t parsed, n;
} figures;

static double now_ms(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

/* Fastest of up to five runs; slow ones are not repeated. */
static sg_status time_parse(bool viterbi, const sg_parse_table *t, const sg_cells *cells, sg_chart *c, double *ms,
                            double *value, sg_error *err)
{
    *ms = INFINITY;
    for (int run = 0; run < 5 && (run == 0 || *ms < 100); run++) {
        const double begin = now_ms();
        SG_TRY((viterbi ? sg_earley_viterbi : sg_earley_inside)(t, cells, c, value, err));
        *ms = fmin(*ms, now_ms() - begin);
    }
    return SG_OK;
}

static sg_status measure_one(const sg_parse_table *t, const sg_cells *cells, sg_chart *c, bool sums, double *counts,
                             figures *f, sg_error *err)
{
    double ms, value;
    SG_TRY(time_parse(true, t, cells, c, &ms, &value, err));
    f->viterbi += ms;
    f->slowest = fmax(f->slowest, ms);
    f->states += (double)sg_chart_states(c);
    double begin = now_ms();
    if (value != -INFINITY)
        SG_TRY(sg_earley_viterbi_counts(t, c, counts, err));
    f->counts += now_ms() - begin;
    f->parsed += value != -INFINITY;
    f->n++;
    if (sums) {
        SG_TRY(time_parse(false, t, cells, c, &ms, &value, err));
        f->inside += ms;
        begin = now_ms();
        SG_TRY(sg_earley_expected_counts(t, c, counts, err));
        f->expected += now_ms() - begin;
    }
    f->megabytes = fmax(f->megabytes, (double)sg_chart_bytes(c) * 1e-6);
    return SG_OK;
}

static sg_status time_table(const sg_split_form *form, sg_leaf_mode mode, sg_parse_table **t, double *ms, sg_error *err)
{
    *ms = INFINITY;
    for (int run = 0; run < 5; run++) {
        if (run > 0)
            sg_parse_table_free(*t);
        const double begin = now_ms();
        SG_TRY(sg_parse_table_create(form, mode, t, err));
        *ms = fmin(*ms, now_ms() - begin);
    }
    return SG_OK;
}

/* sums: inside and expected counts too. Over costs they are those of nearly all rectangles of all symbols. */
static sg_status measure(const sg_split_form *form, sg_leaf_mode mode, const sg_cells *cells, size_t n, bool sums,
                         figures *f, sg_error *err)
{
    sg_parse_table *t;
    sg_chart *c = NULL;
    *f = (figures){0};
    SG_TRY(time_table(form, mode, &t, &f->table, err));
    double *counts = calloc(form->nrules + 1, sizeof *counts);
    sg_status st = counts != NULL ? sg_chart_create(&c, err) : SG_FAIL_NOMEM(err);
    for (size_t i = 0; i < n && st == SG_OK; i++)
        st = measure_one(t, &cells[i], c, sums, counts, f, err);
    f->viterbi /= (double)n;
    f->counts /= (double)n;
    f->inside /= (double)n;
    f->expected /= (double)n;
    f->states /= (double)n;
    sg_chart_free(c);
    sg_parse_table_free(t);
    free(counts);
    return st;
}

static void print_head(void)
{
    printf("%-34s %6s %6s %7s %7s %9s %9s %8s %9s %9s %9s %8s\n", "grammar, lattices", "|N|", "rules", "parsed",
           "table", "Viterbi", "slowest", "its tree", "inside", "expected", "states", "MB");
}

static void print_ms(double ms, bool known)
{
    if (known)
        printf(" %9.3f", ms);
    else
        printf(" %9s", "-");
}

static void print_figures(const char *name, const sg_split_form *form, bool sums, const figures *f)
{
    printf("%-34s %6zu %6zu %3zu/%-3zu %7.3f %9.3f %9.3f %8.3f", name, form->nsymbols, form->nrules, f->parsed, f->n,
           f->table, f->viterbi, f->slowest, f->counts);
    print_ms(f->inside, sums);
    print_ms(f->expected, sums);
    printf(" %9.0f %8.1f\n", f->states, f->megabytes);
    fflush(stdout);
}

/* ---- files ---- */

static double pixels_of(const sg_lattice *l, size_t cell)
{
    const size_t x = cell % l->width, y = cell / l->width;
    return (double)(l->x[x + 1] - l->x[x]) * (double)(l->y[y + 1] - l->y[y]);
}

static sg_status cells_with_costs(const sg_split_form *form, const sg_lattice *l, sg_arena *arena, sg_cells *cells,
                                  sg_error *err)
{
    const size_t n = cells->width * cells->height;
    double *costs = SG_NEW_ARRAY(arena, double, form->nterminals *n);
    if (costs == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t t = 0; t < form->nterminals; t++)
        for (size_t i = 0; i < n; i++)
            costs[t * n + i] = pixels_of(l, i) * (cells->labels[i] == t ? -log(0.994) : -log(0.001));
    *cells = (sg_cells){cells->width, cells->height, NULL, costs};
    return SG_OK;
}

static sg_status bench_files(const char *name, sg_leaf_mode mode, bool costs, char **files, size_t n, sg_arena *arena,
                             sg_error *err)
{
    sg_grammar *g;
    sg_split_form form;
    SG_TRY(sg_grammar_load(files[0], &g, err));
    sg_status st = sg_split_form_of(g, arena, &form, err);
    sg_cells *cells = SG_NEW_ARRAY(arena, sg_cells, n);
    if (st == SG_OK && cells == NULL)
        st = SG_FAIL_NOMEM(err);
    for (size_t i = 1; i < n && st == SG_OK; i++) {
        sg_lattice l;
        st = sg_lattice_read(files[i], arena, &l, err);
        if (st == SG_OK)
            st = sg_lattice_cells(&l, &form, arena, &cells[i], err);
        if (st == SG_OK && costs)
            st = cells_with_costs(&form, &l, arena, &cells[i], err);
    }
    figures f;
    if (st == SG_OK)
        st = measure(&form, mode, cells + 1, n - 1, !costs, &f, err);
    if (st == SG_OK)
        print_figures(name != NULL ? name : files[0], &form, !costs, &f);
    sg_grammar_free(g);
    return st;
}

/* ---- synthetic facades: 30 lattices of 25 rows, drawn from 100 kinds of rows of 25 cells ---- */

enum { FACADES = 30, SIDE = 25, KINDS = 100 };

static const char *const LABELS[] = {"wall", "window", "balcony", "roof", "sky", "shop", "door"};

static sg_status make_facades(sg_arena *arena, sg_lattice *out, sg_error *err)
{
    uint16_t kinds[KINDS][SIDE];
    gsl_rng *rng = sg_random_create(1);
    uint32_t *px = SG_NEW_ARRAY(arena, uint32_t, SIDE + 1);
    if (rng == NULL || px == NULL) {
        gsl_rng_free(rng);
        return SG_FAIL_NOMEM(err);
    }
    for (uint32_t i = 0; i <= SIDE; i++)
        px[i] = 10 * i;
    for (size_t k = 0; k < KINDS; k++) /* pairs of labels by turns, with runs, as rows of facades are */
        for (size_t x = 0; x < SIDE; x++)
            kinds[k][x] = (uint16_t)(x > 0 && sg_random_uniform(rng) < 0.5 ? kinds[k][x - 1] : (k + 3 * (x % 2)) % 7);
    for (size_t i = 0; i < FACADES; i++) {
        uint16_t *labels = SG_NEW_ARRAY(arena, uint16_t, SIDE * SIDE);
        for (size_t y = 0; labels != NULL && y < SIDE; y++)
            memcpy(labels + y * SIDE, kinds[(size_t)(sg_random_uniform(rng) * KINDS)], sizeof kinds[0]);
        out[i] = (sg_lattice){SIDE, SIDE, px, px, labels, 7, (const char **)(uintptr_t)LABELS};
        if (labels == NULL) {
            gsl_rng_free(rng);
            return SG_FAIL_NOMEM(err);
        }
    }
    gsl_rng_free(rng);
    return SG_OK;
}

static sg_status bench_facades(sg_arena *arena, sg_error *err)
{
    sg_lattice lattices[FACADES];
    sg_cells cells[FACADES];
    sg_split_form form;
    double *counts;
    figures f;
    const sg_incorporate_opts opts = SG_INCORPORATE_OPTS_INIT;
    SG_TRY(make_facades(arena, lattices, err));
    SG_TRY(sg_incorporate(lattices, FACADES, &opts, arena, &form, &counts, err));
    for (size_t i = 0; i < FACADES; i++)
        SG_TRY(sg_lattice_cells(&lattices[i], &form, arena, &cells[i], err));
    printf("synthetic facades of 25 x 25 cells, their initial grammar; milliseconds a lattice\n");
    print_head();
    SG_TRY(measure(&form, SG_CELL_MODE, cells, FACADES, true, &f, err));
    print_figures("initial grammar, by cells", &form, true, &f);
    SG_TRY(measure(&form, SG_REGION_MODE, cells, FACADES, true, &f, err));
    print_figures("initial grammar, by regions", &form, true, &f);
    return SG_OK;
}

/* ---- growing lattices ---- */

static const char *const ONE[] = {"S", "R", "T"};
static const uint32_t SS[] = {0, 0}, RS[] = {1, 0}, R[] = {1}, TR[] = {2, 1}, T[] = {2}, t0[] = {0};

/* S -> S S (.25) | S/S (.25) | t (.5): every guillotine cut of every rectangle. */
static const sg_split_rule AMBIGUOUS[] = {
    {.lhs = 0, .op = SG_SPLIT_X, .n = 2, .rhs = SS, .probability = 0.25},
    {.lhs = 0, .op = SG_SPLIT_Y, .n = 2, .rhs = SS, .probability = 0.25},
    {.lhs = 0, .op = SG_SPLIT_LEXICAL, .n = 1, .rhs = t0, .probability = 0.5},
};
/* S -> R/S | R, R -> T R | T, T -> t: rows of cells. */
static const sg_split_rule ROWS[] = {
    {.lhs = 0, .op = SG_SPLIT_Y, .n = 2, .rhs = RS, .probability = 0.5},
    {.lhs = 0, .op = SG_SPLIT_Y, .n = 1, .rhs = R, .probability = 0.5},
    {.lhs = 1, .op = SG_SPLIT_X, .n = 2, .rhs = TR, .probability = 0.5},
    {.lhs = 1, .op = SG_SPLIT_X, .n = 1, .rhs = T, .probability = 0.5},
    {.lhs = 2, .op = SG_SPLIT_LEXICAL, .n = 1, .rhs = t0, .probability = 1},
};

typedef struct {
    const char *name;
    sg_leaf_mode mode;
    bool costs;
    size_t nsymbols, nrules;
    const sg_split_rule *rules;
} curve;

/* Slope of log y over log x by least squares. */
static double exponent(const double *x, const double *y, size_t n)
{
    double mx = 0, my = 0, xx = 0, xy = 0;
    for (size_t i = 0; i < n; i++) {
        mx += log(x[i]) / (double)n;
        my += log(y[i]) / (double)n;
    }
    for (size_t i = 0; i < n; i++) {
        xx += (log(x[i]) - mx) * (log(x[i]) - mx);
        xy += (log(x[i]) - mx) * (log(y[i]) - my);
    }
    return xy / xx;
}

static sg_status bench_curve(const curve *c, size_t largest, sg_error *err)
{
    static const size_t SIDES[] = {4, 8, 12, 16, 20, 30, 40, 50, 60, 80, 100, 120};
    const sg_split_form form = {.name = c->name,
                                .nsymbols = c->nsymbols,
                                .symbol_names = ONE,
                                .nterminals = 1,
                                .terminal_names = ONE,
                                .rules = c->rules,
                                .nrules = c->nrules};
    double x[16], viterbi[16], inside[16];
    size_t nfit = 0;
    printf("\n%s\n%5s %7s %12s %12s %12s %12s %8s\n", c->name, "side", "cells", "Viterbi ms", "inside ms",
           "expected ms", "states", "MB");
    for (size_t i = 0; i < sizeof SIDES / sizeof *SIDES && SIDES[i] <= largest; i++) {
        const size_t n = SIDES[i] * SIDES[i];
        uint16_t *labels = calloc(n, sizeof *labels);
        double *costs = calloc(n, sizeof *costs);
        figures f;
        if (labels == NULL || costs == NULL) {
            free(labels);
            free(costs);
            return SG_FAIL_NOMEM(err);
        }
        const sg_cells cells = {SIDES[i], SIDES[i], c->costs ? NULL : labels, c->costs ? costs : NULL};
        const sg_status st = measure(&form, c->mode, &cells, 1, true, &f, err);
        free(labels);
        free(costs);
        SG_TRY(st);
        printf("%5zu %7zu %12.3f %12.3f %12.3f %12.0f %8.1f\n", SIDES[i], n, f.viterbi, f.inside, f.expected, f.states,
               f.megabytes);
        fflush(stdout);
        if (SIDES[i] < 16) /* below, fixed costs show */
            continue;
        x[nfit] = (double)n;
        viterbi[nfit] = f.viterbi;
        inside[nfit++] = f.inside;
    }
    if (nfit > 2)
        printf("time grows as cells^%.2f (Viterbi), cells^%.2f (inside), fitted from side 16 on\n",
               exponent(x, viterbi, nfit), exponent(x, inside, nfit));
    return SG_OK;
}

static sg_status bench_curves(size_t largest, sg_error *err)
{
    const curve curves[] = {
        {"S -> S S (.25) | S/S (.25) | t (.5), by cells", SG_CELL_MODE, false, 1, 3, AMBIGUOUS},
        {"the same, by regions", SG_REGION_MODE, false, 1, 3, AMBIGUOUS},
        {"the same, by regions, cell costs", SG_REGION_MODE, true, 1, 3, AMBIGUOUS},
        {"S -> R/S | R, R -> T R | T, T -> t, by cells", SG_CELL_MODE, false, 3, 5, ROWS},
    };
    for (size_t i = 0; i < sizeof curves / sizeof *curves; i++)
        SG_TRY(bench_curve(&curves[i], largest, err));
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    printf("\npeak memory of this process %.0f MB\n", (double)usage.ru_maxrss / 1024);
    printf("\nquoted, not run here: the published program's 2D Earley parser (2014) takes, with the first grammar,\n"
           "30 us for 2x2, 1.9 ms for 3x3, 450 ms for 4x4 and over 15 s for 5x5; with the last, 13 ms for 4x4 and\n"
           "over 55 s for 8x8\n");
    return SG_OK;
}

typedef struct {
    sg_common_opts common;
    sg_leaf_mode mode;
    bool costs;
    const char *name;
    size_t largest;
} options;

enum { OPT_MODE = SG_OPT_OWN, OPT_COSTS, OPT_NAME, OPT_LARGEST };

static int parse_args(int argc, char **argv, options *o)
{
    static const struct option known[] = {{"mode", required_argument, NULL, OPT_MODE},
                                          {"costs", no_argument, NULL, OPT_COSTS},
                                          {"name", required_argument, NULL, OPT_NAME},
                                          {"largest", required_argument, NULL, OPT_LARGEST},
                                          SG_COMMON_LONG_OPTIONS,
                                          {NULL, 0, NULL, 0}};
    static const char *const modes[] = {"cell", "region", NULL};
    int choice = 0;
    for (int opt; (opt = getopt_long(argc, argv, "", known, NULL)) != -1;) {
        const sg_option_result common = sg_program_option(opt, optarg, HELP, &o->common);
        if (common == SG_OPTION_EXIT_OK)
            return sg_program_end(SG_OK, NULL);
        bool ok = common == SG_OPTION_TAKEN || common == SG_OPTION_OTHER;
        if (opt == OPT_MODE && (ok = sg_program_choice("--mode", optarg, modes, &choice)))
            o->mode = choice == 0 ? SG_CELL_MODE : SG_REGION_MODE;
        else if (opt == OPT_LARGEST)
            ok = sg_program_size("--largest", optarg, 4, 120, &o->largest);
        else if (opt == OPT_NAME)
            o->name = optarg;
        else if (opt == OPT_COSTS)
            o->costs = true;
        if (!ok)
            return 2;
    }
    if (argc - optind == 1)
        return sg_program_usage("expected a grammar and at least one lattice");
    return -1;
}

int main(int argc, char **argv)
{
    options o = {.common = SG_COMMON_OPTS_INIT, .mode = SG_CELL_MODE, .largest = 60};
    sg_error err = SG_ERROR_INIT;
    sg_program_begin("bench_earley");
    const int code = parse_args(argc, argv, &o);
    if (code >= 0)
        return code;
    sg_arena *arena = sg_arena_create();
    sg_status st = arena != NULL ? SG_OK : SG_FAIL_NOMEM(&err);
    if (st == SG_OK && optind < argc)
        st = bench_files(o.name, o.mode, o.costs, argv + optind, (size_t)(argc - optind), arena, &err);
    else if (st == SG_OK) {
        st = bench_facades(arena, &err);
        if (st == SG_OK)
            st = bench_curves(o.largest, &err);
    }
    sg_arena_free(arena);
    return sg_program_end(st, &err);
}
