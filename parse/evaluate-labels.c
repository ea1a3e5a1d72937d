/* SPDX-License-Identifier: GPL-3.0-or-later */
/* evaluate-labels.c - label maps that were found, against those of a data set. */
#include "config.h"

#include "core/arena.h"
#include "core/file.h"
#include "image/png_io.h"
#include "parse/dataset.h"
#include "parse/evaluation.h"
#include "parse/evaluation_print.h"
#include "program/program.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char HELP[] =
    "Example: evaluate-labels data/facades out/parsed --fold 1\n"
    "\n"
    "Usage: evaluate-labels DATASET DIR [OPTION]...\n"
    "Compare the label maps DIR/NAME.png with those of a data set: confusion matrix, recall and intersection over union\n"
    "of each class, overall pixel accuracy, class average. Classes go by name: the maps' table is DIR/classes.tsv, or\n"
    "the data set's where there is none.\n"
    "\n"
    "  --fold K           the test images of folds/K.tsv; several, or a range as 1-5, give each fold, all pixels\n"
    "                     pooled, the mean of the folds, and the published convention; %d in DIR is then the fold\n"
    "  --part PART        train, valid, test or all of the fold (default test)\n"
    "  --names FILE       the images named in FILE, one a line (default: all of the data set)\n"
    "  --classes FILE     class table of the truth in place of the data set's; pixels of 'ignore' count nowhere\n"
    "  --map-classes FILE class table of the maps in DIR\n"
    "  --alias NAME=OTHER what was found to be NAME counts as OTHER; may be repeated\n" SG_COMMON_HELP "\n"
    "What was found to be no class of the truth's is an error, and said. Maps of ECP that know chimneys are measured by\n"
    "  evaluate-labels ecp out/fold%d --fold 1-5 --classes ecp/classes7.tsv --alias chimney=roof\n"
    "as in the published tables.\n"
    "Exit status: 0 done, 2 wrong usage, 3 bad input, 4 the system failed, 5 stopped.\n";

enum { MAX_FOLDS = 1000, MAX_ALIASES = 250 };

typedef struct {
    sg_common_opts common;
    const char *folder, *maps;
    sg_dataset_opts dataset;
    bool part_given;
    int folds[MAX_FOLDS];
    size_t nfolds; /* 0: no fold asked for */
    const char *map_classes;
    const char *aliases[MAX_ALIASES];
    size_t naliases;
} options;

/* One fold, or all that was chosen without one. */
typedef struct {
    int number; /* 0: no fold */
    const char *maps;
    sg_dataset dataset;
    bool open;
    sg_confusion confusion;
    sg_scores scores;
} fold;

typedef struct {
    const options *opts;
    sg_arena *arena;
    sg_progress progress;
    fold *folds;
    size_t nfolds, ndone, nfaults;
} job;

/* ---- options ---- */

enum { OPT_FOLD = SG_OPT_OWN, OPT_PART, OPT_NAMES, OPT_CLASSES, OPT_MAP_CLASSES, OPT_ALIAS };

static const struct option LONG_OPTIONS[] = {{"fold", required_argument, NULL, OPT_FOLD},
                                             {"part", required_argument, NULL, OPT_PART},
                                             {"names", required_argument, NULL, OPT_NAMES},
                                             {"classes", required_argument, NULL, OPT_CLASSES},
                                             {"map-classes", required_argument, NULL, OPT_MAP_CLASSES},
                                             {"alias", required_argument, NULL, OPT_ALIAS},
                                             SG_COMMON_LONG_OPTIONS,
                                             {NULL, 0, NULL, 0}};

/* K, or K-L. */
static bool take_folds(options *o, const char *arg)
{
    char first[16];
    size_t low, high;
    const size_t n = strcspn(arg, "-");
    snprintf(first, sizeof first, "%.*s", (int)(n < 15 ? n : 15), arg);
    if (!sg_program_size("--fold", first, 1, 1000000, &low))
        return false;
    high = low;
    if (arg[n] == '-' && !sg_program_size("--fold", arg + n + 1, low, low + MAX_FOLDS - 1, &high))
        return false;
    for (size_t k = low; k <= high; k++) {
        for (size_t i = 0; i < o->nfolds; i++)
            if (o->folds[i] == (int)k)
                return sg_program_usage("--fold: fold %zu is asked for twice", k), false;
        if (o->nfolds == MAX_FOLDS)
            return sg_program_usage("--fold: more than %d folds", MAX_FOLDS), false;
        o->folds[o->nfolds++] = (int)k;
    }
    return true;
}

static bool take_alias(options *o, const char *arg)
{
    const char *equals = strchr(arg, '=');
    if (equals == NULL)
        return sg_program_usage("--alias: '%s' is not NAME=OTHER", arg), false;
    for (size_t i = 0; i < o->naliases; i++)
        if (strncmp(o->aliases[i], arg, (size_t)(equals - arg) + 1) == 0)
            return sg_program_usage("--alias: '%s' after '%s': two for one name", arg, o->aliases[i]), false;
    if (o->naliases == MAX_ALIASES)
        return sg_program_usage("--alias: more than %d", MAX_ALIASES), false;
    o->aliases[o->naliases++] = arg;
    return true;
}

static bool take_own(int opt, const char *arg, void *user)
{
    static const char *const parts[] = {"train", "valid", "test", "all", NULL};
    options *o = user;
    int part = 0;
    switch (opt) {
    case OPT_FOLD:
        return take_folds(o, arg);
    case OPT_PART:
        if (!sg_program_choice("--part", arg, parts, &part))
            return false;
        o->dataset.part = (sg_dataset_part)part;
        return o->part_given = true;
    case OPT_NAMES:
        o->dataset.names_file = arg;
        return true;
    case OPT_CLASSES:
        o->dataset.classes_file = arg;
        return true;
    case OPT_MAP_CLASSES:
        o->map_classes = arg;
        return true;
    case OPT_ALIAS:
        return take_alias(o, arg);
    default:
        sg_program_usage("unknown option");
        return false;
    }
}

/* Exit status to leave with, or -1 to go on. */
static int parse_args(int argc, char **argv, options *o)
{
    const int end = sg_program_options(argc, argv, "", LONG_OPTIONS, HELP, &o->common, take_own, o);
    if (end >= 0)
        return end;
    if (argc - optind != 2)
        return sg_program_usage("expected a data set and the folder of the label maps");
    if (o->nfolds > 0 && o->dataset.names_file != NULL)
        return sg_program_usage("--fold and --names cannot both be asked for");
    if (o->part_given && o->nfolds == 0)
        return sg_program_usage("--part belongs to --fold");
    o->folder = argv[optind];
    o->maps = argv[optind + 1];
    return -1;
}

/* ---- counting ---- */

static void tell_fault(void *user, const char *sentence)
{
    job *j = user;
    j->nfaults++;
    sg_program_complain("%s", sentence);
}

/* A failure of a file is a fault, told with the others; only lack of memory goes on. */
static sg_status note(job *j, sg_status st, const sg_error *inner, sg_error *err)
{
    if (st == SG_EINPUT)
        tell_fault(j, inner->msg);
    else if (st != SG_OK)
        return SG_FAIL(err, st, "%s", inner->msg);
    return SG_OK;
}

/* The folder of a fold's maps: each %d of the name is its number. */
static sg_status folder_of_fold(job *j, fold *f, sg_error *err)
{
    const char *text = "";
    for (const char *p = j->opts->maps; text != NULL && *p != '\0';) {
        const char *mark = f->number > 0 ? strstr(p, "%d") : NULL;
        if (mark == NULL) {
            text = sg_arena_printf(j->arena, "%s%s", text, p);
            break;
        }
        text = sg_arena_printf(j->arena, "%s%.*s%d", text, (int)(mark - p), p, f->number);
        p = mark + 2;
    }
    f->maps = text;
    return text != NULL ? SG_OK : SG_FAIL_NOMEM(err);
}

static sg_status open_fold(job *j, fold *f, sg_error *err)
{
    sg_dataset_opts opts = j->opts->dataset;
    sg_error inner = SG_ERROR_INIT;
    opts.fold = f->number;
    const size_t before = j->nfaults;
    const sg_status st = sg_dataset_open(j->opts->folder, &opts, j->arena, tell_fault, j, &f->dataset, &inner);
    f->open = st == SG_OK;
    return st == SG_EINPUT && j->nfaults > before ? SG_OK : note(j, st, &inner, err);
}

/* The class table of a fold's maps: as asked for, their own, the data set's; NULL in *path: that of the truth. */
static sg_status find_table(job *j, const fold *f, const char **path, sg_error *err)
{
    const char *const candidates[] = {sg_arena_printf(j->arena, "%s/classes.tsv", f->maps),
                                      sg_arena_printf(j->arena, "%s/classes.tsv", j->opts->folder)};
    *path = j->opts->map_classes;
    for (size_t i = 0; i < 2; i++) {
        if (candidates[i] == NULL)
            return SG_FAIL_NOMEM(err);
        if (*path == NULL && sg_file_exists(candidates[i]))
            *path = candidates[i];
    }
    return SG_OK;
}

/* What the pixel values of a fold's maps are. */
static sg_status map_values(job *j, const fold *f, uint8_t class_of[256], sg_error *err)
{
    const options *o = j->opts;
    const char *path;
    sg_classes found = {0};
    SG_TRY(find_table(j, f, &path, err));
    if (path != NULL)
        SG_TRY(sg_classes_read(path, &found, err));
    const sg_status st = sg_evaluation_classes(path != NULL ? &found : &f->dataset.classes, &f->dataset.classes, o->aliases,
                                               o->naliases, class_of, err);
    sg_classes_clear(&found);
    return st;
}

static sg_status count_map(job *j, fold *f, size_t item, const uint8_t class_of[256], sg_error *err)
{
    sg_label_map truth, found;
    const char *path = sg_arena_printf(j->arena, "%s/%s.png", f->maps, f->dataset.items[item].name);
    if (path == NULL)
        return SG_FAIL_NOMEM(err);
    SG_TRY(sg_png_read_labels(path, &found, err));
    sg_status st = sg_dataset_read_labels(&f->dataset, item, &truth, err);
    if (st == SG_OK) {
        st = sg_confusion_add(&f->confusion, &truth, &found, class_of, err);
        if (st == SG_EINVAL) {
            const sg_error why = *err;
            st = SG_FAIL(err, SG_EINPUT, "%s: %.900s", path, why.msg);
        }
        sg_label_map_clear(&truth);
    }
    sg_label_map_clear(&found);
    return st;
}

static sg_status count_fold(job *j, fold *f, sg_error *err)
{
    uint8_t class_of[256];
    sg_error inner = SG_ERROR_INIT;
    SG_TRY(sg_confusion_create(f->dataset.classes.nclasses, j->arena, &f->confusion, err));
    const sg_status st = map_values(j, f, class_of, &inner);
    if (st != SG_OK)
        return note(j, st, &inner, err);
    for (size_t i = 0; i < f->dataset.nitems && !sg_progress_stopped(&j->progress); i++) {
        sg_progress_report(&j->progress, "label maps", i, f->dataset.nitems);
        SG_TRY(note(j, count_map(j, f, i, class_of, &inner), &inner, err));
    }
    return sg_scores_of(&f->confusion, j->arena, &f->scores, err);
}

static sg_status count_all(job *j, sg_error *err)
{
    for (size_t k = 0; k < j->nfolds; k++) {
        fold *f = &j->folds[k];
        f->number = j->opts->nfolds > 0 ? j->opts->folds[k] : 0;
        SG_TRY(folder_of_fold(j, f, err));
        SG_TRY(open_fold(j, f, err));
        if (f->open)
            SG_TRY(count_fold(j, f, err));
        if (sg_progress_stopped(&j->progress))
            j->nfolds = k + 1;
    }
    if (j->nfaults > 0)
        return SG_FAIL(err, SG_EINPUT, "%zu fault%s; nothing is scored", j->nfaults, j->nfaults == 1 ? "" : "s");
    return sg_progress_stopped(&j->progress) ? SG_FAIL(err, SG_STOPPED, "stopped") : SG_OK;
}

/* ---- results ---- */

/* All folds as one, their mean, and the published convention. */
typedef struct {
    sg_confusion pooled;
    sg_scores scores, mean, published;
} summary;

static sg_status sum_up(job *j, summary *s, sg_error *err)
{
    const size_t n = j->nfolds;
    sg_scores *scores = SG_NEW_ARRAY(j->arena, sg_scores, n);
    sg_confusion *confusions = SG_NEW_ARRAY(j->arena, sg_confusion, n);
    if (scores == NULL || confusions == NULL)
        return SG_FAIL_NOMEM(err);
    SG_TRY(sg_confusion_create(j->folds[0].dataset.classes.nclasses, j->arena, &s->pooled, err));
    for (size_t k = 0; k < n; k++) {
        scores[k] = j->folds[k].scores;
        confusions[k] = j->folds[k].confusion;
        sg_confusion_merge(&confusions[k], &s->pooled);
    }
    SG_TRY(sg_scores_of(&s->pooled, j->arena, &s->scores, err));
    SG_TRY(sg_scores_mean(scores, n, j->arena, &s->mean, err));
    return sg_scores_published(confusions, n, j->arena, &s->published, err);
}

static void print_folds(const job *j, const summary *s, FILE *out)
{
    const sg_classes *classes = &j->folds[0].dataset.classes;
    fputs("\nrecall of each class, %; published: a fold's entries cut to whole per cent, then averaged\n", out);
    sg_scores_print_heading("fold", classes, out);
    for (size_t k = 0; k < j->nfolds; k++) {
        char name[16];
        snprintf(name, sizeof name, "%d", j->folds[k].number);
        sg_scores_print_line(name, j->folds[k].confusion.nmaps, classes, &j->folds[k].scores, out);
    }
    sg_scores_print_line("pooled", s->pooled.nmaps, classes, &s->scores, out);
    sg_scores_print_line("mean", s->pooled.nmaps, classes, &s->mean, out);
    sg_scores_print_line("published", s->pooled.nmaps, classes, &s->published, out);
}

/* A list of the folds' objects, or NULL. */
static json_t *folds_json(const job *j)
{
    json_t *list = json_array();
    for (size_t k = 0; list != NULL && k < j->nfolds; k++) {
        const fold *f = &j->folds[k];
        json_t *o = sg_scores_json(&f->confusion, &f->scores, &f->dataset.classes);
        if (o == NULL || json_object_set_new(o, "fold", json_integer(f->number)) != 0 || json_array_append(list, o) != 0) {
            json_decref(list);
            list = NULL;
        }
        json_decref(o);
    }
    return list;
}

static json_t *to_json(const job *j, const summary *s)
{
    const sg_classes *classes = &j->folds[0].dataset.classes;
    json_t *o = sg_scores_json(&s->pooled, &s->scores, classes);
    if (o == NULL || j->opts->nfolds < 2)
        return o;
    if (json_object_set_new(o, "folds", folds_json(j)) == 0 &&
        json_object_set_new(o, "fold_mean", sg_scores_json(NULL, &s->mean, classes)) == 0 &&
        json_object_set_new(o, "published", sg_scores_json(NULL, &s->published, classes)) == 0)
        return o;
    json_decref(o);
    return NULL;
}

static sg_status write_json(const job *j, const summary *s, sg_error *err)
{
    json_t *root = to_json(j, s);
    char *text = root != NULL ? json_dumps(root, JSON_INDENT(1) | JSON_REAL_PRECISION(12)) : NULL;
    json_decref(root);
    if (text == NULL)
        return SG_FAIL_NOMEM(err);
    sg_output out;
    const sg_status st = sg_output_open(&out, j->opts->common.json, err);
    if (st == SG_OK) {
        fputs(text, out.fp);
        fputc('\n', out.fp);
    }
    free(text);
    return st == SG_OK ? sg_output_commit(&out, err) : st;
}

/* No result replaces what was read. */
static sg_status spare_inputs(const job *j, sg_error *err)
{
    const options *o = j->opts;
    for (size_t k = 0; k < j->nfolds; k++) {
        const fold *f = &j->folds[k];
        const char *const tables[] = {o->dataset.classes_file, o->dataset.names_file, o->map_classes,
                                      sg_arena_printf(j->arena, "%s/classes.tsv", o->folder),
                                      sg_arena_printf(j->arena, "%s/classes.tsv", f->maps),
                                      sg_arena_printf(j->arena, "%s/folds/%d.tsv", o->folder, f->number)};
        SG_TRY(sg_program_spare(o->common.json, tables, sizeof tables / sizeof tables[0], err));
        for (size_t i = 0; i < f->dataset.nitems; i++) {
            const char *const maps[] = {f->dataset.items[i].labels,
                                        sg_arena_printf(j->arena, "%s/%s.png", f->maps, f->dataset.items[i].name)};
            SG_TRY(sg_program_spare(o->common.json, maps, 2, err));
        }
    }
    return SG_OK;
}

/* The table gives way to JSON on standard output. */
static sg_status report(job *j, sg_error *err)
{
    summary s;
    const char *json = j->opts->common.json;
    SG_TRY(spare_inputs(j, err));
    SG_TRY(sum_up(j, &s, err));
    sg_program_progress_end();
    if (json == NULL || strcmp(json, "-") != 0) {
        sg_confusion_print(&s.pooled, &s.scores, &j->folds[0].dataset.classes, stdout);
        if (j->opts->nfolds > 1)
            print_folds(j, &s, stdout);
    }
    return json != NULL ? write_json(j, &s, err) : SG_OK;
}

static sg_status run(job *j, sg_error *err)
{
    j->nfolds = j->opts->nfolds > 0 ? j->opts->nfolds : 1;
    j->folds = SG_NEW_ARRAY(j->arena, fold, j->nfolds);
    if (j->folds == NULL)
        return SG_FAIL_NOMEM(err);
    sg_status st = count_all(j, err);
    if (st == SG_OK || st == SG_STOPPED) {
        const sg_status told = report(j, err);
        st = told != SG_OK ? told : st;
    }
    for (size_t k = 0; k < j->nfolds; k++)
        if (j->folds[k].open)
            sg_dataset_close(&j->folds[k].dataset);
    return st;
}

int main(int argc, char **argv)
{
    options o = {.common = SG_COMMON_OPTS_INIT, .dataset = SG_DATASET_OPTS_INIT};
    o.dataset.part = SG_SPLIT_TEST;
    sg_program_begin("evaluate-labels");
    const int code = parse_args(argc, argv, &o);
    if (code >= 0)
        return code;
    sg_error err = SG_ERROR_INIT;
    job j = {.opts = &o, .progress = sg_program_progress(&o.common), .arena = sg_arena_create()};
    const sg_status st = j.arena != NULL ? run(&j, &err) : SG_FAIL_NOMEM(&err);
    sg_arena_free(j.arena);
    return sg_program_end(st, &err);
}
