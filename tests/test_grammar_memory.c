/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_grammar_memory.c - every allocation of reading, converting and writing grammars fails once. Linked with --wrap, so
 * that the library's calls of malloc and its kin come here; jansson is told to allocate here too when it writes (when it
 * reads, it reports most failed allocations as syntax errors). */
#include "grammar/split.h"

#include "tests/grammar_support.h"

#include <jansson.h>

static long allowed = -1; /* allocations that still succeed; negative: all */

void *__real_malloc(size_t size);
void *__real_calloc(size_t n, size_t size);
void *__real_realloc(void *p, size_t size);
void *__real_aligned_alloc(size_t alignment, size_t size);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t n, size_t size);
void *__wrap_realloc(void *p, size_t size);
void *__wrap_aligned_alloc(size_t alignment, size_t size);

static bool refuse(void)
{
    if (allowed < 0)
        return false;
    return allowed == 0 || allowed-- == 0;
}

void *__wrap_malloc(size_t size)
{
    return refuse() ? NULL : __real_malloc(size);
}

void *__wrap_calloc(size_t n, size_t size)
{
    return refuse() ? NULL : __real_calloc(n, size);
}

void *__wrap_realloc(void *p, size_t size)
{
    return refuse() ? NULL : __real_realloc(p, size);
}

void *__wrap_aligned_alloc(size_t alignment, size_t size)
{
    return refuse() ? NULL : __real_aligned_alloc(alignment, size);
}

static const char language[] =
    "grammar g limit depth 3 tied weights const k = 2 function f(a) = a + k label wall #ff0000 label sky start A(f(1)) "
    "rule A(x) if x > 0 -> x + 1 : s ~ normal(x, 1) draw(mixture((1, s, 1), (2, 0, 1))) [ B maybe(0.5) wall maybe(x / 9) A(x) ] C(uniform(0, 1)) "
    "-> 1 : split x { 3 : wall | ~2 : B | '0.1 : sky } repeat y 3 { B wall } components { top : wall | all : B } "
    "rule A(x) if x <= 0 -> insert(cube) set_material(oak) rule A(x) at limit -> draw(0.1) "
    "rule B -> 0.5 : split y { wall | sky } sizes mean (0.5, 0.5) covariance ((0.01)) examples ((0.4, 0.6)) "
    "-> 0.5 : split y { wall | sky | sky } sizes mean (0.5, 0.3, 0.2) sd (0.1, 0.1, 0.1) "
    "rule C(u) if u < 2 -> u - 0.5 : nothing -> 1 : nothing rule C(u) if u > 2 -> nothing";

static const char exchange[] =
    "{\"format\":\"shapegram-grammar\",\"version\":1,\"name\":\"n\",\"tied\":true,\"axiom\":\"S\",\"terminals\":[{\"name\":\"w\",\"color\":\"#ff0000\"},{\"name\":\"A\"}],"
    "\"rules\":[{\"lhs\":\"S\",\"op\":\"split-y\",\"rhs\":[\"A\",\"w\"],\"probability\":0.5,"
    "\"attributes\":[[0.2,0.8],[0.25,0.75]],\"mean\":[0.225,0.775],\"covariance\":[[0.00125]]},"
    "{\"lhs\":\"S\",\"op\":\"split-x\",\"rhs\":[\"w\"],\"probability\":0.5},"
    "{\"lhs\":\"A\",\"op\":\"terminal\",\"rhs\":[\"w\"],\"probability\":1.0},"
    "{\"lhs\":\"w\",\"op\":\"terminal\",\"rhs\":[\"w\"],\"probability\":1}]}";

/* Reads a text; with the first `n` allocations only. */
static sg_status read_with(long n, const char *text, sg_grammar **out, sg_error *err)
{
    allowed = n;
    const sg_status st = sg_grammar_parse(text, strlen(text), "test", out, err);
    allowed = -1;
    return st;
}

static void fail_once_each(const char *text)
{
    long n = 0;
    for (;; n++) {
        sg_error err = SG_ERROR_INIT;
        sg_grammar *g = NULL;
        const sg_status st = read_with(n, text, &g, &err);
        sg_grammar_free(g);
        if (st == SG_OK)
            break;
        ck_assert_msg(st == SG_ENOMEM, "allocation %ld: status %d: %s", n, (int)st, err.msg);
        ck_assert_ptr_null(g);
        ck_assert_str_eq(err.msg, "out of memory");
    }
    ck_assert_int_ge(n, 10);
}

START_TEST(reading_survives_failed_allocations)
{
    fail_once_each(_i == 0 ? language : exchange);
}
END_TEST

static void *jansson_malloc(size_t size)
{
    return __wrap_malloc(size);
}

START_TEST(writing_survives_failed_allocations)
{
    sg_error err = SG_ERROR_INIT;
    sg_grammar *g = NULL;
    ck_ok(sg_grammar_parse(exchange, strlen(exchange), "test", &g, &err));
    FILE *out = fopen("/dev/null", "w");
    ck_assert_ptr_nonnull(out);
    setvbuf(out, NULL, _IONBF, 0);
    json_set_alloc_funcs(jansson_malloc, free); /* a process of its own: nobody else sees it */
    sg_status st = SG_ENOMEM;
    for (long n = 0; st != SG_OK; n++) {
        sg_arena *arena = sg_arena_create();
        sg_split_form form;
        allowed = n;
        st = sg_split_form_of(g, arena, &form, &err);
        if (st == SG_OK)
            st = sg_split_form_write_json(&form, out, &err);
        allowed = -1;
        ck_assert(st == SG_OK || st == SG_ENOMEM);
        sg_arena_free(arena);
    }
    fclose(out);
    sg_grammar_free(g);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("grammar_memory");
    TCase *tc = tcase_create("memory");
    tcase_set_timeout(tc, 120);
    tcase_add_loop_test(tc, reading_survives_failed_allocations, 0, 2);
    tcase_add_test(tc, writing_survives_failed_allocations);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
