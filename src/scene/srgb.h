/* SPDX-License-Identifier: GPL-3.0-or-later */
/* srgb.h - between the values of pictures and linear light (IEC 61966-2-1). */
#ifndef SG_SCENE_SRGB_H
#define SG_SCENE_SRGB_H

#include <math.h>
#include <stdint.h>

/** 0xRRGGBB as linear light, 0 to 1. */
static inline void sg_srgb_to_linear(uint32_t color, double *rgb)
{
    for (int i = 0; i < 3; i++) {
        const double v = (double)(color >> (16 - 8 * i) & 255) / 255;
        rgb[i] = v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
    }
}

/** One channel, 0 to 255; what is brighter than white is white. */
static inline uint8_t sg_srgb_of_linear(double v)
{
    const double s = v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - 0.055;
    return (uint8_t)lround(255 * fmin(1, fmax(0, s)));
}

#endif
