/* SPDX-License-Identifier: GPL-3.0-or-later */
/* import_files.c - names and files on both sides of an import. */
#include "config.h"

#include "core/array.h"
#include "core/file.h"
#include "data/import_files.h"

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

static bool has_ending(const char *file, const char *const *endings)
{
    const size_t n = strlen(file);
    for (; *endings != NULL; endings++) {
        const size_t k = strlen(*endings);
        if (n > k && strcasecmp(file + n - k, *endings) == 0)
            return true;
    }
    return false;
}

/* Name without folder, ending and suffix. */
static char *stem_of(const char *path, const char *suffix, sg_arena *arena)
{
    const char *slash = strrchr(path, '/');
    char *name = sg_arena_string(arena, slash != NULL ? slash + 1 : path);
    char *dot = name != NULL ? strrchr(name, '.') : NULL;
    if (dot != NULL && dot != name)
        *dot = '\0';
    if (name != NULL && suffix != NULL) {
        const size_t n = strlen(name), k = strlen(suffix);
        if (n > k && strcmp(name + n - k, suffix) == 0)
            name[n - k] = '\0';
    }
    return name;
}

static int compare_sources(const void *a, const void *b)
{
    const sg_import_source *x = a, *y = b;
    const int by_name = strcmp(x->name, y->name);
    return by_name != 0 ? by_name : strcmp(x->path, y->path);
}

typedef struct {
    const char *suffix;
    sg_import_source *items; /* malloc'd */
    size_t count, capacity;
} source_list;

static sg_status add_source(source_list *l, const char *path, sg_arena *arena, sg_error *err)
{
    const char *name = path != NULL ? stem_of(path, l->suffix, arena) : NULL;
    if (name == NULL || !SG_GROW(l->items, l->capacity, l->count + 1))
        return SG_FAIL_NOMEM(err);
    l->items[l->count++] = (sg_import_source){path, name};
    return SG_OK;
}

static sg_status read_folder(const char *folder, DIR *dir, const char *const *endings, sg_arena *arena, source_list *l,
                             sg_error *err)
{
    for (struct dirent *d = readdir(dir); d != NULL; d = readdir(dir))
        if (d->d_name[0] != '.' && has_ending(d->d_name, endings))
            SG_TRY(add_source(l, sg_arena_printf(arena, "%s/%s", folder, d->d_name), arena, err));
    if (l->count == 0)
        return SG_FAIL(err, SG_EINPUT, "%s: no file in it ends in %s", folder, endings[0]);
    qsort(l->items, l->count, sizeof *l->items, compare_sources);
    return SG_OK;
}

sg_status sg_import_list(const char *source, const char *const *endings, const char *suffix, sg_arena *arena,
                         sg_import_source **out, size_t *count, sg_error *err)
{
    source_list l = {suffix, NULL, 0, 0};
    sg_status st;
    DIR *dir = opendir(source);
    if (dir != NULL) {
        st = read_folder(source, dir, endings, arena, &l, err);
        closedir(dir);
    } else if (errno == ENOTDIR) {
        st = add_source(&l, sg_arena_string(arena, source), arena, err);
    } else {
        st = SG_FAIL(err, SG_EINPUT, "%s: %s", source, strerror(errno));
    }
    if (st == SG_OK) {
        *count = l.count;
        *out = sg_arena_copy(arena, l.items, l.count * sizeof *l.items);
        if (*out == NULL)
            st = SG_FAIL_NOMEM(err);
    }
    free(l.items);
    return st;
}

bool sg_import_same_file(const char *a, const char *b)
{
    struct stat x, y;
    return stat(a, &x) == 0 && stat(b, &y) == 0 && x.st_dev == y.st_dev && x.st_ino == y.st_ino;
}

sg_status sg_import_find_photo(const char *folder, const char *name, const char *other, sg_arena *arena,
                               const char **out, sg_error *err)
{
    static const char *const endings[] = {"jpg", "JPG", "jpeg", "JPEG", "Jpg", "png", "PNG"};
    *out = NULL;
    for (size_t i = 0; i < sizeof endings / sizeof endings[0]; i++) {
        const char *path = sg_arena_printf(arena, "%s/%s.%s", folder, name, endings[i]);
        if (path == NULL)
            return SG_FAIL_NOMEM(err);
        if (sg_file_exists(path) && !sg_import_same_file(path, other)) {
            *out = path;
            return SG_OK;
        }
    }
    return SG_OK;
}

sg_status sg_import_copy(const char *from, const char *to, sg_error *err)
{
    char *bytes;
    size_t n;
    sg_output out;
    sg_arena *arena = sg_arena_create();
    if (arena == NULL)
        return SG_FAIL_NOMEM(err);
    sg_status st = sg_file_read(from, (size_t)1 << 30, arena, &bytes, &n, err);
    if (st == SG_OK)
        st = sg_output_open(&out, to, err);
    if (st == SG_OK) {
        fwrite(bytes, 1, n, out.fp);
        st = sg_output_commit(&out, err); /* a failed write shows up here */
    }
    sg_arena_free(arena);
    return st;
}
