/* SPDX-License-Identifier: GPL-3.0-or-later */
/* obj_priv.h - lines and words of OBJ and MTL files: what their readers share. */
#ifndef SG_SCENE_OBJ_PRIV_H
#define SG_SCENE_OBJ_PRIV_H

#include "grammar/source.h"
#include "scene/obj_read.h"

#include <locale.h>
#include <stdbool.h>

/** A place in a file that is read. The text is a copy that ends in a NUL, and holds no other. */
typedef struct {
    sg_source source;
    size_t at;
    char *copy;
    locale_t plain, before; /* of numbers; what the thread had */
    sg_error *err;
} sg_obj_text;

typedef struct {
    size_t at, length; /* in the text; length 0: the line has ended */
} sg_obj_word;

/** The text must be whole: no NUL in it. Until sg_obj_text_close() numbers have a point in this thread, whatever the locale
 *  of the program is. @return SG_OK, SG_EINPUT, SG_ENOMEM; on failure there is nothing to close */
sg_status sg_obj_text_open(sg_obj_text *t, const char *text, size_t length, const char *name, sg_error *err);
void sg_obj_text_close(sg_obj_text *t);
/** To the first word of the next line that has one. @return false at the end of the file */
bool sg_obj_next_line(sg_obj_text *t);
/** The next word of the line. A backslash at the end of a line continues it. */
sg_obj_word sg_obj_next_word(sg_obj_text *t);
/** What is left of the line, without blanks around it: names may hold some. */
sg_obj_word sg_obj_rest(sg_obj_text *t);
bool sg_obj_is_word(const sg_obj_text *t, sg_obj_word w, const char *text);
/** The next word as a number between -1e30 and 1e30. @return SG_OK, SG_EINPUT */
sg_status sg_obj_number(sg_obj_text *t, double *out);
/** SG_EINPUT, FILE:LINE:COL and the line. */
sg_status sg_obj_fail(const sg_obj_text *t, size_t at, const char *format, ...) __attribute__((format(printf, 3, 4)));
/** A copy of a name that is valid UTF-8, in the arena of the mesh. @return SG_OK, SG_EINPUT, SG_ENOMEM */
sg_status sg_obj_name(const sg_obj_text *t, sg_obj_word w, sg_obj *obj, const char **name);

/** The material of this name, made when it is not there; nor then, when make is false: SG_NONE.
 *  @return SG_OK, SG_ENOMEM */
sg_status sg_obj_material_find(sg_obj *obj, const char *name, bool make, uint32_t *out, sg_error *err);

/** A polygon of n >= 3 corners becomes faces. @return SG_OK, SG_ENOMEM */
sg_status sg_obj_add_polygon(sg_obj *obj, const sg_mesh_corner *corners, size_t n, uint32_t material, sg_error *err);

#endif
