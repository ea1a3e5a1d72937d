/* SPDX-License-Identifier: GPL-3.0-or-later */
/* learn_input.c - data sets and folders of lattices. */
#include "config.h"

#include "learn/learn_input.h"

#include "core/array.h"
#include "core/file.h"
#include "core/lines.h"
#include "parse/lattice_fit.h"

#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

void sg_learn_input_clear(sg_learn_input *in)
{
    for (size_t i = 0; i < in->n && in->arenas != NULL; i++)
        sg_arena_free(in->arenas[i]);
    sg_arena_free(in->arena);
    memset(in, 0, sizeof *in);
}

static sg_status make_room(sg_learn_input *in, size_t n, sg_error *err)
{
    in->lattices = SG_NEW_ARRAY(in->arena, sg_lattice, n + 1);
    in->names = SG_NEW_ARRAY(in->arena, const char *, n + 1);
    in->arenas = SG_NEW_ARRAY(in->arena, sg_arena *, n + 1);
    if (in->lattices == NULL || in->names == NULL || in->arenas == NULL)
        return SG_FAIL_NOMEM(err);
    in->n = n;
    for (size_t i = 0; i < n; i++)
        if ((in->arenas[i] = sg_arena_create()) == NULL)
            return SG_FAIL_NOMEM(err);
    return SG_OK;
}

static void find_mean_cells(sg_learn_input *in)
{
    in->cells = 0;
    for (size_t i = 0; i < in->n; i++)
        in->cells += (double)(in->lattices[i].width * in->lattices[i].height) / (double)in->n;
}

/* ---- data sets ---- */

static sg_status fit(sg_lattice_problem *p, const sg_learn_input_opts *o, sg_arena *arena, sg_lattice_fit *out,
                     sg_error *err)
{
    if (o->cells > 0)
        return sg_lattice_fit_cells(p, o->cells, arena, out, err);
    if (o->accuracy > 0)
        return sg_lattice_fit_accuracy(p, o->accuracy, arena, out, err);
    return sg_lattice_fit_length(p, arena, out, err);
}

static sg_status fit_map(const sg_dataset *d, const sg_label_map *map, const sg_learn_input_opts *o, sg_arena *arena,
                         sg_lattice *out, double *accuracy, sg_error *err)
{
    const sg_lattice_source source = sg_lattice_source_of(map, d->classes.nclasses);
    const sg_lattice_fit_opts opts = SG_LATTICE_FIT_OPTS_INIT;
    sg_lattice_problem *p;
    sg_lattice_fit f;
    SG_TRY(sg_lattice_problem_create(&source, &opts, &p, err));
    sg_status st = fit(p, o, arena, &f, err);
    sg_lattice_problem_free(p);
    if (st != SG_OK)
        return st;
    *accuracy = sg_lattice_accuracy(&f);
    return sg_lattice_from_fit(&f, (const char *const *)d->classes.names, d->classes.nclasses, arena, out, err);
}

static sg_status fit_item(const sg_dataset *d, size_t item, const sg_learn_input_opts *o, sg_learn_input *in,
                          double *accuracy, sg_error *err)
{
    sg_label_map map;
    SG_TRY(sg_dataset_read_labels(d, item, &map, err));
    const sg_status st = fit_map(d, &map, o, in->arenas[item], &in->lattices[item], accuracy, err);
    sg_label_map_clear(&map);
    if (st != SG_OK && err != NULL) {
        const sg_error e = *err;
        return SG_FAIL(err, st, "%s: %.800s", d->items[item].labels, e.msg);
    }
    return st;
}

/* Each lattice has an arena of its own, so that threads do not meet. The first failure in the order of the items
 * counts. */
static sg_status fit_all(const sg_dataset *d, const sg_learn_input_opts *o, sg_learn_input *in, sg_error *err)
{
    sg_status *status = SG_NEW_ARRAY(in->arena, sg_status, in->n);
    sg_error *errors = SG_NEW_ARRAY(in->arena, sg_error, in->n);
    double *accuracy = SG_NEW_ARRAY(in->arena, double, in->n);
    if (status == NULL || errors == NULL || accuracy == NULL)
        return SG_FAIL_NOMEM(err);
    size_t done = 0;
#pragma omp parallel for schedule(dynamic)
    for (size_t i = 0; i < in->n; i++) {
        bool stopped;
#pragma omp critical(sg_learn_input_progress)
        {
            stopped = sg_progress_stopped(o->progress);
            sg_progress_report(o->progress, "fitting lattices", done++, in->n);
        }
        status[i] = stopped ? SG_STOPPED : fit_item(d, i, o, in, &accuracy[i], &errors[i]);
    }
    in->accuracy = 0;
    for (size_t i = 0; i < in->n; i++) {
        if (status[i] != SG_OK)
            return SG_FAIL(err, status[i], "%s",
                           status[i] == SG_STOPPED ? "stopped before there was a grammar" : errors[i].msg);
        in->accuracy += accuracy[i] / (double)in->n;
    }
    return SG_OK;
}

static sg_status take_classes(sg_learn_input *in, const sg_classes *c, sg_error *err)
{
    in->nterminals = c->nclasses;
    in->terminal_names = SG_NEW_ARRAY(in->arena, const char *, c->nclasses + 1);
    in->terminal_colors = SG_NEW_ARRAY(in->arena, uint32_t, c->nclasses + 1);
    if (in->terminal_names == NULL || in->terminal_colors == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t i = 0; i < c->nclasses; i++) {
        in->terminal_colors[i] = c->colors[i];
        if ((in->terminal_names[i] = sg_arena_string(in->arena, c->names[i])) == NULL)
            return SG_FAIL_NOMEM(err);
    }
    return SG_OK;
}

/* Lattices borrow the names of their labels from the class table, which is closed: they get ours. */
static sg_status rename_labels(sg_learn_input *in, sg_error *err)
{
    for (size_t i = 0; i < in->n; i++) {
        sg_lattice *l = &in->lattices[i];
        const char **names = SG_NEW_ARRAY(in->arenas[i], const char *, l->nlabels + 1);
        if (names == NULL)
            return SG_FAIL_NOMEM(err);
        for (size_t k = 0; k < l->nlabels; k++)
            if ((names[k] = sg_arena_string(in->arenas[i], l->label_names[k])) == NULL)
                return SG_FAIL_NOMEM(err);
        l->label_names = names;
    }
    return SG_OK;
}

static sg_status read_dataset(const sg_dataset *d, const sg_learn_input_opts *o, sg_learn_input *in, sg_error *err)
{
    if (d->nitems == 0)
        return SG_FAIL(err, SG_EINPUT, "%s: there is no label map to learn from", d->folder);
    SG_TRY(make_room(in, d->nitems, err));
    for (size_t i = 0; i < in->n; i++)
        in->names[i] = d->items[i].name;
    SG_TRY(take_classes(in, &d->classes, err));
    SG_TRY(fit_all(d, o, in, err));
    return rename_labels(in, err);
}

/* ---- folders of lattices ---- */

static int by_name(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

typedef struct {
    const char **items;
    size_t n, capacity;
} name_list;

static sg_status list_lattices(const char *folder, sg_arena *arena, name_list *list, sg_error *err)
{
    DIR *dir = opendir(folder);
    if (dir == NULL)
        return SG_FAIL(err, SG_EINPUT, "%s: %s", folder, strerror(errno));
    sg_status st = SG_OK;
    for (const struct dirent *e; st == SG_OK && (e = readdir(dir)) != NULL;) {
        const size_t length = strlen(e->d_name);
        if (length <= 4 || e->d_name[0] == '.' || strcmp(e->d_name + length - 4, ".lat") != 0)
            continue;
        char *name = sg_arena_printf(arena, "%.*s", (int)(length - 4), e->d_name);
        if (name == NULL || !SG_GROW(list->items, list->capacity, list->n + 1))
            st = SG_FAIL_NOMEM(err);
        else
            list->items[list->n++] = name;
    }
    closedir(dir);
    if (list->n > 1)
        qsort(list->items, list->n, sizeof *list->items, by_name);
    return st;
}

static sg_status list_named(const char *file, sg_arena *arena, name_list *list, sg_error *err)
{
    sg_lines lines;
    SG_TRY(sg_lines_open(file, (size_t)1 << 26, arena, &lines, err));
    while (sg_lines_next(&lines)) {
        if (!SG_GROW(list->items, list->capacity, list->n + 1))
            return SG_FAIL_NOMEM(err);
        list->items[list->n++] = lines.text;
    }
    return SG_OK;
}

static uint32_t hue_color(size_t i, size_t n)
{
    const double h = 6.0 * (double)i / (double)n;
    double c[3];
    for (int k = 0; k < 3; k++) {
        const double d = fabs(fmod(h + 2.0 * k, 6.0) - 3.0) - 1;
        c[k] = 70 + 160 * fmin(fmax(d, 0), 1);
    }
    return (uint32_t)c[0] << 16 | (uint32_t)c[1] << 8 | (uint32_t)c[2];
}

/* Labels of all lattices by name, with colours around the wheel. */
static sg_status find_terminals(sg_learn_input *in, sg_error *err)
{
    name_list all = {NULL, 0, 0};
    for (size_t i = 0; i < in->n; i++)
        for (size_t k = 0; k < in->lattices[i].nlabels; k++) {
            bool known = false;
            for (size_t j = 0; j < all.n && !known; j++)
                known = strcmp(all.items[j], in->lattices[i].label_names[k]) == 0;
            if (known)
                continue;
            if (!SG_GROW(all.items, all.capacity, all.n + 1)) {
                free(all.items);
                return SG_FAIL_NOMEM(err);
            }
            all.items[all.n++] = in->lattices[i].label_names[k];
        }
    if (all.n > 1)
        qsort(all.items, all.n, sizeof *all.items, by_name);
    in->nterminals = all.n;
    in->terminal_names = sg_arena_copy(in->arena, all.items, all.n * sizeof *all.items);
    in->terminal_colors = SG_NEW_ARRAY(in->arena, uint32_t, all.n + 1);
    free(all.items);
    if (in->terminal_names == NULL || in->terminal_colors == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t i = 0; i < in->nterminals; i++)
        in->terminal_colors[i] = hue_color(i, in->nterminals);
    return SG_OK;
}

static sg_status take_class_file(sg_learn_input *in, const char *file, sg_error *err)
{
    sg_classes classes;
    SG_TRY(sg_classes_read(file, &classes, err));
    const sg_status st = take_classes(in, &classes, err);
    sg_classes_clear(&classes);
    return st;
}

static sg_status read_lattices(const char *folder, const name_list *list, const sg_learn_input_opts *o,
                               sg_learn_input *in, sg_error *err)
{
    const size_t limit = o->dataset.max_images;
    if (list->n == 0)
        return SG_FAIL(err, SG_EINPUT, "%s: neither a data set (there is no classes.tsv) nor a folder of *.lat files",
                       folder);
    SG_TRY(make_room(in, limit > 0 && limit < list->n ? limit : list->n, err));
    for (size_t i = 0; i < in->n; i++) {
        const char *path = sg_arena_printf(in->arena, "%s/%s.lat", folder, list->items[i]);
        in->names[i] = sg_arena_string(in->arena, list->items[i]);
        if (path == NULL || in->names[i] == NULL)
            return SG_FAIL_NOMEM(err);
        SG_TRY(sg_lattice_read(path, in->arenas[i], &in->lattices[i], err));
    }
    in->accuracy = NAN;
    return o->dataset.classes_file != NULL ? take_class_file(in, o->dataset.classes_file, err)
                                           : find_terminals(in, err);
}

static sg_status read_lattice_folder(const char *folder, const sg_learn_input_opts *o, sg_learn_input *in,
                                     sg_error *err)
{
    name_list list = {NULL, 0, 0};
    sg_status st = o->dataset.names_file != NULL ? list_named(o->dataset.names_file, in->arena, &list, err)
                                                 : list_lattices(folder, in->arena, &list, err);
    if (st == SG_OK)
        st = read_lattices(folder, &list, o, in, err);
    free(list.items);
    return st;
}

static bool is_dataset(const char *folder, const sg_learn_input_opts *o, sg_arena *arena)
{
    const char *classes = sg_arena_printf(arena, "%s/classes.tsv", folder);
    const char *labels = sg_arena_printf(arena, "%s/labels", folder);
    return classes != NULL && labels != NULL &&
           (sg_file_exists(classes) || (o->dataset.classes_file != NULL && sg_folder_exists(labels)));
}

sg_status sg_learn_input_read(const char *folder, const sg_learn_input_opts *o, sg_learn_input *out, sg_error *err)
{
    sg_learn_input in = {.arena = sg_arena_create()};
    if (in.arena == NULL)
        return SG_FAIL_NOMEM(err);
    sg_status st;
    if (!is_dataset(folder, o, in.arena)) {
        st = o->dataset.fold != 0
                 ? SG_FAIL(err, SG_EINPUT, "%s: no data set (there is no classes.tsv), so it has no folds", folder)
                 : read_lattice_folder(folder, o, &in, err);
    } else {
        sg_dataset d;
        st = sg_dataset_open(folder, &o->dataset, in.arena, o->fault, NULL, &d, err);
        if (st == SG_OK) {
            st = read_dataset(&d, o, &in, err);
            sg_dataset_close(&d);
        }
    }
    if (st != SG_OK) {
        sg_learn_input_clear(&in);
        return st;
    }
    find_mean_cells(&in);
    *out = in;
    return SG_OK;
}
