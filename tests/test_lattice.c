/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_lattice.c - lattices in memory and their files. */
#include "core/random.h"
#include "parse/lattice.h"
#include "tests/support.h"

#include <string.h>
#include <unistd.h>

static sg_arena *arena;
static sg_error err;

static void set_up(void)
{
    arena = sg_arena_create();
    ck_assert_ptr_nonnull(arena);
}

static void tear_down(void)
{
    sg_arena_free(arena);
}

static sg_lattice parse(const char *text)
{
    sg_lattice l = {0};
    ck_ok(sg_lattice_parse("F", text, strlen(text), arena, &l, &err));
    return l;
}

static const char *const NAMES[] = {"wall", "window", "x", "y", "0", "b\xc3\xa4lkong", "a-very-long-name_with.dots"};
enum { NNAMES = sizeof NAMES / sizeof *NAMES };

static sg_lattice random_lattice(int seed)
{
    gsl_rng *rng = sg_random_create((uint64_t)seed + 1);
    sg_lattice l = {0};
    ck_ok(sg_lattice_create(1 + gsl_rng_uniform_int(rng, 9), 1 + gsl_rng_uniform_int(rng, 9), arena, &l, &err));
    for (size_t i = 0; i <= l.width; i++)
        l.x[i] = (i > 0 ? l.x[i - 1] + 1 : 0) + (uint32_t)gsl_rng_uniform_int(rng, 200);
    for (size_t i = 0; i <= l.height; i++)
        l.y[i] = (i > 0 ? l.y[i - 1] + 1 : 0) + (uint32_t)gsl_rng_uniform_int(rng, 200);
    l.nlabels = NNAMES;
    l.label_names = sg_arena_copy(arena, NAMES, sizeof NAMES);
    for (size_t i = 0; i < l.width * l.height; i++)
        l.labels[i] = (uint16_t)gsl_rng_uniform_int(rng, NNAMES);
    gsl_rng_free(rng);
    return l;
}

START_TEST(round_trip_keeps_boundaries_and_labels)
{
    const sg_lattice l = random_lattice(_i);
    char path[] = "lattice-XXXXXX";
    const int fd = mkstemp(path);
    ck_assert_int_ge(fd, 0);
    close(fd);
    ck_ok(sg_lattice_save(&l, path, &err));
    sg_lattice back;
    ck_ok(sg_lattice_read(path, arena, &back, &err));
    unlink(path);
    ck_assert(sg_lattice_equal(&l, &back));
    sg_lattice copy;
    ck_ok(sg_lattice_copy(&back, arena, &copy, &err));
    ck_assert(sg_lattice_equal(&l, &copy));
    copy.x[copy.width]++;
    ck_assert(!sg_lattice_equal(&l, &copy));
}
END_TEST

START_TEST(what_the_format_allows_is_read)
{
    static const char *const same[] = {
        "lattice 2 3\nx 0 1 2\ny 0 1 2 3\na b\nb c\nc a\n",
        "lattice 2 3\na b\nb c\nc a\n",
        "# first\n#second\nlattice 2 3\n\na b\n# between\nb c\n\t c\ta  \n\n#last",
        "lattice 2 3\r\nx 0 1 2\r\na b\r\nb c\r\nc a",
        "  lattice\t2 3\ny 0 1 2 3\na b\nb c\nc a\n",
    };
    const sg_lattice first = parse(same[0]);
    ck_assert_uint_eq(first.width, 2);
    ck_assert_uint_eq(first.height, 3);
    ck_assert_uint_eq(first.nlabels, 3);
    ck_assert_str_eq(first.label_names[first.labels[3]], "c");
    for (size_t i = 1; i < sizeof same / sizeof *same; i++) {
        const sg_lattice l = parse(same[i]);
        ck_assert_msg(sg_lattice_equal(&first, &l), "text %zu differs", i);
    }
}
END_TEST

START_TEST(labels_may_be_called_like_the_boundary_lines)
{
    sg_lattice l = parse("lattice 1 2\nx\ny\n");
    ck_assert_str_eq(l.label_names[l.labels[0]], "x");
    ck_assert_str_eq(l.label_names[l.labels[1]], "y");
    l = parse("lattice 2 2\nx y\ny x\n");
    ck_assert_str_eq(l.label_names[l.labels[3]], "x");
    l = parse("lattice 2 2\nx 3 5 9\ny 0 7 8\nx 1\ny 2\n");
    ck_assert_uint_eq(l.x[2], 9);
    ck_assert_str_eq(l.label_names[l.labels[1]], "1");
}
END_TEST

typedef struct {
    const char *text;
    const char *message; /* what the sentence begins with, and a part of what follows */
    const char *part;
} bad;

static const bad BAD[] = {
    {"", "F:1:1: error:", "end of the file"},
    {"# only a comment\n", "F:1:", "end of the file"},
    {"lattis 2 2\n", "F:1:1:", "expected 'lattice W H'"},
    {"lattice\n", "F:1:8:", "expected 2 numbers"},
    {"lattice 2\n", "F:1:10:", "expected 2 numbers"},
    {"lattice 2 2 2\n", "F:1:13:", "found 3"},
    {"lattice 0 2\n", "F:1:9:", "width: 0 is not in 1 to 4096"},
    {"lattice 2 4097\n", "F:1:11:", "height: 4097"},
    {"lattice 2 99999999999999999999999999999\n", "F:1:11:", "not in"},
    {"lattice 2 -1\n", "F:1:11:", "whole number, found '-1'"},
    {"lattice 2 1.5\n", "F:1:11:", "found '1.5'"},
    {"lattice 2 1\nx 0 1\na b\n", "F:2:6:", "expected 3 boundaries, found 2"},
    {"lattice 2 1\nx 0 1 2 3\na b\n", "F:2:9:", "expected 3 boundaries, found 4"},
    {"lattice 2 1\nx 0 1 1\na b\n", "F:2:7:", "must increase"},
    {"lattice 2 1\nx 0 2 1\na b\n", "F:2:7:", "must increase"},
    {"lattice 2 1\nx 0 1 4294967296\na b\n", "F:2:7:", "not in 0 to 2147483647"},
    {"lattice 2 1\nx 0 1 184467440737095516160\na b\n", "F:2:7:", "not in"},
    {"lattice 2 1\nx 0 1 b\na b\n", "F:2:7:", "found 'b'"},
    {"lattice 2 1\ny 0 0\na b\n", "F:2:5:", "must increase"},
    {"lattice 2 2\n\na b\n", "F:3:4:", "expected 2 rows of labels, found the end after 1"},
    {"lattice 2 2", "F:1:12:", "found the end after 0"},
    {"lattice 2 2\na b\na\n", "F:3:2:", "expected 2 labels, found 1"},
    {"lattice 2 2\na b\na b c\n", "F:3:5:", "found 3"},
    {"lattice 2 2\na b\na b\nc d\n", "F:4:1:", "after the last row"},
    {"lattice 1 1\r\na\rb\r\n", "F:2:2:", "control character"},
    {"lattice 2 1\na \x1b[1m\n", "F:2:3:", "control character"},
};

START_TEST(malformed_text_is_refused_with_its_place)
{
    const bad *b = &BAD[_i];
    sg_lattice l = {.width = 77};
    ck_assert_int_eq(sg_lattice_parse("F", b->text, strlen(b->text), arena, &l, &err), SG_EINPUT);
    ck_assert_msg(strncmp(err.msg, b->message, strlen(b->message)) == 0 && strstr(err.msg, b->part) != NULL,
                  "text %d: '%s' has not '%s' and '%s'", _i, err.msg, b->message, b->part);
    ck_assert_uint_eq(l.width, 77);
}
END_TEST

START_TEST(every_truncation_of_a_good_file_is_refused_or_complete)
{
    static const char text[] = "lattice 3 2\nx 0 10 25 31\ny 0 4 9\nwall window wall\nshop door shop\n";
    for (size_t n = 0; n < sizeof text - 1; n++) {
        sg_lattice l;
        const sg_status st = sg_lattice_parse("F", text, n, arena, &l, &err);
        /* without the last newline, or a shorter last label, the file is still a lattice */
        ck_assert_int_eq(st, n > sizeof text - 6 ? SG_OK : SG_EINPUT);
    }
}
END_TEST

START_TEST(nul_bytes_are_refused_everywhere)
{
    static const char text[] = "lattice 3 2\nx 0 10 25 31\ny 0 4 9\nwall window wall\nshop door shop\n";
    for (size_t n = 0; n < sizeof text - 1; n++) {
        char broken[sizeof text];
        memcpy(broken, text, sizeof text);
        broken[n] = '\0';
        sg_lattice l;
        ck_assert_int_eq(sg_lattice_parse("F", broken, sizeof text - 1, arena, &l, &err), SG_EINPUT);
        ck_assert_msg(strncmp(err.msg, "F:", 2) == 0, "%s", err.msg);
    }
}
END_TEST

START_TEST(random_damage_never_does_harm)
{
    gsl_rng *rng = sg_random_create(77);
    static const char alphabet[] = " \n\r\t#x0y9-lattice\0\xff";
    for (int i = 0; i < 3000; i++) {
        char text[] = "lattice 3 2\nx 0 10 25 31\ny 0 4 9\nwall window wall\nshop door shop\n";
        size_t n = sizeof text - 1;
        for (unsigned long k = gsl_rng_uniform_int(rng, 6); k > 0; k--)
            text[gsl_rng_uniform_int(rng, n)] = alphabet[gsl_rng_uniform_int(rng, sizeof alphabet)];
        n -= gsl_rng_uniform_int(rng, 4) == 0 ? gsl_rng_uniform_int(rng, n) : 0;
        sg_lattice l;
        const sg_status st = sg_lattice_parse("F", text, n, arena, &l, &err);
        ck_assert(st == SG_OK || st == SG_EINPUT);
        ck_assert(st != SG_OK || (l.x[l.width] > l.x[0] && l.labels[l.width * l.height - 1] < l.nlabels));
    }
    gsl_rng_free(rng);
}
END_TEST

START_TEST(many_different_labels_are_numbered_in_reading_order)
{
    enum { SIDE = 200 };
    char *text = NULL;
    size_t length;
    FILE *fp = open_memstream(&text, &length);
    fprintf(fp, "lattice %d %d\n", SIDE, SIDE);
    for (int i = 0; i < SIDE * SIDE; i++)
        fprintf(fp, "L%d%c", i, i % SIDE == SIDE - 1 ? '\n' : ' ');
    fclose(fp);
    const sg_lattice l = parse(text);
    ck_assert_uint_eq(l.nlabels, SIDE * SIDE);
    for (size_t i = 0; i < SIDE * SIDE; i++)
        ck_assert_uint_eq(l.labels[i], i);
    ck_assert_str_eq(l.label_names[39999], "L39999");
    free(text);
}
END_TEST

START_TEST(names_that_no_file_can_hold_are_refused)
{
    static const char *names[] = {"", "#a", "two words", "tab\there", "line\n"};
    sg_lattice l = parse("lattice 1 1\na\n");
    l.label_names = &names[_i];
    FILE *fp = fopen("/dev/null", "w");
    ck_assert_int_eq(sg_lattice_write(&l, fp, &err), SG_EINVAL);
    fclose(fp);
}
END_TEST

START_TEST(writing_failures_are_reported)
{
    const sg_lattice l = parse("lattice 1 1\na\n");
    ck_assert_int_eq(sg_lattice_save(&l, "/dev/full", &err), SG_EIO);
    ck_assert_ptr_nonnull(strstr(err.msg, "/dev/full"));
    ck_assert_int_eq(sg_lattice_save(&l, "no/such/folder/a.lat", &err), SG_EIO);
    sg_lattice back;
    ck_assert_int_eq(sg_lattice_read("no/such/file.lat", arena, &back, &err), SG_EINPUT);
    ck_assert_ptr_nonnull(strstr(err.msg, "no/such/file.lat"));
}
END_TEST

START_TEST(sides_are_checked)
{
    sg_lattice l;
    ck_assert_int_eq(sg_lattice_create(0, 1, arena, &l, &err), SG_EINVAL);
    ck_assert_int_eq(sg_lattice_create(1, SG_LATTICE_MAX_SIDE + 1, arena, &l, &err), SG_EINVAL);
    ck_ok(sg_lattice_create(SG_LATTICE_MAX_SIDE, 1, arena, &l, &err));
}
END_TEST

START_TEST(labels_are_mapped_by_name)
{
    const sg_lattice l = parse("lattice 3 1\nc a b\n");
    const char *const names[] = {"a", "b", "z"};
    uint16_t map[3];
    ck_assert_uint_eq(sg_lattice_map_labels(&l, names, 3, map), 1);
    ck_assert_uint_eq(map[0], SG_LATTICE_NO_LABEL);
    ck_assert_uint_eq(map[1], 0);
    ck_assert_uint_eq(map[2], 1);
    ck_assert_uint_eq(sg_lattice_find_label(&l, "b"), 2);
    ck_assert_uint_eq(sg_lattice_find_label(&l, "z"), SG_LATTICE_NO_LABEL);
}
END_TEST

START_TEST(cells_are_found_from_pixels)
{
    const sg_lattice l = random_lattice(_i);
    for (uint32_t px = 0; px < l.x[l.width] + 3; px++) {
        size_t expected = 0;
        while (expected + 1 < l.width && l.x[expected + 1] <= px)
            expected++;
        ck_assert_uint_eq(sg_lattice_column_of(&l, px), expected);
    }
    for (size_t row = 0; row < l.height; row++) {
        ck_assert_uint_eq(sg_lattice_row_of(&l, l.y[row]), row);
        ck_assert_uint_eq(sg_lattice_row_of(&l, l.y[row + 1] - 1), row);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("lattice");
    TCase *tc = tcase_create("files");
    tcase_add_checked_fixture(tc, set_up, tear_down);
    tcase_add_loop_test(tc, round_trip_keeps_boundaries_and_labels, 0, 40);
    tcase_add_test(tc, what_the_format_allows_is_read);
    tcase_add_test(tc, labels_may_be_called_like_the_boundary_lines);
    tcase_add_loop_test(tc, malformed_text_is_refused_with_its_place, 0, (int)(sizeof BAD / sizeof *BAD));
    tcase_add_test(tc, every_truncation_of_a_good_file_is_refused_or_complete);
    tcase_add_test(tc, nul_bytes_are_refused_everywhere);
    tcase_add_test(tc, random_damage_never_does_harm);
    tcase_add_test(tc, many_different_labels_are_numbered_in_reading_order);
    tcase_add_loop_test(tc, names_that_no_file_can_hold_are_refused, 0, 5);
    tcase_add_test(tc, writing_failures_are_reported);
    tcase_add_test(tc, sides_are_checked);
    tcase_add_test(tc, labels_are_mapped_by_name);
    tcase_add_loop_test(tc, cells_are_found_from_pixels, 0, 20);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
