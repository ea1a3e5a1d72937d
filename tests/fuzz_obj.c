/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fuzz_obj.c - any bytes as a mesh file, and as a library of its materials. What is taken for a mesh has indices of what is
 * there, finite numbers and faces of three or four corners. */
#include "config.h"

#include "scene/obj_read.h"
#include "tests/fuzz.h"

#include <math.h>

static void check_corner(const sg_obj *obj, const sg_mesh_corner *c)
{
    fuzz_must(c->vertex < obj->nvertices);
    fuzz_must(c->normal == SG_NONE || c->normal < obj->nnormals);
    fuzz_must(c->uv == SG_NONE || c->uv < obj->nuvs);
    for (int i = 0; i < 3; i++) {
        const double x = obj->vertices[c->vertex][i];
        fuzz_must(isfinite(x) && x >= obj->low[i] && x <= obj->high[i]);
    }
}

static void check_mesh(const sg_obj *obj)
{
    for (size_t i = 0; i < obj->nfaces; i++) {
        const sg_mesh_face *f = obj->faces + i;
        fuzz_must(f->ncorners == 3 || f->ncorners == 4);
        fuzz_must(f->group == SG_NONE || f->group < obj->nmaterials);
        for (uint32_t k = 0; k < f->ncorners; k++)
            check_corner(obj, f->corner + k);
    }
    for (size_t i = 0; i < obj->nnormals; i++) {
        const double length = sg_vec_length(obj->normals[i]);
        fuzz_must(length == 0 || fabs(length - 1) < 1e-12);
    }
    for (size_t i = 0; i < obj->nmaterials; i++)
        fuzz_must(obj->materials[i].color == SG_NONE || obj->materials[i].color <= 0xffffff);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    sg_error err = SG_ERROR_INIT;
    sg_obj obj;
    const sg_status st = sg_obj_parse((const char *)data, size, "fuzz", &obj, &err);
    if (st != SG_OK) {
        fuzz_refused(st, err);
        return 0;
    }
    const sg_status colours = sg_obj_parse_materials((const char *)data, size, "fuzz", &obj, &err);
    if (colours != SG_OK)
        fuzz_refused(colours, err);
    check_mesh(&obj);
    sg_obj_clear(&obj);
    return 0;
}
