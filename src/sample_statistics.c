/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sample_statistics.c - how large samples are, and tables of that. */
#include "config.h"

#include "sample_job.h"

#include "core/file.h"

#include <stdlib.h>
#include <string.h>

sg_status sample_count(sample_job *j, sample_worker *w, size_t i, sg_error *err)
{
    sg_scene_opts scene = SG_SCENE_OPTS_INIT;
    const sg_mesh_opts mesh = sample_mesh_opts(j);
    memcpy(scene.size, j->opts->scope, sizeof scene.size);
    return sg_model_statistics_of(&w->d, &scene, &mesh, &w->space, &w->mesh, j->models + i, err);
}

size_t sample_done_models(const sample_job *j, sg_model_statistics *models)
{
    size_t n = 0;
    for (size_t i = 0; i < j->n; i++)
        if (j->stats[i].done)
            models[n++] = j->models[i];
    return n;
}

static sg_status print_models(const sample_job *j, bool aligned, FILE *out, sg_error *err)
{
    sg_model_statistics *models = malloc(j->n * sizeof *models);
    const char **names = malloc(j->n * sizeof *names);
    sg_arena *arena = sg_arena_create();
    bool good = models != NULL && names != NULL && arena != NULL;
    size_t n = 0;
    for (size_t i = 0; good && i < j->n; i++)
        if (j->stats[i].done)
            good = (names[n++] = sg_arena_printf(arena, "%s-%04zu", j->name, i + 1)) != NULL;
    sg_status st = good ? SG_OK : SG_FAIL_NOMEM(err);
    if (st == SG_OK)
        st = sg_model_statistics_write(models, names, sample_done_models(j, models), aligned, out, err);
    free(models);
    free(names);
    sg_arena_free(arena);
    return st;
}

sg_status sample_write_statistics(const sample_job *j, sg_error *err)
{
    if (j->opts->stats)
        SG_TRY(print_models(j, true, stdout, err)); /* a failed write shows up at the end */
    if (j->opts->table == NULL)
        return SG_OK;
    sg_output out;
    SG_TRY(sg_output_open(&out, j->opts->table, err));
    return sg_output_end(&out, print_models(j, false, out.fp, err), err);
}
