/* SPDX-License-Identifier: GPL-3.0-or-later */
/* jpeg_info.c - segments of a JPEG file (ITU T.81, annex B). */
#include "config.h"

#include "image/image.h"
#include "image/jpeg_info.h"

enum { SOI = 0xd8, EOI = 0xd9, SOS = 0xda, RST0 = 0xd0, RST7 = 0xd7, TEM = 0x01 };

bool sg_jpeg_is(const uint8_t *bytes, size_t n)
{
    return n >= 3 && bytes[0] == 0xff && bytes[1] == SOI && bytes[2] == 0xff;
}

static size_t get_u16(const uint8_t *p)
{
    return (size_t)p[0] << 8 | p[1];
}

/* SOF0..SOF15 without DHT, JPG and DAC, which lie between them. */
static bool is_frame(unsigned marker)
{
    return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
}

/* With Huffman codes each block of 64 samples takes a bit at least, and the blocks of the finest component in either
 * direction cover half of the picture together, however they are sampled. Arithmetic codes have no such bound. */
static bool is_beyond(unsigned marker, size_t pixels, size_t nbytes)
{
    return marker <= 0xc7 && pixels / (2 * 64 * 8) > nbytes;
}

static sg_status read_frame(unsigned marker, const uint8_t *segment, size_t length, size_t nbytes, size_t *width,
                            size_t *height, sg_error *err)
{
    if (length < 8)
        return SG_FAIL(err, SG_EINPUT, "a damaged JPEG file: its frame header is too short");
    if (segment[2] != 8)
        return SG_FAIL(err, SG_EINPUT, "a JPEG file of %u bits a channel; only 8 are read", (unsigned)segment[2]);
    *height = get_u16(segment + 3);
    *width = get_u16(segment + 5);
    sg_error inner = SG_ERROR_INIT;
    if (sg_image_check_size(*width, *height, &inner) != SG_OK)
        return SG_FAIL(err, SG_EINPUT, "%s", inner.msg);
    if (is_beyond(marker, *width * *height, nbytes))
        return SG_FAIL(err, SG_EINPUT, "a damaged JPEG file: %zu x %zu pixels cannot come from %zu bytes", *width, *height,
                       nbytes);
    return SG_OK;
}

/* Past the coded data of a scan: to the next 0xff that begins a marker other than a restart. */
static size_t skip_scan(const uint8_t *bytes, size_t n, size_t at)
{
    for (; at + 1 < n; at++) {
        const unsigned next = bytes[at + 1];
        if (bytes[at] == 0xff && next != 0 && next != 0xff && !(next >= RST0 && next <= RST7))
            return at;
    }
    return n;
}

sg_status sg_jpeg_check(const uint8_t *bytes, size_t n, size_t *width, size_t *height, sg_error *err)
{
    size_t at = 2; /* after SOI */
    bool framed = false, scanned = false;
    while (at + 1 < n) {
        if (bytes[at] != 0xff)
            return SG_FAIL(err, SG_EINPUT, "a damaged JPEG file: no marker at byte %zu", at);
        const unsigned marker = bytes[at + 1];
        at += marker == 0xff ? 1 : 2; /* 0xff before a marker is filling */
        if (marker == 0xff || marker == TEM || (marker >= RST0 && marker <= RST7))
            continue;
        if (marker == EOI)
            return framed && scanned ? SG_OK : SG_FAIL(err, SG_EINPUT, "a JPEG file without a picture");
        if (at + 2 > n)
            break;
        const size_t length = get_u16(bytes + at);
        if (length < 2 || marker == SOI || marker == 0)
            return SG_FAIL(err, SG_EINPUT, "a damaged JPEG file: a bad segment at byte %zu", at - 2);
        if (length > n - at)
            break;
        if (is_frame(marker)) {
            SG_TRY(read_frame(marker, bytes + at, length, n, width, height, err));
            framed = true;
        }
        at += length;
        if (marker == SOS) {
            at = skip_scan(bytes, n, at);
            scanned = true;
        }
    }
    return SG_FAIL(err, SG_EINPUT, "the file is truncated");
}
