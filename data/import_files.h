/* SPDX-License-Identifier: GPL-3.0-or-later */
/* import_files.h - names and files on both sides of an import. */
#ifndef SG_DATA_IMPORT_FILES_H
#define SG_DATA_IMPORT_FILES_H

#include "core/arena.h"
#include "core/status.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct {
    const char *path, *name; /* name: the file's without folder and ending */
} sg_import_source;

/** The file itself, or all files of a folder with the ending (".png", in any case), in the order of their names.
 *  @param suffix  taken off the names that end in it, or NULL
 *  @return SG_OK, SG_EINPUT (missing, none), SG_ENOMEM */
sg_status sg_import_list(const char *source, const char *const *endings, const char *suffix, sg_arena *arena,
                         sg_import_source **out, size_t *count, sg_error *err);
/** Photograph of a name in a folder: jpg, jpeg or png in any case; not the file `other`. NULL when there is none.
 *  @return SG_OK, SG_ENOMEM */
sg_status sg_import_find_photo(const char *folder, const char *name, const char *other, sg_arena *arena,
                               const char **out, sg_error *err);
/** Both exist and are one file. */
bool sg_import_same_file(const char *a, const char *b);
/** Copy bytes; the target is written beside its place and renamed. @return SG_OK, SG_EINPUT, SG_EIO, SG_ENOMEM */
sg_status sg_import_copy(const char *from, const char *to, sg_error *err);

#endif
