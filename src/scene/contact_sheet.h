/* SPDX-License-Identifier: GPL-3.0-or-later */
/* contact_sheet.h - many pictures on one page. */
#ifndef SG_SCENE_CONTACT_SHEET_H
#define SG_SCENE_CONTACT_SHEET_H

#include "image/image.h"

typedef struct {
    size_t columns, rows; /* rows 0: as many as the pictures need */
    size_t margin_px;     /* around the sheet and between pictures */
    uint32_t background;  /* 0xRRGGBB */
} sg_sheet_opts;

#define SG_SHEET_OPTS_INIT {4, 0, 12, 0xffffff}

/** Lay the first columns x rows of n pictures out row by row; each cell is as large as the largest picture, and pictures
 *  are centred in theirs. @param out made here. @return SG_OK, SG_EINVAL (no picture, no column, too large a sheet), SG_ENOMEM */
sg_status sg_contact_sheet(const sg_image *pictures, size_t n, const sg_sheet_opts *opts, sg_image *out, sg_error *err);

#endif
