/* SPDX-License-Identifier: GPL-3.0-or-later */
/* derivation_json_tree.c - derivations of any grammar as JSON, node by node as they are stored. */
#include "scene/derivation_json.h"

#include "scene/json_node.h"

/* Close the node, if it is a leaf, and all subtrees that end with it. */
static void close_subtrees(const sg_derivation *d, size_t node, FILE *out)
{
    for (size_t at = node; at + d->nodes[at].length == node + 1; at -= d->nodes[at].parent) {
        fputs("]}", out);
        if (d->nodes[at].parent == 0)
            return;
    }
}

sg_status sg_derivation_write_json_tree(const sg_derivation *d, FILE *out, sg_error *err)
{
    if (d->nnodes == 0)
        return SG_FAIL(err, SG_EINVAL, "an empty derivation");
    for (size_t i = 0; i < d->nnodes; i++) {
        if (d->nodes[i].parent > 1) /* not the first child */
            fputs(",", out);
        SG_TRY(sg_json_node_begin(d, i, out, err));
        SG_TRY(sg_json_node_end(d, i, out, err));
        close_subtrees(d, i, out);
    }
    return ferror(out) ? SG_FAIL(err, SG_EIO, "writing a derivation failed") : SG_OK;
}
