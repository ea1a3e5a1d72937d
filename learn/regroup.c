/* SPDX-License-Identifier: GPL-3.0-or-later */
/* regroup.c - pairs of neighbouring rows with corresponding cells. */
#include "learn/regroup_priv.h"

#include <stdbool.h>
#include <string.h>

#define HASH_NONFATAL_OOM 1
#define uthash_nonfatal_oom(item) ((item)->failed = true)
/* tables live in the arena too, and go with it */
#define uthash_malloc(size) sg_arena_alloc(g->arena, (size))
#define uthash_free(pointer, size) ((void)(pointer))
#include <uthash.h>

#define NO_TERMINAL UINT32_MAX

typedef struct signature {
    uint32_t *below; /* [nterminals]: what stands below a terminal, or NO_TERMINAL */
    size_t count;
    bool failed;
    UT_hash_handle hh;
} signature;

struct sg_regroup {
    sg_arena *arena;
    signature *all;
};

sg_regroup *sg_regroup_create(sg_arena *arena)
{
    sg_regroup *g = SG_NEW(arena, sg_regroup);
    if (g != NULL)
        g->arena = arena;
    return g;
}

/* Fill below[] and above[] ([nterminals] each); false when the rows do not correspond one to one. */
static bool correspond(const uint32_t *upper, const uint32_t *lower, size_t width, size_t nterminals, uint32_t *below,
                       uint32_t *above)
{
    memset(below, 0xff, nterminals * sizeof *below);
    memset(above, 0xff, nterminals * sizeof *above);
    size_t npairs = 0;
    for (size_t x = 0; x < width; x++) {
        const uint32_t u = upper[x], v = lower[x];
        if (below[u] == NO_TERMINAL && above[v] == NO_TERMINAL) {
            below[u] = v;
            above[v] = u;
            npairs++;
        } else if (below[u] != v || above[v] != u) {
            return false;
        }
    }
    return npairs >= 2;
}

static signature *find(const sg_regroup *g, const uint32_t *below, size_t nterminals)
{
    signature *s = NULL;
    HASH_FIND(hh, g->all, below, nterminals * sizeof *below, s);
    return s;
}

sg_status sg_regroup_count(sg_regroup *g, const uint32_t *t, size_t width, size_t height, size_t nterminals)
{
    uint32_t *above = SG_NEW_ARRAY(g->arena, uint32_t, nterminals);
    if (above == NULL)
        return SG_ENOMEM;
    for (size_t y = 0; y + 1 < height; y++) {
        uint32_t *below = SG_NEW_ARRAY(g->arena, uint32_t, nterminals);
        if (below == NULL)
            return SG_ENOMEM;
        if (!correspond(t + y * width, t + (y + 1) * width, width, nterminals, below, above))
            continue;
        signature *s = find(g, below, nterminals);
        if (s == NULL) {
            s = SG_NEW(g->arena, signature);
            if (s == NULL)
                return SG_ENOMEM;
            s->below = below;
            HASH_ADD_KEYPTR(hh, g->all, s->below, nterminals * sizeof *below, s);
            if (s->failed)
                return SG_ENOMEM;
        }
        s->count++;
    }
    return SG_OK;
}

/* weight[y]: frequency of the signature of rows y and y+1, 0 when they do not correspond. */
static sg_status weigh(const sg_regroup *g, const uint32_t *t, size_t width, size_t height, size_t nterminals,
                       size_t *weight)
{
    uint32_t *below = SG_NEW_ARRAY(g->arena, uint32_t, 2 * nterminals);
    if (below == NULL)
        return SG_ENOMEM;
    for (size_t y = 0; y + 1 < height; y++) {
        weight[y] = 0;
        if (!correspond(t + y * width, t + (y + 1) * width, width, nterminals, below, below + nterminals))
            continue;
        const signature *s = find(g, below, nterminals);
        weight[y] = s != NULL ? s->count : 0;
    }
    return SG_OK;
}

sg_status sg_regroup_rows(const sg_regroup *g, const uint32_t *t, size_t width, size_t height, size_t nterminals,
                          size_t *first, size_t *ngroups)
{
    size_t *weight = SG_NEW_ARRAY(g->arena, size_t, height);
    bool *with_next = SG_NEW_ARRAY(g->arena, bool, height + 1);
    if (weight == NULL || with_next == NULL)
        return SG_ENOMEM;
    SG_TRY(weigh(g, t, width, height, nterminals, weight));
    for (;;) {
        size_t best = height;
        for (size_t y = 0; y + 1 < height; y++)
            if (weight[y] > 0 && (best == height || weight[y] > weight[best]))
                best = y;
        if (best == height)
            break;
        with_next[best] = true;
        weight[best] = weight[best + 1] = 0;
        if (best > 0)
            weight[best - 1] = 0;
    }
    *ngroups = 0;
    for (size_t y = 0; y < height; y += with_next[y] ? 2 : 1)
        first[(*ngroups)++] = y;
    first[*ngroups] = height;
    return SG_OK;
}
