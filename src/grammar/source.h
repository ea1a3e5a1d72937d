/* SPDX-License-Identifier: GPL-3.0-or-later */
/* source.h - the text that a grammar was read from, and how an error points into it. */
#ifndef SG_GRAMMAR_SOURCE_H
#define SG_GRAMMAR_SOURCE_H

#include "core/arena.h"
#include "core/status.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

/** A place in a source. Without text (the exchange form) line is 0 and offset is the number of a rule, from 1; 0: none. */
typedef struct {
    uint32_t offset; /* bytes from the beginning */
    uint32_t line;   /* from 1 */
} sg_pos;

/** A file whose text is a part of a source's. */
typedef struct {
    const char *name;
    size_t begin;
} sg_source_part;

typedef struct {
    const char *name; /* of the file, for messages */
    const char *text; /* NULL when there is none: then errors name a rule */
    size_t length;
    sg_source_part *parts; /* files whose texts were added, in order; before the first is the text of `name` */
    size_t nparts;
    char *own; /* the text, when sg_source_add() has made it: with room for more */
    size_t own_capacity, parts_capacity;
} sg_source;

/** Add the text of another file; positions in it are those in the whole text, which begin at *base, with their own lines.
 *  @return SG_OK, SG_ENOMEM */
sg_status sg_source_add(sg_source *s, const sg_source *other, sg_arena *arena, size_t *base, sg_error *err);

/** Write "NAME:LINE:COL: error: sentence", the line and a caret under it into err; columns count characters, from 1.
 *  @return SG_EINPUT */
sg_status sg_source_fail(const sg_source *s, sg_pos at, sg_error *err, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/** The added file that a place lies in; NULL: none. */
const char *sg_source_imported(const sg_source *s, sg_pos at);

/** The same text with "warning" for "error" into message. */
void sg_source_warning(const sg_source *s, sg_pos at, char *message, size_t size, const char *sentence);

/** Refuse what no text file holds: invalid UTF-8 and control characters. @return SG_OK, SG_EINPUT */
sg_status sg_source_check(const sg_source *s, sg_error *err);

#endif
