/* SPDX-License-Identifier: GPL-3.0-or-later */
/* lattice.h - irregular label lattices: W x H cells with pixel boundaries, each cell holding a label (DESIGN 5.1), and
 * their files (*.lat, INTERFACES 5). */
#ifndef SG_PARSE_LATTICE_H
#define SG_PARSE_LATTICE_H

#include "core/arena.h"
#include "core/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#define SG_LATTICE_MAX_SIDE 4096 /* cells */
#define SG_LATTICE_MAX_LABELS 65534
#define SG_LATTICE_NO_LABEL UINT16_MAX /* what a label is mapped to that the other table does not have */

/** Everything is in the arena it was made in. */
typedef struct {
    size_t width, height;   /* cells */
    uint32_t *x;            /* [width + 1] pixel boundaries, increasing; unit cells when the file has none */
    uint32_t *y;            /* [height + 1], top row first */
    uint16_t *labels;       /* [height][width], indices into label_names */
    size_t nlabels;
    const char **label_names; /* [nlabels] distinct */
} sg_lattice;

/** Zeroed boundaries and labels in the arena; no label names. @return SG_OK, SG_EINVAL (a side is 0 or too long), SG_ENOMEM */
sg_status sg_lattice_create(size_t width, size_t height, sg_arena *arena, sg_lattice *out, sg_error *err);

/** Read a *.lat file (INTERFACES 5). Labels are numbered by their first appearance, in reading order. Blank lines and
 *  carriage returns at the ends of lines are passed over. Where boundaries may stand, a line that begins with the label
 *  'x' or 'y' is a row only if no number follows and its count of words fits a row.
 *  @return SG_OK, SG_EINPUT (FILE:LINE:COL), SG_ENOMEM */
sg_status sg_lattice_read(const char *path, sg_arena *arena, sg_lattice *out, sg_error *err);
/** The same from text in memory. @param name  stands for the file in messages */
sg_status sg_lattice_parse(const char *name, const char *text, size_t length, sg_arena *arena, sg_lattice *out,
                           sg_error *err);
/** @return SG_OK, SG_EINVAL (a label name that the format cannot hold: empty, with blanks, or beginning with #), SG_EIO */
sg_status sg_lattice_write(const sg_lattice *l, FILE *out, sg_error *err);
/** Write to a path: beside its place, then renamed. */
sg_status sg_lattice_save(const sg_lattice *l, const char *path, sg_error *err);

static inline uint16_t sg_lattice_label(const sg_lattice *l, size_t column, size_t row)
{
    return l->labels[row * l->width + column];
}

/** Index of a label name, or SG_LATTICE_NO_LABEL. */
uint16_t sg_lattice_find_label(const sg_lattice *l, const char *name);
/** Where the lattice's labels stand in another table of distinct names.
 *  @param map  out [l->nlabels]: index into names, or SG_LATTICE_NO_LABEL
 *  @return number of labels that the table does not have */
size_t sg_lattice_map_labels(const sg_lattice *l, const char *const *names, size_t nnames, uint16_t *map);
/** Column that holds pixel column x_px (row, of y_px): the last cell whose left (upper) boundary is not beyond it, by
 *  bisection. Pixels outside belong to the border cells. */
size_t sg_lattice_column_of(const sg_lattice *l, uint32_t x_px);
size_t sg_lattice_row_of(const sg_lattice *l, uint32_t y_px);

/** Same boundaries and same label names in all cells; the numbering of the labels may differ. */
bool sg_lattice_equal(const sg_lattice *a, const sg_lattice *b);
/** Deep copy into an arena. @return SG_OK, SG_ENOMEM */
sg_status sg_lattice_copy(const sg_lattice *l, sg_arena *arena, sg_lattice *out, sg_error *err);

#endif
