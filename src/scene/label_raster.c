/* SPDX-License-Identifier: GPL-3.0-or-later */
/* label_raster.c - label scenes as pixels, and the class table that their values are written with. */
#include "scene/label_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

size_t sg_label_scene_pixel(double c, double extent, size_t n)
{
    const double px = extent == (double)n ? c : c / extent * (double)n; /* a scene in pixels is not rounded again */
    const double at = ceil(px - 0.5);
    return !(at > 0) ? 0 : at >= (double)n ? n : (size_t)at;
}

/* The pixels of a rectangle: half open in both directions. Equal boundaries round equally, hence no gaps. */
typedef struct {
    size_t x0, y0, x1, y1;
} pixels;

static pixels pixels_of(const sg_label_scene *s, const sg_label_rect *r, size_t width, size_t height)
{
    return (pixels){sg_label_scene_pixel(r->x0, s->width, width), sg_label_scene_pixel(r->y0, s->height, height),
                    sg_label_scene_pixel(r->x1, s->width, width), sg_label_scene_pixel(r->y1, s->height, height)};
}

void sg_label_scene_raster(const sg_label_scene *scene, const uint8_t *value_of, sg_label_map *map)
{
    for (size_t i = 0; i < scene->nrects; i++) {
        const pixels p = pixels_of(scene, scene->rects + i, map->width, map->height);
        for (size_t y = p.y0; y < p.y1 && p.x1 > p.x0; y++)
            memset(map->labels + y * map->width + p.x0, value_of[scene->rects[i].label], p.x1 - p.x0);
    }
}

void sg_label_scene_paint(const sg_label_scene *scene, const sg_grammar *g, sg_image *im)
{
    for (size_t i = 0; i < scene->nrects; i++) {
        const uint32_t color = sg_grammar_symbol(g, scene->rects[i].label)->color;
        const pixels p = pixels_of(scene, scene->rects + i, im->width, im->height);
        for (size_t y = p.y0; y < p.y1; y++)
            for (size_t x = p.x0; x < p.x1; x++)
                sg_image_set(im, x, y, color);
    }
}

void sg_label_scene_shares(const sg_label_scene *scene, const sg_grammar *g, double *share)
{
    const double area = scene->width * scene->height;
    for (size_t s = 0; s < sg_grammar_symbol_count(g); s++)
        share[s] = 0;
    for (size_t i = 0; i < scene->nrects; i++) {
        const sg_label_rect *r = scene->rects + i;
        share[r->label] += (r->x1 - r->x0) * (r->y1 - r->y0) / area;
    }
}

static size_t list_labels(const sg_grammar *g, const char **names, uint32_t *colors, uint8_t *value_of)
{
    size_t n = 0;
    for (sg_sym s = 0; s < sg_grammar_symbol_count(g); s++) {
        const sg_symbol *symbol = sg_grammar_symbol(g, s);
        value_of[s] = 0;
        if (symbol->kind != SG_SYMBOL_LABEL)
            continue;
        if (n < SG_MAX_CLASSES) {
            names[n] = symbol->name;
            colors[n] = symbol->color;
            value_of[s] = (uint8_t)n;
        }
        n++;
    }
    return n;
}

sg_status sg_label_classes(const sg_grammar *g, sg_classes *classes, uint8_t *value_of, sg_error *err)
{
    const char *names[SG_MAX_CLASSES];
    uint32_t colors[SG_MAX_CLASSES];
    const size_t n = list_labels(g, names, colors, value_of);
    if (n == 0 || n > SG_MAX_CLASSES)
        return SG_FAIL(err, SG_EINPUT, "the grammar has %zu labels: a label map holds 1 to %d", n, SG_MAX_CLASSES);
    const sg_status st = sg_classes_create(n, names, colors, classes, err);
    return st == SG_EINVAL ? SG_EINPUT : st;
}
