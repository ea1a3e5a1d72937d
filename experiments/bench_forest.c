/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench_forest.c - how fast a forest judges photographs: our tables, features included, beside OpenCV's own prediction with
 * the same forest on the same pixels, whose votes must be the same (experiments/bench_forest.sh).
 *
 * Rates are pixels a second. Of one thread by processor time, so that other work on the machine does not count; of all
 * threads by the clock. OpenCV gets its samples ready-made in one matrix: gathering them is not counted. */
#include "config.h"

#include "image/cv_image.h"
#include "parse/pixel_classifier_sample.h"
#include "program/program.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static const char HELP[] =
    "Usage: bench_forest DATASET [OPTION]...\n"
    "Grow a forest on the training part of fold 1, and judge photographs of its test part.\n"
    "\n"
    "  --classes FILE     class table in place of DATASET/classes.tsv\n"
    "  --features SET     patch (default) or rich\n"
    "  --patch SIDE       (default 13)\n"
    "  --trees N, --depth N, --pixels N\n"
    "                     of the forest, and that it is grown on (default 20, 20, 100000)\n"
    "  --images N         that are judged (default 4)\n"
    "  --matrix N         pixels of them, about, that OpenCV judges (default 50000)\n" SG_COMMON_HELP;

typedef struct {
    sg_common_opts common;
    const char *classes;
    int kind;
    size_t patch, trees, depth, pixels, images, matrix;
} options;

enum { OPT_CLASSES = SG_OPT_OWN, OPT_FEATURES, OPT_PATCH, OPT_TREES, OPT_DEPTH, OPT_PIXELS, OPT_IMAGES, OPT_MATRIX };

static const struct option LONG_OPTIONS[] = {{"classes", required_argument, NULL, OPT_CLASSES},
                                             {"features", required_argument, NULL, OPT_FEATURES},
                                             {"patch", required_argument, NULL, OPT_PATCH},
                                             {"trees", required_argument, NULL, OPT_TREES},
                                             {"depth", required_argument, NULL, OPT_DEPTH},
                                             {"pixels", required_argument, NULL, OPT_PIXELS},
                                             {"images", required_argument, NULL, OPT_IMAGES},
                                             {"matrix", required_argument, NULL, OPT_MATRIX},
                                             SG_COMMON_LONG_OPTIONS,
                                             {NULL, 0, NULL, 0}};

static bool take_own(int opt, const char *arg, void *user)
{
    options *o = user;
    static const char *const kinds[] = {"patch", "rich", NULL};
    switch (opt) {
    case OPT_CLASSES:
        o->classes = arg;
        return true;
    case OPT_FEATURES:
        return sg_program_choice("--features", arg, kinds, &o->kind);
    case OPT_PATCH:
        return sg_program_size("--patch", arg, 1, 63, &o->patch);
    case OPT_TREES:
        return sg_program_size("--trees", arg, 1, 1000, &o->trees);
    case OPT_DEPTH:
        return sg_program_size("--depth", arg, 1, SG_CV_MAX_DEPTH, &o->depth);
    case OPT_PIXELS:
        return sg_program_size("--pixels", arg, 1, 100000000, &o->pixels);
    case OPT_IMAGES:
        return sg_program_size("--images", arg, 1, 1000, &o->images);
    default: /* OPT_MATRIX */
        return sg_program_size("--matrix", arg, 1, 10000000, &o->matrix);
    }
}

static double clock_s(clockid_t id)
{
    struct timespec t;
    clock_gettime(id, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ---- growing ---- */

static sg_status grow(const options *o, const sg_dataset *d, const sg_feature_set *set, sg_arena *arena,
                      sg_cv_forest **out, sg_error *err)
{
    const sg_pixel_sample_opts opts = {*set, o->common.seed, omp_get_max_threads(), NULL};
    const sg_cv_forest_opts forest = {o->trees, o->depth, 5, 0};
    sg_pixel_census census;
    sg_sample_matrix m;
    sg_cv_samples *samples;
    uint64_t quotas[SG_MAX_CLASSES];
    SG_TRY(sg_pixel_census_take(d, arena, &census, err));
    sg_pixel_quotas(&census, o->pixels, false, quotas);
    SG_TRY(sg_pixel_sample_draw(d, &census, quotas, &opts, &m, err));
    const double begin = clock_s(CLOCK_THREAD_CPUTIME_ID);
    sg_status st = sg_cv_samples_create(m.x, m.n, m.nfeatures, m.classes, &samples, err);
    if (st == SG_OK) {
        st = sg_cv_forest_grow(samples, &forest, o->common.seed, out, err);
        sg_cv_samples_free(samples);
    }
    printf("grown in one thread: %zu trees, depth %zu, on %zu pixels of %zu features: %.1f s\n", o->trees, o->depth, m.n,
           m.nfeatures, clock_s(CLOCK_THREAD_CPUTIME_ID) - begin);
    free(m.x);
    free(m.classes);
    return st;
}

/* ---- judging ---- */

typedef struct {
    const options *opts;
    const sg_cv_forest *theirs;
    const sg_forest *ours;
    size_t pixels, matrix_pixels, votes, wrong_votes; /* seen so far; wrong_votes: other than OpenCV's */
    double features_s, forest_s; /* processor time of one thread */
    double all_s;                /* by the clock, all threads, features included */
    double theirs_s;             /* processor time of one thread */
} judging;

static sg_status judge_ours(judging *j, const sg_feature_set *set, const sg_image *photo, sg_float_map *votes,
                            sg_error *err)
{
    sg_features f;
    sg_float_map again;
    const double t0 = clock_s(CLOCK_THREAD_CPUTIME_ID);
    SG_TRY(sg_features_create(set, photo, &f, err));
    const double t1 = clock_s(CLOCK_THREAD_CPUTIME_ID);
    sg_status st = sg_forest_apply(j->ours, &f, 1, votes, err);
    j->features_s += t1 - t0;
    j->forest_s += clock_s(CLOCK_THREAD_CPUTIME_ID) - t1;
    sg_features_clear(&f);
    SG_TRY(st);
    const double wall = clock_s(CLOCK_MONOTONIC);
    SG_TRY(sg_features_create(set, photo, &f, err));
    st = sg_forest_apply(j->ours, &f, omp_get_max_threads(), &again, err);
    sg_features_clear(&f);
    SG_TRY(st);
    j->all_s += clock_s(CLOCK_MONOTONIC) - wall;
    j->pixels += photo->width * photo->height;
    sg_float_map_clear(&again);
    return SG_OK;
}

/* Every step-th pixel, gathered for OpenCV; the votes of both are compared one by one. */
static sg_status judge_theirs(judging *j, const sg_features *f, const sg_float_map *votes, size_t step, float *x,
                              uint8_t *classes, int32_t *table, sg_error *err)
{
    const size_t plane = f->width * f->height, nclasses = votes->channels, nfeatures = f->nfeatures;
    size_t n = 0;
    for (size_t i = 0; i < plane; i += step, n++)
        for (size_t k = 0; k < nfeatures; k++)
            x[n * nfeatures + k] = sg_features_value(f, k, i % f->width, i / f->width);
    const double begin = clock_s(CLOCK_THREAD_CPUTIME_ID);
    SG_TRY(sg_cv_forest_predict(j->theirs, x, n, classes, err));
    j->theirs_s += clock_s(CLOCK_THREAD_CPUTIME_ID) - begin;
    SG_TRY(sg_cv_forest_votes(j->theirs, x, n, nclasses, table, err));
    for (size_t i = 0; i < n; i++)
        for (size_t c = 0; c < nclasses; c++) {
            const float share = votes->values[c * plane + i * step] * (float)j->opts->trees;
            j->wrong_votes += lroundf(share) != table[i * nclasses + c];
        }
    j->votes += n * nclasses;
    j->matrix_pixels += n;
    return SG_OK;
}

static sg_status compare(judging *j, const sg_feature_set *set, const sg_image *photo, const sg_float_map *votes,
                         sg_error *err)
{
    sg_features f;
    SG_TRY(sg_features_create(set, photo, &f, err));
    const size_t plane = f.width * f.height, want = j->opts->matrix / j->opts->images + 1;
    const size_t step = plane > want ? plane / want : 1, n = plane / step + 1;
    float *x = malloc(n * f.nfeatures * sizeof *x);
    uint8_t *classes = malloc(n);
    int32_t *table = malloc(n * votes->channels * sizeof *table);
    const sg_status st = x != NULL && classes != NULL && table != NULL
                             ? judge_theirs(j, &f, votes, step, x, classes, table, err)
                             : SG_FAIL_NOMEM(err);
    free(x);
    free(classes);
    free(table);
    sg_features_clear(&f);
    return st;
}

static sg_status judge_item(judging *j, const sg_dataset *d, size_t item, const sg_feature_set *set, sg_error *err)
{
    sg_image photo;
    sg_float_map votes = {0};
    SG_TRY(sg_photo_read(d->items[item].image, &photo, err));
    sg_status st = judge_ours(j, set, &photo, &votes, err);
    if (st == SG_OK)
        st = compare(j, set, &photo, &votes, err);
    sg_float_map_clear(&votes);
    sg_image_clear(&photo);
    return st;
}

static sg_status judge(const options *o, const sg_cv_forest *theirs, const sg_dataset *test, const sg_feature_set *set,
                       sg_error *err)
{
    sg_forest ours;
    SG_TRY(sg_forest_from_cv(theirs, test->classes.nclasses, &ours, err));
    judging j = {.opts = o, .theirs = theirs, .ours = &ours};
    sg_status st = SG_OK;
    for (size_t i = 0; st == SG_OK && i < test->nitems; i++)
        st = judge_item(&j, test, i, set, err);
    size_t depth = 0;
    for (size_t t = 0; t < ours.ntrees; t++)
        depth = sg_forest_depth(&ours, t) > depth ? sg_forest_depth(&ours, t) : depth;
    const double n = (double)j.pixels;
    printf("%zu nodes, deepest leaf at %zu; %zu photographs, %zu pixels\n", ours.nnodes, depth, test->nitems, j.pixels);
    printf("ours, one thread          features %9.0f/s  forest %9.0f/s  both %9.0f/s\n", n / j.features_s,
           n / j.forest_s, n / (j.features_s + j.forest_s));
    printf("ours, %2d threads, clock                                        both %9.0f/s\n", omp_get_max_threads(),
           n / j.all_s);
    printf("OpenCV, one thread                           forest %9.0f/s  on %zu of the pixels, gathered\n",
           (double)j.matrix_pixels / j.theirs_s, j.matrix_pixels);
    printf("votes other than OpenCV's: %zu of %zu\n", j.wrong_votes, j.votes);
    sg_forest_clear(&ours);
    if (st == SG_OK && j.wrong_votes > 0)
        return SG_FAIL(err, SG_ENUMERIC, "the table is not OpenCV's forest");
    return st;
}

static sg_status run(const options *o, const char *folder, sg_arena *arena, sg_error *err)
{
    const sg_feature_set set = sg_feature_set_of((sg_feature_kind)o->kind, (uint32_t)o->patch);
    sg_dataset_opts opts = SG_DATASET_OPTS_INIT;
    sg_dataset train, test;
    sg_cv_forest *theirs;
    opts.classes_file = o->classes;
    opts.fold = 1;
    opts.need_images = true;
    SG_TRY(sg_dataset_open(folder, &opts, arena, NULL, NULL, &train, err));
    sg_status st = grow(o, &train, &set, arena, &theirs, err);
    sg_dataset_close(&train);
    SG_TRY(st);
    opts.part = SG_SPLIT_TEST;
    opts.max_images = o->images;
    st = sg_dataset_open(folder, &opts, arena, NULL, NULL, &test, err);
    if (st == SG_OK) {
        st = judge(o, theirs, &test, &set, err);
        sg_dataset_close(&test);
    }
    sg_cv_forest_free(theirs);
    return st;
}

int main(int argc, char **argv)
{
    options o = {SG_COMMON_OPTS_INIT, NULL, SG_FEATURES_PATCH, 13, 20, 20, 100000, 4, 50000};
    sg_error err = SG_ERROR_INIT;
    sg_program_begin("bench_forest");
    const int code = sg_program_options(argc, argv, "", LONG_OPTIONS, HELP, &o.common, take_own, &o);
    if (code >= 0)
        return code;
    if (argc - optind != 1)
        return sg_program_usage("expected one data set folder");
    if (o.common.threads > 0)
        omp_set_num_threads(o.common.threads);
    sg_arena *arena = sg_arena_create();
    const sg_status st = arena != NULL ? run(&o, argv[optind], arena, &err) : SG_FAIL_NOMEM(&err);
    sg_arena_free(arena);
    return sg_program_end(st, &err);
}
