/* SPDX-License-Identifier: GPL-3.0-or-later */
/* json_text.c - JSON values as text. */
#include "config.h"

#include "grammar/json_text.h"
#include "grammar/number.h"

#include <errno.h>
#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

static void put_string(const char *s, FILE *out)
{
    fputc('"', out);
    for (; *s != '\0'; s++) {
        const unsigned char c = (unsigned char)*s;
        if (c == '"' || c == '\\')
            fprintf(out, "\\%c", c);
        else if (c < 0x20)
            fprintf(out, "\\u%04x", c);
        else
            fputc(c, out);
    }
    fputc('"', out);
}

static void separate(int depth, int broken, bool first, FILE *out)
{
    if (!first)
        fputc(',', out);
    if (depth <= broken)
        fprintf(out, "\n%*s", depth, "");
    else if (!first)
        fputc(' ', out);
}

static void put_value(const json_t *v, int depth, int broken, FILE *out)
{
    char number[SG_NUMBER_SIZE];
    const char *key;
    const json_t *member;
    bool first = true;
    switch (json_typeof(v)) {
    case JSON_OBJECT:
        fputc('{', out);
        for (void *i = json_object_iter((json_t *)(uintptr_t)v); i != NULL;
             i = json_object_iter_next((json_t *)(uintptr_t)v, i), first = false) {
            key = json_object_iter_key(i);
            member = json_object_iter_value(i);
            separate(depth + 1, broken, first, out);
            put_string(key, out);
            fputs(": ", out);
            put_value(member, depth + 1, broken, out);
        }
        fputc('}', out);
        break;
    case JSON_ARRAY:
        fputc('[', out);
        for (size_t i = 0; i < json_array_size(v); i++, first = false) {
            separate(depth + 1, broken, first, out);
            put_value(json_array_get(v, i), depth + 1, broken, out);
        }
        fputc(']', out);
        break;
    case JSON_STRING:
        put_string(json_string_value(v), out);
        break;
    case JSON_INTEGER:
        fprintf(out, "%" JSON_INTEGER_FORMAT, json_integer_value(v));
        break;
    case JSON_REAL:
        fputs(sg_number_format(json_real_value(v), number), out);
        break;
    case JSON_TRUE:
        fputs("true", out);
        break;
    case JSON_FALSE:
        fputs("false", out);
        break;
    case JSON_NULL:
        fputs("null", out);
        break;
    }
}

sg_status sg_json_write(const struct json_t *value, int broken, FILE *out, sg_error *err)
{
    errno = 0;
    put_value(value, 0, broken, out);
    fputc('\n', out);
    return ferror(out) ? SG_FAIL(err, SG_EIO, "%s", errno != 0 ? strerror(errno) : "writing failed") : SG_OK;
}
