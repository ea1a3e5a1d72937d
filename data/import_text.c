/* SPDX-License-Identifier: GPL-3.0-or-later */
/* import_text.c - label maps that are text: matrices of whole numbers, or a digit a pixel. */
#include "config.h"

#include "core/array.h"
#include "core/lines.h"
#include "data/import_priv.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FILE_LIMIT = 1 << 30 }; /* bytes */

typedef struct {
    const sg_importer *im;
    sg_lines lines;
    sg_import_tally *tally;
    uint8_t *labels; /* malloc'd */
    size_t count, capacity, width, height, column;
} reader;

static sg_status take_value(reader *r, long value, const char *at, sg_error *err)
{
    const int index = sg_import_index(r->im, value);
    if (r->height > 0 && r->column == r->width)
        return sg_lines_fail(&r->lines, at, err, "more than the %zu values of the rows before", r->width);
    if (r->column == SG_IMAGE_MAX_SIDE)
        return sg_lines_fail(&r->lines, at, err, "more than the %d values that a row may have", SG_IMAGE_MAX_SIDE);
    if (!SG_GROW(r->labels, r->capacity, r->count + 1))
        return SG_FAIL_NOMEM(err);
    r->labels[r->count++] = (uint8_t)index;
    const size_t x = r->column++;
    if (index >= 0)
        return SG_OK;
    char text[32];
    snprintf(text, sizeof text, "%ld", value);
    return sg_import_tally_add(r->tally, text, x, r->height, err);
}

/* Some programs write whole numbers as 1.000e+00: any number that is whole will do. */
static bool parse_value(const char *p, char **end, long *out)
{
    if (!isdigit((unsigned char)*p) && *p != '-' && *p != '+' && *p != '.')
        return false;
    const double v = strtod(p, end);
    if (*end == p || !(fabs(v) < 1e9) || v != floor(v))
        return false;
    *out = (long)v;
    return true;
}

static sg_status read_numbers(reader *r, sg_error *err)
{
    char *p = r->lines.text + strspn(r->lines.text, " \t");
    while (*p != '\0') {
        char *end;
        long value;
        if (!parse_value(p, &end, &value))
            return sg_lines_fail(&r->lines, p, err, "'%.*s' is no whole number", (int)strcspn(p, " \t,;") % 40, p);
        SG_TRY(take_value(r, value, p, err));
        const size_t blanks = strspn(end, " \t");
        const bool comma = end[blanks] == ',' || end[blanks] == ';';
        if (blanks == 0 && !comma && *end != '\0')
            return sg_lines_fail(&r->lines, end, err, "'%c' after a number", *end);
        p = end + blanks + (comma ? 1 : 0);
        p += strspn(p, " \t");
    }
    return SG_OK;
}

static sg_status read_digits(reader *r, sg_error *err)
{
    const char *line = r->lines.text;
    size_t n = strlen(line);
    while (n > 0 && (line[n - 1] == ' ' || line[n - 1] == '\t'))
        n--;
    for (size_t i = 0; i < n; i++) {
        if (!isdigit((unsigned char)line[i]))
            return sg_lines_fail(&r->lines, line + i, err, "'%c' is no digit", line[i]);
        SG_TRY(take_value(r, line[i] - '0', line + i, err));
    }
    return SG_OK;
}

static sg_status read_rows(reader *r, sg_status (*read_row)(reader *, sg_error *), sg_error *err)
{
    while (sg_lines_next(&r->lines)) {
        r->column = 0;
        SG_TRY(read_row(r, err));
        if (r->height == 0)
            r->width = r->column;
        if (r->column < r->width)
            return sg_lines_fail(&r->lines, r->lines.text + strlen(r->lines.text), err,
                                 "%zu values, but the rows before have %zu", r->column, r->width);
        r->height++;
    }
    return SG_OK;
}

static sg_status finish_map(reader *r, const char *path, sg_label_map *out, sg_error *err)
{
    sg_error inner = SG_ERROR_INIT;
    if (r->height == 0)
        return SG_FAIL(err, SG_EINPUT, "%s: no values", path);
    const sg_status st = sg_label_map_create(r->width, r->height, out, &inner);
    if (st != SG_OK)
        return st == SG_ENOMEM ? SG_FAIL_NOMEM(err) : SG_FAIL(err, SG_EINPUT, "%s: %s", path, inner.msg);
    memcpy(out->labels, r->labels, r->count);
    return SG_OK;
}

static sg_status read_text(const sg_importer *im, const char *path, sg_status (*read_row)(reader *, sg_error *),
                           sg_label_map *out, sg_error *err)
{
    reader r;
    memset(&r, 0, sizeof r);
    r.im = im;
    r.tally = sg_import_tally_begin(im->scratch);
    if (r.tally == NULL)
        return SG_FAIL_NOMEM(err);
    SG_TRY(sg_lines_open(path, FILE_LIMIT, im->scratch, &r.lines, err));
    sg_status st = read_rows(&r, read_row, err);
    const sg_status told = sg_import_tally_end(r.tally, path, "label", "pixel", st == SG_OK ? err : NULL);
    if (st == SG_OK)
        st = told;
    if (st == SG_OK)
        st = finish_map(&r, path, out, err);
    free(r.labels);
    return st;
}

sg_status sg_import_matrix(const sg_importer *im, const char *path, sg_import_size photo, sg_label_map *out,
                           sg_error *err)
{
    (void)photo;
    return read_text(im, path, read_numbers, out, err);
}

sg_status sg_import_digits(const sg_importer *im, const char *path, sg_import_size photo, sg_label_map *out,
                           sg_error *err)
{
    (void)photo;
    return read_text(im, path, read_digits, out, err);
}
