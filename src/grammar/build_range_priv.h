/* SPDX-License-Identifier: GPL-3.0-or-later */
/* build_range_priv.h - what parameters and the depth of each symbol can be, over all derivations from the start. */
#ifndef SG_GRAMMAR_BUILD_RANGE_PRIV_H
#define SG_GRAMMAR_BUILD_RANGE_PRIV_H

#include "grammar/build_priv.h"
#include "grammar/interval_code.h"

/** Everything that a symbol is ever derived with. */
typedef struct {
    bool reached, queued;
    unsigned grown; /* how often it became larger */
    sg_interval depth;
    sg_interval *params;
} sg_range;

typedef struct {
    sg_builder *b;
    const sg_grammar *g;
    sg_arena *arena;  /* for what lives as long as this */
    sg_interval_frame f;
    sg_range *ranges; /* [nsymbols] */
    sg_range *into;   /* where successors go: ranges, or those of the next round */
    sg_sym *queue;    /* a ring of symbols that grew; NULL: nobody wants to know */
    size_t first, nqueued;
    bool *chancy;     /* [nsymbols] `maybe` whose first parameter is its probability */
    bool switched;    /* constants take a rule out of use */
    bool suspect;     /* something may go wrong; examples will tell */
} sg_ranges;

/** Find them. Free with sg_ranges_clear(). @return SG_OK, SG_ENOMEM */
sg_status sg_ranges_find(sg_ranges *w, sg_builder *b, const sg_grammar *g, sg_arena *arena);
void sg_ranges_clear(sg_ranges *w);

/** The frame of rule r of s, where its guard holds: parameters and depth only. @return false when that is nowhere */
bool sg_ranges_enter(sg_ranges *w, sg_sym s, sg_rule_id r);
/** The same, and draws too; false also when its weight is never above 0. */
bool sg_ranges_use(sg_ranges *w, sg_sym s, sg_rule_id r);
/** Can some depth be one where rules are chosen, and not completions? */
bool sg_ranges_above_limit(const sg_ranges *w, sg_sym s);
/** Weight of a rule in the frame of the moment. */
sg_interval sg_ranges_weight(sg_ranges *w, const sg_rule *r);

/** Errors for what fails whatever the values are, warnings for guards and symbols that never come to use. Sets
 *  w->suspect. @return SG_OK, SG_EINPUT, SG_ENOMEM */
sg_status sg_ranges_check(sg_ranges *w);

/** Derive a few hundred examples, shallow ones first and with draws that are nothing special, and warn of each place where
 *  one fails. @return SG_OK, SG_ENOMEM */
sg_status sg_build_try_examples(sg_builder *b, const sg_grammar *g, sg_arena *arena);

#endif
