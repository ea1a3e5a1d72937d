/* SPDX-License-Identifier: GPL-3.0-or-later */
/* make-lattice.c - label maps to lattices (*.lat), with what the lattices cannot show. */
#include "config.h"

#include "core/array.h"
#include "core/file.h"
#include "image/png_io.h"
#include "parse/dataset.h"
#include "parse/lattice_draw.h"
#include "parse/lattice_fit.h"
#include "parse/lattice_loss.h"
#include "program/program.h"

#include <jansson.h>
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static const char HELP[] =
    "Example: make-lattice data/facades -o lattices --cells 600\n"
    "\n"
    "Usage: make-lattice DATASET -o DIR [OPTION]...\n"
    "Make an irregular lattice DIR/NAME.lat of each label map of a data set, and print its size and the share of pixels\n"
    "that it shows right. Of the weights below one may be chosen; the default is description length.\n"
    "\n"
    "  -o, --output DIR   folder for the lattices\n"
    "  --cells N          the most accurate lattice with at most N cells, of each map\n"
    "  --accuracy A       the smallest lattice that shows a share A of the pixels right, of each map\n"
    "  --mean-cells N, --mean-accuracy A\n"
    "                     the same for the means over the set, with one price of a cell for all maps: the set's best\n"
    "  --lambda V         a line must save V wrong pixels\n"
    "  --mu V             a cell must save V wrong pixels for every 100000 pixels of its map\n"
    "  --starts N         descents a fit, 1 to 4 (default 4)\n"
    "  --classes FILE     class table in place of DATASET/classes.tsv\n"
    "  --fold K           the images of fold K; --part train|valid|test|all (default train)\n"
    "  --names FILE       the images named there, one a line\n"
    "  --max-images N     the first N of them\n"
    "  --pictures         also NAME.png, the lattice drawn, and NAME.errors.png, the wrong pixels in their true colours\n"
    "  --loss             also print what is lost: by class, by cause and by what is shown instead\n" SG_COMMON_HELP;

typedef enum { BY_LENGTH, BY_CELLS, BY_ACCURACY, BY_MEAN_CELLS, BY_MEAN_ACCURACY, BY_LAMBDA, BY_MU } rule;

static const char *const RULES[] = {"description length", "cells", "accuracy", "mean cells", "mean accuracy",
                                    "lambda", "mu"};

typedef struct {
    sg_common_opts common;
    sg_dataset_opts dataset;
    const char *folder, *output;
    rule rule;
    int nrules; /* asked for */
    double value;
    size_t starts;
    bool pictures, loss, part_given;
} options;

/* What is kept of a finished map. */
typedef struct {
    bool done;
    size_t width, height, counted_px, wrong_px;
    sg_lattice_weights weights;
    double milliseconds; /* processor time of evidence and fit */
    sg_lattice_loss loss;
} result;

typedef struct {
    const options *opts;
    sg_dataset dataset;
    sg_arena *arena;
    result *results;    /* [items] */
    double share;       /* common price of a cell */
    sg_progress progress;
    size_t ndone;
    sg_status status;   /* of the first map, in order, that failed */
    size_t failed_item;
    sg_error error;
} job;

enum {
    OPT_CELLS = SG_OPT_OWN, OPT_ACCURACY, OPT_MEAN_CELLS, OPT_MEAN_ACCURACY, OPT_LAMBDA, OPT_MU, OPT_STARTS,
    OPT_CLASSES, OPT_FOLD, OPT_PART, OPT_NAMES, OPT_MAX_IMAGES, OPT_PICTURES, OPT_LOSS
};

static const struct option LONG_OPTIONS[] = {
    {"output", required_argument, NULL, 'o'},
    {"cells", required_argument, NULL, OPT_CELLS},
    {"accuracy", required_argument, NULL, OPT_ACCURACY},
    {"mean-cells", required_argument, NULL, OPT_MEAN_CELLS},
    {"mean-accuracy", required_argument, NULL, OPT_MEAN_ACCURACY},
    {"lambda", required_argument, NULL, OPT_LAMBDA},
    {"mu", required_argument, NULL, OPT_MU},
    {"starts", required_argument, NULL, OPT_STARTS},
    {"classes", required_argument, NULL, OPT_CLASSES},
    {"fold", required_argument, NULL, OPT_FOLD},
    {"part", required_argument, NULL, OPT_PART},
    {"names", required_argument, NULL, OPT_NAMES},
    {"max-images", required_argument, NULL, OPT_MAX_IMAGES},
    {"pictures", no_argument, NULL, OPT_PICTURES},
    {"loss", no_argument, NULL, OPT_LOSS},
    SG_COMMON_LONG_OPTIONS,
    {NULL, 0, NULL, 0}};

static bool take_rule(int opt, const char *arg, options *o)
{
    size_t n = 0;
    o->nrules++;
    switch (opt) {
    case OPT_CELLS:
    case OPT_MEAN_CELLS:
        o->rule = opt == OPT_CELLS ? BY_CELLS : BY_MEAN_CELLS;
        if (!sg_program_size(opt == OPT_CELLS ? "--cells" : "--mean-cells", arg, 1, 1000000000, &n))
            return false;
        o->value = (double)n;
        return true;
    case OPT_ACCURACY:
    case OPT_MEAN_ACCURACY:
        o->rule = opt == OPT_ACCURACY ? BY_ACCURACY : BY_MEAN_ACCURACY;
        return sg_program_double(opt == OPT_ACCURACY ? "--accuracy" : "--mean-accuracy", arg, 0, 1, &o->value);
    case OPT_LAMBDA:
        o->rule = BY_LAMBDA;
        return sg_program_double("--lambda", arg, 0, 1e12, &o->value);
    default:
        o->rule = BY_MU;
        return sg_program_double("--mu", arg, 0, 1e12, &o->value);
    }
}

static bool take_own(int opt, const char *arg, void *user)
{
    options *o = user;
    static const char *const parts[] = {"train", "valid", "test", "all", NULL};
    size_t n = 0;
    int part = 0;
    switch (opt) {
    case 'o':
        o->output = arg;
        return true;
    case OPT_STARTS:
        return sg_program_size("--starts", arg, 1, 4, &o->starts);
    case OPT_CLASSES:
        o->dataset.classes_file = arg;
        return true;
    case OPT_FOLD:
        if (!sg_program_size("--fold", arg, 1, 1000000, &n))
            return false;
        o->dataset.fold = (int)n;
        return true;
    case OPT_PART:
        if (!sg_program_choice("--part", arg, parts, &part))
            return false;
        o->dataset.part = (sg_dataset_part)part;
        return o->part_given = true;
    case OPT_NAMES:
        o->dataset.names_file = arg;
        return true;
    case OPT_MAX_IMAGES:
        return sg_program_size("--max-images", arg, 1, 1000000000, &o->dataset.max_images);
    case OPT_PICTURES:
        return o->pictures = true;
    case OPT_LOSS:
        return o->loss = true;
    default:
        return take_rule(opt, arg, o);
    }
}

/* Exit status to leave with, or -1 to go on. */
static int parse_args(int argc, char **argv, options *o)
{
    const int end = sg_program_options(argc, argv, "o:", LONG_OPTIONS, HELP, &o->common, take_own, o);
    if (end >= 0)
        return end;
    if (argc - optind != 1)
        return sg_program_usage("expected one data set folder, found %d", argc - optind);
    if (o->output == NULL)
        return sg_program_usage("expected a folder for the lattices: -o DIR");
    if (o->nrules > 1)
        return sg_program_usage("of --cells, --accuracy, --mean-cells, --mean-accuracy, --lambda and --mu take one");
    if (o->part_given && o->dataset.fold == 0)
        return sg_program_usage("--part belongs to --fold");
    if (o->dataset.fold != 0 && o->dataset.names_file != NULL)
        return sg_program_usage("--fold and --names do not go together");
    o->folder = argv[optind];
    return -1;
}

static double thread_ms(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

static sg_status fit_by_rule(const job *j, sg_lattice_problem *p, sg_arena *arena, sg_lattice_fit *f, sg_error *err)
{
    const double v = j->opts->value;
    switch (j->opts->rule) {
    case BY_CELLS:
        return sg_lattice_fit_cells(p, (size_t)v, arena, f, err);
    case BY_ACCURACY:
        return sg_lattice_fit_accuracy(p, v, arena, f, err);
    case BY_MEAN_CELLS:
    case BY_MEAN_ACCURACY:
        return sg_lattice_fit_share(p, j->share, arena, f, err);
    case BY_LAMBDA:
        return sg_lattice_fit_weights(p, &(sg_lattice_weights){v, v, 0}, arena, f, err);
    case BY_MU:
        return sg_lattice_fit_share(p, v * 1e-5, arena, f, err);
    case BY_LENGTH:
        break;
    }
    return sg_lattice_fit_length(p, arena, f, err);
}

static sg_status write_picture(const job *j, size_t item, const char *suffix, const sg_image *im, sg_arena *arena,
                               sg_error *err)
{
    const char *path = sg_arena_printf(arena, "%s/%s%s", j->opts->output, j->dataset.items[item].name, suffix);
    return path != NULL ? sg_png_write_rgb(path, im, err) : SG_FAIL_NOMEM(err);
}

static sg_status draw(const job *j, size_t item, const sg_lattice *l, const sg_label_map *map, sg_arena *arena,
                      sg_error *err)
{
    enum { SCALE = 2 };
    uint8_t identity[SG_MAX_CLASSES];
    for (size_t i = 0; i < SG_MAX_CLASSES; i++)
        identity[i] = (uint8_t)i;
    sg_image im = {0};
    sg_status st = sg_lattice_draw(l, j->dataset.classes.colors, SCALE, &im, err);
    if (st == SG_OK)
        st = write_picture(j, item, ".png", &im, arena, err);
    sg_image_clear(&im);
    if (st == SG_OK)
        st = sg_lattice_draw_errors(l, identity, map, j->dataset.classes.colors, SCALE, &im, err);
    if (st == SG_OK)
        st = write_picture(j, item, ".errors.png", &im, arena, err);
    sg_image_clear(&im);
    return st;
}

static sg_status write_files(const job *j, size_t item, const sg_lattice_fit *f, const sg_label_map *map,
                             sg_arena *arena, sg_error *err)
{
    sg_lattice l;
    SG_TRY(sg_lattice_from_fit(f, (const char *const *)j->dataset.classes.names, j->dataset.classes.nclasses, arena, &l,
                               err));
    const char *path = sg_arena_printf(arena, "%s/%s.lat", j->opts->output, j->dataset.items[item].name);
    if (path == NULL)
        return SG_FAIL_NOMEM(err);
    SG_TRY(sg_lattice_save(&l, path, err));
    return j->opts->pictures ? draw(j, item, &l, map, arena, err) : SG_OK;
}

static sg_status fit_map(const job *j, const sg_lattice_source *source, sg_arena *arena, result *r, sg_lattice_fit *f,
                         sg_error *err)
{
    sg_lattice_fit_opts opts = SG_LATTICE_FIT_OPTS_INIT;
    opts.starts = j->opts->starts;
    sg_lattice_problem *p;
    const double begin = thread_ms();
    SG_TRY(sg_lattice_problem_create(source, &opts, &p, err));
    const sg_status st = fit_by_rule(j, p, arena, f, err);
    r->milliseconds = thread_ms() - begin;
    sg_lattice_problem_free(p);
    SG_TRY(st);
    r->width = f->width;
    r->height = f->height;
    r->counted_px = f->counted_px;
    r->wrong_px = f->wrong_px;
    r->weights = f->weights;
    return sg_lattice_loss_add(source, f, arena, &r->loss, err);
}

static sg_status make_one(const job *j, size_t item, sg_error *err)
{
    sg_arena *arena = sg_arena_create();
    sg_label_map map = {0};
    result *r = &j->results[item];
    sg_status st = arena != NULL ? sg_dataset_read_labels(&j->dataset, item, &map, err) : SG_FAIL_NOMEM(err);
    if (st == SG_OK) {
        const sg_lattice_source source = sg_lattice_source_of(&map, j->dataset.classes.nclasses);
        sg_lattice_fit f;
        st = fit_map(j, &source, arena, r, &f, err);
        if (st == SG_EINPUT) {
            const sg_error why = *err;
            st = SG_FAIL(err, st, "%s: %.900s", j->dataset.items[item].labels, why.msg);
        }
        if (st == SG_OK)
            st = write_files(j, item, &f, &map, arena, err);
    }
    r->done = st == SG_OK;
    sg_label_map_clear(&map);
    sg_arena_free(arena);
    return st;
}

/* The failure that is told is that of the first map in order, whichever thread met one first. */
static void note_outcome(job *j, size_t item, sg_status st, const sg_error *err)
{
    j->ndone++;
    if (st != SG_OK && (j->status == SG_OK || item < j->failed_item)) {
        j->status = st;
        j->failed_item = item;
        j->error = *err;
    }
}

static sg_status make_all(job *j, sg_error *err)
{
    const size_t n = j->dataset.nitems;
    bool stopped = false;
#pragma omp parallel for schedule(dynamic)
    for (size_t i = 0; i < n; i++) {
        bool skip;
#pragma omp critical(make_lattice)
        {
            stopped = stopped || sg_progress_stopped(&j->progress);
            skip = stopped || j->status != SG_OK;
        }
        if (skip)
            continue;
        sg_error e = SG_ERROR_INIT;
        const sg_status st = make_one(j, i, &e);
#pragma omp critical(make_lattice)
        {
            note_outcome(j, i, st, &e);
            sg_progress_report(&j->progress, "lattices", j->ndone, n);
        }
    }
    *err = j->error;
    return j->status != SG_OK ? j->status : stopped ? SG_STOPPED : SG_OK;
}

static sg_status prepare(const job *j, size_t item, sg_label_map *map, sg_lattice_problem **problem, sg_error *err)
{
    SG_TRY(sg_dataset_read_labels(&j->dataset, item, map, err));
    const sg_lattice_source source = sg_lattice_source_of(map, j->dataset.classes.nclasses);
    const sg_lattice_fit_opts opts = SG_LATTICE_FIT_OPTS_INIT;
    const sg_status st = sg_lattice_problem_create(&source, &opts, problem, err);
    if (st == SG_EINPUT) {
        const sg_error why = *err;
        return SG_FAIL(err, st, "%s: %.900s", j->dataset.items[item].labels, why.msg);
    }
    return st;
}

/* --mean-cells and --mean-accuracy look at all maps before the first lattice is made. */
static sg_status find_share(job *j, sg_error *err)
{
    const size_t n = j->dataset.nitems;
    sg_lattice_problem **problems = SG_NEW_ARRAY(j->arena, sg_lattice_problem *, n);
    sg_label_map *maps = SG_NEW_ARRAY(j->arena, sg_label_map, n);
    sg_status st = problems != NULL && maps != NULL ? SG_OK : SG_FAIL_NOMEM(err);
    size_t ready = 0;
    for (; st == SG_OK && ready < n; ready++) {
        sg_progress_report(&j->progress, "evidence", ready, n);
        st = sg_progress_stopped(&j->progress) ? SG_FAIL(err, SG_STOPPED, "stopped")
                                               : prepare(j, ready, &maps[ready], &problems[ready], err);
    }
    if (st == SG_OK)
        st = sg_lattice_common_price(problems, n, j->opts->rule == BY_MEAN_CELLS ? j->opts->value : 0, j->opts->value,
                                     omp_get_max_threads(), &j->progress, &j->share, err);
    for (size_t i = 0; i < ready; i++) {
        sg_lattice_problem_free(problems[i]);
        sg_label_map_clear(&maps[i]);
    }
    return st;
}

typedef struct {
    size_t n, counted_px, wrong_px;
    double cells, width, height, accuracy, milliseconds; /* means */
    sg_lattice_loss loss;
} summary;

static double accuracy_of(const result *r)
{
    return 1 - (double)r->wrong_px / (double)r->counted_px;
}

static sg_status sum_up(const job *j, summary *s, sg_error *err)
{
    *s = (summary){0};
    SG_TRY(sg_lattice_loss_create(j->dataset.classes.nclasses, j->arena, &s->loss, err));
    for (size_t i = 0; i < j->dataset.nitems; i++) {
        const result *r = &j->results[i];
        if (!r->done)
            continue;
        s->n++;
        s->counted_px += r->counted_px;
        s->wrong_px += r->wrong_px;
        s->cells += (double)(r->width * r->height);
        s->width += (double)r->width;
        s->height += (double)r->height;
        s->accuracy += accuracy_of(r);
        s->milliseconds += r->milliseconds;
        sg_lattice_loss_merge(&r->loss, &s->loss);
    }
    const double n = s->n > 0 ? (double)s->n : 1;
    s->cells /= n;
    s->width /= n;
    s->height /= n;
    s->accuracy /= n;
    s->milliseconds /= n;
    return SG_OK;
}

/* The two confusions that cost most, in per cent of the map's pixels. */
static void print_worst(const result *r, const sg_classes *classes, FILE *out)
{
    const size_t n = r->loss.nclasses;
    size_t last = SIZE_MAX;
    for (int k = 0; k < 2; k++) {
        size_t worst = SIZE_MAX;
        for (size_t i = 0; i < n * n; i++)
            if (i / n != i % n && i != last && r->loss.confusion[i] > 0 &&
                (worst == SIZE_MAX || r->loss.confusion[i] > r->loss.confusion[worst]))
                worst = i;
        if (worst == SIZE_MAX)
            break;
        fprintf(out, "  %s as %s %.2f", classes->names[worst / n], classes->names[worst % n],
                100 * (double)r->loss.confusion[worst] / (double)r->counted_px);
        last = worst;
    }
}

static void print_table(const job *j, const summary *s, FILE *out)
{
    int width = 4;
    for (size_t i = 0; i < j->dataset.nitems; i++)
        width = (int)strlen(j->dataset.items[i].name) > width ? (int)strlen(j->dataset.items[i].name) : width;
    fprintf(out, "%-*s %5s %5s %7s %9s  %s\n", width, "name", "W", "H", "cells", "accuracy", "most lost, % of all pixels");
    for (size_t i = 0; i < j->dataset.nitems; i++) {
        const result *r = &j->results[i];
        if (!r->done)
            continue;
        fprintf(out, "%-*s %5zu %5zu %7zu %8.3f%%", width, j->dataset.items[i].name, r->width, r->height,
                r->width * r->height, 100 * accuracy_of(r));
        print_worst(r, &j->dataset.classes, out);
        fputc('\n', out);
    }
    if (s->n > 0)
        fprintf(out, "%-*s %5.1f %5.1f %7.1f %8.3f%%  over %zu maps; %.3f%% of their %zu pixels\n", width, "mean", s->width,
                s->height, s->cells, 100 * s->accuracy, s->n,
                100 * (1 - (double)s->wrong_px / (double)s->counted_px), s->counted_px);
}

static double percent(size_t part, size_t whole)
{
    return whole > 0 ? 100 * (double)part / (double)whole : 0;
}

static void print_loss(const summary *s, const sg_classes *classes, FILE *out)
{
    const sg_lattice_loss *l = &s->loss;
    fprintf(out, "\nlost, %% of the class's pixels: at most %d px from a cell of the class (misaligned), further away "
                 "(irregular),\nregions shown nowhere, at most %d px wide or high (thin) or larger (region); near: at most "
                 "%d px from any line\n",
            SG_LATTICE_NEAR_PX, SG_LATTICE_THIN_PX, SG_LATTICE_NEAR_PX);
    fprintf(out, "%-12s %10s %7s", "class", "pixels", "lost");
    for (int c = 0; c < SG_LOSS_CAUSES; c++)
        fprintf(out, " %10s", sg_loss_cause_name((sg_loss_cause)c));
    fprintf(out, " %7s  shown as\n", "near");
    for (size_t k = 0; k < l->nclasses; k++) {
        const size_t pixels = sg_lattice_loss_pixels(l, k);
        fprintf(out, "%-12s %10zu %6.2f%%", classes->names[k], pixels, percent(sg_lattice_loss_wrong(l, k), pixels));
        for (int c = 0; c < SG_LOSS_CAUSES; c++)
            fprintf(out, " %9.2f%%", percent(l->causes[k * SG_LOSS_CAUSES + (size_t)c], pixels));
        fprintf(out, " %6.2f%% ", percent(l->near_line[k], pixels));
        for (size_t c = 0; c < l->nclasses; c++)
            if (c != k && percent(l->confusion[k * l->nclasses + c], pixels) >= 0.1)
                fprintf(out, " %s %.2f", classes->names[c], percent(l->confusion[k * l->nclasses + c], pixels));
        fputc('\n', out);
    }
    size_t causes[SG_LOSS_CAUSES] = {0};
    for (size_t i = 0; i < l->nclasses * SG_LOSS_CAUSES; i++)
        causes[i % SG_LOSS_CAUSES] += l->causes[i];
    fprintf(out, "of all %zu lost pixels:", s->wrong_px);
    for (int c = 0; c < SG_LOSS_CAUSES; c++)
        fprintf(out, " %s %.1f%%", sg_loss_cause_name((sg_loss_cause)c), percent(causes[c], s->wrong_px));
    fputc('\n', out);
}

static json_t *loss_to_json(const sg_lattice_loss *l, const sg_classes *classes)
{
    json_t *out = json_object(), *per_class = json_object(), *confusion = json_array();
    for (size_t k = 0; k < l->nclasses; k++) {
        json_t *c = json_pack("{s:I, s:I, s:I}", "pixels", (json_int_t)sg_lattice_loss_pixels(l, k), "lost",
                              (json_int_t)sg_lattice_loss_wrong(l, k), "near_line", (json_int_t)l->near_line[k]);
        for (int i = 0; i < SG_LOSS_CAUSES; i++)
            json_object_set_new(c, sg_loss_cause_name((sg_loss_cause)i),
                                json_integer((json_int_t)l->causes[k * SG_LOSS_CAUSES + (size_t)i]));
        json_object_set_new(per_class, classes->names[k], c);
        json_t *row = json_array();
        for (size_t i = 0; i < l->nclasses; i++)
            json_array_append_new(row, json_integer((json_int_t)l->confusion[k * l->nclasses + i]));
        json_array_append_new(confusion, row);
    }
    json_object_set_new(out, "per_class", per_class);
    json_object_set_new(out, "confusion", confusion);
    return out;
}

static json_t *map_to_json(const job *j, size_t item)
{
    const result *r = &j->results[item];
    json_t *m = json_pack("{s:s, s:I, s:I, s:I, s:I, s:I, s:f, s:f, s:f, s:f, s:f}", "name", j->dataset.items[item].name,
                          "width", (json_int_t)r->width, "height", (json_int_t)r->height, "cells",
                          (json_int_t)(r->width * r->height), "pixels", (json_int_t)r->counted_px, "wrong",
                          (json_int_t)r->wrong_px, "accuracy", accuracy_of(r), "per_column", r->weights.per_column,
                          "per_row", r->weights.per_row, "per_cell", r->weights.per_cell, "milliseconds",
                          r->milliseconds);
    json_object_set_new(m, "loss", loss_to_json(&r->loss, &j->dataset.classes));
    return m;
}

static json_t *to_json(const job *j, const summary *s)
{
    json_t *maps = json_array();
    for (size_t i = 0; i < j->dataset.nitems; i++)
        if (j->results[i].done)
            json_array_append_new(maps, map_to_json(j, i));
    json_t *out = json_pack("{s:s, s:I, s:f, s:f, s:f, s:f}", "weights_from", RULES[j->opts->rule], "maps_made",
                            (json_int_t)s->n, "mean_cells", s->cells, "mean_accuracy", s->accuracy, "pooled_accuracy",
                            s->counted_px > 0 ? 1 - (double)s->wrong_px / (double)s->counted_px : 0.0,
                            "mean_milliseconds", s->milliseconds);
    json_object_set_new(out, "loss", loss_to_json(&s->loss, &j->dataset.classes));
    json_object_set_new(out, "maps", maps);
    return out;
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

/* The table gives way to JSON on standard output. */
static sg_status report(job *j, sg_error *err)
{
    summary s;
    SG_TRY(sum_up(j, &s, err));
    sg_program_progress_end();
    const char *json = j->opts->common.json;
    if (json == NULL || strcmp(json, "-") != 0) {
        print_table(j, &s, stdout);
        if (j->opts->loss && s.n > 0)
            print_loss(&s, &j->dataset.classes, stdout);
    }
    return json != NULL ? write_json(j, &s, err) : SG_OK;
}

static void tell_fault(void *user, const char *sentence)
{
    (void)user;
    sg_program_complain("%s", sentence);
}

/* A picture NAME.png must not replace the label map or the photograph that it is of, nor the result anything read. */
static sg_status spare_inputs(const job *j, sg_error *err)
{
    const options *o = j->opts;
    const char *const tables[] = {o->dataset.classes_file, o->dataset.names_file,
                                  sg_arena_printf(j->arena, "%s/classes.tsv", o->folder),
                                  sg_arena_printf(j->arena, "%s/folds/%d.tsv", o->folder, o->dataset.fold)};
    SG_TRY(sg_program_spare(o->common.json, tables, sizeof tables / sizeof tables[0], err));
    for (size_t i = 0; i < j->dataset.nitems; i++) {
        const sg_dataset_item *item = &j->dataset.items[i];
        const char *const read[] = {item->labels, item->image};
        const char *picture = sg_arena_printf(j->arena, "%s/%s.png", o->output, item->name);
        const char *lattice = sg_arena_printf(j->arena, "%s/%s.lat", o->output, item->name);
        if (picture == NULL || lattice == NULL)
            return SG_FAIL_NOMEM(err);
        const char *const written[] = {lattice, o->pictures ? picture : NULL};
        SG_TRY(sg_program_apart(o->common.json, written, 2, err));
        SG_TRY(sg_program_spare(o->common.json, read, 2, err));
        if (o->pictures)
            SG_TRY(sg_program_spare(picture, read, 2, err));
    }
    return SG_OK;
}

static sg_status run_job(job *j, sg_error *err)
{
    SG_TRY(spare_inputs(j, err));
    const size_t n = j->dataset.nitems;
    j->results = SG_NEW_ARRAY(j->arena, result, n);
    if (j->results == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t i = 0; i < n; i++)
        SG_TRY(sg_lattice_loss_create(j->dataset.classes.nclasses, j->arena, &j->results[i].loss, err));
    SG_TRY(sg_folder_create(j->opts->output, err));
    if (j->opts->rule == BY_MEAN_CELLS || j->opts->rule == BY_MEAN_ACCURACY)
        SG_TRY(find_share(j, err));
    const sg_status st = make_all(j, err);
    if (st != SG_OK && st != SG_STOPPED)
        return st;
    SG_TRY(report(j, err));
    return st;
}

int main(int argc, char **argv)
{
    options o = {.common = SG_COMMON_OPTS_INIT, .dataset = SG_DATASET_OPTS_INIT, .starts = 4};
    o.dataset.part = SG_SPLIT_TRAIN;
    sg_program_begin("make-lattice");
    const int code = parse_args(argc, argv, &o);
    if (code >= 0)
        return code;
    if (o.common.threads > 0)
        omp_set_num_threads(o.common.threads);
    sg_error err = SG_ERROR_INIT;
    job j = {.opts = &o, .progress = sg_program_progress(&o.common), .arena = sg_arena_create()};
    sg_status st = j.arena != NULL ? sg_dataset_open(o.folder, &o.dataset, j.arena, tell_fault, NULL, &j.dataset, &err)
                                   : SG_FAIL_NOMEM(&err);
    if (st == SG_OK) {
        st = run_job(&j, &err);
        sg_dataset_close(&j.dataset);
    }
    sg_arena_free(j.arena);
    return sg_program_end(st, &err);
}
