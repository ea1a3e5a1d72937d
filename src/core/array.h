/* SPDX-License-Identifier: GPL-3.0-or-later */
/* array.h - growing a malloc'd array. */
#ifndef SG_CORE_ARRAY_H
#define SG_CORE_ARRAY_H

#include <stdbool.h>
#include <stddef.h>

/** Make room for `need` items of `size` bytes: at least doubles. On failure the array is as it was.
 *  @param items  address of the array pointer (a pointer to any object pointer)
 *  @return false when memory is out */
bool sg_array_grow(void *items, size_t *capacity, size_t need, size_t size);

#define SG_GROW(array, capacity, need) sg_array_grow(&(array), &(capacity), (need), sizeof *(array))

#endif
