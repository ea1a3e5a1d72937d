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
    size_t row;           /* (width + 1) * channels */
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

typedef struct {
    uint8_t kind;     /* sg_plan_kind */
    uint8_t axis;     /* SPLIT: 0 along x, 1 along y */
    uint8_t drawn;    /* SPLIT: sizes are drawn */
    uint8_t cuts;     /* bit 1 << axis: the rule or what may stand below it cuts along the axis */
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

/** Edges in the order of the language, so that a split along axis a runs from edge 2a to edge 2a + 1. */
enum { SG_LEFT, SG_RIGHT, SG_BOTTOM, SG_TOP };

/** One place of a node. */
typedef struct {
    double at[4];  /* picture coordinates of the edges */
    int32_t px[4]; /* first pixels behind them */
} sg_label_spot;

/** A tree placed: spots of its nodes in pre-order. A tied node has as many as it has occurrences in the scene, those of one
 *  occurrence of its parent together. */
typedef struct {
    sg_label_spot *spots;
    size_t spots_capacity;
    int64_t *sums; /* of the labels that a spot's own body places: a split has none */
    size_t sums_capacity;
    uint32_t *first; /* tied: [nnodes + 1] first spot of each node; else a node is its spot */
    size_t first_capacity;
    size_t nnodes, nspots;
} sg_label_table;

void sg_label_table_clear(sg_label_table *t);
/** Room for so many in all. @return false when memory is out */
bool sg_label_table_reserve(sg_label_table *t, size_t nodes, size_t spots, bool tied);

/** What new values do to a child. */
typedef enum {
    SG_SAME,
    SG_SLID,   /* by less than a pixel, along an axis that nothing below cuts: sums hold */
    SG_PLACED, /* a label, or labels of the node's own body: spots and sums are there */
    SG_MOVED,  /* the subtree is placed anew */
} sg_label_motion;

/** A stored child of a tied split: the node, its first spot, its plan, and (of new values) the greatest motion of a spot. */
typedef struct {
    size_t node, spot;
    const sg_label_plan *plan;
    sg_label_motion motion;
} sg_label_child;

/** Work space of placing, kept from one to the next. */
typedef struct {
    sg_placer placer;
    sg_child_list list;
    sg_label_child *children;
    size_t children_capacity;
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
    const sg_label_table *now; /* tied: where d stands before nodes are placed anew, or NULL; what stays is copied */
    int64_t sum, most;         /* so far; more than this is of no use */
    size_t labels;             /* placed by bodies that are no plain label */
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

/** A split that is walked along, part by part. */
typedef struct {
    const double *sizes, *ends; /* one of them is NULL */
    uint32_t k, n;              /* parts passed, parts */
    unsigned along, across;     /* first edge along the axis, and across it */
    double from, to;            /* where shares 0 and 1 lie */
    double sum;                 /* of sizes passed */
    double at;                  /* where the walk stands, and its pixel */
    int32_t px;
    double sides[2]; /* of the scope, across the axis */
    int32_t side_px[2];
    const int64_t *corners[2]; /* at pixel 0 along the axis, on both sides */
    ptrdiff_t step;            /* between corners along the axis */
} sg_label_walk;

static inline sg_label_walk sg_label_walk_of(const sg_label_target *t, const sg_label_plan *p, const double *draws,
                                             const sg_label_spot *s)
{
    const unsigned along = 2u * p->axis, across = 2 - along;
    const sg_label_sums *image = &t->image;
    const ptrdiff_t row = (ptrdiff_t)image->row, column = (ptrdiff_t)image->channels;
    const ptrdiff_t sideways = p->axis ? column : row;
    return (sg_label_walk){.sizes = p->drawn ? draws + p->first : NULL,
                           .ends = p->drawn ? NULL : t->plans.ends + p->first,
                           .n = p->n,
                           .along = along,
                           .across = across,
                           .from = s->at[along],
                           .to = s->at[along + 1],
                           .at = s->at[along],
                           .px = s->px[along],
                           .sides = {s->at[across], s->at[across + 1]},
                           .side_px = {s->px[across], s->px[across + 1]},
                           .corners = {image->sums + s->px[across] * sideways,
                                       image->sums + s->px[across + 1] * sideways},
                           .step = p->axis ? row : column};
}

/** Where the next part ends. */
static inline double sg_label_walk_end(sg_label_walk *w)
{
    const uint32_t k = w->k++;
    if (w->k == w->n)
        return w->to;
    const double share = w->ends != NULL ? w->ends[k] : sg_placer_share(w->sum += w->sizes[k]);
    return sg_placer_cut(w->from, w->to, share);
}

/** Go to the end of a part: its spot, and (for a label) its sum.
 *  Corners at the end of the part less those at its begin: positive along both axes, since y runs up. */
static inline int64_t sg_label_walk_to(sg_label_walk *w, double end, const sg_label_plan *part, sg_label_spot *spot)
{
    const int32_t px = sg_label_pixel(end);
    const ptrdiff_t b = w->px * w->step, e = px * w->step;
    const int64_t *const first = w->corners[0] + part->channel, *const second = w->corners[1] + part->channel;
    spot->at[w->along] = w->at;
    spot->at[w->along + 1] = end;
    spot->at[w->across] = w->sides[0];
    spot->at[w->across + 1] = w->sides[1];
    spot->px[w->along] = w->px;
    spot->px[w->along + 1] = px;
    spot->px[w->across] = w->side_px[0];
    spot->px[w->across + 1] = w->side_px[1];
    w->at = end;
    w->px = px;
    return part->kind == SG_PLAN_LABEL ? (first[e] - second[e]) - (first[b] - second[b]) : 0;
}

/** The stored children of a tied split, into the scratch, with nothing moved. @return false when memory is out */
bool sg_label_list_children(sg_label_placing *w, const sg_label_plan *p, size_t node);

/** Tied trees: number the spots of all nodes of w->d, the root having `copies`, in w->to->first.
 *  @return SG_OK, SG_ENUMERIC (too many, or children that do not fit a rule), SG_ENOMEM */
sg_status sg_label_number_spots(sg_label_placing *w, size_t copies);

/** Sums of a node whose body is a label, over its spots, which are there. */
void sg_label_place_label(sg_label_placing *w, size_t node);
/** Place what the body of a node places, whose own spots are there: spots of its children, sums of those that are labels.
 *  @param frame  arguments and draw values of the node
 *  @return SG_OK, SG_ENUMERIC (no label scene, or w->most is passed), SG_ENOMEM */
sg_status sg_label_place_body(sg_label_placing *w, size_t node, const double *frame);
/** The same for nodes first..end-1, which are whole subtrees; what their parents place is there. */
sg_status sg_label_place_nodes(sg_label_placing *w, size_t first, size_t end);

/** A subtree of the tree where a state stands: nodes first..end-1. */
typedef struct {
    size_t first, end;
    sg_label_motion motion;
} sg_label_range;

typedef enum { SG_PENDING_NONE, SG_PENDING_WHOLE, SG_PENDING_SLICE, SG_PENDING_VALUES } sg_label_pending;

typedef struct {
    sg_score_state state; /* first */
    sg_label_table now;   /* where it stands */
    int64_t sum;
    size_t places; /* symbols and labels: no fewer than the scene has */
    bool stands;   /* at a derivation that is a label scene */
    sg_label_table next; /* what is proposed: all of it, a slice, or the node's subtree with holes */
    int64_t next_sum;
    size_t next_places;
    sg_label_pending pending;
    const sg_change *change;
    sg_label_range *ranges; /* of pending values: children of the node that moved */
    size_t nranges, ranges_capacity;
    double *frame; /* [frame size of the grammar] */
    sg_label_scratch scratch;
    sg_derivation whole;
} sg_label_state;

static inline const sg_label_target *sg_label_target_of(const sg_label_state *s)
{
    return (const sg_label_target *)s->state.target;
}

/** First spot of a node where the state stands; the node behind the last one has one, too. */
static inline size_t sg_label_first_spot(const sg_label_state *s, size_t node)
{
    return s->now.first != NULL ? s->now.first[node] : node;
}

/** Sum over the spots of nodes first..end-1. */
int64_t sg_label_sum_nodes(const sg_label_state *s, size_t first, size_t end);

sg_label_placing sg_label_placing_of(sg_label_state *s, const sg_derivation *d);

/** Score new values of a node. @return SG_OK: pending; SG_ENUMERIC (no label scene, or more than `most`), SG_ENOMEM */
sg_status sg_label_propose_values(sg_label_state *s, const sg_change *c, int64_t most);
void sg_label_commit_values(sg_label_state *s);

#endif
