/* SPDX-License-Identifier: GPL-3.0-or-later */
/* mesh_gltf.h - meshes as binary glTF 2.0 (*.glb; Khronos Group, "glTF 2.0 Specification", 2021; ISO/IEC 12113:2022).
 *
 * Our scenes have glTF's axes and unit already: right-handed, y up, metres. Each name of the mesh becomes a node with a
 * mesh, each material in it a primitive of triangles; faces without a name are the mesh "unnamed". Colours are sRGB
 * here, linear there; surfaces are matt and seen from both sides, since labels and polygons have one face. */
#ifndef SG_SCENE_MESH_GLTF_H
#define SG_SCENE_MESH_GLTF_H

#include "scene/mesh.h"

/** Write the file. Lengths under half a micrometre are 0; the same mesh gives the same bytes. A mesh without faces is a
 *  scene without nodes.
 *  @return SG_OK, SG_ENUMERIC (a coordinate that is no 32-bit number, a file over 4 GiB), SG_ENOMEM, SG_EIO */
sg_status sg_mesh_gltf_write(const sg_mesh *mesh, FILE *out, sg_error *err);

/** The same, as the file `path`, which appears when it is whole. @return as above */
sg_status sg_mesh_gltf_save(const sg_mesh *mesh, const char *path, sg_error *err);

#endif
