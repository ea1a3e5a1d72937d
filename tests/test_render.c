/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_render.c - pictures: light that is hidden against closed forms, edges that are smoothed, thin twigs, shadows, odd
 * sizes, the same bytes whatever the threads, memory that runs out. */
#include "config.h"

#include "scene/render.h"
#include "scene/shade.h"
#include "scene/srgb.h"
#include "tests/failing_malloc.h"
#include "tests/render_support.h"
#include "tests/scene_support.h"

#include <math.h>

/* ---- light ---- */

/* Shares of sky and sun that come to points of a mesh. */
static void gather(const sg_mesh *m, const sg_lights *lights, const double (*at)[3], const double (*normal)[3], size_t n,
                   size_t nsky, size_t nsun, sg_light_point *out)
{
    sg_error err = SG_ERROR_INIT;
    const sg_ball ball = sg_ball_of(m);
    sg_light_maps maps;
    ck_ok(sg_light_maps_create(lights, &maps, &err));
    for (size_t i = 0; i < n; i++) {
        out[i] = (sg_light_point){0};
        sg_ball_coordinates(&ball, at[i], out[i].at);
        for (int k = 0; k < 3; k++) {
            out[i].normal[k] = (float)normal[i][k];
            out[i].at[k] += (float)(sg_shadow_map_lift(lights->sun_side) * normal[i][k]);
        }
    }
    ck_ok(sg_light_gather(lights, m, &ball, &maps, 0, nsky, 0, nsun, out, n, &err));
    sg_light_maps_clear(&maps);
}

static void add_floor(test_mesh *m, double half)
{
    const double floor_[4][3] = {{-half, 0, half}, {half, 0, half}, {half, 0, -half}, {-half, 0, -half}};
    test_mesh_add(m, floor_, 4);
}

/* Nothing hides the sky from a plane that leans any way, seen from either side. */
START_TEST(a_plane_sees_all_of_the_sky)
{
    sg_lights lights = SG_LIGHTS_INIT;
    const double a = 0.7 * _i, b = 0.4 * _i;
    const double x[3] = {cos(a), sin(a) * sin(b), -sin(a) * cos(b)}, z[3] = {sin(a), -cos(a) * sin(b), cos(a) * cos(b)};
    double corner[4][3], at[9][3], normal[9][3], y[3];
    sg_vec_cross(z, x, y);
    for (int k = 0; k < 4; k++)
        for (int i = 0; i < 3; i++)
            corner[k][i] = 5 + (k == 1 || k == 2 ? 1 : -1) * x[i] + (k >= 2 ? 1 : -1) * y[i];
    for (int k = 0; k < 9; k++)
        for (int i = 0; i < 3; i++) {
            at[k][i] = 5 + 0.45 * (k % 3 - 1) * x[i] + 0.45 * (k / 3 - 1) * y[i];
            normal[k][i] = (k % 2 == 0 ? 1 : -1) * z[i];
        }
    test_mesh *m = test_mesh_create(0xffffff);
    test_mesh_add(m, (const double(*)[3])corner, 4);
    sg_light_point p[9];
    memcpy(lights.sun, z, sizeof z);
    gather(&m->mesh, &lights, (const double(*)[3])at, (const double(*)[3])normal, 9, 200, 4, p);
    for (int k = 0; k < 9; k++) {
        ck_assert(p[k].whole > 0);
        ck_assert(p[k].open == p[k].whole);
        ck_assert(k % 2 == 1 || p[k].sun_open == p[k].sun_whole);
        ck_assert(k % 2 == 0 || p[k].sun_open == 0); /* on the other side the plane itself is in the way */
    }
    free(m);
}
END_TEST

/* Points that look down on what lies below, as in a mirror: for light from there comes less often, and as much. */
static void turn_over(test_mesh *m, double (*at)[3], double (*normal)[3], size_t n)
{
    for (size_t i = 0; i < m->mesh.nvertices; i++)
        m->vertices[i][1] *= -1;
    for (size_t i = 0; i < n; i++) {
        at[i][1] *= -1;
        normal[i][1] *= -1;
    }
}

/* A wall of height h beside a floor, long as it is, hides (1 - d / sqrt(d^2 + h^2)) / 2 of the light of an even sky from a
 * point at the distance d (Siegel and Howell, Thermal Radiation Heat Transfer, configuration factors: an element and a
 * plane at a right angle to it). */
START_TEST(a_wall_hides_its_share_of_the_sky)
{
    sg_lights lights = SG_LIGHTS_INIT;
    const double wall[4][3] = {{0, 0, 8}, {0, 0, -8}, {0, 1, -8}, {0, 1, 8}};
    double at[4][3] = {{0.1, 0, 0}, {0.5, 0, 0}, {1, 0, 1}, {4, 0, -1}}, normal[4][3];
    for (int k = 0; k < 4; k++)
        memcpy(normal[k], (const double[]){0, 1, 0}, sizeof normal[k]);
    test_mesh *m = test_mesh_create(0xffffff);
    add_floor(m, 5);
    test_mesh_add(m, wall, 4);
    if (_i == 1)
        turn_over(m, at, normal, 4);
    const double lift = sg_shadow_map_lift(lights.sky_side) * sg_ball_of(&m->mesh).radius; /* points stand that high */
    sg_light_point p[4];
    gather(&m->mesh, &lights, (const double(*)[3])at, (const double(*)[3])normal, 4, 500, 0, p);
    for (int k = 0; k < 4; k++) {
        const double d = at[k][0], h = 1 - lift, hidden = (1 - d / hypot(d, h)) / 2;
        ck_assert_double_eq_tol((double)(p[k].open / p[k].whole), 1 - hidden, 0.02);
        ck_assert(k == 0 || p[k].open > p[k - 1].open);
    }
    free(m);
}
END_TEST

/* A face that stands upright on a wide floor loses the light from below, which is what the ground sends back. */
START_TEST(a_floor_hides_the_light_of_the_ground)
{
    sg_lights lights = SG_LIGHTS_INIT;
    const double at[1][3] = {{-49, 1, 0}}, normal[1][3] = {{1, 0, 0}}, luma[3] = {0.2126, 0.7152, 0.0722};
    test_mesh *m = test_mesh_create(0xffffff);
    add_floor(m, 50);
    sg_light_point p;
    gather(&m->mesh, &lights, at, normal, 1, 2000, 0, &p);
    const double sky = sg_vec_dot(luma, lights.sky), ground = sg_vec_dot(luma, lights.ground);
    ck_assert_double_eq_tol((double)(p.open / p.whole), sky / (sky + ground), 0.02);
    free(m);
}
END_TEST

/* The sum of the light without shadows is that of the hemispheres. */
START_TEST(open_light_is_that_of_the_hemispheres)
{
    sg_lights lights = SG_LIGHTS_INIT;
    memcpy(lights.sun, (const double[]){0.6, 0.8, 0}, sizeof lights.sun);
    const sg_light_point up = {.normal = {0, 1, 0}}, down = {.normal = {0, -1, 0}},
                         shaded = {.normal = {0, 1, 0}, .open = 1, .whole = 4, .sun_open = 0, .sun_whole = 3};
    double rgb[3];
    for (int i = 0; i < 3; i++) {
        sg_light_sum(&lights, &up, rgb);
        ck_assert_double_eq_tol(rgb[i], lights.sky[i] + 0.8 * lights.sun_light[i], 1e-6);
        sg_light_sum(&lights, &down, rgb);
        ck_assert_double_eq_tol(rgb[i], lights.ground[i], 1e-6);
        sg_light_sum(&lights, &shaded, rgb);
        ck_assert_double_eq_tol(rgb[i], lights.sky[i] / 4, 1e-6);
    }
}
END_TEST

START_TEST(colours_survive_linear_light)
{
    for (uint32_t v = 0; v < 256; v++) {
        double rgb[3];
        sg_srgb_to_linear(v << 16 | (255 - v) << 8 | v / 2, rgb);
        ck_assert_uint_eq(sg_srgb_of_linear(rgb[0]), v);
        ck_assert_uint_eq(sg_srgb_of_linear(rgb[1]), 255 - v);
        ck_assert_uint_eq(sg_srgb_of_linear(rgb[2]), v / 2);
    }
    ck_assert_uint_eq(sg_srgb_of_linear(0.21586), 128); /* half as bright as it looks, and a little */
    ck_assert_uint_eq(sg_srgb_of_linear(7), 255);
    ck_assert_uint_eq(sg_srgb_of_linear(-1), 0);
}
END_TEST

/* ---- pictures ---- */

static double linear_at(const sg_image *im, size_t x, size_t y)
{
    double rgb[3];
    sg_srgb_to_linear((uint32_t)im->rgb[3 * (y * im->width + x)] << 16, rgb);
    return rgb[0];
}

/* Share of a unit square at (x, y) that lies where a x + b y < c, by clipping it. */
static double share_below(double x, double y, double a, double b, double c)
{
    const double corner[4][2] = {{x, y}, {x + 1, y}, {x + 1, y + 1}, {x, y + 1}};
    double kept[8][2], area = 0;
    int n = 0;
    for (int i = 0; i < 4; i++) {
        const double *p = corner[i], *q = corner[(i + 1) % 4];
        const double dp = c - a * p[0] - b * p[1], dq = c - a * q[0] - b * q[1];
        if (dp >= 0)
            memcpy(kept[n++], p, sizeof kept[0]);
        if ((dp >= 0) != (dq >= 0)) {
            kept[n][0] = p[0] + dp / (dp - dq) * (q[0] - p[0]);
            kept[n++][1] = p[1] + dp / (dp - dq) * (q[1] - p[1]);
        }
    }
    for (int i = 0; i < n; i++)
        area += (kept[i][0] * kept[(i + 1) % n][1] - kept[i][1] * kept[(i + 1) % n][0]) / 2;
    return area;
}

/* A black half plane before white: pixels on its edge are as bright as the share that it leaves free. */
START_TEST(edges_are_as_dark_as_they_cover)
{
    sg_error err = SG_ERROR_INIT;
    sg_render_opts opts = {64, 0, 0, 0, 45, 0xffffff, false, 1, NULL};
    const double t = 0.1 + 0.37 * _i, a = cos(t), b = sin(t);
    const sg_camera c = {.frame = SG_FRAME_INIT, .half = {10, 10}, .scale = 1, .projection = SG_PROJECTION_ORTHOGRAPHIC};
    /* In the picture a (x - 10) + b (y - 10) < 0.3, with y down; 1 px is a unit. */
    double corner[4][3];
    for (int k = 0; k < 4; k++) {
        const double along = k == 1 || k == 2 ? 50 : -50, across = k >= 2 ? -50 : 0.3;
        corner[k][0] = across * a - along * b;
        corner[k][1] = -(across * b + along * a);
        corner[k][2] = -1;
    }
    test_mesh *m = test_mesh_create(0);
    test_mesh_add(m, (const double(*)[3])corner, 4);
    sg_image im;
    ck_ok(sg_image_create(20, 20, &im, &err));
    ck_ok(sg_render_mesh(&m->mesh, NULL, &c, &opts, &im, &err));
    double sum = 0;
    size_t nedge = 0;
    for (size_t i = 0; i < 400; i++) {
        const double want = 1 - share_below((double)(i % 20), (double)(i / 20), a, b, 10 * a + 10 * b + 0.3);
        const double got = linear_at(&im, i % 20, i / 20);
        ck_assert_double_eq_tol(got, want, 0.06);
        nedge += want > 0.05 && want < 0.95;
        sum += got - want;
    }
    ck_assert_uint_gt(nedge, 15);
    ck_assert_double_eq_tol(sum / 400, 0, 0.002);
    sg_image_clear(&im);
    free(m);
}
END_TEST

static sg_status draw(const sg_scene *scene, const sg_view *view, const sg_render_opts *opts, sg_image *im, sg_error *err)
{
    const sg_mesh_opts mesh_opts = SG_MESH_OPTS_INIT;
    sg_mesh mesh = {0};
    const sg_status st = sg_render_scene(scene, &mesh_opts, view, opts, &mesh, im, err);
    sg_mesh_clear(&mesh);
    return st;
}

static sg_image picture(const char *text, size_t width, size_t height, const sg_view *view, const sg_render_opts *opts)
{
    sg_error err = SG_ERROR_INIT;
    test_scene f = test_scene_of(text);
    sg_image im;
    ck_ok(sg_image_create(width, height, &im, &err));
    ck_ok(draw(&f.scene, view, opts, &im, &err));
    test_close_scene(&f);
    return im;
}

static int brightness(const sg_image *im, size_t x, size_t y)
{
    const uint8_t *p = im->rgb + 3 * (y * im->width + x);
    return p[0] + p[1] + p[2];
}

/* A twig a hundredth of a pixel wide is seen in every row, and hardly wider than a pixel. */
START_TEST(thin_twigs_do_not_vanish)
{
    char text[300];
    sg_view view = SG_VIEW_INIT;
    sg_render_opts opts = SG_RENDER_OPTS_INIT;
    opts.sky = opts.sun = 0;
    opts.ground = false;
    view.azimuth = view.elevation = 0;
    view.projection = _i % 2 == 0 ? SG_PROJECTION_PERSPECTIVE : SG_PROJECTION_ORTHOGRAPHIC;
    snprintf(text, sizeof text, "start S\nrule S -> set_material(#000000) width(0.001) turn(%d) draw(5) draw(5)\n", 7 * _i);
    sg_image im = picture(text, 100, 100, &view, &opts);
    const int white = brightness(&im, 0, 50);
    for (size_t y = 12; y < 88; y++) {
        double dark = 0;
        for (size_t x = 0; x < 100; x++)
            dark += 1 - linear_at(&im, x, y) / linear_at(&im, 0, 0);
        ck_assert_msg(dark > 0.4 && dark < 1.5, "row %zu: %g pixels", y, dark);
    }
    ck_assert_int_eq(white, brightness(&im, 99, 99));
    sg_image_clear(&im);
}
END_TEST

/* The corners of a picture are its background; the ground is dark under a box and away from the sun, nowhere else. */
START_TEST(boxes_throw_shadows)
{
    sg_view view = SG_VIEW_INIT;
    sg_render_opts opts = SG_RENDER_OPTS_INIT;
    view.azimuth = 0;
    view.elevation = 30;
    view.margin = 0.6;
    opts.sun_azimuth = 90; /* from the left */
    const char *box = "start S\nrule S -> translate(-1, 0, -1) size(2, 2, 2) set_material(#ffffff) insert(box)\n";
    sg_image im = picture(box, 100, 100, &view, &opts);
    const int white = brightness(&im, 0, 0), left = brightness(&im, 15, 62), right = brightness(&im, 75, 62);
    ck_assert_int_eq(white, 0xf4 + 0xf4 + 0xf2);
    ck_assert_int_eq(brightness(&im, 99, 0), white);
    ck_assert_int_gt(left, white - 30);
    ck_assert_int_lt(right, white - 150);
    sg_image_clear(&im);
    opts.ground = false;
    im = picture(box, 100, 100, &view, &opts);
    ck_assert_int_eq(brightness(&im, 75, 62), white);
    sg_image_clear(&im);
}
END_TEST

/* From the left and from the right of its front, a box has that in the sun, and its side in the shade. */
START_TEST(fronts_are_lit)
{
    sg_view view = SG_VIEW_INIT;
    sg_render_opts opts = SG_RENDER_OPTS_INIT;
    opts.sky = 8;
    opts.samples = 4;
    for (int side = -1; side <= 1; side += 2) {
        view.azimuth = 40 * side;
        sg_image im = picture("start S\nrule S -> translate(-1, 0, -1) size(2, 2, 2) insert(box)\n", 100, 100, &view, &opts);
        const size_t front = side > 0 ? 40 : 60, shade = side > 0 ? 80 : 20;
        ck_assert_int_gt(brightness(&im, front, 60), brightness(&im, shade, 60) + 100);
        sg_image_clear(&im);
    }
}
END_TEST

/* A sheet is the same from both sides, when the sun stands on the side of the camera. */
START_TEST(sheets_have_two_sides)
{
    sg_view view = SG_VIEW_INIT;
    sg_render_opts opts = SG_RENDER_OPTS_INIT;
    opts.ground = false;
    int seen[2];
    for (int side = 0; side < 2; side++) {
        view.azimuth = 180 * side;
        opts.sun_azimuth = 20;
        sg_image im = picture("start S\nrule S -> translate(-1, 0, 0) size(2, 2, 0) set_material(#808080) insert(box)\n", 60, 60,
                              &view, &opts);
        seen[side] = brightness(&im, 30, 30);
        sg_image_clear(&im);
    }
    ck_assert_int_gt(seen[0], 300); /* it is in the sun */
    ck_assert_int_le(abs(seen[0] - seen[1]), 6);
}
END_TEST

static const char plant[] =
    "limit depth 5\nstart T(1)\nrule T(l) -> width(l / 8) draw(l) [ turn(40) set_material(#808020) T(l * 0.7) ] roll(90) "
    "pitch(20) T(l * 0.8)\nrule T(l) at limit -> size(0.1, 0.1, 0) set_material(#208020) insert(box)\n";

/* A picture is the same whatever the number of threads that draw it; also of so many samples that the order matters in which
 * they are added up. */
START_TEST(pictures_do_not_depend_on_threads)
{
    static const struct {
        size_t samples, sky, sun;
    } cases[] = {{1, 3, 2}, {3, 3, 2}, {7, 1, 1}, {128, 1, 0}};
    const sg_view view = SG_VIEW_INIT;
    sg_render_opts opts = SG_RENDER_OPTS_INIT;
    opts.samples = cases[_i].samples;
    opts.sky = cases[_i].sky;
    opts.sun = cases[_i].sun;
    sg_image one = picture(plant, 71, 93, &view, &opts);
    for (opts.threads = 2; opts.threads <= 5; opts.threads += 3) {
        sg_image many = picture(plant, 71, 93, &view, &opts);
        ck_assert_msg(memcmp(one.rgb, many.rgb, 3 * 71 * 93) == 0, "%d threads", opts.threads);
        sg_image_clear(&many);
    }
    sg_image_clear(&one);
}
END_TEST

/* Pictures drawn beside each other in threads are those that are drawn alone. */
START_TEST(threads_draw_the_same_bytes)
{
    enum { N = 4 };
    sg_image im[N + 1];
    bool good[N] = {false};
    const sg_view view = SG_VIEW_INIT;
    sg_render_opts opts = SG_RENDER_OPTS_INIT;
    sg_error err = SG_ERROR_INIT;
    test_scene f = test_scene_of(plant);
    opts.samples = opts.sky = 3;
    for (int i = 0; i <= N; i++)
        ck_ok(sg_image_create(40, 50, im + i, &err));
    ck_ok(draw(&f.scene, &view, &opts, im + N, &err));
#pragma omp parallel for num_threads(2)
    for (int i = 0; i < N; i++)
        good[i] = draw(&f.scene, &view, &opts, im + i, NULL) == SG_OK;
    for (int i = 0; i < N; i++)
        ck_assert(good[i] && memcmp(im[i].rgb, im[N].rgb, 3 * 40 * 50) == 0);
    for (int i = 0; i <= N; i++)
        sg_image_clear(im + i);
    test_close_scene(&f);
}
END_TEST

START_TEST(empty_scenes_and_odd_sizes_have_pictures)
{
    static const char *const texts[] = {
        "start S\nrule S -> nothing\n", "start S\nrule S -> width(0) draw(1)\n",
        "label t\nstart S\nrule S -> size(1, 1, 0) t\n",
        "start S\nrule S -> translate(1e90, 1e90, 0) size(1e90, 2e90, 3e90) insert(box)\n",
        "start S\nrule S -> size(1e-9, 1, 1e9) insert(box)\n"};
    static const size_t sizes[][2] = {{1, 1}, {1, 70}, {70, 1}, {13, 7}};
    for (size_t k = 0; k < sizeof texts / sizeof *texts; k++)
        for (size_t s = 0; s < 4; s++)
            for (int projection = 0; projection < 2; projection++) {
                sg_view view = SG_VIEW_INIT;
                sg_render_opts opts = SG_RENDER_OPTS_INIT;
                view.projection = (sg_projection)projection;
                view.elevation = s == 0 ? 90 : s == 1 ? -90 : 20;
                opts.samples = opts.sun = 1;
                opts.sky = 2;
                sg_image im = picture(texts[k], sizes[s][0], sizes[s][1], &view, &opts);
                for (size_t i = 0; k < 2 && i < im.width * im.height; i++)
                    ck_assert_int_eq(brightness(&im, i % im.width, i / im.width), 0xf4 + 0xf4 + 0xf2);
                sg_image_clear(&im);
            }
}
END_TEST

START_TEST(options_out_of_range_are_refused)
{
    const sg_render_opts good = {256, 0, 0, 0, 0, 0, true, 1, NULL},
                         bad[] = {{0, 1, 1, 0, 0, 0, true, 1, NULL}, {257, 1, 1, 0, 0, 0, true, 1, NULL},
                                  {1, 1025, 1, 0, 0, 0, true, 1, NULL}, {1, 1, 1025, 0, 0, 0, true, 1, NULL}};
    const sg_view view = SG_VIEW_INIT;
    sg_error err = SG_ERROR_INIT;
    test_scene f = test_scene_of(plant);
    sg_image im;
    ck_ok(sg_image_create(4, 4, &im, &err));
    for (int i = 0; i < 4; i++)
        ck_assert_int_eq(draw(&f.scene, &view, bad + i, &im, &err), SG_EINVAL);
    ck_ok(draw(&f.scene, &view, &good, &im, &err));
    sg_image_clear(&im);
    test_close_scene(&f);
}
END_TEST

static bool stop_at_once(sg_progress *self)
{
    ++*(size_t *)self->user;
    return true;
}

START_TEST(drawing_can_be_stopped)
{
    size_t asked = 0;
    sg_progress progress = {.stop = stop_at_once, .user = &asked};
    const sg_view view = SG_VIEW_INIT;
    sg_render_opts opts = SG_RENDER_OPTS_INIT;
    sg_error err = SG_ERROR_INIT;
    test_scene f = test_scene_of(plant);
    sg_image im;
    opts.progress = &progress;
    ck_ok(sg_image_create(4, 4, &im, &err));
    ck_assert_int_eq(draw(&f.scene, &view, &opts, &im, &err), SG_STOPPED);
    ck_assert_uint_ge(asked, 1);
    sg_image_clear(&im);
    test_close_scene(&f);
}
END_TEST

START_TEST(every_allocation_may_fail)
{
    const sg_view view = SG_VIEW_INIT;
    sg_render_opts opts = SG_RENDER_OPTS_INIT;
    sg_error err = SG_ERROR_INIT;
    test_scene f = test_scene_of(plant);
    sg_image im;
    ck_ok(sg_image_create(200, 200, &im, &err)); /* the twigs are thin */
    opts.samples = opts.sky = opts.sun = 1;
    size_t failures = 0;
    for (bool failed = true; failed; failures += failed) {
        test_fail_allocation(failures);
        const sg_status st = draw(&f.scene, &view, &opts, &im, &err);
        failed = test_allocation_failed();
        ck_assert_int_eq(st, failed ? SG_ENOMEM : SG_OK);
    }
    ck_assert_uint_gt(failures, 10);
    sg_image_clear(&im);
    test_close_scene(&f);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("render");
    TCase *light = tcase_create("light"), *pictures = tcase_create("pictures");
    tcase_add_loop_test(light, a_plane_sees_all_of_the_sky, 0, 8);
    tcase_add_loop_test(light, a_wall_hides_its_share_of_the_sky, 0, 2);
    tcase_add_test(light, a_floor_hides_the_light_of_the_ground);
    tcase_add_test(light, open_light_is_that_of_the_hemispheres);
    tcase_add_test(light, colours_survive_linear_light);
    tcase_add_loop_test(pictures, edges_are_as_dark_as_they_cover, 0, 17);
    tcase_add_loop_test(pictures, thin_twigs_do_not_vanish, 0, 6);
    tcase_add_test(pictures, boxes_throw_shadows);
    tcase_add_test(pictures, fronts_are_lit);
    tcase_add_test(pictures, sheets_have_two_sides);
    tcase_add_loop_test(pictures, pictures_do_not_depend_on_threads, 0, 4);
    tcase_add_test(pictures, threads_draw_the_same_bytes);
    tcase_add_test(pictures, empty_scenes_and_odd_sizes_have_pictures);
    tcase_add_test(pictures, options_out_of_range_are_refused);
    tcase_add_test(pictures, drawing_can_be_stopped);
    tcase_add_test(pictures, every_allocation_may_fail);
    suite_add_tcase(suite, light);
    suite_add_tcase(suite, pictures);
    return test_run(suite);
}
