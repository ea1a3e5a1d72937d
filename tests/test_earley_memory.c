/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_earley_memory.c - parses when memory runs out at any point: a status, nothing lost, and a chart that parses on.
 */
#include "parse/earley_em.h"
#include "tests/earley_oracle.h"
#include "tests/failing_malloc.h"
#include "tests/support.h"

#include <math.h>
#include <string.h>

/* Arenas take their blocks from here. */
void *__real_aligned_alloc(size_t alignment, size_t n);
void *__wrap_aligned_alloc(size_t alignment, size_t n);

void *__wrap_aligned_alloc(size_t alignment, size_t n)
{
    return test_allocations++ == test_fail_at ? NULL : __real_aligned_alloc(alignment, n);
}

enum { SIDE = 9 };

/* Check allocates too, so nothing is asserted while an allocation is to fail. */
typedef struct {
    oracle_grammar g;
    uint16_t labels[SIDE * SIDE];
    double costs[2 * SIDE * SIDE];
    sg_leaf_mode mode;
    sg_parse_table *table;
    sg_chart *chart;
    double value, counts[ORACLE_RULES];
} fixture;

typedef sg_status operation(fixture *f, sg_error *err);

/* Unit cycles, ambiguity, and more predictions than the first hash table holds. */
static void make_grammar(fixture *f, bool tied)
{
    oracle_begin(&f->g, 3, 2);
    oracle_rule(&f->g, 0, SG_SPLIT_Y, 2, (uint32_t[]){1, 0}, 0.25);
    oracle_rule(&f->g, 0, SG_SPLIT_X, 3, (uint32_t[]){0, 0, 0}, 0.25);
    oracle_rule(&f->g, 0, SG_SPLIT_X, 1, (uint32_t[]){1}, 0.5);
    oracle_rule(&f->g, 1, SG_SPLIT_Y, 1, (uint32_t[]){0}, 0.1);
    oracle_rule(&f->g, 1, SG_SPLIT_X, 2, (uint32_t[]){2, 1}, 0.4);
    oracle_rule(&f->g, 1, SG_SPLIT_LEXICAL, 1, (uint32_t[]){0}, 0.5);
    oracle_rule(&f->g, 2, SG_SPLIT_LEXICAL, 1, (uint32_t[]){0}, 0.5);
    oracle_rule(&f->g, 2, SG_SPLIT_LEXICAL, 1, (uint32_t[]){1}, 0.5);
    f->g.form.tied = tied;
    for (size_t i = 0; i < SIDE * SIDE; i++) {
        f->labels[i] = i % 5 == 3 && i % SIDE != SIDE - 1;
        f->costs[i] = (double)(i % 7);
        f->costs[SIDE * SIDE + i] = (double)(i % 11) + 60;
    }
}

static sg_status create_table(fixture *f, sg_error *err)
{
    sg_parse_table *t = NULL;
    const sg_status st = sg_parse_table_create(&f->g.form, f->mode, &t, err);
    sg_parse_table_free(t);
    return st;
}

static sg_status create_chart(fixture *f, sg_error *err)
{
    sg_chart *c = NULL;
    (void)f;
    const sg_status st = sg_chart_create(&c, err);
    sg_chart_free(c);
    return st;
}

static sg_status expect_labels(fixture *f, sg_error *err)
{
    const sg_cells cells = {SIDE, SIDE, f->labels, NULL};
    memset(f->counts, 0, sizeof f->counts);
    SG_TRY(sg_earley_inside(f->table, &cells, f->chart, &f->value, err));
    return sg_earley_expected_counts(f->table, f->chart, f->counts, err);
}

static sg_status derive_labels(fixture *f, sg_error *err)
{
    const sg_cells cells = {SIDE, SIDE, f->labels, NULL};
    sg_parse_node *nodes = NULL;
    size_t n;
    memset(f->counts, 0, sizeof f->counts);
    SG_TRY(sg_earley_viterbi(f->table, &cells, f->chart, &f->value, err));
    SG_TRY(sg_earley_viterbi_counts(f->table, f->chart, f->counts, err));
    const sg_status st = sg_earley_viterbi_tree(f->table, f->chart, &nodes, &n, err);
    free(nodes);
    return st;
}

static sg_status derive_costs(fixture *f, sg_error *err)
{
    const sg_cells cells = {SIDE, SIDE, NULL, f->costs};
    memset(f->counts, 0, sizeof f->counts);
    SG_TRY(sg_earley_viterbi(f->table, &cells, f->chart, &f->value, err));
    return sg_earley_viterbi_counts(f->table, f->chart, f->counts, err);
}

static sg_status reestimate(fixture *f, sg_error *err)
{
    const sg_cells cells[2] = {{3, 2, f->labels, NULL}, {1, 2, f->labels, NULL}};
    sg_em_opts opts = SG_EM_OPTS_INIT;
    opts.mode = f->mode;
    opts.iterations = 2;
    return sg_em_reestimate(&f->g.form, cells, 2, &opts, NULL, f->counts, NULL, NULL, err);
}

/* Fail each allocation of the operation in turn, in the chart that the failures before were in; in between, and at the
 * end, the result must be the one without failures. */
static void fail_each(fixture *f, operation *run)
{
    sg_error err = SG_ERROR_INIT;
    double want[ORACLE_RULES];
    ck_ok(sg_chart_create(&f->chart, &err));
    ck_ok(run(f, &err));
    memcpy(want, f->counts, sizeof want);
    const double value = f->value;
    for (size_t k = 0;; k += 1 + k / 20) { /* with --enable-arena-debug there are thousands */
        sg_chart_free(f->chart);
        ck_ok(sg_chart_create(&f->chart, &err));
        test_fail_allocation(k);
        const sg_status st = run(f, &err);
        if (!test_allocation_failed()) {
            ck_assert_int_eq(st, SG_OK);
            ck_assert_uint_gt(k, 0);
            break;
        }
        ck_assert_msg(st == SG_ENOMEM, "allocation %zu: status %d: %s", k, (int)st, err.msg);
        if (k % 3 != 0)
            continue;
        ck_ok(run(f, &err));
        ck_assert(f->value == value);
        ck_assert_mem_eq(f->counts, want, sizeof want);
    }
    sg_chart_free(f->chart);
}

static operation *const OPERATIONS[] = {create_table,  create_chart, expect_labels,
                                        derive_labels, derive_costs, reestimate};

START_TEST(each_allocation_may_fail)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = {.mode = _i % 2 == 0 ? SG_CELL_MODE : SG_REGION_MODE};
    make_grammar(&f, false);
    ck_ok(sg_parse_table_create(&f.g.form, f.mode, &f.table, &err));
    fail_each(&f, OPERATIONS[_i / 2]);
    sg_parse_table_free(f.table);
}
END_TEST

START_TEST(each_allocation_may_fail_with_tied_siblings)
{
    static operation *const tied[] = {create_table, expect_labels, derive_labels};
    sg_error err = SG_ERROR_INIT;
    fixture f = {.mode = SG_CELL_MODE};
    make_grammar(&f, true);
    ck_ok(sg_parse_table_create(&f.g.form, f.mode, &f.table, &err));
    fail_each(&f, tied[_i]);
    sg_parse_table_free(f.table);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("earley_memory");
    TCase *tc = tcase_create("earley_memory");
    tcase_set_timeout(tc, 60);
    tcase_add_loop_test(tc, each_allocation_may_fail, 0, 12);
    tcase_add_loop_test(tc, each_allocation_may_fail_with_tied_siblings, 0, 3);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
