/* SPDX-License-Identifier: GPL-3.0-or-later */
/* obj_text.c - lines, words and numbers of OBJ and MTL files. */
#include "config.h"

#include "scene/obj_priv.h"

#include "core/utf8.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

sg_status sg_obj_fail(const sg_obj_text *t, size_t at, const char *format, ...)
{
    char sentence[400];
    va_list ap;
    va_start(ap, format);
    vsnprintf(sentence, sizeof sentence, format, ap);
    va_end(ap);
    return sg_source_fail(&t->source, (sg_pos){(uint32_t)at, 0}, t->err, "%s", sentence);
}

static sg_status check_text(const sg_obj_text *t, const char *text, size_t length, const char *name, sg_error *err)
{
    if (length > SG_OBJ_MAX_BYTES)
        return SG_FAIL(err, SG_EINPUT, "%.250s: larger than the %d bytes that a mesh may have", name, SG_OBJ_MAX_BYTES);
    const char *zero = memchr(text, '\0', length);
    if (zero != NULL)
        return sg_obj_fail(t, (size_t)(zero - text), "a byte 0: this is no text file");
    return SG_OK;
}

sg_status sg_obj_text_open(sg_obj_text *t, const char *text, size_t length, const char *name, sg_error *err)
{
    *t = (sg_obj_text){.source = {.name = name, .text = text, .length = length}, .err = err};
    SG_TRY(check_text(t, text, length, name, err));
    t->copy = malloc(length + 1);
    t->plain = newlocale(LC_NUMERIC_MASK, "C", (locale_t)0);
    if (t->copy == NULL || t->plain == (locale_t)0) {
        free(t->copy);
        if (t->plain != (locale_t)0)
            freelocale(t->plain);
        return SG_FAIL_NOMEM(err);
    }
    memcpy(t->copy, text, length);
    t->copy[length] = '\0';
    t->source.text = t->copy;
    t->before = uselocale(t->plain);
    return SG_OK;
}

void sg_obj_text_close(sg_obj_text *t)
{
    uselocale(t->before);
    freelocale(t->plain);
    free(t->copy);
}

/* Length of what continues a line here, 0: nothing does. */
static size_t continuation(const sg_obj_text *t)
{
    const char *p = t->source.text + t->at;
    return p[0] != '\\' ? 0 : p[1] == '\n' ? 2 : p[1] == '\r' && p[2] == '\n' ? 3 : 0;
}

static void skip_blanks(sg_obj_text *t)
{
    for (;;) {
        const char c = t->source.text[t->at];
        const size_t more = continuation(t);
        if (more == 0 && c != ' ' && c != '\t' && c != '\r' && c != '\f')
            return;
        t->at += more > 0 ? more : 1;
    }
}

static bool ends_line(const sg_obj_text *t)
{
    const char c = t->source.text[t->at];
    return c == '\n' || c == '\0' || c == '#';
}

static void skip_line(sg_obj_text *t)
{
    t->at += strcspn(t->source.text + t->at, "\n");
}

bool sg_obj_next_line(sg_obj_text *t)
{
    for (;;) {
        skip_blanks(t);
        if (!ends_line(t))
            return true;
        skip_line(t);
        if (t->source.text[t->at] == '\0')
            return false;
        t->at++;
    }
}

sg_obj_word sg_obj_next_word(sg_obj_text *t)
{
    skip_blanks(t);
    sg_obj_word w = {t->at, 0};
    if (ends_line(t))
        return w;
    while (strchr(" \t\r\f\n", t->source.text[t->at]) == NULL && continuation(t) == 0) /* finds the NUL too */
        t->at++;
    w.length = t->at - w.at;
    return w;
}

sg_obj_word sg_obj_rest(sg_obj_text *t)
{
    skip_blanks(t);
    sg_obj_word w = {t->at, 0};
    skip_line(t);
    w.length = t->at - w.at;
    while (w.length > 0 && strchr(" \t\r\f", t->source.text[w.at + w.length - 1]) != NULL)
        w.length--;
    return w;
}

bool sg_obj_is_word(const sg_obj_text *t, sg_obj_word w, const char *text)
{
    return w.length == strlen(text) && memcmp(t->source.text + w.at, text, w.length) == 0;
}

/* Of the many things that strtod() takes, decimal numbers. */
sg_status sg_obj_number(sg_obj_text *t, double *out)
{
    const sg_obj_word w = sg_obj_next_word(t);
    const char *p = t->source.text + w.at;
    char *end = NULL;
    if (w.length == 0)
        return sg_obj_fail(t, w.at, "found the end of the line; expected a number");
    *out = strspn(p, "+-.0123456789eE") >= w.length ? strtod(p, &end) : NAN;
    if (end != p + w.length)
        return sg_obj_fail(t, w.at, "found '%.*s'; expected a number", (int)(w.length < 40 ? w.length : 40), p);
    if (!(fabs(*out) <= 1e30))
        return sg_obj_fail(t, w.at, "a number over 1e30");
    return SG_OK;
}

sg_status sg_obj_name(const sg_obj_text *t, sg_obj_word w, sg_obj *obj, const char **name)
{
    if (w.length == 0)
        return sg_obj_fail(t, w.at, "found the end of the line; expected a name");
    if (!sg_utf8_is(t->source.text + w.at, w.length))
        return sg_obj_fail(t, w.at, "a name that is no UTF-8");
    *name = sg_arena_printf(obj->arena, "%.*s", (int)w.length, t->source.text + w.at);
    return *name != NULL ? SG_OK : SG_FAIL_NOMEM(t->err);
}
