/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bytes.h - numbers as little-endian bytes, whatever the machine: what binary files are made of. */
#ifndef SG_CORE_BYTES_H
#define SG_CORE_BYTES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** A growing buffer: a zeroed one is empty, free with sg_bytes_clear(). */
typedef struct {
    unsigned char *bytes;
    size_t n, capacity;
    bool failed; /* memory is out: nothing more is added */
} sg_bytes;

void sg_bytes_clear(sg_bytes *b);
/** Append the lowest `size` (at most 8) bytes of value. */
void sg_bytes_put(sg_bytes *b, uint64_t value, size_t size);
/** The same of 4 bytes, of the 4 or 8 of an IEEE 754 number, and of a text without its NUL. */
void sg_bytes_put_u32(sg_bytes *b, size_t value);
void sg_bytes_put_f32(sg_bytes *b, float value);
void sg_bytes_put_f64(sg_bytes *b, double value);
void sg_bytes_put_text(sg_bytes *b, const char *text);

/** A place in bytes that are read. */
typedef struct {
    const unsigned char *bytes;
    size_t n, at;
    bool failed; /* more was asked for than there is: all further numbers are 0 */
} sg_byte_reader;

/** The next number of `size` (at most 8) bytes. */
uint64_t sg_bytes_get(sg_byte_reader *r, size_t size);
/** The next 4 bytes, and the next 4 or 8 as an IEEE 754 number, whatever its bits. */
uint32_t sg_bytes_get_u32(sg_byte_reader *r);
float sg_bytes_get_f32(sg_byte_reader *r);
double sg_bytes_get_f64(sg_byte_reader *r);

/** CRC-32, as zlib has it. */
uint32_t sg_bytes_checksum(const unsigned char *bytes, size_t n);

#endif
