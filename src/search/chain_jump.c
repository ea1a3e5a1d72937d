/* SPDX-License-Identifier: GPL-3.0-or-later */
/* chain_jump.c - jumps: the subtree of a node anew from the rules, and the second try after a rejection (DESIGN 5.3,
 * MATHEMATICS B5.2 to B5.4, where the printed formulas are put right).
 *
 * A jump x -> y draws rules from the prior and uniforms afresh, or keeps those of x: node by node in pre-order, the first
 * min(j, k) of the j that the old subtree has go to the k of the new one. With k - j fresh ones r added to x, or j - k added to
 * y, the two directions are one permutation of the same numbers, whose Jacobian is 1 and whose density is that of the
 * rules. These are drawn in both directions with just the probability that the target gives them, given the values at hand:
 *     pi(x) P(rules of y | values of y) / (pi(y) P(rules of x | values of x)) = exp(beta (l(x) - l(y))),
 * also where rules depend on kept values. What is left is the score and the choice of the node.
 *
 * The second try keeps the rules of y and draws its uniforms afresh: z. The way back is z -> y* -> x, where y* has the rules of
 * x and uniforms as a jump of this kind from z would have given it: with copies the first min(k, j) of z, and fresh ones r*
 * where they lack. (x, r, z, r*) and (z, r*, x, r) hold the same numbers: with j < k r* is empty on the way there, on the way
 * back r is a dummy that is drawn all the same, and the other way round. So no Jacobian here either. The flow there has
 *     pi(x) q_x(v) P(rules of y | values of y) [1 - alpha(x -> y)],
 * the flow back
 *     pi(z) q_z(v) P(rules of x | values of y*) [1 - alpha(z -> y*)],
 * and pi holds P(rules of x | values of x), P(rules of y | values of z): the ratio is DESIGN's alpha_2. Nodes beyond the depth
 * limit have their one rule with probability 1 in all four.
 *
 * A switch (derivation_switch.h) is a jump that keeps more than uniforms; what its sizes add to the ratio comes with it. It has no
 * second try. */
#include "search/chain_priv.h"

#include <math.h>

/* A jump on its way. */
typedef struct {
    sg_chain *c;
    sg_move *m;
    bool copy;
    double old_rules, old_density; /* sums over the subtree of x; needed in annealing only */
    sg_error *err;
} jump;

static double log_score(const sg_chain *c)
{
    return c->at->posterior.score.log;
}

static sg_change change_to(const jump *j, const sg_candidate *s)
{
    return (sg_change){&j->c->at->d, j->m->node, &s->d, NULL, NULL};
}

/* log((1 - exp(x))), x <= 0 */
static double log_rest(double x)
{
    return x > -M_LN2 ? log(-expm1(x)) : log1p(-exp(x));
}

static sg_status propose_y(jump *j, bool *inside)
{
    sg_chain *c = j->c;
    sg_uniforms from = {NULL, 0, 0, c->rng};
    if (j->copy)
        from.kept = sg_derivation_uniforms(&c->at->d, j->m->node, &from.nkept);
    c->y.summed = false;
    if (j->m->kind == SG_MOVE_SWITCH)
        return sg_switcher_propose(c->switcher, &c->at->d, j->m->node, c->rng, c->opts.max_nodes, &c->y.d,
                                   &j->m->d_log_propose, inside, j->err);
    return sg_derivation_regenerate(&c->at->d, j->m->node, &from, c->opts.max_nodes, &c->y.d, inside, j->err);
}

/* Annealing: what a candidate has more than x, of rules and densities. */
static sg_status sharpen(jump *j, sg_candidate *s, double *by)
{
    *by = 0;
    if (j->c->sharpness == 1)
        return SG_OK;
    SG_TRY(sg_chain_sum(j->c, s, j->err));
    *by = sg_chain_sharpen(j->c, s->log_rules - j->old_rules + s->log_density - j->old_density);
    return SG_OK;
}

static sg_status score_of(jump *j, const sg_candidate *s, double floor, sg_score_value *score)
{
    const sg_change change = change_to(j, s);
    SG_TRY(sg_score_propose(j->c->at->score, &change, floor, score, j->err));
    sg_score_rollback(j->c->at->score);
    return SG_OK;
}

/* z and y*, with the ratios of rule probabilities R(z) and 1/R(x). inside: both can be. */
static sg_status propose_z(jump *j, double *log_ratio, bool *inside)
{
    sg_chain *c = j->c;
    double forth, back;
    sg_uniforms fresh = {NULL, 0, 0, c->rng};
    c->z.summed = c->back.summed = false;
    SG_TRY(sg_derivation_revalue(&c->y.d, &fresh, &c->z.d, &forth, inside, j->err));
    if (!*inside)
        return SG_OK;
    sg_uniforms matched = {c->z.d.uniforms, j->copy ? c->z.d.nuniforms : 0, 0, c->rng};
    SG_TRY(sg_derivation_revalue(&c->old.d, &matched, &c->back.d, &back, inside, j->err));
    *log_ratio = forth + back;
    return SG_OK;
}

/* log alpha(z -> y*): q_y*(v) / q_z(v) is q_x(v) / q_y(v). */
static sg_status log_way_back(jump *j, double z_log, double z_sharp, double *log_alpha)
{
    sg_chain *c = j->c;
    sg_score_value score;
    double sharp;
    SG_TRY(sharpen(j, &c->back, &sharp));
    const double others = sharp - z_sharp - j->m->d_log_select;
    SG_TRY(score_of(j, &c->back, sg_chain_floor(c, z_log, others), &score));
    *log_alpha = sg_chain_log_alpha(c, score.log - z_log, others);
    return SG_OK;
}

static sg_status accept_z(jump *j, const sg_score_value *score)
{
    sg_chain *c = j->c;
    const sg_change change = change_to(j, &c->z);
    sg_score_value again;
    SG_TRY(sg_score_propose(c->at->score, &change, -INFINITY, &again, j->err));
    return sg_chain_accept(c, &change, &c->z, score, j->err);
}

static sg_status second_stage(jump *j)
{
    sg_chain *c = j->c;
    sg_move *m = j->m;
    sg_score_value score;
    double log_ratio, sharp, way_back;
    bool inside;
    m->second_stage = true;
    m->log_accept2 = -INFINITY;
    SG_TRY(propose_z(j, &log_ratio, &inside));
    if (!inside)
        return SG_OK;
    SG_TRY(sharpen(j, &c->z, &sharp));
    const double others = m->d_log_select + log_ratio + sharp - log_rest(m->log_accept);
    SG_TRY(score_of(j, &c->z, sg_chain_floor(c, log_score(c), others), &score));
    const double most = sg_chain_log_ratio(c, score.log - log_score(c), others);
    if (most < SG_LOG_NEVER) /* whatever the way back is like */
        return SG_OK;
    SG_TRY(log_way_back(j, score.log, sharp, &way_back));
    if (way_back >= 0)
        return SG_OK;
    m->log_accept2 = fmin(most + log_rest(way_back), 0);
    m->accepted = sg_chain_draw(c, m->log_accept2);
    return m->accepted ? accept_z(j, &score) : SG_OK;
}

/* Subtrees of the rules of x and y, whichever way one goes: y* and z have as many nodes. */
static bool small_enough(const jump *j)
{
    const size_t most = j->c->opts.delayed_nodes;
    return j->c->at->d.nodes[j->m->node].length <= most && j->c->y.d.nnodes <= most;
}

/* Where neither has a uniform z is y and y* is x, and one of two ways is always accepted: nothing is left for a second try. */
static sg_status try_again(jump *j)
{
    sg_chain *c = j->c;
    size_t n;
    sg_derivation_uniforms(&c->at->d, j->m->node, &n);
    if (!c->opts.delayed_rejection || !small_enough(j) || (n == 0 && c->y.d.nuniforms == 0))
        return SG_OK;
    SG_TRY(sg_derivation_extract(&c->at->d, j->m->node, &c->old.d, j->err));
    return second_stage(j);
}

static sg_status first_stage(jump *j)
{
    sg_chain *c = j->c;
    sg_move *m = j->m;
    sg_score_value score;
    if (c->sharpness != 1)
        sg_chain_sum_subtree(c, m->node, &j->old_rules, &j->old_density);
    SG_TRY(sharpen(j, &c->y, &m->d_log_anneal));
    m->d_log_select = sg_chain_log_select(c, m->node, &c->y.d);
    const sg_change change = change_to(j, &c->y);
    const double others = m->d_log_select + m->d_log_propose + m->d_log_anneal;
    SG_TRY(sg_score_propose(c->at->score, &change, sg_chain_floor(c, log_score(c), others), &score, j->err));
    m->d_log_score = score.log - log_score(c);
    m->log_accept = sg_chain_log_alpha(c, m->d_log_score, others);
    m->accepted = sg_chain_draw(c, m->log_accept);
    if (m->accepted)
        return sg_chain_accept(c, &change, &c->y, &score, j->err);
    sg_score_rollback(c->at->score);
    return m->kind == SG_MOVE_SWITCH ? SG_OK : try_again(j);
}

sg_status sg_chain_jump(sg_chain *c, sg_move *m, sg_error *err)
{
    jump j = {c, m, m->kind == SG_MOVE_JUMP_COPY, 0, 0, err};
    bool inside;
    m->node = sg_chain_pick(c, SG_LIST_JUMPS);
    if (m->node == SIZE_MAX)
        return SG_OK;
    SG_TRY(propose_y(&j, &inside));
    if (!inside) { /* too large: y has no density, and no tree as large as it has a second try that leads here; or no switch */
        m->d_log_propose = 0;
        m->d_log_score = m->log_accept = -INFINITY;
        return SG_OK;
    }
    if (j.copy && sg_chain_same_rules(&c->at->d, m->node, &c->y.d)) {
        m->accepted = true; /* the same rules with the same uniforms */
        return SG_OK;
    }
    return first_stage(&j);
}
