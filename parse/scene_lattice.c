/* SPDX-License-Identifier: GPL-3.0-or-later */
/* scene_lattice.c - label scenes as lattices. */
#include "parse/scene_lattice.h"

#include <stdbool.h>
#include <string.h>

/* Grid lines along one axis. */
typedef struct {
    size_t n;        /* pixels */
    uint32_t *index; /* [n + 1] number of the grid line at a pixel boundary */
    bool *cut;       /* [n + 1] */
} lines;

static sg_status create_lines(lines *l, size_t n, sg_arena *arena, sg_error *err)
{
    l->n = n;
    l->index = SG_NEW_ARRAY(arena, uint32_t, n + 1);
    l->cut = SG_NEW_ARRAY(arena, bool, n + 1);
    if (l->index == NULL || l->cut == NULL)
        return SG_FAIL_NOMEM(err);
    l->cut[0] = l->cut[n] = true;
    return SG_OK;
}

/* Number the lines; the count of cells between them. */
static size_t number_lines(lines *l)
{
    size_t found = 0;
    for (size_t i = 0; i <= l->n; i++)
        if (l->cut[i])
            l->index[i] = (uint32_t)found++;
    return found - 1;
}

static void list_lines(const lines *l, uint32_t *at)
{
    for (size_t i = 0; i <= l->n; i++)
        if (l->cut[i])
            *at++ = (uint32_t)i;
}

static sg_status name_labels(const sg_grammar *g, uint16_t *number_of, sg_arena *arena, sg_lattice *l, sg_error *err)
{
    const size_t nsymbols = sg_grammar_symbol_count(g);
    l->label_names = SG_NEW_ARRAY(arena, const char *, nsymbols);
    if (l->label_names == NULL)
        return SG_FAIL_NOMEM(err);
    l->nlabels = 0;
    for (sg_sym s = 0; s < nsymbols; s++) {
        const sg_symbol *symbol = sg_grammar_symbol(g, s);
        if (symbol->kind != SG_SYMBOL_LABEL)
            continue;
        if (l->nlabels == SG_LATTICE_MAX_LABELS)
            return SG_FAIL(err, SG_EINVAL, "more than the %d labels that a lattice may have", SG_LATTICE_MAX_LABELS);
        char *name = sg_arena_string(arena, symbol->name);
        if (name == NULL)
            return SG_FAIL_NOMEM(err);
        number_of[s] = (uint16_t)l->nlabels;
        l->label_names[l->nlabels++] = name;
    }
    return SG_OK;
}

static void fill_cells(const sg_label_scene *scene, const lines *x, const lines *y, const uint16_t *number_of,
                       sg_lattice *l)
{
    for (size_t i = 0; i < scene->nrects; i++) {
        const sg_label_rect *r = scene->rects + i;
        const size_t x0 = x->index[sg_label_scene_pixel(r->x0, scene->width, x->n)],
                     x1 = x->index[sg_label_scene_pixel(r->x1, scene->width, x->n)],
                     y0 = y->index[sg_label_scene_pixel(r->y0, scene->height, y->n)],
                     y1 = y->index[sg_label_scene_pixel(r->y1, scene->height, y->n)];
        for (size_t row = y0; row < y1; row++)
            for (size_t column = x0; column < x1; column++)
                l->labels[row * l->width + column] = number_of[r->label];
    }
}

static void mark_cuts(const sg_label_scene *scene, lines *x, lines *y)
{
    for (size_t i = 0; i < scene->nrects; i++) {
        const sg_label_rect *r = scene->rects + i;
        const size_t x0 = sg_label_scene_pixel(r->x0, scene->width, x->n),
                     x1 = sg_label_scene_pixel(r->x1, scene->width, x->n),
                     y0 = sg_label_scene_pixel(r->y0, scene->height, y->n),
                     y1 = sg_label_scene_pixel(r->y1, scene->height, y->n);
        if (x0 < x1 && y0 < y1) /* what no pixel sees cuts nothing */
            x->cut[x0] = x->cut[x1] = y->cut[y0] = y->cut[y1] = true;
    }
}

sg_status sg_lattice_of_scene(const sg_label_scene *scene, const sg_grammar *g, size_t width, size_t height,
                              sg_arena *arena, sg_lattice *out, sg_error *err)
{
    if (scene->nrects == 0 || width == 0 || height == 0)
        return SG_FAIL(err, SG_EINVAL, "an empty scene has no lattice");
    lines x, y;
    sg_lattice l;
    uint16_t *number_of = SG_NEW_ARRAY(arena, uint16_t, sg_grammar_symbol_count(g));
    if (number_of == NULL)
        return SG_FAIL_NOMEM(err);
    SG_TRY(create_lines(&x, width, arena, err));
    SG_TRY(create_lines(&y, height, arena, err));
    mark_cuts(scene, &x, &y);
    const size_t columns = number_lines(&x), rows = number_lines(&y);
    SG_TRY(sg_lattice_create(columns, rows, arena, &l, err));
    SG_TRY(name_labels(g, number_of, arena, &l, err));
    list_lines(&x, l.x);
    list_lines(&y, l.y);
    fill_cells(scene, &x, &y, number_of, &l);
    *out = l;
    return SG_OK;
}
