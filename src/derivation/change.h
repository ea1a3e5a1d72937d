/* SPDX-License-Identifier: GPL-3.0-or-later */
/* change.h - a change of a derivation that is proposed but not made: what every search hands to every score.
 *
 * Two forms. A slice replaces the subtree of a node: the general one. Or the tree stays and the draws of one node take
 * other values on which nothing below depends but the geometry (no argument, no repeat count; sg_rule.draws_passed is
 * false): then nothing is copied, and a score recomputes only what moved. */
#ifndef SG_DERIVATION_CHANGE_H
#define SG_DERIVATION_CHANGE_H

#include "derivation/derivation.h"

typedef struct {
    const sg_derivation *current; /* complete, as it is before the change */
    size_t node;
    const sg_derivation *slice;   /* its root has the symbol, arguments and depth of the node; NULL: the second form */
    const double *uniforms;       /* second form: [nuniforms of the node's rule] */
    const double *values;         /* second form: [nvalues of the node's rule], what the uniforms make */
} sg_change;

/** Make the change in d, which is change->current. @return SG_OK, SG_EINVAL, SG_ENOMEM; on failure d is as it was */
sg_status sg_derivation_apply(sg_derivation *d, const sg_change *change, sg_error *err);

/** Take the memory that the change needs: sg_derivation_apply() then cannot fail for want of it. @return SG_OK, SG_ENOMEM */
sg_status sg_derivation_make_room(sg_derivation *d, const sg_change *change, sg_error *err);

#endif
