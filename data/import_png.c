/* SPDX-License-Identifier: GPL-3.0-or-later */
/* import_png.c - label maps that are PNG files: in colours, or as values counted from some base. */
#include "config.h"

#include "data/import_priv.h"
#include "image/png_io.h"

#include <stdio.h>

int sg_import_index(const sg_importer *im, long value)
{
    const long index = value - im->opts->base;
    if (index < 0)
        return im->void_index;
    return index <= 255 && im->classes.class_of[index] != SG_CLASS_UNKNOWN ? (int)index : -1;
}

/* ---- colours ---- */

static int squared_distance(uint32_t a, uint32_t b)
{
    int sum = 0;
    for (int shift = 0; shift < 24; shift += 8) {
        const int d = (int)(a >> shift & 255) - (int)(b >> shift & 255);
        sum += d * d;
    }
    return sum;
}

/* Index of the nearest colour within the tolerance, the lowest of equals; -1 when there is none. */
static int nearest_index(const sg_importer *im, uint32_t color)
{
    int best = -1;
    double best_distance = im->opts->tolerance * im->opts->tolerance;
    for (int i = 0; i < 256; i++) {
        if (im->classes.class_of[i] == SG_CLASS_UNKNOWN)
            continue;
        const double d = squared_distance(color, im->classes.index_colors[i]);
        if (best < 0 ? d <= best_distance : d < best_distance) {
            best = i;
            best_distance = d;
        }
    }
    return best;
}

static sg_status convert_colors(const sg_importer *im, const sg_image *from, sg_label_map *to, sg_import_tally *tally,
                                sg_error *err)
{
    uint32_t last = UINT32_MAX; /* runs of one colour are long */
    int index = -1;
    for (size_t i = 0; i < from->width * from->height; i++) {
        const uint8_t *p = from->rgb + 3 * i;
        const uint32_t color = (uint32_t)p[0] << 16 | (uint32_t)p[1] << 8 | p[2];
        if (color != last)
            index = nearest_index(im, color);
        last = color;
        to->labels[i] = (uint8_t)index;
        if (index >= 0)
            continue;
        char text[16];
        snprintf(text, sizeof text, "#%06x", (unsigned)color);
        SG_TRY(sg_import_tally_add(tally, text, i % from->width, i / from->width, err));
    }
    return SG_OK;
}

/* Every reader ends so: the tally becomes the sentence, and the map goes out only when nothing is wrong. */
static sg_status conclude(sg_status st, sg_import_tally *tally, const char *path, const char *noun, sg_label_map *m,
                          sg_label_map *out, sg_error *err)
{
    const sg_status told = sg_import_tally_end(tally, path, noun, "pixel", st == SG_OK ? err : NULL);
    if (st == SG_OK)
        st = told;
    if (st == SG_OK)
        *out = *m;
    else
        sg_label_map_clear(m);
    return st;
}

sg_status sg_import_rgb(const sg_importer *im, const char *path, sg_import_size photo, sg_label_map *out, sg_error *err)
{
    (void)photo;
    sg_image from;
    sg_label_map m = {0, 0, NULL};
    sg_import_tally *tally = sg_import_tally_begin(im->scratch);
    if (tally == NULL)
        return SG_FAIL_NOMEM(err);
    SG_TRY(sg_png_read_rgb(path, &from, err));
    sg_status st = sg_label_map_create(from.width, from.height, &m, err);
    if (st == SG_OK)
        st = convert_colors(im, &from, &m, tally, err);
    sg_image_clear(&from);
    return conclude(st, tally, path, "colour", &m, out, err);
}

/* ---- values ---- */

static sg_status convert_values(const sg_importer *im, sg_label_map *m, sg_import_tally *tally, sg_error *err)
{
    for (size_t i = 0; i < m->width * m->height; i++) {
        const unsigned value = m->labels[i];
        const int index = sg_import_index(im, (long)value);
        m->labels[i] = (uint8_t)index;
        if (index >= 0)
            continue;
        char text[16];
        snprintf(text, sizeof text, "%u", value);
        SG_TRY(sg_import_tally_add(tally, text, i % m->width, i / m->width, err));
    }
    return SG_OK;
}

sg_status sg_import_palette(const sg_importer *im, const char *path, sg_import_size photo, sg_label_map *out,
                            sg_error *err)
{
    (void)photo;
    sg_label_map m;
    sg_import_tally *tally = sg_import_tally_begin(im->scratch);
    if (tally == NULL)
        return SG_FAIL_NOMEM(err);
    SG_TRY(sg_png_read_labels(path, &m, err));
    const sg_status st = convert_values(im, &m, tally, err);
    return conclude(st, tally, path, "label", &m, out, err);
}
