/* SPDX-License-Identifier: GPL-3.0-or-later */
/* file.h - reading whole files, and writing them so that a crash never leaves half of one.
 * An output is written beside its place under a temporary name and renamed when it is complete and on disk. */
#ifndef SG_CORE_FILE_H
#define SG_CORE_FILE_H

#include "core/arena.h"
#include "core/status.h"

#include <stdbool.h>
#include <stdio.h>

typedef struct {
    FILE *fp;          /* write here */
    char path[4096];   /* where it will stand; "-" is standard output */
    char temp[4096];   /* where it is written; empty when it is written in place (standard output, a device) */
} sg_output;

/** Open an output. "-" is standard output; a device such as /dev/full is written in place.
 *  @return SG_OK, SG_EIO (the sentence names the path) */
sg_status sg_output_open(sg_output *out, const char *path, sg_error *err);
/** Flush, close and rename. On failure nothing is left behind. @return SG_OK, SG_EIO */
sg_status sg_output_commit(sg_output *out, sg_error *err);
/** Commit when the writing went well (st is SG_OK); else discard and return st, with the path before the sentence of a
 *  failed write. @return st, SG_EIO */
sg_status sg_output_end(sg_output *out, sg_status st, sg_error *err);
/** Close and remove: after a failure on the way. Fine on an output that is committed or never opened. */
void sg_output_discard(sg_output *out);

/** Read a whole file into the arena; a NUL follows the last byte. "-" is standard input.
 *  @param limit  more bytes than this are refused
 *  @return SG_OK, SG_EINPUT (missing, unreadable, a folder, over the limit), SG_ENOMEM */
sg_status sg_file_read(const char *path, size_t limit, sg_arena *arena, char **text, size_t *length, sg_error *err);

/** Make a folder and those above it; one that exists is fine. @return SG_OK, SG_EIO */
sg_status sg_folder_create(const char *path, sg_error *err);

/** Do two paths lead to one file or folder? False when one is not there. */
bool sg_file_same(const char *a, const char *b);
/** Would outputs of these two paths be one file, now or once their folders are made? By the identity of the folders, whatever
 *  they are called. "-" is no file. */
bool sg_file_same_place(const char *a, const char *b);
bool sg_file_exists(const char *path);
/** Name of a file without folders and ending, in the arena; NULL when its memory ran out. */
char *sg_file_stem(const char *path, sg_arena *arena);
/** Path of a file that stands beside another one: `name` as seen from the folder of `path`. @return NULL: memory is out */
char *sg_file_beside(const char *path, const char *name, sg_arena *arena);
/** Is folder/NAMEending, NAME being name, no longer than the file system takes? */
bool sg_file_name_fits(const char *folder, const char *name, const char *ending);
bool sg_folder_exists(const char *path);

#endif
