/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fuzz_main.c - a stand-in for libFuzzer where there is none: each file of the corpus as it is, then mutations of them, the
 * same ones every time. Usage as libFuzzer's: FUZZER [-runs=N] [-seed=N] FOLDER-OR-FILE...; other options are not known. */
#include "tests/fuzz.h"

#include <dirent.h>
#include <stdbool.h>
#include <string.h>
#include <sys/stat.h>

enum { MAX_FILES = 1000, MAX_SIZE = 1 << 16, MAX_STEPS = 8 };

typedef struct {
    uint8_t *bytes;
    size_t n;
} input;

typedef struct {
    input files[MAX_FILES];
    size_t nfiles;
    uint64_t state;
} corpus;

static uint64_t next(corpus *c)
{
    c->state += 0x9e3779b97f4a7c15u; /* splitmix64 (Steele, Lea and Flood, 2014) */
    uint64_t z = c->state;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}

static size_t below(corpus *c, size_t n)
{
    return n > 0 ? (size_t)(next(c) % n) : 0;
}

static void add_file(corpus *c, const char *path)
{
    FILE *fp = fopen(path, "rb");
    fuzz_must(fp != NULL && c->nfiles < MAX_FILES);
    input *in = c->files + c->nfiles++;
    in->bytes = malloc(MAX_SIZE);
    fuzz_must(in->bytes != NULL);
    in->n = fread(in->bytes, 1, MAX_SIZE, fp);
    fclose(fp);
}

static int compare(const struct dirent **a, const struct dirent **b)
{
    return strcmp((*a)->d_name, (*b)->d_name); /* in any locale the same order */
}

static void add(corpus *c, const char *path)
{
    struct stat st;
    fuzz_must(stat(path, &st) == 0);
    if (!S_ISDIR(st.st_mode)) {
        add_file(c, path);
        return;
    }
    struct dirent **names = NULL;
    const int n = scandir(path, &names, NULL, compare);
    for (int i = 0; i < n; i++) {
        char file[4096];
        snprintf(file, sizeof file, "%s/%s", path, names[i]->d_name);
        if (stat(file, &st) == 0 && S_ISREG(st.st_mode))
            add_file(c, file);
        free(names[i]);
    }
    free(names);
}

/* A copy of just that size, so that sanitizers see a byte too far. */
static void try_bytes(const uint8_t *bytes, size_t n)
{
    uint8_t *copy = malloc(n > 0 ? n : 1);
    fuzz_must(copy != NULL);
    memcpy(copy, bytes, n);
    LLVMFuzzerTestOneInput(copy, n);
    free(copy);
}

/* Put n bytes in at a place. */
static void put_in(input *in, size_t at, const uint8_t *bytes, size_t n)
{
    n = n < MAX_SIZE - in->n ? n : MAX_SIZE - in->n;
    memmove(in->bytes + at + n, in->bytes + at, in->n - at);
    memmove(in->bytes + at, bytes, n);
    in->n += n;
}

static void take_out(input *in, size_t at, size_t n)
{
    n = n < in->n - at ? n : in->n - at;
    memmove(in->bytes + at, in->bytes + at + n, in->n - at - n);
    in->n -= n;
}

static void mutate(corpus *c, input *in)
{
    static const uint8_t strange[] = {0, 1, 0x7f, 0x80, 0xff, '0', '9', '"', '(', ')', '[', '{', '}', '-', '.', 'e', '\n'};
    uint8_t some[MAX_STEPS];
    const size_t at = below(c, in->n);
    const input *other = c->files + below(c, c->nfiles);
    const size_t from = below(c, other->n);
    for (size_t i = 0; i < sizeof some; i++)
        some[i] = strange[below(c, sizeof strange)];
    if (in->n == 0) {
        put_in(in, 0, some, sizeof some);
        return;
    }
    switch (below(c, 7)) {
    case 0:
        in->bytes[at] ^= (uint8_t)(1U << below(c, 8));
        break;
    case 1:
        in->bytes[at] = some[0];
        break;
    case 2:
        take_out(in, at, 1 + below(c, 16));
        break;
    case 3:
        put_in(in, at, some, 1 + below(c, sizeof some));
        break;
    case 4:
        put_in(in, at, other->bytes + from, 1 + below(c, other->n - from));
        break;
    case 5:
        memset(in->bytes + at, some[0], 4 < in->n - at ? 4 : in->n - at);
        break;
    default:
        in->n = at;
    }
}

static void try_mutation(corpus *c, uint8_t *space)
{
    const input *seed = c->files + below(c, c->nfiles);
    input in = {space, seed->n};
    memcpy(space, seed->bytes, seed->n);
    for (size_t steps = 1 + below(c, MAX_STEPS); steps > 0; steps--)
        mutate(c, &in);
    try_bytes(in.bytes, in.n);
}

int main(int argc, char **argv)
{
    static corpus c;
    unsigned long runs = 2000;
    c.state = 1;
    for (int i = 1; i < argc; i++) {
        if (strncmp(argv[i], "-runs=", 6) == 0)
            runs = strtoul(argv[i] + 6, NULL, 10);
        else if (strncmp(argv[i], "-seed=", 6) == 0)
            c.state = strtoul(argv[i] + 6, NULL, 10);
        else
            add(&c, argv[i]);
    }
    fuzz_must(c.nfiles > 0);
    uint8_t *space = malloc(MAX_SIZE);
    fuzz_must(space != NULL);
    for (size_t i = 0; i < c.nfiles; i++)
        try_bytes(c.files[i].bytes, c.files[i].n);
    for (unsigned long i = 0; i < runs; i++)
        try_mutation(&c, space);
    printf("%zu files, %lu mutations\n", c.nfiles, runs);
    for (size_t i = 0; i < c.nfiles; i++)
        free(c.files[i].bytes);
    free(space);
    return EXIT_SUCCESS;
}
