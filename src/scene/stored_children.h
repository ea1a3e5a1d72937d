/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stored_children.h - which child of a node a successor of its rule places. */
#ifndef SG_SCENE_STORED_CHILDREN_H
#define SG_SCENE_STORED_CHILDREN_H

#include "derivation/derivation.h"

/** How far a body is read: successors must come in its order. */
typedef struct {
    uint32_t id; /* sg_op.child of successors outside repeats: those below it are known */
    size_t next; /* first stored child that was not placed */
} sg_child_cursor;

/** Work space: a zeroed one is empty. */
typedef struct {
    size_t *nodes; /* of the children */
    size_t n, capacity;
    size_t *position; /* sg_op.child -> stored child */
    size_t position_capacity;
    sg_child_cursor at;
} sg_stored_children;

/** Find the children of a node that has rule r, and go to the begin of its body. @return SG_OK, SG_ENOMEM */
sg_status sg_stored_children_find(sg_stored_children *c, const sg_derivation *d, size_t node, const sg_rule *r,
                                  sg_error *err);
/** The node of the successor op: a new child, or the one that it is tied to.
 *  @return false when there are fewer children than the rule asks for */
bool sg_stored_children_next(sg_stored_children *c, const sg_op *op, bool in_repeat, size_t *node);
void sg_stored_children_clear(sg_stored_children *c);

#endif
