/* SPDX-License-Identifier: GPL-3.0-or-later */
/* raster.c - triangles by their edge functions (Pineda, "A parallel algorithm for polygon rasterization", 1988), in whole
 * numbers: what lies on an edge is known exactly. */
#include "scene/raster_priv.h"

#include "core/array.h"
#include "image/image.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

sg_status sg_raster_create(size_t width, size_t height, bool triangles, sg_raster *out, sg_error *err)
{
    SG_TRY(sg_image_check_size(width, height, err));
    sg_raster r = {.width = width, .height = height};
    r.keys = malloc(width * height * sizeof *r.keys);
    r.triangles = triangles ? malloc(width * height * sizeof *r.triangles) : NULL;
    if (r.keys == NULL || (triangles && r.triangles == NULL)) {
        sg_raster_clear(&r);
        return SG_FAIL_NOMEM(err);
    }
    sg_raster_wipe(&r);
    *out = r;
    return SG_OK;
}

void sg_raster_clear(sg_raster *r)
{
    free(r->keys);
    free(r->triangles);
    free(r->work);
    *r = (sg_raster){0};
}

void sg_raster_wipe(sg_raster *r)
{
    for (size_t x = 0; x < r->width; x++)
        r->keys[x] = INFINITY;
    for (size_t y = 1; y < r->height; y++)
        memcpy(r->keys + y * r->width, r->keys, r->width * sizeof *r->keys);
    if (r->triangles != NULL)
        memset(r->triangles, 0xff, r->width * r->height * sizeof *r->triangles);
}

/* Positive inside, once the corners run clockwise as one looks at the picture. */
typedef struct {
    int64_t value;  /* at the sample where a row begins */
    int64_t dx, dy; /* to the next sample, to the next row */
    int64_t own;    /* 0 where samples on the edge belong to it, else 1 */
} edge;

static edge edge_of(const sg_raster_vertex *a, const sg_raster_vertex *b, int64_t x, int64_t y)
{
    const int64_t dx = (int64_t)b->x - a->x, dy = (int64_t)b->y - a->y;
    const bool top_left = dy < 0 || (dy == 0 && dx > 0);
    return (edge){dx * (y - a->y) - dy * (x - a->x), -dy * SG_RASTER_FINE, dx * SG_RASTER_FINE, top_left ? 0 : 1};
}

/* First sample of a row, from its begin on, that an edge lets in; `limit` when none does. */
static int64_t first_inside(const edge *e, int64_t limit)
{
    const int64_t value = e->value - e->own;
    if (value >= 0)
        return 0;
    if (e->dx <= 0)
        return limit;
    const int64_t steps = (-value + e->dx - 1) / e->dx;
    return steps < limit ? steps : limit;
}

/* One behind the last such sample. */
static int64_t end_inside(const edge *e, int64_t limit)
{
    const int64_t value = e->value - e->own;
    if (e->dx >= 0)
        return value < 0 && e->dx == 0 ? 0 : limit;
    if (value < 0)
        return 0;
    const int64_t steps = value / -e->dx + 1;
    return steps < limit ? steps : limit;
}

/* Samples of a row that all three edges let in. In narrow triangles trying them is faster than dividing. */
static void row_range(const edge *e, int64_t width, int64_t *from, int64_t *to)
{
    enum { NARROW = 6 };
    *from = 0;
    *to = width;
    if (width <= NARROW) {
        int64_t a = e[0].value - e[0].own, b = e[1].value - e[1].own, c = e[2].value - e[2].own, x = 0;
        for (; x < width && (a | b | c) < 0; x++, a += e[0].dx, b += e[1].dx, c += e[2].dx)
            continue;
        *from = x;
        for (; x < width && (a | b | c) >= 0; x++, a += e[0].dx, b += e[1].dx, c += e[2].dx)
            continue;
        *to = x;
        return;
    }
    for (int i = 0; i < 3; i++) {
        const int64_t first = first_inside(e + i, width), end = end_inside(e + i, width);
        *from = first > *from ? first : *from;
        *to = end < *to ? end : *to;
    }
}

/* Whole pixels. What is below 0 is moved above it first, where division rounds down and is a shift. */
static int64_t floor_fine(int64_t x)
{
    const uint64_t above = UINT64_C(1) << 40;
    return (int64_t)(((uint64_t)x + above) / SG_RASTER_FINE) - (int64_t)(above / SG_RASTER_FINE);
}

static int64_t least3(int64_t a, int64_t b, int64_t c)
{
    return a < b ? (a < c ? a : c) : (b < c ? b : c);
}

static int64_t most3(int64_t a, int64_t b, int64_t c)
{
    return a > b ? (a > c ? a : c) : (b > c ? b : c);
}

/* Samples from low to high - 1 that a triangle can have, cut off at the picture. */
static bool sample_range(int64_t a, int64_t b, int64_t c, size_t size, int64_t *low, int64_t *high)
{
    *low = -floor_fine(-least3(a, b, c));
    *high = floor_fine(most3(a, b, c)) + 1;
    *low = *low > 0 ? *low : 0;
    *high = *high < (int64_t)size ? *high : (int64_t)size;
    return *low < *high;
}

typedef struct {
    double key, per_b, per_c; /* the key of corner a, and what the edge functions opposite to b and c add */
    double dx;                /* to the next sample */
} key_plane;

static void draw_keys(float *keys, int32_t n, float key, float dx)
{
    int32_t i = 0;
    for (; i + 4 <= n; i += 4) /* four at once, which compilers turn into one instruction each */
        for (int32_t j = 0; j < 4; j++) {
            const float k = key + (float)(i + j) * dx;
            keys[i + j] = k < keys[i + j] ? k : keys[i + j];
        }
    for (; i < n; i++) {
        const float k = key + (float)i * dx;
        keys[i] = k < keys[i] ? k : keys[i];
    }
}

static void draw_span(sg_raster *r, const edge *e, const key_plane *p, size_t row, int64_t from, int64_t to, uint32_t index)
{
    if (from >= to)
        return;
    const double b = (double)(e[2].value + from * e[2].dx), c = (double)(e[0].value + from * e[0].dx);
    const double key = p->key + b * p->per_b + c * p->per_c;
    float *keys = r->keys + row + from;
    if (r->triangles == NULL) {
        draw_keys(keys, (int32_t)(to - from), (float)key, (float)p->dx);
        return;
    }
    for (int64_t i = 0; i < to - from; i++) {
        const float k = (float)key + (float)(int32_t)i * (float)p->dx;
        if (k < keys[i]) {
            keys[i] = k;
            r->triangles[row + (size_t)(from + i)] = index;
        }
    }
}

void sg_raster_triangle(sg_raster *r, const sg_raster_vertex *a, const sg_raster_vertex *b, const sg_raster_vertex *c,
                        uint32_t index)
{
    int64_t left, right, top, bottom;
    if (!sample_range(a->x, b->x, c->x, r->width, &left, &right) ||
        !sample_range(a->y, b->y, c->y, r->height, &top, &bottom))
        return;
    int64_t area = ((int64_t)b->x - a->x) * ((int64_t)c->y - a->y) - ((int64_t)b->y - a->y) * ((int64_t)c->x - a->x);
    if (area == 0)
        return;
    if (area < 0) {
        const sg_raster_vertex *other = b;
        b = c;
        c = other;
        area = -area;
    }
    const int64_t x = left * SG_RASTER_FINE, y = top * SG_RASTER_FINE, width = right - left;
    edge e[3] = {edge_of(a, b, x, y), edge_of(b, c, x, y), edge_of(c, a, x, y)};
    key_plane k = {a->key, (b->key - a->key) / (double)area, (c->key - a->key) / (double)area, 0};
    k.dx = (double)e[2].dx * k.per_b + (double)e[0].dx * k.per_c;
    for (int64_t row = top; row < bottom; row++) {
        int64_t from, to;
        row_range(e, width, &from, &to);
        draw_span(r, e, &k, (size_t)row * r->width + (size_t)left, from, to, index);
        for (int i = 0; i < 3; i++)
            e[i].value += e[i].dy;
    }
}

/* Of a number within 2^29: above 0 the conversion rounds down. lround() is a call, and this is done for each vertex. */
static int32_t nearest(double x)
{
    const int32_t above = 1 << 29;
    return (int32_t)(x + 0.5 + above) - above;
}

sg_raster_vertex sg_raster_place(const sg_raster_job *j, const double *at)
{
    const sg_camera *c = j->camera;
    const double w = c->projection == SG_PROJECTION_PERSPECTIVE ? at[2] : 1;
    const double x = (1 + at[0] / (c->half[0] * w)) * (double)j->raster->width / 2 - j->offset[0];
    const double y = (1 - at[1] / (c->half[1] * w)) * (double)j->raster->height / 2 - j->offset[1];
    if (!(at[2] >= c->near) || !(fabs(x) <= SG_RASTER_GUARD) || !(fabs(y) <= SG_RASTER_GUARD))
        return (sg_raster_vertex){SG_RASTER_OUTSIDE, 0, 0};
    return (sg_raster_vertex){nearest(x * SG_RASTER_FINE), nearest(y * SG_RASTER_FINE), sg_camera_key(c, at[2])};
}

static void draw_triangle(const sg_raster_job *j, const sg_mesh *m, uint32_t index)
{
    const sg_raster_vertex *v[3];
    sg_mesh_corner corner[3];
    bool outside = false;
    sg_raster_corners(m, index, corner);
    for (int i = 0; i < 3; i++) {
        v[i] = j->raster->work + corner[i].vertex;
        outside = outside || v[i]->x == SG_RASTER_OUTSIDE;
    }
    if (!outside) {
        sg_raster_triangle(j->raster, v[0], v[1], v[2], index);
        return;
    }
    double at[3][3];
    for (int i = 0; i < 3; i++)
        sg_camera_coordinates(j->camera, m->vertices[corner[i].vertex], at[i]);
    sg_raster_clipped(j, (const double(*)[3])at, index);
}

sg_status sg_raster_draw(sg_raster *r, const sg_mesh *mesh, const sg_camera *camera, const double *offset, sg_error *err)
{
    const sg_raster_job j = {r, camera, offset};
    if (mesh->nfaces >= (size_t)1 << 31)
        return SG_FAIL(err, SG_ENUMERIC, "a mesh of 2^31 faces or more cannot be drawn");
    if (!SG_GROW(r->work, r->work_capacity, mesh->nvertices + 1))
        return SG_FAIL_NOMEM(err);
    for (size_t i = 0; i < mesh->nvertices; i++) {
        double at[3];
        sg_camera_coordinates(camera, mesh->vertices[i], at);
        r->work[i] = sg_raster_place(&j, at);
    }
    for (uint32_t i = 0; i < mesh->nfaces; i++)
        for (uint32_t half = 0; half + 2 < mesh->faces[i].ncorners; half++)
            draw_triangle(&j, mesh, 2 * i + half);
    return SG_OK;
}

bool sg_raster_shares(const double *origin, const double *direction, const double *a, const double *b, const double *c,
                      double *shares)
{
    double ab[3], ac[3], from[3], p[3], q[3];
    sg_vec_add(b, -1, a, ab);
    sg_vec_add(c, -1, a, ac);
    sg_vec_add(origin, -1, a, from);
    sg_vec_cross(direction, ac, p);
    sg_vec_cross(from, ab, q);
    const double determinant = sg_vec_dot(ab, p);
    double v = sg_vec_dot(from, p) / determinant, w = sg_vec_dot(direction, q) / determinant;
    const bool good = isfinite(v) && isfinite(w);
    v = good ? fmin(1, fmax(0, v)) : 1.0 / 3;
    w = good ? fmin(1, fmax(0, w)) : 1.0 / 3;
    const double sum = fmax(1, v + w);
    shares[1] = v / sum;
    shares[2] = w / sum;
    shares[0] = fmax(0, 1 - shares[1] - shares[2]);
    return good;
}
