/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stored_children.c - which child of a node a successor of its rule places. */
#include "scene/stored_children.h"

#include "core/array.h"

#include <stdlib.h>
#include <string.h>

sg_status sg_stored_children_find(sg_stored_children *c, const sg_derivation *d, size_t node, const sg_rule *r,
                                  sg_error *err)
{
    c->n = 0;
    c->at = (sg_child_cursor){0, 0};
    for (size_t i = node + 1; i < node + d->nodes[node].length; i += d->nodes[i].length) {
        if (!SG_GROW(c->nodes, c->capacity, c->n + 1))
            return SG_FAIL_NOMEM(err);
        c->nodes[c->n++] = i;
    }
    return SG_GROW(c->position, c->position_capacity, (size_t)r->nops + 1) ? SG_OK : SG_FAIL_NOMEM(err);
}

static size_t child_of(sg_stored_children *c, const sg_op *op, bool in_repeat)
{
    if (!in_repeat && op->child < c->at.id)
        return c->position[op->child];
    if (!in_repeat) {
        c->at.id = op->child + 1;
        c->position[op->child] = c->at.next;
    }
    return c->at.next++;
}

bool sg_stored_children_next(sg_stored_children *c, const sg_op *op, bool in_repeat, size_t *node)
{
    const size_t child = child_of(c, op, in_repeat);
    if (child >= c->n)
        return false;
    *node = c->nodes[child];
    return true;
}

void sg_stored_children_clear(sg_stored_children *c)
{
    free(c->nodes);
    free(c->position);
    memset(c, 0, sizeof *c);
}
