/* SPDX-License-Identifier: GPL-3.0-or-later */
/* derivation_load.h - stored derivations in either of their forms. */
#ifndef SG_SCENE_DERIVATION_LOAD_H
#define SG_SCENE_DERIVATION_LOAD_H

#include "derivation/derivation_io.h"

/** Read derivations of g: JSON (derivation_json.h) when the file begins with a bracket, else the binary form
 *  (derivation_io.h). "-" is standard input. @return SG_OK, SG_EINPUT, SG_ENOMEM; out only on success */
sg_status sg_derivation_load(const char *path, const sg_grammar *g, sg_derivation_file *out, sg_error *err);

#endif
