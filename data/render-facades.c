/* SPDX-License-Identifier: GPL-3.0-or-later */
/* render-facades.c - a data set of our own: facades sampled from a split grammar, as label maps that are exact and as
 * photographs that are not. Not installed: data/make-facades.sh calls it. */
#include "config.h"

#include "core/array.h"
#include "core/file.h"
#include "core/random.h"
#include "data/render_facade.h"
#include "image/cv_image.h"
#include "image/png_io.h"
#include "program/program.h"
#include "program/program_grammar.h"
#include "scene/label_scene.h"

#include <stdlib.h>
#include <string.h>

static const char help[] =
    "Usage: render-facades GRAMMAR -o FOLDER\n"
    "Example: render-facades data/grammars/haussmann.sg -o out/facades -n 48 --seed 1853\n"
    "Sample facades from a split grammar and render each as a photograph: a data set with label maps, pictures, classes\n"
    "and folds. Labels: sky, wall, roof, chimney, shop, door, window, balcony.\n"
    "  -o, --output FOLDER  the data set\n"
    "  -n, --count N        pictures (default 48)\n"
    "  --width N            mean width in pixels (default 200); it varies by a tenth\n"
    "  --height N           mean height (default 280)\n" SG_COMMON_HELP;

enum { QUALITY = 85, MAX_NODES = 10000, FOLDS = 4 };

typedef struct {
    sg_common_opts common;
    const char *grammar, *folder;
    size_t count, width, height;
} render_opts;

typedef struct {
    const render_opts *opts;
    sg_grammar *grammar;
    sg_classes classes;
    uint8_t *value_of; /* [symbols] pixel value of a label */
    gsl_rng *rng;
    sg_derivation derivation;
    sg_label_scene scene;
    sg_facade_element *elements;
    size_t capacity;
} render_job;

/* Returns -1 to go on, else the exit status. */
static int take_option(int opt, render_opts *o)
{
    switch (opt) {
    case 'o':
        o->folder = optarg;
        return -1;
    case 'n':
        return sg_program_size("--count", optarg, 1, 9999, &o->count) ? -1 : 2;
    case SG_OPT_OWN:
        return sg_program_size("--width", optarg, 32, 4096, &o->width) ? -1 : 2;
    case SG_OPT_OWN + 1:
        return sg_program_size("--height", optarg, 32, 4096, &o->height) ? -1 : 2;
    default:
        switch (sg_program_option(opt, optarg, help, &o->common)) {
        case SG_OPTION_TAKEN:
            return -1;
        case SG_OPTION_EXIT_OK:
            return 0;
        default:
            return 2;
        }
    }
}

static int read_options(int argc, char **argv, render_opts *o)
{
    static const struct option options[] = {{"output", required_argument, NULL, 'o'},
                                            {"count", required_argument, NULL, 'n'},
                                            {"width", required_argument, NULL, SG_OPT_OWN},
                                            {"height", required_argument, NULL, SG_OPT_OWN + 1},
                                            SG_COMMON_LONG_OPTIONS,
                                            {NULL, 0, NULL, 0}};
    for (int opt; (opt = getopt_long(argc, argv, "o:n:", options, NULL)) != -1;) {
        const int status = take_option(opt, o);
        if (status >= 0)
            return status;
    }
    if (argc - optind != 1)
        return sg_program_usage("one grammar is wanted");
    if (o->folder == NULL)
        return sg_program_usage("-o FOLDER is wanted");
    o->grammar = argv[optind];
    return -1;
}

static sg_status check_labels(const sg_grammar *g, sg_error *err)
{
    for (sg_sym s = 0; s < sg_grammar_symbol_count(g); s++) {
        const sg_symbol *symbol = sg_grammar_symbol(g, s);
        if (symbol->kind == SG_SYMBOL_LABEL && sg_part_named(symbol->name) == SG_PARTS)
            return SG_FAIL(err, SG_EINPUT, "label '%s': only sky, wall, roof, chimney, shop, door, window and balcony can "
                                           "be rendered", symbol->name);
    }
    return SG_OK;
}

static sg_status begin(render_job *job, sg_error *err)
{
    char path[4096];
    SG_TRY(sg_program_load_grammar(job->opts->grammar, &job->grammar, err));
    SG_TRY(check_labels(job->grammar, err));
    job->value_of = calloc(sg_grammar_symbol_count(job->grammar), 1);
    job->rng = sg_random_create(job->opts->common.seed);
    if (job->value_of == NULL || job->rng == NULL)
        return SG_FAIL_NOMEM(err);
    SG_TRY(sg_label_classes(job->grammar, &job->classes, job->value_of, err));
    sg_derivation_init(&job->derivation, job->grammar);
    const char *const folders[] = {"images", "labels", "folds"};
    for (size_t i = 0; i < sizeof folders / sizeof *folders; i++) {
        snprintf(path, sizeof path, "%s/%s", job->opts->folder, folders[i]);
        SG_TRY(sg_folder_create(path, err));
    }
    snprintf(path, sizeof path, "%s/classes.tsv", job->opts->folder);
    return sg_classes_write(path, &job->classes, err);
}

static void end(render_job *job)
{
    free(job->elements);
    sg_label_scene_clear(&job->scene);
    if (job->grammar != NULL)
        sg_derivation_clear(&job->derivation);
    sg_classes_clear(&job->classes);
    free(job->value_of);
    gsl_rng_free(job->rng);
    sg_grammar_free(job->grammar);
}

static size_t varied(gsl_rng *rng, size_t mean)
{
    return (size_t)((double)mean * (0.9 + 0.2 * sg_random_uniform(rng)));
}

static sg_status write_labels(render_job *job, size_t width, size_t height, const char *name, sg_error *err)
{
    char path[4096];
    sg_label_map map;
    SG_TRY(sg_label_map_create(width, height, &map, err));
    sg_label_scene_raster(&job->scene, job->value_of, &map);
    snprintf(path, sizeof path, "%s/labels/%s.png", job->opts->folder, name);
    const sg_status st = sg_png_write_labels(path, &map, job->classes.colors, job->classes.nclasses, err);
    sg_label_map_clear(&map);
    return st;
}

static sg_status write_photograph(render_job *job, size_t picture, size_t width, size_t height, const char *name,
                                  sg_error *err)
{
    char path[4096];
    sg_facade facade = {width, height, job->scene.nrects, NULL};
    if (!SG_GROW(job->elements, job->capacity, facade.nelements))
        return SG_FAIL_NOMEM(err);
    for (size_t i = 0; i < facade.nelements; i++) {
        const sg_label_rect *r = &job->scene.rects[i];
        job->elements[i].part = sg_part_named(sg_grammar_symbol(job->grammar, r->label)->name);
        job->elements[i].box = sg_box_of(r->x0, r->y0, r->x1, r->y1);
    }
    facade.elements = job->elements;
    sg_image photograph;
    SG_TRY(sg_facade_render(&facade, job->opts->common.seed, (uint32_t)picture, &photograph, err));
    snprintf(path, sizeof path, "%s/images/%s.jpg", job->opts->folder, name);
    const sg_status st = sg_photo_write_jpeg(path, &photograph, QUALITY, err);
    sg_image_clear(&photograph);
    return st;
}

/* Stream (seed, picture, 0) makes the house, stream (seed, picture, 1) its photograph. */
static sg_status make_picture(render_job *job, size_t picture, sg_error *err)
{
    char name[32];
    snprintf(name, sizeof name, "facade%03zu", picture + 1);
    sg_random_stream(job->rng, job->opts->common.seed, (uint32_t)picture, 0);
    const size_t width = varied(job->rng, job->opts->width), height = varied(job->rng, job->opts->height);
    SG_TRY(sg_derivation_sample(&job->derivation, job->rng, MAX_NODES, err));
    SG_TRY(sg_label_scene_interpret(&job->scene, &job->derivation, (double)width, (double)height, err));
    SG_TRY(write_labels(job, width, height, name, err));
    return write_photograph(job, picture, width, height, name, err);
}

/* Fold k tests the k-th quarter; the eighth after it is for validation, the rest, in turn from there, for training. */
static sg_status write_fold(const render_job *job, size_t fold, sg_error *err)
{
    char path[4096];
    sg_output out;
    const size_t n = job->opts->count, ntest = n / FOLDS, nvalid = n / (2 * FOLDS);
    snprintf(path, sizeof path, "%s/folds/%zu.tsv", job->opts->folder, fold + 1);
    SG_TRY(sg_output_open(&out, path, err));
    for (size_t i = 0; i < n; i++) {
        const char *part = i < ntest ? "test" : i < ntest + nvalid ? "valid" : "train";
        fprintf(out.fp, "facade%03zu\t%s\n", (fold * ntest + i) % n + 1, part);
    }
    return sg_output_commit(&out, err);
}

static sg_status run(render_job *job, sg_error *err)
{
    sg_progress progress = sg_program_progress(&job->opts->common);
    SG_TRY(begin(job, err));
    for (size_t i = 0; i < job->opts->count; i++) {
        if (sg_progress_stopped(&progress))
            return SG_STOPPED;
        SG_TRY(make_picture(job, i, err));
        sg_progress_report(&progress, "rendering", i + 1, job->opts->count);
    }
    for (size_t fold = 0; fold < FOLDS; fold++)
        SG_TRY(write_fold(job, fold, err));
    return SG_OK;
}

int main(int argc, char **argv)
{
    render_opts opts = {SG_COMMON_OPTS_INIT, NULL, NULL, 48, 200, 280};
    sg_error err = SG_ERROR_INIT;
    render_job job;
    sg_program_begin("render-facades");
    const int status = read_options(argc, argv, &opts);
    if (status >= 0)
        return status;
    memset(&job, 0, sizeof job);
    job.opts = &opts;
    const sg_status st = run(&job, &err);
    end(&job);
    return sg_program_end(st, &err);
}
