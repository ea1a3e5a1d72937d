/* SPDX-License-Identifier: GPL-3.0-or-later */
/* learn-grammar.c - label maps, or lattices, to a split grammar. */
#include "config.h"

#include "core/file.h"
#include "learn/learn.h"
#include "learn/learn_input.h"
#include "learn/learn_output.h"
#include "program/program.h"

#include <omp.h>
#include <stdlib.h>
#include <string.h>

static const char help[] =
    "Example: learn-grammar data/facades -o facades.sg --tied --report report\n"
    "\n"
    "Usage: learn-grammar [OPTION]... FOLDER -o GRAMMAR\n"
    "Learn a stochastic split grammar by Bayesian model merging. FOLDER is a data set\n"
    "(classes.tsv, labels/NAME.png) or holds lattices (NAME.lat). GRAMMAR is written in the\n"
    "grammar language, or in the exchange form when its name ends in .json.\n"
    "\n"
    "What is learned from\n"
    "  --names FILE       names of the data to use, one a line\n"
    "  --fold K           the training part of fold K, in its order\n"
    "  --classes FILE     class table to use in place of classes.tsv\n"
    "  --max-images N     use the first N (default 30; 0: all)\n"
    "  --cells N          fit each lattice with at most N cells\n"
    "  --accuracy A       or show at least this share of the pixels right (default: by\n"
    "                     description length)\n"
    "The energy: weight * description length - log P(data)\n"
    "  --weight W         weight of the prior (default 1)\n"
    "  --data-term TERM   marginal (default) or viterbi\n"
    "  --alpha A          of the Dirichlet prior of rule probabilities (default 1)\n"
    "  --length-prior P   of right-hand sides: poisson (default) or none\n"
    "The search\n"
    "  --share HOW        rows that share a symbol at first: none, equal (default), collapsed\n"
    "  --regroup HOW      neighbouring rows that become one row of columns: none, pairs that\n"
    "                     correspond one to one, floors: bands of any height, or best (default):\n"
    "                     what gives the least energy in the end\n"
    "  --no-regroup       none\n"
    "  --compatible HOW   what may be merged: symbols that reach the same labels (labels), with\n"
    "                     rules of the same kinds too (kinds, default), of about the same\n"
    "                     size too (sizes)\n"
    "  --search KIND      greedy (default), lookahead, beam, anneal\n"
    "  --patience N       lookahead, beam: steps without a new best (default 10)\n"
    "  --beam N           grammars side by side (default 5)\n"
    "  --walks N          anneal: random walks (default 4)\n"
    "  --temperature T    anneal: at the start of a walk, in nats (default 3)\n"
    "  --chunk            give repeated sequences symbols of their own\n"
    "  --reestimate WHEN  by parsing: every (after each step) or end (default)\n"
    "What comes out\n"
    "  -o, --output FILE  the learned grammar; - is standard output\n"
    "  --tied             it declares tied siblings: what repeats in a split repeats exactly\n"
    "  --concentration X,Y  sizes vary about their means as under a Dirichlet distribution of this\n"
    "                     concentration along x, y, as far as a rule's own examples do not tell;\n"
    "                     pooled: the one of all rules (default 0,0: by its own examples alone)\n"
    "  --initial FILE     write the grammar that the search starts from, too\n"
    "  --report DIR       write a page with settings, trace, grammar, lattices and samples\n" SG_COMMON_HELP;

enum {
    OPT_NAMES = SG_OPT_OWN,
    OPT_FOLD,
    OPT_CLASSES,
    OPT_MAX_IMAGES,
    OPT_CELLS,
    OPT_ACCURACY,
    OPT_WEIGHT,
    OPT_DATA_TERM,
    OPT_ALPHA,
    OPT_LENGTH_PRIOR,
    OPT_SHARE,
    OPT_REGROUP,
    OPT_NO_REGROUP,
    OPT_COMPATIBLE,
    OPT_SEARCH,
    OPT_PATIENCE,
    OPT_BEAM,
    OPT_WALKS,
    OPT_TEMPERATURE,
    OPT_CHUNK,
    OPT_REESTIMATE,
    OPT_TIED,
    OPT_CONCENTRATION,
    OPT_INITIAL,
    OPT_REPORT
};

static const struct option long_options[] = {{"names", required_argument, NULL, OPT_NAMES},
                                             {"fold", required_argument, NULL, OPT_FOLD},
                                             {"classes", required_argument, NULL, OPT_CLASSES},
                                             {"max-images", required_argument, NULL, OPT_MAX_IMAGES},
                                             {"cells", required_argument, NULL, OPT_CELLS},
                                             {"accuracy", required_argument, NULL, OPT_ACCURACY},
                                             {"weight", required_argument, NULL, OPT_WEIGHT},
                                             {"data-term", required_argument, NULL, OPT_DATA_TERM},
                                             {"alpha", required_argument, NULL, OPT_ALPHA},
                                             {"length-prior", required_argument, NULL, OPT_LENGTH_PRIOR},
                                             {"share", required_argument, NULL, OPT_SHARE},
                                             {"regroup", required_argument, NULL, OPT_REGROUP},
                                             {"no-regroup", no_argument, NULL, OPT_NO_REGROUP},
                                             {"compatible", required_argument, NULL, OPT_COMPATIBLE},
                                             {"search", required_argument, NULL, OPT_SEARCH},
                                             {"patience", required_argument, NULL, OPT_PATIENCE},
                                             {"beam", required_argument, NULL, OPT_BEAM},
                                             {"walks", required_argument, NULL, OPT_WALKS},
                                             {"temperature", required_argument, NULL, OPT_TEMPERATURE},
                                             {"chunk", no_argument, NULL, OPT_CHUNK},
                                             {"reestimate", required_argument, NULL, OPT_REESTIMATE},
                                             {"output", required_argument, NULL, 'o'},
                                             {"tied", no_argument, NULL, OPT_TIED},
                                             {"concentration", required_argument, NULL, OPT_CONCENTRATION},
                                             {"initial", required_argument, NULL, OPT_INITIAL},
                                             {"report", required_argument, NULL, OPT_REPORT},
                                             SG_COMMON_LONG_OPTIONS,
                                             {NULL, 0, NULL, 0}};

static const char *const data_terms[] = {"marginal", "viterbi", NULL};
static const char *const length_priors[] = {"poisson", "none", NULL};
static const char *const shares[] = {"none", "equal", "collapsed", NULL};
static const char *const regroups[] = {"none", "pairs", "floors", "best", NULL};
static const char *const searches[] = {"greedy", "lookahead", "beam", "anneal", NULL};
static const char *const compatibles[] = {"labels", "kinds", "sizes", NULL};
static const char *const moments[] = {"end", "every", NULL};

typedef struct {
    sg_common_opts common;
    sg_learn_input_opts input;
    sg_learn_opts learn;
    const char *folder, *output, *initial, *report;
} options;

static bool set_input_option(int opt, const char *arg, options *o)
{
    size_t n;
    switch (opt) {
    case OPT_NAMES:
        o->input.dataset.names_file = arg;
        return true;
    case OPT_FOLD:
        if (!sg_program_size("--fold", arg, 1, 1000000, &n))
            return false;
        o->input.dataset.fold = (int)n;
        return true;
    case OPT_CLASSES:
        o->input.dataset.classes_file = arg;
        return true;
    case OPT_MAX_IMAGES:
        return sg_program_size("--max-images", arg, 0, 1000000, &o->input.dataset.max_images);
    case OPT_CELLS:
        return sg_program_size("--cells", arg, 1, 1000000, &o->input.cells);
    default: /* OPT_ACCURACY */
        return sg_program_double("--accuracy", arg, 1e-6, 1, &o->input.accuracy);
    }
}

static bool set_energy_option(int opt, const char *arg, sg_energy_opts *e)
{
    int i;
    switch (opt) {
    case OPT_WEIGHT:
        return sg_program_double("--weight", arg, 0, 1e6, &e->weight);
    case OPT_ALPHA:
        return sg_program_double("--alpha", arg, 1e-6, 1e6, &e->alpha);
    case OPT_DATA_TERM:
        if (!sg_program_choice("--data-term", arg, data_terms, &i))
            return false;
        e->data_term = i == 0 ? SG_DATA_MARGINAL : SG_DATA_VITERBI;
        return true;
    default: /* OPT_LENGTH_PRIOR */
        if (!sg_program_choice("--length-prior", arg, length_priors, &i))
            return false;
        e->poisson = i == 0;
        return true;
    }
}

/* X or X,Y, each a number or "pooled". */
static bool set_concentration(const char *arg, sg_density_opts *d)
{
    char x[64];
    const char *comma = strchr(arg, ','), *part[2] = {x, comma != NULL ? comma + 1 : x};
    const size_t length = comma != NULL ? (size_t)(comma - arg) : strlen(arg);
    snprintf(x, sizeof x, "%.*s", (int)(length < sizeof x ? length : sizeof x - 1), arg);
    for (int axis = SG_SPLIT_X; axis <= SG_SPLIT_Y; axis++) {
        if (strcmp(part[axis], "pooled") == 0)
            d->concentration[axis] = SG_CONCENTRATION_POOLED;
        else if (!sg_program_double("--concentration", part[axis], 0, 1e6, &d->concentration[axis]))
            return false;
    }
    return true;
}

static bool set_search_option(int opt, const char *arg, sg_learn_opts *l)
{
    int i;
    switch (opt) {
    case OPT_SHARE:
        if (!sg_program_choice("--share", arg, shares, &i))
            return false;
        l->incorporate.share = (sg_share)i;
        return true;
    case OPT_REGROUP:
        if (!sg_program_choice("--regroup", arg, regroups, &i))
            return false;
        l->best_regroup = i == 3;
        if (i < 3)
            l->incorporate.regroup = (sg_regroup_kind)i;
        return true;
    case OPT_COMPATIBLE:
        if (!sg_program_choice("--compatible", arg, compatibles, &i))
            return false;
        l->compatible = (sg_compatible)i;
        return true;
    case OPT_SEARCH:
        if (!sg_program_choice("--search", arg, searches, &i))
            return false;
        l->search.kind = (sg_search_kind)i;
        return true;
    case OPT_REESTIMATE:
        if (!sg_program_choice("--reestimate", arg, moments, &i))
            return false;
        l->reestimate_every = i == 1;
        return true;
    case OPT_PATIENCE:
        return sg_program_size("--patience", arg, 0, 1000000, &l->search.patience);
    case OPT_BEAM:
        return sg_program_size("--beam", arg, 1, 1000, &l->search.width);
    case OPT_WALKS:
        return sg_program_size("--walks", arg, 1, 1000000, &l->search.walks);
    case OPT_TEMPERATURE:
        return sg_program_double("--temperature", arg, 1e-6, 1e6, &l->search.temperature);
    case OPT_CHUNK:
        l->search.chunk = true;
        return true;
    case OPT_TIED:
        l->tied = true;
        return true;
    case OPT_CONCENTRATION:
        return set_concentration(arg, &l->densities);
    default: /* OPT_NO_REGROUP */
        l->best_regroup = false;
        l->incorporate.regroup = SG_REGROUP_NONE;
        return true;
    }
}

static bool set_option(int opt, const char *arg, void *user)
{
    options *o = user;
    switch (opt) {
    case 'o':
        o->output = arg;
        return true;
    case OPT_INITIAL:
        o->initial = arg;
        return true;
    case OPT_REPORT:
        o->report = arg;
        return true;
    case OPT_NAMES:
    case OPT_FOLD:
    case OPT_CLASSES:
    case OPT_MAX_IMAGES:
    case OPT_CELLS:
    case OPT_ACCURACY:
        return set_input_option(opt, arg, o);
    case OPT_WEIGHT:
    case OPT_ALPHA:
    case OPT_DATA_TERM:
    case OPT_LENGTH_PRIOR:
        return set_energy_option(opt, arg, &o->learn.energy);
    default:
        return set_search_option(opt, arg, &o->learn);
    }
}

static bool is_one_file(const char *a, const char *b)
{
    return a != NULL && b != NULL && sg_file_same_place(a, b);
}

static bool is_stdout(const char *path)
{
    return path != NULL && strcmp(path, "-") == 0;
}

static int check_usage(const options *o, int nfolders)
{
    if (nfolders != 1)
        return sg_program_usage(nfolders == 0 ? "the folder to learn from is missing" : "one folder only");
    if (o->output == NULL)
        return sg_program_usage("-o FILE is missing");
    if (is_stdout(o->output) + is_stdout(o->initial) + is_stdout(o->common.json) > 1)
        return sg_program_usage("only one result can go to standard output");
    if (is_one_file(o->output, o->initial) || is_one_file(o->output, o->common.json) ||
        is_one_file(o->initial, o->common.json))
        return sg_program_usage("--output, --initial and --json need a file each");
    if (o->input.cells > 0 && o->input.accuracy > 0)
        return sg_program_usage("--cells and --accuracy exclude each other");
    if (o->input.dataset.fold > 0 && o->input.dataset.names_file != NULL)
        return sg_program_usage("--fold and --names exclude each other");
    if (o->learn.energy.data_term == SG_DATA_VITERBI && o->learn.energy.alpha < 1)
        return sg_program_usage("--data-term viterbi needs an --alpha of at least 1");
    return -1;
}

/* @return exit status, or -1: go on */
static int read_options(int argc, char **argv, options *o)
{
    const int end = sg_program_options(argc, argv, "o:", long_options, help, &o->common, set_option, o);
    if (end >= 0)
        return end;
    o->folder = argv[optind];
    return check_usage(o, argc - optind);
}

/* Places that cannot be written are better found before the work than after it. */
static sg_status try_output(const char *path, sg_error *err)
{
    sg_output out;
    if (path == NULL || is_stdout(path))
        return SG_OK;
    SG_TRY(sg_output_open(&out, path, err));
    sg_output_discard(&out);
    return SG_OK;
}

/* None of them is a page of the report. */
static sg_status spare_report(const options *o, sg_error *err)
{
    char index[4096], drawing[4096];
    const char *const pages[] = {index, drawing};
    if (o->report == NULL)
        return SG_OK;
    snprintf(index, sizeof index, "%s/index.html", o->report); /* a cut one fails when it is written */
    snprintf(drawing, sizeof drawing, "%s/grammar.svg", o->report);
    SG_TRY(sg_program_apart(o->output, pages, 2, err));
    SG_TRY(sg_program_apart(o->initial, pages, 2, err));
    return sg_program_apart(o->common.json, pages, 2, err);
}

static sg_status try_outputs(const options *o, sg_error *err)
{
    SG_TRY(spare_report(o, err));
    SG_TRY(try_output(o->output, err));
    SG_TRY(try_output(o->initial, err));
    SG_TRY(try_output(o->common.json, err));
    return o->report != NULL ? sg_folder_create(o->report, err) : SG_OK;
}

/* What an output must not replace: tables and lists, label maps and lattices. */
static sg_status spare_inputs(const options *o, const sg_learn_input *in, const char *output, sg_arena *a, sg_error *err)
{
    const sg_dataset_opts *d = &o->input.dataset;
    const char *const tables[] = {d->classes_file, d->names_file, sg_arena_printf(a, "%s/classes.tsv", o->folder),
                                  sg_arena_printf(a, "%s/folds/%d.tsv", o->folder, d->fold)};
    SG_TRY(sg_program_spare(output, tables, sizeof tables / sizeof tables[0], err));
    for (size_t i = 0; i < in->n; i++) {
        const char *const data[] = {sg_arena_printf(a, "%s/%s.lat", o->folder, in->names[i]),
                                    sg_arena_printf(a, "%s/labels/%s.png", o->folder, in->names[i])};
        if (data[0] == NULL || data[1] == NULL)
            return SG_FAIL_NOMEM(err);
        SG_TRY(sg_program_spare(output, data, 2, err));
    }
    return SG_OK;
}

static sg_status spare_all_inputs(const options *o, const sg_learn_input *in, sg_arena *a, sg_error *err)
{
    SG_TRY(spare_inputs(o, in, o->output, a, err));
    SG_TRY(spare_inputs(o, in, o->initial, a, err));
    return spare_inputs(o, in, o->common.json, a, err);
}

static const char *concentrations(const sg_density_opts *d, sg_arena *a)
{
    const char *text[2];
    for (int axis = SG_SPLIT_X; axis <= SG_SPLIT_Y; axis++)
        text[axis] = d->concentration[axis] == SG_CONCENTRATION_POOLED
                         ? "pooled"
                         : sg_arena_printf(a, "%g", d->concentration[axis]);
    return text[0] != NULL && text[1] != NULL ? sg_arena_printf(a, "%s, %s", text[0], text[1]) : NULL;
}

static size_t list_settings(const options *o, const sg_learn_result *r, sg_arena *a, sg_report_line *s)
{
    const sg_learn_opts *l = &o->learn;
    size_t n = 0;
    s[n++] = (sg_report_line){"data", o->folder};
    if (o->input.dataset.fold > 0)
        s[n++] = (sg_report_line){"fold", sg_arena_printf(a, "%d", o->input.dataset.fold)};
    if (o->input.dataset.classes_file != NULL)
        s[n++] = (sg_report_line){"classes", o->input.dataset.classes_file};
    s[n++] = (sg_report_line){"weight of the prior", sg_arena_printf(a, "%g", l->energy.weight)};
    s[n++] = (sg_report_line){"data term", data_terms[l->energy.data_term]};
    s[n++] = (sg_report_line){"alpha", sg_arena_printf(a, "%g", l->energy.alpha)};
    s[n++] = (sg_report_line){"length prior", length_priors[l->energy.poisson ? 0 : 1]};
    s[n++] = (sg_report_line){"shared rows", shares[l->incorporate.share]};
    s[n++] = (sg_report_line){"regrouping of rows", regroups[r->regroup]};
    s[n++] = (sg_report_line){"compatible for a merge", compatibles[l->compatible]};
    s[n++] = (sg_report_line){"search", searches[l->search.kind]};
    s[n++] = (sg_report_line){"chunks", l->search.chunk ? "yes" : "no"};
    s[n++] = (sg_report_line){"re-estimation", moments[l->reestimate_every ? 1 : 0]};
    s[n++] = (sg_report_line){"tied siblings", l->tied ? "yes" : "no"};
    s[n++] = (sg_report_line){"concentration of sizes", concentrations(&l->densities, a)};
    s[n++] = (sg_report_line){"seed", sg_arena_printf(a, "%llu", (unsigned long long)o->common.seed)};
    for (size_t i = 0; i < n; i++)
        if (s[i].value == NULL)
            s[i].value = "";
    return n;
}

static sg_status write_all(const options *o, const sg_learn_input *in, const sg_learn_result *r, double seconds,
                           sg_arena *arena, sg_error *err)
{
    sg_report_line settings[20];
    SG_TRY(sg_learn_write_grammar(&r->finished, o->output, err));
    if (o->initial != NULL)
        SG_TRY(sg_learn_write_grammar(&r->initial, o->initial, err));
    if (o->common.json != NULL)
        SG_TRY(sg_learn_write_json(r, &o->learn, seconds, o->common.json, err));
    if (o->report != NULL)
        SG_TRY(sg_learn_write_report(o->report, in, r, settings, list_settings(o, r, arena, settings), o->common.seed,
                                     seconds, err));
    return SG_OK;
}

static void tell(const sg_learn_input *in, const sg_learn_result *r, double seconds)
{
    const sg_grammar_sizes a = sg_split_form_sizes(&r->initial), b = sg_split_form_sizes(&r->merged);
    sg_program_progress_end();
    fprintf(stderr,
            "learn-grammar: %zu lattices of %.0f cells; energy %.2f -> %.2f (last re-estimation %+.3g); non-terminals"
            " %zu -> %zu, x-rules %zu -> %zu, y-rules %zu -> %zu; %zu merges, %zu chunks in %.2f s\n",
            in->n, in->cells, r->initial_energy.energy, r->energy.energy, r->energy.energy - r->searched_energy,
            a.nonterminals, b.nonterminals, a.rules_x, b.rules_x, a.rules_y, b.rules_y, r->history.merges,
            r->history.chunks, seconds);
}

static sg_status learn_and_write(options *o, const sg_learn_input *in, sg_error *err)
{
    sg_learn_result r;
    sg_arena *arena = sg_arena_create();
    if (arena == NULL)
        return SG_FAIL_NOMEM(err);
    o->learn.incorporate.nterminals = in->nterminals;
    o->learn.incorporate.terminal_names = in->terminal_names;
    o->learn.incorporate.terminal_colors = in->terminal_colors;
    sg_status st = spare_all_inputs(o, in, arena, err);
    if (st == SG_OK)
        st = sg_learn(in->lattices, in->n, &o->learn, arena, &r, err);
    if (st == SG_OK || st == SG_STOPPED) {
        const double seconds = r.search_s + r.reestimate_s;
        const sg_status written = write_all(o, in, &r, seconds, arena, err);
        if (written == SG_OK && !o->common.quiet)
            tell(in, &r, seconds);
        st = written != SG_OK ? written : st;
        sg_learn_result_clear(&r);
    }
    sg_arena_free(arena);
    return st;
}

static void complain(void *user, const char *sentence)
{
    (void)user;
    sg_program_complain("%s", sentence);
}

static sg_status run(options *o, bool *nothing, sg_error *err)
{
    sg_learn_input in;
    SG_TRY(try_outputs(o, err));
    sg_progress progress = sg_program_progress(&o->common);
    o->input.progress = o->learn.search.progress = &progress;
    if (o->common.threads > 0)
        omp_set_num_threads(o->common.threads);
    o->input.fault = complain;
    o->learn.search.seed = o->common.seed;
    SG_TRY(sg_learn_input_read(o->folder, &o->input, &in, err));
    *nothing = false;
    const sg_status st = learn_and_write(o, &in, err);
    sg_learn_input_clear(&in);
    return st;
}

int main(int argc, char **argv)
{
    options o = {SG_COMMON_OPTS_INIT, SG_LEARN_INPUT_OPTS_INIT, SG_LEARN_OPTS_INIT, NULL, NULL, NULL, NULL};
    sg_error err = SG_ERROR_INIT;
    o.input.dataset.max_images = 30;
    sg_program_begin("learn-grammar");
    const int usage = read_options(argc, argv, &o);
    if (usage >= 0)
        return usage;
    bool nothing = true;
    const sg_status st = run(&o, &nothing, &err);
    if (st == SG_STOPPED && nothing) {
        sg_program_complain("stopped before there was a grammar: nothing is written");
        return sg_exit_code(st);
    }
    return sg_program_end(st, &err);
}
