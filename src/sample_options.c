/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sample_options.c - the command line of sample-grammar, and what is written when nothing is said. */
#include "config.h"

#include "sample_options.h"

#include "image/image.h"

#include <stdlib.h>
#include <string.h>

static const char help[] =
    "Example: sample-grammar haussmann.sg -n 16 -o facades --sheet 4x4\n\n"
    "Usage: sample-grammar GRAMMAR -n N -o DIR [OPTION]...\n"
    "Sample models from a grammar (*.sg, or its JSON form), or show stored ones.\n\n"
    "  -n N               number of samples (default 1)\n"
    "  --from FILE        do not sample: the derivations in FILE (NAME.sgd or NAME.json)\n"
    "  -o DIR             folder for the results; it is made when it is not there\n"
    "  --size WxH         size of a picture in pixels (default 300x400, of models in space 600x600)\n"
    "  --formats LIST     what to write (default: labels to sheet; of models in space obj,render,sheet):\n"
    "    labels  NAME.png, a label map, classes.tsv    sheet       sheet.png, first samples on a page\n"
    "    rgb     NAME.rgb.png, the labels' colours     derivation  NAME.sgd, as it is stored\n"
    "    svg     NAME.svg                              obj         NAME.obj and NAME.mtl, in space\n"
    "    lat     NAME.lat, the lattice of all cuts     render      NAME.render.png, in space\n"
    "    json    NAME.json, the derivation             tree        NAME.tree.svg and .png, drawn\n"
    "    gltf    NAME.glb, the same as binary glTF\n"
    "  --scope XxYxZ      size of the first scope of models in space (default 1x1x1)\n"
    "  --detail N         level of detail of models in space: 0 the finest (default) to 15\n"
    "  --view AZ,EL       where the camera stands: degrees right of the front and up (default 35,18)\n"
    "  --projection P     perspective (default) or orthographic\n"
    "  --sheet CxR        columns and rows of the sheet (default 4x4)\n"
    "  --tree             the format tree; --tree-nodes N, --tree-depth N: how much of it (150, all)\n"
    "  --given NODE=VALUE leave this draw or choice not to chance, as A.h=3 or A=2; repeatable\n"
    "  --stats            print how large samples are; --table FILE: as a table with tabs\n"
    "  --dataset          write a data set: labels/NAME.png and classes.tsv; rgb goes to\n"
    "                     images/NAME.png, and only labels are written by default\n"
    "  --name PREFIX      NAME is PREFIX-0001 and so on (default: the grammar's name)\n"
    "  --max-nodes N      a derivation with more nodes is an error (default 1000000)\n" SG_COMMON_HELP;

enum { MAX_SAMPLES = 1000000 };

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

/* N numbers with a separator between; "0x1" is no hexadecimal one but two, 0 and 1. */
static bool parse_numbers(const char *arg, char separator, size_t n, double low, double high, double *out)
{
    for (size_t i = 0; i < n; i++) {
        char word[64], *end;
        const size_t length = strcspn(arg, (const char[]){separator, '\0'});
        if (length == 0 || length >= sizeof word || strspn(arg, "0123456789+-.eE") < length)
            return false;
        memcpy(word, arg, length);
        word[length] = '\0';
        out[i] = strtod(word, &end) + 0.0; /* -0 becomes 0 */
        if (*end != '\0' || !(out[i] >= low && out[i] <= high) || arg[length] != (i + 1 < n ? separator : '\0'))
            return false;
        arg += length + 1;
    }
    return true;
}

static bool parse_scope(const char *arg, double *size)
{
    if (parse_numbers(arg, 'x', 3, 0, 1e9, size))
        return true;
    sg_program_usage("--scope: '%s' is no size of three numbers from 0 to 1e9, as in 10x8.5x0", arg);
    return false;
}

static bool parse_view(const char *arg, sg_view *view)
{
    double angles[2];
    if (parse_numbers(arg, ',', 2, -360, 360, angles) && angles[1] >= -90 && angles[1] <= 90) {
        view->azimuth = angles[0];
        view->elevation = angles[1];
        return true;
    }
    sg_program_usage("--view: '%s' is no azimuth from -360 to 360 and elevation from -90 to 90, as in 35,18", arg);
    return false;
}

static bool parse_projection(const char *arg, sg_view *view)
{
    static const char *const names[] = {"perspective", "orthographic", NULL};
    int which;
    if (!sg_program_choice("--projection", arg, names, &which))
        return false;
    view->projection = which == 0 ? SG_PROJECTION_PERSPECTIVE : SG_PROJECTION_ORTHOGRAPHIC;
    return true;
}

static bool parse_formats(const char *arg, unsigned *formats)
{
    static const char *const names[] = {"labels", "rgb", "svg", "lat", "json", "sheet", "obj", "derivation",
                                        "render", "tree", "gltf", "all", NULL};
    if (!sg_program_choices("--formats", arg, names, formats))
        return false;
    const unsigned all = 1U << 11; /* its place among the names */
    if (*formats & all)
        *formats = (*formats & ~all) | SAMPLE_ALL_LABELS;
    return true;
}

enum { OPT_SIZE = SG_OPT_OWN, OPT_FORMATS, OPT_SHEET, OPT_DATASET, OPT_NAME, OPT_MAX_NODES, OPT_SCOPE, OPT_DETAIL,
       OPT_FROM, OPT_VIEW, OPT_PROJECTION, OPT_TREE, OPT_TREE_NODES, OPT_TREE_DEPTH, OPT_GIVEN, OPT_STATS, OPT_TABLE };

/* Options about drawn trees, pins and statistics. */
static bool take_option_of_trees(int opt, const char *arg, sample_options *o)
{
    switch (opt) {
    case OPT_TREE:
        o->formats |= SAMPLE_TREE;
        return true;
    case OPT_TREE_NODES:
        return sg_program_size("--tree-nodes", arg, 1, 100000, &o->tree.max_marks);
    case OPT_TREE_DEPTH:
        return sg_program_size("--tree-depth", arg, 0, UINT32_MAX, &o->tree.max_depth);
    case OPT_STATS:
        o->stats = true;
        return true;
    case OPT_TABLE:
        o->table = arg;
        return true;
    default:
        if (o->ngiven == SAMPLE_MAX_GIVEN)
            return sg_program_usage("--given: more than %d of them", SAMPLE_MAX_GIVEN), false;
        o->given[o->ngiven++] = arg;
        return true;
    }
}

static bool take_option(int opt, const char *arg, void *user)
{
    sample_options *o = user;
    switch (opt) {
    case 'n':
        return sg_program_size("-n", arg, 1, MAX_SAMPLES, &o->n);
    case 'o':
        o->folder = arg;
        return true;
    case OPT_SIZE:
        return parse_pair("--size", arg, SG_IMAGE_MAX_SIDE, &o->width, &o->height);
    case OPT_FORMATS: {
        const unsigned tree = o->formats & SAMPLE_TREE; /* of --tree */
        const bool good = parse_formats(arg, &o->formats);
        o->formats |= tree;
        return good;
    }
    case OPT_SHEET:
        return parse_pair("--sheet", arg, 1000, &o->columns, &o->rows);
    case OPT_SCOPE:
        return parse_scope(arg, o->scope);
    case OPT_DETAIL:
        return sg_program_size("--detail", arg, 0, 15, &o->detail);
    case OPT_TREE:
    case OPT_TREE_NODES:
    case OPT_TREE_DEPTH:
    case OPT_GIVEN:
    case OPT_STATS:
    case OPT_TABLE:
        return take_option_of_trees(opt, arg, o);
    case OPT_VIEW:
        return parse_view(arg, &o->view);
    case OPT_PROJECTION:
        return parse_projection(arg, &o->view);
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

static bool is_stdout(const char *path)
{
    return path != NULL && strcmp(path, "-") == 0;
}

int sample_parse_options(int argc, char **argv, sample_options *o)
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
                                          {"view", required_argument, NULL, OPT_VIEW},
                                          {"projection", required_argument, NULL, OPT_PROJECTION},
                                          {"from", required_argument, NULL, OPT_FROM},
                                          {"tree", no_argument, NULL, OPT_TREE},
                                          {"tree-nodes", required_argument, NULL, OPT_TREE_NODES},
                                          {"tree-depth", required_argument, NULL, OPT_TREE_DEPTH},
                                          {"given", required_argument, NULL, OPT_GIVEN},
                                          {"stats", no_argument, NULL, OPT_STATS},
                                          {"table", required_argument, NULL, OPT_TABLE},
                                          {NULL, 0, NULL, 0}};
    const int end = sg_program_options(argc, argv, "n:o:", longs, help, &o->common, take_option, o);
    if (end >= 0)
        return end;
    if (argc - optind != 1)
        return sg_program_usage("one grammar file is wanted, not %d", argc - optind);
    if (o->folder == NULL && (!sample_counts(o) || o->formats != 0 || o->dataset))
        return sg_program_usage("-o DIR is missing");
    if (sample_counts(o) && is_stdout(o->common.json) + is_stdout(o->table) + o->stats > 1)
        return sg_program_usage("--stats, --table - and --json - exclude each other on standard output");
    if (o->from != NULL && o->ngiven > 0)
        return sg_program_usage("--given and --from: nothing is drawn");
    if (o->from != NULL && o->n > 0)
        return sg_program_usage("-n and --from: a file holds as many derivations as it holds");
    o->n = o->n > 0 ? o->n : 1;
    o->grammar = argv[optind];
    if (o->width * o->height > SG_IMAGE_MAX_PIXELS)
        return sg_program_usage("--size: %zux%zu is more than %u pixels", o->width, o->height, SG_IMAGE_MAX_PIXELS);
    return -1;
}

static bool is_op_in_space(const sg_op *op)
{
    return op->kind == SG_OP_SHAPE || op->kind == SG_OP_PUSH ||
           ((op->kind == SG_OP_SPLIT || op->kind == SG_OP_REPEAT) && op->axis == SG_AXIS_Z);
}

/* Does it do what no label scene can: move, turn, make solids, cut along z? Without any label it makes none either. */
static bool is_in_space(const sg_grammar *g)
{
    bool labels = false;
    for (sg_sym s = 0; s < sg_grammar_symbol_count(g); s++)
        labels = labels || sg_grammar_symbol(g, s)->kind == SG_SYMBOL_LABEL;
    for (sg_rule_id r = 0; r < sg_grammar_rule_count(g); r++) {
        const sg_rule *rule = sg_grammar_rule(g, r);
        for (uint32_t i = 0; i < rule->nops; i++)
            if (is_op_in_space(rule->ops + i))
                return true;
    }
    return !labels;
}

void sample_settle(sample_options *o, const sg_grammar *g)
{
    o->in_space = !o->dataset && is_in_space(g);
    if (o->formats == 0 && (o->dataset || !sample_counts(o)))
        o->formats = o->dataset    ? SAMPLE_LABELS
                     : o->in_space ? SAMPLE_OBJ | SAMPLE_RENDER | SAMPLE_SHEET
                                   : SAMPLE_ALL_LABELS;
    if (o->width == 0) {
        o->width = o->in_space ? 600 : 300;
        o->height = o->in_space ? 600 : 400;
    }
}
