/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bytes.c - numbers as bytes. */
#include "core/bytes.h"

#include "core/array.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

void sg_bytes_clear(sg_bytes *b)
{
    free(b->bytes);
    *b = (sg_bytes){0};
}

void sg_bytes_put(sg_bytes *b, uint64_t value, size_t size)
{
    b->failed = b->failed || !SG_GROW(b->bytes, b->capacity, b->n + size);
    for (size_t i = 0; !b->failed && i < size; i++)
        b->bytes[b->n++] = (unsigned char)(value >> 8 * i);
}

void sg_bytes_put_u32(sg_bytes *b, size_t value)
{
    sg_bytes_put(b, value, 4);
}

void sg_bytes_put_f32(sg_bytes *b, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    sg_bytes_put(b, bits, 4);
}

void sg_bytes_put_f64(sg_bytes *b, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    sg_bytes_put(b, bits, 8);
}

void sg_bytes_put_text(sg_bytes *b, const char *text)
{
    for (; *text != '\0'; text++)
        sg_bytes_put(b, (unsigned char)*text, 1);
}

uint64_t sg_bytes_get(sg_byte_reader *r, size_t size)
{
    uint64_t value = 0;
    r->failed = r->failed || r->n - r->at < size;
    if (r->failed)
        return 0;
    for (size_t i = 0; i < size; i++)
        value |= (uint64_t)r->bytes[r->at + i] << 8 * i;
    r->at += size;
    return value;
}

uint32_t sg_bytes_get_u32(sg_byte_reader *r)
{
    return (uint32_t)sg_bytes_get(r, 4);
}

float sg_bytes_get_f32(sg_byte_reader *r)
{
    const uint32_t bits = sg_bytes_get_u32(r);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

double sg_bytes_get_f64(sg_byte_reader *r)
{
    const uint64_t bits = sg_bytes_get(r, 8);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* zlib counts in 32 bits on some systems. */
uint32_t sg_bytes_checksum(const unsigned char *bytes, size_t n)
{
    uLong crc = crc32(0, NULL, 0);
    for (size_t i = 0; i < n;) {
        const size_t part = n - i < 1u << 30 ? n - i : 1u << 30;
        crc = crc32(crc, bytes + i, (uInt)part);
        i += part;
    }
    return (uint32_t)crc;
}
