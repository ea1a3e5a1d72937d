/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fuzz_derivation_binary.c - any bytes as a file of derivations (*.sgd), as they are, and once more with length, checksum
 * and fingerprint mended, since no mutation finds these. */
#include "config.h"

#include "derivation/derivation_io.h"
#include "grammar/fingerprint.h"
#include "tests/fuzz_stored.h"

#include <string.h>

enum { HEAD = 24, FINGERPRINT = 8 };

/* What was read is written as the very same bytes. */
static void write_again(const sg_derivation_file *f, const uint8_t *data, size_t size)
{
    sg_bytes b = {0};
    fuzz_must(sg_derivation_file_encode(fuzz_stored_grammar(), f->items, f->n, &b, NULL) == SG_OK);
    fuzz_must(b.n == size);
    if (f->n == 0)
        fuzz_must(memcmp(b.bytes, data, size) == 0);
    sg_derivation_file again = {0};
    fuzz_must(sg_derivation_file_decode(b.bytes, b.n, "again", fuzz_stored_grammar(), &again, NULL) == SG_OK);
    fuzz_must(again.n == f->n);
    for (size_t i = 0; i < f->n; i++) {
        const sg_derivation *d = f->items + i, *e = again.items + i;
        fuzz_must(d->nnodes == e->nnodes && memcmp(d->nodes, e->nodes, d->nnodes * sizeof *d->nodes) == 0);
        fuzz_must(d->nvalues == 0 || memcmp(d->values, e->values, d->nvalues * sizeof *d->values) == 0);
        fuzz_must(d->nuniforms == 0 || memcmp(d->uniforms, e->uniforms, d->nuniforms * sizeof *d->uniforms) == 0);
    }
    sg_derivation_file_clear(&again);
    sg_bytes_clear(&b);
}

static void try_bytes(const uint8_t *data, size_t size)
{
    sg_error err = SG_ERROR_INIT;
    sg_derivation_file f = {0};
    const sg_status st = sg_derivation_file_decode(data, size, "fuzz", fuzz_stored_grammar(), &f, &err);
    if (st != SG_OK) {
        fuzz_refused(st, err);
        return;
    }
    write_again(&f, data, size);
    sg_derivation_file_clear(&f);
}

static void put(uint8_t *at, uint64_t value, size_t size)
{
    for (size_t i = 0; i < size; i++)
        at[i] = (uint8_t)(value >> 8 * i);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    uint64_t fingerprint = 0;
    try_bytes(data, size);
    if (size < HEAD + FINGERPRINT)
        return 0;
    fuzz_must(sg_grammar_fingerprint(fuzz_stored_grammar(), &fingerprint, NULL) == SG_OK);
    uint8_t *copy = malloc(size);
    fuzz_must(copy != NULL);
    memcpy(copy, data, size);
    memcpy(copy, "sgderiv\n\1\0\0\0", 12);
    put(copy + HEAD, fingerprint, FINGERPRINT);
    put(copy + 12, sg_bytes_checksum(copy + HEAD, size - HEAD), 4);
    put(copy + 16, size - HEAD, 8);
    try_bytes(copy, size);
    free(copy);
    return 0;
}
