/* SPDX-License-Identifier: GPL-3.0-or-later */
/* arena.h - memory with one lifetime: a parse, a chain, a proposal.
 * Allocation is a pointer bump, single pieces are never freed, and a mark gives back all that came after it. With
 * --enable-arena-debug each piece is a malloc of its own, so that AddressSanitizer sees stale pointers. */
#ifndef SG_CORE_ARENA_H
#define SG_CORE_ARENA_H

#include <stddef.h>

typedef struct sg_arena sg_arena;

typedef struct {
    void *block;
    size_t used;
} sg_mark;

/** An empty arena, or NULL when memory is out. */
sg_arena *sg_arena_create(void);
/** Frees everything in it; NULL is fine. */
void sg_arena_free(sg_arena *a);

/** size bytes, aligned for any type (64 bytes from 4 KiB upwards), contents undefined; NULL when memory is out. */
void *sg_arena_alloc(sg_arena *a, size_t size);
/** n * size bytes of zeros; NULL when memory is out or the product overflows. */
void *sg_arena_calloc(sg_arena *a, size_t n, size_t size);
/** Copy of n bytes, of a string, of a printed string; NULL when memory is out. */
void *sg_arena_copy(sg_arena *a, const void *src, size_t n);
char *sg_arena_string(sg_arena *a, const char *s);
char *sg_arena_printf(sg_arena *a, const char *format, ...) __attribute__((format(printf, 2, 3)));

/** What comes after the mark is given back by the rewind: pointers to it are dead. Blocks are kept for reuse. */
sg_mark sg_arena_mark(sg_arena *a);
void sg_arena_rewind(sg_arena *a, sg_mark mark);
/** Rewind to empty. */
void sg_arena_reset(sg_arena *a);
/** Bytes handed out since the arena was empty. */
size_t sg_arena_used(const sg_arena *a);

#define SG_NEW(arena, type) ((type *)sg_arena_calloc((arena), 1, sizeof(type)))
#define SG_NEW_ARRAY(arena, type, n) ((type *)sg_arena_calloc((arena), (n), sizeof(type)))

#endif
