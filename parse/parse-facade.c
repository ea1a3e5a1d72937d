/* SPDX-License-Identifier: GPL-3.0-or-later */
/* parse-facade.c - photographs of facades by a grammar. */
#include "config.h"

#include "core/file.h"
#include "core/utf8.h"
#include "grammar/json_text.h"
#include "grammar/split.h"
#include "parse/facade_process.h"
#include "parse/unaries.h"
#include "program/program.h"
#include "program/program_grammar.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

static const char HELP[] =
    "Example: parse-facade facades.sg -u facades.rf photographs/*.jpg -o parsed\n"
    "\n"
    "Usage: parse-facade GRAMMAR -u CLASSIFIER|-p DIR IMAGE... -o DIR [OPTION]...\n"
    "Parse photographs of facades by a split grammar: the derivation that explains the pixels' labels best. An IMAGE is a\n"
    "photograph, a data set folder (its photographs, with their label maps for truth), or with -p the name of an array.\n"
    "\n"
    "  -u, --classifier FILE\n"
    "                     class probabilities of the pixels by a classifier of learn-unaries\n"
    "  -p, --probabilities DIR\n"
    "                     the same from DIR/NAME.npy, with the classes of DIR/classes.tsv\n"
    "  -o, --output DIR   folder for the results\n"
    "  --formats LIST     what to write for each, with commas between: labels, overlay, derivation, trace, marginals,\n"
    "                     lines, uncertainty (default all)\n"
    "  --hard [P]         most probable class only, with probability P (default 0.994)\n"
    "  --floor P          least probability of a class (default 1e-06)\n"
    "  --unary-weight W   weight of the pixels (default 1)\n"
    "  --truth DIR        data set, or folder of label maps NAME.png: also print accuracies; --classes FILE: their table\n"
    "  --fold K, --part PART, --names FILE\n"
    "                     which images of a data set (default: all; test images of a fold)\n"
    "  --method M         mcmc (default), or exact: dynamic programming on a lattice of the unaries\n"
    "  --start S          chains begin at samples of the prior, or at exact's parse (prior, exact)\n"
    "  --gap              mcmc, exact, and mcmc from exact's parse: print all three\n"
    "  --runs N, --iterations N, --chains N, --tempering T\n"
    "                     of the search: 5, 100000, 8, 1.3; --time S: at most so many seconds a photograph\n"
    "  --anneal B         in the last half all inverse temperatures rise to B (default 1: not)\n"
    "  --share KIND=S     share of a kind of moves: jump-fresh, jump-copy, resample, reflect, shift,\n"
    "                     switch\n"
    "  --no-delayed-rejection, --depth-base B, --reflect-step S, --shift-step S, --swap-every N, --tries N\n"
    "                     of the moves and chains; the manual page says more\n"
    "  --burn-in SHARE    of the iterations, whose samples are dropped (default 0.5); --samples N: kept of a run\n"
    "  --cells N          most cells of the lattice of exact\n" SG_COMMON_HELP "\n"
    "Exit status: 0 done, 1 not parsed, 2 wrong usage, 3 bad input (the others are parsed), 4 the system failed, 5 stopped.\n";

typedef struct {
    sg_common_opts common;
    const char *grammar, *classifier, *probabilities, *output, *truth, *truth_table;
    sg_dataset_opts dataset;
    bool part_given, start_given, gap, dataset_opts_given;
    sg_facade_opts facade;
    double hard, floor;
    unsigned formats;
    char **argv, **images;
    size_t nimages;
} options;

typedef struct {
    const options *opts;
    sg_arena *arena;
    sg_grammar *g;
    sg_pixel_classifier *classifier;
    sg_classes own_classes, truth_classes;
    sg_facade_setup setup;
    sg_facade_photos photos;
    sg_facade_outcome *outcomes; /* [photos.n] */
    size_t ndone;
    sg_progress bar, progress;   /* what is shown; what the library is given */
} job;

/* ---- options ---- */

enum {
    OPT_FORMATS = SG_OPT_OWN, OPT_HARD, OPT_FLOOR, OPT_WEIGHT, OPT_TRUTH, OPT_CLASSES, OPT_FOLD, OPT_PART, OPT_NAMES,
    OPT_METHOD, OPT_START, OPT_GAP, OPT_RUNS, OPT_ITERATIONS, OPT_CHAINS, OPT_TEMPERING, OPT_TIME, OPT_ANNEAL, OPT_SHARE,
    OPT_NO_DELAYED, OPT_DEPTH_BASE, OPT_REFLECT, OPT_SHIFT, OPT_SWAP_EVERY, OPT_TRIES, OPT_BURN_IN, OPT_SAMPLES, OPT_CELLS
};

static const struct option LONG_OPTIONS[] = {
    {"classifier", required_argument, NULL, 'u'},
    {"probabilities", required_argument, NULL, 'p'},
    {"output", required_argument, NULL, 'o'},
    {"formats", required_argument, NULL, OPT_FORMATS},
    {"hard", optional_argument, NULL, OPT_HARD},
    {"floor", required_argument, NULL, OPT_FLOOR},
    {"unary-weight", required_argument, NULL, OPT_WEIGHT},
    {"truth", required_argument, NULL, OPT_TRUTH},
    {"classes", required_argument, NULL, OPT_CLASSES},
    {"fold", required_argument, NULL, OPT_FOLD},
    {"part", required_argument, NULL, OPT_PART},
    {"names", required_argument, NULL, OPT_NAMES},
    {"method", required_argument, NULL, OPT_METHOD},
    {"start", required_argument, NULL, OPT_START},
    {"gap", no_argument, NULL, OPT_GAP},
    {"runs", required_argument, NULL, OPT_RUNS},
    {"iterations", required_argument, NULL, OPT_ITERATIONS},
    {"chains", required_argument, NULL, OPT_CHAINS},
    {"tempering", required_argument, NULL, OPT_TEMPERING},
    {"time", required_argument, NULL, OPT_TIME},
    {"anneal", required_argument, NULL, OPT_ANNEAL},
    {"share", required_argument, NULL, OPT_SHARE},
    {"no-delayed-rejection", no_argument, NULL, OPT_NO_DELAYED},
    {"depth-base", required_argument, NULL, OPT_DEPTH_BASE},
    {"reflect-step", required_argument, NULL, OPT_REFLECT},
    {"shift-step", required_argument, NULL, OPT_SHIFT},
    {"swap-every", required_argument, NULL, OPT_SWAP_EVERY},
    {"tries", required_argument, NULL, OPT_TRIES},
    {"burn-in", required_argument, NULL, OPT_BURN_IN},
    {"samples", required_argument, NULL, OPT_SAMPLES},
    {"cells", required_argument, NULL, OPT_CELLS},
    SG_COMMON_LONG_OPTIONS,
    {NULL, 0, NULL, 0}};

static bool take_formats(const char *arg, unsigned *formats)
{
    const char *names[SG_FACADE_FORMATS + 2] = {NULL};
    for (int k = 0; k < SG_FACADE_FORMATS; k++)
        names[k] = sg_facade_format_name(k);
    names[SG_FACADE_FORMATS] = "all";
    if (!sg_program_choices("--formats", arg, names, formats))
        return false;
    if (*formats & 1U << SG_FACADE_FORMATS)
        *formats = SG_FACADE_ALL;
    return true;
}

/* --hard, --hard=P, or --hard P: a number that follows is taken for P. */
static bool take_hard(options *o, const char *arg)
{
    if (arg == NULL && o->argv[optind] != NULL) {
        char *end;
        const double v = strtod(o->argv[optind], &end);
        if (end != o->argv[optind] && *end == '\0' && v >= 0)
            arg = o->argv[optind++];
    }
    o->hard = 0.994;
    if (arg == NULL || (sg_program_double("--hard", arg, 0, 1, &o->hard) && o->hard > 0 && o->hard < 1))
        return true;
    if (o->hard == 0 || o->hard == 1)
        sg_program_usage("--hard: '%s' is no probability between 0 and 1", arg);
    return false;
}

/* KIND=S. */
static bool take_share(const char *arg, sg_kernel_opts *kernel)
{
    const char *names[SG_MOVE_KINDS + 1] = {NULL}, *equals = strchr(arg, '=');
    char kind[32];
    int which;
    for (int k = 0; k < SG_MOVE_KINDS; k++)
        names[k] = sg_move_name((sg_move_kind)k);
    const size_t n = equals != NULL ? (size_t)(equals - arg) : strlen(arg);
    snprintf(kind, sizeof kind, "%.*s", (int)(n < 31 ? n : 31), arg);
    if (!sg_program_choice("--share", kind, names, &which))
        return false;
    if (equals == NULL)
        return sg_program_usage("--share: '%s' is not KIND=S", arg), false;
    return sg_program_double("--share", equals + 1, 0, 1e9, &kernel->share[which]);
}

static bool take_method(const char *arg, options *o)
{
    static const char *const methods[] = {"mcmc", "exact", NULL};
    int which;
    if (!sg_program_choice("--method", arg, methods, &which))
        return false;
    o->facade.stages[SG_FACADE_EXACT] = which == 1;
    o->facade.stages[SG_FACADE_SEARCH] = which == 0;
    return true;
}

static bool take_start(const char *arg, options *o)
{
    static const char *const starts[] = {"prior", "exact", NULL};
    int which;
    o->start_given = true;
    if (!sg_program_choice("--start", arg, starts, &which))
        return false;
    o->facade.stages[SG_FACADE_SEARCH_FROM_EXACT] = which == 1;
    return true;
}

static bool take_search(int opt, const char *arg, options *o)
{
    sg_metropolis_opts *s = &o->facade.search;
    switch (opt) {
    case OPT_RUNS:
        return sg_program_size("--runs", arg, 1, 10000, &s->runs);
    case OPT_ITERATIONS:
        return sg_program_size("--iterations", arg, 1, 1000000000000, &s->iterations);
    case OPT_CHAINS:
        return sg_program_size("--chains", arg, 1, 1000, &s->chains);
    case OPT_TEMPERING:
        return sg_program_double("--tempering", arg, 1, 1000, &s->tempering);
    case OPT_TIME:
        return sg_program_double("--time", arg, 1e-3, 1e9, &s->time_s);
    case OPT_ANNEAL:
        return sg_program_double("--anneal", arg, 1, 1e6, &s->anneal);
    case OPT_SHARE:
        return take_share(arg, &s->kernel);
    case OPT_NO_DELAYED:
        s->kernel.delayed_rejection = false;
        return true;
    case OPT_DEPTH_BASE:
        return sg_program_double("--depth-base", arg, 1e-3, 1e3, &s->kernel.depth_base);
    case OPT_REFLECT:
        return sg_program_double("--reflect-step", arg, 1e-9, 1e3, &s->kernel.reflect_step);
    case OPT_SHIFT:
        return sg_program_double("--shift-step", arg, 1e-9, 1e3, &s->kernel.shift_step);
    case OPT_SWAP_EVERY:
        return sg_program_size("--swap-every", arg, 1, 1000000000, &s->swap_every);
    default:
        return sg_program_size("--tries", arg, 1, 1000000000, &s->tries);
    }
}

static bool take_data(int opt, const char *arg, options *o)
{
    static const char *const parts[] = {"train", "valid", "test", "all", NULL};
    size_t n = 0;
    int part = 0;
    switch (opt) {
    case OPT_FOLD:
        o->dataset_opts_given = true;
        if (!sg_program_size("--fold", arg, 1, 1000000, &n))
            return false;
        o->dataset.fold = (int)n;
        return true;
    case OPT_PART:
        o->part_given = true;
        if (!sg_program_choice("--part", arg, parts, &part))
            return false;
        o->dataset.part = (sg_dataset_part)part;
        return true;
    case OPT_NAMES:
        o->dataset_opts_given = true;
        o->dataset.names_file = arg;
        return true;
    case OPT_TRUTH:
        o->truth = arg;
        return true;
    default:
        o->truth_table = arg;
        return true;
    }
}

static bool take_own(int opt, const char *arg, void *user)
{
    options *o = user;
    switch (opt) {
    case 'u':
        o->classifier = arg;
        return true;
    case 'p':
        o->probabilities = arg;
        return true;
    case 'o':
        o->output = arg;
        return true;
    case OPT_FORMATS:
        return take_formats(arg, &o->formats);
    case OPT_HARD:
        return take_hard(o, arg);
    case OPT_FLOOR:
        return sg_program_double("--floor", arg, 1e-30, 1, &o->floor);
    case OPT_WEIGHT:
        return sg_program_double("--unary-weight", arg, 1e-9, 1e9, &o->facade.weight);
    case OPT_METHOD:
        return take_method(arg, o);
    case OPT_START:
        return take_start(arg, o);
    case OPT_GAP:
        o->gap = true;
        return true;
    case OPT_BURN_IN:
        return sg_program_double("--burn-in", arg, 0, 0.999, &o->facade.burn_in);
    case OPT_SAMPLES:
        return sg_program_size("--samples", arg, 2, 1000000, &o->facade.samples);
    case OPT_CELLS:
        return sg_program_size("--cells", arg, 1, 1000000, &o->facade.exact.max_cells);
    case OPT_TRUTH:
    case OPT_CLASSES:
    case OPT_FOLD:
    case OPT_PART:
    case OPT_NAMES:
        return take_data(opt, arg, o);
    default:
        return take_search(opt, arg, o);
    }
}

static bool has_a_share(const sg_kernel_opts *kernel)
{
    for (int k = 0; k < SG_MOVE_KINDS; k++)
        if (kernel->share[k] > 0)
            return true;
    return false;
}

/* What is asked for twice, or of nothing. */
static int check_args(const options *o)
{
    if ((o->classifier != NULL) == (o->probabilities != NULL))
        return sg_program_usage("expected either a classifier (-u) or a folder of probabilities (-p)");
    if (o->output == NULL)
        return sg_program_usage("expected a folder for the results: -o DIR");
    if (o->dataset.fold != 0 && o->dataset.names_file != NULL)
        return sg_program_usage("--fold and --names cannot both be asked for");
    if (o->part_given && o->dataset.fold == 0)
        return sg_program_usage("--part belongs to --fold");
    if (o->start_given && o->facade.stages[SG_FACADE_EXACT] && !o->gap)
        return sg_program_usage("--start belongs to --method mcmc");
    if (o->gap && o->facade.stages[SG_FACADE_EXACT])
        return sg_program_usage("--gap makes both; --method exact is not needed");
    if (o->gap && o->start_given)
        return sg_program_usage("--gap begins at both; --start is not needed");
    if (!has_a_share(&o->facade.search.kernel))
        return sg_program_usage("--share: every kind of moves has a share of 0, so there is none to make");
    return -1;
}

/* JSON holds UTF-8 only. */
static int check_utf8(const options *o)
{
    const char *const paths[] = {o->probabilities, o->output, o->truth};
    for (size_t i = 0; i < o->nimages + 3; i++) {
        const char *path = i < o->nimages ? o->images[i] : paths[i - o->nimages];
        if (path != NULL && !sg_utf8_is(path, strlen(path)))
            return sg_program_usage("--json: the name '%s' is no UTF-8", path);
    }
    return -1;
}

/* Exit status to leave with, or -1 to go on. */
static int parse_args(int argc, char **argv, options *o)
{
    o->argv = argv;
    const int end = sg_program_options(argc, argv, "u:p:o:", LONG_OPTIONS, HELP, &o->common, take_own, o);
    if (end >= 0)
        return end;
    if (argc - optind < 2)
        return sg_program_usage("expected a grammar and at least one photograph");
    o->grammar = argv[optind];
    o->images = argv + optind + 1;
    o->nimages = (size_t)(argc - optind - 1);
    const int code = check_args(o);
    if (code >= 0)
        return code;
    bool *stages = o->facade.stages;
    if (o->gap)
        stages[SG_FACADE_EXACT] = stages[SG_FACADE_SEARCH] = stages[SG_FACADE_SEARCH_FROM_EXACT] = true;
    else if (stages[SG_FACADE_SEARCH_FROM_EXACT])
        stages[SG_FACADE_SEARCH] = false;
    if ((o->formats & (SG_FACADE_MARGINALS | SG_FACADE_LINES | SG_FACADE_UNCERTAINTY)) == 0)
        o->facade.samples = 0;
    o->facade.search.seed = o->common.seed;
    o->facade.search.threads = o->common.threads;
    return o->common.json != NULL ? check_utf8(o) : -1;
}

/* ---- what all photographs share ---- */

static void tell_fault(void *user, const char *sentence)
{
    (void)user;
    sg_program_complain("%s", sentence);
}

/* Classes of the channels. */
static sg_status read_classes(job *j, sg_error *err)
{
    const options *o = j->opts;
    if (o->classifier != NULL) {
        SG_TRY(sg_pixel_classifier_read(o->classifier, &j->classifier, err));
        j->setup.classes = sg_pixel_classifier_classes(j->classifier);
        return SG_OK;
    }
    const char *path = sg_arena_printf(j->arena, "%s/classes.tsv", o->probabilities);
    if (path == NULL)
        return SG_FAIL_NOMEM(err);
    j->setup.classes = &j->own_classes;
    return sg_classes_read(path, &j->own_classes, err);
}

static sg_status read_grammar(job *j, sg_error *err)
{
    SG_TRY(sg_program_load_grammar(j->opts->grammar, &j->g, err));
    uint32_t *channel = SG_NEW_ARRAY(j->arena, uint32_t, sg_grammar_symbol_count(j->g));
    if (channel == NULL)
        return SG_FAIL_NOMEM(err);
    const sg_status st = sg_unaries_channels(j->g, j->setup.classes, channel, err);
    if (st != SG_OK) {
        const sg_error why = *err;
        return SG_FAIL(err, st, "%s: %.950s", j->opts->grammar, why.msg);
    }
    j->setup.g = j->g;
    j->setup.channel = channel;
    if (!j->opts->facade.stages[SG_FACADE_EXACT] && !j->opts->facade.stages[SG_FACADE_SEARCH_FROM_EXACT])
        return SG_OK;
    sg_split_form form; /* what it refuses, exact would refuse for every photograph */
    return sg_split_form_of(j->g, j->arena, &form, err);
}

/* Classes that the grammar has no label for are left to other labels. */
static void tell_unused_classes(const job *j)
{
    char list[400] = "";
    for (size_t c = 0; c < j->setup.classes->nclasses; c++) {
        bool used = false;
        for (sg_sym s = 0; s < sg_grammar_symbol_count(j->g); s++)
            used = used || j->setup.channel[s] == c;
        const size_t n = strlen(list);
        if (!used)
            snprintf(list + n, sizeof list - n, "%s%s", n > 0 ? ", " : "", j->setup.classes->names[c]);
    }
    if (list[0] != '\0' && !j->opts->common.quiet)
        sg_program_complain("note: the grammar has no label for %s", list);
}

/* Its class table: as asked for, beside the truth, that of the data set among the images, that of the channels. */
static sg_status read_truth_table(job *j, sg_error *err)
{
    const options *o = j->opts;
    const char *path = o->truth_table;
    const char *folders[2] = {o->truth, NULL};
    for (size_t i = 0; i < o->nimages && folders[1] == NULL && o->truth == NULL; i++)
        if (sg_folder_exists(o->images[i]))
            folders[1] = o->images[i];
    for (int k = 0; k < 2; k++) {
        if (folders[k] == NULL || path != NULL)
            continue;
        path = sg_arena_printf(j->arena, "%s/classes.tsv", folders[k]);
        if (path == NULL)
            return SG_FAIL_NOMEM(err);
        path = sg_file_exists(path) ? path : NULL;
    }
    bool any = false;
    for (size_t i = 0; i < j->photos.n; i++)
        any = any || j->photos.items[i].truth != NULL;
    if (!any)
        return SG_OK;
    if (path != NULL)
        SG_TRY(sg_classes_read(path, &j->truth_classes, err));
    j->setup.truth_classes = path != NULL ? &j->truth_classes : j->setup.classes;
    return sg_evaluation_classes(j->setup.classes, j->setup.truth_classes, NULL, 0, j->setup.truth_of, err);
}

static sg_status list_photos(job *j, sg_error *err)
{
    const options *o = j->opts;
    sg_dataset_opts dataset = o->dataset;
    dataset.classes_file = o->truth_table;
    dataset.one_image = true;
    const sg_facade_photo_opts opts = {o->probabilities, o->truth, &dataset};
    SG_TRY(sg_facade_photos_list(o->images, o->nimages, &opts, j->arena, tell_fault, NULL, &j->photos, err));
    if (j->photos.ndatasets == 0 && o->dataset_opts_given)
        return SG_FAIL(err, SG_EINVAL, "--fold and --names choose from a data set folder, and no image is one");
    return read_truth_table(j, err);
}

/* ---- files ---- */

static const char *output_path(const job *j, const char *name, const char *ending)
{
    return sg_arena_printf(j->arena, "%s/%s%s", j->opts->output, name, ending);
}

/* With probabilities and results in one folder they share the table: it is not written again. */
static bool shares_table(const job *j)
{
    return j->opts->probabilities != NULL && sg_file_same(j->opts->probabilities, j->opts->output);
}

static sg_status spare_inputs(const job *j, sg_error *err)
{
    const options *o = j->opts;
    const size_t n = j->photos.n;
    const char **outputs = SG_NEW_ARRAY(j->arena, const char *, n * SG_FACADE_FORMATS + 2);
    const char **inputs = SG_NEW_ARRAY(j->arena, const char *, 3 * n + 6);
    size_t nout = 0, nin = 0;
    if (outputs == NULL || inputs == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t i = 0; i < n; i++) {
        const sg_facade_photo *p = &j->photos.items[i];
        for (int k = 0; k < SG_FACADE_FORMATS; k++)
            if (((o->formats | SG_FACADE_OWN) >> k & 1) &&
                (outputs[nout++] = output_path(j, p->name, sg_facade_format_ending(k))) == NULL)
                return SG_FAIL_NOMEM(err);
        inputs[nin++] = p->image;
        inputs[nin++] = p->probabilities;
        inputs[nin++] = p->truth;
    }
    if (!shares_table(j) && (outputs[nout++] = output_path(j, "classes", ".tsv")) == NULL)
        return SG_FAIL_NOMEM(err);
    const char *const shared[] = {o->grammar, o->classifier, o->truth_table, o->dataset.names_file,
                                  sg_arena_printf(j->arena, "%s/classes.tsv", o->probabilities != NULL ? o->probabilities : "."),
                                  sg_arena_printf(j->arena, "%s/classes.tsv", o->truth != NULL ? o->truth : ".")};
    for (size_t k = 0; k < sizeof shared / sizeof shared[0]; k++)
        inputs[nin++] = shared[k];
    SG_TRY(sg_program_apart(o->common.json, outputs, nout, err));
    if (o->common.json != NULL && strcmp(o->common.json, "-") != 0)
        outputs[nout++] = o->common.json;
    return sg_facade_spare_files(outputs, nout, inputs, nin, err);
}

static sg_status write_table(const job *j, sg_error *err)
{
    SG_TRY(sg_folder_create(j->opts->output, err));
    if (shares_table(j))
        return SG_OK;
    const char *path = output_path(j, "classes", ".tsv");
    return path != NULL ? sg_classes_write(path, j->setup.classes, err) : SG_FAIL_NOMEM(err);
}

/* ---- the table ---- */

static bool shows_table(const job *j)
{
    return j->opts->common.json == NULL || strcmp(j->opts->common.json, "-") != 0;
}

static int name_width(const job *j)
{
    size_t width = 5;
    for (size_t i = 0; i < j->photos.n; i++)
        width = strlen(j->photos.items[i].name) > width ? strlen(j->photos.items[i].name) : width;
    return width < 40 ? (int)width : 40;
}

static void print_heading(const job *j)
{
    printf("%-*s %9s %13s %13s %11s %11s", name_width(j), "name", "size", "energy", "image", "rules", "sizes");
    if (j->setup.truth_classes != NULL)
        printf(" %7s %7s", "MAP", "parse");
    printf(" %8s %9s\n", "seconds", "moves/s");
}

static void print_share(double x)
{
    if (isnan(x))
        printf(" %7s", "-");
    else
        printf(" %6.2f%%", 100 * x);
}

static void print_energy(const sg_energy *e)
{
    printf(" %13.1f %13.1f %11.1f %11.1f", sg_energy_sum(e), e->image, e->rule, e->attribute);
}

/* The stages below each other, when there are several. */
static void print_stages(const job *j, const sg_facade_outcome *o)
{
    for (int s = 0; s < SG_FACADE_STAGES; s++) {
        if (!o->stages[s].done)
            continue;
        char name[64];
        snprintf(name, sizeof name, "  %s", sg_facade_stage_name((sg_facade_stage)s));
        printf("%-*s", name_width(j) + 10, name);
        print_energy(&o->stages[s].energy);
        if (j->setup.truth_classes != NULL) {
            printf(" %7s", "");
            print_share(o->stages[s].accuracy);
        }
        printf(" %8.2f\n", o->stages[s].seconds);
    }
}

static void print_outcome(const job *j, const sg_facade_photo *p, const sg_facade_outcome *o)
{
    const sg_facade_stage_outcome *best = &o->stages[o->best];
    printf("%-*s %4zux%-4zu", name_width(j), p->name, o->width, o->height);
    print_energy(&best->energy);
    if (j->setup.truth_classes != NULL) {
        print_share(o->scored ? sg_confusion_accuracy(&o->map) : NAN);
        print_share(best->accuracy);
    }
    printf(" %8.2f", o->seconds);
    if (o->searched && o->search_seconds > 0)
        printf(" %9.0f\n", (double)o->moves / o->search_seconds);
    else
        printf(" %9s\n", "-");
    int nstages = 0;
    for (int s = 0; s < SG_FACADE_STAGES; s++)
        nstages += o->stages[s].done;
    if (nstages > 1)
        print_stages(j, o);
    fflush(stdout);
}

/* Pixels of all photographs pooled. */
static sg_status print_scores(const job *j, sg_error *err)
{
    sg_confusion map, found;
    sg_scores of_map, of_found;
    const size_t n = j->setup.truth_classes->nclasses;
    SG_TRY(sg_confusion_create(n, j->arena, &map, err));
    SG_TRY(sg_confusion_create(n, j->arena, &found, err));
    for (size_t i = 0; i < j->photos.n; i++)
        if (j->outcomes[i].scored) {
            sg_confusion_merge(&j->outcomes[i].map, &map);
            sg_confusion_merge(&j->outcomes[i].found, &found);
        }
    SG_TRY(sg_scores_of(&map, j->arena, &of_map, err));
    SG_TRY(sg_scores_of(&found, j->arena, &of_found, err));
    if (isnan(of_found.overall)) /* no pixel has a truth */
        return SG_OK;
    printf("all %zu: accuracy %.2f%% (MAP %.2f%%), class average %.2f%% (MAP %.2f%%)\n", found.nmaps, 100 * of_found.overall,
           100 * of_map.overall, 100 * of_found.class_average, 100 * of_map.class_average);
    return SG_OK;
}

/* ---- the photographs ---- */

/* The library's steps, with the photograph they are about. */
static void report_photo(sg_progress *self, const char *step, size_t done, size_t total)
{
    job *j = self->user;
    char text[64];
    snprintf(text, sizeof text, "%.20s (%zu/%zu) %.20s", j->photos.items[j->ndone].name, j->ndone + 1, j->photos.n, step);
    j->bar.report(&j->bar, text, done, total);
}

static bool stop_photo(sg_progress *self)
{
    job *j = self->user;
    return sg_progress_stopped(&j->bar);
}

/* What the next photographs would meet too; memory that does not suffice for one may for others. */
static bool is_fatal(sg_status st)
{
    return st == SG_EIO || st == SG_STOPPED;
}

static void process_all(job *j)
{
    for (j->ndone = 0; j->ndone < j->photos.n && !sg_progress_stopped(&j->bar); j->ndone++) {
        const sg_facade_photo *photo = &j->photos.items[j->ndone];
        sg_facade_outcome *o = &j->outcomes[j->ndone];
        const sg_status st = sg_facade_process(&j->setup, photo, &j->progress, j->arena, o);
        sg_program_progress_end();
        if (st != SG_OK && st != SG_STOPPED)
            sg_program_complain("%s", o->error.msg);
        else if (shows_table(j) && o->stages[o->best].done)
            print_outcome(j, photo, o);
        if (is_fatal(st)) {
            j->ndone++;
            return;
        }
    }
}

static sg_status write_json(const job *j, sg_error *err)
{
    json_t *list = json_array();
    bool good = list != NULL;
    for (size_t i = 0; good && i < j->ndone; i++)
        good = json_array_append_new(list, sg_facade_outcome_json(&j->photos.items[i], &j->outcomes[i])) == 0;
    sg_output out;
    sg_status st = good ? sg_output_open(&out, j->opts->common.json, err) : SG_FAIL_NOMEM(err);
    if (st == SG_OK)
        st = sg_output_end(&out, sg_json_write(list, 2, out.fp, err), err);
    json_decref(list);
    return st;
}

/* How bad a status is for the whole run: the system, then bad input, then what could not be parsed. */
static int rank(sg_status st)
{
    switch (st) {
    case SG_OK:
    case SG_STOPPED:
        return 0;
    case SG_EIO:
    case SG_ENOMEM:
        return 3;
    case SG_EINPUT:
        return 2;
    default:
        return 1;
    }
}

static bool has_result(const job *j)
{
    for (size_t i = 0; i < j->ndone; i++)
        if (j->outcomes[i].stages[j->outcomes[i].best].done)
            return true;
    return false;
}

/* The worst that befell a photograph; each has been named already. */
static sg_status conclude(job *j, sg_error *err)
{
    sg_status worst = SG_OK;
    size_t nfailed = 0;
    for (size_t i = 0; i < j->ndone; i++) {
        const sg_status st = j->outcomes[i].status;
        nfailed += rank(st) > 0;
        worst = rank(st) > rank(worst) ? st : worst;
    }
    if (rank(worst) == 3)
        return SG_FAIL(err, worst, "%zu of %zu photographs were parsed", j->ndone - nfailed, j->photos.n);
    if (sg_progress_stopped(&j->bar))
        return SG_FAIL(err, SG_STOPPED, "stopped");
    if (nfailed > 0)
        return SG_FAIL(err, worst == SG_EINVAL ? SG_ENUMERIC : worst, "%zu of %zu photographs were not parsed", nfailed,
                       j->photos.n);
    return SG_OK;
}

static sg_status process_and_report(job *j, sg_error *err)
{
    sg_error inner = SG_ERROR_INIT;
    SG_TRY(write_table(j, err));
    if (shows_table(j))
        print_heading(j);
    process_all(j);
    sg_status st = SG_OK;
    if (shows_table(j) && j->setup.truth_classes != NULL)
        st = print_scores(j, &inner);
    if (st == SG_OK && j->opts->common.json != NULL)
        st = write_json(j, &inner);
    if (st != SG_OK) {
        *err = inner;
        return st;
    }
    return conclude(j, err);
}

/* Probabilities that --floor and --hard set, against the number of classes. */
static sg_status check_levels(const job *j, sg_error *err)
{
    const size_t n = j->setup.classes->nclasses;
    const double even = 1 / (double)n;
    if (n > 1 && j->opts->floor >= even)
        return SG_FAIL(err, SG_EINVAL, "--floor %g: with %zu classes it must be below %g", j->opts->floor, n, even);
    if (j->opts->hard > 0 && n == 1)
        return SG_FAIL(err, SG_EINVAL, "--hard: there is one class only, so nothing is more probable than something else");
    if (j->opts->hard > 0 && j->opts->hard <= even)
        return SG_FAIL(err, SG_EINVAL, "--hard %g: with %zu classes it must be above %g", j->opts->hard, n, even);
    return SG_OK;
}

static sg_status run(job *j, sg_error *err)
{
    const options *o = j->opts;
    const int threads = o->common.threads > 0 ? o->common.threads : omp_get_max_threads();
    j->setup = (sg_facade_setup){.hard = o->hard, .floor = (float)o->floor, .opts = o->facade, .folder = o->output,
                                 .formats = o->formats, .threads = threads};
    SG_TRY(read_classes(j, err));
    SG_TRY(read_grammar(j, err));
    j->setup.classifier = j->classifier;
    SG_TRY(check_levels(j, err));
    tell_unused_classes(j);
    SG_TRY(list_photos(j, err));
    SG_TRY(spare_inputs(j, err));
    j->outcomes = SG_NEW_ARRAY(j->arena, sg_facade_outcome, j->photos.n);
    if (j->outcomes == NULL)
        return SG_FAIL_NOMEM(err);
    return process_and_report(j, err);
}

int main(int argc, char **argv)
{
    options o = {.common = SG_COMMON_OPTS_INIT, .dataset = SG_DATASET_OPTS_INIT, .facade = SG_FACADE_OPTS_INIT, .floor = 1e-6,
                 .formats = SG_FACADE_ALL};
    o.dataset.part = SG_SPLIT_TEST;
    sg_program_begin("parse-facade");
    const int code = parse_args(argc, argv, &o);
    if (code >= 0)
        return code;
    sg_error err = SG_ERROR_INIT;
    job j = {.opts = &o, .arena = sg_arena_create(), .bar = sg_program_progress(&o.common)};
    j.progress = (sg_progress){j.bar.report != NULL ? report_photo : NULL, stop_photo, &j};
    const sg_status st = j.arena != NULL ? run(&j, &err) : SG_FAIL_NOMEM(&err);
    const bool nothing = st == SG_STOPPED && !has_result(&j);
    sg_pixel_classifier_free(j.classifier);
    sg_classes_clear(&j.own_classes);
    sg_classes_clear(&j.truth_classes);
    sg_grammar_free(j.g);
    sg_arena_free(j.arena);
    if (nothing) {
        sg_program_complain("stopped before a photograph was parsed");
        return sg_exit_code(st);
    }
    return sg_program_end(st, &err);
}
