/* SPDX-License-Identifier: GPL-3.0-or-later */
/* markup.c - text inside HTML and SVG. */
#include "core/markup.h"

void sg_markup_text(FILE *out, const char *s)
{
    for (; *s != '\0'; s++) {
        switch (*s) {
        case '&':
            fputs("&amp;", out);
            break;
        case '<':
            fputs("&lt;", out);
            break;
        case '>':
            fputs("&gt;", out);
            break;
        case '"':
            fputs("&quot;", out);
            break;
        default:
            if ((unsigned char)*s >= ' ')
                fputc(*s, out);
        }
    }
}
