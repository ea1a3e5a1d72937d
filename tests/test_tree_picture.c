/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_tree_picture.c - drawn derivations: all of it or a part that says what it leaves out, and nothing on top of another. */
#include "core/random.h"
#include "core/utf8.h"
#include "derivation/derivation_statistics.h"
#include "scene/tree_picture.h"
#include "tests/derivation_grammars.h"
#include "tests/failing_malloc.h"
#include "tests/grammar_support.h"

static const char plant[] = "grammar plant\nweights\nlimit depth 7\nlabel bark #402000\nstart T(4, 1)\n"
                            "rule T(l, w) if l > 0.5\n"
                            "  -> 2 : f ~ truncated_normal(0.7, 0.1, 0.4, 0.95) width(w) draw(l) [ turn(normal(30, 8)) T(l * f, w) ]\n"
                            "         [ roll(90) T(l * f, w * 0.7) ]\n"
                            "  -> 1 : repeat y 3 { draw(l) L(l) } maybe(0.6) L(l) T(l * 0.6, w)\n"
                            "rule T(l, w) if l <= 0.5 -> L(l)\n"
                            "rule T(l, w) at limit -> L(l)\n"
                            "rule L(s) -> 1 : set_material(#208020) insert(\"leaf.obj\") set_label(bark) -> 1 : nothing\n";

typedef struct {
    sg_grammar *g;
    sg_derivation d;
    sg_tree_picture p;
} fixture;

static fixture draw(const char *text, uint64_t seed, sg_tree_picture_opts opts)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = {.g = test_grammar(text)};
    gsl_rng *rng = sg_random_create(seed);
    sg_derivation_init(&f.d, f.g);
    ck_ok(sg_derivation_sample(&f.d, rng, 100000, &err));
    ck_ok(sg_tree_picture_make(&f.d, &opts, &f.p, &err));
    gsl_rng_free(rng);
    return f;
}

static void close_fixture(fixture *f)
{
    sg_tree_picture_clear(&f->p);
    sg_derivation_clear(&f->d);
    sg_grammar_free(f->g);
}

/* A name that is too long is cut between two letters, so that an SVG stays UTF-8. */
START_TEST(long_names_are_cut_between_letters)
{
    fixture f = draw("start S\nrule S -> h\xC3\xB6\xC3\xB6\xC3\xB6\xC3\xB6\xC3\xB6\xC3\xB6\xC3\xB6\xC3\xB6\xC3\xB6"
                     "\xC3\xB6\xC3\xB6\xC3\xB6\xC3\xB6 ~ uniform(1, 1.00001) draw(1)\n",
                     1, (sg_tree_picture_opts)SG_TREE_PICTURE_OPTS_INIT);
    const char *beside = f.p.marks[0].beside;
    ck_assert(sg_utf8_is(beside, strlen(beside)));
    ck_assert_str_eq(beside, "h\xC3\xB6\xC3\xB6\xC3\xB6\xC3\xB6\xC3\xB6\xC3\xB6\xC3\xB6\xC3\xB6\xC3\xB6\xC3\xB6\xC3\xB6 = 1");
    close_fixture(&f);
}
END_TEST

/* Everything a mark takes: its box, and the text beside it. */
typedef struct {
    double x0, y0, x1, y1;
} area;

static area area_of(const sg_tree_mark *m)
{
    const double beside = (double)m->beside_columns * SG_TREE_ADVANCE * SG_TREE_SMALL_PX;
    const double high = fmax(m->height, 5 + (double)m->beside_lines * SG_TREE_LINE * SG_TREE_SMALL_PX), top = m->y - m->height / 2;
    return (area){m->x - m->width / 2, top, m->x + m->width / 2 + (beside > 0 ? SG_TREE_BESIDE_PX + beside : 0), top + high};
}

static void check_apart(const sg_tree_picture *p)
{
    for (size_t i = 0; i < p->n; i++) {
        const area a = area_of(p->marks + i);
        test_must(a.x0 >= 0 && a.y0 >= 0 && a.x1 <= p->width && a.y1 <= p->height);
        test_must((double)p->marks[i].columns * SG_TREE_ADVANCE * SG_TREE_LETTER_PX < p->marks[i].width);
        for (size_t j = 0; j < i; j++) {
            const area b = area_of(p->marks + j);
            test_must(a.x0 >= b.x1 || b.x0 >= a.x1 || a.y0 >= b.y1 || b.y0 >= a.y1);
        }
    }
}

/* Boxes: of a stack each one. */
static size_t count_shape(const sg_tree_picture *p, sg_tree_shape shape)
{
    size_t n = 0;
    for (size_t i = 0; i < p->n; i++)
        n += p->marks[i].shape == shape ? p->marks[i].lines : 0;
    return n;
}

START_TEST(all_of_a_derivation_is_drawn)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = draw(_i % 2 == 0 ? plant : GRAMMAR_OF_DERIVATIONS, (uint64_t)_i + 1, (sg_tree_picture_opts){100000, SIZE_MAX});
    sg_derivation_statistics s;
    ck_ok(sg_derivation_statistics_of(&f.d, &s, &err));
    ck_assert_uint_eq(count_shape(&f.p, SG_TREE_NONTERMINAL), s.nonterminals);
    ck_assert_uint_eq(count_shape(&f.p, SG_TREE_TERMINAL), s.terminals);
    ck_assert_uint_eq(count_shape(&f.p, SG_TREE_ELIDED), 0);
    if (f.p.n < 3000)
        check_apart(&f.p);
    for (size_t i = 1; i < f.p.n; i++) { /* the tree is the derivation's */
        const sg_tree_mark *m = f.p.marks + i, *up = f.p.marks + m->parent;
        ck_assert(m->parent < i && up->shape == SG_TREE_NONTERMINAL && m->level == up->level + 1 && m->y > up->y);
        ck_assert(m->node == up->node || m->node - f.d.nodes[m->node].parent == up->node);
    }
    close_fixture(&f);
}
END_TEST

/* What is drawn and what the elided marks tell are together all nodes. */
START_TEST(a_part_says_what_it_leaves_out)
{
    const size_t marks = (size_t[]){1, 2, 10, 40, 150}[_i % 5], depth = _i < 25 ? SIZE_MAX : (size_t)_i % 4;
    fixture f = draw(plant, (uint64_t)_i + 1, (sg_tree_picture_opts){marks, depth});
    size_t nodes = count_shape(&f.p, SG_TREE_NONTERMINAL);
    const size_t elided = count_shape(&f.p, SG_TREE_ELIDED);
    ck_assert_uint_le(nodes + count_shape(&f.p, SG_TREE_TERMINAL), marks);
    ck_assert_uint_le(elided, nodes);
    for (size_t i = 0; i < f.p.n; i++) {
        size_t count;
        ck_assert_uint_le(f.p.marks[i].level, depth == SIZE_MAX ? 100 : depth + 1);
        if (f.p.marks[i].shape != SG_TREE_ELIDED)
            continue;
        ck_assert_int_eq(sscanf(f.p.marks[i].text, "\xE2\x80\xA6 %zu", &count), 1);
        ck_assert_uint_ge(count, 1);
        if (strstr(f.p.marks[i].text, "node") != NULL)
            nodes += count;
    }
    ck_assert_uint_eq(nodes, f.d.nnodes);
    check_apart(&f.p);
    close_fixture(&f);
}
END_TEST

static const sg_tree_mark *find_mark(const sg_tree_picture *p, const char *text)
{
    for (size_t i = 0; i < p->n; i++)
        for (const char *at = p->marks[i].text; (at = strstr(at, text)) != NULL; at++) { /* a line of it */
            const char end = at[strlen(text)];
            if ((at == p->marks[i].text || at[-1] == '\n') && (end == '\0' || end == '\n'))
                return p->marks + i;
        }
    ck_abort_msg("no mark says %s", text);
}

START_TEST(marks_say_what_they_should)
{
    fixture f = draw("label \"<b>\" #102030\nstart S(1.23456)\n"
                     "rule S(x) -> 0.25 : h ~ uniform(2, 2.0000001) A(h) draw(uniform(7, 7.0000001)) -> 0.75 : split x { A(x) | \"<b>\" } "
                     "sizes mean (0.5, 0.5) sd (0.0001, 0.0001)\n"
                     "rule A(y) -> set_material(#aabbcc) set_material(\"old wood\") insert(sphere) translate(y, 1, 0.5)\n",
                     (uint64_t)_i, (sg_tree_picture_opts)SG_TREE_PICTURE_OPTS_INIT);
    const sg_tree_mark *root = find_mark(&f.p, "S(1.235)");
    ck_assert(root == f.p.marks);
    if (sg_grammar_symbol(f.g, 0)->first_rule == f.d.nodes[0].rule) {
        ck_assert_str_eq(root->beside, "p = 0.25\nh = 2\n~ 7");
        ck_assert_uint_eq(root->beside_lines, 3);
        ck_assert_uint_eq(root->beside_columns, 8);
        find_mark(&f.p, "draw(7)");
    } else {
        ck_assert_str_eq(root->beside, "p = 0.75\n0.500 0.500");
        ck_assert(find_mark(&f.p, "<b>")->fill == 0x102030);
    }
    find_mark(&f.p, "set_material(#aabbcc)");
    find_mark(&f.p, "set_material(old wood)");
    find_mark(&f.p, "insert(sphere)");
    close_fixture(&f);
}
END_TEST

START_TEST(pictures_are_written)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = draw(plant, 3, (sg_tree_picture_opts){60, SIZE_MAX});
    char *text = NULL;
    size_t size = 0, boxes = 0;
    FILE *out = open_memstream(&text, &size);
    ck_ok(sg_tree_picture_svg(&f.p, out, &err));
    fclose(out);
    for (const char *p = text; (p = strstr(p, "<rect x=")) != NULL; p++)
        boxes++;
    ck_assert_uint_eq(boxes, count_shape(&f.p, SG_TREE_NONTERMINAL) + count_shape(&f.p, SG_TREE_TERMINAL));
    sg_image im, small;
    ck_ok(sg_tree_picture_paint(&f.p, 2, &im, &err));
    ck_assert_uint_eq(im.width, (size_t)(2 * f.p.width));
    for (size_t i = 0; i < f.p.n; i++) { /* each mark is there, dark upon light */
        const sg_tree_mark *m = f.p.marks + i;
        size_t dark = 0;
        for (size_t y = (size_t)(2 * (m->y - 5)); y < (size_t)(2 * (m->y + 5)); y++)
            for (size_t x = (size_t)(2 * (m->x - m->width / 2 + 4)); x < (size_t)(2 * (m->x + m->width / 2 - 4)); x++)
                dark += im.rgb[3 * (y * im.width + x)] < 160;
        ck_assert_msg(dark >= 20, "%s: %zu dark pixels", m->text, dark);
    }
    f.p.width = 40000; /* more than fits: as much as does */
    ck_ok(sg_tree_picture_paint(&f.p, 2, &small, &err));
    ck_assert(small.width == 16384 && small.width * small.height <= 64000000);
    sg_image_clear(&im);
    sg_image_clear(&small);
    free(text);
    FILE *full = fopen("/dev/full", "w");
    if (full != NULL) {
        setvbuf(full, NULL, _IONBF, 0);
        ck_assert_int_eq(sg_tree_picture_svg(&f.p, full, &err), SG_EIO);
        fclose(full);
    }
    close_fixture(&f);
}
END_TEST

START_TEST(failures_leave_nothing)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = draw(plant, 5, (sg_tree_picture_opts){60, SIZE_MAX});
    const sg_tree_picture_opts opts = {60, SIZE_MAX};
    size_t failures = 0;
    for (size_t k = 0;; k++, failures++) {
        sg_tree_picture p = {0};
        test_fail_allocation(k);
        const sg_status st = sg_tree_picture_make(&f.d, &opts, &p, &err);
        if (!test_allocation_failed()) {
            ck_assert_int_eq(st, SG_OK);
            sg_tree_picture_clear(&p);
            break;
        }
        ck_assert_int_eq(st, SG_ENOMEM);
        ck_assert_ptr_null(p.marks);
    }
    ck_assert_uint_ge(failures, 10);
    sg_derivation none;
    sg_derivation_init(&none, f.g);
    sg_tree_picture p;
    ck_assert_int_eq(sg_tree_picture_make(&none, &opts, &p, &err), SG_EINVAL);
    close_fixture(&f);
}
END_TEST

/* Operations that follow each other stand on each other, a dozen at most. */
START_TEST(stacks_of_operations_are_not_high)
{
    fixture f = draw("start S\nrule S -> move(1) move(2) move(3) move(4) move(5) move(6) move(7) move(8) move(9) move(10) move(11) "
                     "move(12) move(13)\n",
                     1, (sg_tree_picture_opts)SG_TREE_PICTURE_OPTS_INIT);
    ck_assert_uint_eq(f.p.n, 3);
    ck_assert_uint_eq(f.p.marks[1].lines, 12);
    ck_assert_str_eq(f.p.marks[2].text, "move(13)");
    close_fixture(&f);
}
END_TEST

/* What stands in a repeat that is repeated counts as often as it is placed. */
START_TEST(statistics_count_nested_repeats)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = draw("start S\nrule S -> repeat y 3 { move(1) repeat x 2 { draw(1) } }\n", 1,
                     (sg_tree_picture_opts)SG_TREE_PICTURE_OPTS_INIT);
    sg_derivation_statistics s;
    ck_ok(sg_derivation_statistics_of(&f.d, &s, &err));
    ck_assert_uint_eq(s.nonterminals, 1);
    ck_assert_uint_eq(s.terminals, 3 + 3 * 2);
    close_fixture(&f);
}
END_TEST

/* Counts by hand. */
START_TEST(statistics_count_symbols_and_parameters)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = draw("label a\nlabel b\nstart S(1, 2)\n"
                     "rule S(x, y) -> h ~ uniform(0, 1) split x { a | T(h) | b } sizes mean (0.2, 0.3, 0.5) sd (0.1, 0.1, 0.1)\n"
                     "rule T(z) -> set_label(a) set_material(#010203) repeat y 3 { [ translate(1, 2, normal(0, 1)) U ] b } U\n"
                     "rule U -> components { top : V | side : V }\n"
                     "rule V -> draw(1)\n",
                     1, (sg_tree_picture_opts)SG_TREE_PICTURE_OPTS_INIT);
    sg_derivation_statistics s;
    ck_ok(sg_derivation_statistics_of(&f.d, &s, &err));
    /* S, T, four U, eight V */
    ck_assert_uint_eq(s.nonterminals, 1 + 1 + 4 + 8);
    /* a and b; set_label, set_material, three translate, three b; eight draw */
    ck_assert_uint_eq(s.terminals, 2 + 2 + 3 + 3 + 8);
    ck_assert_uint_eq(s.symbols, s.nonterminals + s.terminals);
    ck_assert_uint_eq(s.arguments, 2 + 1);
    ck_assert_uint_eq(s.terminal_arguments, 9 + 8);
    ck_assert_uint_eq(s.draws, 1 + 2 + 1); /* the draw of translate is one of T's body, whatever the repeat */
    ck_assert_uint_eq(s.parameters, 3 + 17 + 4);
    ck_assert_uint_eq(s.depth, 3);
    close_fixture(&f);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("tree_picture");
    TCase *tc = tcase_create("tree_picture");
    tcase_add_test(tc, long_names_are_cut_between_letters);
    tcase_add_test(tc, stacks_of_operations_are_not_high);
    tcase_add_test(tc, statistics_count_nested_repeats);
    tcase_add_loop_test(tc, all_of_a_derivation_is_drawn, 0, 20);
    tcase_add_loop_test(tc, a_part_says_what_it_leaves_out, 0, 45);
    tcase_add_loop_test(tc, marks_say_what_they_should, 0, 8);
    tcase_add_test(tc, pictures_are_written);
    tcase_add_test(tc, failures_leave_nothing);
    tcase_add_test(tc, statistics_count_symbols_and_parameters);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
