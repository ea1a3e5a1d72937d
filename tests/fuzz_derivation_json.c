/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fuzz_derivation_json.c - any bytes as derivations in JSON. What is taken for one is written and read again, and is the
 * same then. */
#include "config.h"

#include "scene/derivation_json.h"
#include "tests/fuzz_stored.h"

#include <string.h>

/* A NaN keeps its sign alone. */
static bool same_values(const double *a, const double *b, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (memcmp(a + i, b + i, sizeof *a) != 0 && (a[i] == a[i] || b[i] == b[i]))
            return false;
    return true;
}

static void must_be_same(const sg_derivation *a, const sg_derivation *b)
{
    fuzz_must(a->nnodes == b->nnodes && a->nvalues == b->nvalues && a->nuniforms == b->nuniforms);
    fuzz_must(memcmp(a->nodes, b->nodes, a->nnodes * sizeof *a->nodes) == 0);
    fuzz_must(same_values(a->values, b->values, a->nvalues) && same_values(a->uniforms, b->uniforms, a->nuniforms));
}

static void write_again(const sg_derivation *d, bool placed)
{
    sg_error err = SG_ERROR_INIT;
    sg_derivation_file again = {0};
    char *text = NULL;
    size_t n = 0;
    FILE *fp = open_memstream(&text, &n);
    fuzz_must(fp != NULL);
    const sg_status st = placed ? sg_derivation_write_json(d, 300, 400, fp, &err) : sg_derivation_write_json_tree(d, fp, &err);
    fuzz_must(fclose(fp) == 0);
    fuzz_must(st == SG_OK || (placed && st == SG_ENUMERIC)); /* not every derivation is a label scene */
    if (st == SG_OK) {
        fuzz_must(sg_derivation_parse_json(text, n, "again", fuzz_stored_grammar(), &again, &err) == SG_OK);
        fuzz_must(again.n == 1);
        must_be_same(d, again.items);
        sg_derivation_file_clear(&again);
    }
    free(text);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    sg_error err = SG_ERROR_INIT;
    sg_derivation_file f = {0};
    const sg_status st = sg_derivation_parse_json((const char *)data, size, "fuzz", fuzz_stored_grammar(), &f, &err);
    if (st != SG_OK) {
        fuzz_refused(st, err);
        return 0;
    }
    for (size_t i = 0; i < f.n; i++) {
        write_again(f.items + i, false);
        write_again(f.items + i, true);
    }
    sg_derivation_file_clear(&f);
    return 0;
}
