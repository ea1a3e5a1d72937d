/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_features.c - features of photographs against direct readings of the photograph. */
#include "config.h"

#include "parse/features_channels_priv.h"
#include "parse/features_priv.h"
#include "parse/features_sums_priv.h"
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
    sg_feature_set bad[] = {sg_feature_set_of(SG_FEATURES_PATCH, 13),
                            sg_feature_set_of(SG_FEATURES_RICH, 0),
                            sg_feature_set_of(SG_FEATURES_PATCH, 12),
                            {(sg_feature_kind)7, 13, 1}};
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

/* ---- rich: planes against sums over the photograph ---- */

static sg_features rich_features(const sg_image *im)
{
    sg_error err = SG_ERROR_INIT;
    const sg_feature_set set = sg_feature_set_of(SG_FEATURES_RICH, 0);
    sg_features f;
    ck_ok(sg_features_create(&set, im, &f, &err));
    return f;
}

/* The feature of this name. */
static size_t named(const char *name)
{
    const sg_feature_set set = sg_feature_set_of(SG_FEATURES_RICH, 0);
    char text[80];
    for (size_t f = 0; f < sg_feature_set_count(&set); f++) {
        sg_feature_set_describe(&set, f, text, sizeof text);
        if (strcmp(text, name) == 0)
            return f;
    }
    ck_abort_msg("no feature is named %s", name);
}

/* Mean, or standard deviation, of a plane over a rectangle of pixels, of which those outside repeat the nearest one. */
static double over(sg_plane p, ptrdiff_t left, ptrdiff_t top, ptrdiff_t right, ptrdiff_t bottom, bool sd)
{
    double sum = 0, squares = 0, n = 0;
    for (ptrdiff_t y = top; y <= bottom; y++)
        for (ptrdiff_t x = left; x <= right; x++, n++) {
            const double v = (double)p.at[clamped(y, p.height) * p.stride + clamped(x, p.width)];
            sum += v;
            squares += v * v;
        }
    return sd ? sqrt(fmax(0, squares / n - sum / n * sum / n)) : sum / n;
}

/* What a sum is, pixel by pixel. */
static double slow_sum(sg_sum sum, ptrdiff_t bw, ptrdiff_t bh, sg_plane p, ptrdiff_t x, ptrdiff_t y)
{
    const ptrdiff_t w = bw / 2, h = bh / 2, right = (ptrdiff_t)p.width - 1, bottom = (ptrdiff_t)p.height - 1;
    const ptrdiff_t top_row = y - h < 0 ? 0 : y - h, low_row = y + h > bottom ? bottom : y + h;
    const ptrdiff_t left_column = x - w < 0 ? 0 : x - w, right_column = x + w > right ? right : x + w;
    const double here = (double)p.at[(size_t)y * p.stride + (size_t)x];
    switch (sum) {
    case SG_SUM_NONE:
        return here;
    case SG_SUM_MEAN:
    case SG_SUM_SD:
        return over(p, x - w, y - h, x + w, y + h, sum == SG_SUM_SD);
    case SG_SUM_CONTRAST:
        return here - over(p, x - w, y - h, x + w, y + h, false);
    case SG_SUM_ROW:
    case SG_SUM_ROW_SD:
        return over(p, 0, top_row, right, low_row, sum == SG_SUM_ROW_SD);
    case SG_SUM_ROW_CONTRAST:
        return here - over(p, 0, top_row, right, low_row, false);
    case SG_SUM_COLUMN:
    case SG_SUM_COLUMN_SD:
        return over(p, left_column, 0, right_column, bottom, sum == SG_SUM_COLUMN_SD);
    case SG_SUM_COLUMN_CONTRAST:
        return here - over(p, left_column, 0, right_column, bottom, false);
    case SG_SUM_ABOVE:
        return over(p, x - w, 0, x + w, y, false);
    case SG_SUM_BELOW:
        return over(p, x - w, y, x + w, bottom, false);
    case SG_SUM_LEFT:
        return over(p, 0, y - h, x, y + h, false);
    case SG_SUM_RIGHT:
        return over(p, x, y - h, right, y + h, false);
    }
    ck_abort_msg("no sum has number %d", (int)sum);
}

static sg_plane new_plane(size_t width, size_t height)
{
    const size_t stride = width + 3;
    float *at = calloc(stride * height, sizeof *at);
    ck_assert_ptr_nonnull(at);
    return (sg_plane){at, width, height, stride};
}

/* What lies beside the photograph's rows is no part of it and must not matter. */
START_TEST(sums_are_those_of_the_photograph)
{
    static const size_t boxes[][2] = {{1, 1}, {3, 5}, {15, 15}, {61, 3}};
    enum { NSUMS = SG_SUM_RIGHT + 1 };
    const sg_sum sum = (sg_sum)(_i % NSUMS);
    const size_t *size = sizes[_i / NSUMS];
    sg_error err = SG_ERROR_INIT;
    gsl_rng *rng = sg_random_create((uint64_t)_i);
    ck_assert_ptr_nonnull(rng);
    sg_plane p[4];
    for (size_t i = 0; i < 4; i++)
        p[i] = new_plane(size[0], size[1]);
    for (size_t i = 0; i < p[0].stride * p[0].height; i++)
        p[0].at[i] = i % p[0].stride < p[0].width ? (float)gsl_rng_uniform(rng) : 1000;
    for (size_t b = 0; b < 4; b++) {
        ck_ok(sg_sum_up(sum, boxes[b][0], boxes[b][1], p[0], p + 1, p[3], &err));
        for (size_t y = 0; y < size[1]; y++)
            for (size_t x = 0; x < size[0]; x++)
                ck_assert_double_eq_tol(
                    (double)p[3].at[y * p[3].stride + x],
                    slow_sum(sum, (ptrdiff_t)boxes[b][0], (ptrdiff_t)boxes[b][1], p[0], (ptrdiff_t)x, (ptrdiff_t)y),
                    sum == SG_SUM_SD ? 5e-4 : 2e-6);
    }
    for (size_t i = 0; i < 4; i++)
        free(p[i].at);
    gsl_rng_free(rng);
}
END_TEST

/* A feature's name says what it reads. */
START_TEST(features_are_what_their_names_say)
{
    static const struct {
        const char *name, *of;
        sg_sum sum;
        int width, height, dx, dy;
    } cases[] = {
        {"L mean 15x15", "L", SG_SUM_MEAN, 15, 15, 0, 0},
        {"a mean 15x15 at -20,+0", "a", SG_SUM_MEAN, 15, 15, -20, 0},
        {"b mean 31x31 at +0,+80", "b", SG_SUM_MEAN, 31, 31, 0, 80},
        {"L sd 7x7", "L", SG_SUM_SD, 7, 7, 0, 0},
        {"gradient mean 15x15 at +15,+0", "gradient mean 15x15", SG_SUM_NONE, 0, 0, 15, 0},
        {"a row mean 15 at +0,-40", "a", SG_SUM_ROW, 0, 15, 0, -40},
        {"b row sd 5", "b", SG_SUM_ROW_SD, 0, 5, 0, 0},
        {"b blur 2 less column mean 15", "b blur 2", SG_SUM_COLUMN_CONTRAST, 15, 0, 0, 0},
        {"L blur 2 mean 41x3 at +0,+5", "L blur 2", SG_SUM_MEAN, 41, 3, 0, 5},
        {"L above 15", "L", SG_SUM_ABOVE, 15, 0, 0, 0},
        {"L right 15", "L", SG_SUM_RIGHT, 0, 15, 0, 0},
    };
    sg_image im = random_photo(sizes[_i][0], sizes[_i][1], (uint64_t)_i);
    sg_features f = rich_features(&im);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const size_t feature = named(cases[i].name);
        const sg_plane of = {f.data + f.offsets[named(cases[i].of)], f.width, f.height, f.stride};
        for (size_t y = 0; y < f.height; y++)
            for (size_t x = 0; x < f.width; x++) {
                const ptrdiff_t cx = (ptrdiff_t)clamped((ptrdiff_t)x + cases[i].dx, f.width);
                const ptrdiff_t cy = (ptrdiff_t)clamped((ptrdiff_t)y + cases[i].dy, f.height);
                ck_assert_double_eq_tol((double)sg_features_value(&f, feature, x, y),
                                        slow_sum(cases[i].sum, cases[i].width, cases[i].height, of, cx, cy),
                                        cases[i].sum == SG_SUM_SD ? 5e-2 : 2e-3); /* squares are up to 1e4 */
            }
    }
    sg_features_clear(&f);
    sg_image_clear(&im);
}
END_TEST

/* Every feature reads its plane, and outside the photograph the nearest pixel of it. */
START_TEST(far_look_ups_are_clamped)
{
    const sg_feature_set set = sg_feature_set_of(SG_FEATURES_RICH, 0);
    sg_image im = random_photo(sizes[_i][0], sizes[_i][1], 7);
    sg_features f = rich_features(&im);
    const size_t pad = sg_features_rich.pad(&set), plane = f.stride * (f.height + 2 * pad);
    for (size_t k = 0; k < f.nfeatures; k++) {
        const sg_feature_place at = sg_features_rich.place(&set, k);
        const float *start = f.data + at.plane * plane + pad * f.stride + pad;
        for (size_t y = 0; y < f.height; y++)
            for (size_t x = 0; x < f.width; x++) {
                const size_t row = clamped((ptrdiff_t)y + at.dy, f.height),
                             column = clamped((ptrdiff_t)x + at.dx, f.width);
                ck_assert_float_eq(sg_features_value(&f, k, x, y), start[row * f.stride + column]);
            }
    }
    sg_features_clear(&f);
    sg_image_clear(&im);
}
END_TEST

/* Gradients are shared among the orientations, and every pixel has one pattern. */
START_TEST(histograms_add_up)
{
    sg_image im = random_photo(sizes[_i][0], sizes[_i][1], 11);
    sg_features f = rich_features(&im);
    sg_error err = SG_ERROR_INIT;
    float *memory = calloc(3 * f.width * f.height, sizeof *memory);
    ck_assert_ptr_nonnull(memory);
    sg_plane p[3];
    for (size_t i = 0; i < 3; i++)
        p[i] = (sg_plane){memory + i * f.width * f.height, f.width, f.height, f.width};
    sg_channels c;
    ck_ok(sg_channels_create(&im, &c, &err));
    for (unsigned group = 0; group < 2; group++) {
        const unsigned first = group == 0 ? SG_CHANNEL_ORIENTATION : SG_CHANNEL_PATTERN;
        memset(p[0].at, 0, f.width * f.height * sizeof *memory);
        for (unsigned k = 0; k < (group == 0 ? SG_ORIENTATIONS : SG_PATTERNS); k++) {
            ck_ok(sg_channels_make(&c, first + k, p[1], &err));
            for (size_t i = 0; i < f.width * f.height; i++) {
                ck_assert_float_ge(p[1].at[i], 0);
                p[0].at[i] += p[1].at[i];
            }
        }
        ck_ok(sg_channels_make(&c, SG_CHANNEL_GRADIENT, p[2], &err));
        for (size_t i = 0; i < f.width * f.height; i++)
            ck_assert_float_eq_tol(p[0].at[i], group == 0 ? p[2].at[i] : 1, 1e-4f);
    }
    sg_channels_clear(&c);
    free(memory);
    sg_features_clear(&f);
    sg_image_clear(&im);
}
END_TEST

/* A photograph of one column of pixels, or one row, or one pixel, or one colour, has all features too. */
START_TEST(all_features_are_finite)
{
    sg_image im = random_photo(sizes[_i % NSIZES][0], sizes[_i % NSIZES][1], 3);
    if (_i >= NSIZES)
        memset(im.rgb, 30 * (_i - NSIZES), 3 * im.width * im.height);
    sg_features f = rich_features(&im);
    for (size_t k = 0; k < f.nfeatures; k++)
        for (size_t y = 0; y < f.height; y++)
            for (size_t x = 0; x < f.width; x++)
                ck_assert_float_finite(sg_features_value(&f, k, x, y));
    sg_features_clear(&f);
    sg_image_clear(&im);
}
END_TEST

START_TEST(positions_are_where_the_pixel_is)
{
    sg_image im = random_photo(8, 20, 3);
    sg_features f = rich_features(&im);
    ck_assert_float_eq_tol(sg_features_value(&f, named("x/W"), 1, 0), 1.5f / 8, 1e-6f);
    ck_assert_float_eq_tol(sg_features_value(&f, named("y/H"), 0, 19), 19.5f / 20, 1e-6f);
    ck_assert_float_eq(sg_features_value(&f, named("px to side"), 1, 0), 1);
    ck_assert_float_eq(sg_features_value(&f, named("px to side"), 5, 0), 2);
    ck_assert_float_eq(sg_features_value(&f, named("px to top"), 5, 4), 4);
    ck_assert_float_eq(sg_features_value(&f, named("px to bottom"), 5, 4), 15);
    sg_features_clear(&f);
    sg_image_clear(&im);
}
END_TEST

START_TEST(colours_are_known_ones)
{
    sg_error err = SG_ERROR_INIT;
    static const uint32_t rgb[] = {0xffffff, 0x000000, 0xff0000, 0x00ff00};
    static const float lab[][3] = {{100, 0, 0}, {0, 0, 0}, {53.24f, 80.09f, 67.2f}, {87.73f, -86.18f, 83.18f}};
    static const float hsv[][3] = {{0, 0, 1}, {0, 0, 0}, {0, 1, 1}, {120, 1, 1}};
    sg_image im;
    ck_ok(sg_image_create(4, 1, &im, &err));
    for (size_t i = 0; i < 4; i++)
        sg_image_set(&im, i, 0, rgb[i]);
    sg_features f = rich_features(&im);
    static const char *const names[6] = {"L", "a", "b", "hue", "saturation", "value"};
    for (size_t i = 0; i < 4; i++)
        for (size_t k = 0; k < 6; k++)
            ck_assert_float_eq_tol(sg_features_value(&f, named(names[k]), i, 0), k < 3 ? lab[i][k] : hsv[i][k - 3],
                                   0.1f);
    sg_features_clear(&f);
    sg_image_clear(&im);
}
END_TEST

/* A ramp to the right: its slope is in the gradients along x and in the first orientation alone. */
START_TEST(a_ramp_has_one_direction)
{
    float ramp[5][7], made[5][7];
    sg_error err = SG_ERROR_INIT;
    for (size_t y = 0; y < 5; y++)
        for (size_t x = 0; x < 7; x++)
            ramp[y][x] = 3 * (float)x;
    const sg_plane from = {ramp[0], 7, 5, 7}, to = {made[0], 7, 5, 7};
    ck_ok(sg_cv_derivative(from, to, 1, 0, &err));
    ck_assert_float_eq_tol(made[2][3], 3, 1e-5f);
    ck_ok(sg_cv_derivative(from, to, 0, 1, &err));
    ck_assert_float_eq_tol(made[2][3], 0, 1e-5f);
    ck_ok(sg_cv_laplacian(from, to, &err));
    ck_assert_float_eq_tol(made[2][3], 0, 1e-5f);
    ck_ok(sg_cv_gaussian(from, to, 0.8, &err));
    ck_assert_float_eq_tol(made[2][3], 9, 1e-5f);
}
END_TEST

START_TEST(patterns_are_told_apart)
{
    static const struct {
        float around[3][3];
        unsigned kind;
    } cases[] = {
        {{{0, 0, 0}, {0, 1, 0}, {0, 0, 0}}, 0}, /* a bright spot */
        {{{1, 1, 1}, {1, 0, 1}, {1, 1, 1}}, 8}, /* a dark one */
        {{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}, 8}, /* nothing */
        {{{1, 1, 1}, {1, 1, 1}, {0, 0, 0}}, 5}, /* the upper side of an edge */
        {{{0, 1, 1}, {0, 1, 1}, {0, 1, 1}}, 5}, /* the right side of one */
        {{{0, 0, 1}, {0, 1, 1}, {1, 1, 1}}, 5}, /* and of a slanting one */
        {{{0, 0, 0}, {0, 1, 1}, {0, 1, 1}}, 3}, /* a corner */
        {{{0, 1, 0}, {0, 1, 0}, {0, 1, 0}}, 9}, /* a thin line */
        {{{1, 0, 1}, {0, 1, 0}, {1, 0, 1}}, 9}, /* a checkerboard */
    };
    float around[3][3];
    memcpy(around, cases[_i].around, sizeof around);
    const sg_plane p = {around[0], 3, 3, 3};
    ck_assert_uint_eq(sg_binary_pattern(p, 1, 1), cases[_i].kind);
    const sg_plane alone = {around[0], 1, 1, 3}; /* its neighbours are itself */
    ck_assert_uint_eq(sg_binary_pattern(alone, 0, 0), 8);
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
    tcase_add_test(sets, huge_photographs_are_refused);
    suite_add_tcase(suite, sets);
    TCase *patch = tcase_create("patch");
    tcase_add_loop_test(patch, patch_reads_the_photograph, 0, 3 * NSIZES);
    suite_add_tcase(suite, patch);
    TCase *rich = tcase_create("rich");
    tcase_add_loop_test(rich, sums_are_those_of_the_photograph, 0, (SG_SUM_RIGHT + 1) * NSIZES);
    tcase_add_loop_test(rich, features_are_what_their_names_say, 0, NSIZES);
    tcase_add_loop_test(rich, far_look_ups_are_clamped, 0, NSIZES);
    tcase_add_loop_test(rich, histograms_add_up, 0, NSIZES);
    tcase_add_loop_test(rich, all_features_are_finite, 0, 2 * NSIZES);
    tcase_add_test(rich, positions_are_where_the_pixel_is);
    tcase_add_test(rich, colours_are_known_ones);
    tcase_add_test(rich, a_ramp_has_one_direction);
    tcase_add_loop_test(rich, patterns_are_told_apart, 0, 9);
    suite_add_tcase(suite, rich);
    TCase *memory = tcase_create("memory");
    tcase_add_loop_test(memory, every_allocation_can_fail, 0, 2);
    suite_add_tcase(suite, memory);
    return test_run(suite);
}
