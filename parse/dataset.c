/* SPDX-License-Identifier: GPL-3.0-or-later */
/* dataset.c - opening a data set: everything that was asked for is looked at before any work starts. */
#include "config.h"

#include "core/file.h"
#include "image/cv_image.h"
#include "image/png_io.h"
#include "parse/dataset_priv.h"

#include <stdio.h>
#include <string.h>

enum { MAX_VALUES_NAMED = 5 }; /* unknown labels of one map that are named one by one */

/* Where a value of a label map that no class has was met. */
typedef struct {
    size_t count, x, y; /* of the first pixel, px */
} sighting;

static void report_unknown(sg_dataset_check *c, const char *path, const sighting *seen)
{
    size_t named = 0, more = 0;
    for (unsigned v = 0; v < 256; v++) {
        if (seen[v].count == 0)
            continue;
        if (named++ < MAX_VALUES_NAMED)
            sg_dataset_fault(c,
                             "%s: label %u is not in the class table (%zu pixel%s, the first at column %zu, row %zu)",
                             path, v, seen[v].count, seen[v].count == 1 ? "" : "s", seen[v].x, seen[v].y);
        else
            more++;
    }
    if (more > 0)
        sg_dataset_fault(c, "%s: %zu more labels are not in the class table", path, more);
}

static void check_values(sg_dataset_check *c, const char *path, const sg_label_map *m, const sg_classes *classes)
{
    sighting seen[256];
    size_t nunknown = 0, nused = 0;
    memset(seen, 0, sizeof seen);
    for (size_t i = 0; i < m->width * m->height; i++) {
        const unsigned v = m->labels[i], class = classes->class_of[v];
        nused += class < SG_MAX_CLASSES;
        if (class != SG_CLASS_UNKNOWN)
            continue;
        nunknown++;
        if (seen[v].count++ == 0) {
            seen[v].x = i % m->width;
            seen[v].y = i / m->width;
        }
    }
    if (nunknown > 0)
        report_unknown(c, path, seen);
    else if (nused == 0)
        sg_dataset_fault(c, "%s: every pixel is ignored", path);
}

/* A failure that is the file's fault is noted; lack of memory is passed on. */
static sg_status note(sg_dataset_check *c, sg_status st, const sg_error *inner, sg_error *err)
{
    if (st == SG_ENOMEM)
        return SG_FAIL_NOMEM(err);
    if (st != SG_OK)
        sg_dataset_fault(c, "%s", inner->msg);
    return SG_OK;
}

/* classes is NULL when the table itself is at fault: then values are not judged. Size 0 x 0 when the map is bad. */
static sg_status check_labels(sg_dataset_check *c, const char *path, const sg_classes *classes, size_t size[2],
                              sg_error *err)
{
    sg_label_map m;
    sg_error inner = SG_ERROR_INIT;
    const sg_status st = sg_png_read_labels(path, &m, &inner);
    size[0] = size[1] = 0;
    if (st != SG_OK)
        return note(c, st, &inner, err);
    size[0] = m.width;
    size[1] = m.height;
    if (classes != NULL)
        check_values(c, path, &m, classes);
    sg_label_map_clear(&m);
    return SG_OK;
}

/* A photograph that is not needed may lack or be damaged, but one of another size is a sign that files were mixed up. */
static sg_status check_size(sg_dataset_check *c, const sg_dataset_item *item, const size_t size[2], sg_error *err)
{
    size_t width, height;
    sg_error inner = SG_ERROR_INIT;
    const sg_status st = sg_photo_read_size(item->image, &width, &height, &inner);
    if (st == SG_ENOMEM)
        return SG_FAIL_NOMEM(err);
    if (st == SG_OK && size[0] != 0 && (width != size[0] || height != size[1]))
        sg_dataset_fault(c, "%s: %zu x %zu pixels, but %s has %zu x %zu", item->image, width, height, item->labels, size[0],
                         size[1]);
    return SG_OK;
}

static sg_status check_image(sg_dataset_check *c, const sg_dataset_item *item, const size_t size[2], sg_error *err)
{
    sg_image im;
    sg_error inner = SG_ERROR_INIT;
    const sg_status st = sg_photo_read(item->image, &im, &inner);
    if (st != SG_OK)
        return note(c, st, &inner, err);
    if (size[0] != 0 && (im.width != size[0] || im.height != size[1]))
        sg_dataset_fault(c, "%s: %zu x %zu pixels, but %s has %zu x %zu", item->image, im.width, im.height,
                         item->labels, size[0], size[1]);
    sg_image_clear(&im);
    return SG_OK;
}

/* Path of the picture of a name, NULL when there is none. Two of them are a fault: which one was meant? */
static sg_status find_image(sg_dataset_check *c, const char *name, const char **out, sg_error *err)
{
    static const char *const endings[] = {"jpg", "jpeg", "png"};
    *out = NULL;
    for (size_t i = 0; i < sizeof endings / sizeof endings[0]; i++) {
        const char *path = sg_arena_printf(c->arena, "%s/images/%s.%s", c->folder, name, endings[i]);
        if (path == NULL)
            return SG_FAIL_NOMEM(err);
        if (!sg_file_exists(path))
            continue;
        if (*out == NULL)
            *out = path;
        else if (c->opts->need_images || c->opts->one_image)
            sg_dataset_fault(c, "%s: there is %s too", path, *out);
    }
    if (*out == NULL && c->opts->need_images)
        sg_dataset_fault(c, "%s/images/%s.jpg (or .png): no such picture", c->folder, name);
    return SG_OK;
}

static sg_status check_item(sg_dataset_check *c, const char *name, const sg_classes *classes, sg_dataset_item *item,
                            sg_error *err)
{
    size_t size[2];
    item->name = name;
    item->labels = sg_arena_printf(c->arena, "%s/labels/%s.png", c->folder, name);
    if (item->labels == NULL)
        return SG_FAIL_NOMEM(err);
    SG_TRY(find_image(c, name, &item->image, err));
    SG_TRY(check_labels(c, item->labels, classes, size, err));
    if (item->image == NULL)
        return SG_OK;
    return c->opts->need_images ? check_image(c, item, size, err) : check_size(c, item, size, err);
}

static sg_status check_classes(sg_dataset_check *c, sg_classes *out, bool *good, sg_error *err)
{
    sg_error inner = SG_ERROR_INIT;
    const char *path = c->opts->classes_file;
    if (path == NULL)
        path = sg_arena_printf(c->arena, "%s/classes.tsv", c->folder);
    if (path == NULL)
        return SG_FAIL_NOMEM(err);
    const sg_status st = sg_classes_read(path, out, &inner);
    *good = st == SG_OK;
    return note(c, st, &inner, err);
}

static sg_status check_all(sg_dataset_check *c, sg_dataset *d, sg_error *err)
{
    bool good = false;
    sg_dataset_names chosen = {NULL, 0};
    SG_TRY(check_classes(c, &d->classes, &good, err));
    SG_TRY(sg_dataset_choose(c, &chosen, err));
    d->items = SG_NEW_ARRAY(c->arena, sg_dataset_item, chosen.count + 1);
    if (d->items == NULL)
        return SG_FAIL_NOMEM(err);
    for (d->nitems = 0; d->nitems < chosen.count; d->nitems++)
        SG_TRY(check_item(c, chosen.names[d->nitems], good ? &d->classes : NULL, &d->items[d->nitems], err));
    return SG_OK;
}

static sg_status conclude(const sg_dataset_check *c, sg_error *err)
{
    if (c->nfaults == 0)
        return SG_OK;
    if (c->fault != NULL)
        return SG_FAIL(err, SG_EINPUT, "%s: %zu fault%s in the data set", c->folder, c->nfaults,
                       c->nfaults == 1 ? "" : "s");
    if (c->nfaults == 1)
        return SG_FAIL(err, SG_EINPUT, "%s", c->first);
    return SG_FAIL(err, SG_EINPUT, "%.900s (and %zu more faults)", c->first, c->nfaults - 1);
}

/* With anything of one in it, what is missing is told by name. */
static bool looks_like_dataset(const char *folder, const sg_dataset_opts *opts, sg_arena *arena)
{
    const char *table = sg_arena_printf(arena, "%s/classes.tsv", folder), *labels = sg_arena_printf(arena, "%s/labels", folder);
    return opts->classes_file != NULL || table == NULL || labels == NULL || sg_file_exists(table) || sg_file_exists(labels);
}

sg_status sg_dataset_open(const char *folder, const sg_dataset_opts *opts, sg_arena *arena,
                          void (*fault)(void *user, const char *sentence), void *user, sg_dataset *out, sg_error *err)
{
    sg_dataset d;
    memset(&d, 0, sizeof d);
    if (opts->names_file != NULL && opts->fold != 0)
        return SG_FAIL(err, SG_EINVAL, "a fold and a list of names cannot both be asked for");
    if (!sg_folder_exists(folder))
        return SG_FAIL(err, SG_EINPUT, "%s: no such folder", folder);
    if (!looks_like_dataset(folder, opts, arena))
        return SG_FAIL(err, SG_EINPUT, "%s: this folder is no data set: neither classes.tsv nor labels/ is in it", folder);
    sg_dataset_check c = {folder, opts, arena, fault, user, 0, ""};
    d.folder = sg_arena_string(arena, folder);
    if (d.folder == NULL)
        return SG_FAIL_NOMEM(err);
    sg_status st = check_all(&c, &d, err);
    if (st == SG_OK)
        st = conclude(&c, err);
    if (st == SG_OK)
        *out = d;
    else
        sg_classes_clear(&d.classes);
    return st;
}

void sg_dataset_close(sg_dataset *d)
{
    sg_classes_clear(&d->classes);
    memset(d, 0, sizeof *d);
}

sg_status sg_dataset_read_labels(const sg_dataset *d, size_t item, sg_label_map *out, sg_error *err)
{
    sg_label_map m;
    if (item >= d->nitems)
        return SG_FAIL(err, SG_EINVAL, "item %zu of %zu", item, d->nitems);
    SG_TRY(sg_png_read_labels(d->items[item].labels, &m, err));
    for (size_t i = 0; i < m.width * m.height; i++) {
        const uint8_t class = d->classes.class_of[m.labels[i]];
        if (class == SG_CLASS_UNKNOWN) { /* the file has changed since it was checked */
            const unsigned v = m.labels[i];
            sg_label_map_clear(&m);
            return SG_FAIL(err, SG_EINPUT, "%s: label %u is not in the class table", d->items[item].labels, v);
        }
        m.labels[i] = class;
    }
    *out = m;
    return SG_OK;
}
