/* SPDX-License-Identifier: GPL-3.0-or-later */
/* operators.h - the operators and functions of expressions, shared by syntax tree, code and printer. */
#ifndef SG_GRAMMAR_OPERATORS_H
#define SG_GRAMMAR_OPERATORS_H

#include <stdint.h>

typedef enum {
    SG_E_OR,
    SG_E_AND,
    SG_E_NOT,
    SG_E_LT,
    SG_E_LE,
    SG_E_GT,
    SG_E_GE,
    SG_E_EQ,
    SG_E_NE,
    SG_E_ADD,
    SG_E_SUB,
    SG_E_MUL,
    SG_E_DIV,
    SG_E_NEG,
    SG_E_POW,
    SG_E_IF, /* if(condition, then, else) */
    /* functions, written NAME(...) */
    SG_E_ABS,
    SG_E_SIGN,
    SG_E_FLOOR,
    SG_E_CEIL,
    SG_E_ROUND,
    SG_E_SQRT,
    SG_E_EXP,
    SG_E_LOG,
    SG_E_SIN,
    SG_E_COS,
    SG_E_TAN,
    SG_E_ASIN,
    SG_E_ACOS,
    SG_E_ATAN,
    SG_E_ATAN2,
    SG_E_HYPOT,
    SG_E_MOD,
    SG_E_MIN,
    SG_E_MAX,
    SG_E_COUNT,
} sg_operator;

typedef struct {
    const char *name;
    uint32_t arity;
    int precedence; /* higher binds tighter; functions bind tightest */
} sg_operator_info;

const sg_operator_info *sg_operator_get(sg_operator op);
/** The function of this name, SG_E_COUNT when there is none. */
sg_operator sg_operator_find(const char *name);
/** Value of an operator on its arguments (those over its arity are ignored). Booleans are 1 and 0. */
double sg_operator_apply(sg_operator op, double a, double b, double c);

#endif
