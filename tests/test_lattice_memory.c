/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_lattice_memory.c - lattices when memory runs out at any point: a status, nothing lost, nothing half made. */
#include "image/classes.h"
#include "parse/lattice_draw.h"
#include "parse/lattice_fit.h"
#include "parse/lattice_loss.h"
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

enum { WIDTH = 70, HEIGHT = 50 };

static uint8_t labels[WIDTH * HEIGHT];
static float costs[3 * WIDTH * HEIGHT];

static void make_map(void)
{
    for (size_t i = 0; i < WIDTH * HEIGHT; i++) {
        const size_t x = i % WIDTH, y = i / WIDTH;
        labels[i] = (uint8_t)((x / 9 + y / 11 + (x * y % 97 == 0)) % 3);
        if (x > 60 && y > 40)
            labels[i] = SG_CLASS_IGNORE;
        for (size_t c = 0; c < 3; c++)
            costs[c * WIDTH * HEIGHT + i] = labels[i] != c && labels[i] != SG_CLASS_IGNORE;
    }
}

/* Check allocates too, so nothing is asserted while an allocation is to fail. Each operation has its own arena. */
typedef sg_status operation(sg_arena *arena, sg_error *err);

static sg_status parse(sg_arena *arena, sg_error *err)
{
    static const char text[] = "lattice 3 2\nx 0 10 25 31\ny 0 4 9\na b c\nd e f\n";
    sg_lattice l, copy;
    SG_TRY(sg_lattice_parse("F", text, sizeof text - 1, arena, &l, err));
    SG_TRY(sg_lattice_copy(&l, arena, &copy, err));
    return sg_lattice_equal(&l, &copy) ? SG_OK : SG_ENUMERIC;
}

typedef sg_status fit_call(sg_lattice_problem *p, sg_arena *arena, sg_lattice_fit *f, sg_error *err);

static sg_status with_problem(const sg_lattice_fit_opts *opts, const float *with_costs, fit_call *call, sg_arena *arena,
                              sg_lattice_fit *f, sg_error *err)
{
    const sg_lattice_source source = {WIDTH, HEIGHT, 3, labels, with_costs};
    sg_lattice_problem *p = NULL;
    SG_TRY(sg_lattice_problem_create(&source, opts, &p, err));
    const sg_status st = call(p, arena, f, err);
    sg_lattice_problem_free(p);
    return st;
}

static sg_status call_length(sg_lattice_problem *p, sg_arena *arena, sg_lattice_fit *f, sg_error *err)
{
    return sg_lattice_fit_length(p, arena, f, err);
}

static sg_status call_cells(sg_lattice_problem *p, sg_arena *arena, sg_lattice_fit *f, sg_error *err)
{
    return sg_lattice_fit_cells(p, 20, arena, f, err);
}

static sg_status call_common(sg_lattice_problem *p, sg_arena *arena, sg_lattice_fit *f, sg_error *err)
{
    double share = 0;
    SG_TRY(sg_lattice_common_price(&p, 1, 0, 0.9, 1, NULL, &share, err));
    return sg_lattice_fit_share(p, share, arena, f, err);
}

static const sg_lattice_fit_opts USUAL = SG_LATTICE_FIT_OPTS_INIT;

static sg_status fit_length(sg_arena *arena, sg_error *err)
{
    sg_lattice_fit f;
    return with_problem(&USUAL, NULL, call_length, arena, &f, err);
}

static sg_status fit_cells(sg_arena *arena, sg_error *err)
{
    const sg_lattice_fit_opts few = {.max_candidates = 8, .persistence = 0.02, .min_run = 4, .max_places = 12, .starts = 2};
    sg_lattice_fit f;
    return with_problem(&few, NULL, call_cells, arena, &f, err);
}

static sg_status fit_common(sg_arena *arena, sg_error *err)
{
    sg_lattice_fit f;
    return with_problem(&USUAL, NULL, call_common, arena, &f, err);
}

static sg_status fit_costs(sg_arena *arena, sg_error *err)
{
    sg_lattice_fit f;
    return with_problem(&USUAL, costs, call_length, arena, &f, err);
}

static sg_status draw_and_lose(sg_arena *arena, sg_error *err)
{
    static const char *names[] = {"a", "b", "c"};
    static const uint32_t colors[] = {1, 2, 3};
    static const uint8_t identity[] = {0, 1, 2};
    const sg_lattice_source source = {WIDTH, HEIGHT, 3, labels, NULL};
    const sg_label_map map = {WIDTH, HEIGHT, labels};
    sg_lattice_fit f;
    sg_lattice l;
    sg_lattice_loss loss;
    SG_TRY(with_problem(&USUAL, NULL, call_length, arena, &f, err));
    SG_TRY(sg_lattice_from_fit(&f, names, 3, arena, &l, err));
    SG_TRY(sg_lattice_loss_create(3, arena, &loss, err));
    SG_TRY(sg_lattice_loss_add(&source, &f, arena, &loss, err));
    sg_image im = {0, 0, NULL};
    SG_TRY(sg_lattice_draw(&l, colors, 2, &im, err));
    sg_image_clear(&im);
    SG_TRY(sg_lattice_draw_errors(&l, identity, &map, colors, 1, &im, err));
    sg_image_clear(&im);
    sg_label_map painted = {0, 0, NULL};
    SG_TRY(sg_lattice_paint(&l, identity, &painted, err));
    sg_label_map_clear(&painted);
    return SG_OK;
}

static operation *const OPERATIONS[] = {parse, fit_length, fit_cells, fit_common, fit_costs, draw_and_lose};

START_TEST(every_allocation_may_fail)
{
    make_map();
    int failed = 1;
    for (size_t k = 0; failed; k += 1 + k / 100) { /* with a debugging arena there are thousands */
        sg_arena *arena = sg_arena_create();
        ck_assert_ptr_nonnull(arena);
        sg_error err = SG_ERROR_INIT;
        test_fail_allocation(k);
        const sg_status st = OPERATIONS[_i](arena, &err);
        failed = test_allocation_failed();
        sg_arena_free(arena);
        ck_assert_msg(st == (failed ? SG_ENOMEM : SG_OK), "allocation %zu: status %d: %s", k, (int)st, err.msg);
        ck_assert(st == SG_OK || err.msg[0] != '\0');
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("lattice_memory");
    TCase *tc = tcase_create("memory");
    tcase_set_timeout(tc, 120);
    tcase_add_loop_test(tc, every_allocation_may_fail, 0, (int)(sizeof OPERATIONS / sizeof *OPERATIONS));
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
