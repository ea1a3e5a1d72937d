/* SPDX-License-Identifier: GPL-3.0-or-later */
/* number.h - numbers as text. */
#ifndef SG_GRAMMAR_NUMBER_H
#define SG_GRAMMAR_NUMBER_H

enum { SG_NUMBER_SIZE = 32 };

/** The shortest decimal that reads back as the same double, with a point whatever the locale; text has SG_NUMBER_SIZE
 *  bytes. Returns text. */
const char *sg_number_format(double value, char *text);

#endif
