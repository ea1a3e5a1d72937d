/* SPDX-License-Identifier: GPL-3.0-or-later */
/* array.c - growing a malloc'd array. */
#include "core/array.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

bool sg_array_grow(void *items, size_t *capacity, size_t need, size_t size)
{
    if (need <= *capacity)
        return true;
    size_t n = *capacity < 8 ? 8 : *capacity;
    while (n < need) {
        if (n > SIZE_MAX / 2)
            return false;
        n *= 2;
    }
    if (n > SIZE_MAX / size)
        return false;
    void *old;
    memcpy(&old, items, sizeof old); /* any object pointer type may stand behind items */
    void *p = realloc(old, n * size);
    if (p == NULL)
        return false;
    memcpy(items, &p, sizeof p);
    *capacity = n;
    return true;
}
