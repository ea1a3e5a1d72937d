/* SPDX-License-Identifier: GPL-3.0-or-later */
/* import-labels.c - label maps of other projects into a data set of ours. */
#include "config.h"

#include "core/file.h"
#include "data/import.h"
#include "program/program.h"

#include <jansson.h>
#include <string.h>

static const char help[] =
    "Example: import-labels palette base/ --classes cmp.tsv --images base/ -o cmp\n"
    "\n"
    "Usage: import-labels KIND SOURCE -o DATASET [option...]\n"
    "Import label maps into a data set: DATASET/labels/NAME.png and DATASET/classes.tsv.\n"
    "SOURCE is a file, or a folder of which every file with the kind's ending is taken.\n"
    "Bad files are told and left out; then the exit status is 3.\n"
    "\n"
    "KIND is\n"
    "  rgb       PNG in the colours of the class table\n"
    "  palette   grey or palette PNG; the value of class index 0 is --base (default 1)\n"
    "  matrix    text (txt, csv, tsv, dat): whole numbers with blanks or commas between\n"
    "  digits    text: a digit a pixel, nothing between\n"
    "  labelme   JSON of LabelMe: polygons, rectangles, circles, drawn in their order\n"
    "\n"
    "  -o, --output DATASET  the folder to write or to add to\n"
    "  --classes FILE     class table (index, name, #rrggbb; default: DATASET/classes.tsv)\n"
    "  --images DIR       copy the photographs DIR/NAME.jpg (or .png) too; sizes must agree\n"
    "  --suffix TEXT      take TEXT off the ends of names: x_labels.png becomes x\n"
    "  --base N           value of class index 0 in palette, matrix (0) and digits (0);\n"
    "                     lower values are void and become the first 'ignore' index\n"
    "  --tolerance D      rgb: take the nearest colour within D (0 to 442, default 0)\n"
    "  --background NAME  labelme: class of what no shape covers (default ignore)\n" SG_COMMON_HELP;

enum { OPT_CLASSES = SG_OPT_OWN, OPT_IMAGES, OPT_SUFFIX, OPT_BASE, OPT_TOLERANCE, OPT_BACKGROUND };

static const struct option long_options[] = {SG_COMMON_LONG_OPTIONS,
                                             {"output", required_argument, NULL, 'o'},
                                             {"classes", required_argument, NULL, OPT_CLASSES},
                                             {"images", required_argument, NULL, OPT_IMAGES},
                                             {"suffix", required_argument, NULL, OPT_SUFFIX},
                                             {"base", required_argument, NULL, OPT_BASE},
                                             {"tolerance", required_argument, NULL, OPT_TOLERANCE},
                                             {"background", required_argument, NULL, OPT_BACKGROUND},
                                             {NULL, 0, NULL, 0}};

typedef struct {
    sg_common_opts common;
    sg_import_opts import;
    bool base_given;
    json_t *faults; /* for --json; NULL without */
} settings;

static bool take_own_option(int opt, const char *arg, void *user)
{
    settings *s = user;
    size_t base = 0;
    switch (opt) {
    case 'o':
        s->import.dataset = arg;
        return true;
    case OPT_CLASSES:
        s->import.classes_file = arg;
        return true;
    case OPT_IMAGES:
        s->import.images = arg;
        return true;
    case OPT_SUFFIX:
        s->import.suffix = arg;
        return true;
    case OPT_BASE:
        if (!sg_program_size("--base", arg, 0, 255, &base))
            return false;
        s->import.base = (int)base;
        s->base_given = true;
        return true;
    case OPT_TOLERANCE:
        return sg_program_double("--tolerance", arg, 0, 442, &s->import.tolerance);
    case OPT_BACKGROUND:
        s->import.background = arg;
        return true;
    default:
        return false;
    }
}

static bool take_arguments(int argc, char **argv, settings *s)
{
    static const char *const kinds[] = {"rgb", "palette", "matrix", "digits", "labelme", NULL};
    int kind = 0;
    if (argc - optind != 2) {
        sg_program_usage("a kind and a source are needed, and nothing else");
        return false;
    }
    if (!sg_program_choice("KIND", argv[optind], kinds, &kind))
        return false;
    s->import.kind = (sg_import_kind)kind;
    s->import.source = argv[optind + 1];
    if (!s->base_given)
        s->import.base = s->import.kind == SG_IMPORT_PALETTE ? 1 : 0;
    if (s->import.dataset == NULL || s->import.dataset[0] == '\0') {
        sg_program_usage("-o DATASET is needed");
        return false;
    }
    return true;
}

/* -1 when the work can begin, else the exit status. */
static int parse_options(int argc, char **argv, settings *s)
{
    const int end = sg_program_options(argc, argv, "o:", long_options, help, &s->common, take_own_option, s);
    if (end >= 0)
        return end;
    return take_arguments(argc, argv, s) ? -1 : 2;
}

static void take_fault(void *user, const char *sentence)
{
    settings *s = user;
    sg_program_complain("%s", sentence);
    if (s->faults != NULL)
        json_array_append_new(s->faults, json_string(sentence));
}

static sg_status write_json(const settings *s, const sg_import_result *result, sg_error *err)
{
    sg_output out;
    json_t *j = json_pack("{s:I, s:I, s:O}", "files", (json_int_t)result->found, "imported",
                          (json_int_t)result->imported, "faults", s->faults);
    if (j == NULL)
        return SG_FAIL_NOMEM(err);
    sg_status st = sg_output_open(&out, s->common.json, err);
    if (st == SG_OK) {
        json_dumpf(j, out.fp, JSON_INDENT(1));
        fputc('\n', out.fp);
        st = sg_output_commit(&out, err);
    }
    json_decref(j);
    return st;
}

/* The result must replace nothing that is read: neither a file nor one of a folder of them. */
static sg_status spare_inputs(const settings *s, sg_error *err)
{
    const char *json = s->common.json, *slash = json != NULL ? strrchr(json, '/') : NULL;
    const char *const files[] = {s->import.source, s->import.classes_file};
    char folder[4096] = ".";
    SG_TRY(sg_program_spare(json, files, 2, err));
    if (slash != NULL)
        snprintf(folder, sizeof folder, "%.*s/", (int)(slash - json), json);
    if (json != NULL && sg_file_exists(json) && sg_file_same(folder, s->import.source))
        return SG_FAIL(err, SG_EINVAL, "%s: this stands in the folder that is imported; it will not be written over",
                       json);
    return SG_OK;
}

static sg_status import(settings *s, sg_error *err)
{
    sg_import_result result;
    SG_TRY(spare_inputs(s, err));
    sg_progress progress = sg_program_progress(&s->common);
    sg_status st = sg_import_run(&s->import, take_fault, s, &progress, &result, err);
    sg_program_progress_end();
    if (s->common.json != NULL) {
        sg_error inner = SG_ERROR_INIT;
        const sg_status written = write_json(s, &result, &inner);
        if (written != SG_OK && (st == SG_OK || st == SG_EINPUT))
            st = SG_FAIL(err, written, "%s", inner.msg);
    }
    if (st == SG_OK && !s->common.quiet)
        fprintf(stderr, "import-labels: %zu label maps in %s\n", result.imported, s->import.dataset);
    return st;
}

int main(int argc, char **argv)
{
    settings s = {SG_COMMON_OPTS_INIT, SG_IMPORT_OPTS_INIT, false, NULL};
    sg_error err = SG_ERROR_INIT;
    sg_program_begin("import-labels");
    const int done = parse_options(argc, argv, &s);
    if (done >= 0)
        return done;
    s.faults = s.common.json != NULL ? json_array() : NULL;
    const sg_status st = import(&s, &err);
    json_decref(s.faults);
    return sg_program_end(st, &err);
}
