/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shape_ops.c - the table of shape operations. */
#include "config.h"

#include "grammar/shape_ops.h"

#include <string.h>

static const sg_shape_info operations[SG_SHAPE_COUNT] = {
    [SG_SHAPE_DRAW] = {"draw", "n", 1},
    [SG_SHAPE_MOVE] = {"move", "n", 1},
    [SG_SHAPE_TURN] = {"turn", "n", 1},
    [SG_SHAPE_PITCH] = {"pitch", "n", 1},
    [SG_SHAPE_ROLL] = {"roll", "n", 1},
    [SG_SHAPE_WIDTH] = {"width", "n", 1},
    [SG_SHAPE_TROPISM] = {"tropism", "nnnn", 4},
    [SG_SHAPE_TRANSLATE] = {"translate", "nnn", 3},
    [SG_SHAPE_ROTATE] = {"rotate", "nnn", 3},
    [SG_SHAPE_SCALE] = {"scale", "nnn", 3},
    [SG_SHAPE_SIZE] = {"size", "nnn", 3},
    [SG_SHAPE_EXTRUDE] = {"extrude", "n", 1},
    [SG_SHAPE_FLAT_ROOF] = {"flat_roof", "n", 0},
    [SG_SHAPE_GABLE_ROOF] = {"gable_roof", "nn", 1},
    [SG_SHAPE_HIP_ROOF] = {"hip_roof", "nn", 1},
    [SG_SHAPE_INSERT] = {"insert", "s", 1},
    [SG_SHAPE_SET_MATERIAL] = {"set_material", "c", 1},
    [SG_SHAPE_SET_LABEL] = {"set_label", "l", 1},
    [SG_SHAPE_COMPONENTS] = {"components", "", 0},
    [SG_SHAPE_POLYGON] = {"polygon", "nnnnnnnnnnnnnnnnnnnnnnnn", 6},
};

static const char *const faces[SG_FACE_COUNT] = {
    [SG_FACE_FRONT] = "front", [SG_FACE_BACK] = "back",     [SG_FACE_LEFT] = "left", [SG_FACE_RIGHT] = "right",
    [SG_FACE_TOP] = "top",     [SG_FACE_BOTTOM] = "bottom", [SG_FACE_SIDE] = "side", [SG_FACE_ALL] = "all",
};

const sg_shape_info *sg_shape_op_info(sg_shape_op op)
{
    return &operations[op];
}

sg_shape_op sg_shape_op_find(const char *name)
{
    for (int i = 0; i < SG_SHAPE_COUNT; i++)
        if (i != SG_SHAPE_COMPONENTS && strcmp(operations[i].name, name) == 0)
            return (sg_shape_op)i;
    return SG_SHAPE_COUNT;
}

const char *sg_face_name(sg_face face)
{
    return faces[face];
}

sg_face sg_face_find(const char *name)
{
    for (int i = 0; i < SG_FACE_COUNT; i++)
        if (strcmp(faces[i], name) == 0)
            return (sg_face)i;
    return SG_FACE_COUNT;
}
