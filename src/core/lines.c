/* SPDX-License-Identifier: GPL-3.0-or-later */
/* lines.c - small text tables, line by line. */
#include "config.h"

#include "core/file.h"
#include "core/lines.h"

#include <stdarg.h>
#include <string.h>

sg_status sg_lines_open(const char *path, size_t limit, sg_arena *arena, sg_lines *out, sg_error *err)
{
    size_t length;
    char *text;
    SG_TRY(sg_file_read(path, limit, arena, &text, &length, err));
    if (memchr(text, '\0', length) != NULL)
        return SG_FAIL(err, SG_EINPUT, "%s: no text file: it holds a NUL byte", path);
    if (strncmp(text, "\xef\xbb\xbf", 3) == 0) /* some editors put a byte order mark there */
        text += 3;
    *out = (sg_lines){path, text, NULL, 0};
    return SG_OK;
}

static bool is_content(const char *line)
{
    if (line[0] == '#' && (line[1] == ' ' || line[1] == '\t' || line[1] == '\0'))
        return false;
    return line[strspn(line, " \t")] != '\0';
}

bool sg_lines_next(sg_lines *l)
{
    while (l->next != NULL) {
        l->text = l->next;
        l->number++;
        const size_t length = strcspn(l->text, "\r\n");
        char *end = l->text + length;
        if (*end == '\0') {
            l->next = NULL;
        } else {
            l->next = end + (end[0] == '\r' && end[1] == '\n' ? 2 : 1);
            *end = '\0';
        }
        if (is_content(l->text))
            return true;
    }
    return false;
}

size_t sg_lines_split(sg_lines *l, char **fields, size_t max)
{
    char *p = l->text;
    for (size_t n = 0; n < max; n++) {
        fields[n] = p;
        p = strchr(p, '\t');
        if (p == NULL)
            return n + 1;
        *p++ = '\0';
    }
    return max + 1;
}

sg_status sg_lines_fail(const sg_lines *l, const char *at, sg_error *err, const char *format, ...)
{
    char sentence[768];
    va_list ap;
    va_start(ap, format);
    vsnprintf(sentence, sizeof sentence, format, ap);
    va_end(ap);
    const size_t column = at != NULL ? (size_t)(at - l->text) + 1 : 1;
    return SG_FAIL(err, SG_EINPUT, "%s:%zu:%zu: error: %s", l->path, l->number, column, sentence);
}
