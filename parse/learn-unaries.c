/* SPDX-License-Identifier: GPL-3.0-or-later */
/* learn-unaries.c - annotated photographs to a pixel classifier. */
#include "config.h"

#include "core/array.h"
#include "core/file.h"
#include "grammar/json_text.h"
#include "parse/cv_forest.h"
#include "parse/pixel_classifier_learn.h"
#include "program/program.h"

#include <jansson.h>
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

static const char HELP[] =
    "Example: learn-unaries data/facades --fold 1 -o facades.rf\n"
    "\n"
    "Usage: learn-unaries DATASET -o FILE [OPTION]...\n"
    "Learn from annotated photographs which class each pixel is of: a random forest over features of the photograph, for\n"
    "apply-unaries and parse-facade. With --fold its probabilities are calibrated on the validation part.\n"
    "\n"
    "  -o, --output FILE  the classifier\n"
    "  --features SET     rich (default): colour, texture, surroundings, position; patch: the colours of a square patch\n"
    "  --patch SIDE       of the patch, odd, px (default 13)\n"
    "  --balanced         all classes on an equal footing, however rare\n"
    "  --trees N          (default 20)\n"
    "  --depth N          of the trees, 1 to 25 (default 20)\n"
    "  --min-leaf N       a node of N pixels or fewer is not split (default 5)\n"
    "  --active N         features tried at a node (default: the square root of their number)\n"
    "  --pixels N         that the trees are grown on (default 200000); the leaves see all\n"
    "  --classes FILE     class table in place of DATASET/classes.tsv\n"
    "  --fold K           learn from the training part of fold K\n"
    "  --names FILE       learn from the images named there, one a line\n"
    "  --max-images N     learn from the first N (default: all)\n" SG_COMMON_HELP;

typedef struct {
    sg_common_opts common;
    sg_dataset_opts dataset;
    sg_pixel_learn_opts learn;
    sg_feature_kind features;
    size_t patch; /* 0: not given */
    const char *folder, *output;
} options;

enum {
    OPT_FEATURES = SG_OPT_OWN, OPT_PATCH, OPT_BALANCED, OPT_TREES, OPT_DEPTH, OPT_MIN_LEAF, OPT_ACTIVE, OPT_PIXELS,
    OPT_CLASSES, OPT_FOLD, OPT_NAMES, OPT_MAX_IMAGES
};

static const struct option LONG_OPTIONS[] = {{"output", required_argument, NULL, 'o'},
                                             {"features", required_argument, NULL, OPT_FEATURES},
                                             {"patch", required_argument, NULL, OPT_PATCH},
                                             {"balanced", no_argument, NULL, OPT_BALANCED},
                                             {"trees", required_argument, NULL, OPT_TREES},
                                             {"depth", required_argument, NULL, OPT_DEPTH},
                                             {"min-leaf", required_argument, NULL, OPT_MIN_LEAF},
                                             {"active", required_argument, NULL, OPT_ACTIVE},
                                             {"pixels", required_argument, NULL, OPT_PIXELS},
                                             {"classes", required_argument, NULL, OPT_CLASSES},
                                             {"fold", required_argument, NULL, OPT_FOLD},
                                             {"names", required_argument, NULL, OPT_NAMES},
                                             {"max-images", required_argument, NULL, OPT_MAX_IMAGES},
                                             SG_COMMON_LONG_OPTIONS,
                                             {NULL, 0, NULL, 0}};

static const char *const FEATURES[] = {"patch", "rich", NULL};

static bool take_data_option(int opt, const char *arg, options *o)
{
    size_t n = 0;
    switch (opt) {
    case OPT_CLASSES:
        o->dataset.classes_file = arg;
        return true;
    case OPT_FOLD:
        if (!sg_program_size("--fold", arg, 1, 1000000, &n))
            return false;
        o->dataset.fold = (int)n;
        return true;
    case OPT_NAMES:
        o->dataset.names_file = arg;
        return true;
    default: /* OPT_MAX_IMAGES */
        return sg_program_size("--max-images", arg, 0, 1000000, &o->dataset.max_images);
    }
}

static bool take_own(int opt, const char *arg, void *user)
{
    options *o = user;
    sg_forest_grow_opts *g = &o->learn.grow;
    int i = 0;
    switch (opt) {
    case 'o':
        o->output = arg;
        return true;
    case OPT_FEATURES:
        if (!sg_program_choice("--features", arg, FEATURES, &i))
            return false;
        o->features = (sg_feature_kind)i;
        return true;
    case OPT_PATCH:
        return sg_program_size("--patch", arg, 1, 63, &o->patch);
    case OPT_BALANCED:
        return o->learn.balanced = true;
    case OPT_TREES:
        return sg_program_size("--trees", arg, 1, 100000, &g->trees);
    case OPT_DEPTH:
        return sg_program_size("--depth", arg, 1, SG_CV_MAX_DEPTH, &g->depth);
    case OPT_MIN_LEAF:
        return sg_program_size("--min-leaf", arg, 1, 1000000000, &g->min_leaf);
    case OPT_ACTIVE:
        return sg_program_size("--active", arg, 1, 1000000, &g->active);
    case OPT_PIXELS:
        return sg_program_size("--pixels", arg, 1, 1000000000, &o->learn.pixels);
    default:
        return take_data_option(opt, arg, o);
    }
}

static bool is_stdout(const char *path)
{
    return path != NULL && strcmp(path, "-") == 0;
}

static int check_usage(options *o, int nfolders)
{
    if (nfolders != 1)
        return sg_program_usage("expected one data set folder, found %d", nfolders);
    if (o->output == NULL)
        return sg_program_usage("expected a file for the classifier: -o FILE");
    if (is_stdout(o->output) && is_stdout(o->common.json))
        return sg_program_usage("only one result can go to standard output");
    if (o->common.json != NULL && sg_file_same_place(o->output, o->common.json))
        return sg_program_usage("--output and --json need a file each");
    if (o->dataset.fold != 0 && o->dataset.names_file != NULL)
        return sg_program_usage("--fold and --names do not go together");
    if (o->patch != 0 && o->features != SG_FEATURES_PATCH)
        return sg_program_usage("--patch belongs to --features patch");
    if (o->patch % 2 == 0 && o->patch != 0)
        return sg_program_usage("--patch: %zu is not odd", o->patch);
    o->learn.features = sg_feature_set_of(o->features, o->patch != 0 ? (uint32_t)o->patch : 13);
    const size_t n = sg_feature_set_count(&o->learn.features);
    if (o->learn.grow.active > n)
        return sg_program_usage("--active: %zu of %zu features", o->learn.grow.active, n);
    return -1;
}

/* Exit status to leave with, or -1 to go on. */
static int parse_args(int argc, char **argv, options *o)
{
    const int end = sg_program_options(argc, argv, "o:", LONG_OPTIONS, HELP, &o->common, take_own, o);
    if (end >= 0)
        return end;
    o->folder = argv[optind];
    return check_usage(o, argc - optind);
}

/* ---- data ---- */

typedef struct {
    const options *opts;
    sg_arena *arena;
    sg_dataset train, valid;
    const char **told; /* faults; malloc'd, the sentences are in the arena */
    size_t ntold, told_capacity;
    bool has_result; /* something is written */
} job;

/* Both parts have the class table and the fold: what is wrong with these is told once. */
static void tell_fault(void *user, const char *sentence)
{
    job *j = user;
    for (size_t i = 0; i < j->ntold; i++)
        if (strcmp(j->told[i], sentence) == 0)
            return;
    const char *copy = sg_arena_string(j->arena, sentence);
    if (copy != NULL && SG_GROW(j->told, j->told_capacity, j->ntold + 1))
        j->told[j->ntold++] = copy;
    sg_program_complain("%s", sentence);
}

/* All faults of both parts are told before the call fails. */
static sg_status open_data(job *j, sg_error *err)
{
    const char *folder = j->opts->folder;
    sg_dataset_opts o = j->opts->dataset;
    sg_error inner = SG_ERROR_INIT;
    o.need_images = true;
    const sg_status train = sg_dataset_open(folder, &o, j->arena, tell_fault, j, &j->train, err);
    if (o.fold == 0 || (train != SG_OK && train != SG_EINPUT))
        return train;
    o.part = SG_SPLIT_VALID;
    o.max_images = 0;
    o.may_be_empty = true;
    const sg_status valid = sg_dataset_open(folder, &o, j->arena, tell_fault, j, &j->valid, &inner);
    if (train == SG_OK && valid != SG_OK)
        *err = inner;
    if (j->ntold > 0)
        SG_FAIL(err, SG_EINPUT, "%s: %zu fault%s in the data set", folder, j->ntold, j->ntold == 1 ? "" : "s");
    return train != SG_OK ? train : valid;
}

static sg_status spare_inputs(const job *j, const char *output, sg_error *err)
{
    const options *o = j->opts;
    const char *const tables[] = {o->dataset.classes_file, o->dataset.names_file,
                                  sg_arena_printf(j->arena, "%s/classes.tsv", o->folder),
                                  sg_arena_printf(j->arena, "%s/folds/%d.tsv", o->folder, o->dataset.fold)};
    SG_TRY(sg_program_spare(output, tables, sizeof tables / sizeof tables[0], err));
    const sg_dataset *const sets[] = {&j->train, &j->valid};
    for (size_t k = 0; k < 2; k++)
        for (size_t i = 0; i < sets[k]->nitems; i++) {
            const char *const read[] = {sets[k]->items[i].labels, sets[k]->items[i].image};
            SG_TRY(sg_program_spare(output, read, 2, err));
        }
    return SG_OK;
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

/* ---- report ---- */

/* NaN, of classes that do not occur, is null. */
static json_t *number(double x)
{
    return isfinite(x) ? json_real(x) : json_null();
}

static json_t *score_to_json(const sg_pixel_score *s, const sg_classes *classes)
{
    json_t *out = json_object(), *recall = json_object();
    json_object_set_new(out, "overall", number(s->overall));
    json_object_set_new(out, "class_average", number(s->class_average));
    json_object_set_new(out, "log_loss", number(s->log_loss));
    for (size_t k = 0; k < classes->nclasses; k++)
        json_object_set_new(recall, classes->names[k], number(s->recall[k]));
    json_object_set_new(out, "per_class", recall);
    return out;
}

static json_t *counts_to_json(const uint64_t *counts, const sg_classes *classes)
{
    json_t *out = json_object();
    for (size_t k = 0; k < classes->nclasses; k++)
        json_object_set_new(out, classes->names[k], json_integer((json_int_t)counts[k]));
    return out;
}

static json_t *curve_to_json(const sg_pixel_tradeoff *curve)
{
    json_t *out = json_array();
    for (size_t i = 0; i < SG_PIXEL_EXPONENTS; i++)
        json_array_append_new(out, json_pack("[f, f, f]", curve[i].exponent, curve[i].overall, curve[i].class_average));
    return out;
}

typedef struct {
    uint64_t uses;
    size_t feature;
} feature_use;

static int compare_uses(const void *a, const void *b)
{
    const feature_use *x = a, *y = b;
    if (x->uses != y->uses)
        return x->uses < y->uses ? 1 : -1;
    return x->feature < y->feature ? -1 : x->feature > y->feature;
}

/* The most used first. */
static json_t *uses_to_json(const sg_feature_set *set, const uint64_t *uses, sg_arena *arena)
{
    const size_t n = sg_feature_set_count(set);
    feature_use *order = SG_NEW_ARRAY(arena, feature_use, n + 1);
    json_t *out = json_array();
    for (size_t i = 0; order != NULL && i < n; i++)
        order[i] = (feature_use){uses[i], i};
    if (order != NULL)
        qsort(order, n, sizeof *order, compare_uses);
    for (size_t i = 0; order != NULL && i < n && order[i].uses > 0; i++) {
        char text[128];
        sg_feature_set_describe(set, order[i].feature, text, sizeof text);
        json_array_append_new(out, json_pack("{s:s, s:I}", "feature", text, "nodes", (json_int_t)order[i].uses));
    }
    return out;
}

static json_t *forest_to_json(const job *j, const sg_pixel_classifier_sizes *s)
{
    const sg_pixel_learn_opts *l = &j->opts->learn;
    return json_pack("{s:s, s:I, s:I, s:b, s:I, s:I, s:I, s:I, s:I, s:I, s:I}", "features", FEATURES[l->features.kind],
                     "patch", (json_int_t)l->features.patch, "nfeatures", (json_int_t)s->nfeatures, "balanced",
                     l->balanced, "trees", (json_int_t)s->ntrees, "nodes", (json_int_t)s->nnodes, "leaves",
                     (json_int_t)s->nleaves, "max_depth", (json_int_t)l->grow.depth, "min_leaf",
                     (json_int_t)l->grow.min_leaf, "active", (json_int_t)l->grow.active, "seed",
                     (json_int_t)l->grow.seed);
}

static json_t *to_json(const job *j, const sg_pixel_classifier *c, const sg_pixel_learn_report *r)
{
    const sg_classes *classes = sg_pixel_classifier_classes(c);
    const sg_calibration cal = sg_pixel_classifier_calibration(c);
    const sg_pixel_classifier_sizes sizes = sg_pixel_classifier_sizes_of(c);
    json_t *out = json_object();
    json_object_set_new(out, "forest", forest_to_json(j, &sizes));
    json_object_set_new(out, "train_images", json_integer((json_int_t)r->train_images));
    json_object_set_new(out, "train_pixels", counts_to_json(r->train_pixels, classes));
    json_object_set_new(out, "sample_pixels", counts_to_json(r->sample_pixels, classes));
    json_object_set_new(out, "valid_images", json_integer((json_int_t)r->valid_images));
    json_object_set_new(out, "calibration",
                        json_pack("{s:b, s:f, s:f, s:I}", "fitted", cal.fitted, "temperature", cal.temperature,
                                  "prior_exponent", cal.exponent, "pixels", (json_int_t)r->valid_pixels));
    if (cal.fitted) {
        json_object_set_new(out, "valid_before", score_to_json(&r->valid_before, classes));
        json_object_set_new(out, "valid", score_to_json(&r->valid, classes));
        json_object_set_new(out, "exponent_overall_average", curve_to_json(r->curve));
    }
    json_object_set_new(out, "seconds",
                        json_pack("{s:f, s:f, s:f, s:f}", "sample", r->sample_s, "grow", r->grow_s, "fill", r->fill_s,
                                  "validate", r->valid_s));
    json_object_set_new(out, "uses", uses_to_json(&j->opts->learn.features, r->uses, j->arena));
    return out;
}

static sg_status write_json(const job *j, const sg_pixel_classifier *c, const sg_pixel_learn_report *r, sg_error *err)
{
    json_t *root = to_json(j, c, r);
    sg_output out;
    sg_status st = root != NULL ? sg_output_open(&out, j->opts->common.json, err) : SG_FAIL_NOMEM(err);
    if (st == SG_OK)
        st = sg_output_end(&out, sg_json_write(root, 2, out.fp, err), err);
    json_decref(root);
    return st;
}

static void tell(const sg_pixel_classifier *c, const sg_pixel_learn_report *r)
{
    const sg_calibration cal = sg_pixel_classifier_calibration(c);
    const sg_pixel_classifier_sizes s = sg_pixel_classifier_sizes_of(c);
    sg_program_progress_end();
    fprintf(stderr, "learn-unaries: %zu photographs, %zu features; %zu trees, %zu leaves in %.1f s\n", r->train_images,
            s.nfeatures, s.ntrees, s.nleaves, r->sample_s + r->grow_s + r->fill_s + r->valid_s);
    if (cal.fitted)
        fprintf(stderr,
                "learn-unaries: %zu validation photographs: overall %.2f %%, class average %.2f %%, log loss %.4f"
                " (%.2f, %.2f, %.4f before calibration); temperature %.3f, prior exponent %.3f\n",
                r->valid_images, 100 * r->valid.overall, 100 * r->valid.class_average, r->valid.log_loss,
                100 * r->valid_before.overall, 100 * r->valid_before.class_average, r->valid_before.log_loss,
                cal.temperature, cal.exponent);
    else if (r->valid_images > 0)
        fprintf(stderr, "learn-unaries: not calibrated: it was stopped before\n");
}

/* ---- all of it ---- */

static sg_status write_all(const job *j, const sg_pixel_classifier *c, const sg_pixel_learn_report *r, sg_error *err)
{
    SG_TRY(sg_pixel_classifier_write(j->opts->output, c, err));
    if (!j->opts->common.quiet)
        tell(c, r);
    return j->opts->common.json != NULL ? write_json(j, c, r, err) : SG_OK;
}

static sg_status run(job *j, sg_error *err)
{
    sg_pixel_classifier *c;
    sg_pixel_learn_report r;
    SG_TRY(open_data(j, err));
    SG_TRY(spare_inputs(j, j->opts->output, err));
    SG_TRY(spare_inputs(j, j->opts->common.json, err));
    SG_TRY(try_output(j->opts->output, err));
    SG_TRY(try_output(j->opts->common.json, err));
    sg_status st = sg_pixel_classifier_learn(&j->train, &j->valid, &j->opts->learn, &c, &r, err);
    if (c != NULL) {
        const sg_status written = write_all(j, c, &r, err);
        st = written != SG_OK ? written : st;
        j->has_result = true;
    }
    sg_pixel_classifier_free(c);
    sg_pixel_learn_report_clear(&r);
    return st;
}

int main(int argc, char **argv)
{
    options o = {.common = SG_COMMON_OPTS_INIT, .dataset = SG_DATASET_OPTS_INIT, .learn = SG_PIXEL_LEARN_OPTS_INIT,
                 .features = SG_FEATURES_RICH};
    sg_error err = SG_ERROR_INIT;
    sg_program_begin("learn-unaries");
    const int code = parse_args(argc, argv, &o);
    if (code >= 0)
        return code;
    sg_progress progress = sg_program_progress(&o.common);
    o.learn.grow.progress = &progress;
    o.learn.grow.seed = o.common.seed;
    o.learn.grow.threads = o.common.threads > 0 ? o.common.threads : omp_get_max_threads();
    job j = {.opts = &o, .arena = sg_arena_create()};
    const sg_status st = j.arena != NULL ? run(&j, &err) : SG_FAIL_NOMEM(&err);
    sg_dataset_close(&j.train);
    sg_dataset_close(&j.valid);
    free(j.told);
    sg_arena_free(j.arena);
    if (st == SG_STOPPED && !j.has_result) {
        sg_program_complain("stopped before there was a tree: nothing is written");
        return sg_exit_code(st);
    }
    return sg_program_end(st, &err);
}
