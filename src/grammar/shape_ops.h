/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shape_ops.h - the shape operations of bodies: names and arguments. What they do is the interpreter's affair. */
#ifndef SG_GRAMMAR_SHAPE_OPS_H
#define SG_GRAMMAR_SHAPE_OPS_H

#include <stdint.h>

typedef enum {
    SG_SHAPE_DRAW,     /* length: a segment from the turtle's place, which moves to its end */
    SG_SHAPE_MOVE,     /* length: the same without a segment */
    SG_SHAPE_TURN,     /* degrees about the turtle's up */
    SG_SHAPE_PITCH,    /* degrees about its left */
    SG_SHAPE_ROLL,     /* degrees about its heading */
    SG_SHAPE_WIDTH,    /* of the segments that follow */
    SG_SHAPE_TROPISM,  /* x, y, z, strength: after each segment the heading bends towards (x, y, z) */
    SG_SHAPE_TRANSLATE, /* x, y, z in the scope's axes */
    SG_SHAPE_ROTATE,   /* degrees about the scope's x, y, z, in this order */
    SG_SHAPE_SCALE,    /* factors of the scope's size */
    SG_SHAPE_SIZE,     /* the scope's size */
    SG_SHAPE_EXTRUDE,  /* height: the face becomes a solid */
    SG_SHAPE_FLAT_ROOF,
    SG_SHAPE_GABLE_ROOF, /* slope in degrees [, overhang] */
    SG_SHAPE_HIP_ROOF,
    SG_SHAPE_INSERT,   /* primitive or mesh by name: fills the scope */
    SG_SHAPE_SET_MATERIAL, /* by name or colour */
    SG_SHAPE_SET_LABEL,    /* a declared label: of the primitives that follow */
    SG_SHAPE_COMPONENTS,   /* a block of SG_OP_PART, one a face selector (in sg_op.shape) */
    SG_SHAPE_POLYGON,  /* x, y of three to twelve corners, as shares of the face: the face becomes this polygon */
    SG_SHAPE_COUNT,
} sg_shape_op;

/** Face selectors of `components`. A face goes to the first part that takes it. */
typedef enum {
    SG_FACE_FRONT,
    SG_FACE_BACK,
    SG_FACE_LEFT,
    SG_FACE_RIGHT,
    SG_FACE_TOP,
    SG_FACE_BOTTOM,
    SG_FACE_SIDE, /* front, back, left, right */
    SG_FACE_ALL,
    SG_FACE_COUNT,
} sg_face;

/** Kinds of arguments, one character each: 'n' number, 's' string (the value is an index for sg_grammar_string()),
 *  'c' colour 0xRRGGBB or string (which of them: SG_SHAPE_STRING_ARG is added to indices), 'l' label (its sg_sym). */
typedef struct {
    const char *name;
    const char *args;
    uint32_t required; /* those after these may be left out */
} sg_shape_info;

/** Added to the string index where a colour or a string may stand: colours are below it. */
#define SG_SHAPE_STRING_ARG 0x1000000

const sg_shape_info *sg_shape_op_info(sg_shape_op op);
/** SG_SHAPE_COUNT when no operation (that is written NAME(...)) has this name. */
sg_shape_op sg_shape_op_find(const char *name);
const char *sg_face_name(sg_face face);
/** SG_FACE_COUNT when there is none. */
sg_face sg_face_find(const char *name);

#endif
