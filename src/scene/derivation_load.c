/* SPDX-License-Identifier: GPL-3.0-or-later */
/* derivation_load.c - the form is told by the first byte. */
#include "config.h"

#include "scene/derivation_load.h"

#include "core/file.h"
#include "scene/derivation_json.h"

#include <string.h>

#define FILE_LIMIT ((size_t)1 << 32) /* bytes */

static sg_status parse(const char *text, size_t n, const char *name, const sg_grammar *g, sg_derivation_file *out,
                       sg_error *err)
{
    const size_t blank = strspn(text, " \t\r\n");
    if (blank < n && (text[blank] == '{' || text[blank] == '['))
        return sg_derivation_parse_json(text, n, name, g, out, err);
    return sg_derivation_file_decode((const unsigned char *)text, n, name, g, out, err);
}

sg_status sg_derivation_load(const char *path, const sg_grammar *g, sg_derivation_file *out, sg_error *err)
{
    char *text = NULL;
    size_t n = 0;
    sg_arena *arena = sg_arena_create();
    sg_status st = arena != NULL ? sg_file_read(path, FILE_LIMIT, arena, &text, &n, err) : SG_FAIL_NOMEM(err);
    if (st == SG_OK)
        st = parse(text, n, strcmp(path, "-") == 0 ? "standard input" : path, g, out, err);
    sg_arena_free(arena);
    return st;
}
