/* SPDX-License-Identifier: GPL-3.0-or-later */
/* apply-unaries.c - photographs to class probabilities of their pixels. */
#include "config.h"

#include "core/file.h"
#include "core/utf8.h"
#include "grammar/json_text.h"
#include "image/cv_image.h"
#include "image/png_io.h"
#include "parse/pixel_classifier.h"
#include "parse/unaries.h"
#include "program/program.h"

#include <jansson.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <time.h>

static const char HELP[] =
    "Example: apply-unaries facades.rf photographs/*.jpg -o unaries\n"
    "\n"
    "Usage: apply-unaries CLASSIFIER IMAGE... -o DIR [OPTION]...\n"
    "Give every pixel of photographs (JPEG, PNG) its class probabilities, by a classifier that learn-unaries made:\n"
    "DIR/NAME.npy holds them (32-bit floats, shape (classes, height, width)), DIR/NAME.png the most probable class of each\n"
    "pixel, DIR/classes.tsv names and colours of the classes. A photograph that cannot be read is named; the others are\n"
    "done all the same, and the exit status is 3.\n"
    "\n"
    "  -o, --output DIR   folder for the results\n" SG_COMMON_HELP;

typedef struct {
    sg_common_opts common;
    const char *classifier, *output;
    char **images;
    size_t nimages;
} options;

typedef struct {
    const char *name; /* of the outputs */
    bool done;
    size_t width, height;
    double seconds;
    sg_status status;
    sg_error error;
} result;

typedef struct {
    const options *opts;
    sg_arena *arena;
    sg_pixel_classifier *classifier;
    result *results; /* [nimages] */
    int workers, threads; /* photographs at a time, and threads for each */
    sg_progress progress;
    size_t ndone;
    bool stopped, broken; /* by a signal; because results cannot be written */
} job;

static const struct option LONG_OPTIONS[] = {
    {"output", required_argument, NULL, 'o'}, SG_COMMON_LONG_OPTIONS, {NULL, 0, NULL, 0}};

static bool take_own(int opt, const char *arg, void *user)
{
    options *o = user;
    (void)opt; /* there is one only */
    o->output = arg;
    return true;
}

/* Exit status to leave with, or -1 to go on. */
static int parse_args(int argc, char **argv, options *o)
{
    const int end = sg_program_options(argc, argv, "o:", LONG_OPTIONS, HELP, &o->common, take_own, o);
    if (end >= 0)
        return end;
    if (argc - optind < 2)
        return sg_program_usage("expected a classifier and at least one photograph");
    if (o->output == NULL)
        return sg_program_usage("expected a folder for the results: -o DIR");
    for (int i = optind; o->common.json != NULL && i < argc; i++)
        if (!sg_utf8_is(argv[i], strlen(argv[i])))
            return sg_program_usage("--json: the name '%s' is no UTF-8", argv[i]);
    o->classifier = argv[optind];
    o->images = argv + optind + 1;
    o->nimages = (size_t)(argc - optind - 1);
    return -1;
}

static double now_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ---- names ---- */

static int compare_names(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* Two photographs of one name would overwrite each other's results. */
static sg_status check_names(const job *j, sg_error *err)
{
    const size_t n = j->opts->nimages;
    const char **names = SG_NEW_ARRAY(j->arena, const char *, n);
    if (names == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t i = 0; i < n; i++) {
        names[i] = j->results[i].name;
        if (names[i][0] == '\0')
            return SG_FAIL(err, SG_EINVAL, "%s: no name of a photograph", j->opts->images[i]);
        if (sg_text_has_control(names[i]))
            return SG_FAIL(err, SG_EINVAL, "'%s': a name with a control character", names[i]);
    }
    qsort(names, n, sizeof *names, compare_names);
    for (size_t i = 1; i < n; i++)
        if (strcmp(names[i - 1], names[i]) == 0)
            return SG_FAIL(err, SG_EINVAL, "two photographs are named '%s': their results would be one file", names[i]);
    return SG_OK;
}

static const char *output_path(const job *j, const char *name, const char *ending, sg_arena *arena)
{
    return sg_arena_printf(arena, "%s/%s%s", j->opts->output, name, ending);
}

/* No output may be a file that is read, or the machine-readable result. */
static sg_status spare(const job *j, const char *output, sg_error *err)
{
    const char *const classifier[] = {j->opts->classifier};
    if (output == NULL)
        return SG_FAIL_NOMEM(err);
    SG_TRY(sg_program_spare(output, classifier, 1, err));
    if (output != j->opts->common.json)
        SG_TRY(sg_program_apart(j->opts->common.json, &output, 1, err));
    return sg_program_spare(output, (const char *const *)j->opts->images, j->opts->nimages, err);
}

static sg_status check_outputs(const job *j, sg_error *err)
{
    SG_TRY(check_names(j, err));
    if (j->opts->common.json != NULL)
        SG_TRY(spare(j, j->opts->common.json, err));
    SG_TRY(spare(j, output_path(j, "classes", ".tsv", j->arena), err));
    for (size_t i = 0; i < j->opts->nimages; i++) {
        SG_TRY(spare(j, output_path(j, j->results[i].name, ".npy", j->arena), err));
        SG_TRY(spare(j, output_path(j, j->results[i].name, ".png", j->arena), err));
    }
    return SG_OK;
}

/* ---- one photograph ---- */

/* Classes become pixel indices of the class table. */
static sg_status write_map(const job *j, const sg_float_map *p, const char *path, sg_error *err)
{
    const sg_classes *classes = sg_pixel_classifier_classes(j->classifier);
    sg_label_map map;
    SG_TRY(sg_unaries_map(p, &map, err));
    for (size_t i = 0; i < map.width * map.height; i++)
        map.labels[i] = classes->first_index[map.labels[i]];
    const sg_status st = sg_png_write_labels(path, &map, classes->index_colors, 256, err);
    sg_label_map_clear(&map);
    return st;
}

static sg_status write_result(const job *j, const char *name, const sg_float_map *p, sg_error *err)
{
    sg_arena *arena = sg_arena_create();
    const char *npy = arena != NULL ? output_path(j, name, ".npy", arena) : NULL;
    const char *png = arena != NULL ? output_path(j, name, ".png", arena) : NULL;
    sg_status st = npy != NULL && png != NULL ? sg_npy_write(npy, p, err) : SG_FAIL_NOMEM(err);
    if (st == SG_OK)
        st = write_map(j, p, png, err);
    sg_arena_free(arena);
    return st;
}

static sg_status apply_one(const job *j, size_t i, sg_error *err)
{
    result *r = &j->results[i];
    if (!sg_file_name_fits(j->opts->output, r->name, ".npy"))
        return SG_FAIL(err, SG_EINPUT, "%.700s: the name is too long for its results", j->opts->images[i]);
    sg_image photo;
    sg_float_map p = {0};
    sg_error inner = SG_ERROR_INIT;
    const double begin = now_s();
    SG_TRY(sg_photo_read(j->opts->images[i], &photo, err));
    sg_status st = sg_pixel_classifier_apply(j->classifier, &photo, j->threads, &p, &inner);
    if (st != SG_OK)
        SG_FAIL(err, st, "%s: %.900s", j->opts->images[i], inner.msg);
    else
        st = write_result(j, r->name, &p, err);
    r->width = photo.width;
    r->height = photo.height;
    r->seconds = now_s() - begin;
    r->done = st == SG_OK;
    sg_float_map_clear(&p);
    sg_image_clear(&photo);
    return st;
}

static void apply_all(job *j)
{
    const size_t n = j->opts->nimages;
#pragma omp parallel for schedule(dynamic) num_threads(j->workers)
    for (size_t i = 0; i < n; i++) {
        bool skip;
#pragma omp critical(apply_unaries)
        {
            j->stopped = j->stopped || sg_progress_stopped(&j->progress);
            skip = j->stopped || j->broken;
        }
        if (skip)
            continue;
        const sg_status st = apply_one(j, i, &j->results[i].error);
#pragma omp critical(apply_unaries)
        {
            j->results[i].status = st;
            j->broken = j->broken || st == SG_EIO;
            sg_progress_report(&j->progress, "photographs", ++j->ndone, n);
        }
    }
}

/* What memory did not suffice for beside the others may find enough alone. */
static void apply_again(job *j)
{
    for (size_t i = 0; i < j->opts->nimages && !j->broken && !sg_progress_stopped(&j->progress); i++) {
        result *r = &j->results[i];
        if (r->status != SG_ENOMEM)
            continue;
        r->status = apply_one(j, i, &r->error);
        j->broken = r->status == SG_EIO;
        if (r->status == SG_ENOMEM)
            SG_FAIL(&r->error, SG_ENOMEM, "%.900s: there is not enough memory for it", j->opts->images[i]);
    }
}

/* ---- all of them ---- */

/* Photographs that could not be used are named; results that could not be written are returned as they are. */
static sg_status conclude(const job *j, sg_error *err)
{
    size_t nbad = 0;
    sg_status worst = SG_EINPUT;
    const result *unwritten = NULL;
    for (size_t i = 0; i < j->opts->nimages; i++) {
        const result *r = &j->results[i];
        if (r->status == SG_EIO)
            unwritten = unwritten != NULL ? unwritten : r;
        else if (r->status != SG_OK && ++nbad > 0)
            sg_program_complain("%s", r->error.msg);
        worst = r->status == SG_ENOMEM ? SG_ENOMEM : worst;
    }
    if (unwritten != NULL) {
        *err = unwritten->error;
        return SG_EIO;
    }
    if (j->stopped && worst != SG_ENOMEM)
        return SG_FAIL(err, SG_STOPPED, "stopped");
    if (nbad > 0)
        return SG_FAIL(err, worst, "%zu of %zu photographs could not be used", nbad, j->opts->nimages);
    return SG_OK;
}

static json_t *to_json(const job *j)
{
    const sg_calibration c = sg_pixel_classifier_calibration(j->classifier);
    json_t *images = json_array();
    for (size_t i = 0; i < j->opts->nimages; i++) {
        const result *r = &j->results[i];
        if (r->done)
            json_array_append_new(images, json_pack("{s:s, s:s, s:I, s:I, s:f}", "image", j->opts->images[i], "name",
                                                    r->name, "width", (json_int_t)r->width, "height",
                                                    (json_int_t)r->height, "seconds", r->seconds));
    }
    return json_pack("{s:{s:b, s:f, s:f}, s:o}", "calibration", "fitted", c.fitted, "temperature", c.temperature,
                     "prior_exponent", c.exponent, "images", images);
}

static sg_status write_json(const job *j, sg_error *err)
{
    json_t *root = to_json(j);
    sg_output out;
    sg_status st = root != NULL ? sg_output_open(&out, j->opts->common.json, err) : SG_FAIL_NOMEM(err);
    if (st == SG_OK)
        st = sg_output_end(&out, sg_json_write(root, 3, out.fp, err), err);
    json_decref(root);
    return st;
}

static bool has_result(const job *j)
{
    for (size_t i = 0; i < j->opts->nimages; i++)
        if (j->results[i].done)
            return true;
    return false;
}

static sg_status apply_and_report(job *j, sg_error *err)
{
    SG_TRY(sg_folder_create(j->opts->output, err));
    const char *table = output_path(j, "classes", ".tsv", j->arena);
    SG_TRY(table != NULL ? sg_classes_write(table, sg_pixel_classifier_classes(j->classifier), err)
                         : SG_FAIL_NOMEM(err));
    apply_all(j);
    apply_again(j);
    sg_program_progress_end();
    const sg_status st = conclude(j, err);
    if (j->opts->common.json != NULL && st != SG_EIO) {
        sg_error inner = SG_ERROR_INIT;
        const sg_status written = write_json(j, &inner);
        if (written != SG_OK) {
            *err = inner;
            return written;
        }
    }
    return st;
}

static sg_status run(job *j, sg_error *err)
{
    const options *o = j->opts;
    const int all = o->common.threads > 0 ? o->common.threads : omp_get_max_threads();
    j->workers = o->nimages < (size_t)all ? (int)o->nimages : all;
    j->threads = all / j->workers;
    omp_set_max_active_levels(2);
    j->results = SG_NEW_ARRAY(j->arena, result, o->nimages);
    if (j->results == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t i = 0; i < o->nimages; i++)
        if ((j->results[i].name = sg_file_stem(o->images[i], j->arena)) == NULL)
            return SG_FAIL_NOMEM(err);
    SG_TRY(check_outputs(j, err));
    SG_TRY(sg_pixel_classifier_read(o->classifier, &j->classifier, err));
    const sg_status st = apply_and_report(j, err);
    sg_pixel_classifier_free(j->classifier);
    return st;
}

int main(int argc, char **argv)
{
    options o = {.common = SG_COMMON_OPTS_INIT};
    sg_error err = SG_ERROR_INIT;
    sg_program_begin("apply-unaries");
    const int code = parse_args(argc, argv, &o);
    if (code >= 0)
        return code;
    job j = {.opts = &o, .arena = sg_arena_create(), .progress = sg_program_progress(&o.common)};
    const sg_status st = j.arena != NULL ? run(&j, &err) : SG_FAIL_NOMEM(&err);
    const bool nothing = st == SG_STOPPED && !has_result(&j);
    sg_arena_free(j.arena);
    if (nothing) {
        sg_program_complain("stopped before a photograph was done");
        return sg_exit_code(st);
    }
    return sg_program_end(st, &err);
}
