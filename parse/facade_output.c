/* SPDX-License-Identifier: GPL-3.0-or-later */
/* facade_output.c - label map, overlay, derivation and trace of a parsed photograph. */
#include "config.h"

#include "core/file.h"
#include "image/png_io.h"
#include "parse/facade_output_priv.h"
#include "scene/derivation_json.h"
#include "scene/overlay.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const struct {
    const char *name, *ending;
} FORMATS[SG_FACADE_FORMATS] = {{"labels", ".png"},
                                {"overlay", ".overlay.png"},
                                {"derivation", ".json"},
                                {"trace", ".trace.tsv"},
                                {"marginals", ".marginals.npy"},
                                {"lines", ".lines.tsv"},
                                {"uncertainty", ".uncertainty.png"}};

const char *sg_facade_format_name(int format)
{
    return FORMATS[format].name;
}

const char *sg_facade_format_ending(int format)
{
    return FORMATS[format].ending;
}

sg_status sg_facade_path(const sg_facade_report *r, sg_facade_format format, char path[SG_FACADE_PATH], sg_error *err)
{
    int k = 0;
    while (1 << k != (int)format)
        k++;
    const int n = snprintf(path, SG_FACADE_PATH, "%s/%s%s", r->folder, r->name, FORMATS[k].ending);
    return n > 0 && n < SG_FACADE_PATH ? SG_OK : SG_FAIL(err, SG_EIO, "%.200s...: the path is too long", path);
}

/* ---- label maps ---- */

static sg_status raster(const sg_facade_report *r, const uint8_t *value_of, sg_label_map *map, sg_error *err)
{
    sg_label_scene scene = {0};
    const sg_derivation *d = &r->parse->results[r->stage].derivation;
    sg_status st = sg_label_scene_interpret(&scene, d, (double)r->width, (double)r->height, err);
    if (st == SG_OK)
        st = sg_label_map_create(r->width, r->height, map, err);
    if (st == SG_OK)
        sg_label_scene_raster(&scene, value_of, map);
    sg_label_scene_clear(&scene);
    return st;
}

/* With channels or with the class table's pixel values. */
sg_status sg_facade_raster(const sg_facade_report *r, bool channels, sg_label_map *map, sg_error *err)
{
    const size_t n = sg_grammar_symbol_count(r->g);
    uint8_t *value_of = calloc(n, 1);
    if (value_of == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t s = 0; s < n; s++)
        if (r->channel[s] != UINT32_MAX)
            value_of[s] = channels ? (uint8_t)r->channel[s] : r->classes->first_index[r->channel[s]];
    const sg_status st = raster(r, value_of, map, err);
    free(value_of);
    return st;
}

sg_status sg_facade_label_map(const sg_facade_report *r, sg_label_map *map, sg_error *err)
{
    return sg_facade_raster(r, false, map, err);
}

static sg_status write_labels(const sg_facade_report *r, const sg_label_map *map, sg_error *err)
{
    char path[SG_FACADE_PATH];
    SG_TRY(sg_facade_path(r, SG_FACADE_LABELS, path, err));
    return sg_png_write_labels(path, map, r->classes->index_colors, 256, err);
}

static sg_status write_overlay(const sg_facade_report *r, const sg_label_map *map, sg_error *err)
{
    char path[SG_FACADE_PATH];
    sg_image im;
    SG_TRY(sg_facade_path(r, SG_FACADE_OVERLAY, path, err));
    SG_TRY(sg_overlay_labels(r->photo, map, r->classes->index_colors, 256, &im, err));
    const sg_status st = sg_png_write_rgb(path, &im, err);
    sg_image_clear(&im);
    return st;
}

/* ---- derivation ---- */

/* The derivation's text begins with the brace of its root; the energies go in behind that. */
static void print_root(const sg_facade_report *r, const char *text, FILE *out)
{
    const sg_energy *e = &r->parse->results[r->stage].energy;
    fprintf(out,
            "{\"method\":\"%s\",\"energy\":%.17g,\"energy_image\":%.17g,\"energy_rule\":%.17g,\"energy_attribute\":%.17g,"
            "\"width\":%zu,\"height\":%zu,%s\n",
            sg_facade_stage_name(r->stage), sg_energy_sum(e), e->image, e->rule, e->attribute, r->width, r->height,
            text + 1);
}

static sg_status derivation_text(const sg_facade_report *r, char **text, sg_error *err)
{
    size_t n = 0;
    FILE *fp = open_memstream(text, &n);
    if (fp == NULL)
        return SG_FAIL_NOMEM(err);
    const sg_derivation *d = &r->parse->results[r->stage].derivation;
    sg_status st = sg_derivation_write_json(d, (double)r->width, (double)r->height, fp, err);
    if (fclose(fp) != 0 || st == SG_EIO)
        st = SG_FAIL_NOMEM(err);
    return st;
}

static sg_status write_derivation(const sg_facade_report *r, sg_error *err)
{
    char path[SG_FACADE_PATH], *text = NULL;
    sg_output out;
    SG_TRY(sg_facade_path(r, SG_FACADE_DERIVATION, path, err));
    sg_status st = derivation_text(r, &text, err);
    if (st == SG_OK)
        st = sg_output_open(&out, path, err);
    if (st == SG_OK) {
        print_root(r, text, out.fp);
        st = sg_output_commit(&out, err);
    }
    free(text);
    return st;
}

/* ---- trace ---- */

static void print_trace_line(const sg_trace_line *l, FILE *out)
{
    fprintf(out, "%u\t%llu\t%.10g\t%.10g\t%.10g\t%.10g\t%.10g\n", (unsigned)l->run, (unsigned long long)l->iteration,
            0 - sg_posterior_log(&l->cold), 0 - l->cold.score.log, 0 - l->cold.log_rules, 0 - l->cold.log_density,
            0 - sg_posterior_log(&l->best));
}

static sg_status write_trace(const sg_facade_report *r, sg_error *err)
{
    char path[SG_FACADE_PATH];
    sg_output out;
    SG_TRY(sg_facade_path(r, SG_FACADE_TRACE, path, err));
    SG_TRY(sg_output_open(&out, path, err));
    fputs("run\titeration\tenergy\tenergy_image\tenergy_rule\tenergy_attribute\tbest\n", out.fp);
    for (size_t i = 0; i < r->parse->search.ntrace; i++)
        print_trace_line(&r->parse->search.trace[i], out.fp);
    return sg_output_commit(&out, err);
}

/* ---- all ---- */

/* What of the formats there is something to make from. */
static unsigned makeable(const sg_facade_report *r, unsigned formats)
{
    if (r->photo == NULL)
        formats &= ~(unsigned)SG_FACADE_OVERLAY;
    if (!r->parse->searched)
        formats &= ~(unsigned)SG_FACADE_TRACE;
    if (r->parse->samples.nsamples == 0)
        formats &= ~(unsigned)(SG_FACADE_MARGINALS | SG_FACADE_LINES | SG_FACADE_UNCERTAINTY);
    return formats;
}

/* They would tell of another parse than the new ones beside them. */
static sg_status remove_old(const sg_facade_report *r, unsigned which, sg_error *err)
{
    char path[SG_FACADE_PATH];
    for (unsigned format = 1; format < SG_FACADE_ALL; format <<= 1) {
        if (!(which & format))
            continue;
        SG_TRY(sg_facade_path(r, (sg_facade_format)format, path, err));
        if (sg_file_exists(path) && unlink(path) != 0)
            return SG_FAIL(err, SG_EIO, "%s: of an earlier parse, and cannot be removed: %s", path, strerror(errno));
    }
    return SG_OK;
}

sg_status sg_facade_write(const sg_facade_report *r, unsigned formats, sg_error *err)
{
    sg_label_map map;
    formats = makeable(r, formats);
    SG_TRY(sg_facade_label_map(r, &map, err));
    sg_status st = SG_OK;
    if (formats & SG_FACADE_LABELS)
        st = write_labels(r, &map, err);
    if (st == SG_OK && (formats & SG_FACADE_OVERLAY))
        st = write_overlay(r, &map, err);
    sg_label_map_clear(&map);
    if (st == SG_OK && (formats & SG_FACADE_DERIVATION))
        st = write_derivation(r, err);
    if (st == SG_OK && (formats & SG_FACADE_TRACE))
        st = write_trace(r, err);
    if (st == SG_OK && r->parse->samples.nsamples > 0)
        st = sg_facade_write_uncertainty(r, formats, err);
    if (st == SG_OK)
        st = remove_old(r, SG_FACADE_OWN & ~formats, err);
    return st;
}
