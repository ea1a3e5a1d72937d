/* SPDX-License-Identifier: GPL-3.0-or-later */
/* exact_parse.h - parsing of per-pixel label costs by dynamic programming, in place of a search.
 *
 * An irregular lattice is fitted to the costs (lattice_fit.h), the cells' sums of costs are parsed by the Earley
 * machine in region mode (earley.h), and the best derivation becomes one of the grammar, its sizes those of the
 * lattice's lines. It is the best one, by E_img + E_rule of DESIGN 5.4, of all whose cuts are lines of the lattice, where
 * siblings are not tied: sizes have no density in that parse, so E_attr takes no part in it, and tied siblings are
 * derived one by one, after which the derivation that serves all their places best takes all of them.
 *
 * Both are made good by refining: a second derivation comes from descent over whole rules (exact_descend.c), in both the
 * cuts move to where the energy with all its parts is least (exact_move.c), and the better one stays. That is a local
 * optimum, no more bound to the lattice. */
#ifndef SG_PARSE_EXACT_PARSE_H
#define SG_PARSE_EXACT_PARSE_H

#include "derivation/derivation.h"
#include "image/npy.h"

typedef struct {
    double weight;    /* of the costs, > 0: as in label_score.h */
    size_t max_cells; /* of the lattice, half of them fitted, the others by halving the longest sides; 0: as many as
                         description length asks for, and as many again */
    bool refine;
    double step_px;   /* of refining: between places for cuts in descent, >= 1 */
} sg_exact_opts;

#define SG_EXACT_OPTS_INIT {1, 600, true, 6}

typedef struct {
    sg_derivation derivation;
    double energy_image;     /* weight * sum of the costs of the pixels' labels, nats */
    double energy_rule;      /* -sum of log rule probabilities */
    double energy_attribute; /* -sum of log densities of the sizes */
    double energy_lattice;   /* E_img + E_rule of the parse, before ties and refining: the least on the lattice */
    size_t columns, rows;    /* of the lattice, cells */
    size_t states;           /* of the chart */
    double seconds;
} sg_exact_result;

/** @param costs    [channels][height][width] nats, finite, >= 0
 *  @param channel  [symbols of g] the channel of each label; for other symbols not read
 *  @return SG_OK; SG_EINPUT (no split grammar: sg_split_form_of()); SG_ENOPARSE (no derivation fills the lattice);
 *          SG_EINVAL (a cost that is negative or not finite, a channel that is not there, a weight that is no positive
 *          number); SG_ENUMERIC, SG_ENOMEM. On failure out is empty. Clear it in every case; g must outlive it */
sg_status sg_exact_parse(const sg_grammar *g, const sg_float_map *costs, const uint32_t *channel,
                         const sg_exact_opts *opts, sg_exact_result *out, sg_error *err);
void sg_exact_result_clear(sg_exact_result *r);

#endif
