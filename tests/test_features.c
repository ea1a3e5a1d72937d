/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_features.c - features of photographs against direct readings of the photograph. */
#include "config.h"

#include "parse/features.h"
#include "parse/features_priv.h"
#include "tests/failing_malloc.h"
#include "tests/support.h"

#include "core/random.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

static const size_t sizes[][2] = {{1, 1}, {1, 9}, {23, 1}, {17, 31}, {40, 12}};
enum { NSIZES = sizeof sizes / sizeof sizes[0] };

static sg_image random_photo(size_t width, size_t height, uint64_t seed)
{
    sg_error err = SG_ERROR_INIT;
    sg_image im;
    gsl_rng *rng = sg_random_create(seed);
    ck_assert_ptr_nonnull(rng);
    ck_ok(sg_image_create(width, height, &im, &err));
    for (size_t i = 0; i < 3 * width * height; i++)
        im.rgb[i] = (uint8_t)gsl_rng_uniform_int(rng, 256);
    gsl_rng_free(rng);
    return im;
}

static size_t clamped(ptrdiff_t at, size_t n)
{
    return at < 0 ? 0 : at >= (ptrdiff_t)n ? n - 1 : (size_t)at;
}

/* ---- sets ---- */

START_TEST(sets_are_counted)
{
    for (uint32_t side = 0; side < 70; side++) {
        const sg_feature_set set = sg_feature_set_of(SG_FEATURES_PATCH, side);
        ck_assert_uint_eq(sg_feature_set_count(&set), side % 2 == 1 && side <= 63 ? 3 * side * side : 0);
    }
    const sg_feature_set rich = sg_feature_set_of(SG_FEATURES_RICH, 0);
    ck_assert_uint_gt(sg_feature_set_count(&rich), 0);
}
END_TEST

START_TEST(unknown_sets_are_refused)
{
    sg_feature_set bad[] = {sg_feature_set_of(SG_FEATURES_PATCH, 13), sg_feature_set_of(SG_FEATURES_RICH, 0),
                            sg_feature_set_of(SG_FEATURES_PATCH, 12), {(sg_feature_kind)7, 13, 1}};
    bad[0].version++;
    bad[1].version--;
    sg_image im = random_photo(5, 5, 1);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        sg_error err = SG_ERROR_INIT;
        sg_features f = {0};
        ck_assert_uint_eq(sg_feature_set_count(&bad[i]), 0);
        ck_assert_int_eq(sg_features_create(&bad[i], &im, &f, &err), SG_EINVAL);
        ck_assert_ptr_nonnull(strstr(err.msg, "version"));
        ck_assert_ptr_null(f.data);
    }
    sg_image_clear(&im);
}
END_TEST

/* Every feature has a name of its own, and one that is too long for its place is cut. */
START_TEST(features_have_names)
{
    const sg_feature_set set =
        _i == 0 ? sg_feature_set_of(SG_FEATURES_PATCH, 5) : sg_feature_set_of(SG_FEATURES_RICH, 0);
    const size_t n = sg_feature_set_count(&set);
    char(*names)[80] = malloc(n * sizeof *names), small[4];
    ck_assert_ptr_nonnull(names);
    for (size_t f = 0; f < n; f++) {
        sg_feature_set_describe(&set, f, names[f], sizeof names[f]);
        ck_assert_uint_gt(strlen(names[f]), 0);
        for (size_t g = 0; g < f; g++)
            ck_assert_msg(strcmp(names[f], names[g]) != 0, "features %zu and %zu are both %s", g, f, names[f]);
        sg_feature_set_describe(&set, f, small, sizeof small);
        ck_assert_int_eq(strncmp(small, names[f], 3), 0);
    }
    sg_feature_set_describe(&set, n, names[0], sizeof names[0]);
    ck_assert_str_eq(names[0], "no such feature");
    free(names);
}
END_TEST

/* ---- patch ---- */

START_TEST(patch_reads_the_photograph)
{
    sg_error err = SG_ERROR_INIT;
    const uint32_t side = (uint32_t[]){1, 3, 13}[_i % 3];
    const int half = (int)side / 2;
    sg_image im = random_photo(sizes[_i / 3][0], sizes[_i / 3][1], (uint64_t)_i);
    const sg_feature_set set = sg_feature_set_of(SG_FEATURES_PATCH, side);
    sg_features f;
    ck_ok(sg_features_create(&set, &im, &f, &err));
    ck_assert_uint_eq(f.nfeatures, 3 * side * side);
    ck_assert(f.width == im.width && f.height == im.height);
    for (size_t y = 0; y < im.height; y++)
        for (size_t x = 0; x < im.width; x++)
            for (size_t k = 0, c = 0; c < 3; c++)
                for (int dy = -half; dy <= half; dy++)
                    for (int dx = -half; dx <= half; dx++, k++) {
                        const size_t row = clamped((ptrdiff_t)y + dy, im.height);
                        const size_t column = clamped((ptrdiff_t)x + dx, im.width);
                        ck_assert_float_eq(sg_features_value(&f, k, x, y), im.rgb[3 * (row * im.width + column) + c]);
                    }
    sg_features_clear(&f);
    sg_features_clear(&f);
    sg_image_clear(&im);
}
END_TEST

/* The photograph is not read when it is refused, so it needs no pixels here. */
START_TEST(huge_photographs_are_refused)
{
    sg_error err = SG_ERROR_INIT;
    const sg_image huge = {16384, 16384, NULL};
    const sg_feature_set set = sg_feature_set_of(SG_FEATURES_RICH, 0);
    sg_features f = {0};
    ck_assert_int_eq(sg_features_create(&set, &huge, &f, &err), SG_EINPUT);
    ck_assert_ptr_nonnull(strstr(err.msg, "16384 x 16384"));
    ck_assert_ptr_nonnull(strstr(err.msg, "would fit"));
    const sg_image none = {0, 4, NULL};
    ck_assert_int_eq(sg_features_create(&set, &none, &f, &err), SG_EINVAL);
    ck_assert_ptr_null(f.data);
}
END_TEST

/* ---- memory ---- */

START_TEST(every_allocation_can_fail)
{
    sg_image im = random_photo(12, 9, 5);
    const sg_feature_set set =
        _i == 0 ? sg_feature_set_of(SG_FEATURES_PATCH, 5) : sg_feature_set_of(SG_FEATURES_RICH, 0);
    bool failed = true;
    for (size_t k = 0; failed; k++) {
        sg_error err = SG_ERROR_INIT;
        sg_features f = {0};
        test_fail_allocation(k);
        const sg_status st = sg_features_create(&set, &im, &f, &err);
        failed = test_allocation_failed();
        ck_assert_int_eq(st, failed ? SG_ENOMEM : SG_OK);
        ck_assert((f.data != NULL) == (st == SG_OK));
        sg_features_clear(&f);
        ck_assert_uint_lt(k, 1000);
    }
    sg_image_clear(&im);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("features");
    TCase *sets = tcase_create("sets");
    tcase_add_test(sets, sets_are_counted);
    tcase_add_test(sets, unknown_sets_are_refused);
    tcase_add_loop_test(sets, features_have_names, 0, 2);
    if (sg_features_rich.planes(NULL) > 7)
        tcase_add_test(sets, huge_photographs_are_refused);
    suite_add_tcase(suite, sets);
    TCase *patch = tcase_create("patch");
    tcase_add_loop_test(patch, patch_reads_the_photograph, 0, 3 * NSIZES);
    suite_add_tcase(suite, patch);
    TCase *memory = tcase_create("memory");
    tcase_add_loop_test(memory, every_allocation_can_fail, 0, 2);
    suite_add_tcase(suite, memory);
    return test_run(suite);
}
