/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_unaries.c - class probabilities of pixels: what is refused, MAP, hard ones, costs, channels by name. */
#include "config.h"

#include "core/random.h"
#include "parse/unaries.h"
#include "tests/failing_malloc.h"
#include "tests/support.h"
#include "tests/temp_folder.h"

#include <math.h>
#include <string.h>

enum { CLASSES = 4, WIDTH = 5, HEIGHT = 3, PIXELS = WIDTH * HEIGHT };

static temp_folder t;
static gsl_rng *rng;
static sg_error err;

static void set_up(void)
{
    t = temp_folder_make();
    rng = sg_random_create(1);
    ck_assert_ptr_nonnull(rng);
}

static void tear_down(void)
{
    gsl_rng_free(rng);
    temp_folder_remove(&t);
}

/* Random probabilities; a third of the entries is 0, but never all of a pixel. */
static sg_float_map random_map(size_t channels)
{
    sg_float_map p;
    ck_ok(sg_float_map_create(channels, HEIGHT, WIDTH, &p, &err));
    for (size_t i = 0; i < PIXELS; i++) {
        double sum = 0;
        for (size_t c = 0; c < channels; c++) {
            const bool zero = c > 0 && gsl_rng_uniform(rng) < 0.33;
            sum += p.values[c * PIXELS + i] = zero ? 0 : (float)(0.1 + gsl_rng_uniform(rng));
        }
        for (size_t c = 0; c < channels; c++)
            p.values[c * PIXELS + i] = (float)(p.values[c * PIXELS + i] / sum);
    }
    return p;
}

static sg_float_map copy_of(const sg_float_map *p)
{
    sg_float_map q;
    ck_ok(sg_float_map_create(p->channels, p->height, p->width, &q, &err));
    memcpy(q.values, p->values, p->channels * PIXELS * sizeof *q.values);
    return q;
}

static void write_map(const char *name, const sg_float_map *p)
{
    ck_ok(sg_npy_write(temp_path(&t, name), p, &err));
}

static double sum_of(const sg_float_map *p, size_t i)
{
    double sum = 0;
    for (size_t c = 0; c < p->channels; c++)
        sum += p->values[c * PIXELS + i];
    return sum;
}

static void refused(const char *name, size_t nclasses, float floor, sg_status status, const char *text)
{
    sg_float_map out = {7, 7, 7, NULL};
    ck_assert_int_eq(sg_unaries_read(t.path, name, nclasses, floor, &out, &err), status);
    ck_assert_msg(strstr(err.msg, text) != NULL, "'%s' is not in: %s", text, err.msg);
    ck_assert_msg(status != SG_EINPUT || strstr(err.msg, name) != NULL, "the file is not named: %s", err.msg);
    ck_assert(out.channels == 7 && out.values == NULL);
}

START_TEST(what_is_written_is_read)
{
    sg_float_map p = random_map(CLASSES), q;
    write_map("a.npy", &p);
    ck_ok(sg_unaries_read(t.path, "a", CLASSES, 0, &q, &err));
    ck_assert(q.channels == CLASSES && q.height == HEIGHT && q.width == WIDTH);
    ck_assert_mem_eq(q.values, p.values, CLASSES * PIXELS * sizeof(float));
    sg_float_map_clear(&q);
    sg_float_map_clear(&p);
}
END_TEST

START_TEST(zeros_are_lifted_and_the_rest_keeps_its_proportions)
{
    const float floor = 0.01F;
    sg_float_map p = random_map(CLASSES), q;
    p.values[0] = 1;
    for (size_t c = 1; c < CLASSES; c++)
        p.values[c * PIXELS] = 0;
    write_map("a.npy", &p);
    ck_ok(sg_unaries_read(t.path, "a", CLASSES, floor, &q, &err));
    size_t lifted = 0;
    for (size_t i = 0; i < PIXELS; i++) {
        double extra = 0;
        for (size_t c = 0; c < CLASSES; c++)
            extra += p.values[c * PIXELS + i] < floor ? floor - p.values[c * PIXELS + i] : 0;
        for (size_t c = 0; c < CLASSES; c++) {
            const double was = p.values[c * PIXELS + i], expected = (was < floor ? floor : was) / (1 + extra);
            ck_assert_double_eq_tol(q.values[c * PIXELS + i], expected, 1e-6);
            ck_assert(extra > 0 || q.values[c * PIXELS + i] == p.values[c * PIXELS + i]);
            lifted += was == 0;
        }
        ck_assert_double_eq_tol(sum_of(&q, i), 1, 1e-6);
    }
    ck_assert_uint_gt(lifted, CLASSES);
    ck_assert_double_eq_tol(q.values[PIXELS], 0.01 / 1.03, 1e-7);
    sg_float_map_clear(&p);
    sg_float_map_clear(&q);
}
END_TEST

START_TEST(what_is_no_distribution_is_refused_with_its_place)
{
    static const struct {
        float value;
        const char *text;
    } cases[] = {{NAN, "class 2 has nan"},        {-0.25F, "class 2 has -0.25"}, {INFINITY, "class 2 has inf"},
                 {-INFINITY, "class 2 has -inf"}, {3, "sum to "},                {-1e-9F, "class 2 has -1e-09"}};
    sg_float_map p = random_map(CLASSES);
    p.values[2 * PIXELS + 7] = cases[_i].value;
    p.values[2 * PIXELS + 8] = cases[_i].value; /* the first one is named */
    write_map("bad.npy", &p);
    refused("bad", CLASSES, 0, SG_EINPUT, cases[_i].text);
    refused("bad", CLASSES, 0, SG_EINPUT, "bad.npy: column 2, row 1: ");
    sg_float_map_clear(&p);
}
END_TEST

START_TEST(sums_may_be_off_by_a_thousandth)
{
    static const struct {
        double scale;
        bool good;
    } cases[] = {{1.0009, true}, {0.9991, true}, {1.0012, false}, {0.9988, false}, {0, false}};
    sg_float_map p = random_map(CLASSES), q;
    for (size_t c = 0; c < CLASSES; c++)
        p.values[c * PIXELS + 14] = (float)(p.values[c * PIXELS + 14] * cases[_i].scale);
    write_map("a.npy", &p);
    if (cases[_i].good) {
        ck_ok(sg_unaries_read(t.path, "a", CLASSES, 0, &q, &err));
        sg_float_map_clear(&q);
    } else {
        refused("a", CLASSES, 0, SG_EINPUT, "column 4, row 2: the 4 probabilities sum to ");
    }
    sg_float_map_clear(&p);
}
END_TEST

START_TEST(files_that_are_no_unaries_are_refused)
{
    sg_float_map p = random_map(CLASSES);
    write_map("a.npy", &p);
    refused("a", CLASSES + 1, 0, SG_EINPUT, "4 values a pixel, but there are 5 classes");
    refused("a", CLASSES - 1, 0, SG_EINPUT, "4 values a pixel, but there are 3 classes");
    refused("missing", CLASSES, 0, SG_EINPUT, "No such file");
    temp_text(&t, "text.npy", "0.5 0.5\n");
    refused("text", CLASSES, 0, SG_EINPUT, "no NumPy array file");
    refused("a", CLASSES, 0.25F, SG_EINVAL, "floor");
    refused("a", CLASSES, -0.1F, SG_EINVAL, "floor");
    refused("a", CLASSES, NAN, SG_EINVAL, "floor");
    char name[5000];
    memset(name, 'x', sizeof name);
    name[sizeof name - 1] = '\0';
    ck_assert_int_eq(sg_unaries_read(t.path, name, CLASSES, 0, &p, &err), SG_EINPUT);
    sg_float_map_clear(&p);
}
END_TEST

/* ---- MAP, hard, costs ---- */

START_TEST(the_map_is_the_first_best_class)
{
    gsl_rng_set(rng, (unsigned long)_i + 1);
    sg_float_map p = random_map(CLASSES);
    for (size_t c = 0; c < CLASSES; c++)
        p.values[c * PIXELS + 3] = 0.25F; /* all alike */
    p.values[1 * PIXELS + 4] = p.values[3 * PIXELS + 4] = 0.4F;
    p.values[4] = p.values[2 * PIXELS + 4] = 0.1F;
    sg_label_map m;
    ck_ok(sg_unaries_map(&p, &m, &err));
    ck_assert(m.width == WIDTH && m.height == HEIGHT && m.labels[3] == 0 && m.labels[4] == 1);
    for (size_t i = 0; i < PIXELS; i++)
        for (size_t c = 0; c < CLASSES; c++) {
            const float best = p.values[m.labels[i] * (size_t)PIXELS + i], other = p.values[c * PIXELS + i];
            ck_assert(c < m.labels[i] ? other < best : other <= best);
        }
    sg_label_map_clear(&m);
    sg_float_map_clear(&p);
}
END_TEST

START_TEST(hard_ones_know_the_map_only)
{
    sg_float_map p = random_map(7);
    p.values[5] = p.values[5 + PIXELS] = 0.5F;
    for (size_t c = 2; c < 7; c++)
        p.values[5 + c * PIXELS] = 0;
    sg_float_map hard = copy_of(&p);
    sg_label_map before, after;
    ck_ok(sg_unaries_map(&p, &before, &err));
    ck_ok(sg_unaries_harden(&hard, 0.994, &err));
    ck_ok(sg_unaries_map(&hard, &after, &err));
    ck_assert_mem_eq(before.labels, after.labels, PIXELS);
    for (size_t i = 0; i < PIXELS; i++) {
        for (size_t c = 0; c < 7; c++)
            ck_assert_double_eq_tol(hard.values[c * PIXELS + i], c == before.labels[i] ? 0.994 : 0.001, 1e-7);
        ck_assert_double_eq_tol(sum_of(&hard, i), 1, 1e-6);
    }
    static const double bad[] = {1, 1.5, 0, -1, 1.0 / 7, NAN};
    for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++)
        ck_assert_int_eq(sg_unaries_harden(&hard, bad[k], &err), SG_EINVAL);
    sg_float_map one = random_map(1);
    ck_assert_int_eq(sg_unaries_harden(&one, 0.994, &err), SG_EINVAL); /* nothing is left for other classes */
    sg_label_map_clear(&before);
    sg_label_map_clear(&after);
    sg_float_map_clear(&p);
    sg_float_map_clear(&hard);
    sg_float_map_clear(&one);
}
END_TEST

START_TEST(costs_are_logarithms)
{
    sg_float_map p = random_map(CLASSES);
    ck_ok(sg_unaries_lift(&p, 1e-4F, &err));
    p.values[2] = 1.0009F; /* within the tolerance of sums */
    p.values[3] = 1;
    sg_float_map cost = copy_of(&p);
    sg_unaries_to_costs(&cost);
    for (size_t i = 0; i < CLASSES * PIXELS; i++) {
        const double expected = -log((double)p.values[i]);
        ck_assert_double_eq_tol(cost.values[i], expected > 0 ? expected : 0, 1e-6);
        ck_assert(isfinite(cost.values[i]) && !signbit(cost.values[i]));
    }
    sg_float_map_clear(&p);
    sg_float_map_clear(&cost);
}
END_TEST

START_TEST(more_classes_than_a_label_map_holds)
{
    sg_float_map p;
    sg_label_map m = {0};
    ck_ok(sg_float_map_create(SG_MAX_CLASSES + 1, 1, 1, &p, &err));
    ck_assert_int_eq(sg_unaries_map(&p, &m, &err), SG_EINVAL);
    sg_float_map_clear(&p);
}
END_TEST

/* ---- channels ---- */

static sg_grammar *grammar_of(const char *labels, const char *body)
{
    char text[8192];
    sg_grammar *g = NULL;
    snprintf(text, sizeof text, "%s\nstart S\nrule S -> %s\n", labels, body);
    ck_ok(sg_grammar_parse(text, strlen(text), "test", &g, &err));
    return g;
}

START_TEST(channels_go_by_name)
{
    static const char *const names[] = {"wall", "ignore", "window", "wall", "door"};
    static const uint32_t colors[5] = {1, 2, 3, 4, 5};
    sg_classes classes;
    ck_ok(sg_classes_create(5, names, colors, &classes, &err));
    sg_grammar *g = grammar_of("label door #000001 label wall #000002", "split x { door | wall }");
    uint32_t channel[16];
    ck_assert_uint_le(sg_grammar_symbol_count(g), 16);
    ck_ok(sg_unaries_channels(g, &classes, channel, &err)); /* a class without a label is no fault */
    for (sg_sym s = 0; s < sg_grammar_symbol_count(g); s++) {
        const sg_symbol *symbol = sg_grammar_symbol(g, s);
        if (symbol->kind == SG_SYMBOL_LABEL)
            ck_assert_uint_eq(channel[s], strcmp(symbol->name, "wall") == 0 ? 0 : 2);
        else
            ck_assert_uint_eq(channel[s], UINT32_MAX);
    }
    sg_grammar_free(g);
    g = grammar_of("label door #000001 label moon #000002 label wall #000003 label sun #000004",
                   "split x { door | moon | wall | sun }");
    ck_assert_int_eq(sg_unaries_channels(g, &classes, channel, &err), SG_EINPUT);
    ck_assert_ptr_nonnull(strstr(err.msg, ": moon, sun (those are wall, window, door)"));
    sg_grammar_free(g);
    sg_classes_clear(&classes);
}
END_TEST

START_TEST(very_many_missing_labels_are_cut_with_dots)
{
    static const char *const names[] = {"wall"};
    static const uint32_t colors[1] = {1};
    char labels[8000] = "", body[4000] = "split x { ";
    for (int i = 0; i < 120; i++) {
        snprintf(labels + strlen(labels), sizeof labels - strlen(labels), "label strange%03d #000001\n", i);
        snprintf(body + strlen(body), sizeof body - strlen(body), "%sstrange%03d", i > 0 ? " | " : "", i);
    }
    strcat(body, " }");
    sg_classes classes;
    uint32_t channel[512];
    ck_ok(sg_classes_create(1, names, colors, &classes, &err));
    sg_grammar *g = grammar_of(labels, body);
    ck_assert_uint_le(sg_grammar_symbol_count(g), 512);
    ck_assert_int_eq(sg_unaries_channels(g, &classes, channel, &err), SG_EINPUT);
    ck_assert_ptr_nonnull(strstr(err.msg, "strange000, strange001, "));
    ck_assert_ptr_nonnull(strstr(err.msg, ", ... (those are wall)"));
    sg_grammar_free(g);
    sg_classes_clear(&classes);
}
END_TEST

/* ---- lack of memory ---- */

START_TEST(each_allocation_may_fail)
{
    sg_float_map p = random_map(CLASSES);
    write_map("a.npy", &p);
    for (size_t k = 0;; k++) {
        sg_float_map q = {0};
        sg_label_map m = {0};
        test_fail_allocation(k);
        const sg_status read = sg_unaries_read(t.path, "a", CLASSES, 1e-3F, &q, &err);
        const sg_status map = read == SG_OK ? sg_unaries_map(&q, &m, &err) : SG_OK;
        const bool failed = test_allocation_failed();
        sg_float_map_clear(&q);
        sg_label_map_clear(&m);
        if (!failed) {
            ck_assert(read == SG_OK && map == SG_OK);
            ck_assert_uint_gt(k, 2);
            break;
        }
        /* libc's own buffers come from elsewhere: every failure here is ours */
        ck_assert(read == SG_ENOMEM || map == SG_ENOMEM);
    }
    sg_float_map_clear(&p);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("unaries");
    TCase *tc = tcase_create("unaries");
    tcase_add_checked_fixture(tc, set_up, tear_down);
    tcase_add_test(tc, what_is_written_is_read);
    tcase_add_test(tc, zeros_are_lifted_and_the_rest_keeps_its_proportions);
    tcase_add_loop_test(tc, what_is_no_distribution_is_refused_with_its_place, 0, 6);
    tcase_add_loop_test(tc, sums_may_be_off_by_a_thousandth, 0, 5);
    tcase_add_test(tc, files_that_are_no_unaries_are_refused);
    tcase_add_loop_test(tc, the_map_is_the_first_best_class, 0, 20);
    tcase_add_test(tc, hard_ones_know_the_map_only);
    tcase_add_test(tc, costs_are_logarithms);
    tcase_add_test(tc, more_classes_than_a_label_map_holds);
    tcase_add_test(tc, channels_go_by_name);
    tcase_add_test(tc, very_many_missing_labels_are_cut_with_dots);
    tcase_add_test(tc, each_allocation_may_fail);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
