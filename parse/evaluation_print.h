/* SPDX-License-Identifier: GPL-3.0-or-later */
/* evaluation_print.h - confusion matrices and scores as tables for people and as JSON for machines. */
#ifndef SG_PARSE_EVALUATION_PRINT_H
#define SG_PARSE_EVALUATION_PRINT_H

#include "parse/evaluation.h"

#include <jansson.h>
#include <stdio.h>

/** The matrix in per cent of each true class, with pixels and intersection over union, and a line of what it comes to. */
void sg_confusion_print(const sg_confusion *c, const sg_scores *s, const sg_classes *classes, FILE *out);

/** A table of scores in per cent, a line each: first the heading, then the lines. */
void sg_scores_print_heading(const char *first, const sg_classes *classes, FILE *out);
void sg_scores_print_line(const char *name, size_t nmaps, const sg_classes *classes, const sg_scores *s, FILE *out);

/** {"overall", "class_average", "mean_iou", "per_class", "iou_per_class", "confusion"} in fractions of 1, null for what is
 *  none; with c also {"counts", "unclassed", "ignored", "maps"} in pixels. @param c may be NULL
 *  @return NULL: out of memory */
json_t *sg_scores_json(const sg_confusion *c, const sg_scores *s, const sg_classes *classes);

#endif
