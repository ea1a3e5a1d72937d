/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_lattice_fit.c - fitting lattices to label maps: the parts against brute force, the whole by its properties. */
#include "core/random.h"
#include "image/classes.h"
#include "parse/lattice_draw.h"
#include "parse/lattice_fit.h"
#include "parse/lattice_priv.h"
#include "tests/support.h"

#include <math.h>
#include <string.h>

static sg_arena *arena;
static gsl_rng *rng;
static sg_error err;

static void set_up(void)
{
    arena = sg_arena_create();
    rng = sg_random_create(1);
    ck_assert(arena != NULL && rng != NULL);
}

static void tear_down(void)
{
    sg_arena_free(arena);
    gsl_rng_free(rng);
}

static size_t draw(size_t low, size_t high)
{
    return low + gsl_rng_uniform_int(rng, high - low + 1);
}

/* A random map; `sameness` is the share of pixels that repeat the one to the left or above. */
static sg_lattice_source random_map(size_t width, size_t height, size_t nclasses, double sameness, double ignored)
{
    uint8_t *labels = sg_arena_alloc(arena, width * height);
    ck_assert_ptr_nonnull(labels);
    for (size_t i = 0; i < width * height; i++) {
        const size_t x = i % width, y = i / width;
        labels[i] = (uint8_t)gsl_rng_uniform_int(rng, nclasses);
        if (gsl_rng_uniform(rng) < sameness && i > 0)
            labels[i] = labels[x > 0 && (y == 0 || gsl_rng_uniform(rng) < 0.5) ? i - 1 : y > 0 ? i - width : i - 1];
        if (gsl_rng_uniform(rng) < ignored && i > 0)
            labels[i] = SG_CLASS_IGNORE;
    }
    if (labels[0] == SG_CLASS_IGNORE)
        labels[0] = 0;
    return (sg_lattice_source){width, height, nclasses, labels, NULL};
}

static void add_random_costs(sg_lattice_source *s)
{
    float *costs = SG_NEW_ARRAY(arena, float, s->nclasses * s->width * s->height);
    for (size_t c = 0; c < s->nclasses; c++)
        for (size_t i = 0; i < s->width * s->height; i++)
            costs[c * s->width * s->height + i] =
                s->labels[i] == SG_CLASS_IGNORE ? 0 : (float)(gsl_rng_uniform(rng) + (s->labels[i] != c));
    s->costs = costs;
}

static sg_axis axis_of(const sg_lattice_source *s)
{
    return (sg_axis){s->width, s->height, s->nclasses, s->labels, s->costs};
}

static sg_places places_of(const uint32_t *at, size_t n)
{
    return (sg_places){n, sg_arena_copy(arena, at, n * sizeof *at)};
}

/* 0, some of 1..length-1, length. */
static sg_places random_places(size_t length, double share)
{
    uint32_t at[64];
    size_t n = 0;
    for (size_t p = 0; p <= length; p++)
        if (p == 0 || p == length || gsl_rng_uniform(rng) < share)
            at[n++] = (uint32_t)p;
    return places_of(at, n);
}

static sg_places subset(size_t length, unsigned mask)
{
    uint32_t at[32];
    size_t n = 0;
    for (size_t p = 0; p <= length; p++)
        if (p == 0 || p == length || (mask >> (p - 1) & 1))
            at[n++] = (uint32_t)p;
    return places_of(at, n);
}

/* The slow, obvious gain of a rectangle. */
static double gain_of(const sg_axis *a, uint32_t p0, uint32_t p1, uint32_t q0, uint32_t q1)
{
    double best = -INFINITY;
    for (size_t c = 0; c < a->nclasses; c++) {
        double gain = 0;
        for (uint32_t q = q0; q < q1; q++)
            for (uint32_t p = p0; p < p1; p++)
                gain += a->costs != NULL ? -(double)a->costs[(c * a->breadth + q) * a->length + p]
                                         : (double)(a->labels[q * a->length + p] == c);
        best = gain > best ? gain : best;
    }
    return best;
}

static double gain_of_cuts(const sg_axis *a, const sg_places *cuts, const sg_places *strips)
{
    double gain = 0;
    for (size_t i = 0; i + 1 < cuts->n; i++)
        for (size_t j = 0; j + 1 < strips->n; j++)
            gain += gain_of(a, cuts->at[i], cuts->at[i + 1], strips->at[j], strips->at[j + 1]);
    return gain;
}

static double best_by_enumeration(const sg_axis *a, const sg_places *strips, double penalty)
{
    double best = -INFINITY;
    for (unsigned mask = 0; mask < 1u << (a->length - 1); mask++) {
        const sg_mark mark = sg_arena_mark(arena);
        const sg_places cuts = subset(a->length, mask);
        const double value = gain_of_cuts(a, &cuts, strips) - penalty * (double)(cuts.n - 1);
        best = value > best ? value : best;
        sg_arena_rewind(arena, mark);
    }
    return best;
}

START_TEST(dynamic_program_equals_enumeration)
{
    gsl_rng_set(rng, (unsigned long)_i + 1);
    sg_lattice_source s = random_map(draw(1, 8), draw(1, 6), draw(1, 4), gsl_rng_uniform(rng), _i % 3 == 0 ? 0.2 : 0);
    const bool costs = _i % 2 == 1;
    if (costs)
        add_random_costs(&s);
    const sg_axis a = axis_of(&s);
    const sg_places all = subset(a.length, ~0u), strips = random_places(a.breadth, 0.5);
    const double penalty = _i % 5 == 0 ? 0 : 3 * gsl_rng_uniform(rng);
    sg_strip_table t;
    ck_ok(sg_strip_table_create(&a, &all, &strips, arena, &t, &err));
    sg_places cuts;
    double value;
    ck_ok(sg_cuts_solve(&t, penalty, arena, &cuts, &value, &err));
    const double tolerance = costs ? 1e-4 : 1e-9;
    ck_assert_double_eq_tol(value, best_by_enumeration(&a, &strips, penalty), tolerance);
    ck_assert_double_eq_tol(value, gain_of_cuts(&a, &cuts, &strips) - penalty * (double)(cuts.n - 1), tolerance);

    /* sums over some places and strips are those of the pixels */
    const sg_places fine = subset(a.breadth, ~0u), some = random_places(a.length, 0.5);
    sg_strip_table base, coarse, direct;
    ck_ok(sg_strip_table_create(&a, &all, &fine, arena, &base, &err));
    ck_ok(sg_strip_table_coarsen(&base, &fine, &some, &strips, arena, &coarse, &err));
    ck_ok(sg_strip_table_create(&a, &some, &strips, arena, &direct, &err));
    for (size_t i = 0; i + 1 < some.n; i++)
        ck_assert_double_eq_tol(sg_strip_table_gain(&coarse, i, some.n - 1),
                                sg_strip_table_gain(&direct, i, some.n - 1), tolerance);

    /* places with equal pixels on both sides are never needed */
    sg_places knots;
    double value_knots;
    ck_ok(sg_axis_knots(&a, 100, arena, &knots, &err));
    ck_ok(sg_strip_table_create(&a, &knots, &strips, arena, &t, &err));
    ck_ok(sg_cuts_solve(&t, penalty, arena, &cuts, &value_knots, &err));
    ck_assert_double_eq_tol(value, value_knots, tolerance);
}
END_TEST

/* How deep one must go from i before something higher comes (on a plateau: something as high that stands further left). */
static uint32_t persistence_of(const uint32_t *v, size_t n, size_t i)
{
    uint32_t deepest = v[i], saddle = 0;
    bool higher = false;
    for (int side = -1; side <= 1; side += 2) {
        uint32_t lowest = v[i];
        for (size_t j = i + (size_t)side; j < n; j += (size_t)side) {
            lowest = v[j] < lowest ? v[j] : lowest;
            if (v[j] > v[i] || (v[j] == v[i] && j < i)) {
                saddle = !higher || lowest > saddle ? lowest : saddle;
                higher = true;
                break;
            }
        }
    }
    if (higher)
        return v[i] - saddle;
    for (size_t j = 0; j < n; j++)
        deepest = v[j] < deepest ? v[j] : deepest;
    return v[i] - deepest;
}

START_TEST(persistence_equals_its_definition)
{
    gsl_rng_set(rng, (unsigned long)_i + 1);
    uint32_t value[40], persistence[40];
    const size_t n = draw(1, 40), range = draw(1, 20);
    for (size_t i = 0; i < n; i++)
        value[i] = (uint32_t)draw(0, range);
    ck_ok(sg_persistence(value, n, arena, persistence, &err));
    for (size_t i = 0; i < n; i++)
        ck_assert_uint_eq(persistence[i], persistence_of(value, n, i));
}
END_TEST

START_TEST(evidence_passes_over_ignored_pixels_and_knows_no_numbering)
{
    const uint8_t I = SG_CLASS_IGNORE;
    const uint8_t labels[] = {0, 0, 1, 1, I, 1, 2, /**/ 0, 0, I, I, 1, 2, 2, /**/ I, 3, 0, 0, 0, 0, 0};
    const sg_axis a = {7, 3, 4, labels, NULL};
    uint32_t profile[8], run[8];
    ck_ok(sg_axis_evidence(&a, arena, profile, run, &err));
    const uint32_t expected[] = {0, 0, 2, 0, 1, 1, 1, 0};
    for (size_t p = 0; p < 8; p++)
        ck_assert_uint_eq(profile[p], expected[p]);
    ck_assert_uint_eq(run[2], 1);
    uint8_t renamed[sizeof labels];
    for (size_t i = 0; i < sizeof labels; i++)
        renamed[i] = labels[i] == I ? I : (uint8_t)(3 - labels[i]);
    const sg_axis b = {7, 3, 4, renamed, NULL};
    uint32_t profile_b[8], run_b[8];
    ck_ok(sg_axis_evidence(&b, arena, profile_b, run_b, &err));
    ck_assert_mem_eq(profile, profile_b, sizeof profile);
    ck_assert_mem_eq(run, run_b, sizeof run);
}
END_TEST

/* A grid in which neighbouring columns differ in some row, and neighbouring rows in some column. */
static sg_lattice random_grid(size_t max_cells, size_t min_px, size_t max_px, size_t nclasses)
{
    sg_lattice l;
    ck_ok(sg_lattice_create(draw(1, max_cells), draw(1, max_cells), arena, &l, &err));
    for (size_t i = 0; i < l.width; i++)
        l.x[i + 1] = l.x[i] + (uint32_t)draw(min_px, max_px);
    for (size_t i = 0; i < l.height; i++)
        l.y[i + 1] = l.y[i] + (uint32_t)draw(min_px, max_px);
    for (size_t i = 0; i < l.width * l.height; i++)
        l.labels[i] = (uint16_t)gsl_rng_uniform_int(rng, nclasses);
    /* along one row and one column neighbours always differ */
    for (size_t i = 1; i < l.width; i++)
        if (l.labels[i] == l.labels[i - 1])
            l.labels[i] = (uint16_t)((l.labels[i] + 1) % nclasses);
    for (size_t i = 1; i < l.height; i++)
        if (l.labels[i * l.width] == l.labels[(i - 1) * l.width])
            l.labels[i * l.width] = (uint16_t)((l.labels[i * l.width] + 1) % nclasses);
    return l;
}

static const uint8_t IDENTITY[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9};

static sg_lattice_source paint(const sg_lattice *l, size_t nclasses)
{
    sg_label_map map;
    ck_ok(sg_lattice_paint(l, IDENTITY, &map, &err));
    uint8_t *labels = sg_arena_copy(arena, map.labels, map.width * map.height);
    sg_label_map_clear(&map);
    return (sg_lattice_source){l->x[l->width], l->y[l->height], nclasses, labels, NULL};
}

static sg_lattice_fit fit(const sg_lattice_source *s, const sg_lattice_weights *w)
{
    const sg_lattice_fit_opts opts = SG_LATTICE_FIT_OPTS_INIT;
    sg_lattice_problem *p;
    ck_ok(sg_lattice_problem_create(s, &opts, &p, &err));
    sg_lattice_fit f;
    if (w != NULL)
        ck_ok(sg_lattice_fit_weights(p, w, arena, &f, &err));
    else
        ck_ok(sg_lattice_fit_length(p, arena, &f, &err));
    sg_lattice_problem_free(p);
    return f;
}

static void check_same(const sg_lattice *l, const sg_lattice_fit *f)
{
    ck_assert_uint_eq(l->width, f->width);
    ck_assert_uint_eq(l->height, f->height);
    ck_assert_mem_eq(l->x, f->x, (l->width + 1) * sizeof *l->x);
    ck_assert_mem_eq(l->y, f->y, (l->height + 1) * sizeof *l->y);
    for (size_t i = 0; i < l->width * l->height; i++)
        ck_assert_uint_eq(l->labels[i], f->classes[i]);
    ck_assert_uint_eq(f->wrong_px, 0);
}

START_TEST(grids_come_back_exactly)
{
    gsl_rng_set(rng, (unsigned long)_i + 1);
    const sg_lattice l = random_grid(14, 1, 20, 2 + (size_t)_i % 6);
    const sg_lattice_source s = paint(&l, 8);
    const sg_lattice_fit f = fit(&s, &(sg_lattice_weights){0.4, 0.4, 0});
    check_same(&l, &f);
    const sg_lattice_fit g = fit(&s, &(sg_lattice_weights){0, 0, 0.5 / 14});
    check_same(&l, &g);
}
END_TEST

START_TEST(description_length_finds_usual_grids_without_being_told_a_weight)
{
    gsl_rng_set(rng, (unsigned long)_i + 1);
    const sg_lattice l = random_grid(12, 8, 30, 5);
    const sg_lattice_source s = paint(&l, 7);
    const sg_lattice_fit f = fit(&s, NULL);
    check_same(&l, &f);
}
END_TEST

START_TEST(grids_come_back_through_ignored_pixels)
{
    gsl_rng_set(rng, (unsigned long)_i + 1);
    const sg_lattice l = random_grid(8, 8, 20, 4);
    sg_lattice_source s = paint(&l, 4);
    uint8_t *labels = sg_arena_copy(arena, s.labels, s.width * s.height);
    for (size_t i = 0; i < s.width * s.height; i++)
        if (gsl_rng_uniform(rng) < 0.1)
            labels[i] = SG_CLASS_IGNORE;
    s.labels = labels;
    const sg_lattice_fit f = fit(&s, &(sg_lattice_weights){0.4, 0.4, 0});
    check_same(&l, &f);
}
END_TEST

START_TEST(lines_are_placed_within_noise)
{
    /* 8 % of the pixels have a random label: a line stands where a share of the pixels can only guess, but never far */
    gsl_rng_set(rng, (unsigned long)_i + 1);
    const sg_lattice l = random_grid(6, 12, 30, 4);
    sg_lattice_source s = paint(&l, 4);
    uint8_t *labels = sg_arena_copy(arena, s.labels, s.width * s.height);
    for (size_t i = 0; i < s.width * s.height; i++)
        if (gsl_rng_uniform(rng) < 0.08)
            labels[i] = (uint8_t)gsl_rng_uniform_int(rng, 4);
    s.labels = labels;
    const sg_lattice_fit f = fit(&s, &(sg_lattice_weights){8, 8, 0});
    ck_assert_uint_eq(l.width, f.width);
    ck_assert_uint_eq(l.height, f.height);
    for (size_t i = 0; i <= l.width; i++)
        ck_assert_int_le(abs((int)l.x[i] - (int)f.x[i]), 1);
    for (size_t i = 0; i < l.width * l.height; i++)
        ck_assert_uint_eq(l.labels[i], f.classes[i]);
}
END_TEST

/* Everything that a fit says of itself, counted again from the painted lattice. */
static void check_account(const sg_lattice_source *s, const sg_lattice_fit *f)
{
    static const char *names[10] = {"a", "b", "c", "d", "e", "f", "g", "h", "i", "j"};
    sg_lattice l;
    ck_ok(sg_lattice_from_fit(f, names, s->nclasses, arena, &l, &err));
    sg_label_map map;
    ck_ok(sg_lattice_paint(&l, IDENTITY, &map, &err));
    ck_assert_uint_eq(map.width, s->width);
    ck_assert_uint_eq(map.height, s->height);
    size_t counted = 0, wrong = 0;
    double cost = 0;
    for (size_t i = 0; i < s->width * s->height; i++) {
        counted += s->labels[i] != SG_CLASS_IGNORE;
        wrong += s->labels[i] != SG_CLASS_IGNORE && s->labels[i] != map.labels[i];
        cost += s->costs != NULL ? (double)s->costs[map.labels[i] * s->width * s->height + i] : 0;
    }
    sg_label_map_clear(&map);
    ck_assert_uint_eq(f->counted_px, counted);
    ck_assert_uint_eq(f->wrong_px, wrong);
    ck_assert_double_eq_tol(f->loss, s->costs != NULL ? cost : (double)wrong, 1e-6);
    const double lines = f->weights.per_column * (double)f->width + f->weights.per_row * (double)f->height +
                         f->weights.per_cell * (double)(f->width * f->height);
    ck_assert_double_eq_tol(f->energy, f->loss + lines, 1e-9);
    /* energies fall, and the last one is the energy: the dynamic programs and the painted lattice agree */
    ck_assert_uint_ge(f->nsteps, 1);
    for (size_t i = 1; i < f->nsteps; i++)
        ck_assert_double_lt(f->trace[i], f->trace[i - 1]);
    ck_assert_double_eq_tol(f->trace[f->nsteps - 1], f->energy, 1e-3);
}

START_TEST(account_is_right_and_energy_falls)
{
    gsl_rng_set(rng, (unsigned long)_i + 1);
    sg_lattice_source s = random_map(draw(1, 40), draw(1, 40), draw(1, 6), 0.9 + 0.1 * gsl_rng_uniform(rng),
                                     _i % 2 ? 0.1 : 0);
    if (_i % 4 == 3)
        add_random_costs(&s);
    const sg_lattice_weights w = {5 * gsl_rng_uniform(rng), 5 * gsl_rng_uniform(rng), gsl_rng_uniform(rng)};
    const sg_lattice_fit f = fit(&s, &w);
    check_account(&s, &f);
    const sg_lattice_fit g = fit(&s, NULL);
    check_account(&s, &g);
    ck_assert(isfinite(g.weights.per_column) && g.weights.per_cell >= 0);
}
END_TEST

static void turn(const sg_lattice_source *s, uint8_t *turned)
{
    for (size_t y = 0; y < s->height; y++)
        for (size_t x = 0; x < s->width; x++)
            turned[x * s->height + y] = s->labels[y * s->width + x];
}

START_TEST(result_is_a_fixed_point_of_exact_steps)
{
    /* no other columns are better with these rows, and no other rows with these columns: by enumeration */
    gsl_rng_set(rng, (unsigned long)_i + 1);
    const sg_lattice_source s = random_map(draw(1, 9), draw(1, 9), draw(2, 4), 0.5, _i % 2 ? 0.1 : 0);
    const sg_lattice_weights w = {gsl_rng_uniform(rng), gsl_rng_uniform(rng), 0.3 * gsl_rng_uniform(rng)};
    const sg_lattice_fit f = fit(&s, &w);
    check_account(&s, &f);
    uint8_t turned[81];
    turn(&s, turned);
    const sg_axis columns = axis_of(&s), rows = {s.height, s.width, s.nclasses, turned, NULL};
    const sg_places x = places_of(f.x, f.width + 1), y = places_of(f.y, f.height + 1);
    const double counted = (double)f.counted_px, nx = (double)f.width, ny = (double)f.height;
    const double best_columns = counted - best_by_enumeration(&columns, &y, w.per_column + w.per_cell * ny);
    ck_assert_double_eq_tol(f.energy, best_columns + w.per_row * ny, 1e-6);
    const double best_rows = counted - best_by_enumeration(&rows, &x, w.per_row + w.per_cell * nx);
    ck_assert_double_eq_tol(f.energy, best_rows + w.per_column * nx, 1e-6);
}
END_TEST

START_TEST(the_lowest_energy_of_all_lattices_is_mostly_found_on_noise)
{
    int found = 0;
    enum { CASES = 60 };
    for (int k = 0; k < CASES; k++) {
        gsl_rng_set(rng, (unsigned long)k + 1);
        const sg_lattice_source s = random_map(6, 6, 3, 0.7, 0);
        const sg_lattice_weights w = {0.8, 0.8, 0.1};
        const sg_lattice_fit f = fit(&s, &w);
        const sg_axis a = axis_of(&s);
        double best = INFINITY;
        for (unsigned mask = 0; mask < 32; mask++) {
            const sg_places strips = subset(6, mask);
            const double others = (double)(strips.n - 1);
            sg_places all = subset(6, ~0u), cuts;
            sg_strip_table t;
            double value;
            ck_ok(sg_strip_table_create(&a, &all, &strips, arena, &t, &err));
            ck_ok(sg_cuts_solve(&t, w.per_column + w.per_cell * others, arena, &cuts, &value, &err));
            best = fmin(best, 36 - value + w.per_row * others);
        }
        ck_assert_double_ge(f.energy, best - 1e-9);
        found += f.energy < best + 1e-9;
    }
    ck_assert_int_ge(found, CASES * 3 / 4);
}
END_TEST

START_TEST(costs_of_one_for_wrong_labels_are_labels)
{
    gsl_rng_set(rng, (unsigned long)_i + 1);
    sg_lattice_source s = random_map(draw(5, 30), draw(5, 30), 4, 0.95, _i % 2 ? 0.05 : 0);
    const sg_lattice_weights w = {2, 3, 0.2};
    const sg_lattice_fit by_label = fit(&s, &w);
    float *costs = SG_NEW_ARRAY(arena, float, 4 * s.width * s.height);
    for (size_t c = 0; c < 4; c++)
        for (size_t i = 0; i < s.width * s.height; i++)
            costs[c * s.width * s.height + i] = s.labels[i] != c && s.labels[i] != SG_CLASS_IGNORE;
    s.costs = costs;
    const sg_lattice_fit by_cost = fit(&s, &w);
    ck_assert_double_eq_tol(by_label.energy, by_cost.energy, 1e-9);
}
END_TEST

START_TEST(cells_of_ignored_pixels_take_the_neighbour_with_the_longest_border)
{
    const uint8_t I = SG_CLASS_IGNORE;
    /* columns of 1, 3, 2 px; rows of 2, 1, 1 px; the middle cell is ignored: left and right border 1 px, above and below 3 */
    const uint8_t labels[] = {0, 1, 1, 1, 2, 2, /**/ 0, 1, I, 1, 2, 2, /**/ 0, I, I, I, 2, 2, /**/ 0, 3, 3, 3, I, I};
    const sg_lattice_source s = {6, 4, 4, labels, NULL};
    uint32_t x[] = {0, 1, 4, 6}, y[] = {0, 2, 3, 4};
    uint8_t classes[9];
    sg_lattice_fit f = {.width = 3, .height = 3, .x = x, .y = y, .classes = classes};
    ck_ok(sg_lattice_vote(&s, arena, &f, &err));
    const uint8_t expected[] = {0, 1, 2, 0, 1, 2, 0, 3, 2}; /* above before below; 2 px above beats 1 px left */
    ck_assert_mem_eq(classes, expected, 9);
    ck_assert_uint_eq(f.wrong_px, 0);
    ck_assert_uint_eq(f.counted_px, 24 - 6);

    const uint8_t far[] = {I, I, I, I, 1}; /* in rounds, from the classed cell outwards */
    const sg_lattice_source t = {5, 1, 2, far, NULL};
    uint32_t tx[] = {0, 1, 2, 3, 4, 5}, ty[] = {0, 1};
    f = (sg_lattice_fit){.width = 5, .height = 1, .x = tx, .y = ty, .classes = classes};
    ck_ok(sg_lattice_vote(&t, arena, &f, &err));
    for (size_t i = 0; i < 5; i++)
        ck_assert_uint_eq(classes[i], 1);
}
END_TEST

START_TEST(extreme_maps)
{
    const sg_lattice_weights w = {0.1, 0.1, 0.01};
    sg_lattice_source s = random_map(1, 1, 1, 0, 0);
    for (int k = 0; k < 2; k++) {
        const sg_lattice_fit f = fit(&s, k ? &w : NULL);
        ck_assert(f.width == 1 && f.height == 1 && f.wrong_px == 0 && f.x[1] == 1 && f.y[1] == 1);
    }
    s = random_map(57, 31, 1, 0, 0); /* one class */
    for (int k = 0; k < 2; k++) {
        const sg_lattice_fit f = fit(&s, k ? &w : NULL);
        ck_assert(f.width == 1 && f.height == 1 && f.wrong_px == 0 && f.x[1] == 57);
    }
    uint8_t different[15 * 15];
    for (size_t i = 0; i < sizeof different; i++)
        different[i] = (uint8_t)i;
    s = (sg_lattice_source){15, 15, 225, different, NULL};
    const sg_lattice_fit all = fit(&s, &w);
    ck_assert(all.width == 15 && all.height == 15 && all.wrong_px == 0);
    const sg_lattice_fit one = fit(&s, &(sg_lattice_weights){20, 20, 0});
    ck_assert(one.width == 1 && one.height == 1 && one.wrong_px == 224);
    const sg_lattice_fit some = fit(&s, NULL);
    ck_assert(isfinite(some.energy));
    s = random_map(300, 1, 3, 0.5, 0); /* a line of pixels, and a column */
    ck_assert_uint_eq(fit(&s, &w).wrong_px, 0);
    s.height = 300;
    s.width = 1;
    ck_assert_uint_eq(fit(&s, &w).wrong_px, 0);
}
END_TEST

START_TEST(more_places_than_allowed_still_make_a_lattice)
{
    const sg_lattice_source s = random_map(90, 70, 5, 0.9, 0.05);
    const sg_lattice_fit_opts opts = {.max_candidates = 12, .persistence = 0.02, .min_run = 4, .max_places = 20, .starts = 4};
    sg_lattice_problem *p;
    ck_ok(sg_lattice_problem_create(&s, &opts, &p, &err));
    sg_lattice_fit f;
    ck_ok(sg_lattice_fit_weights(p, &(sg_lattice_weights){1, 1, 0.01}, arena, &f, &err));
    ck_assert_uint_le(f.width, 19);
    ck_assert_uint_le(f.height, 19);
    check_account(&s, &f);
    /* an accuracy out of reach gives what can be had */
    ck_ok(sg_lattice_fit_accuracy(p, 1, arena, &f, &err));
    ck_assert(f.wrong_px > 0 && f.width <= 19);
    sg_lattice_problem_free(p);
}
END_TEST

START_TEST(targets_are_met)
{
    gsl_rng_set(rng, (unsigned long)_i + 1);
    sg_lattice l = random_grid(12, 4, 12, 4);
    sg_lattice_source s = paint(&l, 4);
    uint8_t *labels = sg_arena_copy(arena, s.labels, s.width * s.height);
    for (size_t i = 0; i < s.width * s.height / 20; i++)
        labels[gsl_rng_uniform_int(rng, s.width * s.height)] = (uint8_t)gsl_rng_uniform_int(rng, 4);
    s.labels = labels;
    const sg_lattice_fit_opts opts = SG_LATTICE_FIT_OPTS_INIT;
    sg_lattice_problem *p;
    ck_ok(sg_lattice_problem_create(&s, &opts, &p, &err));
    double last = 0;
    for (size_t cells = 1; cells < 1000; cells = cells * 3 + 1) {
        sg_lattice_fit f;
        ck_ok(sg_lattice_fit_cells(p, cells, arena, &f, &err));
        ck_assert_uint_le(f.width * f.height, cells);
        ck_assert_double_ge(sg_lattice_accuracy(&f) + 0.02, last); /* more cells lose no accuracy to speak of */
        last = sg_lattice_accuracy(&f);
        check_account(&s, &f);
    }
    for (double accuracy = 0; accuracy <= 1; accuracy += 0.25) {
        sg_lattice_fit f;
        ck_ok(sg_lattice_fit_accuracy(p, accuracy, arena, &f, &err));
        ck_assert_double_ge(sg_lattice_accuracy(&f), accuracy);
        ck_assert(accuracy > 0 || f.width * f.height == 1);
    }
    sg_lattice_problem_free(p);
}
END_TEST

/* One decision after the other, as an adaptive coder would make them. */
static double decision(size_t count[2], bool yes)
{
    const double p = ((double)count[yes] + 0.5) / (double)(count[0] + count[1] + 1);
    count[yes]++;
    return -log(p);
}

static int wrong_at(const sg_lattice_source *s, const sg_label_map *shown, long x, long y)
{
    if (x < 0 || y < 0 || x >= (long)s->width)
        return 0;
    const size_t i = (size_t)y * s->width + (size_t)x;
    return s->labels[i] == SG_CLASS_IGNORE || s->labels[i] == shown->labels[i] ? 0 : 1 + s->labels[i];
}

START_TEST(residual_length_is_that_of_an_adaptive_coder)
{
    gsl_rng_set(rng, (unsigned long)_i + 1);
    const sg_lattice_source s = random_map(draw(1, 30), draw(1, 30), draw(3, 5), 0.9, 0.1);
    const sg_lattice_fit f = fit(&s, &(sg_lattice_weights){6, 6, 0});
    static const char *names[] = {"a", "b", "c", "d", "e"};
    sg_lattice l;
    ck_ok(sg_lattice_from_fit(&f, names, s.nclasses, arena, &l, &err));
    sg_label_map map;
    ck_ok(sg_lattice_paint(&l, IDENTITY, &map, &err));
    size_t context[16][2] = {{0}}, left[2] = {0}, above[2] = {0};
    double nats = 0;
    for (long y = 0; y < (long)s.height; y++)
        for (long x = 0; x < (long)s.width; x++) {
            if (s.labels[y * (long)s.width + x] == SG_CLASS_IGNORE)
                continue;
            const int w = wrong_at(&s, &map, x, y), a = wrong_at(&s, &map, x - 1, y);
            const int b = wrong_at(&s, &map, x - 1, y - 1), c = wrong_at(&s, &map, x, y - 1);
            const int d = wrong_at(&s, &map, x + 1, y - 1);
            nats += decision(context[(a > 0) + 2 * (b > 0) + 4 * (c > 0) + 8 * (d > 0)], w > 0);
            if (w == 0)
                continue;
            if (a > 0)
                nats += decision(left, w == a);
            else if (c > 0)
                nats += decision(above, w == c);
            if ((a > 0 ? a : c) != w)
                nats += log((double)s.nclasses - 1);
        }
    ck_assert_double_eq_tol(sg_lattice_residual_length(&s, &f, arena), nats, 1e-8 * nats + 1e-10);
    sg_label_map_clear(&map);
}
END_TEST

START_TEST(bad_arguments_are_refused)
{
    sg_lattice_fit_opts opts = SG_LATTICE_FIT_OPTS_INIT;
    sg_lattice_problem *p = NULL;
    const uint8_t ignored[] = {SG_CLASS_IGNORE, SG_CLASS_IGNORE}, bad[] = {0, 7}, good[] = {0, 1};
    sg_lattice_source s = {2, 1, 2, ignored, NULL};
    ck_assert_int_eq(sg_lattice_problem_create(&s, &opts, &p, &err), SG_EINPUT);
    s.labels = bad;
    ck_assert_int_eq(sg_lattice_problem_create(&s, &opts, &p, &err), SG_EINVAL);
    ck_assert_ptr_nonnull(strstr(err.msg, "label 7 at pixel 1, 0"));
    s.labels = good;
    s.width = 0;
    ck_assert_int_eq(sg_lattice_problem_create(&s, &opts, &p, &err), SG_EINVAL);
    s.width = 2;
    const float costs[] = {0, NAN, 1, 1}, negative[] = {0, 0, -1, 1};
    s.costs = costs;
    ck_assert_int_eq(sg_lattice_problem_create(&s, &opts, &p, &err), SG_EINVAL);
    s.costs = negative;
    ck_assert_int_eq(sg_lattice_problem_create(&s, &opts, &p, &err), SG_EINVAL);
    s.costs = NULL;
    opts.starts = 0;
    ck_assert_int_eq(sg_lattice_problem_create(&s, &opts, &p, &err), SG_EINVAL);
    opts.starts = 4;
    ck_ok(sg_lattice_problem_create(&s, &opts, &p, &err));
    sg_lattice_fit f;
    ck_assert_int_eq(sg_lattice_fit_weights(p, &(sg_lattice_weights){-1, 0, 0}, arena, &f, &err), SG_EINVAL);
    ck_assert_int_eq(sg_lattice_fit_weights(p, &(sg_lattice_weights){0, NAN, 0}, arena, &f, &err), SG_EINVAL);
    ck_assert_int_eq(sg_lattice_fit_weights(p, &(sg_lattice_weights){0, 0, INFINITY}, arena, &f, &err), SG_EINVAL);
    ck_assert_int_eq(sg_lattice_fit_cells(p, 0, arena, &f, &err), SG_EINVAL);
    ck_assert_int_eq(sg_lattice_fit_accuracy(p, 1.01, arena, &f, &err), SG_EINVAL);
    ck_assert_int_eq(sg_lattice_fit_accuracy(p, NAN, arena, &f, &err), SG_EINVAL);
    sg_lattice_problem_free(p);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("lattice_fit");
    TCase *tc = tcase_create("fit");
    tcase_set_timeout(tc, 120);
    tcase_add_checked_fixture(tc, set_up, tear_down);
    tcase_add_loop_test(tc, dynamic_program_equals_enumeration, 0, 100);
    tcase_add_loop_test(tc, persistence_equals_its_definition, 0, 60);
    tcase_add_test(tc, evidence_passes_over_ignored_pixels_and_knows_no_numbering);
    tcase_add_loop_test(tc, grids_come_back_exactly, 0, 60);
    tcase_add_loop_test(tc, description_length_finds_usual_grids_without_being_told_a_weight, 0, 30);
    tcase_add_loop_test(tc, grids_come_back_through_ignored_pixels, 0, 20);
    tcase_add_loop_test(tc, lines_are_placed_within_noise, 0, 20);
    tcase_add_loop_test(tc, account_is_right_and_energy_falls, 0, 60);
    tcase_add_loop_test(tc, result_is_a_fixed_point_of_exact_steps, 0, 30);
    tcase_add_test(tc, the_lowest_energy_of_all_lattices_is_mostly_found_on_noise);
    tcase_add_loop_test(tc, costs_of_one_for_wrong_labels_are_labels, 0, 20);
    tcase_add_test(tc, cells_of_ignored_pixels_take_the_neighbour_with_the_longest_border);
    tcase_add_test(tc, extreme_maps);
    tcase_add_test(tc, more_places_than_allowed_still_make_a_lattice);
    tcase_add_loop_test(tc, targets_are_met, 0, 6);
    tcase_add_loop_test(tc, residual_length_is_that_of_an_adaptive_coder, 0, 30);
    tcase_add_test(tc, bad_arguments_are_refused);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
