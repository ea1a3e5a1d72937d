/* SPDX-License-Identifier: GPL-3.0-or-later */
/* model_statistics.c - counts of models, and tables of them. */
#include "config.h"

#include "scene/model_statistics.h"

#include <math.h>
#include <string.h>

static const struct {
    const char *name;
    size_t offset;
    bool real;
} columns[] = {
#define COUNT(name, field) {name, offsetof(sg_model_statistics, field), false}
    COUNT("symbols", derivation.symbols),
    COUNT("parameters", derivation.parameters),
    COUNT("depth", derivation.depth),
    COUNT("nonterminals", derivation.nonterminals),
    COUNT("terminals", derivation.terminals),
    COUNT("arguments", derivation.arguments),
    COUNT("terminal_arguments", derivation.terminal_arguments),
    COUNT("draws", derivation.draws),
    COUNT("primitives", primitives),
    COUNT("vertices", vertices),
    COUNT("faces", faces),
#undef COUNT
    {"log_prior", offsetof(sg_model_statistics, log_prior), true},
    {"log_density", offsetof(sg_model_statistics, log_density), true},
};

sg_status sg_model_statistics_of(const sg_derivation *d, const sg_scene_opts *scene_opts, const sg_mesh_opts *mesh_opts,
                                 sg_scene *scene, sg_mesh *mesh, sg_model_statistics *out, sg_error *err)
{
    SG_TRY(sg_derivation_statistics_of(d, &out->derivation, err));
    SG_TRY(sg_derivation_log_prior(d, &out->log_prior, err));
    SG_TRY(sg_derivation_log_density(d, &out->log_density, err));
    SG_TRY(sg_scene_interpret(d, scene_opts, scene, err));
    SG_TRY(sg_mesh_from_scene(scene, mesh_opts, mesh, err));
    out->primitives = scene->n;
    out->vertices = mesh->nvertices;
    out->faces = mesh->nfaces;
    return SG_OK;
}

size_t sg_model_statistics_columns(void)
{
    return sizeof columns / sizeof *columns;
}

const char *sg_model_statistics_name(size_t column)
{
    return columns[column].name;
}

double sg_model_statistics_value(const sg_model_statistics *s, size_t column)
{
    const char *at = (const char *)s + columns[column].offset;
    double real;
    size_t count;
    if (columns[column].real) {
        memcpy(&real, at, sizeof real);
        return real;
    }
    memcpy(&count, at, sizeof count);
    return (double)count;
}

sg_model_summary sg_model_statistics_summary(const sg_model_statistics *models, size_t n, size_t column)
{
    sg_model_summary s = {0, INFINITY, -INFINITY};
    for (size_t i = 0; i < n; i++) {
        const double x = sg_model_statistics_value(models + i, column);
        s.mean += x / (double)n;
        s.low = fmin(s.low, x);
        s.high = fmax(s.high, x);
    }
    return s;
}

/* One cell; the first of a line has a width of its own. */
static void put(FILE *out, size_t column, double x, bool aligned)
{
    char text[64];
    const int width = (int)strlen(columns[column].name);
    snprintf(text, sizeof text, x == floor(x) && fabs(x) < 1e15 ? "%.0f" : aligned ? "%.2f" : "%.9g", x);
    if (aligned)
        fprintf(out, "  %*s", width < 8 ? 8 : width, text);
    else
        fprintf(out, "\t%s", text);
}

static void put_line(FILE *out, const char *name, int width, const sg_model_statistics *s, bool aligned)
{
    fprintf(out, "%-*s", aligned ? width : 0, name);
    for (size_t c = 0; c < sg_model_statistics_columns(); c++)
        put(out, c, sg_model_statistics_value(s, c), aligned);
    fputc('\n', out);
}

static void put_summary(FILE *out, const char *name, int width, const sg_model_statistics *models, size_t n, int which,
                        bool aligned)
{
    fprintf(out, "%-*s", aligned ? width : 0, name);
    for (size_t c = 0; c < sg_model_statistics_columns(); c++) {
        const sg_model_summary s = sg_model_statistics_summary(models, n, c);
        put(out, c, which == 0 ? s.mean : which == 1 ? s.low : s.high, aligned);
    }
    fputc('\n', out);
}

sg_status sg_model_statistics_write(const sg_model_statistics *models, const char *const *names, size_t n, bool aligned,
                                    FILE *out, sg_error *err)
{
    static const char *const summaries[] = {"mean", "min", "max"};
    int width = 4;
    for (size_t i = 0; i < n; i++)
        width = (int)strlen(names[i]) > width ? (int)strlen(names[i]) : width;
    fprintf(out, "%-*s", aligned ? width : 0, "name");
    for (size_t c = 0; c < sg_model_statistics_columns(); c++)
        fprintf(out, aligned ? "  %8s" : "\t%s", columns[c].name);
    fputc('\n', out);
    for (size_t i = 0; i < n; i++)
        put_line(out, names[i], width, models + i, aligned);
    for (int which = 0; n > 0 && which < 3; which++)
        put_summary(out, summaries[which], width, models, n, which, aligned);
    return ferror(out) ? SG_FAIL(err, SG_EIO, "writing a table failed") : SG_OK;
}
