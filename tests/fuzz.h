/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fuzz.h - what every fuzzer of ours is: one function, called with any bytes by libFuzzer or by fuzz_main.c. A failed
 * assertion aborts, which both take for a find. */
#ifndef SG_TESTS_FUZZ_H
#define SG_TESTS_FUZZ_H

#include "core/status.h"

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#define fuzz_must(condition)                                                                                           \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, #condition);                                            \
            abort();                                                                                                   \
        }                                                                                                              \
    } while (0)

/** Bytes that nobody could have made may be refused, with a sentence, and memory may be out; nothing else. */
#define fuzz_refused(status, err) fuzz_must(((status) == SG_EINPUT && (err).msg[0] != '\0') || (status) == SG_ENOMEM)

#endif
