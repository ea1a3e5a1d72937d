/* SPDX-License-Identifier: GPL-3.0-or-later */
/* import_rename_priv.h - the names of an imported grammar, made its importer's. */
#ifndef SG_GRAMMAR_IMPORT_RENAME_PRIV_H
#define SG_GRAMMAR_IMPORT_RENAME_PRIV_H

#include "grammar/ast.h"

/** Give every symbol, constant and function that the tree defines its name as a part of `name`: the start symbol becomes `name`
 *  itself, X becomes name.X. Meshes, which stand in the folder of `file`, are
 *  called as they are seen from where `file` is.
 *  @return SG_OK, SG_ENOMEM */
sg_status sg_import_rename(sg_ast *ast, const char *name, const char *file, sg_arena *arena);

#endif
