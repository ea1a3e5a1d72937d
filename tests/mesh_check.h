/* SPDX-License-Identifier: GPL-3.0-or-later */
/* mesh_check.h - what every mesh of a scene must be, whatever the grammar: the rules of mesh.h, one by one. */
#ifndef SG_TESTS_MESH_CHECK_H
#define SG_TESTS_MESH_CHECK_H

#include "scene/mesh.h"

/** Triangles and quadrilaterals with an area and different corners; normals of length 1 that agree with the winding;
 *  finite numbers; no face twice; each edge used once in either direction, but for flat parts and those of mesh
 *  files, which may have a border; closed surfaces that hold a positive volume; faces in their groups; materials, colours and
 *  names valid.
 *  @param nopen  out, when all is well: parts with a border; may be NULL
 *  @return NULL, or what is wrong, in a few words */
const char *mesh_check(const sg_mesh *m, size_t *nopen);

/** The volume inside, by the divergence theorem; quadrilaterals as two triangles. */
double mesh_volume(const sg_mesh *m);

#endif
