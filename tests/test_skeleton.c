/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_skeleton.c - straight skeletons: known ones, those of convex polygons against the distance to their edges, those of
 * random polygons of right angles and of others, and polygons that have none. */
#include "config.h"

#include "core/random.h"
#include "scene/skeleton.h"
#include "scene/triangulate.h"
#include "tests/support.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

typedef double point[2];

/* What C does not see by itself before C23. */
#define CONST(p) ((const point *)(p))

static sg_skeleton skeleton_of(const point *p, size_t n)
{
    sg_skeleton s;
    ck_assert(sg_skeleton_find(CONST(p), n, &s));
    return s;
}

/* Of the edge i, inwards. */
static double edge_distance(const point *p, size_t n, size_t i, const double *at)
{
    const double *a = p[i], *b = p[(i + 1) % n];
    return sg_triangle_area(a, b, at) / hypot(b[0] - a[0], b[1] - a[1]);
}

/* Every corner of a face is as far from its edge as its time says; the volume under all faces. */
static double check_faces(const point *p, size_t n, const sg_skeleton *s)
{
    double volume = 0, area = 0, whole = 0;
    for (size_t i = 0; i < n; i++) {
        const sg_skeleton_face *f = s->face + i;
        test_must(f->corner[0] == i && f->corner[1] == (i + 1) % n);
        for (size_t k = 0; k < f->ncorners; k++) {
            const double *node = s->node[f->corner[k]];
            test_must(node[2] >= 0 && node[2] <= s->height);
            test_must(fabs(edge_distance(p, n, i, node) - node[2]) < 1e-7);
        }
        for (size_t k = 1; k + 1 < f->ncorners; k++) { /* a prism under each triangle, of its mean height */
            const double *a = s->node[f->corner[0]], *b = s->node[f->corner[k]], *c = s->node[f->corner[k + 1]];
            area += sg_triangle_area(a, b, c) / 2;
            volume += sg_triangle_area(a, b, c) / 2 * (a[2] + b[2] + c[2]) / 3;
        }
        whole += sg_triangle_area(p[0], p[i], p[(i + 1) % n]) / 2;
    }
    test_must(fabs(area - whole) < 1e-6 * whole);
    return volume;
}

/* Edges inside of the polygon are in two faces, once in either direction. */
static void check_edges(const sg_skeleton *s, size_t n)
{
    int count[SG_SKELETON_NODES][SG_SKELETON_NODES] = {{0}};
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < s->face[i].ncorners; k++)
            count[s->face[i].corner[k]][s->face[i].corner[(k + 1) % s->face[i].ncorners]]++;
    for (size_t a = 0; a < s->nnodes; a++)
        for (size_t b = 0; b < s->nnodes; b++) {
            const bool outer = a < n && b < n && (b == (a + 1) % n || a == (b + 1) % n);
            test_must(count[a][b] <= 1 && (outer || count[a][b] == count[b][a]));
        }
}

static void check_known(const point *p, size_t n, double height, double volume, size_t nnodes)
{
    const sg_skeleton s = skeleton_of(p, n);
    ck_assert_double_eq_tol(s.height, height, 1e-9);
    ck_assert_double_eq_tol(check_faces(p, n, &s), volume, 1e-9);
    check_edges(&s, n);
    ck_assert_uint_eq(s.nnodes, nnodes);
}

/* Volumes by hand: a hip roof of slope 1 over w by l is w^2 (3 l - w) / 12; two that cross share what both cover. */
START_TEST(known_skeletons)
{
    static const point square[] = {{0, 0}, {4, 0}, {4, 4}, {0, 4}};
    check_known(square, 4, 2, 4.0 * 4 * 2 / 3, 5);
    static const point rectangle[] = {{1, 1}, {7, 1}, {7, 5}, {1, 5}};
    check_known(rectangle, 4, 2, 4 * 4 * (3 * 6 - 4) / 12.0, 6);
    static const point triangle[] = {{0, 0}, {3, 0}, {0, 4}};
    check_known(triangle, 3, 1, 6.0 / 3, 4);
    static const point equal_l[] = {{0, 0}, {6, 0}, {6, 2}, {2, 2}, {2, 5}, {0, 5}};
    check_known(equal_l, 6, 1, 2 * 2 * (3 * 6 - 2) / 12.0 + 2 * 2 * (3 * 5 - 2) / 12.0 - 4.0 / 3, 9);
    static const point l[] = {{0, 0}, {6, 0}, {6, 4}, {2, 4}, {2, 8}, {0, 8}}; /* legs of 4 and 2 */
    const sg_skeleton s = skeleton_of(l, 6);
    ck_assert_double_eq_tol(s.height, 2, 1e-9);
    check_faces(l, 6, &s);
    check_edges(&s, 6);
    static const point in_line[] = {{0, 0}, {2, 0}, {4, 0}, {4, 4}, {0, 4}}; /* a corner that is none */
    const sg_skeleton five = skeleton_of(in_line, 5);
    ck_assert_double_eq_tol(check_faces(in_line, 5, &five), 4.0 * 4 * 2 / 3, 1e-9);
    static const point cross[] = {{2, 0}, {4, 0}, {4, 2}, {6, 2}, {6, 4}, {4, 4},
                                  {4, 6}, {2, 6}, {2, 4}, {0, 4}, {0, 2}, {2, 2}};
    check_known(cross, 12, 1, 2 * (2 * 2 * (3 * 6 - 2) / 12.0) - 4.0 / 3, 12 + 5);
    static const point u[] = {{0, 0}, {8, 0}, {8, 6}, {5, 6}, {5, 3}, {3, 3}, {3, 6}, {0, 6}};
    const sg_skeleton us = skeleton_of(u, 8);
    check_faces(u, 8, &us);
    check_edges(&us, 8);
    static const point t[] = {{0, 0}, {9, 0}, {9, 2}, {6, 2}, {6, 7}, {3, 7}, {3, 2}, {0, 2}};
    const sg_skeleton ts = skeleton_of(t, 8);
    ck_assert_double_eq_tol(ts.height, 1.625, 0.2);
    check_faces(t, 8, &ts);
    check_edges(&ts, 8);
}
END_TEST

/* In a convex polygon the time of a place is its distance to the nearest edge. */
static double convex_volume(const point *p, size_t n, double radius)
{
    enum { STEPS = 400 };
    double sum = 0;
    for (int i = 0; i < STEPS; i++)
        for (int k = 0; k < STEPS; k++) {
            const double at[2] = {radius * (2 * (i + 0.5) / STEPS - 1), radius * (2 * (k + 0.5) / STEPS - 1)};
            double least = INFINITY;
            for (size_t e = 0; e < n; e++)
                least = fmin(least, edge_distance(p, n, e, at));
            sum += fmax(0, least);
        }
    return sum * 4 * radius * radius / ((double)STEPS * STEPS);
}

START_TEST(convex_polygons)
{
    gsl_rng *rng = sg_random_create((uint64_t)_i + 1);
    for (int k = 0; k < 10; k++) {
        point p[SG_SKELETON_CORNERS];
        double angle[SG_SKELETON_CORNERS];
        const size_t n = 3 + gsl_rng_uniform_int(rng, SG_SKELETON_CORNERS - 2);
        for (size_t i = 0; i < n; i++) /* on a circle, about evenly */
            angle[i] = 2 * pi * ((double)i + 0.8 * gsl_rng_uniform(rng)) / (double)n;
        for (size_t i = 0; i < n; i++) {
            p[i][0] = 5 * cos(angle[i]);
            p[i][1] = 5 * sin(angle[i]);
        }
        sg_skeleton s;
        ck_assert_msg(sg_skeleton_find(CONST(p), n, &s), "seed %d, %d: no skeleton", _i, k);
        const double volume = check_faces(CONST(p), n, &s);
        check_edges(&s, n);
        ck_assert_uint_eq(s.nnodes, 2 * n - 2);
        ck_assert_double_eq_tol(volume, convex_volume(CONST(p), n, 5), 0.002 * volume);
    }
    gsl_rng_free(rng);
}
END_TEST

/* Regular polygons have one node: all events are one. */
START_TEST(regular_polygons)
{
    for (size_t n = 3; n <= SG_SKELETON_CORNERS; n++) {
        point p[SG_SKELETON_CORNERS];
        for (size_t i = 0; i < n; i++) {
            p[i][0] = 3 + cos(2 * pi * (double)i / (double)n);
            p[i][1] = 2 + sin(2 * pi * (double)i / (double)n);
        }
        const double height = cos(pi / (double)n), area = (double)n * sin(2 * pi / (double)n) / 2;
        check_known(CONST(p), n, height, area * height / 3, n + 1);
    }
}
END_TEST

/* Stairs: right angles, sizes in whole numbers, so that many events fall together. */
static size_t stairs(gsl_rng *rng, point *p)
{
    const size_t steps = 1 + gsl_rng_uniform_int(rng, 4);
    double x = 0, y = 0;
    size_t n = 0;
    for (size_t i = 0; i <= steps; i++)
        x += 1 + (double)gsl_rng_uniform_int(rng, 4);
    p[n][0] = p[n][1] = 0;
    p[++n][0] = x;
    p[n++][1] = 0;
    for (size_t i = 0; i <= steps; i++) {
        y += 1 + (double)gsl_rng_uniform_int(rng, 4);
        p[n][0] = x;
        p[n++][1] = y;
        x = i == steps ? 0 : x * (0.3 + 0.1 * (double)gsl_rng_uniform_int(rng, 5));
        p[n][0] = x;
        p[n++][1] = y;
    }
    return n;
}

/* Stars about the origin, with reflex corners. */
static size_t star(gsl_rng *rng, point *p)
{
    const size_t n = 4 + gsl_rng_uniform_int(rng, SG_SKELETON_CORNERS - 3);
    for (size_t i = 0; i < n; i++) {
        const double r = 1 + 3 * gsl_rng_uniform(rng),
                     angle = 2 * pi * ((double)i + 0.5 * gsl_rng_uniform(rng)) / (double)n;
        p[i][0] = r * cos(angle);
        p[i][1] = r * sin(angle);
    }
    return n;
}

START_TEST(polygons_with_reflex_corners)
{
    gsl_rng *rng = sg_random_create((uint64_t)_i + 1);
    for (int k = 0; k < 200; k++) {
        point p[SG_SKELETON_CORNERS];
        sg_skeleton s;
        const size_t n = k % 2 == 0 ? stairs(rng, p) : star(rng, p);
        ck_assert_msg(sg_skeleton_find(CONST(p), n, &s), "seed %d, %d: no skeleton of %zu corners", _i, k, n);
        check_faces(CONST(p), n, &s);
        check_edges(&s, n);
    }
    gsl_rng_free(rng);
}
END_TEST

/* Turned, moved and scaled polygons have turned, moved and scaled skeletons. */
START_TEST(the_place_does_not_matter)
{
    static const point l[] = {{0, 0}, {6, 0}, {6, 2}, {2, 2}, {2, 5}, {0, 5}};
    for (int k = 0; k < 24; k++) {
        const double angle = k * 0.7, scale = pow(10, k % 8 - 4);
        point p[6];
        sg_skeleton s;
        for (size_t i = 0; i < 6; i++) {
            p[i][0] = scale * (l[i][0] * cos(angle) - l[i][1] * sin(angle) + k);
            p[i][1] = scale * (l[i][0] * sin(angle) + l[i][1] * cos(angle) - 3 * k);
        }
        ck_assert(sg_skeleton_find(CONST(p), 6, &s));
        ck_assert_double_eq_tol(s.height / scale, 1, 1e-7);
        ck_assert_uint_eq(s.nnodes, 9);
    }
}
END_TEST

START_TEST(bad_polygons_have_none)
{
    sg_skeleton s;
    static const point crossed[] = {{0, 0}, {4, 4}, {4, 0}, {0, 5}}, clockwise[] = {{0, 0}, {0, 4}, {4, 4}, {4, 0}};
    static const point twice[] = {{0, 0}, {4, 0}, {4, 0}, {0, 4}}, flat[] = {{0, 0}, {4, 0}, {2, 0}};
    static const point nan_corner[] = {{0, 0}, {4, 0}, {NAN, 4}};
    ck_assert(!sg_skeleton_find(crossed, 4, &s));
    ck_assert(!sg_skeleton_find(clockwise, 4, &s));
    ck_assert(!sg_skeleton_find(twice, 4, &s));
    ck_assert(!sg_skeleton_find(flat, 3, &s));
    ck_assert(!sg_skeleton_find(nan_corner, 3, &s));
    ck_assert(!sg_skeleton_find(clockwise, 2, &s));
}
END_TEST

static Suite *skeleton_suite(void)
{
    Suite *s = suite_create("skeleton");
    TCase *all = tcase_create("all");
    tcase_add_test(all, known_skeletons);
    tcase_add_loop_test(all, convex_polygons, 0, 5);
    tcase_add_test(all, regular_polygons);
    tcase_add_loop_test(all, polygons_with_reflex_corners, 0, 10);
    tcase_add_test(all, the_place_does_not_matter);
    tcase_add_test(all, bad_polygons_have_none);
    suite_add_tcase(s, all);
    return s;
}

int main(void)
{
    return test_run(skeleton_suite());
}
