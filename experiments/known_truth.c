/* SPDX-License-Identifier: GPL-3.0-or-later */
/* known_truth.c - does learning find a grammar that it could have been shown?
 *
 *   known_truth [--lattices N] [--samples N] [--seeds N] [--weight W] GRAMMAR...
 *
 * Label lattices are drawn from each grammar in cell mode, and grammars are learned from them by beam search and
 * greedily. Printed per seed: the energies of both less that of the truth (the truth with the counts of its Viterbi
 * parses of the same lattices, rules that are not used left out), relative to the truth's; and the least
 * Bonferroni-corrected p of two-sample tests between lattices drawn from the truth and from the learned grammar:
 * numbers of rows, of columns, of each label, of each pair of neighbouring labels, by chi-square on their values. */
#include "config.h"

#include "core/random.h"
#include "learn/cell_sample.h"
#include "learn/learn.h"
#include "learn/reestimate.h"
#include "program/program.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BEST = 3 };
enum { OPT_LATTICES = SG_OPT_OWN, OPT_SAMPLES, OPT_SEEDS, OPT_WEIGHT, OPT_REGROUP };

static const char help[] = "Usage: known_truth GRAMMAR...\n"
                           "Learn grammars from lattices that grammars made, and compare with the truth.\n\n"
                           "  --lattices N       to learn from (default 40)\n"
                           "  --samples N        to compare, of each (default 150)\n"
                           "  --seeds N          (default 10)\n"
                           "  --weight W         of the prior (default 1)\n"
                           "  --regroup HOW      none, pairs, floors, best (default)\n" SG_COMMON_HELP;

typedef struct {
    sg_common_opts common;
    size_t lattices, samples, seeds;
    double weight;
    int regroup; /* sg_regroup_kind, or BEST */
} options;

static sg_status draw_lattices(const sg_split_form *f, size_t n, uint64_t seed, uint32_t chain, sg_arena *arena,
                               sg_lattice *out, sg_error *err)
{
    gsl_rng *rng = sg_random_create(seed);
    sg_status st = rng != NULL ? SG_OK : SG_FAIL_NOMEM(err);
    for (size_t i = 0; i < n && st == SG_OK; i++) {
        sg_random_stream(rng, seed, chain, i);
        st = sg_cell_sample(f, rng, 10000, 100000, arena, &out[i], NULL, err);
    }
    if (rng != NULL)
        gsl_rng_free(rng);
    return st;
}

/* ---- two-sample tests ---- */

/* Columns: rows, columns, labels, pairs side by side, pairs above each other. */
static size_t nstatistics(size_t nlabels)
{
    return 2 + nlabels + 2 * nlabels * nlabels;
}

static void measure(const sg_lattice *l, size_t nlabels, double *s)
{
    memset(s, 0, nstatistics(nlabels) * sizeof *s);
    s[0] = (double)l->height;
    s[1] = (double)l->width;
    for (size_t y = 0; y < l->height; y++)
        for (size_t x = 0; x < l->width; x++) {
            const size_t a = sg_lattice_label(l, x, y);
            s[2 + a]++;
            if (x + 1 < l->width)
                s[2 + nlabels + a * nlabels + sg_lattice_label(l, x + 1, y)]++;
            if (y + 1 < l->height)
                s[2 + nlabels + (nlabels + a) * nlabels + sg_lattice_label(l, x, y + 1)]++;
        }
}

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Chi-square test of homogeneity over value classes; neighbouring values are joined until ten are in each class. NaN:
 * there is one class only. */
static double two_sample_p(const double *u, const double *v, size_t n, double *scratch)
{
    memcpy(scratch, u, n * sizeof *u);
    memcpy(scratch + n, v, n * sizeof *v);
    qsort(scratch, 2 * n, sizeof *scratch, by_value);
    double chisq = 0;
    size_t classes = 0;
    for (size_t i = 0, end; i < 2 * n; i = end) {
        for (end = i; end < 2 * n && (end - i < 10 || scratch[end] == scratch[end - 1] || 2 * n - end < 10);)
            end++;
        double a = 0, b = 0;
        for (size_t k = 0; k < n; k++) {
            a += u[k] >= scratch[i] && u[k] <= scratch[end - 1];
            b += v[k] >= scratch[i] && v[k] <= scratch[end - 1];
        }
        chisq += (a - b) * (a - b) / (a + b);
        classes++;
    }
    return classes > 1 ? gsl_cdf_chisq_Q(chisq, (double)classes - 1) : NAN;
}

/* Least p times the number of tests. Labels of the learned grammar are put in the order of the truth's first. */
static double corrected_p(const sg_lattice *truth, const sg_lattice *learned, size_t n, size_t nlabels, sg_arena *arena)
{
    const size_t m = nstatistics(nlabels);
    double *s = SG_NEW_ARRAY(arena, double, 2 * n * m), *u = SG_NEW_ARRAY(arena, double, n);
    double *v = SG_NEW_ARRAY(arena, double, n), *scratch = SG_NEW_ARRAY(arena, double, 2 * n);
    for (size_t i = 0; i < n; i++) {
        measure(&truth[i], nlabels, s + i * m);
        measure(&learned[i], nlabels, s + (n + i) * m);
    }
    double least = 1;
    size_t tests = 0;
    for (size_t k = 0; k < m; k++) {
        for (size_t i = 0; i < n; i++) {
            u[i] = s[i * m + k];
            v[i] = s[(n + i) * m + k];
        }
        const double p = two_sample_p(u, v, n, scratch);
        if (isnan(p))
            continue;
        tests++;
        least = fmin(least, p);
    }
    return fmin(1, least * (double)tests);
}

static sg_status relabel(sg_lattice *l, const sg_split_form *truth, sg_error *err)
{
    uint16_t map[256];
    if (l->nlabels > 256 || sg_lattice_map_labels(l, truth->terminal_names, truth->nterminals, map) > 0)
        return SG_FAIL(err, SG_EINVAL, "the learned grammar has labels that the truth has not");
    for (size_t i = 0; i < l->width * l->height; i++)
        l->labels[i] = map[l->labels[i]];
    l->nlabels = truth->nterminals;
    return SG_OK;
}

/* ---- energies ---- */

static sg_status truth_energy(const sg_split_form *truth, const sg_lattice *lattices, size_t n, const sg_energy_opts *o,
                              sg_arena *arena, double *energy, sg_error *err)
{
    sg_corpus corpus;
    sg_rules r;
    sg_reestimator *e = NULL;
    const sg_reestimate_opts plain = {false, true};
    double *ones = SG_NEW_ARRAY(arena, double, truth->nrules);
    for (size_t i = 0; i < truth->nrules; i++)
        ones[i] = 1000 * truth->rules[i].probability; /* so that the first parse is under the truth's probabilities */
    SG_TRY(sg_corpus_create(lattices, n, truth, arena, &corpus, err));
    SG_TRY(sg_rules_create(&r, truth, ones, o, arena, err));
    sg_status st = sg_reestimator_create(&corpus, &plain, &e, err);
    if (st == SG_OK)
        st = sg_reestimate_until_stable(e, &r, 20, NULL, err);
    *energy = sg_rules_energy(&r);
    sg_reestimator_free(e);
    sg_rules_clear(&r);
    return st;
}

typedef struct {
    double truth, beam, greedy, p;
    size_t nonterminals, rules;
} outcome;

static sg_status run_seed(const sg_split_form *truth, const options *o, uint64_t seed, sg_arena *arena, outcome *out,
                          sg_error *err)
{
    const size_t most = o->lattices > o->samples ? o->lattices : o->samples;
    sg_lattice *l = SG_NEW_ARRAY(arena, sg_lattice, most), *m = SG_NEW_ARRAY(arena, sg_lattice, most);
    sg_learn_opts learn = SG_LEARN_OPTS_INIT;
    sg_learn_result r;
    learn.energy.weight = o->weight;
    learn.best_regroup = o->regroup == BEST;
    if (!learn.best_regroup)
        learn.incorporate.regroup = (sg_regroup_kind)o->regroup;
    SG_TRY(draw_lattices(truth, o->lattices, seed, 0, arena, l, err));
    SG_TRY(truth_energy(truth, l, o->lattices, &learn.energy, arena, &out->truth, err));
    SG_TRY(sg_learn(l, o->lattices, &learn, arena, &r, err));
    out->greedy = r.energy.energy;
    sg_learn_result_clear(&r);
    learn.search.kind = SG_SEARCH_BEAM;
    SG_TRY(sg_learn(l, o->lattices, &learn, arena, &r, err));
    out->beam = r.energy.energy;
    out->nonterminals = r.merged.nsymbols;
    out->rules = r.merged.nrules;
    sg_learn_result_clear(&r);
    SG_TRY(draw_lattices(truth, o->samples, seed, 1, arena, l, err));
    SG_TRY(draw_lattices(&r.merged, o->samples, seed, 2, arena, m, err));
    for (size_t i = 0; i < o->samples; i++)
        SG_TRY(relabel(&m[i], truth, err));
    out->p = corrected_p(l, m, o->samples, truth->nterminals, arena);
    return SG_OK;
}

static sg_status run_grammar(const char *path, const options *o, sg_error *err)
{
    sg_grammar *g;
    sg_split_form truth;
    sg_arena *forms = sg_arena_create(), *arena = sg_arena_create();
    size_t beam_good = 0, greedy_good = 0, alike = 0;
    SG_TRY(sg_grammar_load(path, &g, err));
    sg_status st = sg_split_form_of(g, forms, &truth, err);
    if (st == SG_OK)
        printf("%s: %zu symbols, %zu rules\nseed\ttruth\tbeam\tgreedy\tsymbols\trules\tp\n", path, truth.nsymbols,
               truth.nrules);
    for (size_t seed = 1; seed <= o->seeds && st == SG_OK; seed++) {
        outcome out;
        sg_arena_reset(arena);
        st = run_seed(&truth, o, seed + 1000 * o->common.seed, arena, &out, err);
        if (st != SG_OK)
            break;
        const double scale = fabs(out.truth), beam = (out.beam - out.truth) / scale,
                     greedy = (out.greedy - out.truth) / scale;
        beam_good += beam <= 1e-9;
        greedy_good += greedy <= 0.01;
        alike += out.p > 0.01;
        printf("%zu\t%.3f\t%+.3f%%\t%+.3f%%\t%zu\t%zu\t%.3g\n", seed, out.truth, 100 * beam, 100 * greedy,
               out.nonterminals, out.rules, out.p);
        fflush(stdout);
    }
    if (st == SG_OK)
        printf("beam at or below the truth: %zu of %zu; greedy within 1 %% or below: %zu; samples alike (p > 0.01): "
               "%zu\n\n",
               beam_good, o->seeds, greedy_good, alike);
    sg_grammar_free(g);
    sg_arena_free(arena);
    sg_arena_free(forms);
    return st;
}

static bool set_option(int opt, const char *arg, options *o)
{
    static const char *const regroups[] = {"none", "pairs", "floors", "best", NULL};
    switch (opt) {
    case OPT_LATTICES:
        return sg_program_size("--lattices", arg, 1, 100000, &o->lattices);
    case OPT_SAMPLES:
        return sg_program_size("--samples", arg, 20, 100000, &o->samples);
    case OPT_SEEDS:
        return sg_program_size("--seeds", arg, 1, 1000, &o->seeds);
    case OPT_WEIGHT:
        return sg_program_double("--weight", arg, 0, 1e6, &o->weight);
    default: /* OPT_REGROUP */
        return sg_program_choice("--regroup", arg, regroups, &o->regroup);
    }
}

int main(int argc, char **argv)
{
    static const struct option long_options[] = {{"lattices", required_argument, NULL, OPT_LATTICES},
                                                 {"samples", required_argument, NULL, OPT_SAMPLES},
                                                 {"seeds", required_argument, NULL, OPT_SEEDS},
                                                 {"weight", required_argument, NULL, OPT_WEIGHT},
                                                 {"regroup", required_argument, NULL, OPT_REGROUP},
                                                 SG_COMMON_LONG_OPTIONS,
                                                 {NULL, 0, NULL, 0}};
    options o = {SG_COMMON_OPTS_INIT, 40, 150, 10, 1, BEST};
    sg_error err = SG_ERROR_INIT;
    sg_program_begin("known_truth");
    for (int opt; (opt = getopt_long(argc, argv, "", long_options, NULL)) != -1;) {
        const sg_option_result r = sg_program_option(opt, optarg, help, &o.common);
        if (r == SG_OPTION_EXIT_OK)
            return sg_program_end(SG_OK, NULL);
        if (r == SG_OPTION_BAD || (r == SG_OPTION_OTHER && !set_option(opt, optarg, &o)))
            return 2;
    }
    if (optind == argc)
        return sg_program_usage("a grammar is missing");
    sg_status st = SG_OK;
    for (int i = optind; i < argc && st == SG_OK; i++)
        st = run_grammar(argv[i], &o, &err);
    return sg_program_end(st, &err);
}
