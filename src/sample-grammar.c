/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sample-grammar.c - models from a grammar, sampled or stored before: label maps, pictures, lattices, derivations, meshes. */
#include "config.h"

#include "core/file.h"
#include "core/random.h"
#include "image/png_io.h"
#include "parse/scene_lattice.h"
#include "program/program.h"
#include "scene/contact_sheet.h"
#include "scene/derivation_json.h"
#include "scene/derivation_load.h"
#include "scene/label_svg.h"
#include "scene/mesh_obj.h"

#include <jansson.h>
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const char help[] =
    "Example: sample-grammar haussmann.sg -n 16 -o facades --sheet 4x4\n\n"
    "Usage: sample-grammar GRAMMAR -n N -o DIR [OPTION]...\n"
    "Sample models from a grammar (*.sg, or its JSON form), or show stored ones.\n\n"
    "  -n N               number of samples (default 1)\n"
    "  --from FILE        do not sample: the derivations in FILE (NAME.sgd or NAME.json)\n"
    "  -o DIR             folder for the results; it is made when it is not there\n"
    "  --size WxH         size of a picture in pixels (default 300x400)\n"
    "  --formats LIST     what to write, with commas between (default all but obj and derivation):\n"
    "                       labels   NAME.png, a label map, and classes.tsv\n"
    "                       rgb      NAME.rgb.png, the labels' colours\n"
    "                       svg      NAME.svg\n"
    "                       lat      NAME.lat, the lattice of all cuts\n"
    "                       json     NAME.json, the derivation with its rectangles\n"
    "                       sheet    sheet.png, the first samples on one page\n"
    "                       derivation  NAME.sgd, the derivation as it is stored\n"
    "                       obj      NAME.obj and NAME.mtl, the model in space\n"
    "  --scope XxYxZ      size of the first scope of obj (default 1x1x1)\n"
    "  --detail N         level of detail of obj: 0 the finest (default) to 15\n"
    "  --sheet CxR        columns and rows of the sheet (default 4x4)\n"
    "  --dataset          write a data set: labels/NAME.png and classes.tsv; rgb goes to\n"
    "                     images/NAME.png, and only labels are written by default\n"
    "  --name PREFIX      NAME is PREFIX-0001 and so on (default: the grammar's name)\n"
    "  --max-nodes N      a derivation with more nodes is an error (default 1000000)\n" SG_COMMON_HELP;

enum { FORMAT_LABELS = 1, FORMAT_RGB = 2, FORMAT_SVG = 4, FORMAT_LAT = 8, FORMAT_JSON = 16, FORMAT_SHEET = 32,
       FORMAT_OBJ = 64, FORMAT_DERIVATION = 128 };
enum { FORMATS_ALL = 63 /* of label scenes */, MAX_SAMPLES = 1000000, SHEET_SIDE_PX = 4096 };

typedef struct {
    sg_common_opts common;
    const char *grammar, *folder, *name, *from; /* from: NULL when sampling */
    size_t n; /* 0: not said */
    size_t width, height, columns, rows, max_nodes, detail;
    double scope[3];
    unsigned formats; /* 0: the default */
    bool dataset;
} options;

typedef struct {
    bool done;
    size_t nodes, rects, faces;
    double log_prior, log_density;
} sample_stats;

/* What all threads share. */
typedef struct {
    const options *opts;
    const sg_grammar *g;
    sg_derivation_file stored; /* none when sampling */
    size_t n;                  /* samples */
    char name[256];
    sg_classes classes;
    uint8_t *value_of;   /* [symbols] */
    size_t nsymbols;
    sample_stats *stats; /* [n] */
    float *share;        /* [n][classes], area shares */
    sg_image *thumbs;    /* [nthumbs], the first samples */
    size_t nthumbs, thumb_width, thumb_height;
    size_t failed; /* lowest sample that failed, n: none */
    sg_error err;  /* its sentence */
} job;

/* Work space of one thread. */
typedef struct {
    sg_derivation d;
    sg_label_scene scene;
    sg_scene space;
    sg_mesh mesh;
    gsl_rng *rng;
    sg_arena *arena;
    double *share; /* [symbols] */
} worker;

static bool parse_pair(const char *option, const char *arg, size_t high, size_t *a, size_t *b)
{
    unsigned long x, y;
    char end;
    if (strchr(arg, '-') == NULL && sscanf(arg, "%lux%lu%c", &x, &y, &end) == 2 && x >= 1 && y >= 1 && x <= high &&
        y <= high) {
        *a = x;
        *b = y;
        return true;
    }
    sg_program_usage("%s: '%s' is no pair of whole numbers from 1 to %zu, as in 4x3", option, arg, high);
    return false;
}

static bool parse_scope(const char *arg, double *size)
{
    char end;
    if (sscanf(arg, "%lfx%lfx%lf%c", size, size + 1, size + 2, &end) == 3 && size[0] >= 0 && size[1] >= 0 && size[2] >= 0 &&
        size[0] <= 1e9 && size[1] <= 1e9 && size[2] <= 1e9)
        return true;
    sg_program_usage("--scope: '%s' is no size as in 10x8.5x0", arg);
    return false;
}

static bool parse_formats(const char *arg, unsigned *formats)
{
    static const char *const names[] = {"labels", "rgb", "svg", "lat", "json", "sheet", "obj", "derivation", "all", NULL};
    *formats = 0;
    for (const char *p = arg;;) {
        const size_t length = strcspn(p, ",");
        char word[32];
        int which;
        snprintf(word, sizeof word, "%.*s", (int)(length < 31 ? length : 31), p);
        if (!sg_program_choice("--formats", word, names, &which))
            return false;
        *formats |= which == 8 ? FORMATS_ALL : 1U << which;
        if (p[length] == '\0')
            return true;
        p += length + 1;
    }
}

enum { OPT_SIZE = SG_OPT_OWN, OPT_FORMATS, OPT_SHEET, OPT_DATASET, OPT_NAME, OPT_MAX_NODES, OPT_SCOPE, OPT_DETAIL,
       OPT_FROM };

static bool take_option(int opt, const char *arg, void *user)
{
    options *o = user;
    switch (opt) {
    case 'n':
        return sg_program_size("-n", arg, 1, MAX_SAMPLES, &o->n);
    case 'o':
        o->folder = arg;
        return true;
    case OPT_SIZE:
        return parse_pair("--size", arg, SG_IMAGE_MAX_SIDE, &o->width, &o->height);
    case OPT_FORMATS:
        return parse_formats(arg, &o->formats);
    case OPT_SHEET:
        return parse_pair("--sheet", arg, 1000, &o->columns, &o->rows);
    case OPT_SCOPE:
        return parse_scope(arg, o->scope);
    case OPT_DETAIL:
        return sg_program_size("--detail", arg, 0, 15, &o->detail);
    case OPT_DATASET:
        o->dataset = true;
        return true;
    case OPT_FROM:
        o->from = arg;
        return true;
    case OPT_NAME:
        o->name = arg;
        return arg[0] != '\0' && strchr(arg, '/') == NULL && strlen(arg) < 200
                   ? true
                   : (sg_program_usage("--name: '%s' is no beginning of a file name", arg), false);
    default:
        return sg_program_size("--max-nodes", arg, 1, UINT32_MAX - 2, &o->max_nodes);
    }
}

/* @return -1: go on; else exit with this status */
static int parse_args(int argc, char **argv, options *o)
{
    static const struct option longs[] = {SG_COMMON_LONG_OPTIONS,
                                          {"size", required_argument, NULL, OPT_SIZE},
                                          {"formats", required_argument, NULL, OPT_FORMATS},
                                          {"sheet", required_argument, NULL, OPT_SHEET},
                                          {"dataset", no_argument, NULL, OPT_DATASET},
                                          {"name", required_argument, NULL, OPT_NAME},
                                          {"scope", required_argument, NULL, OPT_SCOPE},
                                          {"detail", required_argument, NULL, OPT_DETAIL},
                                          {"max-nodes", required_argument, NULL, OPT_MAX_NODES},
                                          {"from", required_argument, NULL, OPT_FROM},
                                          {NULL, 0, NULL, 0}};
    const int end = sg_program_options(argc, argv, "n:o:", longs, help, &o->common, take_option, o);
    if (end >= 0)
        return end;
    if (argc - optind != 1)
        return sg_program_usage("one grammar file is wanted, not %d", argc - optind);
    if (o->folder == NULL)
        return sg_program_usage("-o DIR is missing");
    if (o->from != NULL && o->n > 0)
        return sg_program_usage("-n and --from: a file holds as many derivations as it holds");
    o->n = o->n > 0 ? o->n : 1;
    o->grammar = argv[optind];
    if (o->formats == 0)
        o->formats = o->dataset ? FORMAT_LABELS : FORMATS_ALL;
    if (o->width * o->height > SG_IMAGE_MAX_PIXELS)
        return sg_program_usage("--size: %zux%zu is more than %u pixels", o->width, o->height, SG_IMAGE_MAX_PIXELS);
    return -1;
}

static bool is_same_file(const char *a, const char *b)
{
    struct stat in, out;
    return a != NULL && stat(a, &in) == 0 && stat(b, &out) == 0 && in.st_dev == out.st_dev && in.st_ino == out.st_ino &&
           S_ISREG(out.st_mode);
}

/* Never what is read: -o may name the folder it stands in. */
static sg_status check_not_input(const job *j, const char *path, sg_error *err)
{
    const bool grammar = is_same_file(j->opts->grammar, path);
    if (grammar || is_same_file(j->opts->from, path))
        return SG_FAIL(err, SG_EINVAL, "%s: %s read; choose another folder or --name", path,
                       grammar ? "this is the grammar that is" : "these are the derivations that are");
    return SG_OK;
}

static sg_status path_of(const job *j, const char *folder, size_t i, const char *suffix, char *path, size_t size,
                         sg_error *err)
{
    const int n = snprintf(path, size, "%s/%s%s-%04zu%s", j->opts->folder, folder, j->name, i + 1, suffix);
    if (n < 0 || (size_t)n >= size)
        return SG_FAIL(err, SG_EIO, "%s: the path is too long", j->opts->folder);
    return check_not_input(j, path, err);
}

static sg_status write_labels(const job *j, const worker *w, size_t i, sg_error *err)
{
    char path[4096];
    sg_label_map map;
    SG_TRY(path_of(j, j->opts->dataset ? "labels/" : "", i, ".png", path, sizeof path, err));
    SG_TRY(sg_label_map_create(j->opts->width, j->opts->height, &map, err));
    sg_label_scene_raster(&w->scene, j->value_of, &map);
    const sg_status st = sg_png_write_labels(path, &map, j->classes.index_colors, j->classes.nclasses, err);
    sg_label_map_clear(&map);
    return st;
}

static sg_status write_rgb(const job *j, const worker *w, size_t i, sg_error *err)
{
    char path[4096];
    sg_image im;
    const bool dataset = j->opts->dataset;
    SG_TRY(path_of(j, dataset ? "images/" : "", i, dataset ? ".png" : ".rgb.png", path, sizeof path, err));
    SG_TRY(sg_image_create(j->opts->width, j->opts->height, &im, err));
    sg_label_scene_paint(&w->scene, j->g, &im);
    const sg_status st = sg_png_write_rgb(path, &im, err);
    sg_image_clear(&im);
    return st;
}

/* A text file, by one of the writers below. */
static sg_status write_text(const job *j, worker *w, size_t i, const char *suffix,
                            sg_status (*write)(const job *, worker *, FILE *, sg_error *), sg_error *err)
{
    char path[4096];
    sg_output out;
    SG_TRY(path_of(j, "", i, suffix, path, sizeof path, err));
    SG_TRY(sg_output_open(&out, path, err));
    const sg_status st = write(j, w, out.fp, err);
    if (st == SG_OK)
        return sg_output_commit(&out, err);
    sg_output_discard(&out);
    return st;
}

static sg_status print_svg(const job *j, worker *w, FILE *fp, sg_error *err)
{
    return sg_label_svg_write(&w->scene, j->g, fp, err);
}

static sg_status print_lattice(const job *j, worker *w, FILE *fp, sg_error *err)
{
    sg_lattice l;
    sg_arena_reset(w->arena);
    SG_TRY(sg_lattice_of_scene(&w->scene, j->g, j->opts->width, j->opts->height, w->arena, &l, err));
    return sg_lattice_write(&l, fp, err);
}

static sg_status print_derivation(const job *j, worker *w, FILE *fp, sg_error *err)
{
    SG_TRY(sg_derivation_write_json(&w->d, (double)j->opts->width, (double)j->opts->height, fp, err));
    fputc('\n', fp);
    return SG_OK;
}

/* The materials stand beside it, and are an output too. */
static sg_status write_mesh(const job *j, worker *w, size_t i, sg_error *err)
{
    char path[4096];
    const options *o = j->opts;
    sg_scene_opts scene = SG_SCENE_OPTS_INIT;
    sg_mesh_opts mesh = SG_MESH_OPTS_INIT;
    memcpy(scene.size, o->scope, sizeof scene.size);
    mesh.detail = (unsigned)o->detail;
    SG_TRY(sg_scene_interpret(&w->d, &scene, &w->space, err));
    SG_TRY(sg_mesh_from_scene(&w->space, &mesh, &w->mesh, err));
    j->stats[i].faces = w->mesh.nfaces;
    SG_TRY(path_of(j, "", i, ".mtl", path, sizeof path, err));
    SG_TRY(path_of(j, "", i, ".obj", path, sizeof path, err));
    return sg_mesh_obj_save(&w->mesh, path, err);
}

static sg_status write_stored(const job *j, const worker *w, size_t i, sg_error *err)
{
    char path[4096];
    SG_TRY(path_of(j, "", i, ".sgd", path, sizeof path, err));
    return sg_derivation_file_write(path, j->g, &w->d, 1, err);
}

static sg_status write_formats(const job *j, worker *w, size_t i, sg_error *err)
{
    const unsigned f = j->opts->formats;
    if (f & FORMAT_LABELS)
        SG_TRY(write_labels(j, w, i, err));
    if (f & FORMAT_RGB)
        SG_TRY(write_rgb(j, w, i, err));
    if (f & FORMAT_SVG)
        SG_TRY(write_text(j, w, i, ".svg", print_svg, err));
    if (f & FORMAT_LAT)
        SG_TRY(write_text(j, w, i, ".lat", print_lattice, err));
    if (f & FORMAT_JSON)
        SG_TRY(write_text(j, w, i, ".json", print_derivation, err));
    if (f & FORMAT_OBJ)
        SG_TRY(write_mesh(j, w, i, err));
    if (f & FORMAT_DERIVATION)
        SG_TRY(write_stored(j, w, i, err));
    return SG_OK;
}

/* Does a format ask for label scenes? A grammar of models in space need not have any. */
static bool wants_labels(const options *o)
{
    return (o->formats & FORMATS_ALL) != 0;
}

static sg_status note_labels(job *j, worker *w, size_t i, sg_error *err)
{
    j->stats[i].rects = w->scene.nrects;
    sg_label_scene_shares(&w->scene, j->g, w->share);
    for (sg_sym k = 0; k < j->nsymbols; k++)
        if (sg_grammar_symbol(j->g, k)->kind == SG_SYMBOL_LABEL)
            j->share[i * j->classes.nclasses + j->classes.class_of[j->value_of[k]]] += (float)w->share[k];
    if (i < j->nthumbs) {
        SG_TRY(sg_image_create(j->thumb_width, j->thumb_height, j->thumbs + i, err));
        sg_label_scene_paint(&w->scene, j->g, j->thumbs + i);
    }
    return SG_OK;
}

static sg_status note_sample(job *j, worker *w, size_t i, sg_error *err)
{
    sample_stats *s = j->stats + i;
    s->nodes = w->d.nnodes;
    SG_TRY(sg_derivation_log_prior(&w->d, &s->log_prior, err));
    SG_TRY(sg_derivation_log_density(&w->d, &s->log_density, err));
    if (wants_labels(j->opts))
        SG_TRY(note_labels(j, w, i, err));
    s->done = true;
    return SG_OK;
}

/* Sample i is a pure function of the seed and i. */
static sg_status derive(const job *j, worker *w, size_t i, sg_error *err)
{
    if (j->opts->from == NULL) {
        sg_random_stream(w->rng, j->opts->common.seed, (uint32_t)i, 0);
        return sg_derivation_sample(&w->d, w->rng, j->opts->max_nodes, err);
    }
    if (j->stored.items[i].nnodes > j->opts->max_nodes)
        return SG_FAIL(err, SG_ENUMERIC, "more than %zu nodes", j->opts->max_nodes);
    return sg_derivation_copy(&w->d, j->stored.items + i, err);
}

static sg_status make_sample(job *j, worker *w, size_t i, sg_error *err)
{
    SG_TRY(derive(j, w, i, err));
    if (wants_labels(j->opts))
        SG_TRY(sg_label_scene_interpret(&w->scene, &w->d, (double)j->opts->width, (double)j->opts->height, err));
    SG_TRY(write_formats(j, w, i, err));
    return note_sample(j, w, i, err);
}

static bool worker_open(const job *j, worker *w)
{
    memset(w, 0, sizeof *w);
    sg_derivation_init(&w->d, j->g);
    w->rng = sg_random_create(1);
    w->arena = sg_arena_create();
    w->share = calloc(j->nsymbols, sizeof *w->share);
    return w->rng != NULL && w->arena != NULL && w->share != NULL;
}

static void worker_close(worker *w)
{
    sg_derivation_clear(&w->d);
    sg_label_scene_clear(&w->scene);
    sg_scene_clear(&w->space);
    sg_mesh_clear(&w->mesh);
    if (w->rng != NULL)
        gsl_rng_free(w->rng);
    sg_arena_free(w->arena);
    free(w->share);
}

/* Of several failures the one of the lowest sample is told: which one comes first is a matter of scheduling. */
static void note_failure(job *j, size_t i, const sg_error *err)
{
#pragma omp critical(sample_failure)
    if (i < j->failed) {
        j->failed = i;
        sg_fail(&j->err, err->code, "sample %zu: %.900s", i + 1, err->msg);
    }
}

static size_t lowest_failure(job *j)
{
    size_t i;
#pragma omp critical(sample_failure)
    i = j->failed;
    return i;
}

static void run_worker(job *j, sg_progress *progress, size_t *ndone)
{
    worker w;
    const bool good = worker_open(j, &w);
#pragma omp for schedule(dynamic, 1)
    for (size_t i = 0; i < j->n; i++) {
        sg_error err = SG_ERROR_INIT;
        if (i > lowest_failure(j) || sg_progress_stopped(progress))
            continue;
        if (!good)
            err.code = SG_FAIL_NOMEM(&err);
        else if (make_sample(j, &w, i, &err) == SG_ENOMEM)
            SG_FAIL_NOMEM(&err);
        if (err.code != SG_OK)
            note_failure(j, i, &err);
#pragma omp critical(sample_progress)
        sg_progress_report(progress, j->opts->from == NULL ? "sampling" : "showing", ++*ndone, j->n);
    }
    worker_close(&w);
}

static sg_status sample_all(job *j, sg_error *err)
{
    sg_progress progress = sg_program_progress(&j->opts->common);
    size_t ndone = 0;
    if (j->opts->common.threads > 0)
        omp_set_num_threads(j->opts->common.threads);
#pragma omp parallel
    run_worker(j, &progress, &ndone);
    sg_program_progress_end();
    if (j->failed < j->n) {
        *err = j->err;
        return err->code;
    }
    return sg_progress_stopped(&progress) ? SG_STOPPED : SG_OK;
}

static sg_status write_sheet(job *j, sg_error *err)
{
    size_t n = 0;
    for (size_t i = 0; i < j->nthumbs; i++) { /* after an interrupt some may be missing */
        const sg_image im = j->thumbs[i];
        j->thumbs[i] = (sg_image){0};
        if (im.rgb != NULL)
            j->thumbs[n++] = im;
    }
    if (n == 0)
        return SG_OK;
    char path[4096];
    sg_image sheet;
    sg_sheet_opts o = SG_SHEET_OPTS_INIT;
    o.columns = j->opts->columns < n ? j->opts->columns : n;
    if (snprintf(path, sizeof path, "%s/sheet.png", j->opts->folder) >= (int)sizeof path)
        return SG_FAIL(err, SG_EIO, "%s: the path is too long", j->opts->folder);
    SG_TRY(check_not_input(j, path, err));
    SG_TRY(sg_contact_sheet(j->thumbs, n, &o, &sheet, err));
    const sg_status st = sg_png_write_rgb(path, &sheet, err);
    sg_image_clear(&sheet);
    return st;
}

/* JSON has no infinities. */
static json_t *number(double x)
{
    return isfinite(x) ? json_real(x) : json_null();
}

static json_t *sample_json(const job *j, size_t i)
{
    const sample_stats *s = j->stats + i;
    char name[sizeof j->name + 32];
    snprintf(name, sizeof name, "%s-%04zu", j->name, i + 1);
    json_t *areas = json_object();
    for (size_t k = 0; k < j->classes.nclasses; k++)
        if (json_object_set_new(areas, j->classes.names[k], json_real((double)j->share[i * j->classes.nclasses + k])) != 0)
            return json_decref(areas), NULL;
    return json_pack("{s:s, s:I, s:I, s:I, s:o, s:o, s:o}", "name", name, "nodes", (json_int_t)s->nodes, "faces",
                     (json_int_t)s->faces, "rectangles",
                     (json_int_t)s->rects, "log_prior", number(s->log_prior), "log_density", number(s->log_density),
                     "areas", areas);
}

static json_t *report_json(const job *j)
{
    json_t *samples = json_array();
    for (size_t i = 0; i < j->n; i++)
        if (j->stats[i].done && json_array_append_new(samples, sample_json(j, i)) != 0)
            return json_decref(samples), NULL;
    if (j->opts->from != NULL)
        return json_pack("{s:s, s:s, s:[I, I], s:o}", "grammar", sg_grammar_name(j->g), "from", j->opts->from, "size",
                         (json_int_t)j->opts->width, (json_int_t)j->opts->height, "samples", samples);
    return json_pack("{s:s, s:I, s:s, s:[I, I], s:o}", "grammar", sg_grammar_name(j->g), "seed",
                     (json_int_t)j->opts->common.seed, "generator", sg_random_philox->name, "size",
                     (json_int_t)j->opts->width, (json_int_t)j->opts->height, "samples", samples);
}

static sg_status write_report(const job *j, sg_error *err)
{
    if (j->opts->common.json == NULL)
        return SG_OK;
    SG_TRY(check_not_input(j, j->opts->common.json, err));
    json_t *report = report_json(j);
    if (report == NULL)
        return SG_FAIL_NOMEM(err);
    sg_output out;
    sg_status st = sg_output_open(&out, j->opts->common.json, err);
    if (st == SG_OK) {
        json_dumpf(report, out.fp, JSON_INDENT(1)); /* a failed write shows up in the commit */
        fputc('\n', out.fp);
        st = sg_output_commit(&out, err);
    }
    json_decref(report);
    return st;
}

static sg_status make_folders(const job *j, sg_error *err)
{
    char path[4096];
    SG_TRY(sg_folder_create(j->opts->folder, err));
    static const struct {
        unsigned format;
        const char *name;
    } folders[] = {{FORMAT_LABELS, "labels"}, {FORMAT_RGB, "images"}};
    for (size_t k = 0; k < 2 && j->opts->dataset; k++) {
        if (!(j->opts->formats & folders[k].format))
            continue;
        if (snprintf(path, sizeof path, "%s/%s", j->opts->folder, folders[k].name) >= (int)sizeof path)
            return SG_FAIL(err, SG_EIO, "%s: the path is too long", j->opts->folder);
        SG_TRY(sg_folder_create(path, err));
    }
    if (!(j->opts->formats & FORMAT_LABELS))
        return SG_OK;
    if (snprintf(path, sizeof path, "%s/classes.tsv", j->opts->folder) >= (int)sizeof path)
        return SG_FAIL(err, SG_EIO, "%s: the path is too long", j->opts->folder);
    SG_TRY(check_not_input(j, path, err));
    return sg_classes_write(path, &j->classes, err);
}

/* Pictures on the sheet are as large as the others, unless the sheet would become too large to look at. */
static void plan_sheet(job *j)
{
    const options *o = j->opts;
    if (!(o->formats & FORMAT_SHEET))
        return;
    j->nthumbs = o->columns * o->rows < j->n ? o->columns * o->rows : j->n;
    const double scale = fmin(1, fmin((double)SHEET_SIDE_PX / (double)(o->columns * o->width),
                                      (double)SHEET_SIDE_PX / (double)(o->rows * o->height)));
    j->thumb_width = (size_t)fmax(1, scale * (double)o->width);
    j->thumb_height = (size_t)fmax(1, scale * (double)o->height);
}

static sg_status job_open(job *j, sg_error *err)
{
    j->nsymbols = sg_grammar_symbol_count(j->g);
    j->failed = j->n;
    const char *name = j->opts->name != NULL ? j->opts->name : sg_grammar_name(j->g);
    snprintf(j->name, sizeof j->name, "%s", name != NULL && name[0] != '\0' ? name : "sample");
    for (char *p = j->name; *p != '\0'; p++)
        if (*p == '/' || (unsigned char)*p <= ' ')
            *p = '_';
    plan_sheet(j);
    j->value_of = calloc(j->nsymbols, 1);
    j->stats = calloc(j->n, sizeof *j->stats);
    j->thumbs = calloc(j->nthumbs + 1, sizeof *j->thumbs);
    if (j->value_of == NULL || j->stats == NULL || j->thumbs == NULL)
        return SG_FAIL_NOMEM(err);
    if (wants_labels(j->opts))
        SG_TRY(sg_label_classes(j->g, &j->classes, j->value_of, err));
    j->share = calloc(j->n * j->classes.nclasses + 1, sizeof *j->share);
    return j->share != NULL ? SG_OK : SG_FAIL_NOMEM(err);
}

static void job_close(job *j)
{
    for (size_t i = 0; j->thumbs != NULL && i < j->nthumbs; i++)
        sg_image_clear(j->thumbs + i);
    sg_derivation_file_clear(&j->stored);
    free(j->thumbs);
    free(j->stats);
    free(j->share);
    free(j->value_of);
    sg_classes_clear(&j->classes);
}

static sg_status load_stored(job *j, sg_error *err)
{
    if (j->opts->from == NULL)
        return SG_OK;
    SG_TRY(sg_derivation_load(j->opts->from, j->g, &j->stored, err));
    j->n = j->stored.n;
    return j->n > 0 ? SG_OK : SG_FAIL(err, SG_EINPUT, "%s: it holds no derivation", j->opts->from);
}

static sg_status run(const options *o, const sg_grammar *g, sg_error *err)
{
    job j = {.opts = o, .g = g, .n = o->n};
    sg_status st = load_stored(&j, err);
    if (st == SG_OK)
        st = job_open(&j, err);
    if (st == SG_OK)
        st = make_folders(&j, err);
    if (st == SG_OK)
        st = sample_all(&j, err);
    if (st == SG_OK || st == SG_STOPPED) {
        sg_status written = write_sheet(&j, err);
        if (written == SG_OK)
            written = write_report(&j, err);
        st = written != SG_OK ? written : st;
    }
    job_close(&j);
    return st;
}

int main(int argc, char **argv)
{
    options o = {.common = SG_COMMON_OPTS_INIT,
                 .width = 300,
                 .height = 400,
                 .columns = 4,
                 .rows = 4,
                 .scope = {1, 1, 1},
                 .max_nodes = 1000000};
    sg_error err = SG_ERROR_INIT;
    sg_grammar *g = NULL;
    sg_program_begin("sample-grammar");
    const int early = parse_args(argc, argv, &o);
    if (early >= 0)
        return early;
    sg_status st = sg_grammar_load(o.grammar, &g, &err);
    if (st == SG_OK)
        st = run(&o, g, &err);
    sg_grammar_free(g);
    return sg_program_end(st, &err);
}
