/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fingerprint.c - the hash of a grammar's canonical text. */
#include "config.h"

#include "grammar/fingerprint.h"

#include <stdlib.h>

/* Fowler, Noll, Vo: http://www.isthe.com/chongo/tech/comp/fnv/ */
static uint64_t hash(const char *text, size_t n)
{
    uint64_t h = 0xcbf29ce484222325u;
    for (size_t i = 0; i < n; i++)
        h = (h ^ (unsigned char)text[i]) * 0x100000001b3u;
    return h;
}

sg_status sg_grammar_fingerprint(const sg_grammar *g, uint64_t *out, sg_error *err)
{
    char *text = NULL;
    size_t n = 0;
    FILE *fp = open_memstream(&text, &n);
    if (fp == NULL)
        return SG_FAIL_NOMEM(err);
    sg_status st = sg_grammar_print(g, fp, NULL);
    if (fclose(fp) != 0 || st != SG_OK) /* nothing but memory can be missing */
        st = SG_FAIL_NOMEM(err);
    else
        *out = hash(text, n);
    free(text);
    return st;
}
