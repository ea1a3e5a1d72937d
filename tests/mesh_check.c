/* SPDX-License-Identifier: GPL-3.0-or-later */
/* mesh_check.c - the rules of mesh.h. */
#include "tests/mesh_check.h"

#include "core/utf8.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MUST(condition, rule)                                                                                          \
    do {                                                                                                               \
        if (!(condition))                                                                                              \
            return (rule);                                                                                             \
    } while (0)

typedef struct {
    uint32_t from, to, face;
} edge;

typedef struct {
    uint32_t vertex[4]; /* ascending; SG_NONE behind three */
} face_key;

typedef struct {
    const sg_mesh *m;
    edge *edges; /* sorted */
    size_t nedges;
    face_key *keys;
    uint32_t *single; /* [faces] edges without their opposite */
    uint32_t *up;     /* [vertices] towards the root of its part */
    double *volume;   /* [vertices] of a part, at its root */
    bool *open;       /* [vertices] the part has an edge without its opposite, at its root */
    uint32_t *first;  /* [vertices] the first face of a part, at its root */
} checker;

static int compare_edges(const void *a, const void *b)
{
    const edge *x = a, *y = b;
    return x->from != y->from ? (x->from < y->from ? -1 : 1) : (x->to > y->to) - (x->to < y->to);
}

static int compare_numbers(const void *a, const void *b)
{
    const uint32_t *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

static int compare_keys(const void *a, const void *b)
{
    for (int i = 0; i < 4; i++) {
        const int order = compare_numbers(((const face_key *)a)->vertex + i, ((const face_key *)b)->vertex + i);
        if (order != 0)
            return order;
    }
    return 0;
}

static double face_volume(const sg_mesh *m, const sg_mesh_face *f, const double *origin)
{
    double sum = 0;
    for (uint32_t k = 1; k + 1 < f->ncorners; k++) {
        double a[3], b[3], c[3], n[3];
        sg_vec_add(m->vertices[f->corner[0].vertex], -1, origin, a);
        sg_vec_add(m->vertices[f->corner[k].vertex], -1, origin, b);
        sg_vec_add(m->vertices[f->corner[k + 1].vertex], -1, origin, c);
        sg_vec_cross(b, c, n);
        sum += sg_vec_dot(a, n) / 6;
    }
    return sum;
}

double mesh_volume(const sg_mesh *m)
{
    double sum = 0;
    for (size_t i = 0; i < m->nfaces; i++)
        sum += face_volume(m, m->faces + i, (const double[]){0, 0, 0});
    return sum;
}

/* Along the normal of the face: the cross product of its diagonals, or of two sides. */
static void area_vector(const sg_mesh *m, const sg_mesh_face *f, double *out)
{
    double a[3], b[3];
    const uint32_t last = f->ncorners - 1;
    const double *first = m->vertices[f->corner[0].vertex];
    sg_vec_add(m->vertices[f->corner[last == 3 ? 2 : 1].vertex], -1, first, a);
    sg_vec_add(m->vertices[f->corner[last].vertex], -1, m->vertices[f->corner[last == 3 ? 1 : 0].vertex], b);
    sg_vec_cross(a, b, out);
}

/* ---- numbers, faces, names ---- */

static bool all_finite(const double *x, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (!isfinite(x[i]))
            return false;
    return true;
}

static const char *check_numbers(const sg_mesh *m)
{
    MUST(m->nvertices == 0 || all_finite(m->vertices[0], 3 * m->nvertices), "a place that is not finite");
    MUST(m->nuvs == 0 || all_finite(m->uvs[0], 2 * m->nuvs), "a texture coordinate that is not finite");
    for (size_t i = 0; i < m->nnormals; i++)
        MUST(fabs(sg_vec_length(m->normals[i]) - 1) < 1e-12, "a normal that is not of length 1");
    return NULL;
}

static const char *check_face(const sg_mesh *m, const sg_mesh_face *f)
{
    double n[3], straightest = -1;
    MUST(f->ncorners == 3 || f->ncorners == 4, "a face that is neither triangle nor quadrilateral");
    for (uint32_t k = 0; k < f->ncorners; k++) {
        MUST(f->corner[k].vertex < m->nvertices && f->corner[k].normal < m->nnormals && f->corner[k].uv < m->nuvs,
             "an index that is too large");
        for (uint32_t i = 0; i < k; i++)
            MUST(f->corner[k].vertex != f->corner[i].vertex, "a face with a vertex twice");
    }
    area_vector(m, f, n);
    MUST(sg_vec_normalize(n), "a face without area");
    for (uint32_t k = 0; k < f->ncorners; k++)
        straightest = fmax(straightest, sg_vec_dot(n, m->normals[f->corner[k].normal]));
    MUST(straightest > 0, "normals against the winding");
    return NULL;
}

static bool is_name(const char *name)
{
    return name == NULL || (name[0] != '\0' && sg_utf8_is(name, strlen(name)));
}

static const char *check_groups(const sg_mesh *m)
{
    size_t first = 0;
    for (size_t k = 0; k < m->ngroups; k++) {
        const sg_mesh_group *g = m->groups + k;
        MUST(g->first == first, "groups that do not follow each other");
        MUST(g->material < m->nmaterials, "a group without a material");
        MUST(is_name(g->name), "a group's name that is no text");
        MUST(g->n <= m->nfaces - first, "a group of more faces than there are");
        for (size_t i = first; i < first + g->n; i++)
            MUST(m->faces[i].group == k, "a face outside its group");
        first += g->n;
    }
    MUST(first == m->nfaces, "faces without a group");
    for (size_t i = 0; i < m->nmaterials; i++) {
        MUST(m->materials[i].color <= 0xffffff, "a material whose colour is none");
        MUST(is_name(m->materials[i].name), "a material's name that is no text");
    }
    return NULL;
}

/* ---- faces and edges together ---- */

static const char *check_twins(checker *c)
{
    for (size_t i = 0; i < c->m->nfaces; i++) {
        const sg_mesh_face *f = c->m->faces + i;
        for (uint32_t k = 0; k < 4; k++)
            c->keys[i].vertex[k] = k < f->ncorners ? f->corner[k].vertex : SG_NONE;
        qsort(c->keys[i].vertex, 4, sizeof(uint32_t), compare_numbers);
    }
    qsort(c->keys, c->m->nfaces, sizeof *c->keys, compare_keys);
    for (size_t i = 1; i < c->m->nfaces; i++)
        MUST(compare_keys(c->keys + i - 1, c->keys + i) != 0, "a face twice");
    return NULL;
}

static void list_edges(checker *c)
{
    for (size_t i = 0; i < c->m->nfaces; i++) {
        const sg_mesh_face *f = c->m->faces + i;
        for (uint32_t k = 0; k < f->ncorners; k++)
            c->edges[c->nedges++] = (edge){f->corner[k].vertex, f->corner[(k + 1) % f->ncorners].vertex, (uint32_t)i};
    }
    qsort(c->edges, c->nedges, sizeof *c->edges, compare_edges);
}

static bool of_file(const checker *c, size_t face)
{
    return c->m->groups[c->m->faces[face].group].key_mesh != SG_NONE;
}

static const char *check_edges(checker *c)
{
    list_edges(c);
    for (size_t i = 0; i < c->nedges; i++) {
        const edge back = {c->edges[i].to, c->edges[i].from, 0};
        MUST(i == 0 || compare_edges(c->edges + i, c->edges + i - 1) != 0, "an edge twice in one direction");
        c->single[c->edges[i].face] += bsearch(&back, c->edges, c->nedges, sizeof back, compare_edges) == NULL;
    }
    return NULL;
}

static uint32_t root(uint32_t *up, uint32_t i)
{
    while (up[i] != i)
        i = up[i] = up[up[i]];
    return i;
}

static void find_parts(checker *c)
{
    const sg_mesh *m = c->m;
    for (uint32_t i = 0; i < m->nvertices; i++)
        c->up[i] = i;
    for (size_t i = 0; i < m->nfaces; i++)
        for (uint32_t k = 1; k < m->faces[i].ncorners; k++)
            c->up[root(c->up, m->faces[i].corner[k].vertex)] = root(c->up, m->faces[i].corner[0].vertex);
    for (size_t i = 0; i < m->nfaces; i++) {
        const uint32_t r = root(c->up, m->faces[i].corner[0].vertex);
        c->volume[r] += face_volume(m, m->faces + i, m->vertices[r]);
        c->open[r] |= c->single[i] > 0;
    }
}

/* Looks like another face of its part, of which it is the first. */
static bool lies_with(const checker *c, size_t first, size_t face)
{
    double a[3], b[3];
    area_vector(c->m, c->m->faces + first, a);
    area_vector(c->m, c->m->faces + face, b);
    sg_vec_normalize(a);
    sg_vec_normalize(b);
    return sg_vec_dot(a, b) > 1 - 1e-9;
}

/* All faces of a closed part look outwards, or none does; those of an open one lie in one plane. */
static const char *check_parts(checker *c, size_t *nopen)
{
    const sg_mesh *m = c->m;
    find_parts(c);
    for (size_t i = 0; i < m->nvertices; i++)
        c->first[i] = SG_NONE;
    for (size_t i = 0; i < m->nfaces; i++) {
        const uint32_t r = root(c->up, m->faces[i].corner[0].vertex);
        const bool begins = c->first[r] == SG_NONE;
        if (begins)
            c->first[r] = (uint32_t)i;
        MUST(c->open[r] || c->volume[r] > 0, "a closed surface that looks inwards");
        MUST(!c->open[r] || of_file(c, i) || lies_with(c, c->first[r], i), "a surface with a hole");
        *nopen += begins && c->open[r];
    }
    return NULL;
}

static const char *check_all(checker *c, size_t *nopen)
{
    const char *wrong = check_numbers(c->m);
    for (size_t i = 0; i < c->m->nfaces && wrong == NULL; i++)
        wrong = check_face(c->m, c->m->faces + i);
    if (wrong == NULL)
        wrong = check_groups(c->m);
    if (wrong == NULL)
        wrong = check_twins(c);
    if (wrong == NULL)
        wrong = check_edges(c);
    return wrong != NULL ? wrong : check_parts(c, nopen);
}

const char *mesh_check(const sg_mesh *m, size_t *nopen)
{
    checker c = {.m = m};
    size_t open = 0;
    c.edges = malloc((4 * m->nfaces + 1) * sizeof *c.edges);
    c.keys = malloc((m->nfaces + 1) * sizeof *c.keys);
    c.single = calloc(m->nfaces + 1, sizeof *c.single);
    c.up = malloc((m->nvertices + 1) * sizeof *c.up);
    c.volume = calloc(m->nvertices + 1, sizeof *c.volume);
    c.open = calloc(m->nvertices + 1, sizeof *c.open);
    c.first = malloc((m->nvertices + 1) * sizeof *c.first);
    const bool room = c.edges != NULL && c.keys != NULL && c.single != NULL && c.up != NULL && c.volume != NULL &&
                      c.open != NULL && c.first != NULL;
    const char *wrong = room ? check_all(&c, &open) : "out of memory";
    if (nopen != NULL)
        *nopen = open;
    free(c.edges);
    free(c.keys);
    free(c.single);
    free(c.up);
    free(c.volume);
    free(c.open);
    free(c.first);
    return wrong;
}
