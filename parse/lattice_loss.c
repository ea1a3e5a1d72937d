/* SPDX-License-Identifier: GPL-3.0-or-later */
/* lattice_loss.c - what a lattice shows wrong, by class and by cause. */
#include "parse/lattice_loss.h"

#include "core/array.h"
#include "image/classes.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

const char *sg_loss_cause_name(sg_loss_cause cause)
{
    static const char *const names[] = {"misaligned", "irregular", "thin", "region"};
    return names[cause];
}

sg_status sg_lattice_loss_create(size_t nclasses, sg_arena *arena, sg_lattice_loss *out, sg_error *err)
{
    const sg_lattice_loss loss = {nclasses, SG_NEW_ARRAY(arena, size_t, nclasses * nclasses),
                                  SG_NEW_ARRAY(arena, size_t, nclasses * SG_LOSS_CAUSES),
                                  SG_NEW_ARRAY(arena, size_t, nclasses)};
    if (loss.confusion == NULL || loss.causes == NULL || loss.near_line == NULL)
        return SG_FAIL_NOMEM(err);
    *out = loss;
    return SG_OK;
}

/* A map and its lattice, pixel by pixel. */
typedef struct {
    size_t width, height;
    const uint8_t *truth;
    uint8_t *shown;
    bool *near_column, *near_row; /* [width], [height]: a line is near */
    uint32_t *region;             /* [height][width] number of the pixel's region */
    uint32_t *stack;              /* room for the pixels of one region */
} canvas;

typedef struct {
    size_t right;
    size_t x0, y0, x1, y1; /* what it spans, half open */
} region;

static void show(const sg_lattice_fit *f, canvas *c)
{
    for (size_t row = 0; row < f->height; row++)
        for (uint32_t y = f->y[row]; y < f->y[row + 1]; y++)
            for (size_t column = 0; column < f->width; column++)
                memset(c->shown + y * c->width + f->x[column], f->classes[row * f->width + column],
                       f->x[column + 1] - f->x[column]);
}

/* Lines inside the map only: its border is no line that could have been put elsewhere. */
static void mark_near(const uint32_t *line, size_t ncells, size_t length, bool *near)
{
    for (size_t i = 1; i < ncells; i++)
        for (size_t p = line[i] > SG_LATTICE_NEAR_PX ? line[i] - SG_LATTICE_NEAR_PX : 0;
             p < line[i] + (size_t)SG_LATTICE_NEAR_PX && p < length; p++)
            near[p] = true;
}

static void push(canvas *c, size_t x, size_t y, uint8_t class, uint32_t number, size_t *n)
{
    const size_t i = y * c->width + x;
    if (c->truth[i] != class || c->region[i] != 0)
        return;
    c->region[i] = number;
    c->stack[(*n)++] = (uint32_t)i;
}

/* The region of pixel (x, y), which has none yet. */
static region flood(canvas *c, size_t x, size_t y, uint32_t number)
{
    region r = {0, x, y, x + 1, y + 1};
    const uint8_t class = c->truth[y * c->width + x];
    size_t n = 0;
    push(c, x, y, class, number, &n);
    while (n > 0) {
        const size_t i = c->stack[--n], px = i % c->width, py = i / c->width;
        r.right += c->shown[i] == class;
        r.x0 = px < r.x0 ? px : r.x0;
        r.x1 = px + 1 > r.x1 ? px + 1 : r.x1;
        r.y1 = py + 1 > r.y1 ? py + 1 : r.y1; /* y0 stands: regions are met at their topmost row */
        if (px > 0)
            push(c, px - 1, py, class, number, &n);
        if (px + 1 < c->width)
            push(c, px + 1, py, class, number, &n);
        if (py > 0)
            push(c, px, py - 1, class, number, &n);
        if (py + 1 < c->height)
            push(c, px, py + 1, class, number, &n);
    }
    return r;
}

/* Numbered from 1. */
static sg_status find_regions(canvas *c, region **regions, sg_error *err)
{
    size_t capacity = 0, n = 1;
    for (size_t i = 0; i < c->width * c->height; i++) {
        if (c->region[i] != 0 || c->truth[i] == SG_CLASS_IGNORE)
            continue;
        if (!SG_GROW(*regions, capacity, n + 1))
            return SG_FAIL_NOMEM(err);
        (*regions)[n] = flood(c, i % c->width, i / c->width, (uint32_t)n);
        n++;
    }
    return SG_OK;
}

static bool is_shown_near(const canvas *c, size_t x, size_t y, uint8_t class)
{
    const size_t far = SG_LATTICE_NEAR_PX;
    for (size_t v = y > far ? y - far : 0; v <= y + far && v < c->height; v++)
        for (size_t u = x > far ? x - far : 0; u <= x + far && u < c->width; u++)
            if (c->shown[v * c->width + u] == class)
                return true;
    return false;
}

static sg_loss_cause cause_of(const canvas *c, const region *r, size_t x, size_t y, uint8_t class)
{
    if (r->right > 0)
        return is_shown_near(c, x, y, class) ? SG_LOSS_MISALIGNED : SG_LOSS_IRREGULAR;
    const bool thin = r->x1 - r->x0 <= SG_LATTICE_THIN_PX || r->y1 - r->y0 <= SG_LATTICE_THIN_PX;
    return thin ? SG_LOSS_THIN : SG_LOSS_REGION;
}

/* Pixels of a region that is shown nowhere may still be next to a cell of their class: another region's. */
static void count_pixels(const canvas *c, const region *regions, sg_lattice_loss *loss)
{
    for (size_t y = 0; y < c->height; y++)
        for (size_t x = 0; x < c->width; x++) {
            const size_t i = y * c->width + x;
            const uint8_t class = c->truth[i];
            if (class == SG_CLASS_IGNORE)
                continue;
            loss->confusion[class * loss->nclasses + c->shown[i]]++;
            if (c->shown[i] == class)
                continue;
            loss->near_line[class] += c->near_column[x] || c->near_row[y];
            loss->causes[class * SG_LOSS_CAUSES + cause_of(c, &regions[c->region[i]], x, y, class)]++;
        }
}

sg_status sg_lattice_loss_add(const sg_lattice_source *source, const sg_lattice_fit *f, sg_arena *scratch,
                              sg_lattice_loss *loss, sg_error *err)
{
    const size_t n = source->width * source->height;
    const sg_mark mark = sg_arena_mark(scratch);
    canvas c = {source->width, source->height, source->labels, sg_arena_alloc(scratch, n),
                SG_NEW_ARRAY(scratch, bool, source->width), SG_NEW_ARRAY(scratch, bool, source->height),
                SG_NEW_ARRAY(scratch, uint32_t, n), SG_NEW_ARRAY(scratch, uint32_t, n)};
    region *regions = NULL;
    sg_status st = SG_OK;
    if (c.shown == NULL || c.near_column == NULL || c.near_row == NULL || c.region == NULL || c.stack == NULL) {
        st = SG_FAIL_NOMEM(err);
    } else {
        show(f, &c);
        mark_near(f->x, f->width, source->width, c.near_column);
        mark_near(f->y, f->height, source->height, c.near_row);
        st = find_regions(&c, &regions, err);
    }
    if (st == SG_OK)
        count_pixels(&c, regions, loss);
    free(regions);
    sg_arena_rewind(scratch, mark);
    return st;
}

void sg_lattice_loss_merge(const sg_lattice_loss *from, sg_lattice_loss *to)
{
    for (size_t i = 0; i < to->nclasses * to->nclasses; i++)
        to->confusion[i] += from->confusion[i];
    for (size_t i = 0; i < to->nclasses * SG_LOSS_CAUSES; i++)
        to->causes[i] += from->causes[i];
    for (size_t i = 0; i < to->nclasses; i++)
        to->near_line[i] += from->near_line[i];
}

size_t sg_lattice_loss_pixels(const sg_lattice_loss *loss, size_t class)
{
    size_t sum = 0;
    for (size_t c = 0; c < loss->nclasses; c++)
        sum += loss->confusion[class * loss->nclasses + c];
    return sum;
}

size_t sg_lattice_loss_wrong(const sg_lattice_loss *loss, size_t class)
{
    return sg_lattice_loss_pixels(loss, class) - loss->confusion[class * loss->nclasses + class];
}
