/* SPDX-License-Identifier: GPL-3.0-or-later */
/* lattice_loss.h - what a lattice shows wrong, by class and by cause.
 * Its cause is what can be told from the map alone: the region (4-connected pixels of one class) that a wrong pixel
 * belongs to is shown nowhere, or it is shown and the pixel is where its outline and the cells' do not agree. */
#ifndef SG_PARSE_LATTICE_LOSS_H
#define SG_PARSE_LATTICE_LOSS_H

#include "core/arena.h"
#include "core/status.h"
#include "parse/lattice_fit.h"

#include <stddef.h>

enum { SG_LATTICE_NEAR_PX = 2, SG_LATTICE_THIN_PX = 4 };

typedef enum {
    SG_LOSS_MISALIGNED, /* a cell of the pixel's class is at most SG_LATTICE_NEAR_PX away: the outline is beside the line */
    SG_LOSS_IRREGULAR,  /* further away: slanted, round or stepped outlines, and outlines that no line follows */
    SG_LOSS_THIN,       /* no pixel of the region is right, and it is at most SG_LATTICE_THIN_PX wide or high */
    SG_LOSS_REGION,     /* no pixel of the region is right: the structure has no cell of its own */
    SG_LOSS_CAUSES
} sg_loss_cause;

/** Name of a cause for tables. */
const char *sg_loss_cause_name(sg_loss_cause cause);

/** Counts over any number of lattices, px. */
typedef struct {
    size_t nclasses;
    size_t *confusion; /* [nclasses][nclasses]: truth, then what is shown; right pixels on the diagonal */
    size_t *causes;    /* [nclasses][SG_LOSS_CAUSES] of the wrong pixels, by true class */
    size_t *near_line; /* [nclasses] wrong pixels that are at most SG_LATTICE_NEAR_PX from any line of the lattice */
} sg_lattice_loss;

/** All zero, in the arena. @return SG_OK, SG_ENOMEM */
sg_status sg_lattice_loss_create(size_t nclasses, sg_arena *arena, sg_lattice_loss *out, sg_error *err);
/** Add what a fit loses of its source. @return SG_OK, SG_ENOMEM (then nothing is added) */
sg_status sg_lattice_loss_add(const sg_lattice_source *source, const sg_lattice_fit *f, sg_arena *scratch,
                              sg_lattice_loss *loss, sg_error *err);
/** Add the counts of another. */
void sg_lattice_loss_merge(const sg_lattice_loss *from, sg_lattice_loss *to);

/** Sums of a row of the confusion: pixels of a true class, and those of them that are shown wrong. */
size_t sg_lattice_loss_pixels(const sg_lattice_loss *loss, size_t class);
size_t sg_lattice_loss_wrong(const sg_lattice_loss *loss, size_t class);

#endif
