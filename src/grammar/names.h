/* SPDX-License-Identifier: GPL-3.0-or-later */
/* names.h - a map from names to numbers. */
#ifndef SG_GRAMMAR_NAMES_H
#define SG_GRAMMAR_NAMES_H

#include "core/arena.h"

#include <stdbool.h>
#include <stdint.h>

typedef struct {
    struct sg_name_entry *entries; /* uthash's head */
    sg_arena *arena;               /* entries live there; names are borrowed */
} sg_names;

void sg_names_clear(sg_names *m);
/** @return false when memory is out */
bool sg_names_put(sg_names *m, const char *name, uint32_t value);
/** The number of a name, UINT32_MAX when it has none. */
uint32_t sg_names_get(const sg_names *m, const char *name);

#endif
