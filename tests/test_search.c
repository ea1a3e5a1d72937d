/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_search.c - chunks, re-estimation by parsing, the searches, and learning from start to end. */
#include "learn/cell_sample.h"
#include "learn/chunk.h"
#include "learn/learn.h"
#include "learn/merge.h"
#include "tests/learn_support.h"
#include "tests/support.h"

#include <math.h>
#include <string.h>

typedef struct {
    sg_arena *arena;
    gsl_rng *rng;
    sg_lattice lattices[16];
    size_t n;
    sg_split_form form;
    double *counts;
    sg_corpus corpus;
    sg_energy_opts opts;
    sg_rules rules;
    sg_error err;
} corpus_case;

static void start_case(corpus_case *c, int seed, size_t n, double noise, sg_share share, bool regroup)
{
    sg_error err = SG_ERROR_INIT;
    memset(c, 0, sizeof *c);
    c->arena = sg_arena_create();
    c->rng = sg_random_create((uint64_t)seed + 1);
    c->n = n;
    for (size_t i = 0; i < n; i++)
        c->lattices[i] = test_random_facade(c->rng, c->arena, noise);
    sg_incorporate_opts inc = SG_INCORPORATE_OPTS_INIT;
    inc.share = share;
    inc.regroup = regroup ? SG_REGROUP_PAIRS + (unsigned)seed % 2 : SG_REGROUP_NONE;
    ck_ok(sg_incorporate(c->lattices, n, &inc, c->arena, &c->form, &c->counts, &err));
    ck_ok(sg_corpus_create(c->lattices, n, &c->form, c->arena, &c->corpus, &err));
    const sg_energy_opts o = SG_ENERGY_OPTS_INIT;
    c->opts = o;
    c->opts.weight = seed % 2 == 0 ? 0.3 : 1;
    c->opts.data_term = seed % 3 == 0 ? SG_DATA_VITERBI : SG_DATA_MARGINAL;
    ck_ok(sg_rules_create(&c->rules, &c->form, c->counts, &c->opts, c->arena, &err));
}

static void end_case(corpus_case *c)
{
    sg_rules_clear(&c->rules);
    gsl_rng_free(c->rng);
    sg_arena_free(c->arena);
}

#define ck_near(got, want) ck_assert_double_eq_tol(got, want, 1e-9 * (1 + fabs(want)))

static double scratch_energy(const sg_rules *r)
{
    sg_error err = SG_ERROR_INIT;
    sg_energy_parts parts;
    ck_ok(sg_rules_energy_parts(r, &parts, &err));
    return parts.energy;
}

/* ---- chunks ---- */

/* Every sequence of every rule, scored one by one. */
static bool brute_best_chunk(const sg_rules *r, double *best)
{
    bool found = false;
    for (uint32_t i = 0; i < r->nrules; i++) {
        const sg_learn_rule *x = &r->rules[i];
        for (uint32_t n = 2; x->alive && x->op != SG_SPLIT_LEXICAL && n <= x->n && n <= SG_CHUNK_MAX; n++)
            for (uint32_t at = 0; at + n <= x->n; at++) {
                const uint32_t *rhs = sg_rules_rhs(r, i) + at;
                size_t places = 0;
                for (uint32_t j = 0; j < r->nrules; j++)
                    for (uint32_t k = 0; r->rules[j].alive && r->rules[j].op == x->op && k + n <= r->rules[j].n; k++)
                        places += memcmp(sg_rules_rhs(r, j) + k, rhs, n * sizeof *rhs) == 0;
                const double delta = sg_chunk_delta(r, x->op, rhs, n);
                if (places >= 2 && (!found || delta < *best)) {
                    found = true;
                    *best = delta;
                }
            }
    }
    return found;
}

START_TEST(the_best_chunk_is_the_best_and_changes_the_energy_as_foretold)
{
    sg_error err = SG_ERROR_INIT;
    corpus_case c;
    start_case(&c, _i, 8, 0.05, SG_SHARE_EQUAL, _i % 2 == 0);
    for (int step = 0; step < 30; step++) {
        sg_chunk chunk;
        bool found;
        double brute = 0;
        uint32_t symbol;
        ck_ok(sg_chunk_best(&c.rules, &chunk, &found, &err));
        ck_assert_int_eq(brute_best_chunk(&c.rules, &brute), found);
        if (!found)
            break;
        ck_near(chunk.delta, brute);
        const double before = sg_rules_energy(&c.rules);
        ck_ok(sg_chunk_apply(&c.rules, &chunk, "K", &symbol, &err));
        ck_near(sg_rules_energy(&c.rules), before + chunk.delta);
        ck_near(sg_rules_energy(&c.rules), scratch_energy(&c.rules));
    }
    /* sizes went with the rules: as many rows as uses, each of sum 1 */
    sg_split_form form;
    double *counts;
    ck_ok(sg_rules_form(&c.rules, true, c.arena, &form, NULL, &counts, &err));
    for (size_t i = 0; i < form.nrules; i++) {
        const sg_split_rule *x = &form.rules[i];
        if (x->op == SG_SPLIT_LEXICAL)
            continue;
        ck_assert_double_eq((double)x->nattributes, counts[i]);
        for (size_t k = 0; k < x->nattributes; k++) {
            double sum = 0;
            for (uint32_t j = 0; j < x->n; j++)
                sum += x->attributes[k * x->n + j];
            ck_assert_double_eq_tol(sum, 1, 1e-12);
        }
    }
    /* and the grammar makes the lattices with the same counts */
    sg_reestimator *e;
    sg_reestimate_result result;
    const sg_reestimate_opts plain = {false, true};
    ck_ok(sg_reestimator_create(&c.corpus, &plain, &e, &err));
    ck_ok(sg_reestimate(e, &c.rules, &result, &err));
    ck_near(sg_rules_energy(&c.rules), scratch_energy(&c.rules));
    sg_reestimator_free(e);
    end_case(&c);
}
END_TEST

/* ---- re-estimation ---- */

static double log_viterbi_of_all(corpus_case *c, const sg_rules *r)
{
    sg_error err = SG_ERROR_INIT;
    sg_split_form form;
    sg_parse_table *t;
    sg_chart *chart;
    double sum = 0;
    ck_ok(sg_rules_form(r, false, c->arena, &form, NULL, NULL, &err));
    ck_ok(sg_parse_table_create(&form, SG_CELL_MODE, &t, &err));
    ck_ok(sg_chart_create(&chart, &err));
    for (size_t i = 0; i < c->n; i++) {
        double v;
        ck_ok(sg_earley_viterbi(t, &c->corpus.cells[i], chart, &v, &err));
        sum += v;
    }
    sg_chart_free(chart);
    sg_parse_table_free(t);
    return sum;
}

/* Random merges: every lattice stays in the language, and what is carried along is a lower bound. */
START_TEST(merged_grammars_keep_their_lattices)
{
    sg_error err = SG_ERROR_INIT;
    corpus_case c;
    start_case(&c, 3 * _i, 6, 0.1, SG_SHARE_NONE, _i % 2 == 0);
    ck_assert_int_eq(c.opts.data_term, SG_DATA_VITERBI);
    for (int miss = 0; miss < 300; miss++) {
        const uint32_t a = (uint32_t)gsl_rng_uniform_int(c.rng, c.rules.nsymbols);
        const uint32_t b = (uint32_t)gsl_rng_uniform_int(c.rng, c.rules.nsymbols);
        if (!sg_rules_compatible(&c.rules, a, b))
            continue;
        ck_ok(sg_merge_apply(&c.rules, a, b, &err));
        miss = 0;
        if (gsl_rng_uniform_int(c.rng, 4) != 0)
            continue;
        sg_energy_parts parts;
        ck_ok(sg_rules_energy_parts(&c.rules, &parts, &err));
        const double reparsed = log_viterbi_of_all(&c, &c.rules);
        ck_assert(reparsed > -INFINITY);
        ck_assert_msg(parts.log_likelihood <= reparsed + 1e-9 * fabs(reparsed), "%.12g > %.12g", parts.log_likelihood,
                      reparsed);
    }
    end_case(&c);
}
END_TEST

static void run_greedy_with(corpus_case *c, bool parse_all, bool chunk, sg_rules *r, size_t *parsed)
{
    sg_error err = SG_ERROR_INIT;
    const sg_reestimate_opts how = {false, parse_all};
    sg_search_opts o = SG_SEARCH_OPTS_INIT;
    sg_search_history h = {0};
    o.chunk = chunk;
    ck_ok(sg_reestimator_create(&c->corpus, &how, &o.every, &err));
    ck_ok(sg_rules_copy(r, &c->rules, &err));
    ck_ok(sg_search(r, &o, &h, &err));
    *parsed = h.parsed;
    sg_search_history_clear(&h);
    sg_reestimator_free(o.every);
}

/* Leaving lattices out must change nothing, and must leave some out. */
START_TEST(parsing_less_gives_what_parsing_all_gives)
{
    sg_error err = SG_ERROR_INIT;
    corpus_case c;
    sg_rules some = {0}, all = {0};
    size_t parsed_some, parsed_all;
    start_case(&c, _i, 8, _i % 4 == 0 ? 0 : 0.04, _i % 5 == 0 ? SG_SHARE_NONE : SG_SHARE_EQUAL, _i % 2 == 0);
    c.rules.energy_opts.weight = _i % 3 == 0 ? 2 : 0.5; /* a strong prior merges rows with lexical symbols too */
    for (uint32_t s = 0; s < c.rules.nsymbols; s++)
        sg_rules_refresh_symbol(&c.rules, s);
    run_greedy_with(&c, false, _i % 7 == 0, &some, &parsed_some);
    run_greedy_with(&c, true, _i % 7 == 0, &all, &parsed_all);
    sg_split_form f, g;
    double *fc, *gc;
    ck_ok(sg_rules_form(&some, false, c.arena, &f, NULL, &fc, &err));
    ck_ok(sg_rules_form(&all, false, c.arena, &g, NULL, &gc, &err));
    ck_assert_uint_eq(f.nrules, g.nrules);
    ck_assert_uint_eq(f.nsymbols, g.nsymbols);
    for (size_t i = 0; i < f.nrules; i++) {
        ck_assert_uint_eq(f.rules[i].lhs, g.rules[i].lhs);
        ck_assert_uint_eq(f.rules[i].n, g.rules[i].n);
        ck_assert_mem_eq(f.rules[i].rhs, g.rules[i].rhs, f.rules[i].n * sizeof *f.rules[i].rhs);
        ck_assert_double_eq(fc[i], gc[i]);
    }
    ck_assert_uint_le(parsed_some, parsed_all);
    if (parsed_all > 40 && _i % 5 != 0 && _i % 7 != 0)
        ck_assert_uint_lt(parsed_some, parsed_all);
    sg_rules_clear(&some);
    sg_rules_clear(&all);
    end_case(&c);
}
END_TEST

START_TEST(expectation_maximisation_never_loses)
{
    sg_error err = SG_ERROR_INIT;
    corpus_case c;
    start_case(&c, 3 * _i, 6, 0.1, SG_SHARE_NONE, true); /* ML probabilities */
    c.rules.energy_opts.alpha = 1;
    for (int i = 0, merges = 0; i < 4000 && merges < 25; i++) {
        const uint32_t a = (uint32_t)gsl_rng_uniform_int(c.rng, c.rules.nsymbols);
        const uint32_t b = (uint32_t)gsl_rng_uniform_int(c.rng, c.rules.nsymbols);
        if (sg_rules_compatible(&c.rules, a, b)) {
            ck_ok(sg_merge_apply(&c.rules, a, b, &err));
            merges++;
        }
    }
    for (int expected = 0; expected < 2; expected++) {
        sg_rules r = {0};
        sg_reestimator *e;
        const sg_reestimate_opts how = {expected == 1, true};
        double last = -INFINITY;
        ck_ok(sg_rules_copy(&r, &c.rules, &err));
        ck_ok(sg_reestimator_create(&c.corpus, &how, &e, &err));
        for (int round = 0; round < 6; round++) {
            sg_reestimate_result result;
            ck_ok(sg_reestimate(e, &r, &result, &err));
            ck_assert_uint_eq(result.parsed, c.n);
            ck_assert_msg(result.log_parsed >= last - 1e-9 * fabs(last), "round %d: %.12g after %.12g", round,
                          result.log_parsed, last);
            last = result.log_parsed;
            ck_near(sg_rules_energy(&r), scratch_energy(&r));
        }
        sg_reestimator_free(e);
        sg_rules_clear(&r);
    }
    end_case(&c);
}
END_TEST

START_TEST(a_lattice_outside_the_language_is_named)
{
    sg_error err = SG_ERROR_INIT;
    corpus_case c;
    start_case(&c, 5, 3, 0, SG_SHARE_EQUAL, true);
    uint16_t label = 3; /* sky at the bottom */
    c.lattices[1].labels[c.lattices[1].width * c.lattices[1].height - 1] = label;
    ck_ok(sg_corpus_create(c.lattices, c.n, &c.form, c.arena, &c.corpus, &err));
    sg_reestimator *e;
    sg_reestimate_result result;
    const sg_reestimate_opts plain = {false, false};
    ck_ok(sg_reestimator_create(&c.corpus, &plain, &e, &err));
    ck_assert_int_eq(sg_reestimate(e, &c.rules, &result, &err), SG_ENOPARSE);
    ck_assert_ptr_nonnull(strstr(err.msg, "lattice 2"));
    sg_reestimator_free(e);
    end_case(&c);
}
END_TEST

/* ---- searches ---- */

static double search_energy(corpus_case *c, sg_search_kind kind, bool chunk, size_t *merges)
{
    sg_error err = SG_ERROR_INIT;
    sg_rules r = {0};
    sg_search_opts o = SG_SEARCH_OPTS_INIT;
    sg_search_history h = {0};
    o.kind = kind;
    o.chunk = chunk;
    ck_ok(sg_rules_copy(&r, &c->rules, &err));
    ck_ok(sg_search(&r, &o, &h, &err));
    const double energy = sg_rules_energy(&r);
    ck_near(energy, scratch_energy(&r));
    ck_assert_uint_eq(h.n, 1 + h.merges + h.chunks);
    ck_near(h.steps[h.n - 1].energy, energy);
    for (size_t i = 1; i < h.n && kind == SG_SEARCH_GREEDY; i++)
        ck_assert(h.steps[i].energy < h.steps[i - 1].energy);
    ck_assert(log_viterbi_of_all(c, &r) > -INFINITY);
    if (merges != NULL)
        *merges = h.merges;
    sg_search_history_clear(&h);
    sg_rules_clear(&r);
    return energy;
}

START_TEST(no_search_ends_above_greedy)
{
    corpus_case c;
    size_t merges;
    start_case(&c, 2 * _i + 1, 10, 0.05, (sg_share)(_i % 3), _i % 2 == 0); /* odd seeds: w = 1 */
    const double greedy = search_energy(&c, SG_SEARCH_GREEDY, false, &merges);
    ck_assert_uint_gt(merges, 0);
    for (sg_search_kind k = SG_SEARCH_LOOKAHEAD; k <= SG_SEARCH_ANNEAL; k++) {
        const double e = search_energy(&c, k, false, NULL);
        ck_assert_msg(e <= greedy + 1e-9 * fabs(greedy), "search %d: %.12g above greedy's %.12g", (int)k, e, greedy);
        ck_assert_double_eq(e, search_energy(&c, k, false, NULL)); /* and again the same */
    }
    ck_assert(search_energy(&c, SG_SEARCH_GREEDY, true, NULL) <= greedy + 1e-9 * fabs(greedy));
    end_case(&c);
}
END_TEST

static bool stop_now(sg_progress *p)
{
    size_t *left = p->user;
    return (*left)-- == 0;
}

START_TEST(a_stopped_search_leaves_a_valid_grammar)
{
    sg_error err = SG_ERROR_INIT;
    corpus_case c;
    start_case(&c, _i, 10, 0.05, SG_SHARE_NONE, true);
    for (size_t steps = 0; steps < 12; steps += 3) {
        size_t left = steps;
        sg_progress p = {NULL, stop_now, &left};
        sg_learn_opts o = SG_LEARN_OPTS_INIT;
        sg_learn_result r;
        o.incorporate.share = SG_SHARE_NONE;
        o.search.kind = (sg_search_kind)_i;
        o.search.progress = &p;
        o.reestimate_every = steps % 2 == 1;
        ck_assert_int_eq(sg_learn(c.lattices, c.n, &o, c.arena, &r, &err), SG_STOPPED);
        ck_assert_uint_gt(r.finished.nrules, 0);
        ck_assert_double_le(r.energy.energy, r.initial_energy.energy + 1e-9 * fabs(r.initial_energy.energy));
        sg_learn_result_clear(&r);
    }
    end_case(&c);
}
END_TEST

/* Rows are unique by sequence, so only the axiom chooses: log P = sum log(n_i / n), n_i the lattices with rows like
 * i's. */
START_TEST(the_initial_likelihood_is_that_of_choosing_a_lattice)
{
    sg_error err = SG_ERROR_INIT;
    corpus_case c;
    start_case(&c, 4, 7, 0, SG_SHARE_EQUAL, false);
    c.lattices[7] = c.lattices[2];
    sg_energy_opts o = SG_ENERGY_OPTS_INIT;
    o.data_term = SG_DATA_VITERBI;
    const sg_incorporate_opts inc = SG_INCORPORATE_OPTS_INIT;
    sg_energy_parts parts;
    ck_ok(sg_incorporate(c.lattices, 8, &inc, c.arena, &c.form, &c.counts, &err));
    ck_ok(sg_energy_of_form(&o, &c.form, c.counts, &parts, &err));
    double want = 0;
    for (size_t i = 0; i < 8; i++) {
        size_t same = 0;
        for (size_t j = 0; j < 8; j++)
            same += c.lattices[i].width == c.lattices[j].width && c.lattices[i].height == c.lattices[j].height &&
                    memcmp(c.lattices[i].labels, c.lattices[j].labels,
                           c.lattices[i].width * c.lattices[i].height * sizeof(uint16_t)) == 0;
        want += log((double)same / 8);
    }
    ck_near(parts.log_likelihood, want);
    end_case(&c);
}
END_TEST

START_TEST(learning_gives_consistent_grammars)
{
    sg_error err = SG_ERROR_INIT;
    corpus_case c;
    start_case(&c, _i, 12, 0.03, SG_SHARE_EQUAL, true);
    sg_learn_opts o = SG_LEARN_OPTS_INIT;
    sg_learn_result r, again;
    o.search.chunk = _i % 2 == 1;
    o.reestimate_every = _i % 3 == 0;
    o.tied = true;
    ck_ok(sg_learn(c.lattices, c.n, &o, c.arena, &r, &err));
    ck_ok(sg_learn(c.lattices, c.n, &o, c.arena, &again, &err));
    ck_assert_double_eq(r.energy.energy, again.energy.energy);
    ck_assert(!r.merged.tied && r.finished.tied);
    ck_assert_double_le(r.energy.energy, r.searched_energy + 1e-9 * fabs(r.searched_energy));
    for (size_t i = 0; i < r.merged.nrules; i++) {
        if (r.merged.rules[i].op == SG_SPLIT_LEXICAL)
            continue;
        ck_assert_double_eq((double)r.merged.rules[i].nattributes, r.merged_counts[i]);
        ck_assert_double_gt(r.merged_counts[i], 0);
    }
    for (size_t i = 0, end; i < r.finished.nrules; i = end) {
        double p = 0;
        for (end = i; end < r.finished.nrules && r.finished.rules[end].lhs == r.finished.rules[i].lhs; end++)
            p += r.finished.rules[end].probability;
        ck_assert_double_eq_tol(p, 1, 1e-9);
    }
    sg_learn_result_clear(&r);
    sg_learn_result_clear(&again);
    end_case(&c);
}
END_TEST

/* Lattices of a grammar whose structure can be found: the beam must not end above it. */
START_TEST(a_known_grammar_is_found)
{
    static const char *const names[] = {"office", "arcade", "terrace"};
    sg_error err = SG_ERROR_INIT;
    sg_arena *a = sg_arena_create();
    gsl_rng *rng = sg_random_create(1);
    sg_grammar *g;
    sg_split_form truth;
    char path[4096];
    snprintf(path, sizeof path, "%s/data/grammars/%s.sg", test_folder("SG_SOURCE_DIR"), names[_i % 3]);
    ck_ok(sg_grammar_load(path, &g, &err));
    ck_ok(sg_split_form_of(g, a, &truth, &err));
    enum { N = 40 };
    sg_lattice lattices[N];
    for (size_t i = 0; i < N; i++) {
        sg_random_stream(rng, 100 + (uint64_t)_i, 0, i);
        ck_ok(sg_cell_sample(&truth, rng, 1000, 10000, a, &lattices[i], NULL, &err));
    }
    sg_learn_opts o = SG_LEARN_OPTS_INIT;
    sg_learn_result r;
    o.search.kind = SG_SEARCH_BEAM;
    ck_ok(sg_learn(lattices, N, &o, a, &r, &err));

    sg_corpus corpus;
    sg_rules rules;
    sg_reestimator *e;
    const sg_reestimate_opts plain = {false, true};
    double *counts = SG_NEW_ARRAY(a, double, truth.nrules);
    for (size_t i = 0; i < truth.nrules; i++)
        counts[i] = 1000 * truth.rules[i].probability;
    ck_ok(sg_corpus_create(lattices, N, &truth, a, &corpus, &err));
    ck_ok(sg_rules_create(&rules, &truth, counts, &o.energy, a, &err));
    ck_ok(sg_reestimator_create(&corpus, &plain, &e, &err));
    ck_ok(sg_reestimate_until_stable(e, &rules, 20, NULL, &err));
    const double want = sg_rules_energy(&rules);
    ck_assert_msg(r.energy.energy <= want + 1e-9 * fabs(want), "%s: %.10g above the truth's %.10g", names[_i % 3],
                  r.energy.energy, want);
    sg_reestimator_free(e);
    sg_rules_clear(&rules);
    sg_learn_result_clear(&r);
    sg_grammar_free(g);
    gsl_rng_free(rng);
    sg_arena_free(a);
}
END_TEST

/* What is drawn has the frequencies of the rules, and only what fits together. */
START_TEST(drawn_lattices_follow_the_grammar)
{
    sg_error err = SG_ERROR_INIT;
    sg_arena *a = sg_arena_create();
    gsl_rng *rng = sg_random_create(3);
    /* S -> A | A side by side, A -> t over t (.5) or t (.5): two of four derivations fit, each as likely */
    const uint32_t aa[] = {1, 1}, tt[] = {2, 2}, one[] = {2}, t[] = {0};
    const sg_split_rule rules[] = {{.lhs = 0, .op = SG_SPLIT_X, .n = 2, .rhs = aa, .probability = 1},
                                   {.lhs = 1, .op = SG_SPLIT_Y, .n = 2, .rhs = tt, .probability = 0.5},
                                   {.lhs = 1, .op = SG_SPLIT_Y, .n = 1, .rhs = one, .probability = 0.5},
                                   {.lhs = 2, .op = SG_SPLIT_LEXICAL, .n = 1, .rhs = t, .probability = 1}};
    const char *names[] = {"S", "A", "T"}, *terminals[] = {"t"};
    const uint32_t colors[] = {0};
    sg_split_form f = {.name = "fit",
                       .nsymbols = 3,
                       .symbol_names = names,
                       .nterminals = 1,
                       .terminal_names = terminals,
                       .terminal_colors = colors,
                       .nrules = 4,
                       .rules = rules};
    size_t tall = 0, tried = 0;
    for (int i = 0; i < 2000; i++) {
        sg_lattice l;
        size_t n;
        ck_ok(sg_cell_sample(&f, rng, 1000, 100, a, &l, &n, &err));
        ck_assert_uint_eq(l.width, 2);
        tall += l.height == 2;
        tried += n;
        sg_arena_reset(a);
    }
    ck_assert_double_eq_tol((double)tall, 1000, 5 * sqrt(500));
    ck_assert_double_eq_tol((double)tried, 4000, 5 * sqrt(2 * 2000)); /* geometric, p = 1/2 */
    ck_assert_int_eq(sg_cell_sample(&f, rng, 100, 1, a, &(sg_lattice){0}, NULL, &err), SG_ENUMERIC);
    f.tied = true;
    ck_assert_int_eq(sg_cell_sample(&f, rng, 100, 100, a, &(sg_lattice){0}, NULL, &err), SG_EINVAL);
    gsl_rng_free(rng);
    sg_arena_free(a);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("search");
    TCase *tc = tcase_create("search");
    tcase_set_timeout(tc, 120);
    tcase_add_loop_test(tc, the_best_chunk_is_the_best_and_changes_the_energy_as_foretold, 0, 6);
    tcase_add_loop_test(tc, merged_grammars_keep_their_lattices, 0, 6);
    tcase_add_loop_test(tc, parsing_less_gives_what_parsing_all_gives, 0, 24);
    tcase_add_loop_test(tc, expectation_maximisation_never_loses, 0, 4);
    tcase_add_test(tc, a_lattice_outside_the_language_is_named);
    tcase_add_loop_test(tc, no_search_ends_above_greedy, 0, 12);
    tcase_add_loop_test(tc, a_stopped_search_leaves_a_valid_grammar, 0, 4);
    tcase_add_test(tc, the_initial_likelihood_is_that_of_choosing_a_lattice);
    tcase_add_loop_test(tc, a_known_grammar_is_found, 0, 6);
    tcase_add_test(tc, drawn_lattices_follow_the_grammar);
    tcase_add_loop_test(tc, learning_gives_consistent_grammars, 0, 6);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
