/* SPDX-License-Identifier: GPL-3.0-or-later */
/* search_beam.c - several grammars side by side, without doubles.
 * Line 0 is the greedy one: its best child is always the next line 0, whatever the others are worth. */
#include "config.h"

#include "learn/search_priv.h"

#include <math.h>
#include <stdlib.h>

typedef struct {
    size_t parent;
    uint32_t a, b;
    double energy;
    uint64_t partition;
} child;

typedef struct {
    sg_line *now, *next, saved; /* [width] lines each */
    size_t nnow, nnext;
    child *children; /* [width * width] */
    size_t nchildren;
    double best; /* least energy so far */
    size_t best_line;
    bool best_is_now; /* it stands in now[best_line], else in saved */
    size_t since;     /* steps since it was found */
} beam;

static void clear(beam *b, size_t width)
{
    for (size_t i = 0; i < width; i++) {
        if (b->now != NULL)
            sg_line_clear(&b->now[i]);
        if (b->next != NULL)
            sg_line_clear(&b->next[i]);
    }
    sg_line_clear(&b->saved);
    free(b->now);
    free(b->next);
    free(b->children);
}

/* The same grammars grouped in the same way are the same grammar, in whatever order they were merged. */
static uint64_t partition_after(const sg_rules *r, uint32_t a, uint32_t b)
{
    const uint64_t x = r->symbols[a].members, y = r->symbols[b].members;
    return r->partition - sg_rules_mix(x) - sg_rules_mix(y) + sg_rules_mix(x + y);
}

static sg_status list_children(beam *b, size_t width, sg_candidate *scratch, sg_error *err)
{
    b->nchildren = 0;
    for (size_t i = 0; i < b->nnow; i++) {
        sg_line *l = &b->now[i];
        size_t n;
        SG_TRY(sg_candidates_top(&l->candidates, &l->rules, width, scratch, &n, err));
        const double base = sg_line_energy(l) + sg_merge_common(&l->rules);
        for (size_t k = 0; k < n; k++)
            b->children[b->nchildren++] = (child){i, scratch[k].a, scratch[k].b, base + scratch[k].key,
                                                  partition_after(&l->rules, scratch[k].a, scratch[k].b)};
    }
    return SG_OK;
}

/* The first child of line 0 stays where it is, in front. */
static int by_energy(const void *p, const void *q)
{
    const child *x = p, *y = q;
    if (x->energy != y->energy)
        return x->energy < y->energy ? -1 : 1;
    if (x->parent != y->parent)
        return x->parent < y->parent ? -1 : 1;
    if (x->a != y->a)
        return x->a < y->a ? -1 : 1;
    return (x->b > y->b) - (x->b < y->b);
}

static sg_status make_children(beam *b, size_t width, sg_error *err)
{
    if (b->nchildren > 1)
        qsort(b->children + 1, b->nchildren - 1, sizeof *b->children, by_energy);
    b->nnext = 0;
    for (size_t i = 0; i < b->nchildren && b->nnext < width; i++) {
        const child *c = &b->children[i];
        bool known = false;
        for (size_t k = 0; k < b->nnext && !known; k++)
            known = b->next[k].rules.partition == c->partition;
        if (known)
            continue;
        sg_line *l = &b->next[b->nnext];
        SG_TRY(sg_line_copy(l, &b->now[c->parent], err));
        SG_TRY(sg_line_merge(l, c->a, c->b, err));
        b->nnext++;
    }
    return SG_OK;
}

static size_t least(const sg_line *lines, size_t n)
{
    size_t best = 0;
    for (size_t i = 1; i < n; i++)
        if (sg_line_energy(&lines[i]) < sg_line_energy(&lines[best]))
            best = i;
    return best;
}

static sg_status take_generation(beam *b, const sg_search_opts *o, sg_error *err)
{
    const size_t first = least(b->next, b->nnext);
    const bool better = sg_line_energy(&b->next[first]) < b->best - SG_LEAST_GAIN;
    if (!better && b->best_is_now) {
        sg_line_swap(&b->saved, &b->now[b->best_line]);
        b->best_is_now = false;
    }
    sg_line *t = b->now;
    b->now = b->next;
    b->next = t;
    b->nnow = b->nnext;
    b->since++;
    if (!better)
        return SG_OK;
    SG_TRY(sg_line_reestimate(&b->now[first], o, true, err));
    b->best = sg_line_energy(&b->now[first]);
    b->best_line = first;
    b->best_is_now = true;
    b->since = 0;
    return SG_OK;
}

/* The greedy line is followed to its end, even when another one stalls below it. */
static bool greedy_goes_on(beam *b)
{
    sg_candidate best;
    double delta;
    return sg_line_best(&b->now[0], &best, &delta) && delta < -SG_LEAST_GAIN;
}

static sg_status run(beam *b, const sg_search_opts *o, sg_candidate *scratch, sg_error *err)
{
    while (b->since < o->patience || b->best_is_now || greedy_goes_on(b)) {
        if (!sg_search_goes_on(o, &b->now[0]))
            return SG_STOPPED;
        SG_TRY(list_children(b, o->width, scratch, err));
        if (b->nchildren == 0)
            break;
        SG_TRY(make_children(b, o->width, err));
        SG_TRY(take_generation(b, o, err));
    }
    return SG_OK;
}

sg_status sg_search_beam(sg_line *l, const sg_search_opts *o, sg_error *err)
{
    beam b = {.now = calloc(o->width, sizeof *b.now),
              .next = calloc(o->width, sizeof *b.next),
              .children = malloc((o->width * o->width + 1) * sizeof *b.children),
              .nnow = 1,
              .best_is_now = true};
    sg_candidate *scratch = malloc((o->width + 1) * sizeof *scratch);
    if (b.now == NULL || b.next == NULL || b.children == NULL || scratch == NULL) {
        clear(&b, o->width);
        free(scratch);
        return SG_FAIL_NOMEM(err);
    }
    sg_line_swap(&b.now[0], l);
    b.best = sg_line_energy(&b.now[0]);
    const sg_status st = run(&b, o, scratch, err);
    sg_line_swap(l, b.best_is_now ? &b.now[b.best_line] : &b.saved);
    clear(&b, o->width);
    free(scratch);
    return st;
}
