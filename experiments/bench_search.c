/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench_search.c - how many moves a second chains make on photographs, move by move and as whole searches, and what energies
 * they reach. Prints figures, judges nothing. Rates of single moves are of processor time on one core. */
#include "core/random.h"
#include "parse/unaries.h"
#include "program/program.h"
#include "score/label_score.h"
#include "search/metropolis.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static const char help[] =
    "Example: bench_search ecp.sg unaries/ monge_2 monge_11\n"
    "Usage: bench_search [OPTION]... GRAMMAR PROBABILITIES NAME...\n"
    "PROBABILITIES is a folder of NAME.npy with their classes.tsv.\n\n"
    "  --runs N, --iterations N, --chains N, --tempering X, --swap-every N, --tries N, --anneal X\n"
    "                     the search (default: the published 5, 100000, 8, 1.3)\n"
    "  --shares A,B,C,D,E,F\n"
    "                     of jumps with fresh and with copied values, resampling, reflected steps, shifts, switches\n"
    "  --delayed 0|1      delayed rejection\n"
    "  --reflect-step X, --shift-step X, --depth-base X\n"
    "  --weight X         of the score (default 1)\n"
    "  --hard X           probability of the most probable class, of which alone is used then\n"
    "  --seconds X        for each rate of a single move (default 1; 0: none)\n" SG_COMMON_HELP;

enum { OPT_RUNS = SG_OPT_OWN, OPT_ITERATIONS, OPT_CHAINS, OPT_TEMPERING, OPT_SWAP, OPT_TRIES, OPT_ANNEAL, OPT_SHARES,
       OPT_DELAYED, OPT_REFLECT, OPT_SHIFT, OPT_BASE, OPT_WEIGHT, OPT_HARD, OPT_SECONDS };

static const struct option long_options[] = {SG_COMMON_LONG_OPTIONS,
                                             {"runs", required_argument, NULL, OPT_RUNS},
                                             {"iterations", required_argument, NULL, OPT_ITERATIONS},
                                             {"chains", required_argument, NULL, OPT_CHAINS},
                                             {"tempering", required_argument, NULL, OPT_TEMPERING},
                                             {"swap-every", required_argument, NULL, OPT_SWAP},
                                             {"tries", required_argument, NULL, OPT_TRIES},
                                             {"anneal", required_argument, NULL, OPT_ANNEAL},
                                             {"shares", required_argument, NULL, OPT_SHARES},
                                             {"delayed", required_argument, NULL, OPT_DELAYED},
                                             {"reflect-step", required_argument, NULL, OPT_REFLECT},
                                             {"shift-step", required_argument, NULL, OPT_SHIFT},
                                             {"depth-base", required_argument, NULL, OPT_BASE},
                                             {"weight", required_argument, NULL, OPT_WEIGHT},
                                             {"hard", required_argument, NULL, OPT_HARD},
                                             {"seconds", required_argument, NULL, OPT_SECONDS},
                                             {NULL, 0, NULL, 0}};

typedef struct {
    sg_metropolis_opts search;
    double weight, hard, seconds;
} options;

static bool read_shares(const char *arg, double *share)
{
    int used = 0, n = sscanf(arg, "%lf,%lf,%lf,%lf,%lf,%lf%n", share, share + 1, share + 2, share + 3, share + 4,
                             share + 5, &used);
    if (n == SG_MOVE_KINDS && arg[used] == '\0')
        return true;
    sg_program_usage("--shares takes %d numbers with commas between them", SG_MOVE_KINDS);
    return false;
}

static bool take(int opt, const char *arg, void *user)
{
    options *o = user;
    sg_metropolis_opts *s = &o->search;
    size_t flag = 0;
    switch (opt) {
    case OPT_RUNS: return sg_program_size("--runs", arg, 1, 1000, &s->runs);
    case OPT_ITERATIONS: return sg_program_size("--iterations", arg, 0, SIZE_MAX / 2, &s->iterations);
    case OPT_CHAINS: return sg_program_size("--chains", arg, 1, 1000, &s->chains);
    case OPT_TEMPERING: return sg_program_double("--tempering", arg, 1, 1e6, &s->tempering);
    case OPT_SWAP: return sg_program_size("--swap-every", arg, 1, SIZE_MAX / 2, &s->swap_every);
    case OPT_TRIES: return sg_program_size("--tries", arg, 1, SIZE_MAX / 2, &s->tries);
    case OPT_ANNEAL: return sg_program_double("--anneal", arg, 1, 1e9, &s->anneal);
    case OPT_SHARES: return read_shares(arg, s->kernel.share);
    case OPT_DELAYED:
        if (!sg_program_size("--delayed", arg, 0, 1, &flag))
            return false;
        s->kernel.delayed_rejection = flag != 0;
        return true;
    case OPT_REFLECT: return sg_program_double("--reflect-step", arg, 1e-9, 1e9, &s->kernel.reflect_step);
    case OPT_SHIFT: return sg_program_double("--shift-step", arg, 1e-9, 1e9, &s->kernel.shift_step);
    case OPT_BASE: return sg_program_double("--depth-base", arg, 1e-9, 1e9, &s->kernel.depth_base);
    case OPT_WEIGHT: return sg_program_double("--weight", arg, 1e-9, 1e9, &o->weight);
    case OPT_HARD: return sg_program_double("--hard", arg, 0, 1, &o->hard);
    default: return sg_program_double("--seconds", arg, 0, 1e6, &o->seconds);
    }
}

static double clock_s(clockid_t clock)
{
    struct timespec t;
    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ---- one photograph ---- */

typedef struct {
    const sg_grammar *g;
    const options *o;
    const sg_common_opts *common;
    sg_score *score;
    sg_metropolis_result result;
    sg_error *err;
} bench;

static sg_status read_score(bench *b, const char *folder, const char *name)
{
    sg_classes classes = {0};
    sg_float_map map = {0};
    char path[4096];
    uint32_t *channel = calloc(sg_grammar_symbol_count(b->g), sizeof *channel);
    snprintf(path, sizeof path, "%s/classes.tsv", folder);
    sg_status st = channel != NULL ? sg_classes_read(path, &classes, b->err) : SG_FAIL_NOMEM(b->err);
    if (st == SG_OK)
        st = sg_unaries_read(folder, name, classes.nclasses, 1e-4f, &map, b->err);
    if (st == SG_OK && b->o->hard > 0)
        st = sg_unaries_harden(&map, b->o->hard, b->err);
    if (st == SG_OK)
        st = sg_unaries_channels(b->g, &classes, channel, b->err);
    if (st == SG_OK) {
        sg_unaries_to_costs(&map);
        st = sg_label_score_create(b->g, &map, channel, b->o->weight, &b->score, b->err);
    }
    sg_classes_clear(&classes);
    sg_float_map_clear(&map);
    free(channel);
    return st;
}

static sg_status time_search(bench *b, int threads)
{
    sg_metropolis_opts opts = b->o->search;
    opts.threads = threads;
    opts.seed = b->common->seed;
    sg_metropolis_result_clear(&b->result);
    SG_TRY(sg_metropolis_run(b->g, b->score, &opts, NULL, NULL, NULL, &b->result, b->err));
    const sg_metropolis_result *r = &b->result;
    printf("  %d thread%s  %9.0f moves/s  %6.2f s  energy %.1f (image %.1f, rules %.1f, sizes %.1f), nodes %zu; runs", threads,
           threads == 1 ? " " : "s", (double)r->moves / r->seconds, r->seconds, -sg_posterior_log(&r->posterior),
           -r->posterior.score.log, -r->posterior.log_rules, -r->posterior.log_density, r->best.nnodes);
    for (size_t i = 0; i < r->nruns; i++)
        printf(" %.1f", -sg_posterior_log(&r->run_best[i]));
    printf("\n");
    return SG_OK;
}

static void print_acceptance(const sg_metropolis_result *r)
{
    static const char *const names[SG_MOVE_KINDS] = {"jump, fresh", "jump, copied", "resample", "reflect", "shift",
                                                        "switch"};
    for (int k = 0; k < SG_MOVE_KINDS; k++)
        if (r->stats.proposed[k] > 0)
            printf("  %-14s accepted %8.4f %%\n", names[k],
                   100 * (double)r->stats.accepted[k] / (double)r->stats.proposed[k]);
    if (r->stats.second_proposed > 0)
        printf("  %-14s accepted %8.4f %%\n", "second tries",
               100 * (double)r->stats.second_accepted / (double)r->stats.second_proposed);
    printf("  %-14s accepted %8.4f %%\n", "swaps", 100 * (double)r->swaps_accepted / fmax(1, (double)r->swaps_proposed));
}

/* Moves of one kind, or of all (SG_MOVE_KINDS), from where the search ended. */
static sg_status time_moves(bench *b, int kind, const char *name)
{
    sg_kernel_opts opts = b->o->search.kernel;
    for (int k = 0; k < SG_MOVE_KINDS; k++)
        opts.share[k] = kind == SG_MOVE_KINDS ? opts.share[k] : k == kind;
    sg_chain *c = NULL;
    SG_TRY(sg_chain_create(b->g, b->score, &opts, b->common->seed, 0, 1, &c, b->err));
    sg_status st = sg_chain_start(c, &b->result.best, 0, NULL, b->err);
    const double start = clock_s(CLOCK_PROCESS_CPUTIME_ID);
    double elapsed = 0;
    uint64_t n = 0;
    while (st == SG_OK && elapsed < b->o->seconds) {
        for (int i = 0; st == SG_OK && i < 1000; i++)
            st = sg_chain_step(c, ++n, NULL, b->err);
        elapsed = clock_s(CLOCK_PROCESS_CPUTIME_ID) - start;
    }
    if (st == SG_OK)
        printf("  %-26s %9.0f moves/s\n", name, (double)n / elapsed);
    sg_chain_free(c);
    return st;
}

static sg_status time_scratch(bench *b)
{
    sg_score_state *state = NULL;
    sg_score_value value;
    SG_TRY(sg_score_state_create(b->score, &state, b->err));
    sg_status st = SG_OK;
    const double start = clock_s(CLOCK_PROCESS_CPUTIME_ID);
    double elapsed = 0;
    uint64_t n = 0;
    while (st == SG_OK && elapsed < b->o->seconds) {
        for (int i = 0; st == SG_OK && i < 100; i++, n++)
            st = sg_score_evaluate(state, &b->result.best, &value, b->err);
        elapsed = clock_s(CLOCK_PROCESS_CPUTIME_ID) - start;
    }
    if (st == SG_OK)
        printf("  %-26s %9.0f scores/s\n", "the whole score anew", (double)n / elapsed);
    sg_score_state_free(state);
    return st;
}

static sg_status measure(bench *b)
{
    static const char *const names[SG_MOVE_KINDS + 1] = {"jumps, fresh values", "jumps, copied values", "resampling",
                                                         "reflected steps", "shifts", "switches", "all moves, one chain"};
    if (b->common->threads == 0) {
        SG_TRY(time_search(b, 1));
        SG_TRY(time_search(b, 2));
    } else {
        SG_TRY(time_search(b, b->common->threads));
    }
    if (!(b->o->seconds > 0))
        return SG_OK;
    print_acceptance(&b->result);
    for (int k = 0; k <= SG_MOVE_KINDS; k++)
        SG_TRY(time_moves(b, k, names[k]));
    return time_scratch(b);
}

static sg_status bench_photo(bench *b, const char *folder, const char *name)
{
    sg_status st = read_score(b, folder, name);
    if (st == SG_OK) {
        printf("%s\n", name);
        sg_derivation_init(&b->result.best, b->g);
        st = measure(b);
        sg_metropolis_result_clear(&b->result);
        fflush(stdout);
    }
    sg_score_free(b->score);
    b->score = NULL;
    return st;
}

int main(int argc, char **argv)
{
    sg_common_opts common = SG_COMMON_OPTS_INIT;
    options o = {SG_METROPOLIS_OPTS_INIT, 1, 0, 1};
    sg_program_begin("bench_search");
    const int code = sg_program_options(argc, argv, "", long_options, help, &common, take, &o);
    if (code >= 0)
        return code;
    if (argc - optind < 3)
        return sg_program_usage("a grammar, a folder and names are needed");
    sg_error err = SG_ERROR_INIT;
    sg_grammar *g = NULL;
    sg_status st = sg_grammar_load(argv[optind], &g, &err);
    bench b = {.g = g, .o = &o, .common = &common, .err = &err};
    for (int i = optind + 2; st == SG_OK && i < argc; i++)
        st = bench_photo(&b, argv[optind + 1], argv[i]);
    sg_grammar_free(g);
    return sg_program_end(st, &err);
}
