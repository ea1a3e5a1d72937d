/* SPDX-License-Identifier: GPL-3.0-or-later */
/* derivation_io.c - derivations as files, version 1. All numbers are little-endian, whatever the machine:
 *
 *   8 bytes  "sgderiv\n"         u32  version
 *   u32  CRC-32 of what follows the length       u64  bytes that follow here
 *   u64  fingerprint of the grammar              u32  derivations
 *   for each derivation:
 *     f64  log prior   u32 x 3  nodes, uniforms, values
 *     for each node: u32 x 5  symbol, rule, parent, length, depth      (derivation.h)
 *     f64 x uniforms   f64 x values
 *
 * Offsets of a node's values and uniforms follow from the rules before it, and are not stored. */
#include "config.h"

#include "derivation/derivation_io.h"

#include "core/array.h"
#include "core/file.h"
#include "derivation/derivation_priv.h"
#include "grammar/fingerprint.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MAGIC "sgderiv\n"
enum { FILE_VERSION = 1, HEAD = 24, NODE = 20, LEAST = 20 }; /* bytes: of the head, a node, a derivation without nodes */
#define FILE_LIMIT ((size_t)1 << 32)                         /* bytes */

void sg_derivation_file_clear(sg_derivation_file *f)
{
    for (size_t i = 0; i < f->n; i++)
        sg_derivation_clear(f->items + i);
    free(f->items);
    free(f->log_priors);
    *f = (sg_derivation_file){0};
}

sg_status sg_derivation_file_add(sg_derivation_file *f, const sg_grammar *g, sg_error *err)
{
    if (!SG_GROW(f->items, f->items_capacity, f->n + 1) || !SG_GROW(f->log_priors, f->log_priors_capacity, f->n + 1))
        return SG_FAIL_NOMEM(err);
    f->log_priors[f->n] = 0;
    sg_derivation_init(f->items + f->n++, g);
    return SG_OK;
}

sg_status sg_derivation_file_check_last(sg_derivation_file *f, sg_error *err)
{
    const sg_derivation *d = f->items + f->n - 1;
    if (d->nnodes == 0)
        return SG_FAIL(err, SG_EINPUT, "it has no node");
    if (d->nodes[0].depth > SG_DERIVATION_MAX_ITEMS - d->nnodes)
        return SG_FAIL(err, SG_EINPUT, "node 0: its depth is %u", (unsigned)d->nodes[0].depth);
    sg_status st = sg_derivation_check(d, err);
    if (st == SG_OK)
        st = sg_derivation_log_prior(d, f->log_priors + f->n - 1, err);
    if (err != NULL && st != SG_OK && st != SG_ENOMEM)
        err->code = SG_EINPUT;
    return st == SG_OK || st == SG_ENOMEM ? st : SG_EINPUT;
}

/* ---- writing ---- */

static void put_nodes(sg_bytes *b, const sg_derivation *d)
{
    for (const sg_node *n = d->nodes; n < d->nodes + d->nnodes; n++) {
        sg_bytes_put_u32(b, n->symbol);
        sg_bytes_put_u32(b, n->rule);
        sg_bytes_put_u32(b, n->parent);
        sg_bytes_put_u32(b, n->length);
        sg_bytes_put_u32(b, n->depth);
    }
}

static void put_numbers(sg_bytes *b, const double *x, size_t n)
{
    for (size_t i = 0; i < n; i++)
        sg_bytes_put_f64(b, x[i]);
}

static sg_status put_derivation(sg_bytes *b, const sg_grammar *g, const sg_derivation *d, sg_error *err)
{
    double log_prior = 0;
    if (d->nnodes == 0 || d->grammar != g)
        return SG_FAIL(err, SG_EINVAL, "an empty derivation, or one of another grammar");
    SG_TRY(sg_derivation_log_prior(d, &log_prior, err));
    sg_bytes_put_f64(b, log_prior);
    sg_bytes_put_u32(b, d->nnodes);
    sg_bytes_put_u32(b, d->nuniforms);
    sg_bytes_put_u32(b, d->nvalues);
    put_nodes(b, d);
    put_numbers(b, d->uniforms, d->nuniforms);
    put_numbers(b, d->values, d->nvalues);
    return SG_OK;
}

static sg_status put_body(sg_bytes *b, const sg_grammar *g, const sg_derivation *list, size_t n, sg_error *err)
{
    uint64_t fingerprint = 0;
    if (n > UINT32_MAX)
        return SG_FAIL(err, SG_EINVAL, "more derivations than a file can hold");
    SG_TRY(sg_grammar_fingerprint(g, &fingerprint, err));
    sg_bytes_put(b, fingerprint, 8);
    sg_bytes_put_u32(b, n);
    for (size_t i = 0; i < n; i++)
        SG_TRY(put_derivation(b, g, list + i, err));
    return b->failed ? SG_FAIL_NOMEM(err) : SG_OK;
}

/* The body is there, behind room for the head. */
static void fill_head(sg_bytes *b, size_t begin)
{
    const size_t body = begin + HEAD, end = b->n;
    const uint32_t crc = sg_bytes_checksum(b->bytes + body, end - body);
    b->n = begin;
    sg_bytes_put_text(b, MAGIC);
    sg_bytes_put_u32(b, FILE_VERSION);
    sg_bytes_put_u32(b, crc);
    sg_bytes_put(b, end - body, 8);
    b->n = end;
}

sg_status sg_derivation_file_encode(const sg_grammar *g, const sg_derivation *list, size_t n, sg_bytes *out, sg_error *err)
{
    const size_t begin = out->n;
    for (size_t i = 0; i < HEAD / 8; i++)
        sg_bytes_put(out, 0, 8);
    const sg_status st = put_body(out, g, list, n, err);
    if (st == SG_OK)
        fill_head(out, begin);
    return st;
}

static sg_status write_bytes(const char *path, const sg_bytes *b, sg_error *err)
{
    sg_output out;
    SG_TRY(sg_output_open(&out, path, err));
    fwrite(b->bytes, 1, b->n, out.fp);
    return sg_output_commit(&out, err); /* a failed write shows up here */
}

sg_status sg_derivation_file_write(const char *path, const sg_grammar *g, const sg_derivation *list, size_t n,
                                   sg_error *err)
{
    sg_bytes b = {0};
    sg_status st = sg_derivation_file_encode(g, list, n, &b, err);
    if (st == SG_OK)
        st = write_bytes(path, &b, err);
    sg_bytes_clear(&b);
    return st;
}

/* ---- reading ---- */

typedef struct {
    sg_byte_reader in;
    const char *name;
    const sg_grammar *g;
    sg_error *err;
} reader;

#define FAIL(r, offset, format, ...)                                                                                   \
    SG_FAIL((r)->err, SG_EINPUT, "%.250s: byte %zu: " format, (r)->name, (size_t)(offset), __VA_ARGS__)

static size_t left(const reader *r)
{
    return r->in.n - r->in.at;
}

static sg_status check_magic(reader *r)
{
    const size_t n = left(r) < strlen(MAGIC) ? left(r) : strlen(MAGIC);
    if (memcmp(r->in.bytes, MAGIC, n) != 0 || n == 0)
        return SG_FAIL(r->err, SG_EINPUT, "%.250s: no file of derivations (*.sgd)", r->name);
    if (r->in.n < HEAD)
        return FAIL(r, r->in.n, "%s", "the file is cut short");
    r->in.at += n;
    return SG_OK;
}

static sg_status check_head(reader *r)
{
    SG_TRY(check_magic(r));
    const uint32_t version = sg_bytes_get_u32(&r->in), crc = sg_bytes_get_u32(&r->in);
    const uint64_t length = sg_bytes_get(&r->in, 8);
    if (version != FILE_VERSION)
        return FAIL(r, strlen(MAGIC), "derivations of version %u; this program knows version %d", (unsigned)version,
                    FILE_VERSION);
    if (left(r) < length)
        return FAIL(r, r->in.n, "the file is cut short: %llu bytes are missing", (unsigned long long)(length - left(r)));
    if (left(r) > length)
        return FAIL(r, HEAD + length, "%llu bytes too many", (unsigned long long)(left(r) - length));
    if (sg_bytes_checksum(r->in.bytes + HEAD, left(r)) != crc)
        return FAIL(r, HEAD, "%s", "the file is damaged: its checksum does not hold");
    return SG_OK;
}

static sg_status check_grammar(reader *r)
{
    uint64_t want = 0;
    SG_TRY(sg_grammar_fingerprint(r->g, &want, r->err));
    const size_t at = r->in.at;
    const uint64_t got = sg_bytes_get(&r->in, 8);
    if (r->in.failed)
        return FAIL(r, at, "%s", "the file ends before the fingerprint of its grammar");
    if (got != want)
        return FAIL(r, at, "these are derivations of another grammar than '%.60s' (fingerprint %016llx, not %016llx)",
                    sg_grammar_name(r->g), (unsigned long long)got, (unsigned long long)want);
    return SG_OK;
}

/* A node, and the pieces of values and uniforms that are its own. */
static sg_status get_node(reader *r, sg_derivation *d, size_t *values, size_t *uniforms)
{
    const size_t at = r->in.at, i = d->nnodes;
    sg_node n = {.values = (uint32_t)*values, .uniforms = (uint32_t)*uniforms};
    n.symbol = sg_bytes_get_u32(&r->in);
    n.rule = sg_bytes_get_u32(&r->in);
    n.parent = sg_bytes_get_u32(&r->in);
    n.length = sg_bytes_get_u32(&r->in);
    n.depth = sg_bytes_get_u32(&r->in);
    if (n.symbol >= sg_grammar_symbol_count(r->g))
        return FAIL(r, at, "node %zu: symbol %u is none of the grammar", i, (unsigned)n.symbol);
    if (n.rule < SG_RULE_EMPTY && n.rule >= sg_grammar_rule_count(r->g))
        return FAIL(r, at, "node %zu: rule %u is none of the grammar", i, (unsigned)n.rule);
    const sg_rule *rule = sg_node_rule(d, &n);
    *values += sg_grammar_symbol(r->g, n.symbol)->nparams + (rule != NULL ? rule->nvalues : 0);
    *uniforms += rule != NULL ? rule->nuniforms : 0;
    if (*values > d->nvalues || *uniforms > d->nuniforms)
        return FAIL(r, at, "node %zu: it needs more values or uniforms than there are", i);
    d->nodes[d->nnodes++] = n;
    return SG_OK;
}

static void get_numbers(reader *r, double *x, size_t n)
{
    for (size_t i = 0; i < n; i++)
        x[i] = sg_bytes_get_f64(&r->in);
}

static sg_status get_arrays(reader *r, sg_derivation *d)
{
    const size_t at = r->in.at, nnodes = sg_bytes_get_u32(&r->in), nuniforms = sg_bytes_get_u32(&r->in),
                 nvalues = sg_bytes_get_u32(&r->in);
    /* 32-bit sizes: the sum does not overflow 64 bits, and nothing is allocated that the file cannot fill */
    if (left(r) < (uint64_t)nnodes * NODE + ((uint64_t)nuniforms + nvalues) * 8)
        return FAIL(r, at, "%zu nodes, %zu uniforms and %zu values are more than the file holds", nnodes, nuniforms,
                    nvalues);
    SG_TRY(sg_derivation_reserve(d, nnodes, nuniforms + 1, nvalues + 1, r->err)); /* so that both arrays are there */
    d->nuniforms = nuniforms;
    d->nvalues = nvalues;
    size_t values = 0, uniforms = 0;
    for (size_t i = 0; i < nnodes; i++)
        SG_TRY(get_node(r, d, &values, &uniforms));
    get_numbers(r, d->uniforms, nuniforms);
    get_numbers(r, d->values, nvalues);
    return SG_OK;
}

static bool close_to(double a, double b)
{
    return a == b || fabs(a - b) <= 1e-9 * (1 + fabs(b));
}

static sg_status get_derivation(reader *r, size_t i, sg_derivation_file *out)
{
    const size_t at = r->in.at;
    if (left(r) < LEAST)
        return FAIL(r, at, "the file ends before derivation %zu", i + 1);
    const double log_prior = sg_bytes_get_f64(&r->in);
    SG_TRY(sg_derivation_file_add(out, r->g, r->err));
    SG_TRY(get_arrays(r, out->items + i));
    sg_error inner = SG_ERROR_INIT;
    const sg_status st = sg_derivation_file_check_last(out, &inner);
    if (st == SG_ENOMEM)
        return SG_FAIL_NOMEM(r->err);
    if (st != SG_OK)
        return FAIL(r, at, "derivation %zu: %.600s", i + 1, inner.msg);
    if (!close_to(log_prior, out->log_priors[i]))
        return FAIL(r, at, "derivation %zu: its log prior is %.17g, not %.17g", i + 1, out->log_priors[i], log_prior);
    out->log_priors[i] = log_prior;
    return SG_OK;
}

static sg_status get_all(reader *r, sg_derivation_file *out)
{
    SG_TRY(check_head(r));
    SG_TRY(check_grammar(r));
    const size_t at = r->in.at, n = sg_bytes_get_u32(&r->in);
    if (r->in.failed)
        return FAIL(r, at, "%s", "the file ends before the number of its derivations");
    for (size_t i = 0; i < n; i++)
        SG_TRY(get_derivation(r, i, out));
    return left(r) == 0 ? SG_OK : FAIL(r, r->in.at, "%zu bytes behind the last derivation", left(r));
}

sg_status sg_derivation_file_decode(const unsigned char *bytes, size_t n, const char *name, const sg_grammar *g,
                                    sg_derivation_file *out, sg_error *err)
{
    reader r = {{bytes, n, 0, false}, name, g, err};
    sg_derivation_file f = {0};
    const sg_status st = get_all(&r, &f);
    if (st == SG_OK)
        *out = f;
    else
        sg_derivation_file_clear(&f);
    return st;
}

sg_status sg_derivation_file_read(const char *path, const sg_grammar *g, sg_derivation_file *out, sg_error *err)
{
    char *text = NULL;
    size_t n = 0;
    sg_arena *arena = sg_arena_create();
    sg_status st = arena != NULL ? sg_file_read(path, FILE_LIMIT, arena, &text, &n, err) : SG_FAIL_NOMEM(err);
    if (st == SG_OK)
        st = sg_derivation_file_decode((const unsigned char *)text, n, strcmp(path, "-") == 0 ? "standard input" : path, g,
                                       out, err);
    sg_arena_free(arena);
    return st;
}
