/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_kernels_errata.c - the acceptance ratios as they are printed, and what becomes of the target with them.
 *
 * No chain runs here: whole transition kernels are put together from proposal probabilities and a formula. With the
 * right formula pi K = pi to the last bit, with each wrong one it does not. That is also the proof that
 * test_kernels_exact.c, which does the same with what chains report, can fail. */
#include "tests/kernel_grammars.h"
#include "tests/kernel_oracle.h"
#include "tests/support.h"
#include "tests/toy_score.h"

#include <gsl/gsl_randist.h>
#include <math.h>
#include <string.h>

/* ---- jumps and second stages ---- */

/* Ways to go wrong, each on its own. */
typedef enum {
    RIGHT,
    NO_SELECTION,     /* q_y(v) / q_x(v) is left out */
    RAW_SELECTION,    /* b^(depth of tree - depth of node), not normalised */
    DENSITIES,        /* the printed jump: densities of the values beside a Jacobian of uniforms */
    SECOND_DENSITIES, /* the printed second stage with the right jump */
    NO_REJECTION,     /* the second stage without its factors 1 - alpha */
    NO_RULES,         /* the second stage, or a diffusion, without ratios of rule probabilities */
} erratum;

static uint32_t tree_depth(const sg_derivation *d)
{
    uint32_t depth = 0;
    for (size_t i = 0; i < d->nnodes; i++)
        depth = d->nodes[i].depth > depth ? d->nodes[i].depth : depth;
    return depth;
}

static double log_select(const kernel_model *m, erratum e, size_t x, size_t y)
{
    if (e == NO_SELECTION)
        return 0;
    if (e == RAW_SELECTION) /* the depth of the node is the same in both */
        return ((double)tree_depth(m->space.d + y) - (double)tree_depth(m->space.d + x)) * log(m->base);
    return kernel_log_weight(m, x) - kernel_log_weight(m, y);
}

static double jump_ratio(const kernel_model *m, erratum e, size_t x, size_t y)
{
    const double densities = e == DENSITIES ? m->log_density[y] - m->log_density[x] : 0;
    return fmin(m->beta * (m->log_score[y] - m->log_score[x]) + log_select(m, e, x, y) + densities, 0);
}

static double second_ratio(const kernel_model *m, erratum e, const kernel_step *s)
{
    const double forth = jump_ratio(m, e, s->x, s->y), back = jump_ratio(m, e, s->z, s->back);
    double r = m->beta * (m->log_score[s->z] - m->log_score[s->x]) + log_select(m, e, s->x, s->z);
    if (back >= 0 && e != NO_REJECTION)
        return -INFINITY;
    if (e != NO_REJECTION)
        r += log1p(-exp(back)) - log1p(-exp(forth));
    if (e != NO_RULES)
        r += m->log_rules[s->z] - m->log_rules[s->y] + m->log_rules[s->back] - m->log_rules[s->x];
    if (e == DENSITIES || e == SECOND_DENSITIES)
        r += m->log_density[s->z] - m->log_density[s->x];
    return fmin(r, 0);
}

static double accept_with(void *user, const kernel_model *m, const kernel_step *s, double p)
{
    (void)p;
    const erratum e = *(const erratum *)user;
    if (s->y == SIZE_MAX || (s->z == SIZE_MAX && m->log_score[s->y] == -INFINITY))
        return -INFINITY;
    if (s->kind == SG_MOVE_RESAMPLE)
        return fmin(m->beta * (m->log_score[s->y] - m->log_score[s->x]) +
                        (e == NO_RULES ? 0 : m->log_rules[s->y] - m->log_rules[s->x]),
                    0);
    return s->z == SIZE_MAX ? jump_ratio(m, e, s->x, s->y) : second_ratio(m, e, s);
}

/* || pi K - pi || of a kernel on one of the grammars, with b = 2. */
static double imbalance(const char *grammar, sg_move_kind kind, bool delayed, erratum e)
{
    toy_hash hash = {17, 1, 0};
    size_t i = 0;
    while (i < NFINITE && strcmp(finite_grammars[i].name, grammar) != 0)
        i++;
    ck_assert_uint_lt(i, NFINITE);
    kernel_model m;
    kernel_flow f;
    kernel_model_init(&m, finite_grammars[i].text, finite_grammars[i].cells, finite_grammars[i].max_nodes, toy_hash_log,
                      &hash);
    kernel_model_temper(&m, 1, 2, 1);
    kernel_flow_init(&f, &m);
    kernel_add(&f, &m, kind, delayed, 1, accept_with, &e);
    const double off = kernel_imbalance(&f, &m);
    kernel_flow_clear(&f);
    kernel_model_clear(&m);
    return off;
}

/* A way to go wrong, and where it shows. */
typedef struct {
    const char *grammar;
    sg_move_kind kind;
    bool delayed;
    erratum wrong;
} case_of;

static const case_of cases[] = {
    {"branching", SG_MOVE_JUMP_FRESH, false, NO_SELECTION},
    {"branching", SG_MOVE_JUMP_FRESH, false, RAW_SELECTION},
    {"one or two values", SG_MOVE_JUMP_FRESH, false, DENSITIES},
    {"one or two values", SG_MOVE_JUMP_COPY, false, DENSITIES},
    {"one or two values", SG_MOVE_JUMP_FRESH, true, DENSITIES},
    {"one or two values", SG_MOVE_JUMP_FRESH, true, SECOND_DENSITIES},
    {"one or two values", SG_MOVE_JUMP_COPY, true, SECOND_DENSITIES},
    {"one or two values", SG_MOVE_JUMP_FRESH, true, NO_REJECTION},
    {"one or two values", SG_MOVE_JUMP_COPY, true, NO_REJECTION},
    {"values decide what follows", SG_MOVE_JUMP_FRESH, true, NO_RULES},
    {"values decide what follows", SG_MOVE_JUMP_COPY, true, NO_RULES},
    {"values decide what follows", SG_MOVE_RESAMPLE, false, NO_RULES},
};

enum { NCASES = sizeof cases / sizeof *cases };

START_TEST(wrong_ratios_lose_the_target)
{
    const case_of *c = cases + _i;
    const double right = imbalance(c->grammar, c->kind, c->delayed, RIGHT);
    const double wrong = imbalance(c->grammar, c->kind, c->delayed, c->wrong);
    ck_assert_msg(right < 1e-12, "%s: %g", c->grammar, right);
    ck_assert_msg(wrong > 1e-3, "%s, erratum %d: only %g", c->grammar, (int)c->wrong, wrong);
}
END_TEST

/* ---- swaps ---- */

typedef enum { SWAP_RIGHT, SWAP_TRANSPOSED, SWAP_POSTERIORS } swap_erratum;

/* Two chains at beta 1 and 0.4: how far the product of their targets is from where a swap leaves it. */
static double swap_imbalance(const kernel_model *cold, const kernel_model *hot, swap_erratum e)
{
    const size_t n = cold->space.n;
    double off = 0;
    for (size_t x = 0; x < n; x++) {
        for (size_t y = 0; y < n; y++) {
            double r = hot->log_score[y] - hot->log_score[x];
            if (e == SWAP_POSTERIORS)
                r += log(cold->space.prior[y]) - log(cold->space.prior[x]);
            r *= e == SWAP_TRANSPOSED ? hot->beta - cold->beta : cold->beta - hot->beta;
            const double here = cold->pi[x] * hot->pi[y], there = cold->pi[y] * hot->pi[x];
            off += fabs(there * exp(fmin(-r, 0)) - here * exp(fmin(r, 0))); /* in less out */
        }
    }
    return off;
}

START_TEST(swaps_weigh_the_score_alone)
{
    toy_hash hash = {3, 1, 0};
    kernel_model cold, hot;
    kernel_model_init(&cold, finite_grammars[0].text, 1, 100, toy_hash_log, &hash);
    kernel_model_init(&hot, finite_grammars[0].text, 1, 100, toy_hash_log, &hash);
    kernel_model_temper(&cold, 1, 1, 1);
    kernel_model_temper(&hot, 0.4, 1, 1);
    ck_assert_double_lt(swap_imbalance(&cold, &hot, SWAP_RIGHT), 1e-12);
    ck_assert_double_gt(swap_imbalance(&cold, &hot, SWAP_TRANSPOSED), 0.01);
    ck_assert_double_gt(swap_imbalance(&cold, &hot, SWAP_POSTERIORS), 0.01);
    kernel_model_clear(&cold);
    kernel_model_clear(&hot);
}
END_TEST

/* ---- attributes proposed in one way and weighed in another ---- */

/* S has two sizes (probability 0.3) or three, multiples of 1/N; the model of sizes is a normal density on the simplex.
 * A state is its free sizes; all of them are listed. */
enum { N = 24 };

typedef struct {
    int k;        /* sizes */
    int s[2];     /* the free ones, in Nths */
    double prior; /* of the rule */
    double phi;   /* density of the sizes, which sums to 1 over the simplex */
    double score;
} sizes;

typedef struct {
    sizes state[2 * N * N];
    size_t n;
    double mass[2]; /* of the unnormalised normals */
} world;

static double raw_phi(int k, const int *s)
{
    const double a = (double)s[0] / N, b = (double)s[1] / N;
    return k == 2 ? gsl_ran_gaussian_pdf(a - 0.45, 0.08)
                  : gsl_ran_gaussian_pdf(a - 0.3, 0.12) * gsl_ran_gaussian_pdf(b - 0.35, 0.12);
}

static void add_state(world *w, int k, int a, int b)
{
    sizes *s = w->state + w->n++;
    *s = (sizes){k, {a, b}, k == 2 ? 0.3 : 0.7, 0, exp(-0.5 * pow(((double)a / N - 0.37) / 0.15, 2))};
    s->phi = raw_phi(k, s->s);
    w->mass[k - 2] += s->phi;
}

static void list_world(world *w)
{
    memset(w, 0, sizeof *w);
    for (int a = 1; a < N; a++)
        add_state(w, 2, a, 0);
    for (int a = 1; a < N; a++)
        for (int b = 1; a + b < N; b++)
            add_state(w, 3, a, b);
    for (size_t i = 0; i < w->n; i++)
        w->state[i].phi /= w->mass[w->state[i].k - 2];
}

typedef enum { FROM_CUBE, FROM_PHI, FROM_SIMPLEX } proposal;

/* Probability of proposing these sizes once the rule is known; what falls outside of the simplex is rejected. */
static double propose(const sizes *s, proposal from)
{
    const double points = s->k == 2 ? N - 1 : (N - 1) * (N - 2) / 2.0, cube = s->k == 2 ? N - 1 : (N - 1) * (N - 1);
    return from == FROM_PHI ? s->phi : 1 / (from == FROM_CUBE ? cube : points);
}

/* What of the attributes goes into the acceptance. */
typedef enum {
    IMAGE_ONLY,     /* exp(-dE_img) */
    EQUATION_11,    /* and the ratio of phi */
    UNNORMALISED,   /* phi without its normaliser */
    WITH_PROPOSALS, /* and the ratio of proposal densities: the general form */
} weighing;

static double weigh(const world *w, const sizes *s, proposal from, weighing how)
{
    const double cells = s->k == 2 ? N - 1 : (N - 1.0) * (N - 1); /* a cube's density is 1, of others relative to it */
    if (how == IMAGE_ONLY)
        return s->score;
    const double phi = how == UNNORMALISED
                           ? s->phi * w->mass[s->k - 2] * pow(sqrt(2 * M_PI) * (s->k == 2 ? 0.08 : 0.12), s->k - 1)
                           : s->phi * cells;
    return s->score * phi / (how == WITH_PROPOSALS ? propose(s, from) * cells : 1);
}

static double sizes_imbalance(const world *w, proposal from, weighing how)
{
    double total = 0, off = 0;
    for (size_t i = 0; i < w->n; i++)
        total += w->state[i].prior * w->state[i].phi * w->state[i].score;
    for (size_t i = 0; i < w->n; i++) {
        double in_less_out = 0;
        for (size_t j = 0; j < w->n; j++) {
            const sizes *x = w->state + i, *y = w->state + j;
            const double ratio = weigh(w, y, from, how) / weigh(w, x, from, how);
            const double out = x->prior * x->phi * x->score / total * y->prior * propose(y, from) * fmin(1, ratio);
            const double in = y->prior * y->phi * y->score / total * x->prior * propose(x, from) * fmin(1, 1 / ratio);
            in_less_out += in - out;
        }
        off += fabs(in_less_out);
    }
    return off;
}

START_TEST(equation_11_is_for_uniform_cubes)
{
    static world w;
    list_world(&w);
    ck_assert_double_lt(sizes_imbalance(&w, FROM_CUBE, EQUATION_11), 1e-12);
    ck_assert_double_lt(sizes_imbalance(&w, FROM_CUBE, WITH_PROPOSALS), 1e-12);
    ck_assert_double_lt(sizes_imbalance(&w, FROM_PHI, IMAGE_ONLY), 1e-12);
    ck_assert_double_lt(sizes_imbalance(&w, FROM_PHI, WITH_PROPOSALS), 1e-12);
    ck_assert_double_lt(sizes_imbalance(&w, FROM_SIMPLEX, WITH_PROPOSALS), 1e-12);
    ck_assert_double_gt(sizes_imbalance(&w, FROM_PHI, EQUATION_11), 0.01);     /* counts phi twice */
    ck_assert_double_gt(sizes_imbalance(&w, FROM_SIMPLEX, EQUATION_11), 0.01); /* lacks the ratio of (k-1)! */
    ck_assert_double_gt(sizes_imbalance(&w, FROM_CUBE, UNNORMALISED), 0.01);
    ck_assert_double_gt(sizes_imbalance(&w, FROM_CUBE, IMAGE_ONLY), 0.01);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("kernels_errata");
    TCase *tc = tcase_create("errata");
    tcase_add_loop_test(tc, wrong_ratios_lose_the_target, 0, NCASES);
    tcase_add_test(tc, swaps_weigh_the_score_alone);
    tcase_add_test(tc, equation_11_is_for_uniform_cubes);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
