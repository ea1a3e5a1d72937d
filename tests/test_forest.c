/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_forest.c - tables of forests: they are OpenCV's trees, node for node; leaves count what comes to them; photographs go
 * through them as single pixels do. */
#include "config.h"

#include "core/random.h"
#include "parse/forest_grow.h"
#include "tests/support.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_randist.h>
#include <math.h>
#include <string.h>

/* ---- samples ---- */

/* Classes that differ a little in some features; whole numbers, as patches have them, or not. */
static sg_sample_matrix make_samples(gsl_rng *rng, size_t n, size_t nfeatures, size_t nclasses, bool whole)
{
    sg_sample_matrix m = {n, nfeatures, nclasses, malloc(n * nfeatures * sizeof *m.x), malloc(n)};
    for (size_t i = 0; i < n; i++) {
        m.classes[i] = (uint8_t)gsl_rng_uniform_int(rng, nclasses);
        for (size_t f = 0; f < nfeatures; f++) {
            const double v = 30 * gsl_ran_ugaussian(rng) + (f % nclasses == m.classes[i] ? 40 : 0);
            m.x[f * n + i] = (float)(whole ? floor(v) : v);
        }
    }
    return m;
}

static void clear_samples(sg_sample_matrix *m)
{
    free(m->x);
    free(m->classes);
}

static ptrdiff_t *offsets_of(const sg_sample_matrix *m)
{
    ptrdiff_t *offsets = malloc(m->nfeatures * sizeof *offsets);
    for (size_t f = 0; f < m->nfeatures; f++)
        offsets[f] = (ptrdiff_t)(f * m->n);
    return offsets;
}

static ptrdiff_t *numbers_to(size_t n)
{
    ptrdiff_t *numbers = malloc((n + 1) * sizeof *numbers);
    for (size_t i = 0; i < n; i++)
        numbers[i] = (ptrdiff_t)i;
    return numbers;
}

/* The leaf that a sample comes to, without anything clever. */
static uint32_t walk(const sg_forest *f, size_t tree, const sg_sample_matrix *m, size_t i)
{
    size_t at = f->roots[tree];
    while (f->nodes[at].feature != SG_FOREST_LEAF)
        at = f->nodes[at].child + (m->x[f->nodes[at].feature * m->n + i] <= f->nodes[at].threshold ? 0u : 1u);
    return f->nodes[at].child;
}

static sg_forest grow(const sg_sample_matrix *m, size_t trees, size_t depth, uint64_t seed, int threads)
{
    sg_error err = SG_ERROR_INIT;
    sg_forest f;
    const sg_forest_grow_opts o = {trees, depth, 2, 0, seed, threads, NULL};
    ck_ok(sg_forest_grow(m, &o, &f, &err));
    return f;
}

static void assert_same(const sg_forest *a, const sg_forest *b)
{
    ck_assert_uint_eq(a->ntrees, b->ntrees);
    ck_assert_uint_eq(a->nnodes, b->nnodes);
    ck_assert_mem_eq(a->roots, b->roots, (a->ntrees + 1) * sizeof *a->roots);
    ck_assert_mem_eq(a->nodes, b->nodes, a->nnodes * sizeof *a->nodes);
    ck_assert_mem_eq(a->leaves, b->leaves, a->nleaves * a->nclasses * sizeof *a->leaves);
}

/* ---- OpenCV ---- */

START_TEST(table_votes_as_opencv_does)
{
    sg_error err = SG_ERROR_INIT;
    gsl_rng *rng = sg_random_create((uint64_t)_i);
    const size_t nclasses = 2 + (size_t)_i % 6, nfeatures = 1 + (size_t)(_i * 3) % 20, trees = 1 + (size_t)_i % 7;
    sg_sample_matrix m = make_samples(rng, 300 + 100 * (size_t)_i, nfeatures, nclasses, _i % 2 == 0);
    const sg_cv_forest_opts o = {trees, 1 + (size_t)(_i * 5) % 25, 1 + (size_t)_i % 4, 0};
    sg_cv_samples *samples;
    sg_cv_forest *theirs;
    sg_forest ours;
    sg_forest_view *v;
    ck_ok(sg_cv_samples_create(m.x, m.n, m.nfeatures, m.classes, &samples, &err));
    ck_ok(sg_cv_forest_grow(samples, &o, 5 + (uint64_t)_i, &theirs, &err));
    ck_ok(sg_forest_from_cv(theirs, nclasses, &ours, &err));
    ck_assert_uint_eq(ours.ntrees, trees);

    /* new samples: OpenCV's own rows of them, and some that lie exactly on a threshold */
    sg_sample_matrix t = make_samples(rng, 500, nfeatures, nclasses, _i % 2 == 0);
    for (size_t i = 0; i < t.n; i += 3)
        for (size_t k = 0; k < ours.nnodes; k += 1 + gsl_rng_uniform_int(rng, 50))
            if (ours.nodes[k].feature != SG_FOREST_LEAF)
                t.x[ours.nodes[k].feature * t.n + i] = ours.nodes[k].threshold;
    float *rows = malloc(t.n * nfeatures * sizeof *rows), *p = malloc(t.n * nclasses * sizeof *p);
    for (size_t i = 0; i < t.n; i++)
        for (size_t f = 0; f < nfeatures; f++)
            rows[i * nfeatures + f] = t.x[f * t.n + i];
    int32_t *votes = malloc(t.n * nclasses * sizeof *votes);
    uint8_t *classes = malloc(t.n);
    uint32_t *leaves = malloc(t.n * sizeof *leaves);
    ck_ok(sg_cv_forest_votes(theirs, rows, t.n, nclasses, votes, &err));
    ck_ok(sg_cv_forest_predict(theirs, rows, t.n, classes, &err));

    ptrdiff_t *offsets = offsets_of(&t), *pixels = numbers_to(t.n);
    ck_ok(sg_forest_bind(&ours, t.x, offsets, &v, &err));
    sg_forest_mean(v, pixels, t.n, leaves, p);
    for (size_t i = 0; i < t.n; i++) {
        int32_t most = 0;
        for (size_t c = 0; c < nclasses; c++) {
            ck_assert_int_eq(lroundf(p[i * nclasses + c] * (float)trees), votes[i * nclasses + c]);
            most = votes[i * nclasses + c] > most ? votes[i * nclasses + c] : most;
        }
        ck_assert_int_eq(votes[i * nclasses + classes[i]], most);
    }
    for (size_t k = 0; k < trees; k++) {
        sg_forest_find(v, k, pixels, t.n, leaves);
        for (size_t i = 0; i < t.n; i++)
            ck_assert_uint_eq(leaves[i], walk(&ours, k, &t, i));
    }
    sg_forest_view_free(v);
    sg_forest_clear(&ours);
    sg_cv_forest_free(theirs);
    sg_cv_samples_free(samples);
    clear_samples(&m);
    clear_samples(&t);
    free(rows);
    free(p);
    free(votes);
    free(classes);
    free(leaves);
    free(offsets);
    free(pixels);
    gsl_rng_free(rng);
}
END_TEST

/* A tree of the table is one of OpenCV's: nodes in its order, depth as it was asked for. */
START_TEST(nodes_are_those_that_opencv_hands_out)
{
    sg_error err = SG_ERROR_INIT;
    gsl_rng *rng = sg_random_create(7);
    sg_sample_matrix m = make_samples(rng, 2000, 8, 4, false);
    const sg_cv_forest_opts o = {3, 1 + (size_t)_i, 1, 3};
    sg_cv_samples *samples;
    sg_cv_forest *theirs;
    sg_forest ours;
    ck_ok(sg_cv_samples_create(m.x, m.n, m.nfeatures, m.classes, &samples, &err));
    ck_ok(sg_cv_forest_grow(samples, &o, 1, &theirs, &err));
    ck_ok(sg_forest_from_cv(theirs, 4, &ours, &err));
    ck_assert_uint_eq(sg_cv_forest_trees(theirs), 3);
    ck_assert_uint_eq(sg_cv_forest_features(theirs), 8);
    for (size_t t = 0; t < 3; t++) {
        sg_cv_node *nodes;
        size_t n, deepest = 0;
        ck_ok(sg_cv_forest_tree(theirs, t, &nodes, &n, &err));
        ck_assert_uint_eq(n, ours.roots[t + 1] - ours.roots[t]);
        size_t *depth = calloc(n, sizeof *depth);
        for (size_t i = 0; i < n; i++) {
            const sg_forest_node *mine = &ours.nodes[ours.roots[t] + i];
            deepest = depth[i] > deepest ? depth[i] : deepest;
            if (nodes[i].feature < 0) {
                ck_assert_uint_eq(mine->feature, SG_FOREST_LEAF);
                ck_assert_float_eq(ours.leaves[mine->child * 4 + (size_t)nodes[i].label], 1);
                continue;
            }
            ck_assert_uint_eq(mine->feature, (uint32_t)nodes[i].feature);
            ck_assert_float_eq(mine->threshold, nodes[i].threshold);
            ck_assert_uint_eq(mine->child, ours.roots[t] + (uint32_t)nodes[i].left);
            ck_assert_int_eq(nodes[i].right, nodes[i].left + 1);
            depth[nodes[i].left] = depth[nodes[i].right] = depth[i] + 1;
        }
        ck_assert_uint_eq(sg_forest_depth(&ours, t), deepest);
        ck_assert_uint_le(deepest, o.depth);
        free(depth);
        free(nodes);
    }
    sg_cv_node *none;
    size_t n;
    ck_assert_int_eq(sg_cv_forest_tree(theirs, 3, &none, &n, &err), SG_EINVAL);
    sg_forest_clear(&ours);
    ck_assert_int_eq(sg_forest_from_cv(theirs, 3, &ours, &err), SG_EINVAL); /* a leaf of class 3 */
    sg_cv_forest_free(theirs);
    sg_cv_samples_free(samples);
    clear_samples(&m);
    gsl_rng_free(rng);
}
END_TEST

/* ---- growing ---- */

START_TEST(a_tree_depends_on_its_seed_and_number_alone)
{
    gsl_rng *rng = sg_random_create(3);
    sg_sample_matrix m = make_samples(rng, 800, 10, 3, true);
    sg_forest one = grow(&m, 5, 12, 9, 1), again = grow(&m, 5, 12, 9, 3), more = grow(&m, 8, 12, 9, 2),
              other = grow(&m, 5, 12, 10, 1);
    assert_same(&one, &again);
    ck_assert_mem_eq(one.nodes, more.nodes, one.nnodes * sizeof *one.nodes);
    ck_assert(other.nnodes != one.nnodes || memcmp(one.nodes, other.nodes, one.nnodes * sizeof *one.nodes) != 0);
    for (size_t t = 1; t < 5; t++) /* trees differ */
        ck_assert(one.roots[t + 1] - one.roots[t] != one.roots[1] ||
                  memcmp(one.nodes, one.nodes + one.roots[t], sizeof *one.nodes) != 0);
    sg_forest_clear(&one);
    sg_forest_clear(&again);
    sg_forest_clear(&more);
    sg_forest_clear(&other);
    clear_samples(&m);
    gsl_rng_free(rng);
}
END_TEST

START_TEST(growing_refuses_what_makes_no_sense)
{
    gsl_rng *rng = sg_random_create(3);
    sg_sample_matrix m = make_samples(rng, 50, 4, 2, true), none = m;
    none.n = 0;
    const sg_forest_grow_opts bad[] = {{0, 5, 1, 0, 1, 1, NULL},  {2, 0, 1, 0, 1, 1, NULL}, {2, 26, 1, 0, 1, 1, NULL},
                                       {2, 5, 1, 5, 1, 1, NULL}, {2, 5, (size_t)1 << 40, 0, 1, 1, NULL}};
    sg_error err = SG_ERROR_INIT;
    sg_forest f;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        ck_assert_int_eq(sg_forest_grow(&m, &bad[i], &f, &err), SG_EINVAL);
    const sg_forest_grow_opts good = {2, 5, 1, 4, 1, 1, NULL};
    ck_assert_int_eq(sg_forest_grow(&none, &good, &f, &err), SG_EINVAL);
    ck_ok(sg_forest_grow(&m, &good, &f, &err));
    sg_forest_clear(&f);
    clear_samples(&m);
    gsl_rng_free(rng);
}
END_TEST

/* One sample, one class, one value: a root that is a leaf. */
START_TEST(nothing_to_split_makes_one_leaf)
{
    float x[12] = {0};
    uint8_t classes[6] = {0, 0, 0, 0, 0, 0};
    sg_sample_matrix m = {_i == 0 ? 1 : 6, 2, 3, x, classes};
    if (_i == 1)
        for (int i = 0; i < 12; i++)
            x[i] = (float)i;
    if (_i == 2)
        classes[3] = 2;
    sg_error err = SG_ERROR_INIT;
    sg_forest f = grow(&m, 2, 20, 1, 1);
    ck_assert_uint_eq(f.nnodes, 2);
    ck_assert_uint_eq(f.nleaves, 2);
    ck_assert_uint_eq(sg_forest_depth(&f, 1), 0);
    const uint64_t counts[6] = {5, 0, 1, 0, 0, 0};
    const double weights[3] = {1, 1, 1};
    sg_forest_fill(&f, counts, weights, 1);
    ck_ok(sg_forest_check(&f, &err));
    ck_assert_float_eq_tol(f.leaves[0], 6.f / 9, 1e-6f);
    ck_assert_float_eq_tol(f.leaves[3], 1.f / 3, 1e-6f);
    sg_forest_clear(&f);
}
END_TEST

static bool stop_after_two(sg_progress *p)
{
    size_t *n = p->user;
    return (*n)++ >= 2;
}

START_TEST(stopped_growth_gives_the_trees_that_are_done)
{
    gsl_rng *rng = sg_random_create(3);
    sg_sample_matrix m = make_samples(rng, 200, 4, 2, true);
    sg_error err = SG_ERROR_INIT;
    sg_forest whole = grow(&m, 5, 6, 4, 1), part;
    size_t asked = 0;
    sg_progress progress = {NULL, stop_after_two, &asked};
    const sg_forest_grow_opts o = {5, 6, 2, 0, 4, 1, &progress};
    ck_assert_int_eq(sg_forest_grow(&m, &o, &part, &err), SG_STOPPED);
    ck_assert_uint_eq(part.ntrees, 2);
    ck_assert_mem_eq(part.nodes, whole.nodes, part.nnodes * sizeof *part.nodes);
    sg_forest_clear(&part);
    asked = 2;
    ck_assert_int_eq(sg_forest_grow(&m, &o, &part, &err), SG_STOPPED);
    ck_assert_uint_eq(part.ntrees, 0);
    sg_forest_clear(&part);
    sg_forest_clear(&whole);
    clear_samples(&m);
    gsl_rng_free(rng);
}
END_TEST

/* ---- leaves ---- */

START_TEST(leaves_hold_what_a_direct_count_finds)
{
    sg_error err = SG_ERROR_INIT;
    gsl_rng *rng = sg_random_create((uint64_t)_i);
    sg_sample_matrix m = make_samples(rng, 700, 6, 3, true), all = make_samples(rng, 3001, 6, 3, true);
    sg_forest f = grow(&m, 4, 7, 2, 2);
    sg_forest_view *v;
    uint64_t *counts = calloc(f.nleaves * 3, sizeof *counts), *direct = calloc(f.nleaves * 3, sizeof *direct);
    ptrdiff_t *offsets = offsets_of(&all), *pixels = numbers_to(all.n);
    uint32_t *leaves = malloc(all.n * sizeof *leaves);
    ck_ok(sg_forest_bind(&f, all.x, offsets, &v, &err));
#pragma omp parallel for num_threads(3)
    for (int part = 0; part < 7; part++) { /* in parts, by several threads: 1001 of 3001 twice */
        const size_t from = (size_t)part * 500, n = part < 6 ? (size_t)500 : 1;
        sg_forest_count(v, pixels + from, all.classes + from, n, leaves + from, counts);
    }
    for (size_t t = 0; t < f.ntrees; t++)
        for (size_t i = 0; i < all.n; i++)
            direct[walk(&f, t, &all, i) * 3 + all.classes[i]]++;
    ck_assert_mem_eq(counts, direct, f.nleaves * 3 * sizeof *counts);

    const double weights[3] = {1, 0.5, 20}, smoothing = _i == 0 ? 1 : 0.01;
    sg_forest_fill(&f, counts, weights, smoothing);
    ck_ok(sg_forest_check(&f, &err));
    for (size_t l = 0; l < f.nleaves; l++) {
        double sum = 0;
        for (size_t c = 0; c < 3; c++)
            sum += weights[c] * (double)direct[l * 3 + c] + smoothing;
        for (size_t c = 0; c < 3; c++)
            ck_assert_double_eq_tol(f.leaves[l * 3 + c], (weights[c] * (double)direct[l * 3 + c] + smoothing) / sum, 1e-6);
    }
    sg_forest_view_free(v);
    sg_forest_clear(&f);
    clear_samples(&m);
    clear_samples(&all);
    free(counts);
    free(direct);
    free(offsets);
    free(pixels);
    free(leaves);
    gsl_rng_free(rng);
}
END_TEST

/* Two normal classes, 2 apart, in one of five features: no rule errs less than P(z > 1) = 15.9 %. */
START_TEST(forest_comes_near_the_bayes_error)
{
    enum { TRAIN = 20000, TEST = 40000, FEATURES = 5 };
    sg_error err = SG_ERROR_INIT;
    gsl_rng *rng = sg_random_create(11);
    sg_sample_matrix m[2];
    for (int k = 0; k < 2; k++) {
        m[k] = make_samples(rng, k == 0 ? TRAIN : TEST, FEATURES, 2, false);
        for (size_t i = 0; i < m[k].n * FEATURES; i++)
            m[k].x[i] = (float)gsl_ran_ugaussian(rng);
        for (size_t i = 0; i < m[k].n; i++)
            m[k].x[2 * m[k].n + i] += m[k].classes[i] == 1 ? 2 : 0;
    }
    sg_forest f = grow(&m[0], 20, 9, 5, 2);
    sg_forest_view *v;
    const double weights[2] = {1, 1};
    uint64_t *counts = calloc(f.nleaves * 2, sizeof *counts);
    uint32_t *leaves = malloc(TEST * sizeof *leaves);
    float *p = malloc(TEST * 2 * sizeof *p);
    ptrdiff_t *pixels = numbers_to(TEST);
    for (int k = 0; k < 2; k++) {
        ptrdiff_t *offsets = offsets_of(&m[k]);
        ck_ok(sg_forest_bind(&f, m[k].x, offsets, &v, &err));
        if (k == 0) {
            sg_forest_count(v, pixels, m[k].classes, m[k].n, leaves, counts);
            sg_forest_fill(&f, counts, weights, 1);
        } else {
            sg_forest_mean(v, pixels, m[k].n, leaves, p);
        }
        sg_forest_view_free(v);
        free(offsets);
    }
    double wrong = 0, off = 0;
    for (size_t i = 0; i < TEST; i++) {
        const double x = (double)m[1].x[2 * TEST + i], truth = 1 / (1 + exp(2 - 2 * x)); /* P(class 1 | x) */
        ck_assert_double_eq_tol(p[2 * i] + p[2 * i + 1], 1, 1e-5);
        wrong += (p[2 * i + 1] > p[2 * i]) != (m[1].classes[i] == 1);
        off += fabs((double)p[2 * i + 1] - truth);
    }
    const double bayes = gsl_cdf_ugaussian_Q(1), sigma = sqrt(bayes * (1 - bayes) / TEST);
    ck_assert_double_gt(wrong / TEST, bayes - 5 * sigma);
    ck_assert_double_lt(wrong / TEST, bayes + 5 * sigma + 0.005);
    ck_assert_double_lt(off / TEST, 0.06);
    sg_forest_clear(&f);
    clear_samples(&m[0]);
    clear_samples(&m[1]);
    free(counts);
    free(leaves);
    free(p);
    free(pixels);
    gsl_rng_free(rng);
}
END_TEST

/* ---- photographs ---- */

static sg_image noise(gsl_rng *rng, size_t width, size_t height)
{
    sg_error err = SG_ERROR_INIT;
    sg_image im;
    ck_ok(sg_image_create(width, height, &im, &err));
    for (size_t i = 0; i < 3 * width * height; i++)
        im.rgb[i] = (uint8_t)gsl_rng_uniform_int(rng, 256);
    return im;
}

START_TEST(photographs_go_through_as_single_pixels_do)
{
    static const size_t sizes[][2] = {{1, 1}, {1, 70}, {130, 3}, {64, 64}, {65, 129}, {200, 77}};
    sg_error err = SG_ERROR_INIT;
    gsl_rng *rng = sg_random_create((uint64_t)_i);
    const sg_feature_set set = sg_feature_set_of(SG_FEATURES_PATCH, 3);
    sg_image im = noise(rng, sizes[_i][0], sizes[_i][1]);
    sg_features features;
    sg_sample_matrix m = make_samples(rng, 600, sg_feature_set_count(&set), 4, true);
    for (size_t i = 0; i < m.n * m.nfeatures; i++)
        m.x[i] = m.x[i] / 2 + 120;
    sg_forest f = grow(&m, 5, 9, 1, 1);
    uint64_t *counts = calloc(f.nleaves * 4, sizeof *counts);
    for (size_t i = 0; i < f.nleaves * 4; i++)
        counts[i] = gsl_rng_uniform_int(rng, 9);
    const double weights[4] = {1, 1, 1, 1};
    sg_forest_fill(&f, counts, weights, 1);
    ck_ok(sg_features_create(&set, &im, &features, &err));
    sg_float_map one, more;
    ck_ok(sg_forest_apply(&f, &features, 1, &one, &err));
    ck_assert_uint_eq(one.channels, 4);
    ck_assert_uint_eq(one.width, im.width);
    ck_assert_uint_eq(one.height, im.height);
    const size_t plane = im.width * im.height;
    for (size_t i = 0; i < plane; i++) {
        double p[4] = {0}, sum = 0;
        for (size_t t = 0; t < f.ntrees; t++) {
            size_t at = f.roots[t];
            while (f.nodes[at].feature != SG_FOREST_LEAF) {
                const float value = sg_features_value(&features, f.nodes[at].feature, i % im.width, i / im.width);
                at = f.nodes[at].child + (value <= f.nodes[at].threshold ? 0u : 1u);
            }
            for (size_t c = 0; c < 4; c++)
                p[c] += (double)f.leaves[f.nodes[at].child * 4 + c] / (double)f.ntrees;
        }
        for (size_t c = 0; c < 4; c++) {
            ck_assert_double_eq_tol(one.values[c * plane + i], p[c], 1e-6);
            ck_assert_float_gt(one.values[c * plane + i], 0);
            sum += (double)one.values[c * plane + i];
        }
        ck_assert_double_eq_tol(sum, 1, 1e-5);
    }
    for (int threads = 2; threads < 5; threads++) {
        ck_ok(sg_forest_apply(&f, &features, threads, &more, &err));
        ck_assert_mem_eq(one.values, more.values, 4 * plane * sizeof *one.values);
        sg_float_map_clear(&more);
    }
    features.nfeatures--;
    ck_assert_int_eq(sg_forest_apply(&f, &features, 1, &more, &err), SG_EINVAL);
    sg_float_map_clear(&one);
    sg_features_clear(&features);
    sg_image_clear(&im);
    sg_forest_clear(&f);
    clear_samples(&m);
    free(counts);
    gsl_rng_free(rng);
}
END_TEST

/* ---- checks ---- */

/* Each change breaks one thing that the comment of sg_forest_check() promises. */
START_TEST(broken_tables_are_found)
{
    sg_error err = SG_ERROR_INIT;
    gsl_rng *rng = sg_random_create(2);
    sg_sample_matrix m = make_samples(rng, 400, 5, 3, true);
    sg_forest f = grow(&m, 3, 5, 1, 1);
    for (size_t i = 0; i < f.nleaves * 3; i++)
        f.leaves[i] = 1.f / 3;
    ck_ok(sg_forest_check(&f, &err));
    size_t leaf = 0, inner = f.roots[1]; /* a leaf somewhere, and the second root */
    while (f.nodes[leaf].feature != SG_FOREST_LEAF)
        leaf++;
    ck_assert_uint_ne(f.nodes[inner].feature, SG_FOREST_LEAF);
    switch (_i) {
    case 0: f.nodes[inner].feature = 5; break;
    case 1: f.nodes[inner].threshold = NAN; break;
    case 2: f.nodes[inner].threshold = -INFINITY; break;
    case 3: f.nodes[inner].child = (uint32_t)inner; break; /* a cycle */
    case 4: f.nodes[inner].child++; break;
    case 5: f.nodes[inner].child = f.roots[0]; break; /* into another tree */
    case 6: f.nodes[inner].child = UINT32_MAX - 1; break;
    case 7: f.nodes[leaf].child = (uint32_t)f.nleaves; break;
    case 8: f.nodes[leaf].child++; break;
    case 9: f.nodes[inner].feature = SG_FOREST_LEAF; break;
    case 10: f.nodes[leaf].feature = 0; break;
    case 11: f.roots[1] = f.roots[2]; break;
    case 12: f.roots[2] = UINT32_MAX; break;
    case 13: f.roots[0] = 1; break;
    case 14: f.roots[3]--; break;
    case 15: f.leaves[4] = 0; break;
    case 16: f.leaves[4] = NAN; break;
    case 17: f.leaves[4] = 0.4f; break;
    case 18: f.leaves[4] = -1; break;
    default: f.nleaves--; break;
    }
    ck_assert_int_eq(sg_forest_check(&f, &err), SG_EINPUT);
    ck_assert_str_ne(err.msg, "");
    f.nleaves += _i == 19;
    sg_forest_clear(&f);
    clear_samples(&m);
    gsl_rng_free(rng);
}
END_TEST

START_TEST(sizes_are_checked)
{
    sg_error err = SG_ERROR_INIT;
    sg_forest f;
    ck_assert_int_eq(sg_forest_create(0, 1, 1, 1, 1, &f, &err), SG_EINVAL);
    ck_assert_int_eq(sg_forest_create(1, 0, 1, 1, 1, &f, &err), SG_EINVAL);
    ck_assert_int_eq(sg_forest_create(1, 1, 0, 1, 1, &f, &err), SG_EINVAL);
    ck_assert_int_eq(sg_forest_create(1, 1, 2, 1, 1, &f, &err), SG_EINVAL);
    ck_assert_int_eq(sg_forest_create(1, 1, 1, 1, 2, &f, &err), SG_EINVAL);
    ck_assert_int_eq(sg_forest_create(1, 1, 1, (size_t)1 << 33, 1, &f, &err), SG_EINVAL);
    ck_ok(sg_forest_create(1, 1, 1, 1, 1, &f, &err));
    sg_forest_clear(&f);
    sg_forest_clear(&f);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("forest");
    TCase *c = tcase_create("forest");
    tcase_add_loop_test(c, table_votes_as_opencv_does, 0, 12);
    tcase_add_loop_test(c, nodes_are_those_that_opencv_hands_out, 0, 8);
    tcase_add_test(c, a_tree_depends_on_its_seed_and_number_alone);
    tcase_add_test(c, growing_refuses_what_makes_no_sense);
    tcase_add_loop_test(c, nothing_to_split_makes_one_leaf, 0, 3);
    tcase_add_test(c, stopped_growth_gives_the_trees_that_are_done);
    tcase_add_loop_test(c, leaves_hold_what_a_direct_count_finds, 0, 2);
    tcase_add_test(c, forest_comes_near_the_bayes_error);
    tcase_add_loop_test(c, photographs_go_through_as_single_pixels_do, 0, 6);
    tcase_add_loop_test(c, broken_tables_are_found, 0, 20);
    tcase_add_test(c, sizes_are_checked);
    suite_add_tcase(suite, c);
    return test_run(suite);
}
