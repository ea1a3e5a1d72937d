/* SPDX-License-Identifier: GPL-3.0-or-later */
/* label_scene.c - walks a derivation with rectangles on a stack of its own, so depth costs no C stack. */
#include "scene/label_scene.h"

#include "core/array.h"
#include "scene/placer.h"

#include <math.h>
#include <stdlib.h>

void sg_label_scene_clear(sg_label_scene *scene)
{
    free(scene->rects);
    if (scene->placer != NULL)
        sg_placer_clear(scene->placer);
    free(scene->placer);
    *scene = (sg_label_scene){0};
}

static sg_status add_rect(sg_label_scene *scene, const sg_place *p, sg_error *err)
{
    if (scene->nrects == scene->capacity && !SG_GROW(scene->rects, scene->capacity, scene->nrects + 1))
        return SG_FAIL_NOMEM(err);
    scene->rects[scene->nrects++] =
        (sg_label_rect){p->rect.x0, p->rect.y0, p->rect.x1, p->rect.y1, p->label, (uint32_t)p->node};
    return SG_OK;
}

static sg_status walk(sg_label_scene *scene, const sg_derivation *d, sg_error *err)
{
    sg_placer *p = scene->placer;
    SG_TRY(sg_placer_place(p, d, 0, (sg_rect){0, 0, scene->width, scene->height}, err));
    sg_placer_reverse(p, 0);
    while (p->n > 0) {
        const sg_place top = p->items[--p->n];
        if (top.label != SG_NONE) {
            SG_TRY(add_rect(scene, &top, err));
            continue;
        }
        const size_t first = p->n;
        SG_TRY(sg_placer_place(p, d, top.node, top.rect, err));
        sg_placer_reverse(p, first);
    }
    return SG_OK;
}

sg_status sg_label_scene_interpret(sg_label_scene *scene, const sg_derivation *d, double width, double height,
                                   sg_error *err)
{
    scene->nrects = 0;
    scene->width = width;
    scene->height = height;
    if (d->nnodes == 0 || !(width > 0) || !(height > 0) || !isfinite(width) || !isfinite(height))
        return SG_FAIL(err, SG_ENUMERIC, "an empty derivation, or a scope without area");
    if (scene->placer == NULL && (scene->placer = calloc(1, sizeof *scene->placer)) == NULL)
        return SG_FAIL_NOMEM(err);
    sg_placer_reset(scene->placer);
    const sg_status st = walk(scene, d, err);
    if (st != SG_OK)
        scene->nrects = 0;
    return st;
}
