/* SPDX-License-Identifier: GPL-3.0-or-later */
/* markup.h - text inside HTML and SVG. */
#ifndef SG_CORE_MARKUP_H
#define SG_CORE_MARKUP_H

#include <stdio.h>

/** Write s so that it can stand in an element or a quoted attribute: & < > " become entities, and control characters,
 *  which XML does not allow, are left out. A failed write shows up in
 *  ferror(out). */
void sg_markup_text(FILE *out, const char *s);

#endif
