/* SPDX-License-Identifier: GPL-3.0-or-later */
/* parse_priv.h - what scanner and parser share. Both are re-entrant: all state is here. */
#ifndef SG_GRAMMAR_PARSE_PRIV_H
#define SG_GRAMMAR_PARSE_PRIV_H

#include "grammar/ast.h"

#include <stdalign.h>

typedef struct {
    sg_source source;
    size_t base; /* where the text begins in the source's */
    sg_arena *arena;
    sg_ast *ast;
    sg_error *err;
    sg_status status; /* of the first failure; its sentence is in err then */
    /* scanner */
    sg_pos at;               /* where the next token begins */
    int previous, before;    /* the last two tokens: a colour is told from a comment by them */
    unsigned nesting;
    size_t ntokens;
    alignas(16) char pool[1024]; /* the scanner's own memory: it must not fail, its only answer is exit() */
    size_t pool_used;
} sg_parse;

/** Parse text (length bytes, which two more NULs follow; it is scribbled on and must not be the source's) into an empty
 *  tree. @return SG_OK, SG_EINPUT, SG_ENOMEM */
sg_status sg_parse_text(sg_parse *p, char *text, size_t length);

/** Fail at a place, unless something failed before. */
void sg_parse_fail(sg_parse *p, sg_pos at, const char *format, ...) __attribute__((format(printf, 3, 4)));
void sg_parse_fail_nomem(sg_parse *p);

/** True when a name must be quoted: it is a keyword, or not a plain identifier. */
bool sg_name_needs_quotes(const char *name);

#endif
