/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_grammar.c - the language: what is read, what is printed, what is refused and how that is said. */
#include "grammar/grammar.h"

#include "core/file.h"
#include "grammar/shape_ops.h"
#include "grammar/grammar_counts.h"
#include "tests/grammar_support.h"
#include "tests/random_grammar.h"

#include <unistd.h>

/* ---- expressions ---- */

/* Value of an expression of x = 3 and y = 0.5 at depth 2: the weight of a rule that is never used, and so may be anything. */
static double value_of(const char *expression)
{
    char text[1000];
    snprintf(text, sizeof text,
             "const k = 10 function twice(a) = 2 * a function sum(a, b) = twice(a) + b "
             "weights start S rule S -> nothing -> 0 : X(1, 1) rule X(x, y) -> %s : nothing -> 1 : nothing", expression);
    sg_grammar *g = test_grammar(text);
    const sg_rule *r = sg_grammar_rule(g, sg_grammar_symbol(g, sg_grammar_find(g, "X"))->first_rule);
    const double frame[] = {3, 0.5};
    const double v = sg_grammar_eval(g, r->weight, frame, 2);
    sg_grammar_free(g);
    return v;
}

static const struct {
    const char *text;
    double value;
} expressions[] = {
    {"1", 1}, {"x", 3}, {"x - 2 - 1", 0}, {"x - (2 - 1)", 2}, {"12 / 2 / 3", 2}, {"12 / (2 / 4)", 24}, {"2 ^ 3 ^ 2", 512},
    {"(2 ^ 3) ^ 2", 64}, {"10 - 2 ^ 2", 6}, {"20 + -2 ^ 2", 16}, {"(-2) ^ 2", 4}, {"2 ^ -1", 0.5}, {"x ^ -y * 4", 4 / 1.7320508075688772},
    {"2 * -x + 10", 4}, {"1 - -1", 2}, {"not x == 2", 1}, {"not 1", 0}, {"not 0 and 1", 1}, {"1 or 0 and 0", 1},
    {"(1 or 0) and 0", 0}, {"x > 2 and y < 1", 1}, {"x >= 3", 1}, {"x <= 2.9", 0}, {"x != 3", 0}, {"1 + (2 < 3)", 2},
    {"if(x > 2, y, 1 / 0)", 0.5}, {"if(0, 1, 2)", 2}, {"min(x, y)", 0.5}, {"max(x, y)", 3}, {"abs(-x)", 3}, {"sign(-x) + 1", 0},
    {"floor(-0.5) + 1", 0}, {"ceil(y)", 1}, {"round(x + y)", 4}, {"sqrt(x + 1)", 2}, {"exp(0)", 1}, {"log(exp(2))", 2},
    {"mod(-1, 3)", 2}, {"mod(7, x)", 1}, {"hypot(x, 4)", 5}, {"atan2(0, 1)", 0}, {"sin(pi / 2)", 1}, {"cos(0)", 1},
    {"asin(1) - pi / 2", 0}, {"acos(1)", 0}, {"atan(0) + tan(0)", 0}, {"k + x", 13}, {"twice(x)", 6}, {"sum(x, sum(1, y))", 8.5},
    {"depth", 2}, {"depth + k", 12}, {"true + true", 2}, {"false", 0}, {"1e3", 1000}, {".5", 0.5}, {"7.", 7}, {"2.5e-1", 0.25},
};

START_TEST(expressions_have_their_values)
{
    ck_assert_msg(fabs(value_of(expressions[_i].text) - expressions[_i].value) < 1e-14, "%s is %.17g, not %g",
                  expressions[_i].text, value_of(expressions[_i].text), expressions[_i].value);
}
END_TEST

/* A random tree is written with all its parentheses and evaluated beside it: precedence, folding, registers. */
typedef struct {
    char text[4000];
    size_t n;
    gsl_rng *rng;
    double x, y;
} random_tree;

static void write_text(random_tree *t, const char *s)
{
    t->n += (size_t)snprintf(t->text + t->n, sizeof t->text - t->n, "%s", s);
}

static double grow_tree(random_tree *t, unsigned depth)
{
    static const char *const names[] = {" + ", " - ", " * ", " / ", " ^ ", " < ", " >= ", " == ", " and ", " or "};
    const unsigned kind = depth == 0 ? (unsigned)gsl_rng_uniform_int(t->rng, 3) : 3 + (unsigned)gsl_rng_uniform_int(t->rng, 12);
    char number[40];
    if (kind == 0 || kind == 1) {
        write_text(t, kind == 0 ? "x" : "y");
        return kind == 0 ? t->x : t->y;
    }
    if (kind == 2) {
        const double v = gsl_rng_uniform(t->rng) * 3;
        snprintf(number, sizeof number, "%.17g", v);
        write_text(t, number);
        return v;
    }
    if (kind >= 13) {
        write_text(t, kind == 13 ? "(-" : "(not ");
        const double v = grow_tree(t, depth - 1);
        write_text(t, ")");
        return kind == 13 ? -v : v == 0;
    }
    write_text(t, "(");
    const double a = grow_tree(t, depth - 1);
    write_text(t, names[kind - 3]);
    const double b = grow_tree(t, depth - 1);
    write_text(t, ")");
    const double values[] = {a + b,  a - b,  a * b,  a / b,           pow(a, b),
                             a < b, a >= b, a == b, a != 0 && b != 0, a != 0 || b != 0};
    return values[kind - 3];
}

START_TEST(random_expressions_agree_with_their_trees)
{
    gsl_rng *rng = sg_random_create((uint64_t)_i);
    random_tree t = {"", 0, rng, gsl_rng_uniform(rng) * 2 - 1, gsl_rng_uniform(rng) * 2};
    write_text(&t, "weights rule X(x, y) -> 0 * x + ");
    const double value = grow_tree(&t, 1 + (unsigned)_i % 5);
    write_text(&t, " : nothing -> 1 : nothing start S rule S -> nothing -> 0 : X(1, 1)");
    sg_grammar *g = test_grammar(t.text);
    char *printed = test_print(g);
    sg_grammar *again = test_grammar(printed);
    const double frame[] = {t.x, t.y};
    /* 0 * x may be -0 and the tree NaN: compare what is left */
    const double expected = 0 * t.x + value;
    const sg_grammar *const both[] = {g, again};
    for (int i = 0; i < 2; i++) {
        const double got = sg_grammar_eval(both[i], sg_grammar_rule(both[i], 0)->weight, frame, 0);
        ck_assert_msg(got == expected || (isnan(got) && isnan(expected)), "seed %d: %s gives %.17g, not %.17g", _i,
                      t.text, got, expected);
    }
    free(printed);
    sg_grammar_free(again);
    sg_grammar_free(g);
    gsl_rng_free(rng);
}
END_TEST

/* ---- what is read ---- */

START_TEST(numbers_are_read_and_printed_exactly)
{
    gsl_rng *rng = sg_random_create(7);
    for (int i = 0; i < 2000; i++) {
        uint64_t bits = (uint64_t)gsl_rng_get(rng) << 32 | gsl_rng_get(rng);
        double v;
        memcpy(&v, &bits, sizeof v);
        v = fabs(v);
        if (!isfinite(v))
            continue;
        char text[200], wanted[40];
        snprintf(wanted, sizeof wanted, "%.17g", v);
        snprintf(text, sizeof text, "start X(%s) rule X(a) -> nothing", wanted);
        sg_grammar *g = test_grammar(text);
        ck_assert_double_eq(sg_grammar_start_args(g)[0], v);
        char *printed = test_print(g);
        sg_grammar *again = test_grammar(printed);
        ck_assert_double_eq(sg_grammar_start_args(again)[0], v);
        free(printed);
        sg_grammar_free(again);
        sg_grammar_free(g);
    }
    gsl_rng_free(rng);
}
END_TEST

static const char branching[] =
    "# a plant\n"
    "grammar branching\n"
    "limit depth 12\n"
    "const a = 30\n"
    "label leaf #00ff00\n"
    "start X(1)\n"
    "rule X(l) if l <= 3\n"
    "  -> 1 - l/3 : s ~ normal(l, 0.2)  draw(s) [ turn(-a) X(l+1) ] [ turn(a) X(l+1) ]\n"
    "  -> l/3     : draw(normal(l, 0.2)) leaf\n"
    "rule X(l) if l > 3 -> leaf\n"
    "rule X(l) at limit -> draw(0.1)\n";

START_TEST(a_grammar_has_what_its_text_says)
{
    sg_grammar *g = test_grammar(branching);
    ck_assert_str_eq(sg_grammar_name(g), "branching");
    ck_assert_uint_eq(sg_grammar_depth_limit(g), 12);
    ck_assert(!sg_grammar_tied(g));
    ck_assert_uint_eq(sg_grammar_symbol_count(g), 2);
    ck_assert_uint_eq(sg_grammar_rule_count(g), 4);
    ck_assert_uint_eq(sg_grammar_frame_size(g), 2);
    ck_assert_uint_eq(sg_grammar_find(g, "Y"), SG_NONE);
    const sg_sym x = sg_grammar_find(g, "X"), leaf = sg_grammar_find(g, "leaf");
    ck_assert_uint_eq(sg_grammar_start(g), x);
    ck_assert_double_eq(sg_grammar_start_args(g)[0], 1);
    const sg_symbol *s = sg_grammar_symbol(g, x);
    ck_assert_int_eq(s->kind, SG_SYMBOL_NONTERMINAL);
    ck_assert_uint_eq(s->nparams, 1);
    ck_assert_str_eq(s->params[0], "l");
    ck_assert_uint_eq(s->nrules, 3);
    ck_assert_uint_eq(s->completion, s->first_rule + 3);
    ck_assert(!s->constant_weights);
    ck_assert_uint_eq(s->line, 7);
    ck_assert_uint_eq(sg_grammar_symbol(g, leaf)->color, 0x00ff00);
    ck_assert_int_eq(sg_grammar_symbol(g, leaf)->kind, SG_SYMBOL_LABEL);
    sg_grammar_free(g);
}
END_TEST

START_TEST(a_body_is_flat_and_in_order)
{
    sg_grammar *g = test_grammar(branching);
    const sg_rule *r = sg_grammar_rule(g, 0);
    ck_assert_uint_eq(r->ndraws, 1);
    ck_assert_str_eq(r->draws[0].name, "s");
    ck_assert_int_eq(r->draws[0].kind, SG_DRAW_NORMAL);
    ck_assert_uint_eq(r->nchildren, 2);
    static const struct {
        sg_op_kind kind;
        uint32_t length, shape;
    } wanted[] = {{SG_OP_SHAPE, 1, SG_SHAPE_DRAW}, {SG_OP_PUSH, 3, 0},      {SG_OP_SHAPE, 1, SG_SHAPE_TURN},
                  {SG_OP_SUCCESSOR, 1, 0},         {SG_OP_PUSH, 3, 0},      {SG_OP_SHAPE, 1, SG_SHAPE_TURN},
                  {SG_OP_SUCCESSOR, 1, 0}};
    ck_assert_uint_eq(r->nops, 7);
    for (uint32_t i = 0; i < r->nops; i++) {
        ck_assert_int_eq(r->ops[i].kind, wanted[i].kind);
        ck_assert_uint_eq(r->ops[i].length, wanted[i].length);
        ck_assert_uint_eq(r->ops[i].shape, wanted[i].shape);
    }
    ck_assert_uint_eq(r->ops[3].child, 0);
    ck_assert_uint_eq(r->ops[6].child, 1);
    const double frame[] = {2, 0.75}; /* l, s */
    ck_assert_double_eq(sg_grammar_eval(g, r->ops[0].args[0], frame, 0), 0.75);
    ck_assert_double_eq(sg_grammar_eval(g, r->ops[2].args[0], frame, 0), -30);
    ck_assert_double_eq(sg_grammar_eval(g, r->ops[3].args[0], frame, 0), 3);
    /* the anonymous draw of the second rule */
    const sg_rule *second = sg_grammar_rule(g, 1);
    ck_assert_uint_eq(second->ndraws, 1);
    ck_assert_ptr_null(second->draws[0].name);
    ck_assert_double_eq(sg_grammar_eval(g, second->ops[0].args[0], frame, 0), 0.75);
    ck_assert_uint_eq(second->nchildren, 0); /* a label outside of splits is no child */
    ck_assert_uint_eq(second->ops[1].child, SG_NONE);
    sg_grammar_free(g);
}
END_TEST

START_TEST(guards_and_weights_give_probabilities)
{
    sg_error err = SG_ERROR_INIT;
    sg_grammar *g = test_grammar(branching);
    const sg_sym x = sg_grammar_find(g, "X");
    double p[3], l = 1;
    ck_ok(sg_grammar_rule_probabilities(g, x, &l, 0, p, &err));
    ck_assert_double_eq_tol(p[0], 2.0 / 3, 1e-15);
    ck_assert_double_eq_tol(p[1], 1.0 / 3, 1e-15);
    ck_assert_double_eq(p[2], 0);
    l = 4;
    ck_ok(sg_grammar_rule_probabilities(g, x, &l, 0, p, &err));
    ck_assert_double_eq(p[2], 1);
    l = -3; /* 1 - l/3 = 2, l/3 = -1 */
    ck_assert_int_eq(sg_grammar_rule_probabilities(g, x, &l, 0, p, &err), SG_ENUMERIC);
    ck_assert_ptr_nonnull(strstr(err.msg, "weight of a rule is -1"));
    l = NAN; /* no guard holds */
    ck_assert_int_eq(sg_grammar_rule_probabilities(g, x, &l, 0, p, &err), SG_ENUMERIC);
    sg_grammar_free(g);
    g = test_grammar("start A rule A -> 0.25 : nothing -> 0.5 : nothing -> 0.25 : nothing");
    ck_assert(sg_grammar_symbol(g, 0)->constant_weights);
    ck_ok(sg_grammar_rule_probabilities(g, 0, NULL, 0, p, &err));
    ck_assert(p[0] == 0.25 && p[1] == 0.5 && p[2] == 0.25);
    sg_grammar_free(g);
    g = test_grammar("weights start A rule A -> 3 : nothing -> nothing");
    ck_assert_double_eq(sg_grammar_rule(g, 0)->probability, 0.75);
    sg_grammar_free(g);
    g = test_grammar("start A rule A -> nothing -> nothing");
    ck_assert_double_eq(sg_grammar_rule(g, 0)->probability, 0.5);
    sg_grammar_free(g);
}
END_TEST

START_TEST(splits_have_parts_and_hidden_lexical_symbols)
{
    sg_grammar *g = test_grammar("limit depth 1 label wall label sky start F "
                                 "rule F -> split y { 3.5 : wall | ~2 : F | '0.2 : sky wall | nothing }");
    const sg_rule *r = sg_grammar_rule(g, 0);
    ck_assert_int_eq(r->ops[0].kind, SG_OP_SPLIT);
    ck_assert_int_eq(r->ops[0].axis, SG_AXIS_Y);
    ck_assert_uint_eq(r->ops[0].nparts, 4);
    ck_assert_uint_eq(r->ops[0].draw, SG_NONE);
    ck_assert_uint_eq(r->ops[0].length, r->nops);
    static const sg_size_kind kinds[] = {SG_SIZE_ABSOLUTE, SG_SIZE_FLOATING, SG_SIZE_RELATIVE, SG_SIZE_FLOATING};
    static const double sizes[] = {3.5, 2, 0.2, 1};
    uint32_t at = 1;
    for (int i = 0; i < 4; i++) {
        ck_assert_int_eq(r->ops[at].kind, SG_OP_PART);
        ck_assert_int_eq(r->ops[at].size, kinds[i]);
        ck_assert_double_eq(sg_grammar_eval(g, r->ops[at].args[0], NULL, 0), sizes[i]);
        at += r->ops[at].length;
    }
    const sg_sym hidden = r->ops[2].symbol;
    const sg_symbol *s = sg_grammar_symbol(g, hidden);
    ck_assert(s->hidden && s->kind == SG_SYMBOL_NONTERMINAL);
    ck_assert_str_eq(s->name, "wall");
    ck_assert_uint_eq(s->nrules, 1);
    ck_assert_uint_eq(s->completion, s->first_rule); /* a label stays a label at the depth limit */
    const sg_op *lexical = sg_grammar_rule(g, s->first_rule)->ops;
    ck_assert_uint_eq(lexical->symbol, sg_grammar_find(g, "wall"));
    ck_assert_uint_eq(r->ops[6].symbol != hidden, 1);
    ck_assert_uint_eq(r->ops[7].symbol, hidden); /* one hidden symbol for each label */
    ck_assert_uint_eq(r->nchildren, 4);
    sg_grammar_free(g);
}
END_TEST

START_TEST(learned_sizes_are_a_draw)
{
    sg_grammar *g = test_grammar("label a label b start F rule F -> split x { a | b | a } sizes mean (0.2, 0.6, 0.2) "
                                 "covariance ((0.01, 0.001), (0.001, 0.02)) examples ((0.2, 0.6, 0.2), (0.1, 0.8, 0.1))");
    const sg_rule *r = sg_grammar_rule(g, 0);
    ck_assert_uint_eq(r->ndraws, 1);
    ck_assert_int_eq(r->draws[0].kind, SG_DRAW_SIMPLEX);
    ck_assert_uint_eq(r->nuniforms, 2);
    ck_assert_uint_eq(r->nvalues, 3);
    ck_assert_uint_eq(r->ops[0].draw, 0);
    ck_assert_int_eq(r->ops[1].size, SG_SIZE_DRAWN);
    ck_assert_uint_eq(r->nattributes, 2);
    ck_assert_double_eq(r->attributes[4], 0.8);
    ck_assert_double_eq(sg_simplex_mean(r->draws[0].simplex)[1], 0.6);
    ck_assert_double_eq(sg_simplex_covariance(r->draws[0].simplex)[3], 0.02);
    sg_grammar_free(g);
    /* standard deviations: independent normals given their sum */
    g = test_grammar("label a start F rule F -> split x { a | a } sizes mean (0.5, 0.5) sd (0.1, 0.2)");
    const double v = sg_simplex_covariance(sg_grammar_rule(g, 0)->draws[0].simplex)[0];
    ck_assert_double_eq_tol(v, 0.01 - 0.01 * 0.01 / 0.05, 1e-16);
    sg_grammar_free(g);
}
END_TEST

START_TEST(optional_successors_are_hidden_symbols)
{
    sg_error err = SG_ERROR_INIT;
    sg_grammar *g = test_grammar("label lamp start A(2) rule A(p) -> maybe(0.3) lamp maybe(p / 4) B(p) maybe(0.3) lamp "
                                 "rule B(q) -> draw(q)");
    const sg_rule *r = sg_grammar_rule(g, sg_grammar_symbol(g, sg_grammar_find(g, "A"))->first_rule);
    ck_assert_uint_eq(r->nops, 3);
    ck_assert_uint_eq(r->ops[0].symbol, r->ops[2].symbol);
    const sg_symbol *constant = sg_grammar_symbol(g, r->ops[0].symbol), *other = sg_grammar_symbol(g, r->ops[1].symbol);
    ck_assert(constant->hidden && constant->constant_weights && other->hidden && !other->constant_weights);
    ck_assert_double_eq(sg_grammar_rule(g, constant->first_rule)->probability, 0.3);
    ck_assert_double_eq(sg_grammar_rule(g, constant->first_rule + 1)->probability, 0.7);
    ck_assert_uint_eq(sg_grammar_rule(g, constant->first_rule + 1)->nops, 0);
    ck_assert_uint_eq(other->nparams, 2);
    const double frame[] = {2};
    double args[2], p[2];
    for (int i = 0; i < 2; i++)
        args[i] = sg_grammar_eval(g, r->ops[1].args[i], frame, 0);
    ck_assert_double_eq(args[0], 0.5);
    ck_assert_double_eq(args[1], 2);
    ck_ok(sg_grammar_rule_probabilities(g, r->ops[1].symbol, args, 0, p, &err));
    ck_assert(p[0] == 0.5 && p[1] == 0.5);
    args[0] = 1.5; /* a probability over 1 makes the other weight negative */
    ck_assert_int_eq(sg_grammar_rule_probabilities(g, r->ops[1].symbol, args, 0, p, &err), SG_ENUMERIC);
    sg_grammar_free(g);
}
END_TEST

START_TEST(tied_siblings_share_a_child_outside_of_repeats)
{
    static const char *const text = "%s label w start A rule A -> split x { B(1) | w | B(1) | B(2) | w } repeat x 3 { B(1) } "
                                    "rule B(n) -> draw(n)";
    char untied[300], tied[300];
    snprintf(untied, sizeof untied, text, "");
    snprintf(tied, sizeof tied, text, "tied");
    sg_error err = SG_ERROR_INIT;
    size_t n = 0;
    sg_grammar *g = test_grammar(untied);
    ck_ok(sg_rule_child_count(g, sg_grammar_rule(g, 0), NULL, 0, &n, &err));
    ck_assert_uint_eq(n, 5 + 3);
    sg_grammar_free(g);
    g = test_grammar(tied);
    ck_assert(sg_grammar_tied(g));
    const sg_rule *r = sg_grammar_rule(g, 0);
    static const uint32_t children[] = {0, 1, 0, 2, 1, 3};
    uint32_t seen = 0;
    for (uint32_t i = 0; i < r->nops; i++)
        if (r->ops[i].kind == SG_OP_SUCCESSOR)
            ck_assert_uint_eq(r->ops[i].child, children[seen++]);
    ck_assert_uint_eq(seen, 6);
    ck_ok(sg_rule_child_count(g, r, NULL, 0, &n, &err));
    ck_assert_uint_eq(n, 3 + 3);
    sg_grammar_free(g);
}
END_TEST

START_TEST(repeats_count_their_children)
{
    sg_error err = SG_ERROR_INIT;
    sg_grammar *g = test_grammar("start A(1) rule A(n) -> B repeat x n { B repeat y 2 { B } } rule B -> draw(1)");
    const sg_rule *r = sg_grammar_rule(g, 0);
    size_t n = 0;
    ck_assert(r->has_repeat);
    for (double count = 0; count < 5; count += 0.75) {
        ck_ok(sg_rule_child_count(g, r, &count, 0, &n, &err));
        ck_assert_uint_eq(n, 1 + 3 * (size_t)round(count));
    }
    static const double bad[] = {-1, NAN, INFINITY, 1e6 + 1, 4e5};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        ck_assert_int_eq(sg_rule_child_count(g, r, &bad[i], 0, &n, &err), SG_ENUMERIC);
    sg_grammar_free(g);
}
END_TEST

START_TEST(operations_and_names_do_not_clash)
{
    sg_grammar *g = test_grammar("label draw #010203 label \"rule\" start turn rule turn -> draw(1) draw turn2(2) insert(\"a b\") "
                                 "set_material(#ff8000) set_material(oak) set_label(\"rule\") components { top : draw | all : nothing } "
                                 "rule turn2(x) -> turn(x)");
    const sg_rule *r = sg_grammar_rule(g, sg_grammar_symbol(g, sg_grammar_find(g, "turn"))->first_rule);
    ck_assert_int_eq(r->ops[0].kind, SG_OP_SHAPE);
    ck_assert_uint_eq(r->ops[1].symbol, sg_grammar_find(g, "draw"));
    ck_assert_uint_eq(r->ops[3].shape, SG_SHAPE_INSERT);
    ck_assert_str_eq(sg_grammar_string(g, (uint32_t)sg_grammar_eval(g, r->ops[3].args[0], NULL, 0)), "a b");
    ck_assert_double_eq(sg_grammar_eval(g, r->ops[4].args[0], NULL, 0), 0xff8000);
    const double material = sg_grammar_eval(g, r->ops[5].args[0], NULL, 0) - SG_SHAPE_STRING_ARG;
    ck_assert_str_eq(sg_grammar_string(g, (uint32_t)material), "oak");
    ck_assert_double_eq(sg_grammar_eval(g, r->ops[6].args[0], NULL, 0), sg_grammar_find(g, "rule"));
    ck_assert_uint_eq(r->ops[7].shape, SG_SHAPE_COMPONENTS);
    ck_assert_uint_eq(r->ops[7].length, 4);
    ck_assert_int_eq(r->ops[8].kind, SG_OP_PART);
    ck_assert_uint_eq(r->ops[8].shape, SG_FACE_TOP);
    ck_assert_uint_eq(r->ops[10].shape, SG_FACE_ALL);
    sg_grammar_free(g);
}
END_TEST

/* ---- printing ---- */

static void compare_rules(const sg_grammar *g, const sg_grammar *h, sg_rule_id id, const double *frame)
{
    const sg_rule *r = sg_grammar_rule(g, id), *q = sg_grammar_rule(h, id);
    ck_assert_uint_eq(r->lhs, q->lhs);
    ck_assert_uint_eq(r->nops, q->nops);
    ck_assert_uint_eq(r->ndraws, q->ndraws);
    ck_assert_uint_eq(r->nchildren, q->nchildren);
    ck_assert(r->probability == q->probability);
    ck_assert_uint_eq(r->nattributes, q->nattributes);
    for (uint32_t i = 0; i < r->nops; i++) {
        const sg_op *a = &r->ops[i], *b = &q->ops[i];
        ck_assert(a->kind == b->kind && a->length == b->length && a->nargs == b->nargs && a->symbol == b->symbol &&
                  a->child == b->child && a->axis == b->axis && a->nparts == b->nparts && a->draw == b->draw &&
                  a->size == b->size && a->shape == b->shape);
        for (uint32_t j = 0; j < a->nargs; j++) {
            const double x = sg_grammar_eval(g, a->args[j], frame, 3), y = sg_grammar_eval(h, b->args[j], frame, 3);
            ck_assert_msg(x == y || (isnan(x) && isnan(y)), "%g %g", x, y);
        }
    }
    for (uint32_t i = 0; i < r->ndraws; i++) {
        const sg_draw *a = &r->draws[i], *b = &q->draws[i];
        ck_assert(a->kind == b->kind && a->nargs == b->nargs && a->first_value == b->first_value);
        for (uint32_t j = 0; j < a->nargs; j++)
            ck_assert(sg_grammar_eval(g, a->args[j], frame, 3) == sg_grammar_eval(h, b->args[j], frame, 3));
    }
}

/* Two grammars that should be one: the same symbols, rules, bodies, and the same values in a random frame. */
static void compare(const sg_grammar *g, const sg_grammar *h, gsl_rng *rng)
{
    ck_assert_str_eq(sg_grammar_name(g), sg_grammar_name(h));
    ck_assert_uint_eq(sg_grammar_symbol_count(g), sg_grammar_symbol_count(h));
    ck_assert_uint_eq(sg_grammar_rule_count(g), sg_grammar_rule_count(h));
    ck_assert_uint_eq(sg_grammar_start(g), sg_grammar_start(h));
    ck_assert_uint_eq(sg_grammar_depth_limit(g), sg_grammar_depth_limit(h));
    for (sg_sym s = 0; s < sg_grammar_symbol_count(g); s++) {
        const sg_symbol *a = sg_grammar_symbol(g, s), *b = sg_grammar_symbol(h, s);
        ck_assert_str_eq(a->name, b->name);
        ck_assert(a->kind == b->kind && a->hidden == b->hidden && a->nrules == b->nrules && a->color == b->color &&
                  a->completion == b->completion && a->constant_weights == b->constant_weights);
    }
    double *frame = malloc(sg_grammar_frame_size(g) * sizeof *frame);
    for (size_t i = 0; i < sg_grammar_frame_size(g); i++)
        frame[i] = gsl_rng_uniform(rng) * 4 - 1;
    for (sg_rule_id r = 0; r < sg_grammar_rule_count(g); r++)
        compare_rules(g, h, r, frame);
    free(frame);
}

enum { TEXTS_A_TEST = 80 };

START_TEST(printing_is_a_fixed_point_under_random_grammars)
{
    gsl_rng *rng = sg_random_create((uint64_t)_i);
    for (int i = 0; i < TEXTS_A_TEST; i++) {
        const random_grammar_opts opts = {1 + (unsigned)i % 9, i % 3 == 0, i % 2 == 0};
        char *text = random_grammar_text(rng, &opts);
        sg_grammar *g = test_grammar(text);
        char *once = test_print(g);
        sg_grammar *again = test_grammar(once);
        char *twice = test_print(again);
        ck_assert_msg(strcmp(once, twice) == 0, "seed %d/%d:\n%.1500s\n---\n%.1500s", _i, i, once, twice);
        compare(g, again, rng);
        sg_grammar_free(g);
        sg_grammar_free(again);
        free(text);
        free(once);
        free(twice);
    }
    gsl_rng_free(rng);
}
END_TEST

START_TEST(printed_text_is_canonical)
{
    sg_grammar *g = test_grammar("rule A->0.50:split x{~1.0:B|'.25:nothing|B()}->.5:[turn(-(30))]B rule B->draw((1+2)*3-(4-(5))) "
                                 "start A() label \"wall\" const c=-(2^-1)");
    char *text = test_print(g);
    ck_assert_str_eq(text, "const c = -2^(-1)\n"
                           "label wall\n"
                           "start A\n"
                           "rule A\n"
                           "  -> 0.5 : split x { ~1 : B | '0.25 : nothing | B }\n"
                           "  -> 0.5 : [ turn(-30) ] B\n"
                           "rule B\n"
                           "  -> draw((1 + 2) * 3 - (4 - 5))\n");
    free(text);
    sg_grammar_free(g);
}
END_TEST

START_TEST(a_graph_is_drawn_with_labels_in_their_colours)
{
    sg_error err = SG_ERROR_INIT;
    sg_grammar *g = test_grammar("label \"a \\\"b\" #ff0000 label c start S rule S -> 0.25 : split x { \"a \\\"b\" | c | c } "
                                 "-> 0.75 : split y { S | c }");
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    ck_ok(sg_grammar_print_dot(g, out, &err));
    fclose(out);
    ck_assert_ptr_nonnull(strstr(text, "label=\"a \\\"b\", shape=box, style=filled, fillcolor=\"#ff0000\""));
    ck_assert_ptr_nonnull(strstr(text, "label=\"0.25\""));
    ck_assert_ptr_nonnull(strstr(text, "label=\" (2)\"")); /* c in both rules, twice in one of them */
    ck_assert_ptr_nonnull(strstr(text, "s0 -> s0 [label=\"0.75\"]"));
    unsigned arrows = 0;
    for (const char *p = text; (p = strstr(p, "->")) != NULL; p += 2)
        arrows++;
    ck_assert_uint_eq(arrows, 3);
    free(text);
    sg_grammar_free(g);
}
END_TEST

/* The edges of a graph as "A>B:label" lines, names instead of node numbers, in their order. */
static void edges_of(const char *graph, char *edges, size_t size)
{
    char names[32][32] = {{0}};
    size_t used = 0;
    for (const char *p = graph; (p = strstr(p, "  s")) != NULL; p++) {
        unsigned a, b;
        char label[32] = "";
        if (sscanf(p, "  s%u [label=\"%31[^\"]", &a, label) == 2)
            memcpy(names[a % 32], label, sizeof label);
        else if (sscanf(p, "  s%u -> s%u [label=\"%31[^\"]", &a, &b, label) >= 2)
            used += (size_t)snprintf(edges + used, size - used, "%s>%s:%s\n", names[a % 32], names[b % 32], label);
    }
}

START_TEST(the_graph_has_an_edge_to_whatever_a_symbol_may_produce)
{
    sg_error err = SG_ERROR_INIT;
    sg_grammar *g = test_grammar("limit depth 9\nlabel t\nstart T(1)\n"
                                 "rule T(x) -> 0.25 : draw(x) [ T(x) ] T(1) L -> 0.25 : T(2) L L L -> 0.5 : maybe(0.25) L set_label(t)\n"
                                 "rule T(x) at limit -> insert(sphere)\n"
                                 "rule L -> 0.5 : split x { t | t } -> 0.5 : M(1)\n"
                                 "rule M(y) if y > 2 -> draw(y) insert(\"a.obj\")\n"
                                 "rule M(y) if y <= 2 -> insert(\"b.obj\")\n");
    char *text = NULL, edges[1000] = "";
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    ck_ok(sg_grammar_print_dot(g, out, &err));
    fclose(out);
    edges_of(text, edges, sizeof edges);
    ck_assert_str_eq(edges, "T(x)>T(x):0.5 (2)\nT(x)>L:0.5 (3)\nT(x)>maybe(0.25) L:0.5\nT(x)>draw:0.25\nT(x)>sphere:limit\n"
                            "L>M(y):0.5\nL>t:0.5 (2)\nM(y)>draw:?\nM(y)>a.obj:?\nM(y)>b.obj:?\nmaybe(0.25) L>L:0.25\n");
    const char *apart = strstr(text, "rank=sink"); /* terminals, and nothing else */
    ck_assert_ptr_nonnull(apart);
    ck_assert_ptr_nonnull(strstr(apart, "label=\"t\""));
    ck_assert_ptr_nonnull(strstr(apart, "label=\"draw\""));
    ck_assert_ptr_null(strstr(apart, "[label=\"T(x)\""));
    free(text);
    sg_grammar_free(g);
}
END_TEST

START_TEST(counts_are_of_what_is_written)
{
    sg_grammar *g = test_grammar("limit depth 9\nlabel t\nlabel w\nstart T(1)\n"
                                 "rule T(x) -> 0.5 : h ~ normal(x, 1) draw(uniform(0, 1)) [ T(h) ] -> 0.5 : maybe(0.25) L set_label(t)\n"
                                 "rule T(x) at limit -> insert(sphere)\n"
                                 "rule L -> split x { t | w | L2 } sizes mean (0.2, 0.3, 0.5) sd (0.1, 0.1, 0.1)\n"
                                 "rule L2 -> w\n");
    const sg_grammar_counts c = sg_grammar_count(g);
    ck_assert_uint_eq(c.nonterminals, 3);
    ck_assert_uint_eq(c.labels, 2);
    ck_assert_uint_eq(c.hidden, 3); /* t and w in the split, maybe */
    ck_assert_uint_eq(c.rules, 5);
    ck_assert_uint_eq(c.arguments, 1);
    ck_assert_uint_eq(c.draws, 4);
    ck_assert_uint_eq(c.operations, 3);
    ck_assert_uint_eq(c.successors, 6);
    sg_grammar_free(g);
}
END_TEST

/* ---- what is refused ---- */

static const struct {
    const char *text, *message;
} mistakes[] = {
    /* syntax: what was found, what was expected */
    {"start A\nrule A -> split x { A | \n  B ; }", "test.sg:3:5: error: unexpected character ';'\n  B ; }\n    ^"},
    {"start A\nrule A(x) -> 1 - ) : nothing", "test.sg:2:18: error: found ')'; expected an expression\nrule A(x) -> 1 - ) : nothing\n                 ^"},
    {"start A rule A -> split x { 2 A }", "test.sg:1:31: error: found 'A'; expected an operator or ':'"},
    {"grammar g\nstart A\nrule A -> ", "test.sg:3:10: error: found the end of the file; expected an expression, a successor or operation or 'nothing'"},
    {"start A rule A -> [ nothing", "found the end of the file; expected ']'"},
    {"start A foo", "found 'foo'; expected"},
    {"limit size 3", "expected 'limit depth'"},
    {"rule A -> \"unfinished\n", "the quoted name does not end on its line"},
    {"start A rule A -> \"\"", "an empty name"},
    {"label wall #ff00 \nstart A rule A -> wall", "'#ff00' is no colour"},
    {"label wall #ff00000\nstart A rule A -> wall", "'#ff00000' is no colour"},
    {"material oak\nstart A rule A -> nothing", "test.sg:2:1: error: found 'start'; expected a colour"},
    {"material oak #12 \nstart A rule A -> nothing", "'#12' is no colour"},
    {"material oak #123456\nmaterial oak #123456", "test.sg:2:10: error: material 'oak' was declared before"},
    {"const a = 3x", "'3x' is neither a number nor a name"},
    {"start A rule A -> split w { A }", "found axis 'w'; expected x, y or z"},
    {"start A rule A -> components { roof : A }", "found face 'roof'; expected front"},
    {"start A rule A -> components { top : nothing | top : nothing }", "face 'top' a second time"},
    /* numbers */
    {"const a = 1e999", "1e999 is out of the range of numbers"},
    {"const a = 1e-999", "1e-999 is too small"},
    {"const a = 1 / 0", "a constant is not finite: its value is inf"},
    {"const a = log(-1)", "a constant is not finite: its value is"},
    {"limit depth 1.5", "whole number from 0 to 1000000"},
    {"limit depth 1e9", "whole number from 0 to 1000000"},
    {"start A(0 / 0) rule A(x) -> nothing", "an argument of 'start' is not finite"},
    /* unknown names */
    {"start A\nrule A -> B", "test.sg:2:11: error: unknown name 'B'; expected a symbol that has rules or a declared label"},
    {"start A rule A -> B(1)", "unknown name 'B'; expected a symbol that has rules or a shape operation"},
    {"start A rule A -> turn", "operations take parentheses"},
    {"start A rule A -> draw(l)", "unknown name 'l' in an argument"},
    {"start A rule A -> draw(s) s ~ normal(0, 1)", "unknown name 's'"},
    {"start A rule A -> draw(foo(1))", "unknown function or distribution 'foo' in an argument"},
    {"start B rule A -> nothing", "unknown name 'B'; expected a symbol that has rules"},
    {"const a = b const b = 1", "unknown name 'b' in a constant"},
    {"function f(x) = f(x)", "unknown function or distribution 'f'"},
    {"const a = depth", "unknown name 'depth'"},
    {"start A rule A -> maybe(0.5) Q", "unknown name 'Q'"},
    {"start A rule A -> set_label(q)", "expected a label"},
    {"rule A -> nothing", "test.sg:1:18: error: the grammar has no 'start'"},
    {"", "test.sg:1:1: error: the grammar has no 'start'"},
    /* numbers of arguments */
    {"start A rule A(x) -> nothing", "A takes 1 argument, not 0"},
    {"start A(1) rule A(x) -> A(1, 2)", "A takes 1 argument, not 2"},
    {"start A rule A -> draw(1, 2)", "draw takes 1 argument, not 2"},
    {"start A rule A -> gable_roof()", "gable_roof takes 1 to 2 arguments, not 0"},
    {"start A rule A -> draw(min(1))", "min takes 2 arguments, not 1"},
    {"function f(a) = a start A rule A -> draw(f(1, 2))", "function f takes 1 argument, not 2"},
    {"start A rule A -> draw(normal(1))", "expected normal(mean, sd)"},
    {"start A rule A -> draw(mixture(1, 2, 3))", "expected mixture((weight, mean, sd), ...)"},
    {"start A rule A -> draw((1, 2))", "a tuple in an argument; expected a number"},
    {"start A rule A -> draw(#ff0000)", "a colour in an argument; expected a number"},
    {"label w start A rule A -> w(1)", "w takes 0 arguments, not 1"},
    {"start A(1) rule A(x) -> nothing rule A(x, y) -> nothing", "A has 2 parameters here and 1 in line 1"},
    /* a second time */
    {"label a\nlabel a", "test.sg:2:7: error: 'a' was declared before, in line 1"},
    {"label A start A rule A -> nothing", "'A' was declared before"},
    {"const a = 1 const a = 2", "'a' is defined a second time"},
    {"const a = 1 function a(x) = 2", "'a' is defined a second time"},
    {"function sin(x) = x", "'sin' is a function or distribution of the language"},
    {"const pi = 3", "'pi' has a meaning of its own"},
    {"start A start B", "a second 'start'"},
    {"grammar a grammar b", "a second 'grammar'"},
    {"limit depth 1 limit depth 2", "a second 'limit depth'"},
    {"tied tied", "a second 'tied'"},
    {"rule A(x, x) -> nothing", "parameter 'x' a second time"},
    {"start A(1) rule A(s) -> s ~ normal(0, 1)", "draw 's' has the name of a parameter"},
    {"start A rule A -> s ~ normal(0, 1) s ~ normal(0, 1)", "a second draw 's'"},
    {"limit depth 2 start A rule A -> nothing rule A at limit -> nothing rule A at limit -> nothing", "a second rule of 'A' at the limit"},
    {"rule turn(x) -> nothing start turn(1)", "'turn' is a shape operation"},
    /* probabilities */
    {"start A\nrule A\n  -> 0.5 : nothing\n  -> 0.4 : nothing", "test.sg:3:6: error: the probabilities of 'A' sum to 0.9, not to 1"},
    {"start A rule A -> 0.5 : nothing -> nothing", "only some rules of 'A' have a probability"},
    {"weights start A rule A -> 0 : nothing", "the weights of 'A' sum to 0"},
    {"start A rule A -> -0.5 : nothing -> 1.5 : nothing", "the weight is -0.5"},
    {"start A rule A -> 0 / 0 : nothing", "a weight is not finite"},
    {"start A rule A -> normal(0, 1) : nothing", "a random draw in a weight"},
    {"start A rule A -> maybe(1.5) A", "the probability is 1.5; expected a number from 0 to 1"},
    {"start A rule A -> draw(normal(0, 0))", "normal: the standard deviation must be greater than 0"},
    {"start A rule A -> draw(uniform(2, 1))", "uniform: low must be less than high"},
    {"start A rule A -> draw(discrete((0, 1), (0, 2)))", "all weights are zero"},
    {"start A rule A -> draw(discrete((-1, 1), (2, 2)))", "a weight is negative"},
    {"start A rule A -> s ~ sin(1)", "found 'sin'"},
    {"start A rule A -> repeat x -1 { nothing }", "the repeat count is -1"},
    {"start A rule A -> split x { -1 : nothing }", "the size is -1"},
    /* sizes */
    {"label a start A rule A -> split x { 1 : a | a } sizes mean (0.5, 0.5) sd (1, 1)", "a part with a size in a split whose sizes are drawn"},
    {"label a start A rule A -> split x { a | a } sizes mean (0.5, 0.4) sd (1, 1)", "a mean whose sizes sum to 0.9"},
    {"label a start A rule A -> split x { a | a } sizes mean (0.5, 0.3, 0.2) sd (1, 1)", "a mean with 3 sizes for a split of 2 parts"},
    {"label a start A rule A -> split x { a | a } sizes mean (0.5, 0.5)", "expected 'covariance' or 'sd'"},
    {"label a start A rule A -> split x { a | a } sizes mean (0.5, 0.5) sd (1, 0)", "standard deviation 0"},
    {"label a start A rule A -> split x { a | a | a } sizes mean (0.4, 0.4, 0.2) covariance ((1, 2), (2, 1))", "not positive definite"},
    {"label a start A rule A -> split x { a | a | a } sizes mean (0.4, 0.4, 0.2) covariance ((1, 2), (0, 1))", "not symmetric"},
    {"label a start A rule A -> split x { a | a } sizes mean (0.4, 0.6) covariance ((1, 2), (0))", "this row has 1 numbers, the first one has 2"},
    {"label a start A rule A -> split x { a | a } sizes mean (0.4, 0.6) covariance ((1, 0), (0, 1))", "a covariance of 2 rows and 2 columns; expected 1"},
    {"label a start A rule A -> split x { a | a } sizes examples ((0.4, 0.5))", "sizes that sum to 0.9"},
    {"label a start A rule A -> split x { a | a } sizes examples ((1.4, -0.4))", "size 1.4 is not between 0 and 1"},
    {"label a start A rule A -> draw(1) split x { a | a } sizes examples ((0.4, 0.6))", "bodies of exactly one split"},
    /* symbols that cannot be used */
    {"start A rule A -> nothing\nrule B -> nothing", "test.sg:2:6: error: 'B' cannot be reached from the start symbol 'A'"},
    {"start A rule A -> 0.5 : A -> 0.5 : B rule B -> A B", "'A' is unproductive"},
    {"start A rule A -> 0 : nothing -> 1 : A", "'A' is unproductive"},
    {"start A rule A -> repeat x 2 { A }", "'A' is unproductive"},
    {"start A rule A at limit -> nothing", "'A' has only a rule at the limit"},
    {"start A rule A -> nothing rule A at limit -> nothing", "a rule 'at limit' in a grammar without 'limit depth'"},
    /* what is no text */
    {"start A rule A -> \xC0\xAF", "test.sg:1:19: error: byte 0xc0 is no UTF-8"},
    {"# \xED\xA0\x80", "byte 0xed is no UTF-8"},
    {"start \x01", "control character 0x01"},
};

START_TEST(mistakes_are_named_with_their_place)
{
    sg_error err = SG_ERROR_INIT;
    const sg_status st = test_refused(mistakes[_i].text, strlen(mistakes[_i].text), &err);
    ck_assert_int_eq(st, SG_EINPUT);
    ck_assert_int_eq(err.code, SG_EINPUT);
    ck_assert_msg(strstr(err.msg, mistakes[_i].message) != NULL, "%s\n  said: %s\n  wanted: %s", mistakes[_i].text,
                  err.msg, mistakes[_i].message);
    ck_assert_msg(strncmp(err.msg, "test.sg:", 8) == 0, "%s", err.msg);
    const char *end = strrchr(err.msg, '\n');
    ck_assert_msg(end != NULL && end[strspn(end, "\n\t ")] == '^', "no caret: %s", err.msg);
}
END_TEST

START_TEST(the_caret_stands_under_the_character)
{
    sg_error err = SG_ERROR_INIT;
    const char *text = "start A\n\trule A -> tür öö";
    test_refused(text, strlen(text), &err);
    ck_assert_str_eq(err.msg, "test.sg:2:12: error: unknown name 'tür'; expected a symbol that has rules or a declared "
                              "label\n\trule A -> tür öö\n\t          ^");
    /* of a very long line a part is shown */
    enum { LONG = 100000 };
    char *line = malloc(LONG + 50);
    memset(line, ' ', LONG);
    strcpy(line + LONG, "rule A -> ) # and more");
    test_refused(line, strlen(line), &err);
    ck_assert_ptr_nonnull(strstr(err.msg, "test.sg:1:100011: error: found ')'"));
    const char *shown = strchr(err.msg, '\n') + 1, *caret = strrchr(err.msg, '\n') + 1;
    ck_assert_int_eq(shown[strcspn(caret, "^")], ')');
    free(line);
}
END_TEST

START_TEST(absurd_nesting_is_refused)
{
    static const struct {
        const char *begin, *again, *end;
    } kinds[] = {{"start A rule A -> ", "[ ", ""},      {"const a = ", "(", "1"},        {"const a = ", "- ", "1"},
                 {"const a = ", "not ", "1"},           {"const a = 1", " ^ 1", ""},     {"const a = 1", " + 1", ""},
                 {"start A rule A -> ", "split x { ", ""}, {"const a = ", "if(1, 2, ", ""}, {"start A rule A -> ", "repeat x 1 { ", ""}};
    enum { TIMES = 10000 };
    char *text = malloc(20 * TIMES);
    size_t n = (size_t)sprintf(text, "%s", kinds[_i].begin);
    for (int i = 0; i < TIMES; i++)
        n += (size_t)sprintf(text + n, "%s", kinds[_i].again);
    sprintf(text + n, "%s", kinds[_i].end);
    sg_error err = SG_ERROR_INIT;
    ck_assert_int_eq(test_refused(text, strlen(text), &err), SG_EINPUT);
    ck_assert_msg(strstr(err.msg, "deep") != NULL || strstr(err.msg, "levels") != NULL, "%s", err.msg);
    free(text);
}
END_TEST

START_TEST(nesting_within_the_limits_is_taken)
{
    char text[4000] = "start A rule A -> ";
    for (int i = 0; i < 250; i++)
        strcat(text, "[");
    strcat(text, "draw(");
    for (int i = 0; i < 200; i++)
        strcat(text, "-");
    strcat(text, "1)");
    for (int i = 0; i < 250; i++)
        strcat(text, "]");
    sg_grammar *g = test_grammar(text);
    ck_assert_uint_eq(sg_grammar_rule(g, 0)->nops, 251);
    sg_grammar_free(g);
}
END_TEST

START_TEST(functions_that_explode_are_refused)
{
    char text[4000] = "start A rule A -> nothing function f0(x) = x + x ";
    for (int i = 1; i < 60; i++) {
        char line[60];
        snprintf(line, sizeof line, "function f%d(x) = f%d(x) + f%d(x) ", i, i - 1, i - 1);
        strcat(text, line);
    }
    sg_error err = SG_ERROR_INIT;
    ck_assert_int_eq(test_refused(text, strlen(text), &err), SG_EINPUT);
    ck_assert_ptr_nonnull(strstr(err.msg, "too large once its functions are inlined"));
}
END_TEST

START_TEST(files_too_large_and_missing_are_refused)
{
    sg_error err = SG_ERROR_INIT;
    sg_grammar *g = NULL;
    ck_assert_int_eq(sg_grammar_load("/no/such/file.sg", &g, &err), SG_EINPUT);
    ck_assert_ptr_nonnull(strstr(err.msg, "/no/such/file.sg"));
    char path[] = "/tmp/sg-test-XXXXXX";
    const int fd = mkstemp(path);
    ck_assert_int_ge(fd, 0);
    ck_assert_int_eq(ftruncate(fd, (off_t)100 << 20), 0);
    close(fd);
    ck_assert_int_eq(sg_grammar_load(path, &g, &err), SG_EINPUT);
    ck_assert_ptr_nonnull(strstr(err.msg, "larger than"));
    ck_assert_ptr_null(g);
    unlink(path);
}
END_TEST

/* Texts with a few bytes changed, cut or doubled: a grammar or a sentence, never a crash, never a hang. */
START_TEST(damaged_texts_are_read_or_refused)
{
    gsl_rng *rng = sg_random_create(1000 + (uint64_t)_i);
    unsigned refused = 0;
    for (int i = 0; i < 150; i++) {
        const random_grammar_opts opts = {4, false, true};
        char *text = random_grammar_text(rng, &opts);
        size_t n = strlen(text);
        for (unsigned k = 1 + (unsigned)gsl_rng_uniform_int(rng, 4); k > 0 && n > 1; k--) {
            const size_t at = gsl_rng_uniform_int(rng, n);
            const size_t length = gsl_rng_uniform_int(rng, n - at < 20 ? n - at : 20);
            switch (gsl_rng_uniform_int(rng, 3)) {
            case 0:
                text[at] = (char)gsl_rng_uniform_int(rng, 256);
                break;
            case 1:
                memmove(text + at, text + at + length, n - at - length);
                n -= length;
                break;
            default:
                text[at] = "(){}[]|~'-\"\\#:,.>0"[gsl_rng_uniform_int(rng, 18)];
            }
        }
        sg_error err = SG_ERROR_INIT;
        sg_grammar *g = NULL;
        const sg_status st = sg_grammar_parse(text, n, "test.sg", &g, &err);
        ck_assert((st == SG_OK && g != NULL) || (st == SG_EINPUT && g == NULL && err.msg[0] != '\0'));
        refused += st != SG_OK;
        if (g != NULL)
            free(test_print(g));
        sg_grammar_free(g);
        free(text);
    }
    ck_assert_uint_gt(refused, 50);
    gsl_rng_free(rng);
}
END_TEST

START_TEST(writing_to_a_full_disk_is_an_error)
{
    sg_error err = SG_ERROR_INIT;
    FILE *full = fopen("/dev/full", "w");
    if (full == NULL)
        return;
    setvbuf(full, NULL, _IONBF, 0);
    sg_grammar *g = test_grammar(branching);
    ck_assert_int_eq(sg_grammar_print(g, full, &err), SG_EIO);
    ck_assert_int_eq(sg_grammar_print_dot(g, full, &err), SG_EIO);
    fclose(full);
    sg_grammar_free(g);
}
END_TEST

#define COUNT(array) ((int)(sizeof(array) / sizeof *(array)))

int main(void)
{
    Suite *suite = suite_create("grammar");
    TCase *tc = tcase_create("grammar");
    tcase_set_timeout(tc, 120);
    tcase_add_loop_test(tc, expressions_have_their_values, 0, COUNT(expressions));
    tcase_add_loop_test(tc, random_expressions_agree_with_their_trees, 0, 200);
    tcase_add_test(tc, numbers_are_read_and_printed_exactly);
    tcase_add_test(tc, a_grammar_has_what_its_text_says);
    tcase_add_test(tc, a_body_is_flat_and_in_order);
    tcase_add_test(tc, guards_and_weights_give_probabilities);
    tcase_add_test(tc, splits_have_parts_and_hidden_lexical_symbols);
    tcase_add_test(tc, learned_sizes_are_a_draw);
    tcase_add_test(tc, optional_successors_are_hidden_symbols);
    tcase_add_test(tc, tied_siblings_share_a_child_outside_of_repeats);
    tcase_add_test(tc, repeats_count_their_children);
    tcase_add_test(tc, operations_and_names_do_not_clash);
    tcase_add_loop_test(tc, printing_is_a_fixed_point_under_random_grammars, 0, 30);
    tcase_add_test(tc, printed_text_is_canonical);
    tcase_add_test(tc, a_graph_is_drawn_with_labels_in_their_colours);
    tcase_add_test(tc, the_graph_has_an_edge_to_whatever_a_symbol_may_produce);
    tcase_add_test(tc, counts_are_of_what_is_written);
    tcase_add_loop_test(tc, mistakes_are_named_with_their_place, 0, COUNT(mistakes));
    tcase_add_test(tc, the_caret_stands_under_the_character);
    tcase_add_loop_test(tc, absurd_nesting_is_refused, 0, 9);
    tcase_add_test(tc, nesting_within_the_limits_is_taken);
    tcase_add_test(tc, functions_that_explode_are_refused);
    tcase_add_test(tc, files_too_large_and_missing_are_refused);
    tcase_add_loop_test(tc, damaged_texts_are_read_or_refused, 0, 20);
    tcase_add_test(tc, writing_to_a_full_disk_is_an_error);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
