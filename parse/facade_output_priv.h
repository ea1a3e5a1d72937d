/* SPDX-License-Identifier: GPL-3.0-or-later */
/* facade_output_priv.h - what the writers of a parsed photograph share. */
#ifndef SG_PARSE_FACADE_OUTPUT_PRIV_H
#define SG_PARSE_FACADE_OUTPUT_PRIV_H

#include "parse/facade_output.h"

enum { SG_FACADE_PATH = 4096 };

/** FOLDER/NAME and the ending of one format. @return SG_OK, SG_EIO (too long) */
sg_status sg_facade_path(const sg_facade_report *r, sg_facade_format format, char path[SG_FACADE_PATH], sg_error *err);

/** The result as pixels: channels, or the class table's pixel values. map is made here.
 *  @return SG_OK, SG_ENUMERIC, SG_ENOMEM */
sg_status sg_facade_raster(const sg_facade_report *r, bool channels, sg_label_map *map, sg_error *err);

/** Marginals, lines and their picture, as asked for; there is a sample. @return SG_OK, SG_EIO, SG_ENUMERIC, SG_ENOMEM */
sg_status sg_facade_write_uncertainty(const sg_facade_report *r, unsigned formats, sg_error *err);

#endif
