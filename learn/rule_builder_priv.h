/* SPDX-License-Identifier: GPL-3.0-or-later */
/* rule_builder_priv.h - makes a split form rule by rule: symbols by key, equal rules united, sizes of each use kept. */
#ifndef SG_LEARN_RULE_BUILDER_PRIV_H
#define SG_LEARN_RULE_BUILDER_PRIV_H

#include "core/arena.h"
#include "core/status.h"
#include "grammar/split.h"

#include <stdint.h>

typedef struct sg_rule_builder sg_rule_builder;

/** A builder in the arena (it holds all until the arena is reset); NULL when memory is out. */
sg_rule_builder *sg_rule_builder_create(sg_arena *arena);

/** Symbol of a key (any words): the one that this key made before, or a new one without a name. SG_NONE: out of memory. */
uint32_t sg_rule_builder_symbol(sg_rule_builder *b, const uint32_t *key, size_t nkey, bool *is_new);
void sg_rule_builder_name(sg_rule_builder *b, uint32_t symbol, const char *name); /* borrowed */

/** Add `count` uses of a rule; an equal rule takes them. sizes: [n] relative, or NULL. @return SG_OK, SG_ENOMEM */
sg_status sg_rule_builder_use(sg_rule_builder *b, uint32_t lhs, sg_split_op op, const uint32_t *rhs, size_t n,
                              double count, const double *sizes);

/** The form: rules by increasing symbol, within one in the order of their first use; probabilities are relative counts.
 *  Terminals, axiom, name and tied are the caller's to set. @param counts out [nrules], may be NULL */
sg_status sg_rule_builder_form(sg_rule_builder *b, sg_split_form *out, double **counts, sg_error *err);

#endif
