/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_photo.c - photographs, polygons and NumPy arrays. */
#include "config.h"

#include "image/cv_image.h"
#include "image/npy.h"
#include "image/png_io.h"
#include "tests/support.h"
#include "tests/temp_folder.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

/* A smooth picture, which JPEG keeps well. */
static sg_image smooth(size_t width, size_t height)
{
    sg_image im;
    ck_assert_int_eq(sg_image_create(width, height, &im, NULL), SG_OK);
    for (size_t y = 0; y < height; y++)
        for (size_t x = 0; x < width; x++)
            sg_image_set(&im, x, y, (uint32_t)(x * 255 / width) << 16 | (uint32_t)(y * 255 / height) << 8 | 60u);
    return im;
}

static double worst_difference(const sg_image *a, const sg_image *b)
{
    double worst = 0;
    ck_assert(a->width == b->width && a->height == b->height);
    for (size_t i = 0; i < 3 * a->width * a->height; i++)
        worst = fmax(worst, fabs((double)a->rgb[i] - (double)b->rgb[i]));
    return worst;
}

START_TEST(photographs_come_back_nearly)
{
    const temp_folder t = temp_folder_make();
    sg_error err = SG_ERROR_INIT;
    sg_image im = smooth(97, 61), back;
    ck_ok(sg_photo_write_jpeg(temp_path(&t, "p.jpg"), &im, 95, &err));
    ck_ok(sg_photo_read(temp_path(&t, "p.jpg"), &back, &err));
    ck_assert_double_lt(worst_difference(&im, &back), 16);
    size_t w, h;
    ck_ok(sg_photo_read_size(temp_path(&t, "p.jpg"), &w, &h, &err));
    ck_assert(w == 97 && h == 61);
    sg_image_clear(&back);
    ck_ok(sg_png_write_rgb(temp_path(&t, "p.png"), &im, &err)); /* exactly, as PNG */
    ck_ok(sg_photo_read(temp_path(&t, "p.png"), &back, &err));
    ck_assert_double_eq(worst_difference(&im, &back), 0);
    ck_ok(sg_photo_read_size(temp_path(&t, "p.png"), &w, &h, &err));
    ck_assert(w == 97 && h == 61);
    sg_image_clear(&back);
    ck_assert_int_eq(sg_photo_write_jpeg("/dev/full", &im, 95, &err), SG_EIO);
    ck_assert_int_eq(sg_photo_write_jpeg("/no/folder/p.jpg", &im, 95, &err), SG_EIO);
    ck_assert_int_eq(sg_photo_write_jpeg("/dev/null", &im, 101, &err), SG_EINVAL);
    sg_image_clear(&im);
    temp_folder_remove(&t);
}
END_TEST

static void refuse(const temp_folder *t, const char *name, const char *word)
{
    sg_error err = SG_ERROR_INIT;
    sg_image im = {0, 0, NULL};
    ck_assert_msg(sg_photo_read(temp_path(t, name), &im, &err) == SG_EINPUT, "%s is read", name);
    ck_assert_ptr_null(im.rgb);
    ck_assert_msg(strstr(err.msg, word) != NULL && strstr(err.msg, name) != NULL, "%s", err.msg);
}

START_TEST(every_prefix_of_a_photograph_is_refused)
{
    const temp_folder t = temp_folder_make();
    sg_error err = SG_ERROR_INIT;
    sg_image im = smooth(40, 30);
    ck_ok(sg_photo_write_jpeg(temp_path(&t, "p.jpg"), &im, 80, &err));
    size_t n;
    unsigned char *bytes = temp_read(&t, "p.jpg", &n);
    for (size_t k = 0; k < n; k++) {
        temp_write(&t, "part.jpg", bytes, k);
        refuse(&t, "part.jpg", k == 0 ? "empty" : k < 3 ? "neither" : "truncated");
    }
    free(bytes);
    sg_image_clear(&im);
    temp_folder_remove(&t);
}
END_TEST

/* Offset of the frame header's marker: 0xff 0xc0. */
static size_t find_frame(const unsigned char *bytes, size_t n)
{
    for (size_t i = 0; i + 1 < n; i++)
        if (bytes[i] == 0xff && bytes[i + 1] == 0xc0)
            return i;
    ck_abort_msg("no frame header");
}

START_TEST(bad_photographs_are_refused_by_name)
{
    const temp_folder t = temp_folder_make();
    sg_error err = SG_ERROR_INIT;
    sg_image im = smooth(40, 30);
    ck_ok(sg_photo_write_jpeg(temp_path(&t, "p.jpg"), &im, 80, &err));
    size_t n;
    unsigned char *bytes = temp_read(&t, "p.jpg", &n);
    const size_t frame = find_frame(bytes, n);
    memcpy(bytes + frame + 5, "\x80\x01\x00\x01", 4); /* 32769 high */
    temp_write(&t, "big.jpg", bytes, n);
    refuse(&t, "big.jpg", "32769");
    memcpy(bytes + frame + 5, "\x20\x00\x7f\xff", 4);
    temp_write(&t, "hollow.jpg", bytes, n);
    refuse(&t, "hollow.jpg", "32767 x 8192 pixels cannot come from");
    memcpy(bytes + frame + 5, "\x00\x00\x00\x20", 4);
    temp_write(&t, "flat.jpg", bytes, n);
    refuse(&t, "flat.jpg", "holds nothing");
    memcpy(bytes + frame + 5, "\x00\x1e\x00\x28", 4);
    bytes[frame + 4] = 12;
    temp_write(&t, "deep.jpg", bytes, n);
    refuse(&t, "deep.jpg", "12 bits");
    bytes[frame + 4] = 8;
    bytes[frame] = 0;
    temp_write(&t, "marker.jpg", bytes, n);
    refuse(&t, "marker.jpg", "no marker");
    temp_text(&t, "text.jpg", "no picture");
    refuse(&t, "text.jpg", "neither");
    refuse(&t, "none.jpg", "No such file");
    temp_write(&t, "nothing.jpg", "\xff\xd8\xff\xd9", 4);
    refuse(&t, "nothing.jpg", "without a picture");
    free(bytes);
    sg_image_clear(&im);
    temp_folder_remove(&t);
}
END_TEST

/* The decoder would fill what is missing, or mend what is changed, and go on. */
START_TEST(damaged_pixels_are_refused)
{
    const temp_folder t = temp_folder_make();
    sg_error err = SG_ERROR_INIT;
    sg_image im = smooth(120, 90);
    for (size_t i = 0; i < 3 * 120 * 90; i++)
        im.rgb[i] = (uint8_t)(im.rgb[i] ^ i * i >> 7); /* no picture: most of the file is coded data */
    ck_ok(sg_photo_write_jpeg(temp_path(&t, "p.jpg"), &im, 80, &err));
    size_t n;
    unsigned char *bytes = temp_read(&t, "p.jpg", &n);
    for (size_t k = n / 2; k + 40 < n; k += 97) {
        unsigned char *part = malloc(n + 200);
        ck_assert_ptr_nonnull(part);
        memcpy(part, bytes, k);
        memcpy(part + k, "\xff\xd9", 2);
        temp_write(&t, "cut.jpg", part, k + 2);
        refuse(&t, "cut.jpg", "damaged JPEG");
        memcpy(part + k, bytes + k - 200, n - k + 200); /* a stretch twice: something is left over */
        temp_write(&t, "twice.jpg", part, n + 200);
        refuse(&t, "twice.jpg", "damaged JPEG");
        free(part);
    }
    free(bytes);
    sg_image_clear(&im);
    temp_folder_remove(&t);
}
END_TEST

/* 8 x 8 pixels of one colour each, coded as coarsely as can be: grey; CMYK as Adobe writes it; RGB in many scans. */
static const struct {
    const char *hex;
    int rgb[3];
} kinds[] = {
    {
     "ffd8ffdb004300ffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffff"
     "ffffffffffffffffffffffffffffffffffffffffffffc0000b080008000801011100ffc40014000100000000000000000000"
     "000000000001ffc40014100100000000000000000000000000000000ffda0008010100003f001fffd9",
     {100, 100, 100}},
    {
     "ffd8ffee000e41646f626500640000000000ffdb004300ffffffffffffffffffffffffffffffffffffffffffffffffffffff"
     "ffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffc00014080008000804431100"
     "4d11005911004b1100ffc40014000100000000000000000000000000000003ffc40014100100000000000000000000000000"
     "000000ffda000e0443004d0059004b00003f00418c8fffd9",
     {255, 0, 0}},
    {
     "ffd8ffdb004300ffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffff"
     "ffffffffffffffffffffffffffffffffffffffffffffdb004301ffffffffffffffffffffffffffffffffffffffffffffffff"
     "ffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffc20011080008000803"
     "012200021101031101ffc40014000100000000000000000000000000000000ffc40014010100000000000000000000000000"
     "000001ffda000c0301000210031000000101ffc40014100100000000000000000000000000000000ffda0008010100010502"
     "7fffc40014110100000000000000000000000000000000ffda0008010301013f017fffc40014110100000000000000000000"
     "000000000000ffda0008010201013f017fffc40014100100000000000000000000000000000000ffda0008010100063f027f"
     "ffc40014100100000000000000000000000000000000ffda0008010100013f217fffda000c030100020003000000100bffc4"
     "0014110100000000000000000000000000000000ffda0008010301013f107fffc40014110100000000000000000000000000"
     "000000ffda0008010201013f107fffc40014100100000000000000000000000000000000ffda0008010100013f107fffd9",
     {200, 100, 50}},
};

START_TEST(grey_cmyk_and_progressive_photographs_are_read)
{
    const temp_folder t = temp_folder_make();
    sg_error err = SG_ERROR_INIT;
    unsigned char bytes[1024];
    const size_t n = strlen(kinds[_i].hex) / 2;
    for (size_t i = 0; i < n; i++) {
        const char digits[3] = {kinds[_i].hex[2 * i], kinds[_i].hex[2 * i + 1], '\0'};
        bytes[i] = (unsigned char)strtoul(digits, NULL, 16);
    }
    temp_write(&t, "p.jpg", bytes, n);
    sg_image im;
    ck_ok(sg_photo_read(temp_path(&t, "p.jpg"), &im, &err));
    ck_assert(im.width == 8 && im.height == 8);
    for (int i = 0; i < 3 * 64; i++)
        ck_assert_int_le(abs((int)im.rgb[i] - kinds[_i].rgb[i % 3]), 24);
    sg_image_clear(&im);
    for (size_t k = 0; k < n; k++) { /* many scans: each prefix is still told from the whole */
        temp_write(&t, "part.jpg", bytes, k);
        refuse(&t, "part.jpg", k == 0 ? "empty" : k < 3 ? "neither" : "truncated");
    }
    temp_folder_remove(&t);
}
END_TEST

/* Any changed byte: a status and, when it is read at all, the size of the header. Nothing may crash, leak or print. */
START_TEST(changed_photographs_do_no_harm)
{
    const temp_folder t = temp_folder_make();
    sg_error err = SG_ERROR_INIT;
    sg_image im = smooth(24, 16);
    ck_ok(sg_photo_write_jpeg(temp_path(&t, "p.jpg"), &im, 80, &err));
    size_t n;
    unsigned char *bytes = temp_read(&t, "p.jpg", &n);
    ck_assert_ptr_nonnull(freopen(temp_path(&t, "said"), "w", stderr));
    for (size_t k = 0; k < n; k++) {
        bytes[k] ^= 0x15;
        temp_write(&t, "bad.jpg", bytes, n);
        sg_image back = {0, 0, NULL};
        const sg_status st = sg_photo_read(temp_path(&t, "bad.jpg"), &back, &err);
        ck_assert(st == SG_OK || st == SG_EINPUT);
        ck_assert((st == SG_OK) == (back.rgb != NULL));
        sg_image_clear(&back);
        bytes[k] ^= 0x15;
    }
    ck_assert_int_eq(ftell(stderr), 0); /* the JPEG library's remarks are ours to tell */
    free(bytes);
    sg_image_clear(&im);
    temp_folder_remove(&t);
}
END_TEST

START_TEST(resizing_averages_and_interpolates)
{
    sg_error err = SG_ERROR_INIT;
    sg_image im, out;
    ck_ok(sg_image_create(4, 2, &im, &err));
    for (size_t x = 0; x < 4; x++) {
        sg_image_set(&im, x, 0, (uint32_t)(40 * x) << 16);
        sg_image_set(&im, x, 1, (uint32_t)(40 * x + 20) << 16);
    }
    ck_ok(sg_photo_resize(&im, 2, 1, &out, &err)); /* means of 2 x 2 */
    ck_assert_uint_eq(out.rgb[0], 30);
    ck_assert_uint_eq(out.rgb[3], 110);
    sg_image_clear(&out);
    ck_ok(sg_photo_resize(&im, 2, 8, &out, &err)); /* averaged across, interpolated down */
    ck_assert(out.width == 2 && out.height == 8);
    ck_assert_uint_eq(out.rgb[0], 20);
    ck_assert_uint_eq(out.rgb[3 * 15], 120);
    for (size_t y = 1; y < 8; y++)
        ck_assert_uint_ge(out.rgb[6 * y], out.rgb[6 * (y - 1)]);
    sg_image_clear(&out);
    ck_assert_int_eq(sg_photo_resize(&im, 0, 8, &out, &err), SG_EINVAL);
    sg_image_clear(&im);
}
END_TEST

/* ---- polygons ---- */

START_TEST(upright_polygons_are_exact)
{
    sg_error err = SG_ERROR_INIT;
    sg_label_map m;
    ck_ok(sg_label_map_create(20, 15, &m, &err));
    const double box[] = {3, 2, 11, 2, 11, 9, 3, 9};
    const double over[] = {-5, 12, 40, 12, 40, 99, -5, 99}; /* cut off at the sides */
    const double beside[] = {30, 1, 35, 1, 35, 4, 30, 4}, left[] = {-9, 1, -2, 1, -2, 4, -9, 4};
    ck_ok(sg_label_map_fill_polygon(&m, box, 4, 7, &err));
    ck_ok(sg_label_map_fill_polygon(&m, over, 4, 9, &err));
    ck_ok(sg_label_map_fill_polygon(&m, beside, 4, 1, &err));
    ck_ok(sg_label_map_fill_polygon(&m, left, 4, 1, &err));
    for (size_t y = 0; y < 15; y++)
        for (size_t x = 0; x < 20; x++)
            ck_assert_uint_eq(m.labels[y * 20 + x], y >= 12 ? 9 : x >= 3 && x < 11 && y >= 2 && y < 9 ? 7 : 0);
    ck_assert_int_eq(sg_label_map_fill_polygon(&m, box, 2, 7, &err), SG_EINVAL);
    const double star[] = {0, 0, 8, 0, 0, 4, 8, 4}; /* even-odd: two triangles, and two that are out */
    memset(m.labels, 0, 300);
    ck_ok(sg_label_map_fill_polygon(&m, star, 4, 1, &err));
    ck_assert(m.labels[3] == 1 && m.labels[3 * 20 + 3] == 1 && m.labels[2 * 20] == 0 && m.labels[1 * 20 + 7] == 0);
    const double bad[] = {0, 0, 1, NAN, 3, 3}, far[] = {0, 0, 1e9, 0, 3, 3};
    ck_assert_int_eq(sg_label_map_fill_polygon(&m, bad, 3, 7, &err), SG_EINVAL);
    ck_assert_int_eq(sg_label_map_fill_polygon(&m, far, 3, 7, &err), SG_EINVAL);
    sg_label_map_clear(&m);
}
END_TEST

/* Distance of a point to a triangle's outline, and which side: the oracle of the next test. */
static double signed_distance(const double *xy, double px, double py)
{
    double nearest = INFINITY;
    bool inside = false;
    for (int i = 0, j = 2; i < 3; j = i++) {
        const double ax = xy[2 * i], ay = xy[2 * i + 1], bx = xy[2 * j] - ax, by = xy[2 * j + 1] - ay;
        const double u = fmin(1, fmax(0, ((px - ax) * bx + (py - ay) * by) / (bx * bx + by * by)));
        nearest = fmin(nearest, hypot(px - ax - u * bx, py - ay - u * by));
        if ((ay > py) != (xy[2 * j + 1] > py) && px < bx * (py - ay) / by + ax)
            inside = !inside;
    }
    return inside ? nearest : -nearest;
}

START_TEST(triangles_hold_the_pixels_whose_centres_are_inside)
{
    sg_error err = SG_ERROR_INIT;
    sg_label_map m;
    double xy[6];
    ck_ok(sg_label_map_create(40, 40, &m, &err));
    for (int seed = 1; seed <= 200; seed++) {
        srand((unsigned)seed);
        for (int k = 0; k < 6; k++)
            xy[k] = 60.0 * rand() / RAND_MAX - 10;
        memset(m.labels, 0, 1600);
        ck_ok(sg_label_map_fill_polygon(&m, xy, 3, 1, &err));
        for (size_t i = 0; i < 1600; i++) {
            const double d = signed_distance(xy, (double)(i % 40) + 0.5, (double)(i / 40) + 0.5);
            if (d > 1e-9 && m.labels[i] != 1)
                ck_abort_msg("seed %d: (%zu, %zu) at %g is missing", seed, i % 40, i / 40, d);
            if (d < -1e-9 && m.labels[i] != 0)
                ck_abort_msg("seed %d: (%zu, %zu) at %g is filled", seed, i % 40, i / 40, d);
        }
    }
    sg_label_map_clear(&m);
}
END_TEST

/* ---- NumPy arrays ---- */

START_TEST(float_maps_come_back)
{
    const temp_folder t = temp_folder_make();
    sg_error err = SG_ERROR_INIT;
    sg_float_map m, back;
    ck_ok(sg_float_map_create(3, 41, 59, &m, &err));
    for (size_t i = 0; i < 3 * 41 * 59; i++)
        m.values[i] = sinf((float)i) * powf(10, (float)(i % 60) - 30);
    ck_ok(sg_npy_write(temp_path(&t, "m.npy"), &m, &err));
    ck_ok(sg_npy_read(temp_path(&t, "m.npy"), &back, &err));
    ck_assert(back.channels == 3 && back.height == 41 && back.width == 59);
    ck_assert_mem_eq(back.values, m.values, sizeof(float) * 3 * 41 * 59);
    sg_float_map_clear(&back);
    size_t n;
    unsigned char *bytes = temp_read(&t, "m.npy", &n);
    ck_assert_uint_eq((n - sizeof(float) * 3 * 41 * 59) % 64, 0);
    const size_t header = n - sizeof(float) * 3 * 41 * 59;
    for (size_t k = 0; k < n; k += k < header ? 1 : 997) {
        temp_write(&t, "part.npy", bytes, k);
        ck_assert_int_eq(sg_npy_read(temp_path(&t, "part.npy"), &back, &err), SG_EINPUT);
        ck_assert_ptr_nonnull(strstr(err.msg, "part.npy"));
    }
    free(bytes);
    ck_assert_int_eq(sg_npy_write("/dev/full", &m, &err), SG_EIO);
    sg_float_map_clear(&m);
    sg_float_map_clear(&m);
    temp_folder_remove(&t);
}
END_TEST

/* A file with this version and header text and so many bytes of 0 after it. */
static void make_npy(const temp_folder *t, unsigned version, const char *text, size_t nbytes)
{
    unsigned char bytes[512] = {0x93, 'N', 'U', 'M', 'P', 'Y', (unsigned char)version, 0, (unsigned char)strlen(text)};
    const size_t head = version == 1 ? 10 : 12;
    memcpy(bytes + head, text, strlen(text));
    temp_write(t, "a.npy", bytes, head + strlen(text) + nbytes);
}

START_TEST(other_writers_headers_are_read)
{
    const temp_folder t = temp_folder_make();
    sg_error err = SG_ERROR_INIT;
    sg_float_map m;
    const char *const texts[] = {"{'descr': '<f4', 'fortran_order': False, 'shape': (1, 2, 3), }\n",
                                 "{\"shape\":(1,2,3),\"fortran_order\":False,\"descr\":\"<f4\"}",
                                 "{'shape': (1L, 2L, 3L), 'descr': '<f4', 'fortran_order': False}   \n"};
    for (int k = 0; k < 9; k++) {
        make_npy(&t, (unsigned)k / 3 + 1, texts[k % 3], 24);
        ck_ok(sg_npy_read(temp_path(&t, "a.npy"), &m, &err));
        ck_assert(m.channels == 1 && m.height == 2 && m.width == 3);
        sg_float_map_clear(&m);
    }
    temp_folder_remove(&t);
}
END_TEST

static const struct {
    const char *text;
    size_t nbytes;
    const char *word;
} bad_arrays[] = {
    {"{'descr': '<f8', 'fortran_order': False, 'shape': (1, 2, 3), }", 48, "type '<f8'"},
    {"{'descr': '>f4', 'fortran_order': False, 'shape': (1, 2, 3), }", 24, "type '>f4'"},
    {"{'descr': '<f4', 'fortran_order': True, 'shape': (1, 2, 3), }", 24, "Fortran"},
    {"{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }", 24, "shape is (2, 3)"},
    {"{'descr': '<f4', 'fortran_order': False, 'shape': (1, 1, 2, 3), }", 24, "shape is (1, 1, 2, 3)"},
    {"{'descr': '<f4', 'fortran_order': False, 'shape': (), }", 4, "shape is ()"},
    {"{'descr': '<f4', 'fortran_order': False, 'shape': (1, -2, 3), }", 24, "shape"},
    {"{'descr': '<f4', 'fortran_order': False, 'shape': (99999999999999999999999, 2, 3), }", 24, "shape"},
    {"{'descr': '<f4', 'fortran_order': False, 'shape': (0, 2, 3), }", 0, "0 values a pixel"},
    {"{'descr': '<f4', 'fortran_order': False, 'shape': (257, 2, 3), }", 0, "257 values a pixel"},
    {"{'descr': '<f4', 'fortran_order': False, 'shape': (1, 2, 99999), }", 0, "too many"},
    {"{'descr': '<f4', 'fortran_order': False, 'shape': (200, 30000, 30000), }", 100, "truncated"},
    {"{'descr': '<f4', 'fortran_order': False, 'shape': (1, 2, 3), }", 23, "truncated"},
    {"{'descr': '<f4', 'fortran_order': False, 'shape': (1, 2, 3), }", 25, "more bytes"},
    {"{'fortran_order': False, 'shape': (1, 2, 3), }", 24, "without type"},
    {"", 24, "without type"},
};

START_TEST(bad_arrays_are_refused_by_name)
{
    const temp_folder t = temp_folder_make();
    sg_error err = SG_ERROR_INIT;
    sg_float_map m = {0, 0, 0, NULL};
    make_npy(&t, 1, bad_arrays[_i].text, bad_arrays[_i].nbytes);
    ck_assert_int_eq(sg_npy_read(temp_path(&t, "a.npy"), &m, &err), SG_EINPUT);
    ck_assert_ptr_null(m.values);
    ck_assert_msg(strstr(err.msg, bad_arrays[_i].word) != NULL, "%s", err.msg);
    make_npy(&t, 4, bad_arrays[_i].text, 0);
    ck_assert_int_eq(sg_npy_read(temp_path(&t, "a.npy"), &m, &err), SG_EINPUT);
    ck_assert_ptr_nonnull(strstr(err.msg, "version 4"));
    temp_folder_remove(&t);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("photo");
    TCase *tc = tcase_create("photo");
    tcase_set_timeout(tc, 60);
    tcase_add_test(tc, photographs_come_back_nearly);
    tcase_add_test(tc, every_prefix_of_a_photograph_is_refused);
    tcase_add_test(tc, bad_photographs_are_refused_by_name);
    tcase_add_test(tc, damaged_pixels_are_refused);
    tcase_add_loop_test(tc, grey_cmyk_and_progressive_photographs_are_read, 0, 3);
    tcase_add_test(tc, changed_photographs_do_no_harm);
    tcase_add_test(tc, resizing_averages_and_interpolates);
    tcase_add_test(tc, upright_polygons_are_exact);
    tcase_add_test(tc, triangles_hold_the_pixels_whose_centres_are_inside);
    tcase_add_test(tc, float_maps_come_back);
    tcase_add_test(tc, other_writers_headers_are_read);
    tcase_add_loop_test(tc, bad_arrays_are_refused_by_name, 0, sizeof bad_arrays / sizeof bad_arrays[0]);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
