/* SPDX-License-Identifier: GPL-3.0-or-later */
/* label_color.c - colours of labels that were given none. */
#include "config.h"

#include "grammar/label_color.h"

#include <math.h>

uint32_t sg_label_color(uint32_t n)
{
    const double hue = fmod(n * 0.618033988749895, 1) * 6; /* in sixths of the circle */
    const double value = n % 2 == 0 ? 0.9 : 0.65, saturation = 0.7;
    uint32_t color = 0;
    for (int i = 0; i < 3; i++) {
        const double k = fmod(5 - 2 * i + hue, 6); /* hue, saturation, value to red, green, blue */
        const double part = value * (1 - saturation * fmax(0, fmin(fmin(k, 4 - k), 1)));
        color = color << 8 | (uint32_t)(part * 255);
    }
    return color;
}
