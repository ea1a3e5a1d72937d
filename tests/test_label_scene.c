/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_label_scene.c - derivations as rectangles, label maps, lattices, pictures and JSON. */
#include "core/random.h"
#include "parse/scene_lattice.h"
#include "scene/contact_sheet.h"
#include "scene/derivation_json.h"
#include "scene/label_scene.h"
#include "scene/label_svg.h"
#include "scene/placer.h"
#include "tests/failing_malloc.h"
#include "tests/support.h"

#include <jansson.h>
#include <math.h>
#include <string.h>

/* Nested splits with all kinds of sizes, repeats, tied symbols; everything is filled. */
static const char mixed[] = "grammar mixed\n"
                            "tied\n"
                            "label t #102030\n"
                            "label u #405060\n"
                            "label v #708090\n"
                            "start S(3)\n"
                            "rule S(n)\n"
                            "  -> 0.4 : split y { '0.25 : A | ~2 : S(n) | ~1 : A }\n"
                            "  -> 0.3 : repeat x n { split y { 2 : t | ~1 : A } }\n"
                            "  -> 0.3 : split x { u | split y { v | A | v } | A } sizes mean (0.3, 0.4, 0.3) sd (0.2, 0.2, 0.2)\n"
                            "rule A\n"
                            "  -> 0.3 : t\n"
                            "  -> 0.3 : u\n"
                            "  -> 0.2 : split x { u | t | t | v } sizes mean (0.2, 0.4, 0.3, 0.1) sd (0.2, 0.2, 0.1, 0.1)\n"
                            "  -> 0.2 : repeat y 3 { v }\n";

typedef struct {
    sg_grammar *g;
    sg_derivation d;
    gsl_rng *rng;
    sg_label_scene scene;
} fixture;

static fixture open_fixture(const char *text, uint64_t seed)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = {.rng = sg_random_create(seed)};
    ck_ok(sg_grammar_parse(text, strlen(text), "test", &f.g, &err));
    sg_derivation_init(&f.d, f.g);
    ck_ok(sg_derivation_sample(&f.d, f.rng, 100000, &err));
    return f;
}

/* Interpret, sampling again as long as absolute sizes deep down do not fit; what failed has left nothing. */
static void interpret_some(fixture *f, double width, double height)
{
    sg_error err = SG_ERROR_INIT;
    for (int tries = 0; sg_label_scene_interpret(&f->scene, &f->d, width, height, &err) != SG_OK; tries++) {
        ck_assert_msg(strstr(err.msg, "larger than its scope") != NULL, "%s", err.msg);
        ck_assert_uint_eq(f->scene.nrects, 0);
        ck_assert_int_lt(tries, 50);
        ck_ok(sg_derivation_sample(&f->d, f->rng, 100000, &err));
    }
}

static void close_fixture(fixture *f)
{
    sg_label_scene_clear(&f->scene);
    sg_derivation_clear(&f->d);
    gsl_rng_free(f->rng);
    sg_grammar_free(f->g);
}

static void check_rect(const fixture *f, size_t i, const char *label, double x0, double y0, double x1, double y1)
{
    ck_assert_uint_lt(i, f->scene.nrects);
    const sg_label_rect *r = f->scene.rects + i;
    ck_assert_str_eq(sg_grammar_symbol(f->g, r->label)->name, label);
    ck_assert_double_eq_tol(r->x0, x0, 1e-9);
    ck_assert_double_eq_tol(r->y0, y0, 1e-9);
    ck_assert_double_eq_tol(r->x1, x1, 1e-9);
    ck_assert_double_eq_tol(r->y1, y1, 1e-9);
}

START_TEST(sizes_are_absolute_relative_floating)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture("label a\nlabel b\nlabel c\nlabel d\nstart S\n"
                             "rule S -> split x { 10 : a | ~1 : b | '0.2 : c | ~2 : d }\n",
                             1);
    ck_ok(sg_label_scene_interpret(&f.scene, &f.d, 100, 50, &err));
    ck_assert_uint_eq(f.scene.nrects, 4);
    const double unit = 70.0 / 3; /* what 10 and 20 leave, in three shares */
    check_rect(&f, 0, "a", 0, 0, 10, 50);
    check_rect(&f, 1, "b", 10, 0, 10 + unit, 50);
    check_rect(&f, 2, "c", 10 + unit, 0, 30 + unit, 50);
    check_rect(&f, 3, "d", 30 + unit, 0, 100, 50);
    close_fixture(&f);
}
END_TEST

/* The language's y runs up, a picture's down: the first part of a split y is the lowest; rectangles come from the top. */
START_TEST(y_runs_up_in_the_language_and_down_in_pictures)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture("label a\nlabel b\nlabel c\nstart S\n"
                             "rule S -> split y { '0.1 : a | ~1 : T | '0.2 : c }\nrule T -> repeat y 2 { split x { a | b } }\n",
                             1);
    ck_ok(sg_label_scene_interpret(&f.scene, &f.d, 8, 100, &err));
    ck_assert_uint_eq(f.scene.nrects, 6);
    check_rect(&f, 0, "c", 0, 0, 8, 20);
    check_rect(&f, 1, "a", 0, 20, 4, 55);
    check_rect(&f, 2, "b", 4, 20, 8, 55);
    check_rect(&f, 3, "a", 0, 55, 4, 90);
    check_rect(&f, 4, "b", 4, 55, 8, 90);
    check_rect(&f, 5, "a", 0, 90, 8, 100);
    close_fixture(&f);
}
END_TEST

START_TEST(tied_siblings_look_the_same_everywhere)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture("tied\nlabel a\nlabel b\nstart S\nrule S -> split x { A | b | A }\n"
                             "rule A -> split y { a | b | a } sizes mean (0.3, 0.4, 0.3) sd (0.1, 0.1, 0.1)\n",
                             (uint64_t)_i + 1);
    ck_ok(sg_label_scene_interpret(&f.scene, &f.d, 90, 60, &err));
    ck_assert_uint_eq(f.scene.nrects, 7);
    for (size_t k = 0; k < 3; k++) {
        const sg_label_rect *l = f.scene.rects + k, *r = f.scene.rects + 4 + k;
        ck_assert(l->label == r->label && l->y0 == r->y0 && l->y1 == r->y1 && l->node == r->node);
    }
    const sg_label_rect *r = f.scene.rects;
    ck_assert(r[0].y0 == 0 && r[0].y1 == r[1].y0 && r[1].y1 == r[2].y0 && r[2].y1 == 60);
    close_fixture(&f);
}
END_TEST

/* Rectangles tile the scope: areas sum up, and each pixel centre lies in exactly one, whose label the raster shows. */
START_TEST(rectangles_tile_the_scope_and_agree_with_the_raster)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(mixed, (uint64_t)_i + 1);
    enum { W = 61, H = 47 };
    uint8_t value_of[64];
    double share[64];
    sg_classes classes;
    sg_label_map map;
    sg_image im;
    ck_assert_uint_le(sg_grammar_symbol_count(f.g), 64);
    ck_ok(sg_label_classes(f.g, &classes, value_of, &err));
    ck_ok(sg_label_map_create(W, H, &map, &err));
    ck_ok(sg_image_create(W, H, &im, &err));
    memset(map.labels, 99, W * H);
    const double height = 200 + _i % 3 * 33.3, width = 150;
    interpret_some(&f, width, height);
    double area = 0;
    for (size_t i = 0; i < f.scene.nrects; i++) {
        const sg_label_rect *r = f.scene.rects + i;
        ck_assert(0 <= r->x0 && r->x0 <= r->x1 && r->x1 <= width && 0 <= r->y0 && r->y0 <= r->y1 && r->y1 <= height);
        area += (r->x1 - r->x0) * (r->y1 - r->y0);
    }
    ck_assert_double_eq_tol(area / (width * height), 1, 1e-9);
    sg_label_scene_raster(&f.scene, value_of, &map);
    sg_label_scene_paint(&f.scene, f.g, &im);
    sg_label_scene_shares(&f.scene, f.g, share);
    double sum = 0;
    for (size_t s = 0; s < sg_grammar_symbol_count(f.g); s++)
        sum += share[s];
    ck_assert_double_eq_tol(sum, 1, 1e-9);
    for (size_t p = 0; p < W * H; p++) {
        const double x = ((double)(p % W) + 0.5) / W * width, y = ((double)(p / W) + 0.5) / H * height;
        size_t found = 0;
        for (size_t i = 0; i < f.scene.nrects; i++) {
            const sg_label_rect *r = f.scene.rects + i;
            if (r->x0 <= x && x < r->x1 && r->y0 <= y && y < r->y1) {
                found++;
                ck_assert_uint_eq(map.labels[p], value_of[r->label]);
                const uint32_t c = sg_grammar_symbol(f.g, r->label)->color;
                ck_assert_uint_eq(im.rgb[3 * p], c >> 16);
                ck_assert_uint_eq(im.rgb[3 * p + 2], c & 255);
            }
        }
        ck_assert_msg(found == 1, "pixel %zu lies in %zu rectangles", p, found);
    }
    sg_image_clear(&im);
    sg_label_map_clear(&map);
    sg_classes_clear(&classes);
    close_fixture(&f);
}
END_TEST

/* The lattice, filled cell by cell, is the raster; all of its lines are needed. */
START_TEST(the_lattice_is_the_raster)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(mixed, (uint64_t)_i + 1);
    enum { W = 60, H = 150 };
    uint8_t value_of[64];
    sg_classes classes;
    sg_label_map map;
    sg_lattice l;
    sg_arena *arena = sg_arena_create();
    ck_ok(sg_label_classes(f.g, &classes, value_of, &err));
    ck_ok(sg_label_map_create(W, H, &map, &err));
    interpret_some(&f, W, H);
    sg_label_scene_raster(&f.scene, value_of, &map);
    ck_ok(sg_lattice_of_scene(&f.scene, f.g, W, H, arena, &l, &err));
    ck_assert(l.x[0] == 0 && l.x[l.width] == W && l.y[0] == 0 && l.y[l.height] == H);
    for (size_t i = 0; i < W * H; i++) {
        const uint16_t label =
            sg_lattice_label(&l, sg_lattice_column_of(&l, i % W), sg_lattice_row_of(&l, (uint32_t)(i / W)));
        const char *name = classes.names[classes.class_of[map.labels[i]]];
        ck_assert_str_eq(l.label_names[label], name);
    }
    for (size_t k = 1; k < l.width; k++) {
        bool used = false;
        for (size_t i = 0; i < f.scene.nrects; i++)
            used = used || sg_label_scene_pixel(f.scene.rects[i].x0, W, W) == l.x[k];
        ck_assert(used && l.x[k] > l.x[k - 1]);
    }
    sg_arena_free(arena);
    sg_label_map_clear(&map);
    sg_classes_clear(&classes);
    close_fixture(&f);
}
END_TEST

/* Boundaries of nested parts are in order and inside, whatever is rounded. */
START_TEST(cuts_stay_inside_and_in_order)
{
    gsl_rng *rng = sg_random_create((uint64_t)_i + 1);
    for (int k = 0; k < 100000; k++) {
        const double a = 500 * gsl_rng_uniform(rng), b = k % 7 == 0 ? a : 500 * gsl_rng_uniform(rng);
        const double s = gsl_rng_uniform(rng), t = k % 5 == 0 ? 1 - 1e-16 * k : s + (1 - s) * gsl_rng_uniform(rng);
        const double at_s = sg_placer_cut(a, b, fmin(s, t)), at_t = sg_placer_cut(a, b, fmax(s, t));
        ck_assert(fmin(a, b) <= fmin(at_s, at_t) && fmax(at_s, at_t) <= fmax(a, b));
        ck_assert(a <= b ? at_s <= at_t : at_s >= at_t);
        ck_assert(sg_placer_cut(a, b, 0) == a && sg_placer_cut(a, b, 1) == b && sg_placer_cut(a, b, 1 + 1e-9) == b);
    }
    gsl_rng_free(rng);
}
END_TEST

/* What one size loses the next one gains: those behind them stay where they are, though the sum is rounded. */
START_TEST(a_cut_that_moves_leaves_those_behind_it)
{
    enum { N = 20 };
    gsl_rng *rng = sg_random_create((uint64_t)_i + 1);
    size_t moved = 0, off = 0;
    for (int k = 0; k < 5000; k++) {
        double size[N], sum = 0, total = 0;
        for (size_t j = 0; j < N; j++)
            total += size[j] = gsl_rng_uniform(rng);
        double before[N], other = 0;
        for (size_t j = 0; j < N; j++)
            before[j] = sg_placer_share(sum += size[j] /= total);
        const double step = size[3] * gsl_rng_uniform(rng);
        size[3] -= step;
        size[4] += step;
        sum = 0;
        for (size_t j = 0; j < N; j++) {
            const double now = sg_placer_share(sum += size[j]);
            ck_assert_double_eq_tol(now, sum, 1e-12);
            moved += j == 3 && now != before[j];
            other += j != 3 && now != before[j];
        }
        off += other > 0;
    }
    ck_assert_uint_eq(moved, 5000);
    ck_assert_uint_lt(off, 50);
    gsl_rng_free(rng);
}
END_TEST

START_TEST(pixel_centres_decide)
{
    for (size_t n = 1; n < 600; n++) /* in pixels, a boundary on a centre is one, whatever the extent */
        for (size_t k = 0; k < n; k++)
            ck_assert_uint_eq(sg_label_scene_pixel((double)k + 0.5, (double)n, n), k);
    ck_assert_uint_eq(sg_label_scene_pixel(0, 10, 10), 0);
    ck_assert_uint_eq(sg_label_scene_pixel(2.49, 10, 10), 2);
    ck_assert_uint_eq(sg_label_scene_pixel(2.5, 10, 10), 2); /* the centre of pixel 2 lies on the boundary: it is behind it */
    ck_assert_uint_eq(sg_label_scene_pixel(2.51, 10, 10), 3);
    ck_assert_uint_eq(sg_label_scene_pixel(10, 10, 10), 10);
    ck_assert_uint_eq(sg_label_scene_pixel(5, 10, 4), 2);
    ck_assert_uint_eq(sg_label_scene_pixel(-1, 10, 4), 0);
    ck_assert_uint_eq(sg_label_scene_pixel(11, 10, 4), 4);
}
END_TEST

START_TEST(what_is_no_label_scene_is_said)
{
    static const struct {
        const char *text, *says;
    } cases[] = {
        {"label a\nstart S\nrule S -> split z { a | a }\n", "along z"},
        {"label a\nstart S\nrule S -> repeat z 2 { a }\n", "along z"},
        {"label a\nstart S\nrule S -> split x { 60 : a | 50 : a }\n", "larger than its scope"},
        {"label a\nstart S\nrule S -> split x { 60 : a | '0.5 : a }\n", "larger than its scope"},
        {"label a\nstart S\nrule S -> split x { 60 : a | '0.2 : a }\n", "do not fill"},
        {"label a\nstart S\nrule S -> m ~ normal(-6, 0.1) split x { S2(m) }\nrule S2(n) -> split x { n : a | ~1 : a }\n", "negative"},
        {"label a\nstart S\nrule S -> split x { a | T }\nrule T -> nothing\n", "hole"},
        {"label a\nstart S\nrule S -> repeat x 0 { a }\n", "empty"},
        {"label a\nstart S\nrule S -> A A\nrule A -> a\n", "more than one"},
        {"label a\nstart S\nrule S -> extrude(3)\n", "no split"},
        {"label a\nlimit depth 0\nstart S\nrule S -> split x { T }\nrule T -> a\n", "depth limit"},
    };
    sg_error err = SG_ERROR_INIT;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        fixture f = open_fixture(cases[i].text, 1);
        ck_assert_msg(sg_label_scene_interpret(&f.scene, &f.d, 100, 100, &err) == SG_ENUMERIC, "case %zu", i);
        ck_assert_msg(strstr(err.msg, cases[i].says) != NULL, "case %zu: %s", i, err.msg);
        ck_assert_uint_eq(f.scene.nrects, 0);
        close_fixture(&f);
    }
    fixture f = open_fixture(mixed, 1);
    ck_assert_int_eq(sg_label_scene_interpret(&f.scene, &f.d, 0, 10, &err), SG_ENUMERIC);
    ck_assert_int_eq(sg_label_scene_interpret(&f.scene, &f.d, 10, NAN, &err), SG_ENUMERIC);
    ck_ok(sg_derivation_open(&f.d, sg_grammar_start(f.g), sg_grammar_start_args(f.g), 0, &err));
    ck_assert_int_eq(sg_label_scene_interpret(&f.scene, &f.d, 10, 10, &err), SG_ENUMERIC);
    close_fixture(&f);
}
END_TEST

/* A tied grammar of 30 nodes that asks for 2^29 places. */
START_TEST(too_many_places_are_refused)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture("tied\nlabel a\nstart S(29)\nrule S(n) if n > 0 -> split x { S(n - 1) | S(n - 1) }\n"
                             "rule S(n) if n <= 0 -> a\n",
                             1);
    ck_assert_uint_eq(f.d.nnodes, 30);
    ck_assert_int_eq(sg_label_scene_interpret(&f.scene, &f.d, 100, 100, &err), SG_ENUMERIC);
    ck_assert_ptr_nonnull(strstr(err.msg, "placed"));
    close_fixture(&f);
}
END_TEST

/* Sums over the JSON tree: labels found, areas; each child lies in its parent, in order. */
static void check_json(json_t *node, const double *outer, size_t *labels, double *area)
{
    double r[4];
    for (size_t k = 0; k < 4; k++)
        r[k] = json_number_value(json_array_get(json_object_get(node, "rect"), k));
    ck_assert(r[0] >= outer[0] && r[1] >= outer[1] && r[2] <= outer[2] && r[3] <= outer[3]);
    if (json_object_get(node, "label") != NULL) {
        ++*labels;
        *area += (r[2] - r[0]) * (r[3] - r[1]);
    }
    const json_t *children = json_object_get(node, "children");
    double x = r[0], y = r[1];
    for (size_t k = 0; k < json_array_size(children); k++) {
        json_t *child = json_array_get(children, k);
        check_json(child, r, labels, area);
        const json_t *rect = json_object_get(child, "rect");
        const double cx = json_number_value(json_array_get(rect, 0)), cy = json_number_value(json_array_get(rect, 1));
        ck_assert(cx >= x || cy >= y);
        x = cx;
        y = cy;
    }
    double sum = 0;
    const json_t *sizes = json_object_get(node, "sizes");
    for (size_t k = 0; k < json_array_size(sizes); k++)
        sum += json_number_value(json_array_get(sizes, k));
    if (json_array_size(sizes) > 0)
        ck_assert_double_eq_tol(sum, 1, 1e-9);
}

static char *written(const fixture *f, double width, double height, sg_status *st)
{
    sg_error err = SG_ERROR_INIT;
    char *text = NULL;
    size_t size = 0;
    FILE *fp = open_memstream(&text, &size);
    *st = sg_derivation_write_json(&f->d, width, height, fp, &err);
    fclose(fp);
    return text;
}

START_TEST(json_holds_the_rectangles)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(mixed, (uint64_t)_i + 1);
    sg_status st;
    char *text = written(&f, 150, 200, &st);
    ck_assert_int_eq(st, sg_label_scene_interpret(&f.scene, &f.d, 150, 200, &err));
    if (st == SG_OK) {
        json_t *root = json_loads(text, 0, NULL);
        ck_assert_ptr_nonnull(root);
        size_t labels = 0;
        double area = 0;
        check_json(root, (const double[]){0, 0, 150, 200}, &labels, &area);
        ck_assert_uint_eq(labels, f.scene.nrects);
        ck_assert_double_eq_tol(area, 150 * 200, 1e-6);
        ck_assert_str_eq(json_string_value(json_object_get(root, "symbol")), "S");
        ck_assert_int_eq(json_integer_value(json_object_get(root, "rule")), f.d.nodes[0].rule);
        json_decref(root);
    }
    free(text);
    close_fixture(&f);
}
END_TEST

START_TEST(json_runs_top_to_bottom)
{
    fixture f = open_fixture("label a\nlabel b\nstart S\nrule S -> split y { '0.25 : a | '0.75 : b }\n", 1);
    sg_status st;
    char *text = written(&f, 4, 8, &st);
    ck_assert_int_eq(st, SG_OK);
    json_t *root = json_loads(text, 0, NULL);
    const json_t *first = json_array_get(json_object_get(root, "children"), 0);
    ck_assert_str_eq(json_string_value(json_object_get(first, "label")), "b");
    ck_assert_double_eq(json_number_value(json_array_get(json_object_get(root, "sizes"), 0)), 0.75);
    ck_assert_double_eq(json_number_value(json_array_get(json_object_get(first, "rect"), 3)), 6);
    json_decref(root);
    free(text);
    close_fixture(&f);
}
END_TEST

START_TEST(depth_costs_no_stack)
{
    sg_error err = SG_ERROR_INIT;
    enum { DEPTH = 100000 };
    fixture f = open_fixture("label t\nstart S(5)\nrule S(n) if n > 0 -> split x { S(n - 1) | 0 : t }\nrule S(n) if n <= 0 -> t\n", 1);
    ck_ok(sg_derivation_sample_subtree(&f.d, sg_grammar_start(f.g), (const double[]){DEPTH}, 0, f.rng, 3 * DEPTH, &err));
    ck_ok(sg_label_scene_interpret(&f.scene, &f.d, 100, 100, &err));
    ck_assert_uint_eq(f.scene.nrects, DEPTH + 1);
    sg_status st;
    char *text = written(&f, 100, 100, &st);
    ck_assert_int_eq(st, SG_OK);
    size_t open = 0, close = 0;
    for (const char *p = text; *p != '\0'; p++) {
        open += *p == '{';
        close += *p == '}';
    }
    ck_assert_uint_eq(open, 2 * DEPTH + 1);
    ck_assert_uint_eq(open, close);
    free(text);
    close_fixture(&f);
}
END_TEST

START_TEST(svg_has_one_rect_a_rectangle)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture("label \"a<b\" #ff0080\nlabel b #00ff00\nstart S\nrule S -> split y { \"a<b\" | b | \"a<b\" }\n", 1);
    ck_ok(sg_label_scene_interpret(&f.scene, &f.d, 30, 60, &err));
    char *text = NULL;
    size_t size = 0;
    FILE *fp = open_memstream(&text, &size);
    ck_ok(sg_label_svg_write(&f.scene, f.g, fp, &err));
    fclose(fp);
    ck_assert_ptr_nonnull(strstr(text, "viewBox=\"0 0 30 60\""));
    ck_assert_ptr_nonnull(strstr(text, "<g fill=\"#ff0080\"><title>a&lt;b</title>\n<rect x=\"0\" y=\"0\" width=\"30\" height=\"20\"/>\n"
                                       "<rect x=\"0\" y=\"40\" width=\"30\" height=\"20\"/>\n</g>\n"));
    ck_assert_ptr_nonnull(strstr(text, "<g fill=\"#00ff00\"><title>b</title>\n<rect x=\"0\" y=\"20\""));
    free(text);
    fp = fopen("/dev/full", "w");
    setvbuf(fp, NULL, _IONBF, 0);
    ck_assert_int_eq(sg_label_svg_write(&f.scene, f.g, fp, &err), SG_EIO);
    ck_assert_int_eq(sg_derivation_write_json(&f.d, 1, 1, fp, &err), SG_EIO);
    fclose(fp);
    close_fixture(&f);
}
END_TEST

START_TEST(contact_sheets_lay_out_row_by_row)
{
    sg_error err = SG_ERROR_INIT;
    sg_image im[5], sheet;
    for (size_t i = 0; i < 5; i++) {
        ck_ok(sg_image_create(i == 4 ? 2 : 4, 6, im + i, &err));
        for (size_t p = 0; p < im[i].width * im[i].height; p++)
            sg_image_set(im + i, p % im[i].width, p / im[i].width, 0x010101 * (uint32_t)(i + 1));
    }
    sg_sheet_opts o = SG_SHEET_OPTS_INIT;
    o.columns = 2;
    o.margin_px = 3;
    ck_ok(sg_contact_sheet(im, 5, &o, &sheet, &err));
    ck_assert_uint_eq(sheet.width, 3 + 2 * 7);
    ck_assert_uint_eq(sheet.height, 3 + 3 * 9);
    size_t count[6] = {0};
    for (size_t p = 0; p < sheet.width * sheet.height; p++)
        count[sheet.rgb[3 * p] == 255 ? 0 : sheet.rgb[3 * p]]++;
    for (size_t i = 0; i < 5; i++)
        ck_assert_uint_eq(count[i + 1], im[i].width * 6);
    ck_assert_uint_eq(sheet.rgb[3 * (3 * sheet.width + 3)], 1);
    ck_assert_uint_eq(sheet.rgb[3 * (3 * sheet.width + 10)], 2);
    ck_assert_uint_eq(sheet.rgb[3 * (12 * sheet.width + 3)], 3);
    ck_assert_uint_eq(sheet.rgb[3 * (21 * sheet.width + 3)], 255); /* the narrow one is centred */
    ck_assert_uint_eq(sheet.rgb[3 * (21 * sheet.width + 4)], 5);
    sg_image_clear(&sheet);
    o.rows = 1;
    ck_ok(sg_contact_sheet(im, 5, &o, &sheet, &err));
    ck_assert_uint_eq(sheet.height, 12);
    sg_image_clear(&sheet);
    ck_assert_int_eq(sg_contact_sheet(im, 0, &o, &sheet, &err), SG_EINVAL);
    o.columns = 30000;
    ck_assert_int_eq(sg_contact_sheet(im, 5, &o, &sheet, &err), SG_EINVAL);
    for (size_t i = 0; i < 5; i++)
        sg_image_clear(im + i);
}
END_TEST

START_TEST(labels_become_a_class_table)
{
    sg_error err = SG_ERROR_INIT;
    uint8_t value_of[64];
    sg_classes classes;
    fixture f = open_fixture(mixed, 1);
    ck_ok(sg_label_classes(f.g, &classes, value_of, &err));
    ck_assert_uint_eq(classes.nclasses, 3);
    ck_assert_str_eq(classes.names[0], "t");
    ck_assert_uint_eq(classes.index_colors[2], 0x708090);
    ck_assert_uint_eq(value_of[sg_grammar_find(f.g, "v")], 2);
    sg_classes_clear(&classes);
    close_fixture(&f);
    f = open_fixture("label \"two words\"\nstart S\nrule S -> \"two words\"\n", 1);
    ck_assert_int_eq(sg_label_classes(f.g, &classes, value_of, &err), SG_EINPUT);
    close_fixture(&f);
}
END_TEST

/* Each allocation of each call fails once. */
START_TEST(failed_allocations_are_reported)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(mixed, 3);
    interpret_some(&f, 150, 200);
    FILE *null = fopen("/dev/null", "w");
    size_t failures[4] = {0};
    for (size_t k = 0; k < 60; k++) {
        for (int call = 0; call < 4; call++) {
            sg_label_scene scene = {0};
            sg_image sheet = {0};
            const sg_image picture = {1, 1, (uint8_t[3]){0}};
            const sg_sheet_opts o = SG_SHEET_OPTS_INIT;
            sg_arena *arena = sg_arena_create();
            sg_lattice l;
            test_fail_allocation(k);
            const sg_status st = call == 0   ? sg_label_scene_interpret(&scene, &f.d, 150, 200, &err)
                                 : call == 1 ? sg_derivation_write_json(&f.d, 150, 200, null, &err)
                                 : call == 2 ? sg_contact_sheet(&picture, 1, &o, &sheet, &err)
                                             : sg_lattice_of_scene(&f.scene, f.g, 3000, 3000, arena, &l, &err);
            const int failed = test_allocation_failed();
            ck_assert_msg(st == (failed ? SG_ENOMEM : SG_OK), "call %d, allocation %zu: status %d", call, k, (int)st);
            failures[call] += failed != 0;
            ck_assert(!failed || (scene.nrects == 0 && sheet.rgb == NULL));
            sg_label_scene_clear(&scene);
            sg_image_clear(&sheet);
            sg_arena_free(arena);
        }
    }
    ck_assert(failures[0] > 4 && failures[1] > 4 && failures[2] > 0);
    fclose(null);
    close_fixture(&f);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("label scene");
    TCase *tc = tcase_create("label scene");
    tcase_set_timeout(tc, 120);
    tcase_add_test(tc, sizes_are_absolute_relative_floating);
    tcase_add_test(tc, y_runs_up_in_the_language_and_down_in_pictures);
    tcase_add_loop_test(tc, tied_siblings_look_the_same_everywhere, 0, 4);
    tcase_add_loop_test(tc, rectangles_tile_the_scope_and_agree_with_the_raster, 0, 30);
    tcase_add_loop_test(tc, the_lattice_is_the_raster, 0, 20);
    tcase_add_loop_test(tc, cuts_stay_inside_and_in_order, 0, 2);
    tcase_add_loop_test(tc, a_cut_that_moves_leaves_those_behind_it, 0, 2);
    tcase_add_test(tc, pixel_centres_decide);
    tcase_add_test(tc, what_is_no_label_scene_is_said);
    tcase_add_test(tc, too_many_places_are_refused);
    tcase_add_loop_test(tc, json_holds_the_rectangles, 0, 20);
    tcase_add_test(tc, json_runs_top_to_bottom);
    tcase_add_test(tc, depth_costs_no_stack);
    tcase_add_test(tc, svg_has_one_rect_a_rectangle);
    tcase_add_test(tc, contact_sheets_lay_out_row_by_row);
    tcase_add_test(tc, labels_become_a_class_table);
    tcase_add_test(tc, failed_allocations_are_reported);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
