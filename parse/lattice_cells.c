/* SPDX-License-Identifier: GPL-3.0-or-later */
/* lattice_cells.c - labels of a lattice to terminals of a grammar. */
#include "config.h"

#include "parse/lattice_cells.h"

#include <string.h>

static uint16_t terminal_of(const sg_split_form *form, const char *name)
{
    for (size_t t = 0; t < form->nterminals; t++)
        if (strcmp(form->terminal_names[t], name) == 0)
            return (uint16_t)t;
    return UINT16_MAX;
}

sg_status sg_lattice_cells(const sg_lattice *l, const sg_split_form *form, sg_arena *arena, sg_cells *out,
                           sg_error *err)
{
    if (form->nterminals >= UINT16_MAX)
        return SG_FAIL(err, SG_EINVAL, "the grammar has too many terminals");
    const size_t ncells = l->width * l->height;
    uint16_t *labels = sg_arena_alloc(arena, ncells * sizeof *labels);
    uint16_t *terminals = sg_arena_alloc(arena, (l->nlabels + 1) * sizeof *terminals);
    if (labels == NULL || terminals == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t i = 0; i < l->nlabels; i++)
        terminals[i] = terminal_of(form, l->label_names[i]);
    for (size_t i = 0; i < ncells; i++)
        labels[i] = terminals[l->labels[i]];
    *out = (sg_cells){l->width, l->height, labels, NULL};
    return SG_OK;
}
