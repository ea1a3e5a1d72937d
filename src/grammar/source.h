/* SPDX-License-Identifier: GPL-3.0-or-later */
/* source.h - the text that a grammar was read from, and how an error points into it. */
#ifndef SG_GRAMMAR_SOURCE_H
#define SG_GRAMMAR_SOURCE_H

#include "core/status.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

/** A place in a source. Without text (the exchange form) line is 0 and offset is the number of a rule, from 1; 0: none. */
typedef struct {
    uint32_t offset; /* bytes from the beginning */
    uint32_t line;   /* from 1 */
} sg_pos;

typedef struct {
    const char *name; /* of the file, for messages */
    const char *text; /* NULL when there is none: then errors name a rule */
    size_t length;
} sg_source;

/** Write "NAME:LINE:COL: error: sentence", the line and a caret under it into err; columns count characters, from 1.
 *  @return SG_EINPUT */
sg_status sg_source_fail(const sg_source *s, sg_pos at, sg_error *err, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/** Refuse what no text file holds: invalid UTF-8 and control characters. @return SG_OK, SG_EINPUT */
sg_status sg_source_check(const sg_source *s, sg_error *err);

#endif
