/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_metropolis.c - runs of tempered chains: the same bytes with any number of threads, what is reported against what was seen,
 * ends of every kind. */
#include "search/metropolis.h"

#include "tests/failing_malloc.h"
#include "tests/function_score.h"
#include "tests/grammar_support.h"

#include <string.h>

static const char sized[] = "label t\nlabel w\nstart S\n"
                            "rule S -> 0.2 : split x { S | R | S } sizes mean (0.4, 0.2, 0.4) sd (0.1, 0.1, 0.1)\n"
                            "       -> 0.25 : split y { S | R } sizes mean (0.5, 0.5) sd (0.05, 0.05)\n"
                            "       -> 0.55 : t\n"
                            "rule R -> 0.7 : split x { t | w | t | w } sizes mean (0.3, 0.2, 0.3, 0.2) sd (0.1, 0.1, 0.1, 0.1)\n"
                            "       -> 0.3 : w\n";

static double wants(const sg_derivation *d)
{
    double sum = 0;
    for (size_t i = 0; i < d->nvalues; i++)
        sum -= fabs(d->values[i] - 0.35);
    return 20 * sum - fabs((double)d->nnodes - 18);
}

static double impossible(const sg_derivation *d)
{
    (void)d;
    return -INFINITY;
}

static const sg_kernel_opts kernel = {{0.2, 0.2, 0.2, 0.2, 0.2, 0.2}, true, 8, 1, 0.1, 0.5, 300};

static sg_metropolis_opts small_opts(void)
{
    sg_metropolis_opts o = SG_METROPOLIS_OPTS_INIT;
    o.runs = 3;
    o.iterations = 1030; /* the last block is shorter */
    o.chains = 4;
    o.swap_every = 50;
    o.tries = 4;
    o.kernel = kernel;
    return o;
}

/* Everything that a sampler hears, as one number after the other. */
typedef struct {
    double heard[5000];
    size_t n;
    size_t fail_after;
} listener;

static sg_status listen(void *user, size_t run, uint64_t iteration, const sg_derivation *cold, const sg_posterior *p,
                        sg_error *err)
{
    listener *l = user;
    if (l->n + 5 > 5000 || l->n / 5 >= l->fail_after)
        return SG_FAIL(err, SG_EIO, "heard enough");
    l->heard[l->n++] = (double)run;
    l->heard[l->n++] = (double)iteration;
    l->heard[l->n++] = (double)cold->nnodes;
    l->heard[l->n++] = p->score.log;
    l->heard[l->n++] = wants(cold);
    return SG_OK;
}

typedef struct {
    sg_grammar *g;
    function_score score;
    sg_metropolis_result result;
    listener listener;
} fixture;

static void open_fixture(fixture *f)
{
    memset(f, 0, sizeof *f);
    f->g = test_grammar(sized);
    f->score = (function_score){{&function_ops}, wants, true};
    f->listener.fail_after = SIZE_MAX;
}

static sg_status run(fixture *f, const sg_metropolis_opts *o, sg_progress *progress, sg_error *err)
{
    const sg_sampler sampler = {120, listen, &f->listener};
    f->listener.n = 0;
    return sg_metropolis_run(f->g, &f->score.base, o, NULL, &sampler, progress, &f->result, err);
}

static void close_fixture(fixture *f)
{
    sg_metropolis_result_clear(&f->result);
    sg_grammar_free(f->g);
}

static bool same(const sg_derivation *a, const sg_derivation *b)
{
    return a->nnodes == b->nnodes && a->nvalues == b->nvalues && a->nuniforms == b->nuniforms &&
           memcmp(a->nodes, b->nodes, a->nnodes * sizeof *a->nodes) == 0 &&
           memcmp(a->values, b->values, a->nvalues * sizeof *a->values) == 0 &&
           memcmp(a->uniforms, b->uniforms, a->nuniforms * sizeof *a->uniforms) == 0;
}

static bool same_trace(const sg_metropolis_result *a, const sg_metropolis_result *b)
{
    bool same = a->ntrace == b->ntrace;
    for (size_t i = 0; same && i < a->ntrace; i++) {
        const sg_trace_line *x = a->trace + i, *y = b->trace + i;
        same = x->run == y->run && x->iteration == y->iteration && memcmp(&x->cold, &y->cold, sizeof x->cold) == 0 &&
               memcmp(&x->best, &y->best, sizeof x->best) == 0;
    }
    return same;
}

START_TEST(any_number_of_threads_gives_the_same)
{
    sg_error err = SG_ERROR_INIT;
    sg_metropolis_opts o = small_opts();
    o.anneal = _i == 0 ? 1 : 4;
    fixture f[3];
    for (int i = 0; i < 3; i++) {
        open_fixture(&f[i]);
        o.threads = (const int[]){1, 2, 5}[i];
        ck_ok(run(&f[i], &o, NULL, &err));
        const sg_metropolis_result *a = &f[0].result, *b = &f[i].result;
        ck_assert(same(&a->best, &b->best) && same_trace(a, b));
        ck_assert(memcmp(&a->stats, &b->stats, sizeof a->stats) == 0);
        ck_assert(a->swaps_proposed == b->swaps_proposed && a->swaps_accepted == b->swaps_accepted);
        ck_assert_uint_eq(f[0].listener.n, f[i].listener.n);
        ck_assert(memcmp(f[0].listener.heard, f[i].listener.heard, f[0].listener.n * sizeof(double)) == 0);
    }
    for (int i = 0; i < 3; i++)
        close_fixture(&f[i]);
}
END_TEST

/* The runs are numbered chains: asking for more of them does not change the first. */
START_TEST(more_runs_leave_the_first_as_it_is)
{
    sg_error err = SG_ERROR_INIT;
    fixture f[2];
    sg_metropolis_opts o = small_opts();
    for (int i = 0; i < 2; i++) {
        open_fixture(&f[i]);
        o.runs = i == 0 ? 1 : 3;
        ck_ok(run(&f[i], &o, NULL, &err));
        ck_assert(memcmp(&f[0].result.run_best[0], &f[i].result.run_best[0], sizeof(sg_posterior)) == 0);
    }
    ck_assert(sg_posterior_log(&f[1].result.posterior) >= sg_posterior_log(&f[0].result.posterior));
    close_fixture(&f[0]);
    close_fixture(&f[1]);
}
END_TEST

START_TEST(what_is_reported_is_what_is)
{
    sg_error err = SG_ERROR_INIT;
    fixture f;
    open_fixture(&f);
    const sg_metropolis_opts o = small_opts();
    ck_ok(run(&f, &o, NULL, &err));
    const sg_metropolis_result *r = &f.result;
    double log_rules, log_density;
    ck_ok(sg_derivation_check(&r->best, &err));
    ck_ok(sg_derivation_log_prior(&r->best, &log_rules, &err));
    ck_ok(sg_derivation_log_density(&r->best, &log_density, &err));
    ck_assert_double_eq(r->posterior.score.log, wants(&r->best));
    ck_assert_double_eq_tol(r->posterior.log_rules, log_rules, 1e-9);
    ck_assert_double_eq_tol(r->posterior.log_density, log_density, 1e-9);
    ck_assert_uint_eq(r->nruns, 3);
    for (size_t i = 0; i < 3; i++)
        ck_assert(sg_posterior_log(&r->run_best[i]) <= sg_posterior_log(&r->run_best[r->best_run]));
    ck_assert_double_eq(sg_posterior_log(&r->run_best[r->best_run]), sg_posterior_log(&r->posterior));
    ck_assert_uint_eq(r->moves, 3 * 4 * 1030);
    uint64_t proposed = 0;
    for (int k = 0; k < SG_MOVE_KINDS; k++)
        proposed += r->stats.proposed[k];
    ck_assert(proposed < r->moves && proposed > r->moves / 5);
    ck_assert_uint_eq(r->swaps_proposed, 3 * (11 * 1 + 10 * 2));
    ck_assert(r->swaps_accepted > 10 && r->swaps_accepted < r->swaps_proposed);
    ck_assert_uint_eq(r->ntrace, 3 * 21);
    for (size_t i = 0; i < r->ntrace; i++) {
        const sg_trace_line *t = r->trace + i;
        ck_assert_uint_eq(t->run, i % 3);
        ck_assert_uint_eq(t->iteration, i / 3 == 20 ? 1030 : 50 * (i / 3 + 1));
        ck_assert(sg_posterior_log(&t->cold) <= sg_posterior_log(&t->best));
        ck_assert(i < 3 || sg_posterior_log(&t->best) >= sg_posterior_log(&t[-3].best));
    }
    for (size_t run = 0; run < 3; run++)
        ck_assert(memcmp(&r->trace[60 + run].best, &r->run_best[run], sizeof(sg_posterior)) == 0);
    /* every 120 iterations, rounded up to blocks of 50: 150, 250, 400, ... */
    static const double at[] = {150, 250, 400, 500, 600, 750, 850, 1000};
    ck_assert_uint_eq(f.listener.n, 5 * 3 * 8);
    for (size_t i = 0; i < 24; i++) {
        const double *h = f.listener.heard + 5 * i;
        ck_assert_double_eq(h[0], (double)(i % 3));
        ck_assert_double_eq(h[1], at[i / 3]);
        ck_assert_double_eq(h[3], h[4]);
    }
    close_fixture(&f);
}
END_TEST

START_TEST(long_runs_are_traced_in_about_200_lines)
{
    sg_error err = SG_ERROR_INIT;
    fixture f;
    open_fixture(&f);
    sg_metropolis_opts o = small_opts();
    o.runs = 1;
    o.chains = 2;
    o.iterations = 2345;
    o.swap_every = 2;
    ck_ok(sg_metropolis_run(f.g, &f.score.base, &o, NULL, NULL, NULL, &f.result, &err));
    ck_assert(f.result.ntrace >= 100 && f.result.ntrace <= 201);
    ck_assert_uint_eq(f.result.trace[f.result.ntrace - 1].iteration, 2345);
    close_fixture(&f);
}
END_TEST

START_TEST(equal_temperatures_always_swap)
{
    sg_error err = SG_ERROR_INIT;
    fixture f;
    open_fixture(&f);
    sg_metropolis_opts o = small_opts();
    o.tempering = 1;
    ck_ok(run(&f, &o, NULL, &err));
    ck_assert_uint_eq(f.result.swaps_accepted, f.result.swaps_proposed);
    close_fixture(&f);
}
END_TEST

START_TEST(a_start_is_where_all_chains_begin)
{
    sg_error err = SG_ERROR_INIT;
    fixture f, g;
    open_fixture(&f);
    sg_metropolis_opts o = small_opts();
    ck_ok(run(&f, &o, NULL, &err));
    o.iterations = 0;
    open_fixture(&g);
    sg_derivation start;
    sg_derivation_init(&start, g.g);
    ck_ok(sg_derivation_copy(&start, &f.result.best, &err));
    start.grammar = g.g;
    ck_ok(sg_metropolis_run(g.g, &g.score.base, &o, &start, NULL, NULL, &g.result, &err));
    ck_assert(same(&g.result.best, &start));
    ck_assert_uint_eq(g.result.moves, 0);
    for (size_t i = 0; i < 3; i++)
        ck_assert_double_eq(g.result.run_best[i].score.log, f.result.posterior.score.log);
    sg_derivation_clear(&start);
    close_fixture(&f);
    close_fixture(&g);
}
END_TEST

typedef struct {
    size_t stop_after, reports;
} stopper;

static bool stop_now(sg_progress *p)
{
    stopper *s = p->user;
    return s->reports >= s->stop_after;
}

static void report(sg_progress *p, const char *step, size_t done, size_t total)
{
    (void)step;
    ((stopper *)p->user)->reports++;
    ck_assert(done <= total);
}

START_TEST(a_stopped_search_has_its_best_so_far)
{
    sg_error err = SG_ERROR_INIT;
    fixture f;
    open_fixture(&f);
    const sg_metropolis_opts o = small_opts();
    stopper s = {7, 0};
    sg_progress progress = {report, stop_now, &s};
    ck_assert_int_eq(run(&f, &o, &progress, &err), SG_STOPPED);
    ck_assert_uint_eq(f.result.moves, 7 * 50 * 12);
    ck_assert_uint_eq(s.reports, 7);
    ck_assert_double_eq(f.result.posterior.score.log, wants(&f.result.best));
    ck_ok(sg_derivation_check(&f.result.best, &err));
    /* and it is what a search of so many iterations finds */
    fixture g;
    open_fixture(&g);
    sg_metropolis_opts shorter = o;
    shorter.iterations = 350;
    ck_ok(run(&g, &shorter, NULL, &err));
    ck_assert_double_eq(sg_posterior_log(&g.result.posterior), sg_posterior_log(&f.result.posterior));
    close_fixture(&f);
    close_fixture(&g);
}
END_TEST

START_TEST(a_search_can_be_stopped_while_it_begins)
{
    sg_error err = SG_ERROR_INIT;
    sg_metropolis_opts o = small_opts();
    o.tries = 1000000000; /* hours */
    stopper s = {0, 0};
    sg_progress progress = {report, stop_now, &s};
    fixture f;
    open_fixture(&f);
    ck_assert_int_eq(run(&f, &o, &progress, &err), SG_STOPPED);
    ck_assert(f.result.moves == 0 && f.result.nruns == o.runs);
    ck_ok(sg_derivation_check(&f.result.best, &err));
    sg_metropolis_result_clear(&f.result);
    o.time_s = 1e-9;
    ck_ok(run(&f, &o, NULL, &err));
    sg_metropolis_result_clear(&f.result);
    f.score.log_of = impossible; /* nothing is found at all */
    ck_assert_int_eq(run(&f, &o, &progress, &err), SG_STOPPED);
    ck_assert(f.result.nruns == 0 && f.result.best.nnodes == 0);
    ck_assert_int_eq(run(&f, &o, NULL, &err), SG_ENOPARSE);
    close_fixture(&f);
}
END_TEST

START_TEST(time_ends_a_search_well)
{
    sg_error err = SG_ERROR_INIT;
    fixture f;
    open_fixture(&f);
    sg_metropolis_opts o = small_opts();
    o.time_s = 1e-9;
    ck_ok(run(&f, &o, NULL, &err));
    ck_assert_uint_eq(f.result.moves, 50 * 12);
    ck_assert(f.result.seconds > 0);
    close_fixture(&f);
}
END_TEST

START_TEST(annealing_ends_higher)
{
    sg_error err = SG_ERROR_INIT;
    double log[2];
    for (int i = 0; i < 2; i++) {
        fixture f;
        open_fixture(&f);
        sg_metropolis_opts o = small_opts();
        o.iterations = 8000;
        o.runs = 1;
        o.anneal = i == 0 ? 1 : 200;
        ck_ok(run(&f, &o, NULL, &err));
        log[i] = sg_posterior_log(&f.result.posterior);
        if (i == 1) /* at the end it stands at the top */
            ck_assert_double_ge(sg_posterior_log(&f.result.trace[f.result.ntrace - 1].cold), log[1] - 0.1);
        close_fixture(&f);
    }
    ck_assert_msg(log[1] > log[0], "%g with annealing, %g without", log[1], log[0]);
}
END_TEST

START_TEST(failures_are_reported_and_leave_nothing)
{
    sg_error err = SG_ERROR_INIT;
    fixture f;
    open_fixture(&f);
    for (int i = 0; i < 9; i++) {
        sg_metropolis_opts o = small_opts();
        switch (i) {
        case 0: o.runs = 0; break;
        case 1: o.chains = 0; break;
        case 2: o.swap_every = 0; break;
        case 3: o.tempering = 0.9; break;
        case 4: o.anneal = 0; break;
        case 5: o.time_s = -1; break;
        case 6: o.threads = -1; break;
        case 7: o.kernel.share[2] = NAN; break;
        default: o.runs = SIZE_MAX / 2; break;
        }
        ck_assert_int_eq(run(&f, &o, NULL, &err), SG_EINVAL);
        ck_assert(f.result.best.nnodes == 0 && f.result.trace == NULL && f.result.run_best == NULL);
    }
    const sg_metropolis_opts o = small_opts();
    f.listener.fail_after = 4;
    ck_assert_int_eq(run(&f, &o, NULL, &err), SG_EIO);
    ck_assert_str_eq(err.msg, "heard enough");
    ck_assert(f.result.best.nnodes == 0 && f.result.trace == NULL);
    f.score.log_of = impossible;
    ck_assert_int_eq(run(&f, &o, NULL, &err), SG_ENOPARSE);
    ck_assert(f.result.best.nnodes == 0);
    close_fixture(&f);
}
END_TEST

/* A grammar that fails now and then: the error is that of the first chain that meets it, with any number of threads. */
START_TEST(a_failing_grammar_is_reported_the_same_with_any_number_of_threads)
{
    sg_grammar *g = test_grammar("label t\nstart S\nrule S -> u ~ uniform(0, 1) split x { A(u) | t }\n"
                                 "rule A(u) if u < 0.999 -> w ~ uniform(0, 0.99 - u) t\n");
    function_score score = {{&function_ops}, wants, false};
    char first[1024] = "";
    for (int threads = 1; threads < 5; threads++) {
        sg_error err = SG_ERROR_INIT;
        sg_metropolis_result r;
        sg_metropolis_opts o = small_opts();
        o.threads = threads;
        ck_assert_int_eq(sg_metropolis_run(g, &score.base, &o, NULL, NULL, NULL, &r, &err), SG_ENUMERIC);
        if (threads == 1)
            memcpy(first, err.msg, sizeof first);
        ck_assert_str_eq(err.msg, first);
        sg_metropolis_result_clear(&r);
    }
    ck_assert_str_ne(first, "");
    sg_grammar_free(g);
}
END_TEST

START_TEST(failed_allocations_are_reported)
{
    sg_error err = SG_ERROR_INIT;
    fixture f;
    open_fixture(&f);
    sg_metropolis_opts o = small_opts();
    o.threads = 1;
    o.runs = 2;
    o.chains = 2;
    o.iterations = 300;
    size_t failures = 0, swaps = 0;
    bool done = false;
    for (size_t k = 0; !done && k < 2000; k += 1 + k / 50) {
        test_fail_allocation(k);
        const sg_status st = run(&f, &o, NULL, &err);
        const int failed = test_allocation_failed();
        done = !failed;
        failures += st == SG_ENOMEM;
        swaps += failed && st == SG_OK; /* a swap that did not happen for want of memory */
        ck_assert(st == SG_OK || (st == SG_ENOMEM && failed));
        ck_assert(st == SG_OK || f.result.best.nnodes == 0);
        sg_metropolis_result_clear(&f.result);
    }
    ck_assert(done && failures > 50 && swaps < failures / 4);
    close_fixture(&f);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("metropolis");
    TCase *tc = tcase_create("metropolis");
    tcase_set_timeout(tc, 120);
    tcase_add_loop_test(tc, any_number_of_threads_gives_the_same, 0, 2);
    tcase_add_test(tc, more_runs_leave_the_first_as_it_is);
    tcase_add_test(tc, what_is_reported_is_what_is);
    tcase_add_test(tc, long_runs_are_traced_in_about_200_lines);
    tcase_add_test(tc, equal_temperatures_always_swap);
    tcase_add_test(tc, a_start_is_where_all_chains_begin);
    tcase_add_test(tc, a_stopped_search_has_its_best_so_far);
    tcase_add_test(tc, a_search_can_be_stopped_while_it_begins);
    tcase_add_test(tc, time_ends_a_search_well);
    tcase_add_test(tc, annealing_ends_higher);
    tcase_add_test(tc, failures_are_reported_and_leave_nothing);
    tcase_add_test(tc, a_failing_grammar_is_reported_the_same_with_any_number_of_threads);
    tcase_add_test(tc, failed_allocations_are_reported);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
