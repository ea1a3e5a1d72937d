/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_kernels_exact.c - chains on finite grammars keep their target to the last bit.
 *
 * From every state of a finite grammar the chain makes steps until everything that it can propose has been seen. What
 * it proposes must be what the grammar says, as often as the grammar says; its acceptances, as it reports them, go into
 * the whole transition kernel, and with it || pi K - pi ||_1 < 1e-12. */
#include "tests/kernel_grammars.h"
#include "tests/kernel_oracle.h"
#include "tests/support.h"
#include "tests/toy_score.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <string.h>

/* A step that can be proposed, with its probability from its state, and what was seen of it. */
typedef struct {
    kernel_step step;
    double p;
    double log_accept; /* NAN: not seen */
    size_t times;
} known_step;

typedef struct {
    kernel_model m;
    const finite_grammar *grammar;
    sg_move_kind kind;
    bool delayed;
    toy_hash hash;
    toy_score score;
    size_t least_steps; /* from each state */
    sg_chain *chain;
    known_step *known;
    size_t nknown, capacity, *slots, nslots;
    size_t heard[8], nheard;             /* states that were proposed to the score in one step */
    size_t unseen;                       /* first stages of the present state that are still to come */
    double expected, accepted, variance; /* over all first stages: how many are accepted */
} fixture;

static uint64_t hash(const kernel_step *s)
{
    const size_t part[] = {(size_t)s->kind, s->x, s->v, s->y, s->z, s->back};
    uint64_t h = 0;
    for (size_t i = 0; i < sizeof part / sizeof *part; i++) {
        h = (h ^ part[i]) * 0x9e3779b97f4a7c15;
        h ^= h >> 29;
    }
    return h;
}

static bool same_step(const kernel_step *a, const kernel_step *b)
{
    return a->kind == b->kind && a->x == b->x && a->v == b->v && a->y == b->y && a->z == b->z && a->back == b->back;
}

static size_t slot_of(const fixture *f, const kernel_step *s)
{
    size_t slot = hash(s) & (f->nslots - 1);
    while (f->slots[slot] != 0 && !same_step(&f->known[f->slots[slot] - 1].step, s))
        slot = (slot + 1) & (f->nslots - 1);
    return slot;
}

static void grow(fixture *f)
{
    f->capacity = f->capacity > 0 ? 2 * f->capacity : 1024;
    f->nslots = 4 * f->capacity;
    f->known = realloc(f->known, f->capacity * sizeof *f->known);
    free(f->slots);
    f->slots = calloc(f->nslots, sizeof *f->slots);
    test_must(f->known != NULL && f->slots != NULL);
    for (size_t i = 0; i < f->nknown; i++)
        f->slots[slot_of(f, &f->known[i].step)] = i + 1;
}

/* As an acceptance: notes what can be proposed. Second stages are all asked for, since half is accepted. */
static double note_step(void *user, const kernel_model *m, const kernel_step *s, double p)
{
    fixture *f = user;
    if (f->nknown == f->capacity)
        grow(f);
    const size_t slot = slot_of(f, s);
    if (f->slots[slot] == 0) {
        f->known[f->nknown] = (known_step){.step = *s, .log_accept = NAN};
        f->slots[slot] = ++f->nknown;
    }
    f->known[f->slots[slot] - 1].p += p / m->pi[s->x]; /* what falls outside comes in several ways */
    return log(0.5);
}

static void hear(void *user, const sg_change *change, const sg_derivation *proposed, double floor, double log)
{
    fixture *f = user;
    (void)change, (void)floor, (void)log;
    test_must(f->nheard < sizeof f->heard / sizeof *f->heard);
    f->heard[f->nheard] = oracle_space_find(&f->m.space, proposed);
    test_must(f->heard[f->nheard] != SIZE_MAX);
    f->nheard++;
}

/* Temperatures and bases in turn, so that every pair of them comes up. */
static void open_fixture(fixture *f, int which, sg_move_kind kind, bool delayed)
{
    static const double betas[] = {0, 0.5, 1};
    sg_error err = SG_ERROR_INIT;
    const size_t i = (size_t)which % NFINITE, turn = (size_t)which / NFINITE;
    *f = (fixture){.grammar = finite_grammars + i, .kind = kind, .delayed = delayed, .least_steps = 200};
    f->hash = (toy_hash){11, 1.5, 0.1};
    kernel_model_init(&f->m, f->grammar->text, f->grammar->cells, f->grammar->max_nodes, toy_hash_log, &f->hash);
    kernel_model_temper(&f->m, betas[(turn + i) % 3], (double)(1 + (turn + i / 3) % 3), turn == 2 ? 1.5 : 1);
    if (turn == 1)
        f->m.delayed_nodes = 2;
    toy_score_init(&f->score, toy_hash_log, &f->hash);
    f->score.strict = which < NFINITE;
    f->score.listener = hear;
    f->score.listener_user = f;
    sg_kernel_opts opts = SG_KERNEL_OPTS_INIT;
    memset(opts.share, 0, sizeof opts.share);
    opts.share[kind] = 1;
    opts.delayed_rejection = delayed;
    opts.delayed_nodes = f->m.delayed_nodes;
    opts.depth_base = f->m.base;
    opts.max_nodes = f->m.max_nodes;
    ck_ok(sg_chain_create(f->m.g, &f->score.base, &opts, 5, 3, f->m.beta, &f->chain, &err));
    sg_chain_set_sharpness(f->chain, f->m.sharpness);
    kernel_flow flow;
    kernel_flow_init(&flow, &f->m);
    kernel_add(&flow, &f->m, kind, delayed, 1, note_step, f);
    kernel_flow_clear(&flow);
}

static void close_fixture(fixture *f)
{
    sg_chain_free(f->chain);
    kernel_model_clear(&f->m);
    free(f->known);
    free(f->slots);
}

static bool close_to(double a, double b)
{
    return a == b || fabs(a - b) <= 1e-11 * fmax(1, fabs(b));
}

/* The chain reports a step that is known to the oracle, the same each time, with the acceptance of MATHEMATICS B5. */
static void see(fixture *f, const kernel_step *step, double log_accept)
{
    const size_t found = f->slots[slot_of(f, step)];
    ck_assert_msg(found != 0, "%s: %zu -> %zu (%zu, %zu) at node %zu is proposed and should not be", f->grammar->name,
                  step->x, step->y, step->z, step->back, step->v);
    known_step *k = f->known + found - 1;
    const double right = kernel_right_accept(NULL, &f->m, step, 0);
    /* what is left of 1 by a way back that is all but certain is noise, and of no weight */
    const bool good =
        close_to(log_accept, right) || (step->z != SIZE_MAX && fabs(exp(log_accept) - exp(right)) < 1e-13);
    if (!good || (k->times > 0 && k->log_accept != log_accept))
        ck_abort_msg(
            "%s: %zu -> %zu (%zu, %zu) at node %zu of kind %d: log acceptance %.17g, before %.17g, should be %.17g",
            f->grammar->name, step->x, step->y, step->z, step->back, step->v, (int)step->kind, log_accept,
            k->log_accept, right);
    f->unseen -= k->times == 0 && step->z == SIZE_MAX;
    k->log_accept = log_accept;
    k->times++;
}

static void check_terms(const fixture *f, const sg_move *move, size_t x, size_t y)
{
    const kernel_model *m = &f->m;
    const bool jump = f->kind != SG_MOVE_RESAMPLE;
    const double select = jump ? kernel_log_weight(m, x) - kernel_log_weight(m, y) : 0;
    const double rules = jump ? 0 : m->log_rules[y] - m->log_rules[x];
    test_must(close_to(move->d_log_score, m->log_score[y] - m->log_score[x]));
    if (m->log_score[y] == -INFINITY)
        return;
    test_must(close_to(move->d_log_select, select));
    test_must(close_to(move->d_log_rules, rules));
    test_must(move->d_log_propose == 0);
    test_must(close_to(move->d_log_anneal, (m->sharpness - 1) * (m->log_rules[y] - m->log_rules[x] + m->log_density[y] -
                                                                 m->log_density[x])));
}

/* A step that scores nothing: nothing to move, out of the target, or a copy of what is there. */
static void digest_silence(fixture *f, size_t x, const sg_move *move)
{
    test_must(!move->second_stage);
    if (move->accepted)
        see(f, &(kernel_step){f->kind, x, move->node, x, SIZE_MAX, SIZE_MAX}, move->log_accept);
    else
        test_must(move->node == SIZE_MAX || move->log_accept == -INFINITY);
}

/* After a step from x: what was heard, what was reported and where the chain is now must agree. A second stage asks for
 * z, for y* when z is worth it, and again for z when it is accepted. */
static size_t digest(fixture *f, size_t x, const sg_move *move)
{
    const size_t *heard = f->heard, now = oracle_space_find(&f->m.space, sg_chain_derivation(f->chain));
    test_must((move->kind == f->kind || move->node == SIZE_MAX) && move->log_accept <= 0);
    if (f->nheard == 0) {
        digest_silence(f, x, move);
        test_must(now == x);
        return now;
    }
    see(f, &(kernel_step){f->kind, x, move->node, heard[0], SIZE_MAX, SIZE_MAX}, move->log_accept);
    check_terms(f, move, x, heard[0]);
    test_must(f->nheard == 1 || (move->second_stage && f->delayed));
    if (f->nheard > 2)
        see(f, &(kernel_step){f->kind, x, move->node, heard[0], heard[1], heard[2]}, move->log_accept2);
    else
        test_must(!move->second_stage || move->log_accept2 == -INFINITY);
    test_must(now == (!move->accepted ? x : move->second_stage ? heard[1] : heard[0]));
    return now;
}

static void check_posterior(const fixture *f, size_t x)
{
    const sg_posterior *p = sg_chain_posterior(f->chain);
    test_must(p->score.log == f->m.log_score[x] && close_to(p->log_rules, f->m.log_rules[x]));
}

/* Steps from x until all first stages were seen, and some more: enough to compare frequencies. */
static size_t make_steps(fixture *f, size_t x, uint64_t *iteration)
{
    enum { MOST = 400000 };
    sg_error err = SG_ERROR_INIT;
    size_t steps = 0, now = SIZE_MAX;
    for (; steps < f->least_steps || (f->unseen > 0 && steps < MOST); steps++) {
        sg_move move;
        if (now != x) {
            test_must_ok(sg_chain_start(f->chain, f->m.space.d + x, 0, NULL, &err));
            check_posterior(f, x);
        }
        f->nheard = 0;
        test_must_ok(sg_chain_step(f->chain, ++*iteration, &move, &err));
        now = digest(f, x, &move);
        check_posterior(f, now);
        const double a = f->nheard > 0 || move.accepted ? exp(move.log_accept) : 0;
        f->expected += a;
        f->variance += a * (1 - a);
        f->accepted += move.accepted && !move.second_stage;
    }
    ck_assert_msg(f->unseen == 0, "%s: %zu steps from %zu were never seen", f->grammar->name, f->unseen, x);
    return steps;
}

static bool is_first_stage_of(const known_step *k, size_t x)
{
    return k->step.x == x && k->step.z == SIZE_MAX && k->step.y != SIZE_MAX;
}

/* Chi-square of how often each first stage from x came up; rare ones, and what is outside, count together. */
static void check_frequencies(const fixture *f, size_t x, size_t steps)
{
    double chisq = 0, rest = (double)steps, rest_seen = (double)steps;
    unsigned categories = 0;
    for (size_t i = 0; i < f->nknown; i++) {
        const known_step *k = f->known + i;
        const double expected = k->p * (double)steps;
        if (!is_first_stage_of(k, x) || expected < 8)
            continue;
        chisq += pow((double)k->times - expected, 2) / expected;
        rest -= expected;
        rest_seen -= (double)k->times;
        categories++;
    }
    if (rest > 8)
        chisq += pow(rest_seen - rest, 2) / rest;
    else
        test_must(rest > -1e-6 * (double)steps);
    categories += rest > 8;
    if (categories > 1)
        ck_assert_msg(gsl_cdf_chisq_Q(chisq, categories - 1) > 1e-7, "%s, kind %d: from %zu: chi-square %g of %u",
                      f->grammar->name, (int)f->kind, x, chisq, categories);
}

/* Second stages follow the first one that was rejected: z and y* must come up as often as the grammar says, among those
 * that get as far as being reported. */
static size_t check_second_stages(const fixture *f, size_t first, double *chisq, double *categories)
{
    size_t end = first + 1;
    double p = 0, times = 0;
    for (; end < f->nknown && f->known[end].step.z != SIZE_MAX; end++) {
        const known_step *k = f->known + end;
        p += f->m.log_score[k->step.z] > -INFINITY ? k->p : 0;
        times += (double)k->times;
    }
    for (size_t i = first + 1; i < end; i++) {
        const known_step *k = f->known + i;
        const double expected = f->m.log_score[k->step.z] > -INFINITY ? times * k->p / p : 0;
        if (expected < 5)
            continue;
        *chisq += pow((double)k->times - expected, 2) / expected;
        *categories += 1;
    }
    return end;
}

static void check_all_second_stages(const fixture *f)
{
    double chisq = 0, categories = 0;
    for (size_t i = 0; i < f->nknown;)
        i = check_second_stages(f, i, &chisq, &categories);
    if (categories > 0)
        ck_assert_msg(gsl_cdf_chisq_Q(chisq, categories) > 1e-7, "%s, kind %d: second stages: chi-square %g of %g",
                      f->grammar->name, (int)f->kind, chisq, categories);
}

static void observe(fixture *f)
{
    uint64_t iteration = 0;
    for (size_t x = 0; x < f->m.space.n; x++) {
        if (f->m.pi[x] == 0)
            continue;
        for (size_t i = 0; i < f->nknown; i++)
            f->unseen += is_first_stage_of(f->known + i, x);
        check_frequencies(f, x, make_steps(f, x, &iteration));
    }
    check_all_second_stages(f);
    ck_assert_msg(fabs(f->accepted - f->expected) <= 5 * sqrt(f->variance) + 1e-9,
                  "%s, kind %d: accepted %g, by the reported probabilities %g +- %g", f->grammar->name, (int)f->kind,
                  f->accepted, f->expected, sqrt(f->variance));
}

typedef struct {
    fixture *f;
    size_t second;
    double missed; /* probability, from its state, of the likeliest second stage that never came up */
} reported;

/* What the chain reported; a second stage that never came up gets the formula. */
static double reported_accept(void *user, const kernel_model *m, const kernel_step *s, double p)
{
    reported *r = user;
    const size_t found = r->f->slots[slot_of(r->f, s)];
    test_must(found != 0);
    const known_step *k = r->f->known + found - 1;
    if (s->z != SIZE_MAX && m->log_score[s->z] > -INFINITY) { /* else it is known to be no use, and not reported */
        r->second++;
        r->missed = k->times > 0 ? r->missed : fmax(r->missed, p / m->pi[s->x]);
    }
    return k->times > 0 ? k->log_accept : kernel_right_accept(NULL, m, s, p);
}

/* The kernel made of what was seen keeps the target. */
static reported check_kernel(fixture *f)
{
    kernel_flow flow;
    reported r = {f, 0, 0};
    kernel_flow_init(&flow, &f->m);
    kernel_add(&flow, &f->m, f->kind, f->delayed, 1, reported_accept, &r);
    const double imbalance = kernel_imbalance(&flow, &f->m), irreversible = kernel_irreversibility(&flow, &f->m);
    ck_assert_msg(imbalance < 1e-12 && irreversible < 1e-14, "%s, beta %g, b %g: |pi K - pi| = %g, |F - F'| = %g",
                  f->grammar->name, f->m.beta, f->m.base, imbalance, irreversible);
    kernel_flow_clear(&flow);
    return r;
}

static void try_kernel(int which, sg_move_kind kind, bool delayed)
{
    fixture f;
    open_fixture(&f, which, kind, delayed);
    observe(&f);
    check_kernel(&f);
    close_fixture(&f);
}

START_TEST(reported_acceptances_keep_the_target)
{
    try_kernel(_i, SG_MOVE_JUMP_FRESH, false);
    try_kernel(_i, SG_MOVE_JUMP_COPY, true);
    if (_i % NFINITE < FIRST_WITH_VALUES) /* copies are no different where nothing is drawn */
        return;
    try_kernel(_i, SG_MOVE_JUMP_FRESH, true);
    try_kernel(_i, SG_MOVE_JUMP_COPY, false);
    try_kernel(_i, SG_MOVE_RESAMPLE, true);
}
END_TEST

/* Above, second stages that do not come up get the formula. Here every one is the chain's own, but for the rarest. */
START_TEST(all_second_stages_of_a_small_grammar_are_seen)
{
    for (int kind = SG_MOVE_JUMP_FRESH; kind <= SG_MOVE_JUMP_COPY; kind++) {
        fixture f;
        open_fixture(&f, FIRST_WITH_VALUES + 2 * _i * NFINITE, (sg_move_kind)kind, true);
        f.least_steps = 40000;
        observe(&f);
        const reported r = check_kernel(&f);
        ck_assert_msg(r.second > 5 && r.missed < 3e-4,
                      "turn %d, kind %d: one of %zu that has probability %g is not seen", _i, kind, r.second, r.missed);
        close_fixture(&f);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("kernels_exact");
    TCase *tc = tcase_create("exact");
    tcase_set_timeout(tc, 60);
    tcase_add_loop_test(tc, reported_acceptances_keep_the_target, 0, 3 * NFINITE);
    tcase_add_loop_test(tc, all_second_stages_of_a_small_grammar_are_seen, 0, 2);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
