/* SPDX-License-Identifier: GPL-3.0-or-later */
/* classes.h - class tables: pixel index to class name and colour (INTERFACES 3).
 * Two indices with one name are one class; indices named 'ignore' are left out of learning and scores. Classes are
 * numbered by the order of their distinct names, by first index. */
#ifndef SG_IMAGE_CLASSES_H
#define SG_IMAGE_CLASSES_H

#include "core/status.h"

#include <stddef.h>
#include <stdint.h>

#define SG_CLASS_IGNORE 255  /* class of an ignored pixel */
#define SG_CLASS_UNKNOWN 254 /* class of an index that the table does not list */
#define SG_MAX_CLASSES 250

typedef struct {
    size_t nclasses; /* distinct names that are not 'ignore' */
    char *names[SG_MAX_CLASSES];
    uint32_t colors[SG_MAX_CLASSES];  /* 0xRRGGBB, of the first index with that name */
    uint8_t first_index[SG_MAX_CLASSES]; /* the pixel index to write for a class */
    uint8_t class_of[256];            /* pixel index -> class, SG_CLASS_IGNORE or SG_CLASS_UNKNOWN */
    uint32_t index_colors[256];       /* palette over pixel indices, for writing */
} sg_classes;

/** Read a class table. Names hold no blanks: lattices and folds are lists of words.
 *  @return SG_OK, SG_EINPUT (FILE:LINE:COL: what is wrong; no class at all), SG_ENOMEM; on failure out is untouched */
sg_status sg_classes_read(const char *path, sg_classes *out, sg_error *err);
/** A table of n classes whose pixel indices are 0..n-1. names[i] may be 'ignore' or repeat.
 *  @return SG_OK, SG_EINVAL (n is 0 or over 256, a name is empty or holds a blank, nothing but 'ignore'), SG_ENOMEM */
sg_status sg_classes_create(size_t n, const char *const *names, const uint32_t *colors, sg_classes *out, sg_error *err);
/** Write every index of the table. @return SG_OK, SG_EIO */
sg_status sg_classes_write(const char *path, const sg_classes *c, sg_error *err);
/** Free the names and zero the table; a zeroed one is fine. */
void sg_classes_clear(sg_classes *c);
/** Class of a name, or -1. */
int sg_classes_find(const sg_classes *c, const char *name);

#endif
