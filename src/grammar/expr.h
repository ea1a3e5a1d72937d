/* SPDX-License-Identifier: GPL-3.0-or-later */
/* expr.h - arithmetic and boolean expressions, compiled once to register code.
 * Booleans are 1 and 0; anything but 0 is true. Constants are folded. User functions are inlined when compiled. */
#ifndef SG_GRAMMAR_EXPR_H
#define SG_GRAMMAR_EXPR_H

#include <stdint.h>

typedef uint32_t sg_expr; /* index into the expressions of one grammar; SG_NONE: absent */

#endif
