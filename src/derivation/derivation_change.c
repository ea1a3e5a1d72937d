/* SPDX-License-Identifier: GPL-3.0-or-later */
/* derivation_change.c - proposed changes, made. */
#include "derivation/change.h"

#include "derivation/derivation_priv.h"

#include <string.h>

static void set_draws(sg_derivation *d, const sg_change *change)
{
    const sg_node *n = d->nodes + change->node;
    const sg_rule *r = sg_node_rule(d, n);
    if (r == NULL || r->ndraws == 0)
        return;
    const uint32_t nparams = sg_grammar_symbol(d->grammar, n->symbol)->nparams;
    if (r->nuniforms > 0)
        memcpy(d->uniforms + n->uniforms, change->uniforms, r->nuniforms * sizeof *d->uniforms);
    memcpy(d->values + n->values + nparams, change->values, r->nvalues * sizeof *d->values);
}

sg_status sg_derivation_apply(sg_derivation *d, const sg_change *change, sg_error *err)
{
    if (change->slice != NULL)
        return sg_derivation_splice(d, change->node, change->slice, err);
    set_draws(d, change);
    return SG_OK;
}

sg_status sg_derivation_make_room(sg_derivation *d, const sg_change *change, sg_error *err)
{
    if (change->slice == NULL)
        return SG_OK;
    /* More than the splice asks for, and nothing once the arrays have grown. */
    return sg_derivation_room(d, change->slice->nnodes, change->slice->nuniforms, change->slice->nvalues, err);
}
