/* SPDX-License-Identifier: GPL-3.0-or-later */
/* scene_shape.c - the shape operations: those that change the state, and those that add a primitive.
 * Sources: Prusinkiewicz and Lindenmayer, The Algorithmic Beauty of Plants (1990), section 1.5 (turtle in space)
 * and 2.3.1 (tropism); Mueller, Wonka, Haegler, Ulmer and Van Gool, "Procedural modeling of buildings" (2006). */
#include "scene/scene_priv.h"

#include "core/array.h"
#include "grammar/shape_ops.h"

#include <math.h>
#include <string.h>

enum { MAX_ARGS = 2 * SG_PRIMITIVE_CORNERS };

static const double degree = 0.017453292519943295;

sg_primitive sg_scene_primitive(const sg_scene_body *b, const sg_scene_state *s, sg_primitive_kind kind)
{
    sg_primitive p;
    memset(&p, 0, sizeof p);
    p.frame = s->frame;
    p.kind = kind;
    memcpy(p.size, s->size, sizeof p.size);
    p.material = s->material;
    p.label = s->label;
    p.node = (uint32_t)b->node;
    p.mesh = SG_NONE;
    return p;
}

static bool all_finite(const double *x, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (!isfinite(x[i]))
            return false;
    return true;
}

sg_status sg_scene_add(sg_scene_body *b, const sg_primitive *p, const double (*corners)[2])
{
    if (b->unplaced > 0)
        return SG_OK;
    if (!all_finite(p->frame.origin, 3) || !all_finite(p->size, 3) || !all_finite(p->radius, 2) ||
        (p->ncorners > 0 && !all_finite(corners[0], 2 * (size_t)p->ncorners)))
        return sg_scene_fail(b, "a place or a size grows beyond all numbers");
    SG_TRY(sg_scene_count(b));
    return sg_scene_put(b->scene, p, corners, b->err);
}

/* Which face stands for a scope that is flat. */
static int flat_face(const sg_scene_state *s)
{
    return !(s->size[2] > 0) ? SG_FACE_FRONT : !(s->size[1] > 0) ? SG_FACE_TOP : SG_FACE_RIGHT;
}

static sg_status add_polygon(sg_scene_body *b, const sg_scene_state *s)
{
    sg_primitive p = sg_scene_primitive(b, s, s->size[2] > 0 ? SG_PRIMITIVE_PRISM : SG_PRIMITIVE_POLYGON);
    double corners[SG_PRIMITIVE_CORNERS][2];
    p.ncorners = s->ncorners;
    sg_scene_corners_of(s, corners);
    return s->size[0] > 0 && s->size[1] > 0 ? sg_scene_add(b, &p, (const double(*)[2])corners) : SG_OK;
}

/* A label's rectangle is known by its size. */
static sg_status add_rectangle(sg_scene_body *b, const sg_scene_state *face, sg_primitive_kind kind)
{
    sg_primitive p = sg_scene_primitive(b, face, kind);
    const double w = face->size[0], h = face->size[1], corners[4][2] = {{0, 0}, {w, 0}, {w, h}, {0, h}};
    p.ncorners = kind == SG_PRIMITIVE_POLYGON ? 4 : 0;
    return sg_scene_add(b, &p, corners);
}

sg_status sg_scene_add_scope(sg_scene_body *b, const sg_scene_state *s, sg_primitive_kind flat)
{
    sg_primitive p = sg_scene_primitive(b, s, SG_PRIMITIVE_BOX);
    if (s->ncorners > 0)
        return add_polygon(b, s);
    if (!(s->size[0] > 0 && s->size[1] > 0 && s->size[2] > 0)) {
        sg_scene_state face;
        if (!sg_scene_face(s, flat_face(s), &face))
            return SG_OK;
        return add_rectangle(b, &face, flat);
    }
    return sg_scene_add(b, &p, NULL);
}

/* After a segment the torque e H x T turns the heading towards T, by e |H x T| radians (section 2.3.1). */
static void bend(sg_scene_state *s)
{
    double torque[3];
    sg_vec_cross(s->frame.y, s->tropism, torque);
    const double angle = s->strength * sg_vec_length(torque);
    if (angle != 0 && sg_vec_normalize(torque))
        sg_frame_turn(&s->frame, torque, angle);
}

/* A negative length draws backwards. The first segment of a chain is a cylinder, the others begin as wide as the one
 * before them ends. */
static sg_status draw(sg_scene_body *b, double length, sg_scene_state *s)
{
    sg_primitive p = sg_scene_primitive(b, s, SG_PRIMITIVE_SEGMENT);
    if (length == 0)
        return SG_OK;
    if (length < 0)
        p.frame = sg_frame_permute(&p.frame, -1, -2);
    p.size[0] = p.size[2] = 0;
    p.size[1] = fabs(length);
    p.radius[1] = s->width / 2;
    p.radius[0] = s->joint >= 0 ? s->joint : p.radius[1];
    sg_frame_point(&p.frame, 0, p.size[1], 0, s->frame.origin); /* as who continues it finds its end */
    s->joint = p.radius[1];
    SG_TRY(sg_scene_add(b, &p, NULL));
    bend(s);
    return SG_OK;
}

static void move(sg_scene_state *s, double x, double y, double z)
{
    sg_frame_move(&s->frame, x, y, z);
    if (x != 0 || y != 0 || z != 0)
        s->joint = -1;
}

/* Sizes below 0 are 0. */
static void set_size(sg_scene_state *s, const double *size, bool times)
{
    for (int i = 0; i < 3; i++)
        s->size[i] = fmax(0, times ? s->size[i] * size[i] : size[i]);
}

/* Outwards of a face; of a scope without height (a lot) upwards. A negative height goes the other way. */
static void extrude(sg_scene_state *s, double height)
{
    const int axis = s->size[1] > 0 || !(s->size[2] > 0) ? 2 : 1;
    if (height < 0)
        sg_frame_move(&s->frame, 0, axis == 1 ? height : 0, axis == 2 ? height : 0);
    s->size[axis] = fabs(height);
    s->joint = -1;
}

static void rotate(sg_scene_state *s, const double *degrees)
{
    sg_frame_turn(&s->frame, s->frame.x, degrees[0] * degree);
    sg_frame_turn(&s->frame, s->frame.y, degrees[1] * degree);
    sg_frame_turn(&s->frame, s->frame.z, degrees[2] * degree);
}

const sg_scene_solid *sg_scene_solid_find(const char *name)
{
    static const sg_scene_solid known[] = {{"box", SG_PRIMITIVE_BOX, {0, 0}},
                                           {"cylinder", SG_PRIMITIVE_CYLINDER, {1, 1}},
                                           {"cone", SG_PRIMITIVE_CYLINDER, {1, 0}},
                                           {"sphere", SG_PRIMITIVE_SPHERE, {0, 0}}};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (strcmp(name, known[i].name) == 0)
            return known + i;
    return NULL;
}

static sg_status insert(sg_scene_body *b, uint32_t name, const sg_scene_state *s)
{
    const sg_scene_solid *solid = sg_scene_solid_find(sg_grammar_string(b->d->grammar, name));
    if (solid != NULL && solid->kind == SG_PRIMITIVE_BOX)
        return sg_scene_add_scope(b, s, SG_PRIMITIVE_POLYGON);
    sg_primitive p = sg_scene_primitive(b, s, solid != NULL ? solid->kind : SG_PRIMITIVE_MESH);
    if (solid != NULL)
        memcpy(p.radius, solid->radius, sizeof p.radius);
    else
        p.mesh = name;
    const int nflat = !(s->size[0] > 0) + !(s->size[1] > 0) + !(s->size[2] > 0);
    return nflat > (solid == NULL) ? SG_OK : sg_scene_add(b, &p, NULL);
}

static sg_status eval_args(sg_scene_body *b, const sg_op *op, double *args)
{
    for (uint32_t i = 0; i < op->nargs; i++)
        args[i] = sg_grammar_eval(b->d->grammar, op->args[i], b->frame, b->d->nodes[b->node].depth);
    return all_finite(args, op->nargs) ? SG_OK : sg_scene_fail(b, "a length or an angle is no finite number");
}

sg_status sg_scene_read_shape(sg_scene_body *b, const sg_op *op, sg_scene_state *s)
{
    double a[MAX_ARGS];
    SG_TRY(eval_args(b, op, a));
    switch ((sg_shape_op)op->shape) {
    case SG_SHAPE_DRAW:
        return draw(b, a[0], s);
    case SG_SHAPE_MOVE:
        move(s, 0, a[0], 0);
        break;
    case SG_SHAPE_TURN:
        sg_frame_turn(&s->frame, s->frame.z, a[0] * degree);
        break;
    case SG_SHAPE_PITCH: /* about left, which is -x */
        sg_frame_turn(&s->frame, s->frame.x, -a[0] * degree);
        break;
    case SG_SHAPE_ROLL:
        sg_frame_turn(&s->frame, s->frame.y, a[0] * degree);
        break;
    case SG_SHAPE_WIDTH:
        s->width = fmax(0, a[0]);
        break;
    case SG_SHAPE_TROPISM:
        memcpy(s->tropism, a, sizeof s->tropism);
        s->strength = a[3];
        break;
    case SG_SHAPE_TRANSLATE:
        move(s, a[0], a[1], a[2]);
        break;
    case SG_SHAPE_ROTATE:
        rotate(s, a);
        break;
    case SG_SHAPE_SCALE:
    case SG_SHAPE_SIZE:
        set_size(s, a, op->shape == SG_SHAPE_SCALE);
        break;
    case SG_SHAPE_EXTRUDE:
        extrude(s, a[0]);
        break;
    case SG_SHAPE_FLAT_ROOF:
    case SG_SHAPE_GABLE_ROOF:
    case SG_SHAPE_HIP_ROOF:
        return sg_scene_add_roof(b, op, a, s);
    case SG_SHAPE_POLYGON:
        return sg_scene_make_polygon(b, a, op->nargs, s);
    case SG_SHAPE_INSERT:
        return insert(b, (uint32_t)a[0], s);
    case SG_SHAPE_SET_MATERIAL:
        s->material = (uint32_t)a[0];
        break;
    case SG_SHAPE_SET_LABEL:
        s->label = (uint32_t)a[0];
        break;
    case SG_SHAPE_COMPONENTS:
    case SG_SHAPE_COUNT:
        break;
    }
    return SG_OK;
}
