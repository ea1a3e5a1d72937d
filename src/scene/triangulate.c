/* SPDX-License-Identifier: GPL-3.0-or-later */
/* triangulate.c - cutting off ears. */
#include "scene/triangulate.h"

#include <string.h>

double sg_triangle_area(const double *a, const double *b, const double *c)
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

double sg_polygon_area(const double (*p)[2], size_t n)
{
    double sum = 0;
    for (size_t i = 1; i + 1 < n; i++)
        sum += sg_triangle_area(p[0], p[i], p[i + 1]) / 2;
    return sum;
}

bool sg_polygon_convex(const double (*p)[2], size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (!(sg_triangle_area(p[i], p[(i + 1) % n], p[(i + 2) % n]) > 0))
            return false;
    return true;
}

static bool same_place(const double *a, const double *b)
{
    return a[0] == b[0] && a[1] == b[1];
}

/* Its border counts, its corners do not. */
static bool inside(const double *x, const double *a, const double *b, const double *c)
{
    if (same_place(x, a) || same_place(x, b) || same_place(x, c))
        return false;
    return sg_triangle_area(a, b, x) >= 0 && sg_triangle_area(b, c, x) >= 0 && sg_triangle_area(c, a, x) >= 0;
}

/* Can the corner at place i of those left be cut off? Counts the corners looked at. */
static bool is_ear(const double (*p)[2], const uint32_t *left, size_t n, size_t i, size_t *looks)
{
    const size_t before = (i + n - 1) % n, after = (i + 1) % n;
    const double *a = p[left[before]], *b = p[left[i]], *c = p[left[after]];
    if (!(sg_triangle_area(a, b, c) > 0))
        return false;
    for (size_t k = 0; k < n; k++) {
        ++*looks;
        if (k != before && k != i && k != after && inside(p[left[k]], a, b, c))
            return false;
    }
    return true;
}

static void fan(size_t n, uint32_t (*triangles)[3])
{
    for (uint32_t k = 0; k + 2 < n; k++) {
        triangles[k][0] = 0;
        triangles[k][1] = k + 1;
        triangles[k][2] = k + 2;
    }
}

static bool cut_ears(const double (*p)[2], size_t n, uint32_t (*triangles)[3], uint32_t *left)
{
    const size_t most = 4 * n * n;
    size_t looks = 0, at = 0;
    for (uint32_t k = 0; k < n; k++)
        left[k] = k;
    for (size_t m = n; m >= 3; m--) {
        size_t tries = 0;
        while (tries < m && looks <= most && !is_ear(p, left, m, at % m, &looks)) {
            at++;
            tries++;
        }
        if (tries == m || looks > most)
            return false;
        const size_t i = at % m;
        uint32_t *t = triangles[n - m];
        t[0] = left[(i + m - 1) % m];
        t[1] = left[i];
        t[2] = left[(i + 1) % m];
        memmove(left + i, left + i + 1, (m - i - 1) * sizeof *left);
        at = i + 1; /* not the next corner, so that triangles are no thinner than they must be */
    }
    return true;
}

bool sg_triangulate(const double (*p)[2], size_t n, uint32_t (*triangles)[3], uint32_t *left)
{
    if (sg_polygon_convex(p, n)) {
        fan(n, triangles);
        return true;
    }
    if (cut_ears(p, n, triangles, left))
        return true;
    fan(n, triangles);
    return false;
}
