/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_raster.c - cameras and the rasteriser: projections of known points, the fill rule, depth, interpolation, clipping. */
#include "config.h"

#include "core/random.h"
#include "scene/raster_priv.h"
#include "tests/render_support.h"
#include "tests/support.h"

#include <math.h>

static const double centre[2] = {0.5, 0.5};

/* ---- cameras ---- */

START_TEST(known_points_are_projected)
{
    /* From (0, 0, 4) along -z; tangents 0.5 and 0.25. */
    sg_camera c = {.frame = {{0, 0, 4}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .half = {0.5, 0.25}, .near = 1, .scale = 1};
    double out[3];
    sg_camera_project(&c, (const double[]){0, 0, 0}, 200, 100, out);
    ck_assert_double_eq_tol(out[0], 100, 1e-12);
    ck_assert_double_eq_tol(out[1], 50, 1e-12);
    ck_assert_double_eq_tol(sg_camera_depth(&c, out[2]), 4, 1e-12);
    sg_camera_project(&c, (const double[]){1, 0.5, 2}, 200, 100, out); /* depth 2: the corner of the picture */
    ck_assert_double_eq_tol(out[0], 200, 1e-12);
    ck_assert_double_eq_tol(out[1], 0, 1e-12);
    sg_camera_project(&c, (const double[]){1, 0.5, 0}, 200, 100, out); /* twice as deep: half way there */
    ck_assert_double_eq_tol(out[0], 150, 1e-12);
    ck_assert_double_eq_tol(out[1], 25, 1e-12);
    c.projection = SG_PROJECTION_ORTHOGRAPHIC;
    for (double z = -3; z < 3; z++) {
        sg_camera_project(&c, (const double[]){0.25, -0.25, z}, 200, 100, out);
        ck_assert_double_eq_tol(out[0], 150, 1e-12);
        ck_assert_double_eq_tol(out[1], 100, 1e-12);
        ck_assert_double_eq_tol(sg_camera_depth(&c, out[2]), 4 - z, 1e-12);
    }
}
END_TEST

START_TEST(views_look_from_where_they_say)
{
    static const double origin[1][3] = {{0, 0, 0}};
    sg_view view = SG_VIEW_INIT;
    double at[3];
    view.azimuth = view.elevation = 0;
    sg_camera c = sg_camera_fit(origin, 1, &view, 1);
    ck_assert(c.frame.origin[2] > 0 && fabs(c.frame.origin[0]) < 1e-12);
    sg_camera_coordinates(&c, (const double[]){1, 0, 0}, at);
    ck_assert_double_eq_tol(at[0], 1, 1e-12); /* x is at the right */
    view.azimuth = 90;
    c = sg_camera_fit(origin, 1, &view, 1);
    ck_assert(c.frame.origin[0] > 0);
    sg_camera_coordinates(&c, (const double[]){0, 0, -1}, at);
    ck_assert_double_eq_tol(at[0], 1, 1e-12);
    view.elevation = 90; /* straight down, with the same right */
    c = sg_camera_fit(origin, 1, &view, 1);
    ck_assert(c.frame.origin[1] > 0);
    sg_camera_coordinates(&c, (const double[]){-2, 0, -1}, at);
    ck_assert_double_eq_tol(at[0], 1, 1e-12);
    ck_assert_double_eq_tol(at[1], 2, 1e-12);
}
END_TEST

static double coordinate(gsl_rng *rng)
{
    return 2 * gsl_rng_uniform(rng) - 1;
}

/* All points are in the picture, two opposite sides of the free margin are touched, and the others are equally far. */
START_TEST(a_fitted_camera_sees_all_and_no_more)
{
    gsl_rng *rng = sg_random_create((uint64_t)_i + 1);
    double points[20][3], low[2] = {1e9, 1e9}, high[2] = {-1e9, -1e9}, out[3];
    const double width = _i % 3 == 0 ? 300 : 100, height = _i % 3 == 1 ? 300 : 100, scale = pow(10, 6 * coordinate(rng));
    for (int i = 0; i < 20; i++)
        for (int k = 0; k < 3; k++)
            points[i][k] = scale * (coordinate(rng) + 1);
    sg_view view = SG_VIEW_INIT;
    view.azimuth = 180 * coordinate(rng);
    view.elevation = 90 * coordinate(rng);
    view.projection = _i % 2 == 0 ? SG_PROJECTION_PERSPECTIVE : SG_PROJECTION_ORTHOGRAPHIC;
    view.margin = 0.1;
    const sg_camera c = sg_camera_fit((const double(*)[3])points, 20, &view, width / height);
    for (int i = 0; i < 20; i++) {
        sg_camera_coordinates(&c, points[i], out);
        ck_assert(out[2] > c.near);
        sg_camera_project(&c, points[i], (size_t)width, (size_t)height, out);
        for (int k = 0; k < 2; k++) {
            const double r = 2 * out[k] / (k == 0 ? width : height) - 1;
            low[k] = fmin(low[k], r);
            high[k] = fmax(high[k], r);
        }
    }
    ck_assert_double_eq_tol(fmax(high[0], high[1]), 0.9, 1e-9);
    ck_assert_double_eq_tol(fmin(low[0], low[1]), -0.9, 1e-9);
    for (int k = 0; k < 2 && view.projection == SG_PROJECTION_ORTHOGRAPHIC; k++)
        ck_assert_double_eq_tol(low[k], -high[k], 1e-9);
    gsl_rng_free(rng);
}
END_TEST

START_TEST(rays_go_through_what_they_show)
{
    gsl_rng *rng = sg_random_create(7);
    for (int i = 0; i < 200; i++) {
        static const double box[2][3] = {{-1, -1, -1}, {1, 1, 1}};
        sg_view view = {360 * gsl_rng_uniform(rng), 90 * coordinate(rng), (sg_projection)(i % 2), 40, 0};
        const sg_camera c = sg_camera_fit(box, 2, &view, 1.5);
        const double p[3] = {coordinate(rng), coordinate(rng), coordinate(rng)};
        double at[3], origin[3], direction[3], back[3];
        sg_camera_project(&c, p, 90, 60, at);
        sg_camera_ray(&c, at[0], at[1], 90, 60, origin, direction);
        sg_vec_add(origin, sg_camera_depth(&c, at[2]), direction, back);
        for (int k = 0; k < 3; k++)
            ck_assert_double_eq_tol(back[k], p[k], 1e-9);
    }
    gsl_rng_free(rng);
}
END_TEST

/* ---- the fill rule ---- */

enum { SIDE = 32 };

typedef struct {
    int32_t x, y;
} fine_point;

/* Twice the signed area. */
static int64_t turn(fine_point a, fine_point b, fine_point c)
{
    return ((int64_t)b.x - a.x) * ((int64_t)c.y - a.y) - ((int64_t)b.y - a.y) * ((int64_t)c.x - a.x);
}

static void count_triangle(fine_point a, fine_point b, fine_point c, uint8_t *count)
{
    sg_raster r = {0};
    sg_error err = SG_ERROR_INIT;
    const sg_raster_vertex v[3] = {{a.x, a.y, 0}, {b.x, b.y, 0}, {c.x, c.y, 0}};
    test_must_ok(sg_raster_create(SIDE, SIDE, true, &r, &err));
    sg_raster_triangle(&r, v, v + 1, v + 2, 5);
    for (size_t i = 0; i < SIDE * SIDE; i++) {
        test_must(r.triangles[i] == 5 || r.triangles[i] == SG_RASTER_NONE);
        count[i] = (uint8_t)(count[i] + (r.triangles[i] == 5));
    }
    sg_raster_clear(&r);
}

/* Corners often stand on samples, and edges run through them. */
static fine_point random_corner(gsl_rng *rng, bool coarse)
{
    const double x = (1.5 * SIDE) * gsl_rng_uniform(rng) - SIDE / 4, y = (1.5 * SIDE) * gsl_rng_uniform(rng) - SIDE / 4;
    if (coarse)
        return (fine_point){SG_RASTER_FINE * (int32_t)x, SG_RASTER_FINE * (int32_t)y};
    return (fine_point){(int32_t)(SG_RASTER_FINE * x), (int32_t)(SG_RASTER_FINE * y)};
}

/* Both ways to cut a convex quadrilateral: every sample inside is in one of the two triangles, never in both; and the
 * samples are the same for both ways, those on the outline too. */
START_TEST(each_sample_of_a_quad_is_in_one_triangle)
{
    gsl_rng *rng = sg_random_create((uint64_t)_i + 1);
    int tried = 0;
    while (tried < 50) {
        fine_point q[4];
        for (int k = 0; k < 4; k++)
            q[k] = random_corner(rng, tried % 2 == 0);
        bool convex = true;
        for (int k = 0; k < 4; k++)
            convex = convex && turn(q[k], q[(k + 1) % 4], q[(k + 2) % 4]) > 0;
        if (!convex)
            continue;
        uint8_t one[SIDE * SIDE] = {0}, other[SIDE * SIDE] = {0};
        count_triangle(q[0], q[1], q[2], one);
        count_triangle(q[0], q[3], q[2], one); /* the other way round: winding plays no part */
        count_triangle(q[1], q[2], q[3], other);
        count_triangle(q[3], q[0], q[1], other);
        for (int i = 0; i < SIDE * SIDE; i++) {
            const fine_point p = {SG_RASTER_FINE * (i % SIDE), SG_RASTER_FINE * (i / SIDE)};
            bool inside = true, outside = false;
            for (int k = 0; k < 4; k++) {
                inside = inside && turn(q[k], q[(k + 1) % 4], p) > 0;
                outside = outside || turn(q[k], q[(k + 1) % 4], p) < 0;
            }
            test_must(one[i] == other[i] && one[i] <= 1);
            test_must(!inside || one[i] == 1);
            test_must(!outside || one[i] == 0);
        }
        tried++;
    }
    gsl_rng_free(rng);
}
END_TEST

/* Quadrilaterals around a corner that stands on a sample: it belongs to one of them. */
START_TEST(a_corner_belongs_to_one_triangle)
{
    const fine_point c = {10 * SG_RASTER_FINE, 10 * SG_RASTER_FINE};
    for (int n = 3; n < 9; n++) {
        uint8_t count[SIDE * SIDE] = {0};
        fine_point rim[9];
        for (int k = 0; k < n; k++)
            rim[k] = (fine_point){c.x + (int32_t)(2000 * cos(0.1 * n + 6.283185307179586 * k / n)),
                                  c.y + (int32_t)(2000 * sin(0.1 * n + 6.283185307179586 * k / n))};
        for (int k = 0; k < n; k++)
            count_triangle(c, rim[k], rim[(k + 1) % n], count);
        ck_assert_uint_eq(count[10 * SIDE + 10], 1);
        for (int i = 0; i < SIDE * SIDE; i++)
            test_must(count[i] <= 1);
    }
}
END_TEST

/* A unit square at samples takes its upper left one only. */
START_TEST(top_and_left_edges_are_inside)
{
    uint8_t count[SIDE * SIDE] = {0};
    const int32_t a = 4 * SG_RASTER_FINE, b = 6 * SG_RASTER_FINE;
    count_triangle((fine_point){a, a}, (fine_point){b, a}, (fine_point){b, b}, count);
    count_triangle((fine_point){a, a}, (fine_point){b, b}, (fine_point){a, b}, count);
    for (int i = 0; i < SIDE * SIDE; i++)
        test_must(count[i] == (i % SIDE >= 4 && i % SIDE < 6 && i / SIDE >= 4 && i / SIDE < 6));
}
END_TEST

/* ---- depth and interpolation ---- */

/* Depth at which a ray, whose parameter is the depth, meets the plane of a triangle. */
static double plane_depth(const double *origin, const double *direction, const double (*t)[3])
{
    double ab[3], ac[3], n[3], to[3];
    sg_vec_add(t[1], -1, t[0], ab);
    sg_vec_add(t[2], -1, t[0], ac);
    sg_vec_cross(ab, ac, n);
    sg_vec_add(t[0], -1, origin, to);
    return sg_vec_dot(n, to) / sg_vec_dot(n, direction);
}

/* Corners are rounded: as far as the depth differs a hundredth of a pixel away. */
static double rounding(const sg_camera *c, size_t i, const double (*t)[3], double depth)
{
    double sum = 0, origin[3], direction[3];
    for (int k = 0; k < 2; k++) {
        sg_camera_ray(c, (double)(i % 64) + (k == 0 ? 0.51 : 0.5), (double)(i / 64) + (k == 1 ? 0.51 : 0.5), 64, 64, origin,
                      direction);
        sum += fabs(plane_depth(origin, direction, t) - depth);
    }
    return sum;
}

static void random_triangle(gsl_rng *rng, double (*t)[3])
{
    for (int i = 0; i < 9; i++)
        t[i / 3][i % 3] = coordinate(rng);
}

/* Two triangles that run through each other: the nearer one is seen, at its depth, where both are. */
START_TEST(triangles_that_cross_hide_each_other)
{
    gsl_rng *rng = sg_random_create((uint64_t)_i + 1);
    sg_error err = SG_ERROR_INIT;
    double t[2][3][3];
    test_mesh *m = test_mesh_create(0), *alone[2] = {test_mesh_create(0), test_mesh_create(0)};
    for (int k = 0; k < 2; k++) {
        random_triangle(rng, t[k]);
        test_mesh_add(m, (const double(*)[3])t[k], 3);
        test_mesh_add(alone[k], (const double(*)[3])t[k], 3);
    }
    const sg_view view = {360 * gsl_rng_uniform(rng), 90 * coordinate(rng), (sg_projection)(_i % 2), 40, 0.05};
    const sg_camera c = sg_camera_fit((const double(*)[3])m->vertices, m->mesh.nvertices, &view, 1);
    sg_raster both = {0}, one[2] = {{0}, {0}};
    ck_ok(sg_raster_create(64, 64, true, &both, &err));
    ck_ok(sg_raster_draw(&both, &m->mesh, &c, centre, &err));
    for (int k = 0; k < 2; k++) {
        ck_ok(sg_raster_create(64, 64, true, one + k, &err));
        ck_ok(sg_raster_draw(one + k, &alone[k]->mesh, &c, centre, &err));
    }
    for (size_t i = 0; i < 64 * 64; i++) {
        double origin[3], direction[3], depth[2], slack[2];
        sg_camera_ray(&c, (double)(i % 64) + 0.5, (double)(i / 64) + 0.5, 64, 64, origin, direction);
        for (int k = 0; k < 2; k++) {
            depth[k] = plane_depth(origin, direction, (const double(*)[3])t[k]);
            slack[k] = 1e-5 + rounding(&c, i, (const double(*)[3])t[k], depth[k]);
        }
        const bool covered[2] = {one[0].triangles[i] == 0, one[1].triangles[i] == 0};
        const uint32_t seen = both.triangles[i];
        test_must((seen == SG_RASTER_NONE) == (!covered[0] && !covered[1]));
        if (seen == SG_RASTER_NONE)
            continue;
        test_must(seen == 0 || seen == 2);
        test_must(covered[seen / 2]);
        test_must(fabs(sg_camera_depth(&c, (double)both.keys[i]) - depth[seen / 2]) <= 2 * slack[seen / 2]);
        if (covered[0] && covered[1])
            test_must(depth[seen / 2] <= depth[1 - seen / 2] + 2 * (slack[0] + slack[1]));
    }
    sg_raster_clear(&both);
    for (int k = 0; k < 2; k++) {
        sg_raster_clear(one + k);
        free(alone[k]);
    }
    free(m);
    gsl_rng_free(rng);
}
END_TEST

/* Level ground under a camera that looks to the horizon: in row y of a picture the depth is h / slope(y), and what is
 * interpolated is the point itself. Linear interpolation in the picture would be far off. */
START_TEST(interpolation_is_that_of_perspective)
{
    const sg_camera c = {.frame = {{0, 1, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .half = {1, 1}, .near = 0.1, .scale = 1};
    const double t[3][3] = {{-40, 0, -1}, {40, 0, -1}, {0, 0, -60}};
    for (int y = 55; y < 95; y++) {
        double origin[3], direction[3], share[3], at[3] = {0, 0, 0};
        sg_camera_ray(&c, 50.5, y + 0.5, 100, 100, origin, direction);
        ck_assert(sg_raster_shares(origin, direction, t[0], t[1], t[2], share));
        for (int i = 0; i < 3; i++)
            sg_vec_add(at, share[i], t[i], at);
        const double depth = 1 / ((y + 0.5) / 50 - 1);
        ck_assert_double_eq_tol(at[2], -depth, 1e-9 * depth);
        ck_assert_double_eq_tol(at[0], 0.01 * depth, 1e-9 * depth);
        ck_assert_double_eq_tol(at[1], 0, 1e-9);
        ck_assert_double_eq_tol(share[0] + share[1] + share[2], 1, 1e-12);
    }
}
END_TEST

/* Ground from far behind the camera to far before it: below the horizon all of the picture, once. */
START_TEST(what_reaches_behind_the_camera_is_clipped)
{
    sg_error err = SG_ERROR_INIT;
    for (double far = 10; far < 1e12; far *= 100) {
        const double ground[4][3] = {{-far, 0, far}, {far, 0, far}, {far, 0, -far}, {-far, 0, -far}};
        const sg_camera c = {.frame = {{0.1, 1, 0.2}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .half = {1, 1}, .near = 0.1, .scale = 1};
        test_mesh *m = test_mesh_create(0);
        sg_raster r = {0};
        uint8_t count[40 * 40] = {0};
        test_mesh_add(m, ground, 4);
        ck_ok(sg_raster_create(40, 40, true, &r, &err));
        for (uint32_t half = 0; half < 2; half++) { /* each triangle alone */
            m->faces[0].ncorners = 3;
            m->faces[0].corner[1].vertex = 1 + half;
            m->faces[0].corner[2].vertex = 2 + half;
            sg_raster_wipe(&r);
            ck_ok(sg_raster_draw(&r, &m->mesh, &c, centre, &err));
            for (int i = 0; i < 40 * 40; i++)
                count[i] = (uint8_t)(count[i] + (r.triangles[i] == 0));
        }
        for (int i = 0; i < 40 * 40; i++) {
            const double slope = (i / 40 + 0.5) / 20 - 1; /* downwards; the ground ends where depth 1 / slope is far */
            test_must(count[i] <= 1);
            test_must(slope > 0 || count[i] == 0);
            test_must(slope <= 0 || 1 / slope > 0.9 * far - 1 || count[i] == 1);
            if (r.triangles[i] == 0)
                test_must(fabs(sg_camera_depth(&c, (double)r.keys[i]) * slope - 1) < 1e-2);
        }
        sg_raster_clear(&r);
        free(m);
    }
}
END_TEST

/* Faces without area, points far away, and none at all. */
START_TEST(degenerate_meshes_draw_nothing)
{
    sg_error err = SG_ERROR_INIT;
    const double line[3][3] = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}, point[4][3] = {{1, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 0, 0}};
    const double huge[3][3] = {{-1e100, -1e100, -5}, {1e100, -1e100, -5}, {0, 1e100, -5}};
    const sg_view view = SG_VIEW_INIT;
    test_mesh *m = test_mesh_create(0);
    sg_raster r = {0};
    ck_ok(sg_raster_create(9, 7, true, &r, &err));
    sg_camera c = sg_camera_fit(NULL, 0, &view, 9.0 / 7);
    ck_ok(sg_raster_draw(&r, &m->mesh, &c, centre, &err));
    test_mesh_add(m, line, 3);
    test_mesh_add(m, point, 4);
    c = sg_camera_fit((const double(*)[3])m->vertices, m->mesh.nvertices, &view, 9.0 / 7);
    ck_ok(sg_raster_draw(&r, &m->mesh, &c, centre, &err));
    for (int i = 0; i < 63; i++)
        ck_assert(r.triangles[i] == SG_RASTER_NONE && r.keys[i] == INFINITY);
    test_mesh_add(m, huge, 3);
    c = (sg_camera){.frame = SG_FRAME_INIT, .half = {1, 1}, .near = 1, .scale = 1};
    ck_ok(sg_raster_draw(&r, &m->mesh, &c, centre, &err));
    for (int i = 0; i < 63; i++) {
        ck_assert_uint_eq(r.triangles[i], 4);
        ck_assert_double_eq_tol(sg_camera_depth(&c, (double)r.keys[i]), 5, 1e-5);
    }
    sg_raster_clear(&r);
    ck_assert_int_eq(sg_raster_create(0, 7, true, &r, &err), SG_EINVAL);
    ck_assert_int_eq(sg_raster_create(7, (size_t)1 << 40, true, &r, &err), SG_EINVAL);
    free(m);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("raster");
    TCase *cameras = tcase_create("cameras"), *fill = tcase_create("fill"), *depth = tcase_create("depth");
    tcase_add_test(cameras, known_points_are_projected);
    tcase_add_test(cameras, views_look_from_where_they_say);
    tcase_add_loop_test(cameras, a_fitted_camera_sees_all_and_no_more, 0, 60);
    tcase_add_test(cameras, rays_go_through_what_they_show);
    tcase_add_loop_test(fill, each_sample_of_a_quad_is_in_one_triangle, 0, 10);
    tcase_add_test(fill, a_corner_belongs_to_one_triangle);
    tcase_add_test(fill, top_and_left_edges_are_inside);
    tcase_add_loop_test(depth, triangles_that_cross_hide_each_other, 0, 40);
    tcase_add_test(depth, interpolation_is_that_of_perspective);
    tcase_add_test(depth, what_reaches_behind_the_camera_is_clipped);
    tcase_add_test(depth, degenerate_meshes_draw_nothing);
    suite_add_tcase(suite, cameras);
    suite_add_tcase(suite, fill);
    suite_add_tcase(suite, depth);
    return test_run(suite);
}
