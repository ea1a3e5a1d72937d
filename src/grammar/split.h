/* SPDX-License-Identifier: GPL-3.0-or-later */
/* split.h - a split grammar as flat arrays: the in-memory exchange form between grammar files, parsers and learners.
 *
 * Here, as in lattices and in the JSON form, split-y runs top to bottom (the language runs bottom to top; the
 * conversions below are the one place that reverses). A rule is X -> split-x Y1..Yn, X -> split-y Y1..Yn (n >= 1), or
 * lexical X -> t. Right-hand sides hold non-terminals only, lexical rules exactly one terminal. */
#ifndef SG_GRAMMAR_SPLIT_H
#define SG_GRAMMAR_SPLIT_H

#include "core/arena.h"
#include "core/status.h"
#include "grammar/grammar.h"

typedef enum { SG_SPLIT_X, SG_SPLIT_Y, SG_SPLIT_LEXICAL } sg_split_op;

typedef struct {
    uint32_t lhs;
    sg_split_op op;
    uint32_t n;          /* length of the right-hand side, 1 for lexical rules */
    const uint32_t *rhs; /* [n] non-terminals; lexical: rhs[0] is the terminal */
    double probability;
    size_t nattributes;
    const double *attributes; /* [nattributes][n] relative sizes, each row sums to 1; NULL when there are none */
    const double *mean;       /* [n], or NULL: no size model */
    const double *covariance; /* [n-1][n-1] over the first n-1 sizes, with mean */
    sg_rule_id source;        /* the rule of the sg_grammar that this was made from, or SG_NONE */
} sg_split_rule;

typedef struct {
    const char *name;
    size_t nsymbols; /* non-terminals */
    const char *const *symbol_names;
    size_t nterminals;
    const char *const *terminal_names;
    const uint32_t *terminal_colors; /* 0xRRGGBB */
    uint32_t axiom;
    bool tied;
    size_t nrules;
    const sg_split_rule *rules; /* rules of one symbol stand together, by increasing symbol */
} sg_split_form;

/** The split form of a grammar; everything is put into the arena (names are borrowed from g).
 *  @return SG_OK; SG_EINPUT when g says more than a split grammar can (guards, parameters, weights that are no constants,
 *          operations other than one split or one label in a body, completions): the sentence names rule and line */
sg_status sg_split_form_of(const sg_grammar *g, sg_arena *arena, sg_split_form *out, sg_error *err);

/** A grammar from the split form: copies everything, checks everything that sg_grammar_load() checks.
 *  Rules with mean get a simplex draw; without one, the parts float equally. An implicit lexical symbol comes back as one
 *  when a symbol's only rule is lexical with probability 1 and its name is that of the terminal.
 *  @return SG_OK, SG_EINPUT (probabilities do not sum to 1 within 1e-6, unknown symbols, bad sizes, ...), SG_ENOMEM */
sg_status sg_grammar_from_split(const sg_split_form *form, sg_grammar **out, sg_error *err);

/** The exchange form (INTERFACES 6). Written numbers read back the same. @return SG_OK, SG_EINPUT / SG_EIO, SG_ENOMEM */
sg_status sg_split_form_write_json(const sg_split_form *form, FILE *out, sg_error *err);
sg_status sg_split_form_read_json(const char *text, size_t length, const char *name, sg_arena *arena,
                                  sg_split_form *out, sg_error *err);

/** The exchange form as a jansson value, for results that contain grammars; NULL when memory is out. The caller owns it.
 *  Declared without jansson's header: the type is json_t. */
struct json_t *sg_split_form_json(const sg_split_form *form);

#endif
