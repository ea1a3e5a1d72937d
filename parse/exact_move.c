/* SPDX-License-Identifier: GPL-3.0-or-later */
/* exact_move.c - with the tree as it is, cuts go to where the energy is least: each by itself, and a part as a whole
 * between its neighbours, over all pixels that there are. No step raises the energy. */
#include "parse/exact_priv.h"

#include <math.h>
#include <string.h>

typedef struct {
    const sg_exact_problem *p;
    sg_arena *arena;
    double *work, *sizes, *trial; /* [longest + 1] */
    bool moved;
} mover;

/* A node in its places, with the ends of its parts as shares. */
typedef struct {
    sg_exact_node *e;
    const sg_exact_place *at;
    size_t nplaces;
    double *end;   /* [n + 1], from 0 to 1 */
    double length; /* px, of the longest place */
} split;

/* Sizes, and the image of parts first..last, with the ends in m->trial. */
static double trial_energy(const mover *m, const split *s, uint32_t first, uint32_t last)
{
    for (uint32_t i = 0; i < s->e->rule->n; i++)
        m->sizes[i] = m->trial[i + 1] - m->trial[i];
    double sum = sg_exact_size_energy(m->p, s->e->rule, m->sizes, m->work);
    for (size_t k = 0; k < s->nplaces && sum < INFINITY; k++)
        for (uint32_t i = first; i <= last; i++)
            sum += sg_exact_image_energy(m->p, s->e->children[i],
                                         sg_exact_part(s->e->rule, s->at[k], m->trial[i], m->trial[i + 1]));
    return sum;
}

/* Shift cuts first + 1 .. last together, between the far ends of parts first and last, so that one is at a whole pixel. */
static void shift(mover *m, split *s, uint32_t first, uint32_t last)
{
    const double at = s->end[first + 1] * s->length, room = (s->end[last + 1] - s->end[last]) * s->length;
    double best = 0;
    memcpy(m->trial, s->end, (s->e->rule->n + 1) * sizeof *s->end);
    double least = trial_energy(m, s, first, last) - 1e-9;
    for (double to = floor(s->end[first] * s->length) + 1; to < at + room; to++) {
        const double by = (to - at) / s->length;
        for (uint32_t i = first + 1; i <= last; i++)
            m->trial[i] = s->end[i] + by;
        const double energy = trial_energy(m, s, first, last);
        if (energy < least) {
            least = energy;
            best = by;
        }
    }
    m->moved = m->moved || best != 0;
    for (uint32_t i = first + 1; i <= last; i++)
        s->end[i] += best;
}

static void shift_all(mover *m, split *s)
{
    const uint32_t n = s->e->rule->n;
    for (uint32_t i = 0; i + 1 < n; i++)
        shift(m, s, i, i + 1);
    for (uint32_t i = 0; i + 2 < n; i++)
        shift(m, s, i, i + 2);
    for (uint32_t i = 0; i < n; i++)
        s->e->sizes[i] = s->end[i + 1] - s->end[i];
}

static sg_status move_node(mover *m, sg_exact_node *e, const sg_exact_place *at, size_t nplaces, sg_error *err);

/* Below tied siblings a child stands in several parts of each place. */
static sg_status move_children(mover *m, const split *s, sg_error *err)
{
    const sg_split_rule *r = s->e->rule;
    sg_exact_place *at = SG_NEW_ARRAY(m->arena, sg_exact_place, s->nplaces * r->n);
    if (at == NULL)
        return SG_FAIL_NOMEM(err);
    for (uint32_t i = 0; i < r->n; i++) {
        size_t n = 0;
        if (sg_exact_first(m->p, r, i) != i)
            continue;
        for (uint32_t j = i; j < r->n; j++)
            for (size_t k = 0; k < s->nplaces && sg_exact_first(m->p, r, j) == i; k++)
                at[n++] = sg_exact_part(r, s->at[k], s->end[j], s->end[j + 1]);
        SG_TRY(move_node(m, s->e->children[i], at, n, err));
    }
    return SG_OK;
}

static sg_status move_node(mover *m, sg_exact_node *e, const sg_exact_place *at, size_t nplaces, sg_error *err)
{
    if (e->rule->op == SG_SPLIT_LEXICAL)
        return SG_OK;
    const sg_mark mark = sg_arena_mark(m->arena);
    split s = {e, at, nplaces, SG_NEW_ARRAY(m->arena, double, e->rule->n + 1), 0};
    if (s.end == NULL)
        return SG_FAIL_NOMEM(err);
    for (uint32_t i = 0; i < e->rule->n; i++)
        s.end[i + 1] = i + 1 < e->rule->n ? s.end[i] + e->sizes[i] : 1;
    for (size_t k = 0; k < nplaces; k++)
        s.length = fmax(s.length, sg_exact_length(e->rule, at[k]));
    if (sg_grammar_rule(m->p->g, e->rule->source)->ndraws > 0)
        shift_all(m, &s);
    const sg_status st = move_children(m, &s, err);
    sg_arena_rewind(m->arena, mark);
    return st;
}

sg_status sg_exact_move_cuts(const sg_exact_problem *p, sg_exact_node *root, sg_arena *arena, sg_error *err)
{
    enum { ROUNDS = 20 };
    const sg_exact_place whole = sg_exact_whole(p);
    mover m = {p, arena, SG_NEW_ARRAY(arena, double, p->longest + 1), SG_NEW_ARRAY(arena, double, p->longest + 1),
               SG_NEW_ARRAY(arena, double, p->longest + 1), true};
    if (m.work == NULL || m.sizes == NULL || m.trial == NULL)
        return SG_FAIL_NOMEM(err);
    for (int round = 0; round < ROUNDS && m.moved; round++) {
        m.moved = false;
        SG_TRY(move_node(&m, root, &whole, 1, err));
    }
    return SG_OK;
}
