/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sample_report.c - the report of sample-grammar as JSON. */
#include "config.h"

#include "sample_job.h"

#include "core/file.h"
#include "core/random.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>

/* JSON has no infinities. */
static json_t *number(double x)
{
    return isfinite(x) ? json_real(x) : json_null();
}

static json_t *statistics_json(const sg_model_statistics *s)
{
    json_t *statistics = json_object();
    for (size_t c = 0; c < sg_model_statistics_columns(); c++)
        if (json_object_set_new(statistics, sg_model_statistics_name(c), number(sg_model_statistics_value(s, c))) != 0)
            return json_decref(statistics), NULL;
    return statistics;
}

static json_t *sample_json(const sample_job *j, size_t i)
{
    const sample_stats *s = j->stats + i;
    char name[sizeof j->name + 32];
    snprintf(name, sizeof name, "%s-%04zu", j->name, i + 1);
    json_t *areas = json_object();
    for (size_t k = 0; k < j->classes.nclasses; k++)
        if (json_object_set_new(areas, j->classes.names[k], json_real((double)j->share[i * j->classes.nclasses + k])) != 0)
            return json_decref(areas), NULL;
    json_t *sample = json_pack("{s:s, s:I, s:I, s:I, s:o, s:o, s:o}", "name", name, "nodes", (json_int_t)s->nodes, "faces",
                               (json_int_t)s->faces, "rectangles", (json_int_t)s->rects, "log_prior", number(s->log_prior),
                               "log_density", number(s->log_density), "areas", areas);
    if (j->pins != NULL && json_object_set_new(sample, "log_given", number(s->log_given)) != 0)
        return json_decref(sample), NULL;
    if (j->models != NULL && json_object_set_new(sample, "statistics", statistics_json(j->models + i)) != 0)
        return json_decref(sample), NULL;
    return sample;
}

/* Mean and range of each column. */
static json_t *summary_json(const sg_model_statistics *models, size_t n)
{
    json_t *summary = json_object();
    for (size_t c = 0; c < sg_model_statistics_columns(); c++) {
        const sg_model_summary s = sg_model_statistics_summary(models, n, c);
        if (json_object_set_new(summary, sg_model_statistics_name(c),
                                json_pack("{s:o, s:o, s:o}", "mean", number(s.mean), "min", number(s.low), "max",
                                          number(s.high))) != 0)
            return json_decref(summary), NULL;
    }
    return summary;
}

static json_t *plain_report_json(const sample_job *j)
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

static json_t *report_json(const sample_job *j)
{
    json_t *report = plain_report_json(j);
    if (report == NULL || j->models == NULL)
        return report;
    sg_model_statistics *models = malloc(j->n * sizeof *models);
    const size_t n = models != NULL ? sample_done_models(j, models) : 0;
    const bool good = models != NULL && (n == 0 || json_object_set_new(report, "summary", summary_json(models, n)) == 0);
    free(models);
    if (good)
        return report;
    json_decref(report);
    return NULL;
}

sg_status sample_write_report(const sample_job *j, sg_error *err)
{
    if (j->opts->common.json == NULL)
        return SG_OK;
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
