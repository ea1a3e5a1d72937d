/* SPDX-License-Identifier: GPL-3.0-or-later */
/* classifier_support.h - a small annotated data set for tests of the pixel classifier, made in a folder of the test. Include
 * config.h first. */
#ifndef SG_TESTS_CLASSIFIER_SUPPORT_H
#define SG_TESTS_CLASSIFIER_SUPPORT_H

#include "core/random.h"
#include "image/png_io.h"
#include "parse/dataset.h"
#include "tests/support.h"
#include "tests/temp_folder.h"

enum { TEST_PHOTOS = 5, TEST_WIDTH = 40, TEST_HEIGHT = 30 };

/* The colour of a pixel says where it is: red its column, green its row, blue its photograph; unless `noisy`: then the colour
 * tells its class, but not always. Classes: sky above, wall, some windows, a door in photograph 3 only; a band is ignored. */
static inline uint8_t test_index_at(size_t photo, size_t x, size_t y)
{
    if (y < 6)
        return 0; /* sky */
    if (y >= 28)
        return 4; /* ignored */
    if (photo == 3 && x < 2 && y >= 24)
        return 3; /* door */
    return x % 10 < 4 && y % 8 < 4 ? 2 : 1; /* window, wall */
}

static inline void test_write_photo(const temp_folder *t, size_t photo, bool noisy, gsl_rng *rng)
{
    static const uint32_t colors[5] = {0x80ffff, 0xffff00, 0xff0000, 0xff8000, 0};
    sg_error err = SG_ERROR_INIT;
    sg_image im;
    sg_label_map map;
    char name[64];
    ck_ok(sg_image_create(TEST_WIDTH, TEST_HEIGHT, &im, &err));
    ck_ok(sg_label_map_create(TEST_WIDTH, TEST_HEIGHT, &map, &err));
    for (size_t y = 0; y < TEST_HEIGHT; y++)
        for (size_t x = 0; x < TEST_WIDTH; x++) {
            const uint8_t label = test_index_at(photo, x, y);
            const uint32_t at = (uint32_t)(x << 16 | y << 8 | photo);
            const uint32_t told = label * 40u + (uint32_t)gsl_rng_uniform_int(rng, 90);
            map.labels[y * TEST_WIDTH + x] = label;
            sg_image_set(&im, x, y, noisy ? told << 16 | (uint32_t)gsl_rng_uniform_int(rng, 256) << 8 : at);
        }
    snprintf(name, sizeof name, "set/images/p%zu.png", photo);
    ck_ok(sg_png_write_rgb(temp_path(t, name), &im, &err));
    snprintf(name, sizeof name, "set/labels/p%zu.png", photo);
    ck_ok(sg_png_write_labels(temp_path(t, name), &map, colors, 5, &err));
    sg_image_clear(&im);
    sg_label_map_clear(&map);
}

/* Fold 1: photographs 0, 1, 3 train, 2 valid, 4 test. */
static inline void test_write_set(const temp_folder *t, bool noisy)
{
    gsl_rng *rng = sg_random_create(5);
    temp_mkdir(t, "set");
    temp_mkdir(t, "set/images");
    temp_mkdir(t, "set/labels");
    temp_mkdir(t, "set/folds");
    temp_text(t, "set/classes.tsv",
              "0\tsky\t#80ffff\n1\twall\t#ffff00\n2\twindow\t#ff0000\n3\tdoor\t#ff8000\n4\tignore\t#000000\n7\tmoat\t#0000ff\n");
    temp_text(t, "set/folds/1.tsv", "p0\ttrain\np1\ttrain\np3\ttrain\np2\tvalid\np4\ttest\n");
    for (size_t i = 0; i < TEST_PHOTOS; i++)
        test_write_photo(t, i, noisy, rng);
    gsl_rng_free(rng);
}

static inline sg_dataset test_open_set(const temp_folder *t, sg_dataset_part part, sg_arena *arena)
{
    sg_error err = SG_ERROR_INIT;
    sg_dataset_opts o = SG_DATASET_OPTS_INIT;
    sg_dataset d;
    o.fold = 1;
    o.part = part;
    o.need_images = true;
    ck_ok(sg_dataset_open(temp_path(t, "set"), &o, arena, NULL, NULL, &d, &err));
    return d;
}

#endif
