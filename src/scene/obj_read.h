/* SPDX-License-Identifier: GPL-3.0-or-later */
/* obj_read.h - polygon meshes from Wavefront OBJ files and the colours of their materials from MTL files (Wavefront,
 * appendices B1 and B2 of the Advanced Visualizer manual, 1995).
 *
 * Read are v, vt, vn, f, usemtl and mtllib; what says nothing about the surface of polygons (names of objects and groups,
 * smoothing, lines, points) is passed over; curves and free-form surfaces are refused. */
#ifndef SG_SCENE_OBJ_READ_H
#define SG_SCENE_OBJ_READ_H

#include "core/arena.h"
#include "grammar/names.h"
#include "scene/mesh.h"

/** The most bytes and materials a file, and corners a face, may have. */
enum { SG_OBJ_MAX_BYTES = 32 << 20, SG_OBJ_MAX_MATERIALS = 4096, SG_OBJ_MAX_CORNERS = 256 };

typedef struct {
    const char *name;
    uint32_t color; /* 0xRRGGBB of Kd; SG_NONE: no library says it */
} sg_obj_material;

/** A material library that the file names. */
typedef struct {
    const char *name; /* as it stands in the file */
    size_t at;        /* byte of the file where */
    const char *path; /* that was read; NULL: none */
} sg_obj_library;

/** A zeroed one is empty. Strings live as long as it. */
typedef struct {
    double (*vertices)[3];
    double (*normals)[3]; /* of length 1; one of length 0 in the file has none, and is 0 */
    double (*uvs)[2];
    sg_mesh_face *faces; /* normal and uv of a corner may be SG_NONE; group: its material, or SG_NONE */
    sg_obj_material *materials;
    sg_obj_library *libraries;
    size_t nvertices, nnormals, nuvs, nfaces, nmaterials, nlibraries;
    size_t vertices_capacity, normals_capacity, uvs_capacity, faces_capacity, materials_capacity, libraries_capacity;
    double low[3], high[3]; /* box around the vertices that faces use; 0 where there is no face */
    sg_names names;         /* of materials: their numbers */
    sg_arena *arena;        /* of the strings */
} sg_obj;

/** Read a file and its material libraries, which stand beside it. Polygons of more than four corners, and those that are
 *  not convex, are cut into triangles; corners that repeat the one before them, and faces that then have fewer than three,
 *  go.
 *  @return SG_OK, SG_EINPUT (FILE:LINE:COL: what is wrong; a library that is missing, numbers that are not finite or over
 *  1e30 in size, an index of nothing, a file over the limits), SG_ENOMEM; on failure *obj is empty; free with
 *  sg_obj_clear() */
sg_status sg_obj_load(const char *path, sg_obj *obj, sg_error *err);

/** The same from memory, without libraries: materials have no colours. name stands for the file in messages. */
sg_status sg_obj_parse(const char *text, size_t length, const char *name, sg_obj *obj, sg_error *err);
/** Colours from the text of a library, for the materials that the mesh has. @return SG_OK, SG_EINPUT, SG_ENOMEM */
sg_status sg_obj_parse_materials(const char *text, size_t length, const char *name, sg_obj *obj, sg_error *err);

void sg_obj_clear(sg_obj *obj);

#endif
