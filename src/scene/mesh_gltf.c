/* SPDX-License-Identifier: GPL-3.0-or-later */
/* mesh_gltf.c - the binary container: a header and two chunks, all lengths multiples of 4. */
#include "scene/mesh_gltf.h"

#include "core/file.h"
#include "scene/gltf_priv.h"

#include <stdlib.h>

enum { MAGIC = 0x46546C67 /* glTF */, VERSION = 2, JSON_CHUNK = 0x4E4F534A, BIN_CHUNK = 0x004E4942 };
enum { HEADER_BYTES = 12, CHUNK_BYTES = 8 };

static void write_u32(size_t value, FILE *out)
{
    for (int i = 0; i < 4; i++)
        fputc((int)(value >> 8 * i & 255), out);
}

static void write_part(const sg_bytes *part, FILE *out)
{
    if (part->n > 0)
        fwrite(part->bytes, 1, part->n, out);
}

static void write_file(const sg_gltf_pack *pack, const char *json, size_t length, FILE *out)
{
    const size_t n = pack->positions.n + pack->normals.n + pack->uvs.n + pack->indices.n;
    write_u32(MAGIC, out);
    write_u32(VERSION, out);
    write_u32(HEADER_BYTES + CHUNK_BYTES + length + (n > 0 ? CHUNK_BYTES + n : 0), out);
    write_u32(length, out);
    write_u32(JSON_CHUNK, out);
    fwrite(json, 1, length, out);
    if (n == 0)
        return;
    write_u32(n, out);
    write_u32(BIN_CHUNK, out);
    write_part(&pack->positions, out);
    write_part(&pack->normals, out);
    write_part(&pack->uvs, out);
    write_part(&pack->indices, out);
}

static sg_status pack_and_write(const sg_mesh *mesh, sg_gltf_pack *pack, FILE *out, sg_error *err)
{
    char *json;
    size_t length;
    SG_TRY(sg_gltf_pack_mesh(mesh, pack, err));
    SG_TRY(sg_gltf_json(mesh, pack, &json, &length, err));
    write_file(pack, json, length, out);
    free(json);
    return ferror(out) ? SG_FAIL(err, SG_EIO, "writing a mesh failed") : SG_OK;
}

sg_status sg_mesh_gltf_write(const sg_mesh *mesh, FILE *out, sg_error *err)
{
    sg_gltf_pack pack = {0};
    const sg_status st = pack_and_write(mesh, &pack, out, err);
    sg_gltf_pack_clear(&pack);
    return st;
}

sg_status sg_mesh_gltf_save(const sg_mesh *mesh, const char *path, sg_error *err)
{
    sg_output out;
    SG_TRY(sg_output_open(&out, path, err));
    return sg_output_end(&out, sg_mesh_gltf_write(mesh, out.fp, err), err);
}
