/* SPDX-License-Identifier: GPL-3.0-or-later */
/* import.c - the import as a whole: what is read, checked and written, file after file. */
#include "config.h"

#include "core/file.h"
#include "core/utf8.h"
#include "data/import_files.h"
#include "data/import_priv.h"
#include "image/cv_image.h"
#include "image/png_io.h"

#include <stdio.h>
#include <string.h>

typedef struct {
    sg_importer im;
    sg_arena *arena; /* of the whole import */
    void (*fault)(void *user, const char *sentence);
    void *user;
    sg_import_result *result;
    bool ready; /* the target's folders and class table are there */
} job;

/* ---- the class table ---- */

static const char *own_table(job *j)
{
    return sg_arena_printf(j->arena, "%s/classes.tsv", j->im.opts->dataset);
}

static bool same_tables(const sg_classes *a, const sg_classes *b)
{
    if (a->nclasses != b->nclasses || memcmp(a->class_of, b->class_of, sizeof a->class_of) != 0)
        return false;
    for (size_t i = 0; i < a->nclasses; i++)
        if (strcmp(a->names[i], b->names[i]) != 0)
            return false;
    return true;
}

/* A data set that is there already must keep the meaning of its label maps. */
static sg_status check_own_table(job *j, const char *own, sg_error *err)
{
    sg_classes there;
    SG_TRY(sg_classes_read(own, &there, err));
    const bool same = same_tables(&there, &j->im.classes);
    sg_classes_clear(&there);
    return same ? SG_OK
                : SG_FAIL(err, SG_EINPUT, "%s: the data set has another class table than %s", own,
                          j->im.opts->classes_file);
}

static sg_status find_background(sg_importer *im, sg_error *err)
{
    const char *name = im->opts->background;
    im->background = im->void_index;
    if (im->opts->kind != SG_IMPORT_LABELME)
        return SG_OK;
    if (name != NULL && strcmp(name, "ignore") != 0) {
        const int class = sg_classes_find(&im->classes, name);
        im->background = class >= 0 ? im->classes.first_index[class] : -1;
    }
    if (im->background < 0)
        return SG_FAIL(err, SG_EINPUT, "the background class '%s' is not in the class table",
                       name != NULL ? name : "ignore");
    return SG_OK;
}

/* Colours must tell classes apart. */
static sg_status check_colors(const sg_importer *im, sg_error *err)
{
    const sg_classes *c = &im->classes;
    for (int i = 0; i < 256 && im->opts->kind == SG_IMPORT_RGB; i++)
        for (int k = i + 1; k < 256; k++)
            if (c->class_of[i] != SG_CLASS_UNKNOWN && c->class_of[k] != SG_CLASS_UNKNOWN &&
                c->class_of[i] != c->class_of[k] && c->index_colors[i] == c->index_colors[k])
                return SG_FAIL(err, SG_EINPUT, "the class table gives indices %d and %d one colour, #%06x", i, k,
                               (unsigned)c->index_colors[i]);
    return SG_OK;
}

static sg_status read_table(job *j, sg_error *err)
{
    const char *own = own_table(j);
    const char *path = j->im.opts->classes_file != NULL ? j->im.opts->classes_file : own;
    if (own == NULL)
        return SG_FAIL_NOMEM(err);
    if (path == own && !sg_file_exists(own))
        return SG_FAIL(err, SG_EINPUT, "%s: the data set has no class table yet: one must be given", own);
    SG_TRY(sg_classes_read(path, &j->im.classes, err));
    j->im.void_index = -1;
    for (int i = 255; i >= 0; i--)
        if (j->im.classes.class_of[i] == SG_CLASS_IGNORE)
            j->im.void_index = i;
    if (path != own && sg_file_exists(own))
        SG_TRY(check_own_table(j, own, err));
    SG_TRY(check_colors(&j->im, err));
    return find_background(&j->im, err);
}

/* ---- one file ---- */

typedef struct {
    const sg_import_source *source;
    const char *photo;               /* NULL: none is asked for */
    const char *labels_to, *photo_to;
    sg_import_size photo_size;
} item;

static sg_status check_name(const sg_import_source *s, sg_error *err)
{
    for (const char *p = s->name; *p != '\0'; p++)
        if ((unsigned char)*p < 32 || *p == 127)
            return SG_FAIL(err, SG_EINPUT, "%s: a name with a control character", s->path);
    if (!sg_utf8_is(s->name, strlen(s->name)))
        return SG_FAIL(err, SG_EINPUT, "%s: a name that is no UTF-8", s->path);
    if (s->name[0] == '.' || strstr(s->name, "..") != NULL)
        return SG_FAIL(err, SG_EINPUT, "%s: '%s' cannot be a name in a data set", s->path, s->name);
    return SG_OK;
}

static bool begins_as_png(const char *path)
{
    FILE *fp = fopen(path, "rb");
    const int first = fp != NULL ? getc(fp) : EOF;
    if (fp != NULL)
        fclose(fp);
    return first == 0x89;
}

/* Find the photograph and decode it once: a damaged one is told now and not when it is used. */
static sg_status look_at_photo(job *j, item *it, sg_error *err)
{
    sg_image im;
    const char *folder = j->im.opts->images, *name = it->source->name;
    if (folder == NULL)
        return SG_OK;
    SG_TRY(sg_import_find_photo(folder, name, it->source->path, j->im.scratch, &it->photo, err));
    if (it->photo == NULL)
        return SG_FAIL(err, SG_EINPUT, "%s: there is no photograph %s/%s.jpg (or .png)", it->source->path, folder,
                       name);
    SG_TRY(sg_photo_read(it->photo, &im, err));
    it->photo_size = (sg_import_size){im.width, im.height};
    sg_image_clear(&im);
    it->photo_to = sg_arena_printf(j->im.scratch, "%s/images/%s.%s", j->im.opts->dataset, name,
                                   begins_as_png(it->photo) ? "png" : "jpg");
    return it->photo_to != NULL ? SG_OK : SG_FAIL_NOMEM(err);
}

static sg_status check_targets(const item *it, sg_error *err)
{
    if (sg_import_same_file(it->source->path, it->labels_to))
        return SG_FAIL(err, SG_EINPUT, "%s: the import would overwrite its own input", it->source->path);
    if (it->photo != NULL && sg_import_same_file(it->photo, it->photo_to))
        return SG_FAIL(err, SG_EINPUT, "%s: the import would overwrite its own input", it->photo);
    return SG_OK;
}

static sg_status prepare_target(job *j, sg_error *err)
{
    const char *dataset = j->im.opts->dataset;
    const char *labels = sg_arena_printf(j->arena, "%s/labels", dataset);
    const char *images = sg_arena_printf(j->arena, "%s/images", dataset);
    const char *own = own_table(j);
    if (labels == NULL || images == NULL || own == NULL)
        return SG_FAIL_NOMEM(err);
    SG_TRY(sg_folder_create(labels, err));
    if (j->im.opts->images != NULL)
        SG_TRY(sg_folder_create(images, err));
    if (!sg_file_exists(own))
        SG_TRY(sg_classes_write(own, &j->im.classes, err));
    j->ready = true;
    return SG_OK;
}

/* The label map last: a name with a label map is complete. */
static sg_status write_item(job *j, const item *it, const sg_label_map *m, sg_error *err)
{
    if (!j->ready)
        SG_TRY(prepare_target(j, err));
    if (it->photo != NULL)
        SG_TRY(sg_import_copy(it->photo, it->photo_to, err));
    return sg_png_write_labels(it->labels_to, m, j->im.classes.index_colors, 256, err);
}

static sg_status import_map(job *j, item *it, const sg_label_map *m, sg_error *err)
{
    if (it->photo != NULL && (m->width != it->photo_size.width || m->height != it->photo_size.height))
        return SG_FAIL(err, SG_EINPUT, "%s: %zu x %zu pixels, but %s has %zu x %zu", it->source->path, m->width,
                       m->height, it->photo, it->photo_size.width, it->photo_size.height);
    SG_TRY(check_targets(it, err));
    return write_item(j, it, m, err);
}

static sg_status import_one(job *j, const sg_import_source *source, sg_error *err)
{
    static sg_import_reader *const readers[] = {[SG_IMPORT_RGB] = sg_import_rgb,
                                                [SG_IMPORT_PALETTE] = sg_import_palette,
                                                [SG_IMPORT_MATRIX] = sg_import_matrix,
                                                [SG_IMPORT_DIGITS] = sg_import_digits,
                                                [SG_IMPORT_LABELME] = sg_import_labelme};
    item it = {source, NULL, NULL, NULL, {0, 0}};
    sg_label_map m;
    SG_TRY(check_name(source, err));
    it.labels_to = sg_arena_printf(j->im.scratch, "%s/labels/%s.png", j->im.opts->dataset, source->name);
    if (it.labels_to == NULL)
        return SG_FAIL_NOMEM(err);
    SG_TRY(look_at_photo(j, &it, err));
    SG_TRY(readers[j->im.opts->kind](&j->im, source->path, it.photo_size, &m, err));
    const sg_status st = import_map(j, &it, &m, err);
    sg_label_map_clear(&m);
    return st;
}

/* ---- all files ---- */

static void tell(job *j, const char *sentence)
{
    if (j->fault != NULL)
        j->fault(j->user, sentence);
}

/* Bad files are told and passed over; what is not a file's fault ends the import. */
static sg_status import_next(job *j, const sg_import_source *list, size_t i, sg_error *err)
{
    sg_error inner = SG_ERROR_INIT;
    sg_status st;
    sg_arena_reset(j->im.scratch);
    if (i > 0 && strcmp(list[i].name, list[i - 1].name) == 0)
        st = SG_FAIL(&inner, SG_EINPUT, "%s: %s has the same name", list[i].path, list[i - 1].path);
    else
        st = import_one(j, &list[i], &inner);
    if (st == SG_EINPUT)
        tell(j, inner.msg);
    else if (st != SG_OK)
        return SG_FAIL(err, st, "%s", inner.msg);
    j->result->imported += st == SG_OK;
    return SG_OK;
}

static sg_status import_all(job *j, sg_progress *progress, sg_error *err)
{
    static const char *const png[] = {".png", NULL}, *const json[] = {".json", NULL};
    static const char *const text[] = {".txt", ".csv", ".tsv", ".dat", NULL};
    static const char *const *const endings[] = {[SG_IMPORT_RGB] = png, [SG_IMPORT_PALETTE] = png,
                                                 [SG_IMPORT_MATRIX] = text, [SG_IMPORT_DIGITS] = text,
                                                 [SG_IMPORT_LABELME] = json};
    sg_import_source *list;
    if (j->im.opts->images != NULL && !sg_folder_exists(j->im.opts->images))
        return SG_FAIL(err, SG_EINPUT, "%s: no such folder", j->im.opts->images);
    SG_TRY(read_table(j, err));
    SG_TRY(sg_import_list(j->im.opts->source, endings[j->im.opts->kind], j->im.opts->suffix, j->arena, &list,
                          &j->result->found, err));
    for (size_t i = 0; i < j->result->found; i++) {
        if (sg_progress_stopped(progress))
            return SG_FAIL(err, SG_STOPPED, "stopped after %zu of %zu files", i, j->result->found);
        SG_TRY(import_next(j, list, i, err));
        sg_progress_report(progress, "importing", i + 1, j->result->found);
    }
    const size_t bad = j->result->found - j->result->imported;
    return bad == 0 ? SG_OK
                    : SG_FAIL(err, SG_EINPUT, "%s: %zu of %zu files could not be imported", j->im.opts->source, bad,
                              j->result->found);
}

sg_status sg_import_run(const sg_import_opts *opts, void (*fault)(void *user, const char *sentence), void *user,
                        sg_progress *progress, sg_import_result *result, sg_error *err)
{
    job j;
    memset(&j, 0, sizeof j);
    *result = (sg_import_result){0, 0};
    j.im.opts = opts;
    j.fault = fault;
    j.user = user;
    j.result = result;
    j.arena = sg_arena_create();
    j.im.scratch = sg_arena_create();
    const bool good = j.arena != NULL && j.im.scratch != NULL;
    const sg_status st = good ? import_all(&j, progress, err) : SG_FAIL_NOMEM(err);
    sg_classes_clear(&j.im.classes);
    sg_arena_free(j.im.scratch);
    sg_arena_free(j.arena);
    return st;
}
