/* SPDX-License-Identifier: GPL-3.0-or-later */
/* json_text.h - JSON values as text with the shortest numbers that read back the same; jansson writes 17 digits. */
#ifndef SG_GRAMMAR_JSON_TEXT_H
#define SG_GRAMMAR_JSON_TEXT_H

#include "core/status.h"

#include <stdio.h>

struct json_t;

/** Write a value and a newline. What stands `broken` levels deep or less is broken into lines, the rest is not.
 *  @return SG_OK, SG_EIO, SG_ENOMEM */
sg_status sg_json_write(const struct json_t *value, int broken, FILE *out, sg_error *err);

#endif
