/* SPDX-License-Identifier: GPL-3.0-or-later */
/* mesh_priv.h - what the files of meshes share. */
#ifndef SG_SCENE_MESH_PRIV_H
#define SG_SCENE_MESH_PRIV_H

#include "scene/assets.h"
#include "scene/mesh.h"

/** A mesh in the making. */
typedef struct {
    const sg_scene *scene;
    sg_mesh *mesh;
    const sg_assets *assets; /* NULL: none */
    unsigned radial; /* at this level of detail */
    sg_error *err;
} sg_mesh_builder;

/** Room for so many more; then the functions below cannot fail. @return SG_OK, SG_ENUMERIC (over 2^32), SG_ENOMEM */
sg_status sg_mesh_reserve(sg_mesh_builder *b, size_t vertices, size_t normals, size_t uvs, size_t faces);
uint32_t sg_mesh_add_vertex(sg_mesh_builder *b, const double *at);
uint32_t sg_mesh_add_normal(sg_mesh_builder *b, const double *direction); /* of length 1 */
uint32_t sg_mesh_add_uv(sg_mesh_builder *b, double u, double v);
void sg_mesh_add_face(sg_mesh_builder *b, const sg_mesh_corner *corners, uint32_t n, uint32_t group);

/** The group of a primitive, made when it is the first of its kind. @return SG_OK, SG_ENOMEM */
sg_status sg_mesh_group_of(sg_mesh_builder *b, const sg_primitive *p, uint32_t *group);

/** The same for a part of a mesh file that has a material of its own. */
sg_status sg_mesh_group_of_part(sg_mesh_builder *b, const sg_primitive *p, uint32_t part, sg_mesh_material own,
                                uint32_t *group);

/** Is a length too short beside the place and the size of the primitive? */
bool sg_mesh_thin(const sg_primitive *p, double length);

/** Boxes, prisms, hip roofs, polygons, labels. @return SG_OK, SG_ENUMERIC, SG_ENOMEM */
sg_status sg_mesh_add_flat(sg_mesh_builder *b, const sg_primitive *p);
/** A mesh from a file, scaled to fill the scope. */
sg_status sg_mesh_add_file(sg_mesh_builder *b, const sg_primitive *p, const sg_obj *obj);
/** Cylinders, cones, spheres. */
sg_status sg_mesh_add_round(sg_mesh_builder *b, const sg_primitive *p);
/** All segments of the scene. */
sg_status sg_mesh_add_segments(sg_mesh_builder *b);

/** A ring of a round surface: the ellipse centre + a cos t + b sin t. The axis runs in the direction a x b. */
typedef struct {
    double centre[3], a[3], b[3];
    double v;       /* texture coordinate */
    uint32_t group; /* of the faces from here to the next ring */
} sg_mesh_ring;

/** The closed surface along n >= 2 rings: a first or last ring without extent is a point, others get a lid. */
sg_status sg_mesh_add_rings(sg_mesh_builder *b, const sg_mesh_ring *rings, size_t n);

/** Which segment continues each primitive of the scene. */
typedef struct {
    uint32_t *next; /* [primitives] SG_NONE: none */
    bool *inner;    /* [primitives] it continues one */
} sg_mesh_strands;

/** @return SG_OK, SG_ENOMEM; on success free it with sg_mesh_strands_clear() */
sg_status sg_mesh_strands_find(const sg_scene *scene, sg_mesh_strands *s, sg_error *err);
void sg_mesh_strands_clear(sg_mesh_strands *s);

#endif
