/* SPDX-License-Identifier: GPL-3.0-or-later */
/* import_labelme.c - annotations of the LabelMe tool in JSON: shapes with class names, drawn in their order. */
#include "config.h"

#include "core/file.h"
#include "data/import_priv.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { FILE_LIMIT = 1 << 29, MIN_ARC = 16, MAX_ARC = 4096 }; /* bytes (photographs may be in them); corners of a circle */

typedef struct {
    const char *type, *label;
    double *xy; /* [n][2] */
    size_t n;
} shape;

/* ---- one shape ---- */

static sg_status read_points(const json_t *points, sg_arena *arena, shape *s, sg_error *err)
{
    s->n = json_array_size(points);
    if (!json_is_array(points) || s->n == 0)
        return SG_FAIL(err, SG_EINPUT, "no points");
    s->xy = SG_NEW_ARRAY(arena, double, 2 * s->n);
    if (s->xy == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t i = 0; i < 2 * s->n; i++) {
        const json_t *point = json_array_get(points, i / 2), *v = json_array_get(point, i % 2);
        if (json_array_size(point) != 2 || !json_is_number(v))
            return SG_FAIL(err, SG_EINPUT, "point %zu is no pair of numbers", i / 2 + 1);
        s->xy[i] = json_number_value(v);
    }
    return SG_OK;
}

static sg_status read_shape(const json_t *j, sg_arena *arena, shape *s, sg_error *err)
{
    const json_t *type = json_object_get(j, "shape_type"); /* early versions had polygons only and did not say so */
    s->label = json_string_value(json_object_get(j, "label"));
    s->type = type == NULL || json_is_null(type) ? "polygon" : json_string_value(type);
    if (s->label == NULL || s->type == NULL)
        return SG_FAIL(err, SG_EINPUT, "no label, or a type that is no word");
    return read_points(json_object_get(j, "points"), arena, s, err);
}

/* Two opposite corners become four. */
static sg_status expand_rectangle(shape *s, sg_arena *arena, sg_error *err)
{
    const double *c = s->xy;
    const double corners[8] = {c[0], c[1], c[2], c[1], c[2], c[3], c[0], c[3]};
    s->xy = sg_arena_copy(arena, corners, sizeof corners);
    s->n = 4;
    return s->xy != NULL ? SG_OK : SG_FAIL_NOMEM(err);
}

/* Centre and a point of the circle become corners about a pixel apart. */
static sg_status expand_circle(shape *s, sg_arena *arena, sg_error *err)
{
    const double x = s->xy[0], y = s->xy[1], radius = hypot(s->xy[2] - x, s->xy[3] - y);
    s->n = (size_t)fmin(MAX_ARC, fmax(MIN_ARC, ceil(2 * M_PI * radius)));
    s->xy = SG_NEW_ARRAY(arena, double, 2 * s->n);
    if (s->xy == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t i = 0; i < s->n; i++) {
        const double angle = 2 * M_PI * (double)i / (double)s->n;
        s->xy[2 * i] = x + radius * cos(angle);
        s->xy[2 * i + 1] = y + radius * sin(angle);
    }
    return SG_OK;
}

static sg_status make_polygon(shape *s, sg_arena *arena, sg_error *err)
{
    if (strcmp(s->type, "rectangle") == 0 && s->n == 2)
        return expand_rectangle(s, arena, err);
    if (strcmp(s->type, "circle") == 0 && s->n == 2)
        return expand_circle(s, arena, err);
    if (strcmp(s->type, "polygon") == 0 || (strcmp(s->type, "rectangle") == 0 && s->n == 4))
        return SG_OK;
    return SG_FAIL(err, SG_EINPUT, "a %.40s of %zu points is no area that can be drawn", s->type, s->n);
}

/* ---- names ---- */

/* Class tables have no blanks in names; annotators do: 'street lamp' is found as street-lamp or street_lamp. */
static int find_index(const sg_importer *im, const char *label)
{
    char name[128];
    if (strcmp(label, "ignore") == 0)
        return im->void_index;
    if (strlen(label) >= sizeof name)
        return -1;
    for (const char *joint = " -_"; *joint != '\0'; joint++) {
        strcpy(name, label);
        for (char *p = strchr(name, ' '); p != NULL && *joint != ' '; p = strchr(p, ' '))
            *p = *joint;
        const int class = sg_classes_find(&im->classes, name);
        if (class >= 0)
            return im->classes.first_index[class];
    }
    return -1;
}

/* ---- the file ---- */

static sg_status draw_shape(const sg_importer *im, const json_t *j, sg_import_tally *tally, sg_label_map *m,
                            sg_error *err)
{
    shape s = {NULL, NULL, NULL, 0};
    SG_TRY(read_shape(j, im->scratch, &s, err));
    const int index = find_index(im, s.label);
    if (index < 0)
        return sg_import_tally_add(tally, s.label, 0, 0, err);
    SG_TRY(make_polygon(&s, im->scratch, err));
    const sg_status st = sg_label_map_fill_polygon(m, s.xy, s.n, (uint8_t)index, err);
    return st == SG_EINVAL ? SG_EINPUT : st; /* the sentence is right: it speaks of corners */
}

static sg_status draw_shapes(const sg_importer *im, const char *path, const json_t *shapes, sg_import_tally *tally,
                             sg_label_map *m, sg_error *err)
{
    sg_error inner = SG_ERROR_INIT;
    if (!json_is_array(shapes))
        return SG_FAIL(err, SG_EINPUT, "%s: no LabelMe file: it has no list of shapes", path);
    for (size_t i = 0; i < json_array_size(shapes); i++) {
        const sg_status st = draw_shape(im, json_array_get(shapes, i), tally, m, &inner);
        if (st == SG_ENOMEM)
            return SG_FAIL_NOMEM(err);
        if (st != SG_OK)
            return SG_FAIL(err, SG_EINPUT, "%s: shape %zu: %s", path, i + 1, inner.msg);
    }
    return SG_OK;
}

/* Width or height: the file's own, else the photograph's. 0 when neither says it. */
static sg_status read_side(const char *path, const json_t *root, const char *key, size_t photo, size_t *out,
                           sg_error *err)
{
    const json_t *v = json_object_get(root, key);
    *out = photo;
    if (v == NULL || json_is_null(v)) {
        if (photo == 0)
            return SG_FAIL(err, SG_EINPUT, "%s: no %s in it, and no photograph to take it from", path, key);
        return SG_OK;
    }
    const json_int_t n = json_integer_value(v);
    if (!json_is_integer(v) || n < 1 || n > SG_IMAGE_MAX_SIDE)
        return SG_FAIL(err, SG_EINPUT, "%s: %s is no number of pixels from 1 to %d", path, key, SG_IMAGE_MAX_SIDE);
    *out = (size_t)n;
    return SG_OK;
}

static sg_status create_map(const sg_importer *im, const char *path, const json_t *root, sg_import_size photo,
                            sg_label_map *out, sg_error *err)
{
    size_t width, height;
    sg_error inner = SG_ERROR_INIT;
    SG_TRY(read_side(path, root, "imageWidth", photo.width, &width, err));
    SG_TRY(read_side(path, root, "imageHeight", photo.height, &height, err));
    const sg_status st = sg_label_map_create(width, height, out, &inner);
    if (st != SG_OK)
        return st == SG_ENOMEM ? SG_FAIL_NOMEM(err) : SG_FAIL(err, SG_EINPUT, "%s: %s", path, inner.msg);
    memset(out->labels, im->background, width * height);
    return SG_OK;
}

static sg_status read_root(const sg_importer *im, const char *path, const json_t *root, sg_import_size photo,
                           sg_label_map *out, sg_error *err)
{
    sg_label_map m = {0, 0, NULL};
    sg_import_tally *tally = sg_import_tally_begin(im->scratch);
    if (tally == NULL)
        return SG_FAIL_NOMEM(err);
    sg_status st = create_map(im, path, root, photo, &m, err);
    if (st == SG_OK)
        st = draw_shapes(im, path, json_object_get(root, "shapes"), tally, &m, err);
    const sg_status told = sg_import_tally_end(tally, path, "class name", "shape", st == SG_OK ? err : NULL);
    if (st == SG_OK)
        st = told;
    if (st == SG_OK)
        *out = m;
    else
        sg_label_map_clear(&m);
    return st;
}

sg_status sg_import_labelme(const sg_importer *im, const char *path, sg_import_size photo, sg_label_map *out,
                            sg_error *err)
{
    char *text;
    size_t length;
    json_error_t why;
    SG_TRY(sg_file_read(path, FILE_LIMIT, im->scratch, &text, &length, err));
    json_t *root = json_loadb(text, length, 0, &why);
    if (root == NULL && json_error_code(&why) == json_error_out_of_memory)
        return SG_FAIL_NOMEM(err);
    if (root == NULL)
        return SG_FAIL(err, SG_EINPUT, "%s:%d:%d: error: %s", path, why.line, why.column, why.text);
    const sg_status st = read_root(im, path, root, photo, out, err);
    json_decref(root);
    return st;
}
