/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_split.c - the split form: to grammars and back, through text and through JSON. */
#include "grammar/split.h"

#include "tests/grammar_support.h"
#include "tests/random_grammar.h"

#include <float.h>

static uint32_t find(const char *const *names, size_t n, const char *name)
{
    for (size_t i = 0; i < n; i++)
        if (strcmp(names[i], name) == 0)
            return (uint32_t)i;
    ck_abort_msg("%s is missing", name);
    return 0;
}

static void compare_sizes(const sg_split_rule *a, const sg_split_rule *b, double tolerance)
{
    const size_t n = a->n - 1;
    ck_assert_uint_eq(a->nattributes, b->nattributes);
    for (size_t i = 0; i < a->nattributes * a->n; i++)
        ck_assert(a->attributes[i] == b->attributes[i]);
    ck_assert((a->mean == NULL) == (b->mean == NULL));
    if (a->mean == NULL)
        return;
    for (size_t i = 0; i < a->n; i++)
        ck_assert(a->mean[i] == b->mean[i]);
    for (size_t i = 0; i < n * n; i++)
        ck_assert_msg(fabs(a->covariance[i] - b->covariance[i]) <= tolerance, "%.17g %.17g", a->covariance[i],
                      b->covariance[i]);
}

/* Equal up to the numbering of symbols: names, rules in their order, and all numbers bit for bit but the covariance. */
static void compare(const sg_split_form *a, const sg_split_form *b, double tolerance)
{
    ck_assert_uint_eq(a->nsymbols, b->nsymbols);
    ck_assert_uint_eq(a->nterminals, b->nterminals);
    ck_assert_uint_eq(a->nrules, b->nrules);
    ck_assert(a->tied == b->tied);
    ck_assert_str_eq(a->name, b->name);
    ck_assert_str_eq(a->symbol_names[a->axiom], b->symbol_names[b->axiom]);
    for (size_t t = 0; t < a->nterminals; t++) {
        ck_assert_str_eq(a->terminal_names[t], b->terminal_names[t]);
        ck_assert_uint_eq(a->terminal_colors[t], b->terminal_colors[t]);
    }
    for (size_t i = 0; i < a->nrules;) {
        const uint32_t s = a->rules[i].lhs, other = find(b->symbol_names, b->nsymbols, a->symbol_names[s]);
        size_t j = 0;
        while (j < b->nrules && b->rules[j].lhs != other)
            j++;
        for (; i < a->nrules && a->rules[i].lhs == s; i++, j++) {
            const sg_split_rule *x = &a->rules[i], *y = &b->rules[j];
            ck_assert(j < b->nrules && y->lhs == other && x->op == y->op && x->n == y->n);
            ck_assert(x->probability == y->probability);
            for (uint32_t k = 0; k < x->n; k++)
                if (x->op == SG_SPLIT_LEXICAL)
                    ck_assert_uint_eq(x->rhs[k], y->rhs[k]);
                else
                    ck_assert_str_eq(a->symbol_names[x->rhs[k]], b->symbol_names[y->rhs[k]]);
            compare_sizes(x, y, tolerance);
        }
    }
}

/* form -> grammar -> text -> grammar -> form -> JSON -> form -> grammar -> text: nothing changes on the way. */
static void round_trip(const sg_split_form *form)
{
    sg_error err = SG_ERROR_INIT;
    sg_arena *arena = sg_arena_create();
    sg_grammar *g = NULL, *again = NULL;
    sg_split_form read, direct;
    ck_ok(sg_grammar_from_split(form, &g, &err));
    ck_ok(sg_split_form_of(g, arena, &direct, &err));
    compare(form, &direct, 1e-13);
    char *text = test_print(g);
    sg_grammar *from_text = test_grammar(text);
    sg_split_form of_text;
    ck_ok(sg_split_form_of(from_text, arena, &of_text, &err));
    compare(&direct, &of_text, 0);
    char *json = test_json(&of_text);
    ck_ok(sg_split_form_read_json(json, strlen(json), "test.json", arena, &read, &err));
    compare(&of_text, &read, 0);
    char *json_again = test_json(&read);
    ck_assert_str_eq(json, json_again);
    ck_ok(sg_grammar_parse(json, strlen(json), "test.json", &again, &err));
    sg_split_form last;
    ck_ok(sg_split_form_of(again, arena, &last, &err));
    compare(form, &last, 1e-12);
    free(text);
    free(json);
    free(json_again);
    sg_grammar_free(g);
    sg_grammar_free(from_text);
    sg_grammar_free(again);
    sg_arena_free(arena);
}

START_TEST(random_forms_survive_every_way_round)
{
    gsl_rng *rng = sg_random_create((uint64_t)_i);
    for (int i = 0; i < 50; i++) {
        sg_arena *arena = sg_arena_create();
        sg_split_form form;
        const random_split_opts opts = {1 + (unsigned)i % 8, 1 + (unsigned)i % 4, 1 + (unsigned)i % 6, true, true};
        random_split_form(rng, &opts, arena, &form);
        round_trip(&form);
        sg_arena_free(arena);
    }
    gsl_rng_free(rng);
}
END_TEST

/* Without size models nothing is computed: the text itself comes back through JSON. */
START_TEST(text_survives_json)
{
    gsl_rng *rng = sg_random_create(500 + (uint64_t)_i);
    for (int i = 0; i < 50; i++) {
        sg_error err = SG_ERROR_INIT;
        sg_arena *arena = sg_arena_create();
        sg_split_form form, second;
        const random_split_opts opts = {8, 4, 5, false, true};
        random_split_form(rng, &opts, arena, &form);
        sg_grammar *g = NULL, *again = NULL;
        ck_ok(sg_grammar_from_split(&form, &g, &err));
        ck_ok(sg_split_form_of(g, arena, &second, &err));
        char *json = test_json(&second), *text = test_print(g);
        ck_ok(sg_grammar_parse(json, strlen(json), "test.json", &again, &err));
        char *text_again = test_print(again);
        ck_assert_str_eq(text, text_again);
        free(json);
        free(text);
        free(text_again);
        sg_grammar_free(g);
        sg_grammar_free(again);
        sg_arena_free(arena);
    }
    gsl_rng_free(rng);
}
END_TEST

START_TEST(y_is_reversed_and_x_is_not)
{
    sg_error err = SG_ERROR_INIT;
    sg_arena *arena = sg_arena_create();
    sg_split_form f;
    sg_grammar *g = test_grammar("label a label b label c start S rule S "
                                 "-> 0.5 : split y { a | b | c } sizes mean (0.5, 0.3, 0.2) covariance ((0.01, -0.002), (-0.002, 0.02)) "
                                 "examples ((0.5, 0.4, 0.1)) "
                                 "-> 0.5 : split x { a | b | c } sizes mean (0.5, 0.3, 0.2) covariance ((0.01, -0.002), (-0.002, 0.02)) "
                                 "examples ((0.5, 0.4, 0.1))");
    ck_ok(sg_split_form_of(g, arena, &f, &err));
    const sg_split_rule *y = &f.rules[0], *x = &f.rules[1];
    ck_assert(y->op == SG_SPLIT_Y && x->op == SG_SPLIT_X);
    static const char *const order[] = {"a", "b", "c"};
    static const double mean[] = {0.5, 0.3, 0.2}, example[] = {0.5, 0.4, 0.1};
    for (int i = 0; i < 3; i++) {
        ck_assert_str_eq(f.symbol_names[x->rhs[i]], order[i]);
        ck_assert_str_eq(f.symbol_names[y->rhs[i]], order[2 - i]);
        ck_assert(x->mean[i] == mean[i] && y->mean[i] == mean[2 - i]);
        ck_assert(x->attributes[i] == example[i] && y->attributes[i] == example[2 - i]);
    }
    ck_assert(x->covariance[0] == 0.01 && x->covariance[3] == 0.02);
    /* Var c = Var(a + b) = 0.026, Cov(c, b) = -Cov(a, b) - Var b = -0.018, Var b = 0.02 */
    static const double turned[] = {0.026, -0.018, -0.018, 0.02};
    for (int i = 0; i < 4; i++)
        ck_assert_double_eq_tol(y->covariance[i], turned[i], 1e-16);
    ck_assert_uint_eq(y->source, 0);
    ck_assert_uint_eq(f.rules[2].source, 2);
    sg_grammar_free(g);
    sg_arena_free(arena);
}
END_TEST

START_TEST(implicit_lexical_symbols_come_and_go)
{
    sg_error err = SG_ERROR_INIT;
    sg_arena *arena = sg_arena_create();
    sg_split_form f;
    static const char *const text = "label wall #111111\n"
                                    "label sky #222222\n"
                                    "start S\n"
                                    "rule S\n"
                                    "  -> split y { wall | T | sky }\n"
                                    "rule T\n"
                                    "  -> wall\n";
    sg_grammar *g = test_grammar(text), *again = NULL;
    ck_ok(sg_split_form_of(g, arena, &f, &err));
    ck_assert_uint_eq(f.nsymbols, 4);
    ck_assert_uint_eq(f.nrules, 4);
    ck_ok(sg_grammar_from_split(&f, &again, &err));
    char *printed = test_print(again);
    ck_assert_str_eq(strchr(printed, '\n') + 1, text); /* behind the name that the form gave it */
    free(printed);
    sg_grammar_free(g);
    sg_grammar_free(again);
    sg_arena_free(arena);
}
END_TEST

/* In the exchange form a symbol may have the name of a terminal and be something else. */
START_TEST(symbols_that_share_a_terminals_name_are_renamed)
{
    sg_error err = SG_ERROR_INIT;
    static const char json[] =
        "{\"format\":\"shapegram-grammar\",\"version\":1,\"axiom\":\"wall\",\"terminals\":[{\"name\":\"wall\"},{\"name\":\"sky\"},{\"name\":\"wall_2\"}],"
        "\"rules\":[{\"lhs\":\"wall\",\"op\":\"split-x\",\"rhs\":[\"sky\",\"sky\"],\"probability\":0.5},"
        "{\"lhs\":\"sky\",\"op\":\"terminal\",\"rhs\":[\"sky\"],\"probability\":1},"
        "{\"lhs\":\"wall\",\"op\":\"terminal\",\"rhs\":[\"wall\"],\"probability\":0.5}]}";
    sg_grammar *g = NULL;
    ck_ok(sg_grammar_parse(json, strlen(json), "test.json", &g, &err));
    ck_assert_str_eq(sg_grammar_symbol(g, sg_grammar_start(g))->name, "wall_3");
    ck_assert_int_eq(sg_grammar_symbol(g, sg_grammar_find(g, "wall"))->kind, SG_SYMBOL_LABEL);
    char *printed = test_print(g);
    sg_grammar_free(test_grammar(printed));
    free(printed);
    sg_grammar_free(g);
}
END_TEST

START_TEST(the_forms_own_example_is_read)
{
    sg_error err = SG_ERROR_INIT;
    static const char json[] =
        "{\"format\":\"shapegram-grammar\",\"version\":1,\"axiom\":\"S\",\n"
        " \"terminals\":[{\"name\":\"window\",\"color\":\"#ff0000\"}],\n"
        " \"rules\":[{\"lhs\":\"S\",\"op\":\"split-y\",\"rhs\":[\"A\",\"B\"],\"probability\":0.5,\n"
        "   \"attributes\":[[0.2,0.8],[0.25,0.75]],\"mean\":[0.225,0.775],\"covariance\":[[0.00125]]},\n"
        "  {\"lhs\":\"S\",\"op\":\"split-x\",\"rhs\":[\"B\"],\"probability\":0.5,\"mean\":[1],\"covariance\":[]},\n"
        "  {\"lhs\":\"A\",\"op\":\"terminal\",\"rhs\":[\"window\"],\"probability\":1.0},\n"
        "  {\"lhs\":\"B\",\"op\":\"terminal\",\"rhs\":[\"window\"],\"probability\":1}]}";
    sg_arena *arena = sg_arena_create();
    sg_split_form f;
    ck_ok(sg_split_form_read_json(json, strlen(json), "test.json", arena, &f, &err));
    ck_assert_uint_eq(f.nsymbols, 3);
    ck_assert_uint_eq(f.rules[0].nattributes, 2);
    ck_assert_double_eq(f.rules[0].attributes[3], 0.75);
    ck_assert_double_eq(f.rules[0].covariance[0], 0.00125);
    ck_assert_uint_eq(f.terminal_colors[0], 0xff0000);
    f.name = "example";
    round_trip(&f);
    sg_arena_free(arena);
}
END_TEST

/* What split grammars cannot say. */
static const struct {
    const char *text, *message;
} too_much[] = {
    {"start A(1) rule A(x) -> nothing", "parameters"},
    {"start A rule A if depth < 1 -> nothing rule A if depth >= 1 -> nothing", "a guard"},
    {"label a start A rule A -> split x { 2 : a | a }", "sizes that are neither drawn nor equal"},
    {"label a start A rule A -> split z { a | a }", "a split along z"},
    {"label a start A rule A -> draw(1)", "a body that is not one split or one label"},
    {"label a start A rule A -> nothing", "a body that is not one split or one label"},
    {"label a start A\nrule A -> split x { a } a", "test.sg:2: error: no split grammar: rule of A: a body"},
    {"label a start A rule A -> split x { a a }", "a part that is not one symbol"},
    {"label a start A rule A -> split x { [ a ] }", "a part that is not one symbol"},
    {"label a start A rule A -> split x { nothing }", "a part that is not one symbol"},
    {"label a start A rule A -> split x { maybe(0.5) a }", "a body that is not one split or one label"},
    {"label a limit depth 3 start A rule A -> a", "a depth limit"},
};

START_TEST(what_is_no_split_grammar_is_refused)
{
    sg_error err = SG_ERROR_INIT;
    sg_arena *arena = sg_arena_create();
    sg_split_form f;
    sg_grammar *g = test_grammar(too_much[_i].text);
    ck_assert_int_eq(sg_split_form_of(g, arena, &f, &err), SG_EINPUT);
    ck_assert_msg(strstr(err.msg, too_much[_i].message) != NULL, "%s", err.msg);
    sg_grammar_free(g);
    sg_arena_free(arena);
}
END_TEST

START_TEST(a_bare_symbol_is_a_split_into_one)
{
    sg_error err = SG_ERROR_INIT;
    sg_arena *arena = sg_arena_create();
    sg_split_form f;
    sg_grammar *g = test_grammar("label a start A rule A -> B rule B -> a");
    ck_ok(sg_split_form_of(g, arena, &f, &err));
    ck_assert(f.rules[0].op == SG_SPLIT_X && f.rules[0].n == 1);
    ck_assert(f.rules[1].op == SG_SPLIT_LEXICAL);
    sg_grammar_free(g);
    sg_arena_free(arena);
}
END_TEST

/* A file of the exchange form with one thing in it replaced. */
static const char good[] =
    "{\"format\":\"shapegram-grammar\",\n\"version\":1,\n\"axiom\":\"S\",\n"
    "\"terminals\":[{\"name\":\"w\",\"color\":\"#ff0000\"}],\n"
    "\"rules\":[{\"lhs\":\"S\",\"op\":\"split-y\",\"rhs\":[\"A\",\"B\"],\"probability\":0.5,"
    "\"attributes\":[[0.2,0.8],[0.25,0.75]],\"mean\":[0.225,0.775],\"covariance\":[[0.00125]]},\n"
    "{\"lhs\":\"S\",\"op\":\"split-x\",\"rhs\":[\"B\"],\"probability\":0.5},\n"
    "{\"lhs\":\"A\",\"op\":\"terminal\",\"rhs\":[\"w\"],\"probability\":1.0},\n"
    "{\"lhs\":\"B\",\"op\":\"terminal\",\"rhs\":[\"w\"],\"probability\":1}]}";

static const struct {
    const char *old, *new, *message;
} faults[] = {
    {"\"version\":1", "\"version\":2", "\"version\" is not 1"},
    {"shapegram-grammar", "other", "\"format\" is \"other\""},
    {"\"axiom\":\"S\"", "\"axiom\":\"Q\"", "the axiom 'Q' has no rules"},
    {"\"axiom\":\"S\"", "\"axiom\":\"A\"", "cannot be reached"},
    {"\"axiom\":\"S\",\n", "", "\"axiom\" is missing"},
    {"\"axiom\":\"S\"", "\"axiom\":3", "\"axiom\" is no string"},
    {"#ff0000", "red", "terminal 1: \"color\""},
    {"\"terminals\":[", "\"terminals\":[{\"name\":\"w\"},", "two terminals named 'w'"},
    {"\"terminals\":[{", "\"terminals\":[{\"x\":1},{", "\"name\" is missing"},
    {"split-y", "split-z", "rule 1: error: \"op\" is \"split-z\""},
    {"\"A\",\"B\"", "\"A\",\"Q\"", "rule 1: error: \"rhs\": 'Q' is no symbol with rules"},
    {"\"A\",\"B\"", "\"A\",7", "rule 1: error: \"rhs\""},
    {"[\"B\"]", "[]", "rule 2: error: \"rhs\""},
    {"[\"w\"],\"probability\":1.0", "[\"v\"],\"probability\":1.0", "rule 3: error: \"rhs\": 'v' is no terminal"},
    {"\"probability\":0.5,", "\"probability\":0.4,", "rule 1: error: the probabilities of 'S' sum to 0.9, not to 1"},
    {"\"probability\":0.5,", "\"probability\":-0.5,", "rule 1: error: the probability is -0.5"},
    {"\"probability\":0.5,", "\"probability\":\"a\",", "rule 1: error: \"probability\" is no number"},
    {"\"probability\":0.5},", "\"p\":0.5},", "rule 2: error: \"probability\" is missing"},
    {"\"probability\":0.5,", "\"probability\":NaN,", "test.json:5:"},
    {"\"probability\":0.5,", "\"probability\":1e999,", "test.json:5:"},
    {"[0.25,0.75]", "[0.25]", "rule 1: error: \"attributes\": expected an array of 2 numbers"},
    {"[0.25,0.75]", "[0.25,0.85]", "rule 1: error: an example: sizes that sum to 1.1"},
    {"[0.225,0.775]", "[0.225,0.775,0]", "rule 1: error: \"mean\""},
    {"[0.225,0.775]", "[0.225,0.875]", "a mean whose sizes sum to 1.1"},
    {"\"mean\":[0.225,0.775],", "", "\"covariance\" without \"mean\""},
    {"[[0.00125]]", "[]", "rule 1: error: \"covariance\": expected an array of 1 rows"},
    {"[[0.00125]]", "[[-1]]", "rule 1: error: the covariance of the sizes is not positive definite"},
    {"{\"lhs\":\"A\",", "{", "rule 3: error: \"lhs\" is missing"},
    {"\"rules\":[", "\"rules\":[7,", "rule 1: error: no object"},
    {"\"op\":\"terminal\",\"rhs\":[\"w\"],\"probability\":1}", "\"op\":\"split-x\",\"rhs\":[\"B\"],\"probability\":1}", "unproductive"},
    {"\"A\",\"B\"", "\"B\",\"B\"", "'A' cannot be reached"},
    {"\"version\":1,", "\"version\":1", "test.json:3:"},
    {"\"version\":1,", "\"version\":1,\"version\":1,", "duplicate"},
    {"\"lhs\":\"A\"", "\"lhs\":\"\xff\"", "test.json:7:"},
    {"\"name\":\"w\"", "\"name\":\"a\\nb\"", "rule 3: error: \"rhs\""},
};

START_TEST(faults_of_the_exchange_form_are_named)
{
    const char *at = strstr(good, faults[_i].old);
    ck_assert_ptr_nonnull(at);
    char text[2000];
    snprintf(text, sizeof text, "%.*s%s%s", (int)(at - good), good, faults[_i].new, at + strlen(faults[_i].old));
    sg_error err = SG_ERROR_INIT;
    sg_grammar *g = NULL;
    ck_ok(sg_grammar_parse(good, strlen(good), "test.json", &g, &err));
    sg_grammar_free(g);
    g = NULL;
    ck_assert_int_eq(sg_grammar_parse(text, strlen(text), "test.json", &g, &err), SG_EINPUT);
    ck_assert_msg(strncmp(err.msg, "test.json:", 10) == 0, "%s", err.msg);
    ck_assert_msg(strstr(err.msg, faults[_i].message) != NULL, "said: %s\nwanted: %s", err.msg, faults[_i].message);
}
END_TEST

/* Files with a few bytes changed: a grammar or a sentence, never a crash. */
START_TEST(damaged_exchange_forms_are_read_or_refused)
{
    gsl_rng *rng = sg_random_create(2000 + (uint64_t)_i);
    unsigned refused = 0;
    for (int i = 0; i < 300; i++) {
        char text[sizeof good];
        memcpy(text, good, sizeof good);
        for (unsigned k = 1 + (unsigned)gsl_rng_uniform_int(rng, 3); k > 0; k--)
            text[1 + gsl_rng_uniform_int(rng, sizeof good - 2)] = "{}[]\":,019.-eSAB \xC3n"[gsl_rng_uniform_int(rng, 19)];
        sg_error err = SG_ERROR_INIT;
        sg_grammar *g = NULL;
        const sg_status st = sg_grammar_parse(text, strlen(text), "test.json", &g, &err);
        ck_assert_msg((st == SG_OK && g != NULL) || (st == SG_EINPUT && g == NULL && err.msg[0] != '\0'), "%d %s", (int)st, text);
        refused += st != SG_OK;
        sg_grammar_free(g);
    }
    ck_assert(refused > 100 && refused < 300);
    gsl_rng_free(rng);
}
END_TEST

/* Forms that a program may make wrongly. */
START_TEST(bad_forms_are_refused)
{
    sg_error err = SG_ERROR_INIT;
    sg_grammar *g = NULL;
    static const char *const symbols[] = {"S", "T"}, *const terminals[] = {"w"}, *const twice[] = {"S", "S"}, *const line[] = {"S", "a\nb"};
    static const uint32_t colors[] = {0}, to_t[] = {1, 1}, to_w[] = {0}, beyond[] = {7};
    static const double mean[] = {0.5, 0.5}, covariance[] = {0.01}, bad_mean[] = {NAN, 0.5}, zero[] = {0};
    static const sg_split_rule base[] = {{0, SG_SPLIT_X, 2, to_t, 1, 0, NULL, mean, covariance, SG_NONE},
                                         {1, SG_SPLIT_LEXICAL, 1, to_w, 1, 0, NULL, NULL, NULL, SG_NONE}};
    for (int fault = 0; fault < 12; fault++) {
        sg_split_rule r[2] = {base[0], base[1]};
        sg_split_form f = {"f", 2, symbols, 1, terminals, colors, 0, false, 2, r};
        switch (fault) {
        case 1:
            f.axiom = 2;
            break;
        case 2:
            r[0].rhs = beyond;
            r[0].n = 1;
            break;
        case 3:
            r[0].probability = NAN;
            break;
        case 4:
            r[1].lhs = 0;
            break;
        case 5:
            f.symbol_names = twice;
            break;
        case 6:
            r[0].mean = bad_mean;
            break;
        case 7:
            r[0].covariance = zero;
            break;
        case 8:
            r[0].n = 0;
            break;
        case 9:
            f.symbol_names = line;
            break;
        case 10:
            r[0].probability = 0.5;
            break;
        case 11:
            r[0].covariance = NULL;
            break;
        default:
            break;
        }
        const sg_status st = sg_grammar_from_split(&f, &g, &err);
        ck_assert_msg(st == (fault == 0 ? SG_OK : SG_EINPUT), "fault %d: %s", fault, err.msg);
        if (fault == 0)
            sg_grammar_free(g);
        g = NULL;
    }
}
END_TEST

/* Probabilities that sum to one but for some digits are made to, and then keep their bits. */
START_TEST(probabilities_settle)
{
    sg_error err = SG_ERROR_INIT;
    sg_arena *arena = sg_arena_create();
    sg_grammar *g = test_grammar("label w start S rule S -> 0.333333 : w -> 0.333333 : split x { w | w } -> 0.333334 : split y { w }");
    sg_split_form f;
    for (int i = 0; i < 3; i++) {
        sg_grammar *next = NULL;
        ck_ok(sg_split_form_of(g, arena, &f, &err));
        ck_assert_double_eq_tol(f.rules[0].probability + f.rules[1].probability + f.rules[2].probability, 1, 4 * DBL_EPSILON);
        ck_ok(sg_grammar_from_split(&f, &next, &err));
        ck_assert(sg_grammar_rule(next, 0)->probability == sg_grammar_rule(g, 0)->probability);
        sg_grammar_free(g);
        g = next;
    }
    sg_grammar_free(g);
    sg_arena_free(arena);
}
END_TEST

/* A chain of symbols as long as a hostile file can make it: no quadratic time, no deep recursion. */
START_TEST(long_chains_are_checked_in_linear_time)
{
    enum { N = 50000 };
    sg_error err = SG_ERROR_INIT;
    sg_arena *arena = sg_arena_create();
    const char **names = SG_NEW_ARRAY(arena, const char *, N);
    sg_split_rule *rules = SG_NEW_ARRAY(arena, sg_split_rule, N);
    static const char *const terminals[] = {"w"};
    static const uint32_t colors[] = {0};
    for (uint32_t i = 0; i < N; i++) {
        uint32_t *rhs = SG_NEW(arena, uint32_t);
        *rhs = i + 1 < N ? i + 1 : 0;
        names[i] = sg_arena_printf(arena, "S%u", i);
        rules[i] = (sg_split_rule){i, i + 1 < N ? SG_SPLIT_X : SG_SPLIT_LEXICAL, 1, rhs, 1, 0, NULL, NULL, NULL, SG_NONE};
    }
    const sg_split_form f = {"chain", N, names, 1, terminals, colors, 0, false, N, rules};
    sg_grammar *g = NULL;
    ck_ok(sg_grammar_from_split(&f, &g, &err));
    ck_assert_uint_eq(sg_grammar_rule_count(g), N);
    sg_grammar_free(g);
    sg_arena_free(arena);
}
END_TEST

#define COUNT(array) ((int)(sizeof(array) / sizeof *(array)))

int main(void)
{
    Suite *suite = suite_create("split");
    TCase *tc = tcase_create("split");
    tcase_set_timeout(tc, 120);
    tcase_add_loop_test(tc, random_forms_survive_every_way_round, 0, 30);
    tcase_add_loop_test(tc, text_survives_json, 0, 10);
    tcase_add_test(tc, y_is_reversed_and_x_is_not);
    tcase_add_test(tc, implicit_lexical_symbols_come_and_go);
    tcase_add_test(tc, symbols_that_share_a_terminals_name_are_renamed);
    tcase_add_test(tc, the_forms_own_example_is_read);
    tcase_add_loop_test(tc, what_is_no_split_grammar_is_refused, 0, COUNT(too_much));
    tcase_add_test(tc, a_bare_symbol_is_a_split_into_one);
    tcase_add_loop_test(tc, faults_of_the_exchange_form_are_named, 0, COUNT(faults));
    tcase_add_loop_test(tc, damaged_exchange_forms_are_read_or_refused, 0, 5);
    tcase_add_test(tc, bad_forms_are_refused);
    tcase_add_test(tc, probabilities_settle);
    tcase_add_test(tc, long_chains_are_checked_in_linear_time);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
