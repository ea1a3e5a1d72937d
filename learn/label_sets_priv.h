/* SPDX-License-Identifier: GPL-3.0-or-later */
/* label_sets_priv.h - which labels a symbol can reach, as bit sets. */
#ifndef SG_LEARN_LABEL_SETS_PRIV_H
#define SG_LEARN_LABEL_SETS_PRIV_H

#include "core/arena.h"
#include "core/status.h"
#include "grammar/split.h"

#include <stdbool.h>
#include <stdint.h>

typedef struct {
    size_t nsymbols, nwords;
    uint64_t *bits; /* [nsymbols][nwords] */
} sg_label_sets;

/** Closure over all rules. @param out in the arena @return SG_OK, SG_ENOMEM */
sg_status sg_label_sets_of(const sg_split_form *f, sg_arena *arena, sg_label_sets *out, sg_error *err);
/** Number of labels that a symbol reaches. */
size_t sg_label_sets_size(const sg_label_sets *sets, uint32_t symbol);

#endif
