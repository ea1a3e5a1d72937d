/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_pixel_classifier.c - drawing pixels, learning, calibrating, and files that are whole or not. */
#include "config.h"

#include "parse/pixel_classifier_learn.h"
#include "parse/pixel_classifier_priv.h"
#include "parse/pixel_classifier_sample.h"
#include "tests/classifier_support.h"

#include <gsl/gsl_randist.h>
#include <math.h>
#include <zlib.h>

static temp_folder folder;
static sg_arena *arena;
static sg_dataset train, valid;

static void open_set(bool noisy)
{
    folder = temp_folder_make();
    arena = sg_arena_create();
    test_write_set(&folder, noisy);
    train = test_open_set(&folder, SG_SPLIT_TRAIN, arena);
    valid = test_open_set(&folder, SG_SPLIT_VALID, arena);
}

static void open_plain(void)
{
    open_set(false);
}

static void open_noisy(void)
{
    open_set(true);
}

static void close_set(void)
{
    sg_dataset_close(&train);
    sg_dataset_close(&valid);
    sg_arena_free(arena);
    temp_folder_remove(&folder);
}

static sg_pixel_classifier *learn(const sg_pixel_learn_opts *o, sg_pixel_learn_report *r)
{
    sg_error err = SG_ERROR_INIT;
    sg_pixel_classifier *c;
    sg_pixel_learn_report mine;
    ck_ok(sg_pixel_classifier_learn(&train, &valid, o, &c, r != NULL ? r : &mine, &err));
    ck_assert_ptr_nonnull(c);
    if (r == NULL)
        sg_pixel_learn_report_clear(&mine);
    return c;
}

static sg_pixel_learn_opts small_opts(void)
{
    sg_pixel_learn_opts o = SG_PIXEL_LEARN_OPTS_INIT;
    o.features = sg_feature_set_of(SG_FEATURES_PATCH, 3);
    o.grow.trees = 3;
    o.grow.depth = 5;
    o.grow.threads = 2;
    o.pixels = 600;
    return o;
}

/* ---- drawing ---- */

START_TEST(census_counts_every_pixel_once)
{
    sg_error err = SG_ERROR_INIT;
    sg_pixel_census c;
    uint64_t counts[5] = {0};
    static const size_t photos[] = {0, 1, 3}, class_of[] = {0, 1, 2, 3};
    ck_ok(sg_pixel_census_take(&train, arena, &c, &err));
    ck_assert_uint_eq(c.nitems, 3);
    ck_assert_uint_eq(c.nclasses, 5);
    for (size_t i = 0; i < 3; i++)
        for (size_t p = 0; p < TEST_WIDTH * TEST_HEIGHT; p++) {
            const uint8_t index = test_index_at(photos[i], p % TEST_WIDTH, p / TEST_WIDTH);
            if (index < 4)
                counts[class_of[index]]++;
        }
    for (size_t k = 0; k < 5; k++)
        ck_assert_uint_eq(c.of_class[k], counts[k]);
    ck_assert_uint_eq(c.npixels, 3 * TEST_WIDTH * 28);
    ck_assert_uint_eq(counts[3], 8);
    ck_assert_uint_eq(counts[4], 0);
}
END_TEST

START_TEST(quotas_leave_no_class_out)
{
    sg_error err = SG_ERROR_INIT;
    sg_pixel_census c;
    uint64_t q[5];
    ck_ok(sg_pixel_census_take(&train, arena, &c, &err));
    for (size_t n = 1; n < 5000; n += 1 + n / 7) {
        size_t sum = 0;
        sg_pixel_quotas(&c, n, false, q);
        for (size_t k = 0; k < 5; k++) {
            const size_t least = n / 100 > 0 ? n / 100 : 1; /* of 1 / (20 classes) */
            ck_assert_uint_le(q[k], c.of_class[k]);
            ck_assert_uint_ge(q[k], least < c.of_class[k] ? least : c.of_class[k]);
            sum += q[k];
        }
        ck_assert_uint_le(sum, n > 4 ? n : 4);
        ck_assert_uint_ge(sum + 5, n < c.npixels ? n : c.npixels);
        sg_pixel_quotas(&c, n, true, q);
        for (size_t k = 0; k < 5; k++) {
            const size_t each = n / 5 > 0 ? n / 5 : 1;
            ck_assert_uint_eq(q[k], each < c.of_class[k] ? each : c.of_class[k]);
        }
    }
    sg_pixel_quotas(&c, 1000000, false, q);
    ck_assert_mem_eq(q, c.of_class, sizeof q);
}
END_TEST

/* Colours say where a sample is from: so it is of its class, of a photograph that was asked for, and there only once. */
START_TEST(samples_are_distinct_pixels_of_their_class)
{
    static const size_t sizes[] = {5, 200, 1500, 100000};
    static const size_t photos[] = {0, 1, 3};
    sg_error err = SG_ERROR_INIT;
    sg_pixel_census c;
    sg_sample_matrix m, again;
    uint64_t q[5], got[5] = {0}, of_photo[5] = {0};
    static bool seen[TEST_PHOTOS][TEST_HEIGHT][TEST_WIDTH];
    const sg_pixel_sample_opts o = {sg_feature_set_of(SG_FEATURES_PATCH, 1), 4, 1, NULL},
                               o2 = {sg_feature_set_of(SG_FEATURES_PATCH, 1), 4, 3, NULL};
    ck_ok(sg_pixel_census_take(&train, arena, &c, &err));
    sg_pixel_quotas(&c, sizes[_i], false, q);
    ck_ok(sg_pixel_sample_draw(&train, &c, q, &o, &m, &err));
    ck_ok(sg_pixel_sample_draw(&train, &c, q, &o2, &again, &err));
    ck_assert_uint_eq(m.nfeatures, 3);
    ck_assert_uint_eq(m.nclasses, 5);
    ck_assert_uint_eq(again.n, m.n);
    ck_assert_mem_eq(m.x, again.x, m.n * 3 * sizeof *m.x);
    ck_assert_mem_eq(m.classes, again.classes, m.n);
    for (size_t i = 0; i < m.n; i++) {
        const size_t x = (size_t)m.x[i], y = (size_t)m.x[m.n + i], photo = (size_t)m.x[2 * m.n + i];
        ck_assert(photo == photos[0] || photo == photos[1] || photo == photos[2]);
        ck_assert_uint_eq(m.classes[i], test_index_at(photo, x, y)); /* the first four classes are the indices */
        ck_assert(!seen[photo][y][x]);
        seen[photo][y][x] = true;
        got[m.classes[i]]++;
        of_photo[photo]++;
    }
    ck_assert_mem_eq(got, q, sizeof q);
    if (m.n > 100)
        for (size_t i = 0; i < 3; i++) /* each photograph gives its share: they are of one size */
            ck_assert_uint_le(3 * of_photo[photos[i]], m.n + 3 * 5);
    free(m.x);
    free(m.classes);
    free(again.x);
    free(again.classes);
}
END_TEST

/* Over many seeds each pixel of a class is drawn as often: chi-square over the sky's pixels of all photographs. */
START_TEST(each_pixel_is_as_likely)
{
    enum { RUNS = 400, SKY = 6 * TEST_WIDTH };
    sg_error err = SG_ERROR_INIT;
    sg_pixel_census c;
    static double drawn[TEST_PHOTOS][SKY];
    uint64_t q[5] = {60, 0, 0, 0, 0};
    ck_ok(sg_pixel_census_take(&train, arena, &c, &err));
    for (uint64_t seed = 0; seed < RUNS; seed++) {
        const sg_pixel_sample_opts o = {sg_feature_set_of(SG_FEATURES_PATCH, 1), seed, 1, NULL};
        sg_sample_matrix m;
        ck_ok(sg_pixel_sample_draw(&train, &c, q, &o, &m, &err));
        ck_assert_uint_eq(m.n, 60);
        for (size_t i = 0; i < m.n; i++)
            drawn[(size_t)m.x[120 + i]][(size_t)m.x[60 + i] * TEST_WIDTH + (size_t)m.x[i]]++;
        free(m.x);
        free(m.classes);
    }
    /* without replacement counts vary less than Poisson: their variance is mean * (1 - 20 / 240) */
    const double mean = RUNS * 60.0 / (3 * SKY);
    double chi2 = 0;
    for (size_t p = 0; p < TEST_PHOTOS; p++)
        for (size_t i = 0; i < SKY; i++)
            if (p != 2 && p != 4)
                chi2 += (drawn[p][i] - mean) * (drawn[p][i] - mean) / (mean * (1 - 20.0 / SKY));
    const double df = 3 * (SKY - 1), z = (chi2 - df) / sqrt(2 * df);
    ck_assert_msg(fabs(z) < 5, "chi-square %g with %g degrees of freedom", chi2, df);
}
END_TEST

/* ---- learning ---- */

static void assert_same_file(const sg_pixel_classifier *a, const sg_pixel_classifier *b, bool same)
{
    sg_error err = SG_ERROR_INIT;
    size_t na, nb;
    ck_ok(sg_pixel_classifier_write(temp_path(&folder, "a.rf"), a, &err));
    ck_ok(sg_pixel_classifier_write(temp_path(&folder, "b.rf"), b, &err));
    unsigned char *x = temp_read(&folder, "a.rf", &na), *y = temp_read(&folder, "b.rf", &nb);
    ck_assert((na == nb && memcmp(x, y, na) == 0) == same);
    free(x);
    free(y);
}

START_TEST(learning_is_a_function_of_data_options_and_seed)
{
    sg_pixel_learn_opts o = small_opts();
    sg_pixel_classifier *a = learn(&o, NULL);
    for (int threads = 1; threads < 5; threads += 3) {
        o.grow.threads = threads;
        sg_pixel_classifier *b = learn(&o, NULL);
        assert_same_file(a, b, true);
        sg_pixel_classifier_free(b);
    }
    o.grow.seed = 2;
    sg_pixel_classifier *b = learn(&o, NULL);
    assert_same_file(a, b, false);
    sg_pixel_classifier_free(a);
    sg_pixel_classifier_free(b);
}
END_TEST

/* The leaves are what all training pixels make of them, whatever the trees were grown on. */
START_TEST(leaves_hold_all_training_pixels)
{
    sg_error err = SG_ERROR_INIT;
    sg_pixel_learn_opts o = small_opts();
    o.balanced = _i == 1;
    sg_pixel_learn_report r;
    sg_pixel_classifier *c = learn(&o, &r);
    const sg_forest *f = &c->forest;
    double *counts = calloc(f->nleaves * 5, sizeof *counts), total = 0;
    for (size_t i = 0; i < train.nitems; i++) {
        sg_pixel_photo p;
        ck_ok(sg_pixel_photo_open(&train, i, &o.features, &p, &err));
        for (size_t y = 0; y < TEST_HEIGHT; y++)
            for (size_t x = 0; x < TEST_WIDTH; x++) {
                const uint8_t class = p.labels.labels[y * TEST_WIDTH + x];
                for (size_t t = 0; class != SG_CLASS_IGNORE && t < f->ntrees; t++) {
                    size_t at = f->roots[t];
                    while (f->nodes[at].feature != SG_FOREST_LEAF)
                        at = f->nodes[at].child + (sg_features_value(&p.features, f->nodes[at].feature, x, y) <=
                                                           f->nodes[at].threshold
                                                       ? 0u
                                                       : 1u);
                    counts[f->nodes[at].child * 5 + class]++;
                }
            }
        sg_pixel_photo_clear(&p);
    }
    for (size_t k = 0; k < 5; k++)
        total += (double)r.train_pixels[k];
    for (size_t l = 0; l < f->nleaves; l++) {
        double sum = 0, p[5];
        for (size_t k = 0; k < 5; k++) { /* four classes occur: each has a quarter of the weight */
            const double weight = o.balanced && r.train_pixels[k] > 0 ? total / 4 / (double)r.train_pixels[k] : 1;
            sum += p[k] = weight * counts[l * 5 + k] + 1;
        }
        for (size_t k = 0; k < 5; k++)
            ck_assert_double_eq_tol(f->leaves[l * 5 + k], p[k] / sum, 1e-6);
    }
    for (size_t k = 0; k < 5; k++)
        ck_assert_double_eq_tol(c->frequency[k], k == 4 ? 0 : o.balanced ? 0.25 : (double)r.train_pixels[k] / total, 1e-12);
    sg_pixel_classifier_free(c);
    sg_pixel_learn_report_clear(&r);
    free(counts);
}
END_TEST

START_TEST(report_adds_up)
{
    sg_pixel_learn_opts o = small_opts();
    sg_pixel_learn_report r;
    sg_pixel_classifier *c = learn(&o, &r);
    uint64_t uses = 0;
    for (size_t i = 0; i < 27; i++)
        uses += r.uses[i];
    ck_assert_uint_eq(uses, c->forest.nnodes - c->forest.nleaves);
    ck_assert_uint_eq(r.train_images, 3);
    ck_assert_uint_eq(r.valid_images, 1);
    ck_assert_uint_eq(r.valid_pixels, TEST_WIDTH * 28);
    ck_assert(isnan(r.valid.recall[3]) && isnan(r.valid.recall[4]));
    ck_assert_double_ge(r.valid.overall + r.valid.class_average, r.valid_before.overall + r.valid_before.class_average);
    ck_assert(c->calibration.fitted);
    /* without validation part nothing is changed */
    sg_error err = SG_ERROR_INIT;
    sg_pixel_classifier *plain;
    sg_pixel_learn_report r2;
    ck_ok(sg_pixel_classifier_learn(&train, NULL, &o, &plain, &r2, &err));
    ck_assert(!plain->calibration.fitted);
    ck_assert_double_eq(plain->calibration.temperature, 1);
    ck_assert_double_eq(plain->calibration.exponent, 0);
    ck_assert_mem_eq(plain->forest.leaves, c->forest.leaves, c->forest.nleaves * 5 * sizeof(float));
    sg_pixel_classifier_free(plain);
    sg_pixel_classifier_free(c);
    sg_pixel_learn_report_clear(&r);
    sg_pixel_learn_report_clear(&r2);
}
END_TEST

static bool stop_at(sg_progress *p)
{
    size_t *left = p->user;
    return *left == 0 || --*left == 0;
}

/* Stopped at any moment: a classifier that holds, or none. */
START_TEST(stopped_learning_leaves_what_there_is)
{
    sg_error err = SG_ERROR_INIT;
    size_t whole = 0, partial = 0, none = 0;
    for (size_t k = 1; whole == 0; k++) {
        size_t left = k;
        sg_progress progress = {NULL, stop_at, &left};
        sg_pixel_learn_opts o = small_opts();
        sg_pixel_classifier *c;
        sg_pixel_learn_report r;
        o.grow.progress = &progress;
        o.grow.threads = 1;
        const sg_status st = sg_pixel_classifier_learn(&train, &valid, &o, &c, &r, &err);
        ck_assert(st == SG_OK || st == SG_STOPPED);
        ck_assert(st == SG_STOPPED || c != NULL);
        if (c != NULL)
            ck_ok(sg_pixel_classifier_check(c, &err));
        *(st == SG_OK ? &whole : c != NULL ? &partial : &none) += 1;
        sg_pixel_classifier_free(c);
        sg_pixel_learn_report_clear(&r);
    }
    ck_assert_uint_gt(none, 2);
    ck_assert_uint_gt(partial, 5); /* two of three trees, three photographs of leaves, validation */
}
END_TEST

START_TEST(learning_refuses_what_makes_no_sense)
{
    sg_error err = SG_ERROR_INIT;
    sg_pixel_classifier *c;
    sg_pixel_learn_report r;
    for (int i = 0; i < 6; i++) {
        sg_pixel_learn_opts o = small_opts();
        sg_dataset data = train;
        data.nitems = i == 0 ? 0 : data.nitems;
        o.pixels = i == 1 ? 0 : o.pixels;
        o.smoothing = i == 2 ? 0 : o.smoothing;
        o.features.version = i == 3 ? 99 : o.features.version;
        o.grow.depth = i == 4 ? 0 : o.grow.depth;
        o.grow.trees = i == 5 ? 0 : o.grow.trees;
        ck_assert_int_eq(sg_pixel_classifier_learn(&data, &valid, &o, &c, &r, &err), SG_EINVAL);
        ck_assert_ptr_null(c);
    }
}
END_TEST

/* ---- applying ---- */

START_TEST(applying_is_the_mean_calibrated)
{
    sg_error err = SG_ERROR_INIT;
    sg_pixel_learn_opts o = small_opts();
    sg_pixel_classifier *c = learn(&o, NULL);
    c->calibration = (sg_calibration){_i == 0 ? 1 : 0.7, _i == 2 ? 0.3 : 0, true};
    sg_image im;
    sg_features f;
    sg_float_map raw, p, again;
    ck_ok(sg_png_read_rgb(valid.items[0].image, &im, &err));
    ck_ok(sg_features_create(&c->features, &im, &f, &err));
    ck_ok(sg_forest_apply(&c->forest, &f, 1, &raw, &err));
    ck_ok(sg_pixel_classifier_apply(c, &im, 1, &p, &err));
    ck_ok(sg_pixel_classifier_apply(c, &im, 3, &again, &err));
    const size_t plane = im.width * im.height;
    ck_assert_mem_eq(p.values, again.values, 5 * plane * sizeof *p.values);
    for (size_t i = 0; i < plane; i++) {
        double q[5], sum = 0, total = 0;
        for (size_t k = 0; k < 5; k++) {
            const double prior = c->frequency[k] > 0 ? pow(c->frequency[k], c->calibration.exponent) : 1;
            sum += q[k] = pow((double)raw.values[k * plane + i] / prior, 1 / c->calibration.temperature);
        }
        for (size_t k = 0; k < 5; k++) {
            ck_assert_double_eq_tol(p.values[k * plane + i], q[k] / sum, 2e-6);
            ck_assert_float_gt(p.values[k * plane + i], 0);
            total += (double)p.values[k * plane + i];
        }
        ck_assert_double_eq_tol(total, 1, 1e-5);
    }
    sg_float_map_clear(&raw);
    sg_float_map_clear(&p);
    sg_float_map_clear(&again);
    sg_features_clear(&f);
    sg_image_clear(&im);
    sg_pixel_classifier_free(c);
}
END_TEST

/* A cold calibration makes even probabilities that would underflow positive. */
START_TEST(no_class_becomes_impossible)
{
    const sg_calibration c = {0.02, 0, true};
    float p[3] = {0.999f, 0.0009f, 0.0001f}, shift[3];
    const double frequency[3] = {0.5, 0.5, 0};
    sg_pixel_calibration_shift(&c, frequency, 3, shift);
    sg_pixel_calibrate(&c, shift, 3, p);
    for (int k = 0; k < 3; k++)
        ck_assert(p[k] > 0 && isfinite(logf(p[k])));
}
END_TEST

/* ---- calibration ---- */

/* Pixels whose classes are drawn from q, judged by p = (q f^a)^t, normalised: too sure of itself where t > 1. */
static sg_pixel_judgements simulate(size_t n, double t, double a, const double *f, uint64_t seed)
{
    enum { K = 4 };
    gsl_rng *rng = sg_random_create(seed);
    sg_pixel_judgements j = {n, K, malloc(n * K * sizeof *j.p), malloc(n)};
    for (size_t i = 0; i < n; i++) {
        double q[K], p[K], sum = 0, total = 0, u = sg_random_uniform(rng);
        for (size_t k = 0; k < K; k++)
            sum += q[k] = gsl_ran_gamma(rng, 0.4, 1) + 1e-3;
        for (size_t k = 0; k < K; k++)
            total += p[k] = pow(q[k] / sum * pow(f[k], a), t);
        j.classes[i] = 0;
        for (size_t k = 0; k < K; k++) {
            j.p[i * K + k] = (float)(p[k] / total);
            u -= q[k] / sum;
            j.classes[i] += u > 0 && k + 1 < K;
        }
    }
    gsl_rng_free(rng);
    return j;
}

static sg_pixel_weights equal_weights(void)
{
    sg_pixel_weights w;
    for (size_t k = 0; k < SG_MAX_CLASSES; k++)
        w.accuracy[k] = w.loss[k] = 1;
    return w;
}

START_TEST(temperature_is_found)
{
    static const double truths[] = {0.5, 0.8, 1, 1.7, 3};
    const double f[4] = {0.25, 0.25, 0.25, 0.25}, t = truths[_i];
    sg_error err = SG_ERROR_INIT;
    sg_pixel_judgements j = simulate(15000, t, 0, f, 1);
    const sg_pixel_weights w = equal_weights();
    const sg_calibration none = SG_CALIBRATION_NONE;
    sg_calibration c, again;
    ck_ok(sg_pixel_calibration_fit(&j, f, &w, false, 1, NULL, NULL, &c, &err));
    ck_ok(sg_pixel_calibration_fit(&j, f, &w, false, 3, NULL, NULL, &again, &err));
    ck_assert_double_eq(c.temperature, again.temperature);
    ck_assert(c.fitted);
    ck_assert_double_eq(c.exponent, 0);
    ck_assert_double_eq_tol(c.temperature, t, 0.06 * t);
    const double best = sg_pixel_score_of(&j, &c, f, &w).log_loss;
    ck_assert_double_le(best, sg_pixel_score_of(&j, &none, f, &w).log_loss + 1e-9);
    for (double s = 0.2; s < 5; s *= 1.1) { /* no other is better */
        const sg_calibration other = {s, 0, true};
        ck_assert_double_ge(sg_pixel_score_of(&j, &other, f, &w).log_loss, best - 1e-6);
    }
    sg_pixel_judgements_clear(&j);
}
END_TEST

START_TEST(exponent_has_the_best_accuracy)
{
    const double f[4] = {0.7, 0.2, 0.08, 0.02};
    sg_error err = SG_ERROR_INIT;
    sg_pixel_judgements j = simulate(10000, 1, 0.6, f, 2 + (uint64_t)_i);
    const sg_pixel_weights w = equal_weights();
    sg_calibration c;
    sg_pixel_tradeoff curve[SG_PIXEL_EXPONENTS];
    ck_ok(sg_pixel_calibration_fit(&j, f, &w, true, 2, NULL, curve, &c, &err));
    ck_assert_double_eq_tol(c.exponent, 0.6, 0.2); /* what was done to them is undone */
    const sg_pixel_score best = sg_pixel_score_of(&j, &c, f, &w);
    for (int i = 0; i <= 40; i++) {
        const sg_calibration other = {c.temperature, i / 40.0, true};
        const sg_pixel_score s = sg_pixel_score_of(&j, &other, f, &w);
        ck_assert_double_le(s.overall + s.class_average, best.overall + best.class_average + 1e-4);
        ck_assert_double_eq_tol(curve[i].exponent, other.exponent, 1e-12);
        ck_assert_double_eq_tol(curve[i].overall, s.overall, 1e-4);
        ck_assert_double_eq_tol(curve[i].class_average, s.class_average, 1e-3);
    }
    sg_pixel_judgements_clear(&j);
}
END_TEST

START_TEST(score_is_what_a_hand_finds)
{
    sg_error err = SG_ERROR_INIT;
    float p[] = {0.5f, 0.3f, 0.2f, /**/ 0.1f, 0.8f, 0.1f, /**/ 0.6f, 0.3f, 0.1f, /**/ 0.2f, 0.7f, 0.1f};
    uint8_t classes[] = {0, 0, 1, 1};
    sg_pixel_judgements j = {4, 3, p, classes}, none = {0, 3, p, classes};
    sg_pixel_weights w = equal_weights();
    const sg_calibration plain = SG_CALIBRATION_NONE;
    const double f[3] = {0.5, 0.5, 0};
    sg_pixel_score s = sg_pixel_score_of(&j, &plain, f, &w);
    ck_assert_double_eq_tol(s.overall, 0.5, 1e-12);
    ck_assert_double_eq_tol(s.class_average, 0.5, 1e-12);
    ck_assert_double_eq_tol(s.log_loss, -(log(0.5) + log(0.1) + log(0.3) + log(0.7)) / 4, 1e-6);
    ck_assert(isnan(s.recall[2]));
    w.accuracy[1] = 3;
    w.loss[0] = 0;
    p[3] = 0.9f; /* now the second pixel is right */
    p[4] = 0.05f;
    p[5] = 0.05f;
    s = sg_pixel_score_of(&j, &plain, f, &w);
    ck_assert_double_eq_tol(s.overall, (2 + 3) / 8.0, 1e-12);
    ck_assert_double_eq_tol(s.class_average, 0.75, 1e-12);
    ck_assert_double_eq_tol(s.log_loss, -(log(0.3) + log(0.7)) / 2, 1e-6);
    ck_assert(isnan(sg_pixel_score_of(&none, &plain, f, &w).overall));
    sg_calibration c;
    ck_assert_int_eq(sg_pixel_calibration_fit(&none, f, &w, true, 1, NULL, NULL, &c, &err), SG_EINVAL);
}
END_TEST

/* ---- files ---- */

START_TEST(what_is_written_is_read)
{
    sg_error err = SG_ERROR_INIT;
    sg_pixel_learn_opts o = small_opts();
    o.balanced = _i == 1;
    sg_pixel_classifier *c = learn(&o, NULL), *back;
    ck_ok(sg_pixel_classifier_write(temp_path(&folder, "c.rf"), c, &err));
    ck_ok(sg_pixel_classifier_read(temp_path(&folder, "c.rf"), &back, &err));
    assert_same_file(c, back, true);
    ck_assert_int_eq(back->balanced, _i == 1);
    ck_assert_double_eq(sg_pixel_classifier_calibration(back).temperature, c->calibration.temperature);
    ck_assert_double_eq(sg_pixel_classifier_calibration(back).exponent, c->calibration.exponent);
    ck_assert_uint_eq(sg_pixel_classifier_features(back).patch, 3);
    ck_assert_uint_eq(sg_pixel_classifier_sizes_of(back).nnodes, c->forest.nnodes);
    const sg_classes *classes = sg_pixel_classifier_classes(back);
    ck_assert_uint_eq(classes->nclasses, 5);
    for (size_t k = 0; k < 5; k++) {
        ck_assert_str_eq(classes->names[k], train.classes.names[k]);
        ck_assert_uint_eq(classes->colors[k], train.classes.colors[k]);
        ck_assert_uint_eq(classes->first_index[k], train.classes.first_index[k]);
    }
    ck_assert_mem_eq(classes->class_of, train.classes.class_of, 256);
    ck_assert_mem_eq(classes->index_colors, train.classes.index_colors, sizeof classes->index_colors);
    sg_pixel_classifier_free(c);
    sg_pixel_classifier_free(back);
}
END_TEST

static sg_status read_bytes(const unsigned char *bytes, size_t n, sg_pixel_classifier **out, sg_error *err)
{
    *out = NULL;
    temp_write(&folder, "x.rf", bytes, n);
    return sg_pixel_classifier_read(temp_path(&folder, "x.rf"), out, err);
}

static unsigned char *small_file(size_t *n)
{
    sg_error err = SG_ERROR_INIT;
    sg_pixel_learn_opts o = small_opts();
    o.grow.trees = 2;
    o.grow.depth = 2;
    sg_pixel_classifier *c = learn(&o, NULL);
    ck_ok(sg_pixel_classifier_write(temp_path(&folder, "c.rf"), c, &err));
    sg_pixel_classifier_free(c);
    return temp_read(&folder, "c.rf", n);
}

START_TEST(every_cut_and_every_changed_byte_is_found)
{
    sg_error err = SG_ERROR_INIT;
    sg_pixel_classifier *c;
    size_t n;
    unsigned char *bytes = small_file(&n);
    ck_assert_uint_gt(n, 1000);
    for (size_t k = 0; k < n; k++) {
        ck_assert_int_eq(read_bytes(bytes, k, &c, &err), SG_EINPUT);
        ck_assert_ptr_nonnull(strstr(err.msg, "x.rf: "));
    }
    unsigned char *more = malloc(n + 1);
    memcpy(more, bytes, n);
    more[n] = 0;
    ck_assert_int_eq(read_bytes(more, n + 1, &c, &err), SG_EINPUT);
    ck_assert_ptr_nonnull(strstr(err.msg, "too long"));
    for (size_t k = 0; k < n; k++) {
        const unsigned char kept = bytes[k];
        bytes[k] ^= (unsigned char)(1u << k % 8);
        ck_assert_int_eq(read_bytes(bytes, n, &c, &err), SG_EINPUT);
        bytes[k] = kept;
    }
    ck_ok(read_bytes(bytes, n, &c, &err));
    sg_pixel_classifier_free(c);
    free(more);
    free(bytes);
}
END_TEST

/* The checksum made right again, what is read must hold: then it can be used, or the sentence says what does not. */
START_TEST(damage_under_a_right_checksum_does_no_harm)
{
    static const unsigned char values[] = {0x00, 0x01, 0x7f, 0x80, 0xff};
    sg_error err = SG_ERROR_INIT;
    size_t n, refused = 0;
    unsigned char *bytes = small_file(&n);
    sg_image im;
    ck_ok(sg_image_create(5, 4, &im, &err));
    for (size_t k = 24; k < n; k++) {
        sg_pixel_classifier *c;
        const unsigned char kept = bytes[k];
        bytes[k] = values[(k + (size_t)_i) % sizeof values];
        const uint32_t crc = (uint32_t)crc32(crc32(0, NULL, 0), bytes + 24, (uInt)(n - 24));
        for (size_t i = 0; i < 4; i++)
            bytes[12 + i] = (unsigned char)(crc >> 8 * i);
        const sg_status st = read_bytes(bytes, n, &c, &err);
        ck_assert(st == SG_OK || st == SG_EINPUT);
        refused += st != SG_OK;
        if (st == SG_OK) {
            sg_float_map p;
            ck_ok(sg_pixel_classifier_apply(c, &im, 1, &p, &err));
            for (size_t i = 0; i < 20; i++) {
                double sum = 0;
                for (size_t q = 0; q < p.channels; q++)
                    sum += (double)p.values[q * 20 + i];
                ck_assert_double_eq_tol(sum, 1, 1e-4);
            }
            sg_float_map_clear(&p);
        }
        sg_pixel_classifier_free(c);
        bytes[k] = kept;
    }
    ck_assert_uint_gt(refused, 100);
    sg_image_clear(&im);
    free(bytes);
}
END_TEST

START_TEST(reasons_are_told)
{
    static const struct {
        size_t at;
        unsigned char value;
        const char *said;
    } cases[] = {{0, 'S', "not a pixel classifier"},
                 {8, 2, "version 2; this program knows version 1"},
                 {16, 1, "bytes"},
                 {12, 0, "checksum"}};
    sg_error err = SG_ERROR_INIT;
    sg_pixel_classifier *c;
    size_t n;
    unsigned char *bytes = small_file(&n);
    bytes[12]++; /* so that a zero there is a change for sure */
    bytes[cases[_i].at] = cases[_i].value == bytes[cases[_i].at] ? 77 : cases[_i].value;
    ck_assert_int_eq(read_bytes(bytes, n, &c, &err), SG_EINPUT);
    ck_assert_msg(strstr(err.msg, cases[_i].said) != NULL, "%s", err.msg);
    ck_assert_int_eq(sg_pixel_classifier_read(temp_path(&folder, "none.rf"), &c, &err), SG_EINPUT);
    ck_assert_int_eq(sg_pixel_classifier_read(temp_path(&folder, "set"), &c, &err), SG_EINPUT);
    free(bytes);
}
END_TEST

START_TEST(unwritable_places_are_told)
{
    sg_error err = SG_ERROR_INIT;
    sg_pixel_learn_opts o = small_opts();
    sg_pixel_classifier *c = learn(&o, NULL);
    ck_assert_int_eq(sg_pixel_classifier_write(temp_path(&folder, "nowhere/c.rf"), c, &err), SG_EIO);
    ck_assert_int_eq(sg_pixel_classifier_write("/dev/full", c, &err), SG_EIO);
    sg_pixel_classifier_free(c);
}
END_TEST

static TCase *with_set(Suite *suite, const char *name, void (*open)(void))
{
    TCase *c = tcase_create(name);
    tcase_add_checked_fixture(c, open, close_set);
    suite_add_tcase(suite, c);
    return c;
}

int main(void)
{
    Suite *suite = suite_create("pixel_classifier");
    TCase *c = with_set(suite, "drawing", open_plain);
    tcase_add_test(c, census_counts_every_pixel_once);
    tcase_add_test(c, quotas_leave_no_class_out);
    tcase_add_loop_test(c, samples_are_distinct_pixels_of_their_class, 0, 4);
    tcase_add_test(c, each_pixel_is_as_likely);
    c = with_set(suite, "learning", open_noisy);
    tcase_add_test(c, learning_is_a_function_of_data_options_and_seed);
    tcase_add_loop_test(c, leaves_hold_all_training_pixels, 0, 2);
    tcase_add_test(c, report_adds_up);
    tcase_add_test(c, stopped_learning_leaves_what_there_is);
    tcase_add_test(c, learning_refuses_what_makes_no_sense);
    tcase_add_loop_test(c, applying_is_the_mean_calibrated, 0, 3);
    c = with_set(suite, "files", open_noisy);
    tcase_add_loop_test(c, what_is_written_is_read, 0, 2);
    tcase_add_test(c, every_cut_and_every_changed_byte_is_found);
    tcase_add_loop_test(c, damage_under_a_right_checksum_does_no_harm, 0, 3);
    tcase_add_loop_test(c, reasons_are_told, 0, 4);
    tcase_add_test(c, unwritable_places_are_told);
    c = tcase_create("calibration");
    suite_add_tcase(suite, c);
    tcase_add_test(c, no_class_becomes_impossible);
    tcase_add_loop_test(c, temperature_is_found, 0, 5);
    tcase_add_loop_test(c, exponent_has_the_best_accuracy, 0, 3);
    tcase_add_test(c, score_is_what_a_hand_finds);
    return test_run(suite);
}
