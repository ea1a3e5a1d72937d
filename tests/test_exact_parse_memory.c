/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_exact_parse_memory.c - exact parsing when memory runs out at any point: a status, and nothing left. */
#include "parse/exact_parse.h"
#include "tests/failing_malloc.h"
#include "tests/support.h"

#include <string.h>

/* Arenas take their blocks from here. */
void *__real_aligned_alloc(size_t alignment, size_t n);
void *__wrap_aligned_alloc(size_t alignment, size_t n);

void *__wrap_aligned_alloc(size_t alignment, size_t n)
{
    return test_allocations++ == test_fail_at ? NULL : __real_aligned_alloc(alignment, n);
}

enum { SIDE = 24 };

static const char text[] = "tied\nlabel a\nlabel b\nstart S\n"
                           "rule S -> split y { F | a | F } sizes mean (0.4, 0.2, 0.4) sd (0.1, 0.1, 0.1)\n"
                           "rule F\n"
                           "  -> 0.5 : split x { a | C | a } sizes mean (0.3, 0.4, 0.3) sd (0.1, 0.1, 0.1)\n"
                           "  -> 0.5 : split x { b | a } sizes mean (0.5, 0.5) sd (0.1, 0.1)\n"
                           "rule C -> split y { a | b } sizes mean (0.5, 0.5) sd (0.1, 0.1)\n";

START_TEST(parsing_survives_any_failed_allocation)
{
    sg_error err = SG_ERROR_INIT;
    sg_grammar *g = NULL;
    sg_float_map costs;
    uint32_t channel[16] = {0};
    ck_ok(sg_grammar_parse(text, strlen(text), "test", &g, &err));
    ck_ok(sg_float_map_create(2, SIDE, SIDE, &costs, &err));
    channel[sg_grammar_find(g, "b")] = 1;
    for (size_t i = 0; i < 2 * SIDE * SIDE; i++)
        costs.values[i] = (float)((i * 7919 + i / SIDE) % 5);
    const sg_exact_opts opts = {0.1, 60, true, 3};
    size_t failures = 0;
    for (size_t k = 0;; k++) {
        sg_exact_result r;
        test_fail_allocation(k);
        const sg_status st = sg_exact_parse(g, &costs, channel, &opts, &r, &err);
        const bool failed = test_allocation_failed();
        ck_assert_int_eq(st, failed ? SG_ENOMEM : SG_OK);
        ck_assert_int_eq(r.derivation.nnodes == 0, failed);
        sg_exact_result_clear(&r);
        failures += failed;
        if (!failed)
            break;
    }
    ck_assert_uint_gt(failures, 50);
    sg_float_map_clear(&costs);
    sg_grammar_free(g);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("exact_parse_memory");
    TCase *tc = tcase_create("exact_parse_memory");
    tcase_set_timeout(tc, 60);
    tcase_add_test(tc, parsing_survives_any_failed_allocation);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
