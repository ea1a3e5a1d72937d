/* SPDX-License-Identifier: GPL-3.0-or-later */
/* scene_roof.c - the faces of a scope, and the roofs that stand on one.
 * Source: roofs and component splits as in Mueller, Wonka, Haegler, Ulmer and Van Gool, "Procedural modeling of
 * buildings" (2006), section 3. */
#include "scene/scene_priv.h"

#include "grammar/shape_ops.h"
#include "scene/skeleton.h"

#include <math.h>

bool sg_scene_face(const sg_scene_state *s, int face, sg_scene_state *out)
{
    /* The origin as shares of the size, the axes for sg_frame_permute(), the axes of the scope that give width and
     * height. */
    static const struct {
        double at[3];
        int x, y, width, height, depth;
    } faces[SG_FACE_SIDE] = {
        [SG_FACE_FRONT] = {{0, 0, 1}, 1, 2, 0, 1, 2}, [SG_FACE_BACK] = {{1, 0, 0}, -1, 2, 0, 1, 2},
        [SG_FACE_LEFT] = {{0, 0, 0}, 3, 2, 2, 1, 0},  [SG_FACE_RIGHT] = {{1, 0, 1}, -3, 2, 2, 1, 0},
        [SG_FACE_TOP] = {{0, 1, 1}, 1, -3, 0, 2, 1},  [SG_FACE_BOTTOM] = {{0, 0, 0}, 1, 3, 0, 2, 1},
    };
    const double *size = s->size;
    const bool negative = face == SG_FACE_BACK || face == SG_FACE_LEFT || face == SG_FACE_BOTTOM;
    sg_scene_state_copy(out, s);
    out->joint = -1;
    out->size[0] = size[faces[face].width];
    out->size[1] = size[faces[face].height];
    out->size[2] = 0;
    out->frame = sg_frame_permute(&s->frame, faces[face].x, faces[face].y);
    sg_frame_point(&s->frame, faces[face].at[0] * size[0], faces[face].at[1] * size[1], faces[face].at[2] * size[2],
                   out->frame.origin);
    return out->size[0] > 0 && out->size[1] > 0 && (size[faces[face].depth] > 0 || !negative);
}

/* The frame under a roof: y up from the face, z along the ridge, which follows the longer side. */
static void lay_ridge(const sg_scene_state *face, sg_primitive *p)
{
    const double w = face->size[0], h = face->size[1];
    if (w >= h) { /* the ridge follows the face's x */
        p->frame = sg_frame_permute(&p->frame, 2, 3);
        p->size[0] = h;
        p->size[2] = w;
    } else { /* its y, backwards */
        sg_frame_move(&p->frame, 0, h, 0);
        p->frame = sg_frame_permute(&p->frame, 1, 3);
        p->size[0] = w;
        p->size[2] = h;
    }
}

static sg_status add_pitched(sg_scene_body *b, const sg_scene_state *face, double slope, bool hip)
{
    const double pi = 3.14159265358979323846;
    sg_primitive p = sg_scene_primitive(b, face, hip ? SG_PRIMITIVE_HIP : SG_PRIMITIVE_PRISM);
    if (slope >= 90)
        return sg_scene_fail(b, "a roof of 90 degrees or more");
    lay_ridge(face, &p);
    p.size[1] = p.size[0] / 2 * tan(slope * pi / 180);
    const double gable[3][2] = {{0, 0}, {p.size[0], 0}, {p.size[0] / 2, p.size[1]}};
    p.ncorners = hip ? 0 : 3;
    return sg_scene_add(b, &p, gable);
}

static sg_status add_flat(sg_scene_body *b, const sg_scene_state *face, double height)
{
    sg_scene_state slab;
    sg_scene_state_copy(&slab, face);
    slab.size[2] = fmax(0, height);
    return sg_scene_add_scope(b, &slab, SG_PRIMITIVE_POLYGON);
}

/* Its skeleton is found here, so that what has none is told with its rule, and again where it becomes a mesh. */
static sg_status add_over_polygon(sg_scene_body *b, const sg_op *op, double slope, double overhang,
                                  sg_scene_state *face)
{
    const double pi = 3.14159265358979323846;
    sg_skeleton skeleton;
    if (slope >= 90)
        return sg_scene_fail(b, "a roof of 90 degrees or more");
    if (overhang != 0 && !sg_scene_widen_polygon(face, overhang))
        return sg_scene_fail(b, "the edges of a roof over a polygon cross or touch: its overhang is too large");
    if (!(slope > 0))
        return add_flat(b, face, 0);
    sg_primitive p = sg_scene_primitive(b, face, SG_PRIMITIVE_HIP);
    double corners[SG_PRIMITIVE_CORNERS][2];
    p.ncorners = face->ncorners;
    sg_scene_corners_of(face, corners);
    if (!sg_skeleton_find((const double(*)[2])corners, p.ncorners, &skeleton))
        return sg_scene_fail(b, "a roof over a polygon that has no straight skeleton");
    if (op->shape == SG_SHAPE_GABLE_ROOF &&
        sg_skeleton_raise_gables((const double(*)[2])corners, p.ncorners, &skeleton) > 0)
        p.radius[1] = 1;
    p.radius[0] = tan(slope * pi / 180);
    p.size[2] = skeleton.height * p.radius[0];
    return sg_scene_add(b, &p, (const double(*)[2])corners);
}

/* A roof stands on a face, or on the top of a scope that has depth; an overhang widens it on all sides. */
sg_status sg_scene_add_roof(sg_scene_body *b, const sg_op *op, const double *args, const sg_scene_state *s)
{
    sg_scene_state face;
    if (!sg_scene_base(s, &face))
        return SG_OK;
    if (op->shape == SG_SHAPE_FLAT_ROOF)
        return add_flat(b, &face, op->nargs > 0 ? args[0] : 0);
    const double overhang = op->nargs > 1 ? args[1] : 0;
    if (face.ncorners > 0)
        return add_over_polygon(b, op, args[0], overhang, &face);
    sg_frame_move(&face.frame, -overhang, -overhang, 0);
    for (int i = 0; i < 2; i++)
        face.size[i] += 2 * overhang;
    if (!(face.size[0] > 0 && face.size[1] > 0))
        return SG_OK;
    if (!(args[0] > 0))
        return add_flat(b, &face, 0);
    return add_pitched(b, &face, args[0], op->shape == SG_SHAPE_HIP_ROOF);
}
