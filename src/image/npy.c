/* SPDX-License-Identifier: GPL-3.0-or-later */
/* npy.c - NumPy array files: a magic, a version, a header that is a Python dictionary of three keys,
 * and the values.
 * Source: NumPy Enhancement Proposal 1, "A simple file format for NumPy arrays". */
#include "config.h"

#include "core/file.h"
#include "image/image.h"
#include "image/npy.h"

#include <ctype.h>
#include <errno.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { HEADER_LIMIT = 65536 }; /* bytes: three keys need a hundred */

sg_status sg_float_map_create(size_t channels, size_t height, size_t width, sg_float_map *out, sg_error *err)
{
    SG_TRY(sg_image_check_size(width, height, err));
    if (channels == 0 || channels > SG_NPY_MAX_CHANNELS)
        return SG_FAIL(err, SG_EINVAL, "%zu values a pixel: there must be 1 to %d", channels, SG_NPY_MAX_CHANNELS);
    if (channels * height * width > SG_NPY_MAX_VALUES)
        return SG_FAIL(err, SG_EINVAL, "%zu x %zu x %zu values are too many", channels, height, width);
    float *values = calloc(channels * height * width, sizeof *values);
    if (values == NULL)
        return SG_FAIL_NOMEM(err);
    *out = (sg_float_map){channels, height, width, values};
    return SG_OK;
}

void sg_float_map_clear(sg_float_map *m)
{
    free(m->values);
    *m = (sg_float_map){0, 0, 0, NULL};
}

/* The file has the low byte first, whatever the machine has. */
static void swap_if_needed(float *values, size_t n)
{
#ifdef WORDS_BIGENDIAN
    unsigned char *p = (unsigned char *)values;
    for (size_t i = 0; i < n; i++, p += 4) {
        const unsigned char a = p[0], b = p[1];
        p[0] = p[3];
        p[1] = p[2];
        p[2] = b;
        p[3] = a;
    }
#else
    (void)values;
    (void)n;
#endif
}

/* ---- reading ---- */

/* What follows 'key': in the dictionary, or NULL. */
static const char *find_key(const char *header, const char *key)
{
    for (const char *p = strstr(header, key); p != NULL; p = strstr(p + 1, key)) {
        const char *q = p + strlen(key);
        if (p == header || (p[-1] != '\'' && p[-1] != '"') || *q != p[-1])
            continue;
        q++;
        q += strspn(q, " ");
        if (*q == ':')
            return q + 1 + strspn(q + 1, " ");
    }
    return NULL;
}

static bool parse_shape(const char *p, size_t shape[3])
{
    if (*p++ != '(')
        return false;
    for (int i = 0; i < 3; i++) {
        char *end;
        p += strspn(p, " ");
        if (!isdigit((unsigned char)*p))
            return false;
        errno = 0;
        shape[i] = strtoull(p, &end, 10);
        if (errno != 0)
            return false;
        p = end + strspn(end, "L "); /* Python 2 wrote 3L */
        if (i < 2 && *p++ != ',')
            return false;
    }
    p += *p == ',';
    p += strspn(p, " ");
    return *p == ')';
}

static sg_status parse_header(const char *path, const char *header, size_t shape[3], sg_error *err)
{
    const char *type = find_key(header, "descr"), *order = find_key(header, "fortran_order");
    const char *size = find_key(header, "shape");
    if (type == NULL || order == NULL || size == NULL)
        return SG_FAIL(err, SG_EINPUT, "%s: a NumPy header without type, order or shape", path);
    if (strncmp(type, "'<f4'", 5) != 0 && strncmp(type, "\"<f4\"", 5) != 0)
        return SG_FAIL(err, SG_EINPUT, "%s: the values are of type %.*s, not 32-bit floats ('<f4')", path,
                       (int)strcspn(type, ",}"), type);
    if (strncmp(order, "False", 5) != 0)
        return SG_FAIL(err, SG_EINPUT, "%s: the array is in Fortran order, not in C order", path);
    if (!parse_shape(size, shape))
        return SG_FAIL(err, SG_EINPUT, "%s: the shape is %.*s, not (classes, height, width)", path,
                       (int)strcspn(size, ")") + 1, size);
    return SG_OK;
}

static sg_status read_header(const char *path, FILE *fp, sg_arena *arena, size_t shape[3], sg_error *err)
{
    unsigned char h[12];
    errno = 0;
    const size_t got = fread(h, 1, 10, fp);
    if (ferror(fp))
        return SG_FAIL(err, SG_EINPUT, "%s: %s", path, strerror(errno));
    if (got == 0 || memcmp(h, "\x93NUMPY", got < 6 ? got : 6) != 0)
        return SG_FAIL(err, SG_EINPUT, "%s: no NumPy array file", path);
    if (got < 10)
        return SG_FAIL(err, SG_EINPUT, "%s: the file is truncated", path);
    if (h[6] < 1 || h[6] > 3)
        return SG_FAIL(err, SG_EINPUT, "%s: NumPy format version %u is not known", path, (unsigned)h[6]);
    size_t length = (size_t)h[8] | (size_t)h[9] << 8;
    if (h[6] > 1) {
        if (fread(h + 10, 1, 2, fp) != 2)
            return SG_FAIL(err, SG_EINPUT, "%s: the file is truncated", path);
        length |= (size_t)h[10] << 16 | (size_t)h[11] << 24;
    }
    if (length > HEADER_LIMIT)
        return SG_FAIL(err, SG_EINPUT, "%s: a NumPy header of %zu bytes", path, length);
    char *header = sg_arena_calloc(arena, length + 1, 1);
    if (header == NULL)
        return SG_FAIL_NOMEM(err);
    if (fread(header, 1, length, fp) != length)
        return SG_FAIL(err, SG_EINPUT, "%s: the file is truncated", path);
    return parse_header(path, header, shape, err);
}

/* Before any memory is taken: does the file hold what its header promises? Pipes cannot tell. */
static sg_status check_length(const char *path, FILE *fp, size_t bytes, sg_error *err)
{
    const off_t begin = ftello(fp);
    if (begin < 0 || fseeko(fp, 0, SEEK_END) != 0)
        return SG_OK;
    const off_t end = ftello(fp);
    if (end < begin || fseeko(fp, begin, SEEK_SET) != 0)
        return SG_FAIL(err, SG_EINPUT, "%s: %s", path, strerror(errno));
    if ((size_t)(end - begin) < bytes)
        return SG_FAIL(err, SG_EINPUT, "%s: the file is truncated", path);
    return SG_OK;
}

static sg_status read_values(const char *path, FILE *fp, sg_float_map *m, sg_error *err)
{
    const size_t n = m->channels * m->height * m->width;
    errno = 0;
    if (fread(m->values, sizeof(float), n, fp) != n)
        return SG_FAIL(err, SG_EINPUT, "%s: %s", path, ferror(fp) ? strerror(errno) : "the file is truncated");
    if (getc(fp) != EOF)
        return SG_FAIL(err, SG_EINPUT, "%s: more bytes than the shape says", path);
    swap_if_needed(m->values, n);
    return SG_OK;
}

static sg_status read_open_file(const char *path, FILE *fp, sg_arena *arena, sg_float_map *out, sg_error *err)
{
    size_t shape[3];
    sg_float_map m = {0, 0, 0, NULL};
    sg_error inner = SG_ERROR_INIT;
    SG_TRY(read_header(path, fp, arena, shape, err));
    if (shape[0] <= SG_NPY_MAX_CHANNELS && shape[1] <= SG_IMAGE_MAX_SIDE && shape[2] <= SG_IMAGE_MAX_SIDE)
        SG_TRY(check_length(path, fp, shape[0] * shape[1] * shape[2] * sizeof(float), err));
    sg_status st = sg_float_map_create(shape[0], shape[1], shape[2], &m, &inner);
    if (st != SG_OK)
        return st == SG_ENOMEM ? SG_FAIL_NOMEM(err) : SG_FAIL(err, SG_EINPUT, "%s: %s", path, inner.msg);
    st = read_values(path, fp, &m, err);
    if (st == SG_OK)
        *out = m;
    else
        sg_float_map_clear(&m);
    return st;
}

sg_status sg_npy_read(const char *path, sg_float_map *out, sg_error *err)
{
    FILE *fp = fopen(path, "rb");
    if (fp == NULL)
        return SG_FAIL(err, SG_EINPUT, "%s: %s", path, strerror(errno));
    sg_arena *arena = sg_arena_create();
    const sg_status st = arena != NULL ? read_open_file(path, fp, arena, out, err) : SG_FAIL_NOMEM(err);
    sg_arena_free(arena);
    fclose(fp);
    return st;
}

/* ---- writing ---- */

static void write_header(FILE *fp, const sg_float_map *m)
{
    char text[192];
    const int n = snprintf(text, sizeof text, "{'descr': '<f4', 'fortran_order': False, 'shape': (%zu, %zu, %zu), }",
                           m->channels, m->height, m->width);
    const size_t length = ((size_t)n + 1 + 10 + 63) / 64 * 64 - 10; /* the values begin at a multiple of 64 bytes */
    const unsigned char low = (unsigned char)length, high = (unsigned char)(length >> 8);
    const unsigned char h[10] = {0x93, 'N', 'U', 'M', 'P', 'Y', 1, 0, low, high};
    fwrite(h, 1, sizeof h, fp);
    fprintf(fp, "%-*s\n", (int)length - 1, text);
}

static void write_values(FILE *fp, const sg_float_map *m)
{
    enum { BLOCK = 4096 };
    float block[BLOCK];
    const size_t n = m->channels * m->height * m->width;
    for (size_t i = 0; i < n; i += BLOCK) {
        const size_t k = n - i < BLOCK ? n - i : BLOCK;
        memcpy(block, m->values + i, k * sizeof *block);
        swap_if_needed(block, k);
        fwrite(block, sizeof *block, k, fp);
    }
}

sg_status sg_npy_write(const char *path, const sg_float_map *m, sg_error *err)
{
    sg_output out;
    SG_TRY(sg_image_check_size(m->width, m->height, err));
    SG_TRY(sg_output_open(&out, path, err));
    write_header(out.fp, m);
    write_values(out.fp, m);
    return sg_output_commit(&out, err); /* a failed write shows up here */
}
