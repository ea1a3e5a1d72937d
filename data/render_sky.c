/* SPDX-License-Identifier: GPL-3.0-or-later */
/* render_sky.c - a gradient with clouds; it glows and lies behind everything. */
#include "config.h"

#include "data/render_priv.h"

#include <math.h>

void sg_paint_sky(sg_painter *p)
{
    sg_canvas *c = &p->canvas;
    const sg_tint white = sg_tint_srgb(0xf2f4f6);
    const double cover = 1.4 - 2.6 * p->style.clouds, low = 0.35 * (double)c->height;
    for (size_t y = 0; y < c->height; y++) {
        const sg_tint clear = sg_tint_mixed(p->style.zenith, p->style.horizon, fmin(1, (double)y / low));
        for (size_t x = 0; x < c->width; x++) {
            const size_t i = y * c->width + x;
            const double thick = c->noise[SG_NOISE_STAIN][i] - cover + 0.12 * c->noise[SG_NOISE_MOTTLE][i];
            const double cloud = 1 / (1 + exp(-2.6 * thick));
            const double shade = 0.93 + 0.05 * c->noise[SG_NOISE_STAIN][i];
            const sg_tint t = sg_tint_mixed(clear, sg_tint_scaled(white, shade), 0.85 * cloud);
            c->glow[3 * i] = t.r;
            c->glow[3 * i + 1] = t.g;
            c->glow[3 * i + 2] = t.b;
            c->depth[i] = (float)(-40 * c->unit);
        }
    }
}
