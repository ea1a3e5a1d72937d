/* SPDX-License-Identifier: GPL-3.0-or-later */
/* label_score.c - states of label scores. */
#include "scene/label_scene.h"
#include "score/label_score_priv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    sg_score_state state; /* first */
    sg_label_scene scene;
    sg_derivation changed;
} label_state;

static const sg_label_target *target_of(const label_state *s)
{
    return (const sg_label_target *)s->state.target;
}

static sg_status create_state(const sg_score *target, sg_score_state **out, sg_error *err)
{
    label_state *s = calloc(1, sizeof *s);
    if (s == NULL)
        return SG_FAIL_NOMEM(err);
    s->state.target = target;
    sg_derivation_init(&s->changed, ((const sg_label_target *)target)->g);
    *out = &s->state;
    return SG_OK;
}

static void destroy_state(sg_score_state *state)
{
    label_state *s = (label_state *)state;
    sg_label_scene_clear(&s->scene);
    sg_derivation_clear(&s->changed);
    free(s);
}

static int64_t sum_scene(const sg_label_target *t, const sg_label_scene *scene)
{
    int64_t sum = t->image.base;
    const size_t w = t->image.width, h = t->image.height;
    for (size_t i = 0; i < scene->nrects; i++) {
        const sg_label_rect *r = scene->rects + i;
        sum += sg_label_sum(&t->image, t->channel[r->label], sg_label_scene_pixel(r->x0, scene->width, w),
                            sg_label_scene_pixel(r->y0, scene->height, h), sg_label_scene_pixel(r->x1, scene->width, w),
                            sg_label_scene_pixel(r->y1, scene->height, h));
    }
    return sum;
}

static sg_status evaluate(sg_score_state *state, const sg_derivation *d, sg_score_value *out, sg_error *err)
{
    label_state *s = (label_state *)state;
    const sg_label_target *t = target_of(s);
    if (d->grammar != t->g)
        return SG_FAIL(err, SG_EINVAL, "the score was not made for this grammar");
    *out = (sg_score_value){-INFINITY, -INFINITY};
    const sg_status st = sg_label_scene_interpret(&s->scene, d, (double)t->image.width, (double)t->image.height, err);
    if (st == SG_OK) {
        out->log = -t->nats * (double)sum_scene(t, &s->scene);
        out->value = out->log / ((double)t->image.width * (double)t->image.height);
    }
    return st == SG_ENUMERIC ? SG_OK : st;
}

static sg_status propose(sg_score_state *state, const sg_change *change, double floor, sg_score_value *out,
                         sg_error *err)
{
    label_state *s = (label_state *)state;
    (void)floor;
    SG_TRY(sg_derivation_copy(&s->changed, change->current, err));
    if (change->slice != NULL) {
        SG_TRY(sg_derivation_splice(&s->changed, change->node, change->slice, err));
    } else {
        const sg_node *n = s->changed.nodes + change->node;
        const sg_rule *r = sg_grammar_rule(s->changed.grammar, n->rule);
        const uint32_t nparams = sg_grammar_symbol(s->changed.grammar, n->symbol)->nparams;
        if (r->nvalues > 0)
            memcpy(s->changed.values + n->values + nparams, change->values, r->nvalues * sizeof(double));
    }
    return evaluate(state, &s->changed, out, err);
}

static void end_proposal(sg_score_state *state)
{
    (void)state;
}

static sg_status copy_state(sg_score_state *dst, const sg_score_state *src, sg_error *err)
{
    (void)dst, (void)src, (void)err;
    return SG_OK;
}

const sg_score_ops sg_label_score_ops = {
    .name = "label",
    .destroy = sg_label_target_free,
    .create_state = create_state,
    .destroy_state = destroy_state,
    .evaluate = evaluate,
    .propose = propose,
    .commit = end_proposal,
    .rollback = end_proposal,
    .copy_state = copy_state,
};
