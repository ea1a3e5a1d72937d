/* SPDX-License-Identifier: GPL-3.0-or-later */
/* learn_report.c - the report folder: pictures, then the page. */
#include "config.h"

#include "learn/learn_output.h"

#include "core/file.h"
#include "core/random.h"
#include "image/png_io.h"
#include "parse/lattice_draw.h"
#include "scene/label_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 12, MAX_NODES = 100000, MAX_SIDE_PX = 4096 };

typedef struct {
    const char *folder;
    const sg_learn_input *in;
    const sg_learn_result *result;
    sg_arena *arena;
    uint64_t seed;
    sg_report_picture *lattices, *samples;
    size_t nsamples;
} work;

static sg_status save_map(const work *w, const char *file, const sg_label_map *map, const uint32_t *colors, size_t n,
                          sg_error *err)
{
    const char *path = sg_arena_printf(w->arena, "%s/%s", w->folder, file);
    if (path == NULL)
        return SG_FAIL_NOMEM(err);
    return sg_png_write_labels(path, map, colors, n, err);
}

/* Boundaries of a picture that is at most MAX_SIDE_PX wide or high, or has a pixel a cell. */
static void shrink(uint32_t *boundary, size_t ncells)
{
    const double scale = (double)MAX_SIDE_PX / (double)(boundary[ncells] - boundary[0]);
    for (size_t i = ncells + 1; i-- > 0 && scale < 1;)
        boundary[i] = (uint32_t)((double)(boundary[i] - boundary[0]) * scale);
    for (size_t i = 1; i <= ncells; i++)
        boundary[i] = boundary[i] > boundary[i - 1] ? boundary[i] : boundary[i - 1] + 1;
}

static sg_status draw_lattice(work *w, size_t i, sg_error *err)
{
    sg_lattice small = w->in->lattices[i];
    const sg_lattice *l = &small;
    small.x = sg_arena_copy(w->arena, l->x, (l->width + 1) * sizeof *l->x);
    small.y = sg_arena_copy(w->arena, l->y, (l->height + 1) * sizeof *l->y);
    if (small.x == NULL || small.y == NULL)
        return SG_FAIL_NOMEM(err);
    shrink(small.x, l->width);
    shrink(small.y, l->height);
    uint8_t *value = SG_NEW_ARRAY(w->arena, uint8_t, l->nlabels + 1);
    const char *file = sg_arena_printf(w->arena, "lattices/%s.png", w->in->names[i]);
    if (value == NULL || file == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t k = 0; k < l->nlabels; k++)
        for (size_t t = 0; t < w->in->nterminals && t < 256; t++)
            if (strcmp(l->label_names[k], w->in->terminal_names[t]) == 0)
                value[k] = (uint8_t)t;
    sg_label_map map;
    SG_TRY(sg_lattice_paint(l, value, &map, err));
    const size_t n = w->in->nterminals < 256 ? w->in->nterminals : 256;
    const sg_status st = save_map(w, file, &map, w->in->terminal_colors, n, err);
    sg_label_map_clear(&map);
    w->lattices[i] = (sg_report_picture){file, w->in->names[i]};
    return st;
}

/* Palette index of each label of the grammar, and the colours. @return how many */
static size_t number_labels(const sg_grammar *g, uint8_t *value, uint32_t *colors)
{
    size_t n = 0;
    for (sg_sym s = 0; s < sg_grammar_symbol_count(g); s++) {
        const sg_symbol *symbol = sg_grammar_symbol(g, s);
        if (symbol->kind != SG_SYMBOL_LABEL || n >= 256)
            continue;
        value[s] = (uint8_t)n;
        colors[n++] = symbol->color;
    }
    return n;
}

static void mean_size(const sg_learn_input *in, size_t *width, size_t *height)
{
    double w = 0, h = 0;
    for (size_t i = 0; i < in->n; i++) {
        const sg_lattice *l = &in->lattices[i];
        w += (double)(l->x[l->width] - l->x[0]) / (double)in->n;
        h += (double)(l->y[l->height] - l->y[0]) / (double)in->n;
    }
    /* lattices without boundaries have unit cells: a picture of 20 px would show nothing */
    const double side = fmax(w, h), scale = side > MAX_SIDE_PX ? MAX_SIDE_PX / side : fmax(1, ceil(300 / side));
    *width = (size_t)fmax(1, w * scale + 0.5);
    *height = (size_t)fmax(1, h * scale + 0.5);
}

typedef struct {
    sg_derivation derivation;
    sg_label_scene scene;
    sg_label_map map;
    gsl_rng *rng;
    uint8_t *value;
    uint32_t colors[256];
    size_t ncolors;
} sampler;

static sg_status draw_sample(work *w, sampler *s, size_t i, sg_error *err)
{
    const char *file = sg_arena_printf(w->arena, "samples/%zu.png", i + 1);
    const char *caption = sg_arena_printf(w->arena, "%zu", i + 1);
    if (file == NULL || caption == NULL)
        return SG_FAIL_NOMEM(err);
    sg_random_stream(s->rng, w->seed, 0, i);
    SG_TRY(sg_derivation_sample(&s->derivation, s->rng, MAX_NODES, err));
    SG_TRY(sg_label_scene_interpret(&s->scene, &s->derivation, (double)s->map.width, (double)s->map.height, err));
    sg_label_scene_raster(&s->scene, s->value, &s->map);
    SG_TRY(save_map(w, file, &s->map, s->colors, s->ncolors, err));
    w->samples[w->nsamples++] = (sg_report_picture){file, caption};
    return SG_OK;
}

static sg_status draw_samples_of(work *w, const sg_grammar *g, sg_error *err)
{
    sampler s;
    size_t width, height;
    memset(&s, 0, sizeof s);
    mean_size(w->in, &width, &height);
    sg_derivation_init(&s.derivation, g);
    s.rng = sg_random_create(w->seed);
    s.value = SG_NEW_ARRAY(w->arena, uint8_t, sg_grammar_symbol_count(g) + 1);
    sg_status st =
        s.rng != NULL && s.value != NULL ? sg_label_map_create(width, height, &s.map, err) : SG_FAIL_NOMEM(err);
    if (st == SG_OK)
        s.ncolors = number_labels(g, s.value, s.colors);
    for (size_t i = 0; i < SAMPLES && st == SG_OK; i++) {
        st = draw_sample(w, &s, i, err);
        if (st == SG_ENUMERIC)
            st = SG_OK; /* one that would be too large is left out */
    }
    sg_label_map_clear(&s.map);
    sg_label_scene_clear(&s.scene);
    sg_derivation_clear(&s.derivation);
    if (s.rng != NULL)
        gsl_rng_free(s.rng);
    return st;
}

static sg_status draw_samples(work *w, sg_error *err)
{
    sg_grammar *g;
    SG_TRY(sg_grammar_from_split(&w->result->finished, &g, err));
    const sg_status st = draw_samples_of(w, g, err);
    sg_grammar_free(g);
    return st;
}

/* ---- the page ---- */

static const char *step_name(const sg_search_step *s, sg_arena *arena)
{
    switch (s->kind) {
    case SG_STEP_MERGE:
        return sg_arena_printf(arena, "merge %s %s", s->first, s->second);
    case SG_STEP_CHUNK:
        return sg_arena_printf(arena, "chunk %s", s->first);
    case SG_STEP_START:
    default:
        return "initial grammar";
    }
}

static sg_report_step *list_steps(const sg_learn_result *r, sg_arena *arena)
{
    const size_t lexical = sg_split_form_sizes(&r->merged).rules_lexical;
    sg_report_step *steps = SG_NEW_ARRAY(arena, sg_report_step, r->history.n + 1);
    for (size_t i = 0; steps != NULL && i < r->history.n; i++) {
        const sg_search_step *s = &r->history.steps[i];
        const char *what = step_name(s, arena);
        if (what == NULL)
            return NULL;
        steps[i] = (sg_report_step){what, s->energy, s->nonterminals, s->rules_x, s->rules_y, lexical};
    }
    return steps;
}

static size_t list_results(const work *w, double seconds, sg_report_line *lines)
{
    const sg_learn_result *r = w->result;
    sg_arena *a = w->arena;
    size_t n = 0;
    lines[n++] = (sg_report_line){"lattices", sg_arena_printf(a, "%zu", w->in->n)};
    lines[n++] = (sg_report_line){"cells a lattice", sg_arena_printf(a, "%.0f", w->in->cells)};
    if (!isnan(w->in->accuracy))
        lines[n++] = (sg_report_line){"pixels that the lattices show right",
                                      sg_arena_printf(a, "%.2f %%", 100 * w->in->accuracy)};
    lines[n++] =
        (sg_report_line){"energy of the initial grammar", sg_arena_printf(a, "%.3f", r->initial_energy.energy)};
    lines[n++] = (sg_report_line){"energy of the merged grammar", sg_arena_printf(a, "%.3f", r->energy.energy)};
    lines[n++] =
        (sg_report_line){"the same before the last re-estimation", sg_arena_printf(a, "%.3f", r->searched_energy)};
    lines[n++] = (sg_report_line){"log likelihood", sg_arena_printf(a, "%.3f", r->energy.log_likelihood)};
    lines[n++] = (sg_report_line){"log structure prior", sg_arena_printf(a, "%.3f", r->energy.log_structure_prior)};
    lines[n++] = (sg_report_line){"merges", sg_arena_printf(a, "%zu", r->history.merges)};
    lines[n++] = (sg_report_line){"chunks", sg_arena_printf(a, "%zu", r->history.chunks)};
    lines[n++] = (sg_report_line){"lattices parsed", sg_arena_printf(a, "%zu", r->parsed)};
    lines[n++] = (sg_report_line){"seconds", sg_arena_printf(a, "%.2f", seconds)};
    return n;
}

static sg_status write_page(work *w, const sg_report_line *settings, size_t nsettings, double seconds, sg_error *err)
{
    sg_report_line results[16];
    const size_t nresults = list_results(w, seconds, results);
    const sg_report_step *steps = list_steps(w->result, w->arena);
    for (size_t i = 0; i < nresults; i++)
        if (results[i].value == NULL)
            return SG_FAIL_NOMEM(err);
    if (steps == NULL)
        return SG_FAIL_NOMEM(err);
    const sg_report page = {.title = "A grammar learned by model merging",
                            .settings = settings,
                            .nsettings = nsettings,
                            .results = results,
                            .nresults = nresults,
                            .steps = steps,
                            .nsteps = w->result->history.n,
                            .initial = &w->result->initial,
                            .merged = &w->result->merged,
                            .finished = &w->result->finished,
                            .lattices = w->lattices,
                            .nlattices = w->in->n,
                            .samples = w->samples,
                            .nsamples = w->nsamples};
    return sg_report_write(w->folder, &page, err);
}

static sg_status write_all(work *w, const sg_report_line *settings, size_t nsettings, double seconds, sg_error *err)
{
    const char *lattices = sg_arena_printf(w->arena, "%s/lattices", w->folder);
    const char *samples = sg_arena_printf(w->arena, "%s/samples", w->folder);
    w->lattices = SG_NEW_ARRAY(w->arena, sg_report_picture, w->in->n + 1);
    w->samples = SG_NEW_ARRAY(w->arena, sg_report_picture, SAMPLES);
    if (lattices == NULL || samples == NULL || w->lattices == NULL || w->samples == NULL)
        return SG_FAIL_NOMEM(err);
    SG_TRY(sg_folder_create(lattices, err));
    SG_TRY(sg_folder_create(samples, err));
    for (size_t i = 0; i < w->in->n; i++)
        SG_TRY(draw_lattice(w, i, err));
    SG_TRY(draw_samples(w, err));
    return write_page(w, settings, nsettings, seconds, err);
}

sg_status sg_learn_write_report(const char *folder, const sg_learn_input *in, const sg_learn_result *r,
                                const sg_report_line *settings, size_t nsettings, uint64_t seed, double seconds,
                                sg_error *err)
{
    work w = {.folder = folder, .in = in, .result = r, .arena = sg_arena_create(), .seed = seed};
    const sg_status st = w.arena != NULL ? write_all(&w, settings, nsettings, seconds, err) : SG_FAIL_NOMEM(err);
    sg_arena_free(w.arena);
    return st;
}
