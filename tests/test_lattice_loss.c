/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_lattice_loss.c - what a lattice loses by class and cause, its pictures, one price for many maps. */
#include "core/random.h"
#include "image/classes.h"
#include "parse/lattice_draw.h"
#include "parse/lattice_fit.h"
#include "parse/lattice_loss.h"
#include "tests/support.h"

#include <string.h>

enum { I = SG_CLASS_IGNORE };

static sg_arena *arena;
static gsl_rng *rng;
static sg_error err;

static void set_up(void)
{
    arena = sg_arena_create();
    rng = sg_random_create(1);
    ck_assert(arena != NULL && rng != NULL);
}

static void tear_down(void)
{
    sg_arena_free(arena);
    gsl_rng_free(rng);
}

/* Patches of random size and class, so that regions of all shapes are met; some pixels are ignored. */
static sg_lattice_source random_map(size_t width, size_t height, size_t nclasses)
{
    uint8_t *labels = SG_NEW_ARRAY(arena, uint8_t, width * height);
    for (int k = 0; k < 12; k++) {
        const size_t x0 = gsl_rng_uniform_int(rng, width), y0 = gsl_rng_uniform_int(rng, height);
        const size_t w = 1 + gsl_rng_uniform_int(rng, 12), h = 1 + gsl_rng_uniform_int(rng, 12);
        const uint8_t class = (uint8_t)gsl_rng_uniform_int(rng, nclasses + 1);
        for (size_t y = y0; y < y0 + h && y < height; y++)
            for (size_t x = x0; x < x0 + w && x < width; x++)
                labels[y * width + x] = class == nclasses ? I : class;
    }
    labels[0] = 0;
    return (sg_lattice_source){width, height, nclasses, labels, NULL};
}

static sg_lattice_fit fit(const sg_lattice_source *s, double price)
{
    const sg_lattice_fit_opts opts = SG_LATTICE_FIT_OPTS_INIT;
    sg_lattice_problem *p;
    sg_lattice_fit f;
    ck_ok(sg_lattice_problem_create(s, &opts, &p, &err));
    ck_ok(sg_lattice_fit_weights(p, &(sg_lattice_weights){price, price, 0}, arena, &f, &err));
    sg_lattice_problem_free(p);
    return f;
}

static sg_lattice_loss loss_of(const sg_lattice_source *s, const sg_lattice_fit *f)
{
    sg_lattice_loss loss;
    ck_ok(sg_lattice_loss_create(s->nclasses, arena, &loss, &err));
    const size_t used = sg_arena_used(arena);
    ck_ok(sg_lattice_loss_add(s, f, arena, &loss, &err));
    ck_assert_uint_eq(sg_arena_used(arena), used);
    return loss;
}

static uint8_t shown_at(const sg_lattice_fit *f, size_t x, size_t y)
{
    size_t column = 0, row = 0;
    while (f->x[column + 1] <= x)
        column++;
    while (f->y[row + 1] <= y)
        row++;
    return f->classes[row * f->width + column];
}

/* The slow way: the smallest index spreads over a region until nothing changes. */
static void name_regions(const sg_lattice_source *s, size_t *region)
{
    const size_t n = s->width * s->height;
    for (size_t i = 0; i < n; i++)
        region[i] = i;
    for (bool changed = true; changed;) {
        changed = false;
        for (size_t i = 0; i < n; i++) {
            const size_t beside[] = {i % s->width > 0 ? i - 1 : i, i >= s->width ? i - s->width : i,
                                     (i + 1) % s->width > 0 ? i + 1 : i, i + s->width < n ? i + s->width : i};
            for (size_t k = 0; k < 4; k++)
                if (s->labels[beside[k]] == s->labels[i] && region[beside[k]] < region[i]) {
                    region[i] = region[beside[k]];
                    changed = true;
                }
        }
    }
}

static sg_loss_cause slow_cause(const sg_lattice_source *s, const sg_lattice_fit *f, const size_t *region, size_t i)
{
    size_t right = 0, x0 = SIZE_MAX, x1 = 0, y0 = SIZE_MAX, y1 = 0;
    bool near = false;
    for (size_t j = 0; j < s->width * s->height; j++) {
        const size_t x = j % s->width, y = j / s->width;
        const int dx = abs((int)x - (int)(i % s->width)), dy = abs((int)y - (int)(i / s->width));
        near = near || (dx <= 2 && dy <= 2 && shown_at(f, x, y) == s->labels[i]);
        if (region[j] != region[i])
            continue;
        right += shown_at(f, x, y) == s->labels[i];
        x0 = x < x0 ? x : x0;
        x1 = x > x1 ? x : x1;
        y0 = y < y0 ? y : y0;
        y1 = y > y1 ? y : y1;
    }
    if (right > 0)
        return near ? SG_LOSS_MISALIGNED : SG_LOSS_IRREGULAR;
    return x1 - x0 < 4 || y1 - y0 < 4 ? SG_LOSS_THIN : SG_LOSS_REGION;
}

static bool slow_near(const uint32_t *line, size_t ncells, size_t p)
{
    for (size_t i = 1; i < ncells; i++)
        if (line[i] <= p + 2 && p < line[i] + 2)
            return true;
    return false;
}

START_TEST(counts_equal_the_slow_ones)
{
    gsl_rng_set(rng, (unsigned long)_i + 1);
    const sg_lattice_source s = random_map(1 + gsl_rng_uniform_int(rng, 24), 1 + gsl_rng_uniform_int(rng, 24), 3);
    const sg_lattice_fit f = fit(&s, 2 + 20 * gsl_rng_uniform(rng));
    const sg_lattice_loss loss = loss_of(&s, &f);
    size_t *region = SG_NEW_ARRAY(arena, size_t, s.width * s.height);
    name_regions(&s, region);
    sg_lattice_loss slow;
    ck_ok(sg_lattice_loss_create(3, arena, &slow, &err));
    size_t wrong = 0;
    for (size_t i = 0; i < s.width * s.height; i++) {
        if (s.labels[i] == I)
            continue;
        const uint8_t shown = shown_at(&f, i % s.width, i / s.width);
        slow.confusion[s.labels[i] * 3 + shown]++;
        if (shown == s.labels[i])
            continue;
        wrong++;
        slow.causes[s.labels[i] * SG_LOSS_CAUSES + slow_cause(&s, &f, region, i)]++;
        slow.near_line[s.labels[i]] += slow_near(f.x, f.width, i % s.width) || slow_near(f.y, f.height, i / s.width);
    }
    ck_assert_uint_eq(wrong, f.wrong_px);
    ck_assert_mem_eq(loss.confusion, slow.confusion, 9 * sizeof(size_t));
    ck_assert_mem_eq(loss.causes, slow.causes, 3 * SG_LOSS_CAUSES * sizeof(size_t));
    ck_assert_mem_eq(loss.near_line, slow.near_line, 3 * sizeof(size_t));
    size_t lost = 0;
    for (size_t c = 0; c < 3; c++)
        lost += sg_lattice_loss_wrong(&loss, c);
    ck_assert_uint_eq(lost, f.wrong_px);

    sg_lattice_loss twice;
    ck_ok(sg_lattice_loss_create(3, arena, &twice, &err));
    sg_lattice_loss_merge(&loss, &twice);
    sg_lattice_loss_merge(&loss, &twice);
    for (size_t c = 0; c < 3; c++)
        ck_assert_uint_eq(sg_lattice_loss_pixels(&twice, c), 2 * sg_lattice_loss_pixels(&loss, c));
}
END_TEST

/* A 30 x 20 map of class 0; cells are given, not fitted: one line at x = 10, class 1 to its left. */
static sg_lattice_loss loss_with(uint8_t *labels, size_t x0, size_t y0, size_t x1, size_t y1, uint8_t class)
{
    for (size_t y = 0; y < 20; y++)
        memset(labels + y * 30, 1, 10);
    for (size_t y = y0; y < y1; y++)
        memset(labels + y * 30 + x0, class, x1 - x0);
    const sg_lattice_source s = {30, 20, 3, labels, NULL};
    uint32_t x[] = {0, 10, 30}, y[] = {0, 20};
    uint8_t classes[] = {1, 0};
    const sg_lattice_fit f = {.width = 2, .height = 1, .x = x, .y = y, .classes = classes};
    return loss_of(&s, &f);
}

START_TEST(causes_are_told_apart)
{
    uint8_t labels[600] = {0};
    sg_lattice_loss l = loss_with(labels, 10, 0, 15, 20, 1); /* class 1 goes 5 px over its line: 2 of them near */
    ck_assert_uint_eq(l.causes[1 * SG_LOSS_CAUSES + SG_LOSS_MISALIGNED], 2 * 20);
    ck_assert_uint_eq(l.causes[1 * SG_LOSS_CAUSES + SG_LOSS_IRREGULAR], 3 * 20);
    ck_assert_uint_eq(l.near_line[1], 2 * 20);
    ck_assert_uint_eq(l.confusion[1 * 3 + 0], 100);
    memset(labels, 0, sizeof labels);
    l = loss_with(labels, 20, 3, 29, 7, 2); /* 9 x 4 px that no cell shows */
    ck_assert_uint_eq(l.causes[2 * SG_LOSS_CAUSES + SG_LOSS_THIN], 36);
    memset(labels, 0, sizeof labels);
    l = loss_with(labels, 20, 3, 29, 8, 2); /* 9 x 5 px */
    ck_assert_uint_eq(l.causes[2 * SG_LOSS_CAUSES + SG_LOSS_REGION], 45);
    ck_assert_uint_eq(sg_lattice_loss_pixels(&l, 2), 45);
    ck_assert_uint_eq(sg_lattice_loss_wrong(&l, 2), 45);
    ck_assert_uint_eq(sg_lattice_loss_wrong(&l, 0), 0);
    for (int c = 0; c < SG_LOSS_CAUSES; c++)
        ck_assert_uint_gt(strlen(sg_loss_cause_name((sg_loss_cause)c)), 0);
}
END_TEST

static sg_lattice small_lattice(void)
{
    static const char text[] = "lattice 2 2\nx 0 2 5\ny 0 1 3\na b\nb a\n";
    sg_lattice l;
    ck_ok(sg_lattice_parse("F", text, sizeof text - 1, arena, &l, &err));
    return l;
}

static uint32_t pixel(const sg_image *im, size_t x, size_t y)
{
    const uint8_t *p = im->rgb + 3 * (y * im->width + x);
    return (uint32_t)p[0] << 16 | (uint32_t)p[1] << 8 | p[2];
}

START_TEST(pictures_show_cells_lines_and_errors)
{
    const sg_lattice l = small_lattice();
    const uint32_t colors[] = {0xff0000, 0x00ff00};
    sg_image im;
    ck_ok(sg_lattice_draw(&l, colors, 3, &im, &err));
    ck_assert(im.width == 15 && im.height == 9);
    ck_assert_uint_eq(pixel(&im, 0, 0), 0xff0000); /* no line at the border */
    ck_assert_uint_eq(pixel(&im, 5, 2), 0xff0000);
    ck_assert_uint_ne(pixel(&im, 6, 2), 0x00ff00); /* the line between the columns darkens one pixel */
    ck_assert_uint_eq(pixel(&im, 7, 2), 0x00ff00);
    ck_assert_uint_eq(pixel(&im, 6, 2) & 0xff00ff, 0);
    ck_assert_uint_eq(pixel(&im, 7, 3) & 0xff00, 0); /* the line between the rows, a red cell below */
    ck_assert_uint_ne(pixel(&im, 7, 3), 0xff0000);
    ck_assert_uint_eq(pixel(&im, 7, 4), 0xff0000);
    sg_image_clear(&im);

    uint8_t truth[] = {0, 0, 1, 0, I, /**/ 1, 1, 0, 0, 0, /**/ 1, 1, 0, 0, 0};
    const sg_label_map map = {5, 3, truth};
    const uint8_t classes[] = {0, 1};
    ck_ok(sg_lattice_draw_errors(&l, classes, &map, colors, 1, &im, &err));
    ck_assert_uint_eq(pixel(&im, 3, 0), 0xff0000); /* the true colour of the wrong pixel */
    ck_assert_uint_eq(pixel(&im, 4, 0), 0x808080);
    ck_assert_uint_gt(pixel(&im, 2, 0) & 0xff, 0x80); /* pale */
    ck_assert_uint_eq(pixel(&im, 0, 0), pixel(&im, 4, 2));
    sg_image_clear(&im);

    ck_assert_int_eq(sg_lattice_draw(&l, colors, 0, &im, &err), SG_EINVAL);
    ck_assert_int_eq(sg_lattice_draw(&l, colors, 17, &im, &err), SG_EINVAL);
    const sg_label_map other = {3, 5, truth};
    ck_assert_int_eq(sg_lattice_draw_errors(&l, classes, &other, colors, 1, &im, &err), SG_EINVAL);
}
END_TEST

START_TEST(boundaries_that_begin_elsewhere_are_painted_from_there)
{
    static const char text[] = "lattice 2 1\nx 100 102 105\ny 7 9\na b\n";
    sg_lattice l;
    ck_ok(sg_lattice_parse("F", text, sizeof text - 1, arena, &l, &err));
    const uint8_t values[] = {3, 4}, expected[] = {3, 3, 4, 4, 4, 3, 3, 4, 4, 4};
    sg_label_map map;
    ck_ok(sg_lattice_paint(&l, values, &map, &err));
    ck_assert(map.width == 5 && map.height == 2);
    ck_assert_mem_eq(map.labels, expected, sizeof expected);
    sg_label_map_clear(&map);
    l.x[2] = INT32_MAX; /* larger than a picture may be */
    ck_assert_int_eq(sg_lattice_paint(&l, values, &map, &err), SG_EINVAL);
}
END_TEST

enum { NMAPS = 6 };

static void at_share(sg_lattice_problem *const *p, double share, double *cells, double *accuracy)
{
    *cells = *accuracy = 0;
    for (size_t i = 0; i < NMAPS; i++) {
        sg_lattice_fit f;
        ck_ok(sg_lattice_fit_share(p[i], share, arena, &f, &err));
        *cells += (double)(f.width * f.height) / NMAPS;
        *accuracy += sg_lattice_accuracy(&f) / NMAPS;
    }
}

START_TEST(a_common_price_meets_the_means)
{
    const sg_lattice_fit_opts opts = {256, 0.05, 10, 1024, 1};
    sg_lattice_problem *p[NMAPS];
    for (size_t i = 0; i < NMAPS; i++) {
        const sg_lattice_source s = random_map(40 + 10 * i, 60, 4);
        ck_ok(sg_lattice_problem_create(&s, &opts, &p[i], &err));
    }
    double share, again, cells, accuracy, cheaper_cells, cheaper_accuracy;
    ck_ok(sg_lattice_common_price(p, NMAPS, 30, 0, 1, NULL, &share, &err));
    ck_ok(sg_lattice_common_price(p, NMAPS, 30, 0, 2, NULL, &again, &err));
    ck_assert(share == again); /* whatever the threads */
    at_share(p, share, &cells, &accuracy);
    at_share(p, share / 1.02, &cheaper_cells, &cheaper_accuracy);
    ck_assert(cells <= 30 && cheaper_cells > 30 && cheaper_accuracy >= accuracy);
    ck_ok(sg_lattice_common_price(p, NMAPS, 0, 0.97, 2, NULL, &share, &err));
    at_share(p, share, &cells, &accuracy);
    at_share(p, share * 1.02, &cheaper_cells, &cheaper_accuracy);
    ck_assert_msg(accuracy >= 0.97 && cheaper_accuracy < 0.97, "%g %g at %g", accuracy, cheaper_accuracy, share);
    ck_assert_int_eq(sg_lattice_common_price(p, 0, 30, 0, 1, NULL, &share, &err), SG_EINVAL);
    ck_assert_int_eq(sg_lattice_common_price(p, NMAPS, 0, 1.5, 1, NULL, &share, &err), SG_EINVAL);
    for (size_t i = 0; i < NMAPS; i++)
        sg_lattice_problem_free(p[i]);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("lattice_loss");
    TCase *tc = tcase_create("loss");
    tcase_set_timeout(tc, 120);
    tcase_add_checked_fixture(tc, set_up, tear_down);
    tcase_add_loop_test(tc, counts_equal_the_slow_ones, 0, 60);
    tcase_add_test(tc, causes_are_told_apart);
    tcase_add_test(tc, pictures_show_cells_lines_and_errors);
    tcase_add_test(tc, boundaries_that_begin_elsewhere_are_painted_from_there);
    tcase_add_test(tc, a_common_price_meets_the_means);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
