/* SPDX-License-Identifier: GPL-3.0-or-later */
/* render_support.h - meshes made by hand, for tests of the renderer. */
#ifndef SG_TESTS_RENDER_SUPPORT_H
#define SG_TESTS_RENDER_SUPPORT_H

#include "scene/mesh.h"

#include <stdlib.h>
#include <string.h>

enum { TEST_MESH_FACES = 64 };

/** Faces in one group of one colour, each corner with a vertex of its own; normals are those of the first three corners. */
typedef struct {
    sg_mesh mesh;
    double vertices[4 * TEST_MESH_FACES][3], normals[TEST_MESH_FACES][3], uvs[1][2];
    sg_mesh_face faces[TEST_MESH_FACES];
    sg_mesh_group group;
    sg_mesh_material material;
} test_mesh;

static inline test_mesh *test_mesh_create(uint32_t color)
{
    test_mesh *t = calloc(1, sizeof *t);
    t->material.color = color;
    t->mesh = (sg_mesh){.vertices = t->vertices, .normals = t->normals, .uvs = t->uvs, .faces = t->faces,
                        .groups = &t->group, .materials = &t->material, .nuvs = 1, .ngroups = 1, .nmaterials = 1};
    return t;
}

/** @param corners  [n], 3 or 4 */
static inline void test_mesh_add(test_mesh *t, const double (*corners)[3], uint32_t n)
{
    sg_mesh *m = &t->mesh;
    double ab[3], ac[3];
    sg_mesh_face *f = t->faces + m->nfaces++;
    f->ncorners = n;
    for (uint32_t i = 0; i < n; i++) {
        f->corner[i] = (sg_mesh_corner){(uint32_t)m->nvertices, (uint32_t)m->nnormals, 0};
        memcpy(t->vertices[m->nvertices++], corners[i], sizeof t->vertices[0]);
    }
    sg_vec_add(corners[1], -1, corners[0], ab);
    sg_vec_add(corners[2], -1, corners[0], ac);
    sg_vec_cross(ab, ac, t->normals[m->nnormals]);
    if (!sg_vec_normalize(t->normals[m->nnormals++]))
        t->normals[m->nnormals - 1][1] = 1;
    t->group.n = m->nfaces;
}

#endif
