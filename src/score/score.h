/* SPDX-License-Identifier: GPL-3.0-or-later */
/* score.h - the one score interface: how well a derivation meets a target (DESIGN 3).
 *
 * Two parts. A target is immutable and shared by all chains and threads. A state belongs to one chain: it stands at one
 * derivation, and scores changes of it by what they change only. The order of calls is
 *
 *     evaluate(d)  { propose(change)  [ commit | rollback ] }
 *
 * A proposal ends by a commit (the caller then applies the change to the derivation) or by a rollback; a second proposal
 * may come only after that. Scores of a grammar's own kind (DESIGN 2) implement this table wherever they live; what is
 * searched is for them to interpret, and a search knows nothing of it.
 *
 * Both values grow with quality. `log` is a log-likelihood in nats, what Metropolis and particles use; `value` is what
 * genetic selection ranks. A derivation that cannot be interpreted (its parts do not fill the scope, say) has log and
 * value -INFINITY: that is no error, a search turns from it. Open nodes count as if they were empty. */
#ifndef SG_SCORE_SCORE_H
#define SG_SCORE_SCORE_H

#include "core/status.h"
#include "derivation/change.h"

typedef struct {
    double value, log;
} sg_score_value;

typedef struct sg_score sg_score;             /* a target; each kind of score extends it */
typedef struct sg_score_state sg_score_state; /* likewise */

typedef struct {
    const char *name;
    void (*destroy)(sg_score *target);
    sg_status (*create_state)(const sg_score *target, sg_score_state **out, sg_error *err);
    void (*destroy_state)(sg_score_state *s);
    sg_status (*evaluate)(sg_score_state *s, const sg_derivation *d, sg_score_value *out, sg_error *err);
    sg_status (*propose)(sg_score_state *s, const sg_change *change, double floor, sg_score_value *out, sg_error *err);
    void (*commit)(sg_score_state *s);
    void (*rollback)(sg_score_state *s);
    sg_status (*copy_state)(sg_score_state *dst, const sg_score_state *src, sg_error *err);
} sg_score_ops;

struct sg_score {
    const sg_score_ops *ops;
};

struct sg_score_state {
    const sg_score *target;
};

/** NULL is fine for both. */
static inline void sg_score_free(sg_score *target)
{
    if (target != NULL)
        target->ops->destroy(target);
}

static inline void sg_score_state_free(sg_score_state *s)
{
    if (s != NULL)
        s->target->ops->destroy_state(s);
}

/** A state that stands at no derivation yet. @return SG_OK, SG_ENOMEM */
static inline sg_status sg_score_state_create(const sg_score *target, sg_score_state **out, sg_error *err)
{
    return target->ops->create_state(target, out, err);
}

/** Score d from scratch and stand at it; a proposal that is pending is forgotten.
 *  @return SG_OK, SG_EINVAL (a grammar that the target was not made for), SG_ENOMEM */
static inline sg_status sg_score_evaluate(sg_score_state *s, const sg_derivation *d, sg_score_value *out, sg_error *err)
{
    return s->target->ops->evaluate(s, d, out, err);
}

/** Score the derivation that the change would make; the state still stands at the old one.
 *  @param change  must live until commit or rollback
 *  @param floor   the caller has no use for the exact value of a lower `log`: then the score may stop early and
 *                 give -INFINITY. -INFINITY: always exact
 *  @return SG_OK, SG_ENOMEM; on failure nothing is pending */
static inline sg_status sg_score_propose(sg_score_state *s, const sg_change *change, double floor, sg_score_value *out,
                                         sg_error *err)
{
    return s->target->ops->propose(s, change, floor, out, err);
}

/** Stand at the derivation proposed last, whose `log` was finite; it cannot fail (memory was taken by the proposal). Call
 *  it before the change is applied to the derivation. */
static inline void sg_score_commit(sg_score_state *s)
{
    s->target->ops->commit(s);
}

/** Forget the proposal. */
static inline void sg_score_rollback(sg_score_state *s)
{
    s->target->ops->rollback(s);
}

/** Make dst, a state of the same target, stand where src stands (a copy of src's derivation). @return SG_OK, SG_ENOMEM */
static inline sg_status sg_score_state_copy(sg_score_state *dst, const sg_score_state *src, sg_error *err)
{
    return src->target->ops->copy_state(dst, src, err);
}

#endif
