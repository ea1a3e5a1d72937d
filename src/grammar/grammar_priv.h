/* SPDX-License-Identifier: GPL-3.0-or-later */
/* grammar_priv.h - the fields of a grammar. */
#ifndef SG_GRAMMAR_GRAMMAR_PRIV_H
#define SG_GRAMMAR_GRAMMAR_PRIV_H

#include "core/arena.h"
#include "grammar/ast.h"
#include "grammar/grammar.h"
#include "grammar/names.h"
#include "grammar/source.h"

/** An operand of code: where a value stands. The upper two bits say in which array, the others the index. */
typedef uint32_t sg_operand;

enum { SG_IN_CONSTANTS, SG_IN_FRAME, SG_IN_REGISTERS, SG_IN_DEPTH };
enum { SG_MAX_REGISTERS = 512, SG_MAX_CODE = 20000, SG_MAX_REPEAT = 1000000 };
/* In one rule: draws are found by their names one by one, tied successors compared with each other, and the work for drawn
 * sizes grows with the cube of their number. */
enum { SG_MAX_DRAWS = 1000, SG_MAX_TIED = 5000, SG_MAX_SIZES = 1000 };

#define SG_OPERAND(space, index) (((sg_operand)(space) << 30) | (sg_operand)(index))
#define SG_OPERAND_SPACE(o) ((o) >> 30)
#define SG_OPERAND_INDEX(o) ((o)&0x3FFFFFFFu)

/** register[to] = op(a, b, c) */
typedef struct {
    uint16_t op; /* sg_operator */
    uint16_t to;
    sg_operand a, b, c;
} sg_instruction;

/** A compiled expression: a run of instructions, then the operand that holds the result. */
typedef struct {
    uint32_t first, n;
    sg_operand result;
} sg_code;

struct sg_grammar {
    sg_arena *arena; /* everything is here, this struct too */
    sg_ast *ast;     /* for the printer */
    const char *name;
    const char *source; /* name of the file, for messages */
    const sg_source_part *imported; /* files whose texts belong to it too */
    size_t nimported;
    sg_symbol *symbols;
    size_t nsymbols;
    sg_rule *rules;
    size_t nrules;
    sg_sym start;
    double *start_args;
    size_t depth_limit;
    bool tied;
    size_t frame_size;
    sg_code *codes;
    size_t ncodes;
    sg_instruction *instructions;
    size_t ninstructions;
    double *constants;
    size_t nconstants;
    const char **strings; /* arguments of shape operations */
    size_t nstrings;
    uint32_t *string_colors; /* [nstrings] of declared materials 0xRRGGBB, of others SG_NONE */
    sg_names names; /* of symbols */
    const char *const *warnings;
    size_t nwarnings;
};

/** Build a grammar from a tree that lives in arena; takes over the arena when it succeeds.
 *  @return SG_OK, SG_EINPUT, SG_ENOMEM */
sg_status sg_grammar_build(sg_arena *arena, sg_ast *ast, const sg_source *source, sg_grammar **out, sg_error *err);

#endif
