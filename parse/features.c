/* SPDX-License-Identifier: GPL-3.0-or-later */
/* features.c - sets of features: which there are, the memory of their planes, padding. */
#include "config.h"

#include "parse/features_priv.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_BYTES ((size_t)8 << 30)

static const sg_feature_definition *definition_of(const sg_feature_set *set)
{
    const sg_feature_definition *d = set->kind == SG_FEATURES_PATCH  ? &sg_features_patch
                                     : set->kind == SG_FEATURES_RICH ? &sg_features_rich
                                                                     : NULL;
    return d != NULL && set->version == d->version ? d : NULL;
}

sg_feature_set sg_feature_set_of(sg_feature_kind kind, uint32_t patch)
{
    if (kind == SG_FEATURES_PATCH)
        return (sg_feature_set){kind, patch, sg_features_patch.version};
    return (sg_feature_set){kind, 0, sg_features_rich.version};
}

size_t sg_feature_set_count(const sg_feature_set *set)
{
    const sg_feature_definition *d = definition_of(set);
    return d != NULL ? d->count(set) : 0;
}

void sg_feature_set_describe(const sg_feature_set *set, size_t f, char *text, size_t n)
{
    const sg_feature_definition *d = definition_of(set);
    if (d == NULL || f >= d->count(set)) {
        snprintf(text, n, "no such feature");
        return;
    }
    const sg_feature_place at = d->place(set, f);
    char name[64];
    d->plane_name(set, at.plane, name, sizeof name);
    if (at.dx == 0 && at.dy == 0)
        snprintf(text, n, "%s", name);
    else
        snprintf(text, n, "%s at %+d,%+d", name, at.dx, at.dy);
}

/* ---- planes ---- */

void sg_planes_fill_rgb(sg_planes *p, size_t first, const sg_image *photo)
{
    for (size_t c = 0; c < 3; c++) {
        float *plane = sg_planes_at(p, first + c);
        for (size_t y = 0; y < p->height; y++)
            for (size_t x = 0; x < p->width; x++)
                plane[y * p->stride + x] = photo->rgb[3 * (y * photo->width + x) + c];
    }
}

/* The padding repeats the nearest pixel of the photograph. */
static void pad_plane(const sg_planes *p, size_t plane)
{
    float *const at = sg_planes_at(p, plane), *const left = at - p->pad;
    for (size_t y = 0; y < p->height; y++) {
        float *row = left + y * p->stride, *end = row + p->pad + p->width;
        for (size_t x = 0; x < p->pad; x++) {
            row[x] = row[p->pad];
            end[x] = end[-1];
        }
    }
    float *const last = left + (p->height - 1) * p->stride;
    for (size_t y = 1; y <= p->pad; y++) {
        memcpy(left - y * p->stride, left, p->stride * sizeof *left);
        memcpy(last + y * p->stride, last, p->stride * sizeof *left);
    }
}

static size_t bytes_of(size_t nplanes, size_t pad, size_t width, size_t height)
{
    return nplanes * (width + 2 * pad) * (height + 2 * pad) * sizeof(float);
}

/* The sentence names a size of the same shape that would do. */
static sg_status check_bytes(size_t nplanes, size_t pad, const sg_image *photo, sg_error *err)
{
    const size_t w = photo->width, h = photo->height;
    if (bytes_of(nplanes, pad, w, h) <= MAX_BYTES)
        return SG_OK;
    size_t percent = 100;
    while (percent > 1 && bytes_of(nplanes, pad, w * percent / 100, h * percent / 100) > MAX_BYTES)
        percent--;
    return SG_FAIL(err, SG_EINPUT,
                   "a photograph of %zu x %zu pixels is too large: its features would take %.1f GiB; at %zu x %zu they "
                   "would fit into %zu GiB",
                   w, h, (double)bytes_of(nplanes, pad, w, h) / (double)((size_t)1 << 30), w * percent / 100,
                   h * percent / 100, MAX_BYTES >> 30);
}

/* ---- features ---- */

static ptrdiff_t *offsets_of(const sg_feature_definition *d, const sg_feature_set *set, const sg_planes *p)
{
    const size_t n = d->count(set);
    ptrdiff_t *offsets = malloc(n * sizeof *offsets);
    for (size_t f = 0; offsets != NULL && f < n; f++) {
        const sg_feature_place at = d->place(set, f);
        offsets[f] = sg_planes_at(p, at.plane) - p->data + at.dy * (ptrdiff_t)p->stride + at.dx;
    }
    return offsets;
}

static sg_status fill(const sg_feature_definition *d, const sg_feature_set *set, const sg_image *photo, sg_planes *p,
                      sg_error *err)
{
    SG_TRY(d->fill(set, photo, p, err));
    for (size_t i = 0; i < p->nplanes; i++)
        pad_plane(p, i);
    return SG_OK;
}

sg_status sg_features_create(const sg_feature_set *set, const sg_image *photo, sg_features *out, sg_error *err)
{
    const sg_feature_definition *d = definition_of(set);
    const size_t n = d != NULL ? d->count(set) : 0;
    if (d == NULL || n == 0)
        return SG_FAIL(err, SG_EINVAL, "no set of features has kind %d, patch %u and version %u", (int)set->kind,
                       (unsigned)set->patch, (unsigned)set->version);
    SG_TRY(sg_image_check_size(photo->width, photo->height, err));
    const size_t pad = d->pad(set), nplanes = d->planes(set);
    SG_TRY(check_bytes(nplanes, pad, photo, err));
    sg_planes p = {photo->width, photo->height, pad, photo->width + 2 * pad, photo->height + 2 * pad, nplanes, NULL};
    p.data = malloc(bytes_of(nplanes, pad, p.width, p.height));
    sg_features made = {p.width, p.height, p.stride, p.data, n, p.data != NULL ? offsets_of(d, set, &p) : NULL};
    const sg_status st = made.offsets == NULL ? SG_FAIL_NOMEM(err) : fill(d, set, photo, &p, err);
    if (st == SG_OK)
        *out = made;
    else
        sg_features_clear(&made);
    return st;
}

void sg_features_clear(sg_features *f)
{
    free(f->data);
    free(f->offsets);
    *f = (sg_features){0};
}
