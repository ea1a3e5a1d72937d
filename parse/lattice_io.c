/* SPDX-License-Identifier: GPL-3.0-or-later */
/* lattice_io.c - *.lat files: one line at a time, words parted by blanks. */
#include "parse/lattice.h"

#include "core/array.h"
#include "core/file.h"
#include "core/utf8.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define HASH_NONFATAL_OOM 1
#include <uthash.h>

enum { MAX_FILE_BYTES = 1 << 30 };

typedef struct {
    const char *start;
    size_t length;
} word;

/* A label name and its number, in a hash table while a file is read: a file may have thousands of names. */
typedef struct {
    char *name;
    uint16_t number;
    UT_hash_handle hh;
} name_entry;

typedef struct {
    const char *name; /* of the file */
    const char *at, *end;
    size_t line;
    const char *line_start, *line_end;
    word *words; /* of the line */
    size_t nwords, words_capacity;
    const char **label_names; /* in the arena once complete */
    size_t nlabels, names_capacity;
    name_entry *names;
    bool out_of_memory; /* set by the hash table */
} reader;

static sg_status fail_at(const reader *r, const char *where, sg_error *err, const char *what)
{
    return SG_FAIL(err, SG_EINPUT, "%s:%zu:%zu: error: %s", r->name, r->line, (size_t)(where - r->line_start) + 1, what);
}

static sg_status fail_count(const reader *r, const char *what, size_t expected, size_t found, sg_error *err)
{
    /* too many: at the first that is too much; too few: behind the last */
    const word *last = &r->words[r->nwords - 1];
    const char *where = found > expected ? r->words[r->nwords - (found - expected)].start : last->start + last->length;
    return SG_FAIL(err, SG_EINPUT, "%s:%zu:%zu: error: expected %zu %s, found %zu", r->name, r->line,
                   (size_t)(where - r->line_start) + 1, expected, what, found);
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t';
}

static sg_status split_line(reader *r, sg_error *err)
{
    r->nwords = 0;
    for (const char *p = r->line_start; p < r->line_end;) {
        if (is_blank(*p)) {
            p++;
            continue;
        }
        const char *start = p;
        while (p < r->line_end && !is_blank(*p)) {
            if ((unsigned char)*p < ' ' || *p == 127)
                return fail_at(r, p, err, *p == '\0' ? "a NUL byte: this is no text file" : "a control character");
            p++;
        }
        if (!SG_GROW(r->words, r->words_capacity, r->nwords + 1))
            return SG_FAIL_NOMEM(err);
        r->words[r->nwords++] = (word){start, (size_t)(p - start)};
    }
    return SG_OK;
}

/** The next line that is neither blank nor a comment, in words; no words at the end of the file. */
static sg_status next_line(reader *r, sg_error *err)
{
    r->nwords = 0;
    while (r->nwords == 0 && r->at < r->end) {
        r->line++;
        r->line_start = r->at;
        const char *newline = memchr(r->at, '\n', (size_t)(r->end - r->at));
        const char *line_end = newline != NULL ? newline : r->end;
        r->at = newline != NULL ? newline + 1 : r->end;
        if (line_end > r->line_start && line_end[-1] == '\r')
            line_end--;
        r->line_end = line_end;
        if (line_end > r->line_start && *r->line_start == '#')
            continue;
        SG_TRY(split_line(r, err));
    }
    r->line += r->line == 0; /* an empty file ends in its first line */
    return SG_OK;
}

static bool word_is(const word *w, const char *text)
{
    return w->length == strlen(text) && memcmp(w->start, text, w->length) == 0;
}

static sg_status read_number(const reader *r, const word *w, uint32_t low, uint32_t high, const char *what,
                             uint32_t *out, sg_error *err)
{
    uint64_t value = 0;
    for (size_t i = 0; i < w->length; i++) {
        const char c = w->start[i];
        if (c < '0' || c > '9')
            return SG_FAIL(err, SG_EINPUT, "%s:%zu:%zu: error: %s: expected a whole number, found '%.*s'", r->name,
                           r->line, (size_t)(w->start - r->line_start) + 1, what, (int)(w->length < 80 ? w->length : 80),
                           w->start);
        if (value <= high) /* beyond that it stays too large */
            value = value * 10 + (uint64_t)(c - '0');
    }
    if (value < low || value > high)
        return SG_FAIL(err, SG_EINPUT, "%s:%zu:%zu: error: %s: %.*s is not in %u to %u", r->name, r->line,
                       (size_t)(w->start - r->line_start) + 1, what, (int)(w->length < 80 ? w->length : 80), w->start,
                       (unsigned)low, (unsigned)high);
    *out = (uint32_t)value;
    return SG_OK;
}

static sg_status read_header(reader *r, sg_arena *arena, sg_lattice *l, sg_error *err)
{
    SG_TRY(next_line(r, err));
    if (r->nwords == 0)
        return fail_at(r, r->line_start, err, "expected 'lattice W H', found the end of the file");
    if (!word_is(&r->words[0], "lattice"))
        return fail_at(r, r->words[0].start, err, "expected 'lattice W H'");
    if (r->nwords != 3)
        return fail_count(r, "numbers after 'lattice'", 2, r->nwords - 1, err);
    uint32_t width, height;
    SG_TRY(read_number(r, &r->words[1], 1, SG_LATTICE_MAX_SIDE, "width", &width, err));
    SG_TRY(read_number(r, &r->words[2], 1, SG_LATTICE_MAX_SIDE, "height", &height, err));
    return sg_lattice_create(width, height, arena, l, err);
}

/* A row may begin with a label that is called x or y; then no number follows and the number of words is that of a row. */
static bool is_boundary_line(const reader *r, const char *axis, size_t width)
{
    if (r->nwords == 0 || !word_is(&r->words[0], axis))
        return false;
    const char *second = r->nwords > 1 ? r->words[1].start : "a";
    return r->nwords != width || (*second >= '0' && *second <= '9') || *second == '-' || *second == '+';
}

static sg_status read_boundaries(reader *r, size_t ncells, uint32_t *boundary, sg_error *err)
{
    if (r->nwords - 1 != ncells + 1)
        return fail_count(r, "boundaries", ncells + 1, r->nwords - 1, err);
    for (size_t i = 0; i <= ncells; i++) {
        SG_TRY(read_number(r, &r->words[i + 1], 0, INT32_MAX, "boundary", &boundary[i], err));
        if (i > 0 && boundary[i] <= boundary[i - 1])
            return fail_at(r, r->words[i + 1].start, err, "boundaries must increase");
    }
    return SG_OK;
}

static sg_status read_or_count(reader *r, const char *axis, size_t width, size_t ncells, uint32_t *boundary,
                               sg_error *err)
{
    if (is_boundary_line(r, axis, width)) {
        SG_TRY(read_boundaries(r, ncells, boundary, err));
        return next_line(r, err);
    }
    for (size_t i = 0; i <= ncells; i++)
        boundary[i] = (uint32_t)i;
    return SG_OK;
}

#undef uthash_nonfatal_oom
#define uthash_nonfatal_oom(entry) (r->out_of_memory = true)

static sg_status add_label(reader *r, sg_arena *arena, const word *w, uint16_t *number, sg_error *err)
{
    if (!sg_utf8_is(w->start, w->length))
        return fail_at(r, w->start, err, "a label that is no UTF-8");
    if (r->nlabels == SG_LATTICE_MAX_LABELS)
        return fail_at(r, w->start, err, "too many different labels");
    name_entry *e = SG_NEW(arena, name_entry);
    if (e == NULL || (e->name = sg_arena_alloc(arena, w->length + 1)) == NULL ||
        !SG_GROW(r->label_names, r->names_capacity, r->nlabels + 1))
        return SG_FAIL_NOMEM(err);
    memcpy(e->name, w->start, w->length);
    e->name[w->length] = '\0';
    e->number = (uint16_t)r->nlabels;
    HASH_ADD_KEYPTR(hh, r->names, e->name, w->length, e);
    if (r->out_of_memory)
        return SG_FAIL_NOMEM(err);
    *number = (uint16_t)r->nlabels;
    r->label_names[r->nlabels++] = e->name;
    return SG_OK;
}

static sg_status number_of_label(reader *r, sg_arena *arena, const word *w, uint16_t *number, sg_error *err)
{
    name_entry *e = NULL;
    HASH_FIND(hh, r->names, w->start, w->length, e);
    if (e == NULL)
        return add_label(r, arena, w, number, err);
    *number = e->number;
    return SG_OK;
}

static sg_status read_row(reader *r, sg_arena *arena, size_t width, uint16_t *labels, sg_error *err)
{
    if (r->nwords != width)
        return fail_count(r, "labels", width, r->nwords, err);
    for (size_t i = 0; i < width; i++)
        SG_TRY(number_of_label(r, arena, &r->words[i], &labels[i], err));
    return SG_OK;
}

static sg_status read_rows(reader *r, sg_arena *arena, sg_lattice *l, sg_error *err)
{
    for (size_t row = 0; row < l->height; row++) {
        if (r->nwords == 0)
            return SG_FAIL(err, SG_EINPUT, "%s:%zu:%zu: error: expected %zu rows of labels, found the end after %zu",
                           r->name, r->line, (size_t)(r->line_end - r->line_start) + 1, l->height, row);
        SG_TRY(read_row(r, arena, l->width, l->labels + row * l->width, err));
        SG_TRY(next_line(r, err));
    }
    if (r->nwords != 0)
        return fail_at(r, r->words[0].start, err, "text after the last row of labels");
    l->nlabels = r->nlabels;
    l->label_names = sg_arena_copy(arena, r->label_names, r->nlabels * sizeof *r->label_names);
    return l->label_names != NULL ? SG_OK : SG_FAIL_NOMEM(err);
}

static sg_status read_all(reader *r, sg_arena *arena, sg_lattice *l, sg_error *err)
{
    SG_TRY(read_header(r, arena, l, err));
    SG_TRY(next_line(r, err));
    SG_TRY(read_or_count(r, "x", l->width, l->width, l->x, err));
    SG_TRY(read_or_count(r, "y", l->width, l->height, l->y, err));
    return read_rows(r, arena, l, err);
}

sg_status sg_lattice_parse(const char *name, const char *text, size_t length, sg_arena *arena, sg_lattice *out,
                           sg_error *err)
{
    reader r = {.name = name, .at = text, .end = text + length, .line_start = text, .line_end = text};
    sg_lattice l;
    const sg_status st = read_all(&r, arena, &l, err);
    HASH_CLEAR(hh, r.names); /* the entries themselves are in the arena */
    free(r.words);
    free(r.label_names);
    if (st == SG_OK)
        *out = l;
    return st;
}

sg_status sg_lattice_read(const char *path, sg_arena *arena, sg_lattice *out, sg_error *err)
{
    sg_arena *scratch = sg_arena_create(); /* for the text, which need not outlive the call */
    if (scratch == NULL)
        return SG_FAIL_NOMEM(err);
    char *text;
    size_t length;
    sg_status st = sg_file_read(path, MAX_FILE_BYTES, scratch, &text, &length, err);
    if (st == SG_OK)
        st = sg_lattice_parse(strcmp(path, "-") == 0 ? "standard input" : path, text, length, arena, out, err);
    sg_arena_free(scratch);
    return st;
}

static bool name_can_be_written(const char *name)
{
    if (name[0] == '\0' || name[0] == '#')
        return false;
    for (const char *p = name; *p != '\0'; p++)
        if (is_blank(*p) || (unsigned char)*p < ' ' || *p == 127)
            return false;
    return true;
}

static void write_boundaries(FILE *out, char axis, const uint32_t *boundary, size_t ncells)
{
    fputc(axis, out);
    for (size_t i = 0; i <= ncells; i++)
        fprintf(out, " %lu", (unsigned long)boundary[i]);
    fputc('\n', out);
}

sg_status sg_lattice_write(const sg_lattice *l, FILE *out, sg_error *err)
{
    for (size_t i = 0; i < l->nlabels; i++)
        if (!name_can_be_written(l->label_names[i]))
            return SG_FAIL(err, SG_EINVAL,
                           "label '%s': a lattice file cannot hold a name that is empty, has blanks or begins with #",
                           l->label_names[i]);
    errno = 0;
    fprintf(out, "lattice %zu %zu\n", l->width, l->height);
    write_boundaries(out, 'x', l->x, l->width);
    write_boundaries(out, 'y', l->y, l->height);
    for (size_t row = 0; row < l->height; row++) {
        for (size_t column = 0; column < l->width; column++) {
            if (column > 0)
                fputc(' ', out);
            fputs(l->label_names[sg_lattice_label(l, column, row)], out);
        }
        fputc('\n', out);
    }
    if (ferror(out))
        return SG_FAIL(err, SG_EIO, "writing a lattice: %s", errno != 0 ? strerror(errno) : "failed");
    return SG_OK;
}

sg_status sg_lattice_save(const sg_lattice *l, const char *path, sg_error *err)
{
    sg_output out;
    SG_TRY(sg_output_open(&out, path, err));
    const sg_status st = sg_lattice_write(l, out.fp, err);
    if (st == SG_OK)
        return sg_output_commit(&out, err);
    const int why = errno;
    sg_output_discard(&out);
    return st == SG_EIO ? SG_FAIL(err, SG_EIO, "%s: %s", path, strerror(why)) : st; /* the sentence names the file */
}
