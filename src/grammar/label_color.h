/* SPDX-License-Identifier: GPL-3.0-or-later */
/* label_color.h - colours of labels that were given none. */
#ifndef SG_GRAMMAR_LABEL_COLOR_H
#define SG_GRAMMAR_LABEL_COLOR_H

#include <stdint.h>

/** 0xRRGGBB for the n-th label: hues a golden angle apart, so that the first few differ well. */
uint32_t sg_label_color(uint32_t n);

#endif
