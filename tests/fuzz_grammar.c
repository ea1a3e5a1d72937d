/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fuzz_grammar.c - any bytes as a grammar file, in either form. What is taken for a grammar has a canonical text that is
 * one, too, and stays as it is. */
#include "config.h"

#include "grammar/grammar.h"
#include "tests/fuzz.h"

#include <string.h>

static char *print(const sg_grammar *g, size_t *n)
{
    char *text = NULL;
    FILE *fp = open_memstream(&text, n);
    fuzz_must(fp != NULL);
    fuzz_must(sg_grammar_print(g, fp, NULL) == SG_OK);
    fuzz_must(fclose(fp) == 0);
    return text;
}

static void print_again(const sg_grammar *g)
{
    sg_error err = SG_ERROR_INIT;
    sg_grammar *again = NULL;
    size_t n = 0, m = 0;
    char *text = print(g, &n);
    const sg_status st = sg_grammar_parse(text, n, "again", &again, &err);
    if (st != SG_OK)
        fprintf(stderr, "%s\n%s\n", err.msg, text);
    fuzz_must(st == SG_OK);
    char *same = print(again, &m);
    fuzz_must(n == m && memcmp(text, same, n) == 0);
    sg_grammar_free(again);
    free(text);
    free(same);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    sg_error err = SG_ERROR_INIT;
    sg_grammar *g = NULL;
    const sg_status st = sg_grammar_parse((const char *)data, size, "fuzz", &g, &err);
    if (st != SG_OK) {
        fuzz_refused(st, err);
        return 0;
    }
    print_again(g);
    sg_grammar_free(g);
    return 0;
}
