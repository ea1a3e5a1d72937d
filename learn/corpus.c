/* SPDX-License-Identifier: GPL-3.0-or-later */
/* corpus.c - lattices with labels as terminals. */
#include "config.h"

#include "learn/corpus.h"

static sg_status map_cells(const sg_lattice *l, const sg_split_form *form, sg_arena *arena, sg_cells *out)
{
    const size_t n = l->width * l->height;
    uint16_t *map = SG_NEW_ARRAY(arena, uint16_t, l->nlabels + 1), *labels = SG_NEW_ARRAY(arena, uint16_t, n);
    if (map == NULL || labels == NULL)
        return SG_ENOMEM;
    sg_lattice_map_labels(l, form->terminal_names, form->nterminals, map);
    for (size_t i = 0; i < n; i++)
        labels[i] = map[l->labels[i]];
    *out = (sg_cells){.width = l->width, .height = l->height, .labels = labels};
    return SG_OK;
}

sg_status sg_corpus_create(const sg_lattice *lattices, size_t n, const sg_split_form *form, sg_arena *arena,
                           sg_corpus *out, sg_error *err)
{
    sg_cells *cells = SG_NEW_ARRAY(arena, sg_cells, n + 1);
    if (cells == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t i = 0; i < n; i++)
        if (map_cells(&lattices[i], form, arena, &cells[i]) != SG_OK)
            return SG_FAIL_NOMEM(err);
    *out = (sg_corpus){n, lattices, cells};
    return SG_OK;
}
