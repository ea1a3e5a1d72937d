/* SPDX-License-Identifier: GPL-3.0-or-later */
/* chain.c - makes and steps chains. */
#include "search/chain_priv.h"

#include "core/random.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- making ---- */

static sg_status check_opts(const sg_kernel_opts *o, double beta, sg_error *err)
{
    double sum = 0;
    for (int k = 0; k < SG_MOVE_KINDS; k++) {
        if (!(o->share[k] >= 0))
            return SG_FAIL(err, SG_EINVAL, "a move has the share %g, which is negative or no number", o->share[k]);
        sum += o->share[k];
    }
    if (!(sum > 0) || !isfinite(sum))
        return SG_FAIL(err, SG_EINVAL, "the shares of the moves sum to %g", sum);
    if (!(o->reflect_step > 0) || !isfinite(o->reflect_step) || !(o->shift_step > 0) || !isfinite(o->shift_step) ||
        !(o->depth_base > 0) || !isfinite(o->depth_base))
        return SG_FAIL(err, SG_EINVAL, "steps of %g and %g, base %g: each must be a positive number", o->reflect_step,
                       o->shift_step, o->depth_base);
    if (!(beta >= 0) || !isfinite(beta))
        return SG_FAIL(err, SG_EINVAL, "the inverse temperature %g is negative or no number", beta);
    return SG_OK;
}

/* A jump is of use where there are several rules, or draws: elsewhere what is below can be moved by itself. */
static bool has_choice(const sg_grammar *g, const sg_symbol *s)
{
    bool draws = s->completion != SG_NONE && sg_grammar_rule(g, s->completion)->nuniforms > 0;
    for (sg_rule_id r = s->first_rule; r < s->first_rule + s->nrules; r++)
        draws |= sg_grammar_rule(g, r)->nuniforms > 0;
    return s->nrules > 1 || draws;
}

static void sort_into_lists(sg_chain *c)
{
    for (size_t s = 0; s < sg_grammar_symbol_count(c->g); s++) {
        const sg_symbol *symbol = sg_grammar_symbol(c->g, (sg_sym)s);
        if (symbol->kind == SG_SYMBOL_NONTERMINAL && has_choice(c->g, symbol))
            c->of_symbol[s] = 1u << SG_LIST_JUMPS;
    }
    for (size_t r = 0; r < sg_grammar_rule_count(c->g); r++) {
        const sg_rule *rule = sg_grammar_rule(c->g, (sg_rule_id)r);
        c->log_probability[r] = log(rule->probability);
        if (rule->nuniforms > 0)
            c->of_rule[r] |= 1u << SG_LIST_DRAWS;
        if (sg_rule_has_sizes(rule))
            c->of_rule[r] |= 1u << SG_LIST_SIZES;
    }
}

static const sg_list_kind list_of_kind[SG_MOVE_KINDS] = {
    [SG_MOVE_JUMP_FRESH] = SG_LIST_JUMPS, [SG_MOVE_JUMP_COPY] = SG_LIST_JUMPS, [SG_MOVE_RESAMPLE] = SG_LIST_DRAWS,
    [SG_MOVE_REFLECT] = SG_LIST_DRAWS,    [SG_MOVE_SHIFT] = SG_LIST_SIZES,    [SG_MOVE_SWITCH] = SG_LIST_JUMPS,
};

/* Moves that the grammar has no use for take no share. */
static void sum_shares(sg_chain *c)
{
    unsigned lists = 0;
    for (size_t s = 0; s < sg_grammar_symbol_count(c->g); s++)
        lists |= c->of_symbol[s];
    for (size_t r = 0; r < sg_grammar_rule_count(c->g); r++)
        lists |= c->of_rule[r];
    double sum = 0;
    for (int k = 0; k < SG_MOVE_KINDS; k++) {
        if (lists & 1u << list_of_kind[k] && (k != SG_MOVE_SWITCH || sg_switcher_useful(c->switcher)))
            sum += c->opts.share[k];
        c->shares[k] = sum;
    }
    for (int k = 0; k < SG_MOVE_KINDS && sum > 0; k++)
        c->shares[k] /= sum;
}

static size_t most_uniforms(const sg_grammar *g)
{
    size_t most = 1;
    for (size_t r = 0; r < sg_grammar_rule_count(g); r++)
        if (sg_grammar_rule(g, (sg_rule_id)r)->nuniforms > most)
            most = sg_grammar_rule(g, (sg_rule_id)r)->nuniforms;
    return most;
}

static sg_status take_memory(sg_chain *c, const sg_score *score, sg_error *err)
{
    const sg_grammar *g = c->g;
    sg_derivation *const trees[] = {&c->best, &c->old.d, &c->y.d, &c->z.d, &c->back.d};
    for (size_t i = 0; i < sizeof trees / sizeof *trees; i++)
        sg_derivation_init(trees[i], g);
    c->rng = sg_random_create(c->seed);
    c->of_symbol = calloc(sg_grammar_symbol_count(g) + 1, 1);
    c->of_rule = calloc(sg_grammar_rule_count(g) + 1, 1);
    c->log_probability = calloc(sg_grammar_rule_count(g) + 1, sizeof *c->log_probability);
    c->draws.uniforms = calloc(most_uniforms(g), sizeof *c->draws.uniforms);
    c->draws.frame = calloc(sg_grammar_frame_size(g), sizeof *c->draws.frame);
    if (c->rng == NULL || c->of_symbol == NULL || c->of_rule == NULL || c->log_probability == NULL ||
        c->draws.uniforms == NULL || c->draws.frame == NULL)
        return SG_FAIL_NOMEM(err);
    SG_TRY(sg_switcher_create(g, &c->switcher, err));
    return sg_chain_state_create(g, score, &c->at, err);
}

sg_status sg_chain_create(const sg_grammar *g, const sg_score *score, const sg_kernel_opts *opts, uint64_t seed,
                          uint32_t id, double beta, sg_chain **out, sg_error *err)
{
    SG_TRY(check_opts(opts, beta, err));
    sg_chain *c = calloc(1, sizeof *c);
    if (c == NULL)
        return SG_FAIL_NOMEM(err);
    c->g = g;
    c->opts = *opts;
    c->seed = seed;
    c->id = id;
    c->beta = beta;
    c->sharpness = 1;
    c->log_base = log(opts->depth_base);
    const sg_status st = take_memory(c, score, err);
    if (st != SG_OK) {
        sg_chain_free(c);
        return st;
    }
    sort_into_lists(c);
    sum_shares(c);
    *out = c;
    return SG_OK;
}

static void clear_candidate(sg_candidate *s)
{
    sg_derivation_clear(&s->d);
    free(s->terms.log_rules);
    free(s->terms.log_density);
}

void sg_chain_free(sg_chain *c)
{
    if (c == NULL)
        return;
    sg_chain_state_free(c->at);
    sg_switcher_free(c->switcher);
    sg_derivation_clear(&c->best);
    clear_candidate(&c->old);
    clear_candidate(&c->y);
    clear_candidate(&c->z);
    clear_candidate(&c->back);
    if (c->rng != NULL)
        gsl_rng_free(c->rng);
    free(c->of_symbol);
    free(c->of_rule);
    free(c->log_probability);
    free(c->draws.uniforms);
    free(c->draws.frame);
    free(c);
}

/* ---- starting ---- */

/* A sample of the prior into y; inside: not too large. */
static sg_status sample(sg_chain *c, bool *inside, sg_error *err)
{
    SG_TRY(sg_derivation_open(&c->old.d, sg_grammar_start(c->g), sg_grammar_start_args(c->g), 0, err));
    sg_uniforms fresh = {NULL, 0, 0, c->rng};
    return sg_derivation_regenerate(&c->old.d, 0, &fresh, c->opts.max_nodes, &c->y.d, inside, err);
}

/* The best of `tries` samples, by score, into c->at->d. */
static sg_status sample_best(sg_chain *c, size_t tries, sg_progress *progress, sg_error *err)
{
    double best = -INFINITY;
    sg_random_stream(c->rng, c->seed, c->id, 0);
    for (size_t i = 0; i < tries || i == 0; i++) {
        bool inside;
        if (i > 0 && sg_progress_stopped(progress))
            return best > -INFINITY ? SG_OK : SG_FAIL(err, SG_STOPPED, "stopped before any derivation was found");
        SG_TRY(sample(c, &inside, err));
        sg_score_value score = {-INFINITY, -INFINITY};
        if (inside)
            SG_TRY(sg_score_evaluate(c->at->score, &c->y.d, &score, err));
        if (!(score.log > best))
            continue;
        best = score.log;
        const sg_derivation swap = c->y.d;
        c->y.d = c->at->d;
        c->at->d = swap;
    }
    if (best > -INFINITY)
        return SG_OK;
    return SG_FAIL(err, SG_ENOPARSE, "none of %zu samples of the grammar can be scored", tries > 0 ? tries : 1);
}

sg_status sg_chain_start(sg_chain *c, const sg_derivation *d, size_t tries, sg_progress *progress, sg_error *err)
{
    if (d != NULL)
        SG_TRY(sg_derivation_copy(&c->at->d, d, err));
    else
        SG_TRY(sample_best(c, tries, progress, err));
    SG_TRY(sg_score_evaluate(c->at->score, &c->at->d, &c->at->posterior.score, err));
    if (!(c->at->posterior.score.log > -INFINITY))
        return SG_FAIL(err, SG_ENOPARSE, "the derivation to start at cannot be scored");
    SG_TRY(sg_chain_settle(c, err));
    c->best_posterior = c->at->posterior;
    c->at_best = true;
    return SG_OK;
}

/* ---- stepping ---- */

double sg_chain_sharpen(const sg_chain *c, double d_log_prior)
{
    return (c->sharpness - 1) * d_log_prior;
}

double sg_chain_log_ratio(const sg_chain *c, double d_log_score, double others)
{
    if (!(d_log_score > -INFINITY))
        return -INFINITY;
    return c->sharpness * c->beta * d_log_score + others;
}

double sg_chain_log_alpha(const sg_chain *c, double d_log_score, double others)
{
    return fmin(sg_chain_log_ratio(c, d_log_score, others), 0);
}

double sg_chain_floor(const sg_chain *c, double log_score, double others)
{
    const double weight = c->sharpness * c->beta;
    return weight > 0 ? log_score + (SG_LOG_NEVER - others) / weight : -INFINITY;
}

bool sg_chain_draw(const sg_chain *c, double log_alpha)
{
    return log_alpha >= 0 || (log_alpha > SG_LOG_NEVER && log(sg_random_uniform(c->rng)) < log_alpha);
}

static bool pick_kind(const sg_chain *c, sg_move_kind *kind)
{
    if (!(c->shares[SG_MOVE_KINDS - 1] > 0))
        return false;
    const double u = sg_random_uniform(c->rng);
    int k = 0;
    while (k + 1 < SG_MOVE_KINDS && u >= c->shares[k])
        k++;
    *kind = (sg_move_kind)k;
    return true;
}

static void count(sg_chain_stats *s, const sg_move *m)
{
    s->proposed[m->kind]++;
    s->accepted[m->kind] += m->accepted && !m->second_stage;
    s->second_proposed += m->second_stage;
    s->second_accepted += m->accepted && m->second_stage;
}

sg_status sg_chain_step(sg_chain *c, uint64_t iteration, sg_move *move, sg_error *err)
{
    sg_move m = {.node = SIZE_MAX};
    sg_status st = SG_OK;
    sg_random_stream(c->rng, c->seed, c->id, iteration);
    if (pick_kind(c, &m.kind))
        st = list_of_kind[m.kind] == SG_LIST_JUMPS ? sg_chain_jump(c, &m, err) : sg_chain_move_draws(c, &m, err);
    if (st == SG_OK && m.node != SIZE_MAX)
        count(&c->stats, &m);
    if (move != NULL)
        *move = m;
    return st;
}

/* ---- exchanging ---- */

static double log_prior(const sg_posterior *p)
{
    return p->log_rules + p->log_density;
}

/* Log of the ratio of the joint densities after and before; the whole is 0 where both weigh alike. */
static double log_swap(const sg_chain *a, const sg_chain *b)
{
    const sg_posterior *p = &a->at->posterior, *q = &b->at->posterior;
    return (a->sharpness * a->beta - b->sharpness * b->beta) * (q->score.log - p->score.log) +
           (a->sharpness - b->sharpness) * (log_prior(q) - log_prior(p));
}

/* Ready to leave where it stands for what the other stands at. */
static bool leave(sg_chain *c, const sg_posterior *next)
{
    const bool better = sg_posterior_log(next) > sg_posterior_log(&c->best_posterior);
    if (c->at_best && !better && sg_derivation_copy(&c->best, &c->at->d, NULL) != SG_OK)
        return false;
    c->at_best = c->at_best && better;
    return true;
}

static void enter(sg_chain *c)
{
    if (!(sg_posterior_log(&c->at->posterior) > sg_posterior_log(&c->best_posterior)))
        return;
    c->best_posterior = c->at->posterior;
    c->at_best = true;
}

bool sg_chain_swap(sg_chain *a, sg_chain *b, double u)
{
    if (!(log(u) < log_swap(a, b)))
        return false;
    /* Without memory for what the chains leave behind as their best they do not leave it. */
    if (!leave(a, &b->at->posterior) || !leave(b, &a->at->posterior))
        return false;
    sg_chain_state *at = a->at;
    a->at = b->at;
    b->at = at;
    enter(a);
    enter(b);
    return true;
}

/* ---- looking ---- */

const sg_derivation *sg_chain_derivation(const sg_chain *c)
{
    return &c->at->d;
}

const sg_posterior *sg_chain_posterior(const sg_chain *c)
{
    return &c->at->posterior;
}

double sg_chain_beta(const sg_chain *c)
{
    return c->beta;
}

void sg_chain_set_beta(sg_chain *c, double beta)
{
    c->beta = beta;
}

void sg_chain_set_sharpness(sg_chain *c, double sharpness)
{
    c->sharpness = sharpness;
}

const sg_derivation *sg_chain_best(const sg_chain *c, sg_posterior *p)
{
    if (p != NULL)
        *p = c->best_posterior;
    return c->at_best ? &c->at->d : &c->best;
}

const sg_chain_stats *sg_chain_statistics(const sg_chain *c)
{
    return &c->stats;
}
