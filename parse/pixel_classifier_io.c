/* SPDX-License-Identifier: GPL-3.0-or-later */
/* pixel_classifier_io.c - classifiers as files (*.rf), version 1. All numbers are little-endian, whatever the machine:
 *
 *   8 bytes  "sgforest"          u32  version
 *   u32  CRC-32 of what follows the length       u64  bytes that follow here
 *   u32 x 3  kind, patch, version of the features
 *   u32  balanced  u32  calibration fitted  f64  temperature  f64  exponent
 *   u32  classes   256 bytes  class of each pixel index   u32 x 256  colour of each pixel index
 *   for each class: f64  frequency in the leaves  u32  bytes of its name, and these
 *   u32 x 5  features, classes, trees, nodes, leaves
 *   u32 x (trees + 1)  first node of each tree
 *   for each node: f32  threshold  u32  feature  u32  child      (forest.h)
 *   f32 x leaves x classes  probabilities
 */
#include "config.h"

#include "core/bytes.h"
#include "core/file.h"
#include "core/utf8.h"
#include "parse/pixel_classifier_priv.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#define MAGIC "sgforest"
enum { FILE_VERSION = 1, HEAD = 24, MAX_NAME = 1024 }; /* bytes */
#define FILE_LIMIT ((size_t)1 << 32)              /* bytes */

/* ---- writing ---- */

static void put_classes(sg_bytes *b, const sg_pixel_classifier *c)
{
    sg_bytes_put_u32(b, c->classes.nclasses);
    for (size_t i = 0; i < 256; i++)
        sg_bytes_put(b, c->classes.class_of[i], 1);
    for (size_t i = 0; i < 256; i++)
        sg_bytes_put_u32(b, c->classes.index_colors[i]);
    for (size_t k = 0; k < c->classes.nclasses; k++) {
        const char *name = c->classes.names[k];
        sg_bytes_put_f64(b, c->frequency[k]);
        sg_bytes_put_u32(b, strlen(name));
        sg_bytes_put_text(b, name);
    }
}

static void put_forest(sg_bytes *b, const sg_forest *f)
{
    sg_bytes_put_u32(b, f->nfeatures);
    sg_bytes_put_u32(b, f->nclasses);
    sg_bytes_put_u32(b, f->ntrees);
    sg_bytes_put_u32(b, f->nnodes);
    sg_bytes_put_u32(b, f->nleaves);
    for (size_t t = 0; t <= f->ntrees; t++)
        sg_bytes_put_u32(b, f->roots[t]);
    for (size_t i = 0; i < f->nnodes; i++) {
        sg_bytes_put_f32(b, f->nodes[i].threshold);
        sg_bytes_put_u32(b, f->nodes[i].feature);
        sg_bytes_put_u32(b, f->nodes[i].child);
    }
    for (size_t i = 0; i < f->nleaves * f->nclasses; i++)
        sg_bytes_put_f32(b, f->leaves[i]);
}

static void put_all(sg_bytes *b, const sg_pixel_classifier *c)
{
    sg_bytes_put_u32(b, (size_t)c->features.kind);
    sg_bytes_put_u32(b, c->features.patch);
    sg_bytes_put_u32(b, c->features.version);
    sg_bytes_put_u32(b, c->balanced);
    sg_bytes_put_u32(b, c->calibration.fitted);
    sg_bytes_put_f64(b, c->calibration.temperature);
    sg_bytes_put_f64(b, c->calibration.exponent);
    put_classes(b, c);
    put_forest(b, &c->forest);
}

static sg_status write_parts(const char *path, sg_bytes *head, const sg_bytes *body, sg_error *err)
{
    sg_output out;
    sg_bytes_put_text(head, MAGIC);
    sg_bytes_put_u32(head, FILE_VERSION);
    sg_bytes_put_u32(head, sg_bytes_checksum(body->bytes, body->n));
    sg_bytes_put(head, body->n, 8);
    if (head->failed || body->failed)
        return SG_FAIL_NOMEM(err);
    SG_TRY(sg_output_open(&out, path, err));
    fwrite(head->bytes, 1, head->n, out.fp);
    fwrite(body->bytes, 1, body->n, out.fp);
    return sg_output_commit(&out, err); /* a failed write shows up here */
}

sg_status sg_pixel_classifier_write(const char *path, const sg_pixel_classifier *c, sg_error *err)
{
    sg_bytes head = {0}, body = {0};
    put_all(&body, c);
    const sg_status st = write_parts(path, &head, &body, err);
    sg_bytes_clear(&head);
    sg_bytes_clear(&body);
    return st;
}

/* ---- reading ---- */

static size_t left(const sg_byte_reader *c)
{
    return c->n - c->at;
}

static sg_status no_sense(sg_error *err, const char *what)
{
    return SG_FAIL(err, SG_EINPUT, "%s", what);
}

static bool is_good_name(const char *name, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (isspace((unsigned char)name[i]) || iscntrl((unsigned char)name[i]))
            return false;
    return name[0] != '#' && strcmp(name, "ignore") != 0 && sg_utf8_is(name, n);
}

static sg_status get_name(sg_byte_reader *c, sg_classes *classes, sg_error *err)
{
    const size_t n = sg_bytes_get_u32(c);
    if (c->failed || n == 0 || n > MAX_NAME || n > left(c))
        return no_sense(err, "a class name of no length that could be");
    char *name = malloc(n + 1);
    if (name == NULL)
        return SG_FAIL_NOMEM(err);
    memcpy(name, c->bytes + c->at, n);
    name[n] = '\0';
    c->at += n;
    if (!is_good_name(name, n) || sg_classes_find(classes, name) >= 0) {
        free(name);
        return no_sense(err, "a class name that is none");
    }
    classes->names[classes->nclasses++] = name;
    return SG_OK;
}

/* The first index of each class, in increasing order as classes are numbered. */
static sg_status find_first_indices(sg_classes *classes, size_t nclasses, sg_error *err)
{
    size_t found = 0;
    for (size_t i = 0; i < 256; i++) {
        const size_t class = classes->class_of[i];
        if (class == SG_CLASS_IGNORE || class == SG_CLASS_UNKNOWN || class < found)
            continue;
        if (class != found || class >= nclasses)
            return no_sense(err, "classes that are not in the order of their indices");
        classes->first_index[found] = (uint8_t)i;
        classes->colors[found++] = classes->index_colors[i];
    }
    return found == nclasses ? SG_OK : no_sense(err, "a class that has no pixel index");
}

static sg_status get_classes(sg_byte_reader *c, sg_pixel_classifier *to, sg_error *err)
{
    const size_t n = sg_bytes_get_u32(c);
    for (size_t i = 0; i < 256; i++)
        to->classes.class_of[i] = (uint8_t)sg_bytes_get(c, 1);
    for (size_t i = 0; i < 256; i++)
        to->classes.index_colors[i] = sg_bytes_get_u32(c) & 0xffffff;
    if (c->failed || n == 0 || n > SG_MAX_CLASSES)
        return no_sense(err, "it has no classes");
    for (size_t k = 0; k < n; k++) {
        to->frequency[k] = sg_bytes_get_f64(c);
        SG_TRY(get_name(c, &to->classes, err));
    }
    return find_first_indices(&to->classes, n, err);
}

static sg_status get_forest(sg_byte_reader *c, sg_forest *f, sg_error *err)
{
    const size_t nfeatures = sg_bytes_get_u32(c), nclasses = sg_bytes_get_u32(c), ntrees = sg_bytes_get_u32(c);
    const size_t nnodes = sg_bytes_get_u32(c), nleaves = sg_bytes_get_u32(c);
    /* 32-bit sizes: neither product nor sum overflows 64 bits, and nothing is allocated that the file cannot fill */
    if (c->failed || nclasses > SG_MAX_CLASSES || left(c) != 4 * (ntrees + 1 + 3 * nnodes + nleaves * nclasses))
        return no_sense(err, "tables of other sizes than it says");
    sg_error inner = SG_ERROR_INIT;
    const sg_status st = sg_forest_create(nfeatures, nclasses, ntrees, nnodes, nleaves, f, &inner);
    if (st != SG_OK)
        return st == SG_ENOMEM ? SG_FAIL_NOMEM(err) : SG_FAIL(err, SG_EINPUT, "%s", inner.msg);
    for (size_t t = 0; t <= ntrees; t++)
        f->roots[t] = sg_bytes_get_u32(c);
    for (size_t i = 0; i < nnodes; i++) {
        f->nodes[i].threshold = sg_bytes_get_f32(c);
        f->nodes[i].feature = sg_bytes_get_u32(c);
        f->nodes[i].child = sg_bytes_get_u32(c);
    }
    for (size_t i = 0; i < nleaves * nclasses; i++)
        f->leaves[i] = sg_bytes_get_f32(c);
    return SG_OK;
}

static sg_status get_all(sg_byte_reader *c, sg_pixel_classifier *to, sg_error *err)
{
    const uint32_t kind = sg_bytes_get_u32(c);
    if (kind > SG_FEATURES_RICH)
        return no_sense(err, "features of a kind that is not known here");
    to->features.kind = (sg_feature_kind)kind;
    to->features.patch = sg_bytes_get_u32(c);
    to->features.version = sg_bytes_get_u32(c);
    to->balanced = sg_bytes_get_u32(c) != 0;
    to->calibration.fitted = sg_bytes_get_u32(c) != 0;
    to->calibration.temperature = sg_bytes_get_f64(c);
    to->calibration.exponent = sg_bytes_get_f64(c);
    SG_TRY(get_classes(c, to, err));
    SG_TRY(get_forest(c, &to->forest, err));
    return sg_pixel_classifier_check(to, err);
}

static sg_status check_head(sg_byte_reader *c, sg_error *err)
{
    if (left(c) < HEAD || memcmp(c->bytes + c->at, MAGIC, strlen(MAGIC)) != 0)
        return SG_FAIL(err, SG_EINPUT, left(c) < HEAD && memcmp(c->bytes + c->at, MAGIC, left(c) < 8 ? left(c) : 8) == 0
                                           ? "the file is cut short"
                                           : "not a pixel classifier (*.rf)");
    c->at += strlen(MAGIC);
    const uint32_t version = sg_bytes_get_u32(c), crc = sg_bytes_get_u32(c);
    const uint64_t length = sg_bytes_get(c, 8);
    if (version != FILE_VERSION)
        return SG_FAIL(err, SG_EINPUT, "a pixel classifier of version %u; this program knows version %d",
                       (unsigned)version, FILE_VERSION);
    if (left(c) != length)
        return SG_FAIL(err, SG_EINPUT, left(c) < length ? "the file is cut short: %zu of %llu bytes"
                                                        : "the file is too long: %zu bytes in place of %llu",
                       left(c) + HEAD, (unsigned long long)length + HEAD);
    if (sg_bytes_checksum(c->bytes + c->at, left(c)) != crc)
        return SG_FAIL(err, SG_EINPUT, "the file is damaged: its checksum does not hold");
    return SG_OK;
}

static sg_status read_bytes(const char *path, sg_arena *arena, sg_pixel_classifier *to, sg_error *err)
{
    char *text;
    size_t n;
    sg_error inner = SG_ERROR_INIT;
    SG_TRY(sg_file_read(path, FILE_LIMIT, arena, &text, &n, err));
    sg_byte_reader c = {(const unsigned char *)text, n, 0, false};
    sg_status st = check_head(&c, &inner);
    if (st == SG_OK)
        st = get_all(&c, to, &inner);
    if (st == SG_ENOMEM)
        return SG_FAIL_NOMEM(err);
    return st == SG_OK ? SG_OK : SG_FAIL(err, st, "%s: %.900s", path, inner.msg);
}

sg_status sg_pixel_classifier_read(const char *path, sg_pixel_classifier **out, sg_error *err)
{
    sg_pixel_classifier *c = calloc(1, sizeof *c);
    sg_arena *arena = sg_arena_create();
    const sg_status st = c != NULL && arena != NULL ? read_bytes(path, arena, c, err) : SG_FAIL_NOMEM(err);
    sg_arena_free(arena);
    if (st == SG_OK)
        *out = c;
    else
        sg_pixel_classifier_free(c);
    return st;
}
