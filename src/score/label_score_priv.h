/* SPDX-License-Identifier: GPL-3.0-or-later */
/* label_score_priv.h - targets, and how scenes are placed and summed: what the files of label scores share.
 *
 * A label scene is a partition, so in every pixel the cost of the cheapest label is paid whatever the scene says. It is summed
 * once, into `base`; the integral images hold what a label costs above it. What is placed so far then bounds the whole from
 * below, and tightly.
 *
 * Rules whose body is one label, one successor, or one split with drawn or constant shares have a plan of a few numbers.
 * Other bodies go through the placer of scenes. Both give the same boundaries to the last bit (sg_placer_share(),
 * sg_placer_cut()), so sums agree with the raster of a scene exactly. */
#ifndef SG_SCORE_LABEL_SCORE_PRIV_H
#define SG_SCORE_LABEL_SCORE_PRIV_H

#include "scene/placer.h"
#include "score/label_score.h"

/** Costs are integers in units of 2^-28 nats: exact for 32-bit floats from 1/16 nat on. */
#define SG_LABEL_UNITS_PER_NAT 268435456.0

/** Labels of one corner stand side by side, so that they share a cache line. */
typedef struct {
    size_t width, height; /* px */
    size_t channels;      /* labels of the grammar that are told apart, padded to a cache line */
    int64_t *sums;        /* [height + 1][width + 1][channels] of the pixels above and to the left, above the cheapest */
    int64_t base;         /* sum over all pixels of the cheapest label's cost */
} sg_label_sums;

typedef enum {
    SG_PLAN_LABEL, /* the body is one label */
    SG_PLAN_SPLIT, /* one split along x or y, each part one symbol, shares that do not depend on the scope; or one symbol */
    SG_PLAN_BODY,  /* anything else */
    SG_PLAN_OPEN,  /* no rule yet: its pixels have the cheapest labels */
    SG_PLAN_HOLE,  /* cut at the depth limit: no label scene */
} sg_plan_kind;

enum { SG_CUTS_X = 1, SG_CUTS_Y = 2 };

typedef struct {
    uint8_t kind;     /* sg_plan_kind */
    uint8_t y, drawn; /* SPLIT: along y; sizes are drawn */
    uint8_t cuts;     /* axes along which the rule or what may stand below it cuts */
    uint32_t n;       /* SPLIT: parts */
    uint32_t channel; /* LABEL */
    uint32_t nparams; /* SPLIT: of the symbol */
    uint32_t first;   /* SPLIT: of the drawn sizes among the draw values; of constant ends in sg_label_plans.ends */
    uint32_t part;    /* SPLIT, tied: first in sg_label_plans.parts */
} sg_label_plan;

/** A part of a tied split: which stored child, and which of its copies; children are numbered by their first copies. */
typedef struct {
    uint32_t child, copy, copies;
} sg_label_part;

typedef struct {
    sg_label_plan *rules; /* [rules] */
    sg_label_plan open, hole;
    double *ends; /* where the parts of constant splits end, as shares */
    size_t nends, ends_capacity;
    sg_label_part *parts;
    size_t nparts, parts_capacity;
} sg_label_plans;

typedef struct {
    sg_score score; /* first */
    const sg_grammar *g;
    sg_label_sums image;
    sg_label_plans plans;
    uint32_t *channel; /* [symbols] of a label, in `image` */
    double nats;       /* weight of one unit */
    bool tied;
} sg_label_target;

void sg_label_target_free(sg_score *target);
extern const sg_score_ops sg_label_score_ops;

/** Plans of all rules; channels of labels are known. @return SG_OK, SG_ENOMEM */
sg_status sg_label_plans_create(sg_label_target *t, sg_error *err);
void sg_label_plans_clear(sg_label_plans *p);

/** One place of a node. */
typedef struct {
    sg_rect at;
    int32_t x0, y0, x1, y1; /* pixels, half open */
} sg_label_spot;

/** A tree placed: spots of its nodes in pre-order. A tied node has as many as it has occurrences in the scene, those of one
 *  occurrence of its parent together. */
typedef struct {
    sg_label_spot *spots;
    size_t spots_capacity;
    int64_t *sums; /* of the labels that a spot's own body places: a lexical node has all of its, a split has none */
    size_t sums_capacity;
    uint32_t *first; /* tied: [nnodes + 1] first spot of each node; else a node is its spot */
    size_t first_capacity;
    size_t nnodes, nspots;
} sg_label_table;

void sg_label_table_clear(sg_label_table *t);
/** Room for so many in all. @return false when memory is out */
bool sg_label_table_reserve(sg_label_table *t, size_t nodes, size_t spots, bool tied);

/** Work space of placing, kept from one to the next. */
typedef struct {
    sg_placer placer;
    sg_child_list list;
    size_t *numbers;
    size_t numbers_capacity;
} sg_label_scratch;

/** Places nodes of d into a table. */
typedef struct {
    const sg_label_target *t;
    const sg_derivation *d;
    sg_label_table *to;
    const uint32_t *first; /* tied: first spot of each node of d, before base is subtracted */
    size_t base;           /* the spot that is number 0 in `to` */
    int64_t sum, most;     /* so far; more than this is of no use */
    size_t places;         /* symbols and labels placed */
    sg_label_scratch *scratch;
} sg_label_placing;

static inline const sg_label_plan *sg_label_plan_of(const sg_label_target *t, const sg_derivation *d, size_t node)
{
    const sg_rule_id rule = d->nodes[node].rule;
    return rule < SG_RULE_EMPTY ? t->plans.rules + rule : rule == SG_NONE ? &t->plans.open : &t->plans.hole;
}

/** First spot of a node, as a number in w->to; the node behind the last one has one, too. */
static inline size_t sg_label_spot_of(const sg_label_placing *w, size_t node)
{
    return (w->first != NULL ? w->first[node] : node) - w->base;
}

static inline size_t sg_label_spots_of(const sg_label_placing *w, size_t node)
{
    return w->first != NULL ? w->first[node + 1] - w->first[node] : 1;
}

/** As sg_label_scene_pixel() of a scene in pixels, for coordinates inside of it. */
static inline int32_t sg_label_pixel(double c)
{
    const int32_t k = (int32_t)c;
    return k + (c - k > 0.5);
}

/** Tied trees: number the spots of all nodes of w->d, the root having `copies`, in w->to->first.
 *  @return SG_OK, SG_ENUMERIC (too many, or children that do not fit a rule), SG_ENOMEM */
sg_status sg_label_number_spots(sg_label_placing *w, size_t copies);

/** Place what the body of a node places, whose own spots are there: spots of its children; sums of its labels.
 *  @param frame  arguments and draw values of the node
 *  @return SG_OK, SG_ENUMERIC (no label scene, or w->most is passed), SG_ENOMEM */
sg_status sg_label_place_body(sg_label_placing *w, size_t node, const double *frame);
/** The same for nodes first..end-1, which are whole subtrees; spots of their roots are there. */
sg_status sg_label_place_nodes(sg_label_placing *w, size_t first, size_t end);

#endif
