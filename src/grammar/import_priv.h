/* SPDX-License-Identifier: GPL-3.0-or-later */
/* import_priv.h - a grammar inside of another one: the statement `import NAME "FILE"`.
 *
 * NAME becomes the start symbol of FILE, what else FILE defines is called NAME.SYMBOL here, and the labels of FILE that
 * are symbols of the importing grammar are these symbols: so a grammar of labels (a learned facade) gets bodies. */
#ifndef SG_GRAMMAR_IMPORT_PRIV_H
#define SG_GRAMMAR_IMPORT_PRIV_H

#include "grammar/parse_priv.h"

/** Read what the parsed tree imports, and what that imports, into the tree; the texts are added to p's source.
 *  FILE is looked for in the folder of the file that names it.
 *  @param limit  bytes that all texts may have together
 *  @return SG_OK, SG_EINPUT (a file that cannot be read or is no grammar in this language, a name that is there already, a
 *          circle, `tied` or `weights` in one of the two only, a depth limit that the importing grammar lacks), SG_ENOMEM */
sg_status sg_import_all(sg_parse *p, size_t limit);

#endif
