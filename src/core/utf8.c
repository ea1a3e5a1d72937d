/* SPDX-License-Identifier: GPL-3.0-or-later */
/* utf8.c - well-formed UTF-8 (Unicode 15, table 3-7). */
#include "core/utf8.h"

size_t sg_utf8_sequence(const char *text, size_t n)
{
    const unsigned char *p = (const unsigned char *)text;
    if (p[0] < 0x80)
        return 1;
    const size_t length = p[0] < 0xC2 ? 0 : p[0] < 0xE0 ? 2 : p[0] < 0xF0 ? 3 : p[0] < 0xF5 ? 4 : 0;
    if (length == 0 || length > n)
        return 0;
    for (size_t i = 1; i < length; i++)
        if ((p[i] & 0xC0) != 0x80)
            return 0;
    const bool overlong = (p[0] == 0xE0 && p[1] < 0xA0) || (p[0] == 0xF0 && p[1] < 0x90);
    const bool no_character = (p[0] == 0xED && p[1] > 0x9F) || (p[0] == 0xF4 && p[1] > 0x8F);
    return overlong || no_character ? 0 : length;
}

bool sg_utf8_is(const char *text, size_t n)
{
    for (size_t i = 0; i < n;) {
        const size_t length = sg_utf8_sequence(text + i, n - i);
        if (length == 0)
            return false;
        i += length;
    }
    return true;
}

bool sg_text_has_control(const char *text)
{
    for (const unsigned char *p = (const unsigned char *)text; *p != '\0'; p++)
        if (*p < ' ' || *p == 127)
            return true;
    return false;
}
