/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_tree_layout.c - tidy trees: nothing overlaps, parents are centred, order is kept, whatever the tree. */
#include "core/random.h"
#include "scene/tree_layout.h"
#include "tests/failing_malloc.h"
#include "tests/support.h"

#include <math.h>
#include <stdint.h>

enum { MANY = 100000 };
static const double GAP = 3;

/* Pre-order trees of n nodes: each node hangs below one on the path to the root, chosen by how far up it likes to go. */
static sg_tree_item *random_tree(gsl_rng *rng, size_t n, double up)
{
    sg_tree_item *items = calloc(n, sizeof *items);
    ck_assert_ptr_nonnull(items);
    for (size_t v = 0; v < n; v++) {
        size_t parent = v - 1;
        while (v > 0 && parent != 0 && sg_random_uniform(rng) < up)
            parent = items[parent].parent;
        items[v] = (sg_tree_item){v > 0 ? parent : SIZE_MAX, 20 * sg_random_uniform(rng), 50 * sg_random_uniform(rng), 0};
    }
    return items;
}

static size_t *depths_of(const sg_tree_item *items, size_t n)
{
    size_t *depth = calloc(n, sizeof *depth);
    ck_assert_ptr_nonnull(depth);
    for (size_t v = 1; v < n; v++)
        depth[v] = depth[items[v].parent] + 1;
    return depth;
}

/* In pre-order the nodes of one level come from left to right. */
static void check_levels(const sg_tree_item *items, size_t n, double width)
{
    size_t *depth = depths_of(items, n);
    double *end = malloc(n * sizeof *end), least = INFINITY, most = -INFINITY;
    for (size_t v = 0; v < n; v++)
        end[v] = -INFINITY;
    for (size_t v = 0; v < n; v++) {
        test_must(items[v].x - items[v].left >= end[depth[v]] + GAP - 1e-6);
        end[depth[v]] = items[v].x + items[v].right;
        least = fmin(least, items[v].x - items[v].left);
        most = fmax(most, items[v].x + items[v].right);
    }
    ck_assert_double_eq_tol(least, 0, 1e-6);
    ck_assert_double_eq_tol(most, width, 1e-6);
    free(depth);
    free(end);
}

static void check_centres(const sg_tree_item *items, size_t n)
{
    size_t *first = calloc(n, sizeof *first), *last = calloc(n, sizeof *last);
    for (size_t v = 1; v < n; v++) {
        const size_t p = items[v].parent;
        first[p] = first[p] == 0 ? v : first[p];
        last[p] = v;
    }
    for (size_t v = 0; v < n; v++)
        test_must(first[v] == 0 || fabs(items[v].x - (items[first[v]].x + items[last[v]].x) / 2) < 1e-6);
    free(first);
    free(last);
}

START_TEST(random_trees_are_tidy)
{
    sg_error err = SG_ERROR_INIT;
    gsl_rng *rng = sg_random_create((uint64_t)_i + 1);
    ck_assert_ptr_nonnull(rng);
    for (int round = 0; round < 60; round++) {
        const size_t n = 1 + gsl_rng_uniform_int(rng, 300);
        sg_tree_item *items = random_tree(rng, n, sg_random_uniform(rng));
        double width = NAN;
        ck_ok(sg_tree_layout(items, n, GAP, &width, &err));
        check_levels(items, n, width);
        check_centres(items, n);
        free(items);
    }
    gsl_rng_free(rng);
}
END_TEST

/* Bushy, deep, a chain, a star: in time that grows with the nodes, or this would not end. */
START_TEST(large_trees_are_tidy)
{
    static const double up[] = {0.5, 0.02, 0, 1, 0.9};
    sg_error err = SG_ERROR_INIT;
    gsl_rng *rng = sg_random_create((uint64_t)_i + 1);
    ck_assert_ptr_nonnull(rng);
    sg_tree_item *items = random_tree(rng, MANY, up[_i]);
    double width = NAN;
    ck_ok(sg_tree_layout(items, MANY, GAP, &width, &err));
    check_levels(items, MANY, width);
    check_centres(items, MANY);
    free(items);
    gsl_rng_free(rng);
}
END_TEST

/* A subtree is drawn the same wherever it stands when its neighbours do not reach into it, and a mirrored tree is mirrored. */
START_TEST(small_trees_look_as_they_should)
{
    sg_error err = SG_ERROR_INIT;
    double width;
    sg_tree_item three[] = {{SIZE_MAX, 5, 5, 0}, {0, 5, 5, 0}, {0, 5, 5, 0}, {0, 5, 5, 0}};
    ck_ok(sg_tree_layout(three, 4, 2, &width, &err));
    ck_assert(three[1].x == 5 && three[2].x == 17 && three[3].x == 29 && three[0].x == 17 && width == 34);
    /* Short siblings between two deep ones are spread evenly. */
    sg_tree_item spread[] = {{SIZE_MAX, 1, 1, 0}, {0, 1, 1, 0}, {1, 1, 1, 0}, {1, 1, 1, 0}, {1, 1, 1, 0}, {1, 1, 1, 0},
                             {0, 1, 1, 0},        {0, 1, 1, 0}, {0, 1, 1, 0}, {8, 1, 1, 0}, {8, 1, 1, 0}, {8, 1, 1, 0}, {8, 1, 1, 0}};
    ck_ok(sg_tree_layout(spread, 13, 1, &width, &err));
    const double step = spread[6].x - spread[1].x;
    ck_assert_double_eq_tol(step, 4, 1e-12);
    ck_assert_double_eq_tol(spread[7].x - spread[6].x, step, 1e-12);
    ck_assert_double_eq_tol(spread[8].x - spread[7].x, step, 1e-12);
    ck_assert_double_eq_tol(width, 23, 1e-12);
    check_centres(spread, 13);
}
END_TEST

START_TEST(what_is_no_tree_is_refused)
{
    sg_error err = SG_ERROR_INIT;
    double width;
    sg_tree_item items[] = {{SIZE_MAX, 1, 1, 0}, {0, 1, 1, 0}, {0, 1, 1, 0}, {1, 1, 1, 0}};
    ck_assert_int_eq(sg_tree_layout(items, 0, 1, &width, &err), SG_EINVAL);
    ck_assert_int_eq(sg_tree_layout(items, 4, 1, &width, &err), SG_EINVAL); /* the last one is not in pre-order */
    items[3].parent = 3;
    ck_assert_int_eq(sg_tree_layout(items, 4, 1, &width, &err), SG_EINVAL);
    items[0].parent = 0;
    ck_assert_int_eq(sg_tree_layout(items, 1, 1, &width, &err), SG_EINVAL);
    items[0].parent = SIZE_MAX;
    test_fail_allocation(0);
    ck_assert_int_eq(sg_tree_layout(items, 3, 1, &width, &err), SG_ENOMEM);
    ck_assert(test_allocation_failed());
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("tree_layout");
    TCase *tc = tcase_create("tree_layout");
    tcase_set_timeout(tc, 60);
    tcase_add_loop_test(tc, random_trees_are_tidy, 0, 20);
    tcase_add_loop_test(tc, large_trees_are_tidy, 0, 5);
    tcase_add_test(tc, small_trees_look_as_they_should);
    tcase_add_test(tc, what_is_no_tree_is_refused);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
