/* SPDX-License-Identifier: GPL-3.0-or-later */
/* regroup_priv.h - which neighbouring rows of a lattice become one row of columns.
 * Two rows correspond when their cells map one to one: wall window wall over wall balcony wall does, with the signature
 * {wall/wall, window/balcony}. At least two labels must take part, else any two rows of one label would. A row can
 * be in one pair only; pairs whose signature is most frequent in the data are formed first, so that a window goes with
 * the balcony below it in every image and not with that of the floor above it. */
#ifndef SG_LEARN_REGROUP_PRIV_H
#define SG_LEARN_REGROUP_PRIV_H

#include "core/arena.h"
#include "core/status.h"

#include <stddef.h>
#include <stdint.h>

typedef struct sg_regroup sg_regroup;

/** Frequencies of signatures, in the arena; NULL when memory is out. */
sg_regroup *sg_regroup_create(sg_arena *arena);

/** Count the signatures of a lattice's neighbouring rows. @param t [height][width] terminals, below nterminals
 *  @return SG_OK, SG_ENOMEM */
sg_status sg_regroup_count(sg_regroup *g, const uint32_t *t, size_t width, size_t height, size_t nterminals);

/** Partition of the rows into groups of one or two; without counts every row is alone.
 *  @param first  out [height + 1]: first row of each group, then height
 *  @return SG_OK, SG_ENOMEM */
sg_status sg_regroup_rows(const sg_regroup *g, const uint32_t *t, size_t width, size_t height, size_t nterminals,
                          size_t *first, size_t *ngroups);

/** Partition of the rows into bands of any height by least description length (regroup_floors.c).
 *  @param first  out [height + 1], as above; scratch comes from the arena. O(height^2 * cells) at most
 *  @return SG_OK, SG_ENOMEM */
sg_status sg_regroup_floors(const uint32_t *t, size_t width, size_t height, sg_arena *arena, size_t *first,
                            size_t *ngroups);

#endif
