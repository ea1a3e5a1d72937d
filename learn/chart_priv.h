/* SPDX-License-Identifier: GPL-3.0-or-later */
/* chart_priv.h - a line chart as an <svg> element. */
#ifndef SG_LEARN_CHART_PRIV_H
#define SG_LEARN_CHART_PRIV_H

#include <stddef.h>
#include <stdio.h>

/** One series over 0..n-1 with axes, round ticks and titles. Values that are not finite are left out. */
void sg_chart_write(FILE *out, const double *value, size_t n, const char *title, const char *x_title);

#endif
