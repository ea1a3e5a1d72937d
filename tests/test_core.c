/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_core.c - arenas, growing arrays, output files, random streams. */
#include "core/arena.h"
#include "core/array.h"
#include "core/file.h"
#include "core/random.h"
#include "core/status.h"
#include "tests/support.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdint.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <signal.h>
#include <unistd.h>

START_TEST(arena_pieces_keep_their_contents_and_alignment)
{
    sg_arena *a = sg_arena_create();
    enum { N = 400 };
    unsigned char *piece[N];
    for (size_t i = 0; i < N; i++) {
        const size_t size = 1 + (i * 7919) % 9000;
        piece[i] = sg_arena_alloc(a, size);
        ck_assert_ptr_nonnull(piece[i]);
        ck_assert_uint_eq((uintptr_t)piece[i] % 16, 0);
        if (size >= 4096)
            ck_assert_uint_eq((uintptr_t)piece[i] % 64, 0);
        memset(piece[i], (int)(i % 251), size);
    }
    for (size_t i = 0; i < N; i++) {
        const size_t size = 1 + (i * 7919) % 9000;
        for (size_t j = 0; j < size; j++)
            ck_assert_uint_eq(piece[i][j], i % 251);
    }
    sg_arena_free(a);
}
END_TEST

START_TEST(arena_rewind_gives_back_what_came_after_the_mark)
{
    sg_arena *a = sg_arena_create();
    int *before = sg_arena_copy(a, &(int){42}, sizeof(int));
    const sg_mark mark = sg_arena_mark(a);
    const size_t used = sg_arena_used(a);
    for (int round = 0; round < 5; round++) {
        for (int i = 0; i < 100; i++)
            ck_assert_ptr_nonnull(sg_arena_calloc(a, 1000, 8));
        ck_assert_uint_gt(sg_arena_used(a), used);
        sg_arena_rewind(a, mark);
        ck_assert_uint_eq(sg_arena_used(a), used);
        ck_assert_int_eq(*before, 42);
    }
    sg_arena_reset(a);
    ck_assert_uint_eq(sg_arena_used(a), 0);
    ck_assert_ptr_null(sg_arena_calloc(a, SIZE_MAX / 2, 8));
    ck_assert_str_eq(sg_arena_printf(a, "%d %s", 7, "ab"), "7 ab");
    sg_arena_free(a);
}
END_TEST

START_TEST(arrays_grow_and_keep)
{
    int *v = NULL;
    size_t capacity = 0;
    for (int i = 0; i < 1000; i++) {
        ck_assert(SG_GROW(v, capacity, (size_t)i + 1));
        v[i] = i;
    }
    for (int i = 0; i < 1000; i++)
        ck_assert_int_eq(v[i], i);
    ck_assert(!SG_GROW(v, capacity, SIZE_MAX / 2));
    ck_assert_int_eq(v[999], 999);
    free(v);
}
END_TEST

/* Known answers of Random123's own kat_vectors for philox4x32-10: key 0 and counter 0. */
START_TEST(philox_gives_the_published_words)
{
    gsl_rng *r = sg_random_create(0);
    const unsigned long want[4] = {0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8};
    for (int i = 0; i < 4; i++)
        ck_assert_uint_eq(gsl_rng_get(r), want[i]);
    gsl_rng_free(r);
}
END_TEST

START_TEST(streams_repeat_and_differ_by_each_part_of_the_key)
{
    gsl_rng *r = sg_random_create(9);
    double first[4];
    const uint64_t key[4][3] = {{9, 1, 2}, {10, 1, 2}, {9, 2, 2}, {9, 1, 3}};
    for (int k = 0; k < 4; k++) {
        sg_random_stream(r, key[k][0], (uint32_t)key[k][1], key[k][2]);
        first[k] = sg_random_uniform(r);
        for (int j = 0; j < k; j++)
            ck_assert_double_ne(first[k], first[j]);
    }
    sg_random_stream(r, 9, 1, 2);
    ck_assert_double_eq(sg_random_uniform(r), first[0]);
    gsl_rng_free(r);
}
END_TEST

static double of_two_words(gsl_rng *r)
{
    const uint64_t high = gsl_rng_get(r), low = gsl_rng_get(r);
    return ((double)((high << 20) + (low >> 12)) + 0.5) / 4503599627370496.0;
}

/* However the words are taken, from whichever generator, from an odd word on too (round 1). */
START_TEST(uniforms_are_made_of_two_words)
{
    const gsl_rng_type *types[] = {sg_random_philox, gsl_rng_mt19937};
    gsl_rng *r[3];
    for (int i = 0; i < 3; i++)
        r[i] = gsl_rng_alloc(types[_i]);
    for (int round = 0; round < 3; round++) {
        double u[11];
        for (int i = 0; i < 3 && round == 1; i++)
            gsl_rng_get(r[i]);
        sg_random_uniforms(r[1], u, 11);
        for (int i = 0; i < 11; i++) {
            const double want = of_two_words(r[0]);
            ck_assert_double_eq(sg_random_uniform(r[2]), want);
            ck_assert_double_eq(u[i], want);
        }
    }
    for (int i = 0; i < 3; i++)
        gsl_rng_free(r[i]);
}
END_TEST

START_TEST(uniforms_are_uniform_and_open)
{
    enum { BINS = 64, N = 64000 };
    size_t count[BINS] = {0};
    gsl_rng *r = sg_random_create(_i + 1);
    for (size_t i = 0; i < N; i++) {
        const double u = sg_random_uniform(r);
        ck_assert(u > 0 && u < 1);
        count[(size_t)(u * BINS)]++;
    }
    double chisq = 0;
    for (int b = 0; b < BINS; b++)
        chisq += pow((double)count[b] - N / BINS, 2) / (N / BINS);
    ck_assert_msg(gsl_cdf_chisq_Q(chisq, BINS - 1) > 1e-6, "seed %d: chi-square %g", _i + 1, chisq);
    gsl_rng_free(r);
}
END_TEST

START_TEST(output_replaces_only_when_committed)
{
    sg_error err = SG_ERROR_INIT;
    sg_output out;
    char path[] = "/tmp/sg_test_core_XXXXXX";
    ck_assert_ptr_nonnull(mkdtemp(path));
    char file[256];
    snprintf(file, sizeof file, "%s/out", path);
    ck_ok(sg_output_open(&out, file, &err));
    fputs("one", out.fp);
    ck_ok(sg_output_commit(&out, &err));
    ck_ok(sg_output_open(&out, file, &err));
    fputs("two", out.fp);
    sg_output_discard(&out);
    sg_arena *a = sg_arena_create();
    char *text;
    size_t length;
    ck_ok(sg_file_read(file, 100, a, &text, &length, &err));
    ck_assert_str_eq(text, "one");
    ck_assert_int_eq(sg_file_read(file, 2, a, &text, &length, &err), SG_EINPUT);
    ck_assert_int_eq(sg_file_read(path, 100, a, &text, &length, &err), SG_EINPUT);
    sg_arena_free(a);
    unlink(file);
    ck_assert_int_eq(rmdir(path), 0); /* nothing else was left behind */
}
END_TEST

START_TEST(output_failures_are_named)
{
    sg_error err = SG_ERROR_INIT;
    sg_output out;
    ck_assert_int_eq(sg_output_open(&out, "/no/such/folder/x", &err), SG_EIO);
    ck_assert_ptr_nonnull(strstr(err.msg, "/no/such/folder/x"));
    ck_ok(sg_output_open(&out, "/dev/full", &err));
    fputs("text", out.fp);
    ck_assert_int_eq(sg_output_commit(&out, &err), SG_EIO);
    ck_assert_ptr_nonnull(strstr(err.msg, "/dev/full"));
}
END_TEST

START_TEST(a_file_size_limit_leaves_no_half_file)
{
    sg_error err = SG_ERROR_INIT;
    sg_output out;
    char path[] = "/tmp/sg_test_core_XXXXXX";
    ck_assert_ptr_nonnull(mkdtemp(path));
    char file[256];
    snprintf(file, sizeof file, "%s/out", path);
    signal(SIGXFSZ, SIG_IGN);
    const struct rlimit limit = {4096, 4096};
    ck_assert_int_eq(setrlimit(RLIMIT_FSIZE, &limit), 0);
    ck_ok(sg_output_open(&out, file, &err));
    for (int i = 0; i < 10000; i++)
        fputs("0123456789", out.fp);
    ck_assert_int_eq(sg_output_commit(&out, &err), SG_EIO);
    ck_assert_int_eq(rmdir(path), 0);
}
END_TEST

START_TEST(folders_are_made_with_their_parents)
{
    sg_error err = SG_ERROR_INIT;
    char path[] = "/tmp/sg_test_core_XXXXXX";
    ck_assert_ptr_nonnull(mkdtemp(path));
    char folder[256], file[300];
    snprintf(folder, sizeof folder, "%s/a/b/c", path);
    ck_ok(sg_folder_create(folder, &err));
    ck_ok(sg_folder_create(folder, &err));
    ck_assert(sg_folder_exists(folder));
    snprintf(file, sizeof file, "%s/f", folder);
    fclose(fopen(file, "w"));
    ck_assert_int_eq(sg_folder_create(file, &err), SG_EIO);
    unlink(file);
    for (int i = 0; i < 4; i++) {
        rmdir(folder);
        *strrchr(folder, '/') = '\0';
    }
}
END_TEST

START_TEST(places_are_told_by_their_folders)
{
    char folder[] = "/tmp/sg-test-XXXXXX", x[64], y[64], back[4096];
    ck_assert_ptr_nonnull(mkdtemp(folder));
    ck_assert_ptr_nonnull(getcwd(back, sizeof back));
    ck_assert_int_eq(chdir(folder), 0);
    snprintf(x, sizeof x, "%s/new/x", folder);
    snprintf(y, sizeof y, "%s/./x", folder);
    ck_assert_int_eq(mkdir("real", 0700), 0);
    ck_assert_int_eq(symlink("real", "link"), 0);
    const char *const same[][2] = {{"x", "x"}, {"x", "./x"}, {"x", y}, {"real/x", "link/x"}, {"real/x", "link/../real//x"},
                                   {"new/x", "./new/x"}, {"new/x", "new//./x"}, {"n/x", "n//x"}, {"new/a/x", "real/../new/a/x"}, {"new/x", x},
                                   {"link/new/x", "real/new/x"}, {"/none/x", "//none//x"}};
    const char *const other[][2] = {{"x", "y"}, {"real/x", "x"}, {"new/x", "x"}, {"new/x", "new/y"}, {"new/a/x", "new/b/x"},
                                    {"-", "-"}, {"x", "-"}, {"real", "link"}, {"/none/x", "none/x"}};
    for (size_t i = 0; i < sizeof same / sizeof same[0]; i++)
        ck_assert_msg(sg_file_same_place(same[i][0], same[i][1]), "%s is not %s", same[i][0], same[i][1]);
    for (size_t i = 0; i < sizeof other / sizeof other[0]; i++)
        ck_assert_msg(!sg_file_same_place(other[i][0], other[i][1]), "%s is %s", other[i][0], other[i][1]);
    ck_assert(unlink("link") == 0 && rmdir("real") == 0 && chdir(back) == 0 && rmdir(folder) == 0);
}
END_TEST

START_TEST(each_status_has_its_exit_code)
{
    const int want[] = {0, 2, 3, 1, 1, 4, 4, 5};
    for (int s = SG_OK; s <= SG_STOPPED; s++)
        ck_assert_int_eq(sg_exit_code((sg_status)s), want[s]);
    ck_assert_int_eq(SG_FAIL(NULL, SG_EIO, "%s", "x"), SG_EIO);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("core");
    TCase *tc = tcase_create("core");
    tcase_add_test(tc, arena_pieces_keep_their_contents_and_alignment);
    tcase_add_test(tc, arena_rewind_gives_back_what_came_after_the_mark);
    tcase_add_test(tc, arrays_grow_and_keep);
    tcase_add_test(tc, philox_gives_the_published_words);
    tcase_add_test(tc, streams_repeat_and_differ_by_each_part_of_the_key);
    tcase_add_loop_test(tc, uniforms_are_made_of_two_words, 0, 2);
    tcase_add_loop_test(tc, uniforms_are_uniform_and_open, 0, 8);
    tcase_add_test(tc, output_replaces_only_when_committed);
    tcase_add_test(tc, output_failures_are_named);
    tcase_add_test(tc, a_file_size_limit_leaves_no_half_file);
    tcase_add_test(tc, folders_are_made_with_their_parents);
    tcase_add_test(tc, places_are_told_by_their_folders);
    tcase_add_test(tc, each_status_has_its_exit_code);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
