/* SPDX-License-Identifier: GPL-3.0-or-later */
/* overlay.c - label maps, outlines and heat over photographs. */
#include "scene/overlay.h"

#include <math.h>

/* Share of the photograph that shows through. */
#define LABELS_PHOTO 0.5
#define HEAT_PHOTO 0.25

static uint32_t color_at(const sg_image *im, size_t i)
{
    const uint8_t *p = im->rgb + 3 * i;
    return (uint32_t)p[0] << 16 | (uint32_t)p[1] << 8 | p[2];
}

static uint32_t mix_channel(uint32_t a, uint32_t b, unsigned shift, double share)
{
    const double x = share * (a >> shift & 255) + (1 - share) * (b >> shift & 255);
    return (uint32_t)lround(x) << shift;
}

static uint32_t mix(uint32_t a, uint32_t b, double share)
{
    return mix_channel(a, b, 16, share) | mix_channel(a, b, 8, share) | mix_channel(a, b, 0, share);
}

static bool at_border(const sg_label_map *m, size_t x, size_t y)
{
    const uint8_t *p = m->labels + y * m->width + x;
    return (x + 1 < m->width && p[1] != p[0]) || (y + 1 < m->height && p[m->width] != p[0]);
}

sg_status sg_overlay_labels(const sg_image *photo, const sg_label_map *map, const uint32_t *colors, size_t ncolors,
                            sg_image *out, sg_error *err)
{
    if (photo->width != map->width || photo->height != map->height)
        return SG_FAIL(err, SG_EINVAL, "a label map of %zux%zu pixels over a photograph of %zux%zu", map->width,
                       map->height, photo->width, photo->height);
    SG_TRY(sg_image_create(photo->width, photo->height, out, err));
    for (size_t y = 0; y < map->height; y++)
        for (size_t x = 0; x < map->width; x++) {
            const size_t i = y * map->width + x, label = map->labels[i];
            const uint32_t seen = color_at(photo, i);
            const uint32_t inside = label < ncolors ? mix(seen, colors[label], LABELS_PHOTO) : seen;
            sg_image_set(out, x, y, at_border(map, x, y) ? 0 : inside);
        }
    return SG_OK;
}

static void outline(const sg_label_scene *scene, const sg_label_rect *r, uint32_t color, sg_image *im)
{
    const size_t x0 = sg_label_scene_pixel(r->x0, scene->width, im->width);
    const size_t x1 = sg_label_scene_pixel(r->x1, scene->width, im->width);
    const size_t y0 = sg_label_scene_pixel(r->y0, scene->height, im->height);
    const size_t y1 = sg_label_scene_pixel(r->y1, scene->height, im->height);
    if (x0 == x1 || y0 == y1)
        return;
    for (size_t y = y0; y < y1 && x1 < im->width; y++)
        sg_image_set(im, x1 - 1, y, color);
    for (size_t x = x0; x < x1 && y1 < im->height; x++)
        sg_image_set(im, x, y1 - 1, color);
}

void sg_overlay_outlines(const sg_label_scene *scene, uint32_t color, sg_image *im)
{
    for (size_t i = 0; i < scene->nrects; i++)
        outline(scene, scene->rects + i, color, im);
}

static uint32_t byte_of(double x)
{
    return (uint32_t)lround(255 * fmin(fmax(x, 0), 1));
}

/* Green (2011), equation 2: start 0, half a rotation, hue 1.4, gamma 1. */
uint32_t sg_overlay_ramp(double value01)
{
    const double v = value01 > 0 ? fmin(value01, 1) : 0;
    const double angle = 2 * M_PI * (1 + 0.5 * v), amplitude = 1.4 * v * (1 - v) / 2;
    const double c = cos(angle), s = sin(angle);
    return byte_of(v + amplitude * (-0.14861 * c + 1.78277 * s)) << 16 |
           byte_of(v + amplitude * (-0.29227 * c - 0.90649 * s)) << 8 | byte_of(v + amplitude * 1.97294 * c);
}

static uint32_t grey(uint32_t color)
{
    const double y = 0.299 * (color >> 16) + 0.587 * (color >> 8 & 255) + 0.114 * (color & 255);
    return 0x010101 * (uint32_t)lround(y);
}

sg_status sg_overlay_heat(const sg_image *photo, const float *value01, sg_image *out, sg_error *err)
{
    uint32_t ramp[256];
    for (size_t k = 0; k < 256; k++)
        ramp[k] = sg_overlay_ramp((double)k / 255);
    SG_TRY(sg_image_create(photo->width, photo->height, out, err));
    for (size_t i = 0; i < photo->width * photo->height; i++) {
        const double v = value01[i] > 0 ? fmin(value01[i], 1) : 0;
        sg_image_set(out, i % photo->width, i / photo->width,
                     mix(grey(color_at(photo, i)), ramp[lround(255 * v)], HEAT_PHOTO));
    }
    return SG_OK;
}
