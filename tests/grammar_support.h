/* SPDX-License-Identifier: GPL-3.0-or-later */
/* grammar_support.h - reading, printing and comparing grammars in tests. */
#ifndef SG_TESTS_GRAMMAR_SUPPORT_H
#define SG_TESTS_GRAMMAR_SUPPORT_H

#include "core/random.h"
#include "grammar/split.h"
#include "tests/support.h"

#include <math.h>
#include <string.h>

/** A grammar from text that must be good. */
static inline sg_grammar *test_grammar(const char *text)
{
    sg_error err = SG_ERROR_INIT;
    sg_grammar *g = NULL;
    const sg_status st = sg_grammar_parse(text, strlen(text), "test.sg", &g, &err);
    ck_assert_msg(st == SG_OK, "%s\n%.2500s", err.msg, text);
    return g;
}

/** What sg_grammar_print() writes; free() it. */
static inline char *test_print(const sg_grammar *g)
{
    sg_error err = SG_ERROR_INIT;
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    ck_assert_ptr_nonnull(out);
    ck_ok(sg_grammar_print(g, out, &err));
    ck_assert_int_eq(fclose(out), 0);
    return text;
}

static inline char *test_json(const sg_split_form *f)
{
    sg_error err = SG_ERROR_INIT;
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    ck_assert_ptr_nonnull(out);
    ck_ok(sg_split_form_write_json(f, out, &err));
    ck_assert_int_eq(fclose(out), 0);
    return text;
}

/** Text that must be refused: the status, and the message in err. */
static inline sg_status test_refused(const char *text, size_t length, sg_error *err)
{
    sg_grammar *g = NULL;
    *err = (sg_error)SG_ERROR_INIT;
    const sg_status st = sg_grammar_parse(text, length, "test.sg", &g, err);
    ck_assert_msg(g == NULL, "accepted: %.200s", text);
    return st;
}

#endif
