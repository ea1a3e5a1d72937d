/* SPDX-License-Identifier: GPL-3.0-or-later */
/* json_node.h - the pieces that both writers of derivations as JSON share. */
#ifndef SG_SCENE_JSON_NODE_H
#define SG_SCENE_JSON_NODE_H

#include "derivation/derivation.h"

#include <stdio.h>

/** [x, ...] with 17 digits. JSON has no other numbers than finite ones: these are "inf", "-inf", "nan", "-nan".
 *  @return SG_OK, SG_EIO, SG_ENOMEM */
sg_status sg_json_numbers(const double *x, size_t n, FILE *out, sg_error *err);
/** A string, quoted. @return SG_OK, SG_EIO, SG_ENOMEM */
sg_status sg_json_name(const char *name, FILE *out, sg_error *err);
/** {"rule":...,"symbol":... and for a root that is not at depth 0 "depth":...; the symbol's number where no rule tells it. */
sg_status sg_json_node_begin(const sg_derivation *d, size_t node, FILE *out, sg_error *err);
/** ,"uniforms":[...],"values":[...],"children":[ where the first two are left out when they are empty. */
sg_status sg_json_node_end(const sg_derivation *d, size_t node, FILE *out, sg_error *err);

#endif
