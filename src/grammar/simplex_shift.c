/* SPDX-License-Identifier: GPL-3.0-or-later */
/* simplex_shift.c - what it does to the density of sizes when the boundary between two of them moves. */
#include "config.h"

#include "grammar/simplex_priv.h"

#include <string.h>

/* How the centre of size i > j moves when size j grows by e and size j+1 shrinks by it. */
static double drift(const sg_simplex *s, size_t i, size_t j, double e)
{
    if (s->pull == NULL)
        return i == j + 1 ? s->sizes[i].pull * e : 0;
    const double *pull = s->pull + i * (s->k - 1) + j;
    return i == j + 1 ? pull[0] * e : (pull[0] - pull[1]) * e;
}

/* One shift, term by term. */
typedef struct {
    const sg_simplex *s;
    const double *value;
    const sg_simplex_term *terms; /* NULL: made where they are needed */
    size_t j;
    double e;
    sg_simplex_term *shifted; /* may be NULL */
    double exponents;         /* after less before */
    sg_log_sum masses;        /* before over after */
} shift;

static void put_term(shift *f, size_t i, const sg_simplex_term *before, const sg_simplex_term *after)
{
    f->exponents += after->exponent - before->exponent;
    if (after->mass != before->mass)
        sg_log_multiply(&f->masses, before->mass / after->mass);
    if (f->shifted != NULL)
        f->shifted[i] = *after;
}

/* The size that grows: its mean and its bounds stay. rest: before it. */
static void shift_first(shift *f, double rest)
{
    const sg_size_model *m = f->s->sizes + f->j;
    const double centre = f->terms != NULL ? f->terms[f->j].centre : sg_size_centre(f->s, f->j, f->value, rest);
    const double width = rest * m->rate, value = f->value[f->j];
    const double mass = f->terms != NULL ? f->terms[f->j].mass : 1; /* no matter which */
    put_term(f, f->j, &(sg_simplex_term){centre, sg_truncated_exponent(-centre, width, value * m->rate), mass},
             &(sg_simplex_term){centre, sg_truncated_exponent(-centre, width, (value + f->e) * m->rate), mass});
}

/* One behind it; rest: before it, as it was. */
static void shift_next(shift *f, size_t i, double rest)
{
    const sg_size_model *m = f->s->sizes + i;
    const double by = drift(f->s, i, f->j, f->e), e = i == f->j + 1 ? f->e : 0;
    if (by == 0 && e == 0) {
        if (f->shifted != NULL)
            f->shifted[i] = f->terms[i];
        return;
    }
    const sg_simplex_term before =
        f->terms != NULL ? f->terms[i] : sg_size_term(m, sg_size_centre(f->s, i, f->value, rest), f->value[i], rest);
    const sg_simplex_term after = sg_size_term(m, before.centre + by, f->value[i] - e, rest - e);
    put_term(f, i, &before, &after);
}

static bool possible(const sg_simplex *s, const double *value, size_t j, double e, double rest)
{
    const double grown = value[j] + e, shrunk = value[j + 1] - e;
    return grown > 0 && shrunk > 0 && grown < rest && (j + 2 == s->k || shrunk < rest - grown);
}

double sg_simplex_shift(const sg_simplex *s, const double *value, const sg_simplex_term *terms, size_t j, double e,
                        sg_simplex_term *shifted)
{
    double rest = sg_simplex_rest(j, value);
    if (!possible(s, value, j, e, rest))
        return -INFINITY;
    if (shifted != NULL && terms == NULL) {
        if (!sg_simplex_terms(s, value, shifted))
            return -INFINITY;
        terms = shifted;
    }
    if (shifted != terms && shifted != NULL && j > 0)
        memcpy(shifted, terms, j * sizeof *terms);
    shift f = {s, value, terms, j, e, shifted, 0, {1, 0}};
    shift_first(&f, rest);
    const size_t n = s->k - 1, end = s->pull == NULL && shifted == NULL && j + 2 < n ? j + 2 : n;
    for (size_t i = j + 1; i < end; i++) {
        rest -= value[i - 1];
        shift_next(&f, i, rest);
    }
    return f.exponents + sg_log_total(&f.masses);
}
