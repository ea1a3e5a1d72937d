/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_overlay.c - label maps, outlines and heat over photographs. */
#include "core/random.h"
#include "scene/overlay.h"
#include "tests/failing_malloc.h"
#include "tests/support.h"

#include <math.h>
#include <string.h>

enum { W = 23, H = 17 };

typedef struct {
    sg_image photo, out;
    sg_label_map map;
    gsl_rng *rng;
} fixture;

static fixture open_fixture(uint64_t seed)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = {.rng = sg_random_create(seed)};
    ck_ok(sg_image_create(W, H, &f.photo, &err));
    ck_ok(sg_label_map_create(W, H, &f.map, &err));
    for (size_t i = 0; i < 3 * W * H; i++)
        f.photo.rgb[i] = (uint8_t)gsl_rng_uniform_int(f.rng, 256);
    for (size_t i = 0; i < W * H; i++) /* regions of several pixels */
        f.map.labels[i] = (uint8_t)(i % W > 0 && gsl_rng_uniform(f.rng) < 0.8 ? f.map.labels[i - 1]
                                                                              : gsl_rng_uniform_int(f.rng, 4));
    return f;
}

static void close_fixture(fixture *f)
{
    sg_image_clear(&f->photo);
    sg_image_clear(&f->out);
    sg_label_map_clear(&f->map);
    gsl_rng_free(f->rng);
}

static const uint8_t *pixel(const sg_image *im, size_t x, size_t y)
{
    return im->rgb + 3 * (y * im->width + x);
}

/* Inside of a region a colour lies halfway between photograph and label; a border parts every two regions; a label without a
 * colour shows the photograph. */
START_TEST(labels_lie_over_the_photograph)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture((uint64_t)_i + 1);
    const uint32_t colors[3] = {0xff8000, 0x0040ff, 0x123456};
    ck_ok(sg_overlay_labels(&f.photo, &f.map, colors, 3, &f.out, &err));
    ck_assert(f.out.width == W && f.out.height == H);
    for (size_t y = 0; y < H; y++)
        for (size_t x = 0; x < W; x++) {
            const uint8_t *l = f.map.labels + y * W + x, *p = pixel(&f.out, x, y);
            const bool border = (x + 1 < W && l[1] != l[0]) || (y + 1 < H && l[W] != l[0]);
            for (size_t c = 0; c < 3; c++) {
                const double seen = pixel(&f.photo, x, y)[c];
                const double want = border ? 0 : *l < 3 ? 0.5 * seen + 0.5 * (colors[*l] >> (16 - 8 * c) & 255) : seen;
                ck_assert_double_le(fabs(p[c] - want), 0.5);
            }
        }
    close_fixture(&f);
}
END_TEST

START_TEST(sizes_must_agree)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(1);
    f.map.width--;
    ck_assert_int_eq(sg_overlay_labels(&f.photo, &f.map, NULL, 0, &f.out, &err), SG_EINVAL);
    ck_assert_ptr_nonnull(strstr(err.msg, "22x17"));
    ck_assert_ptr_null(f.out.rgb);
    close_fixture(&f);
}
END_TEST

/* Two rectangles of one label side by side, one below them: a line where they meet, none along the frame. */
START_TEST(outlines_part_rectangles_of_one_label)
{
    sg_error err = SG_ERROR_INIT;
    sg_image im;
    sg_label_rect rects[] = {{0, 0, 40, 50, 1, 0}, {40, 0, 100, 50, 1, 0}, {0, 50, 100, 100, 1, 0}, {3, 50, 3, 60, 1, 0}};
    const sg_label_scene scene = {.width = 100, .height = 100, .rects = rects, .nrects = 4};
    ck_ok(sg_image_create(10, 20, &im, &err));
    sg_overlay_outlines(&scene, 0xffffff, &im);
    for (size_t y = 0; y < 20; y++)
        for (size_t x = 0; x < 10; x++)
            ck_assert_msg(pixel(&im, x, y)[0] == (y == 9 || (x == 3 && y < 9) ? 255 : 0), "pixel (%zu, %zu)", x, y);
    sg_image_clear(&im);
}
END_TEST

static double luma(uint32_t c)
{
    return 0.299 * (c >> 16) + 0.587 * (c >> 8 & 255) + 0.114 * (c & 255);
}

START_TEST(the_ramp_grows_brighter)
{
    ck_assert_uint_eq(sg_overlay_ramp(0), 0);
    ck_assert_uint_eq(sg_overlay_ramp(1), 0xffffff);
    ck_assert_uint_eq(sg_overlay_ramp(-3), 0);
    ck_assert_uint_eq(sg_overlay_ramp(7), 0xffffff);
    ck_assert_uint_eq(sg_overlay_ramp(NAN), 0);
    for (int k = 1; k <= 100; k++) {
        const double step = luma(sg_overlay_ramp(k / 100.0)) - luma(sg_overlay_ramp((k - 1) / 100.0));
        ck_assert_msg(step > 0.5 && step < 5, "step %g at %d", step, k); /* the mean is 2.55 */
    }
}
END_TEST

/* A quarter of the grey photograph, three quarters of the ramp. */
START_TEST(heat_lies_over_the_grey_photograph)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture((uint64_t)_i + 1);
    float value[W * H];
    for (size_t i = 0; i < W * H; i++)
        value[i] = (float)(1.4 * gsl_rng_uniform(f.rng) - 0.2);
    value[5] = NAN;
    value[6] = INFINITY;
    ck_ok(sg_overlay_heat(&f.photo, value, &f.out, &err));
    for (size_t i = 0; i < W * H; i++) {
        const uint8_t *seen = f.photo.rgb + 3 * i, *p = f.out.rgb + 3 * i;
        const double v = value[i] > 0 ? round(255 * fmin(value[i], 1)) / 255 : 0;
        const uint32_t ramp = sg_overlay_ramp(v);
        const double grey = 0.299 * seen[0] + 0.587 * seen[1] + 0.114 * seen[2];
        for (size_t c = 0; c < 3; c++)
            ck_assert_double_eq_tol(p[c], 0.25 * grey + 0.75 * (ramp >> (16 - 8 * c) & 255), 0.7);
    }
    close_fixture(&f);
}
END_TEST

START_TEST(failed_allocations_are_reported)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(1);
    const float value[W * H] = {0};
    test_fail_allocation(0);
    ck_assert_int_eq(sg_overlay_labels(&f.photo, &f.map, NULL, 0, &f.out, &err), SG_ENOMEM);
    ck_assert(test_allocation_failed());
    test_fail_allocation(0);
    ck_assert_int_eq(sg_overlay_heat(&f.photo, value, &f.out, &err), SG_ENOMEM);
    ck_assert(test_allocation_failed());
    ck_assert_ptr_null(f.out.rgb);
    close_fixture(&f);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("overlay");
    TCase *tc = tcase_create("overlay");
    tcase_add_loop_test(tc, labels_lie_over_the_photograph, 0, 4);
    tcase_add_test(tc, sizes_must_agree);
    tcase_add_test(tc, outlines_part_rectangles_of_one_label);
    tcase_add_test(tc, the_ramp_grows_brighter);
    tcase_add_loop_test(tc, heat_lies_over_the_grey_photograph, 0, 4);
    tcase_add_test(tc, failed_allocations_are_reported);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
