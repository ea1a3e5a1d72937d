/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_dataset.c - data set folders: what is chosen, and that every fault is told at once. */
#include "config.h"

#include "core/file.h"
#include "image/cv_image.h"
#include "image/png_io.h"
#include "parse/dataset.h"
#include "tests/png_make.h"
#include "tests/support.h"
#include "tests/temp_folder.h"

#include <string.h>
#include <unistd.h>

enum { WIDTH = 6, HEIGHT = 4, MAX_FAULTS = 64 };

typedef struct {
    temp_folder t;
    sg_arena *arena;
    sg_dataset d;
    sg_error err;
    size_t nfaults;
    char faults[MAX_FAULTS][1024];
} fixture;

static void take_fault(void *user, const char *sentence)
{
    fixture *f = user;
    ck_assert_uint_lt(f->nfaults, MAX_FAULTS);
    snprintf(f->faults[f->nfaults++], sizeof f->faults[0], "%s", sentence);
}

static void add_labels(fixture *f, const char *name, size_t width, size_t height, uint8_t first)
{
    char file[64];
    uint32_t colors[256] = {0};
    sg_label_map m;
    snprintf(file, sizeof file, "labels/%s.png", name);
    ck_assert_int_eq(sg_label_map_create(width, height, &m, NULL), SG_OK);
    m.labels[0] = first;
    ck_assert_int_eq(sg_png_write_labels(temp_path(&f->t, file), &m, colors, 256, NULL), SG_OK);
    sg_label_map_clear(&m);
}

static void add_image(fixture *f, const char *file, size_t width, size_t height)
{
    sg_image im;
    ck_assert_int_eq(sg_image_create(width, height, &im, NULL), SG_OK);
    if (strstr(file, ".png") != NULL)
        ck_assert_int_eq(sg_png_write_rgb(temp_path(&f->t, file), &im, NULL), SG_OK);
    else
        ck_assert_int_eq(sg_photo_write_jpeg(temp_path(&f->t, file), &im, 90, NULL), SG_OK);
    sg_image_clear(&im);
}

/* Five maps a to e with pictures; classes 0 (one), 3 (two), 9 (ignored). */
static fixture *make(void)
{
    fixture *f = calloc(1, sizeof *f);
    f->t = temp_folder_make();
    f->arena = sg_arena_create();
    temp_mkdir(&f->t, "labels");
    temp_mkdir(&f->t, "images");
    temp_mkdir(&f->t, "folds");
    temp_text(&f->t, "classes.tsv", "0\tone\t#ff0000\n3\ttwo\t#00ff00\n9\tignore\t#000000\n");
    for (const char *p = "dbeac"; *p != '\0'; p++) {
        char file[32];
        add_labels(f, (char[]){*p, '\0'}, WIDTH, HEIGHT, 3);
        snprintf(file, sizeof file, "images/%c.%s", *p, *p == 'b' ? "png" : "jpg");
        add_image(f, file, WIDTH, HEIGHT);
    }
    return f;
}

static void finish(fixture *f)
{
    temp_folder_remove(&f->t);
    sg_arena_free(f->arena);
    free(f);
}

static sg_status reopen(fixture *f, const sg_dataset_opts *opts)
{
    f->nfaults = 0;
    return sg_dataset_open(f->t.path, opts, f->arena, take_fault, f, &f->d, &f->err);
}

/* The data set opens and its items are these letters. */
static void expect_items(fixture *f, const sg_dataset_opts *opts, const char *letters)
{
    const sg_status st = reopen(f, opts);
    ck_assert_msg(st == SG_OK, "%s: %s", f->err.msg, f->faults[0]);
    ck_assert_uint_eq(f->d.nitems, strlen(letters));
    for (size_t i = 0; i < f->d.nitems; i++)
        ck_assert(f->d.items[i].name[0] == letters[i] && f->d.items[i].name[1] == '\0');
    sg_dataset_close(&f->d);
}

/* It does not, and the faults hold these words, one fault each, in this order. */
static void expect_faults(fixture *f, const sg_dataset_opts *opts, size_t n, const char *const *words)
{
    ck_assert_int_eq(reopen(f, opts), SG_EINPUT);
    for (size_t i = 0; i < n && i < f->nfaults; i++)
        ck_assert_msg(strstr(f->faults[i], words[i]) != NULL, "'%s' lacks '%s'", f->faults[i], words[i]);
    ck_assert_msg(f->nfaults == n, "%zu faults, not %zu: %s", f->nfaults, n, f->faults[f->nfaults > n ? n : 0]);
    ck_assert_ptr_nonnull(strstr(f->err.msg, "fault"));
}

#define EXPECT_FAULTS(f, opts, ...)                                                                                    \
    expect_faults((f), (opts), sizeof((const char *const[]){__VA_ARGS__}) / sizeof(char *),                            \
                  (const char *const[]){__VA_ARGS__})

START_TEST(maps_come_in_the_order_that_is_asked_for)
{
    fixture *f = make();
    sg_dataset_opts o = SG_DATASET_OPTS_INIT;
    expect_items(f, &o, "abcde");
    o.need_images = true;
    expect_items(f, &o, "abcde");
    o.max_images = 2;
    expect_items(f, &o, "ab");
    o.max_images = 99;
    expect_items(f, &o, "abcde");
    temp_text(&f->t, "folds/1.tsv", "# a comment\nd\ttrain\nb\ttest\na\ttrain\nc\ttrain\ne\tvalid\n");
    temp_text(&f->t, "folds/2.tsv", "d\ttrain\r\nb\ttest\r\na\ttrain\r\nc\ttrain\r\ne\tvalid"); /* the same, Windows */
    o = (sg_dataset_opts)SG_DATASET_OPTS_INIT;
    for (o.fold = 1; o.fold <= 2; o.fold++) {
        o.part = SG_SPLIT_TRAIN;
        expect_items(f, &o, "dac");
        o.max_images = 2;
        expect_items(f, &o, "da");
        o.max_images = 0;
        o.part = SG_SPLIT_VALID;
        expect_items(f, &o, "e");
        o.part = SG_SPLIT_TEST;
        expect_items(f, &o, "b");
        o.part = SG_SPLIT_ALL;
        expect_items(f, &o, "dbace");
    }
    o = (sg_dataset_opts)SG_DATASET_OPTS_INIT;
    temp_text(&f->t, "names.txt", "e\n\na");
    o.names_file = temp_path(&f->t, "names.txt");
    expect_items(f, &o, "ea");
    o.fold = 1;
    ck_assert_int_eq(reopen(f, &o), SG_EINVAL);
    finish(f);
}
END_TEST

START_TEST(labels_become_classes)
{
    fixture *f = make();
    sg_dataset_opts o = SG_DATASET_OPTS_INIT;
    sg_error err = SG_ERROR_INIT;
    sg_label_map m;
    add_labels(f, "a", WIDTH, HEIGHT, 9);
    ck_ok(reopen(f, &o));
    ck_assert_uint_eq(f->d.classes.nclasses, 2);
    ck_assert_str_eq(f->d.classes.names[1], "two");
    ck_ok(sg_dataset_read_labels(&f->d, 0, &m, &err));
    ck_assert_uint_eq(m.labels[0], SG_CLASS_IGNORE);
    ck_assert_uint_eq(m.labels[1], 0);
    sg_label_map_clear(&m);
    ck_ok(sg_dataset_read_labels(&f->d, 1, &m, &err));
    ck_assert_uint_eq(m.labels[0], 1);
    sg_label_map_clear(&m);
    ck_assert_int_eq(sg_dataset_read_labels(&f->d, 5, &m, &err), SG_EINVAL);
    add_labels(f, "a", WIDTH, HEIGHT, 8); /* changed after the check */
    ck_assert_int_eq(sg_dataset_read_labels(&f->d, 0, &m, &err), SG_EINPUT);
    sg_dataset_close(&f->d);
    temp_text(&f->t, "other.tsv", "0\tone\t#ff0000\n3\tone\t#00ff00\n8\tignore\t#000000\n");
    o.classes_file = temp_path(&f->t, "other.tsv");
    ck_ok(reopen(f, &o));
    ck_assert_uint_eq(f->d.classes.nclasses, 1); /* one class is enough */
    sg_dataset_close(&f->d);
    finish(f);
}
END_TEST

START_TEST(one_pixel_and_labels_alone_are_enough)
{
    fixture *f = make();
    sg_dataset_opts o = SG_DATASET_OPTS_INIT;
    unlink(temp_path(&f->t, "images/a.jpg"));
    ck_assert_int_eq(reopen(f, &o), SG_OK);
    ck_assert_ptr_null(f->d.items[0].image);
    ck_assert_ptr_nonnull(strstr(f->d.items[1].image, "images/b.png"));
    sg_dataset_close(&f->d);
    o.need_images = true;
    EXPECT_FAULTS(f, &o, "images/a.jpg (or .png): no such picture");
    add_labels(f, "a", 1, 1, 0);
    add_image(f, "images/a.jpg", 1, 1);
    expect_items(f, &o, "abcde");
    o.need_images = false; /* even then one of another size is told; a damaged one is not */
    add_image(f, "images/a.jpg", 2, 1);
    EXPECT_FAULTS(f, &o, "images/a.jpg: 2 x 1 pixels, but ");
    temp_text(&f->t, "images/a.jpg", "damaged");
    expect_items(f, &o, "abcde");
    finish(f);
}
END_TEST

START_TEST(all_faults_of_files_are_told_at_once)
{
    fixture *f = make();
    sg_dataset_opts o = SG_DATASET_OPTS_INIT;
    const unsigned char pixel[8] = {0};
    size_t n;
    o.need_images = true;
    add_labels(f, "a", WIDTH, HEIGHT, 200);
    png_make(temp_path(&f->t, "labels/b.png"), 1, 1, 16, PNG_COLOR_TYPE_GRAY, 0, pixel, 8);
    add_labels(f, "c", WIDTH + 1, HEIGHT, 3);
    unsigned char *bytes = temp_read(&f->t, "labels/d.png", &n);
    temp_write(&f->t, "labels/d.png", bytes, n / 2);
    free(bytes);
    bytes = temp_read(&f->t, "images/e.jpg", &n);
    temp_write(&f->t, "images/e.jpg", bytes, n - 2);
    free(bytes);
    unlink(temp_path(&f->t, "images/d.jpg"));
    add_image(f, "images/e.png", WIDTH, HEIGHT);
    EXPECT_FAULTS(f, &o, "a.png: label 200 is not in the class table (1 pixel, the first at column 0, row 0)",
                  "labels/b.png: a label map must be", "images/c.jpg: 6 x 4 pixels, but",
                  "images/d.jpg (or .png): no such picture", "labels/d.png: the file is truncated",
                  "images/e.png: there is", "images/e.jpg: the file is truncated");
    ck_assert_ptr_nonnull(strstr(f->err.msg, "7 faults"));
    /* without a listener the call itself names the first */
    ck_assert_int_eq(sg_dataset_open(f->t.path, &o, f->arena, NULL, NULL, &f->d, &f->err), SG_EINPUT);
    ck_assert_ptr_nonnull(strstr(f->err.msg, "label 200"));
    ck_assert_ptr_nonnull(strstr(f->err.msg, "and 6 more faults"));
    finish(f);
}
END_TEST

START_TEST(unknown_labels_are_counted_and_placed)
{
    fixture *f = make();
    sg_dataset_opts o = SG_DATASET_OPTS_INIT;
    uint32_t colors[256] = {0};
    sg_label_map m;
    add_image(f, "images/a.jpg", 10, 10);
    ck_assert_int_eq(sg_label_map_create(10, 10, &m, NULL), SG_OK);
    m.labels[34] = m.labels[57] = m.labels[58] = 7;
    m.labels[99] = 1;
    ck_assert_int_eq(sg_png_write_labels(temp_path(&f->t, "labels/a.png"), &m, colors, 256, NULL), SG_OK);
    EXPECT_FAULTS(f, &o, "label 1 is not in the class table (1 pixel, the first at column 9, row 9)",
                  "label 7 is not in the class table (3 pixels, the first at column 4, row 3)");
    for (size_t i = 0; i < 100; i++)
        m.labels[i] = (uint8_t)(100 + i);
    ck_assert_int_eq(sg_png_write_labels(temp_path(&f->t, "labels/a.png"), &m, colors, 256, NULL), SG_OK);
    EXPECT_FAULTS(f, &o, "label 100", "label 101", "label 102", "label 103", "label 104", "95 more labels");
    memset(m.labels, 9, 100);
    ck_assert_int_eq(sg_png_write_labels(temp_path(&f->t, "labels/a.png"), &m, colors, 256, NULL), SG_OK);
    EXPECT_FAULTS(f, &o, "a.png: every pixel is ignored");
    sg_label_map_clear(&m);
    finish(f);
}
END_TEST

START_TEST(all_faults_of_lists_are_told_at_once)
{
    fixture *f = make();
    sg_dataset_opts o = SG_DATASET_OPTS_INIT;
    temp_text(&f->t, "folds/1.tsv",
              "a\ttrain\nb\ttraining\na\ttest\nz\ttrain\n../x\ttrain\nq/r\ttest\n..\ttrain\nc\ne\ttrain\tx\nd\ttrain\n");
    temp_text(&f->t, "classes.tsv", "0\tone\n");
    o.fold = 1;
    EXPECT_FAULTS(f, &o, "classes.tsv:1:1: error: fewer", "1.tsv:2:3: error: an unknown part",
                  "1.tsv:3:1: error: a name that stands in line 1 already: 'a'", "1.tsv:5:1: error: a name with a slash",
                  "1.tsv:6:1: error: a name with a slash", "1.tsv:7:1: error: a name with two dots",
                  "1.tsv:8:1: error: a line that is not", "1.tsv:9:1: error: a line that is not",
                  "labels/z.png: No such file");
    temp_text(&f->t, "names.txt", "a\nb\ttrain\na\n");
    o.fold = 0;
    o.names_file = temp_path(&f->t, "names.txt");
    EXPECT_FAULTS(f, &o, "classes.tsv:1:1", "names.txt:2:1: error: more than a name", "names.txt:3:1");
    finish(f);
}
END_TEST

START_TEST(empty_and_missing_sets_are_faults)
{
    fixture *f = make();
    sg_dataset_opts o = SG_DATASET_OPTS_INIT;
    o.fold = 9;
    EXPECT_FAULTS(f, &o, "folds/9.tsv: No such file");
    temp_text(&f->t, "folds/9.tsv", "# nothing\n");
    EXPECT_FAULTS(f, &o, "folds/9.tsv: no name in it");
    temp_text(&f->t, "folds/9.tsv", "a\ttest\n");
    EXPECT_FAULTS(f, &o, "folds/9.tsv: no name in it");
    o.fold = 0;
    o.classes_file = temp_path(&f->t, "none.tsv");
    EXPECT_FAULTS(f, &o, "none.tsv: No such file");
    temp_text(&f->t, "none.tsv", "0\tignore\t#000000\n");
    EXPECT_FAULTS(f, &o, "none.tsv: no classes");
    o.classes_file = NULL;
    for (const char *p = "abcde"; *p != '\0'; p++) {
        char file[32];
        snprintf(file, sizeof file, "labels/%c.png", *p);
        unlink(temp_path(&f->t, file));
    }
    EXPECT_FAULTS(f, &o, "labels: no label map");
    rmdir(temp_path(&f->t, "labels"));
    EXPECT_FAULTS(f, &o, "labels: No such file");
    sg_dataset d;
    ck_assert_int_eq(sg_dataset_open("/no/such/set", &o, f->arena, take_fault, f, &d, &f->err), SG_EINPUT);
    ck_assert_ptr_nonnull(strstr(f->err.msg, "/no/such/set"));
    finish(f);
}
END_TEST

/* The published sets, where they are at hand: all their folds open without a fault. */
static const struct {
    const char *folder, *classes;
    int nfolds;
    size_t nmaps, nclasses;
} published[] = {{"ecp", NULL, 5, 104, 8}, {"ecp", "classes7.tsv", 5, 104, 7}, {"cmp120", NULL, 4, 120, 12}};

START_TEST(published_sets_open)
{
    fixture *f = calloc(1, sizeof *f);
    char folder[512], classes[600];
    sg_dataset_opts o = SG_DATASET_OPTS_INIT;
    snprintf(folder, sizeof folder, "%s/data/%s", test_folder("SG_SHARED_DIR"), published[_i].folder);
    if (!sg_folder_exists(folder)) {
        printf("skipped: %s is not there\n", folder);
        free(f);
        return;
    }
    if (published[_i].classes != NULL) {
        snprintf(classes, sizeof classes, "%s/%s", folder, published[_i].classes);
        o.classes_file = classes;
    }
    f->arena = sg_arena_create();
    for (o.fold = 1; o.fold <= published[_i].nfolds; o.fold++) {
        /* every map once, photographs too; then the folds' own lists only name the same maps again */
        o.part = o.fold == 1 ? SG_SPLIT_ALL : SG_SPLIT_VALID;
        o.need_images = o.fold == 1 && o.classes_file == NULL;
        const sg_status st = sg_dataset_open(folder, &o, f->arena, take_fault, f, &f->d, &f->err);
        ck_assert_msg(st == SG_OK, "%s: %s", f->err.msg, f->faults[0]);
        if (o.fold == 1)
            ck_assert_uint_eq(f->d.nitems, published[_i].nmaps);
        ck_assert_uint_eq(f->d.classes.nclasses, published[_i].nclasses);
        sg_dataset_close(&f->d);
    }
    sg_arena_free(f->arena);
    free(f);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("dataset");
    TCase *tc = tcase_create("dataset");
    tcase_set_timeout(tc, 120);
    tcase_add_test(tc, maps_come_in_the_order_that_is_asked_for);
    tcase_add_test(tc, labels_become_classes);
    tcase_add_test(tc, one_pixel_and_labels_alone_are_enough);
    tcase_add_test(tc, all_faults_of_files_are_told_at_once);
    tcase_add_test(tc, unknown_labels_are_counted_and_placed);
    tcase_add_test(tc, all_faults_of_lists_are_told_at_once);
    tcase_add_test(tc, empty_and_missing_sets_are_faults);
    tcase_add_loop_test(tc, published_sets_open, 0, sizeof published / sizeof published[0]);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
