/* SPDX-License-Identifier: GPL-3.0-or-later */
/* features_sums_priv.h - a channel summed up round every pixel: over boxes, rows, columns and what lies on one side. */
#ifndef SG_PARSE_FEATURES_SUMS_PRIV_H
#define SG_PARSE_FEATURES_SUMS_PRIV_H

#include "parse/cv_features.h"

typedef enum {
    SG_SUM_NONE,         /* the channel itself */
    SG_SUM_MEAN,         /* mean over a box */
    SG_SUM_SD,           /* standard deviation over a box */
    SG_SUM_CONTRAST,     /* the pixel less the mean over a box */
    SG_SUM_ROW,          /* mean over `height` whole rows, fewer at the borders */
    SG_SUM_ROW_SD,       /* standard deviation over them */
    SG_SUM_ROW_CONTRAST, /* the pixel less their mean */
    SG_SUM_COLUMN,       /* the same over `width` columns */
    SG_SUM_COLUMN_SD,
    SG_SUM_COLUMN_CONTRAST,
    SG_SUM_ABOVE, /* mean over what lies above in a strip `width` px wide, the pixel's row included */
    SG_SUM_BELOW,
    SG_SUM_LEFT, /* and to the left in a strip `height` px high */
    SG_SUM_RIGHT,
} sg_sum;

/** Sum up a channel. Boxes reach past the borders, which are repeated.
 *  @param width, height  of the box, odd
 *  @param work  two planes of the photograph's size are taken and given back
 *  @return SG_OK, SG_ENOMEM, SG_ENUMERIC */
sg_status sg_sum_up(sg_sum sum, size_t width, size_t height, sg_plane channel, const sg_plane work[2], sg_plane to,
                    sg_error *err);

#endif
