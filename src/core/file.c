/* SPDX-License-Identifier: GPL-3.0-or-later */
/* file.c - whole-file reads and all-or-nothing writes. */
#include "config.h"

#include "core/file.h"

#include <errno.h>
#include <string.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

static bool is_special(const char *path)
{
    struct stat st;
    return stat(path, &st) == 0 && !S_ISREG(st.st_mode);
}

/* mkstemp() makes the file for its owner only; an output should be what fopen() would have made it. */
static void set_usual_mode(int fd)
{
    const mode_t mask = umask(0);
    umask(mask);
    if (fchmod(fd, 0666 & ~mask) != 0)
        errno = 0; /* some file systems have no modes: the file is still good */
}

static sg_status open_temporary(sg_output *out, sg_error *err)
{
    const char *slash = strrchr(out->path, '/');
    const int folder = slash != NULL ? (int)(slash - out->path + 1) : 0;
    const char *name = out->path + folder; /* cut, because the longest allowed leaves no room for more */
    const int n = snprintf(out->temp, sizeof out->temp, "%.*s.%.200s.XXXXXX", folder, out->path, name);
    if (n < 0 || (size_t)n >= sizeof out->temp)
        return SG_FAIL(err, SG_EIO, "%s: the path is too long", out->path);
    const int fd = mkstemp(out->temp);
    if (fd < 0)
        return SG_FAIL(err, SG_EIO, "%s: %s", out->path, errno == ENOENT ? "its folder is not there" : strerror(errno));
    set_usual_mode(fd);
    out->fp = fdopen(fd, "wb");
    if (out->fp == NULL) {
        close(fd);
        unlink(out->temp);
        return SG_FAIL(err, SG_EIO, "%s: %s", out->path, strerror(errno));
    }
    return SG_OK;
}

sg_status sg_output_open(sg_output *out, const char *path, sg_error *err)
{
    out->fp = NULL;
    out->temp[0] = '\0';
    const int n = snprintf(out->path, sizeof out->path, "%s", path);
    if (n == 0)
        return SG_FAIL(err, SG_EIO, "an empty name for an output file");
    if (n < 0 || (size_t)n >= sizeof out->path)
        return SG_FAIL(err, SG_EIO, "%.200s...: the path is too long", path);
    if (strcmp(path, "-") == 0) {
        out->fp = stdout;
        return SG_OK;
    }
    if (!is_special(path))
        return open_temporary(out, err);
    out->fp = fopen(path, "wb");
    return out->fp != NULL ? SG_OK : SG_FAIL(err, SG_EIO, "%s: %s", path, strerror(errno));
}

static bool is_write_error(int code)
{
    return code == ENOSPC || code == EFBIG || code == EDQUOT || code == EIO || code == EPIPE || code == EBADF;
}

sg_status sg_output_commit(sg_output *out, sg_error *err)
{
    FILE *fp = out->fp;
    const bool to_stdout = fp == stdout, to_temp = out->temp[0] != '\0';
    out->fp = NULL;
    /* when the stream has failed before, errno is what that write left, unless another call has changed it since */
    const int before = errno;
    errno = 0;
    bool good = !ferror(fp);
    int why = !good && is_write_error(before) ? before : 0;
    if (good && (fflush(fp) != 0 || (to_temp && fsync(fileno(fp)) != 0))) {
        good = false;
        why = errno;
    }
    if (!to_stdout && fclose(fp) != 0 && good) {
        good = false;
        why = errno;
    }
    if (good && to_temp && rename(out->temp, out->path) != 0) {
        good = false;
        why = errno;
    }
    if (good)
        return SG_OK;
    if (to_temp)
        unlink(out->temp);
    return SG_FAIL(err, SG_EIO, "%s: %s", to_stdout ? "standard output" : out->path,
                   why != 0 ? strerror(why) : "writing failed");
}

void sg_output_discard(sg_output *out)
{
    if (out->fp == NULL)
        return;
    if (out->fp != stdout)
        fclose(out->fp);
    out->fp = NULL;
    if (out->temp[0] != '\0')
        unlink(out->temp);
}

sg_status sg_output_end(sg_output *out, sg_status st, sg_error *err)
{
    if (st == SG_OK)
        return sg_output_commit(out, err);
    sg_output_discard(out);
    if (st != SG_EIO || err == NULL)
        return st;
    const sg_error inner = *err;
    return SG_FAIL(err, st, "%s: %.900s", strcmp(out->path, "-") == 0 ? "standard output" : out->path, inner.msg);
}

static sg_status read_all(FILE *fp, const char *path, size_t limit, sg_arena *arena, char **text, size_t *length,
                          sg_error *err)
{
    size_t size = 0, capacity = 65536;
    char *buffer = malloc(capacity);
    while (buffer != NULL) {
        size += fread(buffer + size, 1, capacity - size, fp);
        if (size < capacity || size > limit)
            break;
        char *larger = realloc(buffer, capacity *= 2);
        if (larger == NULL)
            free(buffer);
        buffer = larger;
    }
    sg_status st = SG_OK;
    if (buffer == NULL)
        return SG_FAIL_NOMEM(err);
    if (ferror(fp))
        st = SG_FAIL(err, SG_EINPUT, "%s: %s", path, strerror(errno));
    else if (size > limit)
        st = SG_FAIL(err, SG_EINPUT, "%s: larger than the %zu bytes that such a file may have", path, limit);
    else if ((*text = sg_arena_alloc(arena, size + 1)) == NULL)
        st = SG_FAIL_NOMEM(err);
    else {
        memcpy(*text, buffer, size);
        (*text)[size] = '\0';
        *length = size;
    }
    free(buffer);
    return st;
}

sg_status sg_file_read(const char *path, size_t limit, sg_arena *arena, char **text, size_t *length, sg_error *err)
{
    if (strcmp(path, "-") == 0)
        return read_all(stdin, "standard input", limit, arena, text, length, err);
    FILE *fp = fopen(path, "rb");
    if (fp == NULL)
        return SG_FAIL(err, SG_EINPUT, "%s: %s", path, strerror(errno));
    const sg_status st = read_all(fp, path, limit, arena, text, length, err);
    fclose(fp);
    return st;
}

sg_status sg_folder_create(const char *path, sg_error *err)
{
    char buffer[4096];
    const int n = snprintf(buffer, sizeof buffer, "%s", path);
    if (n <= 0 || (size_t)n >= sizeof buffer)
        return SG_FAIL(err, SG_EIO, "'%.200s': no path for a folder", path);
    for (char *p = buffer + 1;; p++) {
        const char c = *p;
        if (c != '/' && c != '\0')
            continue;
        *p = '\0';
        if (mkdir(buffer, 0777) != 0 && (errno != EEXIST || !sg_folder_exists(buffer)))
            return SG_FAIL(err, SG_EIO, "%s: %s", buffer, errno == EEXIST ? strerror(ENOTDIR) : strerror(errno));
        if (c == '\0')
            return SG_OK;
        *p = c;
    }
}

bool sg_file_same(const char *a, const char *b)
{
    struct stat x, y;
    return stat(a, &x) == 0 && stat(b, &y) == 0 && x.st_dev == y.st_dev && x.st_ino == y.st_ino;
}

/* The deepest folder that is there, and what follows it. */
typedef struct {
    dev_t device;
    ino_t inode;
    char rest[4096]; /* each part with a slash before it */
} place;

/* Parts that lead nowhere are left out. */
static void tidy(const char *from, char *to)
{
    while (*from != '\0') {
        const size_t n = strcspn(from, "/");
        if (n > 0 && !(n == 1 && *from == '.')) {
            *to++ = '/';
            memcpy(to, from, n);
            to += n;
        }
        from += n + (from[n] == '/');
    }
    *to = '\0';
}

static bool find_place(const char *path, place *out)
{
    char folder[4096 - 1]; /* a slash more fits in out->rest */
    struct stat st;
    size_t n = strlen(path);
    if (n >= sizeof folder)
        return false;
    memcpy(folder, path, n + 1);
    do {
        while (n > 0 && folder[n - 1] != '/') /* the last part, */
            n--;
        while (n > 1 && folder[n - 1] == '/') /* and the slashes before it */
            n--;
        folder[n] = '\0';
    } while (n > 0 && (stat(folder, &st) != 0 || !S_ISDIR(st.st_mode)));
    if (n == 0 && stat(".", &st) != 0)
        return false;
    out->device = st.st_dev;
    out->inode = st.st_ino;
    tidy(path + n, out->rest);
    return true;
}

bool sg_file_same_place(const char *a, const char *b)
{
    place x, y;
    return strcmp(a, "-") != 0 && strcmp(b, "-") != 0 && find_place(a, &x) && find_place(b, &y) && x.device == y.device &&
           x.inode == y.inode && strcmp(x.rest, y.rest) == 0;
}

bool sg_file_name_fits(const char *folder, const char *name, const char *ending)
{
    const long most = pathconf(folder, _PC_NAME_MAX);
    const size_t n = strlen(name) + strlen(ending);
    const sg_output *out = NULL;
    return (most < 0 || n <= (size_t)most) && strlen(folder) + 1 + n < sizeof out->path;
}

char *sg_file_stem(const char *path, sg_arena *arena)
{
    const char *slash = strrchr(path, '/'), *base = slash != NULL ? slash + 1 : path, *dot = strrchr(base, '.');
    return sg_arena_printf(arena, "%.*s", dot != NULL && dot > base ? (int)(dot - base) : (int)strlen(base), base);
}

char *sg_file_beside(const char *path, const char *name, sg_arena *arena)
{
    const char *slash = strrchr(path, '/');
    const int folder = name[0] != '/' && slash != NULL ? (int)(slash - path) + 1 : 0;
    return sg_arena_printf(arena, "%.*s%s", folder, path, name);
}

bool sg_file_exists(const char *path)
{
    struct stat st;
    return stat(path, &st) == 0 && S_ISREG(st.st_mode);
}

bool sg_folder_exists(const char *path)
{
    struct stat st;
    return stat(path, &st) == 0 && S_ISDIR(st.st_mode);
}
