/* SPDX-License-Identifier: GPL-3.0-or-later */
/* lattice.h - irregular label lattices: W x H cells with pixel boundaries, each cell holding a label (DESIGN 5.1). */
#ifndef SG_PARSE_LATTICE_H
#define SG_PARSE_LATTICE_H

#include "core/arena.h"
#include "core/status.h"

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/** Everything is in the arena it was made in. */
typedef struct {
    size_t width, height;   /* cells */
    uint32_t *x;            /* [width + 1] pixel boundaries, increasing; unit cells when the file has none */
    uint32_t *y;            /* [height + 1], top row first */
    uint16_t *labels;       /* [height][width], indices into label_names */
    size_t nlabels;
    const char **label_names; /* [nlabels] distinct */
} sg_lattice;

/** Read a *.lat file (INTERFACES 5). @return SG_OK, SG_EINPUT (FILE:LINE:COL), SG_ENOMEM */
sg_status sg_lattice_read(const char *path, sg_arena *arena, sg_lattice *out, sg_error *err);
sg_status sg_lattice_write(const sg_lattice *l, FILE *out, sg_error *err);

#define SG_LATTICE_MAX_SIDE 4096 /* cells */

#endif
