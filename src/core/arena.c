/* SPDX-License-Identifier: GPL-3.0-or-later */
/* arena.c - a list of blocks, each twice as large as the one before it; the current one is bumped. */
#include "config.h"

#include "core/arena.h"

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct block {
    struct block *next; /* towards larger, emptier blocks; kept after a rewind */
    struct block *prev;
    size_t size, used;
} block;

struct sg_arena {
    block *first, *current;
};

enum { SMALL_ALIGN = 16, LARGE_ALIGN = 64, LARGE_FROM = 4096, FIRST_BLOCK = 16384 };

#define HEADER ((sizeof(block) + LARGE_ALIGN - 1) / LARGE_ALIGN * LARGE_ALIGN)

sg_arena *sg_arena_create(void)
{
    return calloc(1, sizeof(sg_arena));
}

static void free_from(block *b)
{
    while (b != NULL) {
        block *next = b->next;
        free(b);
        b = next;
    }
}

void sg_arena_free(sg_arena *a)
{
    if (a == NULL)
        return;
    free_from(a->first);
    free(a);
}

static block *new_block(sg_arena *a, size_t size)
{
    if (size > SIZE_MAX / 2 - HEADER)
        return NULL;
    const size_t total = (HEADER + size + LARGE_ALIGN - 1) / LARGE_ALIGN * LARGE_ALIGN;
    block *b = aligned_alloc(LARGE_ALIGN, total);
    if (b == NULL)
        return NULL;
    b->size = total - HEADER;
    b->used = 0;
    b->prev = a->current;
    b->next = a->current != NULL ? a->current->next : a->first;
    if (b->next != NULL)
        b->next->prev = b;
    if (a->current != NULL)
        a->current->next = b;
    else
        a->first = b;
    return b;
}

#ifndef SG_ARENA_DEBUG
/* Offset at which size bytes fit in b, or SIZE_MAX. */
static size_t place(const block *b, size_t size)
{
    const size_t align = size >= LARGE_FROM ? LARGE_ALIGN : SMALL_ALIGN;
    const size_t at = (b->used + align - 1) / align * align;
    return at <= b->size && size <= b->size - at ? at : SIZE_MAX;
}

/* A block after the current one in which size bytes fit: a kept one, else a new one. */
static block *advance(sg_arena *a, size_t size)
{
    block *next = a->current != NULL ? a->current->next : a->first;
    if (next != NULL && place(next, size) != SIZE_MAX)
        return next;
    size_t want = a->current != NULL ? 2 * a->current->size : FIRST_BLOCK;
    if (want < size + LARGE_ALIGN)
        want = size + LARGE_ALIGN;
    return new_block(a, want);
}
#endif

void *sg_arena_alloc(sg_arena *a, size_t size)
{
    if (size == 0)
        size = 1;
#ifdef SG_ARENA_DEBUG
    block *b = new_block(a, size);
    if (b == NULL)
        return NULL;
    a->current = b;
    b->used = size;
    return (char *)b + HEADER;
#else
    block *b = a->current;
    size_t at = b != NULL ? place(b, size) : SIZE_MAX;
    if (at == SIZE_MAX) {
        if (size > SIZE_MAX / 4)
            return NULL;
        b = advance(a, size);
        if (b == NULL)
            return NULL;
        a->current = b;
        at = place(b, size);
    }
    b->used = at + size;
    return (char *)b + HEADER + at;
#endif
}

void *sg_arena_calloc(sg_arena *a, size_t n, size_t size)
{
    if (size != 0 && n > SIZE_MAX / size)
        return NULL;
    void *p = sg_arena_alloc(a, n * size);
    if (p != NULL)
        memset(p, 0, n * size);
    return p;
}

void *sg_arena_copy(sg_arena *a, const void *src, size_t n)
{
    void *p = sg_arena_alloc(a, n);
    if (p != NULL && n > 0)
        memcpy(p, src, n);
    return p;
}

char *sg_arena_string(sg_arena *a, const char *s)
{
    return sg_arena_copy(a, s, strlen(s) + 1);
}

char *sg_arena_printf(sg_arena *a, const char *format, ...)
{
    va_list ap;
    va_start(ap, format);
    va_list again;
    va_copy(again, ap);
    const int n = vsnprintf(NULL, 0, format, ap);
    va_end(ap);
    char *s = n >= 0 ? sg_arena_alloc(a, (size_t)n + 1) : NULL;
    if (s != NULL)
        vsnprintf(s, (size_t)n + 1, format, again);
    va_end(again);
    return s;
}

sg_mark sg_arena_mark(sg_arena *a)
{
    return (sg_mark){a->current, a->current != NULL ? a->current->used : 0};
}

void sg_arena_rewind(sg_arena *a, sg_mark mark)
{
    block *to = mark.block;
#ifdef SG_ARENA_DEBUG
    block *dead = to != NULL ? to->next : a->first;
    free_from(dead);
    if (to != NULL)
        to->next = NULL;
    else
        a->first = NULL;
#else
    for (block *b = a->current; b != to && b != NULL; b = b->prev)
        b->used = 0;
#endif
    a->current = to;
    if (to != NULL)
        to->used = mark.used;
}

void sg_arena_reset(sg_arena *a)
{
    sg_arena_rewind(a, (sg_mark){NULL, 0});
}

size_t sg_arena_used(const sg_arena *a)
{
    size_t n = 0;
    for (const block *b = a->current; b != NULL; b = b->prev)
        n += b->used;
    return n;
}
