/* SPDX-License-Identifier: GPL-3.0-or-later */
/* lattice.c - label lattices in memory: making, looking up, comparing, copying. */
#include "parse/lattice.h"

#include <string.h>

sg_status sg_lattice_create(size_t width, size_t height, sg_arena *arena, sg_lattice *out, sg_error *err)
{
    if (width == 0 || height == 0 || width > SG_LATTICE_MAX_SIDE || height > SG_LATTICE_MAX_SIDE)
        return SG_FAIL(err, SG_EINVAL, "a lattice of %zu x %zu cells: each side must be 1 to %d", width, height,
                       SG_LATTICE_MAX_SIDE);
    sg_lattice l = {.width = width, .height = height};
    l.x = SG_NEW_ARRAY(arena, uint32_t, width + 1);
    l.y = SG_NEW_ARRAY(arena, uint32_t, height + 1);
    l.labels = SG_NEW_ARRAY(arena, uint16_t, width * height);
    if (l.x == NULL || l.y == NULL || l.labels == NULL)
        return SG_FAIL_NOMEM(err);
    *out = l;
    return SG_OK;
}

static uint16_t find_name(const char *const *names, size_t nnames, const char *name)
{
    for (size_t i = 0; i < nnames && i < SG_LATTICE_NO_LABEL; i++)
        if (strcmp(names[i], name) == 0)
            return (uint16_t)i;
    return SG_LATTICE_NO_LABEL;
}

uint16_t sg_lattice_find_label(const sg_lattice *l, const char *name)
{
    return find_name(l->label_names, l->nlabels, name);
}

size_t sg_lattice_map_labels(const sg_lattice *l, const char *const *names, size_t nnames, uint16_t *map)
{
    size_t missing = 0;
    for (size_t i = 0; i < l->nlabels; i++) {
        map[i] = find_name(names, nnames, l->label_names[i]);
        missing += map[i] == SG_LATTICE_NO_LABEL;
    }
    return missing;
}

static size_t cell_of(const uint32_t *boundary, size_t ncells, uint32_t px)
{
    size_t low = 0, high = ncells; /* boundary[low] <= px < boundary[high], but for pixels outside */
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        if (boundary[middle] <= px)
            low = middle;
        else
            high = middle;
    }
    return low;
}

size_t sg_lattice_column_of(const sg_lattice *l, uint32_t x_px)
{
    return cell_of(l->x, l->width, x_px);
}

size_t sg_lattice_row_of(const sg_lattice *l, uint32_t y_px)
{
    return cell_of(l->y, l->height, y_px);
}

bool sg_lattice_equal(const sg_lattice *a, const sg_lattice *b)
{
    if (a->width != b->width || a->height != b->height ||
        memcmp(a->x, b->x, (a->width + 1) * sizeof *a->x) != 0 ||
        memcmp(a->y, b->y, (a->height + 1) * sizeof *a->y) != 0)
        return false;
    for (size_t i = 0; i < a->width * a->height; i++)
        if (strcmp(a->label_names[a->labels[i]], b->label_names[b->labels[i]]) != 0)
            return false;
    return true;
}

sg_status sg_lattice_copy(const sg_lattice *l, sg_arena *arena, sg_lattice *out, sg_error *err)
{
    sg_lattice copy;
    SG_TRY(sg_lattice_create(l->width, l->height, arena, &copy, err));
    memcpy(copy.x, l->x, (l->width + 1) * sizeof *l->x);
    memcpy(copy.y, l->y, (l->height + 1) * sizeof *l->y);
    memcpy(copy.labels, l->labels, l->width * l->height * sizeof *l->labels);
    copy.nlabels = l->nlabels;
    copy.label_names = SG_NEW_ARRAY(arena, const char *, l->nlabels + 1);
    if (copy.label_names == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t i = 0; i < l->nlabels; i++)
        if ((copy.label_names[i] = sg_arena_string(arena, l->label_names[i])) == NULL)
            return SG_FAIL_NOMEM(err);
    *out = copy;
    return SG_OK;
}
