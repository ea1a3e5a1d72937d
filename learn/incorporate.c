/* SPDX-License-Identifier: GPL-3.0-or-later */
/* incorporate.c - label lattices to the initial grammar of model merging. */
#include "learn/incorporate.h"

#include "learn/regroup_priv.h"
#include "learn/rule_builder_priv.h"

#include <string.h>

/* First word of a symbol's key. */
enum { KEY_AXIOM, KEY_LEXICAL, KEY_ROW, KEY_COLUMN };

typedef struct {
    sg_rule_builder *builder;
    sg_arena *arena;
    const sg_incorporate_opts *opts;
    const char **names; /* of the terminals in use */
    uint32_t *colors;
    size_t nterminals;
    uint32_t axiom, *lexical; /* [nterminals] symbols */
    uint32_t nunshared;       /* makes keys differ where nothing is shared */
    uint32_t nrows, ncolumns;
} work;

/* One lattice with its labels as terminals. */
typedef struct {
    const sg_lattice *lattice;
    uint32_t *terminals; /* [height][width] */
} item;

static sg_status add_terminal(work *w, const char *name, uint32_t color, uint32_t *index)
{
    for (size_t t = 0; t < w->nterminals; t++)
        if (strcmp(w->names[t], name) == 0) {
            *index = (uint32_t)t;
            return SG_OK;
        }
    const uint32_t key[2] = {KEY_LEXICAL, (uint32_t)w->nterminals};
    const uint32_t s = sg_rule_builder_symbol(w->builder, key, 2, NULL);
    char *copy = sg_arena_string(w->arena, name);
    if (s == SG_NONE || copy == NULL)
        return SG_ENOMEM;
    sg_rule_builder_name(w->builder, s, copy);
    *index = (uint32_t)w->nterminals++;
    w->names[*index] = copy;
    w->colors[*index] = color;
    w->lexical[*index] = s;
    return SG_OK;
}

static bool label_is_used(const sg_lattice *l, size_t label)
{
    for (size_t i = 0; i < l->width * l->height; i++)
        if (l->labels[i] == label)
            return true;
    return false;
}

static bool is_used(const sg_lattice *lattices, size_t n, const char *name)
{
    for (size_t i = 0; i < n; i++) {
        const uint16_t label = sg_lattice_find_label(&lattices[i], name);
        if (label != SG_LATTICE_NO_LABEL && label_is_used(&lattices[i], label))
            return true;
    }
    return false;
}

/* Terminals in the order of the caller's table, so that the grammar does not depend on the order of the lattices. */
static sg_status add_given_terminals(work *w, const sg_lattice *lattices, size_t n, sg_error *err)
{
    uint32_t t;
    for (size_t k = 0; k < w->opts->nterminals; k++)
        if (is_used(lattices, n, w->opts->terminal_names[k]) &&
            add_terminal(w, w->opts->terminal_names[k], w->opts->terminal_colors[k], &t) != SG_OK)
            return SG_FAIL_NOMEM(err);
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < lattices[i].nlabels; k++) {
            bool known = !label_is_used(&lattices[i], k);
            for (size_t j = 0; j < w->nterminals && !known; j++)
                known = strcmp(w->names[j], lattices[i].label_names[k]) == 0;
            if (!known)
                return SG_FAIL(err, SG_EINPUT, "lattice %zu has the label '%s', which the class table does not have",
                               i + 1, lattices[i].label_names[k]);
        }
    return SG_OK;
}

static sg_status add_found_terminals(work *w, const sg_lattice *lattices, size_t n, sg_error *err)
{
    uint32_t t;
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < lattices[i].nlabels; k++) {
            const uint32_t grey = (uint32_t)((w->nterminals * 61 + 40) % 216);
            if (label_is_used(&lattices[i], k) &&
                add_terminal(w, lattices[i].label_names[k], grey * 0x10101, &t) != SG_OK)
                return SG_FAIL_NOMEM(err);
        }
    return SG_OK;
}

/* A lexical symbol has the name of its label, and a label may be called S or R1 too. */
static bool is_terminal(const work *w, const char *name)
{
    for (size_t t = 0; t < w->nterminals; t++)
        if (strcmp(w->names[t], name) == 0)
            return true;
    return false;
}

static sg_status name_axiom(work *w)
{
    const char *name = "S";
    for (uint32_t i = 0; is_terminal(w, name); i++)
        if ((name = sg_arena_printf(w->arena, "S%u", i)) == NULL)
            return SG_ENOMEM;
    sg_rule_builder_name(w->builder, w->axiom, name);
    return SG_OK;
}

static sg_status begin(work *w, const sg_lattice *lattices, size_t n, sg_error *err)
{
    size_t most = w->opts->nterminals;
    for (size_t i = 0; i < n && w->opts->nterminals == 0; i++)
        most += lattices[i].nlabels;
    w->builder = sg_rule_builder_create(w->arena);
    w->names = SG_NEW_ARRAY(w->arena, const char *, most);
    w->colors = SG_NEW_ARRAY(w->arena, uint32_t, most);
    w->lexical = SG_NEW_ARRAY(w->arena, uint32_t, most);
    if (w->builder == NULL || w->names == NULL || w->colors == NULL || w->lexical == NULL)
        return SG_FAIL_NOMEM(err);
    w->axiom = sg_rule_builder_symbol(w->builder, &(uint32_t){KEY_AXIOM}, 1, NULL);
    if (w->axiom == SG_NONE)
        return SG_FAIL_NOMEM(err);
    SG_TRY(w->opts->nterminals > 0 ? add_given_terminals(w, lattices, n, err) : add_found_terminals(w, lattices, n, err));
    return name_axiom(w) == SG_OK ? SG_OK : SG_FAIL_NOMEM(err);
}

static sg_status make_item(work *w, const sg_lattice *l, item *it)
{
    uint32_t *map = SG_NEW_ARRAY(w->arena, uint32_t, l->nlabels);
    it->lattice = l;
    it->terminals = SG_NEW_ARRAY(w->arena, uint32_t, l->width * l->height);
    if (map == NULL || it->terminals == NULL)
        return SG_ENOMEM;
    for (size_t k = 0; k < l->nlabels; k++)
        for (size_t t = 0; t < w->nterminals; t++)
            if (strcmp(w->names[t], l->label_names[k]) == 0)
                map[k] = (uint32_t)t;
    for (size_t i = 0; i < l->width * l->height; i++)
        it->terminals[i] = map[l->labels[i]];
    return SG_OK;
}

/* Relative sizes of the parts between boundaries at[0], at[step...]: parts are given by their first boundary index. */
static void relative_sizes(const uint32_t *boundary, const size_t *first, size_t n, double *sizes)
{
    const double whole = boundary[first[n]] - boundary[first[0]];
    for (size_t i = 0; i < n; i++)
        sizes[i] = (boundary[first[i + 1]] - boundary[first[i]]) / whole;
}

static sg_status name_new(work *w, uint32_t symbol, bool is_new, char letter, uint32_t *count)
{
    if (symbol == SG_NONE)
        return SG_ENOMEM;
    if (!is_new)
        return SG_OK;
    const char *name;
    do {
        if ((name = sg_arena_printf(w->arena, "%c%u", letter, ++*count)) == NULL)
            return SG_ENOMEM;
    } while (is_terminal(w, name));
    sg_rule_builder_name(w->builder, symbol, name);
    return SG_OK;
}

/* Symbol of the cells in column x of the rows y0..y1-1: lexical for one row, else a column of split-y. */
static sg_status column_symbol(work *w, const item *it, size_t x, size_t y0, size_t y1, uint32_t group, uint32_t *out)
{
    const sg_lattice *l = it->lattice;
    const size_t n = y1 - y0;
    if (n == 1) {
        *out = w->lexical[it->terminals[y0 * l->width + x]];
        return SG_OK;
    }
    uint32_t *key = SG_NEW_ARRAY(w->arena, uint32_t, n + 2);
    size_t *first = SG_NEW_ARRAY(w->arena, size_t, n + 1);
    double *sizes = SG_NEW_ARRAY(w->arena, double, n);
    if (key == NULL || first == NULL || sizes == NULL)
        return SG_ENOMEM;
    key[0] = KEY_COLUMN;
    key[1] = w->opts->share == SG_SHARE_NONE ? group : 0;
    for (size_t i = 0; i < n; i++)
        key[2 + i] = w->lexical[it->terminals[(y0 + i) * l->width + x]];
    for (size_t i = 0; i <= n; i++)
        first[i] = y0 + i;
    relative_sizes(l->y, first, n, sizes);
    bool is_new = false;
    *out = sg_rule_builder_symbol(w->builder, key, n + 2, &is_new);
    SG_TRY(name_new(w, *out, is_new, 'C', &w->ncolumns));
    return sg_rule_builder_use(w->builder, *out, SG_SPLIT_Y, key + 2, n, 1, sizes);
}

/* Key of a row from its cells' symbols, as sharing asks for. */
static size_t row_key(work *w, const uint32_t *cells, size_t n, uint32_t *key)
{
    size_t k = 0;
    key[k++] = KEY_ROW;
    if (w->opts->share == SG_SHARE_NONE) {
        key[k++] = w->nunshared;
        return k;
    }
    for (size_t i = 0; i < n; i++)
        if (w->opts->share == SG_SHARE_EQUAL || i == 0 || cells[i] != cells[i - 1])
            key[k++] = cells[i];
    return k;
}

static sg_status row_symbol(work *w, const item *it, size_t y0, size_t y1, uint32_t *out)
{
    const size_t n = it->lattice->width;
    uint32_t *cells = SG_NEW_ARRAY(w->arena, uint32_t, n), *key = SG_NEW_ARRAY(w->arena, uint32_t, n + 2);
    size_t *first = SG_NEW_ARRAY(w->arena, size_t, n + 1);
    double *sizes = SG_NEW_ARRAY(w->arena, double, n);
    if (cells == NULL || key == NULL || first == NULL || sizes == NULL)
        return SG_ENOMEM;
    w->nunshared++;
    for (size_t x = 0; x < n; x++)
        SG_TRY(column_symbol(w, it, x, y0, y1, w->nunshared, &cells[x]));
    for (size_t x = 0; x <= n; x++)
        first[x] = x;
    relative_sizes(it->lattice->x, first, n, sizes);
    const size_t nkey = row_key(w, cells, n, key);
    bool is_new = false;
    *out = sg_rule_builder_symbol(w->builder, key, nkey, &is_new);
    SG_TRY(name_new(w, *out, is_new, 'R', &w->nrows));
    return sg_rule_builder_use(w->builder, *out, SG_SPLIT_X, cells, n, 1, sizes);
}

/* first: [ngroups + 1] first row of each group. */
static sg_status add_lattice(work *w, const item *it, const size_t *first, size_t ngroups)
{
    uint32_t *rows = SG_NEW_ARRAY(w->arena, uint32_t, ngroups);
    double *sizes = SG_NEW_ARRAY(w->arena, double, ngroups);
    if (rows == NULL || sizes == NULL)
        return SG_ENOMEM;
    for (size_t g = 0; g < ngroups; g++)
        SG_TRY(row_symbol(w, it, first[g], first[g + 1], &rows[g]));
    relative_sizes(it->lattice->y, first, ngroups, sizes);
    for (size_t i = 0; i < it->lattice->width * it->lattice->height; i++) {
        const uint32_t t = it->terminals[i];
        SG_TRY(sg_rule_builder_use(w->builder, w->lexical[t], SG_SPLIT_LEXICAL, &t, 1, 1, NULL));
    }
    return sg_rule_builder_use(w->builder, w->axiom, SG_SPLIT_Y, rows, ngroups, 1, sizes);
}

static sg_status add_all(work *w, const sg_lattice *lattices, size_t n)
{
    sg_regroup *regroup = sg_regroup_create(w->arena);
    item *items = SG_NEW_ARRAY(w->arena, item, n);
    if (regroup == NULL || items == NULL)
        return SG_ENOMEM;
    for (size_t i = 0; i < n; i++) {
        SG_TRY(make_item(w, &lattices[i], &items[i]));
        if (w->opts->regroup == SG_REGROUP_PAIRS)
            SG_TRY(sg_regroup_count(regroup, items[i].terminals, lattices[i].width, lattices[i].height, w->nterminals));
    }
    for (size_t i = 0; i < n; i++) {
        size_t *first = SG_NEW_ARRAY(w->arena, size_t, lattices[i].height + 1), ngroups = 0;
        if (first == NULL)
            return SG_ENOMEM;
        if (w->opts->regroup == SG_REGROUP_FLOORS)
            SG_TRY(sg_regroup_floors(items[i].terminals, lattices[i].width, lattices[i].height, w->arena, first,
                                     &ngroups));
        else
            SG_TRY(sg_regroup_rows(regroup, items[i].terminals, lattices[i].width, lattices[i].height, w->nterminals,
                                   first, &ngroups));
        SG_TRY(add_lattice(w, &items[i], first, ngroups));
    }
    return SG_OK;
}

sg_status sg_incorporate(const sg_lattice *lattices, size_t n, const sg_incorporate_opts *opts, sg_arena *arena,
                         sg_split_form *out, double **counts, sg_error *err)
{
    if (n == 0)
        return SG_FAIL(err, SG_EINVAL, "there is no lattice to learn from");
    work w = {.arena = arena, .opts = opts};
    SG_TRY(begin(&w, lattices, n, err));
    if (add_all(&w, lattices, n) != SG_OK)
        return SG_FAIL_NOMEM(err);
    SG_TRY(sg_rule_builder_form(w.builder, out, counts, err));
    out->name = "initial";
    out->axiom = w.axiom;
    out->nterminals = w.nterminals;
    out->terminal_names = w.names;
    out->terminal_colors = w.colors;
    return SG_OK;
}
