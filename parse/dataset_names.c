/* SPDX-License-Identifier: GPL-3.0-or-later */
/* dataset_names.c - which pictures of a data set are meant, and in which order. */
#include "config.h"

#include "core/array.h"
#include "core/file.h"
#include "core/lines.h"
#include "core/utf8.h"
#include "parse/dataset_priv.h"

#include <dirent.h>
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define HASH_NONFATAL_OOM 1
#include <uthash.h>

enum { LIST_LIMIT = 1 << 26 }; /* bytes */

void sg_dataset_fault(sg_dataset_check *c, const char *format, ...)
{
    char sentence[1024];
    va_list ap;
    va_start(ap, format);
    vsnprintf(sentence, sizeof sentence, format, ap);
    va_end(ap);
    if (c->nfaults++ == 0)
        memcpy(c->first, sentence, sizeof sentence);
    if (c->fault != NULL)
        c->fault(c->user, sentence);
}

/* ---- a list file: a fold or names ---- */

typedef struct {
    const char *name;
    size_t line;
    UT_hash_handle hh;
} entry;

typedef struct {
    sg_dataset_check *check;
    sg_lines lines;
    entry *seen; /* hash by name */
    const char **names;
    size_t count, capacity;
} list;

/* A name is a part of two paths and must stay in its folders. */
static const char *name_fault(const char *name)
{
    if (name[0] == '\0')
        return "an empty name";
    if (strchr(name, '/') != NULL)
        return "a name with a slash leads out of the data set";
    if (strstr(name, "..") != NULL)
        return "a name with two dots could lead out of the data set";
    if (sg_text_has_control(name))
        return "a name with a control character";
    if (!sg_utf8_is(name, strlen(name)))
        return "a name that is no UTF-8";
    return NULL;
}

static void line_fault(list *l, const char *at, const char *name, const char *what)
{
    sg_error e = SG_ERROR_INIT;
    sg_lines_fail(&l->lines, at, &e, "%s: '%.200s'", what, name);
    sg_dataset_fault(l->check, "%s", e.msg);
}

/* True when the name is new. False with SG_OK: it was there, which is a fault. */
static sg_status note_name(list *l, const char *name, bool *fresh, sg_error *err)
{
    entry *e = NULL;
    HASH_FIND_STR(l->seen, name, e);
    *fresh = e == NULL;
    if (e != NULL) {
        char what[64];
        snprintf(what, sizeof what, "a name that stands in line %zu already", e->line);
        line_fault(l, NULL, name, what);
        return SG_OK;
    }
    e = SG_NEW(l->check->arena, entry);
    if (e == NULL)
        return SG_FAIL_NOMEM(err);
    e->name = name;
    e->line = l->lines.number;
    HASH_ADD_KEYPTR(hh, l->seen, e->name, strlen(e->name), e);
    return e->hh.tbl != NULL ? SG_OK : SG_FAIL_NOMEM(err); /* uthash's sign that its memory ran out */
}

/* Which part a word means; -1 for none. */
static int parse_part(const char *word)
{
    static const char *const words[] = {
        [SG_SPLIT_TRAIN] = "train", [SG_SPLIT_VALID] = "valid", [SG_SPLIT_TEST] = "test"};
    for (int i = 0; i < 3; i++)
        if (strcmp(words[i], word) == 0)
            return i;
    return -1;
}

/* One line of a fold: is it of the wanted part? Of a list of names every line is. */
static bool is_wanted(list *l, char **field, size_t nfields)
{
    const sg_dataset_opts *o = l->check->opts;
    if (o->names_file != NULL) {
        if (nfields != 1)
            line_fault(l, NULL, field[0], "more than a name in a line");
        return nfields == 1;
    }
    if (nfields != 2) {
        line_fault(l, NULL, field[0], "a line that is not a name, a tab and a part");
        return false;
    }
    const int part = parse_part(field[1]);
    if (part < 0)
        line_fault(l, field[1], field[1], "an unknown part (not train, valid or test)");
    return part >= 0 && (o->part == SG_SPLIT_ALL || (int)o->part == part);
}

static sg_status take_line(list *l, sg_error *err)
{
    char *field[2];
    bool fresh;
    const size_t n = sg_lines_split(&l->lines, field, 2);
    const bool wanted = is_wanted(l, field, n);
    const char *what = name_fault(field[0]);
    if (what != NULL) {
        line_fault(l, field[0], field[0], what);
        return SG_OK;
    }
    SG_TRY(note_name(l, field[0], &fresh, err));
    if (!wanted || !fresh)
        return SG_OK;
    if (!SG_GROW(l->names, l->capacity, l->count + 1))
        return SG_FAIL_NOMEM(err);
    l->names[l->count++] = field[0];
    return SG_OK;
}

static sg_status read_list(sg_dataset_check *c, const char *path, list *l, sg_error *err)
{
    sg_error inner = SG_ERROR_INIT;
    const sg_status st = sg_lines_open(path, LIST_LIMIT, c->arena, &l->lines, &inner);
    if (st == SG_EINPUT) {
        sg_dataset_fault(c, "%s", inner.msg);
        return SG_OK;
    }
    if (st != SG_OK)
        return SG_FAIL(err, st, "%s", inner.msg);
    while (sg_lines_next(&l->lines))
        SG_TRY(take_line(l, err));
    if (l->count == 0 && c->nfaults == 0 && !c->opts->may_be_empty)
        sg_dataset_fault(c, c->opts->names_file != NULL ? "%s: no name in it" :
                            "%s: no name in it is of the part that is asked for", path);
    return SG_OK;
}

/* ---- all label maps ---- */

static int compare_names(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* NAME of NAME.png in the arena; NULL with SG_OK when the file is none or hidden. */
static sg_status label_name(sg_dataset_check *c, const char *file, const char **out, sg_error *err)
{
    const size_t n = strlen(file);
    *out = NULL;
    if (n <= 4 || file[0] == '.' || strcmp(file + n - 4, ".png") != 0)
        return SG_OK;
    char *name = sg_arena_copy(c->arena, file, n + 1);
    if (name == NULL)
        return SG_FAIL_NOMEM(err);
    name[n - 4] = '\0';
    const char *what = name_fault(name);
    if (what != NULL)
        sg_dataset_fault(c, "%s/labels/%s: %s", c->folder, file, what);
    else
        *out = name;
    return SG_OK;
}

static sg_status read_folder(sg_dataset_check *c, DIR *dir, list *l, sg_error *err)
{
    for (struct dirent *d = readdir(dir); d != NULL; d = readdir(dir)) {
        const char *name;
        SG_TRY(label_name(c, d->d_name, &name, err));
        if (name == NULL)
            continue;
        if (!SG_GROW(l->names, l->capacity, l->count + 1))
            return SG_FAIL_NOMEM(err);
        l->names[l->count++] = name;
    }
    if (l->count > 0)
        qsort(l->names, l->count, sizeof *l->names, compare_names);
    else if (c->nfaults == 0)
        sg_dataset_fault(c, "%s/labels: no label map (NAME.png) in it: the data set is empty", c->folder);
    return SG_OK;
}

static sg_status list_folder(sg_dataset_check *c, list *l, sg_error *err)
{
    const char *path = sg_arena_printf(c->arena, "%s/labels", c->folder);
    if (path == NULL)
        return SG_FAIL_NOMEM(err);
    DIR *dir = opendir(path);
    if (dir == NULL) {
        sg_dataset_fault(c, "%s: %s", path, strerror(errno));
        return SG_OK;
    }
    const sg_status st = read_folder(c, dir, l, err);
    closedir(dir);
    return st;
}

static sg_status choose(sg_dataset_check *c, list *l, sg_error *err)
{
    if (c->opts->names_file != NULL)
        return read_list(c, c->opts->names_file, l, err);
    if (c->opts->fold == 0)
        return list_folder(c, l, err);
    const char *path = sg_arena_printf(c->arena, "%s/folds/%d.tsv", c->folder, c->opts->fold);
    return path != NULL ? read_list(c, path, l, err) : SG_FAIL_NOMEM(err);
}

sg_status sg_dataset_choose(sg_dataset_check *c, sg_dataset_names *out, sg_error *err)
{
    list l;
    memset(&l, 0, sizeof l);
    l.check = c;
    sg_status st = choose(c, &l, err);
    HASH_CLEAR(hh, l.seen);
    if (st == SG_OK && l.count > 0) {
        out->count = l.count;
        if (c->opts->max_images > 0 && c->opts->max_images < l.count)
            out->count = c->opts->max_images;
        out->names = sg_arena_copy(c->arena, l.names, out->count * sizeof *l.names);
        if (out->names == NULL)
            st = SG_FAIL_NOMEM(err);
    }
    free(l.names);
    return st;
}
