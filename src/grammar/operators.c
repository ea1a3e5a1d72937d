/* SPDX-License-Identifier: GPL-3.0-or-later */
/* operators.c - names, precedences and meaning of operators and functions. */
#include "config.h"

#include "grammar/operators.h"

#include <math.h>
#include <string.h>

static const sg_operator_info table[SG_E_COUNT] = {
    [SG_E_OR] = {"or", 2, 1},        [SG_E_AND] = {"and", 2, 2},      [SG_E_NOT] = {"not", 1, 3},
    [SG_E_LT] = {"<", 2, 4},         [SG_E_LE] = {"<=", 2, 4},        [SG_E_GT] = {">", 2, 4},
    [SG_E_GE] = {">=", 2, 4},        [SG_E_EQ] = {"==", 2, 4},        [SG_E_NE] = {"!=", 2, 4},
    [SG_E_ADD] = {"+", 2, 5},        [SG_E_SUB] = {"-", 2, 5},        [SG_E_MUL] = {"*", 2, 6},
    [SG_E_DIV] = {"/", 2, 6},        [SG_E_NEG] = {"-", 1, 7},        [SG_E_POW] = {"^", 2, 8},
    [SG_E_IF] = {"if", 3, 9},        [SG_E_ABS] = {"abs", 1, 9},      [SG_E_SIGN] = {"sign", 1, 9},
    [SG_E_FLOOR] = {"floor", 1, 9},  [SG_E_CEIL] = {"ceil", 1, 9},    [SG_E_ROUND] = {"round", 1, 9},
    [SG_E_SQRT] = {"sqrt", 1, 9},    [SG_E_EXP] = {"exp", 1, 9},      [SG_E_LOG] = {"log", 1, 9},
    [SG_E_SIN] = {"sin", 1, 9},      [SG_E_COS] = {"cos", 1, 9},      [SG_E_TAN] = {"tan", 1, 9},
    [SG_E_ASIN] = {"asin", 1, 9},    [SG_E_ACOS] = {"acos", 1, 9},    [SG_E_ATAN] = {"atan", 1, 9},
    [SG_E_ATAN2] = {"atan2", 2, 9},  [SG_E_HYPOT] = {"hypot", 2, 9},  [SG_E_MOD] = {"mod", 2, 9},
    [SG_E_MIN] = {"min", 2, 9},      [SG_E_MAX] = {"max", 2, 9},
};

const sg_operator_info *sg_operator_get(sg_operator op)
{
    return &table[op];
}

sg_operator sg_operator_find(const char *name)
{
    for (int i = SG_E_IF + 1; i < SG_E_COUNT; i++)
        if (strcmp(table[i].name, name) == 0)
            return (sg_operator)i;
    return SG_E_COUNT;
}

/* The remainder takes the sign of the divisor, so that mod(x, n) runs through [0, n) for negative x too. */
static double modulo(double a, double b)
{
    return a - b * floor(a / b);
}

double sg_operator_apply(sg_operator op, double a, double b, double c)
{
    switch (op) {
    case SG_E_OR:
        return a != 0 || b != 0;
    case SG_E_AND:
        return a != 0 && b != 0;
    case SG_E_NOT:
        return a == 0;
    case SG_E_LT:
        return a < b;
    case SG_E_LE:
        return a <= b;
    case SG_E_GT:
        return a > b;
    case SG_E_GE:
        return a >= b;
    case SG_E_EQ:
        return a == b;
    case SG_E_NE:
        return a != b;
    case SG_E_ADD:
        return a + b;
    case SG_E_SUB:
        return a - b;
    case SG_E_MUL:
        return a * b;
    case SG_E_DIV:
        return a / b;
    case SG_E_NEG:
        return -a;
    case SG_E_POW:
        return pow(a, b);
    case SG_E_IF:
        return a != 0 ? b : c;
    case SG_E_ABS:
        return fabs(a);
    case SG_E_SIGN:
        return (a > 0) - (a < 0);
    case SG_E_FLOOR:
        return floor(a);
    case SG_E_CEIL:
        return ceil(a);
    case SG_E_ROUND:
        return round(a);
    case SG_E_SQRT:
        return sqrt(a);
    case SG_E_EXP:
        return exp(a);
    case SG_E_LOG:
        return log(a);
    case SG_E_SIN:
        return sin(a);
    case SG_E_COS:
        return cos(a);
    case SG_E_TAN:
        return tan(a);
    case SG_E_ASIN:
        return asin(a);
    case SG_E_ACOS:
        return acos(a);
    case SG_E_ATAN:
        return atan(a);
    case SG_E_ATAN2:
        return atan2(a, b);
    case SG_E_HYPOT:
        return hypot(a, b);
    case SG_E_MOD:
        return modulo(a, b);
    case SG_E_MIN:
        return a < b || isnan(a) ? a : b;
    case SG_E_MAX:
        return a > b || isnan(a) ? a : b;
    case SG_E_COUNT:
        break;
    }
    return NAN;
}
