/* SPDX-License-Identifier: GPL-3.0-or-later */
/* scene.h - a derivation as a flat list of primitives in space.
 *
 * Space: right-handed, y up, lengths in metres where they have a unit. Turtle and scope share one frame: the turtle
 * stands at the scope's origin, heads along the scope's y, its up is the scope's z and its left is -x. The scope is the
 * box from the origin to `size` along the axes; a scope of depth 0 (no size along z) is a face that looks along z.
 *
 * A successor gets a copy of the state where it stands; what its own body does to that is not seen by what follows. So
 * a subtree depends on the state it inherits alone, and the scene is a concatenation of slices: the primitives of a
 * body, then those of its children, one after the other. Tied siblings, and the parts of `components` that take several
 * faces, are placed at each occurrence.
 *
 * What has no extent is not placed: a box needs three sizes (with two it is a rectangle), a segment a length. Parts
 * that have no size, or begin behind the end of their scope, are passed over with all that stands in them; larger ones
 * are cut off there. Open nodes and nodes cut at the depth limit are empty. */
#ifndef SG_SCENE_SCENE_H
#define SG_SCENE_SCENE_H

#include "derivation/derivation.h"
#include "scene/frame.h"

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

typedef enum {
    SG_PRIMITIVE_SEGMENT,  /* from the origin along y, size[1] long; radius[0] at its start, radius[1] at its end. A
                              segment whose start and radius are another's end continues it */
    SG_PRIMITIVE_BOX,      /* fills size */
    SG_PRIMITIVE_CYLINDER, /* fills size, axis along y (elliptic where x and z differ); radius[] are shares of the half
                              extents at bottom and top: {1, 1} a cylinder, {1, 0} a cone */
    SG_PRIMITIVE_SPHERE,   /* ellipsoid that fills size */
    SG_PRIMITIVE_PRISM,    /* the polygon of its corners in x and y, extruded along z by size[2] */
    SG_PRIMITIVE_HIP, /* hip roof over size[0] by size[2] with size[2] >= size[0], size[1] high: the ridge runs along z,
                         size[0] / 2 from both ends; a pyramid when it has no length. With corners: over the polygon
                         of its corners in x and y, which has a straight skeleton (skeleton.h); it rises along z, radius[0] for
                         each unit of distance from an edge, to size[2]; with radius[1] its ends are gables */
    SG_PRIMITIVE_POLYGON, /* its corners, at z = 0, looks along z */
    SG_PRIMITIVE_LABEL,   /* a label's rectangle, size[0] by size[1], at z = 0, looks along z */
    SG_PRIMITIVE_MESH,    /* the mesh named `mesh`, scaled to fill size */
    SG_PRIMITIVE_COUNT,
} sg_primitive_kind;

enum { SG_PRIMITIVE_CORNERS = 12 };

/** Convex, but for meshes, and where its corners turn to the right somewhere: those polygons are simple. Fields that a kind
 *  has no use for are 0. Corners stand in the scene, so that the many primitives without any are small; sg_primitive_corners()
 *  gives them, sg_scene_append() takes primitives to another scene. */
typedef struct {
    sg_frame frame;
    double size[3];
    double radius[2];
    uint32_t kind, ncorners;
    uint32_t material; /* SG_NONE, or what set_material() set: see sg_scene_material() */
    sg_sym label;      /* SG_NONE, or a symbol of kind SG_SYMBOL_LABEL */
    uint32_t node;     /* of the derivation, whose body made it */
    uint32_t mesh;     /* for sg_grammar_string() */
    size_t corner;     /* the first one, in the scene; 0 when there is none */
} sg_primitive;

/** What a body inherits. */
typedef struct {
    sg_frame frame;
    double size[3];
    double width;      /* diameter of segments to come */
    double joint;      /* radius at the end of the segment that ends here; -1: none does */
    double tropism[3]; /* direction T */
    double strength;   /* susceptibility e, radians for each unit of |H x T| */
    uint32_t material, label;
    uint32_t ncorners; /* 0: the scope is a box */
    uint32_t unused;   /* 0: no padding */
    double corner[SG_PRIMITIVE_CORNERS][2]; /* of the polygon that the scope is across z, as shares of its size: simple,
                                               counterclockwise, from side to side; not set beyond ncorners */
} sg_scene_state;

static inline void sg_scene_state_copy(sg_scene_state *to, const sg_scene_state *from)
{
    memcpy(to, from, offsetof(sg_scene_state, corner));
    if (from->ncorners > 0)
        memcpy(to->corner, from->corner, from->ncorners * sizeof from->corner[0]);
}

/** Bit for bit. */
bool sg_scene_state_equal(const sg_scene_state *a, const sg_scene_state *b);

typedef struct {
    double size[3];    /* of the first scope */
    double width;      /* of segments before a `width` */
    size_t max_places; /* symbols and primitives: a scene that would have more is an error. Tied siblings are placed at
                          every occurrence, so a small derivation can ask for very many */
} sg_scene_opts;

#define SG_SCENE_OPTS_INIT {{1, 1, 1}, 0.1, (size_t)1 << 22}

/** A node where it was placed. Places stand in pre-order; those of a subtree follow each other. */
typedef struct {
    uint32_t node;
    uint32_t parent;      /* distance back to the place of the parent; 0 for the first place of a slice */
    uint32_t length;      /* places in the subtree, itself included */
    size_t first;         /* primitive of the subtree, in the scene */
    sg_scene_state state; /* that it inherited */
} sg_scene_place;

/** States of all nodes that are placed. Without ties, components and parts passed over place i is node i's. A zeroed
 *  one is empty. */
typedef struct {
    sg_scene_place *places;
    size_t n, capacity;
} sg_scene_states;

typedef struct {
    const sg_grammar *grammar; /* borrowed from the derivation */
    sg_primitive *items;
    size_t n, capacity;
    double (*corners)[2]; /* of all polygons, each counterclockwise */
    size_t ncorners, corners_capacity;
    struct sg_scene_work *work; /* work space, kept from one interpretation to the next */
} sg_scene;

/** [ncorners] of a primitive of the scene, in x and y of its frame; NULL when it has none. */
static inline const double (*sg_primitive_corners(const sg_scene *scene, const sg_primitive *p))[2]
{
    return p->ncorners > 0 ? (const double(*)[2])scene->corners + p->corner : NULL;
}

/** Are two primitives the same bit for bit, their corners too, wherever these stand? */
bool sg_primitive_equal(const sg_scene *scene, const sg_primitive *p, const sg_scene *other, const sg_primitive *q);
/** Append primitives first..first+n-1 of another scene than `to`, their corners too.
 *  @return SG_OK, SG_ENOMEM; on failure `to` is as it was */
sg_status sg_scene_append(sg_scene *to, const sg_scene *from, size_t first, size_t n, sg_error *err);

/** The state that the root inherits. */
sg_scene_state sg_scene_first_state(const sg_scene_opts *opts);

/** Interpret a derivation. The scene is emptied first and keeps its memory; start from a zeroed one and free it with
 *  sg_scene_clear(). It takes no recursion over the tree, whatever its depth.
 *  @return SG_OK, SG_EINVAL (no node), SG_ENUMERIC (a size, length or angle is not finite, a part's size is negative, a
 *  roof of 90 degrees or more, more than max_places, children that do not fit a rule, a polygon whose sides cross or that
 *  has no such roof; the sentence tells file, line and derivation path), SG_ENOMEM; on failure the scene is empty */
sg_status sg_scene_interpret(const sg_derivation *d, const sg_scene_opts *opts, sg_scene *scene, sg_error *err);

/** Interpret the subtree of `node` from the state that it inherits, appending to the scene. The slices of the places of
 *  a derivation are, bit for bit, what interpreting all gives. So after a splice the slices of the places of that node
 *  are interpreted anew, and the rest stands; only the node numbers behind the splice shift. max_places counts what is
 *  placed by this call.
 *  @param states  NULL, or: its places are appended, `first` counted in the scene
 *  @return as above, SG_EINVAL also for no such node; on failure scene and states are as they were */
sg_status sg_scene_interpret_slice(const sg_derivation *d, size_t node, const sg_scene_state *state,
                                   const sg_scene_opts *opts, sg_scene *scene, sg_scene_states *states, sg_error *err);

void sg_scene_clear(sg_scene *scene);
void sg_scene_states_clear(sg_scene_states *states);

/** A primitive's material: its colour 0xRRGGBB and, when it was set by name, that name (else NULL). The colour of a
 *  name is the one that it was declared with. Where there is none the label's is taken, and a light grey where there is
 *  no label. */
uint32_t sg_scene_material(const sg_grammar *g, const sg_primitive *p, const char **name);

#endif
