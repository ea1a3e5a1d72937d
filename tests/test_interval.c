/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_interval.c - intervals hold every value that operators, code and whole derivations make of what is in them. */
#include "derivation/derivation.h"
#include "grammar/build_range_priv.h"
#include "tests/grammar_support.h"
#include "tests/random_grammar.h"

#include <float.h>

/* ---- operators ---- */

static double special(gsl_rng *rng)
{
    static const double some[] = {0, -0.0, 1, -1, 0.5, -0.5, 2, -2, 3, 10, -7, 1e-300, -1e-300, 1e300, -1e300,
                                  INFINITY, -INFINITY, DBL_MIN, DBL_MAX, -DBL_MAX, 0x1p53, 1.5707963267948966};
    if (gsl_rng_uniform(rng) < 0.6)
        return some[gsl_rng_uniform_int(rng, sizeof some / sizeof *some)];
    return (gsl_rng_uniform(rng) * 2 - 1) * pow(10, gsl_rng_uniform(rng) * 4 - 2);
}

static sg_interval random_interval(gsl_rng *rng)
{
    if (gsl_rng_uniform(rng) < 0.05)
        return sg_interval_point(NAN);
    const double a = special(rng), b = gsl_rng_uniform(rng) < 0.3 ? a : special(rng);
    return (sg_interval){fmin(a, b), fmax(a, b), gsl_rng_uniform(rng) < 0.1};
}

/* Ends, NaN and zeros of either sign come often. */
static double value_in(gsl_rng *rng, sg_interval x)
{
    const double u = gsl_rng_uniform(rng);
    if (x.nan && (u < 0.2 || !sg_interval_has_number(x)))
        return NAN;
    if (u < 0.4)
        return x.low;
    if (u < 0.6)
        return x.high;
    if (u < 0.7 && sg_interval_contains(x, 0))
        return u < 0.65 ? 0 : -0.0;
    const double low = fmax(x.low, -1e308), high = fmin(x.high, 1e308);
    const double v = low / 2 + high / 2 + (gsl_rng_uniform(rng) - 0.5) * (high / 1 - low);
    const double near = x.low + (isfinite(x.low) ? gsl_rng_uniform(rng) * 3 : 0); /* what is of everyday size */
    return sg_interval_contains(x, near) && !isnan(near) && u < 0.85 ? near : fmin(fmax(v, x.low), x.high);
}

START_TEST(operators_stay_inside)
{
    gsl_rng *rng = sg_random_create(1);
    const sg_operator op = (sg_operator)_i;
    size_t points = 0;
    for (int k = 0; k < 4000; k++) {
        const sg_interval x[3] = {random_interval(rng), random_interval(rng), random_interval(rng)};
        const sg_interval r = sg_interval_apply(op, x[0], x[1], x[2]);
        points += r.low == r.high;
        for (int j = 0; j < 20; j++) {
            const double v[3] = {value_in(rng, x[0]), value_in(rng, x[1]), value_in(rng, x[2])};
            const double y = sg_operator_apply(op, v[0], v[1], v[2]);
            if (!sg_interval_contains(r, y))
                ck_abort_msg("%s of [%g, %g] and [%g, %g] is [%.17g, %.17g], which lacks %.17g from %.17g and %.17g",
                             sg_operator_get(op)->name, x[0].low, x[0].high, x[1].low, x[1].high, r.low, r.high, y, v[0],
                             v[1]);
        }
    }
    ck_assert_uint_gt(points, 0);
    gsl_rng_free(rng);
}
END_TEST

static const struct {
    sg_operator op;
    sg_interval a, b, wanted;
} narrow[] = {
    {SG_E_ADD, {1, 2, false}, {10, 20, false}, {11, 22, false}},
    {SG_E_SUB, {1, 2, false}, {10, 20, false}, {-19, -8, false}},
    {SG_E_MUL, {-1, 2, false}, {-3, 4, false}, {-6, 8, false}},
    {SG_E_MUL, {0, 1, false}, {0, INFINITY, false}, {0, INFINITY, true}},
    {SG_E_DIV, {1, 2, false}, {4, 8, false}, {0.125, 0.5, false}},
    {SG_E_DIV, {1, INFINITY, false}, {1, INFINITY, false}, {0, INFINITY, true}},
    {SG_E_ADD, {-INFINITY, 0, false}, {0, INFINITY, false}, {-INFINITY, INFINITY, true}},
    {SG_E_ABS, {-3, 2, false}, {0, 0, false}, {0, 3, false}},
    {SG_E_SQRT, {-1, 4, false}, {0, 0, false}, {0, 2, true}},
    {SG_E_SQRT, {-2, -1, false}, {0, 0, false}, {INFINITY, -INFINITY, true}},
    {SG_E_MIN, {1, 5, false}, {2, 3, false}, {1, 3, false}},
    {SG_E_ROUND, {0.4, 2.6, false}, {0, 0, false}, {0, 3, false}},
    {SG_E_LT, {0, 1, false}, {2, 3, false}, {1, 1, false}},
    {SG_E_LT, {0, 1, true}, {2, 3, false}, {0, 1, false}},
    {SG_E_LT, {2, 3, true}, {0, 2, false}, {0, 0, false}},
    {SG_E_LE, {2, 3, false}, {0, 2, false}, {0, 1, false}},
    {SG_E_EQ, {2, 3, false}, {4, 5, false}, {0, 0, false}},
    {SG_E_NE, {2, 3, true}, {4, 5, false}, {1, 1, false}},
    {SG_E_AND, {0, 0, false}, {0, 1, false}, {0, 0, false}},
    {SG_E_OR, {1, 2, false}, {0, 1, false}, {1, 1, false}},
};

START_TEST(operators_are_no_wider_than_they_must)
{
    const sg_interval r = sg_interval_apply(narrow[_i].op, narrow[_i].a, narrow[_i].b, sg_interval_none());
    ck_assert_msg(r.low == narrow[_i].wanted.low && r.high == narrow[_i].wanted.high && r.nan == narrow[_i].wanted.nan,
                  "[%g, %g] %d", r.low, r.high, r.nan);
}
END_TEST

/* ---- ranges ---- */

typedef struct {
    sg_grammar *g;
    sg_arena *arena;
    sg_builder b;
    sg_ranges w;
    sg_error err;
} ranges;

static void find_ranges(ranges *r, const char *text)
{
    memset(r, 0, sizeof *r);
    r->g = test_grammar(text);
    r->arena = sg_arena_create();
    r->b.err = &r->err;
    sg_error err = SG_ERROR_INIT;
    ck_ok(sg_ranges_find(&r->w, &r->b, r->g, r->arena));
}

static void clear_ranges(ranges *r)
{
    sg_ranges_clear(&r->w);
    sg_arena_free(r->arena);
    sg_grammar_free(r->g);
}

static const struct {
    const char *text;
    double low, high; /* of the first parameter of X */
} parameters[] = {
    {"start X(2) rule X(x) -> nothing", 2, 2},
    {"start S rule S -> X(1) X(3) rule X(x) -> nothing", 1, 3},
    {"start S rule S -> u ~ uniform(0, 2) X(u + 1) rule X(x) -> nothing", 1, 3},
    {"start S rule S -> X(truncated_normal(0, 1, -1, 4)) rule X(x) -> nothing", -1, 4},
    {"start S rule S -> X(discrete((1, 2), (0, 9), (3, 5))) rule X(x) -> nothing", 2, 5},
    {"start S rule S -> X(normal(0, 1)) rule X(x) -> nothing", -INFINITY, INFINITY},
    {"start S rule S -> u ~ uniform(-1, 4) X(sqrt(u)) rule X(x) -> nothing", 0, 2},
    /* guards bound what counts, whichever way the bound is written, however long it takes to get there */
    {"start X(0) rule X(x) if x < 5 -> X(x + 1) rule X(x) if x >= 5 -> nothing", 0, 6},
    {"start X(0) rule X(x) if x <= 1000 -> X(x + 1) rule X(x) if not x <= 1000 -> nothing", 0, 1001},
    {"function small(x) = 0 <= x and 100 > x start X(64) rule X(x) if small(x) -> X(x / 2 - 1) "
     "rule X(x) if not small(x) -> nothing",
     -1, 64},
    {"start X(0) rule X(x) if x <= 5 or false -> X(x + 1) rule X(x) if x > 5 -> nothing", 0, 6},
    {"start X(3) rule X(x) if x == 3 -> X(x + 1) rule X(x) if x != 3 -> nothing", 3, 4},
    {"limit depth 7 start X(0) rule X(x) -> X(depth)", 0, 7},
    {"limit depth 7 start S rule S -> S rule S at limit -> X(depth) rule X(x) -> nothing", 8, 8},
    /* rules that are never used pass nothing on */
    {"start S rule S -> T(1) X(1) rule T(t) if t > 0 -> nothing rule T(t) if t < 0 -> X(7) rule X(x) -> nothing", 1, 1},
    {"weights start S rule S -> 1 : X(1) -> 0 : X(9) rule X(x) -> nothing", 1, 1},
    {"start X(1) rule X(x) -> 0.5 : X(2 * x) -> 0.5 : nothing", 1, INFINITY},
};

/* The largest number below 5 is nearly 5. */
static bool is_near(double a, double b)
{
    return a == b || fabs(a - b) <= 1e-12 * fabs(b);
}

START_TEST(parameters_have_their_ranges)
{
    ranges r;
    find_ranges(&r, parameters[_i].text);
    const sg_interval x = r.w.ranges[sg_grammar_find(r.g, "X")].params[0];
    ck_assert_msg(is_near(x.low, parameters[_i].low) && is_near(x.high, parameters[_i].high) && !x.nan,
                  "%s: [%.17g, %.17g] %d", parameters[_i].text, x.low, x.high, x.nan);
    clear_ranges(&r);
}
END_TEST

static void check_node(const ranges *r, const sg_derivation *d, size_t node, const char *text)
{
    const sg_node *n = d->nodes + node;
    const sg_range *range = &r->w.ranges[n->symbol];
    if (!range->reached || !sg_interval_contains(range->depth, n->depth))
        ck_abort_msg("node %zu at depth %u\n%s", node, n->depth, text);
    for (uint32_t i = 0; i < sg_grammar_symbol(r->g, n->symbol)->nparams; i++)
        if (!sg_interval_contains(range->params[i], d->values[n->values + i]))
            ck_abort_msg("%s: parameter %u is %.17g, not in [%.17g, %.17g]\n%s", sg_grammar_symbol(r->g, n->symbol)->name, i,
                         d->values[n->values + i], range->params[i].low, range->params[i].high, text);
}

/* A rule that is used is one that can be used, and its draws are where they can be. */
static void check_rule(ranges *r, const sg_derivation *d, size_t node, const char *text)
{
    const sg_node *n = d->nodes + node;
    if (n->rule == SG_RULE_EMPTY)
        return;
    const sg_rule *rule = sg_grammar_rule(r->g, n->rule);
    if (!sg_ranges_use(&r->w, n->symbol, n->rule))
        ck_abort_msg("node %zu uses a rule that cannot be used\n%s", node, text);
    const uint32_t end = sg_grammar_symbol(r->g, n->symbol)->nparams + rule->nvalues;
    for (uint32_t i = 0; i < end; i++)
        if (!sg_interval_contains(r->w.f.slots[i], d->values[n->values + i]))
            ck_abort_msg("slot %u is %.17g, not in [%.17g, %.17g]\n%s", i, d->values[n->values + i], r->w.f.slots[i].low,
                         r->w.f.slots[i].high, text);
}

START_TEST(derivations_stay_inside)
{
    gsl_rng *rng = sg_random_create((uint64_t)_i);
    random_grammar_opts opts = RANDOM_GRAMMAR_OPTS_INIT;
    opts.derivable = _i % 4 != 0;
    opts.strange_layout = false;
    char *text = random_grammar_text(rng, &opts);
    ranges r;
    find_ranges(&r, text);
    sg_derivation d;
    sg_derivation_init(&d, r.g);
    for (int k = 0; k < 20; k++) {
        if (sg_derivation_sample(&d, rng, 20000, NULL) != SG_OK)
            continue;
        for (size_t i = 0; i < d.nnodes; i++) {
            check_node(&r, &d, i, text);
            check_rule(&r, &d, i, text);
        }
    }
    sg_derivation_clear(&d);
    clear_ranges(&r);
    free(text);
    gsl_rng_free(rng);
}
END_TEST

#define COUNT(array) ((int)(sizeof(array) / sizeof *(array)))

int main(void)
{
    Suite *suite = suite_create("interval");
    TCase *tc = tcase_create("interval");
    tcase_set_timeout(tc, 120);
    tcase_add_loop_test(tc, operators_stay_inside, 0, SG_E_COUNT);
    tcase_add_loop_test(tc, operators_are_no_wider_than_they_must, 0, COUNT(narrow));
    tcase_add_loop_test(tc, parameters_have_their_ranges, 0, COUNT(parameters));
    tcase_add_loop_test(tc, derivations_stay_inside, 0, 200);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
