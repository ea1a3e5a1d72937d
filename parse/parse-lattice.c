/* SPDX-License-Identifier: GPL-3.0-or-later */
/* parse-lattice.c - lattices by a split grammar: inside, best derivation, re-estimation. */
#include "config.h"

#include "core/file.h"
#include "core/utf8.h"
#include "grammar/grammar.h"
#include "parse/earley_em.h"
#include "parse/earley_print.h"
#include "parse/lattice_cells.h"
#include "program/program.h"
#include "program/program_grammar.h"

#include <jansson.h>
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static const char HELP[] =
    "Example: parse-lattice facade.sg lattices/*.lat --derivation\n"
    "\n"
    "Usage: parse-lattice GRAMMAR LATTICE... [OPTION]...\n"
    "Parse lattices by a split grammar (the language *.sg or the exchange form) with the 2D Earley-Stolcke parser, "
    "and\n"
    "print for each log inside (all derivations), log Viterbi (the best one) and the number of chart states. A "
    "lattice\n"
    "outside the language has null for both; the others are parsed all the same, and the exit status is 1.\n"
    "\n"
    "  --mode cell|region  a label covers one cell (default), or any rectangle of one label\n"
    "  --derivation        also print the best derivation; with --json it goes there\n"
    "  --untied            derive every child by itself, even where the grammar ties siblings\n"
    "  --em N              first re-estimate the rule probabilities from the lattices, in at most N iterations\n"
    "  --em-mode true|viterbi\n"
    "                      by expected counts (default) or by those of the best derivations\n"
    "  --alpha A           Dirichlet prior of the re-estimation, 1 or more (default 1: none)\n"
    "  -o, --output FILE   the re-estimated grammar\n" SG_COMMON_HELP "\n"
    "Exit status: 0 done, 1 a lattice is outside the language, 2 wrong usage, 3 bad input, 4 the system failed, 5 "
    "stopped.\n";

typedef struct {
    sg_common_opts common;
    sg_leaf_mode mode;
    bool derivation, untied;
    sg_em_opts em;
    bool em_asked, em_opts_given;
    const char *grammar, *output;
    char **lattices;
    size_t nlattices;
} options;

typedef struct {
    bool done;
    double log_inside, log_viterbi, seconds;
    size_t states;
    sg_parse_node *nodes;
    size_t nnodes;
} result;

typedef struct {
    const options *opts;
    sg_arena *arena;
    sg_split_form form;
    sg_lattice *lattices; /* [opts->nlattices] */
    sg_cells *cells;
    result *results;
    sg_progress progress;
} job;

enum { OPT_MODE = SG_OPT_OWN, OPT_DERIVATION, OPT_UNTIED, OPT_EM, OPT_EM_MODE, OPT_ALPHA };

static const struct option LONG_OPTIONS[] = {{"mode", required_argument, NULL, OPT_MODE},
                                             {"derivation", no_argument, NULL, OPT_DERIVATION},
                                             {"untied", no_argument, NULL, OPT_UNTIED},
                                             {"em", required_argument, NULL, OPT_EM},
                                             {"em-mode", required_argument, NULL, OPT_EM_MODE},
                                             {"alpha", required_argument, NULL, OPT_ALPHA},
                                             {"output", required_argument, NULL, 'o'},
                                             SG_COMMON_LONG_OPTIONS,
                                             {NULL, 0, NULL, 0}};

static bool take_own(int opt, const char *arg, void *user)
{
    options *o = user;
    static const char *const modes[] = {"cell", "region", NULL}, *const kinds[] = {"true", "viterbi", NULL};
    int choice = 0;
    switch (opt) {
    case OPT_MODE:
        if (!sg_program_choice("--mode", arg, modes, &choice))
            return false;
        o->mode = choice == 0 ? SG_CELL_MODE : SG_REGION_MODE;
        return true;
    case OPT_DERIVATION:
        return o->derivation = true;
    case OPT_UNTIED:
        return o->untied = true;
    case OPT_EM:
        o->em_asked = true;
        return sg_program_size("--em", arg, 1, 1000000, &o->em.iterations);
    case OPT_EM_MODE:
        o->em_opts_given = true;
        if (!sg_program_choice("--em-mode", arg, kinds, &choice))
            return false;
        o->em.kind = choice == 0 ? SG_EM_TRUE : SG_EM_VITERBI;
        return true;
    case OPT_ALPHA:
        o->em_opts_given = true;
        return sg_program_double("--alpha", arg, 1, 1e9, &o->em.alpha);
    case 'o':
        o->em_opts_given = true;
        o->output = arg;
        return true;
    default:
        sg_program_usage("unknown option");
        return false;
    }
}

/* Exit status to leave with, or -1 to go on. */
static int parse_args(int argc, char **argv, options *o)
{
    const int end = sg_program_options(argc, argv, "o:", LONG_OPTIONS, HELP, &o->common, take_own, o);
    if (end >= 0)
        return end;
    if (argc - optind < 2)
        return sg_program_usage("expected a grammar and at least one lattice");
    if (o->em_opts_given && !o->em_asked)
        return sg_program_usage("--em-mode, --alpha and --output belong to --em");
    for (int i = optind; o->common.json != NULL && i < argc; i++)
        if (!sg_utf8_is(argv[i], strlen(argv[i])))
            return sg_program_usage("--json: the name '%s' is no UTF-8", argv[i]);
    if (o->output != NULL && o->common.json != NULL && strcmp(o->output, o->common.json) == 0)
        return sg_program_usage("--output and --json need a file each");
    o->grammar = argv[optind];
    o->lattices = argv + optind + 1;
    o->nlattices = (size_t)(argc - optind - 1);
    return -1;
}

/* All bad lattices are told; the first one's status counts. */
static sg_status read_lattices(job *j, sg_error *err)
{
    const size_t n = j->opts->nlattices;
    j->lattices = SG_NEW_ARRAY(j->arena, sg_lattice, n);
    j->cells = SG_NEW_ARRAY(j->arena, sg_cells, n);
    j->results = SG_NEW_ARRAY(j->arena, result, n);
    if (j->lattices == NULL || j->cells == NULL || j->results == NULL)
        return SG_FAIL_NOMEM(err);
    sg_status first = SG_OK;
    for (size_t i = 0; i < n; i++) {
        sg_error e = SG_ERROR_INIT;
        sg_status st = sg_lattice_read(j->opts->lattices[i], j->arena, &j->lattices[i], &e);
        if (st == SG_OK)
            st = sg_lattice_cells(&j->lattices[i], &j->form, j->arena, &j->cells[i], &e);
        if (st == SG_OK)
            continue;
        if (first != SG_OK)
            sg_program_complain("%s", err->msg);
        first = first == SG_OK ? st : first;
        if (err != NULL)
            *err = e;
    }
    return first;
}

static double seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static sg_status parse_one(const job *j, const sg_parse_table *t, sg_chart *c, size_t i, sg_error *err)
{
    result *r = &j->results[i];
    const double begin = seconds();
    SG_TRY(sg_earley_inside(t, &j->cells[i], c, &r->log_inside, err));
    SG_TRY(sg_earley_viterbi(t, &j->cells[i], c, &r->log_viterbi, err));
    r->states = sg_chart_states(c);
    if (j->opts->derivation && r->log_viterbi != -INFINITY)
        SG_TRY(sg_earley_viterbi_tree(t, c, &r->nodes, &r->nnodes, err));
    r->seconds = seconds() - begin;
    r->done = true;
    return SG_OK;
}

/* What all threads share, behind one lock. The failure that is told is that of the first lattice in order. */
typedef struct {
    sg_status status;
    size_t failed, ndone;
    bool stopped;
    sg_error error;
} outcome;

static void parse_share(const job *j, const sg_parse_table *t, sg_progress *progress, outcome *o)
{
    sg_chart *c = NULL;
    sg_error e = SG_ERROR_INIT;
    const sg_status made = sg_chart_create(&c, &e);
#pragma omp for schedule(dynamic)
    for (size_t i = 0; i < j->opts->nlattices; i++) {
        bool skip;
#pragma omp critical(parse_lattice)
        {
            o->stopped = o->stopped || sg_progress_stopped(progress);
            skip = o->stopped || o->status != SG_OK;
        }
        if (skip)
            continue;
        const sg_status st = made == SG_OK ? parse_one(j, t, c, i, &e) : made;
#pragma omp critical(parse_lattice)
        {
            if (st != SG_OK && (o->status == SG_OK || i < o->failed)) {
                o->status = st;
                o->failed = i;
                o->error = e;
            }
            sg_progress_report(progress, "lattices", ++o->ndone, j->opts->nlattices);
        }
    }
    sg_chart_free(c);
}

static sg_status parse_all(job *j, sg_error *err)
{
    sg_parse_table *t = NULL;
    outcome o = {.status = SG_OK};
    SG_TRY(sg_parse_table_create(&j->form, j->opts->mode, &t, err));
#pragma omp parallel
    parse_share(j, t, &j->progress, &o);
    sg_parse_table_free(t);
    if (o.status != SG_OK)
        return SG_FAIL(err, o.status, "%s: %.900s", j->opts->lattices[o.failed], o.error.msg);
    return o.stopped ? SG_FAIL(err, SG_STOPPED, "stopped") : SG_OK;
}

/* ---- re-estimation ---- */

static sg_status write_grammar(const job *j, sg_error *err)
{
    sg_grammar *g = NULL;
    sg_output out;
    SG_TRY(sg_grammar_from_split(&j->form, &g, err));
    sg_status st = sg_output_open(&out, j->opts->output, err);
    if (st == SG_OK) {
        st = sg_output_end(&out, sg_grammar_print(g, out.fp, err), err);
    }
    sg_grammar_free(g);
    return st;
}

static void print_trace(const job *j, const double *objective, size_t n)
{
    if (j->opts->common.json != NULL && strcmp(j->opts->common.json, "-") == 0)
        return;
    sg_program_progress_end();
    printf("iteration\t%s\n", j->opts->em.alpha > 1 ? "log_posterior" : "log_likelihood");
    for (size_t i = 0; i <= n; i++)
        printf("%zu\t%.10g\n", i, objective[i]);
}

static sg_status reestimate(job *j, sg_error *err)
{
    sg_em_opts opts = j->opts->em;
    opts.mode = j->opts->mode;
    size_t n = 0;
    double *p = SG_NEW_ARRAY(j->arena, double, j->form.nrules + 1);
    double *objective = SG_NEW_ARRAY(j->arena, double, opts.iterations + 1);
    sg_split_rule *rules = sg_arena_copy(j->arena, j->form.rules, j->form.nrules * sizeof *rules);
    if (p == NULL || objective == NULL || rules == NULL)
        return SG_FAIL_NOMEM(err);
    const sg_status st =
        sg_em_reestimate(&j->form, j->cells, j->opts->nlattices, &opts, &j->progress, p, objective, &n, err);
    if (st != SG_OK && st != SG_STOPPED)
        return st;
    for (size_t r = 0; r < j->form.nrules; r++)
        rules[r].probability = p[r];
    j->form.rules = rules;
    print_trace(j, objective, n);
    if (j->opts->output != NULL)
        SG_TRY(write_grammar(j, err));
    return st;
}

/* ---- results ---- */

static void print_number(double v, FILE *out)
{
    if (v == -INFINITY)
        fputs("\tnull", out);
    else
        fprintf(out, "\t%.12g", v);
}

static void print_table(const job *j, FILE *out)
{
    fputs("lattice\tlog_inside\tlog_viterbi\tstates\n", out);
    for (size_t i = 0; i < j->opts->nlattices; i++) {
        const result *r = &j->results[i];
        if (!r->done)
            continue;
        fputs(j->opts->lattices[i], out);
        print_number(r->log_inside, out);
        print_number(r->log_viterbi, out);
        fprintf(out, "\t%zu\n", r->states);
        if (r->nodes != NULL)
            sg_parse_tree_print(&j->form, r->nodes, r->nnodes, out);
    }
}

static json_t *number_to_json(double v)
{
    return v == -INFINITY ? json_null() : json_real(v);
}

static json_t *result_to_json(const job *j, size_t i)
{
    const result *r = &j->results[i];
    json_t *o = json_pack("{s:s, s:o, s:o, s:I, s:f}", "lattice", j->opts->lattices[i], "log_inside",
                          number_to_json(r->log_inside), "log_viterbi", number_to_json(r->log_viterbi), "states",
                          (json_int_t)r->states, "seconds", r->seconds);
    if (o == NULL || !j->opts->derivation)
        return o;
    json_t *tree = r->nodes != NULL ? sg_parse_tree_json(&j->form, r->nodes, r->nnodes, &j->lattices[i]) : json_null();
    if (json_object_set_new(o, "derivation", tree) == 0)
        return o;
    json_decref(o);
    return NULL;
}

static sg_status write_json(const job *j, sg_error *err)
{
    json_t *list = json_array();
    bool ok = list != NULL;
    for (size_t i = 0; i < j->opts->nlattices && ok; i++)
        if (j->results[i].done)
            ok = json_array_append_new(list, result_to_json(j, i)) == 0;
    if (!ok) {
        json_decref(list);
        return SG_FAIL(err, SG_ENOMEM, "out of memory, or a file name that is no UTF-8");
    }
    sg_output out;
    sg_status st = sg_output_open(&out, j->opts->common.json, err);
    if (st == SG_OK) {
        json_dumpf(list, out.fp, JSON_INDENT(j->opts->derivation ? 0 : 1) | JSON_REAL_PRECISION(17));
        fputc('\n', out.fp); /* a failed write shows up in the commit */
        st = sg_output_commit(&out, err);
    }
    json_decref(list);
    return st;
}

static sg_status report(const job *j, sg_error *err)
{
    const char *json = j->opts->common.json;
    sg_program_progress_end();
    if (json == NULL || strcmp(json, "-") != 0)
        print_table(j, stdout);
    return json != NULL ? write_json(j, err) : SG_OK;
}

/* SG_ENOPARSE when a lattice was parsed in vain. */
static sg_status count_outside(const job *j, sg_error *err)
{
    size_t outside = 0, first = 0;
    for (size_t i = j->opts->nlattices; i-- > 0;)
        if (j->results[i].done && j->results[i].log_inside == -INFINITY) {
            outside++;
            first = i;
        }
    if (outside == 0)
        return SG_OK;
    const char *hint = j->opts->mode == SG_CELL_MODE ? " (in cell mode; with --mode region a label may cover many cells)" : "";
    return outside == 1 ? SG_FAIL(err, SG_ENOPARSE, "%s is outside the language%s", j->opts->lattices[first], hint)
                        : SG_FAIL(err, SG_ENOPARSE, "%zu lattices are outside the language, %s the first of them%s",
                                  outside, j->opts->lattices[first], hint);
}

static sg_status spare_inputs(const options *o, const sg_grammar *g, const char *output, sg_error *err)
{
    SG_TRY(sg_program_spare_grammar(output, o->grammar, g, err));
    return sg_program_spare(output, (const char *const *)o->lattices, o->nlattices, err);
}

static sg_status run(job *j, const sg_grammar *g, sg_error *err)
{
    SG_TRY(spare_inputs(j->opts, g, j->opts->output, err));
    SG_TRY(spare_inputs(j->opts, g, j->opts->common.json, err));
    SG_TRY(sg_split_form_of(g, j->arena, &j->form, err));
    if (j->opts->untied)
        j->form.tied = false;
    SG_TRY(read_lattices(j, err));
    if (j->opts->em_asked)
        SG_TRY(reestimate(j, err));
    const sg_status st = parse_all(j, err);
    if (st != SG_OK && st != SG_STOPPED)
        return st;
    SG_TRY(report(j, err));
    return st == SG_OK ? count_outside(j, err) : st;
}

int main(int argc, char **argv)
{
    options o = {.common = SG_COMMON_OPTS_INIT, .mode = SG_CELL_MODE, .em = SG_EM_OPTS_INIT};
    sg_program_begin("parse-lattice");
    const int code = parse_args(argc, argv, &o);
    if (code >= 0)
        return code;
    if (o.common.threads > 0)
        omp_set_num_threads(o.common.threads);
    sg_error err = SG_ERROR_INIT;
    sg_grammar *g = NULL;
    job j = {.opts = &o, .progress = sg_program_progress(&o.common), .arena = sg_arena_create()};
    sg_status st = j.arena != NULL ? sg_program_load_grammar(o.grammar, &g, &err) : SG_FAIL_NOMEM(&err);
    if (st == SG_OK)
        st = run(&j, g, &err);
    for (size_t i = 0; j.results != NULL && i < o.nlattices; i++)
        free(j.results[i].nodes);
    sg_grammar_free(g);
    sg_arena_free(j.arena);
    return sg_program_end(st, &err);
}
