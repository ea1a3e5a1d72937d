/* SPDX-License-Identifier: GPL-3.0-or-later */
/* obj_materials.c - the colours in material libraries. Of the many statements newmtl and Kd are read. */
#include "config.h"

#include "scene/obj_priv.h"

#include <math.h>

/* Three shares of 255, or one for all. Colours by spectra and in XYZ say nothing we could use. */
static sg_status read_color(sg_obj_text *t, uint32_t *color)
{
    double rgb[3] = {0, 0, 0};
    const size_t begin = t->at;
    const sg_obj_word first = sg_obj_next_word(t);
    if (sg_obj_is_word(t, first, "spectral") || sg_obj_is_word(t, first, "xyz")) {
        sg_obj_rest(t);
        return SG_OK;
    }
    t->at = begin;
    SG_TRY(sg_obj_number(t, rgb));
    size_t at = t->at;
    if (sg_obj_next_word(t).length == 0) {
        rgb[1] = rgb[2] = rgb[0];
    } else {
        t->at = at;
        SG_TRY(sg_obj_number(t, rgb + 1));
        SG_TRY(sg_obj_number(t, rgb + 2));
    }
    *color = 0;
    for (int i = 0; i < 3; i++)
        *color = *color << 8 | (uint32_t)lround(255 * fmin(1, fmax(0, rgb[i])));
    return SG_OK;
}

static sg_status read_all(sg_obj_text *t, sg_obj *obj)
{
    uint32_t material = SG_NONE, unused = 0;
    while (sg_obj_next_line(t)) {
        const sg_obj_word w = sg_obj_next_word(t);
        const char *name;
        if (sg_obj_is_word(t, w, "newmtl")) {
            SG_TRY(sg_obj_name(t, sg_obj_rest(t), obj, &name));
            SG_TRY(sg_obj_material_find(obj, name, false, &material, t->err));
        } else if (sg_obj_is_word(t, w, "Kd")) {
            SG_TRY(read_color(t, material != SG_NONE ? &obj->materials[material].color : &unused));
        } else {
            sg_obj_rest(t);
        }
    }
    return SG_OK;
}

sg_status sg_obj_parse_materials(const char *text, size_t length, const char *name, sg_obj *obj, sg_error *err)
{
    sg_obj_text t;
    SG_TRY(sg_obj_text_open(&t, text, length, name, err));
    const sg_status st = read_all(&t, obj);
    sg_obj_text_close(&t);
    return st;
}
