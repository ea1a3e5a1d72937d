/* SPDX-License-Identifier: GPL-3.0-or-later */
/* chain_draws.c - diffusions: other draws for one node, the rules stay (DESIGN 5.3, MATHEMATICS B5.1).
 *
 * In the space of uniforms resampling and reflected steps are symmetric and the prior of the draws is 1, so what is left is
 * the score, and the probabilities of rules below that depend on the draws. A shift is symmetric in the space of sizes; as a
 * density of uniforms its proposal carries the Jacobian, the ratio of the densities of the sizes. The node is picked by the
 * tree's rules alone, which stay: that probability cancels. */
#include "search/chain_priv.h"

#include <math.h>

static sg_status other_draws(sg_chain *c, sg_move *m, bool *inside, sg_error *err)
{
    const sg_derivation *d = &c->at->d;
    *inside = true;
    if (m->kind == SG_MOVE_RESAMPLE)
        return sg_node_resample(d, m->node, c->rng, &c->draws, err);
    if (m->kind == SG_MOVE_REFLECT)
        return sg_node_reflect(d, m->node, c->opts.reflect_step, c->rng, &c->draws, err);
    sg_node_shift(d, m->node, c->opts.shift_step, c->rng, &c->draws, &m->d_log_propose, inside);
    return SG_OK;
}

/* Draws that others depend on need the subtree made anew. */
static sg_status carry_down(sg_chain *c, sg_move *m, sg_change *change, bool *inside, sg_error *err)
{
    SG_TRY(sg_derivation_extract(&c->at->d, m->node, &c->old.d, err));
    SG_TRY(sg_derivation_revalue_root(&c->old.d, c->draws.uniforms, &c->y.d, &m->d_log_rules, inside, err));
    c->y.summed = false;
    *change = (sg_change){&c->at->d, m->node, &c->y.d, NULL, NULL};
    return SG_OK;
}

static sg_status anneal(sg_chain *c, sg_move *m, const sg_change *change, sg_error *err)
{
    double log_rules, log_density, after;
    if (c->sharpness == 1)
        return SG_OK;
    if (change->slice != NULL) {
        sg_chain_sum_subtree(c, m->node, &log_rules, &log_density);
        SG_TRY(sg_chain_sum(c, &c->y, err));
        m->d_log_anneal = sg_chain_sharpen(c, c->y.log_rules - log_rules + c->y.log_density - log_density);
        return SG_OK;
    }
    SG_TRY(sg_node_draws_log_density(&c->at->d, m->node, &c->draws, &after, err));
    m->d_log_anneal = sg_chain_sharpen(c, after - c->at->terms.log_density[m->node]);
    return SG_OK;
}

static sg_status decide(sg_chain *c, sg_move *m, const sg_change *change, sg_error *err)
{
    SG_TRY(anneal(c, m, change, err));
    sg_score_value score;
    const double now = c->at->posterior.score.log, others = m->d_log_rules + m->d_log_propose + m->d_log_anneal;
    SG_TRY(sg_score_propose(c->at->score, change, sg_chain_floor(c, now, others), &score, err));
    m->d_log_score = score.log - now;
    m->log_accept = sg_chain_log_alpha(c, m->d_log_score, others);
    m->accepted = sg_chain_draw(c, m->log_accept);
    if (!m->accepted)
        sg_score_rollback(c->at->score);
    else if (change->slice != NULL)
        return sg_chain_accept(c, change, &c->y, &score, err);
    else
        return sg_chain_accept_draws(c, change, m->kind == SG_MOVE_SHIFT ? m->d_log_propose : NAN, &score, err);
    return SG_OK;
}

sg_status sg_chain_move_draws(sg_chain *c, sg_move *m, sg_error *err)
{
    const sg_derivation *d = &c->at->d;
    m->node = sg_chain_pick(c, m->kind == SG_MOVE_SHIFT ? SG_LIST_SIZES : SG_LIST_DRAWS);
    if (m->node == SIZE_MAX)
        return SG_OK;
    bool inside;
    SG_TRY(other_draws(c, m, &inside, err));
    sg_change change = {d, m->node, NULL, c->draws.uniforms, c->draws.values};
    if (inside && sg_grammar_rule(c->g, d->nodes[m->node].rule)->draws_passed)
        SG_TRY(carry_down(c, m, &change, &inside, err));
    if (inside)
        return decide(c, m, &change, err);
    m->d_log_score = m->log_accept = -INFINITY;
    return SG_OK;
}
