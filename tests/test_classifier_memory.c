/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_classifier_memory.c - pixel classifiers when memory runs out at any point, in C and in OpenCV's trees: the status says
 * so, and nothing is lost or used after. */
#include "config.h"

#include "parse/pixel_classifier_learn.h"
#include "parse/pixel_classifier_priv.h"
#include "tests/classifier_support.h"
#include "tests/failing_malloc.h"
#include "tests/failing_new.h"

#include <string.h>

char *__real_strdup(const char *s);
char *__wrap_strdup(const char *s);

char *__wrap_strdup(const char *s)
{
    return test_allocations++ == test_fail_at ? NULL : __real_strdup(s);
}

static temp_folder folder;
static sg_arena *arena;
static sg_dataset train, valid;

static void open_set(void)
{
    folder = temp_folder_make();
    arena = sg_arena_create();
    test_write_set(&folder, true);
    train = test_open_set(&folder, SG_SPLIT_TRAIN, arena);
    valid = test_open_set(&folder, SG_SPLIT_VALID, arena);
}

static void close_set(void)
{
    sg_dataset_close(&train);
    sg_dataset_close(&valid);
    sg_arena_free(arena);
    temp_folder_remove(&folder);
}

static sg_status learn(sg_pixel_classifier **c)
{
    sg_error err = SG_ERROR_INIT;
    sg_pixel_learn_opts o = SG_PIXEL_LEARN_OPTS_INIT;
    sg_pixel_learn_report r;
    o.features = sg_feature_set_of(SG_FEATURES_PATCH, 1);
    o.grow.trees = 2;
    o.grow.depth = 3;
    o.pixels = 150;
    const sg_status st = sg_pixel_classifier_learn(&train, &valid, &o, c, &r, &err);
    sg_pixel_learn_report_clear(&r);
    return st;
}

static bool is_same(const sg_pixel_classifier *a, const sg_pixel_classifier *b)
{
    const sg_forest *f = &a->forest, *g = &b->forest;
    return f->nnodes == g->nnodes && memcmp(f->nodes, g->nodes, f->nnodes * sizeof *f->nodes) == 0 &&
           memcmp(f->leaves, g->leaves, f->nleaves * f->nclasses * sizeof *f->leaves) == 0 &&
           a->calibration.temperature == b->calibration.temperature && a->calibration.exponent == b->calibration.exponent;
}

/* Make the k-th allocation fail, for k = 0, 1, ... until none is left. A failure is told, or does no harm: a buffer that would
 * be made smaller, a sort that has another way. */
static void fail_each(void (*arm)(size_t k), int (*has_failed)(void), size_t least)
{
    sg_pixel_classifier *whole = NULL;
    size_t told = 0;
    int failed = 1;
    ck_assert_int_eq(learn(&whole), SG_OK);
    for (size_t k = 0; failed; k += 1 + k / 100) {
        sg_pixel_classifier *c = NULL;
        arm(k); /* Check allocates too: nothing is asserted until this is over */
        const sg_status st = learn(&c);
        failed = has_failed();
        ck_assert_msg(st == SG_OK || (failed && st == SG_ENOMEM), "allocation %zu: status %d", k, (int)st);
        ck_assert((c != NULL) == (st == SG_OK));
        ck_assert(c == NULL || is_same(c, whole));
        sg_pixel_classifier_free(c);
        told += st == SG_ENOMEM;
    }
    ck_assert_uint_gt(told, least);
    sg_pixel_classifier_free(whole);
}

START_TEST(learning_survives_any_failed_allocation)
{
    fail_each(test_fail_allocation, test_allocation_failed, 100);
}
END_TEST

START_TEST(learning_survives_any_failed_new)
{
    fail_each(test_fail_new, test_new_failed, 50);
}
END_TEST

/* ---- files and photographs ---- */

static sg_status write_and_read(const sg_pixel_classifier *c, const char *path, sg_pixel_classifier **back)
{
    sg_error err = SG_ERROR_INIT;
    const sg_status st = sg_pixel_classifier_write(path, c, &err);
    return st == SG_OK ? sg_pixel_classifier_read(path, back, &err) : st;
}

START_TEST(files_survive_any_failed_allocation)
{
    sg_pixel_classifier *c = NULL;
    const char *path = temp_path(&folder, "c.rf");
    ck_assert_int_eq(learn(&c), SG_OK);
    size_t failures = 0;
    int failed = 1;
    for (size_t k = 0; failed; k++) {
        sg_pixel_classifier *back = NULL;
        test_fail_allocation(k);
        const sg_status st = write_and_read(c, path, &back);
        failed = test_allocation_failed();
        ck_assert_msg(st == (failed ? SG_ENOMEM : SG_OK), "allocation %zu: status %d", k, (int)st);
        ck_assert((back != NULL) == (st == SG_OK));
        sg_pixel_classifier_free(back);
        failures += failed != 0;
    }
    ck_assert_uint_gt(failures, 10);
    sg_pixel_classifier_free(c);
}
END_TEST

START_TEST(photographs_survive_any_failed_allocation)
{
    sg_error err = SG_ERROR_INIT;
    sg_pixel_classifier *c = NULL;
    sg_image im;
    ck_assert_int_eq(learn(&c), SG_OK);
    ck_ok(sg_png_read_rgb(valid.items[0].image, &im, &err));
    size_t failures = 0;
    int failed = 1;
    for (size_t k = 0; failed; k++) {
        sg_float_map p = {0};
        test_fail_allocation(k);
        const sg_status st = sg_pixel_classifier_apply(c, &im, 2, &p, &err);
        failed = test_allocation_failed();
        ck_assert_msg(st == (failed ? SG_ENOMEM : SG_OK), "allocation %zu: status %d", k, (int)st);
        ck_assert((p.values != NULL) == (st == SG_OK));
        sg_float_map_clear(&p);
        failures += failed != 0;
    }
    ck_assert_uint_gt(failures, 5);
    sg_image_clear(&im);
    sg_pixel_classifier_free(c);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("classifier_memory");
    TCase *c = tcase_create("memory");
    tcase_add_checked_fixture(c, open_set, close_set);
    tcase_add_test(c, learning_survives_any_failed_allocation);
    tcase_add_test(c, learning_survives_any_failed_new);
    tcase_add_test(c, files_survive_any_failed_allocation);
    tcase_add_test(c, photographs_survive_any_failed_allocation);
    suite_add_tcase(suite, c);
    return test_run(suite);
}
