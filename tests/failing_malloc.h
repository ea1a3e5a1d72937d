/* SPDX-License-Identifier: GPL-3.0-or-later */
/* failing_malloc.h - counts the allocations of a test program and its static libraries, and makes one of them fail.
 * The program is linked with $(WRAP_MALLOC), which sends their calls here. Include it in one file only. */
#ifndef SG_TESTS_FAILING_MALLOC_H
#define SG_TESTS_FAILING_MALLOC_H

#include <stddef.h>
#include <stdlib.h>

void *__real_malloc(size_t n);
void *__real_calloc(size_t n, size_t size);
void *__real_realloc(void *p, size_t n);
void *__wrap_malloc(size_t n);
void *__wrap_calloc(size_t n, size_t size);
void *__wrap_realloc(void *p, size_t n);

static size_t test_allocations;      /* so far */
static size_t test_fail_at = (size_t)-1; /* the allocation with this number fails, and no other */

void *__wrap_malloc(size_t n)
{
    return test_allocations++ == test_fail_at ? NULL : __real_malloc(n);
}

void *__wrap_calloc(size_t n, size_t size)
{
    return test_allocations++ == test_fail_at ? NULL : __real_calloc(n, size);
}

void *__wrap_realloc(void *p, size_t n)
{
    return test_allocations++ == test_fail_at ? NULL : __real_realloc(p, n);
}

/* The k-th allocation from now on fails, counted from 0. */
static inline void test_fail_allocation(size_t k)
{
    test_allocations = 0;
    test_fail_at = k;
}

/* No more failures; true when the one that was asked for happened. */
static inline int test_allocation_failed(void)
{
    const int happened = test_allocations > test_fail_at;
    test_fail_at = (size_t)-1;
    return happened;
}

#endif
