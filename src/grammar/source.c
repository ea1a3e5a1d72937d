/* SPDX-License-Identifier: GPL-3.0-or-later */
/* source.c - positions, carets, UTF-8. */
#include "config.h"

#include "grammar/source.h"

#include "core/utf8.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

enum { WINDOW = 110 }; /* bytes of the line that are shown: a line may be a megabyte long */

static bool continues(char c)
{
    return ((unsigned char)c & 0xC0) == 0x80;
}

/* First byte of the part of the line that is shown, at a character boundary. */
static size_t window_begin(const sg_source *s, size_t line_begin, size_t at)
{
    if (at - line_begin <= WINDOW / 2 + 10)
        return line_begin;
    size_t begin = at - WINDOW / 2;
    while (begin > line_begin && continues(s->text[begin]))
        begin--;
    return begin;
}

static bool ends_line(const sg_source *s, size_t i)
{
    return i >= s->length || s->text[i] == '\n' || s->text[i] == '\r' || s->text[i] == '\0';
}

/* "\nLINE\n   ^" into out. Tabs are kept in the second line, so that the caret stands where the eye expects it. */
static void show_line(const sg_source *s, size_t line_begin, size_t at, char *out, size_t size)
{
    const size_t begin = window_begin(s, line_begin, at);
    size_t end = begin, n = 0;
    while (!ends_line(s, end) && end - begin < WINDOW)
        end++;
    while (end > begin && end < s->length && continues(s->text[end]))
        end--;
    out[n++] = '\n';
    for (size_t i = begin; i < end && n + 1 < size; i++)
        out[n++] = s->text[i];
    if (n + 1 < size)
        out[n++] = '\n';
    for (size_t i = begin; i < at && n + 2 < size; i++)
        if (!continues(s->text[i]))
            out[n++] = s->text[i] == '\t' ? '\t' : ' ';
    if (n + 1 < size)
        out[n++] = '^';
    out[n] = '\0';
}

/* The file in which an offset lies, alone; *offset becomes that in it. */
static sg_source part_at(const sg_source *s, size_t *offset)
{
    sg_source part = {.name = s->name, .text = s->text, .length = s->length};
    size_t begin = 0, i = 0;
    for (; i < s->nparts && s->parts[i].begin <= *offset; i++) {
        part.name = s->parts[i].name;
        begin = s->parts[i].begin;
    }
    const size_t end = i < s->nparts ? s->parts[i].begin - 1 : s->length;
    part.text = s->text + begin;
    part.length = end - begin;
    *offset -= begin;
    return part;
}

const char *sg_source_imported(const sg_source *s, sg_pos at)
{
    const char *name = NULL;
    for (size_t i = 0; s->text != NULL && i < s->nparts && s->parts[i].begin <= at.offset; i++)
        name = s->parts[i].name;
    return name;
}

/* "NAME:LINE:COL: KIND: sentence", the line and the caret. */
static void tell_in_text(const sg_source *whole, sg_pos at, const char *kind, const char *sentence, char *out, size_t size)
{
    size_t offset = at.offset;
    const sg_source part = part_at(whole, &offset), *s = &part;
    offset = offset < s->length ? offset : s->length;
    /* The end of the file is shown behind the last thing in it, not on an empty line. */
    if (offset == s->length)
        while (offset > 0 && strchr(" \t\r\n", s->text[offset - 1]) != NULL)
            offset--;
    size_t begin = 0, column = 1, line = 1;
    for (size_t i = 0; i < offset; i++)
        if (s->text[i] == '\n') {
            line++;
            begin = i + 1;
        }
    for (size_t i = begin; i < offset; i++)
        column += !continues(s->text[i]);
    char shown[2 * WINDOW + 8];
    show_line(s, begin, offset, shown, sizeof shown);
    snprintf(out, size, "%.250s:%zu:%zu: %s: %s%s", s->name, line, column, kind, sentence, shown);
}

static void tell(const sg_source *s, sg_pos at, const char *kind, const char *sentence, char *out, size_t size)
{
    if (s->text != NULL)
        tell_in_text(s, at, kind, sentence, out, size);
    else if (at.offset == 0)
        snprintf(out, size, "%.250s: %s: %s", s->name, kind, sentence);
    else
        snprintf(out, size, "%.250s: rule %u: %s: %s", s->name, at.offset, kind, sentence);
}

sg_status sg_source_fail(const sg_source *s, sg_pos at, sg_error *err, const char *format, ...)
{
    char sentence[480], message[1024];
    va_list ap;
    va_start(ap, format);
    vsnprintf(sentence, sizeof sentence, format, ap);
    va_end(ap);
    tell(s, at, "error", sentence, message, sizeof message);
    return SG_FAIL(err, SG_EINPUT, "%s", message);
}

void sg_source_warning(const sg_source *s, sg_pos at, char *message, size_t size, const char *sentence)
{
    tell(s, at, "warning", sentence, message, size);
}

sg_status sg_source_check(const sg_source *s, sg_error *err)
{
    uint32_t line = 1;
    for (size_t i = 0; i < s->length;) {
        const unsigned char c = (unsigned char)s->text[i];
        const sg_pos at = {(uint32_t)i, line};
        const size_t n = sg_utf8_sequence(s->text + i, s->length - i);
        if (n == 0)
            return sg_source_fail(s, at, err, "byte 0x%02x is no UTF-8", c);
        if ((c < 0x20 && strchr("\t\n\r\f", c) == NULL) || c == 0 || c == 0x7F)
            return sg_source_fail(s, at, err, "control character 0x%02x: this is no text file", c);
        line += c == '\n';
        i += n;
    }
    return SG_OK;
}

/* Copies of a source that were made before see their own length of the text, which stays as it is. */
static bool make_room(sg_source *s, size_t more, sg_arena *arena)
{
    if (s->nparts >= s->parts_capacity) {
        const size_t n = 2 * s->nparts + 4;
        sg_source_part *parts = SG_NEW_ARRAY(arena, sg_source_part, n);
        if (parts == NULL)
            return false;
        if (s->nparts > 0)
            memcpy(parts, s->parts, s->nparts * sizeof *parts);
        s->parts = parts;
        s->parts_capacity = n;
    }
    if (s->own != NULL && s->length + more <= s->own_capacity)
        return true;
    const size_t n = 2 * (s->length + more);
    char *text = SG_NEW_ARRAY(arena, char, n);
    if (text == NULL)
        return false;
    memcpy(text, s->text, s->length);
    s->text = s->own = text;
    s->own_capacity = n;
    return true;
}

sg_status sg_source_add(sg_source *s, const sg_source *other, sg_arena *arena, size_t *base, sg_error *err)
{
    if (!make_room(s, other->length + 2, arena))
        return SG_FAIL_NOMEM(err);
    char *end = s->own + s->length;
    *end = '\n';
    memcpy(end + 1, other->text, other->length);
    *base = s->length + 1;
    s->parts[s->nparts++] = (sg_source_part){other->name, *base};
    s->length = *base + other->length;
    return SG_OK;
}
