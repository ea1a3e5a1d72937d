/* SPDX-License-Identifier: GPL-3.0-or-later */
/* scene_priv.h - the interpretation of one body: what the files of scenes share. */
#ifndef SG_SCENE_SCENE_PRIV_H
#define SG_SCENE_SCENE_PRIV_H

#include "scene/scene.h"
#include "scene/stored_children.h"

/** A child to be placed, on the stack of the walk. */
typedef struct {
    size_t node, parent; /* place of the parent; SIZE_MAX: none */
    sg_scene_state state;
} sg_scene_item;

struct sg_scene_work {
    sg_scene_item *items;
    size_t n, capacity;
    sg_stored_children children;
};

/** The body of one node, while it is interpreted. */
typedef struct {
    const sg_derivation *d;
    size_t node, place;
    const sg_rule *r;
    const double *frame; /* arguments and draw values */
    sg_scene *scene;
    size_t limit;   /* of primitives and places together */
    size_t nplaced; /* so far, children on the stack included */
    bool in_repeat;
    unsigned unplaced; /* blocks passed over that this one stands in */
    sg_error *err;
} sg_scene_body;

/** Interpret the body of b->node from this state: append its primitives to the scene, its children to the stack in
 *  order.
 *  @return SG_OK, SG_ENUMERIC, SG_ENOMEM */
sg_status sg_scene_read_body(sg_scene_body *b, const sg_scene_state *state);

/** A solid that `insert` knows by its name. */
typedef struct {
    const char *name;
    sg_primitive_kind kind;
    double radius[2];
} sg_scene_solid;

/** NULL: this is the name of a mesh file. */
const sg_scene_solid *sg_scene_solid_find(const char *name);

/** One shape operation other than components. @return SG_OK, SG_ENUMERIC, SG_ENOMEM */
sg_status sg_scene_read_shape(sg_scene_body *b, const sg_op *op, sg_scene_state *s);

/** flat_roof, gable_roof and hip_roof over the scope. @param args  [nargs] */
sg_status sg_scene_add_roof(sg_scene_body *b, const sg_op *op, const double *args, const sg_scene_state *s);

/** The face that things are built on: the top of a box that has depth or no height, else the scope itself; of a polygon
 *  the end that looks along z. @return false when it has no area */
bool sg_scene_base(const sg_scene_state *s, sg_scene_state *out);

/** Faces of a scope that is a box or a polygon, and of which kind (front to bottom) each of them is. The walls of a polygon
 *  look to the nearest of front (-y), right, back and left; top and bottom are its ends along z and against it. */
size_t sg_scene_face_count(const sg_scene_state *s);
int sg_scene_face_kind(const sg_scene_state *s, size_t k);
/** @return false when it has no area, or is the back of a scope that is flat */
bool sg_scene_face_at(const sg_scene_state *s, size_t k, sg_scene_state *out);

enum { SG_SCENE_FACES = SG_PRIMITIVE_CORNERS + 2 };

/** The operation `polygon`: the scope becomes a face of this shape. @param args  [nargs] shares of the base
 *  @return SG_OK, SG_ENUMERIC (its sides cross or touch) */
sg_status sg_scene_make_polygon(sg_scene_body *b, const double *args, uint32_t nargs, sg_scene_state *s);
/** Widen a polygon on all sides, its corners kept sharp. @return false when its sides cross or touch then */
bool sg_scene_widen_polygon(sg_scene_state *s, double by);
/** Corners of the polygon, in lengths. @param corners  out [ncorners] */
void sg_scene_corners_of(const sg_scene_state *s, double (*corners)[2]);

/** The state on a face of a scope that is a box: x to the right as it is looked at, y up (of the top: to the back, of the bottom:
 *  to the front), z outwards.
 *  @param face  one of the six
 *  @return false when it has no area, or is the back of a scope that is flat */
bool sg_scene_face(const sg_scene_state *s, int face, sg_scene_state *out);

/** A primitive that takes frame, size, material and label from the state. */
sg_primitive sg_scene_primitive(const sg_scene_body *b, const sg_scene_state *s, sg_primitive_kind kind);
/** One more place or primitive. @return SG_OK, SG_ENUMERIC (too many) */
sg_status sg_scene_count(sg_scene_body *b);
/** Append it, unless b is unplaced. @param corners  [ncorners]; NULL when it has none
 *  @return SG_OK, SG_ENUMERIC (not finite, too many), SG_ENOMEM */
sg_status sg_scene_add(sg_scene_body *b, const sg_primitive *p, const double (*corners)[2]);
/** The same for any scene, whatever is in it. @return SG_OK, SG_ENOMEM */
sg_status sg_scene_put(sg_scene *scene, const sg_primitive *p, const double (*corners)[2], sg_error *err);
/** The scope as a box, or when it is flat along one axis as a rectangle of this kind (POLYGON or LABEL). */
sg_status sg_scene_add_scope(sg_scene_body *b, const sg_scene_state *s, sg_primitive_kind flat);

/** SG_ENUMERIC, with file, line and derivation path of the body before the sentence. */
sg_status sg_scene_fail(sg_scene_body *b, const char *what);

#endif
