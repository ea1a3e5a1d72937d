/* SPDX-License-Identifier: GPL-3.0-or-later */
/* number.c - shortest round-trip decimals. */
#include "config.h"

#include "grammar/number.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* %g drops trailing zeros, so that of 15, 16 and 17 digits the first that reads back is the shortest. */
const char *sg_number_format(double value, char *text)
{
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(text, SG_NUMBER_SIZE, "%.*g", digits, value);
        if (strtod(text, NULL) == value)
            break;
    }
    char *comma = strchr(text, ',');
    if (comma != NULL)
        *comma = '.';
    return text;
}
