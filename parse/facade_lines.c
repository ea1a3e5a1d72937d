/* SPDX-License-Identifier: GPL-3.0-or-later */
/* facade_lines.c - vertical and horizontal lines are the same to all of this: a map is walked along a line and across it
 * with two strides. */
#include "config.h"

#include "parse/facade_lines.h"

#include "core/array.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A label map as the lines of one orientation see it. */
typedef struct {
    const uint8_t *labels;
    size_t breadth, length;      /* px across the lines: places 1..breadth-1; along them */
    size_t across, along;        /* strides */
} grain;

static grain grain_of(const sg_label_map *m, bool vertical)
{
    return vertical ? (grain){m->labels, m->width, m->height, 1, m->width}
                    : (grain){m->labels, m->height, m->width, m->width, 1};
}

/* Do labels change across place `at` at position i along it? */
static bool changes(const grain *g, size_t at, size_t i)
{
    const uint8_t *p = g->labels + at * g->across + i * g->along;
    return *p != *(p - g->across);
}

/* ---- finding ---- */

static uint8_t most_frequent(const grain *g, size_t at, size_t from, size_t to)
{
    size_t count[256] = {0}, best = 0;
    for (size_t i = from; i < to; i++)
        count[g->labels[at * g->across + i * g->along]]++;
    for (size_t c = 1; c < 256; c++)
        if (count[c] > count[best])
            best = c;
    return (uint8_t)best;
}

typedef struct {
    sg_facade_line *items;
    size_t n, capacity;
} line_list;

static sg_status add_line(line_list *list, const grain *g, bool vertical, size_t at, size_t from, size_t to, sg_error *err)
{
    if (!SG_GROW(list->items, list->capacity, list->n + 1))
        return SG_FAIL_NOMEM(err);
    list->items[list->n++] = (sg_facade_line){vertical, (uint32_t)at, (uint32_t)from, (uint32_t)to,
                                              most_frequent(g, at - 1, from, to), most_frequent(g, at, from, to),
                                              NAN, NAN, NAN};
    return SG_OK;
}

static sg_status find_runs(line_list *list, const sg_label_map *m, bool vertical, sg_error *err)
{
    const grain g = grain_of(m, vertical);
    for (size_t at = 1; at < g.breadth; at++)
        for (size_t i = 0; i < g.length;) {
            if (!changes(&g, at, i)) {
                i++;
                continue;
            }
            const size_t from = i;
            while (i < g.length && changes(&g, at, i))
                i++;
            SG_TRY(add_line(list, &g, vertical, at, from, i, err));
        }
    return SG_OK;
}

sg_status sg_facade_lines_find(const sg_label_map *parse, sg_facade_line **lines, size_t *n, sg_error *err)
{
    line_list list = {0};
    sg_status st = find_runs(&list, parse, true, err);
    if (st == SG_OK)
        st = find_runs(&list, parse, false, err);
    if (st == SG_OK) {
        *lines = list.items;
        *n = list.n;
    } else {
        free(list.items);
    }
    return st;
}

/* ---- judging ---- */

static bool is_line_at(const grain *g, const sg_facade_line *l, size_t at)
{
    size_t n = 0;
    for (size_t i = l->from; i < l->to; i++)
        n += changes(g, at, i);
    return 2 * n >= l->to - l->from;
}

/* The place nearest to the line's where a sample has it, the lower of two; 0: none. */
static size_t find_near(const grain *g, const sg_facade_line *l)
{
    for (size_t d = 0; d <= SG_LINE_REACH_PX; d++) {
        if (l->at > d && is_line_at(g, l, l->at - d))
            return l->at - d;
        if (d > 0 && l->at + d < g->breadth && is_line_at(g, l, l->at + d))
            return l->at + d;
    }
    return 0;
}

/* Sums over the samples of where a line was: offsets are whole, so the sums are exact. */
typedef struct {
    double n, sum, squares;
} tally;

static void judge_sample(const sg_facade_line *lines, size_t n, const sg_label_map *m, tally *t)
{
    for (size_t k = 0; k < n; k++) {
        const grain g = grain_of(m, lines[k].vertical);
        const size_t at = find_near(&g, &lines[k]);
        if (at == 0)
            continue;
        const double offset = (double)at - (double)lines[k].at;
        t[k].n++;
        t[k].sum += offset;
        t[k].squares += offset * offset;
    }
}

static void conclude(sg_facade_line *l, const tally *t, size_t nsamples)
{
    l->share = nsamples > 0 ? t->n / (double)nsamples : NAN;
    const double mean = t->sum / t->n; /* NAN when none has it */
    l->mean = (double)l->at + mean;
    const double variance = t->squares / t->n - mean * mean;
    l->sd = variance < 0 ? 0 : sqrt(variance);
}

sg_status sg_facade_lines_judge(sg_facade_line *lines, size_t n, const sg_facade_samples *s, sg_error *err)
{
    sg_label_map map;
    tally *t = calloc(n + 1, sizeof *t);
    if (t == NULL)
        return SG_FAIL_NOMEM(err);
    const sg_status st = sg_label_map_create(s->width, s->height, &map, err);
    for (size_t i = 0; st == SG_OK && i < s->nsamples; i++) {
        sg_facade_samples_raster(s, i, &map);
        judge_sample(lines, n, &map, t);
    }
    for (size_t k = 0; st == SG_OK && k < n; k++)
        conclude(&lines[k], &t[k], s->nsamples);
    if (st == SG_OK)
        sg_label_map_clear(&map);
    free(t);
    return st;
}
