/* SPDX-License-Identifier: GPL-3.0-or-later */
/* classes.c - class tables, read and written. */
#include "config.h"

#include "core/file.h"
#include "core/lines.h"
#include "core/utf8.h"
#include "image/classes.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { FILE_LIMIT = 1 << 20 }; /* bytes: 256 lines need far less */

/* What a table says, by pixel index; the names are borrowed. */
typedef struct {
    const char *name[256]; /* NULL: not listed */
    uint32_t color[256];
} listing;

int sg_classes_find(const sg_classes *c, const char *name)
{
    for (size_t i = 0; i < c->nclasses; i++)
        if (strcmp(c->names[i], name) == 0)
            return (int)i;
    return -1;
}

void sg_classes_clear(sg_classes *c)
{
    for (size_t i = 0; i < c->nclasses; i++)
        free(c->names[i]);
    memset(c, 0, sizeof *c);
}

/* Blanks and control characters would break the word lists that names stand in; # begins comments there. */
static bool is_good_name(const char *name)
{
    for (const char *p = name; *p != '\0'; p++)
        if (isspace((unsigned char)*p) || iscntrl((unsigned char)*p))
            return false;
    return name[0] != '\0' && name[0] != '#' && sg_utf8_is(name, strlen(name));
}

static sg_status add_class(sg_classes *c, const listing *l, size_t index, sg_error *err)
{
    if (c->nclasses == SG_MAX_CLASSES)
        return SG_FAIL(err, SG_EINPUT, "more than the %d classes that a table may have", SG_MAX_CLASSES);
    char *name = strdup(l->name[index]);
    if (name == NULL)
        return SG_FAIL_NOMEM(err);
    c->names[c->nclasses] = name;
    c->colors[c->nclasses] = l->color[index];
    c->first_index[c->nclasses] = (uint8_t)index;
    c->nclasses++;
    return SG_OK;
}

/* Number the classes by their first index. */
static sg_status build(const listing *l, sg_classes *c, sg_error *err)
{
    memset(c, 0, sizeof *c);
    for (size_t i = 0; i < 256; i++) {
        c->class_of[i] = SG_CLASS_UNKNOWN;
        c->index_colors[i] = l->color[i];
        if (l->name[i] == NULL)
            continue;
        if (strcmp(l->name[i], "ignore") == 0) {
            c->class_of[i] = SG_CLASS_IGNORE;
            continue;
        }
        int found = sg_classes_find(c, l->name[i]);
        if (found < 0) {
            SG_TRY(add_class(c, l, i, err));
            found = (int)c->nclasses - 1;
        }
        c->class_of[i] = (uint8_t)found;
    }
    return c->nclasses > 0 ? SG_OK : SG_FAIL(err, SG_EINPUT, "no classes");
}

static bool parse_index(const char *text, size_t *out)
{
    char *end;
    const unsigned long v = strtoul(text, &end, 10);
    *out = v;
    return isdigit((unsigned char)text[0]) && *end == '\0' && v <= 255;
}

static bool parse_color(const char *text, uint32_t *out)
{
    if (text[0] != '#' || strlen(text) != 7 || strspn(text + 1, "0123456789abcdefABCDEF") != 6)
        return false;
    *out = (uint32_t)strtoul(text + 1, NULL, 16);
    return true;
}

static sg_status read_line(sg_lines *lines, listing *l, sg_error *err)
{
    char *field[3];
    size_t index;
    uint32_t color;
    const size_t n = sg_lines_split(lines, field, 3);
    if (n != 3)
        return sg_lines_fail(lines, NULL, err, "%s than three fields (index, name, #rrggbb, with tabs between)",
                             n < 3 ? "fewer" : "more");
    if (!parse_index(field[0], &index))
        return sg_lines_fail(lines, field[0], err, "'%.80s' is no pixel index (0 to 255)", field[0]);
    if (l->name[index] != NULL)
        return sg_lines_fail(lines, field[0], err, "index %zu stands twice in the table", index);
    if (!is_good_name(field[1]))
        return sg_lines_fail(lines, field[1], err,
                             "'%.80s' is no class name: it must be one word of UTF-8, not beginning with #", field[1]);
    if (!parse_color(field[2], &color))
        return sg_lines_fail(lines, field[2], err, "'%.80s' is no colour (#rrggbb)", field[2]);
    l->name[index] = field[1];
    l->color[index] = color;
    return SG_OK;
}

static sg_status read_table(const char *path, sg_arena *arena, sg_classes *out, sg_error *err)
{
    listing *l = SG_NEW(arena, listing);
    sg_classes *c = SG_NEW(arena, sg_classes);
    sg_lines lines;
    if (l == NULL || c == NULL)
        return SG_FAIL_NOMEM(err);
    SG_TRY(sg_lines_open(path, FILE_LIMIT, arena, &lines, err));
    while (sg_lines_next(&lines))
        SG_TRY(read_line(&lines, l, err));
    sg_error inner = SG_ERROR_INIT;
    const sg_status st = build(l, c, &inner);
    if (st == SG_OK) {
        *out = *c;
        return SG_OK;
    }
    sg_classes_clear(c);
    return st == SG_EINPUT ? SG_FAIL(err, st, "%s: %s", path, inner.msg) : SG_FAIL(err, st, "%s", inner.msg);
}

sg_status sg_classes_read(const char *path, sg_classes *out, sg_error *err)
{
    sg_arena *arena = sg_arena_create();
    if (arena == NULL)
        return SG_FAIL_NOMEM(err);
    const sg_status st = read_table(path, arena, out, err);
    sg_arena_free(arena);
    return st;
}

sg_status sg_classes_create(size_t n, const char *const *names, const uint32_t *colors, sg_classes *out, sg_error *err)
{
    if (n == 0 || n > 256)
        return SG_FAIL(err, SG_EINVAL, "a table of %zu pixel indices: it must have 1 to 256", n);
    listing l = {{NULL}, {0}};
    for (size_t i = 0; i < n; i++) {
        if (!is_good_name(names[i]))
            return SG_FAIL(err, SG_EINVAL, "'%s' is no class name: it must be one word, not beginning with #",
                           names[i]);
        l.name[i] = names[i];
        l.color[i] = colors[i] & 0xffffff;
    }
    sg_classes c;
    const sg_status st = build(&l, &c, err);
    if (st != SG_OK) {
        sg_classes_clear(&c);
        if (st == SG_EINPUT && err != NULL)
            err->code = SG_EINVAL;
        return st == SG_EINPUT ? SG_EINVAL : st;
    }
    *out = c;
    return SG_OK;
}

sg_status sg_classes_write(const char *path, const sg_classes *c, sg_error *err)
{
    sg_output out;
    SG_TRY(sg_output_open(&out, path, err));
    fputs("# index\tname\tcolour\n", out.fp);
    for (size_t i = 0; i < 256; i++) {
        const unsigned class = c->class_of[i];
        if (class == SG_CLASS_UNKNOWN)
            continue;
        const char *name = class == SG_CLASS_IGNORE ? "ignore" : c->names[class];
        fprintf(out.fp, "%zu\t%s\t#%06x\n", i, name, (unsigned)c->index_colors[i]);
    }
    return sg_output_commit(&out, err); /* a failed write shows up here */
}
