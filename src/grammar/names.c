/* SPDX-License-Identifier: GPL-3.0-or-later */
/* names.c - names to numbers, on uthash. */
#include "config.h"

#include "grammar/names.h"

#include <stddef.h>
#include <string.h>

#define HASH_NONFATAL_OOM 1
#define uthash_nonfatal_oom(entry) (failed = true)
#include <uthash.h>

typedef struct sg_name_entry {
    const char *name;
    uint32_t value;
    UT_hash_handle hh;
} sg_name_entry;

void sg_names_clear(sg_names *m)
{
    HASH_CLEAR(hh, m->entries);
}

bool sg_names_put(sg_names *m, const char *name, uint32_t value)
{
    bool failed = false;
    sg_name_entry *e = SG_NEW(m->arena, sg_name_entry);
    if (e == NULL)
        return false;
    e->name = name;
    e->value = value;
    HASH_ADD_KEYPTR(hh, m->entries, e->name, strlen(name), e);
    return !failed;
}

uint32_t sg_names_get(const sg_names *m, const char *name)
{
    sg_name_entry *e = NULL;
    HASH_FIND(hh, m->entries, name, strlen(name), e);
    return e != NULL ? e->value : UINT32_MAX;
}
