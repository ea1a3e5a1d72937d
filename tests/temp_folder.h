/* SPDX-License-Identifier: GPL-3.0-or-later */
/* temp_folder.h - a folder for the files of one test, removed with what is in it. Include config.h first (nftw). */
#ifndef SG_TESTS_TEMP_FOLDER_H
#define SG_TESTS_TEMP_FOLDER_H

#include <check.h>
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

typedef struct {
    char path[256];
} temp_folder;

static inline temp_folder temp_folder_make(void)
{
    temp_folder t;
    const char *top = getenv("TMPDIR");
    snprintf(t.path, sizeof t.path, "%s/sg_test_XXXXXX", top != NULL ? top : "/tmp");
    ck_assert_ptr_nonnull(mkdtemp(t.path));
    return t;
}

/** Path of a name in the folder: one of eight buffers in turn. */
static inline const char *temp_path(const temp_folder *t, const char *name)
{
    static char buffer[8][768];
    static unsigned turn;
    char *b = buffer[turn++ % 8];
    snprintf(b, sizeof buffer[0], "%s/%s", t->path, name);
    return b;
}

static inline void temp_write(const temp_folder *t, const char *name, const void *bytes, size_t n)
{
    FILE *fp = fopen(temp_path(t, name), "wb");
    ck_assert_ptr_nonnull(fp);
    ck_assert_uint_eq(fwrite(bytes, 1, n, fp), n);
    ck_assert_int_eq(fclose(fp), 0);
}

static inline void temp_text(const temp_folder *t, const char *name, const char *text)
{
    temp_write(t, name, text, strlen(text));
}

/** All bytes of a file; the caller frees. */
static inline unsigned char *temp_read(const temp_folder *t, const char *name, size_t *n)
{
    FILE *fp = fopen(temp_path(t, name), "rb");
    ck_assert_ptr_nonnull(fp);
    unsigned char *bytes = malloc(1 << 20);
    *n = fread(bytes, 1, 1 << 20, fp);
    ck_assert_uint_lt(*n, 1 << 20);
    fclose(fp);
    return bytes;
}

static inline void temp_mkdir(const temp_folder *t, const char *name)
{
    ck_assert_int_eq(mkdir(temp_path(t, name), 0777), 0);
}

static inline int temp_remove_one(const char *path, const struct stat *st, int type, struct FTW *ftw)
{
    (void)st;
    (void)type;
    (void)ftw;
    return remove(path);
}

static inline void temp_folder_remove(const temp_folder *t)
{
    nftw(t->path, temp_remove_one, 8, FTW_DEPTH | FTW_PHYS);
}

#endif
