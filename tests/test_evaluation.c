/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_evaluation.c - confusion matrices and scores: a worked example, slow counts, means over folds, the published
 * convention. */
#include "config.h"

#include "core/random.h"
#include "parse/evaluation_print.h"
#include "tests/failing_malloc.h"
#include "tests/support.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

enum { I = SG_CLASS_IGNORE, U = SG_CLASS_UNKNOWN };

void *__real_aligned_alloc(size_t alignment, size_t n);
void *__wrap_aligned_alloc(size_t alignment, size_t n);

void *__wrap_aligned_alloc(size_t alignment, size_t n)
{
    return test_allocations++ == test_fail_at ? NULL : __real_aligned_alloc(alignment, n);
}

static sg_arena *arena;
static gsl_rng *rng;
static sg_error err;
static uint8_t same[256];

static void set_up(void)
{
    arena = sg_arena_create();
    rng = sg_random_create(1);
    ck_assert(arena != NULL && rng != NULL);
    for (int v = 0; v < 256; v++)
        same[v] = (uint8_t)v;
}

static void tear_down(void)
{
    sg_arena_free(arena);
    gsl_rng_free(rng);
}

static sg_confusion empty(size_t nclasses)
{
    sg_confusion c;
    ck_ok(sg_confusion_create(nclasses, arena, &c, &err));
    return c;
}

static sg_scores scores_of(const sg_confusion *c)
{
    sg_scores s;
    ck_ok(sg_scores_of(c, arena, &s, &err));
    return s;
}

/* Ten pixels, three classes; worked by hand. Class 2 is not in the truth. */
static sg_confusion example(void)
{
    static uint8_t truth[10] = {0, 0, 0, 0, 1, 1, 1, I, I, 0}, found[10] = {0, 0, 1, 2, 1, 1, U, 0, U, I};
    const sg_label_map t = {5, 2, truth}, f = {5, 2, found};
    sg_confusion c = empty(3);
    ck_ok(sg_confusion_add(&c, &t, &f, same, &err));
    return c;
}

START_TEST(worked_example)
{
    const sg_confusion c = example();
    static const uint64_t counts[12] = {2, 1, 1, 1, 0, 2, 0, 1, 0, 0, 0, 0};
    ck_assert_mem_eq(c.counts, counts, sizeof counts);
    ck_assert(c.ignored == 2 && c.nmaps == 1 && sg_confusion_unclassed(&c) == 2);
    ck_assert(sg_confusion_pixels(&c, 0) == 5 && sg_confusion_pixels(&c, 1) == 3 && sg_confusion_pixels(&c, 2) == 0);
    const sg_scores s = scores_of(&c);
    ck_assert_double_eq_tol(s.overall, 4.0 / 8, 1e-15);
    ck_assert_double_eq_tol(s.recall[0], 2.0 / 5, 1e-15);
    ck_assert_double_eq_tol(s.recall[1], 2.0 / 3, 1e-15);
    ck_assert_double_nan(s.recall[2]);
    ck_assert_double_eq_tol(s.class_average, (2.0 / 5 + 2.0 / 3) / 2, 1e-15);
    ck_assert_double_eq_tol(s.iou[0], 2.0 / 5, 1e-15);  /* found 2, truth 5, both 2 */
    ck_assert_double_eq_tol(s.iou[1], 2.0 / 4, 1e-15);  /* found 3, truth 3, both 2 */
    ck_assert_double_eq_tol(s.iou[2], 0, 1e-15);        /* found once, wrongly */
    ck_assert_double_eq_tol(s.mean_iou, (2.0 / 5 + 2.0 / 4 + 0) / 3, 1e-15);
    ck_assert_double_eq_tol(s.entries[3], 1.0 / 5, 1e-15);
    ck_assert_double_nan(s.entries[8]);
}
END_TEST

START_TEST(counts_equal_slow_ones)
{
    gsl_rng_set(rng, (unsigned long)_i + 1);
    const size_t n = 1 + gsl_rng_uniform_int(rng, 5), width = 1 + gsl_rng_uniform_int(rng, 30);
    uint8_t truth[30], found[30], class_of[256];
    for (size_t v = 0; v < 256; v++)
        class_of[v] = (uint8_t)gsl_rng_uniform_int(rng, 8);
    for (size_t i = 0; i < width; i++) {
        truth[i] = (uint8_t)gsl_rng_uniform_int(rng, n + 1);
        if (truth[i] == n)
            truth[i] = I;
        found[i] = (uint8_t)gsl_rng_uniform_int(rng, 256);
    }
    sg_confusion c = empty(n), sum = empty(n);
    ck_ok(sg_confusion_add(&c, &(sg_label_map){width, 1, truth}, &(sg_label_map){width, 1, found}, class_of, &err));
    for (size_t t = 0; t < n; t++)
        for (size_t f = 0; f <= n; f++) {
            uint64_t slow = 0;
            for (size_t i = 0; i < width; i++)
                slow += truth[i] == t && (f < n ? class_of[found[i]] == f : class_of[found[i]] >= n);
            ck_assert_uint_eq(c.counts[t * (n + 1) + f], slow);
        }
    uint64_t all = c.ignored;
    for (size_t t = 0; t < n; t++)
        all += sg_confusion_pixels(&c, t);
    ck_assert_uint_eq(all, width);
    /* two halves make the whole, and twice the same pixels the same scores */
    sg_confusion_merge(&c, &sum);
    sg_confusion_merge(&c, &sum);
    const sg_scores one = scores_of(&c), two = scores_of(&sum);
    ck_assert(sum.nmaps == 2 && sum.ignored == 2 * c.ignored);
    for (size_t i = 0; i < n * (n + 3); i++) {
        ck_assert_uint_eq(isnan(one.recall[i]), isnan(two.recall[i]));
        ck_assert(isnan(one.recall[i]) || fabs(one.recall[i] - two.recall[i]) < 1e-14);
    }
}
END_TEST

START_TEST(sizes_must_agree)
{
    uint8_t labels[6] = {0};
    sg_confusion c = empty(2);
    const sg_status st =
        sg_confusion_add(&c, &(sg_label_map){3, 2, labels}, &(sg_label_map){2, 3, labels}, same, &err);
    ck_assert_int_eq(st, SG_EINVAL);
    ck_assert_str_eq(err.msg, "2 x 3 pixels, but the truth has 3 x 2");
    ck_assert_uint_eq(c.nmaps + sg_confusion_pixels(&c, 0) + c.ignored, 0);
}
END_TEST

/* ---- folds ---- */

/* A fold with so many right and wrong pixels of two classes, and none of a third. */
static sg_confusion fold_of(uint64_t right0, uint64_t wrong0, uint64_t right1, uint64_t wrong1)
{
    sg_confusion c = empty(3);
    c.counts[0] = right0;
    c.counts[1] = wrong0;
    c.counts[5] = right1;
    c.counts[4] = wrong1;
    c.nmaps = 1;
    return c;
}

START_TEST(published_convention_cuts_in_every_fold)
{
    /* recalls 2/3 and 29/100; 199/200 and 1; the second class is not in the third fold */
    const sg_confusion folds[3] = {fold_of(2, 1, 29, 71), fold_of(199, 1, 40, 0), fold_of(1, 7, 0, 0)};
    const sg_scores scores[3] = {scores_of(&folds[0]), scores_of(&folds[1]), scores_of(&folds[2])};
    sg_scores mean, published;
    ck_ok(sg_scores_mean(scores, 3, arena, &mean, &err));
    ck_ok(sg_scores_published(folds, 3, arena, &published, &err));
    const double overall = (31.0 / 103 + 239.0 / 240 + 1.0 / 8) / 3;
    ck_assert_double_eq_tol(mean.overall, overall, 1e-15);
    ck_assert_double_eq_tol(published.overall, overall, 1e-15); /* not cut */
    ck_assert_double_eq_tol(mean.recall[0], (2.0 / 3 + 199.0 / 200 + 1.0 / 8) / 3, 1e-15);
    ck_assert_double_eq_tol(published.recall[0], (0.66 + 0.99 + 0.12) / 3, 1e-15);
    ck_assert_double_eq_tol(published.entries[1], (0.33 + 0.00 + 0.87) / 3, 1e-15); /* no longer sums to 1 with it */
    ck_assert_double_eq_tol(mean.recall[1], (0.29 + 1) / 2, 1e-15);
    ck_assert_double_eq_tol(published.recall[1], (0.29 + 1) / 2, 1e-15); /* 29 of 100 are 29 per cent, not 28 */
    ck_assert_double_eq_tol(published.class_average, (published.recall[0] + published.recall[1]) / 2, 1e-15);
    /* the mean's class average is that of the folds' averages; here the folds have different classes */
    ck_assert_double_eq_tol(mean.class_average, ((2.0 / 3 + 0.29) / 2 + (0.995 + 1) / 2 + 0.125) / 3, 1e-15);
    ck_assert_double_nan(published.recall[2]);
    ck_assert_double_nan(published.mean_iou);
    ck_assert_double_nan(published.iou[0]);
    ck_assert(!isnan(mean.iou[0]));
}
END_TEST

START_TEST(one_fold_is_its_own_mean)
{
    const sg_confusion c = example();
    const sg_scores s = scores_of(&c);
    sg_scores mean, published;
    ck_ok(sg_scores_mean(&s, 1, arena, &mean, &err));
    ck_ok(sg_scores_published(&c, 1, arena, &published, &err));
    for (size_t i = 0; i < 3 * 6; i++)
        ck_assert(isnan(s.recall[i]) ? isnan(mean.recall[i]) : s.recall[i] == mean.recall[i]);
    ck_assert(mean.overall == s.overall && mean.class_average == s.class_average && mean.mean_iou == s.mean_iou);
    for (size_t i = 0; i < 12; i++)
        ck_assert(isnan(s.entries[i]) || (published.entries[i] <= s.entries[i] + 1e-15 && published.entries[i] > s.entries[i] - 0.01));
    ck_assert_int_eq(sg_scores_mean(&s, 0, arena, &mean, &err), SG_EINVAL);
    ck_assert_int_eq(sg_scores_published(&c, 0, arena, &mean, &err), SG_EINVAL);
}
END_TEST

/* ---- classes by name ---- */

static sg_classes classes_of(size_t n, const char *const *names)
{
    static const uint32_t colors[8];
    sg_classes c;
    ck_ok(sg_classes_create(n, names, colors, &c, &err));
    return c;
}

START_TEST(classes_go_by_name_and_alias)
{
    sg_classes truth = classes_of(4, (const char *const[]){"roof", "wall", "ignore", "sky"});
    sg_classes found = classes_of(5, (const char *const[]){"wall", "chimney", "roof", "wall", "ignore"});
    uint8_t class_of[256];
    const char *alias = "chimney=roof";
    ck_ok(sg_evaluation_classes(&found, &truth, NULL, 0, class_of, &err));
    static const uint8_t plain[5] = {1, U, 0, 1, U}, with_alias[5] = {1, 0, 0, 1, U};
    ck_assert_mem_eq(class_of, plain, 5);
    ck_assert_uint_eq(class_of[200], U);
    ck_ok(sg_evaluation_classes(&found, &truth, &alias, 1, class_of, &err));
    ck_assert_mem_eq(class_of, with_alias, 5);
    static const char *const bad[] = {"chimney", "moon=roof", "chimney=moon", "chimney=", "=roof", "chimney=ignore", "chim=roof"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        ck_assert_int_eq(sg_evaluation_classes(&found, &truth, &bad[i], 1, class_of, &err), SG_EINVAL);
        ck_assert_ptr_nonnull(strstr(err.msg, bad[i]));
    }
    sg_classes_clear(&truth);
    sg_classes_clear(&found);
}
END_TEST

START_TEST(json_holds_the_numbers)
{
    const sg_confusion c = example();
    const sg_scores s = scores_of(&c);
    sg_classes classes = classes_of(3, (const char *const[]){"a", "b", "c"});
    json_t *o = sg_scores_json(&c, &s, &classes);
    double overall, recall;
    json_int_t count, unclassed, ignored;
    json_t *confusion;
    ck_assert_ptr_nonnull(o);
    ck_assert_int_eq(json_unpack(o, "{s:F, s:{s:F, s:n}, s:o, s:[[I]], s:{s:I}, s:I}", "overall", &overall, "per_class", "b",
                                 &recall, "c", "confusion", &confusion, "counts", &count, "unclassed", "b", &unclassed,
                                 "ignored", &ignored),
                     0);
    ck_assert(overall == 0.5 && recall == 2.0 / 3 && count == 2 && unclassed == 1 && ignored == 2);
    ck_assert_double_eq(json_real_value(json_array_get(json_array_get(confusion, 0), 1)), 0.2);
    ck_assert_uint_eq(json_array_size(json_array_get(confusion, 0)), 3);
    json_decref(o);
    sg_classes_clear(&classes);
}
END_TEST

/* Everything of the library that allocates from the arena, in turn. */
static sg_status everything(void)
{
    sg_confusion c[2];
    sg_scores s[2], mean, published;
    for (int i = 0; i < 2; i++) {
        SG_TRY(sg_confusion_create(200, arena, &c[i], &err));
        c[i].counts[0] = 1;
        SG_TRY(sg_scores_of(&c[i], arena, &s[i], &err));
    }
    SG_TRY(sg_scores_mean(s, 2, arena, &mean, &err));
    return sg_scores_published(c, 2, arena, &published, &err);
}

START_TEST(each_allocation_may_fail)
{
    for (size_t k = 0;; k++) {
        sg_arena_free(arena);
        arena = sg_arena_create();
        ck_assert_ptr_nonnull(arena);
        test_fail_allocation(k);
        const sg_status st = everything();
        const bool failed = test_allocation_failed();
        ck_assert_int_eq(st, failed ? SG_ENOMEM : SG_OK);
        if (!failed) {
            ck_assert_uint_gt(k, 2);
            break;
        }
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("evaluation");
    TCase *tc = tcase_create("evaluation");
    tcase_add_checked_fixture(tc, set_up, tear_down);
    tcase_add_test(tc, worked_example);
    tcase_add_loop_test(tc, counts_equal_slow_ones, 0, 60);
    tcase_add_test(tc, sizes_must_agree);
    tcase_add_test(tc, published_convention_cuts_in_every_fold);
    tcase_add_test(tc, one_fold_is_its_own_mean);
    tcase_add_test(tc, classes_go_by_name_and_alias);
    tcase_add_test(tc, json_holds_the_numbers);
    tcase_add_test(tc, each_allocation_may_fail);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
