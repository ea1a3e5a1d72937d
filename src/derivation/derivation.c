/* SPDX-License-Identifier: GPL-3.0-or-later */
/* derivation.c - memory of derivations: slices of three arrays that are copied, moved and mended together. */
#include "derivation/derivation.h"

#include "core/array.h"
#include "derivation/derivation_priv.h"

#include <stdlib.h>
#include <string.h>

void sg_derivation_init(sg_derivation *d, const sg_grammar *g)
{
    memset(d, 0, sizeof *d);
    d->grammar = g;
}

void sg_derivation_clear(sg_derivation *d)
{
    free(d->nodes);
    free(d->uniforms);
    free(d->values);
    free(d->pending.items);
    sg_derivation_init(d, d->grammar);
}

sg_status sg_derivation_reserve(sg_derivation *d, size_t nodes, size_t uniforms, size_t values, sg_error *err)
{
    const size_t most = SG_DERIVATION_MAX_ITEMS;
    if (nodes > most - d->nnodes || uniforms > most - d->nuniforms || values > most - d->nvalues)
        return SG_FAIL(err, SG_ENOMEM, "a derivation would hold more than %zu nodes or values", most);
    /* One more than is needed: then no array is NULL, and a node without values may point into it. */
    if (!SG_GROW(d->nodes, d->nodes_capacity, d->nnodes + nodes + 1) ||
        !SG_GROW(d->uniforms, d->uniforms_capacity, d->nuniforms + uniforms + 1) ||
        !SG_GROW(d->values, d->values_capacity, d->nvalues + values + 1))
        return SG_FAIL_NOMEM(err);
    return SG_OK;
}

static void copy_items(void *dst, const void *src, size_t n, size_t size)
{
    if (n > 0)
        memcpy(dst, src, n * size);
}

static void move_items(void *base, size_t from, ptrdiff_t by, size_t end, size_t size)
{
    char *at = base;
    if (end > from && by != 0)
        memmove(at + (size_t)((ptrdiff_t)from + by) * size, at + from * size, (end - from) * size);
}

sg_status sg_derivation_copy(sg_derivation *dst, const sg_derivation *src, sg_error *err)
{
    if (dst == src)
        return SG_OK;
    const size_t nodes = dst->nnodes, uniforms = dst->nuniforms, values = dst->nvalues;
    dst->nnodes = dst->nuniforms = dst->nvalues = 0;
    const sg_status st = sg_derivation_reserve(dst, src->nnodes, src->nuniforms, src->nvalues, err);
    if (st != SG_OK) {
        dst->nnodes = nodes;
        dst->nuniforms = uniforms;
        dst->nvalues = values;
        return st;
    }
    dst->grammar = src->grammar;
    copy_items(dst->nodes, src->nodes, src->nnodes, sizeof *src->nodes);
    copy_items(dst->uniforms, src->uniforms, src->nuniforms, sizeof *src->uniforms);
    copy_items(dst->values, src->values, src->nvalues, sizeof *src->values);
    dst->nnodes = src->nnodes;
    dst->nuniforms = src->nuniforms;
    dst->nvalues = src->nvalues;
    return SG_OK;
}

size_t sg_derivation_append(sg_derivation *d, sg_sym symbol, uint32_t parent, uint32_t depth, uint32_t nparams)
{
    const size_t node = d->nnodes++;
    d->nodes[node] = (sg_node){.symbol = symbol,
                               .rule = SG_NONE,
                               .parent = parent,
                               .length = 1,
                               .depth = depth,
                               .values = (uint32_t)d->nvalues,
                               .uniforms = (uint32_t)d->nuniforms};
    d->nvalues += nparams;
    return node;
}

sg_status sg_derivation_open(sg_derivation *d, sg_sym symbol, const double *args, uint32_t depth, sg_error *err)
{
    const uint32_t nparams = sg_grammar_symbol(d->grammar, symbol)->nparams;
    d->nnodes = d->nuniforms = d->nvalues = 0;
    SG_TRY(sg_derivation_reserve(d, 1, 0, nparams, err));
    sg_derivation_append(d, symbol, 0, depth, nparams);
    copy_items(d->values, args, nparams, sizeof *args);
    return SG_OK;
}

/* Right siblings of the node and of its ancestors are the only nodes behind it whose parent stands in front of it. */
static void shift_parents(sg_derivation *d, size_t node, ptrdiff_t by)
{
    while (d->nodes[node].parent != 0) {
        const size_t parent = node - d->nodes[node].parent, end = parent + d->nodes[parent].length;
        for (size_t c = node + d->nodes[node].length; c < end; c += d->nodes[c].length)
            d->nodes[c].parent = (uint32_t)((ptrdiff_t)d->nodes[c].parent + by);
        node = parent;
    }
}

static void shift_offsets(sg_derivation *d, size_t first, ptrdiff_t values, ptrdiff_t uniforms)
{
    for (size_t i = first; i < d->nnodes; i++) {
        d->nodes[i].values = (uint32_t)((ptrdiff_t)d->nodes[i].values + values);
        d->nodes[i].uniforms = (uint32_t)((ptrdiff_t)d->nodes[i].uniforms + uniforms);
    }
}

void sg_derivation_shift(sg_derivation *d, size_t node, ptrdiff_t nodes, size_t first_value, ptrdiff_t values,
                         size_t first_uniform, ptrdiff_t uniforms)
{
    const size_t first = node + d->nodes[node].length;
    if (values != 0 || uniforms != 0)
        shift_offsets(d, first, values, uniforms);
    if (nodes != 0)
        shift_parents(d, node, nodes);
    move_items(d->nodes, first, nodes, d->nnodes, sizeof *d->nodes);
    move_items(d->values, first_value, values, d->nvalues, sizeof *d->values);
    move_items(d->uniforms, first_uniform, uniforms, d->nuniforms, sizeof *d->uniforms);
    d->nnodes = (size_t)((ptrdiff_t)d->nnodes + nodes);
    d->nvalues = (size_t)((ptrdiff_t)d->nvalues + values);
    d->nuniforms = (size_t)((ptrdiff_t)d->nuniforms + uniforms);
}

void sg_derivation_stretch(sg_derivation *d, size_t node, ptrdiff_t nodes)
{
    while (d->nodes[node].parent != 0) {
        node -= d->nodes[node].parent;
        d->nodes[node].length = (uint32_t)((ptrdiff_t)d->nodes[node].length + nodes);
    }
}

/* Offsets at which a subtree begins and ends in the three arrays. */
typedef struct {
    size_t node, node_end, value, value_end, uniform, uniform_end;
} extent;

static extent extent_of(const sg_derivation *d, size_t node)
{
    const size_t end = node + d->nodes[node].length;
    const bool last = end == d->nnodes;
    return (extent){node,
                    end,
                    d->nodes[node].values,
                    last ? d->nvalues : d->nodes[end].values,
                    d->nodes[node].uniforms,
                    last ? d->nuniforms : d->nodes[end].uniforms};
}

static size_t growth(size_t now, size_t before)
{
    return now > before ? now - before : 0;
}

sg_status sg_derivation_splice(sg_derivation *d, size_t node, const sg_derivation *slice, sg_error *err)
{
    if (slice->nnodes == 0 || slice->nodes[0].symbol != d->nodes[node].symbol)
        return SG_FAIL(err, SG_EINVAL, "node %zu derives another symbol than what should replace it", node);
    const extent e = extent_of(d, node);
    const size_t old_nodes = e.node_end - e.node, old_values = e.value_end - e.value,
                 old_uniforms = e.uniform_end - e.uniform;
    SG_TRY(sg_derivation_reserve(d, growth(slice->nnodes, old_nodes), growth(slice->nuniforms, old_uniforms),
                                 growth(slice->nvalues, old_values), err));
    const ptrdiff_t more = (ptrdiff_t)slice->nnodes - (ptrdiff_t)old_nodes;
    const uint32_t parent = d->nodes[node].parent, depth = d->nodes[node].depth - slice->nodes[0].depth; /* mod 2^32 */
    sg_derivation_shift(d, node, more, e.value_end, (ptrdiff_t)slice->nvalues - (ptrdiff_t)old_values, e.uniform_end,
                        (ptrdiff_t)slice->nuniforms - (ptrdiff_t)old_uniforms);
    copy_items(d->uniforms + e.uniform, slice->uniforms, slice->nuniforms, sizeof *d->uniforms);
    copy_items(d->values + e.value, slice->values, slice->nvalues, sizeof *d->values);
    for (size_t i = 0; i < slice->nnodes; i++) {
        sg_node n = slice->nodes[i];
        n.depth += depth;
        n.values += (uint32_t)e.value;
        n.uniforms += (uint32_t)e.uniform;
        d->nodes[node + i] = n;
    }
    d->nodes[node].parent = parent;
    sg_derivation_stretch(d, node, more);
    return SG_OK;
}

sg_status sg_derivation_extract(const sg_derivation *d, size_t node, sg_derivation *slice, sg_error *err)
{
    const extent e = extent_of(d, node);
    slice->nnodes = slice->nuniforms = slice->nvalues = 0;
    SG_TRY(sg_derivation_reserve(slice, e.node_end - e.node, e.uniform_end - e.uniform, e.value_end - e.value, err));
    slice->grammar = d->grammar;
    slice->nnodes = e.node_end - e.node;
    slice->nuniforms = e.uniform_end - e.uniform;
    slice->nvalues = e.value_end - e.value;
    copy_items(slice->uniforms, d->uniforms + e.uniform, slice->nuniforms, sizeof *d->uniforms);
    copy_items(slice->values, d->values + e.value, slice->nvalues, sizeof *d->values);
    for (size_t i = 0; i < slice->nnodes; i++) {
        sg_node n = d->nodes[node + i];
        n.values -= (uint32_t)e.value;
        n.uniforms -= (uint32_t)e.uniform;
        slice->nodes[i] = n;
    }
    slice->nodes[0].parent = 0;
    return SG_OK;
}

bool sg_derivation_complete(const sg_derivation *d)
{
    for (size_t i = 0; i < d->nnodes; i++)
        if (d->nodes[i].rule == SG_NONE)
            return false;
    return d->nnodes > 0;
}
