/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_known_truths.c - the shipped grammars keep what they promise: samples of arcade and office are lattices in which
 * each label that was placed is one cell, and which have one derivation; learning is measured against them. */
#include "core/random.h"
#include "parse/earley.h"
#include "parse/scene_lattice.h"
#include "scene/label_scene.h"
#include "tests/support.h"

#include <math.h>
#include <string.h>

typedef struct {
    sg_grammar *g;
    sg_split_form form;
    sg_arena *arena;
    gsl_rng *rng;
    sg_derivation d;
    sg_label_scene scene;
    sg_lattice lattice;
} fixture;

static fixture open_fixture(const char *name)
{
    sg_error err = SG_ERROR_INIT;
    char path[512];
    fixture f = {.arena = sg_arena_create(), .rng = sg_random_create(1)};
    snprintf(path, sizeof path, "%s/data/grammars/%s.sg", test_folder("SG_SOURCE_DIR"), name);
    ck_ok(sg_grammar_load(path, &f.g, &err));
    ck_ok(sg_split_form_of(f.g, f.arena, &f.form, &err));
    sg_derivation_init(&f.d, f.g);
    return f;
}

static void close_fixture(fixture *f)
{
    sg_label_scene_clear(&f->scene);
    sg_derivation_clear(&f->d);
    gsl_rng_free(f->rng);
    sg_arena_free(f->arena);
    sg_grammar_free(f->g);
}

static sg_cells sample(fixture *f, uint32_t i)
{
    sg_error err = SG_ERROR_INIT;
    sg_random_stream(f->rng, 1, i, 0);
    ck_ok(sg_derivation_sample(&f->d, f->rng, 10000, &err));
    ck_ok(sg_label_scene_interpret(&f->scene, &f->d, 300, 400, &err));
    ck_ok(sg_lattice_of_scene(&f->scene, f->g, 300, 400, f->arena, &f->lattice, &err));
    uint16_t map[64];
    ck_assert_uint_le(f->lattice.nlabels, 64);
    ck_assert_uint_eq(sg_lattice_map_labels(&f->lattice, f->form.terminal_names, f->form.nterminals, map), 0);
    const size_t n = f->lattice.width * f->lattice.height;
    uint16_t *labels = SG_NEW_ARRAY(f->arena, uint16_t, n);
    for (size_t k = 0; k < n; k++)
        labels[k] = map[f->lattice.labels[k]];
    return (sg_cells){f->lattice.width, f->lattice.height, labels, NULL};
}

START_TEST(samples_are_lattices_with_one_derivation)
{
    static const char *const names[] = {"arcade", "office"};
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(names[_i]);
    sg_parse_table *table = NULL;
    sg_chart *chart = NULL;
    ck_ok(sg_parse_table_create(&f.form, SG_CELL_MODE, &table, &err));
    ck_ok(sg_chart_create(&chart, &err));
    ck_assert(!sg_grammar_tied(f.g));
    for (uint32_t i = 0; i < 60; i++) {
        const sg_cells cells = sample(&f, i);
        ck_assert_uint_eq(cells.width * cells.height, f.scene.nrects);
        double inside = NAN, viterbi = NAN, prior = NAN;
        ck_ok(sg_earley_inside(table, &cells, chart, &inside, &err));
        ck_ok(sg_earley_viterbi(table, &cells, chart, &viterbi, &err));
        ck_ok(sg_derivation_log_prior(&f.d, &prior, &err));
        ck_assert_double_eq_tol(inside, prior, 1e-9);
        ck_assert_double_eq_tol(viterbi, prior, 1e-9);
    }
    sg_chart_free(chart);
    sg_parse_table_free(table);
    close_fixture(&f);
}
END_TEST

/* Windows of all floors stand above each other, one for each column, and each kind of house comes up. */
START_TEST(haussmannian_floors_are_aligned)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture("haussmann");
    ck_assert(sg_grammar_tied(f.g));
    size_t houses[8][8] = {{0}}, kinds = 0;
    const sg_sym window = sg_grammar_find(f.g, "window"), bay = sg_grammar_find(f.g, "Bay");
    for (uint32_t i = 0; i < 300; i++) {
        sg_random_stream(f.rng, 1, i, 0);
        ck_ok(sg_derivation_sample(&f.d, f.rng, 10000, &err));
        ck_ok(sg_label_scene_interpret(&f.scene, &f.d, 300, 400, &err));
        double left[8], top = -1;
        size_t columns = 0, floors = 0;
        for (size_t k = 0; k < f.scene.nrects; k++) {
            const sg_label_rect *r = f.scene.rects + k;
            const sg_node *parent = f.d.nodes + r->node - f.d.nodes[r->node].parent;
            if (r->label != window || parent->symbol != bay)
                continue;
            if (floors == 0 || r->y0 != top)
                floors++;
            if (floors == 1)
                left[columns++] = r->x0;
            top = r->y0;
            bool aligned = false;
            for (size_t c = 0; c < columns; c++)
                aligned = aligned || left[c] == r->x0;
            ck_assert_msg(aligned, "sample %u: a window at %g", i, r->x0);
        }
        ck_assert(columns >= 3 && columns <= 6 && floors >= 4 && floors <= 6);
        kinds += houses[columns][floors]++ == 0;
    }
    ck_assert_uint_eq(kinds, 12);
    close_fixture(&f);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("known truths");
    TCase *tc = tcase_create("known truths");
    tcase_set_timeout(tc, 120);
    tcase_add_loop_test(tc, samples_are_lattices_with_one_derivation, 0, 2);
    tcase_add_test(tc, haussmannian_floors_are_aligned);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
