/* SPDX-License-Identifier: GPL-3.0-or-later */
/* facade_lines.h - the boundary lines of a parse, and how sure the samples are of each.
 *
 * A line is a longest straight run of boundary between pixels of different labels. A sample has the line when, at most
 * SG_LINE_REACH_PX away from it, labels change across at least half of its length; the nearest such place counts. */
#ifndef SG_PARSE_FACADE_LINES_H
#define SG_PARSE_FACADE_LINES_H

#include "parse/facade_samples.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { SG_LINE_REACH_PX = 5 };

typedef struct {
    bool vertical;
    uint32_t at;           /* px: the line is before this column (row, when it is horizontal) */
    uint32_t from, to;     /* px along it, half open */
    uint8_t before, after; /* channels on its two sides: the most frequent ones along it */
    double share;          /* of the samples that have the line; NAN: no samples */
    double mean, sd;       /* px: of its place in those; NAN: none has it */
} sg_facade_line;

/** The lines of a parse: vertical ones left to right, then horizontal ones top to bottom; shares are not known yet.
 *  @param lines  out [*n], malloc'd, free() it
 *  @return SG_OK, SG_ENOMEM */
sg_status sg_facade_lines_find(const sg_label_map *parse, sg_facade_line **lines, size_t *n, sg_error *err);

/** How sure the samples are of each line. @return SG_OK, SG_ENOMEM. O(samples * lines * their lengths) */
sg_status sg_facade_lines_judge(sg_facade_line *lines, size_t n, const sg_facade_samples *s, sg_error *err);

#endif
