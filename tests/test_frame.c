/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_frame.c - frames in space: turns against rotation matrices of twice the precision, over long chains. */
#include "core/random.h"
#include "scene/frame.h"
#include "tests/support.h"

#include <math.h>

typedef struct {
    long double m[3][3]; /* columns are the axes */
} matrix;

/* The matrix of a rotation about a direction, from Rodrigues' formula, times a. */
static matrix turned(const matrix *a, const long double *axis, long double radians)
{
    const long double c = cosl(radians), s = sinl(radians);
    matrix out;
    for (int col = 0; col < 3; col++) {
        const long double v[3] = {a->m[0][col], a->m[1][col], a->m[2][col]};
        const long double along = axis[0] * v[0] + axis[1] * v[1] + axis[2] * v[2];
        for (int i = 0; i < 3; i++) {
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            out.m[i][col] = c * v[i] + s * (axis[j] * v[k] - axis[k] * v[j]) + (1 - c) * along * axis[i];
        }
    }
    return out;
}

static void scale(matrix *a, int col)
{
    const long double length = sqrtl(a->m[0][col] * a->m[0][col] + a->m[1][col] * a->m[1][col] + a->m[2][col] * a->m[2][col]);
    for (int i = 0; i < 3; i++)
        a->m[i][col] /= length;
}

/* Gram and Schmidt: the formula makes an axis longer that is a little too long. */
static void orthonormalize(matrix *a)
{
    scale(a, 0);
    const long double along = a->m[0][0] * a->m[0][1] + a->m[1][0] * a->m[1][1] + a->m[2][0] * a->m[2][1];
    for (int i = 0; i < 3; i++)
        a->m[i][1] -= along * a->m[i][0];
    scale(a, 1);
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        a->m[i][2] = a->m[j][0] * a->m[k][1] - a->m[k][0] * a->m[j][1];
    }
}

static double error_of(const sg_frame *f, const matrix *m)
{
    double most = 0;
    for (int i = 0; i < 3; i++)
        most = fmax(most, fmax(fabs((double)(f->x[i] - m->m[i][0])),
                               fmax(fabs((double)(f->y[i] - m->m[i][1])), fabs((double)(f->z[i] - m->m[i][2])))));
    return most;
}

static double departure(const sg_frame *f)
{
    const double d[6] = {sg_vec_dot(f->x, f->x) - 1, sg_vec_dot(f->y, f->y) - 1, sg_vec_dot(f->z, f->z) - 1,
                         sg_vec_dot(f->x, f->y),     sg_vec_dot(f->y, f->z),     sg_vec_dot(f->z, f->x)};
    double most = 0;
    for (int i = 0; i < 6; i++)
        most = fmax(most, fabs(d[i]));
    return most;
}

START_TEST(chains_of_turns_are_rotations)
{
    enum { TURNS = 20000 };
    gsl_rng *rng = sg_random_create((uint64_t)_i + 1);
    ck_assert_ptr_nonnull(rng);
    sg_frame f = SG_FRAME_INIT;
    matrix m = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    for (int n = 0; n < TURNS; n++) {
        const double angle = (sg_random_uniform(rng) - 0.5) * (n % 7 == 0 ? 1e4 : 7);
        const int which = (int)gsl_rng_uniform_int(rng, 4);
        double axis[3] = {sg_random_uniform(rng) - 0.5, sg_random_uniform(rng) - 0.5, 1e-3};
        long double about[3];
        sg_vec_normalize(axis);
        for (int i = 0; i < 3; i++)
            about[i] = which < 3 ? m.m[i][which] : axis[i];
        sg_frame_turn(&f, which == 0 ? f.x : which == 1 ? f.y : which == 2 ? f.z : axis, angle);
        m = turned(&m, about, angle);
        orthonormalize(&m);
        test_must(departure(&f) < 2e-15);
        const double error = error_of(&f, &m);
        if (!(error < 5e-16 * (double)(n + 10))) /* rounding adds up no faster than the turns */
            ck_abort_msg("after %d turns: %g", n + 1, error);
    }
    gsl_rng_free(rng);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("frame");
    TCase *tc = tcase_create("frame");
    tcase_add_loop_test(tc, chains_of_turns_are_rotations, 0, 10);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
