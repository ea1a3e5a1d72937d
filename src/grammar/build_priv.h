/* SPDX-License-Identifier: GPL-3.0-or-later */
/* build_priv.h - the builder: syntax tree to grammar. build.c declares symbols and rules, build_hidden.c those that nobody
 * wrote, build_expr.c compiles expressions, build_draw.c draws, build_body.c bodies; build_check.c looks at the whole,
 * build_range.c and build_range_check.c at what values can be, build_examples.c at what they come to. */
#ifndef SG_GRAMMAR_BUILD_PRIV_H
#define SG_GRAMMAR_BUILD_PRIV_H

#include "grammar/grammar_priv.h"
#include "grammar/names.h"

enum { SG_MAX_WARNINGS = 20 };

/** A hidden symbol that is still to get its rules. */
typedef struct {
    sg_sym symbol;
    sg_sym target;      /* the label, or the optional successor */
    bool optional;
    bool constant;      /* optional: the probability is a constant, else it is the first parameter */
    double probability;
} sg_hidden;

typedef struct {
    sg_arena *arena;
    sg_ast *ast;
    const sg_source *source;
    sg_error *err;
    sg_names symbol_names, constant_names, function_names, hidden_names, string_names, number_names,
        material_names; /* to colours */
    /* growing, in malloc's memory until the grammar is done */
    sg_symbol *symbols;
    size_t nsymbols, symbols_capacity;
    sg_rule *rules;
    size_t nrules, rules_capacity;
    sg_code *codes;
    size_t ncodes, codes_capacity;
    sg_pos *code_at; /* where each expression stands, for the same */
    bool *code_tuned; /* whether a constant with a name is in it: such a one may be a switch */
    size_t code_at_capacity, code_tuned_capacity;
    sg_instruction *instructions;
    size_t ninstructions, instructions_capacity;
    double *constants;
    size_t nconstants, constants_capacity;
    const char **strings;
    size_t nstrings, strings_capacity;
    sg_hidden *hidden;
    size_t nhidden, hidden_capacity;
    sg_ast_definition **functions; /* by number */
    size_t nfunctions, functions_capacity;
    sg_pos *symbol_at, *rule_at; /* where they are defined, for errors of the checks */
    size_t symbol_at_capacity, rule_at_capacity;
    const bool *usable; /* [nrules] false: no value that can come there lets the rule be used; NULL: not known yet */
    const char *warnings[SG_MAX_WARNINGS]; /* in the arena, "FILE:LINE:COL: warning: ..." */
    sg_pos warned_at[SG_MAX_WARNINGS];
    size_t nwarnings;
    sg_sym start;
    double *start_args;
} sg_builder;

/** Draws of a rule while its body is compiled. */
typedef struct {
    sg_draw *draws;
    size_t n, capacity;
    uint32_t nuniforms, nvalues;
} sg_draw_list;

/** What names mean in an expression. */
typedef struct sg_scope {
    const sg_ast_names *params; /* frame slots 0...; NULL: none */
    uint32_t nparams;
    sg_draw_list *draws;        /* NULL: draws are not allowed here */
    bool no_depth;              /* `depth` is not known here */
    const char *what;           /* "a weight", ... for messages */
    const sg_ast_names *bound;  /* inside a function: its parameters ... */
    const sg_operand *operands; /* ... and where their values stand */
} sg_scope;

sg_status sg_build_fail_nomem(sg_builder *b);

/** Compile an expression. A constant one that is not finite is an error. */
sg_status sg_build_expr(sg_builder *b, const sg_scope *scope, const sg_ast_expr *e, sg_expr *out);
/** A constant expression of its own. */
sg_status sg_build_constant(sg_builder *b, double value, sg_expr *out);
/** The frame slot as an expression. */
sg_status sg_build_slot(sg_builder *b, uint32_t slot, sg_expr *out);
/** 1 - x of a frame slot. */
sg_status sg_build_complement(sg_builder *b, uint32_t slot, sg_expr *out);
bool sg_build_is_constant(const sg_builder *b, sg_expr e, double *value);
/** Same code, hence same value in every frame. */
bool sg_build_equal(const sg_builder *b, sg_expr x, sg_expr y);
/** Add a draw; name is NULL when it is anonymous. *slot: frame slot of its first value. */
sg_status sg_build_draw(sg_builder *b, const sg_scope *scope, const sg_ast_expr *call, const char *name,
                        uint32_t *slot);
sg_status sg_build_simplex(sg_builder *b, const sg_scope *scope, const sg_ast_sizes *sizes, size_t nparts,
                           uint32_t *draw);
sg_status sg_build_string(sg_builder *b, const char *s, uint32_t *index);
/** True for names that no definition, parameter or draw may take. */
bool sg_build_is_reserved(const char *name);

/** Compile a body into ops, draws and counts of the rule. draws begins empty and is cleared by the caller. */
sg_status sg_build_body(sg_builder *b, const sg_ast_names *params, sg_ast_item *items, sg_rule *rule);

/** What a symbol begins as. */
#define SG_BLANK_SYMBOL {.kind = SG_SYMBOL_NONTERMINAL, .first_rule = SG_NONE, .completion = SG_NONE}

/** The hidden symbol of a label. */
sg_status sg_build_lexical(sg_builder *b, sg_sym label, sg_sym *out);
/** The hidden symbol of an optional successor; nparams of it as the header of build_hidden.c says. */
sg_status sg_build_optional(sg_builder *b, sg_sym target, bool constant, double probability, sg_pos at, sg_sym *out);
sg_status sg_build_symbol(sg_builder *b, const sg_symbol *s, sg_pos at, sg_sym *out);
sg_status sg_build_rule(sg_builder *b, const sg_rule *r, sg_pos at);
/** Rules of all hidden symbols, and the names of the optional ones. */
sg_status sg_build_hidden(sg_builder *b);

/** Weights, reachability, productivity. */
sg_status sg_build_check(sg_builder *b);
/** Every symbol has some choice of rules that ends, of those that are known to be usable. */
sg_status sg_build_check_productive(sg_builder *b);

/** A remark that stops nothing; a second one for the same place, and those after the first SG_MAX_WARNINGS, are dropped. */
sg_status sg_build_warn(sg_builder *b, sg_pos at, const char *format, ...) __attribute__((format(printf, 3, 4)));
/** Look at what the expressions of the finished grammar can be: build_range_priv.h. @return SG_OK, SG_EINPUT, SG_ENOMEM */
sg_status sg_build_examine(sg_builder *b, const sg_grammar *g);

/** What searches ask of each rule again and again: child_ops, draws_passed. */
sg_status sg_build_tables(sg_builder *b);

#endif
