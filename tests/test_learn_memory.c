/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_learn_memory.c - learning when memory runs out at any point: the status says so, and nothing is lost or used
 * after. */
#include "config.h"

#include "learn/learn.h"
#include "tests/failing_malloc.h"
#include "tests/learn_support.h"
#include "tests/support.h"

#include <string.h>

enum { LATTICES = 5 };

static const sg_learn_opts *variant(int i)
{
    static sg_learn_opts o;
    const sg_learn_opts plain = SG_LEARN_OPTS_INIT;
    o = plain;
    o.best_regroup = i == 0;
    o.incorporate.regroup = (sg_regroup_kind)(i % 3);
    o.search.kind = (sg_search_kind)(i % 4);
    o.search.width = 3;
    o.search.walks = 2;
    o.search.chunk = i == 4;
    o.reestimate_every = i % 2 == 1;
    o.energy.weight = 1;
    return &o;
}

/* Check allocates too: nothing is asserted while an allocation is to fail. */
static sg_status learn_once(const sg_lattice *lattices, const sg_learn_opts *o, size_t fail_at, int *failed)
{
    sg_error err = SG_ERROR_INIT;
    sg_learn_result r;
    sg_arena *a = sg_arena_create();
    test_fail_allocation(fail_at);
    const sg_status st = sg_learn(lattices, LATTICES, o, a, &r, &err);
    *failed = test_allocation_failed();
    if (st == SG_OK)
        sg_learn_result_clear(&r);
    sg_arena_free(a);
    return st;
}

START_TEST(learning_survives_any_failed_allocation)
{
    sg_arena *a = sg_arena_create();
    gsl_rng *rng = sg_random_create(17);
    sg_lattice lattices[LATTICES];
    for (int i = 0; i < LATTICES; i++)
        lattices[i] = test_random_facade(rng, a, 0.05);
    size_t failures = 0;
    int failed = 1;
    /* every allocation at first, then fewer and fewer: the same ones come again and again */
    for (size_t k = 0; failed; k += 1 + k / 60) {
        const sg_status st = learn_once(lattices, variant(_i), k, &failed);
        ck_assert_msg(st == (failed ? SG_ENOMEM : SG_OK), "allocation %zu: status %d", k, (int)st);
        failures += failed != 0;
    }
    ck_assert_uint_gt(failures, 50);
    gsl_rng_free(rng);
    sg_arena_free(a);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("learn_memory");
    TCase *tc = tcase_create("learn_memory");
    tcase_set_timeout(tc, 120);
    tcase_add_loop_test(tc, learning_survives_any_failed_allocation, 0, 6);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
