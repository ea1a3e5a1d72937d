/* SPDX-License-Identifier: GPL-3.0-or-later */
/* earley_chart.c - the memory of a parse: the cells, the rectangles found, and the work spaces of corners in progress.
 */
#include "config.h"

#include "core/array.h"
#include "parse/earley_priv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const sg_comps sg_no_comps;

sg_status sg_chart_create(sg_chart **out, sg_error *err)
{
    sg_chart *c = calloc(1, sizeof *c);
    if (c == NULL)
        return SG_FAIL_NOMEM(err);
    c->arena = sg_arena_create();
    if (c->arena == NULL) {
        free(c);
        return SG_FAIL_NOMEM(err);
    }
    *out = c;
    return SG_OK;
}

static void free_level(sg_level *l, size_t height)
{
    for (size_t y = 0; l->rows != NULL && y <= height; y++)
        if (l->rows[y] != NULL) {
            free(l->rows[y]->head);
            free(l->rows[y]);
        }
    void *const pieces[] = {l->in,    l->symbols, l->unit_symbols, l->leaves,   l->touched,    l->b,      l->b2,
                            l->count, l->olds,    l->rows,         l->limit,    l->lines,      l->values, l->outside,
                            l->slots, l->links,   l->done_symbol,  l->done_end, l->done_value, l->bounds, l};
    for (size_t i = 0; i < sizeof pieces / sizeof *pieces; i++)
        free(pieces[i]);
}

void sg_chart_drop_levels(sg_chart *c)
{
    for (size_t i = 0; i < c->nlevels; i++)
        free_level(c->levels[i], c->level_height);
    c->nlevels = 0;
    while (c->free_rows != NULL) {
        sg_row *row = c->free_rows;
        c->free_rows = row->next_free;
        free(row->head);
        free(row);
    }
    c->bytes = 0;
}

void sg_chart_free(sg_chart *c)
{
    if (c == NULL)
        return;
    sg_chart_drop_levels(c);
    free(c->levels);
    free(c->iota);
    sg_arena_free(c->arena);
    free(c);
}

size_t sg_chart_states(const sg_chart *c)
{
    return c->states;
}

size_t sg_chart_bytes(const sg_chart *c)
{
    size_t bytes = c->bytes + sg_arena_used(c->arena);
    for (size_t i = 0; i < c->nlevels; i++) {
        const sg_level *l = c->levels[i];
        bytes += l->values_capacity + l->outside_capacity + l->lines_capacity * sizeof *l->lines +
                 l->links_capacity * sizeof *l->links + l->nslots * sizeof *l->slots +
                 l->olds_capacity * sizeof *l->olds +
                 (l->done_symbol_capacity + l->done_end_capacity) * sizeof(uint32_t) + l->done_value_capacity;
    }
    return bytes;
}

static sg_level *new_level(sg_chart *c)
{
    sg_level *l = calloc(1, sizeof *l);
    if (l == NULL)
        return NULL;
    const size_t n = c->level_symbols, h = c->level_height + 1;
    l->in = calloc(n, 1);
    l->symbols = malloc(n * sizeof *l->symbols);
    l->unit_symbols = malloc(n * sizeof *l->unit_symbols);
    l->leaves = malloc((c->level_leaves + 1) * sizeof *l->leaves);
    l->touched = malloc(n * sizeof *l->touched);
    l->b = malloc(n * sizeof(sg_ext));
    l->b2 = malloc(n * sizeof(sg_ext));
    l->count = malloc(n * sizeof *l->count);
    l->rows = calloc(h, sizeof *l->rows);
    l->limit = malloc(h * sizeof *l->limit);
    l->nslots = 64;
    l->slots = calloc(l->nslots, sizeof *l->slots);
    if (l->in == NULL || l->symbols == NULL || l->unit_symbols == NULL || l->leaves == NULL || l->touched == NULL ||
        l->b == NULL || l->b2 == NULL || l->count == NULL || l->rows == NULL || l->limit == NULL || l->slots == NULL) {
        free_level(l, c->level_height);
        return NULL;
    }
    c->bytes +=
        sizeof *l + n * (1 + 4 * sizeof(uint32_t) + 2 * sizeof(sg_ext)) + h * (sizeof *l->rows + sizeof *l->limit);
    return l;
}

sg_level *sg_chart_level(sg_chart *c, size_t depth)
{
    if (depth < c->nlevels)
        return c->levels[depth];
    if (!SG_GROW(c->levels, c->levels_capacity, depth + 1))
        return NULL;
    sg_level *l = new_level(c);
    if (l != NULL)
        c->levels[c->nlevels++] = l;
    return l;
}

sg_row *sg_chart_row(sg_chart *c)
{
    sg_row *row = c->free_rows;
    if (row != NULL) {
        c->free_rows = row->next_free;
        return row;
    }
    const size_t words = c->row_width / 64 + 1;
    row = calloc(1, sizeof *row + words * sizeof *row->bits);
    uint32_t *head = calloc(c->row_width + 1, sizeof *head);
    if (row == NULL || head == NULL) {
        free(row);
        free(head);
        return NULL;
    }
    row->head = head;
    c->bytes += sizeof *row + words * sizeof *row->bits + (c->row_width + 1) * sizeof *head;
    return row;
}

/* Levels and rows are made for the largest grammar and lattice so far. */
static sg_status fit_levels(sg_chart *c, const sg_parse_table *t, const sg_cells *cells, sg_error *err)
{
    if (t->nsymbols <= c->level_symbols && t->nleaves <= c->level_leaves && cells->width <= c->level_width &&
        cells->height <= c->level_height)
        return SG_OK;
    sg_chart_drop_levels(c);
    c->level_symbols = t->nsymbols > c->level_symbols ? t->nsymbols : c->level_symbols;
    c->level_leaves = t->nleaves > c->level_leaves ? t->nleaves : c->level_leaves;
    c->level_width = cells->width > c->level_width ? cells->width : c->level_width;
    c->level_height = cells->height > c->level_height ? cells->height : c->level_height;
    c->row_width = c->level_width;
    const size_t side = c->level_width > c->level_height ? c->level_width : c->level_height;
    uint16_t *iota = realloc(c->iota, (side + 1) * sizeof *iota);
    if (iota == NULL) {
        c->level_symbols = 0;
        return SG_FAIL_NOMEM(err);
    }
    c->iota = iota;
    for (size_t i = 0; i <= side; i++)
        iota[i] = (uint16_t)i;
    return SG_OK;
}

static sg_status take_labels(sg_chart *c, const sg_parse_table *t, const sg_cells *cells, sg_error *err)
{
    const size_t w = cells->width, h = cells->height;
    c->labels = sg_arena_alloc(c->arena, w * h * sizeof *c->labels);
    c->runs = t->mode == SG_REGION_MODE ? sg_arena_alloc(c->arena, w * h * sizeof *c->runs) : NULL;
    if (c->labels == NULL || (t->mode == SG_REGION_MODE && c->runs == NULL))
        return SG_FAIL_NOMEM(err);
    for (size_t i = 0; i < w * h; i++)
        c->labels[i] = (uint16_t)(cells->labels[i] < t->nterminals ? cells->labels[i] : t->nterminals);
    for (size_t y = 0; c->runs != NULL && y < h; y++)
        for (size_t x = w; x-- > 0;) {
            const size_t i = y * w + x;
            c->runs[i] = (uint16_t)(x + 1 < w && c->labels[i] == c->labels[i + 1] ? c->runs[i + 1] + 1 : 1);
        }
    return SG_OK;
}

/* Costs above those of the cheapest terminal of each cell: the chart's own copy. Over regions, where many cells are
 * added, small numbers also keep their digits. */
static sg_status copy_costs(sg_chart *c, const sg_parse_table *t, const sg_cells *cells, sg_error *err)
{
    const size_t n = cells->width * cells->height;
    long double sum = 0;
    c->costs = sg_arena_alloc(c->arena, t->nterminals * n * sizeof *c->costs + 1);
    if (c->costs == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t i = 0; i < n; i++) {
        double least = INFINITY;
        for (size_t k = 0; k < t->nterminals; k++) {
            const double v = cells->costs[k * n + i];
            if (isnan(v) || v == -INFINITY)
                return SG_FAIL(err, SG_EINVAL, "cell costs must be numbers or +infinity");
            least = fmin(least, v);
        }
        least = least == INFINITY ? 0 : least;
        sum += least;
        for (size_t k = 0; k < t->nterminals; k++)
            c->costs[k * n + i] = cells->costs[k * n + i] - least;
    }
    c->least_cost = (double)sum;
    return SG_OK;
}

static sg_status sum_costs(sg_chart *c, const sg_parse_table *t, sg_error *err)
{
    const size_t w = c->width, h = c->height, plane = (w + 1) * (h + 1), n = t->nterminals * plane;
    c->cost_sums = SG_NEW_ARRAY(c->arena, long double, n);
    c->cost_holes = SG_NEW_ARRAY(c->arena, uint32_t, n);
    if (c->cost_sums == NULL || c->cost_holes == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t k = 0; k < t->nterminals; k++)
        for (size_t y = 0; y < h; y++) {
            long double sum = 0;
            uint32_t holes = 0;
            for (size_t x = 0; x < w; x++) {
                const double v = c->costs[(k * h + y) * w + x];
                if (v == INFINITY)
                    holes++;
                else
                    sum += v;
                const size_t at = k * plane + (y + 1) * (w + 1) + x + 1;
                c->cost_sums[at] = c->cost_sums[at - w - 1] + sum;
                c->cost_holes[at] = c->cost_holes[at - w - 1] + holes;
            }
        }
    return SG_OK;
}

static sg_status take_costs(sg_chart *c, const sg_parse_table *t, const sg_cells *cells, sg_error *err)
{
    SG_TRY(copy_costs(c, t, cells, err));
    return t->mode == SG_REGION_MODE ? sum_costs(c, t, err) : SG_OK;
}

sg_status sg_chart_begin(sg_chart *c, const sg_parse_table *t, const sg_cells *cells, sg_chart_kind kind, sg_error *err)
{
    c->kind = SG_CHART_EMPTY;
    if (cells->width == 0 || cells->height == 0 || cells->width > SG_EARLEY_MAX_SIDE ||
        cells->height > SG_EARLEY_MAX_SIDE)
        return SG_FAIL(err, SG_EINVAL, "a lattice of %zu x %zu cells cannot be parsed: sides are 1 to %d", cells->width,
                       cells->height, SG_EARLEY_MAX_SIDE);
    if (t->tied_rules != NULL && cells->costs != NULL)
        return SG_FAIL(err, SG_EINVAL, "tied siblings with several derivations have no exact parse over cell costs");
    if ((cells->labels == NULL) == (cells->costs == NULL))
        return SG_FAIL(err, SG_EINVAL, "a parse wants either labels or costs");
    SG_TRY(fit_levels(c, t, cells, err));
    sg_arena_reset(c->arena);
    c->table = t;
    c->width = (uint32_t)cells->width;
    c->height = (uint32_t)cells->height;
    c->labels = c->runs = NULL;
    c->costs = NULL;
    c->cost_sums = NULL;
    c->cost_holes = NULL;
    c->states = 0;
    c->least_cost = 0;
    c->floor = -INFINITY;
    c->log_value = -INFINITY;
    c->index = SG_NEW_ARRAY(c->arena, sg_comps **, cells->width * cells->height);
    c->groups = SG_NEW_ARRAY(c->arena, sg_group *, cells->width * cells->height);
    if (c->index == NULL || c->groups == NULL)
        return SG_FAIL_NOMEM(err);
    SG_TRY(cells->labels != NULL ? take_labels(c, t, cells, err) : take_costs(c, t, cells, err));
    c->kind = kind;
    return SG_OK;
}

bool sg_chart_leaf_fits(const sg_chart *c, uint32_t x, uint32_t y, uint32_t x1, uint32_t y1)
{
    if (c->table->mode == SG_CELL_MODE)
        return x1 == x + 1 && y1 == y + 1;
    if (c->labels == NULL)
        return true;
    for (uint32_t j = y; j < y1; j++)
        if (c->runs[(size_t)j * c->width + x] < x1 - x ||
            c->labels[(size_t)j * c->width + x] != c->labels[(size_t)y * c->width + x])
            return false;
    return true;
}

double sg_chart_leaf_cost(const sg_chart *c, uint32_t terminal, uint32_t x, uint32_t y, uint32_t x1, uint32_t y1)
{
    if (c->labels != NULL)
        return c->labels[(size_t)y * c->width + x] == terminal ? 0 : INFINITY;
    if (c->table->mode == SG_CELL_MODE)
        return c->costs[((size_t)terminal * c->height + y) * c->width + x];
    const size_t w = c->width + 1, plane = w * (c->height + 1);
    const uint32_t *holes = c->cost_holes + terminal * plane;
    if (holes[y1 * w + x1] - holes[y * w + x1] - holes[y1 * w + x] + holes[y * w + x] != 0)
        return INFINITY;
    const long double *sum = c->cost_sums + terminal * plane;
    const long double cost = sum[y1 * w + x1] - sum[y * w + x1] - (sum[y1 * w + x] - sum[y * w + x]);
    return cost > 0 ? (double)cost : 0; /* it is, but for rounding */
}
