/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_image_faults.c - the readers and writers of pictures, tables, data sets and imports when memory runs out at any
 * point, and when their files are changed at random. */
#include "config.h"

#include "data/import.h"
#include "image/classes.h"
#include "image/cv_image.h"
#include "image/npy.h"
#include "image/png_io.h"
#include "parse/dataset.h"
#include "tests/failing_malloc.h"
#include "tests/support.h"
#include "tests/temp_folder.h"

#include "core/random.h"

#include <stdbool.h>
#include <string.h>

static temp_folder t;

/* Check allocates too, so nothing is asserted while an allocation is to fail: what is wrong is a status of no call. */
#define HALF_DONE SG_ENUMERIC

char *__real_strdup(const char *s);
char *__wrap_strdup(const char *s);

char *__wrap_strdup(const char *s)
{
    return test_allocations++ == test_fail_at ? NULL : __real_strdup(s);
}

/* ---- one operation each; what is read is given back, and checked where a result could be half made ---- */

static sg_status read_classes(sg_error *err)
{
    sg_classes c;
    const sg_status st = sg_classes_read(temp_path(&t, "set/classes.tsv"), &c, err);
    if (st == SG_OK)
        sg_classes_clear(&c);
    return st;
}

static sg_status make_classes(sg_error *err)
{
    sg_classes c;
    const char *const names[3] = {"a", "b", "a"};
    const uint32_t colors[3] = {0, 1, 2};
    const sg_status st = sg_classes_create(3, names, colors, &c, err);
    if (st == SG_OK)
        sg_classes_clear(&c);
    return st;
}

static sg_status read_labels(sg_error *err)
{
    sg_label_map m = {0, 0, NULL};
    const sg_status st = sg_png_read_labels(temp_path(&t, "set/labels/a.png"), &m, err);
    const bool half = (st == SG_OK) != (m.labels != NULL);
    sg_label_map_clear(&m);
    return half ? HALF_DONE : st;
}

static sg_status read_rgb(sg_error *err)
{
    sg_image im = {0, 0, NULL};
    const sg_status st = sg_photo_read(temp_path(&t, "set/images/b.png"), &im, err);
    const bool half = (st == SG_OK) != (im.rgb != NULL);
    sg_image_clear(&im);
    return half ? HALF_DONE : st;
}

static sg_status read_jpeg(sg_error *err)
{
    sg_image im = {0, 0, NULL};
    const sg_status st = sg_photo_read(temp_path(&t, "set/images/a.jpg"), &im, err);
    const bool half = (st == SG_OK) != (im.rgb != NULL);
    sg_image_clear(&im);
    return half ? HALF_DONE : st;
}

static sg_status read_npy(sg_error *err)
{
    sg_float_map m = {0, 0, 0, NULL};
    const sg_status st = sg_npy_read(temp_path(&t, "m.npy"), &m, err);
    const bool half = (st == SG_OK) != (m.values != NULL);
    sg_float_map_clear(&m);
    return half ? HALF_DONE : st;
}

static sg_status write_pictures(sg_error *err)
{
    sg_image im;
    SG_TRY(sg_image_create(7, 5, &im, err));
    sg_status st = sg_png_write_rgb(temp_path(&t, "w.png"), &im, err);
    if (st == SG_OK)
        st = sg_photo_write_jpeg(temp_path(&t, "w.jpg"), &im, 90, err);
    sg_image_clear(&im);
    return st;
}

static sg_status open_dataset(sg_error *err)
{
    sg_dataset d;
    sg_dataset_opts o = SG_DATASET_OPTS_INIT;
    sg_arena *arena = sg_arena_create();
    if (arena == NULL)
        return SG_FAIL_NOMEM(err);
    o.need_images = true;
    o.fold = 1;
    const sg_status st = sg_dataset_open(temp_path(&t, "set"), &o, arena, NULL, NULL, &d, err);
    if (st == SG_OK)
        sg_dataset_close(&d);
    sg_arena_free(arena);
    return st;
}

static sg_status list_dataset(sg_error *err)
{
    sg_dataset d;
    sg_dataset_opts o = SG_DATASET_OPTS_INIT;
    sg_arena *arena = sg_arena_create();
    if (arena == NULL)
        return SG_FAIL_NOMEM(err);
    const sg_status st = sg_dataset_open(temp_path(&t, "set"), &o, arena, NULL, NULL, &d, err);
    if (st == SG_OK)
        sg_dataset_close(&d);
    sg_arena_free(arena);
    return st;
}

static sg_status import(sg_import_kind kind, const char *source, sg_error *err)
{
    sg_import_opts o = SG_IMPORT_OPTS_INIT;
    sg_import_result result;
    o.kind = kind;
    o.source = temp_path(&t, source);
    o.dataset = temp_path(&t, "out");
    o.classes_file = temp_path(&t, "set/classes.tsv");
    o.tolerance = 442;
    o.background = "one";
    if (kind == SG_IMPORT_RGB)
        o.images = temp_path(&t, "set/images");
    return sg_import_run(&o, NULL, NULL, NULL, &result, err);
}

static sg_status import_rgb(sg_error *err)
{
    return import(SG_IMPORT_RGB, "set/labels", err);
}

static sg_status import_palette(sg_error *err)
{
    return import(SG_IMPORT_PALETTE, "set/labels", err);
}

static sg_status import_matrix(sg_error *err)
{
    return import(SG_IMPORT_MATRIX, "m.txt", err);
}

static sg_status import_digits(sg_error *err)
{
    return import(SG_IMPORT_DIGITS, "d.txt", err);
}

static sg_status import_labelme(sg_error *err)
{
    return import(SG_IMPORT_LABELME, "l.json", err);
}

static sg_status import_unknown(sg_error *err) /* what is not in the table is remembered, which takes memory */
{
    const sg_status st = import(SG_IMPORT_DIGITS, "bad.txt", err);
    return st == SG_EINPUT ? SG_OK : st;
}

typedef struct {
    const char *name;
    sg_status (*run)(sg_error *err);
    const char *file; /* what it reads: changed at random */
} operation;

static const operation operations[] = {
    {"class table", read_classes, "set/classes.tsv"},
    {"classes from memory", make_classes, NULL},
    {"label map", read_labels, "set/labels/a.png"},
    {"PNG photograph", read_rgb, "set/images/b.png"},
    {"JPEG photograph", read_jpeg, "set/images/a.jpg"},
    {"NumPy array", read_npy, "m.npy"},
    {"written pictures", write_pictures, NULL},
    {"data set by fold", open_dataset, "set/folds/1.tsv"},
    {"data set by folder", list_dataset, NULL},
    {"rgb import", import_rgb, "set/labels/b.png"},
    {"palette import", import_palette, "set/labels/a.png"},
    {"matrix import", import_matrix, "m.txt"},
    {"digits import", import_digits, "d.txt"},
    {"LabelMe import", import_labelme, "l.json"},
    {"unknown labels", import_unknown, "bad.txt"},
};
enum { NOPERATIONS = sizeof operations / sizeof operations[0] };

static void make_files(void)
{
    const uint32_t colors[2] = {0xff0000, 0x00ff00};
    sg_label_map m;
    sg_image im;
    sg_float_map v;
    t = temp_folder_make();
    temp_mkdir(&t, "set");
    temp_mkdir(&t, "set/labels");
    temp_mkdir(&t, "set/images");
    temp_mkdir(&t, "set/folds");
    temp_text(&t, "set/classes.tsv", "# index\tname\tcolour\n0\tone\t#ff0000\n1\ttwo\t#00ff00\n2\tignore\t#000000\n");
    temp_text(&t, "set/folds/1.tsv", "a\ttrain\nb\ttrain\nc\ttest\n");
    temp_text(&t, "m.txt", "0 1 1\n1 0 -1\n");
    temp_text(&t, "d.txt", "011\n100\n");
    temp_text(&t, "bad.txt", "0173456789\n");
    temp_text(&t, "l.json", "{\"imageWidth\": 5, \"imageHeight\": 4, \"shapes\": [{\"label\": \"two\", \"points\": [[0, "
                            "0], [3, 0], [2, 3]]}, {\"label\": \"one\", \"shape_type\": \"circle\", \"points\": [[2, 2],"
                            " [3, 2]]}]}");
    ck_assert_int_eq(sg_label_map_create(7, 5, &m, NULL), SG_OK);
    ck_assert_int_eq(sg_image_create(7, 5, &im, NULL), SG_OK);
    ck_assert_int_eq(sg_float_map_create(2, 5, 7, &v, NULL), SG_OK);
    m.labels[11] = 1;
    ck_assert_int_eq(sg_png_write_labels(temp_path(&t, "set/labels/a.png"), &m, colors, 2, NULL), SG_OK);
    ck_assert_int_eq(sg_png_write_labels(temp_path(&t, "set/labels/b.png"), &m, colors, 2, NULL), SG_OK);
    ck_assert_int_eq(sg_photo_write_jpeg(temp_path(&t, "set/images/a.jpg"), &im, 90, NULL), SG_OK);
    ck_assert_int_eq(sg_png_write_rgb(temp_path(&t, "set/images/b.png"), &im, NULL), SG_OK);
    ck_assert_int_eq(sg_npy_write(temp_path(&t, "m.npy"), &v, NULL), SG_OK);
    sg_label_map_clear(&m);
    sg_image_clear(&im);
    sg_float_map_clear(&v);
}

/* Each allocation fails once: the call says so and nothing leaks (AddressSanitizer), or it did without (a piece of
 * memory that could not be made smaller). */
START_TEST(lack_of_memory_is_a_status)
{
    const operation *o = &operations[_i];
    sg_error err = SG_ERROR_INIT;
    make_files();
    ck_assert_msg(o->run(&err) == SG_OK, "%s: %s", o->name, err.msg);
    size_t k = 0, ndone_without = 0;
    for (;; k++) {
        err = (sg_error)SG_ERROR_INIT;
        test_fail_allocation(k);
        const sg_status st = o->run(&err);
        if (!test_allocation_failed())
            break;
        ck_assert_msg(st == SG_ENOMEM || st == SG_OK, "%s: allocation %zu: status %d: %s", o->name, k, (int)st,
                      err.msg);
        ndone_without += st == SG_OK;
        ck_assert_msg(st == SG_OK || strcmp(err.msg, "out of memory") == 0, "%s: %s", o->name, err.msg);
    }
    ck_assert_msg(k >= 1 && ndone_without <= 3, "%s: %zu allocations, %zu not needed", o->name, k, ndone_without);
    temp_folder_remove(&t);
}
END_TEST

/* Change, remove or repeat some bytes. */
static size_t mutate(gsl_rng *r, unsigned char *bytes, size_t n)
{
    const unsigned long nchanges = 1 + gsl_rng_uniform_int(r, 4);
    for (unsigned long i = 0; i < nchanges && n > 1; i++) {
        const size_t at = gsl_rng_uniform_int(r, n), length = 1 + gsl_rng_uniform_int(r, n - at);
        switch (gsl_rng_uniform_int(r, 4)) {
        case 0:
            bytes[at] = (unsigned char)gsl_rng_uniform_int(r, 256);
            break;
        case 1:
            bytes[at] = (unsigned char)"\t\n \"#-.,0179[]{}"[gsl_rng_uniform_int(r, 16)];
            break;
        case 2: /* a piece goes */
            memmove(bytes + at, bytes + at + length, n - at - length);
            n -= length < n ? length : n - 1;
            break;
        default: /* a piece stands somewhere else too */
            memmove(bytes + gsl_rng_uniform_int(r, n - length + 1), bytes + at, length);
        }
    }
    return n;
}

/* Whatever a file holds, its reader answers with SG_OK or SG_EINPUT and a sentence. */
START_TEST(changed_files_do_no_harm)
{
    const operation *o = &operations[_i];
    if (o->file == NULL)
        return;
    size_t n;
    make_files();
    ck_assert_ptr_nonnull(freopen("/dev/null", "w", stderr)); /* the JPEG library's own remarks */
    gsl_rng *r = sg_random_create((uint64_t)_i + 1);
    unsigned char *good = temp_read(&t, o->file, &n), *bytes = malloc(n);
    for (int round = 0; round < 300; round++) {
        memcpy(bytes, good, n);
        temp_write(&t, o->file, bytes, mutate(r, bytes, n));
        sg_error err = SG_ERROR_INIT;
        const sg_status st = o->run(&err);
        ck_assert_msg(st == SG_OK || (st == SG_EINPUT && err.msg[0] != '\0'), "%s, round %d: status %d: %s", o->name,
                      round, (int)st, err.msg);
    }
    free(good);
    free(bytes);
    gsl_rng_free(r);
    temp_folder_remove(&t);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("image_faults");
    TCase *tc = tcase_create("image_faults");
    tcase_set_timeout(tc, 120);
    tcase_add_loop_test(tc, lack_of_memory_is_a_status, 0, NOPERATIONS);
    tcase_add_loop_test(tc, changed_files_do_no_harm, 0, NOPERATIONS);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
