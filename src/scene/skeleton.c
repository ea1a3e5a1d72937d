/* SPDX-License-Identifier: GPL-3.0-or-later */
/* skeleton.c - the wavefront, its events, and the faces that it leaves behind. Simulated in the plain way, O(n^3) in all:
 * polygons are small. */
#include "scene/skeleton.h"

#include "scene/triangulate.h"

#include <math.h>
#include <string.h>

enum { MAX_VERTICES = 8 * SG_SKELETON_CORNERS, MAX_ARCS = 8 * SG_SKELETON_CORNERS };

typedef struct {
    double normal[2], along[2]; /* inwards; in the direction of the edge */
    double at;                  /* normal . x at time 0 */
} line;

/* A corner of the wavefront, between two edges of the polygon. */
typedef struct {
    int in, out;
    int before, after; /* vertices of its loop */
    int node;          /* where it began */
    double start[2], v[2];
    double birth;
    bool alive, stuck; /* stuck: its edges run against each other, what is between them is gone */
} vertex;

typedef struct {
    int a, b;        /* nodes */
    int left, right; /* edges whose faces it parts */
} arc;

typedef enum { EVENT_NONE, EVENT_STUCK, EVENT_EDGE, EVENT_SPLIT } event_kind;

typedef struct {
    event_kind kind;
    double time;
    int vertex, hit; /* EDGE: the edge from `vertex` to the one after; SPLIT: the edge from `hit` on */
} event;

typedef struct {
    sg_skeleton *s;
    line lines[SG_SKELETON_CORNERS];
    size_t n, nvertices, narcs;
    vertex vertices[MAX_VERTICES];
    arc arcs[MAX_ARCS];
    double now, small; /* lengths and times that are none */
    bool failed;
} wave;

static double dot2(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1];
}

static double cross2(const double *a, const double *b)
{
    return a[0] * b[1] - a[1] * b[0];
}

static double distance2(const double *a, const double *b)
{
    return hypot(a[0] - b[0], a[1] - b[1]);
}

static void place_at(const vertex *v, double time, double *out)
{
    for (int i = 0; i < 2; i++)
        out[i] = v->start[i] + (time - v->birth) * v->v[i];
}

/* The node at this place and time, made when it is the first there. */
static int node_at(wave *w, const double *at, double time)
{
    sg_skeleton *s = w->s;
    for (size_t i = 0; i < s->nnodes; i++)
        if (distance2(s->node[i], at) <= 10 * w->small && fabs(s->node[i][2] - time) <= 10 * w->small)
            return (int)i;
    if (s->nnodes == SG_SKELETON_NODES) {
        w->failed = true;
        return 0;
    }
    double *node = s->node[s->nnodes];
    memcpy(node, at, 2 * sizeof *at);
    node[2] = time;
    return (int)s->nnodes++;
}

static void add_arc(wave *w, int a, int b, int left, int right)
{
    if (a == b)
        return;
    if (w->narcs == MAX_ARCS)
        w->failed = true;
    else
        w->arcs[w->narcs++] = (arc){a, b, left, right};
}

/* Both lines move by 1 along their normals: the speed of where they cross. */
static void find_speed(const wave *w, vertex *v)
{
    const line *a = w->lines + v->in, *b = w->lines + v->out;
    const double det = cross2(a->normal, b->normal);
    v->stuck = false;
    if (fabs(det) > 1e-7) {
        v->v[0] = (b->normal[1] - a->normal[1]) / det;
        v->v[1] = (a->normal[0] - b->normal[0]) / det;
    } else if (dot2(a->normal, b->normal) > 0) {
        memcpy(v->v, a->normal, sizeof v->v);
    } else {
        v->v[0] = v->v[1] = 0;
        v->stuck = true;
    }
}

/* A vertex between two others; these are told. */
static int add_vertex(wave *w, int in, int out, const double *at, int node, int before, int after)
{
    if (w->nvertices == MAX_VERTICES) {
        w->failed = true;
        return 0;
    }
    const int i = (int)w->nvertices++;
    vertex *v = w->vertices + i;
    *v = (vertex){.in = in, .out = out, .before = before, .after = after, .node = node, .birth = w->now, .alive = true};
    memcpy(v->start, at, sizeof v->start);
    find_speed(w, v);
    w->vertices[before].after = i;
    w->vertices[after].before = i;
    return i;
}

/* The vertex ends in a node: its way there is an arc. */
static void end_vertex(wave *w, int i, int node)
{
    vertex *v = w->vertices + i;
    add_arc(w, v->node, node, v->in, v->out);
    v->alive = false;
}

/* ---- events ---- */

static bool is_reflex(const wave *w, const vertex *v)
{
    return cross2(w->lines[v->in].along, w->lines[v->out].along) < -1e-7;
}

static void consider(event *best, event e)
{
    if (best->kind == EVENT_NONE || e.time < best->time)
        *best = e;
}

/* The edge from vertex i on: does it shrink to nothing, and when? */
static void consider_edge(const wave *w, int i, event *best)
{
    const vertex *v = w->vertices + i, *u = w->vertices + v->after;
    const double *along = w->lines[v->out].along;
    double a[2], b[2];
    place_at(v, w->now, a);
    place_at(u, w->now, b);
    const double length = dot2(b, along) - dot2(a, along), growth = dot2(u->v, along) - dot2(v->v, along);
    if (growth < -1e-9)
        consider(best, (event){EVENT_EDGE, w->now + fmax(0, length) / -growth, i, 0});
    else if (length <= w->small && growth <= 1e-9)
        consider(best, (event){EVENT_EDGE, w->now, i, 0});
}

/* Does the reflex vertex i run into the edge from vertex k on, between its ends, and when? */
static void consider_split(const wave *w, int i, int k, event *best)
{
    const vertex *v = w->vertices + i, *from = w->vertices + k, *to = w->vertices + from->after;
    const line *l = w->lines + from->out;
    double at[2], a[2], b[2];
    place_at(v, w->now, at);
    const double gap = dot2(l->normal, at) - l->at - w->now, closing = 1 - dot2(l->normal, v->v);
    if (k == i || from->after == i || from->out == v->in || from->out == v->out || gap < -10 * w->small ||
        closing < 1e-9)
        return;
    const double time = w->now + fmax(0, gap) / closing;
    place_at(v, time, at);
    place_at(from, time, a);
    place_at(to, time, b);
    const double place = dot2(at, l->along);
    if (place >= dot2(a, l->along) - 10 * w->small && place <= dot2(b, l->along) + 10 * w->small)
        consider(best, (event){EVENT_SPLIT, time, i, k});
}

static event next_event(const wave *w)
{
    event best = {EVENT_NONE, 0, 0, 0};
    for (int i = 0; i < (int)w->nvertices; i++) {
        const vertex *v = w->vertices + i;
        if (!v->alive)
            continue;
        if (v->stuck || w->vertices[v->after].after == i)
            return (event){EVENT_STUCK, w->now, i, 0};
        consider_edge(w, i, &best);
        for (int k = v->after; is_reflex(w, v) && k != i; k = w->vertices[k].after)
            consider_split(w, i, k, &best);
    }
    return best;
}

/* The edge from vertex i on is gone: its ends become one. */
static void close_edge(wave *w, int i)
{
    const int j = w->vertices[i].after, before = w->vertices[i].before, after = w->vertices[j].after;
    double a[2], b[2];
    place_at(w->vertices + i, w->now, a);
    place_at(w->vertices + j, w->now, b);
    for (int k = 0; k < 2; k++)
        a[k] = (a[k] + b[k]) / 2;
    const int node = node_at(w, a, w->now), in = w->vertices[i].in, out = w->vertices[j].out;
    end_vertex(w, i, node);
    end_vertex(w, j, node);
    add_vertex(w, in, out, a, node, before, after);
}

/* The loop falls apart where vertex i meets the edge from vertex k on. */
static void split_loop(wave *w, int i, int k)
{
    const vertex v = w->vertices[i];
    const int edge = w->vertices[k].out, end = w->vertices[k].after;
    double at[2];
    place_at(&v, w->now, at);
    const int node = node_at(w, at, w->now);
    end_vertex(w, i, node);
    add_vertex(w, v.in, edge, at, node, v.before, end);
    add_vertex(w, edge, v.out, at, node, k, v.after);
}

/* Two edges lie on each other, or a loop has no more than two vertices: from vertex i to the nearer of its neighbours there
 * is a ridge. */
static void close_ridge(wave *w, int i)
{
    const vertex v = w->vertices[i];
    double at[2], a[2], b[2];
    place_at(&v, w->now, at);
    place_at(w->vertices + v.before, w->now, b);
    place_at(w->vertices + v.after, w->now, a);
    const bool forward = distance2(at, a) <= distance2(at, b);
    const int near = forward ? v.after : v.before;
    const vertex u = w->vertices[near];
    const int from = node_at(w, at, w->now), to = node_at(w, forward ? a : b, w->now);
    end_vertex(w, i, from);
    add_arc(w, from, to, v.in, v.out);
    end_vertex(w, near, to);
    if (v.before == v.after)
        return;
    if (forward)
        add_vertex(w, v.in, u.out, a, to, v.before, u.after);
    else
        add_vertex(w, u.in, v.out, b, to, u.before, v.after);
}

static bool run(wave *w)
{
    for (int steps = 0; steps < MAX_VERTICES && !w->failed; steps++) {
        bool alive = false;
        for (size_t i = 0; i < w->nvertices; i++)
            alive = alive || w->vertices[i].alive;
        if (!alive)
            return true;
        const event e = next_event(w);
        w->now = fmax(w->now, e.time);
        switch (e.kind) {
        case EVENT_STUCK:
            close_ridge(w, e.vertex);
            break;
        case EVENT_EDGE:
            close_edge(w, e.vertex);
            break;
        case EVENT_SPLIT:
            split_loop(w, e.vertex, e.hit);
            break;
        case EVENT_NONE:
            return false;
        }
    }
    return false;
}

/* ---- faces ---- */

/* From the end of edge i along arcs that part its face from others, back to its beginning. */
static bool trace_face(wave *w, int i)
{
    sg_skeleton_face *f = w->s->face + i;
    bool used[MAX_ARCS] = {false};
    const int first = i;
    int at = (i + 1) % (int)w->n;
    f->ncorners = 1;
    f->corner[0] = (uint8_t)first;
    while (at != first) {
        size_t next = w->narcs, ways = 0;
        if (f->ncorners == SG_SKELETON_NODES)
            return false;
        f->corner[f->ncorners++] = (uint8_t)at;
        for (size_t k = 0; k < w->narcs; k++)
            if (!used[k] && (w->arcs[k].left == i || w->arcs[k].right == i) &&
                (w->arcs[k].a == at || w->arcs[k].b == at)) {
                next = k;
                ways++;
            }
        if (ways != 1)
            return false;
        used[next] = true;
        at = w->arcs[next].a == at ? w->arcs[next].b : w->arcs[next].a;
    }
    for (size_t k = 0; k < w->narcs; k++)
        if (!used[k] && (w->arcs[k].left == i || w->arcs[k].right == i))
            return false;
    return f->ncorners >= 3;
}

/* Its area, or 0 when it is no simple polygon. */
static double face_area(const sg_skeleton *s, const sg_skeleton_face *f)
{
    double p[SG_SKELETON_NODES][2];
    uint32_t triangles[SG_SKELETON_NODES][3], left[SG_SKELETON_NODES];
    for (size_t i = 0; i < f->ncorners; i++)
        memcpy(p[i], s->node[f->corner[i]], sizeof p[i]);
    const double area = sg_polygon_area((const double(*)[2])p, f->ncorners);
    return area > 0 && sg_triangulate((const double(*)[2])p, f->ncorners, triangles, left) ? area : 0;
}

static bool make_faces(wave *w, const double (*p)[2])
{
    double sum = 0;
    const double whole = sg_polygon_area(p, w->n);
    for (size_t i = 0; i < w->n; i++) {
        if (!trace_face(w, (int)i))
            return false;
        const double area = face_area(w->s, w->s->face + i);
        if (!(area > 0))
            return false;
        sum += area;
    }
    return fabs(sum - whole) <= 1e-6 * whole;
}

/* ---- the beginning ---- */

static bool begin(wave *w, const double (*p)[2])
{
    double extent = 0;
    for (size_t i = 0; i < w->n; i++) {
        const double *from = p[i], *to = p[(i + 1) % w->n];
        const double length = distance2(from, to);
        line *l = w->lines + i;
        if (!(length > 0) || !isfinite(length))
            return false;
        for (int k = 0; k < 2; k++)
            l->along[k] = (to[k] - from[k]) / length;
        l->normal[0] = -l->along[1];
        l->normal[1] = l->along[0];
        l->at = dot2(l->normal, from);
        extent = fmax(extent, length);
        memcpy(w->s->node[i], from, 2 * sizeof *from);
        w->s->node[i][2] = 0;
    }
    w->s->nnodes = w->n;
    w->small = 1e-9 * extent;
    const int n = (int)w->n;
    w->nvertices = w->n; /* so that each may tell its neighbours */
    for (int i = 0; i < n; i++) {
        vertex *v = w->vertices + i;
        *v = (vertex){
            .in = (i + n - 1) % n, .out = i, .before = (i + n - 1) % n, .after = (i + 1) % n, .node = i, .alive = true};
        memcpy(v->start, p[i], sizeof v->start);
        find_speed(w, v);
        if (v->stuck)
            return false;
    }
    return sg_polygon_area(p, w->n) > 0;
}

bool sg_skeleton_find(const double (*p)[2], size_t n, sg_skeleton *s)
{
    wave w = {.s = s, .n = n};
    memset(s, 0, sizeof *s);
    if (n < 3 || n > SG_SKELETON_CORNERS || !begin(&w, p) || !run(&w) || !make_faces(&w, p))
        return false;
    for (size_t i = 0; i < s->nnodes; i++)
        s->height = fmax(s->height, s->node[i][2]);
    return true;
}
