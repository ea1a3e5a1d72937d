/* SPDX-License-Identifier: GPL-3.0-or-later */
/* import_tally.c - what a class table lacks, counted and told in one sentence. */
#include "config.h"

#include "data/import_priv.h"

#include <stdio.h>
#include <string.h>

#define HASH_NONFATAL_OOM 1
#include <uthash.h>

enum { MAX_NAMED = 8 };

typedef struct {
    const char *what;
    size_t count, x, y; /* of the first */
    UT_hash_handle hh;
} entry;

struct sg_import_tally {
    sg_arena *arena;
    entry *entries; /* hash, in the order of their first sight */
};

sg_import_tally *sg_import_tally_begin(sg_arena *arena)
{
    sg_import_tally *t = SG_NEW(arena, sg_import_tally);
    if (t != NULL)
        t->arena = arena;
    return t;
}

sg_status sg_import_tally_add(sg_import_tally *t, const char *what, size_t x, size_t y, sg_error *err)
{
    entry *e = NULL;
    HASH_FIND_STR(t->entries, what, e);
    if (e != NULL) {
        e->count++;
        return SG_OK;
    }
    e = SG_NEW(t->arena, entry);
    if (e == NULL || (e->what = sg_arena_string(t->arena, what)) == NULL)
        return SG_FAIL_NOMEM(err);
    e->count = 1;
    e->x = x;
    e->y = y;
    HASH_ADD_KEYPTR(hh, t->entries, e->what, strlen(e->what), e);
    return e->hh.tbl != NULL ? SG_OK : SG_FAIL_NOMEM(err);
}

/* Most frequent first; the sort is stable, so equals stay in the order of their first sight. */
static int compare_entries(const entry *a, const entry *b)
{
    return (a->count < b->count) - (a->count > b->count);
}

/* Append to a sentence of limited length. */
static void append(char *text, size_t size, const char *more)
{
    const size_t n = strlen(text);
    snprintf(text + n, size - n, "%s", more);
}

static void describe(const entry *e, bool pixels, const char *unit, char *out, size_t size)
{
    const char *plural = e->count == 1 ? "" : "s";
    if (pixels)
        snprintf(out, size, "%.80s (%zu %s%s, the first at column %zu, row %zu)", e->what, e->count, unit, plural, e->x,
                 e->y);
    else
        snprintf(out, size, "'%.80s' (%zu %s%s)", e->what, e->count, unit, plural);
}

sg_status sg_import_tally_end(sg_import_tally *t, const char *path, const char *noun, const char *unit, sg_error *err)
{
    char text[900] = "", one[200];
    const size_t n = HASH_COUNT(t->entries);
    size_t named = 0;
    HASH_SORT(t->entries, compare_entries);
    for (const entry *e = t->entries; e != NULL && named < MAX_NAMED; e = e->hh.next, named++) {
        describe(e, strcmp(unit, "pixel") == 0, unit, one, sizeof one);
        append(text, sizeof text, named > 0 ? ", " : "");
        append(text, sizeof text, one);
    }
    HASH_CLEAR(hh, t->entries);
    if (n == 0)
        return SG_OK;
    if (n > named) {
        snprintf(one, sizeof one, " and %zu more", n - named);
        append(text, sizeof text, one);
    }
    return SG_FAIL(err, SG_EINPUT, "%s: %zu %s%s not in the class table: %s", path, n, noun, n == 1 ? " is" : "s are",
                   text);
}
