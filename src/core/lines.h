/* SPDX-License-Identifier: GPL-3.0-or-later */
/* lines.h - small text tables: a file's lines, split at tabs. Line ends of any system, a byte order mark and a missing
 * last line end are accepted. */
#ifndef SG_CORE_LINES_H
#define SG_CORE_LINES_H

#include "core/arena.h"
#include "core/status.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct {
    const char *path;
    char *next;    /* where the next line begins; NULL after the last */
    char *text;    /* the line: NUL-terminated, without its line end; the caller may change it */
    size_t number; /* of the line, from 1 */
} sg_lines;

/** Read a text file whole into the arena; the lines live there.
 *  @param limit  more bytes than this are refused
 *  @return SG_OK, SG_EINPUT (missing, unreadable, too large, a NUL byte: no text), SG_ENOMEM */
sg_status sg_lines_open(const char *path, size_t limit, sg_arena *arena, sg_lines *out, sg_error *err);

/** Step to the next line that holds anything: blank lines and comments (lines that begin with # and a space, or hold
 *  one # alone) are passed over. @return false at the end */
bool sg_lines_next(sg_lines *l);

/** Cut the line at its tabs, in place. @param fields out [max] @return their number; max + 1 when there are more */
size_t sg_lines_split(sg_lines *l, char **fields, size_t max);

/** SG_EINPUT with "FILE:LINE:COL: error: ..."; at points into the line (NULL: its beginning). */
sg_status sg_lines_fail(const sg_lines *l, const char *at, sg_error *err, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

#endif
