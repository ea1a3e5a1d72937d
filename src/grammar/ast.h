/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ast.h - the syntax tree of a grammar: what the parser (and the split form) makes, what the builder compiles, and what
 * the printer prints. All of it lives in the arena of the grammar. Lists are linked, in the order of the file. */
#ifndef SG_GRAMMAR_AST_H
#define SG_GRAMMAR_AST_H

#include "core/arena.h"
#include "grammar/grammar.h"
#include "grammar/operators.h"
#include "grammar/source.h"

enum {
    SG_MAX_PARAMS = 1000, /* of a symbol or function: they are found by their names one by one */
    SG_MAX_NESTING = 256, /* of brackets */
    SG_MAX_HEIGHT = 1000, /* of an expression's tree: bounds the recursion of everything that walks it */
};

typedef enum {
    SG_AST_NUMBER,
    SG_AST_COLOR, /* value 0xRRGGBB */
    SG_AST_NAME,  /* a constant, parameter, draw; or a string */
    SG_AST_OPERATOR,
    SG_AST_CALL,  /* user function or distribution */
    SG_AST_TUPLE,
} sg_ast_kind;

typedef struct sg_ast_expr {
    sg_ast_kind kind;
    sg_operator op;
    uint32_t height;
    uint32_t nargs;
    sg_pos at;
    double value;
    const char *name;
    struct sg_ast_expr *args; /* the first; linked by next */
    struct sg_ast_expr *next;
} sg_ast_expr;

typedef struct {
    sg_ast_expr *first, *last;
    uint32_t n;
} sg_ast_exprs;

typedef struct sg_ast_name {
    const char *name;
    sg_pos at;
    struct sg_ast_name *next;
} sg_ast_name;

typedef struct {
    sg_ast_name *first, *last;
    uint32_t n;
} sg_ast_names;

/** Numbers row by row. A vector is a matrix of one row. */
typedef struct {
    double *values;
    size_t n, capacity;
    size_t rows, columns;
    sg_pos at;
} sg_ast_matrix;

/** The model of a learned split's sizes; absent parts are NULL. */
typedef struct {
    sg_ast_matrix *mean, *covariance, *sd, *examples;
    sg_pos at;
} sg_ast_sizes;

typedef enum {
    SG_ITEM_CALL,       /* NAME or NAME(args): successor, label or shape operation */
    SG_ITEM_DRAW,       /* NAME ~ distribution */
    SG_ITEM_PUSH,       /* [ items ] */
    SG_ITEM_SPLIT,      /* items are PARTs */
    SG_ITEM_PART,
    SG_ITEM_REPEAT,
    SG_ITEM_MAYBE,      /* items is one CALL */
    SG_ITEM_COMPONENTS, /* items are PARTs with names of faces */
} sg_item_kind;

typedef struct sg_ast_item {
    sg_item_kind kind;
    sg_pos at;
    const char *name;   /* CALL, DRAW; the axis of SPLIT and REPEAT; the face of PART in COMPONENTS */
    bool parentheses;   /* CALL */
    sg_size_kind size;  /* PART; its expression is args, none means one floating share */
    sg_ast_expr *args;  /* of CALL; the distribution of DRAW; the count of REPEAT; the probability of MAYBE */
    uint32_t nargs;
    struct sg_ast_item *items;
    sg_ast_sizes *sizes; /* SPLIT, or NULL */
    struct sg_ast_item *next;
} sg_ast_item;

typedef struct {
    sg_ast_item *first, *last;
} sg_ast_items;

typedef struct sg_ast_alternative {
    sg_ast_expr *weight; /* NULL: not given */
    sg_ast_item *items;
    sg_pos at;
    struct sg_ast_alternative *next;
} sg_ast_alternative;

typedef struct {
    sg_ast_alternative *first, *last;
} sg_ast_alternatives;

typedef struct sg_ast_rule {
    const char *name;
    sg_ast_names params;
    sg_ast_expr *guard;
    bool at_limit;
    sg_ast_alternative *alternatives;
    sg_pos at;
    struct sg_ast_rule *next;
} sg_ast_rule;

/** const NAME = value, or function NAME(params) = value. */
typedef struct sg_ast_definition {
    const char *name;
    bool is_function;
    sg_ast_names params;
    sg_ast_expr *value;
    sg_pos at;
    struct sg_ast_definition *next;
} sg_ast_definition;

/** Also a material, whose colour is always given. */
typedef struct sg_ast_label {
    const char *name;
    bool has_color;
    uint32_t color;
    sg_pos at;
    struct sg_ast_label *next;
} sg_ast_label;

/** import NAME "FILE". */
typedef struct sg_ast_import {
    const char *name, *file;
    sg_pos at, file_at;
    struct sg_ast_import *next;
} sg_ast_import;

typedef struct {
    const char *name; /* NULL: not given */
    sg_pos name_at;
    bool has_limit, tied, relative_weights;
    size_t limit;
    sg_pos limit_at, tied_at, weights_at;
    sg_ast_item *start; /* a CALL, or NULL */
    sg_ast_import *imports, *last_import; /* what they bring is in the lists below once they are read */
    sg_ast_definition *definitions, *last_definition;
    sg_ast_label *labels, *last_label;
    sg_ast_label *materials, *last_material;
    sg_ast_rule *rules, *last_rule;
} sg_ast;

/** Append to a list with members first and last, whose nodes have next. */
#define SG_AST_APPEND(list_first, list_last, node)                                                                     \
    do {                                                                                                               \
        if ((list_last) != NULL)                                                                                       \
            (list_last)->next = (node);                                                                                \
        else                                                                                                           \
            (list_first) = (node);                                                                                     \
        (list_last) = (node);                                                                                          \
    } while (0)

/* Constructors return NULL when memory is out. */
sg_ast_expr *sg_ast_number(sg_arena *arena, double value, sg_pos at);
sg_ast_expr *sg_ast_named(sg_arena *arena, sg_ast_kind kind, const char *name, sg_ast_exprs args, sg_pos at);
/** Arguments are taken out of their lists. b and c may be NULL. */
sg_ast_expr *sg_ast_operate(sg_arena *arena, sg_operator op, sg_ast_expr *a, sg_ast_expr *b, sg_ast_expr *c, sg_pos at);
sg_ast_exprs sg_ast_exprs_add(sg_ast_exprs list, sg_ast_expr *e);
sg_ast_item *sg_ast_item_new(sg_arena *arena, sg_item_kind kind, const char *name, sg_pos at);
sg_ast_matrix *sg_ast_matrix_new(sg_arena *arena, sg_pos at);
/** A matrix that holds a copy of rows x columns numbers. */
sg_ast_matrix *sg_ast_matrix_of(sg_arena *arena, const double *values, size_t rows, size_t columns);
/** @return false when memory is out */
bool sg_ast_matrix_add(sg_arena *arena, sg_ast_matrix *m, const double *values, size_t n);

#endif
