/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sample-grammar.c - models from a grammar, sampled or stored before: label maps, lattices, derivations, meshes, pictures. */
#include "config.h"

#include "sample_job.h"

#include "core/random.h"
#include "program/program_grammar.h"
#include "scene/derivation_load.h"

#include <omp.h>
#include <stdlib.h>
#include <string.h>

static sg_status note_labels(sample_job *j, sample_worker *w, size_t i, sg_error *err)
{
    j->stats[i].rects = w->scene.nrects;
    sg_label_scene_shares(&w->scene, j->g, w->share);
    for (sg_sym k = 0; k < j->nsymbols; k++)
        if (sg_grammar_symbol(j->g, k)->kind == SG_SYMBOL_LABEL)
            j->share[i * j->classes.nclasses + j->classes.class_of[j->value_of[k]]] += (float)w->share[k];
    if (i < j->nthumbs && !j->opts->in_space) {
        SG_TRY(sg_image_create(j->thumb_width, j->thumb_height, j->thumbs + i, err));
        sg_label_scene_paint(&w->scene, j->g, j->thumbs + i);
    }
    return SG_OK;
}

static sg_status note_sample(sample_job *j, sample_worker *w, size_t i, sg_error *err)
{
    sample_stats *s = j->stats + i;
    s->nodes = w->d.nnodes;
    SG_TRY(sg_derivation_log_prior(&w->d, &s->log_prior, err));
    SG_TRY(sg_derivation_log_density(&w->d, &s->log_density, err));
    s->log_given = w->given != NULL ? sg_pin_run_log_weight(w->given) : 0;
    if (j->models != NULL)
        SG_TRY(sample_count(j, w, i, err));
    if (sample_wants_labels(j->opts))
        SG_TRY(note_labels(j, w, i, err));
    s->done = true;
    return SG_OK;
}

/* Sample i is a pure function of the seed and i. */
static sg_status derive(const sample_job *j, sample_worker *w, size_t i, sg_error *err)
{
    if (j->opts->from == NULL) {
        sg_random_stream(w->rng, j->opts->common.seed, (uint32_t)i, 0);
        return w->given != NULL ? sg_derivation_sample_given(&w->d, w->given, w->rng, j->opts->max_nodes, err)
                                : sg_derivation_sample(&w->d, w->rng, j->opts->max_nodes, err);
    }
    if (j->stored.items[i].nnodes > j->opts->max_nodes)
        return SG_FAIL(err, SG_ENUMERIC, "more than %zu nodes", j->opts->max_nodes);
    return sg_derivation_copy(&w->d, j->stored.items + i, err);
}

static sg_status make_sample(sample_job *j, sample_worker *w, size_t i, sg_error *err)
{
    SG_TRY(derive(j, w, i, err));
    if (sample_wants_labels(j->opts))
        SG_TRY(sg_label_scene_interpret(&w->scene, &w->d, (double)j->opts->width, (double)j->opts->height, err));
    SG_TRY(sample_write(j, w, i, err));
    return note_sample(j, w, i, err);
}

static bool worker_open(const sample_job *j, sample_worker *w)
{
    memset(w, 0, sizeof *w);
    sg_derivation_init(&w->d, j->g);
    w->rng = sg_random_create(1);
    w->arena = sg_arena_create();
    w->share = calloc(j->nsymbols, sizeof *w->share);
    if (j->pins != NULL && sg_pin_run_create(j->pins, &w->given, NULL) != SG_OK)
        return false;
    return w->rng != NULL && w->arena != NULL && w->share != NULL;
}

static void worker_close(sample_job *j, sample_worker *w)
{
    if (w->given != NULL)
#pragma omp critical(sample_pins)
        sample_count_pins(j, w);
    sg_pin_run_free(w->given);
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
static void note_failure(sample_job *j, size_t i, const sg_error *err)
{
#pragma omp critical(sample_failure)
    if (i < j->failed) {
        j->failed = i;
        sg_fail(&j->err, err->code, "sample %zu: %.900s", i + 1, err->msg);
    }
}

static size_t lowest_failure(sample_job *j)
{
    size_t i;
#pragma omp critical(sample_failure)
    i = j->failed;
    return i;
}

static void run_worker(sample_job *j, sg_progress *progress, size_t *ndone)
{
    sample_worker w;
    const bool good = worker_open(j, &w);
#pragma omp for schedule(dynamic, 1)
    for (size_t i = 0; i < j->n; i++) {
        sg_error err = SG_ERROR_INIT;
        if (i > lowest_failure(j) || sg_progress_stopped(progress))
            continue;
        if (!good)
            err.code = SG_FAIL_NOMEM(&err);
        else {
            const sg_status st = make_sample(j, &w, i, &err);
            if (st == SG_STOPPED)
                continue;
            if (st == SG_ENOMEM)
                SG_FAIL_NOMEM(&err);
        }
        if (err.code != SG_OK)
            note_failure(j, i, &err);
#pragma omp critical(sample_progress)
        sg_progress_report(progress, j->opts->from == NULL ? "sampling" : "showing", ++*ndone, j->n);
    }
    worker_close(j, &w);
}

/* Threads that no sample is left for draw pictures. */
static void share_threads(sample_job *j)
{
    const int threads = j->opts->common.threads > 0 ? j->opts->common.threads : omp_get_max_threads();
    j->workers = (size_t)threads < j->n ? threads : (int)j->n;
    j->render_threads = threads / j->workers;
    omp_set_max_active_levels(2);
}

static sg_status sample_all(sample_job *j, sg_error *err)
{
    sg_progress progress = sg_program_progress(&j->opts->common);
    j->progress = &progress;
    size_t ndone = 0;
    share_threads(j);
#pragma omp parallel num_threads(j->workers)
    run_worker(j, &progress, &ndone);
    sg_program_progress_end();
    if (j->failed < j->n) {
        *err = j->err;
        return err->code;
    }
    return sg_progress_stopped(&progress) ? SG_STOPPED : SG_OK;
}

/* Grammars of models in space need not have labels; what then cannot be written is said with the grammar's name. */
static sg_status find_classes(sample_job *j, sg_error *err)
{
    sg_error inner = SG_ERROR_INIT;
    const sg_status st = sg_label_classes(j->g, &j->classes, j->value_of, &inner);
    if (st == SG_OK || st == SG_ENOMEM)
        return st == SG_OK ? st : SG_FAIL_NOMEM(err);
    return SG_FAIL(err, st, "%s: %.800s%s", j->opts->grammar, inner.msg,
                   j->opts->in_space ? "; obj, gltf, render, tree and derivation are formats of models in space" : "");
}

static sg_status job_open(sample_job *j, sg_error *err)
{
    j->nsymbols = sg_grammar_symbol_count(j->g);
    j->failed = j->n;
    const char *name = j->opts->name != NULL ? j->opts->name : sg_grammar_name(j->g);
    snprintf(j->name, sizeof j->name, "%s", name != NULL && name[0] != '\0' ? name : "sample");
    for (char *p = j->name; *p != '\0'; p++)
        if (*p == '/' || (unsigned char)*p <= ' ')
            *p = '_';
    sample_plan_sheet(j);
    j->value_of = calloc(j->nsymbols, 1);
    j->stats = calloc(j->n, sizeof *j->stats);
    j->thumbs = calloc(j->nthumbs + 1, sizeof *j->thumbs);
    if (sample_counts(j->opts))
        j->models = calloc(j->n, sizeof *j->models);
    if (j->value_of == NULL || j->stats == NULL || j->thumbs == NULL || (sample_counts(j->opts) && j->models == NULL))
        return SG_FAIL_NOMEM(err);
    SG_TRY(sample_read_pins(j, err));
    if (sample_wants_labels(j->opts))
        SG_TRY(find_classes(j, err));
    j->share = calloc(j->n * j->classes.nclasses + 1, sizeof *j->share);
    return j->share != NULL ? SG_OK : SG_FAIL_NOMEM(err);
}

static void job_close(sample_job *j)
{
    for (size_t i = 0; j->thumbs != NULL && i < j->nthumbs; i++)
        sg_image_clear(j->thumbs + i);
    sg_derivation_file_clear(&j->stored);
    sg_assets_free(j->assets);
    free(j->thumbs);
    free(j->stats);
    free(j->share);
    free(j->value_of);
    free(j->models);
    free(j->pin_uses);
    sg_pins_free(j->pins);
    sg_classes_clear(&j->classes);
}

static sg_status load_stored(sample_job *j, sg_error *err)
{
    if (j->opts->from == NULL)
        return SG_OK;
    SG_TRY(sg_derivation_load(j->opts->from, j->g, &j->stored, err));
    j->n = j->stored.n;
    return j->n > 0 ? SG_OK : SG_FAIL(err, SG_EINPUT, "%s: it holds no derivation", j->opts->from);
}

static sg_status run(const sample_options *o, const sg_grammar *g, sg_error *err)
{
    sample_job j = {.opts = o, .g = g, .n = o->n};
    sg_status st = sg_program_apart(o->table, &o->common.json, 1, err);
    if (st == SG_OK)
        st = load_stored(&j, err);
    if (st == SG_OK && (sample_wants_space(o) || sample_counts(o)))
        st = sg_assets_load(g, o->grammar, &j.assets, err);
    if (st == SG_OK)
        st = job_open(&j, err);
    if (st == SG_OK && o->common.json != NULL) /* before the work and not behind it */
        st = sample_check_not_input(&j, o->common.json, err);
    if (st == SG_OK && o->table != NULL)
        st = sample_check_not_input(&j, o->table, err);
    if (st == SG_OK)
        st = sample_make_folders(&j, err);
    if (st == SG_OK)
        st = sample_all(&j, err);
    if (st == SG_OK || st == SG_STOPPED) {
        sg_status written = sample_write_sheet(&j, err);
        if (written == SG_OK)
            written = sample_write_report(&j, err);
        if (written == SG_OK)
            written = sample_write_statistics(&j, err);
        sample_warn_of_pins(&j);
        st = written != SG_OK ? written : st;
    }
    job_close(&j);
    return st;
}

int main(int argc, char **argv)
{
    sample_options o = {.common = SG_COMMON_OPTS_INIT,
                        .columns = 4,
                        .rows = 4,
                        .scope = {1, 1, 1},
                        .view = SG_VIEW_INIT,
                        .tree = SG_TREE_PICTURE_OPTS_INIT,
                        .max_nodes = 1000000};
    sg_error err = SG_ERROR_INIT;
    sg_grammar *g = NULL;
    sg_program_begin("sample-grammar");
    const int early = sample_parse_options(argc, argv, &o);
    if (early >= 0)
        return early;
    sg_status st = sg_program_load_grammar(o.grammar, &g, &err);
    if (st == SG_OK) {
        sample_settle(&o, g);
        st = run(&o, g, &err);
    }
    sg_grammar_free(g);
    return sg_program_end(st, &err);
}
