/* SPDX-License-Identifier: GPL-3.0-or-later */
/* gltf_priv.h - a mesh in the arrays of glTF: what the files of the exporter share. */
#ifndef SG_SCENE_GLTF_PRIV_H
#define SG_SCENE_GLTF_PRIV_H

#include "core/bytes.h"
#include "scene/mesh.h"

/** Triangles of one name and material. Offsets are bytes in their parts of the buffer. */
typedef struct {
    uint32_t group;    /* a group of the mesh: gives name and material */
    bool first;        /* the first one of its name: a mesh of the file begins */
    uint32_t material; /* number in the file, where only those are that are used */
    size_t first_vertex, nvertices;
    size_t index_offset, nindices;
    unsigned index_size;   /* bytes: 2 or 4 */
    float low[3], high[3]; /* of the positions */
} sg_gltf_primitive;

/** The parts of the buffer, little-endian: float positions, normals, texture coordinates (from the top), indices. Each
 *  is a multiple of 4 bytes long. */
typedef struct {
    sg_bytes positions, normals, uvs, indices;
    size_t nvertices;
    sg_gltf_primitive *primitives;
    size_t nprimitives, capacity;
    uint32_t *materials; /* [mesh materials] number in the file, SG_NONE: not used */
    uint32_t nmaterials; /* that are used */
} sg_gltf_pack;

/** @return SG_OK, SG_ENUMERIC (a coordinate that is no 32-bit number, a file over 4 GiB), SG_ENOMEM; free in any case
 *  with sg_gltf_pack_clear() */
sg_status sg_gltf_pack_mesh(const sg_mesh *mesh, sg_gltf_pack *pack, sg_error *err);
void sg_gltf_pack_clear(sg_gltf_pack *pack);

/** The JSON chunk, padded with spaces to a multiple of 4 bytes.
 *  @return SG_OK, SG_ENOMEM; on success free *text with free() */
sg_status sg_gltf_json(const sg_mesh *mesh, const sg_gltf_pack *pack, char **text, size_t *length, sg_error *err);

#endif
