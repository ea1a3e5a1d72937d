/* SPDX-License-Identifier: GPL-3.0-or-later */
/* mesh.h - a scene as triangles and quadrilaterals.
 *
 * Faces look outwards: counterclockwise as seen from outside. Solids are closed, each edge is used once in either
 * direction; polygons and label rectangles are open and flat. Segments that continue each other (one starts where
 * the other ends, as wide, at less than about 75 degrees, and long beside their width) share the ring of vertices at
 * their joint: generalised cylinders, as in Bloomenthal, "Modeling the mighty maple" (1985), with rings carried along
 * without twist.
 *
 * Texture coordinates: on flat faces lengths along the face; around round ones u runs from 0 to 1, and v along the axis
 * is a length (on spheres from 0 to 1). */
#ifndef SG_SCENE_MESH_H
#define SG_SCENE_MESH_H

#include "scene/scene.h"

typedef struct {
    uint32_t vertex, normal, uv; /* indices into the mesh */
} sg_mesh_corner;

typedef struct {
    sg_mesh_corner corner[4];
    uint32_t ncorners; /* 3 or 4 */
    uint32_t group;
} sg_mesh_face;

typedef struct {
    uint32_t color;   /* 0xRRGGBB */
    const char *name; /* borrowed from the grammar or a mesh file; NULL: it has no name but its colour */
} sg_mesh_material;

/** Faces of one label or mesh name, and one material. They stand together. */
typedef struct {
    const char *name; /* of the label or the mesh, borrowed from the grammar; NULL: none */
    uint32_t material;
    size_t first, n;
    uint32_t key_material, key_label, key_mesh; /* of the primitives */
    uint32_t key_part;                          /* material of a mesh file, SG_NONE: the primitive's */
} sg_mesh_group;

/** A zeroed one is empty. */
typedef struct {
    double (*vertices)[3];
    double (*normals)[3]; /* of length 1 */
    double (*uvs)[2];
    sg_mesh_face *faces;
    sg_mesh_group *groups;
    sg_mesh_material *materials;
    size_t nvertices, nnormals, nuvs, nfaces, ngroups, nmaterials;
    size_t vertices_capacity, normals_capacity, uvs_capacity, faces_capacity, groups_capacity, materials_capacity;
} sg_mesh;

typedef struct {
    unsigned radial; /* sides of round primitives at the finest level */
    unsigned detail; /* level of detail: 0 the finest, each further one halves `radial`, down to 3. All levels have one
                        skeleton: rings stand at the same places, as wide */
    const struct sg_assets *assets; /* the meshes that files hold; must live as long as the mesh. NULL: none are known */
} sg_mesh_opts;

#define SG_MESH_OPTS_INIT {12, 0, NULL}

/** Make the mesh of a scene; it is emptied first, and keeps its memory. Primitives thinner than a billionth of their
 *  distance and size (at least of 1) are left out, and segments without width. A mesh from a file fills its scope, in
 *  groups of its name; faces keep the materials that the file gives colours to. Where it is not among the assets a box
 *  stands for it.
 *  @return SG_OK, SG_EINVAL (radial is less than 3 or more than 1024), SG_ENUMERIC (a coordinate over 1e100, more than
 *  2^32 vertices), SG_ENOMEM; on failure the mesh is empty */
sg_status sg_mesh_from_scene(const sg_scene *scene, const sg_mesh_opts *opts, sg_mesh *mesh, sg_error *err);
void sg_mesh_clear(sg_mesh *mesh);

#endif
