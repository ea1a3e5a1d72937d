/* SPDX-License-Identifier: GPL-3.0-or-later */
/* render_canvas.c - see render_canvas.h. */
#include "config.h"

#include "data/render_canvas.h"

#include "core/random.h"

#include <gsl/gsl_randist.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Width of the first octave in photograph pixels, and octaves, of each kind of noise. */
static const struct {
    double size;
    int octaves;
} noise_kinds[SG_NOISES] = {{0.7, 1}, {9.0, 4}, {70.0, 4}};

static bool add_octave(gsl_rng *rng, size_t width, size_t height, double size_px, double weight, float *plane)
{
    const size_t w = (size_t)ceil((double)width / size_px) + 3, h = (size_t)ceil((double)height / size_px) + 3;
    float *coarse = malloc(w * h * sizeof *coarse), *fine = malloc(width * height * sizeof *fine);
    bool good = coarse != NULL && fine != NULL;
    if (good) {
        for (size_t i = 0; i < w * h; i++)
            coarse[i] = (float)(weight * gsl_ran_ugaussian(rng));
        good = sg_cvdraw_enlarge(coarse, w, h, fine, width, height);
    }
    for (size_t i = 0; good && i < width * height; i++)
        plane[i] += fine[i];
    free(coarse);
    free(fine);
    return good;
}

static void standardise(float *plane, size_t n)
{
    double sum = 0, squares = 0;
    for (size_t i = 0; i < n; i++)
        sum += plane[i];
    const double mean = sum / (double)n;
    for (size_t i = 0; i < n; i++)
        squares += (plane[i] - mean) * (plane[i] - mean);
    const double scale = 1 / sqrt(squares / (double)n + 1e-12);
    for (size_t i = 0; i < n; i++)
        plane[i] = (float)((plane[i] - mean) * scale);
}

bool sg_render_noise(gsl_rng *rng, size_t width, size_t height, double size_px, int octaves, float *plane)
{
    memset(plane, 0, width * height * sizeof *plane);
    double weight = 1;
    for (int i = 0; i < octaves && size_px >= 1; i++) {
        if (!add_octave(rng, width, height, size_px, weight, plane))
            return false;
        size_px /= 2;
        weight /= 1.7;
    }
    standardise(plane, width * height);
    return true;
}

sg_status sg_canvas_create(sg_canvas *c, size_t width, size_t height, double unit, gsl_rng *rng, sg_error *err)
{
    const size_t n = width * height;
    memset(c, 0, sizeof *c);
    c->width = width;
    c->height = height;
    c->unit = unit;
    c->rng = rng;
    c->albedo = calloc(3 * n, sizeof *c->albedo);
    c->glow = calloc(3 * n, sizeof *c->glow);
    c->depth = calloc(n, sizeof *c->depth);
    c->mask = (sg_mask){width, height, calloc(n, 1)};
    bool good = c->albedo != NULL && c->glow != NULL && c->depth != NULL && c->mask.cover != NULL;
    for (int k = 0; good && k < SG_NOISES; k++) {
        c->noise[k] = malloc(n * sizeof *c->noise[k]);
        good = c->noise[k] != NULL &&
               sg_render_noise(rng, width, height, noise_kinds[k].size * unit, noise_kinds[k].octaves, c->noise[k]);
    }
    return good ? SG_OK : SG_FAIL_NOMEM(err);
}

void sg_canvas_clear(sg_canvas *c)
{
    free(c->albedo);
    free(c->glow);
    free(c->depth);
    free(c->mask.cover);
    for (int k = 0; k < SG_NOISES; k++)
        free(c->noise[k]);
    memset(c, 0, sizeof *c);
}

static float linear(uint32_t byte)
{
    return (float)pow((double)byte / 255, 2.2);
}

sg_tint sg_tint_srgb(uint32_t color)
{
    return (sg_tint){linear(color >> 16 & 255), linear(color >> 8 & 255), linear(color & 255)};
}

sg_tint sg_tint_scaled(sg_tint t, double factor)
{
    const float f = (float)factor;
    return (sg_tint){t.r * f, t.g * f, t.b * f};
}

sg_tint sg_tint_mixed(sg_tint a, sg_tint b, double share_of_b)
{
    const float s = (float)share_of_b;
    return (sg_tint){a.r + s * (b.r - a.r), a.g + s * (b.g - a.g), a.b + s * (b.b - a.b)};
}

sg_tint sg_tint_varied(sg_canvas *c, sg_tint t, double spread)
{
    const double all = exp(spread * gsl_ran_ugaussian(c->rng));
    const double warm = 0.3 * spread * gsl_ran_ugaussian(c->rng);
    return (sg_tint){(float)(t.r * all * (1 + warm)), (float)(t.g * all), (float)(t.b * all * (1 - warm))};
}

sg_material sg_material_of(sg_tint tint, double fine, double mottle, double stain)
{
    return (sg_material){tint, {(float)fine, (float)mottle, (float)stain}};
}

double sg_canvas_between(sg_canvas *c, double low, double high)
{
    return low + (high - low) * sg_random_uniform(c->rng);
}

bool sg_canvas_chance(sg_canvas *c, double p)
{
    return sg_random_uniform(c->rng) < p;
}

size_t sg_canvas_pick(sg_canvas *c, size_t n)
{
    return (size_t)(sg_random_uniform(c->rng) * (double)n);
}

static size_t clamped(double v, size_t limit)
{
    const double r = floor(v + 0.5);
    return r <= 0 ? 0 : r >= (double)limit ? limit : (size_t)r;
}

sg_pixels sg_canvas_pixels(const sg_canvas *c, sg_box b)
{
    return (sg_pixels){clamped(b.x0, c->width), clamped(b.y0, c->height), clamped(b.x1, c->width),
                       clamped(b.y1, c->height)};
}

static void put(sg_canvas *c, size_t i, const sg_material *m, float depth, float cover)
{
    float shade = 1;
    for (int k = 0; k < SG_NOISES; k++)
        shade += m->noise[k] * c->noise[k][i];
    shade = shade < 0.05F ? 0.05F : shade;
    const float color[3] = {m->tint.r * shade, m->tint.g * shade, m->tint.b * shade};
    for (int k = 0; k < 3; k++) {
        c->albedo[3 * i + (size_t)k] += cover * (color[k] - c->albedo[3 * i + (size_t)k]);
        c->glow[3 * i + (size_t)k] *= 1 - cover;
    }
    if (cover > 0.4F)
        c->depth[i] = depth;
}

void sg_canvas_box(sg_canvas *c, sg_box b, const sg_material *m, double depth)
{
    const sg_pixels p = sg_canvas_pixels(c, b);
    for (size_t y = p.y0; y < p.y1; y++)
        for (size_t x = p.x0; x < p.x1; x++)
            put(c, y * c->width + x, m, (float)depth, 1);
}

void sg_canvas_raise(sg_canvas *c, sg_box b, double by)
{
    const sg_pixels p = sg_canvas_pixels(c, b);
    for (size_t y = p.y0; y < p.y1; y++)
        for (size_t x = p.x0; x < p.x1; x++)
            c->depth[y * c->width + x] += (float)by;
}

void sg_canvas_tone(sg_canvas *c, sg_box b, double factor)
{
    const sg_pixels p = sg_canvas_pixels(c, b);
    for (size_t y = p.y0; y < p.y1; y++)
        for (size_t x = 3 * p.x0; x < 3 * p.x1; x++)
            c->albedo[3 * y * c->width + x] *= (float)factor;
}

void sg_canvas_glow(sg_canvas *c, sg_box b, sg_tint top, sg_tint bottom, double noise)
{
    const sg_pixels p = sg_canvas_pixels(c, b);
    for (size_t y = p.y0; y < p.y1; y++) {
        const sg_tint t = sg_tint_mixed(top, bottom, (double)(y - p.y0) / (double)(p.y1 - p.y0));
        for (size_t x = p.x0; x < p.x1; x++) {
            const size_t i = y * c->width + x;
            const float s = (float)fmax(0, 1 + noise * c->noise[SG_NOISE_MOTTLE][i]);
            c->glow[3 * i] = t.r * s;
            c->glow[3 * i + 1] = t.g * s;
            c->glow[3 * i + 2] = t.b * s;
        }
    }
}

void sg_canvas_shape_begin(sg_canvas *c, sg_box b)
{
    const sg_pixels p = sg_canvas_pixels(c, b);
    for (size_t y = p.y0; y < p.y1; y++)
        memset(c->mask.cover + y * c->width + p.x0, 0, p.x1 - p.x0);
}

void sg_canvas_shape_end(sg_canvas *c, sg_box b, const sg_material *m, double depth, double opacity)
{
    const sg_pixels p = sg_canvas_pixels(c, b);
    for (size_t y = p.y0; y < p.y1; y++) {
        for (size_t x = p.x0; x < p.x1; x++) {
            const size_t i = y * c->width + x;
            if (c->mask.cover[i] != 0)
                put(c, i, m, (float)depth, (float)opacity * (float)c->mask.cover[i] / 255);
        }
    }
}
