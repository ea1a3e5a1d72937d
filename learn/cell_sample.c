/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cell_sample.c - drawing label lattices. */
#include "config.h"

#include "learn/cell_sample.h"

#include "core/random.h"

#include <stdbool.h>
#include <string.h>

enum { MAX_DEPTH = 200 };

/* A rectangle of cells; NULL labels: it does not fit. */
typedef struct {
    size_t width, height;
    uint16_t *labels;
} block;

typedef struct {
    const sg_split_form *form;
    const size_t *first; /* [nsymbols + 1] rules of each symbol */
    gsl_rng *rng;
    sg_arena *arena;
    size_t max_cells;
    bool no_memory;
} work;

static const sg_split_rule *draw_rule(const work *w, uint32_t symbol)
{
    const size_t first = w->first[symbol], end = w->first[symbol + 1];
    const double u = sg_random_uniform(w->rng);
    double sum = 0;
    for (size_t i = first; i < end; i++) {
        sum += w->form->rules[i].probability;
        if (u < sum)
            return &w->form->rules[i];
    }
    return end > first ? &w->form->rules[end - 1] : NULL;
}

static block make_block(work *w, size_t width, size_t height)
{
    block b = {width, height, NULL};
    if (width * height > w->max_cells)
        return b;
    b.labels = SG_NEW_ARRAY(w->arena, uint16_t, width * height);
    w->no_memory |= b.labels == NULL;
    return b;
}

static void paste(block *to, const block *part, size_t x, size_t y)
{
    for (size_t r = 0; r < part->height; r++)
        memcpy(to->labels + (y + r) * to->width + x, part->labels + r * part->width,
               part->width * sizeof *part->labels);
}

static block join(work *w, const block *parts, uint32_t n, bool x)
{
    size_t along = 0;
    for (uint32_t i = 0; i < n; i++) {
        if (parts[i].labels == NULL || (x ? parts[i].height != parts[0].height : parts[i].width != parts[0].width))
            return (block){0, 0, NULL};
        along += x ? parts[i].width : parts[i].height;
    }
    block all = x ? make_block(w, along, parts[0].height) : make_block(w, parts[0].width, along);
    size_t at = 0;
    for (uint32_t i = 0; i < n && all.labels != NULL; i++) {
        paste(&all, &parts[i], x ? at : 0, x ? 0 : at);
        at += x ? parts[i].width : parts[i].height;
    }
    return all;
}

static block derive(work *w, uint32_t symbol, int depth)
{
    const block none = {0, 0, NULL};
    const sg_split_rule *r = depth < MAX_DEPTH ? draw_rule(w, symbol) : NULL;
    if (r == NULL)
        return none;
    if (r->op == SG_SPLIT_LEXICAL) {
        const block cell = make_block(w, 1, 1);
        if (cell.labels != NULL)
            cell.labels[0] = (uint16_t)r->rhs[0];
        return cell;
    }
    block *parts = SG_NEW_ARRAY(w->arena, block, r->n);
    w->no_memory |= parts == NULL;
    for (uint32_t i = 0; i < r->n && !w->no_memory; i++) {
        parts[i] = derive(w, r->rhs[i], depth + 1);
        if (parts[i].labels == NULL)
            return none;
    }
    return w->no_memory ? none : join(w, parts, r->n, r->op == SG_SPLIT_X);
}

static sg_status keep(const block *b, const sg_split_form *form, sg_arena *arena, sg_lattice *out, sg_error *err)
{
    const char **names = SG_NEW_ARRAY(arena, const char *, form->nterminals + 1);
    if (names == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t t = 0; t < form->nterminals; t++)
        names[t] = form->terminal_names[t];
    SG_TRY(sg_lattice_create(b->width, b->height, arena, out, err));
    for (size_t i = 0; i <= b->width; i++)
        out->x[i] = (uint32_t)i;
    for (size_t i = 0; i <= b->height; i++)
        out->y[i] = (uint32_t)i;
    memcpy(out->labels, b->labels, b->width * b->height * sizeof *b->labels);
    out->nlabels = form->nterminals;
    out->label_names = names;
    return SG_OK;
}

static size_t *find_first_rules(const sg_split_form *form, sg_arena *arena)
{
    size_t *first = SG_NEW_ARRAY(arena, size_t, form->nsymbols + 1);
    for (size_t s = 0, i = 0; first != NULL && s <= form->nsymbols; s++) {
        while (i < form->nrules && form->rules[i].lhs < s)
            i++;
        first[s] = i;
    }
    return first;
}

sg_status sg_cell_sample(const sg_split_form *form, gsl_rng *rng, size_t tries, size_t max_cells, sg_arena *arena,
                         sg_lattice *out, size_t *ntried, sg_error *err)
{
    if (form->tied)
        return SG_FAIL(err, SG_EINVAL, "lattices of cells are drawn from grammars without ties only");
    sg_arena *scratch = sg_arena_create();
    if (scratch == NULL)
        return SG_FAIL_NOMEM(err);
    work w = {
        .form = form, .first = find_first_rules(form, scratch), .rng = rng, .arena = scratch, .max_cells = max_cells};
    sg_status st = w.first != NULL ? SG_ENUMERIC : SG_ENOMEM;
    const sg_mark mark = sg_arena_mark(scratch);
    for (size_t i = 0; i < tries && st == SG_ENUMERIC; i++) {
        sg_arena_rewind(scratch, mark);
        const block b = derive(&w, form->axiom, 0);
        if (ntried != NULL)
            *ntried = i + 1;
        if (w.no_memory)
            st = SG_ENOMEM;
        else if (b.labels != NULL)
            st = keep(&b, form, arena, out, err);
    }
    sg_arena_free(scratch);
    if (st == SG_ENUMERIC)
        return SG_FAIL(err, st, "none of %zu derivations made a lattice of cells", tries);
    return st == SG_ENOMEM ? SG_FAIL_NOMEM(err) : st;
}
