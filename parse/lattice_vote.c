/* SPDX-License-Identifier: GPL-3.0-or-later */
/* lattice_vote.c - the classes of a lattice's cells, by majority or by least cost (MATHEMATICS B2, step 3). */
#include "parse/lattice_fit.h"

#include "image/classes.h"

#include <stdbool.h>
#include <string.h>

enum { NO_CLASS = SG_CLASS_UNKNOWN };

typedef struct {
    uint32_t *count; /* [width][nclasses] of one row of cells */
    double *cost;    /* the same, where there are costs */
} tally;

static void count_row(const sg_lattice_source *s, const sg_lattice_fit *f, size_t row, tally *t)
{
    memset(t->count, 0, f->width * s->nclasses * sizeof *t->count);
    for (uint32_t y = f->y[row]; y < f->y[row + 1]; y++) {
        const uint8_t *label = s->labels + (size_t)y * s->width;
        for (size_t column = 0; column < f->width; column++)
            for (uint32_t x = f->x[column]; x < f->x[column + 1]; x++)
                if (label[x] != SG_CLASS_IGNORE)
                    t->count[column * s->nclasses + label[x]]++;
    }
}

static void sum_costs(const sg_lattice_source *s, const sg_lattice_fit *f, size_t row, tally *t)
{
    memset(t->cost, 0, f->width * s->nclasses * sizeof *t->cost);
    for (size_t c = 0; c < s->nclasses; c++)
        for (uint32_t y = f->y[row]; y < f->y[row + 1]; y++) {
            const float *cost = s->costs + (c * s->height + y) * s->width;
            for (size_t column = 0; column < f->width; column++)
                for (uint32_t x = f->x[column]; x < f->x[column + 1]; x++)
                    t->cost[column * s->nclasses + c] += (double)cost[x];
        }
}

static size_t most(const uint32_t *count, size_t n)
{
    size_t best = 0;
    for (size_t c = 1; c < n; c++)
        if (count[c] > count[best])
            best = c;
    return best;
}

static size_t cheapest(const double *cost, size_t n)
{
    size_t best = 0;
    for (size_t c = 1; c < n; c++)
        if (cost[c] < cost[best])
            best = c;
    return best;
}

static void decide_row(const sg_lattice_source *s, const tally *t, size_t row, sg_lattice_fit *f)
{
    for (size_t column = 0; column < f->width; column++) {
        const uint32_t *count = t->count + column * s->nclasses;
        size_t total = 0;
        for (size_t c = 0; c < s->nclasses; c++)
            total += count[c];
        const size_t best = s->costs != NULL ? cheapest(t->cost + column * s->nclasses, s->nclasses)
                                             : most(count, s->nclasses);
        f->classes[row * f->width + column] = total > 0 ? (uint8_t)best : NO_CLASS;
        f->counted_px += total;
        f->wrong_px += total - (total > 0 ? count[best] : 0);
        if (s->costs != NULL && total > 0)
            f->loss += t->cost[column * s->nclasses + best];
    }
}

typedef struct {
    uint32_t border;
    uint8_t class;
} neighbour;

static void look_at(const sg_lattice_fit *f, size_t column, size_t row, uint32_t border, neighbour *best)
{
    const uint8_t class = f->classes[row * f->width + column];
    if (class != NO_CLASS && border > best->border)
        *best = (neighbour){border, class};
}

static uint8_t class_of_neighbours(const sg_lattice_fit *f, size_t column, size_t row)
{
    neighbour best = {0, NO_CLASS};
    const uint32_t width = f->x[column + 1] - f->x[column], height = f->y[row + 1] - f->y[row];
    if (column > 0)
        look_at(f, column - 1, row, height, &best);
    if (column + 1 < f->width)
        look_at(f, column + 1, row, height, &best);
    if (row > 0)
        look_at(f, column, row - 1, width, &best);
    if (row + 1 < f->height)
        look_at(f, column, row + 1, width, &best);
    return best.class;
}

/* In rounds from the classed cells outwards; each round looks at what the one before has left. */
static sg_status fill_ignored(sg_lattice_fit *f, sg_arena *scratch, sg_error *err)
{
    const size_t n = f->width * f->height;
    uint8_t *next = sg_arena_alloc(scratch, n);
    if (next == NULL)
        return SG_FAIL_NOMEM(err);
    while (memchr(f->classes, NO_CLASS, n) != NULL) {
        memcpy(next, f->classes, n);
        for (size_t i = 0; i < n; i++)
            if (f->classes[i] == NO_CLASS)
                next[i] = class_of_neighbours(f, i % f->width, i / f->width);
        memcpy(f->classes, next, n);
    }
    return SG_OK;
}

sg_status sg_lattice_vote(const sg_lattice_source *source, sg_arena *scratch, sg_lattice_fit *f, sg_error *err)
{
    const size_t n = f->width * source->nclasses;
    tally t = {SG_NEW_ARRAY(scratch, uint32_t, n), source->costs != NULL ? SG_NEW_ARRAY(scratch, double, n) : NULL};
    if (t.count == NULL || (source->costs != NULL && t.cost == NULL))
        return SG_FAIL_NOMEM(err);
    f->counted_px = f->wrong_px = 0;
    f->loss = 0;
    for (size_t row = 0; row < f->height; row++) {
        count_row(source, f, row, &t);
        if (source->costs != NULL)
            sum_costs(source, f, row, &t);
        decide_row(source, &t, row, f);
    }
    if (f->counted_px == 0)
        return SG_FAIL(err, SG_EINPUT, "every pixel is ignored: no cell has a class");
    if (source->costs == NULL)
        f->loss = (double)f->wrong_px;
    return fill_ignored(f, scratch, err);
}

sg_status sg_lattice_from_fit(const sg_lattice_fit *f, const char *const *names, size_t nclasses, sg_arena *arena,
                              sg_lattice *out, sg_error *err)
{
    sg_lattice l;
    SG_TRY(sg_lattice_create(f->width, f->height, arena, &l, err));
    memcpy(l.x, f->x, (f->width + 1) * sizeof *f->x);
    memcpy(l.y, f->y, (f->height + 1) * sizeof *f->y);
    for (size_t i = 0; i < f->width * f->height; i++)
        l.labels[i] = f->classes[i];
    l.nlabels = nclasses;
    l.label_names = sg_arena_copy(arena, names, nclasses * sizeof *names);
    if (l.label_names == NULL)
        return SG_FAIL_NOMEM(err);
    *out = l;
    return SG_OK;
}
