/* SPDX-License-Identifier: GPL-3.0-or-later */
/* utf8.h - is a text UTF-8? Names go into grammars, JSON and SVG, which hold nothing else. */
#ifndef SG_CORE_UTF8_H
#define SG_CORE_UTF8_H

#include <stdbool.h>
#include <stddef.h>

/** Bytes of the sequence at text, of which n > 0 bytes are left; 0 when it is none (overlong forms and surrogates too). */
size_t sg_utf8_sequence(const char *text, size_t n);

/** Are all n bytes UTF-8? */
bool sg_utf8_is(const char *text, size_t n);

/** Is there a control character (line end, tab, escape, delete) in it? Such names would break tables and terminals. */
bool sg_text_has_control(const char *text);

#endif
