/* SPDX-License-Identifier: GPL-3.0-or-later */
/* lattice_target.c - the prices of lines and cells: from description length, or bisected for a wanted size or accuracy. */
#include "image/classes.h"
#include "parse/lattice_fit_priv.h"

#include <math.h>
#include <string.h>

/* Code lengths of yes-no decisions by context, from counts alone: the Krichevsky-Trofimov probability of a sequence
 * depends on nothing else (Krichevsky and Trofimov, "The performance of universal encoding", 1981). */
typedef struct {
    size_t no, yes;
} decisions;

static double code_length(const decisions *d)
{
    const double no = (double)d->no, yes = (double)d->yes;
    return lgamma(no + yes + 1) + 2 * lgamma(0.5) - lgamma(no + 0.5) - lgamma(yes + 0.5);
}

static void decide(decisions *d, bool yes)
{
    if (yes)
        d->yes++;
    else
        d->no++;
}

typedef struct {
    decisions wrong[16];         /* by which neighbours are wrong */
    decisions like_left, like_above;
    size_t others;               /* wrong pixels that are like neither */
} residual;

/* wrong[p] is 0, or 1 + the label of a wrong pixel, one pixel further than a row has on both sides. */
static void add_row(const uint8_t *label, size_t width, const uint8_t *wrong, const uint8_t *above, residual *r)
{
    for (size_t x = 0; x < width; x++) {
        if (label[x] == SG_CLASS_IGNORE)
            continue;
        const uint8_t *w = wrong + x, *a = above + x; /* [0] is the pixel to the left */
        decide(&r->wrong[(w[0] > 0) + 2 * (a[0] > 0) + 4 * (a[1] > 0) + 8 * (a[2] > 0)], w[1] > 0);
        if (w[1] == 0)
            continue;
        if (w[0] > 0)
            decide(&r->like_left, w[1] == w[0]);
        else if (a[1] > 0)
            decide(&r->like_above, w[1] == a[1]);
        const uint8_t guess = w[0] > 0 ? w[0] : a[1];
        r->others += guess == 0 || guess != w[1];
    }
}

static void mark_wrong(const uint8_t *label, const sg_lattice_fit *f, size_t row, uint8_t *wrong)
{
    for (size_t column = 0; column < f->width; column++) {
        const uint8_t class = f->classes[row * f->width + column];
        for (uint32_t x = f->x[column]; x < f->x[column + 1]; x++)
            wrong[x + 1] = label[x] == SG_CLASS_IGNORE || label[x] == class ? 0 : (uint8_t)(label[x] + 1);
    }
}

double sg_lattice_residual_length(const sg_lattice_source *source, const sg_lattice_fit *f, sg_arena *scratch)
{
    residual r = {0};
    const size_t room = source->width + 2;
    const sg_mark mark = sg_arena_mark(scratch);
    uint8_t *above = SG_NEW_ARRAY(scratch, uint8_t, room), *wrong = SG_NEW_ARRAY(scratch, uint8_t, room);
    if (above == NULL || wrong == NULL)
        return NAN;
    for (size_t row = 0; row < f->height; row++)
        for (uint32_t y = f->y[row]; y < f->y[row + 1]; y++) {
            const uint8_t *label = source->labels + (size_t)y * source->width;
            mark_wrong(label, f, row, wrong);
            add_row(label, source->width, wrong, above, &r);
            uint8_t *other = above;
            above = wrong;
            wrong = other;
        }
    sg_arena_rewind(scratch, mark);
    double nats = code_length(&r.like_left) + code_length(&r.like_above);
    for (size_t i = 0; i < 16; i++)
        nats += code_length(&r.wrong[i]);
    return nats + (double)r.others * log(source->nclasses > 2 ? (double)source->nclasses - 1 : 1);
}

static sg_lattice_weights length_weights(const sg_lattice_problem *p, double nats_per_loss)
{
    return (sg_lattice_weights){log((double)p->source.width) / nats_per_loss,
                                log((double)p->source.height) / nats_per_loss,
                                log((double)p->noccurring) / nats_per_loss};
}

sg_status sg_lattice_fit_length(sg_lattice_problem *p, sg_arena *arena, sg_lattice_fit *out, sg_error *err)
{
    enum { ROUNDS = 8 };
    if (p->source.costs != NULL) {
        const sg_lattice_weights w = length_weights(p, 1);
        return sg_lattice_fit_weights(p, &w, arena, out, err);
    }
    double price = 0.5; /* nats a wrong pixel: about where label maps of facades end */
    for (int round = 0; round < ROUNDS; round++) {
        const sg_lattice_weights w = length_weights(p, price);
        const sg_mark mark = sg_arena_mark(arena);
        sg_lattice_fit f;
        SG_TRY(sg_lattice_fit_starts(p, &w, 1, arena, &f, err));
        const double nats = f.wrong_px > 0 ? sg_lattice_residual_length(&p->source, &f, p->scratch) : 0;
        const double found = f.wrong_px > 0 ? nats / (double)f.wrong_px : price;
        sg_arena_rewind(arena, mark);
        if (isnan(found))
            return SG_FAIL_NOMEM(err);
        const bool stands = fabs(found - price) <= 0.01 * price;
        price = found;
        if (stands)
            break;
    }
    const sg_lattice_weights w = length_weights(p, price);
    return sg_lattice_fit_weights(p, &w, arena, out, err);
}

/* Bisection of the price of a cell: fits become smaller and less accurate as it grows. */
typedef struct {
    size_t cells;    /* at most so many, or 0 */
    double accuracy; /* at least so much, where cells is 0 */
} target;

static bool is_met(const target *t, const sg_lattice_fit *f)
{
    return t->cells > 0 ? f->width * f->height <= t->cells : sg_lattice_accuracy(f) >= t->accuracy;
}

static bool is_better(const target *t, const sg_lattice_fit *a, const sg_lattice_fit *b)
{
    const size_t cells_a = a->width * a->height, cells_b = b->width * b->height;
    if (t->cells > 0 && a->loss != b->loss)
        return a->loss < b->loss;
    return cells_a < cells_b || (cells_a == cells_b && a->loss < b->loss);
}

typedef struct {
    sg_arena *arena;
    sg_lattice_fit fit;
    bool met;
} best_fit;

/* One fit at a price; the best that meets the target is kept in an arena of its own. */
static sg_status try_price(sg_lattice_problem *p, const target *t, double price, size_t starts, sg_arena **spare,
                           best_fit *best, bool *met, sg_error *err)
{
    const sg_lattice_weights w = {0, 0, price};
    sg_lattice_fit f;
    sg_arena_reset(*spare);
    SG_TRY(sg_lattice_fit_starts(p, &w, starts, *spare, &f, err));
    *met = is_met(t, &f);
    if (!*met || (best->met && !is_better(t, &f, &best->fit)))
        return SG_OK;
    sg_arena *old = best->arena;
    *best = (best_fit){*spare, f, true};
    *spare = old;
    return SG_OK;
}

/* The border between the prices that meet the target and those that do not, to one per cent. A small lattice is found above
 * it, an accurate one below. From 1e-6 of the map a cell, where no pixel is given up in any usual map, to the whole map a
 * cell, where one cell is left. All starts at last, on the side that meets it. */
static sg_status bisect(sg_lattice_problem *p, const target *t, sg_arena **spare, best_fit *best, sg_error *err)
{
    double low = 1e-6 * (double)p->counted_px, high = (double)p->counted_px;
    bool met;
    SG_TRY(try_price(p, t, t->cells > 0 ? high : 0, 1, spare, best, &met, err));
    while (high > 1.01 * low) {
        const double price = sqrt(low * high);
        SG_TRY(try_price(p, t, price, 1, spare, best, &met, err));
        if (met == (t->cells > 0))
            high = price;
        else
            low = price;
    }
    return try_price(p, t, t->cells > 0 ? high : low, p->opts.starts, spare, best, &met, err);
}

static sg_status copy_fit(const sg_lattice_fit *f, sg_arena *arena, sg_lattice_fit *out, sg_error *err)
{
    sg_lattice_fit c = *f;
    c.x = sg_arena_copy(arena, f->x, (f->width + 1) * sizeof *f->x);
    c.y = sg_arena_copy(arena, f->y, (f->height + 1) * sizeof *f->y);
    c.classes = sg_arena_copy(arena, f->classes, f->width * f->height);
    c.trace = sg_arena_copy(arena, f->trace, f->nsteps * sizeof *f->trace);
    if (c.x == NULL || c.y == NULL || c.classes == NULL || c.trace == NULL)
        return SG_FAIL_NOMEM(err);
    *out = c;
    return SG_OK;
}

static sg_status fit_target(sg_lattice_problem *p, const target *t, sg_arena *arena, sg_lattice_fit *out, sg_error *err)
{
    sg_arena *spare = sg_arena_create();
    best_fit best = {.arena = sg_arena_create()};
    sg_status st = spare != NULL && best.arena != NULL ? bisect(p, t, &spare, &best, err) : SG_FAIL_NOMEM(err);
    if (st == SG_OK) {
        const sg_lattice_weights none = {0, 0, 0};
        st = best.met ? copy_fit(&best.fit, arena, out, err) : sg_lattice_fit_weights(p, &none, arena, out, err);
    }
    sg_arena_free(spare);
    sg_arena_free(best.arena);
    return st;
}

sg_status sg_lattice_fit_cells(sg_lattice_problem *p, size_t cells, sg_arena *arena, sg_lattice_fit *out, sg_error *err)
{
    if (cells == 0)
        return SG_FAIL(err, SG_EINVAL, "a lattice has at least one cell");
    return fit_target(p, &(target){cells, 0}, arena, out, err);
}

sg_status sg_lattice_fit_accuracy(sg_lattice_problem *p, double accuracy, sg_arena *arena, sg_lattice_fit *out,
                                  sg_error *err)
{
    if (!(accuracy >= 0 && accuracy <= 1))
        return SG_FAIL(err, SG_EINVAL, "an accuracy must be between 0 and 1");
    if (p->source.costs != NULL)
        return SG_FAIL(err, SG_EINVAL, "an accuracy can be asked for with labels only, not with costs");
    return fit_target(p, &(target){0, accuracy}, arena, out, err);
}
