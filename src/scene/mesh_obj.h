/* SPDX-License-Identifier: GPL-3.0-or-later */
/* mesh_obj.h - meshes as Wavefront OBJ, with their materials as MTL (Wavefront, "Object Files" and "Material library
 * file", appendices B of the Advanced Visualizer manual, 1995). */
#ifndef SG_SCENE_MESH_OBJ_H
#define SG_SCENE_MESH_OBJ_H

#include "scene/mesh.h"

/** Write vertices, texture coordinates, normals, and the faces of each group. Numbers have seven digits, and lengths
 *  under half a micrometre are 0, so that the same mesh gives the same text everywhere.
 *  @param library  file name of the materials, or NULL
 *  @return SG_OK, SG_EIO */
sg_status sg_mesh_obj_write(const sg_mesh *mesh, const char *library, FILE *out, sg_error *err);
/** Write the materials. @return SG_OK, SG_EIO */
sg_status sg_mesh_mtl_write(const sg_mesh *mesh, FILE *out, sg_error *err);

/** Write the file `path` and beside it the materials, whose name ends in .mtl instead of .obj.
 *  @return SG_OK, SG_EINVAL (path does not end in .obj), SG_EIO (the path is too long too) */
sg_status sg_mesh_obj_save(const sg_mesh *mesh, const char *path, sg_error *err);

#endif
