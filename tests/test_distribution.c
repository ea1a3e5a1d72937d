/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_distribution.c - draws as maps from uniforms: inverses, densities as Jacobians, tails. Sizes: test_simplex.c. */
#include "grammar/distribution.h"

#include "grammar/normal.h"
#include "grammar/truncated.h"
#include "tests/grammar_support.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_integration.h>
#include <gsl/gsl_randist.h>

/* ---- the standard normal ---- */

START_TEST(tails_of_the_normal_are_those_of_the_library)
{
    for (double x = 0; x < 40; x += 1e-3) {
        const double want = gsl_cdf_ugaussian_Q(x);
        ck_assert_msg(fabs(sg_normal_above(x) - want) <= (x < 2 ? 3e-16 : 6e-17), "above %g: %.17g, not %.17g", x, sg_normal_above(x), want);
    }
    ck_assert_double_eq(sg_normal_above(INFINITY), 0);
}
END_TEST

/* Masses from almost nothing to 1/2, and the same on the other side. */
START_TEST(quantiles_of_the_normal_are_those_of_the_library)
{
    for (double tail = 0.5; tail > 1e-300; tail *= 0.99) {
        const double want = gsl_cdf_ugaussian_Pinv(tail), got = sg_normal_quantile(tail, 1 - tail);
        ck_assert_msg(fabs(got - want) <= 2e-15 * fabs(want) + 2e-16, "below %g: %.17g, not %.17g", tail, got, want);
        ck_assert_double_eq_tol(sg_normal_quantile(1 - tail, tail), -got, 2e-15);
        /* Rounding z moves the mass by z^2 ulps. */
        const double back = gsl_cdf_ugaussian_P(got);
        ck_assert_msg(fabs(back - tail) <= tail * 1e-15 * (1 + got * got), "below %g: back %.17g", tail, back);
    }
}
END_TEST

START_TEST(quantiles_of_the_normal_rise)
{
    gsl_rng *rng = sg_random_create((uint64_t)_i);
    for (int i = 0; i < 100000; i++) {
        const double p = sg_random_uniform(rng), q = p + 1e-3 * (1 - p) * sg_random_uniform(rng);
        ck_assert_double_le(sg_normal_quantile(p, 1 - p), sg_normal_quantile(q, 1 - q) + 4e-16);
    }
    const double seams[] = {0.075, exp(-25)}; /* where one approximation ends and the other begins */
    for (int i = 0; i < 2; i++) {
        const double low = seams[i] * (1 - 1e-9), high = seams[i] * (1 + 1e-9);
        ck_assert_double_lt(sg_normal_quantile(low, 1 - low), sg_normal_quantile(high, 1 - high));
        ck_assert_double_gt(sg_normal_quantile(1 - low, low), sg_normal_quantile(1 - high, high));
    }
    gsl_rng_free(rng);
}
END_TEST

/* Quantiles and log densities there, from 120-digit arithmetic. */
static const struct {
    double mean, sd, low, high, u, x, log_density;
} truncated[] = {
    {0.3, 0.1, 0, 1, 0.0625, 0.14760894545701326, 0.22384569451922482},
    {0.3, 0.1, 0, 1, 0.5, 0.30016918470924807, 1.3849959385821105},
    {0.3, 0.1, 0, 1, 0.984375, 0.51544127740873851, -0.93574983082004746},
    {0.3, 0.1, 0, 1, 1e-12, 2.2533489614389644e-11, -3.1150026295685919},
    {0.3, 0.01, 0, 1, 0.0625, 0.28465879455647453, 2.5094687304811422},
    {0.3, 0.01, 0, 1, 0.5, 0.29999999999999999, 3.6862316527834186},
    {0.3, 0.01, 0, 1, 0.984375, 0.32153874694061455, 1.3666435539242483},
    {0.3, 0.01, 0, 1, 1e-12, 0.22965516174698867, -21.055749691428209},
    {-1, 0.1, 0, 1, 0.0625, 0.000638915701092318, 4.5510197295289565},
    {-1, 0.1, 0, 1, 0.5, 0.0068411836081429412, 3.9284732598295332},
    {-1, 0.1, 0, 1, 0.984375, 0.040384732253111938, 0.49491215503287281},
    {-1, 0.1, 0, 1, 1e-12, 9.9028596471780964e-15, 4.6149317103008531},
    {-1, 0.01, 0, 1, 0.0625, 6.4531861044213874e-6, 9.1459082777262388},
    {-1, 0.01, 0, 1, 0.5, 6.9305387524294144e-5, 8.5173624555618663},
    {-1, 0.01, 0, 1, 0.984375, 0.00041576032092795613, 5.0519728544866555},
    {-1, 0.01, 0, 1, 1e-12, 9.9990002998551041e-17, 9.2104403469875073},
    {2, 0.1, 0, 1, 0.0625, 0.9729036079508249, 1.8685817822802003},
    {2, 0.1, 0, 1, 0.5, 0.99315881639185706, 3.9284732598295375},
    {2, 0.1, 0, 1, 0.984375, 0.99984405815836877, 4.5993363102458191},
    {2, 0.1, 0, 1, 1e-12, 0.75568620587856937, -22.800909201741654},
    {2, 0.01, 0, 0.5, 0.0625, 0.49981518035092234, 6.8433843919129281},
    {2, 0.01, 0, 0.5, 0.5, 0.49995379295309213, 8.9227335405173807},
    {2, 0.01, 0, 0.5, 0.984375, 0.49999895015655839, 9.6001022624563701},
    {2, 0.01, 0, 0.5, 1e-12, 0.49815914326854115, -18.01394481981978},
    {0.5, 10, 0, 1, 0.0625, 0.06254273720950977, -0.00054024705610636534},
    {0.5, 10, 0, 1, 0.5, 0.5, 0.00041659722773437479},
    {0.5, 10, 0, 1, 0.984375, 0.98436257761892758, -0.00075643830525388322},
    {0.5, 10, 0, 1, 1e-12, 1.0008337501488483e-12, -0.00083340277226062104},
    {0.5, 1e-06, 0, 1, 0.0625, 0.49999846587945565, 11.719809102419019},
    {0.5, 1e-06, 0, 1, 0.5, 0.5, 12.896572024759601},
    {0.5, 1e-06, 0, 1, 0.984375, 0.50000215387469406, 10.576983925937699},
    {0.5, 1e-06, 0, 1, 1e-12, 0.4999929655161747, -11.845409319264652},
    {-50, 0.5, 0, 1, 0.0625, 0.00032265930522106936, 5.2338852722980928},
    {-50, 0.5, 0, 1, 0.5, 0.0034652693762147071, 4.6053394501337203},
    {-50, 0.5, 0, 1, 0.984375, 0.020788016046397806, 1.1399498490585096},
    {-50, 0.5, 0, 1, 1e-12, 4.9995001499275519e-15, 5.2984173415593613},
    {0, 1, 0, 1e-09, 0.0625, 6.2500000000000004e-11, 20.723265836946411},
    {0, 1, 0, 1e-09, 0.5, 5.0000000000000003e-10, 20.723265836946411},
    {0, 1, 0, 1e-09, 0.984375, 9.8437500000000006e-10, 20.723265836946411},
    {0, 1, 0, 1e-09, 1e-12, 1.0e-21, 20.723265836946411},
    {0.5, 0.1, 0.499999999999, 0.500000000001, 0.0625, 0.49999999999912502, 26.937896057333413},
    {0.5, 0.1, 0.499999999999, 0.500000000001, 0.5, 0.5, 26.937896057333413},
    {0.5, 0.1, 0.499999999999, 0.500000000001, 0.984375, 0.50000000000096873, 26.937896057333413},
    {0.5, 0.1, 0.499999999999, 0.500000000001, 1e-12, 0.49999999999900002, 26.937896057333413},
    {-0.001, 0.01, 0, 1, 0.0625, 0.0007278197589548925, 4.4474594399165172},
    {-0.001, 0.01, 0, 1, 0.5, 0.0063856338831951851, 4.189648306230688},
    {-0.001, 0.01, 0, 1, 0.984375, 0.023476185700924248, 1.4669679131830486},
    {-0.001, 0.01, 0, 1, 1e-12, 1.1592623996188035e-14, 4.457386245513576},
    {3, 0.001, 0, 1, 0.0625, 0.99999861370646591, 11.736069959463097},
    {3, 0.001, 0, 1, 0.5, 0.99999965342652639, 13.81551098129477},
    {3, 0.001, 0, 1, 0.984375, 0.9999999921258235, 14.492909635427003},
    {3, 0.001, 0, 1, 1e-12, 0.99998618454061262, -13.122356219714168},
    {0, 1, -8, 8, 0.0625, -1.5341205443525419, -2.0957014555069412},
    {0, 1, -8, 8, 0.5, -3.0980735318794546e-120, -0.9189385332046715},
    {0, 1, -8, 8, 0.984375, 2.1538746940614408, -3.2385266320638042},
    {0, 1, -8, 8, 1e-12, -7.0343971049796455, -25.660309848477681},
    {0, 1, 6, 40, 0.0625, 6.0104709258450496, 1.754950041555711},
    {0, 1, 6, 40, 0.5, 6.1115650618134393, 1.1422166643806783},
    {0, 1, 6, 40, 0.984375, 6.6425468394018439, -2.2438838400536827},
    {0, 1, 6, 40, 1e-12, 6.0000000000001624, 1.8178304167690577},
    {0, 1, -40, -6, 0.0625, -6.4351844780462883, -0.88796921647390739},
    {0, 1, -40, -6, 0.5, -6.1115650618134393, 1.1422166643806783},
    {0, 1, -40, -6, 0.984375, -6.0025566634013402, 1.8024871680981172},
    {0, 1, -40, -6, 1e-12, -9.5064302807048307, -25.368277924180823},
};

START_TEST(truncated_normals_are_exact_in_their_tails)
{
    const double mean = truncated[_i].mean, sd = truncated[_i].sd, low = truncated[_i].low, high = truncated[_i].high;
    const double u = truncated[_i].u, x = truncated[_i].x, log_density = truncated[_i].log_density;
    const double got = sg_truncated_quantile(mean, sd, low, high, u);
    /* Relative to the nearer end, up to rounding of the ends, and of 1 - u. */
    const double tolerance = 1e-9 * fmin(x - low, high - x) + 4e-16 * fmax(fabs(low), fabs(high)) + 4e-16 / exp(log_density);
    ck_assert_msg(fabs(got - x) <= tolerance, "quantile %.17g, not %.17g", got, x);
    const double density = sg_truncated_log_density(mean, sd, low, high, x);
    const double slope = fabs(x - mean) / (sd * sd) * 4e-16 * fmax(fabs(low), fabs(high)); /* of x being rounded */
    ck_assert_msg(fabs(density - log_density) <= 1e-11 * (1 + fabs(log_density)) + slope, "log density %.17g, not %.17g",
                  density, log_density);
    const double back = sg_truncated_cdf(mean, sd, low, high, x);
    ck_assert_msg(fabs(back - u) <= 1e-9 * u + 1e-15 + exp(log_density) * 4e-16 * fmax(fabs(low), fabs(high)), "cdf %.17g, not %.17g",
                  back, u);
}
END_TEST

START_TEST(truncated_normals_hold_in_impossible_places)
{
    gsl_rng *rng = sg_random_create((uint64_t)_i);
    for (int i = 0; i < 2000; i++) {
        const double low = gsl_ran_gaussian(rng, 1), high = low + pow(10, -6 * gsl_rng_uniform(rng));
        const double sd = pow(10, 8 * gsl_rng_uniform(rng) - 6);
        const double mean = low + gsl_ran_gaussian(rng, 1) * pow(10, 3 * gsl_rng_uniform(rng) - 1);
        const double u = sg_random_uniform(rng), v = sg_random_uniform(rng);
        const double x = sg_truncated_quantile(mean, sd, low, high, u), y = sg_truncated_quantile(mean, sd, low, high, v);
        ck_assert_msg(x >= low && x <= high, "%.17g outside (%.17g, %.17g), mean %.17g sd %.17g u %.17g", x, low, high, mean, sd, u);
        ck_assert_msg((u < v) ? x <= y : x >= y, "not monotone: mean %.17g sd %.17g low %.17g high %.17g", mean, sd, low, high);
        const double log_density = sg_truncated_log_density(mean, sd, low, high, x);
        ck_assert(isfinite(log_density));
        const double rounding = exp(fmin(log_density, 40)) * 4e-16 * (fabs(low) + fabs(high));
        ck_assert_msg(fabs(sg_truncated_cdf(mean, sd, low, high, x) - u) <= 1e-9 + 4 * rounding,
                      "mean %.17g sd %.17g low %.17g high %.17g u %.17g", mean, sd, low, high, u);
    }
    ck_assert(isinf(sg_truncated_log_density(0, 1, 0, 1, 1.1)));
    ck_assert_double_eq(sg_truncated_cdf(0, 1, 0, 1, -1), 0);
    ck_assert_double_eq(sg_truncated_cdf(0, 1, 0, 1, 2), 1);
    gsl_rng_free(rng);
}
END_TEST

/* ---- the draws of a rule ---- */

static const char *const draws[] = {
    "uniform(-1, 2 + m)", "normal(m, 0.3)", "truncated_normal(m, 0.5, 0, 2)", "truncated_normal(-5, m, 0, 2)",
    "mixture((1, m, 0.1), (2, -1, 0.5), (0, 9, 1), (0.5, 3, m))", "discrete((1, 4), (2, m), (0, 7), (0.5, -1), (1, 4))",
};

typedef struct {
    sg_grammar *g;
    const sg_draw *d;
    double frame[2];
} drawn;

static drawn open_draw(int i)
{
    char text[300];
    snprintf(text, sizeof text, "rule A(m) -> s ~ %s draw(s) start B rule B -> m ~ normal(0, 1) A(m)", draws[i]);
    drawn t = {test_grammar(text), NULL, {0.75, 0}};
    t.d = &sg_grammar_rule(t.g, 0)->draws[0];
    return t;
}

START_TEST(draws_go_back_to_their_uniforms)
{
    sg_error err = SG_ERROR_INIT;
    drawn t = open_draw(_i);
    gsl_rng *rng = sg_random_create(3);
    for (int i = 0; i < 2000; i++) {
        const double u[2] = {sg_random_uniform(rng), sg_random_uniform(rng)};
        double value, back[2], again, density;
        ck_ok(sg_draw_transform(t.g, t.d, t.frame, 0, u, &value, &err));
        ck_ok(sg_draw_log_density(t.g, t.d, t.frame, 0, &value, &density, &err));
        ck_assert(isfinite(density));
        double same_value, same_density;
        ck_ok(sg_draw_transform_density(t.g, t.d, t.frame, 0, u, &same_value, &same_density, &err));
        ck_assert(same_value == value && same_density == density);
        ck_ok(sg_draw_invert(t.g, t.d, t.frame, 0, &value, back, &err));
        ck_assert(back[0] > 0 && back[0] < 1);
        if (t.d->kind != SG_DRAW_MIXTURE && t.d->kind != SG_DRAW_DISCRETE)
            ck_assert_double_eq_tol(back[0], u[0], 1e-10);
        ck_ok(sg_draw_transform(t.g, t.d, t.frame, 0, back, &again, &err));
        ck_assert_double_eq_tol(again, value, 1e-9 * (1 + fabs(value)));
    }
    gsl_rng_free(rng);
    sg_grammar_free(t.g);
}
END_TEST

static double density_at(double x, void *user)
{
    const drawn *t = user;
    double log_density = 0;
    sg_draw_log_density(t->g, t->d, t->frame, 0, &x, &log_density, NULL);
    return exp(log_density);
}

/* Densities integrate to the share of uniforms that falls below each of some values: map and density are of one
 * distribution. */
START_TEST(densities_are_those_of_the_draws)
{
    enum { N = 20000, PLACES = 7 };
    sg_error err = SG_ERROR_INIT;
    drawn t = open_draw(_i);
    gsl_rng *rng = sg_random_create(11);
    double *x = malloc(N * sizeof *x);
    for (int i = 0; i < N; i++) {
        const double u[2] = {sg_random_uniform(rng), sg_random_uniform(rng)};
        ck_ok(sg_draw_transform(t.g, t.d, t.frame, 0, u, &x[i], &err));
    }
    gsl_integration_workspace *w = gsl_integration_workspace_alloc(1000);
    gsl_function f = {density_at, &t};
    for (int place = 0; place < PLACES; place++) {
        static const double edges[PLACES] = {-1.2, -0.5, 0.1, 0.7, 0.9, 1.5, 2.7};
        double below = 0, mass = 0, error;
        const double points[] = {-8, -1, 0, 2, 2.75, edges[place]};
        size_t n = 0;
        double sorted[6];
        for (size_t i = 0; i < 5; i++)
            if (points[i] < edges[place])
                sorted[n++] = points[i];
        sorted[n++] = edges[place];
        gsl_integration_qagp(&f, sorted, n, 1e-9, 1e-9, 1000, w, &mass, &error);
        for (int i = 0; i < N; i++)
            below += x[i] < edges[place];
        below /= N;
        ck_assert_msg(fabs(below - mass) <= 5 * sqrt(fmax(mass * (1 - mass), 0) / N) + 1e-7, "%s below %g: %g of draws, mass %g", draws[_i],
                      edges[place], below, mass);
    }
    free(x);
    gsl_integration_workspace_free(w);
    gsl_rng_free(rng);
    sg_grammar_free(t.g);
}
END_TEST

START_TEST(discrete_probabilities_are_those_of_the_draws)
{
    enum { N = 20000 };
    static const double values[] = {4, 0.75, -1}, probabilities[] = {2 / 4.5, 2 / 4.5, 0.5 / 4.5};
    sg_error err = SG_ERROR_INIT;
    drawn t = open_draw(5);
    gsl_rng *rng = sg_random_create(12);
    int count[3] = {0};
    for (int i = 0; i < N; i++) {
        const double u = sg_random_uniform(rng);
        double x;
        ck_ok(sg_draw_transform(t.g, t.d, t.frame, 0, &u, &x, &err));
        for (int k = 0; k < 3; k++)
            count[k] += x == values[k];
    }
    ck_assert_int_eq(count[0] + count[1] + count[2], N);
    for (int k = 0; k < 3; k++) {
        const double p = probabilities[k];
        double log_density;
        ck_assert_msg(fabs(count[k] - N * p) < 5 * sqrt(N * p * (1 - p)), "%g: %d of %g", values[k], count[k], N * p);
        ck_ok(sg_draw_log_density(t.g, t.d, t.frame, 0, &values[k], &log_density, &err));
        ck_assert_double_eq_tol(log_density, log(p), 1e-14);
    }
    const double other = 7; /* its weight is 0 */
    double u, log_density;
    ck_assert_int_eq(sg_draw_invert(t.g, t.d, t.frame, 0, &other, &u, &err), SG_ENUMERIC);
    ck_ok(sg_draw_log_density(t.g, t.d, t.frame, 0, &other, &log_density, &err));
    ck_assert(isinf(log_density) && log_density < 0);
    gsl_rng_free(rng);
    sg_grammar_free(t.g);
}
END_TEST

START_TEST(impossible_parameters_are_errors)
{
    static const struct {
        const char *draw;
        double m;
    } bad[] = {{"normal(0, m)", 0}, {"normal(0, m)", -1}, {"normal(m, 1)", NAN}, {"uniform(m, 1)", 1}, {"uniform(m, 1)", INFINITY},
               {"truncated_normal(0, 1, m, 1)", 2}, {"mixture((m, 1, 1))", 0}, {"mixture((m, 1, 1), (1, 1, 1))", -1},
               {"mixture((1, 1, m))", 0}, {"discrete((m, 1))", 0}, {"discrete((1, m))", NAN}};
    sg_error err = SG_ERROR_INIT;
    char text[200];
    snprintf(text, sizeof text, "rule A(m) -> s ~ %s draw(s) start B rule B -> m ~ normal(0, 1) A(m)", bad[_i].draw);
    sg_grammar *g = test_grammar(text);
    const sg_draw *d = &sg_grammar_rule(g, 0)->draws[0];
    const double u[2] = {0.5, 0.5};
    double x = 0.5, back[2];
    ck_assert_int_eq(sg_draw_transform(g, d, &bad[_i].m, 0, u, &x, &err), SG_ENUMERIC);
    ck_assert_ptr_nonnull(strstr(err.msg, "draw s: "));
    ck_assert_int_eq(sg_draw_invert(g, d, &bad[_i].m, 0, &x, back, &err), SG_ENUMERIC);
    ck_assert_int_eq(sg_draw_log_density(g, d, &bad[_i].m, 0, &x, back, &err), SG_ENUMERIC);
    ck_assert_int_eq(sg_draw_transform_density(g, d, &bad[_i].m, 0, u, &x, back, &err), SG_ENUMERIC);
    sg_grammar_free(g);
}
END_TEST

START_TEST(values_outside_the_support_have_density_zero)
{
    static const double outside[] = {-2, INFINITY, 2.5, -0.1, INFINITY, 0.3};
    sg_error err = SG_ERROR_INIT;
    drawn t = open_draw(_i);
    double u[2], density;
    ck_assert_int_eq(sg_draw_invert(t.g, t.d, t.frame, 0, &outside[_i], u, &err), SG_ENUMERIC);
    ck_ok(sg_draw_log_density(t.g, t.d, t.frame, 0, &outside[_i], &density, &err));
    ck_assert(isinf(density) && density < 0);
    sg_grammar_free(t.g);
}
END_TEST

#define COUNT(array) ((int)(sizeof(array) / sizeof *(array)))

int main(void)
{
    Suite *suite = suite_create("distribution");
    TCase *tc = tcase_create("distribution");
    tcase_set_timeout(tc, 120);
    tcase_add_test(tc, tails_of_the_normal_are_those_of_the_library);
    tcase_add_test(tc, quantiles_of_the_normal_are_those_of_the_library);
    tcase_add_loop_test(tc, quantiles_of_the_normal_rise, 0, 2);
    tcase_add_loop_test(tc, truncated_normals_are_exact_in_their_tails, 0, COUNT(truncated));
    tcase_add_loop_test(tc, truncated_normals_hold_in_impossible_places, 0, 4);
    tcase_add_loop_test(tc, draws_go_back_to_their_uniforms, 0, COUNT(draws));
    tcase_add_loop_test(tc, densities_are_those_of_the_draws, 0, COUNT(draws) - 1);
    tcase_add_test(tc, discrete_probabilities_are_those_of_the_draws);
    tcase_add_loop_test(tc, impossible_parameters_are_errors, 0, 11);
    tcase_add_loop_test(tc, values_outside_the_support_have_density_zero, 0, COUNT(draws));
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
