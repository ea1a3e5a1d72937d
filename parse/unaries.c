/* SPDX-License-Identifier: GPL-3.0-or-later */
/* unaries.c - probabilities are judged pixel by pixel, so that what is wrong is named with its place. */
#include "config.h"

#include "parse/unaries.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double SUM_TOLERANCE = 1e-3;

/* ---- reading ---- */

/* What is wrong with the values of pixel i; false: nothing. */
static bool pixel_fault(const sg_float_map *p, size_t i, char *what, size_t n)
{
    const size_t plane = p->height * p->width;
    double sum = 0;
    for (size_t c = 0; c < p->channels; c++) {
        const double v = p->values[c * plane + i];
        if (!isfinite(v) || v < 0) {
            snprintf(what, n, "class %zu has %g, which is no probability", c, v);
            return true;
        }
        sum += v;
    }
    if (fabs(sum - 1) <= SUM_TOLERANCE)
        return false;
    snprintf(what, n, "the %zu probabilities sum to %.6g, not to 1", p->channels, sum);
    return true;
}

static sg_status check_pixels(const char *path, const sg_float_map *p, sg_error *err)
{
    char what[128];
    for (size_t i = 0; i < p->height * p->width; i++)
        if (pixel_fault(p, i, what, sizeof what))
            return SG_FAIL(err, SG_EINPUT, "%s: column %zu, row %zu: %s", path, i % p->width, i / p->width, what);
    return SG_OK;
}

sg_status sg_unaries_read(const char *dir, const char *name, size_t nclasses, float floor, sg_float_map *out,
                          sg_error *err)
{
    char path[4096];
    sg_float_map p = {0};
    const int n = snprintf(path, sizeof path, "%s/%s.npy", dir, name);
    if (n < 0 || (size_t)n >= sizeof path)
        return SG_FAIL(err, SG_EINPUT, "%.200s...: the path is too long", path);
    SG_TRY(sg_npy_read(path, &p, err));
    sg_status st = SG_OK;
    if (p.channels != nclasses)
        st = SG_FAIL(err, SG_EINPUT, "%s: %zu values a pixel, but there are %zu classes", path, p.channels, nclasses);
    if (st == SG_OK)
        st = check_pixels(path, &p, err);
    if (st == SG_OK)
        st = sg_unaries_lift(&p, floor, err);
    if (st == SG_OK)
        *out = p;
    else
        sg_float_map_clear(&p);
    return st;
}

/* ---- what is made of them ---- */

static void lift_pixel(sg_float_map *p, size_t i, float floor)
{
    const size_t plane = p->height * p->width;
    double sum = 0;
    bool low = false;
    for (size_t c = 0; c < p->channels; c++) {
        float *v = p->values + c * plane + i;
        if (*v < floor) {
            *v = floor;
            low = true;
        }
        sum += *v;
    }
    for (size_t c = 0; low && c < p->channels; c++)
        p->values[c * plane + i] = (float)(p->values[c * plane + i] / sum);
}

sg_status sg_unaries_lift(sg_float_map *p, float floor, sg_error *err)
{
    if (!(floor >= 0) || (double)floor * (double)p->channels >= 1)
        return SG_FAIL(err, SG_EINVAL, "a floor of %g for %zu probabilities: it must be 0 or more, and below their mean",
                       (double)floor, p->channels);
    for (size_t i = 0; floor > 0 && i < p->height * p->width; i++)
        lift_pixel(p, i, floor);
    return SG_OK;
}

/* Plane by plane, so that memory is read in order. */
static void take_best(const sg_float_map *p, float *best, uint8_t *labels)
{
    const size_t plane = p->height * p->width;
    memcpy(best, p->values, plane * sizeof *best);
    for (size_t c = 1; c < p->channels; c++) {
        const float *v = p->values + c * plane;
        for (size_t i = 0; i < plane; i++)
            if (v[i] > best[i]) {
                best[i] = v[i];
                labels[i] = (uint8_t)c;
            }
    }
}

sg_status sg_unaries_map(const sg_float_map *p, sg_label_map *map, sg_error *err)
{
    sg_float_map best;
    sg_label_map m;
    if (p->channels > SG_MAX_CLASSES)
        return SG_FAIL(err, SG_EINVAL, "%zu classes: a label map tells %d apart", p->channels, SG_MAX_CLASSES);
    SG_TRY(sg_label_map_create(p->width, p->height, &m, err));
    const sg_status st = sg_float_map_create(1, p->height, p->width, &best, err);
    if (st != SG_OK) {
        sg_label_map_clear(&m);
        return st;
    }
    take_best(p, best.values, m.labels);
    sg_float_map_clear(&best);
    *map = m;
    return SG_OK;
}

static size_t best_class(const sg_float_map *p, size_t i)
{
    const size_t plane = p->height * p->width;
    size_t best = 0;
    for (size_t c = 1; c < p->channels; c++)
        if (p->values[c * plane + i] > p->values[best * plane + i])
            best = c;
    return best;
}

sg_status sg_unaries_harden(sg_float_map *p, double right, sg_error *err)
{
    const size_t plane = p->height * p->width;
    if (!(right * (double)p->channels > 1 && right < 1))
        return SG_FAIL(err, SG_EINVAL, "a probability of %g for the best of %zu classes: it must be above %g and below 1",
                       right, p->channels, 1 / (double)p->channels);
    const float wrong = (float)((1 - right) / (double)(p->channels - 1));
    for (size_t i = 0; i < plane; i++) {
        const size_t best = best_class(p, i);
        for (size_t c = 0; c < p->channels; c++)
            p->values[c * plane + i] = c == best ? (float)right : wrong;
    }
    return SG_OK;
}

/* A probability of a little over 1, which the tolerance of the sum allows, costs 0. */
void sg_unaries_to_costs(sg_float_map *p)
{
    for (size_t i = 0; i < p->channels * p->height * p->width; i++)
        p->values[i] = p->values[i] < 1 ? -logf(p->values[i]) : 0;
}

/* ---- labels ---- */

enum { LIST_SIZE = 450 }; /* bytes: two lists and what stands between them fill a sentence */

/* Append a name to a list with commas; when no more have room, dots say so. */
static void list_name(char list[LIST_SIZE], const char *name)
{
    const size_t n = strlen(list);
    if (n + strlen(name) + sizeof ", , ..." < LIST_SIZE)
        snprintf(list + n, LIST_SIZE - n, "%s%s", n > 0 ? ", " : "", name);
    else if (n < 4 || strcmp(list + n - 3, "...") != 0)
        snprintf(list + n, LIST_SIZE - n, "%s...", n > 0 ? ", " : "");
}

sg_status sg_unaries_channels(const sg_grammar *g, const sg_classes *classes, uint32_t *channel, sg_error *err)
{
    char missing[LIST_SIZE] = "", there[LIST_SIZE] = "";
    for (sg_sym s = 0; s < sg_grammar_symbol_count(g); s++) {
        const sg_symbol *symbol = sg_grammar_symbol(g, s);
        const int c = symbol->kind == SG_SYMBOL_LABEL ? sg_classes_find(classes, symbol->name) : -1;
        channel[s] = c >= 0 ? (uint32_t)c : UINT32_MAX;
        if (symbol->kind == SG_SYMBOL_LABEL && c < 0)
            list_name(missing, symbol->name);
    }
    if (missing[0] == '\0')
        return SG_OK;
    for (size_t c = 0; c < classes->nclasses; c++)
        list_name(there, classes->names[c]);
    return SG_FAIL(err, SG_EINPUT, "labels of the grammar that are no classes of the pixels: %s (those are %s)",
                   missing, there);
}
