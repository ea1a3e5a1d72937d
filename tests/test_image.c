/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_image.c - pictures, label maps as PNG, class tables. */
#include "config.h"

#include "image/classes.h"
#include "image/image.h"
#include "image/png_io.h"
#include "tests/png_make.h"
#include "tests/support.h"
#include "tests/temp_folder.h"

#include <stdbool.h>
#include <string.h>

/* The value of a pixel in every made-up map below: any function that is not symmetric in x and y. */
static uint8_t value_at(size_t x, size_t y, unsigned modulus)
{
    return (uint8_t)((3 * x + 5 * y + x * y / 2) % modulus);
}

START_TEST(sizes_are_checked)
{
    sg_error err = SG_ERROR_INIT;
    sg_image im;
    sg_label_map m;
    ck_assert_int_eq(sg_image_create(0, 3, &im, &err), SG_EINVAL);
    ck_assert_int_eq(sg_image_create(3, 0, &im, &err), SG_EINVAL);
    ck_assert_int_eq(sg_label_map_create(SG_IMAGE_MAX_SIDE + 1, 1, &m, &err), SG_EINVAL);
    ck_assert_int_eq(sg_label_map_create(SG_IMAGE_MAX_SIDE, SG_IMAGE_MAX_SIDE, &m, &err), SG_EINVAL);
    ck_ok(sg_label_map_create(3, 2, &m, &err));
    for (int i = 0; i < 6; i++)
        ck_assert_uint_eq(m.labels[i], 0);
    ck_ok(sg_image_create(3, 2, &im, &err));
    sg_image_set(&im, 2, 1, 0x123456);
    ck_assert_uint_eq(im.rgb[15], 0x12);
    ck_assert_uint_eq(im.rgb[17], 0x56);
    sg_image_clear(&im);
    sg_image_clear(&im);
    sg_label_map_clear(&m);
    sg_label_map_clear(&m);
}
END_TEST

/* ---- PNG: what is written comes back ---- */

static const size_t sizes[][2] = {{1, 1}, {1, 7}, {9, 1}, {8, 8}, {31, 17}, {300, 5}};

START_TEST(label_maps_come_back)
{
    const temp_folder t = temp_folder_make();
    sg_error err = SG_ERROR_INIT;
    sg_label_map m, back;
    uint32_t colors[256];
    for (uint32_t i = 0; i < 256; i++)
        colors[i] = i * 0x010305;
    ck_ok(sg_label_map_create(sizes[_i][0], sizes[_i][1], &m, &err));
    for (size_t y = 0; y < m.height; y++)
        for (size_t x = 0; x < m.width; x++)
            m.labels[y * m.width + x] = value_at(x, y, 256);
    ck_ok(sg_png_write_labels(temp_path(&t, "m.png"), &m, colors, 256, &err));
    ck_ok(sg_png_read_labels(temp_path(&t, "m.png"), &back, &err));
    ck_assert_uint_eq(back.width, m.width);
    ck_assert_uint_eq(back.height, m.height);
    ck_assert_mem_eq(back.labels, m.labels, m.width * m.height);
    sg_image im;
    ck_ok(sg_png_read_rgb(temp_path(&t, "m.png"), &im, &err));
    for (size_t i = 0; i < m.width * m.height; i++)
        ck_assert_uint_eq(im.rgb[3 * i + 1], colors[m.labels[i]] >> 8 & 255);
    sg_image_clear(&im);
    sg_label_map_clear(&m);
    sg_label_map_clear(&back);
    temp_folder_remove(&t);
}
END_TEST

START_TEST(pictures_come_back)
{
    const temp_folder t = temp_folder_make();
    sg_error err = SG_ERROR_INIT;
    sg_image im, back;
    ck_ok(sg_image_create(sizes[_i][0], sizes[_i][1], &im, &err));
    for (size_t i = 0; i < 3 * im.width * im.height; i++)
        im.rgb[i] = (uint8_t)(i * 37);
    ck_ok(sg_png_write_rgb(temp_path(&t, "i.png"), &im, &err));
    ck_ok(sg_png_read_rgb(temp_path(&t, "i.png"), &back, &err));
    ck_assert_mem_eq(back.rgb, im.rgb, 3 * im.width * im.height);
    size_t w, h;
    ck_ok(sg_png_read_size(temp_path(&t, "i.png"), &w, &h, &err));
    ck_assert(w == im.width && h == im.height);
    sg_image_clear(&im);
    sg_image_clear(&back);
    temp_folder_remove(&t);
}
END_TEST

/* 1, 2, 4 and 8 bits, grey and palette, interlaced or not: the value of a pixel stays what it is. */
START_TEST(small_depths_keep_their_values)
{
    enum { W = 13, H = 9 };
    const int bits = 1 << (_i & 3), interlace = (_i >> 2) & 1;
    const int type = (_i >> 3) != 0 ? PNG_COLOR_TYPE_PALETTE : PNG_COLOR_TYPE_GRAY;
    const unsigned modulus = 1u << bits;
    unsigned char rows[H][W] = {{0}};
    for (size_t y = 0; y < H; y++)
        for (size_t x = 0; x < W; x++) {
            const size_t bit = x * (size_t)bits;
            rows[y][bit / 8] |= (unsigned char)(value_at(x, y, modulus) << (8 - bits - (int)(bit % 8)));
        }
    const temp_folder t = temp_folder_make();
    sg_error err = SG_ERROR_INIT;
    sg_label_map m;
    png_make(temp_path(&t, "m.png"), W, H, bits, type, interlace, rows[0], W);
    ck_ok(sg_png_read_labels(temp_path(&t, "m.png"), &m, &err));
    for (size_t y = 0; y < H; y++)
        for (size_t x = 0; x < W; x++)
            ck_assert_uint_eq(m.labels[y * W + x], value_at(x, y, modulus));
    sg_label_map_clear(&m);
    temp_folder_remove(&t);
}
END_TEST

START_TEST(any_png_becomes_rgb)
{
    const temp_folder t = temp_folder_make();
    sg_error err = SG_ERROR_INIT;
    sg_image im;
    const unsigned char rgba[2][8] = {{10, 20, 30, 255, 10, 20, 30, 0}, {0, 0, 0, 128, 255, 255, 255, 7}};
    png_make(temp_path(&t, "a.png"), 2, 2, 8, PNG_COLOR_TYPE_RGB_ALPHA, _i, rgba[0], 8);
    ck_ok(sg_png_read_rgb(temp_path(&t, "a.png"), &im, &err));
    const unsigned char want[12] = {10, 20, 30, 255, 255, 255, 127, 127, 127, 255, 255, 255};
    ck_assert_mem_eq(im.rgb, want, 12);
    sg_image_clear(&im);
    const unsigned char deep[1][6] = {{0xff, 0xff, 0x80, 0x80, 0, 0}};
    png_make(temp_path(&t, "d.png"), 1, 1, 16, PNG_COLOR_TYPE_RGB, _i, deep[0], 6);
    ck_ok(sg_png_read_rgb(temp_path(&t, "d.png"), &im, &err));
    ck_assert_mem_eq(im.rgb, ((unsigned char[]){0xff, 0x80, 0}), 3);
    sg_image_clear(&im);
    const unsigned char grey[1][1] = {{0x40}}; /* one pixel of 2 bits: value 1 of 3 */
    png_make(temp_path(&t, "g.png"), 1, 1, 2, PNG_COLOR_TYPE_GRAY, _i, grey[0], 1);
    ck_ok(sg_png_read_rgb(temp_path(&t, "g.png"), &im, &err));
    ck_assert_mem_eq(im.rgb, ((unsigned char[]){85, 85, 85}), 3);
    sg_image_clear(&im);
    temp_folder_remove(&t);
}
END_TEST

/* ---- PNG: bad files ---- */

static void refuse_labels(const temp_folder *t, const char *name, const char *word)
{
    sg_error err = SG_ERROR_INIT;
    sg_label_map m = {0, 0, NULL};
    ck_assert_int_eq(sg_png_read_labels(temp_path(t, name), &m, &err), SG_EINPUT);
    ck_assert_msg(strstr(err.msg, word) != NULL && strstr(err.msg, name) != NULL, "'%s' lacks '%s' or '%s'", err.msg,
                  word, name);
    ck_assert_ptr_null(m.labels);
}

START_TEST(label_maps_of_other_formats_are_refused_by_name)
{
    const temp_folder t = temp_folder_make();
    const unsigned char row[8] = {0};
    png_make(temp_path(&t, "deep.png"), 1, 1, 16, PNG_COLOR_TYPE_GRAY, 0, row, 8);
    png_make(temp_path(&t, "rgb.png"), 1, 1, 8, PNG_COLOR_TYPE_RGB, 0, row, 8);
    png_make(temp_path(&t, "rgba.png"), 1, 1, 8, PNG_COLOR_TYPE_RGB_ALPHA, 0, row, 8);
    png_make(temp_path(&t, "ga.png"), 1, 1, 8, PNG_COLOR_TYPE_GRAY_ALPHA, 0, row, 8);
    refuse_labels(&t, "deep.png", "16 bits");
    refuse_labels(&t, "rgb.png", "RGB");
    refuse_labels(&t, "rgba.png", "alpha");
    refuse_labels(&t, "ga.png", "alpha");
    refuse_labels(&t, "none.png", "No such file");
    temp_mkdir(&t, "dir.png");
    refuse_labels(&t, "dir.png", "directory");
    temp_text(&t, "text.png", "this is no picture at all, but long enough for a header\n");
    refuse_labels(&t, "text.png", "no PNG");
    temp_text(&t, "empty.png", "");
    refuse_labels(&t, "empty.png", "empty");
    temp_folder_remove(&t);
}
END_TEST

/* A 20 x 11 map of four values, as bytes of a PNG. */
static unsigned char *small_file(const temp_folder *t, int interlace, size_t *n)
{
    enum { W = 20, H = 11 };
    unsigned char rows[H][W];
    for (size_t y = 0; y < H; y++)
        for (size_t x = 0; x < W; x++)
            rows[y][x] = value_at(x, y, 4);
    png_make(temp_path(t, "small.png"), W, H, 8, PNG_COLOR_TYPE_PALETTE, interlace, rows[0], W);
    return temp_read(t, "small.png", n);
}

START_TEST(every_prefix_of_a_file_is_refused)
{
    const temp_folder t = temp_folder_make();
    size_t n;
    unsigned char *bytes = small_file(&t, _i, &n);
    for (size_t k = 0; k < n; k++) {
        temp_write(&t, "part.png", bytes, k);
        refuse_labels(&t, "part.png", k == 0 ? "empty" : "truncated");
        sg_error err = SG_ERROR_INIT;
        sg_image im = {0, 0, NULL};
        ck_assert_int_eq(sg_png_read_rgb(temp_path(&t, "part.png"), &im, &err), SG_EINPUT);
    }
    free(bytes);
    temp_folder_remove(&t);
}
END_TEST

/* Each byte changed in turn: refused, or (the signature aside, a CRC guards all) never read as something else. */
START_TEST(every_changed_byte_is_refused)
{
    const temp_folder t = temp_folder_make();
    size_t n;
    unsigned char *bytes = small_file(&t, 0, &n);
    for (size_t k = 0; k < n; k++) {
        bytes[k] ^= (unsigned char)(1 + k % 255);
        temp_write(&t, "bad.png", bytes, n);
        refuse_labels(&t, "bad.png", ": ");
        bytes[k] ^= (unsigned char)(1 + k % 255);
    }
    free(bytes);
    temp_folder_remove(&t);
}
END_TEST

START_TEST(oversized_headers_are_refused_before_decoding)
{
    const temp_folder t = temp_folder_make();
    size_t n;
    unsigned char *bytes = small_file(&t, 0, &n);
    const struct {
        unsigned char side[8];
        const char *word;
    } cases[] = {{{0, 0, 0x80, 1, 0, 0, 0, 1}, "32769"},
                 {{0, 0, 0x80, 0, 0, 0, 0x80, 0}, "too many"},
                 {{0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff}, "too many"},
                 {{0, 0, 0, 0, 0, 0, 0, 1}, "holds nothing"}};
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        memcpy(bytes + 16, cases[k].side, 8);
        temp_write(&t, "big.png", bytes, n);
        refuse_labels(&t, "big.png", cases[k].word);
        sg_error err = SG_ERROR_INIT;
        size_t w = 77, h = 77;
        ck_assert_int_eq(sg_png_read_size(temp_path(&t, "big.png"), &w, &h, &err), SG_EINPUT);
        ck_assert(w == 77 && h == 77);
    }
    free(bytes);
    temp_folder_remove(&t);
}
END_TEST

START_TEST(writing_failures_are_named)
{
    sg_error err = SG_ERROR_INIT;
    const uint32_t colors[2] = {0, 0xffffff};
    sg_label_map m;
    ck_ok(sg_label_map_create(200, 200, &m, &err));
    ck_assert_int_eq(sg_png_write_labels("/dev/full", &m, colors, 2, &err), SG_EIO);
    ck_assert_ptr_nonnull(strstr(err.msg, "/dev/full: No space"));
    ck_assert_int_eq(sg_png_write_labels("/no/such/folder/x.png", &m, colors, 2, &err), SG_EIO);
    m.labels[7] = 2;
    ck_assert_int_eq(sg_png_write_labels("/dev/null", &m, colors, 2, &err), SG_EINVAL);
    ck_assert_int_eq(sg_png_write_labels("/dev/null", &m, colors, 0, &err), SG_EINVAL);
    ck_assert_int_eq(sg_png_write_labels("/dev/null", &m, colors, 257, &err), SG_EINVAL);
    sg_label_map_clear(&m);
    sg_image im;
    ck_ok(sg_image_create(300, 300, &im, &err));
    for (size_t i = 0; i < 270000; i++)
        im.rgb[i] = (uint8_t)(i * i >> 7); /* noise: more than one stdio buffer */
    ck_assert_int_eq(sg_png_write_rgb("/dev/full", &im, &err), SG_EIO);
    ck_assert_ptr_nonnull(strstr(err.msg, "/dev/full: No space"));
    sg_image_clear(&im);
}
END_TEST

/* ---- class tables ---- */

START_TEST(classes_are_numbered_by_first_index)
{
    const temp_folder t = temp_folder_make();
    sg_error err = SG_ERROR_INIT;
    sg_classes c;
    /* Windows line ends, a byte order mark, a comment, a blank line, no last line end, lines out of order */
    temp_text(&t, "c.tsv",
              "\xef\xbb\xbf# index\tname\tcolour\r\n\r\n7\tdoor\t#0000FF\r\n3\twall\t#102030\r\n"
              "5\tignore\t#000000\r\n4\tdoor\t#00ff00\r\n200\tsky\t#abcdef");
    ck_ok(sg_classes_read(temp_path(&t, "c.tsv"), &c, &err));
    ck_assert_uint_eq(c.nclasses, 3);
    ck_assert_str_eq(c.names[0], "wall");
    ck_assert_str_eq(c.names[1], "door");
    ck_assert_str_eq(c.names[2], "sky");
    ck_assert_uint_eq(c.first_index[1], 4);
    ck_assert_uint_eq(c.colors[1], 0x00ff00);
    ck_assert_uint_eq(c.class_of[7], 1);
    ck_assert_uint_eq(c.index_colors[7], 0x0000ff);
    ck_assert_uint_eq(c.class_of[5], SG_CLASS_IGNORE);
    ck_assert_uint_eq(c.class_of[0], SG_CLASS_UNKNOWN);
    ck_assert_int_eq(sg_classes_find(&c, "sky"), 2);
    ck_assert_int_eq(sg_classes_find(&c, "ignore"), -1);
    ck_ok(sg_classes_write(temp_path(&t, "d.tsv"), &c, &err));
    sg_classes d;
    ck_ok(sg_classes_read(temp_path(&t, "d.tsv"), &d, &err));
    ck_assert_uint_eq(d.nclasses, c.nclasses);
    ck_assert_mem_eq(d.class_of, c.class_of, 256);
    ck_assert_mem_eq(d.index_colors, c.index_colors, sizeof c.index_colors);
    ck_assert_mem_eq(d.first_index, c.first_index, c.nclasses);
    sg_classes_clear(&d);
    sg_classes_clear(&c);
    sg_classes_clear(&c);
    ck_assert_int_eq(sg_classes_write("/dev/full", &c, &err), SG_EIO);
    temp_folder_remove(&t);
}
END_TEST

static const struct {
    const char *text, *message;
} bad_tables[] = {
    {"0\twall\t#ffffff\n0\tdoor\t#000000\n", "c.tsv:2:1: error: index 0 stands twice"},
    {"0\twall\n", "c.tsv:1:1: error: fewer than three fields"},
    {"\n0\twall\t#ffffff\t9\n", "c.tsv:2:1: error: more than three fields"},
    {"256\twall\t#ffffff\n", "c.tsv:1:1: error: '256' is no pixel index"},
    {"-1\twall\t#ffffff\n", "'-1' is no pixel index"},
    {"1x\twall\t#ffffff\n", "'1x' is no pixel index"},
    {"\twall\t#ffffff\n", "'' is no pixel index"},
    {"1\t\t#ffffff\n", "c.tsv:1:3: error: '' is no class name"},
    {"1\ta wall\t#ffffff\n", "'a wall' is no class name"},
    {"1\twall\t#fffff\n", "c.tsv:1:8: error: '#fffff' is no colour"},
    {"1\twall\tffffff\n", "'ffffff' is no colour"},
    {"1\twall\t#ffffgf\n", "'#ffffgf' is no colour"},
    {"", "c.tsv: no classes"},
    {"# nothing\n", "c.tsv: no classes"},
    {"9\tignore\t#000000\n", "c.tsv: no classes"},
};

START_TEST(bad_class_tables_are_refused_with_their_line)
{
    const temp_folder t = temp_folder_make();
    sg_error err = SG_ERROR_INIT;
    sg_classes c;
    temp_text(&t, "c.tsv", bad_tables[_i].text);
    ck_assert_int_eq(sg_classes_read(temp_path(&t, "c.tsv"), &c, &err), SG_EINPUT);
    ck_assert_msg(strstr(err.msg, bad_tables[_i].message) != NULL, "%s", err.msg);
    temp_folder_remove(&t);
}
END_TEST

START_TEST(class_tables_of_other_kinds_are_refused)
{
    const temp_folder t = temp_folder_make();
    sg_error err = SG_ERROR_INIT;
    sg_classes c;
    ck_assert_int_eq(sg_classes_read(temp_path(&t, "none.tsv"), &c, &err), SG_EINPUT);
    temp_write(&t, "c.tsv", "0\twall\t#ffffff\n\0", 16);
    ck_assert_int_eq(sg_classes_read(temp_path(&t, "c.tsv"), &c, &err), SG_EINPUT);
    ck_assert_ptr_nonnull(strstr(err.msg, "NUL"));
    FILE *fp = fopen(temp_path(&t, "many.tsv"), "w");
    for (int i = 0; i < 251; i++)
        fprintf(fp, "%d\tc%d\t#000000\n", i, i);
    fclose(fp);
    ck_assert_int_eq(sg_classes_read(temp_path(&t, "many.tsv"), &c, &err), SG_EINPUT);
    ck_assert_ptr_nonnull(strstr(err.msg, "250"));
    temp_folder_remove(&t);
}
END_TEST

START_TEST(classes_can_be_made)
{
    sg_error err = SG_ERROR_INIT;
    sg_classes c;
    const char *names[4] = {"a", "ignore", "b", "a"};
    const uint32_t colors[4] = {1, 2, 3, 4};
    ck_ok(sg_classes_create(4, names, colors, &c, &err));
    ck_assert_uint_eq(c.nclasses, 2);
    ck_assert_uint_eq(c.class_of[3], 0);
    ck_assert_uint_eq(c.class_of[1], SG_CLASS_IGNORE);
    ck_assert_uint_eq(c.colors[1], 3);
    sg_classes_clear(&c);
    ck_assert_int_eq(sg_classes_create(0, names, colors, &c, &err), SG_EINVAL);
    ck_assert_int_eq(sg_classes_create(1, names + 1, colors, &c, &err), SG_EINVAL);
    names[2] = "b c";
    ck_assert_int_eq(sg_classes_create(4, names, colors, &c, &err), SG_EINVAL);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("image");
    TCase *tc = tcase_create("image");
    tcase_set_timeout(tc, 60);
    const int nsizes = sizeof sizes / sizeof sizes[0];
    tcase_add_test(tc, sizes_are_checked);
    tcase_add_loop_test(tc, label_maps_come_back, 0, nsizes);
    tcase_add_loop_test(tc, pictures_come_back, 0, nsizes);
    tcase_add_loop_test(tc, small_depths_keep_their_values, 0, 16);
    tcase_add_loop_test(tc, any_png_becomes_rgb, 0, 2);
    tcase_add_test(tc, label_maps_of_other_formats_are_refused_by_name);
    tcase_add_loop_test(tc, every_prefix_of_a_file_is_refused, 0, 2);
    tcase_add_test(tc, every_changed_byte_is_refused);
    tcase_add_test(tc, oversized_headers_are_refused_before_decoding);
    tcase_add_test(tc, writing_failures_are_named);
    tcase_add_test(tc, classes_are_numbered_by_first_index);
    tcase_add_loop_test(tc, bad_class_tables_are_refused_with_their_line, 0, sizeof bad_tables / sizeof bad_tables[0]);
    tcase_add_test(tc, class_tables_of_other_kinds_are_refused);
    tcase_add_test(tc, classes_can_be_made);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
