/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_checks.c - what reading a grammar finds out about values: errors that are certain, warnings with an example, and
 * silence where nothing is wrong; and what a run says when it fails on what could not be known. */
#include "core/random.h"
#include "derivation/derivation.h"
#include "scene/label_scene.h"
#include "scene/scene.h"
#include "tests/grammar_support.h"

#include <dirent.h>

/* ---- errors, and what differs by a hair and is none ---- */

static const struct {
    const char *bad, *message, *good;
} certain[] = {
    {"start X(1)\nrule X(l) if l < 1 and l > 2 -> nothing\nrule X(l) if l >= 1 -> nothing",
     "t.sg:2:14: error: this guard can never hold\n"
     "rule X(l) if l < 1 and l > 2 -> nothing\n"
     "             ^",
     "start X(1)\nrule X(l) if l > 1 and l < 2 or l == 1 -> nothing"},
    {"start X(1)\nrule X(l) if l ^ 2 < 0 -> nothing\nrule X(l) if l >= 1 -> nothing",
     "t.sg:2:14: error: this guard can never hold\n"
     "rule X(l) if l ^ 2 < 0 -> nothing\n"
     "             ^",
     "start X(1)\nrule X(l) if l ^ 3 < 2 -> nothing\nrule X(l) if l ^ 3 >= 2 -> nothing\nrule X(l) if l == 1 -> X(0.5) X(3)"},
    {"limit depth 3\nstart X\nrule X -> nothing\nrule X if depth > 3 -> nothing",
     "t.sg:4:11: error: this guard can never hold\n"
     "rule X if depth > 3 -> nothing\n"
     "          ^",
     "limit depth 3\nstart X\nrule X -> X\nrule X if depth > 2 -> nothing"},
    {"start S\nrule S -> X(1) X(2)\nrule X(l) if l < 1 -> nothing",
     "t.sg:3:6: error: no guard of 'X' ever holds, as l is from 1 to 2\n"
     "rule X(l) if l < 1 -> nothing\n"
     "     ^",
     "start S\nrule S -> X(1) X(2)\nrule X(l) if l <= 2 -> nothing"},
    {"start S\nrule S -> u ~ uniform(0, 1) T(u)\nrule T(u) -> u - 2 : nothing -> 1 : nothing",
     "t.sg:3:14: error: the weight is always negative: it is -1 at most\n"
     "rule T(u) -> u - 2 : nothing -> 1 : nothing\n"
     "             ^",
     "start S\nrule S -> u ~ uniform(2, 3) T(u)\nrule T(u) -> u - 2 : nothing -> 1 : nothing"},
    {"start S(-4)\nrule S(x) -> sqrt(x) : nothing -> 1 : nothing",
     "t.sg:2:14: error: the weight is never a number\n"
     "rule S(x) -> sqrt(x) : nothing -> 1 : nothing\n"
     "             ^",
     "start S(4)\nrule S(x) -> sqrt(x) : nothing -> 1 : nothing"},
    {"start S(2)\nrule S(x)\n  -> x - 2 : nothing\n  -> max(0, -x) : nothing",
     "t.sg:3:6: error: the weights of 'S' are always zero\n"
     "  -> x - 2 : nothing\n"
     "     ^",
     "start S(2)\nrule S(x)\n  -> x - 1 : nothing\n  -> max(0, -x) : nothing"},
    {"start S\nrule S -> u ~ uniform(0, 1)\n  draw(normal(0, u - 1.5))",
     "t.sg:3:18: error: normal: the standard deviation is never greater than 0\n"
     "  draw(normal(0, u - 1.5))\n"
     "                 ^",
     "start S\nrule S -> u ~ uniform(0, 1)\n  draw(normal(0, u + 1.5))"},
    {"start S(1)\nrule S(m) -> draw(uniform(m, m - 1))",
     "t.sg:2:27: error: uniform: low is never less than high\n"
     "rule S(m) -> draw(uniform(m, m - 1))\n"
     "                          ^",
     "start S(1)\nrule S(m) -> draw(uniform(m - 1, m))"},
    {"start S(1)\nrule S(m) -> draw(truncated_normal(0, m, 1, -m))",
     "t.sg:2:36: error: truncated_normal: low is never less than high\n"
     "rule S(m) -> draw(truncated_normal(0, m, 1, -m))\n"
     "                                   ^",
     "start S(1)\nrule S(m) -> draw(truncated_normal(0, m, -1, m))"},
    {"start S(1)\nrule S(m) -> draw(discrete((m, 1), (-m, 2)))",
     "t.sg:2:37: error: discrete: a weight is always negative\n"
     "rule S(m) -> draw(discrete((m, 1), (-m, 2)))\n"
     "                                    ^",
     "start S(1)\nrule S(m) -> draw(discrete((m, 1), (m, 2)))"},
    {"start S(0)\nrule S(m) -> draw(mixture((m, 1, 1), (2 * m, 2, 1)))",
     "t.sg:2:28: error: mixture: all weights are always zero\n"
     "rule S(m) -> draw(mixture((m, 1, 1), (2 * m, 2, 1)))\n"
     "                           ^",
     "start S(0)\nrule S(m) -> draw(mixture((m, 1, 1), (2 + m, 2, 1)))"},
    {"label a\nstart S\nrule S -> u ~ uniform(0, 1) maybe(u + 1.1) a",
     "t.sg:3:35: error: the probability is always too large: it is 1.1 at least\n"
     "rule S -> u ~ uniform(0, 1) maybe(u + 1.1) a\n"
     "                                  ^",
     "label a\nstart S\nrule S -> u ~ uniform(0, 1) maybe(u) a"},
    {"start S(2)\nrule S(n) -> repeat x 1 - n { insert(box) }",
     "t.sg:2:23: error: the repeat count is always too small: it is -1 at most\n"
     "rule S(n) -> repeat x 1 - n { insert(box) }\n"
     "                      ^",
     "start S(2)\nrule S(n) -> repeat x 1.6 - n { insert(box) }"},
    {"label a\nstart S(1)\nrule S(n) -> split x { ~1 : a | n - 2 : a }",
     "t.sg:3:33: error: the size of this part is always too small: it is -1 at most\n"
     "rule S(n) -> split x { ~1 : a | n - 2 : a }\n"
     "                                ^",
     "label a\nstart S(1)\nrule S(n) -> split x { ~1 : a | n - 1 : a }"},
    {"start S\nrule S -> u ~ uniform(0, 1) T(log(-u - 1))\nrule T(x) -> draw(x)",
     "t.sg:2:31: error: this argument is never a number\n"
     "rule S -> u ~ uniform(0, 1) T(log(-u - 1))\n"
     "                              ^",
     "start S\nrule S -> u ~ uniform(0, 1) T(log(u + 1))\nrule T(x) -> draw(x)"},
    /* no derivation ends */
    {"label a\nstart S(1)\nrule S(x) if x > 0 -> split x { S(x + 1) | a }\nrule S(x) if x <= 0 -> a",
     "t.sg:3:6: error: 'S' is unproductive: no choice of its rules that can be used ever ends\n"
     "rule S(x) if x > 0 -> split x { S(x + 1) | a }\n"
     "     ^",
     "label a\nstart S(1)\nrule S(x) if x > 0 -> split x { S(x - 1) | a }\nrule S(x) if x <= 0 -> a"},
    {"limit depth 2\nstart S\nrule S -> S\nrule S at limit -> T\nrule T -> nothing\nrule T at limit -> S",
     "t.sg:4:17: error: this rule 'at limit' of 'S' never ends\n"
     "rule S at limit -> T\n"
     "                ^",
     "limit depth 2\nstart S\nrule S -> S\nrule S at limit -> T\nrule T -> nothing\nrule T at limit -> draw(1)"},
};

static sg_grammar *read_text(const char *text, sg_error *err)
{
    sg_grammar *g = NULL;
    *err = (sg_error)SG_ERROR_INIT;
    const sg_status st = sg_grammar_parse(text, strlen(text), "t.sg", &g, err);
    ck_assert_int_eq(st == SG_OK, g != NULL);
    ck_assert(st == SG_OK || st == SG_EINPUT);
    return g;
}

static void check_silence(const char *text)
{
    sg_error err;
    sg_grammar *g = read_text(text, &err);
    ck_assert_msg(g != NULL, "%s\n%s", text, err.msg);
    if (sg_grammar_warning_count(g) > 0)
        ck_abort_msg("%s\n%s", text, sg_grammar_warning(g, 0));
    sg_grammar_free(g);
}

START_TEST(what_always_fails_is_an_error)
{
    sg_error err;
    sg_grammar *g = read_text(certain[_i].bad, &err);
    ck_assert_msg(g == NULL, "accepted: %s", certain[_i].bad);
    ck_assert_str_eq(err.msg, certain[_i].message);
    check_silence(certain[_i].good);
}
END_TEST

/* ---- warnings ---- */

static const struct {
    const char *odd, *message, *good;
} possible[] = {
    {"start X(1)\nrule X(l) if l < 1 -> nothing\nrule X(l) if l >= 1 -> nothing",
     "t.sg:2:14: warning: this guard never holds, as l is 1\n"
     "rule X(l) if l < 1 -> nothing\n"
     "             ^",
     "start X(1)\nrule X(l) if l < 1 -> nothing\nrule X(l) if l >= 1 -> X(l - 1)"},
    {"start S\nrule S -> X(uniform(2, 4))\nrule X(l) if l > 4 or l + depth < 1 -> nothing\nrule X(l) if l <= 4 -> nothing",
     "t.sg:3:14: warning: this guard never holds, as l is from 2 to 4 and depth is 1\n"
     "rule X(l) if l > 4 or l + depth < 1 -> nothing\n"
     "             ^",
     "start S\nrule S -> X(uniform(2, 4))\nrule X(l) if l > 3 or l + depth < 1 -> nothing\nrule X(l) if l <= 4 -> nothing"},
    {"weights\nstart S\nrule S -> nothing -> 0 : T\nrule T -> nothing",
     "t.sg:4:6: warning: nothing that can be used leads to 'T'\n"
     "rule T -> nothing\n"
     "     ^",
     "weights\nstart S\nrule S -> nothing -> 0.1 : T\nrule T -> nothing"},
    {"start S\nrule S -> X(uniform(0, 1))\nrule X(u)\n  -> u - 0.5 : nothing\n  -> 1 : nothing",
     "t.sg:4:6: warning: the weight can be -0.47, as in S > X(0.03)\n"
     "  -> u - 0.5 : nothing\n"
     "     ^",
     "start S\nrule S -> X(uniform(0, 1))\nrule X(u)\n  -> u : nothing\n  -> 1 : nothing"},
    {"start X(1)\nrule X(l)\n  -> 1.1 - l/3 : X(l + 1)\n  -> l/3 : nothing",
     "t.sg:3:6: warning: the weight can be -0.233333, as in X(1) > X(2) > X(3) > X(4)\n"
     "  -> 1.1 - l/3 : X(l + 1)\n"
     "     ^",
     "start X(1)\nrule X(l) if l <= 3\n  -> 1.1 - l/3 : X(l + 1)\n  -> l/3 : nothing\nrule X(l) if l > 3 -> nothing"},
    {"start S\nrule S -> X(uniform(0, 1))\nrule X(u) if u < 0.2 -> nothing\nrule X(u) if u > 0.8 -> nothing",
     "t.sg:3:6: warning: it can be that no guard of 'X' holds, as in S > X(0.5)\n"
     "rule X(u) if u < 0.2 -> nothing\n"
     "     ^",
     "start S\nrule S -> X(uniform(0, 1))\nrule X(u) if u < 0.2 -> nothing\nrule X(u) if u >= 0.2 -> nothing"},
    {"start S\nrule S -> X(discrete((1, 0), (1, 1)))\nrule X(u)\n  -> u : nothing\n  -> 2 * u : nothing",
     "t.sg:3:6: warning: the weights of 'X' can all be zero, as in S > X(0)\n"
     "rule X(u)\n"
     "     ^",
     "start S\nrule S -> X(discrete((1, 0), (1, 1)))\nrule X(u)\n  -> u : nothing\n  -> 1 - u : nothing"},
    {"start S\nrule S ->\n  u ~ uniform(0, 1)\n  draw(normal(0, u - 0.5))",
     "t.sg:4:15: warning: normal can fail: the standard deviation must be greater than 0, as in S with u = 0.5\n"
     "  draw(normal(0, u - 0.5))\n"
     "              ^",
     "start S\nrule S ->\n  u ~ uniform(0, 1)\n  draw(normal(0, u + 0.5))"},
    {"label a\nstart S\nrule S -> u ~ normal(0.5, 1) maybe(u) a",
     "t.sg:3:36: warning: the probability can be -1.38079, as in S with u = -1.38079\n"
     "rule S -> u ~ normal(0.5, 1) maybe(u) a\n"
     "                                   ^",
     "label a\nstart S\nrule S -> u ~ normal(0.5, 1) maybe(max(0, min(u, 1))) a"},
    {"start S\nrule S -> u ~ uniform(-1, 1) T(sqrt(u))\nrule T(x) -> draw(x)",
     "t.sg:2:32: warning: this argument can be no number, as in S with u = -0.94\n"
     "rule S -> u ~ uniform(-1, 1) T(sqrt(u))\n"
     "                               ^",
     "start S\nrule S -> u ~ uniform(-1, 1) T(sqrt(abs(u)))\nrule T(x) -> draw(x)"},
    {"start S\nrule S -> n ~ uniform(-2, 2) repeat x n { insert(box) }",
     "t.sg:2:39: warning: the repeat count can be -1.88, as in S with n = -1.88\n"
     "rule S -> n ~ uniform(-2, 2) repeat x n { insert(box) }\n"
     "                                      ^",
     "start S\nrule S -> n ~ uniform(-0.49, 2) repeat x n { insert(box) }"},
    {"label a\nstart S\nrule S -> n ~ normal(1, 1) split x { n : a | ~1 : a }",
     "t.sg:3:38: warning: the size of this part can be -0.880794, as in S with n = -0.880794\n"
     "rule S -> n ~ normal(1, 1) split x { n : a | ~1 : a }\n"
     "                                     ^",
     /* four standard deviations are not what a warning is for */
     "label a\nstart S\nrule S -> n ~ normal(1, 0.25) split x { n : a | ~1 : a }"},
    {"material oak #8b5a2b\nstart S\nrule S -> set_material(okk) insert(box)",
     "t.sg:3:24: warning: material 'okk' is not declared, as others are\n"
     "rule S -> set_material(okk) insert(box)\n"
     "                       ^",
     "start S\nrule S -> set_material(okk) insert(box)"},
    {"start S\nrule S -> gable_roof(90)",
     "t.sg:2:22: warning: a roof with a slope of 90 degrees; expected less than 90\n"
     "rule S -> gable_roof(90)\n"
     "                     ^",
     "start S\nrule S -> gable_roof(89)"},
};

/* A constant with a name may be a switch: what it takes out of use is no mistake. */
static const char *const switches[] = {
    "const lobes = 0\nstart X(1)\nrule X(j) if j > 0 and lobes > 0 -> Y\nrule X(j) if not (j > 0 and lobes > 0) -> nothing\nrule Y -> nothing",
    "const lobes = 0\nstart X\nrule X if lobes > 0 -> Y\nrule X if lobes == 0 -> nothing\nrule Y -> nothing",
    ("const lobes = 0\nfunction many(x) = x > lobes + 3\nstart X(1)\nrule X(j) if many(j) -> Y\n"
     "rule X(j) if not many(j) -> nothing\nrule Y -> Z\nrule Z -> nothing"),
    "weights\nconst lobes = 0\nstart X\nrule X -> lobes : Y -> 1 : nothing\nrule Y -> nothing",
};

START_TEST(switches_are_no_mistakes)
{
    check_silence(switches[_i]);
}
END_TEST

START_TEST(what_can_fail_is_a_warning)
{
    sg_error err;
    sg_grammar *g = read_text(possible[_i].odd, &err);
    ck_assert_msg(g != NULL, "%s", err.msg);
    ck_assert_uint_ge(sg_grammar_warning_count(g), 1);
    ck_assert_str_eq(sg_grammar_warning(g, 0), possible[_i].message);
    sg_grammar_free(g);
    if (possible[_i].good != NULL)
        check_silence(possible[_i].good);
}
END_TEST

START_TEST(warnings_are_not_without_end)
{
    char text[8000] = "start S rule S -> nothing ";
    for (int i = 0; i < 60; i++)
        strcat(text, "rule S if depth == 1 -> nothing ");
    sg_error err;
    sg_grammar *g = read_text(text, &err);
    ck_assert_uint_eq(sg_grammar_warning_count(g), 20);
    for (size_t i = 1; i < 20; i++) /* one for each place */
        ck_assert_str_ne(sg_grammar_warning(g, i - 1), sg_grammar_warning(g, i));
    sg_grammar_free(g);
}
END_TEST

/* One place, one warning, however many examples there are. */
START_TEST(a_place_is_warned_of_once)
{
    sg_error err;
    sg_grammar *g = read_text("start S rule S -> X(uniform(-3, 1)) X(uniform(-3, 0)) rule X(u) -> u : nothing -> 4 : nothing",
                              &err);
    ck_assert_uint_eq(sg_grammar_warning_count(g), 1);
    sg_grammar_free(g);
}
END_TEST

START_TEST(our_own_grammars_are_flawless)
{
    char folder[4096], path[8300];
    snprintf(folder, sizeof folder, "%s/data/grammars", test_folder("SG_SOURCE_DIR"));
    DIR *dir = opendir(folder);
    ck_assert_ptr_nonnull(dir);
    unsigned n = 0;
    for (struct dirent *e; (e = readdir(dir)) != NULL;) {
        const size_t length = strlen(e->d_name);
        if (length < 4 || strcmp(e->d_name + length - 3, ".sg") != 0)
            continue;
        sg_error err = SG_ERROR_INIT;
        sg_grammar *g = NULL;
        snprintf(path, sizeof path, "%s/%s", folder, e->d_name);
        ck_ok(sg_grammar_load(path, &g, &err));
        ck_assert_msg(sg_grammar_warning_count(g) == 0, "%s", sg_grammar_warning(g, 0));
        sg_grammar_free(g);
        n++;
    }
    closedir(dir);
    ck_assert_uint_ge(n, 5);
}
END_TEST

/* ---- runs ---- */

/* What stands at the end of a long way, and depends on a draw, only a run can know. */
static const char *const run_template = "label a\nstart B\nrule B -> S(0, normal(1, 0.01))\n"
                                        "rule S(n, y) if n < 3000 -> S(n + 1, y)\nrule S(n, y) if n >= %s\n"
                                        "  -> %s\n";

static const struct {
    const char *from, *end; /* guard and body of the last rule */
    bool labels;            /* it fails as a label scene, not when it is derived */
    unsigned line;
    const char *sentence;
} runs[] = {
    {"3000", "y - 9 : a", false, 4, "the weight of a rule is -"},
    {"3000", "max(0, y - 9) : a", false, 4, "the weights of its rules sum to 0"},
    {"3000 + y", "a", false, 4, "no guard of its rules holds"},
    {"3000", "s ~ normal(0, y - 9) draw(s)", false, 6, "draw s: the standard deviation must be greater than 0"},
    {"3000", "draw(uniform(y, -2))", false, 6, "draw: low must be less than high"},
    {"3000", "draw(discrete((y - 9, 2)))", false, 6, "draw: a weight is negative"},
    {"3000", "draw(mixture((max(0, y - 9), 2, 3)))", false, 6, "draw: all weights are zero"},
    {"3000", "T(sqrt(y - 9)) rule T(x) -> a", false, 6, "argument 1 of T is not a number"},
    {"3000", "repeat x 2 { T(log(y - 9)) } rule T(x) -> a", false, 6, "argument 1 of T is not a number"},
    {"3000", "repeat x y - 9 { a }", false, 6, "a repeat count is -8"},
    {"3000", "maybe(y / 2) a maybe(y + 1) a", false, 6, "the probability of an optional successor is 2."},
    {"3000", "split x { y - 9 : a | ~1 : a }", true, 6, "the size of a part is negative or no number"},
    {"3000", "split x { '3 * y : a | ~1 : a }", true, 6, "the parts of a split are larger than its scope"},
    {"3000", "split x { '0.3 * y : a | '0.1 : a }", true, 6, "the parts of a split do not fill its scope"},
};

/* Derive, and interpret when that is where it fails. */
static sg_status run_once(const sg_grammar *g, bool labels, sg_error *err)
{
    sg_derivation d;
    sg_derivation_init(&d, g);
    gsl_rng *rng = sg_random_create(1);
    sg_status st = sg_derivation_sample(&d, rng, 100000, err);
    gsl_rng_free(rng);
    if (labels) {
        sg_label_scene scene = {0};
        sg_scene space = {0};
        const sg_scene_opts opts = SG_SCENE_OPTS_INIT;
        ck_assert_int_eq(st, SG_OK);
        st = sg_label_scene_interpret(&scene, &d, 10, 10, err);
        sg_error other = SG_ERROR_INIT;
        if (sg_scene_interpret(&d, &opts, &space, &other) != SG_OK) /* in space parts may be larger or smaller */
            ck_assert_str_eq(other.msg, err->msg);
        sg_label_scene_clear(&scene);
        sg_scene_clear(&space);
    }
    sg_derivation_clear(&d);
    return st;
}

START_TEST(runs_tell_file_line_and_path)
{
    sg_error err;
    char text[600], place[100];
    snprintf(text, sizeof text, run_template, runs[_i].from, runs[_i].end);
    sg_grammar *g = read_text(text, &err);
    ck_assert_msg(g != NULL, "%s\n%s", text, err.msg);
    if (sg_grammar_warning_count(g) > 0)
        ck_abort_msg("%s", sg_grammar_warning(g, 0));
    ck_assert_int_eq(run_once(g, runs[_i].labels, &err), SG_ENUMERIC);
    snprintf(place, sizeof place, "t.sg:%u: error: deriving B > S(0, ", runs[_i].line);
    ck_assert_msg(strncmp(err.msg, place, strlen(place)) == 0, "%s", err.msg);
    ck_assert_msg(strstr(err.msg, " more) > S(") != NULL && strstr(err.msg, " > S(3000, ") != NULL, "%s", err.msg);
    ck_assert_msg(strstr(err.msg, runs[_i].sentence) != NULL, "%s", err.msg);
    sg_grammar_free(g);
}
END_TEST

#define COUNT(array) ((int)(sizeof(array) / sizeof *(array)))

int main(void)
{
    Suite *suite = suite_create("checks");
    TCase *tc = tcase_create("checks");
    tcase_set_timeout(tc, 120);
    tcase_add_loop_test(tc, what_always_fails_is_an_error, 0, COUNT(certain));
    tcase_add_loop_test(tc, what_can_fail_is_a_warning, 0, COUNT(possible));
    tcase_add_loop_test(tc, switches_are_no_mistakes, 0, COUNT(switches));
    tcase_add_test(tc, warnings_are_not_without_end);
    tcase_add_test(tc, a_place_is_warned_of_once);
    tcase_add_test(tc, our_own_grammars_are_flawless);
    tcase_add_loop_test(tc, runs_tell_file_line_and_path, 0, COUNT(runs));
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
