/* SPDX-License-Identifier: GPL-3.0-or-later */
/* assets.h - the mesh files that a grammar inserts, read once. They are immutable, and may be shared by threads. */
#ifndef SG_SCENE_ASSETS_H
#define SG_SCENE_ASSETS_H

#include "scene/obj_read.h"

typedef struct sg_assets sg_assets;

/** Read every file that an `insert` of the grammar names. Paths start at the folder of the grammar's file.
 *  @param path  of the grammar's file; "-" stands for one in the current folder
 *  @return SG_OK, SG_EINPUT (FILE:LINE of the rule and the path, where there is no such file; FILE:LINE:COL of the mesh,
 *  where it is bad; no faces), SG_ENOMEM; *out only on success, free it with sg_assets_free() */
sg_status sg_assets_load(const sg_grammar *g, const char *path, sg_assets **out, sg_error *err);
void sg_assets_free(sg_assets *a); /* NULL is fine */

/** The mesh of this name, as primitives have it; NULL: none is there. */
const sg_obj *sg_assets_find(const sg_assets *a, uint32_t name);
/** Is this one of the files that were read, whatever it is called? */
bool sg_assets_has_file(const sg_assets *a, const char *path);

#endif
