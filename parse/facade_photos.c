/* SPDX-License-Identifier: GPL-3.0-or-later */
/* facade_photos.c - arguments to photographs. */
#include "config.h"

#include "core/array.h"
#include "core/file.h"
#include "core/utf8.h"
#include "parse/facade_photos.h"

#include <dirent.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

typedef struct {
    const sg_facade_photo_opts *opts;
    sg_arena *arena;
    void (*fault)(void *user, const char *sentence);
    void *user;
    sg_facade_photo *items; /* malloc'd */
    size_t n, capacity;
} list;

/* ---- one photograph ---- */

static bool is_photo_name(const char *file)
{
    const char *dot = strrchr(file, '.');
    return file[0] != '.' && dot != NULL &&
           (strcasecmp(dot, ".jpg") == 0 || strcasecmp(dot, ".jpeg") == 0 || strcasecmp(dot, ".png") == 0);
}

static const char *probabilities_of(const list *l, const char *name)
{
    return sg_arena_printf(l->arena, "%s/%s.npy", l->opts->probabilities, name);
}

static sg_status add(list *l, sg_facade_photo photo, sg_error *err)
{
    if (photo.name == NULL)
        return SG_FAIL_NOMEM(err);
    if (photo.name[0] == '\0' || strcmp(photo.name, ".") == 0 || strcmp(photo.name, "..") == 0)
        return SG_FAIL(err, SG_EINVAL, "'%s' is no name of a photograph", photo.image != NULL ? photo.image : photo.name);
    if (sg_text_has_control(photo.name))
        return SG_FAIL(err, SG_EINVAL, "'%s': a name with a control character", photo.name);
    if (l->opts->probabilities != NULL && (photo.probabilities = probabilities_of(l, photo.name)) == NULL)
        return SG_FAIL_NOMEM(err);
    if (!SG_GROW(l->items, l->capacity, l->n + 1))
        return SG_FAIL_NOMEM(err);
    l->items[l->n++] = photo;
    return SG_OK;
}

/* A path, or the name of probabilities alone: NAME.npy is then asked for, unless NAME is a file and the array is not there. */
static sg_status add_argument(list *l, const char *arg, sg_error *err)
{
    if (l->opts->probabilities != NULL && strchr(arg, '/') == NULL && !is_photo_name(arg)) {
        const char *path = probabilities_of(l, arg);
        if (path == NULL)
            return SG_FAIL_NOMEM(err);
        if (sg_file_exists(path) || !sg_file_exists(arg))
            return add(l, (sg_facade_photo){.name = sg_arena_string(l->arena, arg)}, err);
    }
    return add(l, (sg_facade_photo){.name = sg_file_stem(arg, l->arena), .image = arg}, err);
}

/* ---- data sets ---- */

static int compare_strings(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

static int compare_item(const void *name, const void *item)
{
    return strcmp(name, ((const sg_dataset_item *)item)->name);
}

/* Files in images/ whose names are not among the items; *names is malloc'd. */
static sg_status find_unlabelled(list *l, DIR *dir, const sg_dataset *d, const char ***names, size_t *n, sg_error *err)
{
    size_t capacity = 0;
    for (struct dirent *e = readdir(dir); e != NULL; e = readdir(dir)) {
        const char *stem = is_photo_name(e->d_name) ? sg_file_stem(e->d_name, l->arena) : "";
        const char *file = stem != NULL ? sg_arena_string(l->arena, e->d_name) : NULL;
        if (file == NULL)
            return SG_FAIL_NOMEM(err);
        if (stem[0] == '\0' || bsearch(stem, d->items, d->nitems, sizeof *d->items, compare_item) != NULL)
            continue;
        if (!SG_GROW(*names, capacity, *n + 1))
            return SG_FAIL_NOMEM(err);
        (*names)[(*n)++] = file;
    }
    return SG_OK;
}

static sg_status tell_unlabelled(const list *l, const char *folder, const char **names, size_t n, sg_error *err)
{
    enum { MOST = 8 };
    const char *text = "";
    qsort(names, n, sizeof *names, compare_strings);
    for (size_t i = 0; i < n && i < MOST && text != NULL; i++)
        text = sg_arena_printf(l->arena, "%s%s%s", text, i > 0 ? ", " : "", names[i]);
    if (text != NULL && n > MOST)
        text = sg_arena_printf(l->arena, "%s and %zu more", text, n - MOST);
    if (text != NULL)
        text = sg_arena_printf(l->arena, "note: %s/images: left out, since there is no label map: %s", folder, text);
    if (text == NULL)
        return SG_FAIL_NOMEM(err);
    l->fault(l->user, text);
    return SG_OK;
}

/* A whole data set is that of its label maps: who meant its photographs should know. */
static sg_status note_unlabelled(list *l, const char *folder, const sg_dataset *d, sg_error *err)
{
    const char **names = NULL;
    size_t n = 0;
    if (l->fault == NULL || l->opts->dataset->fold != 0 || l->opts->dataset->names_file != NULL)
        return SG_OK;
    const char *images = sg_arena_printf(l->arena, "%s/images", folder);
    if (images == NULL)
        return SG_FAIL_NOMEM(err);
    DIR *dir = opendir(images);
    if (dir == NULL)
        return SG_OK;
    sg_status st = find_unlabelled(l, dir, d, &names, &n, err);
    closedir(dir);
    if (st == SG_OK && n > 0)
        st = tell_unlabelled(l, folder, names, n, err);
    free(names);
    return st;
}

static sg_status add_dataset(list *l, const char *folder, sg_error *err)
{
    sg_dataset d;
    SG_TRY(sg_dataset_open(folder, l->opts->dataset, l->arena, l->fault, l->user, &d, err));
    sg_status st = note_unlabelled(l, folder, &d, err);
    for (size_t i = 0; st == SG_OK && i < d.nitems; i++) {
        const sg_dataset_item *item = &d.items[i];
        const char *image = item->image;
        if (image == NULL && l->opts->probabilities == NULL)
            image = sg_arena_printf(l->arena, "%s/images/%s.jpg", folder, item->name); /* is missed at its turn */
        st = add(l, (sg_facade_photo){.name = item->name, .image = image, .truth = item->labels}, err);
    }
    sg_dataset_close(&d);
    return st;
}

/* ---- truth ---- */

/* A folder with labels/ in it is a data set. */
static sg_status find_truths(list *l, sg_error *err)
{
    const char *folder = l->opts->truth;
    if (folder == NULL)
        return SG_OK;
    const char *labels = sg_arena_printf(l->arena, "%s/labels", folder);
    if (labels == NULL)
        return SG_FAIL_NOMEM(err);
    if (sg_folder_exists(labels))
        folder = labels;
    for (size_t i = 0; i < l->n; i++) {
        l->items[i].truth = sg_arena_printf(l->arena, "%s/%s.png", folder, l->items[i].name);
        if (l->items[i].truth == NULL)
            return SG_FAIL_NOMEM(err);
    }
    return SG_OK;
}

/* ---- all of them ---- */

static int compare_names(const void *a, const void *b)
{
    const sg_facade_photo *const *x = a, *const *y = b;
    return strcmp((*x)->name, (*y)->name);
}

static const char *origin(const sg_facade_photo *p)
{
    return p->image != NULL ? p->image : p->probabilities;
}

static sg_status refuse_doubles(const list *l, sg_error *err)
{
    const sg_facade_photo **sorted = malloc((l->n + 1) * sizeof *sorted);
    if (sorted == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t i = 0; i < l->n; i++)
        sorted[i] = &l->items[i];
    qsort(sorted, l->n, sizeof *sorted, compare_names);
    sg_status st = SG_OK;
    for (size_t i = 1; st == SG_OK && i < l->n; i++)
        if (strcmp(sorted[i - 1]->name, sorted[i]->name) == 0)
            st = SG_FAIL(err, SG_EINVAL, "two photographs are called %s, and so would their results be: %s and %s",
                         sorted[i]->name, origin(sorted[i - 1]), origin(sorted[i]));
    free(sorted);
    return st;
}

static sg_status take_all(list *l, char *const *args, size_t nargs, size_t *ndatasets, sg_error *err)
{
    for (size_t i = 0; i < nargs; i++) {
        const bool folder = sg_folder_exists(args[i]);
        *ndatasets += folder;
        SG_TRY(folder ? add_dataset(l, args[i], err) : add_argument(l, args[i], err));
    }
    if (l->n == 0)
        return SG_FAIL(err, SG_EINVAL, "no photograph");
    SG_TRY(refuse_doubles(l, err));
    return find_truths(l, err);
}

sg_status sg_facade_photos_list(char *const *args, size_t nargs, const sg_facade_photo_opts *opts, sg_arena *arena,
                                void (*fault)(void *user, const char *sentence), void *user, sg_facade_photos *out,
                                sg_error *err)
{
    list l = {.opts = opts, .arena = arena, .fault = fault, .user = user};
    size_t ndatasets = 0;
    sg_status st = take_all(&l, args, nargs, &ndatasets, err);
    sg_facade_photo *items = NULL;
    if (st == SG_OK && (items = sg_arena_copy(arena, l.items, l.n * sizeof *items)) == NULL)
        st = SG_FAIL_NOMEM(err);
    if (st == SG_OK)
        *out = (sg_facade_photos){l.n, items, ndatasets};
    free(l.items);
    return st;
}

/* ---- files that must differ ---- */

typedef struct {
    dev_t device;
    ino_t inode;
} identity;

static int compare_identities(const void *a, const void *b)
{
    const identity *x = a, *y = b;
    if (x->device != y->device)
        return x->device < y->device ? -1 : 1;
    return x->inode < y->inode ? -1 : x->inode > y->inode;
}

static sg_status refuse_equal(const char **sorted, const char *const *outputs, size_t n, sg_error *err)
{
    for (size_t i = 0; i < n; i++)
        sorted[i] = outputs[i];
    qsort(sorted, n, sizeof *sorted, compare_strings);
    for (size_t i = 1; i < n; i++)
        if (strcmp(sorted[i - 1], sorted[i]) == 0)
            return SG_FAIL(err, SG_EINVAL, "%s: two results would be this file", sorted[i]);
    return SG_OK;
}

/* Regular files only: nothing is lost in a device. */
static bool identify(const char *path, identity *out)
{
    struct stat st;
    if (path == NULL || stat(path, &st) != 0 || !S_ISREG(st.st_mode))
        return false;
    *out = (identity){st.st_dev, st.st_ino};
    return true;
}

static sg_status refuse_inputs(identity *ids, const char *const *outputs, size_t noutputs, const char *const *inputs,
                               size_t ninputs, sg_error *err)
{
    size_t n = 0;
    identity id;
    for (size_t i = 0; i < ninputs; i++)
        n += identify(inputs[i], &ids[n]);
    qsort(ids, n, sizeof *ids, compare_identities);
    for (size_t i = 0; i < noutputs; i++)
        if (identify(outputs[i], &id) && bsearch(&id, ids, n, sizeof *ids, compare_identities) != NULL)
            return SG_FAIL(err, SG_EINVAL, "%s: this is read; it will not be written over", outputs[i]);
    return SG_OK;
}

sg_status sg_facade_spare_files(const char *const *outputs, size_t noutputs, const char *const *inputs, size_t ninputs,
                                sg_error *err)
{
    const char **sorted = malloc((noutputs + 1) * sizeof *sorted);
    identity *ids = malloc((ninputs + 1) * sizeof *ids);
    sg_status st = sorted != NULL && ids != NULL ? SG_OK : SG_FAIL_NOMEM(err);
    if (st == SG_OK)
        st = refuse_equal(sorted, outputs, noutputs, err);
    if (st == SG_OK)
        st = refuse_inputs(ids, outputs, noutputs, inputs, ninputs, err);
    free(sorted);
    free(ids);
    return st;
}
